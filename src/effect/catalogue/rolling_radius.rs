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
    parameters: &[RATIO],
    apply: |p, _: &mut Memory, call| call.target + p[0] * call.target,
};

/// A radius that falls with the load.
pub const BY_LOAD: Effect = Effect {
    equation: "w = w_0 (1 + a + b |Fz|)",
    drivers: &[Role::Load],
    parameters: &[
        RATIO,
        Parameter::amplitude(
            "per_load",
            "Relative error of the ratio per load",
            Scale::of("1", 0, [-1, 0, 0]),
            (-0.2, 0.2),
            (-1.0, 1.0),
            &[0.005],
        ),
    ],
    apply: |p, _: &mut Memory, call: &Call<'_>| {
        call.target + (p[0] + p[1] * call.drivers[0].abs()) * call.target
    },
    ..EFFECT
};

const RATIO: Parameter = Parameter::amplitude(
    "ratio",
    "Relative error of the ratio of wheel speed and travel speed",
    Scale::plain("1"),
    (-0.2, 0.2),
    (-1.0, 1.0),
    &[0.005],
);
