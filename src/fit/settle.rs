//! [`settle`]: the end of a fit, with derivatives that intervals need.

use super::derivatives::differentiate_centrally;
use super::least_squares::{Fit, Problem, Unknown};
use super::quadratic::{Quadratic, square, variance};

/// Steps of [`settle`]: what the first leaves is of second order.
const SETTLED: usize = 2;

/// A step that promises to lower the sum by no more than this moves no unknown by more than a tenth of its standard deviation: there is
/// nothing to come after it.
const HARDLY: f64 = 0.01;

/// A step that promises more than this may move an unknown by more than its standard deviation. Derivatives where a shorter one ends are, as
/// far as intervals need them, those where it began.
const FAR: f64 = 1.0;

/// The end of a fit with derivatives from both sides, and with the steps that they foretell if these lower the sum.
///
/// Derivatives that were updated on the way, or are differences to one side, are wrong by a share of how much each unknown does. That
/// leads a fit on, but where several unknowns undo each other it looks as if the data told them apart: the information of
/// such a direction is what is wrong with its derivatives, and intervals are too narrow.
pub fn settle(problem: &dyn Problem, unknowns: &[Unknown], mut fit: Fit, redundancy: f64) -> Fit {
    let mut is_far = true;
    for _ in 0..SETTLED {
        if is_far {
            differentiate_centrally(problem, unknowns, &fit.x, &fit.residuals, &mut fit.jacobian);
        }
        let variance = variance(&fit.residuals, fit.least_variance, redundancy);
        let here = Quadratic::at(&fit.x, &fit.residuals, &fit.jacobian, unknowns, variance);
        let to = here.step(0.0);
        let Some(residuals) = problem.residuals(std::slice::from_ref(&to)).pop().flatten() else { break };
        if here.sum(&to, &residuals) >= here.total {
            break;
        }
        let promised = here.promised(&to);
        (fit.x, fit.residuals) = (to, residuals);
        if promised < HARDLY {
            break;
        }
        is_far = promised > FAR;
    }
    fit.cost = square(&fit.residuals);
    fit.updated = false;
    fit
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::{Options, least_squares};
    use std::cell::Cell;

    /// A rate of decay and its amount, with noise; it counts how many points it was asked for.
    #[derive(Default)]
    struct Decay(Cell<usize>);

    impl Problem for Decay {
        fn residuals(&self, points: &[Vec<f64>]) -> Vec<Option<Vec<f64>>> {
            self.0.set(self.0.get() + points.len());
            let of = |k: i32, x: &[f64]| {
                let (t, noise) = (0.01 * f64::from(k), if k % 2 == 0 { 0.1 } else { -0.1 });
                x[0] * (-x[1] * t).exp() - (-t).exp() + noise
            };
            points.iter().map(|x| Some((0..400).map(|k| of(k, x)).collect())).collect()
        }
    }

    fn unknown(start: f64) -> Unknown {
        let (prior, reach) = (f64::INFINITY, f64::INFINITY);
        Unknown { start, mean: start, low: 0.0, high: 10.0, step: 1e-3, prior, reach }
    }

    #[test]
    fn derivatives_are_computed_again_only_where_a_step_was_far() {
        let best = {
            let options = Options { iterations: 40, tolerance: 1e-14, ..Options::default() };
            least_squares(&Decay::default(), &[unknown(1.0), unknown(1.0)], options).unwrap()
        };
        let sure = best.covariance(&[unknown(1.0), unknown(1.0)], 1.0).half_width(1) / 1.96;
        // so many standard deviations away, of which a step leaves 0.026 times the square here; asked for: both sides of two unknowns, and
        // where each step leads
        for (away, asked, near) in [(0.05, 4 + 1, 0.01), (0.5, 4 + 1 + 1, 0.01), (5.0, 2 * (4 + 1), 0.02)] {
            let start = [unknown(best.x[0]), unknown(best.x[1] + away * sure)];
            let once = Options { iterations: 1, ..Options::default() };
            let begun = least_squares(&Decay::default(), &start, once).unwrap();
            let problem = Decay::default();
            let settled = settle(&problem, &start, begun, 1.0);
            assert_eq!(problem.0.get(), asked, "{away}");
            assert!((settled.x[1] - best.x[1]).abs() < near * sure, "{away}: {:?} {:?}", settled.x, best.x);
        }
    }
}
