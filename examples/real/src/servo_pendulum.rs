//! A position servo that swings a pendulum, with no friction but what grows with the speed.

use crate::rk4::rk4;
use latsch::model::{Model, Table, input, output, parameter};
use latsch::{Result, real};
use serde::{Deserialize, Serialize};

/// J φ'' = k (U - k φ') / R - d φ' - m g l sin φ + M, where the controller gives U. Recordings do not have the moment M: it
/// is there for what is left out.
#[derive(Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ServoPendulum {
    mass: f64,
    length: f64,
    gravity: f64,
    armature_inertia: f64,
    torque_constant: f64,
    resistance: f64,
    viscous_friction: f64,
    gain: f64,
    goal: f64,
    enable: f64,
    supply_voltage: f64,
    other_moment: f64,
    motor_moment: f64,
    position: f64,
    velocity: f64,
}

/// Encoder counts of a turn, and what of the product of gain and counts is a whole duty cycle.
const COUNTS: f64 = 4096.0;
const WHOLE: f64 = 256.0 * 885.0;
/// Longest step \[s\] that is taken at once: the motor's own damping is far slower.
const STEP: f64 = 1e-3;

impl ServoPendulum {
    /// What the motor turns the pendulum with.
    fn motor(&self, position: f64, velocity: f64) -> f64 {
        let counts = (self.goal - position) * COUNTS / std::f64::consts::TAU;
        let duty = (self.gain * counts / WHOLE).clamp(-1.0, 1.0);
        let voltage = duty * self.supply_voltage;
        // a motor that is not driven is open: no current brakes it
        let current = self.enable * (voltage - self.torque_constant * velocity) / self.resistance;
        self.torque_constant * current
    }

    fn acceleration(&self, position: f64, velocity: f64) -> f64 {
        let (sin, _) = libm::sincos(position);
        let moment = self.motor(position, velocity)
            - self.viscous_friction * velocity
            - self.mass * self.gravity * self.length * sin
            + self.other_moment;
        moment / (self.mass * self.length * self.length + self.armature_inertia)
    }
}

impl Model for ServoPendulum {
    const NAME: &'static str = "servo-pendulum";
    const DESCRIPTION: &'static str =
        "A position servo with a motor of direct current that swings a pendulum";
    fn variables() -> Table<Self> {
        Table::new([
            parameter("mass", "kg", real!(mass), 0.49, "Mass of the pendulum").range(1e-9, 1e3),
            parameter("length", "m", real!(length), 0.1, "Distance of its mass from the axis")
                .range(1e-9, 10.0),
            parameter("gravity", "m/s2", real!(gravity), 9.81, "Gravity").range(0.0, 20.0),
            parameter(
                "armature_inertia",
                "kg.m2",
                real!(armature_inertia),
                3e-3,
                "Moment of inertia of rotor and gear, about the axis of the pendulum",
            )
            .range(0.0, 1.0)
            .nominal(1e-3),
            parameter(
                "torque_constant",
                "N.m/A",
                real!(torque_constant),
                0.45,
                "Torque by current, at the gear's end",
            )
            .range(1e-6, 100.0),
            parameter("resistance", "V/A", real!(resistance), 4.4, "Of the winding").range(1e-9, 1e3),
            parameter(
                "viscous_friction",
                "N.m.s/rad",
                real!(viscous_friction),
                0.02,
                "Moment of friction by speed",
            )
            .range(0.0, 10.0)
            .nominal(0.01),
            input("gain", "1", real!(gain), 400.0, "Gain of the controller").nominal(400.0),
            input("goal", "rad", real!(goal), 0.0, "Angle that is commanded"),
            input("enable", "1", real!(enable), 1.0, "1 where the motor is driven, else 0"),
            input("supply_voltage", "V", real!(supply_voltage), 7.4, "Supply at the servo").nominal(7.4),
            input(
                "other_moment",
                "N.m",
                real!(other_moment),
                0.0,
                "Moment of what else acts on the pendulum",
            ),
            output("motor_moment", "N.m", real!(motor_moment), "Moment of the motor, at the gear's end"),
            output("position", "rad", real!(position), "Angle of the pendulum, 0 where it hangs"),
            output("velocity", "rad/s", real!(velocity), "Speed of the pendulum"),
        ])
    }
    const COMMUNICATION_STEP: f64 = 5e-3;
    const STOP_TIME: f64 = 6.0;

    fn step_size(&self) -> f64 {
        STEP
    }

    /// At rest where it is told to be.
    fn initialize(&mut self) -> Result<()> {
        self.position = self.goal;
        self.velocity = 0.0;
        self.motor_moment = self.motor(self.position, self.velocity);
        Ok(())
    }

    /// A step of the classical Runge-Kutta method.
    fn step(&mut self, length: f64) -> Result<()> {
        let slope = |[x, v]: [f64; 2]| [v, self.acceleration(x, v)];
        [self.position, self.velocity] = rk4([self.position, self.velocity], length, slope);
        self.motor_moment = self.motor(self.position, self.velocity);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use latsch::model::{Native, Settings, Slave};

    fn servo(values: &[(&str, f64)]) -> (Native<ServoPendulum>, impl Fn(&str) -> usize) {
        let mut servo = Native::<ServoPendulum>::new(&Settings::default()).unwrap();
        let interface = servo.interface().clone();
        let find = move |name: &str| interface.find(name).unwrap();
        for (name, value) in values {
            servo.set(find(name), *value).unwrap();
        }
        servo.start(0.0, None).unwrap();
        servo.finish_start().unwrap();
        (servo, find)
    }

    /// Not driven and without friction it swings with the period of the pendulum, which grows with the square of the angle.
    #[test]
    fn it_swings_as_a_pendulum_where_it_is_not_driven() {
        let (mut servo, find) = servo(&[("enable", 0.0), ("viscous_friction", 0.0), ("goal", 0.2)]);
        let inertia = 0.49 * 0.01 + 3e-3;
        let small = std::f64::consts::TAU * (inertia / (0.49 * 9.81 * 0.1_f64)).sqrt();
        let period = small * (1.0 + 0.2_f64.powi(2) / 16.0 + 11.0 / 3072.0 * 0.2_f64.powi(4));
        servo.step(0.0, period).unwrap();
        assert!((servo.get(find("position")).unwrap() - 0.2).abs() < 1e-6);
        assert!(servo.get(find("velocity")).unwrap().abs() < 1e-4);
    }

    /// Held out, it stays below its goal by what the gravity needs of the controller; far out, the duty cycle is whole.
    #[test]
    fn gravity_pulls_it_from_its_goal() {
        let (mut servo, find) = servo(&[("goal", 1.0), ("gain", 800.0)]);
        servo.step(0.0, 5.0).unwrap();
        let position = servo.get(find("position")).unwrap();
        let duty = 800.0 * (1.0 - position) * COUNTS / std::f64::consts::TAU / WHOLE;
        let held = 0.45 * duty * 7.4 / 4.4;
        assert!((held - 0.49 * 9.81 * 0.1 * position.sin()).abs() < 1e-6, "{position}");
        let (mut servo, find) = super::tests::servo(&[("length", 1e-9), ("mass", 1e-9), ("gain", 800.0)]);
        servo.set(find("goal"), 1e3).unwrap();
        servo.step(0.0, 3.0).unwrap();
        // the motor's speed without load
        let speed = 0.45 * 7.4 / 4.4 / (0.45 * 0.45 / 4.4 + 0.02);
        assert!((servo.get(find("velocity")).unwrap() / speed - 1.0).abs() < 1e-6);
    }
}
