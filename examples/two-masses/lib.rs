//! A mass between a wall and another mass: one half of a coupled pair of oscillators, as an FMU.

use latsch::model::{Model, Table, input, output, parameter};
use latsch::{Result, real};
use serde::{Deserialize, Serialize};

/// m x'' = -k x - d x' + F - R, where R = k_c (x - x_o) is the force on the other mass.
#[derive(Clone, Default, PartialEq, Serialize, Deserialize)]
struct Oscillator {
    mass: f64,
    stiffness: f64,
    damping: f64,
    coupling_stiffness: f64,
    start_position: f64,
    force: f64,
    other_position: f64,
    position: f64,
    velocity: f64,
    reaction: f64,
}

impl Oscillator {
    fn between(&self, x: f64) -> f64 {
        self.coupling_stiffness * (x - self.other_position)
    }

    fn acceleration(&self, x: f64, v: f64) -> f64 {
        (self.force - self.stiffness * x - self.damping * v - self.between(x)) / self.mass
    }
}

impl Model for Oscillator {
    const NAME: &'static str = "coupled-oscillator";
    const DESCRIPTION: &'static str = "A mass between a wall and another mass";
    fn variables() -> Table<Self> {
        Table::new([
            parameter("mass", "kg", real!(mass), 1.0, "Mass").range(1e-3, 1e3),
            parameter("stiffness", "N/m", real!(stiffness), 100.0, "Stiffness to the wall").min(0.0),
            parameter("damping", "N.s/m", real!(damping), 0.0, "Damping to the wall").min(0.0),
            parameter("coupling_stiffness", "N/m", real!(coupling_stiffness), 0.0, "Stiffness to the other mass").min(0.0),
            parameter("start_position", "m", real!(start_position), 0.0, "Position at the start, at rest"),
            input("force", "N", real!(force), 0.0, "Force from outside"),
            input("other_position", "m", real!(other_position), 0.0, "Position of the other mass"),
            output("position", "m", real!(position), "Position of the mass"),
            output("velocity", "m/s", real!(velocity), "Velocity of the mass"),
            output("reaction", "N", real!(reaction), "Force on the other mass"),
        ])
    }

    fn step_size(&self) -> f64 {
        1e-4
    }

    fn initialize(&mut self) -> Result<()> {
        (self.position, self.velocity) = (self.start_position, 0.0);
        self.reaction = self.between(self.position);
        Ok(())
    }

    fn step(&mut self, h: f64) -> Result<()> {
        // classical Runge-Kutta; inputs are held
        let (x, v) = (self.position, self.velocity);
        let a1 = self.acceleration(x, v);
        let (v2, a2) = (v + 0.5 * h * a1, self.acceleration(x + 0.5 * h * v, v + 0.5 * h * a1));
        let (v3, a3) = (v + 0.5 * h * a2, self.acceleration(x + 0.5 * h * v2, v + 0.5 * h * a2));
        let (v4, a4) = (v + h * a3, self.acceleration(x + h * v3, v + h * a3));
        self.position += h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
        self.velocity += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
        self.reaction = self.between(self.position);
        Ok(())
    }
}

latsch::export_fmus!(Oscillator);
