//! Small models whose coupled behaviour is known in closed form.

use latsch::cosimulate::{
    Experiment, Outcome, Plan, PlannedComponent, Source, System, cosimulate, parse_toml,
};
use latsch::model::{
    Access, Model, Native, Settings, Slave, Table, input, integer_parameter, output, parameter,
};
use latsch::{Error, Result, integer, real};
use serde::{Deserialize, Serialize};

/// An input with its rate, so that its course within a step is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Course {
    end: f64,
    rate: f64,
}

impl Course {
    fn at(self, share: f64, length: f64) -> f64 {
        self.end - self.rate * length * (1.0 - share)
    }
}

macro_rules! course {
    ($field:ident) => {
        Access::rated(
            |m: &Self| m.$field.end,
            |m: &mut Self, end, rate| m.$field = Course { end, rate: rate.unwrap_or(0.0) },
        )
    };
}

/// m x'' = -k x - d x' + force - f, with f = kc (x - other_position) + dc (x' - other_velocity); f is what
/// the other side gets. Classical Runge-Kutta of order 4.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Side {
    pub step_size: f64,
    mass: f64,
    stiffness: f64,
    damping: f64,
    coupling_stiffness: f64,
    coupling_damping: f64,
    x0: f64,
    force: Course,
    other_position: Course,
    other_velocity: Course,
    x: f64,
    v: f64,
    reaction: f64,
    largest_force_change: f64,
    moves_at_most: f64,
    last_force: f64,
    anchor: f64,
}

impl Side {
    fn between(&self, x: f64, v: f64, share: f64, h: f64) -> f64 {
        self.coupling_stiffness * (x - self.other_position.at(share, h))
            + self.coupling_damping * (v - self.other_velocity.at(share, h))
    }

    fn rate(&self, (x, v): (f64, f64), share: f64, h: f64) -> (f64, f64) {
        let force =
            self.force.at(share, h) - self.stiffness * x - self.damping * v - self.between(x, v, share, h);
        (v, force / self.mass)
    }
}

impl Model for Side {
    const NAME: &'static str = "side";
    const DESCRIPTION: &'static str = "A mass between a wall and another mass";
    fn variables() -> Table<Self> {
        Table::new([
            parameter("step_size", "s", real!(step_size), 1e-4, "Step"),
            parameter("mass", "kg", real!(mass), 1.0, "Mass").min(1e-6),
            parameter("stiffness", "N/m", real!(stiffness), 0.0, "To the wall"),
            parameter("damping", "N.s/m", real!(damping), 0.0, "To the wall"),
            parameter("coupling_stiffness", "N/m", real!(coupling_stiffness), 0.0, "To the other"),
            parameter("coupling_damping", "N.s/m", real!(coupling_damping), 0.0, "To the other"),
            parameter("x0", "m", real!(x0), 0.0, "Position at the start"),
            input("force", "N", course!(force), 0.0, "Force from outside"),
            input("other_position", "m", course!(other_position), 0.0, "Position of the other"),
            input("other_velocity", "m/s", course!(other_velocity), 0.0, "Velocity of the other"),
            output("position", "m", real!(x), "Position"),
            output("velocity", "m/s", real!(v), "Velocity"),
            output("reaction", "N", real!(reaction), "Force on the other"),
            output("largest_force_change", "N", real!(largest_force_change), "Within a step, of the input"),
            parameter("moves_at_most", "m", real!(moves_at_most), 1e300, "With the same force"),
        ])
    }

    fn step_size(&self) -> f64 {
        self.step_size
    }

    fn initialize(&mut self) -> Result<()> {
        (self.x, self.v) = (self.x0, 0.0);
        (self.last_force, self.anchor) = (self.force.end, self.x);
        self.reaction = self.between(self.x, self.v, 1.0, 0.0);
        Ok(())
    }

    fn step(&mut self, h: f64) -> Result<()> {
        self.largest_force_change = self.largest_force_change.max((self.force.rate * h).abs());
        let y = (self.x, self.v);
        let add = |y: (f64, f64), k: (f64, f64), h: f64| (y.0 + h * k.0, y.1 + h * k.1);
        let k1 = self.rate(y, 0.0, h);
        let k2 = self.rate(add(y, k1, 0.5 * h), 0.5, h);
        let k3 = self.rate(add(y, k2, 0.5 * h), 0.5, h);
        let k4 = self.rate(add(y, k3, h), 1.0, h);
        self.x += h / 6.0 * (k1.0 + 2.0 * k2.0 + 2.0 * k3.0 + k4.0);
        self.v += h / 6.0 * (k1.1 + 2.0 * k2.1 + 2.0 * k3.1 + k4.1);
        self.reaction = self.between(self.x, self.v, 1.0, h);
        if std::mem::replace(&mut self.last_force, self.force.end) != self.force.end {
            self.anchor = y.0;
        }
        if (self.x - self.anchor).abs() > self.moves_at_most {
            return Err(Error::numeric(format!("it moved to {} m on a held force", self.x)));
        }
        Ok(())
    }
}

