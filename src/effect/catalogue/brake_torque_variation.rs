//! An uneven disc, seen in a force.

use super::operator::harmonic;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// p (a cos(theta) + b sin(theta)) is added to a force.
pub const EFFECT: Effect = Effect {
    id: "brake-torque-variation",
    name: "Brake torque that changes over a revolution",
    family: Family::Brake,
    port: Port::Output,
    also: &[],
    equation: "F = F_0 + p (a cos(theta) + b sin(theta))",
    source: "dbausa.com T004; fliphtml5 Automotive Chassis Engineering p324",
    signature: "a line at the first order of the wheel in proportion to the brake pressure",
    confused_with: &[
        ("disc-thickness-variation", "changes the motion of the wheel too"),
        ("non-uniformity", "without braking too"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::WheelAngle, Role::Pressure],
    parameters: &[
        Parameter::amplitude(
            "cosine",
            "Cosine part per pressure",
            Scale::of("1", 1, [0, -1, 0]),
            (-0.5, 0.5),
            (-1.0, 1.0),
            &[0.01],
        ),
        Parameter::amplitude(
            "sine",
            "Sine part per pressure",
            Scale::of("1", 1, [0, -1, 0]),
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
    call.target + call.drivers[1] * harmonic(p[0], p[1], call.drivers[0])
}
