//! What sensors may show at zero: so little that it is no finding.

use super::numbers::{VISIBLE_ZERO, ZERO};
use super::rest::Rest;
use super::study::{Fitted, Study};
use crate::fit::Run;

impl Study<'_> {
    /// Takes from the channels that may show something at zero those that show too much for that, with a model fitted to the fit
    /// runs. Returns whether there are any.
    pub fn drop_visible_zeros(&mut self, fitted: &Fitted, rest: &Rest) -> bool {
        let first = self.free.len() + 1;
        let is_small = |k: usize, (channel, most): (usize, f64)| {
            let (mut count, mut sum, mut square) = (0.0, 0.0, 0.0);
            for (run, traces) in self.fit_runs.iter().zip(&rest.simulated) {
                for (m, s) in run.channels[channel].values.iter().zip(&traces[channel]) {
                    count += 1.0;
                    sum += m - s;
                    square += (m - s).powi(2);
                }
            }
            let beside = (square / count - (sum / count).powi(2)).max(0.0).sqrt();
            let zero = fitted.model.parameters[first + k].abs() * most;
            zero < most && zero <= VISIBLE_ZERO * beside
        };
        let all = self.zeros.iter().copied().enumerate();
        let small: Vec<(usize, f64)> = all.filter(|(k, zero)| is_small(*k, *zero)).map(|(_, z)| z).collect();
        let dropped = small.len() < self.zeros.len();
        self.zeros = small;
        dropped
    }
}

/// What channels may show at zero: by number and in their units. What counts from any zero has none.
pub fn zeros(runs: &[&Run]) -> Vec<(usize, f64)> {
    let count = runs.first().map_or(0, |r| r.channels.len());
    let span = |c: usize| {
        let values = || runs.iter().filter_map(|r| r.channels.get(c)).flat_map(|c| &c.values).copied();
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
    };
    let counts = |c: usize| runs.iter().filter_map(|r| r.channels.get(c)).any(|c| c.counts);
    let channels = (0..count).filter(|c| !counts(*c)).map(|c| (c, ZERO * span(c)));
    channels.filter(|(_, most)| most.is_finite() && *most > 0.0).collect()
}
