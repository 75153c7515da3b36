//! A plan on a stand: its targets as functions of what it looks for.

use super::named::{after_ramp, no_slope};
use super::plan::{Condition, GroupPlan, Limit, Plan, Target, Touch};
use super::registry::{Inversion, Numbers, Registry};
use super::setup::{Reading, Setup};
use super::solve::{Goal, Group, Part, Sequence, Targets, Unsolved, Way, sequence};
use super::stand::{Stand, number};
use crate::model::Causality;
use crate::{Error, Result};
use nalgebra::DMatrix;
use std::cell::RefCell;
use std::collections::BTreeMap;

/// A plan with a stand on which its conditions are met.
pub struct Readings<'a> {
    pub(super) plan: &'a Plan,
    pub(super) stand: &'a Stand,
    pub(super) registry: Registry,
    /// Values of the model's parameters before any is found.
    pub(super) base: Numbers,
    /// Those that the slave starts with by itself.
    pub(super) own: Numbers,
    pub(super) bounds: Vec<[f64; 2]>,
    /// Where inputs brought responses about last, by condition: a search begins there.
    pub(super) reached: RefCell<BTreeMap<String, Vec<f64>>>,
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
                None => group.way(),
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
