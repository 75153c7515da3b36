//! What a rig does in a run: waves for the inputs, and when samples are taken.

use crate::base::Base;
use crate::flat_track;
use crate::random::Random;
use std::f64::consts::{PI, TAU};

/// The course of one input, about 0.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Wave {
    /// Nothing.
    Rest,
    /// Amplitude, first and last frequency \[Hz\], duration.
    Chirp(f64, f64, f64, f64),
    /// Amplitude, period \[s\], phase in periods.
    Triangle(f64, f64, f64),
    /// (time, level) reached by then, over this time \[s\].
    Steps(Vec<(f64, f64)>, f64),
    /// (amplitude, angular frequency, phase).
    Sines(Vec<[f64; 3]>),
    /// Amplitude, three frequencies \[Hz\] one after the other, duration.
    Holds(f64, [f64; 3], f64),
}

fn rise(x: f64) -> f64 {
    0.5 - 0.5 * libm::cos(PI * x.clamp(0.0, 1.0))
}

impl Wave {
    pub(crate) fn at(&self, t: f64) -> f64 {
        let fade = rise(t / 0.4);
        match self {
            Self::Rest => 0.0,
            Self::Chirp(a, from, to, over) => {
                fade * a * libm::sin(TAU * (from * t + 0.5 * (to - from) * t * t / over))
            }
            Self::Triangle(a, period, phase) => {
                let x = t / period + phase + 0.25;
                fade * a * (4.0 * (x - x.floor() - 0.5).abs() - 1.0)
            }
            Self::Steps(levels, over) => {
                let step = |from: f64, (time, to): &(f64, f64)| from + (to - from) * rise((t - time) / over);
                levels.iter().fold(0.0, step)
            }
            Self::Sines(list) => {
                fade * list.iter().map(|[a, w, phase]| a * libm::sin(w * t + phase)).sum::<f64>()
            }
            Self::Holds(a, frequencies, over) => {
                let third = over / 3.0;
                let part = (t / third).clamp(0.0, 2.99).floor();
                let inside = t - part * third;
                let window = rise(inside / 0.3) * rise((third - inside) / 0.3);
                let frequency = if part < 1.0 {
                    frequencies[0]
                } else if part < 2.0 {
                    frequencies[1]
                } else {
                    frequencies[2]
                };
                window * a * libm::sin(TAU * frequency * inside)
            }
        }
    }

    /// A wave of this amplitude within a band \[Hz\].
    pub(crate) fn draw(random: &mut Random, amplitude: f64, band: (f64, f64), duration: f64) -> Self {
        let kind = random.below(5);
        Self::of(kind, random, amplitude, band, duration)
    }

    pub(crate) fn of(
        kind: usize,
        random: &mut Random,
        amplitude: f64,
        band: (f64, f64),
        duration: f64,
    ) -> Self {
        match kind {
            0 if random.chance(0.5) => Self::Chirp(amplitude, band.0, band.1, duration),
            0 => Self::Chirp(amplitude, band.1, band.0, duration),
            1 => Self::Triangle(amplitude, random.within(1.5, 3.0), random.pick(&[0.0, 0.5])),
            2 => Self::steps(random, amplitude, duration, 0.6 / band.1.max(1.5)),
            3 => {
                let share = amplitude * (2.0_f64 / 10.0).sqrt() * 0.8;
                Self::Sines(
                    (0..10)
                        .map(|_| [share, TAU * random.log_within(band.0, band.1), TAU * random.share()])
                        .collect(),
                )
            }
            _ => Self::Holds(amplitude, std::array::from_fn(|_| random.log_within(band.0, band.1)), duration),
        }
    }

    /// A slow sweep to both sides, its period within `periods` \[s\].
    pub(crate) fn triangle(random: &mut Random, amplitude: f64, periods: (f64, f64)) -> Self {
        Self::Triangle(amplitude, random.within(periods.0, periods.1), random.pick(&[0.0, 0.5]))
    }

    pub(crate) fn steps(random: &mut Random, amplitude: f64, duration: f64, over: f64) -> Self {
        let mut levels = Vec::new();
        let mut t = random.within(0.3, 0.6);
        while t < duration - 0.4 {
            let zero = levels.len() % 3 == 2;
            levels.push((t, if zero { 0.0 } else { random.sign() * random.within(0.4, 1.0) * amplitude }));
            t += random.within(0.5, 1.2);
        }
        Self::Steps(levels, over)
    }

    /// Steps that are never negative, each between holds.
    fn pulses(random: &mut Random, top: f64, duration: f64, over: f64) -> Self {
        let mut levels = Vec::new();
        let mut t = random.within(0.3, 0.5);
        while t < duration - 0.3 {
            let zero = levels.len() % 3 == 2;
            levels.push((t, if zero { 0.0 } else { random.within(0.3, 1.0) * top }));
            t += over + random.within(0.25, 0.8);
        }
        Self::Steps(levels, over)
    }
}

/// What a programme is limited to, for runs that shall not show everything. Shares of the usual range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Region {
    /// Share of the usual amplitude, least and most.
    pub amplitude: (f64, f64),
    /// Travel speed \[m/s\].
    pub speed: (f64, f64),
    /// Wheel load \[N\].
    pub load: (f64, f64),
    /// Upper end of the band over the usual.
    pub band: f64,
    /// Whether runs at rest or without load are among them.
    pub rest: bool,
}

/// Everything that a rig would drive.
pub const EVERYTHING: Region =
    Region { amplitude: (0.25, 1.0), speed: (6.0, 32.0), load: (2000.0, 6000.0), band: 1.0, rest: true };

/// Samples of the inputs of a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Run {
    /// When samples are truly taken \[s\].
    pub time: Vec<f64>,
    /// Per input its true values at these times; straight lines between.
    pub inputs: Vec<Vec<f64>>,
}

