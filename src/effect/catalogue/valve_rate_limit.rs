//! A valve with an orifice.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// Pressure changes by at most r per second.
pub const EFFECT: Effect = Effect {
    id: "valve-rate-limit",
    name: "Valve that lets pressure change only so fast",
    family: Family::Brake,
    port: Port::Input,
    also: &[],
    equation: "p = p_cmd + a (l - p_cmd), |dl/dt| <= r, a = 1",
    source: "standard engineering knowledge",
    signature: "ramps with one slope where the command jumps; small steps are right",
    confused_with: &[("hydraulic-lag", "small steps are late too")],
    targets: &[Role::Pressure, Role::BrakeForce],
    drivers: &[],
    parameters: LIMIT,
    apply,
};

/// How much of the limit acts, and how fast it lets through.
pub(super) const LIMIT: &[Parameter] = &[
    Parameter::amplitude(
        "share",
        "How much of the limit acts: 1 when it is there",
        Scale::plain("1"),
        (0.3, 1.3),
        (-0.5, 1.5),
        &[0.1],
    ),
    Parameter::shape(
        "rate",
        "Largest change per second",
        Scale::of("1", 1, [0, 0, 0]).per_time(1),
        (0.2, 100.0),
        (0.1, 200.0),
        &[0.7, 1.5, 3.2, 6.8, 14.5, 31.0],
    ),
];

/// What is given runs after what is asked for, and no faster than that.
pub(super) fn apply(p: &[f64], memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 {
        return call.target;
    }
    let reach = p[1].abs() * call.dt;
    let last = if call.dt > 0.0 { memory.states[0] } else { call.target };
    memory.states[0] = call.target.max(last - reach).min(last + reach);
    call.target + p[0] * (memory.states[0] - call.target)
}
