//! Rigid-body kinematics in Cardan angles: steer about z, then camber about x, then spin about y.

use crate::solver::Real;
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// Pose and velocity of a rim or belt against the road (frame 0: z up, road at z = 0).
///
/// `A = Rz(angles.z) Rx(angles.x) Ry(angles.y)` turns body components into frame 0 (source:
/// definitions 17 and 18). Singular at angles.x = ±90 degrees.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Motion<T: Real> {
    /// Centre \[m\].
    pub position: Vector3<T>,
    /// Its velocity \[m/s\].
    pub velocity: Vector3<T>,
    /// Cardan angles: x camber, y spin (unbounded), z steer \[rad\].
    pub angles: Vector3<T>,
    /// Their rates \[rad/s\].
    pub rates: Vector3<T>,
}

impl<T: Real> Default for Motion<T> {
    fn default() -> Self {
        let zero = Vector3::from_element(T::zero());
        Self { position: zero, velocity: zero, angles: zero, rates: zero }
    }
}

/// A force and a moment about a named point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Wrench<T: Real> {
    /// Force \[N\].
    pub force: Vector3<T>,
    /// Moment \[N.m\].
    pub moment: Vector3<T>,
}

impl<T: Real> Default for Wrench<T> {
    fn default() -> Self {
        let zero = Vector3::from_element(T::zero());
        Self { force: zero, moment: zero }
    }
}

impl<T: Real> std::ops::AddAssign for Wrench<T> {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        self.force += other.force;
        self.moment += other.moment;
    }
}

impl Motion<f64> {
    /// The same motion in another scalar, as a constant.
    pub fn constant<T: Real>(&self) -> Motion<T> {
        let lift = |v: &Vector3<f64>| v.map(T::from);
        Motion {
            position: lift(&self.position),
            velocity: lift(&self.velocity),
            angles: lift(&self.angles),
            rates: lift(&self.rates),
        }
    }
}

impl Motion<f64> {
    /// The same motion in other axes: `axes` turns components of the present ones into the new ones.
    /// The spin angle changes by less than half a turn.
    pub fn turned(&self, axes: &Matrix3<f64>) -> Self {
        let attitude = axes * rotation_z(self.angles.z) * rotation_x(self.angles.x);
        let camber = libm::asin(attitude[(2, 1)].clamp(-1.0, 1.0));
        let spin = self.angles.y + libm::atan2(-attitude[(2, 0)], attitude[(2, 2)]);
        let yaw = libm::atan2(-attitude[(0, 1)], attitude[(1, 1)]);
        let mut motion = Self {
            position: turn(axes, &self.position),
            velocity: turn(axes, &self.velocity),
            angles: Vector3::new(camber, spin, yaw),
            rates: Vector3::zeros(),
        };
        motion.rates = turn(&motion.rate_map_inverse(), &turn(axes, &self.angular_velocity()));
        motion
    }
}

impl<T: Real> Motion<T> {
    /// A: body components to frame 0.
    pub fn rotation(&self) -> Matrix3<T> {
        self.attitude().rotation()
    }

    /// Sines and cosines of the angles.
    pub fn attitude(&self) -> Attitude<T> {
        Attitude { x: self.angles.x.sin_cos(), y: self.angles.y.sin_cos(), z: self.angles.z.sin_cos() }
    }

    /// Omega(angles), which maps Cardan rates to the angular velocity in frame 0 (4.11).
    pub fn rate_map(&self) -> Matrix3<T> {
        self.attitude().rate_map()
    }

    /// The inverse of [`rate_map`](Self::rate_map) (C.151).
    pub fn rate_map_inverse(&self) -> Matrix3<T> {
        self.attitude().rate_map_inverse()
    }

    /// The time derivative of [`rate_map`](Self::rate_map).
    pub fn rate_map_derivative(&self) -> Matrix3<T> {
        self.attitude().rate_map_derivative(&self.rates)
    }

    /// Angular velocity in frame 0 \[rad/s\].
    pub fn angular_velocity(&self) -> Vector3<T> {
        turn(&self.rate_map(), &self.rates)
    }

    /// The time derivative of [`rotation`](Self::rotation).
    pub fn rotation_derivative(&self) -> Matrix3<T> {
        self.attitude().rotation_and_derivative(&self.rates).1
    }
}

/// Sines and cosines of Cardan angles, which cost more than what is made of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attitude<T> {
    /// Of the camber.
    pub x: (T, T),
    /// Of the spin angle.
    pub y: (T, T),
    /// Of the steer angle.
    pub z: (T, T),
}

