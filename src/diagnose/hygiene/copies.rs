//! Runs that are copies of each other.

use super::{Fault, FaultKind, Severity, run_name};
use crate::recording::Recording;
use std::collections::HashSet;

/// Share of equal samples that makes a copy; single cells may have been mended.
const EQUAL: f64 = 0.99;
/// Fewer different values than this prove nothing: two runs may both be at rest.
const LEVELS: usize = 30;

/// Pairs of runs that are equal sample by sample in all their channels.
pub fn copies(runs: &[&Recording]) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut known = HashSet::new();
    for (i, a) in runs.iter().enumerate() {
        if known.contains(&i) {
            continue;
        }
        let same: Vec<usize> = (i + 1..runs.len()).filter(|j| equal(a, runs[*j])).collect();
        if same.is_empty() {
            continue;
        }
        known.extend(same.iter().copied());
        let names: Vec<String> =
            std::iter::once(*a).chain(same.iter().map(|j| runs[*j])).map(|r| run_name(&r.source)).collect();
        faults.push(Fault {
            kind: FaultKind::DuplicatedRun,
            severity: Severity::Fatal,
            value: names.len() as f64,
            unit: "1".into(),
            evidence: format!(
                "The runs {} are equal sample by sample in all channels; two measurements never are.",
                names.join(", ")
            ),
            advice: format!(
                "Keep {} only: copies make a fit look surer than it is and a check on them worthless.",
                names[0]
            ),
            runs: names,
            channel: None,
            span: None,
        });
    }
    faults
}

fn equal(a: &Recording, b: &Recording) -> bool {
    let rows = a.time.len().min(b.time.len());
    if a.channels.len() != b.channels.len() || (rows as f64) < EQUAL * a.time.len().max(b.time.len()) as f64 {
        return false;
    }
    let mut levels = 0;
    for channel in &a.channels {
        let Some(other) = b.channels.iter().find(|c| c.name == channel.name) else { return false };
        // before it is looked at in full
        let same = channel.values.iter().zip(&other.values).filter(|(a, b)| a == b).count();
        if (same as f64) < EQUAL * rows as f64 {
            return false;
        }
        let different: HashSet<u64> = channel.values.iter().map(|v| v.to_bits()).take(4000).collect();
        levels = levels.max(different.len());
    }
    levels >= LEVELS
}
