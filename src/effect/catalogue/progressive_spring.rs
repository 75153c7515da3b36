//! A spring that gets stiffer.

use super::operator::bounded;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// -k_3 x^3 is added to a force.
pub const EFFECT: Effect = Effect {
    id: "progressive-spring",
    name: "Progressive spring",
    family: Family::Mechanism,
    port: Port::Force,
    also: &[],
    equation: "F = F_0 - k_3 x^3",
    source: "standard engineering knowledge",
    signature: "stiffer at large amplitudes: resonances move up, third harmonics",
    confused_with: &[
        ("bump-stop", "nothing at all until the stop is met"),
        ("payne", "softer at large amplitudes, and lossy"),
        ("asymmetric-spring", "second harmonics"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::Position],
    parameters: &[Parameter::amplitude(
        "cubic",
        "Force per cube of the displacement",
        Scale::of("1", 1, [-3, 0, 0]),
        (0.0, 2.0),
        (-2.0, 2.0),
        &[0.02],
    )],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    let x = bounded(call.drivers[0]);
    if p[0] == 0.0 { call.target } else { call.target - p[0] * x * x * x }
}
