//! Recordings that look like what often goes wrong with them.

use super::estimate::{Estimate, Point};
use super::evidence::{Evidence, Read};
use super::matching::{Reading, Signals, Track};
use crate::identify::plan::Plan;
use crate::stats::{correlation, deviation};
use crate::{Error, Result};
use std::collections::{BTreeMap, BTreeSet};

/// What is recorded has something to do with what the model says if they are so coherent: parameters that are not known yet
/// change sizes, not shapes.
const COHERENT: f64 = 0.9;
/// A factor counts as a known mistake if it is within this factor of it: parameters make forces half or twice as large.
const NEAR: f64 = 2.5;
/// An output follows an input if it is so coherent with it.
const FOLLOWS: f64 = 0.5;

/// A slope that is so much of the model's, with the other sign, is no small one that scatters about 0.
const OPPOSITE: f64 = 0.3;
/// Names that a message has room for.
const LISTED: usize = 3;

/// What channels are often off by, and how that comes about.
const MISTAKES: [(f64, &str); 10] = [
    (-1.0, "the other sign"),
    (std::f64::consts::PI / 180.0, "degrees for radians"),
    (180.0 / std::f64::consts::PI, "radians for degrees"),
    (1e-3, "a unit that is a thousand times smaller, as mm for m"),
    (1e3, "a unit that is a thousand times larger, as kN for N"),
    (1e-2, "per cent for 1"),
    (1e2, "1 for per cent"),
    (1.0 / 3.6, "km/h for m/s"),
    (3.6, "m/s for km/h"),
    (9.80665, "kilograms for newtons"),
];

