//! A plan on a stand: its targets as functions of what it looks for.

use super::plan::{Condition, GroupPlan, Limit, Plan, Reach, Recordings, Require, Target, Touch};
use super::registry::{Functional, Inversion, Numbers, Registry, Transform};
use super::solve::{Goal, Group, Nesting, Next, Part, Sequence, Tail, Targets, Unsolved, Way, sequence};
use super::stand::{Stand, number};
use crate::model::{Causality, did_you_mean};
use crate::{Error, Result};
use nalgebra::{DMatrix, DVector};
use std::cell::RefCell;
use std::collections::BTreeMap;

/// Steps of the search for responses: by derivatives it takes a handful.
const MAX_STEPS: usize = 40;
/// A response is reached within this share of its size.
const REACHED: f64 = 1e-11;

/// Something that can be read from a stationary state.
enum Reading {
    Output(usize),
    Functional { functional: Functional, outputs: Vec<usize>, inputs: Vec<usize> },
}

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

fn after_ramp(read: &str) -> Error {
    Error::file(format!("\"{read}\" cannot be read after a ramp: outputs can"))
}

fn no_slope(read: &str) -> Error {
    Error::file(format!("\"{read}\" has no slope: outputs have"))
}

/// A plan with a stand on which its conditions are met.
pub struct Readings<'a> {
    plan: &'a Plan,
    pub(super) stand: &'a Stand,
    registry: Registry,
    /// Values of the model's parameters before any is found.
    base: Numbers,
    /// Those that the slave starts with by itself.
    own: Numbers,
    bounds: Vec<[f64; 2]>,
    /// Where inputs brought responses about last, by condition: a search begins there.
    reached: RefCell<BTreeMap<String, Vec<f64>>>,
}

impl<'a> Readings<'a> {
    /// The plan's targets on this stand. `start` replaces start values of parameters, which count until they are found.
    ///
    /// # Errors
    /// Names that the stand's model or the registry do not have.
    pub fn new(plan: &'a Plan, stand: &'a Stand, registry: Registry, start: &Numbers) -> Result<Self> {
        let mut base = Numbers::new();
        for info in &stand.interface().variables {
            let is_parameter = info.causality == Causality::Parameter;
            if let Some(value) = number(info.start.as_ref()).filter(|_| is_parameter) {
                base.insert(info.name.clone(), value);
            }
        }
        let own = base.clone();
        for (name, value) in start {
            if base.insert(name.clone(), *value).is_none() {
                return Err(Error::variable(format!("{} has no parameter {name}", stand.interface().name)));
            }
        }
        let bounds = plan.groups.iter().flat_map(|g| &g.parameters).map(|p| p.bounds).collect();
        let readings = Self { plan, stand, registry, base, own, bounds, reached: RefCell::default() };
        readings.check()?;
        Ok(readings)
    }

    /// The plan.
    pub fn plan(&self) -> &Plan {
        self.plan
    }

    /// The name of the model on the stand.
    pub fn model(&self) -> &str {
        &self.stand.interface().name
    }

