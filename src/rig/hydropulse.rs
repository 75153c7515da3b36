//! A servo-hydraulic rig for a wheel that stands: `super-elastic-hydropulse`. A cylinder presses the wheel on the road by force or
//! moves it by way, around a preload; a load cell between both.
//!
//! After S. Y. Oh (2017), 7.2: harmonic force excitation b + A sin(2 pi f t) (7-1), with the deflection as the answer.

use super::{Actuation, Actuator, Command, Excitation, Rolling};
use crate::mechanics::{ALONG, Motion, PointMass, check_step_size};
use crate::model::{Access, Model, Purpose, Role, Table, input, integer_parameter, join, output, parameter};
use crate::road;
use crate::tire::Tire;
use crate::{Error, Result, clone_in_place, integer, lens, rated, real};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// What the cylinder controls, from 1.
const CONTROLS: &[(&str, &str)] =
    &[("force", "the force in the load cell"), ("position", "the way of the wheel's centre")];

/// The model.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct HydroPulse<T> {
    tire: Rolling<T>,
    /// Commands of force \[N\] and position \[m\], both downward.
    force: Command,
    position: Command,
    control: i32,
    excitation: Excitation,
    actuation: Actuation,
    /// What the cylinder does, of what it controls.
    actuator: Actuator,
    /// The wheel and what moves with it below the load cell.
    wheel: PointMass,
    mass: f64,
    /// Force in the load cell, downward \[N\].
    cell: f64,
    time: f64,
    step_size: f64,
}

clone_in_place!(HydroPulse<T> {
    tire, force, position, control, excitation, actuation, actuator, wheel, mass, cell, time, step_size
});

impl<T: Tire> Model for HydroPulse<T> {
    const NAME: &'static str = const { &join::<48>(&[T::NAME, "-hydropulse"]) }.as_str();
    const DESCRIPTION: &'static str = const {
        &join::<256>(&[
            T::TITLE,
            " standing under a servo-hydraulic cylinder: force or position in, position or force out, harmonic, sweeping, random or recorded",
        ])
    }
    .as_str();
    const STOP_TIME: f64 = 5.0;
    const DOCUMENTATION: &'static [&'static str] = &[
        include_str!("hydropulse.html"),
        include_str!("actuator.html"),
        T::DOCUMENTATION,
        road::DOCUMENTATION,
        T::ON_ROAD,
    ];

    #[rustfmt::skip] // a row is a line
    fn variables() -> Table<Self> {
        Table::new([
            input("force", "N", rated!(force), 4000.0, "Force with which the cylinder presses the wheel on the road, with force control: the preload and, where recorded, all of it").range(-1e6, 1e6).nominal(1000.0).role(Role::Force),
            input("position", "m", rated!(position), 0.01, "How much lower than without load on level road the wheel's centre is, with position control").range(-0.5, 0.5),
        ])
        // under a wheel that stands, bristles stick and let go in moments
        .part("", lens!(tire), Rolling::rows().without_derivatives_if(true))
        .and([
            output("cell_force", "N", real!(cell), "Force in the load cell above the wheel, positive where it presses the wheel down").nominal(1000.0).role(Role::Load),
            output("piston_position", "m", Access::computed(|m: &Self| m.lowered()), "How much lower than without load on level road the wheel's centre is"),
            output("piston_velocity", "m/s", Access::computed(|m: &Self| -m.wheel.velocity.z), "Velocity of the piston, downward"),
            integer_parameter("control", integer!(control), 1, "What the cylinder controls").items(CONTROLS).purpose(Purpose::Data),
        ])
        .part("", lens!(excitation), Excitation::rows())
        .and([
            parameter("wheel_mass", "kg", real!(mass), 30.0, "Mass below the load cell: wheel, axle and piston, without masses inside the tire's model").range(0.1, 1e4),
            parameter("step_size", "s", real!(step_size), T::STEP, "Step of the model's own time grid").range(1e-7, 1e-3).purpose(Purpose::Numerics).role(Role::Step),
        ])
        .part("", lens!(actuation), Actuation::rows())
        .without_derivatives_if(T::RIPPLES)
    }

    fn step_size(&self) -> f64 {
        self.step_size
    }

    fn initialize(&mut self) -> Result<()> {
        self.tire.mount()?;
        self.check_steps()?;
        self.time = 0.0;
        let command = self.command();
        self.actuator = Actuator { position: command.value, velocity: command.rate.unwrap_or(0.0) };
        let held = Actuator { velocity: 0.0, ..self.actuator };
        self.wheel = PointMass::default();
        if self.controls_force() {
            let load = held.position + self.mass * self.tire.tire().gravity();
            self.tire.start_carrying(&self.rim(), [0.0; 2], load)?;
        } else {
            self.wheel.position.z = self.tire.tire().radius() - held.position;
            self.tire.start(&self.rim(), [0.0; 2])?;
        }
        self.wheel.position.z = self.tire.mounted.rim.position.z;
        self.balance();
        Ok(())
    }

    fn tune(&mut self) -> Result<()> {
        self.check_steps()?;
        self.tire.tune()
    }

    fn check(&self) -> Result<()> {
        self.tire.check()
    }

    fn warning(&self) -> Option<String> {
        self.tire.mounted.warning()
    }

    fn step(&mut self, length: f64) -> Result<()> {
        self.time += length;
        let command = self.command();
        self.actuator.follow(&command, self.actuation.corner(), length);
        if self.controls_force() {
            let predicted = self.wheel.drift(length);
            let rim = Motion { velocity: predicted, ..self.rim() };
            self.tire.step(&rim, [0.0; 2], [0.0; 2], length)?;
            self.balance();
            self.wheel.kick(length);
        } else {
            let before = self.wheel.velocity.z;
            self.wheel.position.z = self.tire.tire().radius() - self.actuator.position;
            self.wheel.velocity.z = -self.actuator.velocity;
            self.wheel.acceleration.z = (self.wheel.velocity.z - before) / length;
            let rim = self.rim();
            self.tire.step(&rim, [0.0; 2], [0.0; 2], length)?;
            self.balance();
        }
        if self.wheel.is_finite() {
            Ok(())
        } else {
            Err(Error::numeric("the wheel's motion is no longer finite; a smaller step_size may help"))
        }
    }
}

