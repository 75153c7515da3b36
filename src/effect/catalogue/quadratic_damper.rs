//! A damper whose force grows with the square.

use super::operator::bounded;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// -c v |v| is added to a force.
pub const EFFECT: Effect = Effect {
    id: "quadratic-damper",
    name: "Damper with turbulent flow",
    family: Family::Suspension,
    port: Port::Force,
    also: &[],
    equation: "F = F_0 - c v |v|",
    source: "standard engineering knowledge",
    signature: "damping grows with the velocity; third harmonics in phase with it",
    confused_with: &[
        ("viscous-drag", "grows in proportion"),
        ("coulomb-friction", "does not grow"),
        ("aero-drag", "by the speed of travel"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::Velocity],
    parameters: &[Parameter::amplitude(
        "quadratic",
        "Force per square of the velocity",
        Scale::of("1", 1, [-2, 0, 0]),
        (0.0, 2.0),
        (-2.0, 2.0),
        &[0.02],
    )],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    let v = bounded(call.drivers[0]);
    if p[0] == 0.0 { call.target } else { call.target - p[0] * v * v.abs() }
}
