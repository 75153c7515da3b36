//! All tests of a plan, and what they say.

use super::independence::{Dependence, Search, depends, influence};
use super::injectivity::{Injectivity, injective};
use super::response::{Response, responds};
use super::samples::{Sampled, Sampling};
use crate::Result;
use crate::identify::Readings;
use serde::Serialize;
use std::fmt;

/// What the tests say of a plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// What the plan looks for.
    pub parameters: Vec<String>,
    /// What it reads.
    pub targets: Vec<String>,
    /// By how much of its range each target (row) changes with each parameter (column), at most.
    pub influence: Vec<Vec<f64>>,
    /// The groups.
    pub groups: Vec<GroupReport>,
    /// How many draws of all parameters there were, and at how many of them all conditions could be met.
    pub computed: [usize; 2],
}

/// What they say of a group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GroupReport {
    /// Its name.
    pub name: String,
    /// Numbers of its first parameter and of the next group's.
    pub range: [usize; 2],
    /// A dependence on parameters of later groups: a counter-example.
    pub dependence: Option<Dependence>,
    /// How many pairs of points were compared for one.
    pub compared: usize,
    /// Whether it has one answer.
    pub injectivity: Injectivity,
    /// In which order and with which signs it can be searched; nothing if no order has one set of signs.
    pub response: Option<Response>,
}

/// Tests a plan: every group for independence of later parameters, for one answer, and for the signs of its targets.
///
/// # Errors
/// The targets cannot be computed anywhere.
pub fn check(readings: &Readings<'_>, sampling: &Sampling) -> Result<Report> {
    let sampled = Sampled::new(readings, *sampling)?;
    let plan = readings.plan();
    let parameters: Vec<String> =
        plan.groups.iter().flat_map(|g| &g.parameters).map(|p| p.name.clone()).collect();
    let mut groups = Vec::new();
    let mut from = 0;
    for group in &plan.groups {
        let to = from + group.parameters.len();
        let (own, later): (Vec<usize>, Vec<usize>) = ((from..to).collect(), (to..parameters.len()).collect());
        let Search { dependence, compared } = depends(&sampled, &own, &later);
        groups.push(GroupReport {
            name: group.name.clone(),
            range: [from, to],
            dependence,
            compared,
            injectivity: injective(&sampled, &own, &own)?,
            response: responds(&sampled, &own, &own)?,
        });
        from = to;
    }
    let influence = influence(&sampled).row_iter().map(|row| row.iter().copied().collect()).collect();
    Ok(Report {
        parameters,
        targets: plan.groups.iter().flat_map(|g| &g.targets).map(|t| t.name.clone()).collect(),
        influence,
        groups,
        computed: sampled.computed,
    })
}

impl Report {
    /// A counter-example was found: the plan does not do what it promises.
    pub fn is_refuted(&self) -> bool {
        let refuted =
            |g: &GroupReport| g.dependence.is_some() || matches!(g.injectivity, Injectivity::Refuted { .. });
        self.groups.iter().any(refuted)
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [draws, computed] = self.computed;
        writeln!(
            f,
            "Conditions met at {computed} of {draws} draws of all parameters within their bounds.\n"
        )?;
        writeln!(f, "Influence of parameters (columns) on targets (rows), as a share of a target's range:")?;
        let widest = self.targets.iter().map(|t| t.chars().count()).max().unwrap_or(0);
        for (row, target) in self.influence.iter().zip(&self.targets) {
            write!(f, "  {target:widest$} ")?;
            for share in row {
                match share {
                    0.0 => write!(f, "     .")?,
                    s if *s < 1e-3 => write!(f, "  <.001")?,
                    s => write!(f, "  {s:4.2}")?,
                }
            }
            writeln!(f)?;
        }
        for (k, parameter) in self.parameters.iter().enumerate() {
            writeln!(f, "  column {:2}: {parameter}", k + 1)?;
        }
        for (number, group) in self.groups.iter().enumerate() {
            writeln!(f, "\nGroup {}: {}", number + 1, group.name)?;
            match &group.dependence {
                None if group.range[1] == self.parameters.len() => {
                    writeln!(f, "  there are no later parameters")?
                }
                None => writeln!(
                    f,
                    "  independent of later parameters: no counter-example in {} pairs (evidence)",
                    group.compared
                )?,
                Some(d) => writeln!(
                    f,
                    "  NOT independent (proof): \"{}\" differs by {:.1e} of its range between\n    {:?}\n    {:?}",
                    self.targets[d.target], d.change, d.points[0], d.points[1]
                )?,
            }
            match &group.injectivity {
                Injectivity::Refuted { points: [a, b] } => {
                    writeln!(f, "  NOT unique (proof): the same targets at\n    {a:?}\n    {b:?}")?;
                }
                Injectivity::Open { orthants, .. } => {
                    let open = orthants.iter().filter(|o| o.margin <= 0.0).count();
                    writeln!(
                        f,
                        "  one answer: open. No two answers were found, but the half-space criterion fails in {open} of {} orthants; it is sufficient, not necessary",
                        orthants.len()
                    )?;
                }
                Injectivity::Passed { orthants, points } => {
                    let least = orthants.iter().map(|o| o.margin).fold(f64::INFINITY, f64::min);
                    writeln!(
                        f,
                        "  one answer: the half-space criterion holds at {points} points and more, with a margin of {least:.2} (evidence)"
                    )?;
                }
            }
            match &group.response {
                None => writeln!(f, "  search: no order of its parameters has one set of signs")?,
                Some(Response { nesting, tail }) => {
                    let name = |k: &usize| self.parameters[group.range[0] + k].as_str();
                    let order: Vec<&str> = nesting.parameters.iter().map(name).collect();
                    let how = if tail.is_some() { ", the last two together" } else { "" };
                    writeln!(
                        f,
                        "  search: nested bisection in the order {}{how} (evidence)",
                        order.join(" > ")
                    )?;
                }
            }
        }
        Ok(())
    }
}
