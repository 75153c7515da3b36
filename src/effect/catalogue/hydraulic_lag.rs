//! Pressure that builds up through a line.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// T dp/dt + p = p_cmd.
pub const EFFECT: Effect = Effect {
    id: "hydraulic-lag",
    name: "Lag of the brake hydraulics",
    family: Family::Brake,
    port: Port::Input,
    also: &[],
    equation: "T dp/dt + p = p_cmd",
    source: "standard engineering knowledge",
    signature: "everything behind the pressure lags by the same time, when it rises and when it falls",
    confused_with: &[
        ("sensor-lag", "one output only"),
        ("hydraulic-hold-off", "late at the onset, but not when released"),
        ("pad-onset", "only after the first contact"),
        ("valve-rate-limit", "small steps are not late"),
    ],
    targets: &[Role::Pressure, Role::BrakeForce],
    drivers: &[],
    parameters: &[Parameter::amplitude(
        "time",
        "Time in which 63 % of a step are reached",
        Scale::own_time(1),
        (0.0, 0.5),
        (0.0, 1.0),
        &[0.005, 0.03, 0.1, 0.3],
    )],
    apply,
};

fn apply(p: &[f64], memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] <= 0.0 { call.target } else { memory.lag(0, call.target, p[0], call.dt) }
}
