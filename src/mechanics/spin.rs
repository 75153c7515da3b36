//! A wheel's turning about its axis, with a brake.

use serde::{Deserialize, Serialize};

/// Angle and speed of what turns about a wheel's axis, and the friction of a brake on it.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Spin {
    /// Angle \[rad\], unbounded.
    pub angle: f64,
    /// Speed \[rad/s\].
    pub speed: f64,
    /// Acceleration at the last instant without the brake's share \[rad/s²\].
    pub free_acceleration: f64,
    /// The torque with which the brake resisted the spin in the last step \[N.m\]: less than it could
    /// where the wheel stands.
    pub brake_torque: f64,
    /// Energy that the brake took since the start \[J\].
    pub brake_energy: f64,
}

impl Spin {
    /// First half of a step with a brake that can resist with the torque `brake` \[N.m\]. Returns the speed
    /// predicted for the end of the step.
    pub fn drift(&mut self, inertia: f64, brake: f64, dt: f64) -> f64 {
        let half = 0.5 * dt;
        self.brake_torque = 0.0;
        self.spin_up(inertia, brake, half, dt);
        self.angle += self.speed * dt;
        braked(self.speed + self.free_acceleration * half, brake * half / inertia)
    }

    /// Second half: the kick by the acceleration of the end of the step.
    pub fn kick(&mut self, inertia: f64, brake: f64, dt: f64) {
        self.spin_up(inertia, brake, 0.5 * dt, dt);
    }

    /// Half a kick, with the brake's friction: it takes speed away, but never turns it round.
    fn spin_up(&mut self, inertia: f64, brake: f64, half: f64, dt: f64) {
        let before = self.speed;
        let free = before + self.free_acceleration * half;
        self.speed = braked(free, brake * half / inertia);
        let taken = (free - self.speed) * inertia;
        self.brake_torque += taken / dt;
        // over the half kick the impulse acts at the mean of the speeds before and after; where the rest turns the
        // spin round, friction is taken off behind the turn, and acts from there
        let from = if before * free < 0.0 { 0.0 } else { before };
        self.brake_energy += taken * 0.5 * (from + self.speed);
    }

    /// Energy of the turning \[J\].
    pub fn kinetic_energy(&self, inertia: f64) -> f64 {
        0.5 * inertia * self.speed * self.speed
    }
}

/// The speed that is left when friction has taken `limit` from it.
fn braked(speed: f64, limit: f64) -> f64 {
    if speed.abs() <= limit { 0.0 } else { speed - limit.copysign(speed) }
}
