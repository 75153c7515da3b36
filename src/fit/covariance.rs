//! [`Covariance`]: how sure a fit is of its unknowns.

use super::least_squares::{Fit, Unknown};
use super::quadratic::variance;
use nalgebra::linalg::SVD;
use nalgebra::{DMatrix, DVector};

/// So many standard deviations are on each side of a 95 % interval of the normal distribution.
const SIDE: f64 = 1.96;
/// Directions of the information, scaled to 1 for each unknown alone, with less than this are those that nothing fixes:
/// rounding makes 1e-16 for each of the products that it is the sum of.
const NOTHING: f64 = 1e-12;
/// An unknown takes part in such a direction if it has more than this share of it.
const TAKES_PART: f64 = 1e-6;
/// Where half an interval has more than so many standard deviations of what is known beforehand, the data tell next to
/// nothing: with none of them it has 1.96, and with 1.8 the variance is still 0.84 of that beforehand.
const TOLD: f64 = 1.8;

/// How sure a fit is of its unknowns: their covariance, and intervals.
///
/// Near its end x̂ a fit with residuals r, their derivatives J and the sum of squares S has
///
/// ```text
/// C = (J^T J / s^2 + P)^-1,    s^2 = q S / n
/// ```
///
/// where n is the number of residuals, q how many of them tell as much as one that is independent of its neighbours
/// (the redundancy); s^2 is at least what rounding makes. P is diagonal, with what is known beforehand: one over the variance of each unknown.
///
/// What that assumes:
///
/// * the residuals are linear in the unknowns over the width of the interval;
/// * what is left is noise of one variance for all residuals, of mean 0; if physics is missing, the intervals say how
///   well the parameters of the wrong model are fixed, and no more;
/// * white residuals for q = 1. Correlated ones, as all residuals of simulations are, with
///   q = 1 + 2 * sum of the autocorrelation ([`redundancy`](crate::stats::redundancy)) if the derivatives change more
///   slowly than the residuals forget. That is exact for a mean of many samples; where derivatives change faster than
///   the residuals forget the intervals are too wide;
/// * s^2 is the variance over n, not over n less the number of unknowns: for few samples to each unknown the intervals
///   are too narrow, by the root of that ratio;
/// * bounds do not exist: an unknown at its bound has the interval that it would have without.
#[derive(Debug, Clone, PartialEq)]
pub struct Covariance {
    matrix: DMatrix<f64>,
    /// Of each unknown: data or prior fix it.
    fixed: Vec<bool>,
}

impl Fit {
    /// The covariance of the unknowns, for residuals of the variance `cost / n` of which `redundancy` tell as much as
    /// one. [`Covariance`] has the formula and what it assumes.
    pub fn covariance(&self, unknowns: &[Unknown], redundancy: f64) -> Covariance {
        let variance = self.variance(redundancy);
        let mut information = self.jacobian.tr_mul(&self.jacobian) / variance;
        for (i, unknown) in unknowns.iter().enumerate() {
            information[(i, i)] += unknown.prior.powi(-2);
        }
        Covariance::of(&information)
    }

    /// The variance of a residual, times how many of them tell as much as one.
    fn variance(&self, redundancy: f64) -> f64 {
        variance(&self.residuals, self.least_variance, redundancy.max(1.0))
    }

