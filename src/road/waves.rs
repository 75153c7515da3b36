//! Profiles of sinusoids, raw and as means over a window.

use super::random::generator;
use crate::clone_in_place;
use crate::solver::lanes::{LANES, LARGEST_ANGLE, level, sin_cos, sum};
use fearless_simd::{Simd, dispatch, f64x4, prelude::*};
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// z = height (1 - cos(k (s - start))) / 2 behind `start`, 0 before: height and slope are continuous.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Versine {
    start: f64,
    /// From valley to peak \[m\].
    height: f64,
    /// k = 2 pi / wavelength \[rad/m\].
    wavenumber: f64,
}

impl Versine {
    pub(super) fn new(start: f64, height: f64, wavelength: f64) -> Self {
        Self { start, height, wavenumber: TAU / wavelength }
    }

    /// The height that they nowhere exceed \[m\].
    pub(super) fn highest(&self) -> f64 {
        self.height.abs()
    }

    /// What a window of `length` multiplies the waves with, where all of it lies behind `start`.
    pub(super) fn gain(&self, length: f64) -> f64 {
        gain(self.wavenumber * length)
    }

    /// Mean height over a window of `length` about `s`, its slope and curvature. `gain` is that of this length.
    pub(super) fn mean(&self, s: f64, length: f64, gain: f64) -> [f64; 3] {
        let d = s - self.start;
        if self.height == 0.0 || d <= -length {
            return [0.0; 3];
        }
        let (half, k) = (0.5 * self.height, self.wavenumber);
        let (one, sin, cos) = if d < length {
            let v = d / length;
            let (sin, cos) = mean_behind(k, d, length);
            (0.5 * (1.0 + v + libm::sin(PI * v) / PI), sin, cos)
        } else {
            let (sin, cos) = libm::sincos(k * d);
            (1.0, gain * sin, gain * cos)
        };
        [half * (one - cos), half * k * sin, half * k * k * cos]
    }

    /// Height, slope and curvature at `s`.
    pub(super) fn at(&self, s: f64) -> [f64; 3] {
        let d = s - self.start;
        if self.height == 0.0 || d < 0.0 {
            return [0.0; 3];
        }
        let (half, k) = (0.5 * self.height, self.wavenumber);
        let (sin, cos) = libm::sincos(k * d);
        [half * (1.0 - cos), half * k * sin, half * k * k * cos]
    }

    /// True if [`new`](Self::new) can have made it.
    pub(super) fn is_whole(&self) -> bool {
        [self.start, self.height, self.wavenumber].iter().all(|value| value.is_finite())
    }
}

/// Integrals of K(u) sin(k (d - u)) and K(u) cos(k (d - u)) over -L < u < d < L: a sinusoid that begins at
/// zero, its mean at d.
///
/// The products of cosines are sums of three, each integrated as its mean phase times a sinc, which has
/// no singular wavelength.
fn mean_behind(k: f64, d: f64, length: f64) -> (f64, f64) {
    let p = PI / length;
    let (span, middle) = (d + length, 0.5 * (d - length));
    let (mut sin, mut cos) = (0.0, 0.0);
    for (weight, q) in [(1.0, -k), (0.5, p - k), (0.5, -p - k)] {
        let (s, c) = libm::sincos(k * d + q * middle);
        let share = weight * sinc(0.5 * q * span);
        sin += share * s;
        cos += share * c;
    }
    let scale = 0.5 * span / length;
    (scale * sin, scale * cos)
}

/// What the window multiplies a sinusoid with, from a = 2 pi L / wavelength:
/// sin(a) / (a (1 - (a / pi)²)).
fn gain(a: f64) -> f64 {
    sinc(a) + 0.5 * (sinc(a - PI) + sinc(a + PI))
}

fn sinc(x: f64) -> f64 {
    if x.abs() < 1e-4 { 1.0 - x * x / 6.0 } else { libm::sin(x) / x }
}