impl<T: Real> Attitude<T> {
    /// [`Motion::rotation`].
    pub fn rotation(&self) -> Matrix3<T> {
        // about z, then x, then y, without what is multiplied by zeros
        let ((sx, cx), (sy, cy), (sz, cz)) = (self.x, self.y, self.z);
        Matrix3::new(
            cz * cy - sz * sx * sy,
            -sz * cx,
            cz * sy + sz * sx * cy,
            sz * cy + cz * sx * sy,
            cz * cx,
            sz * sy - cz * sx * cy,
            -cx * sy,
            sx,
            cx * cy,
        )
    }

    /// [`Motion::rotation`] and its time derivative at these rates of the angles.
    pub fn rotation_and_derivative(&self, rates: &Vector3<T>) -> (Matrix3<T>, Matrix3<T>) {
        let rotation = self.rotation();
        (rotation, cross_matrix(&turn(&self.rate_map(), rates)) * rotation)
    }

    /// [`Motion::rate_map`].
    pub fn rate_map(&self) -> Matrix3<T> {
        let ((sx, cx), (sz, cz)) = (self.x, self.z);
        let (zero, one) = (T::zero(), T::one());
        Matrix3::new(cz, -sz * cx, zero, sz, cz * cx, zero, zero, sx, one)
    }

    /// [`Motion::rate_map_inverse`].
    pub fn rate_map_inverse(&self) -> Matrix3<T> {
        let ((sx, cx), (sz, cz)) = (self.x, self.z);
        let (zero, one) = (T::zero(), T::one());
        Matrix3::new(cz, sz, zero, -sz / cx, cz / cx, zero, sx * sz / cx, -sx * cz / cx, one)
    }

    /// [`Motion::rate_map_derivative`] at these rates of the angles.
    pub fn rate_map_derivative(&self, rates: &Vector3<T>) -> Matrix3<T> {
        let ((sx, cx), (sz, cz)) = (self.x, self.z);
        let (dx, dz) = (rates.x, rates.z);
        let zero = T::zero();
        Matrix3::new(
            -sz * dz,
            -cz * cx * dz + sz * sx * dx,
            zero,
            cz * dz,
            -sz * cx * dz - cz * sx * dx,
            zero,
            zero,
            cx * dx,
            zero,
        )
    }
}

/// A matrix times a vector. Written out: the library's product of such small ones is calls and loops, which were a fifth of what a car costs.
#[inline]
pub fn turn<T: Real>(matrix: &Matrix3<T>, v: &Vector3<T>) -> Vector3<T> {
    let row = |i: usize| matrix[(i, 0)] * v.x + matrix[(i, 1)] * v.y + matrix[(i, 2)] * v.z;
    Vector3::new(row(0), row(1), row(2))
}

/// The transposed matrix times a vector.
#[inline]
pub fn turn_back<T: Real>(matrix: &Matrix3<T>, v: &Vector3<T>) -> Vector3<T> {
    let column = |i: usize| matrix[(0, i)] * v.x + matrix[(1, i)] * v.y + matrix[(2, i)] * v.z;
    Vector3::new(column(0), column(1), column(2))
}

/// Rotation about x.
pub fn rotation_x<T: Real>(angle: T) -> Matrix3<T> {
    about_x(angle.sin_cos())
}

/// Rotation about y.
pub fn rotation_y<T: Real>(angle: T) -> Matrix3<T> {
    about_y(angle.sin_cos())
}

/// Rotation about z.
pub fn rotation_z<T: Real>(angle: T) -> Matrix3<T> {
    about_z(angle.sin_cos())
}

fn about_x<T: Real>((s, c): (T, T)) -> Matrix3<T> {
    let (o, i) = (T::zero(), T::one());
    Matrix3::new(i, o, o, o, c, -s, o, s, c)
}

fn about_y<T: Real>((s, c): (T, T)) -> Matrix3<T> {
    let (o, i) = (T::zero(), T::one());
    Matrix3::new(c, o, s, o, i, o, -s, o, c)
}

fn about_z<T: Real>((s, c): (T, T)) -> Matrix3<T> {
    let (o, i) = (T::zero(), T::one());
    Matrix3::new(c, -s, o, s, c, o, o, o, i)
}

/// The matrix of `v x ...`.
pub fn cross_matrix<T: Real>(v: &Vector3<T>) -> Matrix3<T> {
    let o = T::zero();
    Matrix3::new(o, -v.z, v.y, v.z, o, -v.x, -v.y, v.x, o)
}

/// `a x b`; nalgebra's own needs an ordered field.
#[inline]
pub fn cross<T: Real>(a: &Vector3<T>, b: &Vector3<T>) -> Vector3<T> {
    Vector3::new(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
}
