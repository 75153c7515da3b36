//! A tire that uses a high load less well.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// F (1 - a (Fz / F_ref - 1)).
pub const EFFECT: Effect = Effect {
    id: "load-sensitivity",
    name: "Friction that falls with the load",
    family: Family::Tire,
    port: Port::Output,
    also: &[(Port::Parameter, Role::Friction)],
    equation: "F = F_0 (1 - a (|Fz| / F_ref - 1))",
    source: "standard engineering knowledge",
    signature: "less than in proportion at high load",
    confused_with: &[
        ("pressure-dependent-friction", "follows the pressure: cross load and pressure"),
        ("sensor-gain", "the same at any load"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::Load],
    parameters: &[
        Parameter::amplitude(
            "slope",
            "Relative loss per relative change of the load",
            Scale::plain("1"),
            (-0.2, 0.8),
            (-2.0, 2.0),
            &[0.02],
        ),
        Parameter::shape(
            "reference",
            "Load at which nothing changes",
            Scale::of("1", 0, [1, 0, 0]),
            (0.2, 3.0),
            (0.2, 3.0),
            &[1.0],
        ),
    ],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 || p[1] == 0.0 {
        return call.target;
    }
    call.target * (1.0 - p[0] * (call.drivers[0].abs() / p[1] - 1.0))
}
