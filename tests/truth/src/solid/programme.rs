//! What the rigs do: runs of forces and positions of the cylinder, and of speeds of the drum. The last ones are for checking.

use super::parameters::Rig;
use super::tire::Cleat;
use crate::random::Random;
use std::f64::consts::TAU;

/// A course between -1 and 1.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Wave {
    /// Frequency \[Hz\].
    Sine(f64),
    /// From one frequency to another \[Hz\] over the run.
    Sweep(f64, f64),
    /// Lines: share, frequency \[Hz\], phase.
    Band(Vec<[f64; 3]>),
}

/// The course of a command.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Course {
    /// About a middle, by an amplitude, faded in.
    Wave(f64, f64, Wave),
    /// From rest on: at each time \[s\] the drum begins to go to a speed \[m/s\], within so many seconds.
    Speeds(Vec<[f64; 3]>),
}

/// From 0 to 1 without corners while x goes from 0 to 1.
fn smooth(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * x * (10.0 - 15.0 * x + 6.0 * x * x)
}

/// So long a rig takes to its full amplitude \[s\].
const FADE: f64 = 0.8;

impl Wave {
    fn at(&self, t: f64, duration: f64) -> f64 {
        match self {
            Self::Sine(f) => libm::sin(TAU * f * t),
            Self::Sweep(from, to) => libm::sin(TAU * t * (from + 0.5 * (to - from) * t / duration)),
            Self::Band(lines) => lines.iter().map(|[a, f, phase]| a * libm::sin(TAU * f * t + phase)).sum(),
        }
    }
}

/// One run.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Run {
    pub(crate) course: Course,
    /// When samples are taken, as logged \[s\].
    pub(crate) stamps: Vec<f64>,
    pub(crate) duration: f64,
}

impl Run {
    /// The command at a time; before the start it is what it is at the start.
    pub(crate) fn command(&self, t: f64) -> f64 {
        let t = t.max(0.0);
        match &self.course {
            Course::Wave(middle, amplitude, wave) => {
                middle + amplitude * smooth(t / FADE) * wave.at(t, self.duration)
            }
            Course::Speeds(list) => {
                let mut speed = 0.0;
                for [start, to, within] in list {
                    speed += (to - speed) * smooth((t - start) / within);
                }
                speed
            }
        }
    }

    /// Its first and second derivative.
    pub(crate) fn rates(&self, t: f64) -> (f64, f64) {
        const H: f64 = 2e-4;
        let [a, b, c] = [t - H, t, t + H].map(|t| self.command(t));
        ((c - a) / (2.0 * H), (a - 2.0 * b + c) / (H * H))
    }

    /// The same run with every manieth sample alone.
    pub(crate) fn thinned(&self, every: usize) -> Self {
        Self { stamps: self.stamps.iter().copied().step_by(every).collect(), ..self.clone() }
    }
}

/// Samples per second; the filter of all channels, with a limit of 60 Hz, is that of the sessions.
pub(crate) const RATE: f64 = 200.0;

impl Rig {
    /// Runs, and how many of them are for checking.
    pub(crate) fn runs(self) -> (usize, usize) {
        if self == Self::Drum { (6, 2) } else { (8, 2) }
    }
}

/// Stamps have this resolution \[s\].
const STAMP: f64 = 1e-5;

/// Draws the runs of a case, half of them in the air for half of the time if the wheel is `hung`; `jitter` is by how much sample times are off the even grid \[s\].
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // some thousand samples
pub(crate) fn draw(random: &mut Random, rig: Rig, jitter: f64, hung: bool) -> Vec<Run> {
    (0..rig.runs().0)
        .map(|number| {
            let duration = if rig == Rig::Drum { random.within(5.5, 6.5) } else { random.within(4.0, 5.0) };
            let mut course = course(random, rig, number, duration);
            if let (true, Course::Wave(middle, amplitude, _)) = (hung && number % 2 == 1, &mut course) {
                (*middle, *amplitude) = (0.0, amplitude.max(6e-3));
            }
            let mut stamp = |k: usize| {
                let off = jitter * random.normal().clamp(-3.0, 3.0);
                (((k as f64 / RATE + off).max(0.0)) / STAMP).round() * STAMP
            };
            let stamps = (0..(duration * RATE) as usize).map(&mut stamp).collect();
            Run { course, stamps, duration }
        })
        .collect()
}

