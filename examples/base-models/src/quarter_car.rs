//! `quarter-car`: two masses over a road, about their position at rest.
//!
//! m_b z_b'' = -F_s + F_b,  m_w z_w'' = F_s + k_t (z_r - z_w),  F_s = k (z_b - z_w) + c (z_b' - z_w') - F_d,
//! and the wheel load (m_b + m_w) g + k_t (z_r - z_w).

use crate::rk4::{between, rk4};
use latsch::model::{Access, Model, Table, input, output, parameter};
use latsch::{Result, real};
use serde::{Deserialize, Serialize};

const GRAVITY: f64 = 9.81;

/// Parameters, inputs, where the inputs were one step before, states (z_b, z_w, z_b', z_w').
#[derive(Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct QuarterCar {
    body_mass: f64,
    wheel_mass: f64,
    suspension_stiffness: f64,
    suspension_damping: f64,
    tire_stiffness: f64,
    inputs: Inputs,
    last: Inputs,
    state: [f64; 4],
}

#[derive(Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
struct Inputs {
    road_height: f64,
    body_force: f64,
    suspension_force: f64,
}

impl QuarterCar {
    fn slope(&self, u: &Inputs, [body, wheel, body_rate, wheel_rate]: &[f64; 4]) -> [f64; 4] {
        let strut = self.suspension_stiffness * (body - wheel)
            + self.suspension_damping * (body_rate - wheel_rate)
            - u.suspension_force;
        let tire = self.tire_stiffness * (u.road_height - wheel);
        let body_acceleration = (u.body_force - strut) / self.body_mass;
        [*body_rate, *wheel_rate, body_acceleration, (strut + tire) / self.wheel_mass]
    }

    fn acceleration(&self, of: usize) -> f64 {
        self.slope(&self.inputs, &self.state)[of]
    }

    fn wheel_load(&self) -> f64 {
        (self.body_mass + self.wheel_mass) * GRAVITY
            + self.tire_stiffness * (self.inputs.road_height - self.state[1])
    }
}

