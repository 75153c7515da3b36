//! Filled rubber: stiff when little is asked of it.

use super::operator::berg;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// A friction branch beside the elastic force: F + F_h f, f following a hyperbola of F after each turn.
pub const EFFECT: Effect = Effect {
    id: "payne",
    name: "Rubber that is softer at large amplitudes",
    family: Family::Tire,
    port: Port::Output,
    also: &[],
    equation: "F = F_0 + F_h f, f = f_t + (F_0 - F_t) (1 - s f_t) / (F_2 (1 - s f_t) + |F_0 - F_t|), s = sign(dF_0)",
    source: "Garcia Tarrago et al. 2007, Polymer Testing 26:629-638 (separable model with a friction part; its hyperbola: standard engineering knowledge)",
    signature: "stiffness falls with the amplitude; loss per cycle hardly depends on the frequency",
    confused_with: &[
        ("viscoelastic-stiffening", "depends on the frequency at one amplitude"),
        ("bushing-hysteresis", "the same, acting on the motion"),
        ("coulomb-friction", "jumps at each turn"),
    ],
    targets: &[Role::Force],
    drivers: &[],
    parameters: &[
        Parameter::amplitude(
            "force",
            "Largest force of the friction branch",
            Scale::of("1", 1, [0, 0, 0]),
            (0.0, 1.0),
            (-1.0, 1.0),
            &[0.02],
        ),
        Parameter::shape(
            "half",
            "Elastic force at which half of it is there",
            Scale::of("1", 1, [0, 0, 0]),
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
    call.target + p[0] * berg(memory, call.target, p[1], call.dt)
}
