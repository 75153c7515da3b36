//! A Maxwell branch beside the elastic force.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// F + a (F - F_d) with T dF_d/dt + F_d = F. One arm: rubber, whose stiffness rises with the logarithm of the frequency
/// over many decades, has a spectrum of them.
pub const EFFECT: Effect = Effect {
    id: "viscoelastic-stiffening",
    name: "Rubber that is stiffer when it is fast",
    family: Family::Tire,
    port: Port::Output,
    also: &[],
    equation: "F = F_0 + a (F_0 - F_d), T dF_d/dt + F_d = F_0",
    source: "standard engineering knowledge",
    signature: "the stiffness rises once, within about a decade around the frequency 1 / (2 pi T), at any amplitude; a rise over several decades needs several of them",
    confused_with: &[
        ("payne", "depends on the amplitude at one frequency"),
        ("sensor-lag", "the force would get smaller with the frequency"),
        ("maxwell-element", "the same, acting on the motion"),
    ],
    targets: &[Role::Force],
    drivers: &[],
    parameters: &[
        Parameter::amplitude(
            "ratio",
            "Stiffness at high frequency over that at low, less 1",
            Scale::plain("1"),
            (0.0, 2.0),
            (-0.9, 3.0),
            &[0.02],
        ),
        Parameter::shape(
            "time",
            "Time constant",
            Scale::own_time(1),
            (0.0005, 5.0),
            (0.0002, 10.0),
            &[0.003, 0.03, 0.3],
        ),
    ],
    apply,
};

fn apply(p: &[f64], memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 {
        return call.target;
    }
    call.target + p[0] * (call.target - memory.lag(0, call.target, p[1], call.dt))
}
