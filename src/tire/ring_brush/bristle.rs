//! One bristle: a spring-damper between its top, which moves with the patch, and its bottom, which
//! sticks to the road or slides on it (4.30)-(4.33).

use super::friction::at_speed;
use super::turning::Slid;
use super::{Limits, Parameters};
use crate::solver::Real;

/// What a bristle did in a time step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step<T> {
    /// Deflection at the end, bottom minus top \[m\].
    pub deflection: [T; 2],
    /// It sticks at the end.
    pub stick: bool,
    /// Force on the patch \[N\].
    pub force: [T; 2],
    /// Speed of the bottom over the road, as far as it does work against the friction: along its force \[m/s\].
    pub slip_speed: T,
}

/// Advances a bristle by `dt`.
///
/// `deflection` is the one before, `velocity` that of the top, `stick` the memory. The trial force
/// is that of a bottom that stays where it is; if it is too large the bottom slides, with the force
/// cut back to the friction. As printed, with `whole_step_entry`, it keeps its direction: the exact
/// solution of the backward Euler step, for any `dt`, of first order in it. Else it turns as a bristle
/// that slides does, from where it breaks away on.
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
    let sliding = at_speed(p, limits.sliding, velocity);
    let stuck = stick;
    let bound = if stuck { limits.sticking } else { sliding };
    let relaxed = dt * c + d;
    let stick = bound.value() > 0.0 && size <= bound;
    let (force, slip_speed) = if stick {
        (trial, T::zero())
    } else if size.value() > 0.0 {
        let dragged = velocity.map(|v| v * (dt * c));
        let held = if stuck { bound } else { -T::one() };
        let force = if p.whole_step_entry {
            trial.map(|w| w * (sliding / size))
        } else {
            Slid { trial, dragged, held }.force(size, sliding)
        };
        (force, (size - sliding) / relaxed)
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
