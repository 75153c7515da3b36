//! A ring whose teeth are not evenly spaced.

use super::operator::harmonic;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// w_m = w (1 + a cos(theta) + b sin(theta)).
pub const EFFECT: Effect = Effect {
    id: "tone-ring",
    name: "Uneven ring of a wheel speed sensor",
    family: Family::Brake,
    port: Port::Output,
    also: &[],
    equation: "w_m = w (1 + a cos(theta) + b sin(theta))",
    source: "US6446018B1",
    signature: "a line at the first order of the wheel in the wheel speed, without echo in any force",
    confused_with: &[
        ("non-uniformity", "in the forces too"),
        ("disc-thickness-variation", "only while braking, in the forces too"),
    ],
    targets: &[Role::WheelSpeed],
    drivers: &[Role::WheelAngle],
    parameters: &[
        Parameter::amplitude("cosine", "Cosine part", Scale::plain("1"), (-0.1, 0.1), (-1.0, 1.0), &[0.002]),
        Parameter::amplitude("sine", "Sine part", Scale::plain("1"), (-0.1, 0.1), (-1.0, 1.0), &[0.002]),
    ],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 && p[1] == 0.0 {
        return call.target;
    }
    call.target * (1.0 + harmonic(p[0], p[1], call.drivers[0]))
}
