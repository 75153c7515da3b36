//! The friction factor of a road.

use super::random::{beginning, uniform_at};
use crate::clone_in_place;
use serde::{Deserialize, Serialize};

/// Patches on the left and on the right of the middle, times a variation along the road.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Friction {
    left: Patches,
    /// None: as on the left.
    right: Option<Patches>,
    variation: Option<Variation>,
    /// None: as on the left.
    variation_right: Option<Variation>,
}

clone_in_place!(Friction { left, right, variation, variation_right });

impl Friction {
    pub(super) fn new(
        [left, right]: [Option<Patches>; 2],
        [variation, variation_right]: [Option<Variation>; 2],
    ) -> Self {
        Self { left: left.unwrap_or_default(), right, variation, variation_right }
    }

    /// The mean over a window of `length` \[m\] along the road about `s`, at `t` across it.
    pub(super) fn mean(&self, s: f64, t: f64, length: f64) -> f64 {
        let patches = match &self.right {
            Some(right) if t < 0.0 => right,
            _ => &self.left,
        };
        let variation = match &self.variation_right {
            Some(right) if t < 0.0 => Some(right),
            _ => self.variation.as_ref(),
        };
        match variation {
            None => patches.mean(s, length, |_, _| 1.0),
            Some(variation) => patches.mean(s, length, |from, to| variation.mean(from, to)),
        }
    }

    /// The correlation length \[m\] of what varies at random.
    pub(super) fn correlation_length(&self) -> Option<f64> {
        self.variation.as_ref().map(|variation| variation.spacing / SPACING)
    }

    /// True if [`new`](Self::new) can have made it.
    pub(super) fn is_whole(&self) -> bool {
        self.left.is_whole()
            && self.right.as_ref().is_none_or(Patches::is_whole)
            && [&self.variation, &self.variation_right].into_iter().flatten().all(Variation::is_whole)
    }
}

/// A factor that changes in steps: 1 before the first.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Patches {
    steps: Vec<Step>,
}

/// From `at` \[m\] on the factor is `factor`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Step {
    at: f64,
    factor: f64,
}

clone_in_place!(Patches { steps });

impl Patches {
    /// The factor with steps at places that increase.
    pub(super) fn new(steps: &[[f64; 2]]) -> Self {
        Self { steps: steps.iter().map(|&[at, factor]| Step { at, factor }).collect() }
    }

    /// The mean over a window of `length` \[m\] about `s`, of the factor times what has the mean `varied` between
    /// two places.
    #[inline]
    fn mean(&self, s: f64, length: f64, varied: impl Fn(f64, f64) -> f64) -> f64 {
        let (begin, end) = (s - 0.5 * length, s + 0.5 * length);
        let passed = self.steps.partition_point(|step| step.at <= begin);
        let mut factor = match passed {
            0 => 1.0,
            n => self.steps[n - 1].factor,
        };
        let (mut mean, mut from) = (0.0, begin);
        for step in self.steps[passed..].iter().take_while(|step| step.at < end) {
            mean += factor * (step.at - from) * varied(from, step.at);
            (factor, from) = (step.factor, step.at);
        }
        if from == begin {
            // exact where no step is in the window
            factor * varied(begin, end)
        } else {
            (mean + factor * (end - from) * varied(from, end)) / length
        }
    }

    fn is_whole(&self) -> bool {
        self.steps.iter().all(|step| step.at.is_finite() && step.factor.is_finite() && step.factor >= 0.0)
            && self.steps.windows(2).all(|pair| pair[0].at < pair[1].at)
    }
}

/// A factor of mean 1 that varies along a road without end: straight lines between independent values at
/// nodes of equal distance D.
///
/// The values have a uniform distribution in 1 ± a, and where the nodes lie is as random as the values, so
/// no place is special. The correlation at the lag x D is that of the lines' hat function with itself:
/// 1 - 3/2 x² + 3/4 x³ up to x = 1, (2 - x)³ / 4 up to 2, 0 beyond. Its integral is 3/4 D: the correlation
/// length. The variance is 2/3 of the values', which is a² / 3, so a = sqrt(9/2) standard deviations.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Variation {
    /// a, at most 1: then no factor is negative.
    amplitude: f64,
    /// D \[m\].
    spacing: f64,
    /// Of the numbers at the nodes.
    beginning: u64,
    /// Where node 0 lies, in units of D before the place 0.
    offset: f64,
}

/// Distance of the nodes over the correlation length.
const SPACING: f64 = 4.0 / 3.0;

/// The largest standard deviation, for which factors reach down to 0: sqrt(2) / 3.
pub(super) const LARGEST_DEVIATION: f64 = std::f64::consts::SQRT_2 / 3.0;

impl Variation {
    /// The variation of a standard deviation up to [`LARGEST_DEVIATION`]; every `seed` gives another one.
    pub(super) fn new(deviation: f64, correlation_length: f64, seed: i32) -> Self {
        let beginning = beginning(seed);
        Self {
            amplitude: (deviation / LARGEST_DEVIATION).min(1.0),
            spacing: SPACING * correlation_length,
            beginning,
            // no place on a road has this index
            offset: uniform_at(beginning, i64::MIN),
        }
    }

    /// The mean from `from` to `to` \[m\].
    fn mean(&self, from: f64, to: f64) -> f64 {
        let (from, to) = (from / self.spacing + self.offset, to / self.spacing + self.offset);
        let mut cell = from.floor();
        let (mut here, mut next) = (self.node(cell), self.node(cell + 1.0));
        // that of a straight line is its value in the middle
        let middle = |from: f64, to: f64, cell: f64, here: f64, next: f64| {
            here + (0.5 * (from + to) - cell) * (next - here)
        };
        let (mut sum, mut begin) = (0.0, from);
        // false as well where places are so far away that neighbouring cells are the same number
        while cell + 1.0 < to && cell + 1.0 > cell {
            sum += (cell + 1.0 - begin) * middle(begin, cell + 1.0, cell, here, next);
            cell += 1.0;
            begin = cell;
            (here, next) = (next, self.node(cell + 1.0));
        }
        let last = middle(begin, to, cell, here, next);
        let mean = if begin == from { last } else { (sum + (to - begin) * last) / (to - from) };
        // rounding must not make it negative
        (1.0 + self.amplitude * mean).max(0.0)
    }

    /// The number of a node, -1 to 1.
    fn node(&self, index: f64) -> f64 {
        2.0 * uniform_at(self.beginning, index as i64) - 1.0
    }

    fn is_whole(&self) -> bool {
        (0.0..=1.0).contains(&self.amplitude)
            && self.spacing.is_finite()
            && self.spacing > 0.0
            && (0.0..1.0).contains(&self.offset)
    }
}
