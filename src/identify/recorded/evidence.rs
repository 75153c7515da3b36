//! What recordings say of a plan's targets: readings that meet the conditions, and how each target is read from them.

use super::estimate::{Estimate, Number, Point};
use super::matching::{Reading, Signals, Track, nearest};
use super::suspicion;
use super::zeros::Zeros;
use crate::identify::plan::{Condition, Plan, Target};
use crate::identify::readings::Readings;
use crate::identify::registry::{Numbers, Registry};
use crate::model::Interface;
use crate::recording::Recording;
use crate::{Error, Result};
use std::collections::BTreeSet;

/// An input varies among readings if it does so by more than this share of what its condition allows.
const VARIES: f64 = 0.1;
/// A slope needs an input that varies by more than this share of that.
const TOLD: f64 = 0.25;
/// An output that moves by a smaller share of what the one that moves most does moves by rounding: forces that large were added up to
/// nothing.
const ROUNDING: f64 = 1e-12;
/// More readings than unknowns, at least: from their scatter the intervals come.
const REDUNDANT: usize = 2;

/// A target and its readings.
#[derive(Clone)]
pub struct Read {
    /// The target's name.
    pub name: String,
    /// Factor on the reading, as the plan has it.
    pub factor: f64,
    /// Number of its condition.
    pub condition: usize,
    /// How it is read,
    pub estimate: Estimate,
    /// and from which readings.
    pub members: Vec<usize>,
    /// The same, those together that were made at one place.
    pub visits: Vec<Vec<usize>>,
}

impl Read {
    /// Whether it is read while something moves.
    pub fn is_ramp(&self, evidence: &Evidence) -> bool {
        self.members.iter().any(|k| evidence.readings[*k].moved.is_some())
    }
}

/// Everything that was found in recordings.
pub struct Evidence {
    /// Names of the recordings.
    pub names: Vec<String>,
    /// The signals.
    pub signals: Signals,
    /// All readings, less the offsets of the outputs.
    pub readings: Vec<Reading>,
    /// Stretches in which the tire does not come to rest.
    restless: Vec<Reading>,
    /// The targets that can be read.
    pub targets: Vec<Read>,
    /// The others: number, and what is missing.
    pub missing: Vec<(usize, String)>,
    /// The range of each output over all recordings.
    pub ranges: Vec<f64>,
    /// Offsets that were taken off the outputs.
    pub zeros: Zeros,
    /// What was assumed or left out.
    pub notes: Vec<String>,
}

impl Evidence {
    /// Looks through recordings. `parameters` are those before any is found.
    ///
    /// # Errors
    /// The plan does not say how recordings are to be understood; channels that are missing or have other units; nothing by
    /// which the offsets of the outputs would be known.
    pub fn of(
        plan: &Plan,
        model: &Readings<'_>,
        registry: &Registry,
        interface: &Interface,
        recordings: &[Recording],
        parameters: &Numbers,
    ) -> Result<Self> {
        let Some(how) = &plan.recordings else {
            return Err(Error::file(format!(
                "the plan for {} does not say how recordings are to be understood ([recordings])",
                plan.model
            )));
        };
        if recordings.is_empty() {
            return Err(Error::file("there is no recording"));
        }
        let signals = Signals::of(plan, interface, &outputs_of(plan, registry))?;
        let mut notes = Vec::new();
        let mut tracks = Vec::new();
        for recording in recordings {
            let track = Track::new(recording, &signals, plan, interface)?;
            if !track.assumed.is_empty() {
                notes.push(format!(
                    "{}: no channel of {}: taken to be as in the plan",
                    recording.source,
                    track.assumed.join(", ")
                ));
            }
            notes.extend(track.gaps().iter().map(|[from, to]| {
                format!(
                    "{}: nothing is recorded from {from:.2} to {to:.2} s: nothing is read across",
                    recording.source
                )
            }));
            tracks.push(track);
        }
        let ranges = ranges(&tracks, signals.outputs.len());
        let touches = touches(plan, model, parameters)?;
        suspicion::check_inputs(plan, &signals, &tracks, |tracks| {
            readings_of(plan, &signals, tracks, &ranges, &touches)
        })?;
        let zeros = Zeros::of(plan, how, model, &signals, &tracks, &ranges, parameters)?;
        notes.extend(zeros.notes.iter().cloned());
        tracks.iter_mut().for_each(|track| track.correct(&zeros.offsets));
        let readings = readings_of(plan, &signals, &tracks, &ranges, &touches);
        let (readings, restless): (Vec<_>, Vec<_>) = readings.into_iter().partition(|r| r.moving.is_none());
        if zeros.recordings == 1 {
            notes.push(
                "the zero of the load cell was measured in one recording only: how far it drifts is not known, and intervals do not \
                 count it"
                    .to_owned(),
            );
        }
        let names = recordings.iter().map(|r| r.source.clone()).collect();
        let (targets, missing) = (Vec::new(), Vec::new());
        let mut evidence =
            Self { names, signals, readings, restless, targets, missing, ranges, zeros, notes };
        let restless = evidence.restless.iter().filter_map(|r| Some(evidence.unrest(r)? + ": not read"));
        let restless: Vec<String> = restless.collect();
        evidence.notes.extend(restless);
        for (number, target) in plan.groups.iter().flat_map(|g| &g.targets).enumerate() {
            match evidence.read(target, plan, model, registry, parameters) {
                Ok(read) => evidence.targets.push(read),
                Err(why) => evidence.missing.push((number, why.to_string())),
            }
        }
        Ok(evidence)
    }

