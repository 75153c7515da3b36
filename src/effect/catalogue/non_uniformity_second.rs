//! A tire that is not the same all around, twice per revolution.

use super::non_uniformity;
use super::operator::harmonic;
use crate::effect::{Call, Effect, Memory};

/// |Fz| (a cos(2 theta) + b sin(2 theta)) is added to a force; all else as for the first order.
pub const EFFECT: Effect = Effect {
    id: "non-uniformity-second",
    name: "Non-uniformity of a tire, second order",
    equation: "F = F_0 + |Fz| (a cos(2 theta) + b sin(2 theta))",
    signature: "a line at the second order of the wheel that goes with the load and hardly with the speed",
    confused_with: &[
        ("non-uniformity", "once per revolution"),
        ("brake-torque-variation", "only while braking"),
        ("tone-ring", "in the wheel speed alone"),
        ("belt-order", "fixed to the road, not to the wheel"),
    ],
    apply,
    ..non_uniformity::EFFECT
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 && p[1] == 0.0 {
        return call.target;
    }
    call.target + call.drivers[1].abs() * harmonic(p[0], p[1], 2.0 * call.drivers[0])
}
