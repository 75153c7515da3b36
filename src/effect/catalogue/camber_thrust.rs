//! A lateral force of a tire that leans.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// F - C camber, at one load: by ISO 8855 a positive camber leans the top of the wheel to its right (-y), and the thrust
/// goes to the side of the lean.
pub const EFFECT: Effect = Effect {
    id: "camber-thrust",
    name: "Camber thrust",
    family: Family::Tire,
    port: Port::Output,
    also: &[],
    equation: "F = F_0 - C camber",
    source: "MF-Tyre/MF-Swift 6.2 equation manual (linear part)",
    signature: "against the camber (ISO 8855), at any slip angle",
    confused_with: &[("cross-talk", "a copy of a channel by the sensor"), ("conicity", "without camber too")],
    targets: &[Role::LateralForce],
    drivers: &[Role::Camber],
    parameters: &[Parameter::amplitude(
        "camber_stiffness",
        "Force to the side of the lean per camber; negative if the model has too much of it",
        Scale::of("1", 1, [-1, 0, 0]),
        (-2.0, 2.0),
        (-2.0, 2.0),
        &[0.02],
    )],
    apply,
};

/// A stiffness in proportion to the load.
pub const BY_LOAD: Effect = Effect {
    equation: "F = F_0 - c |Fz| camber",
    drivers: &[Role::Camber, Role::Load],
    parameters: &[Parameter::amplitude(
        "camber_stiffness_per_load",
        "Force to the side of the lean per camber and load; negative if the model has too much of it",
        Scale::of("1", 1, [-1, -1, 0]),
        (-2.0, 2.0),
        (-2.0, 2.0),
        &[0.02],
    )],
    apply: |p, _: &mut Memory, call: &Call<'_>| {
        if p[0] == 0.0 { call.target } else { call.target - p[0] * call.drivers[0] * call.drivers[1].abs() }
    },
    ..EFFECT
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 { call.target } else { call.target - p[0] * call.drivers[0] }
}
