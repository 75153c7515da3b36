//! What a tire stands on: points of a road, or at each instant a plane under a body, which may tilt and move.

use crate::mechanics::{Motion, cross, rotation_x, rotation_y, rotation_z, turn};
use crate::road::{Point, Window};
use nalgebra::{Matrix3, Vector3};

/// The road under a belt at an instant. The road itself does not move; that the plane does comes
/// from the belt's travel over an uneven road.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// Distance of the belt's centre from the plane \[m\].
    pub clearance: f64,
    /// Its rate \[m/s\].
    pub clearance_rate: f64,
    /// Slopes dz/dx and dz/dy in frame 0.
    pub slope: [f64; 2],
    /// Their rates along the belt's travel \[1/s\].
    pub slope_rate: [f64; 2],
    /// Factor on both friction coefficients.
    pub friction: f64,
}

/// Whatever knows the road under a tire. What it makes of it is the tire's: it asks for the plane under a body,
/// bridged over a length of its own, or for points.
pub trait Ground {
    /// The plane under `body` at a share of the step from 0 to 1, for a tire that bridges the road over `window`.
    /// The body's position is seen from the point below the rim's centre at that instant.
    fn plane(&self, body: &Motion<f64>, window: &Window, share: f64) -> Plane;

    /// The road as it is at x and y \[m\], seen from the point below the rim's centre, at a share of the step.
    fn point(&self, x: f64, y: f64, share: f64) -> Point;

    /// Height \[m\] and slopes of [`point`](Self::point).
    fn relief(&self, x: f64, y: f64, share: f64) -> (f64, [f64; 2]) {
        let Point { height, slope, .. } = self.point(x, y, share);
        (height, slope)
    }

    /// Whether it moves by itself, so that a body that ends a step on one plane may begin the next one on another.
    fn moves(&self) -> bool {
        false
    }

    /// A height that no point of the road exceeds \[m\]: infinite if none is known.
    fn highest(&self) -> f64 {
        f64::INFINITY
    }
}

/// The unbounded plane z = 0.
#[derive(Debug, Clone, Copy)]
pub struct Flat {
    /// Factor on both friction coefficients.
    pub friction: f64,
}

impl Ground for Flat {
    fn plane(&self, body: &Motion<f64>, _window: &Window, _share: f64) -> Plane {
        Plane {
            clearance: body.position.z,
            clearance_rate: body.velocity.z,
            slope: [0.0; 2],
            slope_rate: [0.0; 2],
            friction: self.friction,
        }
    }

    fn point(&self, _x: f64, _y: f64, _share: f64) -> Point {
        Point { height: 0.0, slope: [0.0; 2], friction: self.friction }
    }

    fn highest(&self) -> f64 {
        0.0
    }
}

impl Plane {
    /// A level plane `height` \[m\] below a body that keeps its height.
    pub fn level(height: f64, friction: f64) -> Self {
        Self { clearance: height, clearance_rate: 0.0, slope: [0.0; 2], slope_rate: [0.0; 2], friction }
    }

    fn is_level(&self) -> bool {
        self.slope == [0.0; 2] && self.slope_rate == [0.0; 2]
    }

    /// Tilt about y, then about the new x, that turns frame 0 into the plane's.
    fn tilt(&self) -> (f64, f64) {
        let [slope_x, slope_y] = self.slope;
        let about_y = libm::atan(-slope_x);
        (about_y, libm::atan(slope_y * libm::cos(about_y)))
    }

    /// Components in the plane's frame to frame 0. Its z is the plane's normal, its x lies above the
    /// x of frame 0.
    pub fn rotation(&self) -> Matrix3<f64> {
        if self.is_level() {
            return Matrix3::identity();
        }
        let (about_y, about_x) = self.tilt();
        rotation_y(about_y) * rotation_x(about_x)
    }

    /// Components of a vector in the plane's frame to frame 0.
    pub fn to_frame_0(&self, v: &Vector3<f64>) -> Vector3<f64> {
        if self.is_level() { *v } else { turn(&self.rotation(), v) }
    }

