//! Rubber that grips less when it slides fast.

use super::operator::bounded;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// F (1 - a (1 - exp(-(v_s / v_0)^2))) with v_s = slip V.
pub const EFFECT: Effect = Effect {
    id: "speed-dependent-friction",
    name: "Friction that falls with the sliding speed",
    family: Family::Tire,
    port: Port::Output,
    also: &[(Port::Parameter, Role::Other)],
    equation: "F = F_0 (1 - a (1 - exp(-(v_s / v_0)^2))), v_s = slip V",
    source: "Canudas-de-Wit et al. 2003, VSD 39(3):189-226 (form: standard engineering knowledge)",
    signature: "too much force past the peak, the more the faster the contact slides",
    confused_with: &[
        ("thermal-softening", "depends on what went before: reverse the order of runs"),
        ("falling-branch", "depends on the slip, not on the speed: two speeds tell"),
        ("stribeck-friction", "a force on the motion, in any mechanism"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::Slip, Role::TravelSpeed],
    parameters: &[
        Parameter::amplitude(
            "loss",
            "Share that is lost in fast sliding",
            Scale::plain("1"),
            (0.0, 0.8),
            (-1.0, 1.0),
            &[0.02],
        ),
        Parameter::shape(
            "velocity",
            "Sliding speed at which 63 % of it are lost",
            Scale::of("1", 0, [1, 1, 0]),
            (0.02, 3.0),
            (0.01, 5.0),
            &[0.1, 0.4, 1.0],
        ),
    ],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 || p[1] <= 0.0 {
        return call.target;
    }
    let sliding = bounded(call.drivers[0]) * bounded(call.drivers[1]) / p[1];
    call.target * (1.0 + p[0] * (-sliding * sliding).exp_m1())
}
