//! A sensor that shows a number at zero.

use super::constant_force::{OFFSET, apply};
use crate::effect::{Effect, Family, Port};

/// y_m = y + b.
pub const EFFECT: Effect = Effect {
    id: "sensor-bias",
    name: "Offset of a sensor",
    family: Family::Sensor,
    port: Port::Output,
    also: &[],
    equation: "y_m = y + b",
    source: "standard engineering knowledge",
    signature: "the same at rest, without load and in every run",
    confused_with: &[("conicity", "vanishes when the wheel stands"), ("sensor-drift", "grows with time")],
    targets: &[],
    drivers: &[],
    parameters: OFFSET,
    apply,
};