    /// The belt's motion against the plane: on the plane, a belt that moves so is a belt on a flat
    /// road. Its height is the clearance, its angles are those in the plane's frame, and its horizontal
    /// velocity is such that the contact point moves over the road as it does.
    ///
    /// Where the plane pitches because the road is curved, the contact point travels around the tire;
    /// this is the angular velocity of the plane times the arm from the belt's centre. The plane's
    /// turning about its own normal is no motion of the road and does not count.
    pub fn relative(&self, belt: &Motion<f64>) -> Motion<f64> {
        if self.is_level() {
            let mut motion = *belt;
            motion.position.z = self.clearance;
            motion.velocity.z = self.clearance_rate;
            return motion;
        }
        let mut motion = belt.turned(&self.rotation().transpose());
        let (about_y, about_x) = self.tilt();
        let ((sin_y, cos_y), cos_x) = (libm::sincos(about_y), libm::cos(about_x));
        let rate_y = -self.slope_rate[0] * cos_y * cos_y;
        let rate_x = (self.slope_rate[1] * cos_y - self.slope[1] * sin_y * rate_y) * cos_x * cos_x;
        let turning = Vector3::new(rate_x, rate_y * cos_x, 0.0);
        motion.rates -= motion.rate_map_inverse() * turning;

        let beside = self.clearance * libm::tan(motion.angles.x);
        let arm = rotation_z(motion.angles.z) * Vector3::new(0.0, beside, -self.clearance);
        motion.velocity += cross(&turning, &arm);
        motion.velocity.z = self.clearance_rate;
        motion.position.z = self.clearance;
        motion
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Over a large drum: the wheel's centre turns about the drum's axis, the contact point follows on
    /// the drum's surface, and the plane turns with them.
    #[test]
    fn over_a_drum_the_contact_point_is_slower_than_the_centre_and_the_plane_turns() {
        let (drum, clearance, turning) = (1000.0, 0.3, 0.02);
        let centre_speed = turning * (drum + clearance);
        let plane = Plane {
            clearance,
            clearance_rate: 0.0,
            slope: [0.0; 2],
            // d/dt of the slope of a circle at its top, under a centre that moves horizontally
            slope_rate: [-centre_speed / drum, 0.0],
            friction: 1.0,
        };
        let belt = Motion {
            velocity: Vector3::new(centre_speed, 0.0, 0.0),
            rates: Vector3::new(0.0, 60.0, 0.0),
            ..Motion::default()
        };
        let relative = plane.relative(&belt);
        // the slope belongs to the road below the centre, not to the foot of the perpendicular: a
        // difference of second order
        let second = (clearance / drum).powi(2);
        assert!((relative.velocity.x / (turning * drum) - 1.0).abs() < 2.0 * second);
        assert!(((60.0 - relative.rates.y) / turning - 1.0).abs() < 2.0 * clearance / drum);
    }

    /// Rates of the relative motion are the rates of its angles and of its clearance.
    #[test]
    fn relative_rates_are_derivatives() {
        let at = |t: f64| {
            let belt = Motion {
                position: Vector3::new(0.0, 0.0, 0.3),
                velocity: Vector3::new(3.0, 1.0, 0.2),
                angles: Vector3::new(0.1 + 0.4 * t, 2.0 + 30.0 * t, -0.3 + 0.5 * t),
                rates: Vector3::new(0.4, 30.0, 0.5),
            };
            let plane = Plane {
                clearance: 0.3,
                clearance_rate: 0.0,
                slope: [0.1 + 0.7 * t, -0.2 + 0.3 * t],
                slope_rate: [0.7, 0.3],
                friction: 1.0,
            };
            (plane, plane.relative(&belt), plane.rotation())
        };
        let step = 1e-5;
        let [(_, before, turned_before), (_, now, turned), (_, after, turned_after)] =
            [-step, 0.0, step].map(at);
        let rates = (after.angles - before.angles) / (2.0 * step);
        assert!((rates.x - now.rates.x).abs() < 1e-8 && (rates.y - now.rates.y).abs() < 1e-8);
        // the yaw rate is the one about the normal against the road: the frame's own turning about it is
        // no part of it
        let spinning = turned.transpose() * (turned_after - turned_before) / (2.0 * step);
        assert!((rates.z + spinning[(1, 0)] - now.rates.z).abs() < 1e-8);
        assert!(spinning[(1, 0)].abs() > 1e-3);
    }
}
