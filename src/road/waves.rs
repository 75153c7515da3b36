//! Profiles of sinusoids, filtered.

use crate::clone_in_place;
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
    /// Of the filter, where all of it lies behind `start`.
    gain: f64,
}

impl Versine {
    pub(super) fn new(start: f64, height: f64, wavelength: f64, length: f64) -> Self {
        let wavenumber = TAU / wavelength;
        Self { start, height, wavenumber, gain: gain(wavenumber * length) }
    }

    /// Filtered height, slope and curvature at `s`.
    pub(super) fn at(&self, s: f64, length: f64) -> [f64; 3] {
        let d = s - self.start;
        if self.height == 0.0 || d <= -length {
            return [0.0; 3];
        }
        let (half, k) = (0.5 * self.height, self.wavenumber);
        let (one, sin, cos) = if d < length {
            let v = d / length;
            let (sin, cos) = filtered_behind(k, d, length);
            (0.5 * (1.0 + v + libm::sin(PI * v) / PI), sin, cos)
        } else {
            let (sin, cos) = libm::sincos(k * d);
            (1.0, self.gain * sin, self.gain * cos)
        };
        [half * (one - cos), half * k * sin, half * k * k * cos]
    }

    /// Height at `s`, not filtered.
    pub(super) fn raw(&self, s: f64) -> f64 {
        let d = (s - self.start).max(0.0);
        0.5 * self.height * (1.0 - libm::cos(self.wavenumber * d))
    }

    /// True if [`new`](Self::new) can have made it.
    pub(super) fn is_whole(&self) -> bool {
        [self.start, self.height, self.wavenumber, self.gain].iter().all(|value| value.is_finite())
    }
}

/// Integrals of K(u) sin(k (d - u)) and K(u) cos(k (d - u)) over -L < u < d < L: a sinusoid that begins at
/// zero, filtered at d.
///
/// The products of cosines are sums of three, each integrated as its mean phase times a sinc, which has
/// no singular wavelength.
fn filtered_behind(k: f64, d: f64, length: f64) -> (f64, f64) {
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

/// What the filter multiplies a sinusoid with, from a = 2 pi L / wavelength:
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
/// Behind `start` the (filtered) profile is multiplied with a fade-in of half a cosine over 10 m.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Irregular {
    start: f64,
    /// Ten, or none.
    octaves: Vec<Octave>,
}

/// The lines of an octave: the sum of cos_part cos(k x) + sin_part sin(k x), times `gain` when filtered.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct Octave {
    /// k = 2 pi n \[rad/m\].
    wavenumber: [f64; PER_OCTAVE],
    cos_part: [f64; PER_OCTAVE],
    sin_part: [f64; PER_OCTAVE],
    gain: [f64; PER_OCTAVE],
}

clone_in_place!(Irregular { start, octaves });

impl Irregular {
    /// The road of roughness Gd(n0) \[m³\]; every `seed` gives another one.
    pub(super) fn new(start: f64, roughness: f64, seed: i32, length: f64) -> Self {
        let mut random = SplitMix64(i64::from(seed).cast_unsigned());
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
                octave.gain[i] = gain(TAU * n * length);
                n *= 2.0;
                width *= 2.0;
            }
        }
        Self { start, octaves }
    }

    /// Filtered height, slope and curvature at `s`.
    pub(super) fn at(&self, s: f64) -> [f64; 3] {
        let x = s - self.start;
        if self.octaves.is_empty() || x <= 0.0 {
            return [0.0; 3];
        }
        // one sum for each line of an octave: independent sums are quick
        let mut sums = [[0.0; PER_OCTAVE]; 3];
        self.for_octaves(x, |octave, sin, cos| {
            for i in 0..PER_OCTAVE {
                let k = octave.wavenumber[i];
                let (a, b) = (octave.gain[i] * octave.cos_part[i], octave.gain[i] * octave.sin_part[i]);
                let value = a * cos[i] + b * sin[i];
                sums[0][i] += value;
                sums[1][i] += k * (b * cos[i] - a * sin[i]);
                sums[2][i] -= k * k * value;
            }
        });
        let [w, slope, curvature] = sums.map(|sum| sum.iter().sum::<f64>());
        let (fade, by_x, by_xx) = fade_in(x);
        [fade * w, fade * slope + by_x * w, fade * curvature + 2.0 * by_x * slope + by_xx * w]
    }

    /// Height at `s`, not filtered.
    pub(super) fn raw(&self, s: f64) -> f64 {
        let x = s - self.start;
        let mut z = 0.0;
        if x > 0.0 {
            self.for_octaves(x, |octave, sin, cos| {
                for i in 0..PER_OCTAVE {
                    z += octave.cos_part[i] * cos[i] + octave.sin_part[i] * sin[i];
                }
            });
        }
        fade_in(x).0 * z
    }

    /// Calls `f` with every octave and the sines and cosines of its phases at `x`.
    #[inline]
    fn for_octaves(&self, x: f64, mut f: impl FnMut(&Octave, &[f64; PER_OCTAVE], &[f64; PER_OCTAVE])) {
        let Some(first) = self.octaves.first() else { return };
        let (mut sin, mut cos) = ([0.0; PER_OCTAVE], [0.0; PER_OCTAVE]);
        for i in 0..PER_OCTAVE {
            (sin[i], cos[i]) = libm::sincos(first.wavenumber[i] * x);
        }
        for octave in &self.octaves {
            f(octave, &sin, &cos);
            for i in 0..PER_OCTAVE {
                (sin[i], cos[i]) = (2.0 * sin[i] * cos[i], 1.0 - 2.0 * sin[i] * sin[i]);
            }
        }
    }

    /// True if [`new`](Self::new) can have made it.
    pub(super) fn is_whole(&self) -> bool {
        let finite = |o: &Octave| {
            [o.wavenumber, o.cos_part, o.sin_part, o.gain].iter().flatten().all(|value| value.is_finite())
        };
        self.start.is_finite()
            && (self.octaves.is_empty() || self.octaves.len() == OCTAVES)
            && self.octaves.iter().all(finite)
    }
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

/// Steele, Lea and Flood's generator (2014): a counter that is scrambled.
struct SplitMix64(u64);

impl SplitMix64 {
    /// The next number, at least 0 and below 1.
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^= z >> 31;
        // 53 bits are what a number holds
        (z >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::SplitMix64;

    #[test]
    fn the_generator_is_the_published_one() {
        let mut random = SplitMix64(1_234_567);
        // the first numbers of the authors' generator
        for published in [6_457_827_717_110_365_317_u64, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423]
        {
            assert_eq!(random.uniform(), (published >> 11) as f64 / (1_u64 << 53) as f64);
        }
    }
}
