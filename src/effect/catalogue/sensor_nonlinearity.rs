//! A sensor whose gain changes with what it shows.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Scale};

/// y_m = y + a y |y| + b y^2.
pub const EFFECT: Effect = Effect {
    id: "sensor-nonlinearity",
    name: "Curved characteristic of a sensor",
    family: Family::Sensor,
    port: Port::Output,
    also: &[],
    equation: "y_m = y + a y |y| + b y^2",
    source: "standard engineering knowledge",
    signature: "distortion of one channel by its own value, whatever moves it",
    confused_with: &[
        ("progressive-spring", "changes the motion, and with it the other channels"),
        ("saturation", "flat above a limit"),
    ],
    targets: &[],
    drivers: &[],
    parameters: &[
        Parameter::amplitude(
            "odd",
            "Curvature that is equal on both sides of zero",
            Scale::of("1", -1, [0, 0, 0]),
            (-0.5, 0.5),
            (-2.0, 2.0),
            &[0.02],
        ),
        Parameter::amplitude(
            "even",
            "Curvature that differs on both sides of zero",
            Scale::of("1", -1, [0, 0, 0]),
            (-0.5, 0.5),
            (-2.0, 2.0),
            &[0.02],
        ),
    ],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 && p[1] == 0.0 {
        return call.target;
    }
    let y = call.target;
    y + y.abs() * (p[0] * y + p[1] * y.abs())
}
