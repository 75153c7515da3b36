//! A motion that the rig does not make at once.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// T dx/dt + x = x_cmd.
pub const EFFECT: Effect = Effect {
    id: "actuator-lag",
    name: "Actuator that follows late",
    family: Family::Rig,
    port: Port::Input,
    also: &[],
    equation: "T dx/dt + x = x_cmd",
    source: "standard engineering knowledge",
    signature: "all outputs lag behind one command by the same time; its fast parts are missing in all of them",
    confused_with: &[
        ("sensor-lag", "one output only"),
        ("relaxation-length", "the lag goes with 1/V"),
        ("actuator-resonance", "overshoots"),
    ],
    targets: ACTUATED,
    drivers: &[],
    parameters: &[Parameter::amplitude(
        "time",
        "Time in which 63 % of a step are reached",
        Scale::own_time(1),
        (0.0, 1.0),
        (0.0, 2.0),
        &[0.005, 0.03, 0.1, 0.3],
    )],
    apply,
};

/// What actuators give that are no brake: they move or push something, or let current, heat or a fluid flow.
pub(super) const ACTUATED: &[Role] = &[
    Role::Position,
    Role::Velocity,
    Role::SlipAngle,
    Role::Camber,
    Role::Slip,
    Role::TravelSpeed,
    Role::Temperature,
    Role::FrictionPower,
    Role::Command,
];

fn apply(p: &[f64], memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] <= 0.0 { call.target } else { memory.lag(0, call.target, p[0], call.dt) }
}
