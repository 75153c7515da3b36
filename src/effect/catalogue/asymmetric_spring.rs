//! A spring that is stiffer on one side.

use super::operator::bounded;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// -k_2 x^2 is added to a force.
pub const EFFECT: Effect = Effect {
    id: "asymmetric-spring",
    name: "Spring that differs in push and pull",
    family: Family::Mechanism,
    port: Port::Force,
    also: &[],
    equation: "F = F_0 - k_2 x^2",
    source: "standard engineering knowledge",
    signature: "second harmonics and a mean that moves with the amplitude",
    confused_with: &[
        ("damper-asymmetry", "in phase with the velocity"),
        ("progressive-spring", "third harmonics"),
        ("bump-stop", "nothing at all until the stop is met"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::Position],
    parameters: &[Parameter::amplitude(
        "quadratic",
        "Force per square of the displacement",
        Scale::of("1", 1, [-2, 0, 0]),
        (-2.0, 2.0),
        (-2.0, 2.0),
        &[0.02],
    )],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    let x = bounded(call.drivers[0]);
    if p[0] == 0.0 { call.target } else { call.target - p[0] * x * x }
}
