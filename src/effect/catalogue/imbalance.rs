//! A wheel with its centre of gravity off its axis.

use super::operator::{bounded, harmonic};
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// w^2 (a cos(theta) + b sin(theta)) is added to a force.
pub const EFFECT: Effect = Effect {
    id: "imbalance",
    name: "Imbalance of a wheel",
    family: Family::Brake,
    port: Port::Output,
    also: &[],
    equation: "F = F_0 + w^2 (a cos(theta) + b sin(theta))",
    source: "standard engineering knowledge",
    signature: "a line at the first order of the wheel that grows with the square of the speed, with the wheel lifted too",
    confused_with: &[
        ("non-uniformity", "hardly grows with the speed, vanishes when lifted"),
        ("brake-torque-variation", "only while braking"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::WheelAngle, Role::WheelSpeed],
    parameters: &[
        Parameter::amplitude(
            "cosine",
            "Cosine part per square of the speed",
            Scale::of("1", 1, [0, -2, 0]),
            (-0.5, 0.5),
            (-1.0, 1.0),
            &[0.01],
        ),
        Parameter::amplitude(
            "sine",
            "Sine part per square of the speed",
            Scale::of("1", 1, [0, -2, 0]),
            (-0.5, 0.5),
            (-1.0, 1.0),
            &[0.01],
        ),
    ],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 && p[1] == 0.0 {
        return call.target;
    }
    let speed = bounded(call.drivers[1]);
    call.target + speed * speed * harmonic(p[0], p[1], call.drivers[0])
}
