//! The contact patch as a whole: its deformation against the belt, the velocity of the bristles'
//! tops, and how the normal force is spread over the bristles (4.21)-(4.30).

use super::{Contact, Parameters};
use crate::solver::Real;
use serde::{Deserialize, Serialize};

/// Longitudinal force, lateral force and moment about the vertical of the patch, on the belt, in K;
/// also their lagged values and the rates of those.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Loads<T> {
    /// Longitudinal force \[N\].
    pub force_x: T,
    /// Lateral force \[N\].
    pub force_y: T,
    /// Moment about z \[N.m\].
    pub moment_z: T,
}

/// How the patch sits on the belt: shifted, twisted and bent by the lagged loads (4.28).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deformation<T: Real> {
    /// Shift in x \[m\].
    pub shift_x: T,
    /// Shift in y \[m\].
    pub shift_y: T,
    /// Twist about z \[rad\].
    pub twist: T,
    /// Lateral bending \[1/m\].
    pub bend: T,
}

impl<T: Real> Deformation<T> {
    /// The deformation by the lagged loads; by their rates, its rate.
    pub fn new(p: &Parameters, lagged: &Loads<T>) -> Self {
        Self {
            shift_x: lagged.force_x * p.patch_compliance_x,
            shift_y: lagged.force_y * p.patch_compliance_y,
            twist: lagged.moment_z * p.patch_compliance_twist,
            bend: lagged.force_y * p.bend_compliance(),
        }
    }

    /// Where the top of the bristle at (x, y) is \[m\].
    pub fn place(&self, x: T, y: T) -> [T; 2] {
        [x + self.shift_x, y + self.shift_y + (self.twist - self.bend * x) * x]
    }
}

/// The motion of the bristles' tops over the road (4.29), (4.30).
#[derive(Debug, Clone, Copy)]
pub struct Tops<T: Real> {
    deformation: Deformation<T>,
    /// Velocity of the bristles through the patch.
    feed: T,
    /// Spin rate of a cambered belt about the road's normal.
    camber_spin: T,
    /// Velocity of a top at x = y = 0 without yaw.
    velocity_x: T,
    /// Lateral velocity without yaw is a polynomial in x: coefficients 0 to 2.
    velocity_y: [T; 3],
    yaw_rate: T,
    /// Virtual lateral place of the camber parabola: coefficients 0 and 2 in x.
    camber_parabola: [T; 2],
}

impl<T: Real> Tops<T> {
    /// The motion for a contact, the belt's spin rate \[rad/s\], the lagged loads and their rates.
    pub fn new(
        p: &Parameters,
        contact: &Contact<T>,
        spin_rate: T,
        lagged: &Loads<T>,
        lag_rates: &Loads<T>,
    ) -> Self {
        let deformation = Deformation::new(p, lagged);
        let rate = Deformation::new(p, lag_rates);
        let feed = -spin_rate * p.rolling_radius;
        let (sin, cos) = contact.camber_sin_cos;
        let sin_rate = cos * contact.camber_rate;
        let drop = -contact.distance + p.rolling_radius;
        let curvature = 1.0 / (2.0 * p.rolling_radius);
        let [contact_x, contact_y] = contact.velocity;
        Self {
            deformation,
            feed,
            camber_spin: spin_rate * sin,
            velocity_x: feed + rate.shift_x + contact_x,
            velocity_y: [
                rate.shift_y + deformation.twist * feed + sin_rate * drop - sin * contact.distance_rate
                    + contact_y,
                rate.twist - deformation.bend * feed * 2.0 - sin * feed * (2.0 * curvature),
                -rate.bend - sin_rate * curvature,
            ],
            yaw_rate: contact.yaw_rate,
            camber_parabola: [sin * drop, -sin * curvature],
        }
    }

    /// Virtual lateral place of a top, with the camber parabola \[m\] (4.29): it counts in the
    /// velocity only.
    pub fn virtual_y(&self, x: T, y: T) -> T {
        self.deformation.place(x, y)[1] + self.camber_parabola[0] + self.camber_parabola[1] * x * x
    }

