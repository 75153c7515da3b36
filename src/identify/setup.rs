//! A condition of a plan on a stand: what it holds, where the tire touches, and the responses that inputs bring about.

use super::plan::{Condition, Reach, Require, Touch};
use super::readings::Readings;
use super::registry::Functional;
use super::solve::Next;
use super::stand::Stand;
use crate::{Error, Result};
use nalgebra::{DMatrix, DVector};

/// Steps of the search for responses: by derivatives it takes a handful.
const MAX_STEPS: usize = 40;
/// A response is reached within this share of its size.
const REACHED: f64 = 1e-11;

/// Something that can be read from a stationary state.
pub(super) enum Reading {
    Output(usize),
    Functional { functional: Functional, outputs: Vec<usize>, inputs: Vec<usize> },
}

/// Values for the stand that a condition makes, one after the other.
pub(super) struct Setup<'a> {
    pub readings: &'a Readings<'a>,
    pub condition: &'a Condition,
    pub values: Vec<(usize, f64)>,
}

impl Setup<'_> {
    fn stand(&self) -> &Stand {
        self.readings.stand
    }

    fn get(&self, variable: usize) -> f64 {
        self.stand().value(&self.values, variable)
    }

    pub(super) fn set(&mut self, variable: usize, value: f64) {
        match self.values.iter_mut().rev().find(|(v, _)| *v == variable) {
            Some((_, old)) => *old = value,
            None => self.values.push((variable, value)),
        }
    }

    pub(super) fn read(&self, reading: &Reading) -> Result<f64> {
        match reading {
            Reading::Output(output) => Ok(self.stand().stationary(&self.values, &[*output])?[0]),
            Reading::Functional { functional, outputs, inputs } => {
                let outputs = self.stand().stationary(&self.values, outputs)?;
                let inputs: Vec<f64> = inputs.iter().map(|v| self.get(*v)).collect();
                Ok((functional.read)(&outputs, &inputs))
            }
        }
    }

    /// The last place at which the output still has the value of the lower end.
    pub(super) fn touch(&mut self, touch: &Touch, input: usize) -> Result<f64> {
        let output = self.stand().interface().find(&touch.output)?;
        let [mut low, mut high] = touch.between;
        let mut value = |x: f64| {
            self.set(input, x);
            self.stand().stationary(&self.values, &[output]).map(|v| v[0])
        };
        let free = value(low)?;
        let leaves = |value: f64| (value - free).abs() > touch.by;
        if !leaves(value(high)?) {
            return Err(Error::numeric(format!(
                "{} stays {free} up to {} = {high}",
                touch.output, touch.input
            )));
        }
        while high - low > 1e-13 * high.abs().max(low.abs()) {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if leaves(value(middle)?) { high = middle } else { low = middle }
        }
        Ok(low)
    }

    /// Outputs are where they have to be.
    pub(super) fn require(&self, wanted: &[Require]) -> Result<()> {
        if wanted.is_empty() {
            return Ok(());
        }
        let find = |required: &Require| self.stand().interface().find(&required.output);
        let outputs: Vec<usize> = wanted.iter().map(find).collect::<Result<_>>()?;
        for (required, value) in wanted.iter().zip(self.stand().stationary(&self.values, &outputs)?) {
            let [low, high] = required.between;
            if !(low..=high).contains(&value) {
                return Err(Error::numeric(format!(
                    "{} is {value:.6} and has to be {low} to {high}: {}",
                    required.output, required.why
                )));
            }
        }
        Ok(())
    }

    /// Brings responses about.
    pub(super) fn reach(&mut self, wanted: &[Reach]) -> Result<()> {
        let inner: Vec<&Reach> = wanted.iter().filter(|r| r.first_of == 0).collect();
        match wanted.iter().find(|r| r.first_of > 0) {
            None => self.reach_all(&inner),
            Some(first) => self.reach_first(first, &inner),
        }
    }

    /// All at once, within the ranges: by Newton's method with derivatives that the stand gives where it begins, and that
    /// steps improve (Broyden's update).
    fn reach_all(&mut self, wanted: &[&Reach]) -> Result<()> {
        if wanted.is_empty() {
            return Ok(());
        }
        let find = |reach: &&Reach| self.stand().interface().find(&reach.read);
        let outputs: Vec<usize> = wanted.iter().map(find).collect::<Result<_>>()?;
        let inputs: Vec<usize> =
            wanted.iter().map(|r| self.stand().settable(&r.by)).collect::<Result<_>>()?;
        let last = self.readings.reached.borrow().get(&self.condition.name).cloned();
        for (i, (reach, input)) in wanted.iter().zip(&inputs).enumerate() {
            let [low, high] = reach.between;
            let begin = last.as_ref().and_then(|l| l.get(i).copied()).unwrap_or_else(|| self.get(*input));
            self.set(*input, begin.clamp(low, high));
        }
        let size = |i: usize| wanted[i].value.abs().max(1.0);
        let excess_of = |values: &[f64]| DVector::from_fn(wanted.len(), |i, _| values[i] - wanted[i].value);
        let is_within = |excess: &DVector<f64>, share: f64| {
            (0..wanted.len()).all(|i| excess[i].abs() <= share * REACHED * size(i))
        };
        let (mut values, mut slopes) = self.stand().state(&self.values, &outputs, &inputs)?;
        let mut excess = excess_of(&values);
        // a response to one input is monotone: it is met on one side of where it was asked
        let mut brackets: Vec<[f64; 2]> = wanted.iter().map(|r| r.between).collect();
        for _ in 0..MAX_STEPS {
            if is_within(&excess, 1.0) {
                let at = inputs.iter().map(|input| self.get(*input)).collect();
                self.readings.reached.borrow_mut().insert(self.condition.name.clone(), at);
                return Ok(());
            }
            if wanted.len() == 1 {
                let end = usize::from((excess[0] > 0.0) == (slopes[0] > 0.0));
                brackets[0][end] = self.get(inputs[0]);
            }
            let step = slopes.clone().lu().solve(&excess);
            let mut moved = DVector::zeros(inputs.len());
            for (i, input) in inputs.iter().enumerate() {
                let at = self.get(*input);
                let [low, high] = brackets[i];
                // where the derivative leads out of the range, or there is none, half of the way to its end
                let next = match step.as_ref().map_or(f64::NAN, |s| at - s[i]) {
                    x if x > low && x < high => x,
                    x if x <= low => 0.5 * (at + low),
                    x if x >= high => 0.5 * (at + high),
                    _ => 0.5 * (low + high),
                };
                moved[i] = next - at;
                self.set(*input, next);
            }
            if (0..inputs.len())
                .all(|i| moved[i].abs() <= 1e-15 * (wanted[i].between[1] - wanted[i].between[0]))
            {
                break;
            }
            values = self.stand().stationary(&self.values, &outputs)?;
            let next = excess_of(&values);
            let surprise = &next - &excess - &slopes * &moved;
            slopes += surprise * moved.transpose() / moved.norm_squared();
            excess = next;
        }
        // what rounding leaves of a state that is searched itself
        if is_within(&excess, 1e4) { Ok(()) } else { Err(self.not_reached(wanted, &values)) }
    }

    fn not_reached(&self, wanted: &[&Reach], values: &[f64]) -> Error {
        let each = wanted.iter().zip(values).map(|(r, v)| {
            let [low, high] = r.between;
            format!("{} = {} by {} between {low} and {high} (it gets to {v:.6})", r.read, r.value, r.by)
        });
        Error::numeric(format!("this is not reached: {}", each.collect::<Vec<_>>().join(", ")))
    }

    /// The first place from the lower end on, with the others reached at each.
    fn reach_first(&mut self, first: &Reach, others: &[&Reach]) -> Result<()> {
        let reading = self.readings.reading(&first.read)?;
        let input = self.stand().settable(&first.by)?;
        let mut value = |x: f64| {
            self.set(input, x);
            self.reach_all(others)?;
            Ok::<f64, Error>(self.read(&reading)? - first.value)
        };
        let [low, high] = first.between;
        let place = |k: usize| low + (high - low) * k as f64 / first.first_of as f64;
        let (mut ends, mut values) = ([low, low], [value(low)?; 2]);
        let found = (1..=first.first_of).find_map(|k| {
            let x = place(k);
            match value(x) {
                Ok(v) if v * values[0] <= 0.0 => Some(Ok((x, v))),
                Ok(v) => {
                    (ends[0], values[0]) = (x, v);
                    None
                }
                Err(e) => Some(Err(e)),
            }
        });
        let Some(found) = found else {
            return Err(Error::numeric(format!(
                "{} does not become {} for {} between {low} and {high}",
                first.read, first.value, first.by
            )));
        };
        (ends[1], values[1]) = found?;
        let mut next = Next::new(ends[1] - ends[0], 1e-13 * (high - low));
        let sign = values[1].signum();
        while ends[1] - ends[0] > next.width && values.iter().all(|v| *v != 0.0) {
            let x = next.between(ends, [Some(sign * values[0]), Some(sign * values[1])]);
            if x <= ends[0] || x >= ends[1] {
                break;
            }
            let v = value(x)?;
            let end = usize::from(v * sign > 0.0);
            (ends[end], values[end]) = (x, v);
        }
        let best = if values[0].abs() <= values[1].abs() { ends[0] } else { ends[1] };
        value(best).map(|_| ())
    }

    /// The slope of an output along an input, with all responses kept by their inputs.
    pub(super) fn slope(&self, output: usize, along: usize, kept: &[Reach]) -> Result<f64> {
        let find = |reach: &Reach| self.stand().interface().find(&reach.read);
        let held: Vec<usize> = kept.iter().map(find).collect::<Result<_>>()?;
        let by: Vec<usize> = kept.iter().map(|r| self.stand().settable(&r.by)).collect::<Result<_>>()?;
        let outputs = [held, vec![output]].concat();
        let inputs = [by, vec![along]].concat();
        let (_, slopes): (_, DMatrix<f64>) = self.stand().state(&self.values, &outputs, &inputs)?;
        let n = kept.len();
        let own = slopes[(n, n)];
        if n == 0 {
            return Ok(own);
        }
        let by_kept = slopes.view((0, 0), (n, n)).clone_owned();
        let moved = by_kept.lu().solve(&slopes.view((0, n), (n, 1)).clone_owned());
        let moved =
            moved.ok_or_else(|| Error::numeric("the inputs that keep responses do not act on them"))?;
        Ok(own - (0..n).map(|k| slopes[(n, k)] * moved[k]).sum::<f64>())
    }
}
