//! A wheel's hub: mass, spin and a brake, in velocity Verlet steps that go with the tire's.

use crate::mechanics::{Motion, PointMass, Spin};
use crate::model::{Access, Role, Table, output, parameter};
use crate::tire::Carried;
use crate::{lens, real};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Speed below which slip and slip angle are no longer what their definitions say \[m/s\].
pub(super) const SLIP_FLOOR: f64 = 0.1;

/// What a hub is made of. Masses inside the tire are no part of it.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct HubParameters {
    /// Mass of rim, hub and what moves with them \[kg\].
    pub mass: f64,
    /// Inertia of what spins about the wheel's axis \[kg.m²\].
    pub inertia: f64,
    /// Gravity \[m/s²\].
    pub gravity: f64,
}

impl HubParameters {
    /// Mass and inertia.
    #[rustfmt::skip] // a row is a line
    pub(super) fn rows() -> Table<Self> {
        Table::new([
            parameter("hub_mass", "kg", real!(mass), 30.0, "Mass of hub, rim and what moves with them, without masses inside the tire's model").range(0.1, 1e4),
            parameter("hub_inertia", "kg.m2", real!(inertia), 0.7, "Inertia of what spins with the rim about the wheel's axis, without masses inside the tire's model").range(1e-3, 1e4),
        ])
    }
}

/// The motion of a hub and what accelerates it.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Hub {
    /// Centre of the wheel over the road, frame 0.
    pub centre: PointMass,
    /// The wheel about its axis.
    pub spin: Spin,
    /// Inertia of the tire's masses that it carries \[kg.m²\].
    carried_inertia: f64,
}

/// What a wheel tells of its turning.
#[rustfmt::skip] // a row is a line
pub(super) fn turning_rows() -> Table<Spin> {
    Table::new([
        output("wheel_angle", "rad", Access::real(|s: &Spin| s.angle, |s, angle| s.angle = angle), "Spin angle of the wheel, unbounded").role(Role::WheelAngle),
        output("wheel_speed", "rad/s", Access::real(|s: &Spin| s.speed, |s, speed| s.speed = speed), "Spin speed of the wheel").role(Role::WheelSpeed),
    ])
}

impl Hub {
    /// A hub at the origin that travels and does not spin.
    pub fn moving(velocity: Vector3<f64>) -> Self {
        Self { centre: PointMass { velocity, ..PointMass::default() }, ..Self::default() }
    }

    /// The wheel's spin and its brake.
    #[rustfmt::skip] // a row is a line
    pub(super) fn rows() -> Table<Self> {
        Table::new([]).part("", lens!(spin), turning_rows()).and([
            output("brake_torque_actual", "N.m", real!(spin.brake_torque), "Torque with which the brake resisted the forward spin in the last step; on a wheel that stands, what it takes to hold it").nominal(100.0),
            output("brake_energy", "J", real!(spin.brake_energy), "Energy that the brake turned into heat since the start").nominal(1e4),
        ])
    }

    /// First half of a step: half a kick, drift. Returns velocity and spin speed as predicted for the
    /// end of the step, for whatever damps.
    pub fn drift(&mut self, p: &HubParameters, brake: f64, dt: f64) -> (Vector3<f64>, f64) {
        (self.centre.drift(dt), self.spin.drift(p.inertia + self.carried_inertia, brake, dt))
    }

    /// Second half: the kick by what [`load`](Self::load) was told about the end of the step.
    pub fn kick(&mut self, p: &HubParameters, brake: f64, dt: f64) {
        self.centre.kick(dt);
        self.spin.kick(p.inertia + self.carried_inertia, brake, dt);
    }

