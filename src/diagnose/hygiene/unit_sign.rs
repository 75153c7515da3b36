//! Wrong signs and wrong units: gains that are -1 or a ratio of units.

use super::against::Table;
use super::align::{Fit, Pair};
use super::{Fault, FaultKind, Severity, run_name, short};
use crate::model::unit::Unit;
use crate::stats::{deviation, mean, median, spread};

/// Ratios of units: how many of the recorded unit make one of the named unit, and what that would be.
/// Each is looked for upside down, too. The last entry has the quantities that are recorded in these units;
/// empty: any.
const FACTORS: [(f64, &str, &[&str]); 17] = [
    (1e6, "a factor of a million, such as MPa and Pa", &[]),
    (1e5, "bar and Pa", &["Pa"]),
    (6894.757, "psi and Pa", &["Pa"]),
    (1000.0, "a factor of thousand, such as kN and N, m and mm, s and ms", &[]),
    (100.0, "a factor of hundred, such as % and 1, m and cm", &[]),
    (180.0 / std::f64::consts::PI, "degrees and radians", &["rad", "rad/s", "rad/s2"]),
    (25.4, "inches and millimetres", &["m"]),
    (1.0 / 0.0254, "inches and metres", &["m"]),
    (10.0, "a factor of ten, such as daN and N, bar and MPa", &[]),
    (9.80665, "kgf and N, or g and m/s2", &["N", "N.m", "m/s2"]),
    (60.0 / std::f64::consts::TAU, "rpm and rad/s", &["rad/s"]),
    (std::f64::consts::TAU, "Hz and rad/s", &["rad/s"]),
    (4.448222, "lbf and N", &["N"]),
    (3.6, "km/h and m/s, or km/h per second and m/s2", &["m/s", "m/s2"]),
    (1.0 / 0.3048, "feet and metres", &["m", "m/s"]),
    (1.0 / 0.44704, "mph and m/s", &["m/s"]),
    (1.0 / 0.45359237, "pounds and kilograms", &["kg"]),
];
/// Factors beyond this (or below its inverse) are far from what model errors do.
const FAR: f64 = 8.0;
/// Relative tolerance of a far factor: parameters are wrong by 15 % or so, but nothing is near.
const FAR_TOLERANCE: f64 = 0.25;
/// Of the others: their neighbours are 10 % apart, a refitted model is better than that.
const NEAR_TOLERANCE: f64 = 0.07;
/// What may be left of the channel's deviation once a far or near factor is taken out.
const FAR_LEFT: f64 = 0.7;
const NEAR_LEFT: f64 = 0.35;
/// A near factor in all runs: the gains may scatter by this much. Physics that changes a gain twofold
/// changes it with conditions; a unit does not.
const NEAR_SCATTER: f64 = 0.05;
/// With its factor taken out a run may be this much worse than those that are right.
const AS_OTHERS: f64 = 2.0;
/// Gains beyond this are more than parameters in their bounds and a sensor's own gain make, if so many runs have
/// the same.
const STRANGE: f64 = 2.0;
const STRANGE_RUNS: usize = 3;
/// What may be left with the sign reversed.
const SIGN_LEFT: f64 = 0.6;
/// And at most this share of the best that a delay does without reversing. A sine is as well delayed by
/// half a period (a resonance passed), so it does not tell signs.
const SIGN_BETTER: f64 = 0.6;

/// A channel rests at a level if it moves by less than this share of it, measured and simulated; and the level tells a unit if it is not
/// smaller than this share of what it is in the runs that are right: beside zero any ratio is met.
const RESTS: f64 = 0.1;
/// Runs whose level is as simulated, at least, and by how much it may differ there: as parameters do.
const RIGHT_LEVELS: usize = 2;
const LEVEL_TOLERANCE: f64 = 0.25;

/// Finds reversed signs and units, and takes them out of `table`.
pub fn units_and_signs(table: &mut Table) -> Vec<Fault> {
    let mut faults = Vec::new();
    for channel in 0..table.channels.len() {
        faults.extend(signs(table, channel));
        faults.extend(units(table, channel));
    }
    reversed_input(table, &mut faults);
    faults
}

