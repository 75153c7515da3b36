//! The published benchmark (Kaden 2015, 4.2.10): 15 parameters from target values that a simulation made.

use super::registry::Numbers;
use super::ring_brush;
use super::solve::{Goal, Targets};
use super::{Plan, Readings, Stand};
use crate::model::{Native, Settings};
use crate::rig::RingBrushFlatTrack;
use crate::{Error, Result};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

/// A parameter of the published example.
struct Published {
    name: &'static str,
    symbol: &'static str,
    truth: f64,
    start: f64,
    identified: f64,
}

const fn published(
    name: &'static str,
    symbol: &'static str,
    truth: f64,
    start: f64,
    identified: f64,
) -> Published {
    Published { name, symbol, truth, start, identified }
}

/// True, start and identified values (l. 3704 to 3991).
const PARAMETERS: [Published; 15] = [
    published("vertical_stiffness", "c_r lin", 1.54e5, 4e5, 1.54e5),
    published("vertical_stiffness_quadratic", "c_r quad", 2.47e6, 5e6, 2.47e6),
    published("sidewall_radial_stiffness", "c_GF rad", 4.67e6, 3.47e6, 4.62e6),
    published("cross_section_radius", "R_quer", 0.675, 0.225, 0.667),
    published("bristle_stiffness", "c_scher", 4e4, 2.35e4, 4.02e4),
    published("sidewall_tilt_stiffness", "c_GF rot rad", 8e4, 1e5, 7.98e4),
    published("stripe_length_factor", "f_L mat", 0.75, 0.85, 0.75),
    published("patch_compliance_twist", "n_LKt", 1e-4, 5e-5, 1.01e-4),
    published("patch_compliance_y", "n_LKy", 8e-7, 9.97e-6, 8.11e-7),
    published("friction_sliding_zero", "mu_gleit 0bar", 1.1, 1.5, 1.1),
    published("friction_sliding_reference", "mu_gleit Delta p", 1.0, 1.45, 1.0),
    published("patch_compliance_x", "n_LKx", 3e-6, 9.12e-7, 3e-6),
    published("friction_static_zero", "mu_haft 0bar", 1.5, 1.6, 1.52),
    published("friction_static_reference", "mu_haft Delta p", 1.4, 1.55, 1.41),
    published("sidewall_lateral_stiffness", "c_GF quer", 8.5e4, 1e5, 8.54e4),
];

/// A target value as printed.
struct Printed {
    value: f64,
    /// It has so many significant digits.
    digits: i32,
    /// It differs from the limit of a continuum by no more than this share (an inference: the author's simulator has bristles of 14 mm
    /// that count as whole ones, and larger pressures than its formulas give).
    within: f64,
}

const fn printed(value: f64, digits: i32, within: f64) -> Printed {
    Printed { value, digits, within }
}

/// Target values of the source.
const TARGETS: [Printed; 15] = [
    printed(2736.0, 4, 0.003),
    printed(7877.0, 4, 0.003),
    printed(1.493e5, 4, 0.003),
    printed(1.58e5, 3, 0.12),
    printed(2.90e5, 3, 0.12),
    printed(7.98e4, 3, 0.01),
    printed(855.0, 3, 0.18),
    printed(-4290.0, 3, 0.04),
    printed(-1.19e5, 3, 0.04),
    printed(3090.0, 3, 0.07),
    printed(4970.0, 3, 0.07),
    printed(5040.0, 3, 0.09),
    printed(3400.0, 3, 0.09),
    printed(1850.0, 3, 0.09),
    printed(479.0, 3, 0.15),
];

/// What became of one parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Name in the model.
    pub name: &'static str,
    /// Symbol in the source.
    pub symbol: &'static str,
    /// Unit.
    pub unit: String,
    /// The value that made the targets.
    #[serde(rename = "true")]
    pub truth: f64,
    /// The value before it is found.
    pub start: f64,
    /// What the exact targets give,
    pub identified: f64,
    /// and how far that is from the truth, as a share of it.
    pub relative_error: f64,
    /// What the same targets give when they are rounded to the digits of the print.
    pub identified_rounded: f64,
    /// How far that is from the truth,
    pub relative_error_rounded: f64,
    /// and how far rounding alone can take any method, to first order.
    pub rounding_bound: f64,
    /// What the printed targets give, which another simulator made.
    pub identified_printed: f64,
    /// How far that is from the truth.
    pub relative_error_printed: f64,
    /// The error that the source publishes.
    pub published_relative_error: f64,
}

/// A target of the benchmark.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TargetRow {
    /// What it is.
    pub name: String,
    /// Its value for the true parameters.
    pub value: f64,
    /// The same with the digits of the print.
    pub rounded: f64,
    /// What is printed,
    pub printed: f64,
    /// and by which share of it the value may differ: bristles of 14 mm are no continuum.
    pub printed_tolerance: f64,
}

/// The benchmark's answer.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Benchmark {
    /// A row for each parameter.
    pub parameters: Vec<Row>,
    /// A row for each target.
    pub targets: Vec<TargetRow>,
    /// Largest scaled difference that the exact, the rounded and the printed targets are met with.
    pub residuals: [f64; 3],
    /// Groups that have no answer, and why: the nearest to their targets stands in its place, and what follows relies on it.
    pub refused: Vec<String>,
    /// How many stationary states and runs it took.
    pub starts: usize,
}

