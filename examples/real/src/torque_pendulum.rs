//! A pendulum on a torque-controlled motor, with no friction but what grows with the speed.

use crate::rk4::rk4;
use latsch::model::{Model, Table, input, output, parameter};
use latsch::{Result, real};
use serde::{Deserialize, Serialize};

/// J φ'' = M - d φ' - m g l sin φ.
#[derive(Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct TorquePendulum {
    inertia: f64,
    mass: f64,
    length: f64,
    gravity: f64,
    damping: f64,
    torque: f64,
    position: f64,
    velocity: f64,
}

impl TorquePendulum {
    fn slope(&self, [x, v]: [f64; 2]) -> [f64; 2] {
        let (sin, _) = libm::sincos(x);
        [v, (self.torque - self.damping * v - self.mass * self.gravity * self.length * sin) / self.inertia]
    }
}

impl Model for TorquePendulum {
    const NAME: &'static str = "torque-pendulum";
    const DESCRIPTION: &'static str = "A pendulum on the shaft of a motor that is given a torque";
    fn variables() -> Table<Self> {
        Table::new([
            parameter(
                "inertia",
                "kg.m2",
                real!(inertia),
                0.15,
                "Moment of inertia about the axis, rotor included",
            )
            .range(1e-6, 1e3),
            parameter("mass", "kg", real!(mass), 0.676, "Mass of the pendulum").range(1e-6, 1e3),
            parameter("length", "m", real!(length), 0.45, "Distance of its centre of mass from the axis")
                .range(1e-6, 10.0),
            parameter("gravity", "m/s2", real!(gravity), 9.81, "Gravity").range(0.0, 20.0),
            parameter("damping", "N.m.s/rad", real!(damping), 0.1, "Moment of friction by the speed")
                .range(0.0, 10.0)
                .nominal(0.1),
            input("torque", "N.m", real!(torque), 0.0, "Torque of the motor, behind the gear"),
            output("position", "rad", real!(position), "Angle of the pendulum, 0 where it hangs"),
            output("velocity", "rad/s", real!(velocity), "Speed of the pendulum"),
        ])
    }
    const COMMUNICATION_STEP: f64 = 2e-3;
    const STOP_TIME: f64 = 5.0;

    fn step_size(&self) -> f64 {
        1e-3
    }

    /// Hangs at rest.
    fn initialize(&mut self) -> Result<()> {
        (self.position, self.velocity) = (0.0, 0.0);
        Ok(())
    }

    fn step(&mut self, length: f64) -> Result<()> {
        [self.position, self.velocity] = rk4([self.position, self.velocity], length, |x| self.slope(x));
        Ok(())
    }
}
