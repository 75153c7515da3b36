//! A wheel's hub: mass, spin and a brake, in velocity Verlet steps that go with the tire's.

use crate::tire::Motion;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// What a hub is made of. The belt of the tire has its own mass and is no part of it.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct HubParameters {
    /// Mass of rim, hub and what moves with them \[kg\].
    pub mass: f64,
    /// Inertia of what spins about the wheel's axis \[kg.m²\].
    pub inertia: f64,
    /// Gravity \[m/s²\].
    pub gravity: f64,
}

/// The motion of a hub and what accelerates it.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Hub {
    /// Centre of the wheel over the road, frame 0 \[m\].
    pub position: Vector3<f64>,
    /// Its velocity \[m/s\].
    pub velocity: Vector3<f64>,
    /// Spin angle \[rad\], unbounded.
    pub angle: f64,
    /// Spin speed \[rad/s\].
    pub speed: f64,
    /// Acceleration of the centre at the last instant \[m/s²\].
    pub acceleration: Vector3<f64>,
    /// Angular acceleration without the brake's share \[rad/s²\].
    pub free_acceleration: f64,
    /// The torque with which the brake resisted the spin in the last step \[N.m\]: less than it could
    /// where the wheel stands.
    pub brake_torque: f64,
    /// Energy that the brake took since the start \[J\].
    pub brake_energy: f64,
}

impl Hub {
    /// First half of a step: half a kick, drift. Returns velocity and spin speed as predicted for the
    /// end of the step, for whatever damps.
    pub fn drift(&mut self, p: &HubParameters, brake: f64, dt: f64) -> (Vector3<f64>, f64) {
        let half = 0.5 * dt;
        self.velocity += self.acceleration * half;
        self.brake_torque = 0.0;
        self.spin_up(p, brake, half, dt);
        self.position += self.velocity * dt;
        self.angle += self.speed * dt;
        let speed = braked(self.speed + self.free_acceleration * half, brake * half / p.inertia);
        (self.velocity + self.acceleration * half, speed)
    }

    /// Second half: the kick by what [`load`](Self::load) was told about the end of the step.
    pub fn kick(&mut self, p: &HubParameters, brake: f64, dt: f64) {
        self.velocity += self.acceleration * (0.5 * dt);
        self.spin_up(p, brake, 0.5 * dt, dt);
    }

    /// Takes over the force \[N\] and the torque about the wheel's axis \[N.m\] of the present instant,
    /// without gravity and brake.
    pub fn load(&mut self, p: &HubParameters, force: &Vector3<f64>, torque: f64) {
        self.acceleration = force / p.mass - Vector3::new(0.0, 0.0, p.gravity);
        self.free_acceleration = torque / p.inertia;
    }

    /// Half a kick of the spin, with the brake's friction: it takes speed away, but never turns it
    /// round.
    fn spin_up(&mut self, p: &HubParameters, brake: f64, half: f64, dt: f64) {
        let before = self.speed;
        let free = before + self.free_acceleration * half;
        self.speed = braked(free, brake * half / p.inertia);
        let taken = (free - self.speed) * p.inertia;
        self.brake_torque += taken / dt;
        // over the half kick the impulse acts at the mean of the speeds before and after; where the rest turns the
        // spin round, friction is taken off behind the turn, and acts from there
        let from = if before * free < 0.0 { 0.0 } else { before };
        self.brake_energy += taken * 0.5 * (from + self.speed);
    }

    /// The rim's motion as the tire sees it, at attitude (camber, steer) and its rates.
    pub fn rim(
        &self,
        velocity: &Vector3<f64>,
        speed: f64,
        (camber, steer): (f64, f64),
        (camber_rate, steer_rate): (f64, f64),
    ) -> Motion<f64> {
        Motion {
            position: Vector3::new(0.0, 0.0, self.position.z),
            velocity: *velocity,
            angles: Vector3::new(camber, self.angle, steer),
            rates: Vector3::new(camber_rate, speed, steer_rate),
        }
    }
}

/// The speed that is left when friction has taken `limit` from it.
fn braked(speed: f64, limit: f64) -> f64 {
    if speed.abs() <= limit { 0.0 } else { speed - limit.copysign(speed) }
}

