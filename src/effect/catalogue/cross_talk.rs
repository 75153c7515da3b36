//! A channel that carries some of another.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// y_m = y + c z.
pub const EFFECT: Effect = Effect {
    id: "cross-talk",
    name: "Cross-talk from another channel",
    family: Family::Sensor,
    port: Port::Output,
    also: &[],
    equation: "y_m = y + c z",
    source: "standard engineering knowledge",
    signature: "a copy of another channel, without delay, in every condition",
    confused_with: &[
        ("camber-thrust", "a force that the camber makes; it is there with another sensor too"),
        ("sensor-gain", "a copy of its own"),
    ],
    targets: &[],
    drivers: &[Role::Other],
    parameters: &[Parameter::amplitude(
        "share",
        "How much of the other channel is added",
        Scale::of("1", 1, [-1, 0, 0]),
        // a channel that should be at rest has nothing else, and a moment about another point may have more of a force
        // than of itself
        (-5.0, 5.0),
        (-6.0, 6.0),
        &[0.02],
    )],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 { call.target } else { call.target + p[0] * call.drivers[0] }
}
