//! What a solver says: a solution that meets all targets, or why there is none.

use crate::Error;
use std::fmt;

/// Parameters that meet the targets. Where the targets are known to be injective, these are the only ones.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// The parameters.
    pub parameters: Vec<f64>,
    /// Largest scaled difference that is left.
    pub residual: f64,
    /// How often the targets were asked for.
    pub evaluations: usize,
}

/// A side of a range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Below its least value.
    Below,
    /// Above its largest value.
    Above,
}

/// Why a local method ends where the targets are not met. By Lemma 1 (appendix B.2) there is no other reason, if the target is
/// within reach and injective.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stall {
    /// The Jacobian is singular there.
    Singular,
    /// On the boundary, where the projected direction leads nowhere nearer.
    Boundary,
    /// No step along the direction comes nearer.
    NoDecrease,
    /// The iterations were used up.
    Iterations,
}

/// Why there is no solution.
#[derive(Debug, Clone, PartialEq)]
pub enum Unsolved {
    /// The targets cannot be met within the bounds: this parameter would have to be beyond.
    OutOfReach {
        /// The parameter.
        parameter: usize,
        /// On which side of its bounds it would have to be.
        side: Side,
        /// The nearest point that was met.
        nearest: Vec<f64>,
        /// Largest scaled difference there.
        residual: f64,
    },
    /// Two points at which the same targets are met to rounding: those from `target` on, with all parameters before it the same.
    /// If that is the first, this proves that there is no unique answer.
    NotUnique {
        /// The first of the targets that are the same.
        target: usize,
        /// The two points.
        witnesses: [Vec<f64>; 2],
    },
    /// Nothing tells on which side of a parameter to go on: what the targets say contradicts the signs in which they were
    /// promised to respond.
    Undecided {
        /// The parameter.
        parameter: usize,
        /// Where.
        at: Vec<f64>,
    },
    /// A local method came to rest away from the targets.
    Stalled {
        /// Where.
        at: Vec<f64>,
        /// Largest scaled difference there.
        residual: f64,
        /// Why.
        stall: Stall,
    },
    /// What a closed form gives does not meet the targets, and nothing near it does: the form is not that of this model, or the
    /// targets are not.
    Contradicted {
        /// What the closed form gives.
        given: Vec<f64>,
        /// The nearest point that was met from there.
        at: Vec<f64>,
        /// Largest scaled difference there.
        residual: f64,
    },
    /// The targets are met, but what they are known to leaves a parameter open over all its range.
    IllConditioned {
        /// The parameter.
        parameter: usize,
        /// Half of the interval that the targets' uncertainty leaves.
        interval: f64,
        /// Where they are met.
        at: Vec<f64>,
    },
    /// The targets could not be computed.
    Failed(Error),
}

impl Unsolved {
    /// The nearest point to the goal that was met, if there is one.
    pub fn nearest(&self) -> Option<&[f64]> {
        match self {
            Self::OutOfReach { nearest: at, .. }
            | Self::Undecided { at, .. }
            | Self::Stalled { at, .. }
            | Self::Contradicted { at, .. }
            | Self::IllConditioned { at, .. } => Some(at),
            Self::NotUnique { .. } | Self::Failed(_) => None,
        }
    }

    /// The same of a group, with numbers that count from the first parameter of all instead of its own first.
    #[must_use]
    pub(super) fn in_whole(mut self, first: usize) -> Self {
        match &mut self {
            Self::OutOfReach { parameter, .. }
            | Self::Undecided { parameter, .. }
            | Self::IllConditioned { parameter, .. } => *parameter += first,
            Self::NotUnique { target, .. } => *target += first,
            Self::Stalled { .. } | Self::Contradicted { .. } | Self::Failed(_) => {}
        }
        self
    }
}

impl From<Error> for Unsolved {
    fn from(error: Error) -> Self {
        Self::Failed(error)
    }
}

impl Unsolved {
    /// The sentence, with names of parameters and targets.
    pub fn words(&self, name: impl Fn(usize) -> String, target_name: impl Fn(usize) -> String) -> String {
        match self {
            Self::OutOfReach { parameter, side, nearest, residual } => {
                let side = match side {
                    Side::Below => "below its lower bound",
                    Side::Above => "above its upper bound",
                };
                format!(
                    "the targets cannot be met: {} would have to be {side}; at {nearest:?} they are still {residual:.2e} of their size away",
                    name(*parameter)
                )
            }
            Self::NotUnique { target, witnesses: [a, b] } if *target == 0 => {
                format!("there is no unique answer: {a:?} and {b:?} give the same targets")
            }
            Self::NotUnique { target, witnesses: [a, b] } => format!(
                "the target \"{}\" and later ones are the same at {a:?} and at {b:?}: they do not fix the parameters that they belong to",
                target_name(*target)
            ),
            Self::Undecided { parameter, at } => format!(
                "at {at:?} the targets say both that {} is too large and that it is too small: they do not respond with the signs that the search relies on",
                name(*parameter)
            ),
            Self::Stalled { at, residual, stall } => {
                let why = match stall {
                    Stall::Singular => "the Jacobian is singular there",
                    Stall::Boundary => "on the boundary no direction leads nearer",
                    Stall::NoDecrease => "no step leads nearer",
                    Stall::Iterations => "the iterations are used up",
                };
                format!(
                    "the search ends at {at:?}, {residual:.2e} of their size away from the targets: {why}"
                )
            }
            Self::Contradicted { given, at, residual } => format!(
                "the closed form gives {given:?}, which does not meet the targets; at {at:?} they are still {residual:.2e} of their size away"
            ),
            Self::IllConditioned { parameter, interval, at } => format!(
                "the targets do not fix {}: at {at:?} they are met, and what they are known to leaves it open by +-{interval:.2e}",
                name(*parameter)
            ),
            Self::Failed(error) => error.to_string(),
        }
    }
}

impl fmt::Display for Unsolved {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // people count from 1
        f.write_str(&self.words(|k| format!("parameter {}", k + 1), |k| format!("target {}", k + 1)))
    }
}
