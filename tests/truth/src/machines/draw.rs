//! Draws a machine: what it is made of, how large, what is measured and how it is named.
//!
//! All sizes come from three scales (time, length, mass), each over decades, times numbers near one: machines of
//! micrometres and of tonnes are the same to a diagnosis that knows no sizes.

use super::mechanism::{Element, Machine, Parameter, Sensor, Variable};
use crate::random::Random;

/// What a machine is driven by: how large each input is where it is at work, and around what it moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Amplitude.
    pub amplitude: f64,
    /// What it moves around; stores need something that flows.
    pub middle: f64,
    /// Whether it is at work in every run.
    pub always: bool,
}

/// The three scales \[s\], \[m or rad\], \[kg or kg m2\].
struct Scales {
    time: f64,
    length: f64,
    mass: f64,
}

struct Builder<'a> {
    random: &'a mut Random,
    machine: Machine,
    drives: Vec<Drive>,
    rotary: bool,
    scales: Scales,
    style: usize,
}

/// A machine and what its inputs do.
#[must_use]
pub fn draw(random: &mut Random) -> (Machine, Vec<Drive>) {
    let style = random.below(3);
    let time = random.log_within(2e-3, 2.0);
    let rotary = random.chance(0.4);
    let length = if rotary { random.log_within(0.02, 1.0) } else { random.log_within(1e-6, 0.5) };
    let mass = if rotary { random.log_within(1e-5, 50.0) } else { random.log_within(1e-3, 3e3) };
    let scales = Scales { time, length, mass };
    let machine = Machine { time, ..Machine::default() };
    let mut builder = Builder { random, machine, drives: Vec::new(), rotary, scales, style };
    match builder.random.below(8) {
        0 | 1 => builder.stores(),
        2 | 3 => builder.driveline(),
        _ => builder.chain(),
    }
    let Builder { machine, drives, .. } = builder;
    (machine, drives)
}

const BODIES: [&str; 8] = ["carriage", "table", "slider", "arm", "platform", "piston", "frame", "rotor"];
const STORES: [&str; 5] = ["tank", "vessel", "chamber", "block", "housing"];