/// Octaves of wavenumbers, and lines in each.
const OCTAVES: usize = 10;
const PER_OCTAVE: usize = 16;
/// Where they begin \[1/m\]; they end at 10.24 / m.
const LOWEST: f64 = 0.01;
/// Where the roughness is given, n0 \[1/m\].
const REFERENCE: f64 = 0.1;
/// Distance over which an irregular road begins \[m\].
const FADE_IN: f64 = 10.0;

/// An irregular road of ISO 8608: displacement PSD Gd(n) = Gd(n0) (n / n0)^-2, one-sided, n in cycles/m.
///
/// The sum of 160 sinusoids with random phases, 16 to the octave from 0.01 to 10.24 cycles/m; each has
/// the variance of its band. A line of the next octave has exactly twice the wavenumber, so one sine
/// and cosine give those of ten lines, by doubling.
///
/// Behind `start` the profile (its mean) is multiplied with a fade-in of half a cosine over 10 m.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Irregular {
    start: f64,
    /// Ten, or none.
    octaves: Vec<Octave>,
}

/// A number for each line of an octave.
pub(super) type Lines = [f64; PER_OCTAVE];

/// The lines of an octave: the sum of cos_part cos(k x) + sin_part sin(k x).
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct Octave {
    /// k = 2 pi n \[rad/m\].
    wavenumber: Lines,
    cos_part: Lines,
    sin_part: Lines,
}

clone_in_place!(Irregular { start, octaves });

impl Irregular {
    /// Left and right track of roughness Gd(n0) \[m³\]; every `seed` gives others. With a coherence length of 0
    /// both are the same, and the second is left out.
    ///
    /// Lines of the right track have the amplitude of those of the left and are shifted against them by an
    /// angle d. From an independent phase p and the coherence g it is
    ///
    /// exp(i d) = (g + exp(i p)) / (1 + g exp(i p)),
    ///
    /// of size 1. That is analytic in exp(i p) within the unit circle, so its mean over p is its value at
    /// exp(i p) = 0: g. At g = 1 both phases are the same, at g = 0 they are independent.
    pub(super) fn new(start: f64, roughness: f64, seed: i32, coherence_length: f64) -> (Self, Option<Self>) {
        let mut random = generator(seed);
        let mut octaves = vec![Octave::default(); OCTAVES];
        let edge = |i: usize| libm::exp2(i as f64 / PER_OCTAVE as f64) * LOWEST;
        for i in 0..PER_OCTAVE {
            let (from, to) = (edge(i), edge(i + 1));
            let (mut n, mut width) = ((from * to).sqrt(), to - from);
            for octave in &mut octaves {
                let density = roughness * (REFERENCE / n) * (REFERENCE / n);
                let amplitude = (2.0 * density * width).sqrt();
                let (sin, cos) = libm::sincos(TAU * random.uniform());
                octave.wavenumber[i] = TAU * n;
                octave.cos_part[i] = amplitude * cos;
                octave.sin_part[i] = amplitude * sin;
                n *= 2.0;
                width *= 2.0;
            }
        }
        let left = Self { start, octaves };
        if coherence_length == 0.0 {
            return (left, None);
        }
        // after all phases of the left track, which so are those of the road without a coherence
        let mut right = left.clone();
        for i in 0..PER_OCTAVE {
            for octave in &mut right.octaves {
                let g = libm::exp(-coherence_length * octave.wavenumber[i] / TAU);
                let (sin, cos) = libm::sincos(TAU * random.uniform());
                // cos d and sin d less the denominator 1 + 2 g cos p + g²
                let (by_cos, by_sin) = (2.0 * g + (1.0 + g * g) * cos, (1.0 - g * g) * sin);
                let size = libm::hypot(by_cos, by_sin);
                // g = 1 within rounding, and p half a turn
                let (by_cos, by_sin) = if size > 0.0 { (by_cos / size, by_sin / size) } else { (1.0, 0.0) };
                let (a, b) = (octave.cos_part[i], octave.sin_part[i]);
                octave.cos_part[i] = a * by_cos - b * by_sin;
                octave.sin_part[i] = a * by_sin + b * by_cos;
            }
        }
        (left, Some(right))
    }

