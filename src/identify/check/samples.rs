//! Where targets are tested.

use crate::identify::solve::Targets;
use crate::stats::SplitMix64;
use crate::{Error, Result};
use serde::Serialize;

/// How much is tried.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Sampling {
    /// Draws of what is held fixed: known parameters and those of other groups. Fewer, if at fewer of ten times as many draws as
    /// are asked for all targets can be computed.
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

/// So many times as many draws are tried, at most, to find points at which all can be computed.
const MORE: usize = 10;

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
    /// Draws all parameters, to see over which ranges the targets go; more of them, if at too few all can be computed.
    ///
    /// # Errors
    /// There is no such point.
    pub fn new(targets: &'a dyn Targets, sampling: Sampling) -> Result<Self> {
        let mut random = SplitMix64::new(sampling.seed ^ 0x5153);
        let rows = targets.bounds().len();
        let mut ends: Vec<Option<[f64; 2]>> = Vec::new();
        let (mut bases, mut failure, mut computed) = (Vec::new(), None, [0, 0]);
        let asked = sampling.constants * sampling.draws;
        while computed[0] < asked || (bases.len() < sampling.constants && computed[0] < MORE * asked) {
            computed[0] += 1;
            let point = draw(targets.bounds(), &mut random);
            match values(targets, &point, rows, &mut ends) {
                Ok(()) => {
                    computed[1] += 1;
                    if bases.len() < sampling.constants {
                        bases.push(point);
                    }
                }
                Err(error) => failure = Some(error),
            }
        }
        let size = |ends: &Option<[f64; 2]>| match ends {
            Some([low, high]) if high > low => high - low,
            Some([low, _]) => low.abs().max(f64::MIN_POSITIVE),
            None => 1.0,
        };
        match failure {
            Some(error) if bases.is_empty() => {
                Err(error.at("the targets cannot be computed anywhere in the box"))
            }
            None if bases.is_empty() => Err(Error::call("no draws to test targets at")),
            _ => Ok(Self { targets, sampling, sizes: ends.iter().map(size).collect(), bases, computed }),
        }
    }
}

/// Widens the ranges of the targets by what they are at a point. What can be computed counts where others cannot.
fn values(targets: &dyn Targets, point: &[f64], rows: usize, ends: &mut Vec<Option<[f64; 2]>>) -> Result<()> {
    let all = targets.at(point);
    let each: Vec<Result<Vec<f64>>> = match &all {
        Ok(values) => values.iter().map(|v| Ok(vec![*v])).collect(),
        Err(_) => (0..rows).map(|row| targets.some(point, &[row])).collect(),
    };
    ends.resize(each.len().max(ends.len()), None);
    for (ends, value) in ends.iter_mut().zip(&each) {
        if let Ok([value]) = value.as_deref() {
            let [low, high] = ends.unwrap_or([*value; 2]);
            *ends = Some([low.min(*value), high.max(*value)]);
        }
    }
    all.map(|_| ())
}
