//! Faults of a session's recordings: what happens between sensor and file, in some runs.

use super::session::FORCES;
use crate::fault::{Struck, Tables};
use crate::random::Random;

/// The faults, one case each.
pub(crate) const FAULTS: [&str; 4] = ["swapped", "sign", "unit", "time-gap"];

/// Puts a fault in.
pub(crate) fn spoil(tables: &mut Tables, name: &str, random: &mut Random) -> Struck {
    if name == "time-gap" {
        let offered: Vec<usize> = (0..FORCES).collect();
        return tables.spoil(name, &offered, random);
    }
    let channel = random.below(FORCES);
    let other = (channel + 1 + random.below(FORCES - 1)) % FORCES;
    let (one, two) = (tables.inputs + channel, tables.inputs + other);
    // not the runs in which nothing rolls: there channels are silent, and a reversed silence is none
    let mut runs: Vec<usize> = (2..tables.columns.len()).collect();
    random.shuffle(&mut runs);
    runs.sort_by(|a, b| busy(&tables.columns[*b][one]).total_cmp(&busy(&tables.columns[*a][one])));
    runs.truncate(if name == "swapped" { 4 } else { 1 });
    // thousandths of a kilo-unit, or a handbook's units
    let factor = match name {
        "sign" => -1.0,
        _ => random.pick(&[1e-3, 4.448_222, 1.0 / 9.806_65, 9.806_65]),
    };
    for run in &runs {
        let columns = &mut tables.columns[*run];
        if name == "swapped" {
            columns.swap(one, two);
        } else {
            columns[one].iter_mut().for_each(|v| *v *= factor);
        }
    }
    runs.sort_unstable();
    let channels = if name == "swapped" { vec![channel, other] } else { vec![channel] };
    Struck { channels, runs }
}

/// How much a channel moves: the mean of its changes from sample to sample would be noise, its span is not.
fn busy(values: &[f64]) -> f64 {
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    high - low
}