    /// The covariance where residuals are not noise of one kind: with deviations as large as blocks of residuals show them to be,
    /// and never smaller than those of [`Fit::covariance`]. `block` has the number of the block of each residual.
    ///
    /// What pulls at the unknowns in each block, g_b = J_b^T r_b / s^2, has no other variance than its own square, whatever the
    /// residuals are made of: noise of several sizes and memories, or physics that is missing. With blocks that are longer than
    /// the errors' memory
    ///
    /// ```text
    /// C = H^-1 (B / (B - 1) sum_b g_b g_b^T + P) H^-1,    H = J^T J / s^2 + P
    /// ```
    ///
    /// (the "sandwich" of robust statistics, in clusters). It does not know an error that all blocks share.
    pub fn covariance_in_blocks(&self, unknowns: &[Unknown], redundancy: f64, block: &[usize]) -> Covariance {
        let mut usual = self.covariance(unknowns, redundancy);
        let count = block.iter().max().map_or(0, |last| last + 1);
        if count < 2 || block.len() != self.residuals.len() || self.jacobian.nrows() != block.len() {
            return usual;
        }
        let variance = self.variance(redundancy);
        let mut pulls = DMatrix::<f64>::zeros(unknowns.len(), count);
        for (i, column) in self.jacobian.column_iter().enumerate() {
            for ((slope, residual), block) in column.iter().zip(&self.residuals).zip(block) {
                pulls[(i, *block)] += slope * residual / variance;
            }
        }
        let factor = count as f64 / (count as f64 - 1.0);
        let mut middle: DMatrix<f64> = &pulls * pulls.transpose() * factor;
        for (i, unknown) in unknowns.iter().enumerate() {
            middle[(i, i)] += unknown.prior.powi(-2);
        }
        let shown = &usual.matrix * middle * &usual.matrix;
        let wider = DVector::from_fn(unknowns.len(), |i, _| {
            let ratio = shown[(i, i)] / usual.matrix[(i, i)];
            if ratio.is_finite() { ratio.max(1.0).sqrt() } else { 1.0 }
        });
        for (i, j) in (0..wider.len()).flat_map(|i| (0..wider.len()).map(move |j| (i, j))) {
            usual.matrix[(i, j)] *= wider[i] * wider[j];
        }
        usual
    }
}

impl Covariance {
    fn of(information: &DMatrix<f64>) -> Self {
        let size = information.nrows();
        let scale = DVector::from_fn(size, |i, _| 1.0 / information[(i, i)].sqrt().max(1e-150));
        let scaled = DMatrix::from_fn(size, size, |i, j| information[(i, j)] * scale[i] * scale[j]);
        let parts = SVD::new_unordered(scaled, true, true);
        let nothing = |direction: usize| parts.singular_values[direction] <= NOTHING;
        let takes_part = |i: usize, direction: usize| {
            parts.v_t.as_ref().is_none_or(|v_t| v_t[(direction, i)].abs() > TAKES_PART)
        };
        let fixed = (0..size).map(|i| !(0..size).any(|d| nothing(d) && takes_part(i, d))).collect();
        let inverse = parts.pseudo_inverse(NOTHING).unwrap_or_else(|_| DMatrix::zeros(size, size));
        Self { matrix: DMatrix::from_fn(size, size, |i, j| inverse[(i, j)] * scale[i] * scale[j]), fixed }
    }

    /// The matrix. Directions that nothing fixes are left out of it: [`is_fixed`](Self::is_fixed) tells which unknowns
    /// take part in one.
    pub fn matrix(&self) -> &DMatrix<f64> {
        &self.matrix
    }

    /// Whether the data or what is known beforehand fix an unknown at all.
    pub fn is_fixed(&self, unknown: usize) -> bool {
        self.fixed[unknown]
    }

    /// The standard deviation of an unknown; infinite if nothing fixes it.
    pub fn deviation(&self, unknown: usize) -> f64 {
        // rounding may leave a variance a hair below 0
        if self.fixed[unknown] { self.matrix[(unknown, unknown)].max(0.0).sqrt() } else { f64::INFINITY }
    }

    /// Half the width of the 95 % interval of an unknown.
    pub fn half_width(&self, unknown: usize) -> f64 {
        SIDE * self.deviation(unknown)
    }

    /// The 95 % interval of an unknown that was found to be `x`.
    pub fn interval(&self, unknown: usize, x: f64) -> [f64; 2] {
        let half = self.half_width(unknown);
        [x - half, x + half]
    }

    /// The 95 % interval of a number whose logarithm is the unknown, and that was found to be `value`, if residuals are linear in it.
    pub fn interval_of_exponential(&self, unknown: usize, value: f64) -> [f64; 2] {
        let half = self.half_width(unknown);
        [value * (-half).exp(), value * half.exp()]
    }

