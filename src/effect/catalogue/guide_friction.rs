//! A bearing or guide whose friction the load cell feels.

use super::operator::soft_sign;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// F_c tanh(v / v_0) is added to the measured force.
pub const EFFECT: Effect = Effect {
    id: "guide-friction",
    name: "Friction between load cell and specimen",
    family: Family::Rig,
    port: Port::Output,
    also: &[],
    equation: "F_m = F + F_c tanh(v / v_0)",
    source: "standard engineering knowledge",
    signature: "square in phase with the velocity, in the empty rig too; the motion is right",
    confused_with: &[
        ("coulomb-friction", "changes the motion"),
        ("seal-friction", "grows with the pressure"),
        ("guide-drag", "grows with the velocity"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::Velocity],
    parameters: &[
        Parameter::amplitude(
            "force",
            "Friction force",
            Scale::of("1", 1, [0, 0, 0]),
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
    if p[0] == 0.0 { call.target } else { call.target + p[0] * soft_sign(call.drivers[0], p[1]) }
}
