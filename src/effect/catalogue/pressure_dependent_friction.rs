//! Friction and stiffness that change with the pressure.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// F (1 + a (p / p_0 - 1)).
pub const EFFECT: Effect = Effect {
    id: "pressure-dependent-friction",
    name: "Force that depends on the inflation pressure",
    family: Family::Tire,
    port: Port::Output,
    also: &[(Port::Parameter, Role::Friction)],
    equation: "F = F_0 (1 + a (p / p_0 - 1))",
    source: "MF-Tyre/MF-Swift 6.2 equation manual (pressure terms; here linear)",
    signature: "a factor that follows the pressure",
    confused_with: &[
        ("load-sensitivity", "follows the load: cross load and pressure"),
        ("sensor-gain", "the same at any pressure"),
        ("inflation-warm-up", "follows the running time"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::Pressure],
    parameters: &[
        Parameter::amplitude(
            "slope",
            "Relative change per relative change of the pressure",
            Scale::plain("1"),
            (-1.0, 1.0),
            (-2.0, 2.0),
            &[0.02],
        ),
        Parameter::shape(
            "reference",
            "Pressure at which nothing changes",
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
        call.target
    } else {
        call.target * (1.0 + p[0] * (call.drivers[0] / p[1] - 1.0))
    }
}
