//! The flat-track rig: from commands to the motion of the rim, and from its load to the axes of the load cell (9 of the
//! specification). The road stands still and the rim travels.

use super::frames::{Motion, Vector};
use super::parameters::Parameters;

/// Commands in the order of the columns: steer, deflection, path speed, camber, slip, slip angle.
pub(crate) type Commands = [f64; 6];

pub(crate) const STEER: usize = 0;
pub(crate) const DEFLECTION: usize = 1;
pub(crate) const SPEED: usize = 2;
pub(crate) const CAMBER: usize = 3;
pub(crate) const SLIP: usize = 4;
pub(crate) const SLIP_ANGLE: usize = 5;

/// Moves the rim on by `dt`, from where it was to what is commanded now (4.36). The slip angle of the commands is that
/// of ISO 8855, so that the α of the specification is its negative.
pub(crate) fn follow(p: &Parameters, rim: &Motion, u: &Commands, before: &Commands, dt: f64) -> Motion {
    let heading = u[STEER] + u[SLIP_ANGLE];
    let rate = |k: usize| (u[k] - before[k]) / dt;
    let (sine, cosine) = libm::sincos(heading);
    let spin = (u[SLIP] + 1.0) * u[SPEED] * libm::cos(u[SLIP_ANGLE]) / p.rolling_radius;
    let mut now = Motion {
        place: [rim.place[0], rim.place[1], p.tire_radius - u[DEFLECTION]],
        velocity: [u[SPEED] * cosine, u[SPEED] * sine, -rate(DEFLECTION)],
        angles: [u[CAMBER], rim.angles[1], u[STEER]],
        rates: [rate(CAMBER), spin, rate(STEER)],
    };
    // trapezoids
    for k in 0..2 {
        now.place[k] += 0.5 * dt * (rim.velocity[k] + now.velocity[k]);
    }
    now.angles[1] += 0.5 * dt * (rim.rates[1] + now.rates[1]);
    now
}

/// From inertial to H axes (4.37): it turns with the steer angle alone.
pub(crate) fn horizontal(v: Vector, steer: f64) -> Vector {
    let (s, c) = libm::sincos(steer);
    [c * v[0] + s * v[1], -s * v[0] + c * v[1], v[2]]
}
