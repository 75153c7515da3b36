//! A converter with few steps.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Scale};

/// y_m = y + a (q round(y / q) - y).
pub const EFFECT: Effect = Effect {
    id: "quantisation",
    name: "Coarse steps of a converter",
    family: Family::Sensor,
    port: Port::Output,
    also: &[],
    equation: "y_m = y + a (q round(y / q) - y), a = 1",
    source: "standard engineering knowledge",
    signature: "a saw tooth of the own value; the histogram has gaps",
    confused_with: &[("coulomb-friction", "square in the velocity, not in the value")],
    targets: &[],
    drivers: &[],
    parameters: &[
        Parameter::amplitude(
            "share",
            "How much of the rounding acts: 1 when it is there",
            Scale::plain("1"),
            (0.3, 1.3),
            (-0.5, 1.5),
            &[0.1],
        ),
        Parameter::shape(
            "step",
            "Distance of the steps",
            Scale::of("1", 1, [0, 0, 0]),
            (0.0001, 0.5),
            (0.001, 1.0),
            &[0.02, 0.1],
        ),
    ],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 || p[1] <= 0.0 {
        return call.target;
    }
    call.target + p[0] * (p[1] * (call.target / p[1]).round() - call.target)
}
