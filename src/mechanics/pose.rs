//! A body as elements between bodies see it.

use super::motion::{Attitude, Motion, Wrench, cross, turn};
use nalgebra::{Matrix3, Vector3};

/// Where a body is and how it moves, with what its angles mean: made once for all that hangs on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Centre, frame 0 \[m\].
    pub position: Vector3<f64>,
    /// Its velocity \[m/s\].
    pub velocity: Vector3<f64>,
    /// From the body's axes to frame 0.
    pub axes: Matrix3<f64>,
    /// Angular velocity, frame 0 \[rad/s\].
    pub spin: Vector3<f64>,
    /// Sines and cosines of its angles, and their rates \[rad/s\].
    pub attitude: Attitude<f64>,
    /// \[rad/s\]
    pub rates: Vector3<f64>,
}

impl From<&Motion<f64>> for Pose {
    #[inline]
    fn from(motion: &Motion<f64>) -> Self {
        let attitude = motion.attitude();
        Self {
            position: motion.position,
            velocity: motion.velocity,
            axes: attitude.rotation(),
            spin: turn(&attitude.rate_map(), &motion.rates),
            attitude,
            rates: motion.rates,
        }
    }
}

/// A point that moves with a body, frame 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct At {
    /// From the body's centre \[m\].
    pub arm: Vector3<f64>,
    /// Place \[m\].
    pub place: Vector3<f64>,
    /// Velocity \[m/s\].
    pub velocity: Vector3<f64>,
}

impl Pose {
    /// The point of the body with these coordinates in its axes, from its centre \[m\].
    #[inline]
    pub fn at(&self, point: &Vector3<f64>) -> At {
        let arm = turn(&self.axes, point);
        At { arm, place: self.position + arm, velocity: self.velocity + cross(&self.spin, &arm) }
    }
}

impl At {
    /// Force \[N\] at the point, as force and moment about the body's centre.
    #[inline]
    pub fn load(&self, force: Vector3<f64>) -> Wrench<f64> {
        Wrench { force, moment: cross(&self.arm, &force) }
    }
}
