//! Recorded runs: what they are for, which repeat each other, and what is known of each beside the system.

use crate::cosimulate::{Assignment, Plan};
use crate::model::Value;
use crate::recording::{Recording, read_recording};
use crate::{Error, Result, read_text};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

const RUNS_FILE: &str = "runs.toml";

/// What a run is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Use {
    /// Causes are fitted to it.
    Fit,
    /// Nothing is fitted to it; it confirms.
    Check,
    /// It is not looked at.
    Leave,
}

/// A recorded run.
#[derive(Debug, Clone)]
pub struct Recorded {
    /// Its file.
    pub name: String,
    /// What was recorded.
    pub recording: Recording,
    /// What it is for.
    pub used: Use,
    /// The runs that repeat each other have the same group.
    pub group: String,
    /// What is known of this run: values of the system's parameters.
    pub set: Vec<(String, Value)>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    runs: BTreeMap<String, Use>,
    repeats: Option<BTreeMap<String, Vec<String>>>,
    #[serde(default)]
    set: BTreeMap<String, BTreeMap<String, toml::Value>>,
}

/// True if the recordings in a folder are said to repeat each other.
pub fn has_repeats(folder: &Path) -> bool {
    let read = |path: &Path| read_text(path).ok()?.parse::<toml::Table>().ok();
    read(&folder.join(RUNS_FILE)).is_some_and(|table| table.contains_key("repeats"))
}

/// Reads `runs.toml` in a folder and the recordings that it names: `[runs]` with what each is for, `[repeats]` with lists of runs that repeat each
/// other, and `[set."run.csv"]` with values `"component.variable"` that hold in that run only.
///
/// # Errors
/// A file that cannot be read or says something else, a run of no group or of two.
pub fn read_runs(folder: &Path) -> Result<Vec<Recorded>> {
    let path = folder.join(RUNS_FILE);
    let wrong = |what: String| Error::file(format!("{}: {what}", path.display()));
    let mut file: File = toml::from_str(&read_text(&path)?).map_err(|e| wrong(e.message().to_owned()))?;
    let repeats = file.repeats.unwrap_or_default();
    let mut runs = Vec::new();
    for (name, used) in file.runs.into_iter().filter(|(_, used)| *used != Use::Leave) {
        let groups: Vec<&String> =
            repeats.iter().filter(|(_, runs)| runs.contains(&name)).map(|(group, _)| group).collect();
        let [group] = groups[..] else {
            return Err(wrong(format!(
                "{name} is in {} groups of [repeats], and has to be in one",
                groups.len()
            )));
        };
        let recording = read_recording(&folder.join(&name))?;
        let set = file.set.remove(&name).unwrap_or_default();
        let set = set
            .into_iter()
            .map(|(variable, value)| match Value::from_toml(&value) {
                Ok(value) => Ok((variable, value)),
                Err(what) => Err(wrong(format!("[set.{name:?}] {variable:?}: {what}"))),
            })
            .collect::<Result<_>>()?;
        runs.push(Recorded { name, recording, used, group: group.clone(), set });
    }
    if let Some(name) = file.set.keys().next() {
        return Err(wrong(format!("[set.{name:?}] is of no run")));
    }
    let of = |used: Use| runs.iter().filter(|run| run.used == used).count();
    if of(Use::Fit) < 2 || of(Use::Check) < 2 {
        return Err(wrong(format!(
            "there are {} runs to fit and {} to check; two of each is the least",
            of(Use::Fit),
            of(Use::Check)
        )));
    }
    Ok(runs)
}

impl Recorded {
    /// The system with what is known of this run.
    ///
    /// # Errors
    /// A name of no component.
    pub fn applied(&self, plan: &Plan) -> Result<Plan> {
        let mut plan = plan.clone();
        for (name, value) in &self.set {
            super::correct(&mut plan, name, value.clone()).map_err(|e| e.at(&self.name))?;
        }
        Ok(plan)
    }
}

/// The value that a plan gives a variable of a component.
pub(super) fn given<'a>(set: &'a [Assignment], variable: &str) -> Option<&'a Value> {
    set.iter().rev().find(|assignment| assignment.variable == variable).map(|assignment| &assignment.value)
}
