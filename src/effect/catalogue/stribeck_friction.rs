//! Dry friction with a peak at low velocity.

use super::operator::soft_sign;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// -(F_c + F_s exp(-(v / v_s)^2)) tanh(10 v / v_s) is added to a force.
pub const EFFECT: Effect = Effect {
    id: "stribeck-friction",
    name: "Friction that falls when sliding begins",
    family: Family::Mechanism,
    port: Port::Force,
    also: &[],
    equation: "F = F_0 - (F_c + F_s exp(-(v / v_s)^2)) tanh(10 v / v_s)",
    source: "Canudas-de-Wit et al. 2003, VSD 39(3):189-226 (form: standard engineering knowledge)",
    signature: "a square wave in phase with the velocity with peaks at each turn; stick-slip",
    confused_with: &[("coulomb-friction", "no peaks"), ("viscous-drag", "rises with the velocity")],
    targets: &[Role::Force],
    drivers: &[Role::Velocity],
    parameters: &[
        Parameter::amplitude(
            "force",
            "Friction force of fast sliding",
            Scale::of("1", 1, [0, 0, 0]),
            (0.0, 2.0),
            (-2.0, 2.0),
            &[0.02, 0.06, 0.2, 0.6],
        ),
        Parameter::amplitude(
            "peak",
            "What comes on top at low velocity",
            Scale::of("1", 1, [0, 0, 0]),
            (0.0, 2.0),
            (-2.0, 2.0),
            &[0.02, 0.03, 0.1, 0.3],
        ),
        Parameter::shape(
            "velocity",
            "Velocity at which 37 % of the peak are left",
            Scale::of("1", 0, [1, 0, 0]),
            (0.001, 1.0),
            (0.003, 1.0),
            &[0.05, 0.3],
        ),
    ],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 && p[1] == 0.0 {
        return call.target;
    }
    let v = call.drivers[0];
    let share = if p[2] > 0.0 { v / p[2] } else { v.signum() * f64::INFINITY };
    let peak = if v == 0.0 { p[1] } else { p[1] * libm::exp(-share * share) };
    call.target - (p[0] + peak) * soft_sign(v, 0.1 * p[2])
}
