//! The nearest point of the box to the goal: Levenberg and Marquardt's method on the unknowns that no bound holds.
//!
//! It ends where no direction within the box leads nearer. Any method that ends only there inherits what appendix B.10 proves
//! of the gradient method, in a hundredth of its steps.

use super::targets::Problem;
use crate::Result;
use nalgebra::{DMatrix, DVector};

/// The projected gradient counts as zero where it is by so much smaller than derivatives and distance make possible: what
/// differences of targets leave.
const STATIONARY: f64 = 1e-8;
/// From an end where the distance falls by less than this share in a step, nothing is to be gained.
const WORTH: f64 = 1e-13;
const MAX_STEPS: usize = 400;

/// Where a descent ended.
pub(in crate::identify) struct Nearest {
    pub at: Vec<f64>,
    /// By how much the targets exceed the goal there, scaled.
    pub excess: DVector<f64>,
    /// No direction leads nearer; otherwise the steps were used up.
    pub is_stationary: bool,
}

/// The nearest point to the goal of all parameters and targets, from `start`.
pub(in crate::identify) fn nearest(problem: &Problem<'_>, start: &[f64]) -> Result<Nearest> {
    let all: Vec<usize> = (0..problem.len()).collect();
    nearest_of(problem, &all, &all, start)
}

/// The nearest point of some `targets` as functions of some `parameters`, the others as in `start`.
pub(super) fn nearest_of(
    problem: &Problem<'_>,
    parameters: &[usize],
    targets: &[usize],
    start: &[f64],
) -> Result<Nearest> {
    let rows = |excess: DVector<f64>| excess.select_rows(targets);
    let ranges = DVector::from_iterator(parameters.len(), parameters.iter().map(|k| problem.range(*k)));
    let within = |(k, x): (usize, &f64)| x.clamp(problem.bounds(k)[0], problem.bounds(k)[1]);
    let mut at: Vec<f64> = start.iter().enumerate().map(within).collect();
    let mut excess = rows(problem.excess(&at)?);
    let mut damping = 1e-3;
    for _ in 0..MAX_STEPS {
        if excess.amax() <= problem.goal.tolerance {
            return Ok(Nearest { at, excess, is_stationary: true });
        }
        let mut jacobian = problem.jacobian(&at)?.select_rows(targets).select_columns(parameters);
        for (mut column, range) in jacobian.column_iter_mut().zip(&ranges) {
            column *= *range;
        }
        let gradient = jacobian.tr_mul(&excess);
        let is_held = |(i, k): (usize, &usize)| {
            let [low, high] = problem.bounds(*k);
            (at[*k] <= low && gradient[i] > 0.0) || (at[*k] >= high && gradient[i] < 0.0)
        };
        let free: Vec<usize> =
            parameters.iter().enumerate().filter(|p| !is_held(*p)).map(|(i, _)| i).collect();
        let slope = gradient.select_rows(&free);
        if free.is_empty() || slope.amax() <= STATIONARY * jacobian.norm() * excess.norm() {
            return Ok(Nearest { at, excess, is_stationary: true });
        }
        let columns = jacobian.select_columns(&free);
        let normal = columns.tr_mul(&columns);
        let most = normal.diagonal().amax();
        let cost = excess.norm_squared();
        let step = loop {
            let damped = &normal + DMatrix::identity(free.len(), free.len()) * (damping * most);
            let Some(direction) = damped.cholesky().map(|c| c.solve(&slope)) else {
                damping *= 8.0;
                continue;
            };
            let mut trial = at.clone();
            for (i, step) in free.iter().zip(&direction) {
                let k = parameters[*i];
                let [low, high] = problem.bounds(k);
                trial[k] = (trial[k] - step * ranges[*i]).clamp(low, high);
            }
            let next = rows(problem.excess(&trial)?);
            if next.norm_squared() < cost {
                damping = (damping / 6.0).max(1e-15);
                break Some((trial, next));
            }
            damping *= 6.0;
            if damping > 1e12 {
                break None;
            }
        };
        let Some((trial, next)) = step else { return Ok(Nearest { at, excess, is_stationary: true }) };
        let gained = cost - next.norm_squared();
        (at, excess) = (trial, next);
        if gained < WORTH * cost {
            return Ok(Nearest { at, excess, is_stationary: true });
        }
    }
    Ok(Nearest { at, excess, is_stationary: false })
}
