//! A tire that is not the same all around.

use super::operator::harmonic;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// |Fz| (a cos(theta) + b sin(theta)) is added to a force.
pub const EFFECT: Effect = Effect {
    id: "non-uniformity",
    name: "Non-uniformity of a tire",
    family: Family::Tire,
    port: Port::Output,
    also: &[],
    equation: "F = F_0 + |Fz| (a cos(theta) + b sin(theta))",
    source: "TST 17(3):158; TST 39(4):256",
    signature: "a line at the first order of the wheel that goes with the load and hardly with the speed",
    confused_with: &[
        ("imbalance", "grows with the square of the speed, stays when lifted"),
        ("brake-torque-variation", "only while braking"),
        ("tone-ring", "in the wheel speed alone"),
        ("belt-order", "fixed to the road, not to the wheel"),
    ],
    targets: &[Role::Force, Role::Load],
    drivers: &[Role::WheelAngle, Role::Load],
    parameters: &[
        Parameter::amplitude(
            "cosine",
            "Cosine part per load",
            Scale::of("1", 1, [0, -1, 0]),
            (-0.3, 0.3),
            (-1.0, 1.0),
            &[0.005],
        ),
        Parameter::amplitude(
            "sine",
            "Sine part per load",
            Scale::of("1", 1, [0, -1, 0]),
            (-0.3, 0.3),
            (-1.0, 1.0),
            &[0.005],
        ),
    ],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 && p[1] == 0.0 {
        return call.target;
    }
    call.target + call.drivers[1].abs() * harmonic(p[0], p[1], call.drivers[0])
}