    /// Takes over the force \[N\] and the torque about the wheel's axis \[N.m\] of the present instant,
    /// without gravity and brake, and the masses of the tire that the hub carries along.
    pub fn load(&mut self, p: &HubParameters, force: &Vector3<f64>, torque: f64, carried: &Carried) {
        // what their accelerations take is in force and torque already
        let force = force + carried.acceleration * carried.mass;
        let torque = torque + carried.spin_acceleration * carried.inertia;
        let mass = p.mass + carried.mass;
        self.carried_inertia = carried.inertia;
        self.centre.acceleration = force / mass - Vector3::new(0.0, 0.0, p.gravity * (p.mass / mass));
        self.spin.free_acceleration = torque / (p.inertia + carried.inertia);
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
            position: Vector3::new(0.0, 0.0, self.centre.position.z),
            velocity: *velocity,
            angles: Vector3::new(camber, self.spin.angle, steer),
            rates: Vector3::new(camber_rate, speed, steer_rate),
        }
    }

    /// Where the wheel's centre is over the road, x and y \[m\].
    pub fn place(&self) -> [f64; 2] {
        [self.centre.position.x, self.centre.position.y]
    }

    /// Energy of the motion and of the height \[J\].
    pub fn energy(&self, p: &HubParameters) -> f64 {
        self.centre.kinetic_energy(&Vector3::from_element(p.mass))
            + self.spin.kinetic_energy(p.inertia)
            + p.mass * p.gravity * self.centre.position.z
    }

    /// True if nothing of it has left the numbers.
    pub fn is_finite(&self) -> bool {
        self.centre.is_finite() && self.spin.speed.is_finite()
    }
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
        hub.load(&P, &Vector3::zeros(), torque, &Carried::default());
        for _ in 0..steps {
            hub.drift(&P, brake, dt);
            hub.kick(&P, brake, dt);
        }
    }

    #[test]
    fn a_brake_stops_the_spin_and_takes_just_its_energy() {
        let mut hub = Hub { spin: Spin { speed: 60.0, ..Spin::default() }, ..Hub::default() };
        run(&mut hub, 0.0, 240.0, 1e-3, 200);
        // 240 / 1.2 = 200 rad/s²: 0.1 s short of the whole
        assert!((hub.spin.speed - 20.0).abs() < 1e-9);
        assert!((hub.spin.brake_energy - 0.5 * 1.2 * (60.0_f64.powi(2) - 20.0_f64.powi(2))).abs() < 1e-6);
        run(&mut hub, 0.0, 240.0, 1e-3, 200);
        assert_eq!(hub.spin.speed, 0.0);
        assert!((hub.spin.brake_energy - 0.5 * 1.2 * 3600.0).abs() < 1e-6);
        assert_eq!(hub.spin.brake_torque, 0.0);
    }

    #[test]
    fn a_standing_wheel_holds_up_to_the_brakes_torque_and_breaks_away_beyond() {
        for torque in [-90.0, 90.0] {
            let mut hub = Hub::default();
            run(&mut hub, torque, 100.0, 1e-3, 100);
            assert_eq!((hub.spin.speed, hub.spin.angle), (0.0, 0.0));
            assert!((hub.spin.brake_torque - torque).abs() < 1e-9, "it resists with what is there");
            run(&mut hub, torque, 80.0, 1e-3, 100);
            assert!((hub.spin.speed - torque.signum() * 10.0 / 1.2 * 0.1).abs() < 1e-9);
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
            let mut hub = Hub { spin: Spin { speed: random().powi(3), ..Spin::default() }, ..Hub::default() };
            let brake = 500.0 * random().abs();
            for _ in 0..5 {
                let (speed, energy) = (hub.spin.speed, hub.spin.brake_energy);
                run(&mut hub, 2000.0 * random().powi(3), brake, 1e-3, 1);
                turned += usize::from(speed * hub.spin.speed < 0.0);
                assert!(
                    hub.spin.brake_energy >= energy,
                    "{speed} to {} rad/s: {} J",
                    hub.spin.speed,
                    hub.spin.brake_energy - energy
                );
            }
        }
        assert!(turned > 1000, "{turned}");
    }

    #[test]
    fn a_free_hub_falls_and_slip_has_its_ends() {
        let mut hub = Hub::default();
        run(&mut hub, 0.0, 0.0, 1e-3, 1000);
        assert!(
            (hub.centre.position.z + 0.5 * 9.81).abs() < 1e-9 && (hub.centre.velocity.z + 9.81).abs() < 1e-9
        );
        assert_eq!(slip(0.0, 20.0, 0.1), -1.0);
        assert_eq!(slip(0.0, -20.0, 0.1), 1.0);
        assert_eq!(slip(-22.0, -20.0, 0.1), -0.1);
        assert_eq!(slip(20.0, 20.0, 0.1), 0.0);
        assert_eq!(slip(0.0, 0.0, 0.1), 0.0);
    }
}
