//! `brake-corner` and `abs-brake`: a quarter of a vehicle that brakes.
//!
//! m v' = F_x,  J omega' = -F_x R - T tanh(omega / omega_0),  T = k_b p,
//! sigma kappa' = omega R - v - |v| kappa, with the Magic Formula of the other base models.
//! `brake-corner` takes p as recorded. In `abs-brake` an anti-lock controller moves it: with the slip
//! s = 1 - omega R_c / max(v, 1 m/s) that the controller sees, and w = clamp((s_target - s) / width, -1, 1),
//! p' = (build rate if w > 0, else dump rate) w, but no faster towards the driver's pressure, and no
//! faster towards 0, than with the time constant of the valves.

use crate::magic_formula::MagicFormula;
use crate::magic_wheel::STANDSTILL;
use crate::rk4::{between, rk4};
use latsch::model::{Access, Model, Table, input, output, parameter};
use latsch::{Result, real};
use serde::{Deserialize, Serialize};

/// Time constant with which the pressure ends in the driver's, or in 0 \[s\].
const VALVE_LAG: f64 = 0.01;
/// Slip is over no less than this speed \[m/s\].
const SLOW: f64 = 1.0;

/// Parameters and states (v, omega, kappa, p) of both.
#[derive(Clone, Default, PartialEq, Serialize, Deserialize)]
struct Corner {
    mass: f64,
    brake_factor: f64,
    tire: MagicFormula,
    radius: f64,
    spin_inertia: f64,
    slip_relaxation: f64,
    inputs: Inputs,
    last: Inputs,
    start_speed: f64,
    state: [f64; 4],
}

#[derive(Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
struct Inputs {
    pressure: f64,
    load: f64,
}

impl Corner {
    fn start(&mut self, pressure: f64) {
        self.last = self.inputs;
        self.state = [self.start_speed, self.start_speed / self.radius, 0.0, pressure];
    }

    /// Rates of v, omega and kappa.
    fn slope(&self, load: f64, pressure: f64, x: &[f64; 4]) -> [f64; 3] {
        let [v, omega, slip, _] = *x;
        let [fx, ..] = self.tire.forces(slip, 0.0, 0.0, load);
        let brake = self.brake_factor * pressure * libm::tanh(omega / STANDSTILL);
        [
            fx / self.mass,
            (-fx * self.radius - brake) / self.spin_inertia,
            (omega * self.radius - v - v.abs() * slip) / self.slip_relaxation,
        ]
    }

    fn step(&mut self, h: f64, pressure_rate: impl Fn(f64, &[f64; 4]) -> Option<f64>) {
        let (from, to) = (self.last, self.inputs);
        self.state = rk4(self.state, h, |at, x| {
            let commanded = between(from.pressure, to.pressure, at);
            let load = between(from.load, to.load, at);
            let rate = pressure_rate(commanded, x);
            let pressure = if rate.is_some() { x[3] } else { commanded };
            let [v, omega, slip] = self.slope(load, pressure.max(0.0), x);
            [v, omega, slip, rate.unwrap_or(0.0)]
        });
        self.last = self.inputs;
    }

    fn slip(&self) -> f64 {
        let [v, omega, ..] = self.state;
        1.0 - omega * self.radius / v.max(SLOW)
    }

    fn torque(&self, pressure: f64) -> f64 {
        self.brake_factor * pressure.max(0.0) * libm::tanh(self.state[1] / STANDSTILL)
    }
}

/// A quarter of a vehicle that brakes with a given pressure.
#[derive(Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct BrakeCorner {
    corner: Corner,
}

