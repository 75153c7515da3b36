//! A free oscillation: x = zero + A exp(-delta t) cos(w t + phi), fitted as a whole.

use super::laws::{Known, student_factor};
use crate::fit::{Options, Problem, Unknown, least_squares};
use crate::stats::{deviation, mean, redundancy, root_mean_square};
use crate::{Error, Result};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::TAU;

/// Oscillations that have to be there for a decay rate.
pub(super) const LEAST_SWINGS: f64 = 1.5;
/// Samples of an oscillation, at least: a parabola through a turn is then right to a percent.
pub(super) const LEAST_SAMPLES: f64 = 8.0;

/// Degrees of freedom of which Student's t is the normal distribution, that intervals of fits are made with.
const MANY: f64 = 1e6;

/// A free oscillation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oscillation {
    /// Time of one \[s\].
    pub period: Known,
    /// Logarithmic decrement: of amplitudes a period apart, damped.
    pub decrement: Known,
    /// Amplitude at the first sample, in the channel's unit.
    pub amplitude: f64,
    /// Root mean square of what the fit leaves, over the amplitude.
    pub residual: f64,
}

/// The free oscillation that values `step` seconds apart are.
///
/// # Errors
/// Nothing swings, an oscillation explains less than half of what varies, or too few oscillations or samples of one.
pub fn oscillation(values: &[f64], step: f64) -> Result<Oscillation> {
    let start = guess(values, step)
        .ok_or_else(|| Error::numeric("nothing swings to and fro: there are no two turns about a level"))?;
    let swing = Swing { values, step };
    let ([delta, omega], half, residuals) = swing.fit(start)?;
    // those of the fit are of many samples; five numbers were taken from these
    let independent = residuals.len() as f64 / redundancy(&residuals).max(1.0);
    let left = (independent - 5.0).max(1.0);
    let wider = student_factor(left) / student_factor(MANY) * (independent / left).max(1.0).sqrt();
    let [of_delta, of_omega] = half.map(|half| half * wider);
    let (samples, swings) = (TAU / omega / step, values.len() as f64 * step * omega / TAU);
    if samples < LEAST_SAMPLES || swings < LEAST_SWINGS {
        return Err(Error::numeric(format!(
            "{swings:.1} oscillations of {:.1} Hz with {samples:.1} samples each: {LEAST_SWINGS} and {LEAST_SAMPLES} are needed",
            omega / TAU
        )));
    }
    let ([_, cos, sin], _) = swing
        .linear([delta, omega])
        .ok_or_else(|| Error::numeric("the oscillation cannot be told from a level"))?;
    let left = root_mean_square(residuals);
    if 2.0 * left * left >= deviation(values).powi(2) {
        return Err(Error::numeric("an oscillation explains less than half of what varies"));
    }
    let (period, amplitude) = (TAU / omega, cos.hypot(sin));
    let decrement = delta * period;
    let of_decrement = period * of_delta.hypot(delta * of_omega / omega);
    Ok(Oscillation {
        period: Known { value: period, half_width: period * of_omega / omega },
        decrement: Known { value: decrement, half_width: of_decrement },
        amplitude,
        residual: left / amplitude,
    })
}

/// Decay rate and angular frequency by the crossings of the level, and by how much smaller the second oscillation is than the first one.
pub(super) fn guess(free: &[f64], step: f64) -> Option<[f64; 2]> {
    let n = free.len();
    if n < 8 {
        return None;
    }
    let level = mean(&free[n / 2..]);
    let most = free.iter().fold(0.0_f64, |most, v| most.max((v - level).abs()));
    // crossings, with a hysteresis against noise
    let (mut side, mut crossings) = (0.0_f64, Vec::new());
    let threshold = 0.1 * most;
    for (k, v) in free.iter().enumerate() {
        let x = v - level;
        if x.abs() > threshold && x.signum() != side {
            if side != 0.0 {
                crossings.push(k as f64);
            }
            side = x.signum();
        }
    }
    let (first, last) = (crossings.first()?, crossings.last()?);
    if crossings.len() < 2 {
        return None;
    }
    let half = (last - first) / (crossings.len() - 1) as f64;
    let power = |part: &[f64]| part.iter().map(|v| (v - level).powi(2)).sum::<f64>() / part.len() as f64;
    let window = ((2.0 * half) as usize).clamp(1, n / 2);
    let (early, late) = (power(&free[..window]), power(&free[window..2 * window]));
    let delta = (0.5 * (early / late.max(1e-9 * early)).ln() / window as f64).max(1e-3 / n as f64);
    Some([delta / step, std::f64::consts::PI / half / step])
}

