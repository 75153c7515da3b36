//! `oscillator`: m x'' = F - c x' - k x.

use crate::rk4::{between, rk4};
use latsch::model::{Access, Model, Table, input, output, parameter};
use latsch::{Result, real};
use serde::{Deserialize, Serialize};

/// Parameters, input, where the input was one step before, states.
#[derive(Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Oscillator {
    mass: f64,
    stiffness: f64,
    damping: f64,
    force: f64,
    last_force: f64,
    position: f64,
    velocity: f64,
}

impl Oscillator {
    fn acceleration(&self, force: f64, x: f64, v: f64) -> f64 {
        (force - self.stiffness * x - self.damping * v) / self.mass
    }
}

impl Model for Oscillator {
    const NAME: &'static str = "oscillator";
    const DESCRIPTION: &'static str = "A mass on a linear spring and damper, moved by a force";
    const DOCUMENTATION: &'static [&'static str] = &[
        "<h2>Equation</h2><p>m x&#8243; = F &minus; c x&#8242; &minus; k x; it starts at rest, where the spring carries the force.</p>",
    ];
    fn variables() -> Table<Self> {
        Table::new([
            parameter("mass", "kg", real!(mass), 10.0, "Mass (placeholder)").range(1e-9, 1e9).tunable(),
            parameter("stiffness", "N/m", real!(stiffness), 4000.0, "Stiffness of the spring (placeholder)")
                .range(1e-6, 1e12)
                .tunable(),
            parameter("damping", "N.s/m", real!(damping), 80.0, "Damping (placeholder)")
                .range(0.0, 1e12)
                .tunable(),
            input("force", "N", real!(force), 0.0, "Force on the mass").range(-1e12, 1e12),
            output("position", "m", real!(position), "Position of the mass").nominal(0.01),
            output("velocity", "m/s", real!(velocity), "Velocity of the mass").nominal(0.2),
            output(
                "acceleration",
                "m/s2",
                Access::computed(|m: &Self| m.acceleration(m.force, m.position, m.velocity)),
                "Acceleration of the mass",
            )
            .nominal(5.0),
        ])
    }

    fn step_size(&self) -> f64 {
        1e-3
    }

    fn initialize(&mut self) -> Result<()> {
        self.last_force = self.force;
        (self.position, self.velocity) = (self.force / self.stiffness, 0.0);
        Ok(())
    }

    fn step(&mut self, h: f64) -> Result<()> {
        let force = |at| between(self.last_force, self.force, at);
        let slope = |at: f64, x: &[f64; 2]| [x[1], self.acceleration(force(at), x[0], x[1])];
        [self.position, self.velocity] = rk4([self.position, self.velocity], h, slope);
        self.last_force = self.force;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rk4::tests::{close, get, rate, set, started};
    use latsch::model::Slave;

    #[test]
    fn rings_as_the_closed_form_says() {
        let mut slave = started::<Oscillator>(&[("force", 80.0)]);
        close(get(&mut slave, "position"), 0.02, 1e-15);
        // the force goes within the first step; after that a free, damped oscillation
        set(&mut slave, &[("force", 0.0)]);
        slave.step(0.0, 1e-3).unwrap();
        let (x0, v0) = (get(&mut slave, "position"), get(&mut slave, "velocity"));
        slave.step(1e-3, 1.5).unwrap();
        let (decay, natural) = (80.0 / 20.0, 400.0_f64);
        let omega = (natural - decay * decay).sqrt();
        let wave = x0 * (omega * 1.5).cos() + (v0 + decay * x0) / omega * (omega * 1.5).sin();
        close(get(&mut slave, "position"), (-decay * 1.5_f64).exp() * wave, 1e-9);
    }

    #[test]
    fn follows_a_ramp_of_the_force_without_a_lag_of_its_own() {
        // F = r t: x = r (t - c/k) / k after the transient
        let mut slave = started::<Oscillator>(&[("damping", 400.0)]);
        rate(&mut slave, "force", 50.0);
        slave.step(0.0, 3.0).unwrap();
        close(get(&mut slave, "position"), 50.0 / 4000.0 * (3.0 - 400.0 / 4000.0), 1e-12);
        close(get(&mut slave, "velocity"), 50.0 / 4000.0, 1e-12);
        close(get(&mut slave, "acceleration"), 0.0, 1e-9);
    }
}