impl Model for BrakeCorner {
    const NAME: &'static str = "brake-corner";
    const DESCRIPTION: &'static str =
        "A quarter of a vehicle that brakes: pressure of the brake in, speeds, brake torque and slip out";
    const DOCUMENTATION: &'static [&'static str] = &[
        "<h2>Start</h2><p>It starts rolling freely at <code>start_speed</code>, whatever the pressure.</p>",
    ];
    fn variables() -> Table<Self> {
        Table::new([
            parameter("mass", "kg", real!(corner.mass), 400.0, "Mass that the wheel brakes (placeholder)")
                .range(50.0, 5000.0)
                .tunable(),
            parameter(
                "brake_factor",
                "m3",
                real!(corner.brake_factor),
                2.4e-4,
                "Brake torque over pressure: pad friction times piston area times radius (placeholder)",
            )
            .range(1e-5, 1e-2)
            .nominal(1e-4)
            .tunable(),
            parameter(
                "friction",
                "1",
                real!(corner.tire.friction),
                1.1,
                "Largest tire force over load (placeholder)",
            )
            .range(0.1, 3.0)
            .tunable(),
            parameter(
                "slip_stiffness",
                "1",
                real!(corner.tire.slip_stiffness),
                18.0,
                "Tire force over load and slip, at small slip (placeholder)",
            )
            .range(1.0, 100.0)
            .tunable(),
            parameter(
                "shape",
                "1",
                real!(corner.tire.shape),
                1.4,
                "Shape factor C of the tire: the larger, the steeper the fall beyond the peak (placeholder)",
            )
            .range(1.05, 1.95)
            .tunable(),
            parameter(
                "radius",
                "m",
                real!(corner.radius),
                0.32,
                "Rolling radius, and lever of the tire force (placeholder)",
            )
            .range(0.1, 1.0)
            .tunable(),
            parameter(
                "spin_inertia",
                "kg.m2",
                real!(corner.spin_inertia),
                1.3,
                "Moment of inertia about the wheel's axis (placeholder)",
            )
            .range(0.1, 20.0)
            .tunable(),
            parameter(
                "slip_relaxation_length",
                "m",
                real!(corner.slip_relaxation),
                0.2,
                "Relaxation length of the slip (placeholder)",
            )
            .range(0.02, 2.0)
            .tunable(),
            input(
                "line_pressure",
                "Pa",
                real!(corner.inputs.pressure),
                0.0,
                "Pressure in the brake; below 0 counts as 0",
            )
            .range(-1e8, 1e8),
            input("load", "N", real!(corner.inputs.load), 4000.0, "Wheel load; below 0 counts as 0")
                .range(-1e5, 1e5),
            input(
                "start_speed",
                "m/s",
                real!(corner.start_speed),
                30.0,
                "Speed at the start; without effect later",
            )
            .range(0.0, 150.0),
            output("vehicle_speed", "m/s", real!(corner.state[0]), "Speed of the vehicle").nominal(20.0),
            output("wheel_speed", "rad/s", real!(corner.state[1]), "Speed of rotation of the wheel")
                .nominal(60.0),
            output(
                "pressure",
                "Pa",
                Access::computed(|m: &Self| m.corner.inputs.pressure.max(0.0)),
                "Pressure at the pads",
            )
            .nominal(1e6),
            output(
                "brake_torque",
                "N.m",
                Access::computed(|m: &Self| m.corner.torque(m.corner.inputs.pressure)),
                "Torque of the brake against the rotation",
            )
            .nominal(500.0),
            output(
                "slip",
                "1",
                Access::computed(|m: &Self| m.corner.slip()),
                "Brake slip 1 - omega R / v, positive when braking",
            )
            .nominal(0.05),
        ])
    }

    fn step_size(&self) -> f64 {
        1e-3
    }

    fn initialize(&mut self) -> Result<()> {
        self.corner.start(0.0);
        Ok(())
    }

    fn step(&mut self, h: f64) -> Result<()> {
        self.corner.step(h, |_, _| None);
        Ok(())
    }
}

/// The same with an anti-lock controller between driver and brake.
#[derive(Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct AbsBrake {
    corner: Corner,
    build_rate: f64,
    dump_rate: f64,
    slip_target: f64,
    slip_width: f64,
    controller_radius: f64,
}

