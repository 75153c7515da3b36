//! One measured channel of one run beside its simulation: offset, gain and delay between them.

use crate::recording::Recording;
use crate::stats::{amplitude, deviation, mean, median_interval};

/// A measured channel beside the simulated one, on the same times.
#[derive(Debug, Clone)]
pub struct Pair<'a> {
    /// Index of the run.
    pub run: usize,
    /// Times \[s\], strictly increasing.
    pub time: &'a [f64],
    /// Measured values; faults that were found are taken out of them before the next look.
    pub measured: Vec<f64>,
    /// Simulated values.
    pub simulated: &'a [f64],
}

/// `measured(t) = offset + gain simulated(t - delay)`, by least squares.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fit {
    /// Offset, in the channel's unit.
    pub offset: f64,
    /// Gain.
    pub gain: f64,
    /// Delay \[s\].
    pub delay: f64,
    /// What is left, as rms, in the channel's unit.
    pub error: f64,
}

/// Fewer samples than this are no run.
const FEWEST: usize = 60;
/// Samples that are looked at, at most; the simulation keeps its resolution.
const MOST: usize = 1500;
/// And for the first search over delays.
const MOST_COARSE: usize = 250;
/// By how much a delay beyond half a period of the mean frequency has to be better than a shorter one.
const FAR_DELAY: f64 = 2.0;

impl<'a> Pair<'a> {
    /// The channel `name` of run number `run`, if both sides have it, of the same length and finite, and what was measured is not
    /// constant. The simulation may be: it tells an offset.
    pub fn new(run: usize, measured: &'a Recording, simulated: &'a Recording, name: &str) -> Option<Self> {
        let find = |r: &'a Recording| r.channels.iter().find(|c| c.name == name).map(|c| c.values.as_slice());
        let (y, s) = (find(measured)?, find(simulated)?);
        let time = measured.time.as_slice();
        let good = y.len() == time.len() && s.len() == time.len() && time.len() >= FEWEST;
        let finite = |values: &[f64]| values.iter().all(|v| v.is_finite());
        if !good || !finite(y) || !finite(s) || !finite(time) || time.windows(2).any(|w| w[0] >= w[1]) {
            return None;
        }
        let pair = Self { run, time, measured: y.to_vec(), simulated: s };
        (deviation(y) > 0.0).then_some(pair)
    }

    /// The median interval \[s\].
    pub fn interval(&self) -> f64 {
        median_interval(self.time)
    }

    /// The time \[s\] in which the simulation goes through one period of its mean frequency.
    pub fn period(&self) -> f64 {
        period(self.time, self.simulated)
    }

    /// Largest delay that is looked for: a period or 60 intervals, but no more than a tenth of the run.
    pub fn reach(&self) -> f64 {
        let length = self.time[self.time.len() - 1] - self.time[0];
        (0.1 * length).min(self.period().max(60.0 * self.interval()))
    }

    /// Calls `each` with the measured value, the simulated one `delay` before, and the time.
    pub fn visit(&self, from: usize, to: usize, delay: f64, reach: f64, each: impl FnMut(f64, f64, f64)) {
        self.visit_some(MOST, (from, to), delay, reach, each);
    }

    fn visit_some(
        &self,
        most: usize,
        (from, to): (usize, usize),
        delay: f64,
        reach: f64,
        mut each: impl FnMut(f64, f64, f64),
    ) {
        let n = self.time.len();
        let to = to.min(n);
        let stride = to.saturating_sub(from).div_ceil(most).max(1);
        let (first, last) = (self.time[0] + reach, self.time[n - 1] - reach);
        let mut k = 0;
        for i in (from..to).step_by(stride) {
            let t = self.time[i];
            if t < first || t > last {
                continue;
            }
            let t = t - delay;
            if k == 0 {
                k = self.time.partition_point(|x| *x <= t).saturating_sub(1).min(n - 2);
            }
            while k + 2 < n && self.time[k + 1] <= t {
                k += 1;
            }
            let share = (t - self.time[k]) / (self.time[k + 1] - self.time[k]);
            let s = self.simulated[k] * (1.0 - share) + self.simulated[k + 1] * share;
            each(self.measured[i], s, self.time[i]);
        }
    }

