//! A tire that is a cone.

use super::operator::bounded;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// F + c |Fz| r, r being 1 while it rolls in any direction.
pub const EFFECT: Effect = Effect {
    id: "conicity",
    name: "Conicity",
    family: Family::Tire,
    port: Port::Output,
    also: &[],
    equation: "F = F_0 + c |Fz| r, r = V^2 / (V^2 + (0.1 m/s)^2)",
    source: "micropoise.com conicity: half the sum of the lateral shifts in both directions",
    signature: "an offset of the lateral force with the same sign in both directions, gone at standstill",
    confused_with: &[
        ("plysteer", "turns with the direction"),
        ("sensor-bias", "at standstill and without load too"),
        ("camber-thrust", "with the camber"),
    ],
    targets: &[Role::LateralForce],
    drivers: &[Role::Load, Role::TravelSpeed],
    parameters: &[Parameter::amplitude(
        "coefficient",
        "Force per load",
        Scale::of("1", 1, [-1, 0, 0]),
        (-0.5, 0.5),
        (-1.0, 1.0),
        &[0.01],
    )],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 {
        return call.target;
    }
    let pace = bounded(call.drivers[1]) / 0.1;
    let rolls = 1.0 - 1.0 / (1.0 + pace * pace);
    call.target + p[0] * call.drivers[0].abs() * rolls
}
