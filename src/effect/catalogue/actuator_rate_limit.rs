//! An actuator that moves, or lets something flow, only so fast.

use super::actuator_lag::MOTIONS;
use super::valve_rate_limit;
use crate::effect::{Effect, Family, Parameter, Port, Scale};

/// What is given changes by at most r per second.
pub const EFFECT: Effect = Effect {
    id: "actuator-rate-limit",
    name: "Actuator that changes only so fast",
    family: Family::Rig,
    port: Port::Input,
    also: &[],
    equation: "x = x_cmd + a (l - x_cmd), |dl/dt| <= r, a = 1",
    source: "standard engineering knowledge",
    signature: "ramps with one slope where the command jumps; small steps are right",
    confused_with: &[("actuator-lag", "small steps are late too")],
    targets: MOTIONS,
    drivers: &[],
    parameters: &[
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
            &[1.0, 5.0, 25.0],
        ),
    ],
    apply: valve_rate_limit::apply,
};
