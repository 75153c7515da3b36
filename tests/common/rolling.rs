//! Stationary operating points in the notation of the source, through the product's solver.

use latsch::tire::Motion;
use latsch::tire::Vertical;
use latsch::tire::ring_brush::{Prepared, Stationary, stationary_refined};
use nalgebra::Vector3;

/// An operating point. `alpha` is the source's slip angle: the opposite of the rig's `slip_angle`.
#[derive(Debug, Clone, Copy)]
pub struct Point {
    pub load: f64,
    pub speed: f64,
    pub slip: f64,
    pub alpha: f64,
    pub camber: f64,
    pub steer: f64,
}

/// Straight free rolling at 10 m/s.
pub const FREE: Point = Point { load: 5000.0, speed: 10.0, slip: 0.0, alpha: 0.0, camber: 0.0, steer: 0.0 };

impl Point {
    /// The rim's motion (4.36).
    pub fn rim(&self, tire: &Prepared) -> Motion<f64> {
        let (sin, cos) = (self.steer - self.alpha).sin_cos();
        let spin = (self.slip + 1.0) * self.speed * self.alpha.cos() / tire.parameters().rolling_radius;
        // cos(pi/2) is 6e-17 and not the locked wheel that is meant
        let spin = if (self.alpha.abs() - std::f64::consts::FRAC_PI_2).abs() < 1e-12 { 0.0 } else { spin };
        Motion {
            velocity: Vector3::new(self.speed * cos, self.speed * sin, 0.0),
            angles: Vector3::new(self.camber, 0.0, self.steer),
            rates: Vector3::new(0.0, spin, 0.0),
            ..Motion::default()
        }
    }

    /// The stationary state with this many intervals along each stripe.
    #[track_caller]
    pub fn solve(&self, tire: &Prepared, intervals: usize) -> Stationary {
        match stationary_refined(tire, &self.rim(tire), Vertical::Load(self.load), 1.0, intervals) {
            Ok(found) => found,
            Err(e) => panic!("{self:?}: {e}"),
        }
    }
}