    /// Velocity over the road of the top at the undeformed place (x, y), in K \[m/s\] (4.30).
    #[inline]
    pub fn velocity(&self, x: T, y: T) -> [T; 2] {
        let [c0, c1, c2] = self.velocity_y;
        [
            self.velocity_x - self.yaw_rate * self.virtual_y(x, y),
            c0 + (c1 + c2 * x) * x + self.yaw_rate * (x + self.deformation.shift_x),
        ]
    }

    /// The velocity of the tops of a stripe, as polynomials of their undeformed places.
    pub fn at_stripe(&self, y: f64) -> Path<T> {
        let Deformation { shift_x, shift_y, twist, bend } = self.deformation;
        let [c0, c1, c2] = self.velocity_y;
        let [aside, curved] = self.camber_parabola;
        let yaw_rate = self.yaw_rate;
        Path {
            velocity_x: [
                self.velocity_x - yaw_rate * (shift_y + aside + y),
                -yaw_rate * twist,
                -yaw_rate * (curved - bend),
            ],
            velocity_y: [c0 + yaw_rate * shift_x, c1 + yaw_rate, c2],
            led: [twist * self.feed, self.camber_spin - bend * self.feed * 2.0],
        }
    }

    /// Velocity of the bristles through the patch, negative in forward travel \[m/s\].
    pub fn feed(&self) -> T {
        self.feed
    }

    /// Power \[W\] that a bristle takes out of the belt with `force` \[N\] on the patch at the undeformed
    /// place (x, y): what bends, damps and slides. To the sum over all belongs
    /// [`camber_power`](Self::camber_power).
    ///
    /// It is minus the force times the velocity of the top, without what that velocity has beyond a belt
    /// that is rigid: where twist, bending and the camber parabola lead bristles across, the source has no
    /// moment that would brake the belt's spin for it, so nobody pays.
    #[inline]
    pub fn power(&self, x: T, y: T, [force_x, force_y]: [T; 2]) -> T {
        let [velocity_x, velocity_y] = self.velocity(x, y);
        let led =
            (self.deformation.twist - self.deformation.bend * x * 2.0) * self.feed + self.camber_spin * x;
        -(force_x * velocity_x + force_y * (velocity_y - led))
    }

    /// Power \[W\] of the whole patch with the moment `moment_z` \[N.m\] on the belt that the spin of a
    /// cambered belt about the road's normal brings.
    pub fn camber_power(&self, moment_z: T) -> T {
        -self.camber_spin * moment_z
    }
}

/// Velocity over the road \[m/s\] of the tops of a stripe, as polynomials of the place x.
#[derive(Debug, Clone, Copy)]
pub struct Path<T> {
    /// In x: coefficients 0 to 2.
    pub velocity_x: [T; 3],
    /// In y: coefficients 0 to 2.
    pub velocity_y: [T; 3],
    /// What of the velocity in y nobody pays for (see [`Tops::power`]): coefficients 0 and 1.
    pub led: [T; 2],
}

/// Moment of the patch about the lateral axis of K, on the belt \[N.m\] (4.22). `force_x` is lagged.
pub fn moment_y<T: Real>(p: &Parameters, contact: &Contact<T>, spin_rate: T, force_x: T) -> T {
    let speed = spin_rate * p.rolling_radius;
    let direction = if speed.value().abs() < 1.0 { speed } else { speed / speed.abs() };
    -(contact.normal_force * direction * p.rolling_resistance_lever)
        - force_x * (-contact.distance + p.rolling_radius)
}

/// What became of the pressure distribution (the numbers are those of the output variable).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[repr(i32)]
pub enum PressureState {
    /// No contact.
    #[default]
    Air = 1,
    /// Normal force and lateral-axis moment are both met, and no pressure is negative.
    Regular = 2,
    /// Both are met, with negative pressure in some bristles.
    Negative = 3,
    /// The tilt of the pressure was limited: the normal force is met, the moment is not.
    Limited = 4,
    /// All bristles in contact have the same x: the normal force is met, the moment is not.
    Singular = 5,
    /// The belt touches the road between the bristles: no bristle carries anything.
    BetweenBristles = 6,
}

/// The shape of the pressure over the patch before it is scaled (4.21), (4.24).
#[derive(Debug, Clone, Copy)]
pub struct Shape<T: Real> {
    exponent_long: T,
    exponent_lat: T,
    width: f64,
}

