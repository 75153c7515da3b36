//! A characteristic that falls more than thought.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// F (1 - a tanh(max(0, |slip| / s_0 - 1))).
pub const EFFECT: Effect = Effect {
    id: "falling-branch",
    name: "Friction that falls beyond the peak",
    family: Family::Tire,
    port: Port::Output,
    also: &[(Port::Parameter, Role::Friction)],
    equation: "F = F_0 (1 - a tanh(max(0, |slip| / s_0 - 1)))",
    source: "standard engineering knowledge",
    signature: "nothing up to the peak, too much force beyond it, at any speed",
    confused_with: &[
        ("speed-dependent-friction", "the same slip at two speeds tells"),
        ("thermal-softening", "depends on what went before"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::Slip],
    parameters: &[
        Parameter::amplitude(
            "loss",
            "Share that is lost far beyond the peak",
            Scale::plain("1"),
            (-0.5, 0.8),
            (-1.0, 1.0),
            &[0.02],
        ),
        Parameter::shape(
            "peak",
            "Slip from which on it falls",
            Scale::of("1", 0, [1, 0, 0]),
            (0.005, 1.0),
            (0.005, 1.5),
            &[0.05, 0.15, 0.4],
        ),
    ],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 || p[1] <= 0.0 {
        return call.target;
    }
    let beyond = (call.drivers[0].abs() / p[1] - 1.0).max(0.0);
    call.target * (1.0 - p[0] * libm::tanh(beyond))
}
