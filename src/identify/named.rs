//! What a plan calls by name is there, and is what the plan takes it for.

use super::plan::{Condition, GroupPlan, Recordings, Target};
use super::readings::Readings;
use super::registry::{Inversion, Transform};
use super::setup::Reading;
use crate::model::{Causality, did_you_mean};
use crate::{Error, Result};
use std::collections::BTreeMap;

/// What a plan calls by name, of all that is registered.
fn registered<'r, T>(
    what: &str,
    name: Option<&str>,
    all: &'r [T],
    name_of: fn(&T) -> &'static str,
) -> Result<Option<&'r T>> {
    let Some(name) = name else { return Ok(None) };
    let found = all.iter().find(|entry| name_of(entry) == name);
    found.map(Some).ok_or_else(|| {
        let hint = did_you_mean(name, all.iter().map(name_of));
        Error::file(format!("there is no {what} \"{name}\"{hint}"))
    })
}

pub(super) fn after_ramp(read: &str) -> Error {
    Error::file(format!("\"{read}\" cannot be read after a ramp: outputs can"))
}

pub(super) fn no_slope(read: &str) -> Error {
    Error::file(format!("\"{read}\" has no slope: outputs have"))
}

impl Readings<'_> {
    /// All that the plan names is there, and is what the plan takes it for.
    pub(super) fn check(&self) -> Result<()> {
        self.plan.set.keys().try_for_each(|name| self.settable(name))?;
        for condition in &self.plan.conditions {
            self.check_condition(condition).map_err(|e| e.at(format!("condition \"{}\"", condition.name)))?;
        }
        for group in &self.plan.groups {
            self.check_group(group).map_err(|e| e.at(format!("group \"{}\"", group.name)))?;
        }
        self.plan.recordings.iter().try_for_each(|r| self.check_recordings(r).map_err(|e| e.at("recordings")))
    }

    fn settable(&self, name: &str) -> Result<()> {
        self.stand.settable(name).map(|_| ())
    }

    fn check_condition(&self, condition: &Condition) -> Result<()> {
        let reached = condition.reach.iter().map(|r| &r.by);
        let inputs = condition.hold.keys().chain(reached).chain(condition.ramp.iter().map(|r| &r.input));
        inputs.chain(condition.recorded.keys()).try_for_each(|name| self.settable(name))?;
        for reach in &condition.reach {
            let reading = self.reading(&reach.read)?;
            // the search for all at once follows derivatives, which a functional does not have
            if let (Reading::Functional { .. }, 0) = (reading, reach.first_of) {
                return Err(Error::file(format!(
                    "\"{}\" is no output, and is brought about by {} only where the number of intervals to look in is said: first_of",
                    reach.read, reach.by
                )));
            }
        }
        if let Some(touch) = &condition.from_touch {
            self.settable(&touch.input)?;
            self.stand.interface().find(&touch.output)?;
        }
        condition.require.iter().try_for_each(|r| self.stand.interface().find(&r.output).map(|_| ()))
    }

    fn check_group(&self, group: &GroupPlan) -> Result<()> {
        for target in &group.targets {
            self.check_target(target).map_err(|e| e.at(format!("target \"{}\"", target.name)))?;
        }
        if let Some(inversion) = self.inversion(group)? {
            let size = group.targets.len();
            if let Some(needed) = inversion.size.filter(|needed| *needed != size) {
                return Err(Error::file(format!(
                    "inversion \"{}\" takes {needed} targets and gives as many parameters: there are {size}",
                    inversion.name
                )));
            }
            for target in &group.targets {
                let hold = &self.plan.condition(&target.condition)?.hold;
                if let Some(input) = inversion.held.iter().find(|input| !hold.contains_key(**input)) {
                    return Err(Error::file(format!(
                        "inversion \"{}\" needs {input} held, and condition \"{}\" does not",
                        inversion.name, target.condition
                    )));
                }
            }
        }
        let Some(transform) = self.transform(group)? else {
            return group.parameters.iter().try_for_each(|sought| self.settable(&sought.name));
        };
        let (sought, fixed, size) = (group.parameters.len(), group.fixed.len(), transform.size);
        if sought + fixed != size {
            return Err(Error::file(format!(
                "transform \"{}\" takes {size} values: there are {sought} parameters and {fixed} fixed ones",
                transform.name
            )));
        }
        if let Some(place) = group.fixed.keys().find(|place| **place >= size) {
            return Err(Error::file(format!(
                "fixed: transform \"{}\" has no place {place}; its {size} are counted from 0",
                transform.name
            )));
        }
        let changed = (transform.to_model)(&(transform.from_model)(&self.base), &self.base);
        changed.iter().try_for_each(|(name, _)| self.settable(name))
    }

    /// A slope or a ramp is that of an output.
    fn check_target(&self, target: &Target) -> Result<()> {
        let condition = self.plan.condition(&target.condition)?;
        let is_functional = matches!(self.reading(&target.read)?, Reading::Functional { .. });
        if condition.ramp.is_some() && is_functional {
            return Err(after_ramp(&target.read));
        }
        let Some(along) = &target.along else { return Ok(()) };
        self.settable(along)?;
        if is_functional {
            return Err(no_slope(&target.read));
        }
        for reach in &condition.reach {
            if let Reading::Functional { .. } = self.reading(&reach.read)? {
                return Err(Error::file(format!(
                    "no slope can be taken with \"{}\" kept: outputs can be kept",
                    reach.read
                )));
            }
        }
        Ok(())
    }

    /// What is held and may be off is an input, what measures one an output.
    fn check_recordings(&self, recordings: &Recordings) -> Result<()> {
        let interface = self.stand.interface();
        let is = |entry: &str, name: &str, wanted: Causality, what: &str| -> Result<()> {
            let found = &interface.variables[interface.find(name).map_err(|e| e.at(entry))?];
            if found.causality == wanted {
                return Ok(());
            }
            let others = interface.with(wanted).map(|v| interface.variables[v].name.as_str());
            let hint = did_you_mean(name, others);
            Err(Error::variable(format!("{name} of {} is no {what}{hint}", interface.name)).at(entry))
        };
        let inputs = |entry, names: &BTreeMap<String, f64>| {
            names.keys().try_for_each(|name| is(entry, name, Causality::Input, "input"))
        };
        inputs("offsets", &recordings.offsets)?;
        inputs("held_within", &recordings.held_within)?;
        for (input, output) in &recordings.measured_by {
            is("measured_by", input, Causality::Input, "input")?;
            is("measured_by", output, Causality::Output, "output")?;
        }
        Ok(())
    }

    pub(super) fn reading(&self, name: &str) -> Result<Reading> {
        let interface = self.stand.interface();
        let functionals = self.registry.functionals;
        let Some(functional) = functionals.iter().find(|f| f.name == name) else {
            return match interface.index(name) {
                Some(output) => Ok(Reading::Output(output)),
                None => {
                    let variables = interface.variables.iter().map(|v| v.name.as_str());
                    let hint = did_you_mean(name, variables.chain(functionals.iter().map(|f| f.name)));
                    Err(Error::variable(format!(
                        "{} has nothing to read of the name {name:?}{hint}",
                        interface.name
                    )))
                }
            };
        };
        let find = |names: &[&str]| names.iter().map(|n| interface.find(n)).collect::<Result<_>>();
        let (outputs, inputs) = (find(functional.outputs)?, find(functional.inputs)?);
        Ok(Reading::Functional { functional: *functional, outputs, inputs })
    }

    pub(super) fn transform(&self, group: &GroupPlan) -> Result<Option<&Transform>> {
        let all = self.registry.transforms;
        registered("transform", group.transform.as_deref(), all, |t| t.name)
    }

    pub(super) fn inversion(&self, group: &GroupPlan) -> Result<Option<&Inversion>> {
        let all = self.registry.inversions;
        registered("inversion", group.inversion.as_deref(), all, |i| i.name)
    }
}
