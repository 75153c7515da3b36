//! The programme of a session: twelve runs as a flat-track rig drives them, the last three for checking.

use super::rig::{CAMBER, Commands, DEFLECTION, SLIP, SLIP_ANGLE, SPEED};
use crate::random::Random;
use std::f64::consts::TAU;

/// Samples per second.
pub(crate) const RATE: f64 = 200.0;
/// So many runs.
pub(crate) const RUNS: usize = 12;
/// The last of them are for checking.
pub(crate) const CHECKS: usize = 3;

/// The course of a command.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Course {
    /// It stays.
    Hold(f64),
    /// About a middle, by an amplitude, with a period \[s\]: straight to and fro, from the middle on.
    Triangle(f64, f64, f64),
    /// The same as a sine, from a phase on.
    Sine(f64, f64, f64, f64),
    /// About zero, from one frequency to another \[Hz\] within so many seconds.
    Sweep(f64, f64, f64, f64),
    /// Levels that are held for so many seconds each; the rig goes to the next one within a rise time \[s\].
    Steps(Vec<f64>, f64, f64),
    /// From a value to another between two times \[s\].
    Ramp(f64, f64, f64, f64),
}

/// From 0 to 1 without corners while x goes from 0 to 1: no drive jumps.
fn smooth(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * x * (10.0 - 15.0 * x + 6.0 * x * x)
}

impl Course {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // a few levels
    pub(crate) fn at(&self, t: f64) -> f64 {
        match self {
            Self::Hold(value) => *value,
            Self::Triangle(middle, amplitude, period) => {
                let turn = t / period + 0.25;
                middle + amplitude * (1.0 - 4.0 * (turn - turn.floor() - 0.5).abs())
            }
            Self::Sine(middle, amplitude, period, phase) => {
                middle + amplitude * libm::sin(TAU * t / period + phase)
            }
            Self::Sweep(amplitude, low, high, duration) => {
                amplitude * libm::sin(TAU * t * (low + 0.5 * (high - low) * t / duration))
            }
            Self::Steps(levels, hold, rise) => {
                let number = (t / hold).floor().max(0.0);
                let level = |n: f64| if n < 0.0 { levels.first() } else { levels.get(n as usize) };
                let last = levels.last().copied().unwrap_or(0.0);
                let (from, to) =
                    (level(number - 1.0).copied().unwrap_or(last), level(number).copied().unwrap_or(last));
                from + (to - from) * smooth((t - number * hold) / rise)
            }
            Self::Ramp(from, to, start, end) => from + (to - from) * smooth((t - start) / (end - start)),
        }
    }
}

/// One run.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Run {
    /// Commands in the order of the columns.
    pub(crate) courses: [Course; 6],
    /// Where the encoder is at the start \[rad\].
    pub(crate) angle: f64,
    /// Where the track is at the start \[m\].
    pub(crate) track: f64,
    /// When samples are taken, as logged \[s\].
    pub(crate) stamps: Vec<f64>,
    pub(crate) duration: f64,
}

impl Run {
    /// Commands at a time; before the start they are what they are at the start.
    pub(crate) fn commands(&self, t: f64) -> Commands {
        std::array::from_fn(|k| self.courses[k].at(t.max(0.0)))
    }

    /// The same run with every manieth sample alone.
    pub(crate) fn thinned(&self, every: usize) -> Self {
        Self { stamps: self.stamps.iter().copied().step_by(every).collect(), ..self.clone() }
    }
}

/// Stamps have this resolution \[s\].
const STAMP: f64 = 1e-5;

/// Draws a session; `jitter` is by how much sample times are off the even grid \[s\].
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // some thousand samples
pub(crate) fn draw(random: &mut Random, jitter: f64) -> Vec<Run> {
    (0..RUNS)
        .map(|number| {
            let duration = random.within(8.0, 11.0);
            let courses = courses(random, number, duration);
            let stamp = |k: usize, random: &mut Random| {
                let off = jitter * random.normal().clamp(-3.0, 3.0);
                (((k as f64 / RATE + off).max(0.0)) / STAMP).round() * STAMP
            };
            let stamps = (0..(duration * RATE) as usize).map(|k| stamp(k, random)).collect();
            let (angle, track) = (random.within(0.0, TAU), random.within(0.0, 100.0));
            Run { courses, angle, track, stamps, duration }
        })
        .collect()
}

/// Amplitudes of slip angle \[rad\], slip and camber \[rad\] at which the tire slides, or leans as far as rigs lean it.
const MOST: [f64; 3] = [0.13, 0.14, 0.07];