    /// All that the plan names is there, and is what the plan takes it for.
    fn check(&self) -> Result<()> {
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

    fn reading(&self, name: &str) -> Result<Reading> {
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

    fn transform(&self, group: &GroupPlan) -> Result<Option<&Transform>> {
        let all = self.registry.transforms;
        registered("transform", group.transform.as_deref(), all, |t| t.name)
    }

    pub(super) fn inversion(&self, group: &GroupPlan) -> Result<Option<&Inversion>> {
        let all = self.registry.inversions;
        registered("inversion", group.inversion.as_deref(), all, |i| i.name)
    }

    /// The model's parameters for values of what is looked for; those of groups that are not among them keep what they have.
    pub fn model_values(&self, sought: &[f64]) -> Result<Numbers> {
        let mut values = self.base.clone();
        let mut rest = sought;
        for group in &self.plan.groups {
            let Some((own, later)) = rest.split_at_checked(group.parameters.len()) else { break };
            rest = later;
            match self.transform(group)? {
                Some(transform) => {
                    let changed = (transform.to_model)(&group.whole(own), &values);
                    values.extend(changed.into_iter().map(|(name, value)| (name.to_owned(), value)));
                }
                None => values.extend(group.parameters.iter().zip(own).map(|(p, v)| (p.name.clone(), *v))),
            }
        }
        Ok(values)
    }

    /// What is looked for, from values of the model's parameters.
    ///
    /// # Errors
    /// A parameter without a value.
    pub fn sought_values(&self, model: &Numbers) -> Result<Vec<f64>> {
        let mut all = self.base.clone();
        all.extend(model.iter().map(|(name, value)| (name.clone(), *value)));
        let mut sought = Vec::new();
        for group in &self.plan.groups {
            match self.transform(group)? {
                Some(transform) => sought.extend(group.sought(&(transform.from_model)(&all))),
                None => {
                    for parameter in &group.parameters {
                        let value = all.get(&parameter.name);
                        sought
                            .push(*value.ok_or_else(|| {
                                Error::variable(format!("{} has no value", parameter.name))
                            })?);
                    }
                }
            }
        }
        Ok(sought)
    }

    /// Names of the model's parameters that the plan gives values, each with the last group that does.
    ///
    /// # Errors
    /// A transform that is not registered.
    pub fn given(&self) -> Result<Vec<(String, String)>> {
        let mut given: Vec<(String, String)> = Vec::new();
        for group in &self.plan.groups {
            let names = self.given_by(group)?;
            given.retain(|(name, _)| !names.contains(name));
            given.extend(names.into_iter().map(|name| (name, group.name.clone())));
        }
        Ok(given)
    }

    /// Names of the model's parameters that a group gives values.
    fn given_by(&self, group: &GroupPlan) -> Result<Vec<String>> {
        let Some(transform) = self.transform(group)? else {
            return Ok(group.parameters.iter().map(|p| p.name.clone()).collect());
        };
        let whole = (transform.from_model)(&self.base);
        let changed = (transform.to_model)(&whole, &self.base);
        Ok(changed.into_iter().map(|(name, _)| name.to_owned()).collect())
    }

    /// Names of the model's parameters to which only groups give values of which nothing is looked for, as `is_held` knows.
    ///
    /// # Errors
    /// A transform that is not registered.
    pub fn held_names(&self, is_held: impl Fn(&str) -> bool) -> Result<Vec<String>> {
        let (mut held, mut known) = (Vec::new(), Vec::new());
        for group in &self.plan.groups {
            let given = self.given_by(group)?;
            if group.parameters.iter().all(|p| is_held(&p.name)) {
                held.extend(given);
            } else {
                let assumed = self.transform(group)?.map_or(&[][..], |t| t.assumes);
                known.extend(given.into_iter().filter(|name| !assumed.contains(&name.as_str())));
            }
        }
        held.retain(|name| !known.contains(name));
        Ok(held)
    }

    /// Parameters that were found, with those of groups of which nothing was looked for as they were before, or as near to that as
    /// what was found admits. `is_held` knows what was not looked for.
    ///
    /// # Errors
    /// As [`held_names`](Self::held_names).
    pub fn with_what_is_held(&self, found: &Numbers, is_held: impl Fn(&str) -> bool) -> Result<Numbers> {
        let mut all = self.base.clone();
        all.extend(found.iter().map(|(name, value)| (name.clone(), *value)));
        for name in self.held_names(&is_held)? {
            all.extend(self.base.get(&name).map(|value| (name, *value)));
        }
        for group in self.plan.groups.iter().filter(|g| g.parameters.iter().all(|p| is_held(&p.name))) {
            let Some(transform) = self.transform(group)? else { continue };
            // what a group before assumed is put back
            let own = (transform.from_model)(&all).into_iter().zip(&group.parameters);
            let sought: Vec<f64> = own.map(|(x, p)| x.clamp(p.bounds[0], p.bounds[1])).collect();
            let values = (transform.to_model)(&sought, &all).into_iter();
            let values = values.filter(|(name, _)| !transform.assumes.contains(name));
            all.extend(values.map(|(name, value)| (name.to_owned(), value)));
        }
        Ok(all)
    }

    /// Identifies all parameters, group after group.
    ///
    /// # Errors
    /// See [`sequence`].
    pub fn identify(&self, goal: &Goal) -> std::result::Result<Sequence, Unsolved> {
        let start = self.sought_values(&self.base)?;
        let direct: Vec<_> = self
            .plan
            .groups
            .iter()
            .map(|group| {
                let inversion = self.inversion(group)?;
                Ok(inversion.map(|inversion| {
                    move |values: &[f64], known: &[f64]| self.invert(inversion, group, values, known)
                }))
            })
            .collect::<Result<_>>()?;
        let mut groups = Vec::new();
        for (group, direct) in self.plan.groups.iter().zip(&direct) {
            let size = group.parameters.len();
            let way = match direct {
                Some(direct) => Way::Direct(direct),
                None => {
                    let (nesting, tail) = group.search();
                    Way::Nested { nesting, tail }
                }
            };
            groups.push(Group { size, way });
        }
        sequence(self, goal, &groups, &start, false)
    }

    /// A group's parameters in closed form, from the values of its targets and of all parameters before it.
    pub(super) fn invert(
        &self,
        inversion: &Inversion,
        group: &GroupPlan,
        values: &[f64],
        known: &[f64],
    ) -> std::result::Result<Vec<f64>, Unsolved> {
        let held = |target: &Target| Ok(self.plan.condition(&target.condition)?.hold.clone());
        let held: Vec<Numbers> = group.targets.iter().map(held).collect::<Result<_>>()?;
        (inversion.invert)(values, &held, &self.model_values(known)?)
    }

    /// Why a group was not solved, with the plan's names.
    pub fn words(&self, why: &Unsolved) -> String {
        let groups = &self.plan.groups;
        let parameter = |k| groups.iter().flat_map(|g| &g.parameters).nth(k).map(|p| p.name.clone());
        let target = |k| groups.iter().flat_map(|g| &g.targets).nth(k).map(|t| t.name.clone());
        why.words(|k| parameter(k).unwrap_or_default(), |k| target(k).unwrap_or_default())
    }

    /// The values of all variables under a condition for these parameters.
    fn values<'b>(&'b self, condition: &'b Condition, parameters: &Numbers) -> Result<Setup<'b>> {
        let mut setup = Setup { readings: self, condition, values: self.held(condition, parameters)? };
        if let Some(touch) = &condition.from_touch {
            let offset = condition.hold.get(&touch.input).copied().unwrap_or(0.0);
            let input = self.stand.settable(&touch.input)?;
            let at = setup.touch(touch, input)?;
            setup.set(input, at + offset);
        }
        Ok(setup)
    }

    /// What a condition holds, with these parameters.
    pub(super) fn held(&self, condition: &Condition, parameters: &Numbers) -> Result<Vec<(usize, f64)>> {
        let changed = parameters.iter().filter(|(name, value)| self.own.get(*name) != Some(*value));
        let all = changed.chain(&self.plan.set).chain(&condition.hold);
        all.map(|(name, value)| Ok((self.stand.settable(name)?, *value))).collect()
    }

    /// The value of the input at which the tire touches the road.
    pub(super) fn touch_of(&self, condition: &Condition, touch: &Touch, parameters: &Numbers) -> Result<f64> {
        let values = self.held(condition, parameters)?;
        let input = self.stand.settable(&touch.input)?;
        Setup { readings: self, condition, values }.touch(touch, input)
    }

    fn target(&self, target: &Target, parameters: &Numbers) -> Result<f64> {
        let condition = self.plan.condition(&target.condition)?;
        let value = self.limit(condition, &condition.limit, target, parameters)?;
        Ok(target.factor * value)
    }

    /// The reading, extrapolated to where the inputs `limits` are 0.
    fn limit(
        &self,
        condition: &Condition,
        limits: &[Limit],
        target: &Target,
        parameters: &Numbers,
    ) -> Result<f64> {
        let Some((first, others)) = limits.split_first() else {
            return self.read(condition, target, parameters);
        };
        let mut half = condition.clone();
        if let Some(value) = half.hold.get_mut(&first.input) {
            *value *= 0.5;
        }
        let far = self.limit(condition, others, target, parameters)?;
        let near = self.limit(&half, others, target, parameters)?;
        let share = 2f64.powi(first.order);
        Ok((share * near - far) / (share - 1.0))
    }

    fn read(&self, condition: &Condition, target: &Target, parameters: &Numbers) -> Result<f64> {
        let mut setup = self.values(condition, parameters)?;
        setup.reach(&condition.reach)?;
        setup.require(&condition.require)?;
        let reading = self.reading(&target.read)?;
        if let Some(ramp) = &condition.ramp {
            let Reading::Output(output) = reading else {
                return Err(after_ramp(&target.read));
            };
            let input = self.stand.settable(&ramp.input)?;
            let steps = (ramp.time / ramp.step).round().max(1.0) as usize;
            let rows = self.stand.along(&setup.values, &[(input, ramp.rate)], ramp.time, steps, &[output])?;
            return Ok(rows[steps][0]);
        }
        match &target.along {
            None => setup.read(&reading),
            Some(along) => {
                let Reading::Output(output) = reading else {
                    return Err(no_slope(&target.read));
                };
                setup.slope(output, self.stand.settable(along)?, &condition.reach)
            }
        }
    }
}

impl GroupPlan {
    /// Order and signs in which the plan says that its targets respond; the plain ones where it says nothing.
    pub(super) fn search(&self) -> (Nesting, Option<Tail>) {
        let mut nesting = Nesting::plain(self.parameters.len());
        let Some(signs) = &self.nesting else { return (nesting, None) };
        nesting.rises.clone_from(&signs.rises);
        nesting.falls.clone_from(&signs.falls);
        (nesting, signs.tail.map(|sign| Tail { sign }))
    }
}

impl Targets for Readings<'_> {
    fn bounds(&self) -> &[[f64; 2]] {
        &self.bounds
    }

    fn at(&self, parameters: &[f64]) -> Result<Vec<f64>> {
        let rows: Vec<usize> = (0..self.bounds.len()).collect();
        self.some(parameters, &rows)
    }

    fn some(&self, parameters: &[f64], rows: &[usize]) -> Result<Vec<f64>> {
        let values = self.model_values(parameters)?;
        let all: Vec<&Target> = self.plan.groups.iter().flat_map(|g| &g.targets).collect();
        rows.iter()
            .map(|row| {
                let target = all[*row];
                self.target(target, &values).map_err(|e| e.at(format!("\"{}\"", target.name)))
            })
            .collect()
    }
}

impl Readings<'_> {
    /// Derivatives of all targets (rows) by all that is looked for (columns), of which a group's targets have none by what later
    /// groups look for (3.23).
    ///
    /// # Errors
    /// The targets cannot be computed there.
    pub fn triangular_jacobian(&self, sought: &[f64]) -> Result<DMatrix<f64>> {
        let n = self.bounds.len();
        let mut jacobian = DMatrix::zeros(n, n);
        let mut from = 0;
        for group in &self.plan.groups {
            let rows: Vec<usize> = (from..n).collect();
            let own = from..from + group.parameters.len();
            let at = sought.get(own.clone()).unwrap_or_default();
            let part = Part::new(self, rows, own.clone().collect(), sought);
            jacobian.view_mut((from, from), (n - from, own.len())).copy_from(&part.jacobian(at)?);
            from = own.end;
        }
        Ok(jacobian)
    }
}