    /// The 95 % interval of a number that was found to be `value` and whose logarithm is the unknown, whatever it is that residuals are
    /// linear in over the width of the interval: the number, as of a short lag, its logarithm, or its reciprocal, as of a time that
    /// is long beside the recordings. None where an end is open, as these differ too much.
    ///
    /// With the half width h of the logarithm these say `value` (1 ± h), `value` exp(±h) and `value` / (1 ± h); the widest ends are
    /// those of the first and the last. Where h is small all are the same.
    pub fn interval_however_counted(&self, unknown: usize, value: f64) -> Option<[f64; 2]> {
        let half = self.half_width(unknown);
        (half < 1.0).then(|| [value * (1.0 - half), value / (1.0 - half)])
    }

    /// Whether the 95 % interval of an unknown is narrower than `room`, such as the range of its search.
    pub fn is_within(&self, unknown: usize, room: f64) -> bool {
        self.half_width(unknown) < 0.5 * room
    }

    /// Whether the data tell something of an unknown: if not, its interval is as wide as what was known beforehand.
    pub fn is_told(&self, unknown: usize, beforehand: &Unknown) -> bool {
        self.half_width(unknown) < TOLD * beforehand.prior
    }

    /// The correlation coefficient of the errors of two unknowns, -1 to 1: where it is near these, the data tell their
    /// sum or difference only. NaN if nothing fixes one of them.
    pub fn correlation(&self, a: usize, b: usize) -> f64 {
        let scale = self.deviation(a) * self.deviation(b);
        if scale.is_finite() && scale > 0.0 { self.matrix[(a, b)] / scale } else { f64::NAN }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Options, Problem, least_squares};
    use super::*;
    use crate::stats::SplitMix64;
    use crate::stats::testing::coloured;

    /// Residuals a + b t - y.
    struct Line {
        t: Vec<f64>,
        y: Vec<f64>,
    }

    impl Problem for Line {
        fn residuals(&self, points: &[Vec<f64>]) -> Vec<Option<Vec<f64>>> {
            let of = |x: &Vec<f64>| {
                self.t.iter().zip(&self.y).map(|(t, y)| x[0] + x[1] * t - y).collect::<Vec<_>>()
            };
            points.iter().map(|x| Some(of(x))).collect()
        }
    }

    impl Line {
        fn fit(&self, unknowns: &[Unknown]) -> Fit {
            least_squares(self, unknowns, Options { tolerance: 1e-12, ..Options::default() }).unwrap()
        }
    }

    /// Two unknowns of which nothing is known; a step of differences that rounding does not spoil.
    fn open() -> [Unknown; 2] {
        let (low, high, infinite) = (-1e6, 1e6, f64::INFINITY);
        [Unknown { start: 0.0, mean: 0.0, low, high, step: 1e-3, prior: infinite, reach: infinite }; 2]
    }

    fn near(value: f64, expected: f64) {
        assert!((value - expected).abs() < 1e-6 * expected.abs(), "{value} {expected}");
    }

    /// Noise of two sizes: the last tenth of the samples is ten times as noisy, and they alone tell the slope. An interval that knows one variance only is too narrow; with blocks it holds the truth as often as it says.
    #[test]
    fn blocks_know_that_noise_is_of_several_sizes() {
        let mut random = SplitMix64::new(11);
        let (trials, n) = (400, 400);
        let free = Unknown {
            start: 0.0,
            mean: 0.0,
            low: -1e9,
            high: 1e9,
            step: 1e-3,
            prior: f64::INFINITY,
            reach: f64::INFINITY,
        };
        let block: Vec<usize> = (0..n).map(|k| k / 4).collect();
        let (mut usual, mut robust) = (0, 0);
        for _ in 0..trials {
            let t: Vec<f64> = (0..n).map(|k| f64::from(u8::from(k >= n * 9 / 10))).collect();
            let y = t.iter().map(|t| random.normal() * (1.0 + 9.0 * t)).collect();
            let fit = least_squares(&Line { t, y }, &[free, free], Options::default()).unwrap();
            let holds =
                |c: Covariance| usize::from(c.interval(1, fit.x[1])[0] * c.interval(1, fit.x[1])[1] < 0.0);
            usual += holds(fit.covariance(&[free, free], 1.0));
            robust += holds(fit.covariance_in_blocks(&[free, free], 1.0, &block));
        }
        // of the usual one the deviation is a third of the true one: s = 3.3 of 10
        assert!(usual < trials * 6 / 10, "{usual} of {trials}");
        // ten blocks of the noisy part are few: 0.85 to 0.97
        assert!((trials * 85 / 100..trials * 97 / 100).contains(&robust), "{robust} of {trials}");
    }

