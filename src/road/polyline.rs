//! Profiles of straight pieces with vertical edges, filtered.

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
    /// Cosine and sine of pi at / L: differences of phases then need no elementary functions.
    cos: f64,
    sin: f64,
}

clone_in_place!(Polyline { origin, rest, kinks, period });

impl Polyline {
    /// The polyline through points (x counted from `start`, z) \[m\], x never decreasing, for a filter of
    /// length `length`.
    pub(super) fn new(start: f64, points: &[[f64; 2]], period: Option<f64>, length: f64) -> Self {
        let Some(&[first, rest]) = points.first() else { return Self::default() };
        let mut kinks: Vec<Kink> = Vec::new();
        let (mut height_before, mut slope_before) = (rest, 0.0);
        for (i, &[x, z]) in points.iter().enumerate() {
            let slope = match points.get(i + 1) {
                Some(next) if next[0] == x => continue, // the next point is the upper end of an edge
                Some(next) => (next[1] - z) / (next[0] - x),
                None => 0.0,
            };
            let (sin, cos) = libm::sincos(PI * (x - first) / length);
            let (jump, bend) = (z - height_before, slope - slope_before);
            if jump != 0.0 || bend != 0.0 {
                kinks.push(Kink { at: x - first, height: z, slope, jump, bend, cos, sin });
            }
            slope_before = slope;
            height_before = points.get(i + 1).map_or(z, |next| next[1]);
        }
        Self { origin: start + first, rest, kinks, period }
    }

    /// Filtered height, slope and curvature at `s`.
    pub(super) fn at(&self, s: f64, length: f64) -> [f64; 3] {
        if self.kinks.is_empty() {
            return [self.rest, 0.0, 0.0];
        }
        // The piece where the kernel begins, continued, and what the kinks within the kernel change.
        let begin = s - self.origin - length;
        let first = self.copy(begin);
        let (passed, height, slope) = self.piece(first, begin);
        // in units of L along the road, which leaves no division to the kinks
        let scale = 1.0 / length;
        let (mut w, mut by_v, mut by_vv) = (height + slope * length, slope * length, 0.0);
        for n in first..=self.copy(begin + 2.0 * length) {
            let u = begin - self.shift(n) + length;
            let phase = libm::sincos(PI * u / length);
            let kinks = if n == first { &self.kinks[passed..] } else { &self.kinks };
            for kink in kinks.iter().take_while(|k| k.at < u + length) {
                let response = Response::new(kink, (u - kink.at) * scale, phase);
                let bend = kink.bend * length;
                w += kink.jump * response.step + bend * response.ramp;
                by_v += kink.jump * response.kernel + bend * response.step;
                by_vv += kink.jump * response.kernel_slope + bend * response.kernel;
            }
        }
        [w, by_v * scale, by_vv * scale * scale]
    }

    /// Height at `s`, not filtered.
    pub(super) fn raw(&self, s: f64) -> f64 {
        let t = s - self.origin;
        self.piece(self.copy(t), t).1
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
    pub(super) fn is_whole(&self, length: f64) -> bool {
        let finite = |k: &Kink| {
            [k.at, k.height, k.slope, k.jump, k.bend, k.cos, k.sin].iter().all(|value| value.is_finite())
        };
        let extent = self.kinks.last().map_or(0.0, |k| k.at);
        self.origin.is_finite()
            && self.rest.is_finite()
            && self.kinks.iter().all(finite)
            && self.kinks.windows(2).all(|pair| pair[0].at < pair[1].at)
            && self.period.is_none_or(|p| p.is_finite() && p >= extent && p >= shortest_period(length))
    }
}

/// Copies closer than this \[m\] to each other make an evaluation long and are no road.
pub(super) fn shortest_period(length: f64) -> f64 {
    length / 100.0
}

/// What the filter makes of a unit step and a unit change of slope, v behind them, all in units of L.
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
    /// From v and the sine and cosine of the phase pi s / L.
    #[inline]
    fn new(kink: &Kink, v: f64, (sin_s, cos_s): (f64, f64)) -> Self {
        let sin = sin_s * kink.cos - cos_s * kink.sin;
        let cos = cos_s * kink.cos + sin_s * kink.sin;
        let kernel = 0.5 * (1.0 + cos);
        Self {
            ramp: 0.25 * (1.0 + v) * (1.0 + v) - kernel * (FRAC_1_PI * FRAC_1_PI),
            step: 0.5 * (1.0 + v + sin * FRAC_1_PI),
            kernel,
            kernel_slope: -0.5 * PI * sin,
        }
    }
}
