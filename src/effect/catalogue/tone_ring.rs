//! A ring whose teeth are not evenly spaced.

use super::operator::harmonic;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// w_m = w (1 + sum of a_n cos(n theta) + b_n sin(n theta)) for n = 1 to 3.
pub const EFFECT: Effect = Effect {
    id: "tone-ring",
    name: "Uneven ring of a wheel speed sensor",
    family: Family::Brake,
    port: Port::Output,
    also: &[],
    equation: "w_m = w (1 + sum_n (a_n cos(n theta) + b_n sin(n theta))), n = 1, 2, 3",
    source: "US6446018B1",
    signature: "lines at the first orders of the wheel in the wheel speed, without echo in any force",
    confused_with: &[
        ("non-uniformity", "in the forces too"),
        ("disc-thickness-variation", "only while braking, in the forces too"),
    ],
    targets: &[Role::WheelSpeed],
    drivers: &[Role::WheelAngle],
    parameters: &[
        part("cosine", "Cosine part"),
        part("sine", "Sine part"),
        part("cosine_twice", "Cosine part at twice the angle"),
        part("sine_twice", "Sine part at twice the angle"),
        part("cosine_thrice", "Cosine part at three times the angle"),
        part("sine_thrice", "Sine part at three times the angle"),
    ],
    apply,
};

const fn part(name: &'static str, description: &'static str) -> Parameter {
    Parameter::amplitude(name, description, Scale::plain("1"), (-0.1, 0.1), (-1.0, 1.0), &[0.002])
}

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p.iter().all(|p| *p == 0.0) {
        return call.target;
    }
    let parts = p.chunks_exact(2).zip(1..);
    let uneven: f64 = parts.map(|(p, n)| harmonic(p[0], p[1], f64::from(n) * call.drivers[0])).sum();
    call.target * (1.0 + uneven)
}
