//! A sensor that shows too much or too little.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Scale};

/// y_m = (1 + a) y.
pub const EFFECT: Effect = Effect {
    id: "sensor-gain",
    name: "Wrong gain of a sensor",
    family: Family::Sensor,
    port: Port::Output,
    also: &[],
    equation: "y_m = (1 + a) y",
    source: "standard engineering knowledge",
    signature: "a constant factor on one channel, in every condition",
    confused_with: &[
        (
            "drum-curvature",
            "only in forces of a tire: load and side force fall, rolling resistance rises; a known weight is right",
        ),
        ("rolling-radius", "the same on a wheel speed: a torque-free straight run at known speed tells"),
        ("pressure-dependent-friction", "changes with the pressure"),
    ],
    targets: &[],
    drivers: &[],
    parameters: &[Parameter::amplitude(
        "error",
        "Relative error of the gain",
        Scale::plain("1"),
        (-0.5, 0.5),
        (-2.0, 2.0),
        &[0.01],
    )],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 { call.target } else { call.target + p[0] * call.target }
}
