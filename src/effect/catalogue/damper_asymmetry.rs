//! A damper with two slopes.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// -a |v| is added to a force.
pub const EFFECT: Effect = Effect {
    id: "damper-asymmetry",
    name: "Damper that differs in rebound and compression",
    family: Family::Suspension,
    port: Port::Force,
    also: &[],
    equation: "F = F_0 - a |v|",
    source: "standard engineering knowledge",
    signature: "even harmonics; the mean position moves with the roughness",
    confused_with: &[
        ("quadratic-damper", "third harmonics"),
        ("asymmetric-spring", "in phase with the displacement"),
        ("bump-stop", "in phase with the displacement, only at large ones"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::Velocity],
    parameters: &[Parameter::amplitude(
        "difference",
        "Half of the difference of the slopes",
        Scale::of("1", 1, [-1, 0, 0]),
        (-1.0, 1.0),
        (-2.0, 2.0),
        &[0.02],
    )],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 { call.target } else { call.target - p[0] * call.drivers[0].abs() }
}
