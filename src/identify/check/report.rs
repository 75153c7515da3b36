//! All tests of a plan, and what they say.

use super::closed_form::{ClosedForm, closed_form};
use super::independence::{Dependence, Search, depends};
use super::injectivity::{Injectivity, Orthant};
use super::next_group::{Choice, Finder};
use super::response::{self, Response};
use super::samples::{Sampled, Sampling};
use crate::Result;
use crate::identify::Readings;
use serde::Serialize;

/// What the tests say of a plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// What the plan is.
    pub title: String,
    /// The model on which it was tested.
    pub model: String,
    /// What the plan looks for.
    pub parameters: Vec<String>,
    /// What it reads.
    pub targets: Vec<String>,
    /// By how much of its range each target (row) changes with each parameter (column), at most; nothing where no two points could be
    /// compared.
    pub influence: Vec<Vec<Option<f64>>>,
    /// The groups.
    pub groups: Vec<GroupReport>,
    /// The order in which influence and the test for one answer alone would use the targets.
    pub choice: Choice,
    /// How much was tried.
    pub sampling: Sampling,
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
    /// What became of its closed form, if it has one.
    pub closed_form: Option<ClosedForm>,
    /// In which order and with which signs it can be searched; nothing if no order has one set of signs.
    pub response: Option<Response>,
    /// Whether the signs that the plan states are those of all points that were tried; nothing if it states none.
    pub states_its_signs: Option<bool>,
}

/// How much a test says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// There is a counter-example: a proof that it does not hold.
    Refuted,
    /// It holds at all points that were tried: evidence, not proof.
    Passed,
    /// Neither.
    Open,
}

/// Tests a plan: every group for independence of later parameters, for one answer, and for the signs of its targets; and the order
/// in which the targets could be used.
///
/// # Errors
/// The targets cannot be computed anywhere.
pub fn check(readings: &Readings<'_>, sampling: &Sampling) -> Result<Report> {
    let sampled = Sampled::new(readings, *sampling)?;
    let finder = Finder::new(&sampled);
    let plan = readings.plan();
    let parameters: Vec<String> =
        plan.groups.iter().flat_map(|g| &g.parameters).map(|p| p.name.clone()).collect();
    let (mut groups, mut places) = (Vec::new(), Vec::new());
    let mut from = 0;
    for (number, group) in plan.groups.iter().enumerate() {
        let to = from + group.parameters.len();
        let (own, later): (Vec<usize>, Vec<usize>) = ((from..to).collect(), (to..parameters.len()).collect());
        let Search { dependence, compared } = depends(&sampled, &own, &later);
        let slopes = response::slopes(&sampled, &own, &own)?;
        let stated = group.nesting.is_some().then(|| {
            let (nesting, tail) = group.search();
            response::responds_as(&slopes, &Response { nesting, tail })
        });
        groups.push(GroupReport {
            name: group.name.clone(),
            range: [from, to],
            dependence,
            compared,
            injectivity: finder.injective(&own, &own)?,
            closed_form: closed_form(readings, &sampled, number, &own)?,
            response: response::found(&slopes, own.len()),
            states_its_signs: stated,
        });
        places.push(own);
        from = to;
    }
    let cell = |share: &f64| (!share.is_nan()).then_some(*share);
    Ok(Report {
        title: plan.title.clone(),
        model: readings.model().to_owned(),
        parameters,
        targets: plan.groups.iter().flat_map(|g| &g.targets).map(|t| t.name.clone()).collect(),
        influence: finder.influence().row_iter().map(|row| row.iter().map(cell).collect()).collect(),
        groups,
        choice: finder.choose(&places)?,
        sampling: *sampling,
        computed: sampled.computed,
    })
}

impl Report {
    /// A counter-example was found: the plan does not do what it promises.
    pub fn is_refuted(&self) -> bool {
        let refuted = |g: &GroupReport| {
            g.dependence.is_some()
                || matches!(g.injectivity, Injectivity::Refuted { .. })
                || g.closed_form.as_ref().is_some_and(|c| c.counter_example.is_some())
        };
        self.groups.iter().any(refuted)
    }

    /// Whether a group depends on parameters of later ones; nothing if there are none.
    pub fn independence(&self, group: &GroupReport) -> Option<Standing> {
        match (&group.dependence, group.compared) {
            (Some(_), _) => Some(Standing::Refuted),
            (None, _) if group.range[1] == self.parameters.len() => None,
            // nothing was tested
            (None, 0) => Some(Standing::Open),
            (None, _) => Some(Standing::Passed),
        }
    }

    /// The number of the plan's group that consists of these targets and parameters.
    pub fn group_of(&self, targets: &[usize], parameters: &[usize]) -> Option<usize> {
        self.groups.iter().position(|group| {
            let own: Vec<usize> = (group.range[0]..group.range[1]).collect();
            own == targets && own == parameters
        })
    }
}

impl Injectivity {
    /// How much it says.
    pub fn standing(&self) -> Standing {
        match self {
            Self::Refuted { .. } => Standing::Refuted,
            Self::Passed { .. } => Standing::Passed,
            Self::Open { .. } => Standing::Open,
        }
    }

    /// The orthants that were tested; none if there is a counter-example.
    pub fn orthants(&self) -> &[Orthant] {
        match self {
            Self::Refuted { .. } => &[],
            Self::Passed { orthants, .. } | Self::Open { orthants, .. } => orthants,
        }
    }

    /// The least margin of all orthants: positive if the half-space criterion holds.
    pub fn margin(&self) -> Option<f64> {
        self.orthants().iter().map(|o| o.margin).reduce(f64::min)
    }
}