/// The cleat of a case: 5 to 8 mm, as the source has it between 5 and 10.
pub(crate) fn cleat(random: &mut Random, start: f64) -> Cleat {
    let tenth = |v: f64| (v * 1e4).round() * 1e-4;
    Cleat {
        start,
        ramp: tenth(random.within(0.04, 0.06)),
        top: tenth(random.within(0.08, 0.15)),
        height: tenth(random.within(0.005, 0.008)),
    }
}

fn course(random: &mut Random, rig: Rig, number: usize, duration: f64) -> Course {
    if rig == Rig::Drum { drum(random, number, duration) } else { cylinder(random, rig, number) }
}

/// Sines of small and large amplitude, slow and fast, under low and high load; a sweep, a band. With position
/// control the wheel is lifted off the road in two of them.
fn cylinder(random: &mut Random, rig: Rig, number: usize) -> Course {
    let mut between = |low: f64, high: f64| random.within(low, high);
    // load and amplitude \[N\], \[m\]: the tire carries 10 kN at 16 mm
    let force = rig == Rig::Force;
    let pick = |f: f64, x: f64| if force { f } else { x };
    let (low, middle, high) = (
        pick(between(4500.0, 5500.0), between(9.5e-3, 11e-3)),
        pick(between(7000.0, 8500.0), between(12.5e-3, 14.5e-3)),
        pick(between(10e3, 12e3), between(16.5e-3, 18.5e-3)),
    );
    let (small, medium, large) = (
        pick(between(350.0, 600.0), between(4e-4, 8e-4)),
        pick(between(1500.0, 2500.0), between(2e-3, 3e-3)),
        pick(between(4500.0, 6000.0), between(6e-3, 7.5e-3)),
    );
    let (slow, fast) = (between(0.5, 0.8), between(3.0, 5.0));
    let one = between(0.9, 1.4);
    match number {
        0 => Course::Wave(high, 0.85 * large, Wave::Sine(one)),
        1 => lift(rig, middle, Wave::Sine(slow), 1.2 * medium),
        2 => Course::Wave(middle, medium, Wave::Sine(fast)),
        3 => Course::Wave(middle, small, Wave::Sine(2.0 * one)),
        4 => Course::Wave(high, small, Wave::Sweep(0.4, 9.0)),
        5 => Course::Wave(middle, 0.8 * large, Wave::Sine(slow)),
        6 => Course::Wave(middle, large, Wave::Band(lines(random))),
        _ => lift(rig, low, Wave::Sine(between(0.8, 1.2)), 0.7 * medium),
    }
}

/// With position control the wheel leaves the road by some millimetres.
fn lift(rig: Rig, middle: f64, wave: Wave, amplitude: f64) -> Course {
    if rig == Rig::Force {
        Course::Wave(middle, amplitude, wave)
    } else {
        Course::Wave(2.5e-3, 4.5e-3 + amplitude, wave)
    }
}

/// Lines between 0.3 and 6 Hz whose sum hardly leaves -1 to 1.
fn lines(random: &mut Random) -> Vec<[f64; 3]> {
    (0..8).map(|_| [random.within(0.1, 0.2), random.log_within(0.3, 6.0), random.within(0.0, TAU)]).collect()
}

/// Speeds that are held for a turn or some, slow and fast; down, up, and ever faster.
fn drum(random: &mut Random, number: usize, duration: f64) -> Course {
    let mut to = |start: f64, low: f64, high: f64, within: f64| [start, random.within(low, high), within];
    let half = 0.5 * duration;
    Course::Speeds(match number {
        0 => vec![to(0.2, 1.9, 2.2, 1.0)],
        1 => vec![to(0.2, 2.6, 3.0, 1.2), to(half, 1.3, 1.7, 1.5)],
        2 => vec![to(0.2, 3.6, 4.2, 1.5)],
        3 => vec![to(0.2, 4.6, 5.4, 1.8)],
        4 => vec![to(0.2, 2.3, 2.7, 1.2), to(half, 3.3, 3.9, 1.2)],
        _ => vec![to(0.2, 5.0, 6.0, duration)],
    })
}
