//! Values that a file or a data sheet gives and that are not right: a weight that was changed on the rig and not in the file looks like
//! parameters at the ends of their ranges, like an effect, or like something without a name.

use super::given::DATA;
use super::numbers::{LEVEL, MIN_GAIN, MOSTLY};
use super::refit::{FINAL, FIRST};
use super::rest::{Rest, differences};
use super::study::{Fitted, Model, Study};
use super::subject::{FreeParameter, Subject};
use crate::Result;
use crate::fit::{Problem, side_by_side};
use crate::page::number;
use crate::shown::with_unit;
use crate::stats::sign_flip;
use nalgebra::{DMatrix, DVector};

/// Values that are fitted with the parameters at most, one at a time; those of which derivatives promise most. A tire's file has hundreds.
const MOST: usize = 12;
/// The step of differences by a value, as a share of it: they only rank, so that one is enough that stands out from rounding in every model.
const STEP: f64 = 0.01;

/// A value that may be off.
pub(super) struct OffData {
    /// What it is, and what is given.
    pub parameter: FreeParameter,
    /// What it came to, and its 95 % interval.
    value: f64,
    ends: [f64; 2],
    /// What the model then leaves of the check runs.
    rest: Rest,
}

impl OffData {
    /// What is said of it beside something else that explains as much.
    pub fn words(&self, subject: &Subject) -> String {
        let info = &subject.interface.variables[self.parameter.variable];
        let unit = info.unit.as_deref().unwrap_or("1");
        let is_off = is_off(&info.name, self.parameter.nominal, (self.value, self.ends), unit);
        format!("Or the given {is_off}: fitted in place of that, it explains as much. Measure it.")
    }
}

/// What is said of a value that is fitted because it was found to be off: `weight_mass is off, not 523 kg but 450 (440 to 460) kg`.
pub(super) fn in_words(fitted: &super::result::Fitted) -> String {
    let ends = [fitted.low, fitted.high].map(|end| end.unwrap_or(f64::NAN));
    is_off(&fitted.name, fitted.start, (fitted.value, ends), &fitted.unit)
}

fn is_off(name: &str, given: f64, (value, [low, high]): (f64, [f64; 2]), unit: &str) -> String {
    let [given, value, low, high] = [given, value, low, high].map(number);
    let value = format!("{value} ({low} to {high})");
    format!("{name} is off, not {} but {}", with_unit(given, unit), with_unit(value, unit))
}

/// The values that explain as much as a fitted model with all that was found, the best first: with one of them fitted in place of that, what
/// is left of the check runs is no more but for chance, no parameter ends at a bound, and the given value is not in the interval. Where no
/// parameter of the model is at a bound, it takes away the better half of what all that was found does, or, where nothing was, more than
/// chance makes.
///
/// # Errors
/// A model that cannot be run.
pub(super) fn off_data(
    study: &Study<'_>,
    subject: &Subject,
    current: &Fitted,
    (base, check): (&Rest, &Rest),
) -> Result<Vec<OffData>> {
    let is_held = current.fit.held_by_bounds(&current.unknowns).iter().any(|k| *k < study.free.len());
    let has_effects = !current.model.effects.is_empty();
    let given: Vec<FreeParameter> = subject
        .left_out
        .iter()
        .filter(|l| l.why == DATA)
        .filter_map(|l| subject.may_be(l.variable))
        .collect();
    let promising = if given.len() > MOST { promising(study, current, given)? } else { given };
    let fitted = side_by_side(study.bench.threads(), &promising, |p| explained_by(study, p).ok().flatten());
    let level = LEVEL / promising.len().max(1) as f64;
    let explains = |off: &OffData| {
        let units = off.rest.by_channel();
        let blocks = |rest: &Rest| rest.in_units(&units);
        let is_as_good = sign_flip(&differences(&blocks(&off.rest), &blocks(check))) > LEVEL;
        let gained = |rest: &Rest| base.total - rest.total;
        let is_worth_it = gained(&off.rest) > (MOSTLY * gained(check)).max(MIN_GAIN * base.total);
        let by_chance = || sign_flip(&differences(&blocks(base), &blocks(&off.rest))) >= level;
        is_as_good && (is_held || is_worth_it && (has_effects || !by_chance()))
    };
    let mut off: Vec<OffData> = fitted.into_iter().flatten().flatten().filter(explains).collect();
    off.sort_by(|a, b| a.rest.total.total_cmp(&b.rest.total));
    Ok(off)
}

