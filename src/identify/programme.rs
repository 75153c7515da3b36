//! A measurement programme: what a rig has to do so that recordings hold all that a plan reads.

use super::plan::{Plan, finite, range};
use crate::model::{Causality, Interface};
use crate::recording::{Channel, Recording};
use crate::{Error, Result};
use serde::Deserialize;
use std::collections::BTreeMap;

/// Runs, and what the rig can do.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Programme {
    /// The runs.
    #[serde(rename = "run")]
    pub runs: Vec<Run>,
    /// Limits of the rig.
    pub limits: BTreeMap<String, RigLimit>,
}

/// What a rig can do with an input.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RigLimit {
    /// Largest rate \[its unit per second\].
    pub rate: f64,
    /// Where it can be; everywhere, if it is not said.
    pub between: Option<[f64; 2]>,
}

/// A run: points that are visited and held.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Run {
    /// Its name, also that of its file.
    pub name: String,
    /// What it is for, in a line for the person at the rig.
    pub purpose: String,
    /// Inputs and switches, wherever a point says nothing else.
    pub hold: BTreeMap<String, f64>,
    /// Points that are visited one after the other, forth and back.
    pub points: Vec<BTreeMap<String, f64>>,
    /// How often forth and back: what drifts then shows as scatter, and not as a slope.
    pub repeats: usize,
    /// How long each point is held \[s\].
    pub time: f64,
    /// Rates that this run needs, in place of the largest that the rig has.
    #[serde(default)]
    pub rates: BTreeMap<String, f64>,
}

/// A run for a rig: where each input is at times between which it moves evenly.
#[derive(Debug, Clone, PartialEq)]
pub struct RigRun {
    /// The run's name.
    pub name: String,
    /// What it is for.
    pub purpose: String,
    /// The inputs, at the times at which a move begins or ends.
    pub inputs: Recording,
    /// Parameters of the rig, as its switches.
    pub switches: BTreeMap<String, f64>,
}

impl Plan {
    /// The runs of the plan's programme, on a rig with this interface, within `limits` in place of those of the plan where they
    /// say something.
    ///
    /// # Errors
    /// There is no programme, or it asks for more than the limits allow: the message names run and input.
    pub fn runs(&self, interface: &Interface, limits: &BTreeMap<String, RigLimit>) -> Result<Vec<RigRun>> {
        let Some(programme) = &self.programme else {
            return Err(Error::file(format!("the plan for {} has no measurement programme", self.model)));
        };
        let mut all = programme.limits.clone();
        all.extend(limits.iter().map(|(name, limit)| (name.clone(), limit.clone())));
        for name in all.keys() {
            interface.find(name).map_err(|e| e.at("limits"))?;
        }
        programme
            .runs
            .iter()
            .map(|run| {
                run.on_rig(&self.set, interface, &all).map_err(|e| e.at(format!("run \"{}\"", run.name)))
            })
            .collect()
    }
}

impl Run {
    fn on_rig(
        &self,
        set: &BTreeMap<String, f64>,
        interface: &Interface,
        limits: &BTreeMap<String, RigLimit>,
    ) -> Result<RigRun> {
        if self.points.is_empty() || self.repeats == 0 || !(self.time > 0.0 && self.time.is_finite()) {
            return Err(Error::file("points, repeats and a time for which they are held are needed"));
        }
        self.points.iter().try_for_each(finite)?;
        let mut base = set.clone();
        base.extend(self.hold.clone());
        let (mut switches, mut inputs) = (BTreeMap::new(), BTreeMap::new());
        for (name, value) in base.iter().chain(self.points.iter().flatten()) {
            let info = &interface.variables[interface.find(name)?];
            match info.causality {
                Causality::Input => inputs
                    .entry(name.clone())
                    .or_insert_with(|| (*value, info.unit.clone().unwrap_or_else(|| "1".into()))),
                Causality::Parameter => {
                    switches.insert(name.clone(), *value);
                    continue;
                }
                _ => return Err(Error::variable(format!("{name} is no input and no parameter"))),
            };
        }
        let there = self.points.iter();
        let there_and_back: Vec<_> = there.clone().chain(there.rev()).collect();
        let visited = (0..self.repeats).flat_map(|_| there_and_back.iter());
        let place = |point: &BTreeMap<String, f64>| -> Vec<f64> {
            inputs.iter().map(|(name, (value, _))| point.get(name).copied().unwrap_or(*value)).collect()
        };
        let (mut time, mut at): (Vec<f64>, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
        for point in visited {
            let next = place(point);
            let mut now = 0.0;
            if let (Some(last), Some(begin)) = (at.last(), time.last()) {
                let mut moving: f64 = 0.0;
                for ((name, _), (from, to)) in inputs.iter().zip(last.iter().zip(&next)) {
                    moving = moving.max(self.moving_time(name, *from, *to, limits)?);
                }
                now = begin + moving;
                if moving > 0.0 {
                    time.push(now);
                    at.push(next.clone());
                }
            } else {
                time.push(now);
                at.push(next.clone());
            }
            time.push(now + self.time);
            at.push(next);
        }
        let channel = |(k, (name, (_, unit))): (usize, (&String, &(f64, String)))| Channel {
            name: name.clone(),
            unit: unit.clone(),
            values: at.iter().map(|row| row[k]).collect(),
        };
        let channels = inputs.iter().enumerate().map(channel).collect();
        let inputs = Recording { time, channels, source: self.name.clone() };
        Ok(RigRun { name: self.name.clone(), purpose: self.purpose.clone(), inputs, switches })
    }

    /// How long an input needs from one value to another \[s\].
    fn moving_time(
        &self,
        name: &str,
        from: f64,
        to: f64,
        limits: &BTreeMap<String, RigLimit>,
    ) -> Result<f64> {
        let limit = limits.get(name);
        if let Some([low, high]) = limit.and_then(|l| l.between) {
            range(name, [low, high])?;
            if let Some(beyond) = [from, to].into_iter().find(|v| !(low..=high).contains(v)) {
                return Err(Error::file(format!(
                    "{name} has to be {beyond}, and the rig has {low} to {high}: this run cannot be made there"
                )));
            }
        }
        if from == to {
            return Ok(0.0);
        }
        let most = limit.map(|l| l.rate);
        let rate = match (self.rates.get(name), most) {
            (Some(needed), Some(most)) if *needed > most => {
                return Err(Error::file(format!(
                    "{name} has to move with {needed} per second, and the rig has {most}: this run cannot be made there"
                )));
            }
            (Some(needed), _) => *needed,
            (None, Some(most)) => most,
            (None, None) => {
                return Err(Error::file(format!("{name} moves, and there is no limit of its rate")));
            }
        };
        if rate > 0.0 {
            return Ok((to - from).abs() / rate);
        }
        Err(Error::file(format!("{name} has a rate of {rate}")))
    }
}
