//! How much each channel counts: in multiples of its own error, as far as that is not negligible.

use super::negligible::{negligible, resolution};
use super::rest::Rest;
use super::study::{Fitted, Study};
use crate::fit::Run;
use crate::stats::{about_mean, median, redundancy};
use nalgebra::DMatrix;

impl Study<'_> {
    /// Weighs the channels by what a fitted model leaves of the fit runs, and gives the fit with its derivatives in the new
    /// weights.
    pub fn weigh_by(&mut self, fitted: &Fitted, rest: &Rest) -> Fitted {
        let before = self.weights.clone();
        let runs = self.fit_runs.clone();
        self.weigh(&runs, rest);
        let mut fitted = fitted.clone();
        self.weigh_anew(&mut fitted.fit.jacobian, &before);
        fitted
    }

    /// Gives derivatives of the residuals of the fit runs, which have the weights `before`, those of now.
    pub(super) fn weigh_anew(&self, derivatives: &mut DMatrix<f64>, before: &[f64]) {
        let factors: Vec<f64> = self.weights.iter().zip(before).map(|(now, before)| now / before).collect();
        // rows are run by run, channel by channel
        let mut row = 0;
        for run in &self.fit_runs {
            for (channel, factor) in run.channels.iter().zip(&factors) {
                let n = channel.values.len();
                if row + n <= derivatives.nrows() {
                    derivatives.rows_mut(row, n).scale_mut(*factor);
                }
                row += n;
            }
        }
    }

    /// Sets weights and redundancy from what a model leaves: every channel counts in multiples of its
    /// own error, but none for more than a thousand times its relative precision.
    pub fn weigh(&mut self, runs: &[&Run], rest: &Rest) {
        let mut spans = Vec::new();
        for (c, weight) in self.weights.iter_mut().enumerate() {
            let (mut error, mut n) = (0.0, 0.0);
            for (run, traces) in runs.iter().zip(&rest.simulated) {
                let Some(channel) = run.channels.get(c) else { continue };
                let difference: Vec<f64> =
                    traces[c].iter().zip(&channel.values).map(|(s, m)| s - m).collect();
                error += difference.iter().map(|d| d * d).sum::<f64>();
                n += channel.values.len() as f64;
                spans.push(redundancy(&difference));
            }
            if n > 0.0 && error > 0.0 {
                *weight = 1.0 / (error / n).sqrt().max(negligible(runs, c));
            }
        }
        // without any it is 1, too
        self.redundancy = median(&spans).max(1.0);
    }
}

/// Weights of channels before anything is known: one over their spread.
pub fn first_weights(runs: &[&Run]) -> Vec<f64> {
    let count = runs.first().map_or(0, |r| r.channels.len());
    (0..count)
        .map(|c| {
            let (mut square, mut n) = (0.0, 0.0);
            for channel in runs.iter().filter_map(|r| r.channels.get(c)) {
                square += about_mean(&channel.values);
                n += channel.values.len() as f64;
            }
            let spread = (square / f64::max(n, 1.0)).sqrt().max(resolution(runs, c));
            if spread > 0.0 { 1.0 / spread } else { 1.0 }
        })
        .collect()
}
