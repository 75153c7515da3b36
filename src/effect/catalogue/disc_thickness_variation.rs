//! A disc that is thicker on one side.

use super::operator::harmonic;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// The brake acts more at one angle: x (1 + a cos(theta) + b sin(theta)), and at two angles.
pub const EFFECT: Effect = Effect {
    id: "disc-thickness-variation",
    name: "Brake disc of uneven thickness",
    family: Family::Brake,
    port: Port::Input,
    also: &[(Port::Parameter, Role::BrakeGain)],
    equation: "x = x_0 (1 + a cos(theta) + b sin(theta) + c cos(2 theta) + d sin(2 theta))",
    source: "dbausa.com T004; fliphtml5 Automotive Chassis Engineering p324",
    signature: "a line at the first order of the wheel, or the second, while the brake acts, in proportion to it",
    confused_with: &[
        ("non-uniformity", "without braking too"),
        ("tone-ring", "in the wheel speed alone"),
        ("imbalance", "grows with the square of the speed"),
    ],
    targets: &[Role::Pressure, Role::Force],
    drivers: &[Role::WheelAngle],
    parameters: &[
        part("cosine", "Cosine part"),
        part("sine", "Sine part"),
        part("cosine_twice", "Cosine part at twice the angle"),
        part("sine_twice", "Sine part at twice the angle"),
    ],
    apply,
};

const fn part(name: &'static str, description: &'static str) -> Parameter {
    Parameter::amplitude(name, description, Scale::plain("1"), (-0.5, 0.5), (-1.0, 1.0), &[0.01])
}

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p.iter().all(|p| *p == 0.0) {
        return call.target;
    }
    let angle = call.drivers[0];
    call.target * (1.0 + harmonic(p[0], p[1], angle) + harmonic(p[2], p[3], 2.0 * angle))
}
