//! The tire on a rig: a run with what is concealed, as ideal sensors behind the filter see it.

use super::concealed::Concealed;
use super::parameters::{Parameters, Rig};
use super::programme::Run;
use super::rubber::Past;
use super::tire::{Cleat, Rim, Road, STATES, Surface, Tire, Told};
use crate::bessel::DELAY;
use crate::follow::Follower;
use crate::recorder::Recorder;
use crate::simulate::Ideal;

/// Step in recordings \[s\]: contacts of an element swing with up to 1.1 kHz.
pub(crate) const FINE: f64 = 5e-5;
/// The same where effects are sized.
pub(crate) const COARSE: f64 = 2.5e-4;

/// States behind those of the elements.
const HEIGHT: usize = STATES;
const CLIMB: usize = STATES + 1;
const ANGLE: usize = STATES + 2;
const SPIN: usize = STATES + 3;
const SLIP: usize = STATES + 4;
const PLACE: usize = STATES + 5;
const ALL: usize = STATES + 6;

/// Stiffness of the path between cylinder and wheel where it has play \[N/m\], and the share of critical damping.
const PATH: (f64, f64) = (1e8, 0.5);
/// Stiffness of the pivot's lining before it slips, at the wheel \[N/m\].
const LINING: f64 = 2e6;

/// A tire on a rig, with what is concealed.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct World {
    pub(crate) rig: Rig,
    pub(crate) p: Parameters,
    pub(crate) cleat: Cleat,
    pub(crate) concealed: Option<Concealed>,
}

/// Columns that are measured: name, unit.
pub(crate) fn outputs(rig: Rig) -> &'static [(&'static str, &'static str)] {
    match rig {
        Rig::Force => &[("piston_position", "m")],
        Rig::Position => &[("cell_force", "N")],
        // what passes of elements and edges is above any filter for accelerations and the force of the pivot
        Rig::Drum => &[("arm_displacement", "m"), ("wheel_angle", "rad")],
    }
}

/// The column that drives: name, unit, decimals.
pub(crate) fn input(rig: Rig) -> (&'static str, &'static str, i32) {
    match rig {
        Rig::Force => ("force", "N", -2),
        Rig::Position => ("position", "m", -8),
        Rig::Drum => ("drum_speed", "m/s", -5),
    }
}

/// Channels that have noise: all but the angle.
pub(crate) fn noisy(rig: Rig) -> usize {
    outputs(rig).iter().filter(|(name, _)| *name != "wheel_angle").count()
}

/// What is remembered from step to step.
#[derive(Debug, Clone, PartialEq)]
struct Memory {
    past: Vec<Past>,
    /// Where the lining of the pivot held the arm last, with which force.
    lining: (f64, f64),
    /// What the load cell's amplifier shows.
    cell: Follower,
}

/// Forces of an instant.
struct Now {
    /// Acceleration of the wheel's centre, upward.
    lift: f64,
    rim: Rim,
    surface: Surface,
    told: Told,
    /// Force in the load path.
    path: f64,
    spin_rate: f64,
    slip_rate: f64,
}

/// A run that goes on.
struct Going<'a> {
    world: &'a World,
    tire: Tire,
    run: &'a Run,
    start: f64,
}

impl World {
    /// All runs.
    pub(crate) fn session(&self, runs: &[Run], dt: f64) -> Vec<Ideal> {
        runs.iter().map(|run| self.run(run, dt)).collect()
    }

    pub(crate) fn tire(&self) -> Tire {
        let road = match self.rig {
            Rig::Drum => Road::Drum(0.5 * self.p.drum_diameter, self.cleat),
            _ => Road::Level,
        };
        let rubber = self.concealed.and_then(|c| c.rubber(self.p.element_radial_stiffness));
        let mut tire = Tire::new(self.p.clone(), road, rubber);
        if let Some(uneven) = self.concealed.and_then(|c| c.uneven()) {
            tire.uneven = uneven;
        }
        tire
    }

    fn run(&self, run: &Run, dt: f64) -> Ideal {
        let tire = self.tire();
        let u = run.command(0.0);
        let p = &self.p;
        let start = match self.rig {
            Rig::Force => tire.height(u + p.wheel_mass * p.gravity),
            Rig::Position => p.tire_radius - u,
            Rig::Drum => tire.height(self.resting() * p.gravity),
        };
        let (mut y, past) = tire.rest(start);
        y.resize(ALL, 0.0);
        y[HEIGHT] = start;
        let mut memory = Memory { past, lining: (start, 0.0), cell: Follower::default() };
        let going = Going { world: self, tire, run, start };
        let mut recorder = Recorder::new(&run.stamps, 1, outputs(self.rig).len());
        recorder.follow(0.0, &[u], &going.measure(0.0, &y, &mut memory, dt), dt);
        let steps = ((run.duration + 2.0 * DELAY) / dt).ceil();
        let mut n = 0.0;
        while n < steps {
            going.step(n * dt, &mut y, &mut memory, dt);
            n += 1.0;
            let t = n * dt;
            recorder.follow(t, &[run.command(t)], &going.measure(t, &y, &mut memory, dt), dt);
        }
        recorder.ideal
    }

    /// Mass that rests on the wheel, and that swings with it.
    fn resting(&self) -> f64 {
        let p = &self.p;
        p.wheel_mass + (p.arm_mass * p.arm_centre + p.weight_mass * p.weight_distance) / p.arm_length
    }

    fn moved(&self) -> f64 {
        let p = &self.p;
        let inertia = p.arm_inertia + p.weight_mass * p.weight_distance * p.weight_distance;
        p.wheel_mass + inertia / (p.arm_length * p.arm_length)
    }
}

