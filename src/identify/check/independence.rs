//! Which target depends on which parameter.

use super::samples::{Sampled, draw};
use crate::stats::SplitMix64;
use nalgebra::DMatrix;
use serde::Serialize;

/// Two points that differ in parameters that should not count, and differ in a target: a proof that they count.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Dependence {
    /// The target.
    pub target: usize,
    /// The points.
    pub points: [Vec<f64>; 2],
    /// The difference of the target, as a share of its range.
    pub change: f64,
}

/// What a search for one found.
#[derive(Debug, Clone, PartialEq)]
pub struct Search {
    /// The largest dependence beyond the tolerance.
    pub dependence: Option<Dependence>,
    /// How many pairs of points were compared: without any, nothing was tested.
    pub compared: usize,
}

/// Looks for a dependence of targets on some parameters (s1_ind).
///
/// For analytic targets the lack of one is right with probability 1, up to rounding: what is not constant is constant nowhere
/// but on a set of measure zero. A target that reacts only in a small part of the box may be missed.
pub fn depends(sampled: &Sampled<'_>, rows: &[usize], on: &[usize]) -> Search {
    let Sampled { targets, sampling, ref sizes, ref bases, .. } = *sampled;
    let mut random = SplitMix64::new(sampling.seed);
    let mut found = Search { dependence: None, compared: 0 };
    for base in bases {
        let Ok(reference) = targets.some(base, rows) else { continue };
        for _ in 0..sampling.draws {
            let other = draw(targets.bounds(), &mut random);
            let mut moved = base.clone();
            for k in on {
                moved[*k] = other[*k];
            }
            let Ok(values) = targets.some(&moved, rows) else { continue };
            found.compared += 1;
            for (i, row) in rows.iter().enumerate() {
                let change = (values[i] - reference[i]).abs() / sizes[*row];
                let least = found.dependence.as_ref().map_or(sampling.tolerance, |d| d.change);
                if change > least {
                    let points = [base.clone(), moved.clone()];
                    found.dependence = Some(Dependence { target: *row, points, change });
                }
            }
        }
    }
    found
}

/// The influence matrix (3.21): by how much of its range each target (row) changes with each parameter (column) alone, at most;
/// 0 where that is within the tolerance, and no number where there were no two points to compare.
pub fn influence(sampled: &Sampled<'_>) -> DMatrix<f64> {
    let (rows, columns) = (sampled.sizes.len(), sampled.targets.bounds().len());
    let change = |row, k| match depends(sampled, &[row], &[k]) {
        Search { compared: 0, .. } => f64::NAN,
        Search { dependence, .. } => dependence.map_or(0.0, |d| d.change),
    };
    DMatrix::from_fn(rows, columns, change)
}