/// All sensors of a machine that are reversed in the same runs are an input that is: one cause, not many.
fn reversed_input(table: &Table, faults: &mut Vec<Fault>) {
    let compared =
        (0..table.channels.len()).filter(|c| table.pairs[*c].iter().flatten().next().is_some()).count();
    let signs: Vec<&Fault> = faults.iter().filter(|f| f.kind == FaultKind::WrongSign).collect();
    let Some(first) = signs.first().copied().cloned() else { return };
    if compared < 2 || signs.len() < compared || signs.iter().any(|f| f.runs != first.runs) {
        return;
    }
    let is_input = |name: &String| !table.channels.contains(name);
    let names = table.measured.first().map_or(&[][..], |r| &r.channels[..]).iter().map(|c| &c.name);
    let inputs: Vec<&str> = names.filter(|name| is_input(name)).map(String::as_str).collect();
    faults.retain(|f| f.kind != FaultKind::WrongSign);
    faults.push(Fault {
        channel: if let [only] = inputs[..] { Some(only.into()) } else { None },
        evidence: format!(
            "In {} run(s) all {compared} measured outputs go against the simulation: an input is reversed, not {compared} sensors.",
            first.runs.len()
        ),
        advice: format!(
            "Check the sign convention of {}, and reverse what is wrong in these runs.",
            inputs.join(", ")
        ),
        ..first
    });
}

fn signs(table: &mut Table, channel: usize) -> Option<Fault> {
    let mut hits = Vec::new();
    // sines, which a delay of half a period explains as well
    let mut open = Vec::new();
    let mut looked_at = 0;
    for pair in table.pairs[channel].iter().flatten() {
        looked_at += 1;
        let (size, end) = (pair.size(), pair.time.len());
        let Some(reversed) = pair.best_in(0, end, pair.reach().min(pair.period() / 8.0), -1.0) else {
            continue;
        };
        let (m, s, moves) = (mean(&pair.measured), mean(pair.simulated), deviation(pair.simulated));
        // a mean that is there and reversed, too, tells a sine's sign
        let mean_flips = s.abs() > 0.3 * moves && (-3.0..-0.33).contains(&(m / (s * reversed.gain.abs())));
        let mean_stays = s.abs() > moves && m * s > 0.0;
        if reversed.error > SIGN_LEFT * size || mean_stays {
            continue;
        }
        let upright = pair.best().map_or(size, |fit| fit.error);
        if reversed.error < SIGN_BETTER * upright || mean_flips {
            hits.push((pair.run, reversed));
        } else {
            open.push((pair.run, reversed));
        }
    }
    // they go with the others, if nearly all of those are reversed
    if hits.len() + open.len() == looked_at && !hits.is_empty() {
        hits.append(&mut open);
        hits.sort_by_key(|h| h.0);
    }
    if hits.is_empty() {
        return None;
    }
    for (run, _) in &hits {
        if let Some(pair) = &mut table.pairs[channel][*run] {
            pair.measured.iter_mut().for_each(|v| *v = -*v);
        }
    }
    let gain = median(&hits.iter().map(|h| h.1.gain).collect::<Vec<_>>());
    let name = &table.channels[channel];
    Some(Fault {
        kind: FaultKind::WrongSign,
        severity: Severity::Fatal,
        runs: hits.iter().map(|h| run_name(&table.measured[h.0].source)).collect(),
        channel: Some(name.clone()),
        span: None,
        value: gain,
        unit: "1".into(),
        evidence: format!(
            "In {} of {looked_at} run(s) measured {name} goes against the simulation, with a gain of {}; no \
             delay explains that.",
            hits.len(),
            short(gain)
        ),
        advice: format!(
            "Check the sensor's direction and the sign convention, and reverse {name} in these runs."
        ),
    })
}

/// Runs and their gains.
type Runs = Vec<(usize, f64)>;

