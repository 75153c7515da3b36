//! A line at a fixed frequency that nothing in the machine makes.

use super::operator::harmonic;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Scale};

/// y_m = y + a cos(2 pi f t) + b sin(2 pi f t).
pub const EFFECT: Effect = Effect {
    id: "mains-hum",
    name: "Hum of the mains",
    family: Family::Sensor,
    port: Port::Output,
    also: &[],
    equation: "y_m = y + a cos(2 pi f t) + b sin(2 pi f t)",
    source: "standard engineering knowledge",
    signature: "a line at a fixed frequency, at rest too, with the same phase from start to end",
    confused_with: &[("frame-resonance", "needs excitation"), ("belt-order", "moves with the speed")],
    targets: &[],
    drivers: &[],
    parameters: &[
        Parameter::amplitude(
            "cosine",
            "Cosine part",
            Scale::of("1", 1, [0, 0, 0]),
            (-0.5, 0.5),
            (-1.0, 1.0),
            &[0.01],
        ),
        Parameter::amplitude(
            "sine",
            "Sine part",
            Scale::of("1", 1, [0, 0, 0]),
            (-0.5, 0.5),
            (-1.0, 1.0),
            &[0.01],
        ),
        Parameter::shape(
            "frequency",
            "Frequency",
            Scale::plain("Hz"),
            (45.0, 65.0),
            (40.0, 125.0),
            &[50.0, 60.0],
        ),
    ],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 && p[1] == 0.0 {
        return call.target;
    }
    call.target + harmonic(p[0], p[1], std::f64::consts::TAU * p[2] * call.time)
}