    /// What a window of `length` multiplies the lines of every octave with.
    pub(super) fn gains(&self, length: f64) -> Vec<Lines> {
        self.octaves.iter().map(|octave| octave.wavenumber.map(|k| gain(k * length))).collect()
    }

    /// Octaves, and so [`gains`](Self::gains).
    pub(super) fn len(&self) -> usize {
        self.octaves.len()
    }

    /// Mean height over a window about `s` whose `gains` these are, its slope and curvature.
    pub(super) fn mean<'a>(
        &self,
        s: f64,
        gains: impl IntoIterator<Item = &'a Lines, IntoIter: Clone>,
    ) -> [f64; 3] {
        let x = s - self.start;
        if self.octaves.is_empty() || x <= 0.0 {
            return [0.0; 3];
        }
        let [w, slope, curvature] = dispatch!(level(), simd => self.sums(simd, x, gains));
        let (fade, by_x, by_xx) = fade_in(x);
        [fade * w, fade * slope + by_x * w, fade * curvature + 2.0 * by_x * slope + by_xx * w]
    }

    /// Height, slope and curvature at `s`.
    pub(super) fn at(&self, s: f64) -> [f64; 3] {
        self.mean(s, std::iter::repeat(&[1.0; PER_OCTAVE]))
    }

    /// Sums of all lines at x, and of their slopes and curvatures; four lines of an octave at once.
    #[inline(always)]
    fn sums<'a, S: Simd>(
        &self,
        simd: S,
        x: f64,
        gains: impl IntoIterator<Item = &'a Lines, IntoIter: Clone>,
    ) -> [f64; 3] {
        let (gains, zero) = (gains.into_iter(), f64x4::splat(simd, 0.0));
        let Some(first) = self.octaves.first() else { return [0.0; 3] };
        let (mut height, mut slope, mut curvature) = (zero, zero, zero);
        for i in (0..PER_OCTAVE).step_by(LANES) {
            let four = |lines: &Lines| f64x4::from_slice(simd, &lines[i..i + LANES]);
            let (mut sin, mut cos) = sin_cos_of(simd, four(&first.wavenumber) * x);
            for (octave, gain) in self.octaves.iter().zip(gains.clone()) {
                let (k, gain) = (four(&octave.wavenumber), four(gain));
                let (a, b) = (gain * four(&octave.cos_part), gain * four(&octave.sin_part));
                let value = a * cos + b * sin;
                height += value;
                slope += k * (b * cos - a * sin);
                curvature -= k * k * value;
                (sin, cos) = (sin * cos * 2.0, -(sin * sin * 2.0) + 1.0);
            }
        }
        [sum(height), sum(slope), sum(curvature)]
    }

    /// True if [`new`](Self::new) can have made it.
    pub(super) fn is_whole(&self) -> bool {
        let finite = |o: &Octave| {
            [o.wavenumber, o.cos_part, o.sin_part].iter().flatten().all(|value| value.is_finite())
        };
        self.start.is_finite()
            && (self.octaves.is_empty() || self.octaves.len() == OCTAVES)
            && self.octaves.iter().all(finite)
    }
}

/// Sine and cosine of angles of any size.
#[inline(always)]
fn sin_cos_of<S: Simd>(simd: S, angle: f64x4<S>) -> (f64x4<S>, f64x4<S>) {
    if angle.abs().simd_le(LARGEST_ANGLE).all_true() {
        return sin_cos(simd, angle);
    }
    // a road of thousands of kilometres
    let both = <[f64; LANES]>::from(angle).map(libm::sincos);
    (f64x4::from_slice(simd, &both.map(|b| b.0)), f64x4::from_slice(simd, &both.map(|b| b.1)))
}

/// The fade-in and its first two derivatives.
fn fade_in(x: f64) -> (f64, f64, f64) {
    if x <= 0.0 {
        return (0.0, 0.0, 0.0);
    }
    if x >= FADE_IN {
        return (1.0, 0.0, 0.0);
    }
    let k = PI / FADE_IN;
    let (sin, cos) = libm::sincos(k * x);
    (0.5 * (1.0 - cos), 0.5 * k * sin, 0.5 * k * k * cos)
}
