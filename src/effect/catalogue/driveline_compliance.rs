//! A shaft that winds up before it passes a torque on.

use super::operator::mode;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// A share of the torque passes a mode of torsion.
pub const EFFECT: Effect = Effect {
    id: "driveline-compliance",
    name: "Soft shaft",
    family: Family::Brake,
    port: Port::Input,
    also: &[],
    equation: "M = M_0 + a (u - M_0), u'' + 2 D w u' + w^2 (u - M_0) = 0, w = 2 pi f",
    source: "standard engineering knowledge",
    signature: "a decaying vibration at a fixed frequency after each step of the torque",
    confused_with: &[
        ("belt-mode", "in the tire: changes with the pressure"),
        ("backlash", "only when the torque changes sign"),
        ("hydraulic-lag", "no overshoot"),
    ],
    targets: &[Role::Force],
    drivers: &[],
    parameters: &[
        Parameter::amplitude(
            "share",
            "Share that passes the shaft",
            Scale::plain("1"),
            (0.0, 1.3),
            (-0.5, 1.5),
            &[0.05],
        ),
        Parameter::shape(
            "frequency",
            "Frequency",
            Scale::plain("Hz"),
            (1.0, 60.0),
            (0.5, 100.0),
            &[4.0, 12.0, 35.0],
        ),
        Parameter::shape("damping", "Damping ratio", Scale::plain("1"), (0.005, 0.7), (0.003, 0.9), &[0.05]),
    ],
    apply,
};

fn apply(p: &[f64], memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 {
        return call.target;
    }
    call.target + p[0] * (mode(memory, 0, call.target, p[1], p[2], call.dt) - call.target)
}