impl<T: Real> Shape<T> {
    /// The shape at a penetration.
    pub fn new(p: &Parameters, penetration: T) -> Self {
        let exponent = |[c0, c1, c2]: [f64; 3]| ((penetration * c2 + c1) * penetration + c0).or_at_least(1.0);
        Self {
            exponent_long: exponent(p.pressure_exponent_long),
            exponent_lat: exponent(p.pressure_exponent_lat),
            width: p.width,
        }
    }

    /// The exponents along and across the patch (4.21).
    pub fn exponents(&self) -> (T, T) {
        (self.exponent_long, self.exponent_lat)
    }

    /// The factor of a whole stripe \[m\].
    pub fn stripe(&self, y: f64, length: T) -> T {
        let lateral = T::from((2.0 * y / self.width).abs()).pow(self.exponent_lat);
        (-lateral + 1.0) * length
    }

    /// The factor along a stripe.
    #[inline]
    pub fn along(&self, x: T, length: T) -> T {
        -(x * 2.0 / length).abs().pow(self.exponent_long) + 1.0
    }

    /// The factor at the place of which `logarithm` is that of |2 x / length| to base 2.
    #[inline]
    pub fn at_logarithm(&self, logarithm: f64) -> T {
        -(self.exponent_long * logarithm).exp2() + 1.0
    }

    /// The integrals of [`along`](Self::along) over a stripe \[m\], times 1 and x² (times x it is 0).
    pub fn integrals(&self, length: T) -> [T; 2] {
        let g = self.exponent_long;
        let second = (T::from(1.0 / 3.0) - T::one() / (g + 3.0)) * 0.25;
        [length * (g / (g + 1.0)), length * length * length * second]
    }
}

/// Sums of the shape over the bristles: times 1, x and x².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moments<T> {
    /// Sum \[m\].
    pub s0: T,
    /// Sum times x \[m²\].
    pub s1: T,
    /// Sum times x² \[m³\].
    pub s2: T,
}

/// The two free coefficients: pressure = (level + tilt x) shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pressure<T> {
    /// a \[Pa/m\].
    pub level: T,
    /// b \[Pa/m²\].
    pub tilt: T,
    /// What became of it.
    pub state: PressureState,
}

impl<T: Real> Pressure<T> {
    /// The coefficients that give `normal_force` in sum and `moment` = sum of -x times force (4.24).
    ///
    /// The printed system is singular when all bristles in contact have one x: then the tilt is 0.
    /// `longest` is the longest stripe, over which the policy `limit_pressure_tilt` keeps the
    /// pressure from becoming negative.
    pub fn new(p: &Parameters, sums: &Moments<T>, normal_force: T, moment: T, longest: f64) -> Self {
        let zero = T::zero();
        if normal_force.value() <= 0.0 {
            return Self { level: zero, tilt: zero, state: PressureState::Air };
        }
        let Moments { s0, s1, s2 } = *sums;
        if s0.value() <= 0.0 {
            return Self { level: zero, tilt: zero, state: PressureState::BetweenBristles };
        }
        let area = p.cell_area();
        let determinant = s0 * s2 - s1 * s1;
        // Two bristles at neighbouring x with shapes p and q give p q l².
        let one = s0.value() * p.bristle_length;
        let smallest = 1e-9 * (one * one);
        if determinant.value() <= smallest {
            return Self { level: normal_force / s0 / area, tilt: zero, state: PressureState::Singular };
        }
        let level = (moment * s1 + normal_force * s2) / determinant / area;
        let tilt = -(moment * s0 + normal_force * s1) / determinant / area;
        if level.value() >= tilt.value().abs() * longest / 2.0 {
            return Self { level, tilt, state: PressureState::Regular };
        }
        if p.limit_pressure_tilt {
            let ratio = if tilt.value() < 0.0 { -2.0 / longest } else { 2.0 / longest };
            let level = normal_force / (s0 + s1 * ratio) / area;
            return Self { level, tilt: level * ratio, state: PressureState::Limited };
        }
        Self { level, tilt, state: PressureState::Negative }
    }

    /// Pressure where the shape has this value \[Pa\].
    #[inline]
    pub fn at(&self, x: T, shape: T) -> T {
        (self.level + self.tilt * x) * shape
    }
}
