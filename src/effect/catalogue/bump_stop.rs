//! A stop at the end of the way.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// -k (x - g) is added to a force beyond the gap g, on either side with a stiffness of its own.
pub const EFFECT: Effect = Effect {
    id: "bump-stop",
    name: "Bump stop",
    family: Family::Suspension,
    port: Port::Force,
    also: &[],
    equation: "F = F_0 - k_+ max(0, x - g) + k_- max(0, -x - g)",
    source: "standard engineering knowledge",
    signature: "one-sided peaks when the way is used up; nothing below",
    confused_with: &[
        ("progressive-spring", "acts at small displacements too"),
        ("saturation", "flat tops in one channel, the motion goes on"),
        ("asymmetric-spring", "acts at small displacements too"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::Position],
    parameters: &[
        Parameter::amplitude(
            "upper",
            "Stiffness of the stop on the positive side",
            Scale::of("1", 1, [-1, 0, 0]),
            (0.0, 30.0),
            (-30.0, 30.0),
            &[0.05, 1.0, 5.0],
        ),
        Parameter::amplitude(
            "lower",
            "Stiffness of the stop on the negative side",
            Scale::of("1", 1, [-1, 0, 0]),
            (0.0, 30.0),
            (-30.0, 30.0),
            &[0.05, 1.0, 5.0],
        ),
        Parameter::shape(
            "gap",
            "Way to the stop",
            Scale::of("1", 0, [1, 0, 0]),
            (0.0, 1.5),
            (0.0, 1.5),
            &[0.4, 0.7],
        ),
    ],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 && p[1] == 0.0 {
        return call.target;
    }
    let x = call.drivers[0];
    call.target - p[0] * (x - p[2]).max(0.0) + p[1] * (-x - p[2]).max(0.0)
}
