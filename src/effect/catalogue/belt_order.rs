//! A seam or waviness that comes by again and again.

use super::operator::{bounded, harmonic};
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// y = y_0 + a cos(2 pi s / L) + b sin(2 pi s / L).
pub const EFFECT: Effect = Effect {
    id: "belt-order",
    name: "Line that repeats along the belt or road",
    family: Family::Rig,
    port: Port::Output,
    also: &[],
    equation: "y = y_0 + a cos(2 pi s / L) + b sin(2 pi s / L)",
    source: "standard engineering knowledge",
    signature: "a line whose frequency goes with the speed, fixed in metres",
    confused_with: &[
        ("frame-resonance", "fixed in Hz: two speeds tell"),
        ("non-uniformity", "fixed to the angle of the wheel: slip or another roller tells"),
        ("mains-hum", "fixed in Hz"),
    ],
    targets: &[],
    drivers: &[Role::TravelDistance],
    parameters: &[
        Parameter::amplitude(
            "cosine",
            "Cosine part",
            Scale::of("1", 1, [0, 0, 0]),
            (-2.0, 2.0),
            (-2.0, 2.0),
            &[0.02],
        ),
        Parameter::amplitude(
            "sine",
            "Sine part",
            Scale::of("1", 1, [0, 0, 0]),
            (-2.0, 2.0),
            (-2.0, 2.0),
            &[0.02],
        ),
        Parameter::shape(
            "length",
            "Distance after which it repeats",
            Scale::plain("m"),
            (0.05, 50.0),
            (0.02, 100.0),
            &LENGTHS,
        ),
    ],
    apply,
};

/// From 0.5 m to 13 m, so close that over 100 m none is half a period off at either end.
const LENGTHS: [f64; 220] = {
    let mut all = [0.5; 220];
    let mut i = 1;
    while i < all.len() {
        all[i] = 1.015 * all[i - 1];
        i += 1;
    }
    all
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if (p[0] == 0.0 && p[1] == 0.0) || p[2] <= 0.0 {
        return call.target;
    }
    call.target + harmonic(p[0], p[1], std::f64::consts::TAU * (bounded(call.drivers[0]) / p[2]))
}