/// Whether the plan's conditions are met by recordings as they are. `readings` finds all in given recordings.
///
/// # Errors
/// A channel of an input that meets more conditions, and none less, with another sign or in another unit: which, and in which
/// recordings.
pub fn check_inputs<'a>(
    plan: &Plan,
    signals: &Signals,
    tracks: &[Track<'a>],
    readings: impl Fn(&[Track<'a>]) -> Vec<Reading>,
) -> Result<()> {
    let conditions: Vec<usize> =
        (0..plan.conditions.len()).filter(|k| !plan.conditions[*k].recorded.is_empty()).collect();
    let met = |tracks: &[Track<'a>]| {
        let readings = readings(tracks);
        let recordings_of = |number: &usize| {
            let condition = &plan.conditions[*number];
            let own = readings.iter().filter(|r| r.moved.is_some() == condition.ramp.is_some());
            let own = own.filter(|r| condition.is_met(r, signals).is_ok());
            let own: BTreeSet<usize> = own.map(|r| r.recording).collect();
            (!own.is_empty()).then_some((*number, own))
        };
        conditions.iter().filter_map(recordings_of).collect::<BTreeMap<_, _>>()
    };
    let as_it_is = met(tracks);
    if as_it_is.len() == conditions.len() {
        return Ok(());
    }
    let measured_by = signals.measured_by(plan);
    let mut best: Option<(usize, Error)> = None;
    for (input, (name, _)) in signals.inputs.iter().enumerate() {
        let both_ways =
            plan.conditions.iter().filter_map(|c| c.recorded.get(name)).any(|[l, h]| l + h == 0.0);
        for (factor, words) in MISTAKES {
            // what the plan asks for in both directions may have been driven in the other; the outputs tell its sign
            if both_ways && factor < 0.0 {
                continue;
            }
            let scaled: Vec<Track<'a>> = tracks.iter().map(|t| t.with_scaled(input, factor)).collect();
            let then = met(&scaled);
            let gained = then.len() - as_it_is.keys().filter(|k| then.contains_key(k)).count();
            let is_lost = as_it_is.keys().any(|k| !then.contains_key(k));
            if is_lost || gained == 0 || best.as_ref().is_some_and(|(most, _)| *most >= gained) {
                continue;
            }
            let new: Vec<_> = then.iter().filter(|(k, _)| !as_it_is.contains_key(k)).collect();
            let names: Vec<String> =
                new.iter().map(|(k, _)| format!("\"{}\"", plan.conditions[**k].name)).collect();
            let files: BTreeSet<&str> = (new.iter())
                .flat_map(|(_, own)| own.iter().map(|k| tracks[*k].recording.source.as_str()))
                .collect();
            let channel = measured_by[input].map_or(name, |output| &signals.outputs[output].0);
            best = Some((
                gained,
                Error::file(format!(
                    "channel \"{channel}\" in {}: as it is, nothing is recorded of {}; times {factor:.4} there is: it looks like {words}. \
                     Channels are in the model's axes (ISO 8855, H axes) and in the unit of their header",
                    listed(files),
                    listed(names)
                )),
            ));
        }
    }
    best.map_or(Ok(()), |(_, why)| Err(why))
}

/// Compares channels of the outputs with what the model says, `simulated` for each reading of `reads`.
///
/// # Errors
/// A channel has the other sign or is in another unit, as far as one can tell: which, and in which recordings.
pub fn check_outputs(evidence: &Evidence, reads: &[Read], simulated: &[Vec<Point>]) -> Result<()> {
    for (output, (name, _)) in evidence.signals.outputs.iter().enumerate() {
        let (mut own, mut model, mut files) = (Vec::new(), Vec::new(), BTreeSet::new());
        for (read, points) in reads.iter().zip(simulated) {
            for (k, point) in read.members.iter().zip(points) {
                let reading = &evidence.readings[*k];
                own.push(reading.point.outputs[output]);
                model.push(point.outputs[output]);
                files.insert(evidence.names[reading.recording].as_str());
            }
        }
        // about their means: a zero that is wrong is another matter
        let coherence = correlation(&own, &model);
        let factor = coherence * deviation(&own) / deviation(&model);
        if coherence.is_nan() || coherence.abs() < COHERENT {
            continue;
        }
        let is = |other: f64| (factor.abs() / other).ln().abs() < NEAR.ln();
        let guess = if is(1e-3) || is(1e3) {
            "a unit that is a thousand times another, as kN for N".to_owned()
        } else if factor < 0.0 {
            match followed(evidence, reads, simulated, output) {
                inputs if inputs.is_empty() => "the other sign".to_owned(),
                inputs => format!("the other sign, or that of {}", inputs.join(" or of ")),
            }
        } else {
            continue;
        };
        return Err(Error::file(format!(
            "channel \"{name}\" is {factor:.3} times what the model says, in {}: it looks like {guess}. Channels are in the model's axes \
             (ISO 8855, H axes) and in the unit of their header",
            listed(files)
        )));
    }
    slopes_have_the_sign_of_the_model(evidence, reads, simulated)
}

/// An output that answers to several inputs is coherent with the model, too, where only one of them has the other sign.
fn slopes_have_the_sign_of_the_model(
    evidence: &Evidence,
    reads: &[Read],
    simulated: &[Vec<Point>],
) -> Result<()> {
    for (read, points) in reads.iter().zip(simulated) {
        let Estimate::Slope { output, along, .. } = read.estimate else { continue };
        let (own, model) = (read.estimate.of(&evidence.points(read)), read.estimate.of(points));
        if own * model < 0.0 && own.abs() > OPPOSITE * model.abs() {
            return Err(Error::file(format!(
                "channel \"{}\" falls over \"{}\" where the model says that it rises, or the other way, in {}: {own:.3e} for {model:.3e}. It \
                 looks like the other sign of one of the two. Channels are in the model's axes (ISO 8855, H axes)",
                evidence.signals.outputs[output].0,
                evidence.signals.inputs[along].0,
                evidence.files(read)
            )));
        }
    }
    Ok(())
}

/// The first of several names, and how many more there are.
pub fn listed<T: AsRef<str>>(names: impl IntoIterator<Item = T>) -> String {
    let names: Vec<T> = names.into_iter().collect();
    let more = names.len().saturating_sub(LISTED);
    let first: Vec<&str> =
        names.iter().take(if more > 1 { LISTED } else { names.len() }).map(AsRef::as_ref).collect();
    let others = if more > 1 { format!(" and {more} others") } else { String::new() };
    first.join(", ") + &others
}

/// The inputs that an output of the model follows.
fn followed(evidence: &Evidence, reads: &[Read], simulated: &[Vec<Point>], output: usize) -> Vec<String> {
    let points: Vec<&Point> = reads.iter().zip(simulated).flat_map(|(_, points)| points).collect();
    let own: Vec<f64> = points.iter().map(|p| p.outputs[output]).collect();
    let inputs = evidence.signals.inputs.iter().enumerate();
    let follows = inputs.filter(|(k, _)| {
        let values: Vec<f64> = points.iter().map(|p| p.inputs[*k]).collect();
        correlation(&own, &values).abs() > FOLLOWS
    });
    follows.map(|(_, (name, _))| name.clone()).collect()
}
