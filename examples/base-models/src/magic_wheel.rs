//! `magic-wheel`: the tire of `steady-tire` with relaxation, on a wheel that spins.
//!
//! sigma_x kappa' = omega R - V - |V| kappa,  sigma_y alpha' = |V| (alpha_in - alpha),
//! J omega' = -F_x R - T_b tanh(omega / omega_0).

use crate::magic_formula::MagicFormula;
use crate::rk4::{between, rk4};
use latsch::model::{Access, Model, Table, input, output, parameter};
use latsch::{Result, real};
use serde::{Deserialize, Serialize};

/// Below this speed of rotation \[rad/s\] the brake's torque fades: it holds a wheel and does not turn it back.
pub const STANDSTILL: f64 = 2.0;

/// Parameters, inputs, inputs one step before, states (omega, kappa, alpha, angle).
#[derive(Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct MagicWheel {
    tire: MagicFormula,
    radius: f64,
    spin_inertia: f64,
    slip_relaxation: f64,
    relaxation: f64,
    inputs: Inputs,
    last: Inputs,
    state: [f64; 4],
}

#[derive(Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
struct Inputs {
    brake_torque: f64,
    slip_angle: f64,
    camber: f64,
    load: f64,
    speed: f64,
}

impl MagicWheel {
    fn forces(&self, u: &Inputs, x: &[f64; 4]) -> [f64; 3] {
        self.tire.forces(x[1], x[2], u.camber, u.load)
    }

    fn force(&self, index: usize) -> f64 {
        self.forces(&self.inputs, &self.state)[index]
    }

    fn slope(&self, u: &Inputs, x: &[f64; 4]) -> [f64; 4] {
        let [omega, slip, angle, _] = *x;
        let [fx, ..] = self.forces(u, x);
        let brake = u.brake_torque * libm::tanh(omega / STANDSTILL);
        [
            (-fx * self.radius - brake) / self.spin_inertia,
            (omega * self.radius - u.speed - u.speed.abs() * slip) / self.slip_relaxation,
            u.speed.abs() * (u.slip_angle - angle) / self.relaxation,
            omega,
        ]
    }
}

