//! A recorded input with a wrong zero.

use super::constant_force::{OFFSET, apply};
use crate::effect::{Effect, Family, Port, Role};

/// x = x_0 + b. Of what is a force it is a constant force, and where a tire is turned to, ply steer and conicity are the physics.
pub const EFFECT: Effect = Effect {
    id: "input-offset",
    name: "Offset of a recorded input",
    family: Family::Sensor,
    port: Port::Input,
    also: &[],
    equation: "x = x_0 + b",
    source: "standard engineering knowledge",
    signature: "the machine does something where the recorded input is zero, the same in every run",
    confused_with: &[
        ("actuator-dead-band", "changes its sign with the command"),
        ("sensor-bias", "one output only; the motion is right"),
    ],
    targets: &[Role::Command, Role::Pressure, Role::Temperature, Role::FrictionPower],
    drivers: &[],
    parameters: OFFSET,
    apply,
};
