//! Vectors and rotations in space.

use std::ops::{Add, AddAssign, Mul, Neg, Sub, SubAssign};

/// A vector.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Vector(pub(crate) [f64; 3]);

/// Shorthand for a vector.
pub(crate) const fn v(x: f64, y: f64, z: f64) -> Vector {
    Vector([x, y, z])
}

/// Upward.
pub(crate) const UP: Vector = v(0.0, 0.0, 1.0);

impl Vector {
    pub(crate) fn x(self) -> f64 {
        self.0[0]
    }

    pub(crate) fn y(self) -> f64 {
        self.0[1]
    }

    pub(crate) fn z(self) -> f64 {
        self.0[2]
    }

    pub(crate) fn dot(self, o: Self) -> f64 {
        self.0[0] * o.0[0] + self.0[1] * o.0[1] + self.0[2] * o.0[2]
    }

    pub(crate) fn cross(self, o: Self) -> Self {
        let ([a, b, c], [d, e, f]) = (self.0, o.0);
        Self([b * f - c * e, c * d - a * f, a * e - b * d])
    }

    pub(crate) fn length(self) -> f64 {
        self.dot(self).sqrt()
    }

    pub(crate) fn unit(self) -> Self {
        self * (1.0 / self.length())
    }

    /// The mirror image on the other side of the car.
    pub(crate) fn mirrored(self) -> Self {
        v(self.x(), -self.y(), self.z())
    }
}

impl Add for Vector {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] + o.0[i]))
    }
}

impl Sub for Vector {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] - o.0[i]))
    }
}

impl Neg for Vector {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.map(|x| -x))
    }
}

impl Mul<f64> for Vector {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self(self.0.map(|x| factor * x))
    }
}

impl AddAssign for Vector {
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl SubAssign for Vector {
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}

/// A rotation, as a quaternion of length 1 whose first part is the scalar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Attitude(pub(crate) [f64; 4]);

impl Attitude {
    pub(crate) const LEVEL: Self = Self([1.0, 0.0, 0.0, 0.0]);

    /// Columns of the matrix that turns what is fixed to the body into space.
    pub(crate) fn axes(self) -> Axes {
        let [w, x, y, z] = self.0;
        Axes([
            v(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)),
            v(2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)),
            v(2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)),
        ])
    }

    /// Its rate while the body turns with an angular velocity in space.
    pub(crate) fn rate(self, turning: Vector) -> [f64; 4] {
        let [w, x, y, z] = self.0;
        let [a, b, c] = turning.0;
        [
            0.5 * (-a * x - b * y - c * z),
            0.5 * (a * w + b * z - c * y),
            0.5 * (b * w + c * x - a * z),
            0.5 * (c * w + a * y - b * x),
        ]
    }
}

/// Axes of a body in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Axes(pub(crate) [Vector; 3]);

impl Axes {
    /// What is fixed to the body, in space.
    pub(crate) fn out(self, of: Vector) -> Vector {
        self.0[0] * of.x() + self.0[1] * of.y() + self.0[2] * of.z()
    }

    /// What is in space, as the body has it.
    pub(crate) fn back(self, of: Vector) -> Vector {
        v(self.0[0].dot(of), self.0[1].dot(of), self.0[2].dot(of))
    }
}

/// Solves six linear equations by elimination with pivots; none if they are not independent.
pub(crate) fn solve(mut rows: [[f64; 7]; 6]) -> Option<[f64; 6]> {
    for k in 0..6 {
        let pivot = (k..6).max_by(|a, b| rows[*a][k].abs().total_cmp(&rows[*b][k].abs()))?;
        rows.swap(k, pivot);
        let top = rows[k];
        if top[k].abs() < 1e-12 {
            return None;
        }
        for (i, row) in rows.iter_mut().enumerate() {
            if i != k {
                let share = row[k] / top[k];
                row.iter_mut().zip(&top).for_each(|(value, above)| *value -= share * above);
            }
        }
    }
    Some(std::array::from_fn(|k| rows[k][6] / rows[k][k]))
}
