//! A body that moves without turning.

use super::verlet::{drift, kick};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Place, velocity and acceleration of a body that does not turn, frame 0.
///
/// It may have another mass in each direction: a vehicle of which one corner is modelled travels along x as a whole,
/// but only the part over this wheel moves along z.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct PointMass {
    /// Place \[m\].
    pub position: Vector3<f64>,
    /// Velocity \[m/s\].
    pub velocity: Vector3<f64>,
    /// Acceleration at the last instant \[m/s²\].
    pub acceleration: Vector3<f64>,
}

impl PointMass {
    /// First half of a step: half a kick, drift. Returns the velocity predicted for the end.
    pub fn drift(&mut self, dt: f64) -> Vector3<f64> {
        let step = drift(self.velocity, self.acceleration, dt);
        self.velocity = step.velocity;
        self.position += step.travel;
        step.predicted
    }

    /// Second half: the kick with the acceleration of the end of the step.
    pub fn kick(&mut self, dt: f64) {
        self.velocity = kick(self.velocity, self.acceleration, dt);
    }

    /// Energy of the motion \[J\] with a mass \[kg\] in each direction.
    pub fn kinetic_energy(&self, mass: &Vector3<f64>) -> f64 {
        0.5 * mass.dot(&self.velocity.component_mul(&self.velocity))
    }

    /// True if nothing of it has left the numbers.
    pub fn is_finite(&self) -> bool {
        self.position.iter().chain(&self.velocity).all(|x| x.is_finite())
    }
}