/// Longitudinal slip of a wheel: rolling radius times spin speed, less the speed in the wheel's
/// heading, over the magnitude of that. So a positive slip makes a positive force, whichever way the
/// wheel travels, and nothing jumps where it turns round; a locked wheel is -1 forward, +1 in reverse.
/// Below `floor` \[m/s\] the divisor is kept at `floor`.
pub fn slip(rolling_speed: f64, speed: f64, floor: f64) -> f64 {
    (rolling_speed - speed) / speed.abs().max(floor)
}

/// Slip angle of ISO 8855 \[rad\] for the velocity in the wheel's heading and to its left: positive when
/// the wheel travels to its left, forward or in reverse, which makes a negative lateral force. 0 below
/// `floor` \[m/s\], where a direction of travel means nothing.
pub fn slip_angle(ahead: f64, left: f64, floor: f64) -> f64 {
    if libm::hypot(ahead, left) < floor { 0.0 } else { libm::atan2(left, ahead.abs()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: HubParameters = HubParameters { mass: 20.0, inertia: 1.2, gravity: 9.81 };

    fn run(hub: &mut Hub, torque: f64, brake: f64, dt: f64, steps: usize) {
        hub.load(&P, &Vector3::zeros(), torque);
        for _ in 0..steps {
            hub.drift(&P, brake, dt);
            hub.kick(&P, brake, dt);
        }
    }

    #[test]
    fn a_brake_stops_the_spin_and_takes_just_its_energy() {
        let mut hub = Hub { speed: 60.0, ..Hub::default() };
        run(&mut hub, 0.0, 240.0, 1e-3, 200);
        // 240 / 1.2 = 200 rad/s²: 0.1 s short of the whole
        assert!((hub.speed - 20.0).abs() < 1e-9);
        assert!((hub.brake_energy - 0.5 * 1.2 * (60.0_f64.powi(2) - 20.0_f64.powi(2))).abs() < 1e-6);
        run(&mut hub, 0.0, 240.0, 1e-3, 200);
        assert_eq!(hub.speed, 0.0);
        assert!((hub.brake_energy - 0.5 * 1.2 * 3600.0).abs() < 1e-6);
        assert_eq!(hub.brake_torque, 0.0);
    }

    #[test]
    fn a_standing_wheel_holds_up_to_the_brakes_torque_and_breaks_away_beyond() {
        for torque in [-90.0, 90.0] {
            let mut hub = Hub::default();
            run(&mut hub, torque, 100.0, 1e-3, 100);
            assert_eq!((hub.speed, hub.angle), (0.0, 0.0));
            assert!((hub.brake_torque - torque).abs() < 1e-9, "it resists with what is there");
            run(&mut hub, torque, 80.0, 1e-3, 100);
            assert!((hub.speed - torque.signum() * 10.0 / 1.2 * 0.1).abs() < 1e-9);
        }
    }

    #[test]
    fn whatever_turns_the_wheel_the_brake_takes_energy_and_gives_none() {
        // a linear congruential generator: speeds, torques and brakes of all sizes and both signs
        let mut seed = 1_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        let mut turned = 0;
        for _ in 0..10_000 {
            let mut hub = Hub { speed: random().powi(3), ..Hub::default() };
            let brake = 500.0 * random().abs();
            for _ in 0..5 {
                let (speed, energy) = (hub.speed, hub.brake_energy);
                run(&mut hub, 2000.0 * random().powi(3), brake, 1e-3, 1);
                turned += usize::from(speed * hub.speed < 0.0);
                assert!(
                    hub.brake_energy >= energy,
                    "{speed} to {} rad/s: {} J",
                    hub.speed,
                    hub.brake_energy - energy
                );
            }
        }
        assert!(turned > 1000, "{turned}");
    }

    #[test]
    fn a_free_hub_falls_and_slip_has_its_ends() {
        let mut hub = Hub::default();
        run(&mut hub, 0.0, 0.0, 1e-3, 1000);
        assert!((hub.position.z + 0.5 * 9.81).abs() < 1e-9 && (hub.velocity.z + 9.81).abs() < 1e-9);
        assert_eq!(slip(0.0, 20.0, 0.1), -1.0);
        assert_eq!(slip(0.0, -20.0, 0.1), 1.0);
        assert_eq!(slip(-22.0, -20.0, 0.1), -0.1);
        assert_eq!(slip(20.0, 20.0, 0.1), 0.0);
        assert_eq!(slip(0.0, 0.0, 0.1), 0.0);
    }
}