    #[test]
    fn a_regression_has_the_covariance_of_the_textbook() {
        let t: Vec<f64> = (0..40).map(|i| 0.1 * f64::from(i * i % 37)).collect();
        let y: Vec<f64> = (0..40).map(|i| f64::from(i * 7 % 11)).collect();
        let line = Line { t: t.clone(), y };
        let fit = line.fit(&open());
        let (n, sum) = (40.0, t.iter().sum::<f64>());
        let square: f64 = t.iter().map(|t| t * t).sum();
        let determinant = n * square - sum * sum;
        for redundancy in [1.0, 4.0] {
            let variance = redundancy * fit.cost / n;
            let found = fit.covariance(&open(), redundancy);
            near(found.matrix()[(0, 0)], variance * square / determinant);
            near(found.matrix()[(1, 1)], variance * n / determinant);
            near(found.matrix()[(0, 1)], -variance * sum / determinant);
            near(found.correlation(0, 1), -sum / (n * square).sqrt());
            near(found.half_width(1), 1.96 * (variance * n / determinant).sqrt());
        }
    }

    #[test]
    fn what_is_known_beforehand_adds_its_information() {
        // the mean of values of variance 1 about it: 1 / (n + 1 / prior^2)
        let y: Vec<f64> = (0..100).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
        let line = Line { t: vec![0.0; 100], y };
        let known = |prior: f64| {
            let unknowns = [Unknown { prior, ..open()[0] }, Unknown { prior: 2.0, ..open()[1] }];
            (line.fit(&unknowns).covariance(&unknowns, 1.0), unknowns)
        };
        near(known(f64::INFINITY).0.matrix()[(0, 0)], 0.01);
        near(known(0.1).0.matrix()[(0, 0)], 1.0 / 200.0);
        let (covariance, unknowns) = known(0.1);
        // the data tell as much as the prior of one, and nothing of the other
        assert!(covariance.is_told(0, &unknowns[0]) && !covariance.is_told(1, &unknowns[1]));
        near(covariance.deviation(1), 2.0);
        assert!(covariance.is_within(1, 7.85) && !covariance.is_within(1, 7.83));
    }

    #[test]
    fn what_nothing_fixes_has_no_narrow_interval() {
        // t is 0: nothing tells the slope; t is 1: nothing tells level and slope apart
        let y: Vec<f64> = (0..30).map(|i| f64::from(i % 3)).collect();
        for (t, level_is_fixed) in [(0.0, true), (1.0, false)] {
            let line = Line { t: vec![t; 30], y: y.clone() };
            let covariance = line.fit(&open()).covariance(&open(), 1.0);
            assert_eq!(covariance.is_fixed(0), level_is_fixed);
            assert!(!covariance.is_fixed(1) && !covariance.is_within(1, 1e9));
            assert_eq!(covariance.interval(1, 3.0), [f64::NEG_INFINITY, f64::INFINITY]);
            assert_eq!(covariance.interval_of_exponential(1, 3.0), [0.0, f64::INFINITY]);
            assert!(covariance.correlation(0, 1).is_nan());
        }
    }

    #[test]
    fn intervals_of_logarithms_are_factors() {
        let covariance = Covariance::of(&DMatrix::from_diagonal_element(1, 1, 1.96_f64.powi(2) / 0.04));
        let [low, high] = covariance.interval_of_exponential(0, 5.0);
        near(low, 5.0 * (-0.2_f64).exp());
        near(high, 5.0 * 0.2_f64.exp());
    }

