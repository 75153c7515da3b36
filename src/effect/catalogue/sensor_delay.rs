//! A sensor that tells the past.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Scale};

/// y(t) becomes y(t - T).
pub const EFFECT: Effect = Effect {
    id: "sensor-delay",
    name: "Delay of a sensor",
    family: Family::Sensor,
    port: Port::Output,
    also: &[],
    equation: "y_m(t) = y(t - T)",
    source: "standard engineering knowledge",
    signature: "phase falls in proportion to the frequency with gain 1, for whatever moves that sensor, at any speed",
    confused_with: &[
        ("sensor-lag", "a lag makes fast signals smaller, a delay does not"),
        ("relaxation-length", "fixed in distance, not in time: two speeds tell"),
    ],
    targets: &[],
    drivers: &[],
    parameters: &[Parameter {
        name: "delay",
        description: "How old the told value is",
        scale: Scale::own_time(1),
        off: Some(0.0),
        plausible: (0.0, 0.5),
        search: (0.0, 0.5),
        probes: &[0.005, 0.03, 0.1, 0.3],
        of_session: false,
    }],
    apply,
};

fn apply(p: &[f64], memory: &mut Memory, call: &Call<'_>) -> f64 {
    let delay = p[0];
    memory.remember(call.time, call.target, delay);
    if delay <= 0.0 { call.target } else { memory.recall(call.time - delay) }
}