fn units(table: &mut Table, channel: usize) -> Vec<Fault> {
    let unit = table.unit(channel).to_owned();
    let fits: Vec<(usize, Fit, f64)> = table.pairs[channel]
        .iter()
        .flatten()
        .filter_map(|pair| Some((pair.run, pair.best()?, pair.size())))
        .filter(|(_, fit, size)| fit.error < FAR_LEFT * size)
        .collect();
    if fits.is_empty() {
        return wrong_units(table, channel, &unit, levels(table, channel, &unit));
    }
    let gains: Vec<f64> = fits.iter().map(|f| f.1.gain).collect();
    // the runs that are right say what the model's own gain error is
    let right: Vec<f64> = gains.iter().copied().filter(|g| (0.6..1.67).contains(g)).collect();
    let usual = if right.is_empty() { 1.0 } else { median(&right) };
    // a unit is one factor for all of a run, and the runs that are right show how much gains scatter by themselves: where they
    // do, a near factor may be physics that acts in some runs more than in others
    let scatter = |gains: &[f64]| spread(&gains.iter().map(|g| g.ln()).collect::<Vec<_>>());
    let steady = scatter(&gains) < NEAR_SCATTER;
    let others_are_right = 2 * right.len() > gains.len() && scatter(&right) < NEAR_SCATTER;
    // what gains scatter by that are not far; where all are, they show it themselves
    let not_far: Vec<f64> = gains.iter().copied().filter(|g| !is_far(g / usual)).collect();
    let scatters = scatter(if not_far.is_empty() { &gains } else { &not_far });
    let is_right = |(_, fit, _): &&(usize, Fit, f64)| (0.6..1.67).contains(&fit.gain);
    let left_in_right = |of: fn(&(usize, Fit, f64)) -> f64| {
        median(&fits.iter().filter(is_right).map(of).collect::<Vec<f64>>())
    };
    // and leaves no more of it than of the others, of what it measures or in the unit of the model
    let as_others = |fit: &Fit, size: f64| {
        right.is_empty()
            || fit.error / size < AS_OTHERS * left_in_right(|(_, fit, size)| fit.error / size)
            || fit.error / fit.gain.abs() < AS_OTHERS * left_in_right(|(_, fit, _)| fit.error / fit.gain)
    };
    let mut by_factor: Vec<(f64, &str, Runs)> = Vec::new();
    for (run, fit, size) in &fits {
        let Some((factor, what)) = factor(fit.gain / usual, &unit) else { continue };
        let far = is_far(factor);
        // one run alone has nothing to be steady with, nor has it others that are mostly right. What is far from anything that a
        // model errs by is no more than another error of a model whose other gains scatter as much
        let trusted = if far {
            scatters < FAR_TOLERANCE && as_others(fit, *size)
        } else {
            fit.error < NEAR_LEFT * size
                && ((others_are_right && as_others(fit, *size)) || (steady && fits.len() > 1))
        };
        let pair = table.pairs[channel].iter().flatten().find(|pair| pair.run == *run);
        if !trusted || !pair.is_some_and(|pair| mean_agrees(&pair.measured, pair.simulated, factor)) {
            continue;
        }
        match by_factor.iter_mut().find(|f| f.0 == factor) {
            Some(entry) => entry.2.push((*run, fit.gain)),
            None => by_factor.push((factor, what, vec![(*run, fit.gain)])),
        }
    }
    let all = median(&gains);
    if by_factor.is_empty() && no_model_error(table, channel, &fits, &gains) {
        by_factor.push((
            all,
            "no usual units, so the calibration may be wrong",
            fits.iter().map(|f| (f.0, f.1.gain)).collect(),
        ));
    }
    if by_factor.is_empty() {
        by_factor = levels(table, channel, &unit);
    }
    wrong_units(table, channel, &unit, by_factor)
}

/// Runs in which a channel rests at a level that is a ratio of units far from the simulated one, where it is as simulated in most others:
/// no physics makes that of a run. What rests has no gain.
fn levels(table: &Table, channel: usize, unit: &str) -> Vec<(f64, &'static str, Runs)> {
    let level = |pair: &Pair| {
        let (m, s) = (mean(&pair.measured), mean(pair.simulated));
        let rests =
            deviation(&pair.measured) < RESTS * m.abs() && deviation(pair.simulated) < RESTS * s.abs();
        rests.then_some((pair.run, m / s, s.abs()))
    };
    let all: Vec<(usize, f64, f64)> = table.pairs[channel].iter().flatten().filter_map(level).collect();
    let is_right = |(_, ratio, _): &&(usize, f64, f64)| (ratio - 1.0).abs() < LEVEL_TOLERANCE;
    let right: Vec<_> = all.iter().filter(is_right).collect();
    if right.len() < RIGHT_LEVELS || 2 * right.len() <= all.len() {
        return Vec::new();
    }
    let of_right = |value: fn(&(usize, f64, f64)) -> f64| {
        median(&right.iter().map(|level| value(level)).collect::<Vec<f64>>())
    };
    let (usual, size) = (of_right(|level| level.1), of_right(|level| level.2));
    let mut by_factor: Vec<(f64, &str, Runs)> = Vec::new();
    for (run, ratio, own) in all {
        let Some((factor, what)) = factor(ratio / usual, unit) else { continue };
        if own < RESTS * size || !is_far(factor) || (ratio / usual / factor).ln().abs() > NEAR_TOLERANCE {
            continue;
        }
        match by_factor.iter_mut().find(|f| f.0 == factor) {
            Some(entry) => entry.2.push((run, ratio)),
            None => by_factor.push((factor, what, vec![(run, ratio)])),
        }
    }
    by_factor
}

