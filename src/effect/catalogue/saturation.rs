//! A sensor at its limit.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Scale};

/// y_m = y - a (y - clamp(y, -L, L)).
pub const EFFECT: Effect = Effect {
    id: "saturation",
    name: "Saturated sensor or amplifier",
    family: Family::Sensor,
    port: Port::Output,
    also: &[],
    equation: "y_m = y - a (y - min(max(y, -L), L)), a = 1",
    source: "standard engineering knowledge",
    signature: "flat tops at a fixed value of one channel",
    confused_with: &[
        ("loss-of-contact", "clips at zero load and on one side only"),
        ("bump-stop", "changes the motion, and with it the other channels"),
    ],
    targets: &[],
    drivers: &[],
    parameters: &[
        Parameter::amplitude(
            "share",
            "How much of the excess is cut: 1 when it is there",
            Scale::plain("1"),
            (0.3, 1.3),
            (-0.5, 1.5),
            &[0.1],
        ),
        Parameter::shape(
            "limit",
            "Largest value that is shown",
            Scale::of("1", 1, [0, 0, 0]),
            (0.05, 2.0),
            (0.05, 2.0),
            &[0.5, 0.8, 1.1],
        ),
    ],
    apply,
};

pub(super) fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 {
        return call.target;
    }
    let limit = p[1].abs();
    call.target - p[0] * (call.target - call.target.clamp(-limit, limit))
}