/// How a case samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampling {
    /// Samples per second.
    pub rate: f64,
    /// Duration of a run \[s\].
    pub duration: f64,
    /// Standard deviation of the sampling times, over the interval.
    pub jitter: f64,
}

/// Run number `index` of a programme. `gain` scales all amplitudes.
#[must_use]
pub fn draw(
    base: Base,
    random: &mut Random,
    sampling: &Sampling,
    region: &Region,
    index: usize,
    gain: f64,
) -> Run {
    let time = times(random, sampling);
    let waves = waves(base, random, sampling.duration, region, index, gain);
    let inputs = waves
        .iter()
        .map(|(mean, wave, least)| time.iter().map(|t| (mean + wave.at(*t)).max(*least)).collect())
        .collect();
    Run { time, inputs }
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss)] // small counts
fn times(random: &mut Random, sampling: &Sampling) -> Vec<f64> {
    let count = (sampling.rate * sampling.duration) as usize;
    let interval = 1.0 / sampling.rate;
    (0..count)
        .map(|k| {
            let shift = if k == 0 { 0.0 } else { sampling.jitter * random.normal().clamp(-3.0, 3.0) };
            (k as f64 + shift) * interval
        })
        .collect()
}

/// Per input its mean, its wave and the least value.
fn waves(
    base: Base,
    random: &mut Random,
    duration: f64,
    region: &Region,
    index: usize,
    gain: f64,
) -> Vec<(f64, Wave, f64)> {
    const ANY: f64 = f64::NEG_INFINITY;
    let resting = region.rest && index == 3;
    let level = gain * random.log_within(region.amplitude.0, region.amplitude.1);
    let speed = random.within(region.speed.0, region.speed.1);
    let load = random.within(region.load.0, region.load.1);
    match base {
        Base::Oscillator => {
            let top = 7.0 * region.band;
            let wave = if resting {
                Wave::Rest
            } else {
                Wave::of(index % 5, random, 65.0 * level, (0.3, top), duration)
            };
            vec![(0.0, wave, ANY)]
        }
        Base::QuarterCar => {
            let top = 12.0 * region.band;
            let kind = index % 5;
            let height = if kind == 0 || kind == 4 { 0.009 } else { 0.02 };
            let road = if resting {
                Wave::Rest
            } else {
                Wave::of(kind, random, height * level, (0.4, top), duration)
            };
            let force = if index % 4 == 2 {
                Wave::draw(random, 600.0 * level, (0.3, 5.0), duration)
            } else {
                Wave::Rest
            };
            vec![(0.0, road, ANY), (0.0, force, ANY)]
        }
        Base::SteadyTire | Base::MagicWheel => {
            let top = 4.0 * region.band;
            let wheel = base == Base::MagicWheel;
            let lifted = resting && !wheel;
            let load = if lifted { 0.0 } else { load };
            let sideways = index % 3 != 1;
            let along = !index.is_multiple_of(3);
            let side =
                if sideways { Wave::draw(random, 0.12 * level, (0.2, top), duration) } else { Wave::Rest };
            let camber = if index % 4 == 1 || index % 5 == 2 {
                Wave::draw(random, 0.07, (0.2, 1.0), duration)
            } else {
                Wave::Rest
            };
            let swing = if index % 4 == 2 && !lifted && region.load.1 > region.load.0 {
                Wave::draw(random, 0.3 * load, (0.2, 1.5), duration)
            } else {
                Wave::Rest
            };
            let pace = if index % 5 == 4 && region.speed.1 > region.speed.0 {
                Wave::draw(random, 0.25 * speed, (0.1, 0.4), duration)
            } else {
                Wave::Rest
            };
            let first = if !along {
                Wave::Rest
            } else if wheel {
                let room = if sideways { 0.45 } else { 0.7 };
                Wave::pulses(random, room * level.min(1.0) * 0.32 * load * 0.9, duration, random_rise(index))
            } else {
                Wave::draw(random, 0.12 * level, (0.2, top), duration)
            };
            let least = if wheel { 0.0 } else { ANY };
            vec![
                (0.0, first, least),
                (0.0, side, ANY),
                (0.0, camber, ANY),
                (load, swing, 0.0),
                (speed, pace, 0.0),
            ]
        }
        Base::BrakeCorner | Base::AbsBrake => {
            let load = load.clamp(3000.0, 5200.0);
            let locks = 1.1 * load * 0.32 / 2.4e-4;
            let share = if base == Base::AbsBrake { random.within(0.8, 1.9) } else { 0.72 * level.min(1.0) };
            let over = random.pick(&[0.08, 0.15, 0.3]);
            let kind = if base == Base::AbsBrake { 0 } else { index % 4 };
            let pressure = match kind {
                _ if resting => Wave::Rest,
                1 => Wave::Steps(vec![(0.4, share * locks)], duration - 1.2),
                2 => {
                    let swell = random.within(0.5, 1.0);
                    Wave::Steps(vec![(0.4, share * locks), (0.9 + swell, 0.25 * share * locks)], 0.5 + swell)
                }
                _ => Wave::pulses(random, share * locks, duration, over),
            };
            let swing = if index % 3 == 1 {
                Wave::draw(random, 0.12 * load, (0.3, 2.5), duration)
            } else {
                Wave::Rest
            };
            let start = speed.max(18.0) + 8.0;
            vec![(0.0, pressure, 0.0), (load, swing, 0.0), (start, Wave::Rest, 0.0)]
        }
        Base::FlatTrack => flat_track::waves(random, duration, region, index),
    }
}

fn random_rise(index: usize) -> f64 {
    [0.06, 0.12, 0.25, 0.4][index % 4]
}
