//! `steady-tire`: forces that follow slip, slip angle, camber and load at once.
//!
//! The wheel turns with omega = V (1 + kappa) / R_e.

use crate::magic_formula::MagicFormula;
use crate::rk4::{between, rk4};
use latsch::model::{Access, Model, Table, input, output, parameter};
use latsch::{Result, real};
use serde::{Deserialize, Serialize};

/// Parameters, inputs, slip and speed one step before, angle of the wheel.
#[derive(Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct SteadyTire {
    tire: MagicFormula,
    rolling_radius: f64,
    slip: f64,
    slip_angle: f64,
    camber: f64,
    load: f64,
    speed: f64,
    last_slip: f64,
    last_speed: f64,
    angle: f64,
}

impl SteadyTire {
    fn force(&self, index: usize) -> f64 {
        self.tire.forces(self.slip, self.slip_angle, self.camber, self.load)[index]
    }

    fn spin(&self, slip: f64, speed: f64) -> f64 {
        speed * (1.0 + slip) / self.rolling_radius
    }
}

impl Model for SteadyTire {
    const NAME: &'static str = "steady-tire";
    const DESCRIPTION: &'static str = "A Magic-Formula-like tire without transients: slip, slip angle, camber, load and speed in, forces and aligning moment out";
    const DOCUMENTATION: &'static [&'static str] = &[
        "<h2>Axes</h2><p>Forces of the road on the tire, ISO 8855: a positive slip angle gives a negative lateral force and a positive aligning moment; slip is positive when driving.</p>",
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
            parameter(
                "shape",
                "1",
                real!(tire.shape),
                1.4,
                "Shape factor C: above 1, forces fall beyond their peak (placeholder)",
            )
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
                "rolling_radius",
                "m",
                real!(rolling_radius),
                0.32,
                "Distance rolled freely per radian (placeholder)",
            )
            .range(0.1, 1.0),
            input("slip", "1", real!(slip), 0.0, "Longitudinal slip, positive when driving").range(-1.0, 2.0),
            input("slip_angle", "rad", real!(slip_angle), 0.0, "Slip angle").range(-1.0, 1.0),
            input("camber", "rad", real!(camber), 0.0, "Inclination angle").range(-1.0, 1.0),
            input("load", "N", real!(load), 4000.0, "Wheel load; below 0 counts as 0").range(-1e5, 1e5),
            input("speed", "m/s", real!(speed), 20.0, "Travel speed").range(0.0, 150.0),
            output("force_x", "N", Access::computed(|m: &Self| m.force(0)), "Longitudinal force")
                .nominal(1000.0),
            output("force_y", "N", Access::computed(|m: &Self| m.force(1)), "Lateral force").nominal(1000.0),
            output("moment_z", "N.m", Access::computed(|m: &Self| m.force(2)), "Aligning moment")
                .nominal(30.0),
            output(
                "wheel_speed",
                "rad/s",
                Access::computed(|m: &Self| m.spin(m.slip, m.speed)),
                "Speed of rotation",
            )
            .nominal(60.0),
            output("wheel_angle", "rad", real!(angle), "Angle of rotation since the start").nominal(100.0),
        ])
    }

    fn step_size(&self) -> f64 {
        1e-3
    }

    fn initialize(&mut self) -> Result<()> {
        (self.last_slip, self.last_speed, self.angle) = (self.slip, self.speed, 0.0);
        Ok(())
    }

    fn step(&mut self, h: f64) -> Result<()> {
        let spin =
            |at| self.spin(between(self.last_slip, self.slip, at), between(self.last_speed, self.speed, at));
        [self.angle] = rk4([self.angle], h, |at, _| [spin(at)]);
        (self.last_slip, self.last_speed) = (self.slip, self.speed);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rk4::tests::{close, get, rate, set, started};
    use latsch::model::Slave;

    #[test]
    fn rolls_the_distance_and_forgets_the_past() {
        let mut slave = started::<SteadyTire>(&[("speed", 10.0)]);
        rate(&mut slave, "speed", 4.0);
        rate(&mut slave, "slip", -0.05);
        slave.step(0.0, 2.0).unwrap();
        // integral of (10 + 4 t)(1 - 0.05 t) / 0.32 over 2 s
        close(get(&mut slave, "wheel_angle"), (20.0 + 8.0 - 0.5 * 2.0 - 0.2 * 8.0 / 3.0) / 0.32, 1e-9);
        close(get(&mut slave, "wheel_speed"), 18.0 * 0.9 / 0.32, 1e-9);
        set(&mut slave, &[("slip", 0.0), ("slip_angle", 1e-3), ("load", 3000.0)]);
        rate(&mut slave, "slip", 0.0);
        rate(&mut slave, "speed", 0.0);
        slave.step(2.0, 1e-3).unwrap();
        close(get(&mut slave, "force_y"), -45.0, 1e-2);
        close(get(&mut slave, "force_x"), 0.0, 1e-12);
    }
}
