//! Recordings beside simulations of the same runs.

use super::align::Pair;
use super::{Fault, clock, odd, swap, unit_sign};
use crate::diagnose::numbers::RESOLUTION;
use crate::recording::Recording;
use crate::stats::{deviation, mean};

/// What is looked at: every measured output of every run beside its simulation.
pub struct Table<'a> {
    /// The measured recordings, with the inputs among their channels.
    pub measured: &'a [Recording],
    /// The names of the outputs.
    pub channels: &'a [String],
    /// `pairs[channel][run]`; `None` where there is nothing to compare.
    pub pairs: Vec<Vec<Option<Pair<'a>>>>,
}

impl Table<'_> {
    /// The unit of output number `channel`.
    pub fn unit(&self, channel: usize) -> &str {
        self.measured
            .iter()
            .find_map(|r| r.channels.iter().find(|c| c.name == self.channels[channel]))
            .map_or("1", |c| c.unit.as_str())
    }
}

/// Faults of `measured` that show beside simulations of the same runs (`simulated[i]` belongs to
/// `measured[i]`: the same times, the outputs `channels` in the same units). Channels of `measured` that
/// are not in `channels` count as operating conditions. Runs whose simulation is not finite or of another
/// length are not looked at.
///
/// Swapped channels are looked for first, then sign and unit, then what single runs have, then clocks;
/// what one look finds is taken out before the next.
pub fn faults_against(measured: &[Recording], simulated: &[Recording], channels: &[String]) -> Vec<Fault> {
    let simulated: Vec<Recording> = measured.iter().zip(simulated).map(|(m, s)| at_rest(m, s)).collect();
    let pairs = channels
        .iter()
        .map(|name| {
            measured.iter().zip(&simulated).enumerate().map(|(i, (m, s))| Pair::new(i, m, s, name)).collect()
        })
        .collect();
    let mut table = Table { measured, channels, pairs };
    let mut faults = swap::swapped(&mut table);
    faults.extend(unit_sign::units_and_signs(&mut table));
    faults.extend(odd::odd_runs(&mut table));
    faults.extend(clock::drifts(&table));
    faults
}

/// The simulation with constants for channels that move by rounding alone beside what was measured: these have neither unit nor time.
fn at_rest(measured: &Recording, simulated: &Recording) -> Recording {
    let mut simulated = simulated.clone();
    for channel in &mut simulated.channels {
        let moved = measured.channel(&channel.name).map_or(0.0, |c| deviation(&c.values));
        if deviation(&channel.values) <= RESOLUTION * moved {
            let level = mean(&channel.values);
            channel.values.fill(level);
        }
    }
    simulated
}