/// The faults, whose factors are taken out of `table`.
fn wrong_units(
    table: &mut Table,
    channel: usize,
    unit: &str,
    by_factor: Vec<(f64, &'static str, Runs)>,
) -> Vec<Fault> {
    let name = table.channels[channel].clone();
    let looked_at = table.pairs[channel].iter().flatten().count();
    let mut faults = Vec::new();
    for (factor, what, hits) in by_factor {
        for (run, _) in &hits {
            if let Some(pair) = &mut table.pairs[channel][*run] {
                pair.measured.iter_mut().for_each(|v| *v /= factor);
            }
        }
        let gain = median(&hits.iter().map(|h| h.1).collect::<Vec<_>>());
        faults.push(Fault {
            kind: FaultKind::WrongUnit,
            severity: Severity::Fatal,
            runs: hits.iter().map(|h| run_name(&table.measured[h.0].source)).collect(),
            channel: Some(name.clone()),
            span: None,
            value: factor,
            unit: "1".into(),
            evidence: format!(
                "In {} of {looked_at} run(s) measured {name} is {} times the simulated one; {} is the ratio of {what}.",
                hits.len(),
                short(gain),
                short(factor)
            ),
            advice: format!(
                "Check the unit of {name}, which the header calls [{unit}], and divide it by {} in these runs.",
                short(factor)
            ),
        });
    }
    faults
}

/// Whether gains that are no ratio of units are so far from 1, and so much the same in all runs, that neither
/// parameters nor physics make them.
fn no_model_error(table: &Table, channel: usize, fits: &[(usize, Fit, f64)], gains: &[f64]) -> bool {
    let all = median(gains);
    let within = |tolerance: f64| gains.iter().all(|g| *g > 0.0 && (g / all).ln().abs() < tolerance);
    let alike = if is_far(all) {
        within(FAR_TOLERANCE)
    } else {
        all.max(1.0 / all) > STRANGE
            && fits.len() >= STRANGE_RUNS
            && within(2.0 * NEAR_SCATTER)
            && fits.iter().all(|(_, fit, size)| fit.error < NEAR_LEFT * size)
    };
    let agrees = |pair: &Pair| mean_agrees(&pair.measured, pair.simulated, all);
    // what does not move in a run says nothing of a gain
    let has_gain = |pair: &&Pair| fits.iter().any(|(run, ..)| *run == pair.run);
    alike && table.pairs[channel].iter().flatten().filter(has_gain).all(agrees)
}

/// A unit scales the mean as well, where there is one; friction and the like do not.
pub fn mean_agrees(measured: &[f64], simulated: &[f64], factor: f64) -> bool {
    let (m, s) = (mean(measured), mean(simulated));
    s.abs() < 2.0 * deviation(simulated) || ((m / s / factor).abs().ln().abs() < 0.5 && m * s > 0.0)
}

fn is_far(factor: f64) -> bool {
    factor.max(1.0 / factor) > FAR
}

/// The ratio of units that is nearest to a gain, if one is near enough.
/// Only those of the quantity that the header's unit names.
fn factor(gain: f64, unit: &str) -> Option<(f64, &'static str)> {
    if !(gain > 0.0 && gain.is_finite()) {
        return None;
    }
    let away = |factor: f64| (gain / factor).ln().abs();
    let dimension = |text: &str| Unit::parse(text).ok().map(|u| u.exponents);
    let own = dimension(unit);
    let possible =
        |of: &[&str]| of.is_empty() || own.is_none() || of.iter().any(|text| dimension(text) == own);
    FACTORS
        .iter()
        .filter(|(_, _, of)| possible(of))
        .flat_map(|(factor, what, _)| [(*factor, *what), (1.0 / factor, *what)])
        .min_by(|a, b| away(a.0).total_cmp(&away(b.0)))
        .filter(|(factor, _)| {
            let tolerance = if is_far(*factor) { FAR_TOLERANCE } else { NEAR_TOLERANCE };
            away(*factor) < tolerance
        })
}
