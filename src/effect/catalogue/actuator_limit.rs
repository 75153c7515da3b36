//! An actuator that can give only so much.

use super::actuator_lag::ACTUATED;
use super::saturation;
use crate::effect::{Effect, Family, Parameter, Port, Scale};

/// x = clamp(x_cmd, -L, L).
pub const EFFECT: Effect = Effect {
    id: "actuator-limit",
    name: "Actuator that gives only so much",
    family: Family::Rig,
    port: Port::Input,
    also: &[],
    equation: "x = x_cmd - a (x_cmd - min(max(x_cmd, -L), L)), a = 1",
    source: "standard engineering knowledge",
    signature: "large commands do no more than smaller ones; small ones are right",
    confused_with: &[
        ("actuator-rate-limit", "a large command is reached if it stays"),
        ("saturation", "one output only; the motion is right"),
        ("supply-sag", "large commands do less and less the longer they last"),
    ],
    targets: ACTUATED,
    drivers: &[],
    parameters: &[
        saturation::EFFECT.parameters[0],
        Parameter {
            description: "Largest command that is carried out",
            scale: Scale::of("1", 1, [0, 0, 0]),
            ..saturation::EFFECT.parameters[1]
        },
    ],
    apply: saturation::apply,
};