impl<T: Tire> HydroPulse<T> {
    fn controls_force(&self) -> bool {
        self.control != 2
    }

    /// What is commanded at the present time: the input with the excitation around it.
    fn command(&self) -> Command {
        let input = if self.controls_force() { &self.force } else { &self.position };
        let (value, rate) = self.excitation.at(self.time);
        let rates = if rate == 0.0 { input.rate } else { Some(input.rate.unwrap_or(0.0) + rate) };
        Command { value: input.value + value, rate: rates }
    }

    /// The wheel stands.
    fn rim(&self) -> Motion<f64> {
        Motion {
            position: Vector3::new(0.0, 0.0, self.wheel.position.z),
            velocity: self.wheel.velocity,
            ..Motion::default()
        }
    }

    /// How much lower than without load the wheel's centre is over the road's datum \[m\].
    fn lowered(&self) -> f64 {
        self.tire.tire().radius() - self.wheel.position.z
    }

    /// Takes over what acts on the wheel now: with force control its acceleration follows, with position control the force in the
    /// load cell.
    fn balance(&mut self) {
        let tire = self.tire.tire();
        let (of_tire, weight) = (tire.on_rim().force.z, self.mass * tire.gravity());
        if self.controls_force() {
            let carried = tire.carried();
            self.cell = self.actuator.position;
            let free = of_tire + carried.acceleration.z * carried.mass - weight - self.cell;
            self.wheel.acceleration = Vector3::new(0.0, 0.0, free / (self.mass + carried.mass));
        } else {
            self.cell = of_tire - weight - self.mass * self.wheel.acceleration.z;
        }
    }

    fn check_steps(&self) -> Result<()> {
        let [radial, ..] = self.tire.tire().links();
        check_step_size(self.step_size, ("wheel_mass", self.mass), &[radial], &ALONG)
    }
}
