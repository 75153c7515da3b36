//! What is known from an earlier round of a search: how a machine answers to small changes at its places, which the effects
//! found since hardly change, and what is natural for it. Only what promises most is simulated anew.

use super::placement::Placement;
use crate::effect::{Port, Signal};
use nalgebra::DVector;
use std::collections::{BTreeSet, HashMap};
use std::ptr;

/// Typical sizes of a machine's signals, and its own time.
#[derive(Debug, Clone)]
pub(super) struct Natural {
    /// Of every variable.
    pub size: Vec<f64>,
    /// Of the rate and integral of every variable.
    pub rate: Vec<(f64, f64)>,
    /// The machine's own time \[s\].
    pub time: f64,
    /// Forces, and the motions that count against the way in which these push.
    pub against: BTreeSet<(usize, usize)>,
    /// Positions and velocities of which the machine shows both.
    pub shown: BTreeSet<usize>,
}

#[cfg(test)]
impl Natural {
    /// Of so many variables that are all of size 1, as all that goes with them.
    pub fn of_ones(count: usize) -> Self {
        Self {
            size: vec![1.0; count],
            rate: vec![(1.0, 1.0); count],
            time: 1.0,
            against: BTreeSet::new(),
            shown: BTreeSet::new(),
        }
    }
}

/// One change: an effect of this form and size at this place.
#[derive(Debug, PartialEq, Eq, Hash)]
struct Change {
    effect: usize,
    port: Port,
    targets: Vec<usize>,
    drivers: Vec<Signal>,
    amplitude: Option<usize>,
    parameters: Vec<u64>,
}

impl Change {
    fn of(placement: &Placement, shape: &[f64], amplitude: Option<usize>) -> Self {
        Self {
            // forms of an effect share its name
            effect: ptr::from_ref(placement.effect).addr(),
            port: placement.port,
            targets: placement.targets.clone(),
            drivers: placement.drivers.clone(),
            amplitude,
            parameters: shape.iter().zip(&placement.scales).map(|(s, scale)| (s * scale).to_bits()).collect(),
        }
    }
}

/// What is known. Nothing at first.
#[derive(Debug, Default)]
pub(super) struct Recalled {
    /// What is natural for the machine.
    pub natural: Option<Natural>,
    /// The runs that answers are known of, as numbers among the fit runs.
    pub runs: Vec<usize>,
    /// Every how many of their samples count.
    pub stride: usize,
    /// What the channels were weighed with.
    weights: Vec<f64>,
    answers: HashMap<Change, Vec<DVector<f64>>>,
}

impl Recalled {
    /// Forgets all answers; those of these runs follow.
    pub fn begin(&mut self, runs: Vec<usize>, stride: usize, weights: &[f64]) {
        (self.runs, self.stride, self.weights) = (runs, stride, weights.to_vec());
        self.answers.clear();
    }

    /// Keeps the weighted answers of the runs to a change.
    pub fn keep(
        &mut self,
        placement: &Placement,
        shape: &[f64],
        amplitude: Option<usize>,
        answer: &[DVector<f64>],
    ) {
        self.answers.insert(Change::of(placement, shape, amplitude), answer.to_vec());
    }

    /// The answers to a change with other weights, if they are known. Each run has `samples` of each channel, one channel
    /// behind the other.
    pub fn answer(
        &self,
        placement: &Placement,
        shape: &[f64],
        amplitude: Option<usize>,
        samples: &[usize],
        weights: &[f64],
    ) -> Option<Vec<DVector<f64>>> {
        let mut answer = self.answers.get(&Change::of(placement, shape, amplitude))?.clone();
        for (run, samples) in answer.iter_mut().zip(samples) {
            for (row, value) in run.iter_mut().enumerate() {
                let channel = row * self.stride / samples;
                let (new, old) = (weights.get(channel)?, self.weights.get(channel)?);
                *value *= new / old;
            }
        }
        Some(answer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::find;

    #[test]
    fn answers_come_again_with_the_weights_of_the_day_and_only_to_the_same_change() {
        let placement = |scale: f64| Placement {
            effect: find("sensor-gain").unwrap(),
            port: Port::Output,
            targets: vec![3],
            drivers: Vec::new(),
            scales: vec![scale],
            units: vec![None],
            bounded: false,
        };
        let mut recalled = Recalled::default();
        // every second sample of two channels with four samples each, weighed 1 and 2
        recalled.begin(vec![5], 2, &[1.0, 2.0]);
        let answer = [DVector::from_vec(vec![1.0, 2.0, 3.0, 4.0])];
        recalled.keep(&placement(1.0), &[0.0], Some(0), &answer);
        let again = |recalled: &Recalled, scale: f64, amplitude, weights: &[f64]| {
            recalled.answer(&placement(scale), &[0.0], amplitude, &[4], weights)
        };
        let weighed = again(&recalled, 1.0, Some(0), &[10.0, 1.0]).unwrap();
        assert_eq!(weighed[0].as_slice(), [10.0, 20.0, 1.5, 2.0]);
        assert!(again(&recalled, 1.0, None, &[1.0, 2.0]).is_none());
        // a shape at another size is another change
        recalled.keep(&placement(1.0), &[0.5], Some(0), &answer);
        assert!(recalled.answer(&placement(2.0), &[0.5], Some(0), &[4], &[1.0, 2.0]).is_none());
        recalled.begin(vec![5], 2, &[1.0, 2.0]);
        assert!(again(&recalled, 1.0, Some(0), &[1.0, 2.0]).is_none());
    }
}
