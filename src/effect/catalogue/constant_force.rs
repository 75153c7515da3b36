//! A force that is always there.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// b is added to a force.
pub const EFFECT: Effect = Effect {
    id: "constant-force",
    name: "Constant force",
    family: Family::Mechanism,
    port: Port::Force,
    also: &[],
    equation: "F = F_0 + b",
    source: "standard engineering knowledge",
    signature: "the same push in every run, at rest and in motion: a weight, a tilt, a preload, the offset of a measured force",
    confused_with: &[
        ("coulomb-friction", "turns with the motion"),
        ("sensor-bias", "one output only; the motion is right"),
    ],
    targets: &[Role::Force],
    drivers: &[],
    parameters: OFFSET,
    apply,
};

/// What is added, whatever else there is.
pub(super) const OFFSET: &[Parameter] = &[Parameter::amplitude(
    "offset",
    "What is there where nothing should be",
    Scale::of("1", 1, [0, 0, 0]),
    (-1.0, 1.0),
    (-2.0, 2.0),
    &[0.02],
)];

pub(super) fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 { call.target } else { call.target + p[0] }
}