/// Values for the stand that a condition makes, one after the other.
struct Setup<'a> {
    readings: &'a Readings<'a>,
    condition: &'a Condition,
    values: Vec<(usize, f64)>,
}

impl Setup<'_> {
    fn stand(&self) -> &Stand {
        self.readings.stand
    }

    fn get(&self, variable: usize) -> f64 {
        self.stand().value(&self.values, variable)
    }

    fn set(&mut self, variable: usize, value: f64) {
        match self.values.iter_mut().rev().find(|(v, _)| *v == variable) {
            Some((_, old)) => *old = value,
            None => self.values.push((variable, value)),
        }
    }

    fn read(&self, reading: &Reading) -> Result<f64> {
        match reading {
            Reading::Output(output) => Ok(self.stand().stationary(&self.values, &[*output])?[0]),
            Reading::Functional { functional, outputs, inputs } => {
                let outputs = self.stand().stationary(&self.values, outputs)?;
                let inputs: Vec<f64> = inputs.iter().map(|v| self.get(*v)).collect();
                Ok((functional.read)(&outputs, &inputs))
            }
        }
    }

    /// The last place at which the output still has the value of the lower end.
    fn touch(&mut self, touch: &Touch, input: usize) -> Result<f64> {
        let output = self.stand().interface().find(&touch.output)?;
        let [mut low, mut high] = touch.between;
        let mut value = |x: f64| {
            self.set(input, x);
            self.stand().stationary(&self.values, &[output]).map(|v| v[0])
        };
        let free = value(low)?;
        let leaves = |value: f64| (value - free).abs() > touch.by;
        if !leaves(value(high)?) {
            return Err(Error::numeric(format!(
                "{} stays {free} up to {} = {high}",
                touch.output, touch.input
            )));
        }
        while high - low > 1e-13 * high.abs().max(low.abs()) {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if leaves(value(middle)?) { high = middle } else { low = middle }
        }
        Ok(low)
    }

    /// Outputs are where they have to be.
    fn require(&self, wanted: &[Require]) -> Result<()> {
        if wanted.is_empty() {
            return Ok(());
        }
        let find = |required: &Require| self.stand().interface().find(&required.output);
        let outputs: Vec<usize> = wanted.iter().map(find).collect::<Result<_>>()?;
        for (required, value) in wanted.iter().zip(self.stand().stationary(&self.values, &outputs)?) {
            let [low, high] = required.between;
            if !(low..=high).contains(&value) {
                return Err(Error::numeric(format!(
                    "{} is {value:.6} and has to be {low} to {high}: {}",
                    required.output, required.why
                )));
            }
        }
        Ok(())
    }

    /// Brings responses about.
    fn reach(&mut self, wanted: &[Reach]) -> Result<()> {
        let inner: Vec<&Reach> = wanted.iter().filter(|r| r.first_of == 0).collect();
        match wanted.iter().find(|r| r.first_of > 0) {
            None => self.reach_all(&inner),
            Some(first) => self.reach_first(first, &inner),
        }
    }

    /// All at once, within the ranges: by Newton's method with derivatives that the stand gives where it begins, and that
    /// steps improve (Broyden's update).
    fn reach_all(&mut self, wanted: &[&Reach]) -> Result<()> {
        if wanted.is_empty() {
            return Ok(());
        }
        let find = |reach: &&Reach| self.stand().interface().find(&reach.read);
        let outputs: Vec<usize> = wanted.iter().map(find).collect::<Result<_>>()?;
        let inputs: Vec<usize> =
            wanted.iter().map(|r| self.stand().settable(&r.by)).collect::<Result<_>>()?;
        let last = self.readings.reached.borrow().get(&self.condition.name).cloned();
        for (i, (reach, input)) in wanted.iter().zip(&inputs).enumerate() {
            let [low, high] = reach.between;
            let begin = last.as_ref().and_then(|l| l.get(i).copied()).unwrap_or_else(|| self.get(*input));
            self.set(*input, begin.clamp(low, high));
        }
        let size = |i: usize| wanted[i].value.abs().max(1.0);
        let excess_of = |values: &[f64]| DVector::from_fn(wanted.len(), |i, _| values[i] - wanted[i].value);
        let is_within = |excess: &DVector<f64>, share: f64| {
            (0..wanted.len()).all(|i| excess[i].abs() <= share * REACHED * size(i))
        };
        let (mut values, mut slopes) = self.stand().state(&self.values, &outputs, &inputs)?;
        let mut excess = excess_of(&values);
        // a response to one input is monotone: it is met on one side of where it was asked
        let mut brackets: Vec<[f64; 2]> = wanted.iter().map(|r| r.between).collect();
        for _ in 0..MAX_STEPS {
            if is_within(&excess, 1.0) {
                let at = inputs.iter().map(|input| self.get(*input)).collect();
                self.readings.reached.borrow_mut().insert(self.condition.name.clone(), at);
                return Ok(());
            }
            if wanted.len() == 1 {
                let end = usize::from((excess[0] > 0.0) == (slopes[0] > 0.0));
                brackets[0][end] = self.get(inputs[0]);
            }
            let step = slopes.clone().lu().solve(&excess);
            let mut moved = DVector::zeros(inputs.len());
            for (i, input) in inputs.iter().enumerate() {
                let at = self.get(*input);
                let [low, high] = brackets[i];
                // where the derivative leads out of the range, or there is none, half of the way to its end
                let next = match step.as_ref().map_or(f64::NAN, |s| at - s[i]) {
                    x if x > low && x < high => x,
                    x if x <= low => 0.5 * (at + low),
                    x if x >= high => 0.5 * (at + high),
                    _ => 0.5 * (low + high),
                };
                moved[i] = next - at;
                self.set(*input, next);
            }
            if (0..inputs.len())
                .all(|i| moved[i].abs() <= 1e-15 * (wanted[i].between[1] - wanted[i].between[0]))
            {
                break;
            }
            values = self.stand().stationary(&self.values, &outputs)?;
            let next = excess_of(&values);
            let surprise = &next - &excess - &slopes * &moved;
            slopes += surprise * moved.transpose() / moved.norm_squared();
            excess = next;
        }
        // what rounding leaves of a state that is searched itself
        if is_within(&excess, 1e4) { Ok(()) } else { Err(self.not_reached(wanted, &values)) }
    }

    fn not_reached(&self, wanted: &[&Reach], values: &[f64]) -> Error {
        let each = wanted.iter().zip(values).map(|(r, v)| {
            let [low, high] = r.between;
            format!("{} = {} by {} between {low} and {high} (it gets to {v:.6})", r.read, r.value, r.by)
        });
        Error::numeric(format!("this is not reached: {}", each.collect::<Vec<_>>().join(", ")))
    }

    /// The first place from the lower end on, with the others reached at each.
    fn reach_first(&mut self, first: &Reach, others: &[&Reach]) -> Result<()> {
        let reading = self.readings.reading(&first.read)?;
        let input = self.stand().settable(&first.by)?;
        let mut value = |x: f64| {
            self.set(input, x);
            self.reach_all(others)?;
            Ok::<f64, Error>(self.read(&reading)? - first.value)
        };
        let [low, high] = first.between;
        let place = |k: usize| low + (high - low) * k as f64 / first.first_of as f64;
        let (mut ends, mut values) = ([low, low], [value(low)?; 2]);
        let found = (1..=first.first_of).find_map(|k| {
            let x = place(k);
            match value(x) {
                Ok(v) if v * values[0] <= 0.0 => Some(Ok((x, v))),
                Ok(v) => {
                    (ends[0], values[0]) = (x, v);
                    None
                }
                Err(e) => Some(Err(e)),
            }
        });
        let Some(found) = found else {
            return Err(Error::numeric(format!(
                "{} does not become {} for {} between {low} and {high}",
                first.read, first.value, first.by
            )));
        };
        (ends[1], values[1]) = found?;
        let mut next = Next::new(ends[1] - ends[0], 1e-13 * (high - low));
        let sign = values[1].signum();
        while ends[1] - ends[0] > next.width && values.iter().all(|v| *v != 0.0) {
            let x = next.between(ends, [Some(sign * values[0]), Some(sign * values[1])]);
            if x <= ends[0] || x >= ends[1] {
                break;
            }
            let v = value(x)?;
            let end = usize::from(v * sign > 0.0);
            (ends[end], values[end]) = (x, v);
        }
        let best = if values[0].abs() <= values[1].abs() { ends[0] } else { ends[1] };
        value(best).map(|_| ())
    }

    /// The slope of an output along an input, with all responses kept by their inputs.
    fn slope(&self, output: usize, along: usize, kept: &[Reach]) -> Result<f64> {
        let find = |reach: &Reach| self.stand().interface().find(&reach.read);
        let held: Vec<usize> = kept.iter().map(find).collect::<Result<_>>()?;
        let by: Vec<usize> = kept.iter().map(|r| self.stand().settable(&r.by)).collect::<Result<_>>()?;
        let outputs = [held, vec![output]].concat();
        let inputs = [by, vec![along]].concat();
        let (_, slopes): (_, DMatrix<f64>) = self.stand().state(&self.values, &outputs, &inputs)?;
        let n = kept.len();
        let own = slopes[(n, n)];
        if n == 0 {
            return Ok(own);
        }
        let by_kept = slopes.view((0, 0), (n, n)).clone_owned();
        let moved = by_kept.lu().solve(&slopes.view((0, n), (n, 1)).clone_owned());
        let moved =
            moved.ok_or_else(|| Error::numeric("the inputs that keep responses do not act on them"))?;
        Ok(own - (0..n).map(|k| slopes[(n, k)] * moved[k]).sum::<f64>())
    }
}
