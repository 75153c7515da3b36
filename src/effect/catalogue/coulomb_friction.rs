//! Dry friction of a guide or joint.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// -F_c tanh(v / v_0) is added to a force.
pub const EFFECT: Effect = Effect {
    id: "coulomb-friction",
    name: "Coulomb friction",
    family: Family::Mechanism,
    port: Port::Force,
    also: &[],
    equation: "F = F_0 - F_c tanh(v / v_0)",
    source: "standard engineering knowledge",
    signature: "a square wave in phase with the velocity; a loop whose width depends on neither amplitude nor frequency",
    confused_with: &[
        ("viscous-drag", "its loop grows with the velocity"),
        ("stribeck-friction", "has a peak at each turn"),
        ("bouc-wen", "does not jump at a turn"),
        ("guide-friction", "only the load cell feels it, the motion is right"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::Velocity],
    parameters: &[
        Parameter {
            name: "force",
            description: "Friction force",
            scale: Scale::of("1", 1, [0, 0, 0]),
            off: Some(0.0),
            plausible: (0.0, 2.0),
            search: (-2.0, 2.0),
            probes: &[0.02, 0.06, 0.2, 0.6],
        },
        Parameter {
            name: "velocity",
            description: "Velocity at which three quarters of it act",
            scale: Scale::of("1", 0, [1, 0, 0]),
            off: None,
            plausible: (1e-4, 0.2),
            search: (1e-3, 0.2),
            probes: &[0.01, 0.1],
        },
    ],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 { call.target } else { call.target - p[0] * libm::tanh(call.drivers[0] / p[1]) }
}
