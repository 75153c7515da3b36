//! The ring-and-brush tire that latsch ships, on its flat-track rig: the one machine here whose base equations are not
//! written again, because they are thousands of lines.
//!
//! Only the tire is latsch's. What is concealed ([`crate::hidden`]), the step in which it meets the tire, the filter of the
//! sensors and the noise are those of all other machines. An effect reaches the tire through what the rig commands (a
//! slip angle that lags or is off) and through the friction of the track, which the rig can set from step to step; or it
//! sits between the tire and the sensors.

mod offers;
mod programme;
pub mod rig;

pub use offers::{Concealed, draw_cases};
pub(crate) use offers::{OFFERS, OUTSIDE};
pub(crate) use programme::waves;

use crate::base::{Base, Ports, Row};
use crate::hidden::{Influence, Memory};
use crate::programme::Run;
use crate::simulate::{Filter, Ideal, World};
use latsch::Result;
use latsch::model::{Native, Settings, Slave};
use latsch::rig::RingBrushFlatTrack;

/// What the model is called.
pub const NAME: &str = "ring-brush-flat-track";

/// Commands of the rig.
pub(crate) const INPUTS: [Row; 5] = [
    ("path_speed", "m/s", 10.0),
    ("deflection", "m", 0.02),
    ("slip_angle", "rad", 0.0),
    ("slip", "1", 0.0),
    ("camber", "rad", 0.0),
];

/// What the load cell measures.
pub(crate) const OUTPUTS: [Row; 5] = [
    ("force_x", "N", 1200.0),
    ("force_y", "N", 1500.0),
    ("force_z", "N", 1000.0),
    ("moment_x", "N.m", 500.0),
    ("moment_z", "N.m", 25.0),
];

/// Parameters that can be wrong: those on which the forces depend most.
pub(crate) const PARAMETERS: [Row; 6] = [
    ("vertical_stiffness", "N/m", 154e3),
    ("sidewall_lateral_stiffness", "N/m", 85e3),
    ("bristle_stiffness", "N/m", 4e4),
    ("friction_static_zero", "1", 1.5),
    ("friction_sliding_zero", "1", 1.1),
    ("stripe_length_factor", "1", 0.75),
];

/// Least noise over the spread of a channel. The usual step of the model errs by a fifth of this at most; of the moment about
/// the vertical by as much as this in some runs, and by 2.5 times this in one of ten that were looked at.
pub(crate) const LEAST_NOISE: f64 = 0.015;

/// Own step of the tire in recordings \[s\]; the model's usual one is longer.
const FINE: f64 = 8e-5;
/// The same where effects are sized.
const COARSE: f64 = 4e-4;

/// One run, with what is hidden, in steps of at most `longest` seconds. Everything is not-a-number where the tire
/// leaves what its equations are good for.
#[must_use]
pub fn run(world: &World, run: &Run, number: u64, longest: f64) -> Ideal {
    simulate(world, run, number, longest).unwrap_or_else(|_| Ideal {
        inputs: vec![vec![f64::NAN; run.time.len()]; INPUTS.len()],
        outputs: vec![vec![f64::NAN; run.time.len()]; OUTPUTS.len()],
    })
}

/// The tire with the places of its variables.
struct Tire {
    slave: Native<RingBrushFlatTrack>,
    inputs: Vec<usize>,
    outputs: Vec<usize>,
    friction: usize,
    power: usize,
    angle: usize,
    spin: usize,
}

impl Tire {
    fn new<'a>(parameters: impl IntoIterator<Item = (&'a str, f64)>, step: f64) -> Result<Self> {
        let mut slave = Native::new(&Settings::default())?;
        for (name, value) in parameters {
            let variable = slave.find(name)?;
            slave.set(variable, value)?;
        }
        let variable = slave.find("step_size")?;
        slave.set(variable, step)?;
        // the courses of the inputs are the rig's motion
        let variable = slave.find("command_actuators")?;
        slave.set(variable, 0.0)?;
        let find = |rows: &[Row]| rows.iter().map(|row| slave.find(row.0)).collect::<Result<Vec<_>>>();
        Ok(Self {
            inputs: find(&INPUTS)?,
            outputs: find(&OUTPUTS)?,
            friction: slave.find("friction_factor")?,
            // the whole loss of the contact heats it, where the tire tells that
            power: slave.find("contact_power_loss")?,
            angle: slave.find("wheel_angle")?,
            spin: slave.find("wheel_speed")?,
            slave,
        })
    }

    fn start(&mut self, commands: &[f64], friction: f64) -> Result<()> {
        for (variable, value) in self.inputs.iter().zip(commands) {
            self.slave.set(*variable, *value)?;
        }
        self.slave.set(self.friction, friction)?;
        self.slave.start(0.0, None)?;
        self.slave.finish_start()
    }

    /// Steps on with commands that run straight and a friction that is held.
    fn step(&mut self, (from, to): (&[f64], &[f64]), friction: f64, time: f64, dt: f64) -> Result<()> {
        for ((variable, from), to) in self.inputs.iter().zip(from).zip(to) {
            self.slave.set(*variable, *from)?;
            self.slave.set_rate(*variable, (to - from) / dt)?;
        }
        self.slave.set(self.friction, friction)?;
        self.slave.step(time, dt)
    }

    fn measured(&mut self) -> Result<Vec<f64>> {
        self.outputs.iter().map(|variable| self.slave.get(*variable)).collect()
    }

    /// What effects see, with the inputs `u` as commanded.
    fn ports(&mut self, u: &[f64], time: f64, distance: f64) -> Result<Ports> {
        Ok(Ports {
            time,
            distance,
            speed: u[0],
            load: self.slave.get(self.outputs[2])?.max(0.0),
            angle: self.slave.get(self.angle)?,
            spin: self.slave.get(self.spin)?,
            sliding: u[0].abs() * libm::hypot(u[3], libm::tan(u[2])),
            slide_power: self.slave.get(self.power)?,
            slip: u[3],
            slip_angle: u[2],
            camber: u[4],
            ..Ports::default()
        })
    }
}

