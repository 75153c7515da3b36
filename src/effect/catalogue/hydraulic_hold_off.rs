//! Springs and seals that hold the pad off.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// p = sign(p_cmd) max(0, |p_cmd| - p_0).
pub const EFFECT: Effect = Effect {
    id: "hydraulic-hold-off",
    name: "Pressure that is needed before anything happens",
    family: Family::Brake,
    port: Port::Input,
    also: &[],
    equation: "p = sign(p_cmd) max(0, |p_cmd| - p_0)",
    source: "standard engineering knowledge",
    signature: "nothing at low pressure, the same amount too little at high",
    confused_with: &[
        ("hydraulic-lag", "late when released too"),
        ("sensor-bias", "at zero pressure too"),
        ("backlash", "only after a change of sign"),
    ],
    targets: &[Role::Pressure, Role::BrakeForce],
    drivers: &[],
    parameters: &[Parameter::amplitude(
        "pressure",
        "Pressure that is lost",
        Scale::of("1", 1, [0, 0, 0]),
        (0.0, 0.5),
        (0.0, 1.0),
        &[0.01],
    )],
    apply,
};

/// What is given is less than what is asked for, by the same amount, and nothing below that.
pub(super) fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] <= 0.0 {
        return call.target;
    }
    call.target.signum() * (call.target.abs() - p[0]).max(0.0)
}