impl Model for QuarterCar {
    const NAME: &'static str = "quarter-car";
    const DESCRIPTION: &'static str =
        "Two masses over a road: body, suspension, wheel and tire of one corner, linear";
    const DOCUMENTATION: &'static [&'static str] = &[
        "<h2>Axes</h2><p>Everything points upwards and counts from the position at rest. The wheel load contains the weight; the tire pulls if the road falls away fast enough.</p>",
    ];
    fn variables() -> Table<Self> {
        Table::new([
            parameter("body_mass", "kg", real!(body_mass), 350.0, "Sprung mass (placeholder)")
                .range(50.0, 3000.0)
                .tunable(),
            parameter("wheel_mass", "kg", real!(wheel_mass), 45.0, "Unsprung mass (placeholder)")
                .range(5.0, 300.0)
                .tunable(),
            parameter(
                "suspension_stiffness",
                "N/m",
                real!(suspension_stiffness),
                25e3,
                "Stiffness of the suspension at the wheel (placeholder)",
            )
            .range(1e3, 3e5)
            .tunable(),
            parameter(
                "suspension_damping",
                "N.s/m",
                real!(suspension_damping),
                1800.0,
                "Damping of the suspension at the wheel (placeholder)",
            )
            .range(0.0, 3e4)
            .tunable(),
            parameter(
                "tire_stiffness",
                "N/m",
                real!(tire_stiffness),
                2e5,
                "Radial stiffness of the tire (placeholder)",
            )
            .range(1e4, 2e6)
            .tunable(),
            input("road_height", "m", real!(inputs.road_height), 0.0, "Height of the road under the wheel")
                .range(-10.0, 10.0),
            input("body_force", "N", real!(inputs.body_force), 0.0, "Force on the body").range(-1e6, 1e6),
            input(
                "suspension_force",
                "N",
                real!(inputs.suspension_force),
                0.0,
                "Force beside spring and damper that pushes body and wheel apart",
            )
            .range(-1e6, 1e6),
            output(
                "body_acceleration",
                "m/s2",
                Access::computed(|m: &Self| m.acceleration(2)),
                "Acceleration of the body",
            )
            .nominal(2.0),
            output(
                "wheel_acceleration",
                "m/s2",
                Access::computed(|m: &Self| m.acceleration(3)),
                "Acceleration of the wheel",
            )
            .nominal(20.0),
            output(
                "suspension_deflection",
                "m",
                Access::computed(|m: &Self| m.state[0] - m.state[1]),
                "Body minus wheel: positive in rebound",
            )
            .nominal(0.02),
            output(
                "suspension_velocity",
                "m/s",
                Access::computed(|m: &Self| m.state[2] - m.state[3]),
                "Its rate",
            )
            .nominal(0.3),
            output("wheel_load", "N", Access::computed(Self::wheel_load), "Force of the road on the tire")
                .nominal(4000.0),
        ])
    }

    fn step_size(&self) -> f64 {
        1e-3
    }

    fn initialize(&mut self) -> Result<()> {
        let u = self.inputs;
        self.last = u;
        let wheel = u.road_height + u.body_force / self.tire_stiffness;
        let body = wheel + (u.body_force + u.suspension_force) / self.suspension_stiffness;
        self.state = [body, wheel, 0.0, 0.0];
        Ok(())
    }

    fn step(&mut self, h: f64) -> Result<()> {
        let inputs = |at| Inputs {
            road_height: between(self.last.road_height, self.inputs.road_height, at),
            body_force: between(self.last.body_force, self.inputs.body_force, at),
            suspension_force: between(self.last.suspension_force, self.inputs.suspension_force, at),
        };
        self.state = rk4(self.state, h, |at, x| self.slope(&inputs(at), x));
        self.last = self.inputs;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rk4::tests::{close, get, rate, set, started};
    use latsch::model::Slave;

    #[test]
    fn rests_where_the_forces_balance() {
        let mut slave = started::<QuarterCar>(&[
            ("road_height", 0.03),
            ("body_force", -500.0),
            ("suspension_force", 250.0),
        ]);
        let weight = 395.0 * 9.81;
        let deflection = -250.0 / 25e3;
        for _ in 0..2 {
            close(get(&mut slave, "suspension_deflection"), deflection, 1e-12);
            close(get(&mut slave, "wheel_load"), weight + 500.0, 1e-8);
            close(get(&mut slave, "wheel_acceleration"), 0.0, 1e-9);
            if slave.time() == 0.0 {
                slave.step(0.0, 0.5).unwrap();
            }
        }
    }

    #[test]
    fn two_free_masses_answer_a_road_ramp_with_the_closed_form() {
        // no suspension: the wheel on the tire follows a ramp with z_w = r (t - sin(w t) / w)
        let mut slave = started::<QuarterCar>(&[
            ("suspension_damping", 0.0),
            ("suspension_stiffness", 1e3),
            ("body_mass", 3000.0),
        ]);
        // the suspension's 1 kN/m instead of nothing moves the wheel by 1e3/2e5 of the way at most
        rate(&mut slave, "road_height", 0.1);
        slave.step(0.0, 0.05).unwrap();
        let omega = (2.01e5_f64 / 45.0).sqrt();
        let expected = 0.1 * (2e5 / 2.01e5) * (0.05 - (omega * 0.05).sin() / omega);
        close(-get(&mut slave, "suspension_deflection"), expected, 3e-6);
    }

    #[test]
    fn momentum_is_the_impulse_of_the_outer_forces() {
        let mut slave = started::<QuarterCar>(&[]);
        let (mut momentum, mut impulse) = (0.0, 0.0);
        let weight = 395.0 * 9.81;
        for k in 0..2000_i32 {
            let t = f64::from(k) * 1e-3;
            set(
                &mut slave,
                &[("road_height", 0.02 * (9.0 * t).sin()), ("body_force", 300.0 * (31.0 * t).sin())],
            );
            rate(&mut slave, "road_height", 0.18 * (9.0 * t).cos());
            rate(&mut slave, "body_force", 9300.0 * (31.0 * t).cos());
            let outer = get(&mut slave, "wheel_load") - weight + 300.0 * (31.0 * t).sin();
            slave.step(t, 1e-3).unwrap();
            let next = f64::from(k + 1) * 1e-3;
            let after = get(&mut slave, "wheel_load") - weight + 300.0 * (31.0 * next).sin();
            impulse += 0.5e-3 * (outer + after);
            let state = slave.model().state;
            momentum = 350.0 * state[2] + 45.0 * state[3];
        }
        close(momentum, impulse, 0.02);
        assert!(momentum.abs() > 1.0);
    }
}
