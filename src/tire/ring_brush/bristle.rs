//! One bristle: a spring-damper between its top, which moves with the patch, and its bottom, which
//! sticks to the road or slides on it (4.30)-(4.33).

use super::Parameters;
use crate::solver::Real;

/// Friction limits of a bristle \[N\]: the coefficients at its pressure times its normal force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits<T> {
    /// Up to here it sticks.
    pub sticking: T,
    /// With this it slides.
    pub sliding: T,
}

impl<T: Real> Limits<T> {
    /// The limits at a pressure \[Pa\] and normal force \[N\]. Linear in the pressure and extrapolated
    /// beyond the reference pressure (4.32); neither limit is negative.
    #[inline]
    pub fn new(p: &Parameters, pressure: T, normal_force: T) -> Self {
        let zero = T::zero();
        if normal_force.value() <= 0.0 {
            return Self { sticking: zero, sliding: zero };
        }
        let share = pressure * (p.friction_pressure_scale / p.friction_pressure);
        let limit = |[at_zero, at_reference]: [f64; 2]| {
            (share * (at_reference - at_zero) + at_zero).or_at_least(0.0) * normal_force
        };
        Self { sticking: limit(p.friction_static), sliding: limit(p.friction_sliding) }
    }
}

/// What a bristle did in a time step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step<T> {
    /// Deflection at the end, bottom minus top \[m\].
    pub deflection: [T; 2],
    /// It sticks at the end.
    pub stick: bool,
    /// Force on the patch \[N\].
    pub force: [T; 2],
    /// Speed of the bottom over the road \[m/s\].
    pub slip_speed: T,
}

/// Advances a bristle by `dt` with the implicit radial return.
///
/// `deflection` is the one before, `velocity` that of the top, `stick` the memory. The trial force
/// is that of a bottom that stays where it is; if it is too large the bottom slides, with the force
/// cut back along the same direction: the exact solution of the backward Euler step, for any `dt`.
/// Where the friction falls with the sliding speed, that is the speed of the *top*: the bottom's own
/// differs from it only while a bristle snaps back, within its time constant d/c of 16 us, and would
/// make a bristle unstable whose friction falls faster than its damper rises.
/// A sliding bristle sticks again when its bottom comes to rest, that is when the trial force falls
/// to the *sliding* limit.
#[inline]
pub fn advance<T: Real>(
    p: &Parameters,
    deflection: [T; 2],
    velocity: [T; 2],
    stick: bool,
    limits: &Limits<T>,
    dt: T,
) -> Step<T> {
    let (c, d) = (p.bristle_stiffness, p.bristle_damping);
    let trial: [T; 2] = std::array::from_fn(|k| (deflection[k] - dt * velocity[k]) * c - velocity[k] * d);
    let size = norm(trial);
    let sliding = p.friction_at_speed(limits.sliding, velocity);
    let bound = if stick { limits.sticking } else { sliding };
    let relaxed = dt * c + d;
    let stick = bound.value() > 0.0 && size <= bound;
    let (force, slip_speed) = if stick {
        (trial, T::zero())
    } else if size.value() > 0.0 {
        let cut = sliding / size;
        (trial.map(|w| w * cut), (size - sliding) / relaxed)
    } else {
        (trial, T::zero())
    };
    let deflection = std::array::from_fn(|k| (force[k] * dt + deflection[k] * d) / relaxed);
    Step { deflection, stick, force, slip_speed }
}

/// Length of a vector.
pub(super) fn norm<T: Real>([x, y]: [T; 2]) -> T {
    (x * x + y * y).sqrt()
}
