//! A sensor or filter that follows late.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Scale};

/// T dy_m/dt + y_m = y.
pub const EFFECT: Effect = Effect {
    id: "sensor-lag",
    name: "Lag of a sensor or amplifier",
    family: Family::Sensor,
    port: Port::Output,
    also: &[],
    equation: "T dy_m/dt + y_m = y",
    source: "standard engineering knowledge",
    signature: "gain falls and phase lags with the frequency in Hz, at any speed, for whatever moves that sensor",
    confused_with: &[
        ("sensor-delay", "a delay leaves fast signals their size"),
        ("relaxation-length", "fixed in distance, not in time: two speeds tell"),
        ("hydraulic-lag", "everything behind the valve lags, not one sensor"),
    ],
    targets: &[],
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
