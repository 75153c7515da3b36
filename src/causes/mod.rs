//! Which physics of a wired vehicle differs from recorded stops, found by opening loops: pads by themselves at the recorded pressure, hydraulics
//! and controller at the recorded wheel speeds, the vehicle under the recorded torques.
//!
//! After the chain of G. Mack (2009), chapter 6.4: a loop that decides by itself parts from its recording after the first decision, however right the
//! model is, because the road's friction scatters; opened, each part follows its recorded inputs, and what it then does otherwise is its own. The scatter of
//! the friction is followed as well: each wheel has the factor on its friction with which its slip is the recorded one, and these four factors are channels,
//! whose expected value is one. What is left beyond that of all channels is explained by one cause after the other, a parameter of the system or a pair
//! that belongs together ([`Cause`]), in as far as every run agrees, those for checking and on other roads too.

mod cause;
mod closed;
mod evidence;
mod hydraulics;
mod pad_friction;
mod pads;
mod part;
mod runs;
mod vehicle;

pub use cause::Cause;
pub use closed::{ClosedLoop, closed_loops};
pub use evidence::{Candidate, Change, Found, OnRoad};
pub use pad_friction::{PadFriction, pad_friction, pad_friction_csv, pad_frictions};
pub use runs::{Recorded, Use, has_repeats, read_runs};

use crate::cosimulate::{Assignment, Plan};
use crate::{Error, Result};
use evidence::search;
use hydraulics::{Hydraulics, Until};
use part::Part;
use serde::Serialize;

/// What is said of one part.
#[derive(Debug, Clone, Serialize)]
pub struct PartFindings {
    /// The part and how it was opened.
    pub part: String,
    /// Causes, in the order in which they were found.
    pub found: Vec<Found>,
    /// What was looked at beside and not named, the one that explains most first.
    pub left: Vec<Candidate>,
    /// What is otherwise on one road only, in the runs of one group.
    pub of_roads: Vec<OnRoad>,
    /// Causes that these recordings do not show, with what would.
    pub hidden: Vec<Hidden>,
}

/// A cause that recordings do not show.
#[derive(Debug, Clone, Serialize)]
pub struct Hidden {
    /// The cause.
    pub id: &'static str,
    /// Its name for people.
    pub title: &'static str,
    /// What manoeuvre would show it.
    pub shown_by: &'static str,
}

/// Finds causes, part after part, with so many runs simulated at the same time (0: as many as there are cores). `progress` is told what is done now.
///
/// # Errors
/// A system that is no vehicle with brakes as the parts need it, recordings without the channels that they need, models that do not run.
pub fn find(
    plan: &Plan,
    runs: &[Recorded],
    jobs: usize,
    progress: &mut dyn FnMut(&str),
) -> Result<Vec<PartFindings>> {
    let mut findings = Vec::new();
    let mut corrected = plan.clone();
    let vehicle = vehicle::Vehicle::new(&corrected, runs)?;
    progress("the vehicle under the recorded torques");
    findings.push(one(vehicle, &mut corrected, jobs)?);
    if let Some(pads) = pads::Pads::new(&corrected, runs)? {
        progress("pads at the recorded pressure");
        findings.push(one(pads, &mut corrected, jobs)?);
    }
    for until in [Until::FirstDecision, Until::Slow] {
        if let Some(hydraulics) = Hydraulics::new(&corrected, runs, until)? {
            progress("hydraulics and controller at the recorded wheel speeds");
            findings.push(one(hydraulics, &mut corrected, jobs)?);
        }
    }
    Ok(findings)
}

/// Searches a part and corrects the system by what was found.
fn one(part: impl Part, corrected: &mut Plan, jobs: usize) -> Result<PartFindings> {
    let findings = search(&part, jobs)?;
    for found in &findings.found {
        // a recorded input is no parameter
        for change in found.changes.iter().filter(|change| change.name.contains('.')) {
            correct(corrected, &change.name, change.value.clone())?;
        }
    }
    Ok(findings)
}

/// Sets a value of a plan.
///
/// # Errors
/// No such component.
pub fn correct(plan: &mut Plan, name: &str, value: crate::model::Value) -> Result<()> {
    let place = "found in recordings".to_owned();
    let (component, variable) = name
        .split_once('.')
        .ok_or_else(|| Error::variable(format!("{name:?} is no name of a part's variable")))?;
    let part = plan.components.iter_mut().find(|c| c.name == component);
    let part = part.ok_or_else(|| Error::variable(format!("there is no component {component:?}")))?;
    part.set.retain(|assignment| assignment.variable != variable);
    part.set.push(Assignment { variable: variable.to_owned(), value, place });
    Ok(())
}
