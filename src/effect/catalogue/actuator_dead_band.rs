//! An actuator to which a small command is none.

use super::actuator_lag::ACTUATED;
use super::hydraulic_hold_off;
use crate::effect::{Effect, Family, Parameter, Port, Scale};

/// x = sign(x_cmd) max(0, |x_cmd| - b).
pub const EFFECT: Effect = Effect {
    id: "actuator-dead-band",
    name: "Command that is needed before anything happens",
    family: Family::Rig,
    port: Port::Input,
    also: &[],
    equation: "x = sign(x_cmd) max(0, |x_cmd| - b)",
    source: "standard engineering knowledge",
    signature: "nothing at small commands, the same amount too little at large ones",
    confused_with: &[
        ("play", "only after a turn, at any command"),
        ("actuator-lag", "late at any command"),
        ("sensor-bias", "at zero too"),
    ],
    targets: ACTUATED,
    drivers: &[],
    parameters: &[Parameter::amplitude(
        "band",
        "Command that is lost",
        Scale::of("1", 1, [0, 0, 0]),
        (0.0, 0.5),
        (0.0, 1.0),
        &[0.01],
    )],
    apply: hydraulic_hold_off::apply,
};
