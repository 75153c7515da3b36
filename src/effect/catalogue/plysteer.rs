//! A tire whose belt plies pull to a side.

use super::operator::soft_sign;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// F + c |Fz| tanh(V / 0.1 m/s).
pub const EFFECT: Effect = Effect {
    id: "plysteer",
    name: "Ply steer",
    family: Family::Tire,
    port: Port::Output,
    also: &[],
    equation: "F = F_0 + c |Fz| tanh(V / 0.1 m/s)",
    source: "Gough et al. 1961 (pseudo slip angle), after scribd 459127951 ply steer and conicity",
    signature: "an offset of the lateral force that turns with the direction of rotation",
    confused_with: &[
        ("conicity", "does not turn with the direction"),
        ("steering-compliance", "goes with the force"),
        ("rolling-resistance", "in the longitudinal force"),
    ],
    targets: &[Role::LateralForce],
    drivers: &[Role::Load, Role::TravelSpeed],
    parameters: &[Parameter::amplitude(
        "coefficient",
        "Force per load",
        Scale::of("1", 1, [-1, 0, 0]),
        (-0.5, 0.5),
        (-1.0, 1.0),
        &[0.01],
    )],
    apply,
};

/// The same as the slip angle that it is like: that of a wheel whose heading is off. With |V_x| in the definition of the
/// slip angle it turns with the direction of travel; an angle that did not would be conicity.
pub const AS_ANGLE: Effect = Effect {
    port: Port::Input,
    equation: "alpha = alpha_0 + a tanh(V / 0.1 m/s), alpha = atan(V_y / |V_x|)",
    targets: &[Role::SlipAngle],
    drivers: &[Role::TravelSpeed],
    parameters: &[Parameter::amplitude(
        "angle",
        "Slip angle that the tire seems to have when it rolls straight ahead; at minus this it makes no side force",
        Scale::of("1", 1, [0; 3]),
        (-1.0, 1.0),
        (-2.0, 2.0),
        &[0.02],
    )],
    apply: |p, _: &mut Memory, call| {
        if p[0] == 0.0 { call.target } else { call.target + p[0] * soft_sign(call.drivers[0], 0.1) }
    },
    ..EFFECT
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 {
        return call.target;
    }
    call.target + p[0] * call.drivers[0].abs() * soft_sign(call.drivers[1], 0.1)
}
