//! The side wall: spring-dampers in six degrees of freedom between rim and belt (4.2)-(4.9).

use super::Parameters;
use crate::mechanics::{Motion, Wrench, cross, rotation_x, rotation_y, rotation_z};
use crate::solver::Real;
use nalgebra::{Matrix3, Vector3};

/// What the side wall does at an instant. Frame 0, the belt's moment about the belt centre, the
/// rim's about the rim centre; frame G is the belt's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coupling<T: Real> {
    /// Rim centre in frame G \[m\] (4.2).
    pub offset: Vector3<T>,
    /// Its rate in frame G \[m/s\].
    pub offset_rate: Vector3<T>,
    /// Linearised rotation of the rim in frame G \[rad\] (4.4).
    pub rotation: Vector3<T>,
    /// Its rate \[rad/s\] (4.5).
    pub rotation_rate: Vector3<T>,
    /// On the belt, frame G (4.6), (4.7).
    pub belt_in_belt_frame: Wrench<T>,
    /// On the belt, frame 0 (4.8).
    pub on_belt: Wrench<T>,
    /// On the rim, frame 0 (4.9).
    pub on_rim: Wrench<T>,
}

/// The off-diagonal entries that stand for a small rotation: single ones as printed in (4.4), or
/// the antisymmetric part, which transforms as a vector and keeps stationary states stationary.
fn small_rotation<T: Real>(m: &Matrix3<T>, antisymmetric: bool) -> Vector3<T> {
    let entries = Vector3::new(m[(2, 1)], m[(0, 2)], m[(1, 0)]);
    if antisymmetric {
        (entries - Vector3::new(m[(1, 2)], m[(2, 0)], m[(0, 1)])) * T::from(0.5)
    } else {
        entries
    }
}

fn diagonal<T: Real>(about_y: f64, others: f64, v: &Vector3<T>) -> Vector3<T> {
    Vector3::new(v.x * others, v.y * about_y, v.z * others)
}

fn on_rim<T: Real>(on_belt: &Wrench<T>, belt_from_rim: &Vector3<T>) -> Wrench<T> {
    Wrench { force: -on_belt.force, moment: -on_belt.moment - cross(belt_from_rim, &on_belt.force) }
}

/// Forces and moments of the side wall for given motions of rim and belt.
pub fn coupling<T: Real>(p: &Parameters, rim: &Motion<T>, belt: &Motion<T>) -> Coupling<T> {
    let (to_road, to_road_rate) = belt.attitude().rotation_and_derivative(&belt.rates);
    let (to_belt, to_belt_rate) = (to_road.transpose(), to_road_rate.transpose());
    let (rim_rotation, rim_rotation_rate) = rim.attitude().rotation_and_derivative(&rim.rates);

    let apart = rim.position - belt.position;
    let offset = to_belt * apart;
    let offset_rate = to_belt_rate * apart + to_belt * (rim.velocity - belt.velocity);
    let rotation = small_rotation(&(to_belt * rim_rotation), p.antisymmetric_coupling);
    let rotation_rate = small_rotation(
        &(to_belt_rate * rim_rotation + to_belt * rim_rotation_rate),
        p.antisymmetric_coupling,
    );

    let force = diagonal(p.sidewall_lateral_stiffness, p.sidewall_radial_stiffness, &offset)
        + diagonal(p.sidewall_lateral_damping, p.sidewall_radial_damping, &offset_rate);
    let moment = diagonal(p.sidewall_windup_stiffness, p.sidewall_tilt_stiffness, &rotation)
        + diagonal(p.sidewall_windup_damping, p.sidewall_tilt_damping, &rotation_rate);
    let on_belt = Wrench { force: to_road * force, moment: to_road * moment };
    Coupling {
        offset,
        offset_rate,
        rotation,
        rotation_rate,
        belt_in_belt_frame: Wrench { force, moment },
        on_belt,
        on_rim: on_rim(&on_belt, &-apart),
    }
}

/// On the belt and on the rim in a stationary state (4.39)-(4.42): rim and belt translate alike and
/// spin at `spin_rate`, the rim is `windup` ahead of the belt.
///
/// With the entries of (4.4) as printed the true moment has a small ripple twice a turn; this is the
/// value that (4.42) gives.
pub fn stationary<T: Real>(
    p: &Parameters,
    belt_from_rim: &Vector3<T>,
    rim_angles: (T, T),
    belt_angles: (T, T),
    windup: T,
    spin_rate: T,
) -> (Wrench<T>, Wrench<T>) {
    let ((rim_camber, rim_steer), (camber, yaw)) = (rim_angles, belt_angles);
    let tilt = rotation_z(yaw) * rotation_x(camber);

    let offset = tilt.transpose() * -*belt_from_rim;
    let (c, d) = (p.sidewall_radial_stiffness, spin_rate * p.sidewall_radial_damping);
    let force = Vector3::new(
        offset.x * c - offset.z * d,
        offset.y * p.sidewall_lateral_stiffness,
        offset.x * d + offset.z * c,
    );

    let relative = tilt.transpose() * rotation_z(rim_steer) * rotation_x(rim_camber) * rotation_y(windup);
    let angle = small_rotation(&relative, p.antisymmetric_coupling);
    let (c, d) = (p.sidewall_tilt_stiffness, spin_rate * p.sidewall_tilt_damping);
    let moment = Vector3::new(
        angle.x * c - angle.z * d,
        angle.y * p.sidewall_windup_stiffness,
        angle.z * c + angle.x * d,
    );

    let on_belt = Wrench { force: tilt * force, moment: tilt * moment };
    (on_belt, on_rim(&on_belt, belt_from_rim))
}

/// Belt centre from rim centre in a stationary state, in frame 0 \[m\], where the side wall pulls the belt
/// with `force`: what [`stationary`] makes of it, solved for the place.
pub fn belt_from_rim<T: Real>(
    p: &Parameters,
    force: &Vector3<T>,
    (camber, yaw): (T, T),
    spin_rate: T,
) -> Vector3<T> {
    let tilt = rotation_z(yaw) * rotation_x(camber);
    let force = tilt.transpose() * force;
    let (c, d) = (p.sidewall_radial_stiffness, spin_rate * p.sidewall_radial_damping);
    let square = d * d + c * c;
    let offset = Vector3::new(
        (force.x * c + force.z * d) / square,
        force.y / p.sidewall_lateral_stiffness,
        (force.z * c - force.x * d) / square,
    );
    -(tilt * offset)
}
