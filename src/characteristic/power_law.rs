//! Powers of load and speed through points, and what has to be there for an exponent to mean anything.

use super::answer::Point;
use super::laws::{Known, linear, mean_of};
use super::plan::{DecayPlan, Plan};
use crate::Result;

/// Loads have to span this factor for an exponent of the load to mean anything: below it, 2 % of stiffness is 0.05 of exponent.
pub(super) const SPAN: f64 = 1.5;
/// A power law that misses its points by more than this (root mean square) is no law; then there is a table.
pub(super) const LAW_MISSES: f64 = 0.03;

/// The mean of points, as uncertain as they scatter and as the least certain of them; of unknown certainty where none says anything.
pub(super) fn mean_with_scatter(points: &[Point]) -> Known {
    let mean = mean_of(&points.iter().map(|p| p.value.value).collect::<Vec<_>>());
    let known = points.iter().map(|p| p.value.half_width).chain([mean.half_width]).filter(|w| w.is_finite());
    Known { half_width: known.reduce(f64::max).unwrap_or(f64::INFINITY), ..mean }
}

/// Points of the same load and speed made one.
pub(super) fn merged(points: Vec<Point>) -> Vec<Point> {
    let mut all: Vec<(Point, Vec<Known>)> = Vec::new();
    for point in points {
        // loads and speeds are set to a few percent
        let same = |p: &Point| {
            (p.load / point.load - 1.0).abs() < 0.02 && (p.speed - point.speed).abs() <= 0.03 * point.speed
        };
        match all.iter_mut().find(|(p, _)| same(p)) {
            Some((_, values)) => values.push(point.value),
            None => all.push((point, vec![point.value])),
        }
    }
    let one = |(point, values): (Point, Vec<Known>)| {
        let value = mean_of(&values.iter().map(|v| v.value).collect::<Vec<_>>());
        let own =
            (values.iter().map(|v| v.half_width * v.half_width).sum::<f64>()).sqrt() / values.len() as f64;
        let half_width = match values.len() {
            1 => values[0].half_width,
            _ => value.half_width.min(10.0 * own).max(own),
        };
        Point { value: Known { half_width, ..value }, ..point }
    };
    let mut merged: Vec<Point> = all.into_iter().map(one).collect();
    merged.sort_by(|a, b| a.load.total_cmp(&b.load).then(a.speed.total_cmp(&b.speed)));
    merged
}

pub(super) fn span(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, 0.0), |(low, high), v| (low.min(v), high.max(v)))
}

fn geometric_mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0.0), |(s, n), v| (s + v.ln(), n + 1.0));
    (sum / n).exp()
}

/// A power law through points, by logarithms: value at the references, exponents of load and speed where they are asked for, and what is
/// missed.
pub(super) fn power(
    points: &[Point],
    reference: [f64; 2],
    over: [bool; 2],
) -> Option<(Known, [Option<Known>; 2], f64)> {
    let mut columns = vec![vec![1.0; points.len()]];
    if over[0] {
        columns.push(points.iter().map(|p| (p.load / reference[0]).ln()).collect());
    }
    if over[1] {
        columns.push(points.iter().map(|p| (p.speed / reference[1]).ln()).collect());
    }
    let y: Vec<Known> =
        points.iter().map(|p| Known { value: p.value.value.ln(), half_width: p.value.share() }).collect();
    let found = linear(&columns, &y)?;
    let misses = (0..points.len())
        .map(|i| y[i].value - columns.iter().zip(&found).map(|(c, k)| c[i] * k.value).sum::<f64>())
        .map(|left| left * left)
        .sum::<f64>();
    let misses = (misses / points.len() as f64).sqrt();
    let value = found[0].value.exp();
    let mut rest = found[1..].iter().copied();
    let mut exponent = |is: bool| if is { rest.next() } else { None };
    let exponents = [exponent(over[0]), exponent(over[1])];
    Some((Known { value, half_width: value * found[0].half_width }, exponents, misses))
}

/// Where the constants of power laws hold: the plan's, or the middle of the decays' loads and speeds, or of the loops' loads. One pair for
/// both coefficients, as the tire has it.
pub(super) fn references(plan: &Plan, loads: &[f64]) -> Result<[f64; 2]> {
    let own =
        |of: &dyn Fn(&DecayPlan) -> Result<f64>| plan.decays.iter().map(of).collect::<Result<Vec<f64>>>();
    let middle = |values: &[f64]| {
        let positive = values.iter().copied().filter(|v| *v > 0.0);
        let middle = geometric_mean(positive);
        (middle.is_finite() && middle > 0.0).then_some(middle)
    };
    let wanted = &plan.characteristic;
    let load = match &wanted.reference_load {
        Some(given) => given.in_unit("reference_load", "N")?,
        // without anything, the tire's own
        None => middle(&own(&DecayPlan::load)?).or_else(|| middle(loads)).unwrap_or(6504.0),
    };
    let speed = match &wanted.reference_speed {
        Some(given) => given.in_unit("reference_speed", "m/s")?,
        None => middle(&own(&DecayPlan::speed)?).unwrap_or(2.0),
    };
    Ok([load, speed])
}
