//! Where the belt stands on a flat road, and how hard (8.3, 8.4 and 4.35 of the specification).

use super::frames::{Motion, Vector, cross};
use super::odd::Oddness;
use super::parameters::Parameters;
use super::patch::Load;

/// Where the belt is over a flat road: 8.3 and 8.4.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Footing {
    /// Camber and yaw of the belt and their rates \[rad, rad/s\].
    tilt: [f64; 2],
    pub(crate) tilting: [f64; 2],
    pub(crate) sine: f64,
    pub(crate) cosine: f64,
    /// From belt centre to contact point \[m\], and its rate.
    pub(crate) height: f64,
    pub(crate) rising: f64,
    /// Velocity of the contact point in the contact frame \[m/s\].
    pub(crate) velocity: [f64; 2],
    /// Penetration (4.14) \[m\] and normal force (4.15) \[N\].
    pub(crate) penetration: f64,
    pub(crate) force: f64,
    /// Belt centre over the contact point, contact frame \[m\].
    pub(crate) arm: Vector,
}

impl Footing {
    pub(crate) fn new(p: &Parameters, belt: &Motion, odd: &Oddness) -> Self {
        let ([eps, _, yaw], [d_eps, _, d_yaw]) = (belt.angles, belt.rates);
        let ((s, c), (sz, cz)) = (libm::sincos(eps), libm::sincos(yaw));
        let (z, dz) = (belt.place[2], belt.velocity[2]);
        let half = 0.5 * p.tire_width;
        let round = p.cross_section_radius;
        // (4.13), continuous at the limit with (B/2)² under the root
        let inner = p.tire_radius - round;
        let (lowest, falling) = if s.abs() <= half / round {
            (inner * c + round, -inner * s * d_eps)
        } else {
            let edge = inner + (round * round - half * half).max(0.0).sqrt();
            (edge * c + half * s.abs(), (-edge * s + half * s.signum() * c) * d_eps)
        };
        let penetration = (lowest - z).max(0.0);
        let rate = if penetration > 0.0 { falling - dz } else { 0.0 };
        let spring =
            p.vertical_stiffness * penetration + p.vertical_stiffness_quadratic * penetration * penetration;
        let (vx, vy) = (belt.velocity[0], belt.velocity[1]);
        Self {
            tilt: [eps, yaw],
            tilting: [d_eps, d_yaw],
            sine: s,
            cosine: c,
            height: z / c,
            rising: dz / c + z * s / (c * c) * d_eps,
            velocity: [
                cz * vx + sz * vy - d_yaw * z * s / c,
                -sz * vx + cz * vy + dz * s / c + z * d_eps / (c * c),
            ],
            penetration,
            force: (odd.stiffness * spring + p.vertical_damping * rate).max(0.0),
            arm: [0.0, -z * s / c, z],
        }
    }

    /// From the contact frame to inertial axes: it only yaws.
    pub(crate) fn out(&self, v: Vector) -> Vector {
        let (s, c) = libm::sincos(self.tilt[1]);
        [c * v[0] - s * v[1], s * v[0] + c * v[1], v[2]]
    }

    /// Moment of a load of the patch about the belt centre (4.35), contact frame.
    pub(crate) fn moment(&self, load: &Load) -> Vector {
        let lever = cross(self.arm, load.force);
        [load.moment[0] - lever[0], load.moment[1] - lever[1], load.moment[2] - lever[2]]
    }
}