    /// The points of a target.
    pub fn points(&self, read: &Read) -> Vec<Point> {
        read.members.iter().map(|k| self.readings[*k].point.clone()).collect()
    }

    /// The recordings that a target is read from.
    pub fn files(&self, read: &Read) -> String {
        let files: BTreeSet<usize> = read.members.iter().map(|k| self.readings[*k].recording).collect();
        suspicion::listed(files.iter().map(|k| &self.names[*k]))
    }

    /// Where a reading is.
    pub fn place(&self, reading: &Reading) -> String {
        let [from, to] = reading.time;
        format!("{} from {from:.2} to {to:.2} s", self.names[reading.recording])
    }

    /// What moves in a stretch in which nothing should.
    fn unrest(&self, reading: &Reading) -> Option<String> {
        let output = &self.signals.outputs.get(reading.moving?)?.0;
        Some(format!("{}: {output} does not come to rest", self.place(reading)))
    }

    fn read(
        &self,
        target: &Target,
        plan: &Plan,
        model: &Readings<'_>,
        registry: &Registry,
        parameters: &Numbers,
    ) -> Result<Read> {
        let found = plan.conditions.iter().enumerate().find(|(_, c)| c.name == target.condition);
        let Some((place, condition)) = found.filter(|(_, c)| !c.recorded.is_empty()) else {
            let why = found.and_then(|(_, c)| c.not_recorded.clone());
            let unsaid = "the plan does not say what a recording of it would be (recorded)";
            return Err(Error::file(why.unwrap_or_else(|| unsaid.into())));
        };
        // the model is asked once for conditions in which it is the same
        let held = |c: &Condition| {
            let mut held = c.hold.clone();
            held.retain(|name, _| !c.recorded.contains_key(name));
            held
        };
        let same = |c: &Condition| {
            held(c) == held(condition) && c.recorded == condition.recorded && c.ramp == condition.ramp
        };
        let place = plan.conditions.iter().position(same).unwrap_or(place);
        let is_ramp = condition.ramp.is_some();
        let of_kind: Vec<Reading> =
            self.readings.iter().filter(|r| r.moved.is_some() == is_ramp).cloned().collect();
        let members: Vec<usize> = (0..self.readings.len())
            .filter(|k| self.readings[*k].moved.is_some() == is_ramp)
            .filter(|k| condition.is_met(&self.readings[*k], &self.signals).is_ok())
            .collect();
        if members.is_empty() {
            let near = self.restless.iter().find(|r| !is_ramp && condition.is_met(r, &self.signals).is_ok());
            let why = near.and_then(|reading| self.unrest(reading));
            let why = why.unwrap_or_else(|| nearest(condition, &of_kind, &self.signals, &self.names));
            return Err(Error::file(why));
        }
        let output = |name: &str| {
            self.signals.output(name).ok_or_else(|| Error::file(format!("{name} is not recorded")))
        };
        let input = |name: &str| {
            let place = self.signals.input(name);
            place.ok_or_else(|| Error::file(format!("{name} is not recorded")))
        };
        let varying = self.varying(condition, &members, plan);
        let constants: f64;
        let (estimate, unknowns) = if let (Some(touch), false) = (&condition.from_touch, is_ramp) {
            let over = input(&touch.input)?;
            self.spreads(&touch.input, condition, &members)?;
            let number = self.number(&target.read, model, registry, parameters)?;
            constants = number.of(&model.free(condition, touch, &self.signals, parameters)?);
            let distance = condition.hold.get(&touch.input).copied().unwrap_or(0.0);
            (
                Estimate::FromTouch {
                    number,
                    over,
                    distance,
                    slope: target.along.is_some(),
                    free: constants,
                },
                3,
            )
        } else if let Some(along) = &target.along {
            self.spreads(along, condition, &members)?;
            let kept = condition.reach.first().map(|r| Ok::<_, Error>((output(&r.read)?, input(&r.by)?)));
            if let Some(reach) = condition.reach.first() {
                self.spreads(&reach.by, condition, &members)?;
            }
            let unknowns = varying.len() + 1;
            let (output, along) = (output(&target.read)?, input(along)?);
            (Estimate::Slope { output, along, varying, kept: kept.transpose()? }, unknowns)
        } else if let Some((name, at)) = is_ramp.then(|| odd(condition)).flatten() {
            self.spreads(&name, condition, &members)?;
            (Estimate::Odd { output: output(&target.read)?, over: input(&name)?, at }, 2)
        } else {
            (Estimate::Mean(self.number(&target.read, model, registry, parameters)?), 1)
        };
        if members.len() < unknowns + REDUNDANT {
            return Err(Error::file(format!(
                "{} readings for {unknowns} unknowns: {} are needed, so that the scatter can be seen",
                members.len(),
                unknowns + REDUNDANT
            )));
        }
        let visits = self.visits(&members, plan);
        let (name, factor) = (target.name.clone(), target.factor);
        Ok(Read { name, factor, condition: place, estimate, members, visits })
    }

