//! One run of a machine with what is hidden in it, on a fine grid, as ideal sensors behind a filter see it.

use crate::base::{Base, Ports};
use crate::flat_track;
use crate::hidden::{Hidden, Influence, Memory};
use crate::programme::Run;

/// A machine as it truly is.
#[derive(Debug, Clone, PartialEq)]
pub struct World {
    /// Which one.
    pub base: Base,
    /// Its true parameters.
    pub parameters: Vec<f64>,
    /// What the base model does not know of.
    pub hidden: Vec<Hidden>,
    /// Time constant of the first-order filter before every sample, inputs and outputs alike \[s\].
    pub filter: f64,
}

/// What noise-free sensors record, at the samples of the run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Ideal {
    /// Inputs as recorded.
    pub inputs: Vec<Vec<f64>>,
    /// Outputs as recorded.
    pub outputs: Vec<Vec<f64>>,
}

impl Ideal {
    /// What is recorded first.
    pub(crate) fn begin(inputs: &[f64], outputs: &[f64]) -> Self {
        let one = |values: &[f64]| values.iter().map(|v| vec![*v]).collect();
        Self { inputs: one(inputs), outputs: one(outputs) }
    }

    /// Records one sample more.
    pub(crate) fn record(&mut self, inputs: &[f64], outputs: &[f64]) {
        let sampled = self.inputs.iter_mut().zip(inputs).chain(self.outputs.iter_mut().zip(outputs));
        sampled.for_each(|(list, value)| list.push(*value));
    }
}

/// The longest step that the study uses \[s\]. It divides no step of a base model.
pub const STEP: f64 = 0.37e-3;

/// A first-order filter, exact for an input that runs straight.
pub(crate) struct Filter {
    lag: f64,
    last: Vec<f64>,
    pub(crate) state: Vec<f64>,
}

impl Filter {
    pub(crate) fn new(lag: f64, start: &[f64]) -> Self {
        Self { lag, last: start.to_vec(), state: start.to_vec() }
    }

    pub(crate) fn follow(&mut self, values: &[f64], dt: f64) {
        let decay = libm::exp(-dt / self.lag);
        for ((state, last), value) in self.state.iter_mut().zip(&mut self.last).zip(values) {
            let behind = (value - *last) / dt * self.lag;
            *state = value - behind + (*state - *last + behind) * decay;
            *last = *value;
        }
    }
}

impl World {
    fn influence(&self, at: &Ports, x: &[f64], memories: &[Memory]) -> Influence {
        let mut by = Influence::default();
        let mut offset = x.len() - self.states();
        for (hidden, memory) in self.hidden.iter().zip(memories) {
            hidden.influence(self.base, at, &x[offset..offset + hidden.states()], memory, &mut by);
            offset += hidden.states();
        }
        by
    }

    fn states(&self) -> usize {
        self.hidden.iter().map(Hidden::states).sum()
    }

    fn ports(&self, u: &[f64], x: &[f64], time: f64, distance: f64) -> Ports {
        Ports { time, distance, ..self.base.ports(&self.parameters, u, x) }
    }

    fn slope(&self, u: &[f64], x: &[f64], time: f64, memories: &[Memory], dx: &mut [f64]) {
        let at = self.ports(u, x, time, 0.0);
        let by = self.influence(&at, x, memories);
        let own = x.len() - self.states();
        self.base.slope(&self.parameters, u, &x[..own], &by, &mut dx[..own]);
        let mut offset = own;
        for hidden in &self.hidden {
            let end = offset + hidden.states();
            hidden.slope(self.base, &at, &x[offset..end], &mut dx[offset..end]);
            offset = end;
        }
    }

    /// The run number `number` with steps of at most `longest` seconds.
    #[must_use]
    pub fn run(&self, run: &Run, number: u64, longest: f64) -> Ideal {
        if self.base == Base::FlatTrack {
            return flat_track::run(self, run, number, longest);
        }
        let sizes: Vec<f64> = self.base.outputs().iter().map(|row| row.2).collect();
        let raw = |k: usize| -> Vec<f64> { run.inputs.iter().map(|values| values[k]).collect() };
        let mut from = raw(0);
        let mut x = self.base.start(&self.parameters, &from);
        let first = self.ports(&from, &x, 0.0, 0.0);
        let mut memories = Vec::new();
        for hidden in &self.hidden {
            let (states, memory) = hidden.start(self.base, &first, number);
            x.extend(states);
            memories.push(memory);
        }
        let mut on_way_out: Vec<Memory> = vec![Memory::default(); self.hidden.len()];
        let mut time = run.time[0];
        let mut distance = 0.0;
        self.enter(&mut memories, &first, &mut from, 1e-9);
        let mut y = self.leave(&mut on_way_out, &memories, &from, &x, (time, distance), &sizes, 1e-9);
        let mut inputs = Filter::new(self.filter, &raw(0));
        let mut outputs = Filter::new(self.filter, &y);
        let mut ideal = Ideal::begin(&raw(0), &y);
        for k in 1..run.time.len() {
            let (start, end) = (raw(k - 1), raw(k));
            let span = run.time[k] - run.time[k - 1];
            let count = (span / longest).ceil().max(1.0);
            let dt = span / count;
            let mut part = 0.0;
            while part < count - 0.5 {
                part += 1.0;
                let pure: Vec<f64> =
                    start.iter().zip(&end).map(|(a, b)| a + (b - a) * (part / count)).collect();
                let before = self.ports(&from, &x, time, distance);
                let mut to = pure.clone();
                self.enter(&mut memories, &before, &mut to, dt);
                self.integrate(&from, &to, &mut x, time, dt, &memories);
                from = to;
                time += dt;
                distance += before.speed * dt;
                y = self.leave(&mut on_way_out, &memories, &from, &x, (time, distance), &sizes, dt);
                inputs.follow(&pure, dt);
                outputs.follow(&y, dt);
            }
            time = run.time[k];
            ideal.record(&inputs.state, &outputs.state);
        }
        ideal
    }

