//! A steering that gives way to the force of the wheel.

use super::operator::mode;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// The angle gives way by c F, through the mode of the steering.
pub const EFFECT: Effect = Effect {
    id: "steering-compliance",
    name: "Soft steering",
    family: Family::Suspension,
    port: Port::Input,
    also: &[],
    equation: "d' = d - c u, u'' + 2 D w u' + w^2 (u - F) = 0, w = 2 pi f",
    source: "standard engineering knowledge",
    signature: "a line of some Hz in the lateral and steering forces, bursts when the longitudinal force breaks down; less angle under load",
    confused_with: &[("carcass-compliance", "its lag goes with 1/V"), ("plysteer", "the same at any force")],
    targets: &[Role::SlipAngle, Role::Position],
    drivers: &[Role::Force],
    parameters: &[
        Parameter::amplitude(
            "compliance",
            "Angle per force",
            Scale::of("1", 1, [-1, 0, 0]),
            (0.0, 0.5),
            (-0.5, 0.5),
            &[0.01],
        ),
        Parameter::shape(
            "frequency",
            "Frequency of the steering",
            Scale::plain("Hz"),
            (3.0, 60.0),
            (2.0, 100.0),
            &[10.0, 25.0],
        ),
        Parameter::shape("damping", "Damping ratio", Scale::plain("1"), (0.01, 0.7), (0.005, 0.9), &[0.1]),
    ],
    apply,
};

fn apply(p: &[f64], memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 {
        return call.target;
    }
    call.target - p[0] * mode(memory, 0, call.drivers[0], p[1], p[2], call.dt)
}