/// A free oscillation: for a decay rate and a frequency, level and amplitudes are linear.
pub(super) struct Swing<'a> {
    pub values: &'a [f64],
    /// Time from one to the next \[s\].
    pub step: f64,
}

impl Swing<'_> {
    /// Level, amplitudes of cosine and sine, and what they leave.
    pub fn linear(&self, [delta, omega]: [f64; 2]) -> Option<([f64; 3], Vec<f64>)> {
        let base = |k: usize| {
            let t = k as f64 * self.step;
            let (sin, cos) = (omega * t).sin_cos();
            let envelope = (-delta * t).exp();
            Vector3::new(1.0, envelope * cos, envelope * sin)
        };
        let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for (k, v) in self.values.iter().enumerate() {
            let b = base(k);
            normal += b * b.transpose();
            right += b * *v;
        }
        let x = normal.cholesky()?.solve(&right);
        let left = self.values.iter().enumerate().map(|(k, v)| v - base(k).dot(&x)).collect();
        x.iter().all(|x| x.is_finite()).then_some(([x[0], x[1], x[2]], left))
    }

    /// Decay rate and frequency, half their intervals, and the residuals.
    pub fn fit(&self, start: [f64; 2]) -> Result<Fitted> {
        let unknown = |i: usize, low: f64, high: f64, step: f64| Unknown {
            start: start[i],
            mean: start[i],
            low,
            high,
            step,
            prior: f64::INFINITY,
            reach: 0.3 * start[1],
        };
        let omega = start[1];
        let unknowns = [
            unknown(0, -0.2 * omega, 2.0 * omega, 1e-6 * omega),
            unknown(1, 0.5 * omega, 2.0 * omega, 1e-6 * omega),
        ];
        let options = Options { iterations: 60, tolerance: 1e-10, ..Options::default() };
        let fit = least_squares(self, &unknowns, options)?;
        let covariance = fit.covariance(&unknowns, redundancy(&fit.residuals));
        let half = [covariance.half_width(0), covariance.half_width(1)];
        Ok(([fit.x[0], fit.x[1]], half, fit.residuals))
    }
}

pub(super) type Fitted = ([f64; 2], [f64; 2], Vec<f64>);

impl Problem for Swing<'_> {
    fn residuals(&self, points: &[Vec<f64>]) -> Vec<Option<Vec<f64>>> {
        points.iter().map(|p| self.linear([p[0], p[1]]).map(|(_, left)| left)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::SplitMix64;

    /// Period and decrement of a made one, with noise: within their intervals, which are not wide.
    #[test]
    fn a_made_oscillation_comes_back_within_its_intervals() {
        let mut random = SplitMix64::new(3);
        let (delta, omega, step) = (1.3_f64, 27.0_f64, 2e-3);
        let values: Vec<f64> = (0..500)
            .map(|k| {
                let t = step * f64::from(k);
                5.0 + 0.4 * (-delta * t).exp() * (omega * t + 2.0).cos() + 0.004 * random.normal()
            })
            .collect();
        let found = oscillation(&values, step).unwrap();
        let [period, decrement] = [TAU / omega, delta * TAU / omega];
        for (known, exact) in [(found.period, period), (found.decrement, decrement)] {
            assert!((known.value - exact).abs() < 1.5 * known.half_width, "{known:?} {exact}");
            assert!(known.half_width < 0.05 * exact, "{known:?}");
        }
        assert!((found.residual / 0.01 - 1.0).abs() < 0.2, "{}", found.residual);
        assert!(oscillation(&values[..60], step).is_err(), "half an oscillation");
        assert!(oscillation(&[1.0; 500], step).is_err(), "nothing");
        let noise: Vec<f64> = (0..500).map(|_| random.normal()).collect();
        assert!(oscillation(&noise, step).is_err(), "noise");
    }
}
