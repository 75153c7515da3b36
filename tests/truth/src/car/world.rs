//! A run: the driver brakes, brakes and controller do their part, the car stops, and a recorder behind an anti-alias filter looks on.

use super::brake::Brake;
use super::controller::{Controller, SAMPLE};
use super::parameters::Parameters;
use super::programme::{Run, TIMES};
use super::road::{Road, Scatter, Slabs};
use super::vehicle::Vehicle;
use crate::bessel::delay;
use crate::random::Random;
use crate::recorder::Recorder;
use crate::simulate::Ideal;

/// Step \[s\]: the fastest mode of the suspension swings with some 280 Hz.
pub(crate) const STEP: f64 = 1e-4;
/// The recorder's filter takes every second step.
const EVERY: usize = 2;
/// Limit of the filter \[Hz\].
pub(crate) const LIMIT: f64 = 150.0;
/// A decision is taken as long before a whole sample \[s\]: so does the wired system with steps of 1 ms.
const AHEAD: f64 = 1e-3;
/// The recording goes on for so long behind standstill \[s\], and no run is longer than.
const AFTER: f64 = 0.3;
const LONGEST: f64 = 9.0;
/// A car that is slower stands \[m/s\].
const STANDS: f64 = 0.05;

/// Wheels as the models call them, and as the brakes do.
pub(crate) const WHEELS: [(&str, &str); 4] =
    [("front_left", "fl"), ("front_right", "fr"), ("rear_left", "rl"), ("rear_right", "rr")];

/// Columns that are measured, as the wired system calls them: name, unit, least noise.
pub(crate) fn outputs() -> Vec<(String, &'static str, f64)> {
    let mut all = vec![
        ("car.vehicle_speed".to_owned(), "m/s", 5e-3),
        ("car.longitudinal_acceleration".to_owned(), "m/s2", 0.02),
        ("car.yaw_rate".to_owned(), "rad/s", 1e-3),
    ];
    for (wheel, brake) in WHEELS {
        all.push((format!("car.{wheel}.wheel_speed"), "rad/s", 0.02));
        all.push((format!("car.{wheel}.carrier_moment_y"), "N.m", 1.0));
        all.push((format!("brake_{brake}.caliper_pressure"), "bar", 0.1));
    }
    for (wheel, _) in &WHEELS[..2] {
        for name in ["carrier_force_x", "carrier_force_y", "carrier_force_z"] {
            all.push((format!("car.{wheel}.{name}"), "N", 5.0));
        }
        for name in ["longitudinal_link_force", "transverse_link_force", "tie_rod_force", "strut_force"] {
            all.push((format!("car.{wheel}.{name}"), "N", 5.0));
        }
    }
    all
}

/// Pressure of a bar \[Pa\].
pub(crate) const BAR: f64 = 1e5;

/// The car as it truly is.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct World {
    pub(crate) p: Parameters,
    /// Friction that scatters along the road: deviation, correlation length \[m\].
    pub(crate) scatter: (f64, f64),
    /// Both tracks have the same.
    pub(crate) alike: bool,
    /// Friction of the road of one kind of runs, over that of the others.
    pub(crate) other_road: Option<(&'static str, f64)>,
}

impl World {
    /// The road of a run.
    pub(crate) fn road(&self, run: &Run) -> Road {
        let level = self.other_road.filter(|(kind, _)| *kind == run.kind).map_or(1.0, |(_, level)| level);
        let track = |side: u64| {
            if self.scatter.0 > 0.0 {
                Scatter::draw(
                    &mut Random::new(run.seed, if self.alike { 0 } else { side }),
                    level,
                    self.scatter,
                )
            } else {
                Scatter::none(level)
            }
        };
        let slabs = run.slabs.map(|start| Slabs {
            start,
            length: super::programme::SLAB,
            drop: super::programme::DROP,
        });
        Road { slabs, friction: [track(0), track(1)] }
    }

    /// What noise-free sensors record of a run: the driver's pressure \[bar\], and all [`outputs`]; none if the car cannot start.
    pub(crate) fn run(&self, run: &Run, dt: f64) -> Option<Ideal> {
        let road = self.road(run);
        let first = road.friction.each_ref().map(|track| track.at(0.0));
        let mut car = Vehicle::rolls(&self.p, run.speed, first)?;
        let [front, rear] = self.p.rolling_radius;
        let mut controller = Controller::new([front, front, rear, rear], car.spins());
        let mut brakes = [Brake::default(); 4];
        let pads = |k: usize| &self.p.brakes[k / 2];
        let stamps: Vec<f64> = TIMES.collect();
        let count = outputs().len();
        let mut recorder = Recorder::limited(&stamps, (1, count), LIMIT);
        let (mut n, mut stood) = (0_usize, None);
        // in steps, which are counted exactly
        let steps = |time: f64| (time / dt).round() as usize;
        let (sample, ahead, last) = (steps(SAMPLE), steps(SAMPLE - AHEAD), steps(LONGEST));
        let mut torques = [0.0; 4];
        let every = EVERY * steps(STEP).max(1);
        loop {
            let t = n as f64 * dt;
            if n.is_multiple_of(every) {
                let told = car.told(&road, torques);
                let spins = car.spins();
                let mut y = vec![told.speed, told.acceleration, told.yaw_rate];
                for k in 0..4 {
                    y.extend([spins[k], told.wheels[k].carrier_moment.y(), brakes[k].caliper / BAR]);
                }
                for wheel in &told.wheels[..2] {
                    y.extend(wheel.carrier_force.0);
                    y.extend(&wheel.links[..3]);
                    y.push(wheel.strut);
                }
                let shown = self.p.master_gain * run.pressure(t) / BAR;
                recorder.follow(t, &[shown], &y, dt * every as f64);
                if told.speed < STANDS && stood.is_none() {
                    stood = Some(n);
                }
            }
            let end = stood.map_or(last, |s| s + steps(AFTER + 2.0 * delay(LIMIT)));
            if n >= end.min(last) {
                return Some(recorder.ideal);
            }
            if n % sample == ahead {
                controller.sample(car.spins(), run.pressure(t));
            }
            let (valves, driver) = (controller.valves(), run.pressure(t + 0.5 * dt));
            for k in 0..4 {
                brakes[k].follow(pads(k), driver, valves[k], dt);
                torques[k] = brakes[k].torque(pads(k));
            }
            car.step(&road, torques, dt);
            n += 1;
        }
    }
}