/// What comes of a fit of the model's own parameters and this value, if this becomes another and no parameter ends at a bound.
fn explained_by(study: &Study<'_>, given: &FreeParameter) -> Result<Option<OffData>> {
    let mut other = study.clone();
    other.free.push(given.clone());
    let fitted = other.fit_nominal(FIRST, None)?;
    let fitted = other.settled(other.fit_on(&fitted, FINAL)?);
    let own = other.free.len();
    if fitted.fit.held_by_bounds(&fitted.unknowns).iter().any(|k| *k < own) {
        return Ok(None);
    }
    let x = fitted.model.parameters[own - 1];
    let [a, b] = other.covariance(&fitted).interval(own - 1, x).map(|end| end * given.scale);
    let ends = [a.min(b), a.max(b)];
    if (ends[0]..=ends[1]).contains(&given.nominal) {
        return Ok(None);
    }
    let rest = other.rest(&fitted.model, &other.check_runs)?;
    Ok(Some(OffData { parameter: given.clone(), value: x * given.scale, ends, rest }))
}

/// Those values that promise most: whose derivatives, as far as they are not those of what is fitted already, lie most along what is left.
fn promising(study: &Study<'_>, current: &Fitted, given: Vec<FreeParameter>) -> Result<Vec<FreeParameter>> {
    let mut other = study.clone();
    other.free.extend(given.iter().cloned());
    let (first, end) = (study.free.len(), other.free.len());
    let mut parameters = current.model.parameters.clone();
    parameters.splice(first..first, given.iter().map(|p| p.nominal / p.scale));
    // what was found is what a value may explain in its place
    let own = study.own();
    let model = Model { parameters, effects: Vec::new() };
    let problem = other.problem(&model, other.fit_runs.clone());
    let from = Study::point(&model);
    let Some(here) = problem.residuals(std::slice::from_ref(&from)).pop().flatten() else {
        return Ok(Vec::new());
    };
    let moved = |k: usize| {
        let mut point = from.clone();
        point[k] *= 1.0 + STEP;
        point
    };
    let points: Vec<Vec<f64>> = (first..end).map(moved).collect();
    // and so is what a parameter at a bound would do
    let is_fitted = |k: &usize| !current.fit.held_by_bounds(&current.unknowns).contains(k);
    let fitted: Vec<usize> = (0..own).filter(is_fitted).collect();
    let basis = orthonormal(&current.fit.jacobian.select_columns(&fitted));
    let left = DVector::from_column_slice(&here);
    let promise = |change: Option<Vec<f64>>| {
        let Some(change) = change else { return 0.0 };
        let mut change = DVector::from_vec(change);
        let size = change.norm();
        change -= &basis * basis.tr_mul(&change);
        // what rounding leaves of a change that parameters make as well is none
        if change.norm() > 1e-6 * size { (change.dot(&left) / change.norm()).powi(2) } else { 0.0 }
    };
    let changes = problem.changes(&from, &here, &points);
    let mut promised: Vec<(f64, FreeParameter)> = changes.into_iter().map(promise).zip(given).collect();
    promised.retain(|(promise, _)| *promise > 0.0);
    promised.sort_by(|a, b| b.0.total_cmp(&a.0));
    Ok(promised.into_iter().take(MOST).map(|(_, p)| p).collect())
}

