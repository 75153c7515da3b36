//! Channels that carry each other's name.

use super::against::Table;
use super::{Fault, FaultKind, Severity, run_name, short};
use crate::stats::deviation;
use std::collections::BTreeMap;

/// What may be left of a measured channel beside the simulation of the other one, as a share of its deviation: half of it
/// allows for large model errors. Exchanged channels have it as a geometric mean, as likelihoods multiply: one that rests but for
/// its noise says little, and another beside it may say all.
const LEFT: f64 = 0.5;
/// And of each: one that rests but for its noise leaves 1 beside one that rests, unrelated ones of the same size leave 1.4.
const EACH: f64 = 1.1;
/// And each leaves at most this share of what its own simulation leaves.
const BETTER: f64 = 0.5;
/// A swap in less than half of the runs needs more: narrow-band signals may resemble each other once.
const RARE: f64 = 0.5;

/// Finds permutations of channels, run by run, and undoes them in `table`.
pub fn swapped(table: &mut Table) -> Vec<Fault> {
    let runs = table.measured.len();
    let mut found: BTreeMap<Vec<usize>, Vec<(usize, f64, f64)>> = BTreeMap::new();
    let mut seen: BTreeMap<Vec<usize>, usize> = BTreeMap::new();
    let mut permutations = Vec::new();
    for run in 0..runs {
        let permutation = permutation(table, run);
        permutations.push(permutation);
    }
    for (run, permutation) in permutations.iter().enumerate() {
        let Some((cycle, own, other)) = permutation else { continue };
        let key: Vec<usize> = cycle.keys().copied().collect();
        found.entry(key).or_default().push((run, *own, *other));
    }
    for key in found.keys() {
        let testable = (0..runs).filter(|run| key.iter().all(|c| table.pairs[*c][*run].is_some())).count();
        seen.insert(key.clone(), testable);
    }
    let mut faults = Vec::new();
    for (key, mut hits) in found {
        let often = 2 * hits.len() >= seen.get(&key).copied().unwrap_or(0);
        if !often {
            hits.retain(|(_, own, other)| *other < RARE * LEFT && *other < RARE * BETTER * own);
        }
        if hits.is_empty() {
            continue;
        }
        let names: Vec<&str> = key.iter().map(|c| table.channels[*c].as_str()).collect();
        let (_, own, other) = hits[hits.len() / 2];
        faults.push(Fault {
            kind: FaultKind::SwappedChannels,
            severity: Severity::Fatal,
            runs: hits.iter().map(|h| run_name(&table.measured[h.0].source)).collect(),
            channel: Some(names.join(", ")),
            span: None,
            value: own / other,
            unit: "1".into(),
            evidence: format!(
                "Measured {} agree with each other's simulation in {} of {} run(s): exchanged, {} % of the \
                 deviation is left, as named {} %.",
                names.join(" and "),
                hits.len(),
                seen.get(&key).copied().unwrap_or(0),
                short(100.0 * other),
                short(100.0 * own)
            ),
            advice: "Check cables and channel names; exchange the names in the file or by --map.".into(),
        });
        for (run, ..) in hits {
            let Some((cycle, ..)) = &permutations[run] else { continue };
            let taken: Vec<(usize, Vec<f64>)> = cycle
                .iter()
                .filter_map(|(from, to)| Some((*to, table.pairs[*from][run].as_ref()?.measured.clone())))
                .collect();
            for (to, values) in taken {
                if let Some(pair) = &mut table.pairs[to][run] {
                    pair.measured = values;
                }
            }
        }
    }
    faults
}

/// Which channel's simulation each moved channel agrees with, and the shares left as named and exchanged, geometric means.
fn permutation(table: &Table, run: usize) -> Option<(BTreeMap<usize, usize>, f64, f64)> {
    let present: Vec<usize> = (0..table.channels.len()).filter(|c| table.pairs[*c][run].is_some()).collect();
    let left = |i: usize, j: usize| -> f64 {
        match (&table.pairs[i][run], &table.pairs[j][run]) {
            (Some(y), Some(s)) if y.measured.len() == s.simulated.len() => {
                let rest: Vec<f64> = y.measured.iter().zip(s.simulated).map(|(y, s)| y - s).collect();
                deviation(&rest) / y.size()
            }
            _ => f64::INFINITY,
        }
    };
    let mut moved = BTreeMap::new();
    let (mut all_own, mut all_other) = (1.0, 1.0);
    for &i in &present {
        let own = left(i, i);
        let Some((j, other)) = present.iter().map(|j| (*j, left(i, *j))).min_by(|a, b| a.1.total_cmp(&b.1))
        else {
            continue;
        };
        if j != i && other < EACH && other < BETTER * own {
            moved.insert(i, j);
            all_own *= own;
            all_other *= other;
        }
    }
    // a permutation: what goes comes from somewhere
    let mut targets: Vec<usize> = moved.values().copied().collect();
    targets.sort_unstable();
    let sources: Vec<usize> = moved.keys().copied().collect();
    let mean = |product: f64| product.powf(1.0 / moved.len().max(1) as f64);
    let (own, other) = (mean(all_own), mean(all_other));
    (!moved.is_empty() && targets == sources && other < LEFT).then_some((moved, own, other))
}
