//! Mass that the model does not have.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// -m a is added to a force.
pub const EFFECT: Effect = Effect {
    id: "added-inertia",
    name: "Mass that moves along",
    family: Family::Suspension,
    port: Port::Force,
    also: &[],
    equation: "F = F_0 - m a",
    source: "standard engineering knowledge",
    signature: "in phase with the acceleration; grows with the square of the frequency",
    confused_with: &[
        ("fixture-inertia", "only the load cell sees it, the motion does not"),
        ("progressive-spring", "in phase with the displacement"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::Acceleration],
    parameters: &[Parameter::amplitude(
        "mass",
        "Mass, or moment of inertia",
        Scale::of("1", 1, [-1, 0, 0]),
        (0.0, 0.9),
        (-0.9, 0.9),
        &[0.02],
    )],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 { call.target } else { call.target - p[0] * call.drivers[0] }
}