fn courses(random: &mut Random, number: usize, duration: f64) -> [Course; 6] {
    use Course::{Hold, Ramp, Sine, Steps, Sweep, Triangle};
    let [angle, slip, camber] = MOST.map(|most| most * random.within(0.85, 1.0) * random.sign());
    let speed = random.within(5.0, 12.0);
    // 2 to 5.5 kN
    let [light, middle, heavy] =
        [(0.013, 0.016), (0.019, 0.022), (0.0245, 0.028)].map(|(a, b)| random.within(a, b));
    let mut all: [Course; 6] = std::array::from_fn(|_| Hold(0.0));
    all[SPEED] = Hold(speed);
    all[DEFLECTION] = Hold(middle);
    let twice = duration / random.within(1.6, 2.2);
    let levels = |random: &mut Random, most: f64, hold: (f64, f64)| {
        let hold = random.within(hold.0, hold.1);
        let shares = (0..(duration / hold).ceil().max(1.0) as usize)
            .map(|k| if k == 0 { 0.0 } else { most * random.sign() * random.within(0.15, 1.0) });
        Steps(shares.collect(), hold, random.within(0.025, 0.045))
    };
    match number {
        // pressed down while it stands, from just above the road
        0 => {
            all[SPEED] = Hold(0.0);
            all[DEFLECTION] = Sine(0.5 * heavy, 0.5 * heavy + 1e-3, twice, -0.25 * TAU);
        }
        // lifted, faster and faster
        1 => {
            all[SPEED] = Ramp(0.2, random.within(18.0, 22.0), 0.0, 0.8 * duration);
            all[DEFLECTION] = Sine(-0.012, 2e-3, random.within(1.0, 2.0), 0.0);
            all[CAMBER] = Sine(0.0, 0.02, random.within(1.0, 2.0), 0.0);
        }
        2 => {
            all[DEFLECTION] = Hold(light);
            all[SLIP_ANGLE] = Triangle(0.0, angle, twice);
        }
        3 => {
            all[DEFLECTION] = Hold(heavy);
            all[SLIP_ANGLE] = Triangle(0.0, angle, twice);
        }
        4 => {
            all[DEFLECTION] = Hold(heavy);
            all[SLIP] = Triangle(0.0, slip, twice);
        }
        // braking and driving in steps, then in ever faster turns
        5 => {
            all[DEFLECTION] = Hold(light);
            all[SLIP] = levels(random, 0.7 * slip, (0.5, 0.8));
            all[SLIP_ANGLE] = Ramp(0.0, 0.2 * angle, 0.5 * duration, 0.6 * duration);
        }
        6 => all[CAMBER] = Triangle(0.0, camber, twice),
        7 => {
            all[SLIP_ANGLE] = levels(random, 0.5 * angle, (0.5, 0.8));
        }
        8 => {
            all[SPEED] = Sine(11.0, random.within(6.0, 8.0), duration, -0.25 * TAU);
            all[DEFLECTION] = Triangle(middle, random.within(5e-3, 7e-3), twice);
            all[SLIP_ANGLE] = Sweep(0.2 * angle, 0.2, random.within(2.0, 4.0), duration);
            all[SLIP] = Sine(0.0, 0.1 * slip, random.within(0.7, 1.5), 0.0);
        }
        // for checking: all of it again, together and elsewhere
        9 => {
            all[SPEED] = Hold(random.within(12.0, 17.0));
            all[DEFLECTION] = Hold(random.within(0.017, 0.026));
            all[SLIP_ANGLE] = Triangle(0.0, 0.9 * angle, twice);
            all[SLIP] = Triangle(0.0, 0.6 * slip, 0.45 * twice);
            all[CAMBER] = Ramp(0.0, 0.5 * camber, 0.5 * duration, 0.65 * duration);
        }
        10 => {
            all[SPEED] = Sine(11.0, random.within(5.0, 8.0), duration, -0.25 * TAU);
            all[DEFLECTION] = Triangle(middle, random.within(5e-3, 6e-3), 0.7 * twice);
            all[SLIP_ANGLE] = levels(random, 0.4 * angle, (0.4, 0.8));
            all[CAMBER] = Sine(0.0, 0.5 * camber, random.within(1.5, 3.0), 0.0);
        }
        _ => {
            all[DEFLECTION] = Hold(random.within(0.015, 0.026));
            all[SLIP] = levels(random, 0.8 * slip, (0.4, 0.8));
            all[SLIP_ANGLE] = Sweep(0.3 * angle, 0.1, random.within(1.5, 3.0), duration);
        }
    }
    all
}
