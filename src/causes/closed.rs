//! The closed loop beside the repeats, before and after what was found: by what counts for damage, because errors over time rank nothing there.

use super::part::{along, follow, step};
use super::runs::Recorded;
use crate::Result;
use crate::cosimulate::Plan;
use crate::loads::{Conditions, compare};
use crate::recording::{Channel, Recording};
use serde::Serialize;

/// Slope of the S-N line that damage is compared with: links and welds.
const SLOPE: f64 = 5.0;
/// Movements below this share of the recorded span are no cycles: noise.
const GATE: f64 = 0.05;
const CLASSES: usize = 64;

/// A group of runs that repeat each other, beside the closed loop.
#[derive(Debug, Clone, Serialize)]
pub struct ClosedLoop {
    /// The group.
    pub group: String,
    /// How many runs it has.
    pub runs: usize,
    /// Quantities that were compared: extremes, cycles, ranges, crossings, damage of each force.
    pub quantities: usize,
    /// How many of them are outside of the band in which a further recording would be, before and after.
    pub outside: [usize; 2],
    /// Of each force: its name, damage over that of the mean recording, before and after.
    pub damage: Vec<(String, [f64; 2])>,
}

/// Runs both systems as the first run of each group was driven.
///
/// # Errors
/// A system that does not run, recordings that cannot be compared.
pub fn closed_loops(before: &Plan, after: &Plan, runs: &[Recorded]) -> Result<Vec<ClosedLoop>> {
    let mut groups: Vec<&str> = Vec::new();
    for run in runs {
        if !groups.contains(&run.group.as_str()) {
            groups.push(&run.group);
        }
    }
    let mut all = Vec::new();
    for group in groups {
        let repeats: Vec<&Recorded> = runs.iter().filter(|run| run.group == group).collect();
        if repeats.len() < 2 {
            continue;
        }
        all.push(one(before, after, group, &repeats)?);
    }
    Ok(all)
}

fn one(before: &Plan, after: &Plan, group: &str, repeats: &[&Recorded]) -> Result<ClosedLoop> {
    let end =
        repeats.iter().filter_map(|run| run.recording.time.last().copied()).fold(f64::INFINITY, f64::min);
    let forces = |name: &str| name.contains("_force");
    let recorded: Vec<Recording> = repeats
        .iter()
        .map(|run| {
            let mut recording = run.recording.clone();
            recording.channels.retain(|c: &Channel| forces(&c.name));
            recording
        })
        .collect();
    let conditions = Conditions {
        channels: Vec::new(),
        slope: SLOPE,
        gate: GATE,
        classes: CLASSES,
        event: None,
        window: Some([recorded[0].time[0], end]),
        over: None,
    };
    let mut outside = [0, 0];
    let mut quantities = 0;
    let mut damage: Vec<(String, [f64; 2])> = Vec::new();
    for (side, plan) in [before, after].into_iter().enumerate() {
        let simulated = driven(plan, repeats[0], end)?;
        let (all, _) = compare(&simulated, &recorded, &conditions)?;
        quantities = 0;
        for one in &all {
            for (name, band) in one.bands() {
                quantities += 1;
                outside[side] += usize::from(band.off().is_some_and(|off| off.abs() > 1.0));
                if name == "damage" {
                    let over =
                        band.simulated / crate::stats::mean_or_zero(&band.recorded).max(f64::MIN_POSITIVE);
                    match damage.iter_mut().find(|(own, _)| *own == one.name) {
                        Some((_, both)) => both[side] = over,
                        None => damage.push((one.name.clone(), [over, f64::NAN])),
                    }
                }
            }
        }
    }
    Ok(ClosedLoop { group: group.to_owned(), runs: repeats.len(), quantities, outside, damage })
}

/// A system driven as a run was.
fn driven(plan: &Plan, run: &Recorded, end: f64) -> Result<Recording> {
    let mut plan = run.applied(plan)?;
    let inputs = std::mem::take(&mut plan.inputs);
    let mut system = plan.load()?;
    for (channel, to) in inputs.iter().flat_map(|inputs| &inputs.connect) {
        let port = system.port(&to.component, &to.variable)?;
        follow(&mut system, port, (&run.recording, channel), |course| course, 0.0)?;
    }
    let end = run.recording.time.partition_point(|t| *t <= end);
    along(&mut system, &run.recording, end, step(&plan)?)
}