/// A value with so many significant digits.
fn rounded(value: f64, digits: i32) -> f64 {
    let unit = unit_of(value, digits);
    (value / unit).round() * unit
}

/// The unit of the last of so many significant digits.
fn unit_of(value: f64, digits: i32) -> f64 {
    10f64.powi(value.abs().log10().floor() as i32 + 1 - digits)
}

/// Identifies the published example from its exact, its rounded and its printed targets.
///
/// # Errors
/// The targets cannot be computed.
pub fn kaden() -> Result<Benchmark> {
    let plan = Plan::read(ring_brush::PLAN)?;
    let stand = Stand::new(Box::new(Native::<RingBrushFlatTrack>::new(&Settings::default())?), &[]);
    let numbers = |of: fn(&Published) -> f64| -> Numbers {
        PARAMETERS.iter().map(|p| (p.name.to_owned(), of(p))).collect()
    };
    let at_truth = Readings::new(&plan, &stand, ring_brush::REGISTRY, &numbers(|p| p.truth))?;
    let truth = at_truth.sought_values(&Numbers::new())?;
    let exact = at_truth.at(&truth)?;
    let bound = rounding_bound(&at_truth, &truth, &exact)?;
    let readings = Readings::new(&plan, &stand, ring_brush::REGISTRY, &numbers(|p| p.start))?;
    let mut refused = Vec::new();
    let mut identify = |what: &str, values: &[f64]| -> Result<(Vec<f64>, f64)> {
        let found = readings.identify(&Goal::new(values)).map_err(|why| Error::numeric(why.to_string()))?;
        for (number, why) in &found.unsolved {
            let (group, why) = (&plan.groups[*number].name, readings.words(why));
            refused.push(format!("{what} targets, group {} ({group}): {why}", number + 1));
        }
        let model = readings.model_values(&found.parameters)?;
        let each = PARAMETERS.iter().map(|p| model.get(p.name).copied().unwrap_or(f64::NAN));
        Ok((each.collect(), found.residuals.iter().fold(0.0, |a: f64, b| a.max(*b))))
    };
    let to_digits: Vec<f64> =
        exact.iter().zip(&TARGETS).map(|(v, target)| rounded(*v, target.digits)).collect();
    let printed: Vec<f64> = TARGETS.iter().map(|target| target.value).collect();
    let (found, residual) = identify("exact", &exact)?;
    let (from_rounded, residual_rounded) = identify("rounded", &to_digits)?;
    let (from_printed, residual_printed) = identify("printed", &printed)?;

    let error = |value: f64, truth: f64| value / truth - 1.0;
    let row = |(k, p): (usize, &Published)| {
        let unit = stand.interface().index(p.name).and_then(|v| stand.interface().variables[v].unit.clone());
        Row {
            name: p.name,
            symbol: p.symbol,
            unit: unit.unwrap_or_default(),
            truth: p.truth,
            start: p.start,
            identified: found[k],
            relative_error: error(found[k], p.truth),
            identified_rounded: from_rounded[k],
            relative_error_rounded: error(from_rounded[k], p.truth),
            rounding_bound: bound[k] / p.truth,
            identified_printed: from_printed[k],
            relative_error_printed: error(from_printed[k], p.truth),
            published_relative_error: error(p.identified, p.truth),
        }
    };
    let names = plan.groups.iter().flat_map(|g| &g.targets).map(|t| t.name.clone());
    let targets = names.zip(exact).zip(to_digits.iter().zip(&TARGETS));
    Ok(Benchmark {
        parameters: PARAMETERS.iter().enumerate().map(row).collect(),
        targets: targets
            .map(|((name, value), (rounded, printed))| {
                let (printed, printed_tolerance) = (printed.value, printed.within);
                TargetRow { name, value, rounded: *rounded, printed, printed_tolerance }
            })
            .collect(),
        residuals: [residual, residual_rounded, residual_printed],
        refused,
        starts: stand.starts(),
    })
}

/// By how much half a unit of the last printed digit in every target, each with the worst sign, moves each parameter: by the
/// derivatives of the parameters by the targets.
fn rounding_bound(readings: &Readings<'_>, truth: &[f64], targets: &[f64]) -> Result<Vec<f64>> {
    let jacobian: DMatrix<f64> = readings.triangular_jacobian(truth)?;
    let inverse =
        jacobian.try_inverse().ok_or_else(|| Error::numeric("the targets do not fix the parameters"))?;
    let values = |sought: &[f64]| -> Result<Vec<f64>> {
        let model = readings.model_values(sought)?;
        Ok(PARAMETERS.iter().map(|p| model.get(p.name).copied().unwrap_or(f64::NAN)).collect())
    };
    let base = values(truth)?;
    let mut bound = vec![0.0; PARAMETERS.len()];
    for (i, (target, Printed { digits, .. })) in targets.iter().zip(&TARGETS).enumerate() {
        // so small that it is linear
        let share = 1e-3;
        let moved: DVector<f64> = inverse.column(i) * (share * 0.5 * unit_of(*target, *digits));
        let at: Vec<f64> = truth.iter().zip(&moved).map(|(a, b)| a + b).collect();
        for (bound, (there, base)) in bound.iter_mut().zip(values(&at)?.iter().zip(&base)) {
            *bound += (there - base).abs() / share;
        }
    }
    Ok(bound)
}
