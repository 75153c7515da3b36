//! What an identification from recordings answers.

use super::figures::{Characteristic, Response};
use super::misfit::Misfit;
use super::reduced::{Known, Reduced};
use super::search::Search;
use crate::Result;
use crate::identify::plan::Plan;
use crate::identify::registry::Numbers;
use crate::identify::stand::number;
use serde::Serialize;

/// Half an interval of this share of a parameter's value is what a vehicle simulation hardly feels.
const GOOD: f64 = 0.1;

/// An offset of so many standard deviations of what it may be is told.
const UNLIKELY: f64 = 3.0;

/// How far a parameter can be trusted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Light {
    /// Known within a tenth.
    Green,
    /// Known, but not so well, or from recordings that contradict the model.
    Yellow,
    /// Not known: it has the value that it had, or it is a size, which cannot be negative, and its interval reaches down to nothing.
    Red,
}

impl Light {
    /// That of a value and half its interval, if it has one.
    fn of(value: f64, half_width: Option<f64>, is_size: bool, is_contradicted: bool) -> Self {
        match half_width {
            None => Self::Red,
            Some(half) if is_size && half >= value.abs() => Self::Red,
            Some(half) if half <= GOOD * value.abs() && !is_contradicted => Self::Green,
            Some(_) => Self::Yellow,
        }
    }
}

/// What became of a parameter of the model that a plan gives a value.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Found {
    /// Its name.
    pub name: String,
    /// The group that gives it, the last one if there are several.
    pub group: String,
    /// Its value.
    pub value: f64,
    /// Half of its interval (90 %), if it was identified: by what scatters, and by what is held and may be elsewhere.
    pub half_width: Option<f64>,
    /// How far it can be trusted.
    pub light: Light,
    /// Why it was not identified, or what speaks against it.
    pub why: Option<String>,
}

/// A target, as it was read.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Told {
    /// Its name.
    pub name: String,
    /// Its group.
    pub group: String,
    /// From how many stretches or ramps.
    pub readings: usize,
    /// What was measured, as it was measured.
    pub measured: f64,
    /// Half of its interval.
    pub half_width: f64,
    /// The same reading of the model with the parameters found.
    pub modelled: f64,
}

/// Parameters from recordings.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Answer {
    /// The model's parameters that the plan gives values.
    pub parameters: Vec<Found>,
    /// Values of the model's parameters that are not those that it starts with.
    pub values: Numbers,
    /// What was read.
    pub targets: Vec<Told>,
    /// What was read, over what it was read at, beside the model.
    pub characteristics: Vec<Characteristic>,
    /// How targets depend on what they fix.
    pub responses: Vec<Response>,
    /// Offsets of inputs that were found: channel less what it was.
    pub offsets: Vec<(String, f64)>,
    /// Offsets of outputs that were found off the road.
    pub zeros: Vec<(String, f64)>,
    /// Recordings that contradict the model with these parameters.
    pub misfits: Vec<Misfit>,
    /// What was assumed, left out, or is missing.
    pub notes: Vec<String>,
    /// Starts of the model.
    pub starts: usize,
}

