//! The friction factor along a road.

use crate::clone_in_place;
use serde::{Deserialize, Serialize};

/// A factor that changes in steps: 1 before the first.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Friction {
    steps: Vec<Step>,
}

/// From `at` \[m\] on the factor is `factor`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Step {
    at: f64,
    factor: f64,
}

clone_in_place!(Friction { steps });

impl Friction {
    /// The factor with steps at places that increase.
    pub(super) fn new(steps: &[[f64; 2]]) -> Self {
        Self { steps: steps.iter().map(|&[at, factor]| Step { at, factor }).collect() }
    }

    /// The mean over a window of `length` \[m\] about `s`.
    pub(super) fn at(&self, s: f64, length: f64) -> f64 {
        let (begin, end) = (s - 0.5 * length, s + 0.5 * length);
        let passed = self.steps.partition_point(|step| step.at <= begin);
        let mut factor = match passed {
            0 => 1.0,
            n => self.steps[n - 1].factor,
        };
        let (mut mean, mut from) = (0.0, begin);
        for step in self.steps[passed..].iter().take_while(|step| step.at < end) {
            mean += factor * (step.at - from);
            (factor, from) = (step.factor, step.at);
        }
        // exact where no step is in the window
        if from == begin { factor } else { (mean + factor * (end - from)) / length }
    }

    /// True if [`new`](Self::new) can have made it.
    pub(super) fn is_whole(&self) -> bool {
        self.steps.iter().all(|step| step.at.is_finite() && step.factor.is_finite() && step.factor >= 0.0)
            && self.steps.windows(2).all(|pair| pair[0].at < pair[1].at)
    }
}