    /// Offset and gain for one delay, from `most` samples. `reach` \[s\] at both ends are left out.
    fn at_some(&self, most: usize, (from, to): (usize, usize), delay: f64, reach: f64) -> Option<Fit> {
        let (mut n, mut y1, mut s1, mut yy, mut ss, mut ys) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        // about the first values, so that large means do not cost digits
        let (y0, s0) = (self.measured[from.min(self.measured.len() - 1)], self.simulated[0]);
        self.visit_some(most, (from, to), delay, reach, |y, s, _| {
            let (y, s) = (y - y0, s - s0);
            n += 1.0;
            y1 += y;
            s1 += s;
            yy += y * y;
            ss += s * s;
            ys += y * s;
        });
        if n < 8.0 {
            return None;
        }
        let (vs, vy, c) = (ss - s1 * s1 / n, yy - y1 * y1 / n, ys - y1 * s1 / n);
        let gain = if vs > 1e-12 * ss { c / vs } else { 0.0 };
        let error = ((vy - gain * c).max(0.0) / n).sqrt();
        Some(Fit { offset: y0 + y1 / n - gain * (s0 + s1 / n), gain, delay, error })
    }

    /// The best delay of those with a gain of the wanted sign, in samples `from..to`.
    pub fn best_in(&self, from: usize, to: usize, reach: f64, sign: f64) -> Option<Fit> {
        let step = self.interval().max(self.period() / 20.0).min(reach / 2.0);
        let count = (reach / step).floor() as i32;
        // periodic signals come round again: a delay of half a period or more has to be far better
        let far = 0.45 * self.period();
        let cost = |fit: &Fit| fit.error * if fit.delay.abs() > far { FAR_DELAY } else { 1.0 };
        let try_at = |most: usize, delay: f64| {
            self.at_some(most, (from, to), delay, reach).filter(|fit| fit.gain * sign > 0.0)
        };
        let mut best: Option<Fit> = None;
        let better = |fit: Option<Fit>, best: &mut Option<Fit>| {
            if let Some(fit) = fit
                && best.is_none_or(|b| cost(&fit) < cost(&b))
            {
                *best = Some(fit);
            }
        };
        for k in -count..=count {
            better(try_at(MOST_COARSE, f64::from(k) * step), &mut best);
        }
        best = try_at(MOST, best?.delay).or(best);
        // between the grid's delays, four times three times finer
        let mut width = step;
        for _ in 0..4 {
            width /= 3.0;
            let centre = best?.delay;
            for k in [-2.0, -1.0, 1.0, 2.0] {
                let delay: f64 = centre + k * width;
                if delay.abs() <= reach {
                    better(try_at(MOST, delay), &mut best);
                }
            }
        }
        best
    }

    /// The best delay over the whole run, gain positive.
    pub fn best(&self) -> Option<Fit> {
        self.best_in(0, self.time.len(), self.reach(), 1.0)
    }

    /// What is left, as rms, with given offset, gain and delay.
    pub fn error(&self, offset: f64, gain: f64, delay: f64) -> f64 {
        let (mut sum, mut n) = (0.0, 0.0);
        self.visit(0, self.time.len(), delay, self.reach(), |y, s, _| {
            sum += (y - offset - gain * s).powi(2);
            n += 1.0;
        });
        (sum / f64::max(n, 1.0)).sqrt()
    }

    /// Standard deviation of the measured values.
    pub fn size(&self) -> f64 {
        deviation(&self.measured)
    }

    /// Half the range of the measured values.
    pub fn amplitude(&self) -> f64 {
        amplitude(&self.measured)
    }
}

/// The width of a signal's spectrum: 0 for a sine, 1 for white noise (Longuet-Higgins,
/// `sqrt(1 - m2^2 / (m0 m4))` with the spectral moments m).
pub fn bandwidth(time: &[f64], values: &[f64]) -> f64 {
    let slopes: Vec<f64> =
        (1..values.len()).map(|i| (values[i] - values[i - 1]) / (time[i] - time[i - 1])).collect();
    let middles: Vec<f64> = time.windows(2).map(|w| (w[0] + w[1]) / 2.0).collect();
    let ratio = period(&middles, &slopes) / period(time, values);
    (1.0 - ratio * ratio).max(0.0).sqrt()
}

/// Period \[s\] of the mean frequency of a signal, infinite for a constant.
pub fn period(time: &[f64], values: &[f64]) -> f64 {
    let mean = mean(values);
    let (mut power, mut slope) = (0.0, 0.0);
    for i in 1..values.len() {
        let dt = time[i] - time[i - 1];
        power += (values[i] - mean).powi(2) * dt;
        slope += (values[i] - values[i - 1]).powi(2) / dt;
    }
    2.0 * std::f64::consts::PI * (power / slope).sqrt()
}
