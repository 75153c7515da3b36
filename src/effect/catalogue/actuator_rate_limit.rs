//! An actuator that moves, or lets something flow, only so fast.

use super::actuator_lag::ACTUATED;
use super::valve_rate_limit::{LIMIT, apply};
use crate::effect::{Effect, Family, Port};

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
    targets: ACTUATED,
    drivers: &[],
    parameters: LIMIT,
    apply,
};