/// force = -k x, without delay or memory.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Spring {
    step_size: f64,
    stiffness: f64,
    position: f64,
    force: f64,
    moment: f64,
    count: i32,
    start_count: i32,
}

impl Model for Spring {
    const NAME: &'static str = "spring";
    const DESCRIPTION: &'static str = "A spring";
    fn variables() -> Table<Self> {
        Table::new([
            parameter("step_size", "s", real!(step_size), 1e-4, "Step"),
            parameter("stiffness", "N/m", real!(stiffness), 100.0, "Stiffness"),
            input("position", "m", real!(position), 0.0, "Position").range(-1e6, 1e6),
            output("force", "N", real!(force), "Force"),
            output("moment", "N.m", real!(moment), "On a lever of one metre"),
            output("count", "", integer!(count), "Steps"),
            integer_parameter("start_count", integer!(start_count), 0, "Steps at the start"),
        ])
    }

    fn step_size(&self) -> f64 {
        self.step_size
    }

    fn initialize(&mut self) -> Result<()> {
        self.count = self.start_count;
        (self.force, self.moment) = (-self.stiffness * self.position, -self.stiffness * self.position);
        Ok(())
    }

    fn step(&mut self, _: f64) -> Result<()> {
        self.count += 1;
        (self.force, self.moment) = (-self.stiffness * self.position, -self.stiffness * self.position);
        Ok(())
    }
}

/// A spring that is told the velocity and integrates it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Strut {
    stiffness: f64,
    start: f64,
    velocity: f64,
    stretch: f64,
    force: f64,
}

impl Model for Strut {
    const NAME: &'static str = "strut";
    const DESCRIPTION: &'static str = "A spring that is told the velocity of its end";
    fn variables() -> Table<Self> {
        Table::new([
            parameter("stiffness", "N/mm", real!(stiffness), 0.1, "Stiffness"),
            parameter("start", "mm", real!(start), 0.0, "Stretch at the start"),
            input("velocity", "mm/s", real!(velocity), 0.0, "Velocity"),
            output("force", "N", real!(force), "Force on the end"),
            output("stretch", "mm", real!(stretch), "Stretch"),
        ])
    }

    fn step_size(&self) -> f64 {
        1e-4
    }

    fn initialize(&mut self) -> Result<()> {
        self.stretch = self.start;
        self.force = -self.stiffness * self.stretch;
        Ok(())
    }

    fn step(&mut self, h: f64) -> Result<()> {
        self.stretch += h * self.velocity;
        self.force = -self.stiffness * self.stretch;
        Ok(())
    }
}

/// A slave of one of the models here.
pub fn slave(model: &str) -> Result<Box<dyn Slave>> {
    let settings = Settings::default();
    Ok(match model {
        "side" => Box::new(Native::<Side>::new(&settings)?),
        "strut" => Box::new(Native::<Strut>::new(&settings)?),
        "spring" => Box::new(Native::<Spring>::new(&settings)?),
        _ => return Err(Error::variable(format!("there is no test model {model}"))),
    })
}

pub fn add(system: &mut System, component: &PlannedComponent) -> Result<usize> {
    match &component.source {
        Source::Model(model, None) => system.add(&component.name, slave(model)?),
        other => Err(Error::file(format!("{other:?} is not for tests"))),
    }
}

/// The plan and system of a TOML text with these models.
pub fn wire(text: &str) -> Result<(Plan, System)> {
    let plan = parse_toml(text, "system.toml", std::path::Path::new(""))?;
    let system = plan.wire(add)?;
    Ok((plan, system))
}

/// Runs a TOML text.
pub fn run(text: &str) -> (System, Outcome) {
    run_with(text, |_, experiment| experiment)
}

pub fn run_with(text: &str, change: impl FnOnce(&mut System, Experiment) -> Experiment) -> (System, Outcome) {
    let (plan, mut system) = wire(text).unwrap();
    let experiment = plan.experiment(&system, None, None, None).unwrap();
    let experiment = change(&mut system, Experiment { log: true, ..experiment });
    let outcome = cosimulate(&mut system, &experiment, |_| ()).unwrap();
    assert_eq!(outcome.stopped, None);
    (system, outcome)
}

pub fn channel(outcome: &Outcome, name: &str) -> Vec<f64> {
    outcome.recording.channel(name).unwrap().values.clone()
}
