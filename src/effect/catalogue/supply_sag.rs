//! A supply that gives way when something draws on it.

use super::operator::bounded;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// y_m = y (1 - a u), T du/dt + u = |z|.
pub const EFFECT: Effect = Effect {
    id: "supply-sag",
    name: "Supply voltage that sags under load",
    family: Family::Sensor,
    port: Port::Output,
    also: &[],
    equation: "y_m = y (1 - a u), T du/dt + u = |z|",
    source: "standard engineering knowledge",
    signature: "the gain of a channel falls while another one is loaded, a little later",
    confused_with: &[
        ("sensor-gain", "the same at any load"),
        ("thermal-softening", "needs sliding, and recovers slowly"),
    ],
    targets: &[],
    drivers: &[Role::Force],
    parameters: &[
        Parameter::amplitude(
            "sag",
            "Loss of gain per load",
            Scale::of("1", 0, [-1, 0, 0]),
            (0.0, 0.5),
            (-1.0, 1.0),
            &[0.02],
        ),
        Parameter::shape(
            "time",
            "Time in which the supply follows",
            Scale::own_time(1),
            (0.001, 2.0),
            (0.001, 5.0),
            &[0.01, 0.3],
        ),
    ],
    apply,
};

fn apply(p: &[f64], memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 {
        return call.target;
    }
    let draw = memory.lag(0, bounded(call.drivers[0].abs()), p[1], call.dt);
    call.target * (1.0 - p[0] * draw)
}
