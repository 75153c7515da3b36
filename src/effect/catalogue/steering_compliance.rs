//! A steering or wheel carrier that gives way to the forces of the wheel.
//!
//! In the axes of ISO 8855 a positive slip angle makes a negative lateral force and a positive aligning moment. A moment
//! about z turns the wheel to the left, by a positive steer angle, and so takes away slip angle: that of the tire
//! itself always brings it nearer to zero. A lateral force that acts behind the steering axis has the moment -Fy n and does
//! the same (understeer); before it, or through the bushings of some rear axles, it does the opposite (oversteer).

use super::operator::mode;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// The slip angle gives way to the aligning moment by c Mz, through the mode of the steering.
pub const EFFECT: Effect = Effect {
    id: "steering-compliance",
    name: "Soft steering",
    family: Family::Suspension,
    port: Port::Input,
    also: &[],
    equation: "alpha = alpha_0 - c u, u'' + 2 D w u' + w^2 (u - Mz) = 0, w = 2 pi f",
    source: "derived from ISO 8855 signs: a compliance has a positive share of its own",
    signature: "a line of some Hz in the lateral and steering forces, bursts when the longitudinal force breaks down; less slip angle the larger the moment",
    confused_with: &[("carcass-compliance", "its lag goes with 1/V"), ("plysteer", "the same at any force")],
    targets: &[Role::SlipAngle],
    drivers: &[Role::AligningMoment],
    parameters: &[
        gives_way("compliance", "Slip angle that a positive moment takes away, per moment"),
        FREQUENCY,
        DAMPING,
    ],
    apply: |p, memory, call| turned(p, memory, call, -1.0),
};

/// The slip angle gives way to the lateral force.
pub const BY_SIDE_FORCE: Effect = Effect {
    equation: "alpha = alpha_0 + c u, u'' + 2 D w u' + w^2 (u - Fy) = 0, w = 2 pi f",
    source: "derived from ISO 8855 signs: a force may have a share of either sign in an angle",
    signature: "a line of some Hz in the lateral and steering forces, bursts when the longitudinal force breaks down; less slip angle the larger the side force, or more",
    drivers: &[Role::LateralForce],
    parameters: &[
        of_either_sign(
            "side_compliance",
            "Slip angle per lateral force; positive brings it nearer to zero, understeer",
        ),
        FREQUENCY,
        DAMPING,
    ],
    apply: |p, memory, call| turned(p, memory, call, 1.0),
    ..EFFECT
};

/// The steer angle gives way to the aligning moment.
pub const STEER: Effect = Effect {
    equation: "delta = delta_0 + c u, u'' + 2 D w u' + w^2 (u - Mz) = 0, w = 2 pi f",
    targets: &[Role::SteerAngle],
    parameters: &[gives_way("steer_compliance", "Steer angle per moment, both about z"), FREQUENCY, DAMPING],
    apply: |p, memory, call| turned(p, memory, call, 1.0),
    ..EFFECT
};

/// The steer angle gives way to the lateral force.
pub const STEER_BY_SIDE_FORCE: Effect = Effect {
    equation: "delta = delta_0 - c u, u'' + 2 D w u' + w^2 (u - Fy) = 0, w = 2 pi f",
    targets: &[Role::SteerAngle],
    parameters: &[
        of_either_sign(
            "steer_side_compliance",
            "Steer angle away from a lateral force, per force; positive understeers",
        ),
        FREQUENCY,
        DAMPING,
    ],
    apply: |p, memory, call| turned(p, memory, call, -1.0),
    ..BY_SIDE_FORCE
};

const fn gives_way(name: &'static str, description: &'static str) -> Parameter {
    Parameter::amplitude(name, description, Scale::of("1", 1, [-1, 0, 0]), (0.0, 0.5), (-0.5, 0.5), &[0.01])
}

const fn of_either_sign(name: &'static str, description: &'static str) -> Parameter {
    Parameter { plausible: (-0.5, 0.5), ..gives_way(name, description) }
}

const FREQUENCY: Parameter = Parameter::shape(
    "frequency",
    "Frequency of the steering",
    Scale::plain("Hz"),
    (3.0, 60.0),
    (2.0, 100.0),
    &[10.0, 25.0],
);

const DAMPING: Parameter =
    Parameter::shape("damping", "Damping ratio", Scale::plain("1"), (0.01, 0.7), (0.005, 0.9), &[0.1]);

fn turned(p: &[f64], memory: &mut Memory, call: &Call<'_>, sign: f64) -> f64 {
    if p[0] == 0.0 {
        return call.target;
    }
    call.target + sign * p[0] * mode(memory, 0, call.drivers[0], p[1], p[2], call.dt)
}
