//! Sliding friction that falls with the sliding speed, as in Stribeck's curve of rubber.

use super::operator::bounded;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// The coefficient falls from its static to its sliding value; the contact slides along one axis.
pub const EFFECT: Effect = Effect {
    id: "speed-dependent-friction",
    name: "Friction that falls with the sliding speed",
    family: Family::Tire,
    port: Port::Output,
    also: &[(Port::Parameter, Role::Friction)],
    equation: "F = F_0 (1 - a (1 - exp(-(v_s / v_0)^n))), v_s = slip V",
    source: "Canudas-de-Wit et al. 2003, VSD 39(3):189-226 (form: standard engineering knowledge; n from 0.5 to 2)",
    signature: "too much force past the peak, the more the faster the contact slides",
    confused_with: &[
        ("thermal-softening", "depends on what went before: reverse the order of runs"),
        ("falling-branch", "depends on the slip, not on the speed: two speeds tell"),
        ("stribeck-friction", "a force on the motion, in any mechanism"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::Slip, Role::TravelSpeed],
    parameters: PARAMETERS,
    apply: |p, _: &mut Memory, call| less(p, call, bounded(call.drivers[0]) * bounded(call.drivers[1])),
};

/// The same where the contact slides along both axes.
pub const BOTH_AXES: Effect = Effect {
    equation: "F = F_0 (1 - a (1 - exp(-(v_s / v_0)^n))), v_s = V sqrt(slip^2 + tan^2(alpha))",
    drivers: &[Role::TravelSpeed, Role::SlipAngle, Role::Slip],
    parameters: PARAMETERS_OF_BOTH,
    apply: |p, _: &mut Memory, call| {
        let slip = libm::hypot(bounded(call.drivers[2]), libm::tan(bounded(call.drivers[1])));
        less(p, call, slip * bounded(call.drivers[0]))
    },
    ..EFFECT
};

/// The same where the slip along the wheel is known from its speed of rotation only.
pub const BY_WHEEL_SPEED: Effect = Effect {
    equation: "F = F_0 (1 - a (1 - exp(-(v_s / v_0)^n))), v_s = sqrt((V - R w)^2 + V^2 tan^2(alpha))",
    drivers: &[Role::TravelSpeed, Role::SlipAngle, Role::WheelSpeed],
    parameters: &[LOSS, VELOCITY_OF_BOTH, EXPONENT, RADIUS],
    apply: |p, _: &mut Memory, call| {
        let d = |i: usize| bounded(call.drivers[i]);
        less(p, call, libm::hypot(d(0) - p[3] * d(2), d(0) * libm::tan(d(1))))
    },
    ..EFFECT
};

const LOSS: Parameter = Parameter::amplitude(
    "loss",
    "Share that is lost in fast sliding",
    Scale::plain("1"),
    (0.0, 0.8),
    (-1.0, 1.0),
    &[0.02],
);

const EXPONENT: Parameter = Parameter::shape(
    "exponent",
    "How suddenly it is lost: 1 for an exponential",
    Scale::plain("1"),
    (0.4, 2.5),
    (0.5, 2.0),
    &[1.0],
);

const VELOCITY: Parameter = Parameter::shape(
    "velocity",
    "Sliding speed at which 63 % of it are lost",
    Scale::of("1", 0, [1, 1, 0]),
    (0.01, 10.0),
    (0.01, 10.0),
    &[0.1, 0.4, 1.0, 3.0],
);

/// Slips are far below 1, so that the speed of the contact is a small share of the travel's.
const VELOCITY_OF_BOTH: Parameter = Parameter::shape(
    "velocity",
    "Sliding speed at which 63 % of it are lost",
    Scale::of("1", 0, [1, 0, 0]),
    (0.0005, 1.0),
    (0.0005, 1.0),
    &[0.005, 0.02, 0.05, 0.15],
);

/// Speed over speed of rotation, which the recordings tell to a few percent.
const RADIUS: Parameter = Parameter::shape(
    "radius",
    "Rolling radius, at which a wheel that rolls freely does not slide",
    Scale::of("1", 0, [1, 0, -1]),
    (0.8, 1.25),
    (0.8, 1.25),
    &[1.01],
);

const PARAMETERS: &[Parameter] = &[LOSS, VELOCITY, EXPONENT];
const PARAMETERS_OF_BOTH: &[Parameter] = &[LOSS, VELOCITY_OF_BOTH, EXPONENT];

fn less(p: &[f64], call: &Call<'_>, sliding: f64) -> f64 {
    if p[0] == 0.0 || p[1] <= 0.0 {
        return call.target;
    }
    call.target * (1.0 + p[0] * libm::expm1(-libm::pow(sliding.abs() / p[1], p[2])))
}