/// Directions of length one, at right angles to each other, that span the columns of a matrix.
fn orthonormal(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let columns: Vec<DVector<f64>> =
        matrix.column_iter().filter_map(|c| c.into_owned().try_normalize(f64::MIN_POSITIVE)).collect();
    match columns.is_empty() {
        true => DMatrix::zeros(matrix.nrows(), 0),
        false => DMatrix::from_columns(&columns).qr().q(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::study::Closeness;
    use crate::diagnose::{refit::refit, weights::first_weights};
    use crate::fit::{Bench, Channel, Drive, Run, Setup};
    use crate::model::Settings;
    use crate::stats::SplitMix64;
    use std::sync::Arc;

    /// What is found to be off, with the ends of its interval, of a tire on a drum with cleats, if this value is another on the rig.
    fn found(other: Option<(&str, f64)>) -> Vec<(String, [f64; 2])> {
        let subject = Subject::load("linear-drum", &Settings::default()).unwrap();
        let bench = Bench::new(&subject.factory, &subject.fixed, 2).unwrap();
        let find = |name: &str| subject.interface.index(name).unwrap();
        let values = other.iter().map(|(name, value)| (find(name), *value)).collect();
        let setup = Arc::new(Setup { values, ..Setup::default() });
        let watch: Arc<[usize]> = ["arm_displacement", "arm_acceleration_1"].map(find).into();
        let mut random = SplitMix64::new(5);
        let mut run = |speed: f64| {
            let points = 401;
            let drive =
                Arc::new(Drive::new(0.0, 5e-3, points, vec![(find("drum_speed"), vec![speed; points])]));
            let traces =
                bench.run(&[Arc::clone(&setup)], &[Arc::clone(&drive)], &watch).pop().unwrap().unwrap();
            let channels =
                watch.iter().zip(traces).zip([1e-5, 0.05]).map(|((variable, trace), noise)| Channel {
                    variable: *variable,
                    values: trace.into_iter().map(|v| v + noise * random.normal()).collect(),
                    counts: false,
                    unresolved: Vec::new(),
                });
            let channels = channels.collect();
            let time = (0..points).map(|k| drive.time(k)).collect();
            Run { name: speed.to_string(), drive, time, channels }
        };
        let (to_fit, to_check) = ([2.0, 3.0].map(&mut run), [1.8, 2.5, 3.2].map(&mut run));
        // of a stiffness that is fitted too, motions alone tell only how it is to the masses
        let free = find("vertical_damping");
        let mut study = Study {
            bench: &bench,
            fit_runs: to_fit.iter().collect(),
            check_runs: to_check.iter().collect(),
            values: vec![(find("step_size"), 4e-4)],
            of_changes: None,
            closeness: Closeness::Precisely,
            free: subject.free.iter().filter(|p| p.variable == free).cloned().collect(),
            lag: 0.0,
            zeros: Vec::new(),
            weights: first_weights(&to_fit.each_ref()),
            redundancy: 1.0,
        };
        let current = refit(&mut study, None).unwrap();
        let check = study.rest(&current.model, &study.check_runs).unwrap();
        let off = off_data(&study, &subject, &current, (&check, &check)).unwrap();
        let named =
            |off: OffData| (subject.interface.variables[off.parameter.variable].name.clone(), off.ends);
        off.into_iter().map(named).collect()
    }

    #[test]
    fn a_weight_that_was_changed_on_the_rig_only_is_found() {
        assert_eq!(found(None), []);
        // where it sits is as good
        let named = |name: &str, found: &[(String, [f64; 2])]| {
            found.iter().find(|(n, _)| n == name).map(|(_, ends)| *ends)
        };
        let [low, high] = named("weight_mass", &found(Some(("weight_mass", 450.0)))).unwrap();
        assert!(low < 450.0 && high > 450.0 && high < 523.27 && high - low < 90.0, "{low} {high}");
        // and so is an accelerometer that sits elsewhere
        let [low, high] = named("sensor_1_distance", &found(Some(("sensor_1_distance", 1.1)))).unwrap();
        assert!(low < 1.1 && high > 1.1 && low > 1.0, "{low} {high}");
    }
}