    /// Readings that were made at one place, as far as a rig holds it. A ramp is one by itself.
    fn visits(&self, members: &[usize], plan: &Plan) -> Vec<Vec<usize>> {
        let within: Vec<f64> = self
            .signals
            .inputs
            .iter()
            .map(|(name, _)| {
                plan.recordings.as_ref().and_then(|r| r.held_within.get(name)).copied().unwrap_or(0.0)
            })
            .collect();
        let is_at = |a: &Reading, b: &Reading| {
            let places = a.point.inputs.iter().zip(&b.point.inputs);
            a.moved.is_none()
                && b.moved.is_none()
                && places.zip(&within).all(|((a, b), w)| (a - b).abs() <= *w)
        };
        let mut visits = Vec::<Vec<usize>>::new();
        for k in members {
            match visits.iter_mut().find(|visit| is_at(&self.readings[visit[0]], &self.readings[*k])) {
                Some(visit) => visit.push(*k),
                None => visits.push(vec![*k]),
            }
        }
        visits
    }

    /// The mean of readings at one place.
    pub fn mean_of(&self, visit: &[usize]) -> Reading {
        let mut reading = self.readings[visit[0]].clone();
        let mean_of = |k: usize, of: fn(&Point) -> &[f64]| {
            visit.iter().map(|n| of(&self.readings[*n].point)[k]).sum::<f64>() / visit.len() as f64
        };
        let [inputs, outputs] = [reading.point.inputs.len(), reading.point.outputs.len()];
        reading.point = Point {
            inputs: (0..inputs).map(|k| mean_of(k, |p| &p.inputs)).collect(),
            outputs: (0..outputs).map(|k| mean_of(k, |p| &p.outputs)).collect(),
        };
        reading
    }

    fn number(
        &self,
        name: &str,
        model: &Readings<'_>,
        registry: &Registry,
        parameters: &Numbers,
    ) -> Result<Number> {
        let find = |name: &str| {
            let place = self.signals.output(name);
            place.ok_or_else(|| Error::file(format!("{name} is not recorded")))
        };
        let Some(functional) = registry.functionals.iter().find(|f| f.name == name) else {
            return Ok(Number::Output(find(name)?));
        };
        let outputs = functional.outputs.iter().map(|o| find(o)).collect::<Result<_>>()?;
        let inputs = functional
            .inputs
            .iter()
            .map(|name| match self.signals.input(name) {
                Some(place) => Ok(Ok(place)),
                None => Ok(Err(model.value(name, parameters)?)),
            })
            .collect::<Result<_>>()?;
        Ok(Number::Functional { functional: *functional, outputs, inputs })
    }

