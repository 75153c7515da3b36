//! A seal that the pressure presses on.

use super::operator::soft_sign;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// (F_0 + k |p|) tanh(v / v_0) is added to the measured force.
pub const EFFECT: Effect = Effect {
    id: "seal-friction",
    name: "Friction of a pressurised seal",
    family: Family::Rig,
    port: Port::Output,
    also: &[],
    equation: "F_m = F + (F_0 + k |p|) tanh(v / v_0)",
    source: "standard engineering knowledge",
    signature: "a loop over the displacement whose width grows with the pressure",
    confused_with: &[
        ("guide-friction", "the same at any pressure"),
        ("pressure-dependent-friction", "in phase with the force, not with the velocity"),
        ("sensor-gain", "a wrong area is even in the velocity"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::Velocity, Role::Pressure],
    parameters: &[
        Parameter::amplitude(
            "force",
            "Friction without pressure",
            Scale::of("1", 1, [0, 0, 0]),
            (-2.0, 2.0),
            (-2.0, 2.0),
            &[0.02],
        ),
        Parameter::amplitude(
            "per_pressure",
            "Friction per pressure",
            Scale::of("1", 1, [0, -1, 0]),
            (-2.0, 2.0),
            (-2.0, 2.0),
            &[0.02],
        ),
        Parameter::shape(
            "velocity",
            "Velocity at which three quarters of it act",
            Scale::of("1", 0, [1, 0, 0]),
            (0.0001, 0.5),
            (0.001, 0.5),
            &[0.03],
        ),
    ],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 && p[1] == 0.0 {
        return call.target;
    }
    call.target + (p[0] + p[1] * call.drivers[1].abs()) * soft_sign(call.drivers[0], p[2])
}