    /// Of what warms up at a constant power, seen for `length` seconds, the loss and the time in which heat leaves: how often the interval of
    /// the time has the true one in it, by the logarithm and however counted, and the share of those that are open.
    fn coverage_of_a_time(length: f64, noise: f64) -> [f64; 3] {
        const TRIALS: usize = 600;
        const TIME: f64 = 40.0;
        struct Warms {
            t: Vec<f64>,
            y: Vec<f64>,
        }
        impl Warms {
            fn at(&self, loss: f64, time: f64) -> impl Iterator<Item = f64> {
                let length = self.t.last().copied().unwrap_or(1.0);
                self.t.iter().map(move |t| loss * time * (1.0 - (-t / time).exp()) / length)
            }
        }
        impl Problem for Warms {
            fn residuals(&self, points: &[Vec<f64>]) -> Vec<Option<Vec<f64>>> {
                let of = |x: &Vec<f64>| {
                    Some(self.at(x[0], TIME * x[1].exp()).zip(&self.y).map(|(a, b)| a - b).collect())
                };
                points.iter().map(of).collect()
            }
        }
        let unknowns =
            [1.0, 0.0].map(|start| Unknown { start, mean: start, low: -9.0, high: 9.0, ..open()[0] });
        let mut random = SplitMix64::new(5);
        let t: Vec<f64> = (1..=200).map(|i| length * f64::from(i) / 200.0).collect();
        let (mut by_logarithm, mut however, mut open) = (0, 0, 0);
        for _ in 0..TRIALS {
            let mut warms = Warms { t: t.clone(), y: Vec::new() };
            warms.y = warms.at(1.0, TIME).map(|y| y + noise * random.normal()).collect();
            let fit = least_squares(&warms, &unknowns, Options::default()).unwrap();
            let covariance = fit.covariance(&unknowns, 1.0);
            let value = TIME * fit.x[1].exp();
            let [low, high] = covariance.interval_of_exponential(1, value);
            by_logarithm += usize::from((low..=high).contains(&TIME));
            match covariance.interval_however_counted(1, value) {
                Some([low, high]) => however += usize::from((low..=high).contains(&TIME)),
                None => open += 1,
            }
        }
        [by_logarithm, however + open, open].map(|count| count as f64 / TRIALS as f64)
    }

    #[test]
    fn intervals_of_times_hold_whatever_they_are_long_beside() {
        // as long as the time itself, and well seen: all the same
        let [by_logarithm, however, open] = coverage_of_a_time(40.0, 0.03);
        assert!(
            (by_logarithm - 0.95).abs() < 0.027 && (0.923..0.99).contains(&however),
            "{by_logarithm} {however}"
        );
        assert_eq!(open, 0.0);
        // an eighth of it, and seen badly: often far too short a time with a narrow interval of its logarithm
        let [by_logarithm, however, open] = coverage_of_a_time(5.0, 0.1);
        assert!(by_logarithm < 0.93 && however > 0.95 && open > 0.5, "{by_logarithm} {however} {open}");
    }

    /// How often the 95 % interval of a slope has the true one in it, with noise of this memory and this redundancy.
    fn coverage(memory: f64, redundancy: f64) -> f64 {
        const TRIALS: usize = 600;
        let mut random = SplitMix64::new(11);
        let t: Vec<f64> = (0..1000).map(|i| 1e-3 * f64::from(i)).collect();
        let hits = (0..TRIALS).filter(|_| {
            let noise = coloured(&mut random, memory, t.len());
            let y = t.iter().zip(noise).map(|(t, e)| 2.0 - 3.0 * t + e).collect();
            let fit = Line { t: t.clone(), y }.fit(&open());
            let [low, high] = fit.covariance(&open(), redundancy).interval(1, fit.x[1]);
            (low..=high).contains(&-3.0)
        });
        hits.count() as f64 / TRIALS as f64
    }

    #[test]
    fn intervals_cover_the_truth_as_often_as_they_say() {
        // 600 trials: the standard deviation of the share is 0.009 at 0.95, 0.02 at 0.5
        let white = coverage(0.0, 1.0);
        assert!((white - 0.95).abs() < 0.027, "{white}");
        // each residual 0.8 times the one before: 1 + 2 * sum of 0.8^k = 9 tell as much as one
        let correlated = coverage(0.8, 9.0);
        assert!((correlated - 0.95).abs() < 0.027, "{correlated}");
        // taken for white their intervals are three times too narrow: the normal distribution has 0.486 within 1.96 / 3
        let wrong = coverage(0.8, 1.0);
        assert!((wrong - 0.486).abs() < 0.06, "{wrong}");
    }
}