    /// The motions that vary among readings. What an output measures is taken as it is: what it varies by may be drift.
    fn varying(&self, condition: &Condition, members: &[usize], plan: &Plan) -> Vec<usize> {
        let is_motion =
            |name: &&String| plan.recordings.as_ref().is_none_or(|how| !how.measured_by.contains_key(*name));
        let motions = condition.recorded.keys().filter(is_motion);
        let names = motions.filter_map(|name| Some((name, self.signals.input(name)?)));
        let varies = names.filter(|(name, _)| self.spread(name, condition, members) > VARIES);
        varies.map(|(_, place)| place).collect()
    }

    /// How far an input goes, as a share of what its condition allows.
    fn spread(&self, name: &str, condition: &Condition, members: &[usize]) -> f64 {
        let (Some(place), Some([low, high])) = (self.signals.input(name), condition.recorded.get(name))
        else {
            return 0.0;
        };
        let values = members.iter().map(|k| self.readings[*k].point.inputs[place]);
        let ends = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(v), h.max(v)]);
        (ends[1] - ends[0]) / (high - low)
    }

    fn spreads(&self, name: &str, condition: &Condition, members: &[usize]) -> Result<()> {
        if self.spread(name, condition, members) >= TOLD {
            return Ok(());
        }
        let [low, high] = condition.recorded.get(name).copied().unwrap_or([f64::NAN; 2]);
        Err(Error::file(format!(
            "{name} hardly differs between the {} readings that there are; values at both ends of {low} to {high} are needed",
            members.len()
        )))
    }
}

/// The input of which a ramp's reading is an odd function: the one that is held to a value within a range about 0.
fn odd(condition: &Condition) -> Option<(String, f64)> {
    let symmetric = |name: &String| condition.recorded.get(name).is_some_and(|[l, h]| l + h == 0.0);
    let held = condition.hold.iter().find(|(name, value)| **value != 0.0 && symmetric(name))?;
    Some((held.0.clone(), *held.1))
}

/// The outputs that targets read.
fn outputs_of(plan: &Plan, registry: &Registry) -> BTreeSet<String> {
    let mut outputs = BTreeSet::new();
    let mut add = |read: &str| match registry.functionals.iter().find(|f| f.name == read) {
        Some(functional) => outputs.extend(functional.outputs.iter().map(|o| (*o).to_owned())),
        None => {
            outputs.insert(read.to_owned());
        }
    };
    for target in plan.groups.iter().flat_map(|g| &g.targets) {
        add(&target.read);
        let condition = plan.conditions.iter().find(|c| c.name == target.condition);
        if target.along.is_some() {
            condition.iter().flat_map(|c| &c.reach).for_each(|r| add(&r.read));
        }
    }
    outputs
}

/// Of each condition with a ramp, where the tire touches the road.
fn touches(plan: &Plan, model: &Readings<'_>, parameters: &Numbers) -> Result<Vec<Option<f64>>> {
    let touch = |condition: &Condition| {
        let has_both = condition.ramp.is_some() && condition.from_touch.is_some();
        has_both.then(|| model.touch(condition, parameters)).transpose()
    };
    plan.conditions.iter().map(touch).collect()
}

/// All readings of recordings, those that do not come to rest among them. `touches` is for each condition with a ramp.
fn readings_of(
    plan: &Plan,
    signals: &Signals,
    tracks: &[Track<'_>],
    ranges: &[f64],
    touches: &[Option<f64>],
) -> Vec<Reading> {
    let mut readings = Vec::new();
    for (number, track) in tracks.iter().enumerate() {
        readings.extend(track.stretches(number, signals, plan, ranges));
        for (condition, touch) in plan.conditions.iter().zip(touches) {
            if let (Some(ramp), Some(touch)) = (&condition.ramp, touch) {
                readings.extend(track.ramps(number, signals, ramp, *touch));
            }
        }
    }
    readings
}

/// The range of each output over all recordings, or what rounding makes.
fn ranges(tracks: &[Track<'_>], outputs: usize) -> Vec<f64> {
    let mut all = vec![[f64::INFINITY, f64::NEG_INFINITY]; outputs];
    for track in tracks {
        for (ends, [low, high]) in all.iter_mut().zip(track.ends()) {
            *ends = [ends[0].min(low), ends[1].max(high)];
        }
    }
    let own = all.iter().map(|[low, high]| high - low);
    let least = ROUNDING * own.clone().fold(0.0, f64::max);
    own.map(|range| range.max(least)).collect()
}
