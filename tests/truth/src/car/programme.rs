//! What the driver does: stops with controller, faster ones, gentle ones without, and stops on slabs.

use super::parameters::{GRAVITY, Parameters};
use super::world::BAR;
use crate::random::Random;

/// Time between samples of the recorder \[s\].
pub(crate) const INTERVAL: f64 = 2e-3;

/// Times of samples \[s\], longer than any run.
pub(crate) const TIMES: Times = Times(0);

/// Counts up in intervals.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Times(u32);

impl Iterator for Times {
    type Item = f64;

    fn next(&mut self) -> Option<f64> {
        let time = f64::from(self.0) / 500.0;
        self.0 += 1;
        (time < 10.0).then_some(time)
    }
}

/// Length of a slab \[m\], and its drop.
pub(crate) const SLAB: f64 = 15.0;
pub(crate) const DROP: f64 = 0.05;
/// The first drop is as far behind the place where the driver begins to brake \[m\].
const BEFORE_DROP: f64 = 1.1;
/// Where the slabs begin scatters by \[m\], and nobody knows.
const PLACES: f64 = 0.04;
/// The driver begins to brake at \[s\]; later on slabs, since the car has to start on level road before the first of them.
pub(crate) const ONSET: f64 = 0.5;
const SLABS_ONSET: f64 = 0.7;
/// Pressure of a full stop \[bar\], and the time in which it rises \[s\].
pub(crate) const FULL: f64 = 150.0;
pub(crate) const RISE: f64 = 0.15;
/// Deceleration of gentle stops over what the road bears.
const GENTLE: f64 = 0.5;

/// Kinds of runs: name of the file, speed \[km/h\], how many, whether they are for fitting.
pub(crate) const KINDS: [(&str, f64, usize, bool); 4] = [
    ("flat", 80.0, 3, true),
    ("fast", 100.0, 2, false),
    ("partial", 80.0, 3, true),
    ("slabs", 80.0, 3, false),
];

/// One run.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Run {
    /// Name of its kind, and its number among them.
    pub(crate) kind: &'static str,
    pub(crate) number: usize,
    /// Speed at the start \[m/s\].
    pub(crate) speed: f64,
    /// Where slabs begin \[m\].
    pub(crate) slabs: Option<f64>,
    pub(crate) onset: f64,
    /// Pressure that is reached \[Pa\], and in which time \[s\].
    level: f64,
    rise: f64,
    /// Of the friction along the road.
    pub(crate) seed: u64,
}

/// Where slabs begin, as the recording has it \[m\].
pub(crate) fn slabs_start() -> f64 {
    let start = 80.0 / 3.6 * SLABS_ONSET + BEFORE_DROP - SLAB;
    (100.0 * start).round() / 100.0
}

/// Pressure at which the car slows down by a share of what the road bears \[Pa\].
fn gentle(p: &Parameters) -> f64 {
    let per_pressure: f64 =
        p.brakes.iter().map(|b| 2.0 * b.friction * b.piston_area * b.friction_radius).sum();
    let bears = GRAVITY * p.road_friction * p.tire.friction[0];
    GENTLE * bears * p.vehicle_mass * 0.33 / per_pressure
}

/// All runs of a car that is believed to be like this.
pub(crate) fn draw(random: &mut Random, believed: &Parameters) -> Vec<Run> {
    let mut runs = Vec::new();
    for (kind, speed, count, _) in KINDS {
        for number in 1..=count {
            let (level, rise) =
                if kind == "partial" { (gentle(believed), 2.0 * RISE) } else { (FULL * BAR, RISE) };
            let on_slabs = kind == "slabs";
            runs.push(Run {
                kind,
                number,
                speed: speed / 3.6,
                slabs: on_slabs.then(|| slabs_start() + PLACES * random.normal().clamp(-2.0, 2.0)),
                onset: if on_slabs { SLABS_ONSET } else { ONSET },
                level: level * (1.0 + random.within(-0.015, 0.015)),
                rise: rise * (1.0 + random.within(-0.05, 0.05)),
                seed: random.bits(),
            });
        }
    }
    runs
}

impl Run {
    /// Name of its recording.
    pub(crate) fn file(&self) -> String {
        format!("{}-{}.csv", self.kind, self.number)
    }

    /// Pressure in the master cylinder \[Pa\].
    pub(crate) fn pressure(&self, t: f64) -> f64 {
        self.level * ((t - self.onset) / self.rise).clamp(0.0, 1.0)
    }
}
