//! What the tests of faults share: random numbers, runs that were measured and simulated, and both looks at them.

mod channels;
mod rates;
mod some_runs;
mod units;
mod values_alone;

use super::*;
use crate::recording::{Channel, Recording};
use crate::stats::SplitMix64;

/// Every seed is another case.
struct Random(SplitMix64);

impl Random {
    fn new(seed: u64) -> Self {
        Self(SplitMix64::new(seed))
    }
    fn next(&mut self) -> f64 {
        self.0.uniform()
    }
    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
    fn below(&mut self, n: usize) -> usize {
        (self.next() * n as f64) as usize
    }
    fn normal(&mut self) -> f64 {
        self.0.normal()
    }
}

/// Measured runs, their simulations, and the names of the outputs.
struct Case {
    measured: Vec<Recording>,
    simulated: Vec<Recording>,
    channels: Vec<String>,
}

fn values<'a>(recording: &'a mut Recording, name: &str) -> &'a mut Vec<f64> {
    &mut recording.channels.iter_mut().find(|c| c.name == name).unwrap().values
}

/// All faults more than notes, of both looks, as the diagnosis would ask for them.
fn faults(case: &Case) -> Vec<Fault> {
    let raw: Vec<RawRecording> =
        case.measured.iter().map(|r| RawRecording::new(r.clone()).unwrap()).collect();
    let mut faults = faults_of_runs(&raw.iter().collect::<Vec<_>>());
    let at = |simulated: &Recording, times: &[f64]| Recording {
        time: times.to_vec(),
        channels: simulated
            .channels
            .iter()
            .map(|c| Channel {
                values: times
                    .iter()
                    .map(|t| {
                        let last = simulated.time[simulated.time.len() - 1];
                        crate::recording::interpolate(
                            &simulated.time,
                            &c.values,
                            t.clamp(simulated.time[0], last),
                        )
                    })
                    .collect(),
                ..c.clone()
            })
            .collect(),
        source: simulated.source.clone(),
    };
    let measured: Vec<Recording> = raw.into_iter().map(|r| r.recording).collect();
    let simulated: Vec<Recording> =
        case.simulated.iter().zip(&measured).map(|(s, m)| at(s, &m.time)).collect();
    faults.extend(faults_against(&measured, &simulated, &case.channels));
    faults.retain(Fault::counts);
    faults
}

/// Runs of one channel: what a simulation has, and what was measured.
fn channel_of(runs: &[(Vec<f64>, Vec<f64>)]) -> [Vec<Recording>; 2] {
    let side = |which: usize| {
        let recording = |(i, run): (usize, &(Vec<f64>, Vec<f64>))| {
            let values = if which == 0 { run.0.clone() } else { run.1.clone() };
            Recording {
                time: (0..values.len()).map(|k| 0.01 * k as f64).collect(),
                channels: vec![Channel { name: "wheel_speed".into(), unit: "rad/s".into(), values }],
                source: format!("run-{i}.csv"),
            }
        };
        runs.iter().enumerate().map(recording).collect()
    };
    [side(0), side(1)]
}
