//! A wheel that is larger or smaller than thought.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// w = w_0 (1 + a).
pub const EFFECT: Effect = Effect {
    id: "rolling-radius",
    name: "Wrong rolling radius",
    family: Family::Brake,
    port: Port::Output,
    also: &[],
    equation: "w = w_0 (1 + a), a = R_0 / R - 1",
    source: "standard engineering knowledge",
    signature: "a constant factor on a wheel speed, with and without torque",
    confused_with: &[
        ("sensor-gain", "the same in the numbers: another tire on the same sensor tells"),
        ("tone-ring", "its mean over a revolution is right"),
    ],
    targets: &[Role::WheelSpeed],
    drivers: &[],
    parameters: &[Parameter::amplitude(
        "ratio",
        "Relative error of the ratio of wheel speed and travel speed",
        Scale::plain("1"),
        (-0.1, 0.1),
        (-1.0, 1.0),
        &[0.005],
    )],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 { call.target } else { call.target + p[0] * call.target }
}