impl Search<'_> {
    /// Values of the model's parameters that it does not start with.
    fn changed(&self) -> Result<Numbers> {
        let mut changed = Numbers::new();
        for (name, value) in &self.numbers {
            let start = &self.stand.interface().variables[self.stand.settable(name)?].start;
            if number(start.as_ref()) != Some(*value) {
                changed.insert(name.clone(), *value);
            }
        }
        Ok(changed)
    }

    /// Whether a parameter of the model cannot be negative.
    fn is_size(&self, name: &str) -> bool {
        let interface = self.stand.interface();
        interface
            .index(name)
            .is_some_and(|index| interface.variables[index].min.is_some_and(|min| min >= 0.0))
    }

    /// The answer, with the parameters as they are.
    pub fn answer(&self, plan: &Plan, reduced: &Reduced, known: &Known, within: &Numbers) -> Result<Answer> {
        let names: Vec<&String> = plan.groups.iter().flat_map(|g| &g.parameters).map(|p| &p.name).collect();
        let misfits = self.misfits(plan, reduced, known, within)?;
        let contradicted = |group: &String| {
            let missed = self.contradicted.iter().find(|(of, _)| of == group).map(|(_, told)| told.clone());
            let misfit = misfits.iter().find(|m| m.groups.contains(group));
            missed.or_else(|| {
                Some(format!("{} contradicts the model in {}", misfit?.output, misfit?.recording))
            })
        };
        let parameters = self.given(plan, reduced, known, within)?.into_iter().map(|given| {
            let held = given.by_held.and_then(|k| reduced.dropped.iter().find(|(name, _)| name == names[k]));
            let half_width = held.is_none().then_some(known.side * given.deviation);
            let contradiction = contradicted(&given.group);
            let light =
                Light::of(given.value, half_width, self.is_size(&given.name), contradiction.is_some());
            let is_lost = light == Light::Red && half_width.is_some();
            Found {
                light,
                half_width,
                why: match held {
                    Some((name, why)) if *name == given.name => Some(why.clone()),
                    Some((name, why)) => Some(format!("{name}: {why}")),
                    None => contradiction.or_else(|| {
                        is_lost
                            .then(|| "the recordings hardly tell it: its interval reaches down to 0".into())
                    }),
                },
                name: given.name,
                group: given.group,
                value: given.value,
            }
        });
        let parameters = parameters.collect();
        let model = self.model(&reduced.plan)?;
        let numbers = model.model_values(&model.sought_values(&self.numbers)?)?;
        let reads = self.reads(&reduced.plan)?;
        let modelled = self.modelled(&model, &reads, &numbers)?;
        let groups = reduced.plan.groups.iter().flat_map(|g| g.targets.iter().map(|_| g.name.clone()));
        let mut targets = Vec::new();
        for (k, (read, group)) in reads.iter().zip(groups).enumerate() {
            targets.push(Told {
                name: read.name.clone(),
                group,
                readings: read.members.len(),
                measured: self.measured(read)?,
                half_width: known.side * known.covariance[(k, k)].sqrt(),
                modelled: modelled[k],
            });
        }
        let outputs = self.evidence.signals.outputs.iter();
        let inputs = &self.evidence.signals.inputs;
        let looked = |name: &String| plan.recordings.as_ref().is_some_and(|r| r.offsets.contains_key(name));
        let offsets = inputs.iter().zip(&self.offsets).filter(|((name, _), _)| looked(name));
        let mut notes = self.evidence.notes.clone();
        notes.extend(self.notes.iter().cloned());
        for ((name, _), offset) in offsets.clone() {
            let size =
                plan.recordings.as_ref().and_then(|r| r.offsets.get(name)).copied().unwrap_or(f64::INFINITY);
            if offset.abs() > UNLIKELY * size {
                notes.push(format!(
                    "the offset of {name}, {offset:.2e}, is more than one expects of a channel: is the rolling radius, the zero of the \
                     angles, or the height of the rig right?"
                ));
            }
        }
        Ok(Answer {
            parameters,
            values: self.changed()?,
            targets,
            characteristics: self.characteristics(&reduced.plan)?,
            responses: self.responses(&reduced.plan, known)?,
            offsets: offsets.map(|((name, _), offset)| (name.clone(), *offset)).collect(),
            zeros: outputs
                .zip(&self.evidence.zeros.offsets)
                .map(|((n, _), zero)| (n.clone(), *zero))
                .collect(),
            misfits,
            notes,
            starts: self.stand.starts(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_size_that_may_be_nothing_is_not_known() {
        let of = |value, half, is_size| Light::of(value, half, is_size, false);
        assert_eq!(of(2.0, Some(0.1), true), Light::Green);
        assert_eq!(of(2.0, Some(1.9), true), Light::Yellow);
        assert_eq!(of(2.0, Some(2.1), true), Light::Red);
        assert_eq!(of(2.0, None, true), Light::Red);
        // what may have either sign may well be next to nothing
        assert_eq!([of(2.0, Some(2.1), false), of(-2.0, Some(2.1), false)], [Light::Yellow; 2]);
        // and a contradiction makes nothing better than it is
        let contradicted = [0.1, 2.1].map(|half| Light::of(2.0, Some(half), true, true));
        assert_eq!(contradicted, [Light::Yellow, Light::Red]);
    }
}
