//! Profiles of straight pieces with vertical edges, raw and as means over a window.

use crate::clone_in_place;
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_1_PI, PI};

/// Straight pieces between kinks; level before the first kink and behind the last. Repeated or not.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Polyline {
    /// Place of the first kink \[m\].
    origin: f64,
    /// Height before it \[m\].
    rest: f64,
    kinks: Vec<Kink>,
    /// Distance of the copies \[m\], which begin and end at the height `rest`.
    period: Option<f64>,
}

/// A place where height or slope change.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct Kink {
    /// Distance from the first kink \[m\].
    at: f64,
    /// Height and slope behind it.
    height: f64,
    slope: f64,
    /// How they change there.
    jump: f64,
    bend: f64,
}

clone_in_place!(Polyline { origin, rest, kinks, period });

impl Polyline {
    /// The polyline through points (x counted from `start`, z) \[m\], x never decreasing.
    pub(super) fn new(start: f64, points: &[[f64; 2]], period: Option<f64>) -> Self {
        let Some(&[first, rest]) = points.first() else { return Self::default() };
        let mut kinks: Vec<Kink> = Vec::new();
        let (mut height_before, mut slope_before) = (rest, 0.0);
        for (i, &[x, z]) in points.iter().enumerate() {
            let slope = match points.get(i + 1) {
                Some(next) if next[0] == x => continue, // the next point is the upper end of an edge
                Some(next) => (next[1] - z) / (next[0] - x),
                None => 0.0,
            };
            let (jump, bend) = (z - height_before, slope - slope_before);
            if jump != 0.0 || bend != 0.0 {
                kinks.push(Kink { at: x - first, height: z, slope, jump, bend });
            }
            slope_before = slope;
            height_before = points.get(i + 1).map_or(z, |next| next[1]);
        }
        Self { origin: start + first, rest, kinks, period }
    }

    /// Cosine and sine of pi at / L for every kink and a window of `length` L: differences of phases then need
    /// no elementary functions.
    pub(super) fn phases(&self, length: f64) -> Vec<[f64; 2]> {
        let phase = |kink: &Kink| {
            let (sin, cos) = libm::sincos(PI * kink.at / length);
            [cos, sin]
        };
        self.kinks.iter().map(phase).collect()
    }

    /// Mean height over a window of `length` about `s`, its slope and curvature. `phases` are those of this
    /// length.
    pub(super) fn mean(&self, s: f64, length: f64, phases: &[[f64; 2]]) -> [f64; 3] {
        if self.kinks.is_empty() {
            return [self.rest, 0.0, 0.0];
        }
        // The piece where the window begins, continued, and what the kinks within the window change.
        let begin = s - self.origin - length;
        let first = self.copy(begin);
        let (passed, height, slope) = self.piece(first, begin);
        // in units of L along the road, which leaves no division to the kinks
        let scale = 1.0 / length;
        let (mut w, mut by_v, mut by_vv) = (height + slope * length, slope * length, 0.0);
        for n in first..=self.copy(begin + 2.0 * length) {
            let u = begin - self.shift(n) + length;
            let phase = libm::sincos(PI * u / length);
            let from = if n == first { passed } else { 0 };
            let kinks = self.kinks[from..].iter().take_while(|k| k.at < u + length);
            // of another road's window there may be fewer phases
            for (kink, of_kink) in kinks.zip(phases.get(from..).unwrap_or_default()) {
                let response = Response::new((u - kink.at) * scale, phase, of_kink);
                let bend = kink.bend * length;
                w += kink.jump * response.step + bend * response.ramp;
                by_v += kink.jump * response.kernel + bend * response.step;
                by_vv += kink.jump * response.kernel_slope + bend * response.kernel;
            }
        }
        [w, by_v * scale, by_vv * scale * scale]
    }

    /// Height and slope at `s`; at an edge those behind it.
    pub(super) fn at(&self, s: f64) -> [f64; 2] {
        let mut u = s - self.origin;
        if let Some(period) = self.period.filter(|_| u >= 0.0) {
            let begun = u - self.shift(self.copy(u));
            // rounding must not put the beginning of a copy before it or behind the end of the last
            u = if begun < period { begun.max(0.0) } else { 0.0 };
        }
        let (_, height, slope) = self.piece(0, u);
        [height, slope]
    }

    /// The height that it nowhere exceeds \[m\].
    pub(super) fn highest(&self) -> f64 {
        self.kinks.iter().fold(self.rest, |most, kink| most.max(kink.height).max(kink.height - kink.jump))
    }

    /// Distance of the copies \[m\].
    pub(super) fn period(&self) -> Option<f64> {
        self.period
    }

    /// Kinks and so [`phases`](Self::phases).
    pub(super) fn len(&self) -> usize {
        self.kinks.len()
    }

    /// Kinks of copy `n` up to `t`, height and slope at `t`.
    fn piece(&self, n: u64, t: f64) -> (usize, f64, f64) {
        let u = t - self.shift(n);
        match self.kinks.partition_point(|k| k.at <= u) {
            0 => (0, self.rest, 0.0),
            passed => {
                let Kink { at, height, slope, .. } = self.kinks[passed - 1];
                (passed, height + slope * (u - at), slope)
            }
        }
    }

    /// Number of the copy at `t`: the first from minus infinity on.
    fn copy(&self, t: f64) -> u64 {
        // saturates for negative numbers
        self.period.map_or(0, |period| (t / period).floor() as u64)
    }

    /// Where copy `n` begins.
    fn shift(&self, n: u64) -> f64 {
        self.period.map_or(0.0, |period| n as f64 * period)
    }

    /// True if [`new`](Self::new) can have made it.
    pub(super) fn is_whole(&self) -> bool {
        let finite =
            |k: &Kink| [k.at, k.height, k.slope, k.jump, k.bend].iter().all(|value| value.is_finite());
        let extent = self.kinks.last().map_or(0.0, |k| k.at);
        self.origin.is_finite()
            && self.rest.is_finite()
            && self.kinks.iter().all(finite)
            && self.kinks.windows(2).all(|pair| pair[0].at < pair[1].at)
            && self.period.is_none_or(|p| p.is_finite() && p >= extent && p > 0.0)
    }
}

/// What the window makes of a unit step and a unit change of slope, v behind them, all in units of L.
struct Response {
    /// Integral of `step`.
    ramp: f64,
    /// Integral of `kernel`.
    step: f64,
    /// K.
    kernel: f64,
    /// dK/dv.
    kernel_slope: f64,
}

impl Response {
    /// From v, sine and cosine of the phase pi s / L, and cosine and sine of that of the kink.
    #[inline]
    fn new(v: f64, (sin_s, cos_s): (f64, f64), &[kink_cos, kink_sin]: &[f64; 2]) -> Self {
        let sin = sin_s * kink_cos - cos_s * kink_sin;
        let cos = cos_s * kink_cos + sin_s * kink_sin;
        let kernel = 0.5 * (1.0 + cos);
        Self {
            ramp: 0.25 * (1.0 + v) * (1.0 + v) - kernel * (FRAC_1_PI * FRAC_1_PI),
            step: 0.5 * (1.0 + v + sin * FRAC_1_PI),
            kernel,
            kernel_slope: -0.5 * PI * sin,
        }
    }
}
