//! Derivatives of residuals: by differences to one side or to both, and updated from what a step has done.

use super::least_squares::{Problem, Unknown};
use nalgebra::{DMatrix, DVector};

/// Columns of the Jacobian from the given one on, by differences.
pub(super) fn differentiate(
    problem: &dyn Problem,
    unknowns: &[Unknown],
    x: &[f64],
    residuals: &[f64],
    jacobian: &mut DMatrix<f64>,
    from: usize,
) {
    let step = |i: usize| unknowns[i].step_at(x[i]);
    let moved = |i: usize| {
        let mut point = x.to_vec();
        point[i] += step(i);
        point
    };
    let points: Vec<Vec<f64>> = (from..x.len()).map(moved).collect();
    for (i, answer) in (from..x.len()).zip(problem.changes(x, residuals, &points)) {
        // where the model cannot be run the unknown stays
        let Some(answer) = answer else {
            jacobian.column_mut(i).fill(0.0);
            continue;
        };
        for (k, change) in answer.iter().enumerate() {
            jacobian[(k, i)] = change / step(i);
        }
    }
}

/// The Jacobian by differences to both sides, or to one where the other is beyond a bound or cannot be run.
pub(super) fn differentiate_centrally(
    problem: &dyn Problem,
    unknowns: &[Unknown],
    x: &[f64],
    residuals: &[f64],
    jacobian: &mut DMatrix<f64>,
) {
    let sides = |i: usize| {
        let step = unknowns[i].step_at(x[i]);
        [step, -step].map(|s| (x[i] + s).clamp(unknowns[i].low, unknowns[i].high) - x[i])
    };
    let points: Vec<Vec<f64>> = (0..x.len())
        .flat_map(|i| {
            sides(i).map(|step| {
                let mut point = x.to_vec();
                point[i] += step;
                point
            })
        })
        .collect();
    let answers = problem.changes(x, residuals, &points);
    let stays = vec![0.0; residuals.len()];
    for (i, pair) in answers.chunks(2).enumerate() {
        // where the model cannot be run the unknown stays
        let known = |k: usize| pair[k].as_deref().map_or((0.0, &stays[..]), |change| (sides(i)[k], change));
        let [(ahead, above), (behind, below)] = [known(0), known(1)];
        let slope = |(a, b): (&f64, &f64)| if ahead == behind { 0.0 } else { (a - b) / (ahead - behind) };
        let column: Vec<f64> = above.iter().zip(below).map(slope).collect();
        jacobian.set_column(i, &DVector::from_vec(column));
    }
}

/// Broyden's update: the least change of the Jacobian that gives what the step has done, where the steps
/// of differences measure the unknowns.
pub(super) fn broyden(
    jacobian: &mut DMatrix<f64>,
    unknowns: &[Unknown],
    step: &[f64],
    before: &[f64],
    after: &[f64],
) {
    let direction: Vec<f64> = step.iter().zip(unknowns).map(|(s, u)| s * u.step.powi(2)).collect();
    let length: f64 = direction.iter().zip(step).map(|(d, s)| d * s).sum();
    if length.is_nan() || length <= 0.0 {
        return;
    }
    let predicted = &*jacobian * DVector::from_column_slice(step);
    for (k, (a, b)) in after.iter().zip(before).enumerate() {
        let missed = (a - b - predicted[k]) / length;
        for (i, d) in direction.iter().enumerate() {
            jacobian[(k, i)] += missed * d;
        }
    }
}
