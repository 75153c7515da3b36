//! What a model leaves of runs, in blocks and over their noise.

use super::locate;
use super::negligible::error;
use super::study::{Fitted, Model, Study};
use crate::fit::{Covariance, Kept, Run, Traces};
use crate::stats::about_mean;
use crate::{Error, Result};

/// Blocks of a run that errors are compared over, at most and at least.
const BLOCKS: usize = 24;
const FEW_BLOCKS: usize = 8;

/// What a model leaves of some runs.
#[derive(Debug, Clone)]
pub struct Rest {
    /// Simulated channels of each run at its samples.
    pub simulated: Vec<Traces>,
    /// Weighted squared error in each block: of each channel, and at least what is not resolved of it there. Who explains an error down to
    /// there has explained it, and below there is nothing to win.
    pub blocks: Vec<Vec<f64>>,
    /// Their sum.
    pub total: f64,
    /// Weighted squared error as fits lower it, whatever is resolved of it.
    pub cost: f64,
}

impl Rest {
    /// Weighted squared error of each channel.
    pub fn by_channel(&self) -> Vec<f64> {
        let channels = self.blocks.first().map_or(0, Vec::len);
        (0..channels).map(|c| self.blocks.iter().map(|b| b[c]).sum()).collect()
    }

    /// Squared error in each block, with the channels in other units.
    pub fn in_units(&self, units: &[f64]) -> Vec<f64> {
        self.blocks
            .iter()
            .map(|b| b.iter().zip(units).map(|(e, u)| e / u.max(f64::MIN_POSITIVE)).sum())
            .collect()
    }
}

/// What a model leaves in each block less what another leaves.
pub(super) fn differences(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// What is known of the noise of a channel, in the unit of the model's output.
#[derive(Debug, Clone, Copy)]
pub struct Noise {
    /// What follows no other signal.
    pub alone: Option<f64>,
    /// What repeats of a run do not share, if any run is repeated.
    pub scatter: Option<f64>,
}

impl Noise {
    /// Both are upper bounds: the lower one.
    pub fn least(&self) -> Option<f64> {
        self.alone.into_iter().chain(self.scatter).reduce(f64::min)
    }
}

impl Study<'_> {
    /// What a model leaves of some runs.
    ///
    /// # Errors
    /// It cannot be run on one of them.
    pub fn rest(&self, model: &Model, runs: &[&Run]) -> Result<Rest> {
        self.rest_of(model, runs, None)
    }

    /// What a fitted model leaves of the fit runs: they have been simulated.
    ///
    /// # Errors
    /// It cannot be run on one of them.
    pub fn fit_rest(&self, fitted: &Fitted) -> Result<Rest> {
        self.rest_of(&fitted.model, &self.fit_runs, fitted.kept.clone())
    }

    fn rest_of(&self, model: &Model, runs: &[&Run], kept: Option<Kept>) -> Result<Rest> {
        let problem = self.problem(model, runs.to_vec());
        problem.keep(kept);
        let simulated = problem.simulate(&[Self::point(model)]).pop().flatten();
        let simulated =
            simulated.ok_or_else(|| Error::numeric("the model cannot be run on the check runs"))?;
        Ok(self.rest_with(runs, simulated))
    }

    /// What these simulated channels leave of some runs.
    pub(super) fn rest_with(&self, runs: &[&Run], simulated: Vec<Traces>) -> Rest {
        let (mut blocks, mut cost) = (Vec::new(), 0.0);
        for (run, traces) in runs.iter().zip(&simulated) {
            let n = run.time.len();
            let count = self.blocks(n);
            let mut sums = vec![vec![0.0; run.channels.len()]; count];
            for (c, ((channel, trace), weight)) in
                run.channels.iter().zip(traces).zip(&self.weights).enumerate()
            {
                let mut unresolved = vec![0.0; count];
                for (k, (s, m)) in trace.iter().zip(&channel.values).enumerate() {
                    sums[k * count / n][c] += (weight * (s - m)).powi(2);
                }
                for (k, least) in channel.unresolved.iter().enumerate() {
                    unresolved[k * count / n] += (weight * least).powi(2);
                }
                for (sum, least) in sums.iter_mut().zip(unresolved) {
                    cost += sum[c];
                    sum[c] = sum[c].max(least);
                }
            }
            blocks.extend(sums);
        }
        let total = blocks.iter().flatten().sum();
        Rest { simulated, blocks, total, cost }
    }

    /// How many blocks a run of so many samples is compared over: what is missing makes a residual's memory long; the noise of
    /// sensors forgets sooner.
    fn blocks(&self, samples: usize) -> usize {
        ((samples as f64 / (4.0 * self.redundancy)) as usize).clamp(FEW_BLOCKS.min(samples), BLOCKS)
    }

    /// How sure a fit to the fit runs is of its unknowns, as the blocks of these runs show it.
    pub fn covariance(&self, fitted: &Fitted) -> Covariance {
        let mut block = Vec::new();
        let mut first = 0;
        for run in &self.fit_runs {
            let n = run.time.len();
            let count = self.blocks(n);
            // all channels of a piece of time are one block: what is missing shows in several of them
            let channels = run.channels.len();
            block.extend((0..channels).flat_map(|_| (0..n).map(|k| first + k * count / n)));
            first += count;
        }
        fitted.fit.covariance_in_blocks(&fitted.unknowns, self.redundancy, &block)
    }

    /// What is left of a channel of the fit runs over what it moves.
    pub fn share_left(&self, rest: &Rest, channel: usize) -> f64 {
        let (mut left, mut moved) = (0.0, 0.0);
        for (run, traces) in self.fit_runs.iter().zip(&rest.simulated) {
            let values = &run.channels[channel].values;
            left += traces[channel].iter().zip(values).map(|(s, m)| (s - m).powi(2)).sum::<f64>();
            moved += about_mean(values);
        }
        (left / moved.max(f64::MIN_POSITIVE)).sqrt()
    }

    /// Root mean square of what is left of a channel of the check runs, in the unit of the model's output.
    pub fn error(&self, rest: &Rest, channel: usize) -> f64 {
        error(&self.check_runs, &rest.simulated, channel)
    }

    /// The noise of every channel of the check runs, with what a model leaves of the fit runs and of them.
    pub fn noise(&self, fit: &Rest, check: &Rest) -> Vec<Noise> {
        let runs: Vec<&Run> = self.fit_runs.iter().chain(&self.check_runs).copied().collect();
        let scatter = locate::scatter(&runs, &[&fit.simulated[..], &check.simulated[..]].concat());
        let of = |c: usize| Noise {
            alone: locate::noise(&self.check_runs, &check.simulated, c),
            scatter: scatter.as_ref().and_then(|s| s.get(c).copied()),
        };
        (0..self.weights.len()).map(of).collect()
    }

    /// How many independent samples all runs have.
    pub fn independent(&self) -> f64 {
        let all = self.fit_runs.iter().chain(&self.check_runs);
        let samples: usize = all.map(|r| r.time.len() * r.channels.len()).sum();
        (samples as f64 / self.redundancy).max(2.0)
    }
}
