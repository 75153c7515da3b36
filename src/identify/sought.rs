//! What a plan looks for, and the parameters of the model that it gives values.

use super::plan::{GroupPlan, Solver};
use super::readings::Readings;
use super::registry::Numbers;
use super::solve::{Method, Nesting, Tail, Way};
use crate::{Error, Result};

impl Readings<'_> {
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

    /// How it is solved where there is no closed form.
    pub(super) fn way(&self) -> Way<'static> {
        let (nesting, tail) = self.search();
        match self.solver {
            None => Way::Nested { nesting, tail, descends: true },
            Some(Solver::NestedBisection) => Way::Nested { nesting, tail, descends: false },
            Some(Solver::Newton) => Way::Local(Method::Newton),
            Some(Solver::Gradient) => Way::Local(Method::Gradient),
        }
    }
}
