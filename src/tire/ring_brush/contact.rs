//! Where and how hard the belt shell meets the flat road: contact frame, penetration, normal force
//! (4.12)-(4.15), and the lengths of the contact stripes (4.19), (4.20).

use super::Parameters;
use crate::mechanics::{Motion, rotation_z};
use crate::solver::Real;
use nalgebra::{Matrix3, Vector3};

/// The contact frame K on a flat road at z = 0: origin at the contact point, x along the belt's
/// mid-plane, z up. Closed form of (4.12) and definition 20.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact<T: Real> {
    /// Camber of the belt against the road normal \[rad\] and its rate.
    pub camber: T,
    /// Sine and cosine of the camber.
    pub camber_sin_cos: (T, T),
    /// Rate of the camber \[rad/s\].
    pub camber_rate: T,
    /// Heading of the frame \[rad\].
    pub yaw: T,
    /// Its rate \[rad/s\].
    pub yaw_rate: T,
    /// Distance from belt centre to contact point, h \[m\].
    pub distance: T,
    /// Its rate \[m/s\].
    pub distance_rate: T,
    /// Belt centre as seen from the contact point, in K \[m\].
    pub centre: Vector3<T>,
    /// Velocity of the contact point in K: x and y \[m/s\].
    pub velocity: [T; 2],
    /// Depth of the deepest point of the shell below its centre, d \[m\] (4.13).
    pub depth: T,
    /// Penetration f_G \[m\] (4.14).
    pub penetration: T,
    /// Its rate \[m/s\]; zero in the air.
    pub penetration_rate: T,
    /// Normal force of the road on the belt \[N\] (4.15).
    pub normal_force: T,
}

impl<T: Real> Contact<T> {
    /// The contact of a belt that moves as `belt`.
    pub fn new(p: &Parameters, belt: &Motion<T>) -> Self {
        let (camber, camber_rate) = (belt.angles.x, belt.rates.x);
        let (sin, cos) = camber.sin_cos();
        let tan = sin / cos;
        let (height, height_rate) = (belt.position.z, belt.velocity.z);
        let distance = height / cos;
        let tilt_rate = height * camber_rate / (cos * cos);

        let (yaw, yaw_rate) = (belt.angles.z, belt.rates.z);
        let in_contact_frame = rotation_z(yaw).transpose() * belt.velocity;
        let velocity = [
            in_contact_frame.x - yaw_rate * height * tan,
            in_contact_frame.y + height_rate * tan + tilt_rate,
        ];

        let (depth, depth_rate) = shell_depth(p, sin, cos, camber_rate);
        let gap = depth - height;
        let touches = gap.value() > 0.0;
        let penetration = if touches { gap } else { T::zero() };
        let penetration_rate = if touches { depth_rate - height_rate } else { T::zero() };
        let spring = (penetration * p.vertical_stiffness_quadratic + p.vertical_stiffness) * penetration;
        let normal_force = (spring + penetration_rate * p.vertical_damping).or_at_least(0.0);
        Self {
            camber,
            camber_sin_cos: (sin, cos),
            camber_rate,
            yaw,
            yaw_rate,
            distance,
            distance_rate: height_rate / cos + tilt_rate * sin,
            centre: Vector3::new(T::zero(), -height * tan, height),
            velocity,
            depth,
            penetration,
            penetration_rate,
            normal_force,
        }
    }

    /// A_K0: components in K to frame 0.
    pub fn rotation(&self) -> Matrix3<T> {
        rotation_z(self.yaw)
    }

    /// Length of stripe `i` after the material's correction, l_mat \[m\] (4.19), (4.20). The stripe's
    /// radius is passed in because it does not change during a run.
    pub fn stripe_length(&self, p: &Parameters, position: f64, radius: f64) -> T {
        let (sin, cos) = self.camber_sin_cos;
        let ratio = (self.distance + sin / cos * position) / radius;
        if self.penetration.value() <= 0.0 || ratio.value() >= 1.0 {
            return T::zero();
        }
        let angle = if ratio.value() <= -1.0 { T::from(std::f64::consts::PI) } else { ratio.acos() };
        angle * (2.0 * radius * p.stripe_length_factor)
    }
}

/// Distance along the road normal from belt centre to the deepest point of the toroidal shell, and
/// its rate (4.13). Printed with a wrong dimension under the root; (B/2)² is what makes it continuous
/// where the deepest point reaches the shell's edge.
fn shell_depth<T: Real>(p: &Parameters, sin: T, cos: T, camber_rate: T) -> (T, T) {
    let (half, cross) = (p.width / 2.0, p.cross_section_radius);
    if sin.value().abs() <= half / cross {
        let arm = p.radius - cross;
        (cos * arm + cross, -sin * camber_rate * arm)
    } else {
        let arm = p.radius - cross + (cross * cross - half * half).sqrt();
        let side = if sin.value() < 0.0 { -half } else { half };
        (cos * arm + sin * side, (cos * side - sin * arm) * camber_rate)
    }
}
