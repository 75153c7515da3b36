//! A motor that moves a carriage along a guide, with no friction but what grows with the speed.

use crate::rk4::rk4;
use latsch::model::{Model, Table, input, output, parameter};
use latsch::{Result, real};
use serde::{Deserialize, Serialize};

/// m x'' = k u - d x' + F_0 + F. The recordings do not have the force F: it is there for what is left out.
#[derive(Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct PositioningAxis {
    mass: f64,
    viscous_friction: f64,
    force_constant: f64,
    offset: f64,
    voltage: f64,
    start: f64,
    other_force: f64,
    motor_force: f64,
    position: f64,
    velocity: f64,
}

impl PositioningAxis {
    fn acceleration(&self, velocity: f64) -> f64 {
        (self.force_constant * self.voltage + self.offset + self.other_force
            - self.viscous_friction * velocity)
            / self.mass
    }
}

impl Model for PositioningAxis {
    const NAME: &'static str = "positioning-axis";
    const DESCRIPTION: &'static str = "A carriage on a guide that a motor moves by a ball screw";
    fn variables() -> Table<Self> {
        Table::new([
            parameter("mass", "kg", real!(mass), 100.0, "Mass of the carriage, and of all that turns")
                .range(1e-3, 1e5),
            parameter(
                "viscous_friction",
                "N.s/m",
                real!(viscous_friction),
                200.0,
                "Friction by the velocity",
            )
            .range(0.0, 1e6),
            parameter(
                "force_constant",
                "N/V",
                real!(force_constant),
                35.15,
                "Force by the voltage of the drive's command",
            )
            .range(1e-3, 1e4),
            parameter("offset", "N", real!(offset), 0.0, "Force where the command is zero")
                .range(-1e3, 1e3)
                .nominal(1.0),
            input("voltage", "V", real!(voltage), 0.0, "Command of the drive"),
            input("start", "m", real!(start), 0.0, "Where the carriage rests at the start"),
            input("other_force", "N", real!(other_force), 0.0, "Force of what else acts on the carriage"),
            output("motor_force", "N", real!(motor_force), "Force of the motor"),
            output("position", "m", real!(position), "Position of the carriage").nominal(0.1),
            output("velocity", "m/s", real!(velocity), "Velocity of the carriage").nominal(0.1),
        ])
    }
    const COMMUNICATION_STEP: f64 = 5e-3;
    const STOP_TIME: f64 = 6.0;

    fn step_size(&self) -> f64 {
        2.5e-3
    }

    /// At rest.
    fn initialize(&mut self) -> Result<()> {
        self.position = self.start;
        self.velocity = 0.0;
        self.motor_force = self.force_constant * self.voltage;
        Ok(())
    }

    fn step(&mut self, length: f64) -> Result<()> {
        let slope = |[_, v]: [f64; 2]| [v, self.acceleration(v)];
        [self.position, self.velocity] = rk4([self.position, self.velocity], length, slope);
        self.motor_force = self.force_constant * self.voltage;
        Ok(())
    }
}
