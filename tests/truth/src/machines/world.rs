//! Runs of a machine with what is concealed in it.

use super::conceal::{Concealed, Memory, Place};
use super::mechanism::{Influence, Machine};
use crate::programme::Wave;
use crate::simulate::{Filter, Ideal};

/// The course of an input.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Course {
    /// About zero, in natural times.
    pub(crate) wave: Wave,
    /// What it moves around.
    pub(crate) middle: f64,
}

/// One run: when samples are taken, and what the inputs do.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Run {
    pub(crate) number: u64,
    pub(crate) time: Vec<f64>,
    pub(crate) inputs: Vec<Course>,
}

/// Root mean squares over a run, of each state and of its rate.
pub(crate) type Motion = Vec<(f64, f64)>;

/// A machine as it truly is.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct World {
    pub(crate) machine: Machine,
    pub(crate) parameters: Vec<f64>,
    pub(crate) concealed: Vec<Concealed>,
    /// Time constant of the first-order filter of all channels \[s\].
    pub(crate) filter: f64,
}

/// Steps of the truth per natural time of the machine.
const STEPS: f64 = 80.0;

impl World {
    fn pure(&self, run: &Run, t: f64) -> Vec<f64> {
        run.inputs.iter().map(|c| c.middle + c.wave.at(t / self.machine.time)).collect()
    }

    fn influence(&self, x: &[f64], time: f64, memories: &[Memory]) -> Influence {
        let m = &self.machine;
        let mut by = Influence { force: vec![0.0; m.bodies.len()], flow: vec![0.0; m.stores.len()] };
        let mut state = m.states();
        for (one, memory) in self.concealed.iter().zip(memories) {
            let z = if one.states() == 1 { x[state] } else { 0.0 };
            match one.place {
                Place::Body(b) => by.force[b] += one.effort(x[b], x[m.velocity(b)], time, z, memory),
                Place::Store(s) => by.flow[s] += one.effort(x[m.store(s)], 0.0, time, z, memory),
                _ => {}
            }
            state += one.states();
        }
        by
    }

    fn at(&self, time: f64, memories: &[Memory]) -> Vec<f64> {
        let mut p = self.parameters.clone();
        for (one, memory) in self.concealed.iter().zip(memories) {
            if let Place::Parameter(k) = one.place {
                p[k] = one.parameter(p[k], time, memory);
            }
        }
        p
    }

    fn slope(&self, u: &[f64], x: &[f64], time: f64, memories: &[Memory], dx: &mut [f64]) {
        let m = &self.machine;
        let own = m.states();
        let by = self.influence(x, time, memories);
        m.slope(&self.at(time, memories), u, &x[..own], &by, &mut dx[..own]);
        let mut state = own;
        for one in &self.concealed {
            if one.states() == 1
                && let Place::Body(b) = one.place
            {
                dx[state] = one.slope(x[b], x[m.velocity(b)], x[state]);
                state += 1;
            }
        }
    }

    /// Records a run, with how much it moves; `coarse` takes steps twice as long.
    pub(crate) fn run(&self, run: &Run, coarse: bool) -> (Ideal, Motion) {
        let m = &self.machine;
        let longest = m.time / if coarse { STEPS / 2.0 } else { STEPS };
        let mut memories: Vec<Memory> = self.concealed.iter().map(|c| c.start(run.number)).collect();
        let enter = |memories: &mut [Memory], u: &mut [f64], dt: f64| {
            for (one, memory) in self.concealed.iter().zip(memories) {
                if let Place::Input(k) = one.place {
                    one.enter(memory, &mut u[k], dt);
                }
            }
        };
        let first = self.pure(run, 0.0);
        let mut from = first.clone();
        enter(&mut memories, &mut from, 1e-9 * m.time);
        let mut x = m.start(&self.at(0.0, &memories), &from);
        x.extend(self.concealed.iter().filter(|c| c.states() == 1).map(|_| 0.0));
        let leave = |memories: &mut [Memory], u: &[f64], x: &[f64], time: f64, dt: f64| {
            let by = self.influence(x, time, memories);
            let all = m.measure(&self.at(time, memories), u, &x[..m.states()], &by);
            let mut y = all.clone();
            for (one, memory) in self.concealed.iter().zip(memories) {
                if let Place::Output(k) = one.place {
                    one.leave(memory, &all, &mut y[k], time, dt);
                }
            }
            y
        };
        let y = leave(&mut memories, &from, &x, 0.0, 1e-9 * m.time);
        let (mut inputs, mut outputs) = (Filter::new(self.filter, &first), Filter::new(self.filter, &y));
        let mut ideal = Ideal::begin(&first, &y);
        let mut motion: Motion = vec![(0.0, 0.0); x.len()];
        let (mut k1, mut k2, mut k3, mut k4) =
            (vec![0.0; x.len()], vec![0.0; x.len()], vec![0.0; x.len()], vec![0.0; x.len()]);
        let moved =
            |x: &[f64], k: &[f64], h: f64| -> Vec<f64> { x.iter().zip(k).map(|(a, b)| a + h * b).collect() };
        let mut time = 0.0;
        let mut steps = 0.0;
        for sample in 1..run.time.len() {
            let span = run.time[sample] - run.time[sample - 1];
            let count = (span / longest).ceil().max(1.0);
            let dt = span / count;
            let mut part = 0.0;
            while part < count - 0.5 {
                part += 1.0;
                let end = run.time[sample - 1] + part * dt;
                let pure = self.pure(run, end);
                let mut to = pure.clone();
                enter(&mut memories, &mut to, dt);
                let middle: Vec<f64> = from.iter().zip(&to).map(|(a, b)| 0.5 * (a + b)).collect();
                self.slope(&from, &x, time, &memories, &mut k1);
                self.slope(&middle, &moved(&x, &k1, dt / 2.0), time + dt / 2.0, &memories, &mut k2);
                self.slope(&middle, &moved(&x, &k2, dt / 2.0), time + dt / 2.0, &memories, &mut k3);
                self.slope(&to, &moved(&x, &k3, dt), end, &memories, &mut k4);
                for i in 0..x.len() {
                    x[i] += dt / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
                    motion[i].0 += x[i] * x[i];
                    motion[i].1 += k1[i] * k1[i];
                }
                steps += 1.0;
                from = to;
                time = end;
                let y = leave(&mut memories, &from, &x, time, dt);
                inputs.follow(&pure, dt);
                outputs.follow(&y, dt);
            }
            ideal.record(&inputs.state, &outputs.state);
        }
        for (x, dx) in &mut motion {
            (*x, *dx) = ((*x / steps).sqrt(), (*dx / steps).sqrt());
        }
        (ideal, motion)
    }
}