impl Builder<'_> {
    fn parameter(&mut self, name: String, unit: &'static str, value: f64) -> usize {
        self.machine.parameters.push(Parameter { name, unit, value, start: value });
        self.machine.parameters.len() - 1
    }

    fn near(&mut self, low: f64, high: f64) -> f64 {
        self.random.log_within(low, high)
    }

    fn input(&mut self, name: &str, unit: &'static str, drive: Drive) -> usize {
        self.machine.inputs.push(Variable { name: name.into(), unit });
        self.drives.push(drive);
        self.machine.inputs.len() - 1
    }

    fn output(&mut self, name: String, unit: &'static str, sensor: Sensor) {
        if self.machine.outputs.iter().all(|(_, s)| *s != sensor) {
            self.machine.outputs.push((Variable { name, unit }, sensor));
        }
    }

    fn stiffness(&self) -> f64 {
        self.scales.mass / (self.scales.time * self.scales.time)
    }

    fn force(&self) -> f64 {
        self.stiffness() * self.scales.length
    }

    fn units(&self) -> [&'static str; 6] {
        if self.rotary {
            ["rad", "rad/s", "rad/s2", "N.m", "kg.m2", "N.m/rad"]
        } else {
            ["m", "m/s", "m/s2", "N", "kg", "N/m"]
        }
    }

    fn damping_unit(&self) -> &'static str {
        if self.rotary { "N.m.s/rad" } else { "N.s/m" }
    }

    fn named(&self, body: usize, what: &str, short: &str) -> String {
        let name = BODIES[(body + self.style * 3) % BODIES.len()];
        match self.style {
            0 => format!("{short}{}", body + 1),
            1 => format!("{name}_{what}"),
            _ => format!("{what}_{name}"),
        }
    }

    fn bodies(&mut self, count: usize) {
        let [.., unit, _] = self.units();
        for b in 0..count {
            let value = self.scales.mass * self.near(0.4, 2.5);
            let name = if self.rotary { self.named(b, "inertia", "J") } else { self.named(b, "mass", "m") };
            let parameter = self.parameter(name, unit, value);
            self.machine.bodies.push(parameter);
        }
    }

    fn link(&mut self, from: usize, to: Option<usize>) {
        let number = self.machine.elements.len();
        let [.., unit] = self.units();
        let (k, m, t) = (self.stiffness(), self.scales.mass, self.scales.time);
        let value = k * self.near(0.5, 2.0);
        let stiffness = self.parameter(format!("k{number}"), unit, value);
        self.machine.elements.push(Element::Spring { from, to, stiffness });
        let value = m / t * self.near(0.08, 0.5);
        let name = format!("c{number}");
        let unit = self.damping_unit();
        let damping = self.parameter(name, unit, value);
        self.machine.elements.push(Element::Damper { from, to, damping });
    }

    /// Masses on springs, pushed, shaken or moved by a cylinder.
    fn chain(&mut self) {
        let count = 1 + self.random.below(4);
        self.bodies(count);
        let shaken = self.random.chance(0.3);
        for b in 0..count {
            if b > 0 {
                self.link(b - 1, Some(b));
            }
            // what nothing holds runs away; a shaken one is held by what shakes it
            if (b == 0 && !shaken) || (b > 0 && self.random.chance(0.25)) {
                self.link(b, None);
            }
        }
        let [position, _, _, force, _, stiffness] = self.units();
        if shaken {
            let amplitude = self.scales.length * self.near(0.5, 2.0);
            let input = self.input("base", position, Drive { amplitude, middle: 0.0, always: true });
            let value = self.stiffness() * self.near(0.5, 2.0);
            let k = self.parameter("base_stiffness".into(), stiffness, value);
            self.machine.elements.push(Element::Shaken { body: 0, input, stiffness: k });
            let value = self.scales.mass / self.scales.time * self.near(0.1, 0.4);
            let unit = self.damping_unit();
            let damping = self.parameter("drag".into(), unit, value);
            self.machine.elements.push(Element::Damper { from: 0, to: None, damping });
        } else if self.random.chance(0.3) {
            let top = self.random.log_within(1e4, 2e7);
            let amplitude = top * self.near(0.5, 1.0);
            let input = self.input("supply", "Pa", Drive { amplitude, middle: 0.0, always: true });
            let value = self.scales.time * self.near(0.05, 0.4);
            let time = self.parameter("filling_time".into(), "s", value);
            let value = self.force() / top * self.near(0.7, 1.5);
            let area = self.parameter("area".into(), if self.rotary { "m3" } else { "m2" }, value);
            self.machine.others = 1;
            self.machine.elements.push(Element::Cylinder { body: 0, pressure: 0, input, time, area });
            let pressure = self.machine.other(0);
            if self.random.chance(0.7) {
                self.output("pressure".into(), "Pa", Sensor::State(pressure));
            }
        } else {
            let body = self.random.below(count);
            let amplitude = self.force() * self.near(0.5, 1.5);
            let name = if self.style == 1 { "drive" } else { "F" };
            let input = self.input(name, force, Drive { amplitude, middle: 0.0, always: true });
            self.machine.elements.push(Element::Push { body, input });
        }
        self.disturbance(0.6);
        if self.random.chance(0.3) {
            let body = self.random.below(count);
            let value = self.stiffness() / (self.scales.length * self.scales.length) * self.near(0.05, 0.4);
            let unit = if self.rotary { "N.m/rad3" } else { "N/m3" };
            let k = self.parameter("hardening".into(), unit, value);
            self.machine.elements.push(Element::Cubic { from: body, to: None, stiffness: k });
        }
        if self.rotary && self.random.chance(0.4) {
            let value = self.stiffness() * self.near(0.3, 1.5);
            let moment = self.parameter("gravity_moment".into(), "N.m", value);
            self.machine.elements.push(Element::Gravity { body: count - 1, moment });
        }
        self.sensors(count);
    }

    /// A motor, perhaps a soft shaft, and a load.
    fn driveline(&mut self) {
        self.rotary = true;
        // it turns on: tens of radians
        self.scales.length = self.random.log_within(1.0, 30.0);
        self.scales.mass = self.random.log_within(1e-5, 50.0);
        let count = 1 + self.random.below(2);
        self.bodies(count);
        let (j, t) = (self.scales.mass, self.scales.time);
        if count == 2 {
            self.link(0, Some(1));
        }
        for body in 0..count {
            let value = j / t * self.near(0.1, 0.4);
            let damping = self.parameter(format!("bearing{}", body + 1), "N.m.s/rad", value);
            self.machine.elements.push(Element::Damper { from: body, to: None, damping });
        }
        let speed = self.scales.length / t;
        let value = self.random.log_within(5e-3, 1.0);
        let constant = self.parameter("motor_constant".into(), "N.m/A", value);
        let amplitude = speed * value * self.near(0.7, 1.5);
        let input = self.input("voltage", "V", Drive { amplitude, middle: 0.0, always: true });
        let value = value * value * t / j * self.near(0.3, 1.5);
        let resistance = self.parameter("resistance".into(), "Ohm", value);
        let value = value * t * self.near(0.05, 0.3);
        let inductance = self.parameter("inductance".into(), "H", value);
        self.machine.others = 1;
        self.machine.elements.push(Element::Motor {
            body: 0,
            current: 0,
            input,
            inductance,
            resistance,
            constant,
        });
        if self.random.chance(0.3) {
            let value = j / self.scales.length * self.near(0.03, 0.2);
            let damping = self.parameter("fan".into(), "N.m.s2/rad2", value);
            self.machine.elements.push(Element::Orifice { from: count - 1, to: None, damping });
        }
        self.disturbance(0.8);
        let current = self.machine.other(0);
        if self.random.chance(0.7) {
            self.output("current".into(), "A", Sensor::State(current));
        }
        self.sensors(count);
    }

    /// Tanks that run into each other, or bodies that pass heat on.
    fn stores(&mut self) {
        let count = 1 + self.random.below(3);
        let tanks = self.random.chance(0.5);
        // slower than machines
        self.machine.time *= 50.0;
        let t = self.machine.time;
        let level =
            if tanks { self.random.log_within(0.05, 5.0) } else { self.random.log_within(2.0, 200.0) };
        let capacity =
            if tanks { self.random.log_within(1e-3, 10.0) } else { self.random.log_within(1.0, 1e6) };
        for s in 0..count {
            let value = capacity * self.near(0.4, 2.0);
            let name = STORES[(s + self.style) % STORES.len()];
            let (what, unit) = if tanks { ("section", "m2") } else { ("heat_capacity", "J/K") };
            let parameter = self.parameter(format!("{name}_{what}"), unit, value);
            self.machine.stores.push(parameter);
        }
        let middle = capacity * level / t;
        let drive = Drive { amplitude: 0.6 * middle, middle, always: true };
        let input =
            if tanks { self.input("inflow", "m3/s", drive) } else { self.input("heater", "W", drive) };
        self.machine.elements.push(Element::Inflow { store: 0, input });
        for s in 0..count {
            let to = (s + 1 < count).then_some(s + 1);
            if tanks {
                let value = middle / (2.0 * super::mechanism::GRAVITY * level).sqrt() * self.near(0.7, 1.4);
                let area = self.parameter(format!("outlet{}", s + 1), "m2", value);
                self.machine.elements.push(Element::Outlet { from: s, to, area });
            } else {
                let value = capacity / t * self.near(0.7, 1.4);
                let conductance = self.parameter(format!("conductance{}", s + 1), "W/K", value);
                self.machine.elements.push(Element::Conductance { from: s, to, conductance });
            }
        }
        for s in 0..count {
            if s == 0 || s + 1 == count || self.random.chance(0.5) {
                let name = STORES[(s + self.style) % STORES.len()];
                let state = self.machine.store(s);
                let (what, unit) = if tanks { ("level", "m") } else { ("warming", "K") };
                self.output(format!("{name}_{what}"), unit, Sensor::State(state));
            }
        }
    }

    /// A second input, a force on one of the bodies.
    fn disturbance(&mut self, probability: f64) {
        if !self.random.chance(probability) {
            return;
        }
        let body = self.random.below(self.machine.bodies.len());
        let taken = self
            .machine
            .elements
            .iter()
            .any(|e| matches!(e, Element::Push { body: other, .. } if *other == body));
        if taken {
            return;
        }
        let amplitude = self.force() * self.near(0.2, 0.6);
        let [_, _, _, unit, _, _] = self.units();
        let name = if self.rotary { "load_torque" } else { "push" };
        let input = self.input(name, unit, Drive { amplitude, middle: 0.0, always: false });
        self.machine.elements.push(Element::Push { body, input });
    }

    fn sensors(&mut self, count: usize) {
        let [position, velocity, acceleration, force, _, _] = self.units();
        for b in 0..count {
            let (x, v) = (b, self.machine.velocity(b));
            // every body has one, the first one more
            let kind = self.random.below(3);
            if kind == 0 || (b == 0 && self.random.chance(0.5)) {
                let name = self.named(b, "position", "x");
                self.output(name, position, Sensor::State(x));
            }
            if kind == 1 {
                let name = self.named(b, "velocity", "v");
                self.output(name, velocity, Sensor::State(v));
            }
            if kind == 2 {
                let name = self.named(b, "acceleration", "a");
                self.output(name, acceleration, Sensor::Rate(v));
            }
        }
        if self.random.chance(0.4)
            && let Some(k) = self.machine.elements.iter().position(|e| matches!(e, Element::Spring { .. }))
        {
            self.output("spring_force".into(), force, Sensor::Force(k));
        }
    }
}
