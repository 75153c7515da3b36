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
            of_session: false,
        },
        Parameter {
            name: "velocity",
            description: "Velocity at which three quarters of it act",
            scale: Scale::of("1", 0, [1, 0, 0]),
            off: None,
            plausible: (1e-4, 0.2),
            search: (1e-3, 0.2),
            probes: &[0.01, 0.1],
            of_session: false,
        },
    ],
    apply,
};

/// Of another size forwards than backwards, as gears, screws and brushes have it, or beside a constant force that no channel
/// shows. Where runs go one way only, one of both amplitudes has nothing to say.
pub const BY_DIRECTION: Effect = Effect {
    equation: "F = F_0 - F_c tanh(v / v_0), F_c = F_f for v > 0, F_b for v < 0",
    parameters: &[
        Parameter {
            name: "forwards",
            description: "Friction force at positive velocity",
            ..EFFECT.parameters[0]
        },
        Parameter {
            name: "backwards",
            description: "Friction force at negative velocity",
            ..EFFECT.parameters[0]
        },
        EFFECT.parameters[1],
    ],
    apply: |p, _: &mut Memory, call| {
        let velocity = call.drivers[0];
        let force = if velocity > 0.0 { p[0] } else { p[1] };
        if force == 0.0 { call.target } else { call.target - force * libm::tanh(velocity / p[2]) }
    },
    ..EFFECT
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 { call.target } else { call.target - p[0] * libm::tanh(call.drivers[0] / p[1]) }
}
