//! Rubber's friction that is built up over some way.

use super::operator::berg;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// -F_h f is added to a force; f follows a hyperbola after each turn.
pub const EFFECT: Effect = Effect {
    id: "bushing-hysteresis",
    name: "Friction of a rubber bushing",
    family: Family::Suspension,
    port: Port::Force,
    also: &[],
    equation: "F = F_0 - F_h f, f = f_t + (x - x_t) (1 - s f_t) / (x_2 (1 - s f_t) + |x - x_t|), s = sign(dx)",
    source: "Garcia Tarrago et al. 2007, Polymer Testing 26:629-638 (separable model with a friction part; its hyperbola: standard engineering knowledge)",
    signature: "stiff at small amplitudes, soft at large ones; the loss does not depend on the frequency",
    confused_with: &[
        ("maxwell-element", "loss depends on the frequency"),
        ("bouc-wen", "straight back to zero after a turn"),
        ("coulomb-friction", "jumps at each turn"),
        ("payne", "the same in a force output"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::Position],
    parameters: &[
        Parameter::amplitude(
            "force",
            "Largest force of the friction",
            Scale::of("1", 1, [0, 0, 0]),
            (0.0, 2.0),
            (-2.0, 2.0),
            &[0.02, 0.06, 0.2, 0.6],
        ),
        Parameter::shape(
            "length",
            "Way from rest in which half of it is built up",
            Scale::of("1", 0, [1, 0, 0]),
            (0.001, 2.0),
            (0.003, 2.0),
            &[0.03, 0.3],
        ),
    ],
    apply,
};

fn apply(p: &[f64], memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 {
        return call.target;
    }
    call.target - p[0] * berg(memory, call.drivers[0], p[1], call.dt)
}