    pub(crate) fn enter(&self, memories: &mut [Memory], at: &Ports, u: &mut [f64], dt: f64) {
        for (hidden, memory) in self.hidden.iter().zip(memories) {
            hidden.enter(memory, at, u, dt);
        }
    }

    #[allow(clippy::too_many_arguments)] // one caller
    fn leave(
        &self,
        on_way_out: &mut [Memory],
        memories: &[Memory],
        u: &[f64],
        x: &[f64],
        (time, distance): (f64, f64),
        sizes: &[f64],
        dt: f64,
    ) -> Vec<f64> {
        let at = self.ports(u, x, time, distance);
        let by = self.influence(&at, x, memories);
        let mut y = self.base.measure(&self.parameters, u, x, &by);
        for (hidden, memory) in self.hidden.iter().zip(on_way_out) {
            hidden.leave(memory, &at, sizes, &mut y, dt);
        }
        y
    }

    /// Kutta's three-eighths rule, with inputs that run straight.
    fn integrate(&self, from: &[f64], to: &[f64], x: &mut [f64], time: f64, dt: f64, memories: &[Memory]) {
        let n = x.len();
        let mut k = [[0.0; 12]; 4];
        let mut u = [0.0; 8];
        let mut moved = [0.0; 12];
        let stages: [(f64, [f64; 3]); 4] = [
            (0.0, [0.0, 0.0, 0.0]),
            (1.0 / 3.0, [1.0 / 3.0, 0.0, 0.0]),
            (2.0 / 3.0, [-1.0 / 3.0, 1.0, 0.0]),
            (1.0, [1.0, -1.0, 1.0]),
        ];
        for (stage, (at, weights)) in stages.iter().enumerate() {
            for i in 0..n {
                moved[i] = x[i] + dt * (0..3).map(|j| weights[j] * k[j][i]).sum::<f64>();
            }
            for (i, (a, b)) in from.iter().zip(to).enumerate() {
                u[i] = a + (b - a) * at;
            }
            self.slope(&u[..from.len()], &moved[..n], time + at * dt, memories, &mut k[stage][..n]);
        }
        for i in 0..n {
            x[i] += dt / 8.0 * (k[0][i] + 3.0 * (k[1][i] + k[2][i]) + k[3][i]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn world(filter: f64) -> World {
        World { base: Base::Oscillator, parameters: Base::Oscillator.defaults(), hidden: vec![], filter }
    }

    fn ramp() -> Run {
        let time: Vec<f64> = (0..400).map(|k| f64::from(k) * 0.005).collect();
        Run { inputs: vec![time.iter().map(|t| 50.0 * t).collect()], time }
    }

    #[test]
    fn a_ramp_is_answered_with_the_closed_form_behind_the_filter() {
        // x -> r (t - c/k) / k; the filter takes its own lag off
        let ideal = world(1e-3).run(&ramp(), 0, STEP);
        let at = 399.0 * 0.005;
        let (decay, natural): (f64, f64) = (4.0, 20.0);
        let transient = (-decay * at).exp() * 50.0 / 4000.0 / natural;
        let expected = 50.0 / 4000.0 * (at - 1e-3 - 80.0 / 4000.0);
        assert!((ideal.outputs[0][399] - expected).abs() < 1.1 * transient);
        assert!((ideal.inputs[0][399] - 50.0 * (at - 1e-3)).abs() < 1e-9);
    }

    #[test]
    fn the_step_does_not_matter() {
        let (coarse, fine) = (world(1e-3).run(&ramp(), 0, STEP), world(1e-3).run(&ramp(), 0, STEP / 4.0));
        for (a, b) in coarse.outputs[2].iter().zip(&fine.outputs[2]) {
            assert!((a - b).abs() < 1e-6, "{a} {b}");
        }
    }
}
