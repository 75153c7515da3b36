//! A sensor whose zero moves during a run.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Scale};

/// y_m = y + c (t - t_0).
pub const EFFECT: Effect = Effect {
    id: "sensor-drift",
    name: "Drift of a sensor",
    family: Family::Sensor,
    port: Port::Output,
    also: &[],
    equation: "y_m = y + c (t - t_0)",
    source: "standard engineering knowledge",
    signature: "grows with the time since the start of a run, at rest too",
    confused_with: &[
        ("thermal-softening", "only while something slides, and in proportion to the force"),
        ("sensor-bias", "does not grow"),
    ],
    targets: &[],
    drivers: &[],
    parameters: &[Parameter::amplitude(
        "rate",
        "Change of the zero per second",
        Scale::of("1", 1, [0, 0, 0]).per_time(1),
        (-0.1, 0.1),
        (-1.0, 1.0),
        &[0.002],
    )],
    apply,
};

fn apply(p: &[f64], memory: &mut Memory, call: &Call<'_>) -> f64 {
    if call.dt <= 0.0 {
        memory.states[0] = call.time;
    }
    if p[0] == 0.0 { call.target } else { call.target + p[0] * (call.time - memory.states[0]) }
}
