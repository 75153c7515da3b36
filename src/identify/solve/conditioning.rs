//! What the targets are known to, in terms of the parameters.

use super::outcome::{Solution, Unsolved};
use super::targets::Targets;
use crate::Error;

/// An interval of half of this share of a parameter's range to each side fixes nothing.
const OPEN: f64 = 0.5;

/// Half widths of the parameters' intervals around a solution, from those of the targets, which do not depend on each other: to
/// first order, by the derivatives of the parameters by the targets.
///
/// # Errors
/// A parameter is open over its whole range: the targets are met, and say nothing of it. Targets that cannot be computed nearby.
pub fn intervals(
    targets: &dyn Targets,
    solution: &Solution,
    of_targets: &[f64],
) -> Result<Vec<f64>, Unsolved> {
    let n = solution.parameters.len();
    if of_targets.len() != n {
        return Err(Unsolved::Failed(Error::call(format!("{} intervals of {n} targets", of_targets.len()))));
    }
    let jacobian = targets.jacobian(&solution.parameters)?;
    let open = |parameter: usize, interval: f64| Unsolved::IllConditioned {
        parameter,
        interval,
        at: solution.parameters.clone(),
    };
    let Some(inverse) = jacobian.clone().try_inverse() else {
        // the one that the targets react to least
        let range = |k: usize| targets.bounds()[k][1] - targets.bounds()[k][0];
        let reaction = |k: &usize| jacobian.column(*k).norm() * range(*k);
        let least = (0..n).min_by(|a, b| reaction(a).total_cmp(&reaction(b))).unwrap_or(0);
        return Err(open(least, f64::INFINITY));
    };
    (0..n)
        .map(|k| {
            let square = |(i, half): (usize, &f64)| (inverse[(k, i)] * half).powi(2);
            let interval = of_targets.iter().enumerate().map(square).sum::<f64>().sqrt();
            let [low, high] = targets.bounds()[k];
            if interval < OPEN * (high - low) { Ok(interval) } else { Err(open(k, interval)) }
        })
        .collect()
}
