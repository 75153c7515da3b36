//! A contact on a drum.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// F sqrt(1 + c), c = r / R: tire radius over drum radius.
pub const EFFECT: Effect = Effect {
    id: "drum-curvature",
    name: "Drum instead of a flat road",
    family: Family::Tire,
    port: Port::Output,
    also: &[],
    equation: "F = F_0 sqrt(1 + c), c = r / R",
    source: "Freudenmann, Unrau, El-Haji 2009, TST 37(4):254-278 (form by Clark: standard engineering knowledge)",
    signature: "a constant factor on the forces of a tire",
    confused_with: &[
        ("sensor-gain", "on any channel; a known weight tells"),
        ("pressure-dependent-friction", "changes with the pressure"),
        ("load-sensitivity", "changes with the load"),
    ],
    targets: &[Role::Force],
    drivers: &[],
    parameters: &[Parameter::amplitude(
        "ratio",
        "Radius of the tire over that of the drum; negative if the model is on the drum",
        Scale::plain("1"),
        (-0.4, 0.9),
        (-0.6, 2.0),
        &[0.02],
    )],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 { call.target } else { call.target * (1.0 + p[0]).max(0.0).sqrt() }
}
