//! A tire that is not the same all around.

use super::operator::harmonic;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// |Fz| (a cos(theta) + b sin(theta)) is added to a force.
pub const EFFECT: Effect = Effect {
    id: "non-uniformity",
    name: "Non-uniformity of a tire",
    family: Family::Tire,
    port: Port::Output,
    also: &[],
    equation: "F = F_0 + |Fz| (a cos(theta) + b sin(theta))",
    source: "TST 17(3):158; TST 39(4):256",
    signature: "a line at the first order of the wheel that goes with the load and hardly with the speed",
    confused_with: &[
        ("imbalance", "grows with the square of the speed, stays when lifted"),
        ("brake-torque-variation", "only while braking"),
        ("tone-ring", "in the wheel speed alone"),
        ("belt-order", "fixed to the road, not to the wheel"),
    ],
    targets: &[Role::Force, Role::Load],
    drivers: &[Role::WheelAngle, Role::Load],
    parameters: &[part("cosine", "Cosine part per load"), part("sine", "Sine part per load")],
    apply: |p, _: &mut Memory, call| add(&p[..2], &[], call),
};

/// With twice per revolution, too.
pub const WITH_SECOND: Effect = Effect {
    equation: "F = F_0 + |Fz| sum_n (a_n cos(n theta) + b_n sin(n theta)), n = 1, 2",
    signature: "lines at the first two orders of the wheel that go with the load and hardly with the speed",
    parameters: &[
        part("cosine", "Cosine part per load"),
        part("sine", "Sine part per load"),
        part("cosine_twice", "Cosine part per load at twice the angle"),
        part("sine_twice", "Sine part per load at twice the angle"),
    ],
    apply: |p, _: &mut Memory, call| add(&p[..2], &p[2..4], call),
    ..EFFECT
};

/// The stiffness itself, which all that the tire does follows: load, contact and what is made of them.
pub const OF_STIFFNESS: Effect = Effect {
    port: Port::Parameter,
    equation: "k = k_0 (1 + sum_n (a_n cos(n theta) + b_n sin(n theta))), n = 1, 2",
    signature: "lines at the first two orders of the wheel in all forces, that go with the load and hardly with the speed",
    targets: &[Role::Stiffness],
    drivers: &[Role::WheelAngle],
    parameters: &[
        share("cosine", "Cosine part"),
        share("sine", "Sine part"),
        share("cosine_twice", "Cosine part at twice the angle"),
        share("sine_twice", "Sine part at twice the angle"),
    ],
    apply: |p, _: &mut Memory, call| call.target * (1.0 + around(&p[..2], &p[2..4], call.drivers[0])),
    ..EFFECT
};

const fn part(name: &'static str, description: &'static str) -> Parameter {
    Parameter::amplitude(name, description, Scale::of("1", 1, [0, -1, 0]), (-0.3, 0.3), (-1.0, 1.0), &[0.005])
}

const fn share(name: &'static str, description: &'static str) -> Parameter {
    Parameter::amplitude(name, description, Scale::plain("1"), (-0.3, 0.3), (-1.0, 1.0), &[0.005])
}

/// What there is once per revolution, and twice.
fn around(once: &[f64], twice: &[f64], angle: f64) -> f64 {
    let mut sum = 0.0;
    for (order, parts) in [(1.0, once), (2.0, twice)] {
        // what is off has no angle
        if let [a, b] = *parts
            && (a != 0.0 || b != 0.0)
        {
            sum += harmonic(a, b, order * angle);
        }
    }
    sum
}

fn add(once: &[f64], twice: &[f64], call: &Call<'_>) -> f64 {
    let sum = around(once, twice, call.drivers[0]);
    if sum == 0.0 { call.target } else { call.target + call.drivers[1].abs() * sum }
}