impl AbsBrake {
    fn pressure_rate(&self, driver: f64, x: &[f64; 4]) -> f64 {
        let [v, omega, _, pressure] = *x;
        let seen = 1.0 - omega * self.controller_radius / v.max(SLOW);
        let wish = ((self.slip_target - seen) / self.slip_width).clamp(-1.0, 1.0);
        let rate = if wish > 0.0 { self.build_rate } else { self.dump_rate };
        (rate * wish).max(-pressure / VALVE_LAG).min((driver.max(0.0) - pressure) / VALVE_LAG)
    }
}

impl Model for AbsBrake {
    const NAME: &'static str = "abs-brake";
    const DESCRIPTION: &'static str = "A quarter of a vehicle that brakes with an anti-lock controller inside: the driver's pressure in, speeds, pressure, brake torque and slip out";
    const DOCUMENTATION: &'static [&'static str] = &[
        "<h2>Start</h2><p>It starts rolling freely at <code>start_speed</code>, with the driver's pressure.</p>",
    ];
    fn variables() -> Table<Self> {
        Table::new([
            parameter("mass", "kg", real!(corner.mass), 400.0, "Mass that the wheel brakes (placeholder)")
                .range(50.0, 5000.0)
                .tunable(),
            parameter(
                "brake_factor",
                "m3",
                real!(corner.brake_factor),
                2.4e-4,
                "Brake torque over pressure: pad friction times piston area times radius (placeholder)",
            )
            .range(1e-5, 1e-2)
            .nominal(1e-4)
            .tunable(),
            parameter(
                "friction",
                "1",
                real!(corner.tire.friction),
                1.1,
                "Largest tire force over load (placeholder)",
            )
            .range(0.1, 3.0)
            .tunable(),
            parameter(
                "slip_stiffness",
                "1",
                real!(corner.tire.slip_stiffness),
                18.0,
                "Tire force over load and slip, at small slip (placeholder)",
            )
            .range(1.0, 100.0)
            .tunable(),
            parameter(
                "shape",
                "1",
                real!(corner.tire.shape),
                1.3,
                "Shape factor C of the tire: the larger, the steeper the fall beyond the peak (placeholder)",
            )
            .range(1.05, 1.95)
            .tunable(),
            parameter(
                "radius",
                "m",
                real!(corner.radius),
                0.32,
                "Rolling radius, and lever of the tire force (placeholder)",
            )
            .range(0.1, 1.0)
            .tunable(),
            parameter(
                "spin_inertia",
                "kg.m2",
                real!(corner.spin_inertia),
                1.3,
                "Moment of inertia about the wheel's axis (placeholder)",
            )
            .range(0.1, 20.0)
            .tunable(),
            parameter(
                "slip_relaxation_length",
                "m",
                real!(corner.slip_relaxation),
                0.2,
                "Relaxation length of the slip (placeholder)",
            )
            .range(0.02, 2.0)
            .tunable(),
            parameter(
                "build_rate",
                "Pa/s",
                real!(build_rate),
                6e7,
                "Rise of the pressure at full opening (placeholder)",
            )
            .range(1e5, 1e10)
            .nominal(1e7)
            .tunable(),
            parameter(
                "dump_rate",
                "Pa/s",
                real!(dump_rate),
                9e7,
                "Fall of the pressure at full opening (placeholder)",
            )
            .range(1e5, 1e10)
            .nominal(1e7)
            .tunable(),
            parameter(
                "slip_target",
                "1",
                real!(slip_target),
                0.1,
                "Slip at which the controller holds the pressure (placeholder)",
            )
            .range(0.01, 0.9)
            .tunable(),
            parameter(
                "slip_width",
                "1",
                real!(slip_width),
                0.05,
                "Difference of slip that opens a valve fully (placeholder)",
            )
            .range(0.005, 1.0)
            .tunable(),
            parameter(
                "controller_radius",
                "m",
                real!(controller_radius),
                0.32,
                "Rolling radius that the controller takes for true (placeholder)",
            )
            .range(0.1, 1.0)
            .tunable(),
            input(
                "driver_pressure",
                "Pa",
                real!(corner.inputs.pressure),
                0.0,
                "Pressure that the driver gives; below 0 counts as 0",
            )
            .range(-1e8, 1e8),
            input("load", "N", real!(corner.inputs.load), 4000.0, "Wheel load; below 0 counts as 0")
                .range(-1e5, 1e5),
            input(
                "start_speed",
                "m/s",
                real!(corner.start_speed),
                30.0,
                "Speed at the start; without effect later",
            )
            .range(0.0, 150.0),
            output("vehicle_speed", "m/s", real!(corner.state[0]), "Speed of the vehicle").nominal(20.0),
            output("wheel_speed", "rad/s", real!(corner.state[1]), "Speed of rotation of the wheel")
                .nominal(60.0),
            output(
                "pressure",
                "Pa",
                Access::computed(|m: &Self| m.corner.state[3].max(0.0)),
                "Pressure at the pads",
            )
            .nominal(1e6),
            output(
                "brake_torque",
                "N.m",
                Access::computed(|m: &Self| m.corner.torque(m.corner.state[3])),
                "Torque of the brake against the rotation",
            )
            .nominal(500.0),
            output(
                "slip",
                "1",
                Access::computed(|m: &Self| m.corner.slip()),
                "Brake slip 1 - omega R / v, positive when braking",
            )
            .nominal(0.05),
        ])
    }

    fn step_size(&self) -> f64 {
        1e-3
    }

    fn initialize(&mut self) -> Result<()> {
        self.corner.start(self.corner.inputs.pressure.max(0.0));
        Ok(())
    }

    fn step(&mut self, h: f64) -> Result<()> {
        let mut corner = std::mem::take(&mut self.corner);
        corner.step(h, |driver, x| Some(self.pressure_rate(driver, x)));
        self.corner = corner;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rk4::tests::{close, get, set, started};
    use latsch::model::Slave;

    #[test]
    fn a_steady_brake_decelerates_by_torque_over_radius() {
        let mut slave = started::<BrakeCorner>(&[("start_speed", 35.0)]);
        set(&mut slave, &[("line_pressure", 2e6)]);
        slave.step(0.0, 1.0).unwrap();
        let (v, omega) = (get(&mut slave, "vehicle_speed"), get(&mut slave, "wheel_speed"));
        slave.step(1.0, 0.5).unwrap();
        let (dv, dw) = (get(&mut slave, "vehicle_speed") - v, get(&mut slave, "wheel_speed") - omega);
        close(get(&mut slave, "brake_torque"), 480.0, 1e-9);
        // the tire's impulse brakes the vehicle and turns the wheel
        close(1.3 * dw + 480.0 * 0.5, -0.32 * 400.0 * dv, 1e-6);
    }

    #[test]
    fn the_controller_keeps_a_wheel_from_locking_that_locks_without() {
        let mut with = started::<AbsBrake>(&[("shape", 1.6)]);
        let mut without = started::<BrakeCorner>(&[("shape", 1.6)]);
        set(&mut with, &[("driver_pressure", 1e7)]);
        set(&mut without, &[("line_pressure", 1e7)]);
        let mut least: f64 = f64::INFINITY;
        for k in 0..150_i32 {
            let t = f64::from(k) * 0.01;
            with.step(t, 0.01).unwrap();
            without.step(t, 0.01).unwrap();
            least = least.min(get(&mut with, "wheel_speed"));
        }
        assert!(get(&mut without, "slip") > 0.9);
        assert!(least > 20.0, "{least}");
        assert!(get(&mut with, "vehicle_speed") < get(&mut without, "vehicle_speed"));
        close(get(&mut with, "slip"), 0.1, 0.08);
        assert!(get(&mut with, "pressure") < 1e7);
    }
}