impl Going<'_> {
    fn now(&self, t: f64, y: &[f64], memory: &Memory) -> Now {
        let World { rig, p, concealed, .. } = self.world;
        let u = self.run.command(t);
        let mut rim = Rim { height: y[HEIGHT], climb: y[CLIMB], angle: y[ANGLE], spin: y[SPIN] };
        let factor = concealed.map_or(1.0, |c| c.damping(u));
        let damping = p.element_radial_damping * if *rig == Rig::Drum { factor } else { 1.0 };
        let told = self.tire.force(y, rim.angle, damping, &memory.past);
        let mut now = Now {
            lift: 0.0,
            rim,
            surface: Surface::default(),
            told,
            path: 0.0,
            spin_rate: 0.0,
            slip_rate: 0.0,
        };
        let weight = p.wheel_mass * p.gravity;
        match rig {
            Rig::Force => {
                now.lift = (told.z - u - weight) / p.wheel_mass;
                now.path = u;
            }
            Rig::Position => {
                let (rate, rise) = self.run.rates(t);
                if let Some(gap) = concealed.and_then(|c| c.gap()) {
                    // shown is where the wheel is while it is pressed down
                    let over = y[HEIGHT] - (p.tire_radius - u);
                    let (k, share) = PATH;
                    let c = 2.0 * share * (k * p.wheel_mass).sqrt();
                    let rate = c * (y[CLIMB] + rate);
                    now.path = if over > 0.0 {
                        (k * over + rate).max(0.0)
                    } else if over < -2.0 * gap {
                        (k * (over + 2.0 * gap) + rate).min(0.0)
                    } else {
                        0.0
                    };
                    now.lift = (told.z - weight - now.path) / p.wheel_mass;
                } else {
                    (rim.height, rim.climb) = (p.tire_radius - u, -rate);
                    (now.rim, now.lift) = (rim, -rise);
                    now.path = told.z - weight - p.wheel_mass * now.lift;
                }
            }
            Rig::Drum => self.rolls(u, y, memory, &mut now),
        }
        now
    }

    fn rolls(&self, speed: f64, y: &[f64], memory: &Memory, now: &mut Now) {
        let World { p, concealed, .. } = self.world;
        now.surface = Surface { place: y[PLACE], speed };
        let told = now.told;
        let (slip, faster, radius) = self.tire.slip(&now.rim, &now.surface);
        let brush = self.tire.brush(y[SLIP], told.z);
        now.slip_rate = faster / p.relaxation_length * (slip - y[SLIP]);
        now.spin_rate = -radius * brush / (p.wheel_inertia + self.tire.inertia());
        // a standing wheel is not held back; at a walking pace it is
        let turns = libm::tanh(speed / 0.05);
        let along = brush - turns * p.rolling_resistance * told.z;
        let (_, [_, rises]) = self.tire.road.under(&now.surface);
        let held = concealed.and_then(|c| c.pivot()).map_or(0.0, |most| lining(most, y[HEIGHT], memory));
        now.lift = (told.z + along * rises - held) / self.world.moved()
            - self.world.resting() / self.world.moved() * p.gravity;
    }

    fn slope(&self, t: f64, y: &[f64], memory: &Memory, dy: &mut [f64]) {
        let now = self.now(t, y, memory);
        self.tire.rates(y, (&now.rim, now.lift), &now.surface, &now.told, dy);
        dy[HEIGHT] = now.rim.climb;
        dy[CLIMB] = now.lift;
        dy[ANGLE] = now.rim.spin;
        dy[SPIN] = now.spin_rate;
        dy[SLIP] = now.slip_rate;
        dy[PLACE] = now.surface.speed;
    }

    fn step(&self, t: f64, y: &mut [f64], memory: &mut Memory, dt: f64) {
        let mut k = [[0.0; ALL]; 4];
        let mut at = [0.0; ALL];
        at.copy_from_slice(y);
        for stage in 0..4 {
            let h = [0.0, 0.5 * dt, 0.5 * dt, dt][stage];
            if stage > 0 {
                for i in 0..ALL {
                    at[i] = y[i] + h * k[stage - 1][i];
                }
            }
            self.slope(t + h, &at, memory, &mut k[stage]);
        }
        for i in 0..ALL {
            y[i] += dt / 6.0 * (k[0][i] + 2.0 * (k[1][i] + k[2][i]) + k[3][i]);
        }
        self.tire.remember(&y[..STATES], &mut memory.past, dt);
        if let Some(most) = self.world.concealed.and_then(|c| c.pivot()) {
            memory.lining = (y[HEIGHT], lining(most, y[HEIGHT], memory));
        }
    }

    /// What the sensors see.
    fn measure(&self, t: f64, y: &[f64], memory: &mut Memory, dt: f64) -> Vec<f64> {
        let now = self.now(t, y, memory);
        let p = &self.world.p;
        match self.world.rig {
            Rig::Force => vec![p.tire_radius - y[HEIGHT]],
            Rig::Position => {
                let mut shown = now.path;
                if let Some(time) = self.world.concealed.and_then(|c| c.cell()) {
                    shown = memory.cell.follow(shown, dt / time);
                }
                vec![shown]
            }
            Rig::Drum => {
                let at = |distance: f64| distance / p.arm_length;
                vec![(y[HEIGHT] - self.start) * at(p.sensor_4_distance), y[ANGLE]]
            }
        }
    }
}

/// Force of the pivot's lining at the wheel, with which it holds the arm back.
fn lining(most: f64, height: f64, memory: &Memory) -> f64 {
    let (last, force) = memory.lining;
    (force + LINING * (height - last)).clamp(-most, most)
}
