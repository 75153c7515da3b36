//! A road under a rim that travels.

use crate::road::Road;
use crate::tire::{Ground, Motion, Plane};

/// A road for the length of a step.
///
/// The plane under a belt has the filtered road's height and slope below the belt's centre: its
/// distance from the centre is measured vertically, and it is tilted there by the slope. That is the
/// convention of the effective road plane. On a long slope s a circle of radius R would sit
/// R s²/2 higher.
#[derive(Debug, Clone, Copy)]
pub struct OnRoad<'a> {
    /// The road.
    pub road: &'a Road,
    /// Where the rim is over the road at the beginning of the step, x and y \[m\].
    pub from: [f64; 2],
    /// Where it is at the end.
    pub to: [f64; 2],
    /// Factor on the road's friction.
    pub friction: f64,
}

impl<'a> OnRoad<'a> {
    /// At one place.
    pub fn at(road: &'a Road, place: [f64; 2], friction: f64) -> Self {
        Self { road, from: place, to: place, friction }
    }
}

impl Ground for OnRoad<'_> {
    fn under(&self, belt: &Motion<f64>, share: f64) -> Plane {
        let at =
            |axis: usize| self.from[axis] + share * (self.to[axis] - self.from[axis]) + belt.position[axis];
        let surface = self.road.at(at(0), at(1));
        let ([slope_x, slope_y], [xx, xy, yy]) = (surface.slope, surface.curvature);
        let (vx, vy) = (belt.velocity.x, belt.velocity.y);
        Plane {
            clearance: belt.position.z - surface.height,
            clearance_rate: belt.velocity.z - slope_x * vx - slope_y * vy,
            slope: surface.slope,
            slope_rate: [xx * vx + xy * vy, xy * vx + yy * vy],
            friction: surface.friction * self.friction,
        }
    }
}
