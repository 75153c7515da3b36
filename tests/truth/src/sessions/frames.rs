//! Vectors and the Cardan frames of rim and belt (Def. 17 and 18 of the specification).

pub(crate) type Vector = [f64; 3];

pub(crate) fn add(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(crate) fn minus(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn times(a: Vector, k: f64) -> Vector {
    [a[0] * k, a[1] * k, a[2] * k]
}

pub(crate) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Position, velocity, Cardan angles (x camber, y spin, z yaw) and their rates \[m, m/s, rad, rad/s\].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Motion {
    pub(crate) place: Vector,
    pub(crate) velocity: Vector,
    pub(crate) angles: Vector,
    pub(crate) rates: Vector,
}

/// Axes and angular velocity of a frame A = Rz Rx Ry, in inertial components.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Frame {
    /// Columns of A.
    pub(crate) axes: [Vector; 3],
    /// Ω of (4.11) times the rates.
    pub(crate) omega: Vector,
    sine: [f64; 2],
    cosine: [f64; 2],
}

impl Frame {
    pub(crate) fn of(motion: &Motion) -> Self {
        let [x, y, z] = motion.angles;
        let ((sx, cx), (sy, cy), (sz, cz)) = (libm::sincos(x), libm::sincos(y), libm::sincos(z));
        let [dx, dy, dz] = motion.rates;
        Self {
            axes: [
                [cz * cy - sz * sx * sy, sz * cy + cz * sx * sy, -cx * sy],
                [-sz * cx, cz * cx, sx],
                [cz * sy + sz * sx * cy, sz * sy - cz * sx * cy, cx * cy],
            ],
            omega: [cz * dx - sz * cx * dy, sz * dx + cz * cx * dy, sx * dy + dz],
            sine: [sx, sz],
            cosine: [cx, cz],
        }
    }

    /// From inertial components to those of the frame.
    pub(crate) fn into(&self, v: Vector) -> Vector {
        [dot(self.axes[0], v), dot(self.axes[1], v), dot(self.axes[2], v)]
    }

    /// From components of the frame to inertial ones.
    pub(crate) fn out(&self, v: Vector) -> Vector {
        add(add(times(self.axes[0], v[0]), times(self.axes[1], v[1])), times(self.axes[2], v[2]))
    }

    /// Second derivatives of the Cardan angles for an angular acceleration: Ω⁻¹ (ω̇ - Ω̇ φ̇) of (4.11) and (C.151).
    pub(crate) fn cardan(&self, acceleration: Vector, rates: Vector) -> Vector {
        let ([sx, sz], [cx, cz], [dx, dy, dz]) = (self.sine, self.cosine, rates);
        let own = [
            -sz * dz * dx + (sz * sx * dx - cz * cx * dz) * dy,
            cz * dz * dx - (sz * cx * dz + cz * sx * dx) * dy,
            cx * dx * dy,
        ];
        let [x, y, z] = minus(acceleration, own);
        [cz * x + sz * y, (cz * y - sz * x) / cx, (sz * x - cz * y) * sx / cx + z]
    }
}
