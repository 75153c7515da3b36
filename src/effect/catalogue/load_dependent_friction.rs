//! Friction of gears and bearings that carry a load.

use super::operator::soft_sign;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// -K |N| tanh(v / v_0) is added to a force.
pub const EFFECT: Effect = Effect {
    id: "load-dependent-friction",
    name: "Friction in proportion to a load",
    family: Family::Mechanism,
    port: Port::Force,
    also: &[],
    equation: "F = F_0 - K |N| tanh(v / v_0)",
    source: "github Rhoban/bam docs; Duclusaud et al. arXiv 2410.08650 (gear friction in proportion to the load)",
    signature: "square in phase with the velocity, with a size that follows the load",
    confused_with: &[
        ("coulomb-friction", "the same at any load"),
        ("rolling-resistance", "in a force output of a tire"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::Velocity, Role::Force],
    parameters: &[
        Parameter::amplitude(
            "coefficient",
            "Friction per load",
            Scale::of("1", 1, [0, -1, 0]),
            (0.0, 1.0),
            (-1.0, 1.0),
            &[0.02, 0.1, 0.4],
        ),
        Parameter::shape(
            "velocity",
            "Velocity at which three quarters of it act",
            Scale::of("1", 0, [1, 0, 0]),
            (0.0001, 0.2),
            (0.001, 0.2),
            &[0.02, 0.1],
        ),
    ],
    apply,
};

/// Beside a part that is there without a load, as gears and screws under preload have it.
pub const WITH_BASE: Effect = Effect {
    equation: "F = F_0 - (F_c + K |N|) tanh(v / v_0)",
    parameters: &[
        Parameter { name: "per_load", ..EFFECT.parameters[0] },
        Parameter::amplitude(
            "force",
            "Friction force without a load",
            Scale::of("1", 1, [0; 3]),
            (0.0, 2.0),
            (-2.0, 2.0),
            &[0.02, 0.06, 0.2],
        ),
        EFFECT.parameters[1],
    ],
    apply: |p, _: &mut Memory, call| {
        let force = p[1] + p[0] * call.drivers[1].abs();
        if force == 0.0 { call.target } else { call.target - force * soft_sign(call.drivers[0], p[2]) }
    },
    ..EFFECT
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 {
        return call.target;
    }
    call.target - p[0] * call.drivers[1].abs() * soft_sign(call.drivers[0], p[1])
}
