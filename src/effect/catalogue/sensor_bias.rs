//! A sensor that shows a number at zero.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Scale};

/// y_m = y + b.
pub const EFFECT: Effect = Effect {
    id: "sensor-bias",
    name: "Offset of a sensor",
    family: Family::Sensor,
    port: Port::Output,
    also: &[],
    equation: "y_m = y + b",
    source: "standard engineering knowledge",
    signature: "the same at rest, without load and in every run",
    confused_with: &[("conicity", "vanishes when the wheel stands"), ("sensor-drift", "grows with time")],
    targets: &[],
    drivers: &[],
    parameters: &[Parameter::amplitude(
        "offset",
        "What is shown at zero",
        Scale::of("1", 1, [0, 0, 0]),
        (-1.0, 1.0),
        (-2.0, 2.0),
        &[0.02],
    )],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 { call.target } else { call.target + p[0] }
}