impl Model for MagicWheel {
    const NAME: &'static str = "magic-wheel";
    const DESCRIPTION: &'static str = "A wheel with spin inertia and a Magic-Formula-like tire with relaxation: brake torque, slip angle, camber, load and speed in";
    const DOCUMENTATION: &'static [&'static str] = &[
        "<h2>Start</h2><p>It starts rolling freely, without the brake, at the slip angle that it is given.</p>",
    ];
    fn variables() -> Table<Self> {
        Table::new([
            parameter("friction", "1", real!(tire.friction), 1.0, "Largest force over load (placeholder)")
                .range(0.1, 3.0)
                .tunable(),
            parameter(
                "slip_stiffness",
                "1",
                real!(tire.slip_stiffness),
                20.0,
                "Longitudinal force over load and slip, at small slip (placeholder)",
            )
            .range(1.0, 100.0)
            .tunable(),
            parameter(
                "cornering_stiffness",
                "1/rad",
                real!(tire.cornering_stiffness),
                15.0,
                "Lateral force over load and slip angle, at small angles (placeholder)",
            )
            .range(1.0, 100.0)
            .tunable(),
            parameter("shape", "1", real!(tire.shape), 1.4, "Shape factor C (placeholder)")
                .range(1.05, 1.95)
                .tunable(),
            parameter(
                "trail",
                "m",
                real!(tire.trail),
                0.03,
                "Pneumatic trail at small slip angles (placeholder)",
            )
            .range(0.0, 0.2)
            .tunable(),
            parameter(
                "camber_moment",
                "m/rad",
                real!(tire.camber_moment),
                0.01,
                "Aligning moment over load and camber (placeholder)",
            )
            .range(-0.1, 0.1)
            .nominal(0.01)
            .tunable(),
            parameter(
                "radius",
                "m",
                real!(radius),
                0.32,
                "Rolling radius, and lever of the longitudinal force (placeholder)",
            )
            .range(0.1, 1.0)
            .tunable(),
            parameter(
                "spin_inertia",
                "kg.m2",
                real!(spin_inertia),
                1.2,
                "Moment of inertia about the wheel's axis (placeholder)",
            )
            .range(0.1, 20.0)
            .tunable(),
            parameter(
                "slip_relaxation_length",
                "m",
                real!(slip_relaxation),
                0.2,
                "Relaxation length of the longitudinal slip (placeholder)",
            )
            .range(0.02, 2.0)
            .tunable(),
            parameter(
                "relaxation_length",
                "m",
                real!(relaxation),
                0.5,
                "Relaxation length of the slip angle (placeholder)",
            )
            .range(0.02, 5.0)
            .tunable(),
            input(
                "brake_torque",
                "N.m",
                real!(inputs.brake_torque),
                0.0,
                "Torque of the brake against the rotation",
            )
            .range(-1e5, 1e5),
            input("slip_angle", "rad", real!(inputs.slip_angle), 0.0, "Slip angle").range(-1.0, 1.0),
            input("camber", "rad", real!(inputs.camber), 0.0, "Inclination angle").range(-1.0, 1.0),
            input("load", "N", real!(inputs.load), 4000.0, "Wheel load; below 0 counts as 0")
                .range(-1e5, 1e5),
            input("speed", "m/s", real!(inputs.speed), 20.0, "Travel speed").range(0.0, 150.0),
            output("force_x", "N", Access::computed(|m: &Self| m.force(0)), "Longitudinal force")
                .nominal(1000.0),
            output("force_y", "N", Access::computed(|m: &Self| m.force(1)), "Lateral force").nominal(1000.0),
            output("moment_z", "N.m", Access::computed(|m: &Self| m.force(2)), "Aligning moment")
                .nominal(30.0),
            output("wheel_speed", "rad/s", real!(state[0]), "Speed of rotation").nominal(60.0),
            output("wheel_angle", "rad", real!(state[3]), "Angle of rotation since the start").nominal(100.0),
        ])
    }

    fn step_size(&self) -> f64 {
        1e-3
    }

    fn initialize(&mut self) -> Result<()> {
        self.last = self.inputs;
        self.state = [self.inputs.speed / self.radius, 0.0, self.inputs.slip_angle, 0.0];
        Ok(())
    }

    fn step(&mut self, h: f64) -> Result<()> {
        let (from, to) = (self.last, self.inputs);
        let inputs = |at| Inputs {
            brake_torque: between(from.brake_torque, to.brake_torque, at),
            slip_angle: between(from.slip_angle, to.slip_angle, at),
            camber: between(from.camber, to.camber, at),
            load: between(from.load, to.load, at),
            speed: between(from.speed, to.speed, at),
        };
        self.state = rk4(self.state, h, |at, x| self.slope(&inputs(at), x));
        self.last = self.inputs;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rk4::tests::{close, get, set, started};
    use latsch::model::Slave;

    #[test]
    fn the_lateral_force_grows_with_the_distance_rolled() {
        for speed in [10.0, 40.0] {
            let mut slave = started::<MagicWheel>(&[("speed", speed)]);
            set(&mut slave, &[("slip_angle", 1e-3)]);
            slave.step(0.0, 1e-3).unwrap();
            let start = slave.model().state[2];
            let time = (1.0_f64 / speed).max(1e-3);
            slave.step(1e-3, time).unwrap();
            // after 1 m, exp(-2) of the way is left
            close(1e-3 - slave.model().state[2], (1e-3 - start) * (-2.0_f64).exp(), 1e-10);
        }
    }

    #[test]
    fn a_brake_torque_ends_in_a_balanced_wheel_and_a_large_one_locks_it() {
        let mut slave = started::<MagicWheel>(&[]);
        set(&mut slave, &[("brake_torque", 600.0)]);
        slave.step(0.0, 3.0).unwrap();
        close(get(&mut slave, "force_x"), -600.0 / 0.32, 1e-6);
        let slip = slave.model().state[1];
        close(get(&mut slave, "wheel_speed"), 20.0 * (1.0 + slip) / 0.32, 1e-6);
        set(&mut slave, &[("brake_torque", 4000.0)]);
        slave.step(3.0, 1.0).unwrap();
        close(get(&mut slave, "wheel_speed"), 0.0, 1.5);
        assert!(get(&mut slave, "wheel_speed") > 0.0);
    }
}
