//! Drag in proportion to a velocity.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// -c v is added to a force.
pub const EFFECT: Effect = Effect {
    id: "viscous-drag",
    name: "Viscous drag",
    family: Family::Mechanism,
    port: Port::Force,
    also: &[],
    equation: "F = F_0 - c v",
    source: "standard engineering knowledge",
    signature: "a loop whose width grows with the velocity; nothing at rest",
    confused_with: &[
        ("coulomb-friction", "its loop has the same width at any velocity"),
        ("quadratic-damper", "grows with the square"),
        ("maxwell-element", "falls again at high frequency"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::Velocity],
    parameters: &[Parameter::amplitude(
        "damping",
        "Force per velocity",
        Scale::of("1", 1, [-1, 0, 0]),
        (0.0, 2.0),
        (-2.0, 2.0),
        &[0.02],
    )],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 { call.target } else { call.target - p[0] * call.drivers[0] }
}