/// What of the hidden effects runs beside the tire: their states, in the order of the effects, and memories.
struct Beside {
    states: Vec<Vec<f64>>,
    way_in: Vec<Memory>,
    way_out: Vec<Memory>,
}

impl Beside {
    fn start(world: &World, at: &Ports, number: u64) -> Self {
        let (states, way_in) = world.hidden.iter().map(|h| h.start(Base::FlatTrack, at, number)).unzip();
        Self { states, way_in, way_out: vec![Memory::default(); world.hidden.len()] }
    }

    fn influence(&self, world: &World, at: &Ports) -> Influence {
        let mut by = Influence::default();
        for ((hidden, z), memory) in world.hidden.iter().zip(&self.states).zip(&self.way_in) {
            hidden.influence(Base::FlatTrack, at, z, memory, &mut by);
        }
        by
    }

    /// Heun's rule from what effects saw to what they see.
    fn advance(&mut self, world: &World, (from, to): (&Ports, &Ports), dt: f64) {
        for (hidden, z) in world.hidden.iter().zip(&mut self.states) {
            let (mut first, mut second) = (vec![0.0; z.len()], vec![0.0; z.len()]);
            hidden.slope(Base::FlatTrack, from, z, &mut first);
            let ahead: Vec<f64> = z.iter().zip(&first).map(|(z, d)| z + dt * d).collect();
            hidden.slope(Base::FlatTrack, to, &ahead, &mut second);
            for (z, (a, b)) in z.iter_mut().zip(first.iter().zip(&second)) {
                *z += 0.5 * dt * (a + b);
            }
        }
    }

    fn leave(&mut self, world: &World, at: &Ports, y: &mut [f64], dt: f64) {
        let sizes = OUTPUTS.map(|row| row.2);
        for (hidden, memory) in world.hidden.iter().zip(&mut self.way_out) {
            hidden.leave(memory, at, &sizes, y, dt);
        }
    }
}

/// The commands that the tire follows, from those of the rig.
fn commanded(u: &[f64], by: &Influence) -> Vec<f64> {
    let mut u = u.to_vec();
    u[2] += by.slip_angle;
    u
}

fn simulate(world: &World, run: &Run, number: u64, longest: f64) -> Result<Ideal> {
    let own = if longest < COARSE { FINE } else { COARSE };
    let names = PARAMETERS.iter().map(|row| row.0);
    let mut tire = Tire::new(names.zip(world.parameters.iter().copied()), own)?;
    let raw = |k: usize| -> Vec<f64> { run.inputs.iter().map(|values| values[k]).collect() };
    let still = Ports { speed: raw(0)[0], slip_angle: raw(0)[2], ..Ports::default() };
    let mut beside = Beside::start(world, &still, number);
    let mut u = raw(0);
    world.enter(&mut beside.way_in, &still, &mut u, 1e-9);
    let by = beside.influence(world, &still);
    let mut from = commanded(&u, &by);
    tire.start(&from, by.friction)?;

    let (mut time, mut distance) = (run.time[0], 0.0);
    let mut at = tire.ports(&u, time, distance)?;
    let mut y = tire.measured()?;
    beside.leave(world, &at, &mut y, 1e-9);
    let (mut inputs, mut outputs) = (Filter::new(world.filter, &raw(0)), Filter::new(world.filter, &y));
    let mut ideal = Ideal::begin(&raw(0), &y);
    for k in 1..run.time.len() {
        let (start, end) = (raw(k - 1), raw(k));
        let span = run.time[k] - run.time[k - 1];
        let count = (span / longest).ceil().max(1.0);
        let dt = span / count;
        let mut part = 0.0;
        while part < count - 0.5 {
            part += 1.0;
            let pure: Vec<f64> = start.iter().zip(&end).map(|(a, b)| a + (b - a) * (part / count)).collect();
            let mut u = pure.clone();
            world.enter(&mut beside.way_in, &at, &mut u, dt);
            let by = beside.influence(world, &at);
            let to = commanded(&u, &by);
            tire.step((&from, &to), by.friction, time, dt)?;
            from = to;
            time += dt;
            distance += 0.5 * (at.speed + pure[0]) * dt;
            let now = tire.ports(&pure, time, distance)?;
            beside.advance(world, (&at, &now), dt);
            at = now;
            y = tire.measured()?;
            beside.leave(world, &at, &mut y, dt);
            inputs.follow(&pure, dt);
            outputs.follow(&y, dt);
        }
        ideal.record(&inputs.state, &outputs.state);
    }
    Ok(ideal)
}

#[cfg(test)]
mod tests;
