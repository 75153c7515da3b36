//! Faults of a recording: what happens to tables between sensor and file.

use crate::random::Random;

/// Runs as tables: true stamps and columns. Only columns from `outputs` on are measured ones.
#[derive(Debug, Clone, PartialEq)]
pub struct Tables {
    /// Per run its time stamps.
    pub stamps: Vec<Vec<f64>>,
    /// Per run, per column.
    pub columns: Vec<Vec<Vec<f64>>>,
    /// Number of columns that are inputs.
    pub inputs: usize,
}

/// What a fault struck: measured channels and runs, counted from 0. No channels where it struck all that was recorded, no runs
/// where it is in all of them.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Struck {
    /// Measured channels.
    pub channels: Vec<usize>,
    /// Runs.
    pub runs: Vec<usize>,
}

/// The names of the faults.
pub const FAULTS: [&str; 12] = [
    "time-gap",
    "time-jump",
    "unit",
    "sign",
    "swapped",
    "stuck",
    "saturated",
    "offset",
    "delay",
    "clock-drift",
    "spikes",
    "duplicated",
];

fn range(values: &[f64]) -> f64 {
    let fold = |f: fn(f64, f64) -> f64, start| values.iter().copied().fold(start, f);
    fold(f64::max, f64::NEG_INFINITY) - fold(f64::min, f64::INFINITY)
}

/// The value at the place `at` (in samples), straight between them.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss)] // within the list
fn sampled(values: &[f64], at: f64) -> f64 {
    let at = at.clamp(0.0, values.len() as f64 - 1.0);
    let k = (at as usize).min(values.len().saturating_sub(2));
    values[k] + (values[k + 1] - values[k]) * (at - k as f64)
}

impl Tables {
    fn busy_run(&self, random: &mut Random, column: usize) -> usize {
        let runs: Vec<usize> = (0..self.stamps.len()).collect();
        let most = runs.iter().map(|r| range(&self.columns[*r][column])).fold(0.0, f64::max);
        let busy: Vec<usize> =
            runs.into_iter().filter(|r| range(&self.columns[*r][column]) >= 0.4 * most).collect();
        random.pick(&busy)
    }

    /// Some runs: about a third, at least one, never all.
    fn some_runs(&self, random: &mut Random) -> Vec<usize> {
        let mut runs: Vec<usize> = (0..self.stamps.len()).collect();
        random.shuffle(&mut runs);
        runs.truncate((self.stamps.len() / 3).max(2));
        runs
    }

    /// Puts the fault `name` in; `offered` are the measured columns that it may strike.
    #[allow(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::too_many_lines
    )]
    pub fn spoil(&mut self, name: &str, offered: &[usize], random: &mut Random) -> Struck {
        let column = self.inputs + random.pick(offered);
        let run = self.busy_run(random, column);
        let length = self.stamps[run].len();
        let place = random.below(length / 2) + length / 4;
        let measured = column - self.inputs;
        let mut struck = Struck { channels: vec![measured], runs: vec![run] };
        let all = |tables: &Self| tables.columns.iter().map(|c| range(&c[column])).fold(0.0, f64::max);
        match name {
            "time-gap" => {
                let count = length / 12 + random.below(length / 12);
                self.stamps[run].drain(place..place + count);
                for values in &mut self.columns[run] {
                    values.drain(place..place + count);
                }
                struck.channels.clear();
            }
            "time-jump" => {
                let back = random.within(0.1, 0.5);
                for stamp in &mut self.stamps[run][place..] {
                    *stamp -= back;
                }
                struck.channels.clear();
            }
            "unit" => {
                let factor = random.pick(&[
                    1e-3,
                    1e3,
                    3.6,
                    1.0 / 3.6,
                    180.0 / std::f64::consts::PI,
                    9.81,
                    0.453_592_37,
                ]);
                self.each(column, |v| v * factor);
                struck.runs.clear();
            }
            "sign" => {
                self.each(column, |v| -v);
                struck.runs.clear();
            }
            "swapped" => {
                let others: Vec<usize> =
                    offered.iter().map(|c| self.inputs + c).filter(|c| *c != column).collect();
                let other = random.pick(&others);
                for columns in &mut self.columns {
                    columns.swap(column, other);
                }
                struck = Struck { channels: vec![measured, other - self.inputs], runs: Vec::new() };
            }
            "stuck" => {
                let end = (place + length / 4 + random.below(length / 3)).min(length);
                let held = self.columns[run][column][place];
                self.columns[run][column][place..end].fill(held);
            }
            "saturated" => {
                let middle = self.columns[run][column].iter().sum::<f64>() / length as f64;
                let limit = all(self) * random.within(0.18, 0.28);
                self.each(column, |v| v.clamp(middle - limit, middle + limit));
                struck.runs.clear();
            }
            "offset" => {
                let by = random.sign() * random.within(0.1, 0.25) * all(self);
                struck.runs = self.some_runs(random);
                for r in struck.runs.iter().copied() {
                    for value in &mut self.columns[r][column] {
                        *value += by;
                    }
                }
            }
            "delay" => {
                let by = random.within(0.025, 0.07);
                struck.runs = self.some_runs(random);
                for r in struck.runs.iter().copied() {
                    let samples = by * self.stamps[r].len() as f64 / range(&self.stamps[r]);
                    self.warp(r, column..column + 1, |k| k - samples);
                }
            }
            "clock-drift" => {
                let share = random.sign() * random.within(4e-3, 9e-3);
                for r in 0..self.stamps.len() {
                    let columns = self.inputs..self.columns[r].len();
                    self.warp(r, columns, |k| k * (1.0 - share));
                }
                struck = Struck::default();
            }
            "spikes" => {
                let size = all(self);
                for _ in 0..8 + random.below(10) {
                    let at = random.below(length);
                    let zero = random.chance(0.3);
                    let value = if zero { 0.0 } else { random.sign() * size * random.within(0.8, 3.0) };
                    self.columns[run][column][at] = value;
                }
            }
            _ => {
                let from = (run + 1) % self.stamps.len();
                self.stamps[from] = self.stamps[run].clone();
                self.columns[from] = self.columns[run].clone();
                struck = Struck { channels: Vec::new(), runs: vec![run, from] };
            }
        }
        struck.runs.sort_unstable();
        struck
    }

    fn each(&mut self, column: usize, change: impl Fn(f64) -> f64) {
        for columns in &mut self.columns {
            for value in &mut columns[column] {
                *value = change(*value);
            }
        }
    }

    #[allow(clippy::cast_precision_loss)] // a few thousand samples
    fn warp(&mut self, run: usize, columns: std::ops::Range<usize>, at: impl Fn(f64) -> f64) {
        for column in columns {
            let old = self.columns[run][column].clone();
            for (k, value) in self.columns[run][column].iter_mut().enumerate() {
                *value = sampled(&old, at(k as f64));
            }
        }
    }
}
