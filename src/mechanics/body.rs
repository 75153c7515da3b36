//! A rigid body on its way.

use super::motion::{Motion, Wrench};
use super::pose::Pose;
use super::rigid::RigidBody;
use super::verlet::{drift, kick};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Motion of a rigid body and what accelerates it, for velocity Verlet steps.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Body {
    /// Pose and velocities.
    pub motion: Motion<f64>,
    /// Acceleration of the centre at the last instant \[m/s²\].
    pub acceleration: Vector3<f64>,
    /// That of the Cardan angles \[rad/s²\].
    pub turning: Vector3<f64>,
}

impl Body {
    /// A body that moves so, and nothing accelerates.
    pub fn moving(motion: Motion<f64>) -> Self {
        Self { motion, ..Self::default() }
    }

    /// First half of a step: half a kick, drift. Returns the motion at the end with the velocities predicted for it.
    pub fn drift(&mut self, dt: f64) -> Motion<f64> {
        let motion = &mut self.motion;
        let step = drift(motion.velocity, self.acceleration, dt);
        motion.velocity = step.velocity;
        motion.position += step.travel;
        let turn = drift(motion.rates, self.turning, dt);
        motion.rates = turn.velocity;
        motion.angles += turn.travel;
        Motion { velocity: step.predicted, rates: turn.predicted, ..*motion }
    }

    /// Takes over what the loads \[N, N.m\] about the centre make of a body that is posed so.
    pub fn load(&mut self, body: &RigidBody, pose: &Pose, loads: &Wrench<f64>, gravity: f64) {
        (self.acceleration, self.turning) = body.acceleration_at(&pose.attitude, &pose.rates, loads, gravity);
    }

    /// Second half: the kick with the accelerations of the end of the step.
    pub fn kick(&mut self, dt: f64) {
        self.motion.velocity = kick(self.motion.velocity, self.acceleration, dt);
        self.motion.rates = kick(self.motion.rates, self.turning, dt);
    }

    /// True if nothing of it has left the numbers.
    pub fn is_finite(&self) -> bool {
        let m = &self.motion;
        [&m.position, &m.velocity, &m.angles, &m.rates].into_iter().flatten().all(|x| x.is_finite())
    }
}
