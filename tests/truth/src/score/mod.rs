//! The score: diagnoses against sealed answers, as the table of the study.

mod diagnosis;
mod judge;
mod table;
mod wilson;

pub use diagnosis::{Check, Diagnosis, Fault, Finding, Parameter, RunUse};
pub use judge::{Judgement, Timing, judge};
pub use table::report;
pub use wilson::Share;

use crate::answer::{Answer, Reference};
use serde::de::DeserializeOwned;
use std::path::Path;

/// Judges every case that has an answer in `answers`; diagnoses are in `results/CASE/diagnosis.json`, times in
/// `results/CASE/timing.json`.
///
/// # Errors
/// A folder or answer that cannot be read. A diagnosis that cannot be read counts as none.
pub fn judge_all(answers: &Path, results: &Path) -> Result<Vec<Judgement>, String> {
    let list = std::fs::read_dir(answers).map_err(|e| format!("{}: {e}", answers.display()))?;
    let mut names: Vec<String> = list
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter_map(|name| Some(name.strip_suffix(".json")?.to_owned()))
        .filter(|name| !name.ends_with(".reference"))
        .collect();
    names.sort();
    names
        .into_iter()
        .map(|name| {
            let answer: Answer = read(&answers.join(format!("{name}.json")))?;
            let reference: Reference = read(&answers.join(format!("{name}.reference.json")))?;
            let folder = results.join(&name);
            let mut timing: Timing = read(&folder.join("timing.json")).unwrap_or_default();
            let diagnosis = read::<Diagnosis>(&folder.join("diagnosis.json"));
            if let (Err(message), None) = (&diagnosis, &timing.failure) {
                timing.failure = Some(message.clone());
            }
            Ok(judge(answer, &reference, diagnosis.ok().as_ref(), &timing))
        })
        .collect()
}

fn read<T: DeserializeOwned>(path: &Path) -> Result<T, String> {
    let text = std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
    serde_json::from_str(&text).map_err(|e| format!("{}: {e}", path.display()))
}

#[cfg(test)]
mod tests;
