//! A joint that turns a little before it takes something along.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// The inner part follows when the gap of 2 b is used up.
pub const EFFECT: Effect = Effect {
    id: "play",
    name: "Play in a joint",
    family: Family::Suspension,
    port: Port::Input,
    also: &[],
    equation: "y = min(max(y_last, x - b), x + b)",
    source: "standard engineering knowledge",
    signature: "after each turn nothing moves for a while; the loop has the same width at any amplitude and speed",
    confused_with: &[
        ("sensor-delay", "fixed in time"),
        ("coulomb-friction", "stiction: no flat in the motion"),
        ("bouc-wen", "no sharp corners"),
    ],
    targets: &[Role::Position, Role::SlipAngle, Role::Camber],
    drivers: &[],
    parameters: &[Parameter::amplitude(
        "gap",
        "Half of the gap",
        Scale::of("1", 1, [0, 0, 0]),
        (0.0, 0.5),
        (0.0, 1.0),
        &[0.01],
    )],
    apply,
};

fn apply(p: &[f64], memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] <= 0.0 {
        return call.target;
    }
    let last = if call.dt > 0.0 { memory.states[0] } else { call.target };
    memory.states[0] = last.max(call.target - p[0]).min(call.target + p[0]);
    memory.states[0]
}
