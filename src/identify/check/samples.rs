//! Where targets are tested.

use crate::identify::solve::Targets;
use crate::stats::SplitMix64;
use crate::{Error, Result};

/// How much is tried.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampling {
    /// Draws of what is held fixed: known parameters and those of other groups. Fewer, if at fewer of all draws the targets can
    /// be computed.
    pub constants: usize,
    /// Draws of the parameters that are looked at, for each of these.
    pub draws: usize,
    /// Of the random numbers.
    pub seed: u64,
    /// A change of a target by less than this share of its range over all draws is none: what solvers leave.
    pub tolerance: f64,
}

impl Default for Sampling {
    fn default() -> Self {
        Self { constants: 5, draws: 20, seed: 1, tolerance: 1e-9 }
    }
}

/// A point of the box; every fourth draw is one of its corners, where conditions are violated first.
pub(super) fn draw(bounds: &[[f64; 2]], random: &mut SplitMix64) -> Vec<f64> {
    let corner = random.below(4) == 0;
    let within = |[low, high]: &[f64; 2]| {
        let share = random.uniform();
        let share = if corner { share.round() } else { share };
        low + share * (high - low)
    };
    bounds.iter().map(within).collect()
}

/// Targets, and what counts as 1 of each: its range over draws of all parameters.
pub struct Sampled<'a> {
    pub(super) targets: &'a dyn Targets,
    pub(super) sampling: Sampling,
    pub(super) sizes: Vec<f64>,
    /// Points at which all can be computed, around which the others are drawn.
    pub(super) bases: Vec<Vec<f64>>,
    /// How many draws there were, and at how many of them the targets could be computed.
    pub computed: [usize; 2],
}

impl<'a> Sampled<'a> {
    /// Draws all parameters, to see over which ranges the targets go.
    ///
    /// # Errors
    /// They cannot be computed anywhere.
    pub fn new(targets: &'a dyn Targets, sampling: Sampling) -> Result<Self> {
        let mut random = SplitMix64::new(sampling.seed ^ 0x5153);
        let (mut ends, mut bases): (Option<Vec<[f64; 2]>>, _) = (None, Vec::new());
        let (mut failure, mut computed) = (None, [sampling.constants * sampling.draws, 0]);
        for _ in 0..computed[0] {
            let point = draw(targets.bounds(), &mut random);
            match targets.at(&point) {
                Ok(values) => {
                    computed[1] += 1;
                    let ends = ends.get_or_insert_with(|| values.iter().map(|v| [*v, *v]).collect());
                    for (end, value) in ends.iter_mut().zip(&values) {
                        *end = [end[0].min(*value), end[1].max(*value)];
                    }
                    if bases.len() < sampling.constants {
                        bases.push(point);
                    }
                }
                Err(error) => failure = Some(error),
            }
        }
        let size =
            |[low, high]: &[f64; 2]| if high > low { high - low } else { low.abs().max(f64::MIN_POSITIVE) };
        match (ends, failure) {
            (Some(ends), _) => {
                Ok(Self { targets, sampling, sizes: ends.iter().map(size).collect(), bases, computed })
            }
            (None, Some(error)) => Err(error.at("the targets cannot be computed anywhere in the box")),
            (None, None) => Err(Error::call("no draws to test targets at")),
        }
    }
}
