//! A lubricated bearing whose drag the load cell feels.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// c v is added to the measured force.
pub const EFFECT: Effect = Effect {
    id: "guide-drag",
    name: "Viscous drag between load cell and specimen",
    family: Family::Rig,
    port: Port::Output,
    also: &[],
    equation: "F_m = F + c v",
    source: "standard engineering knowledge",
    signature: "in phase with the velocity, in the empty rig too; the motion is right",
    confused_with: &[
        ("viscous-drag", "changes the motion"),
        ("guide-friction", "does not grow with the velocity"),
        ("sensor-lag", "for whatever moves that sensor"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::Velocity],
    parameters: &[Parameter::amplitude(
        "damping",
        "Force per velocity",
        Scale::of("1", 1, [-1, 0, 0]),
        (-2.0, 2.0),
        (-2.0, 2.0),
        &[0.02],
    )],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 { call.target } else { call.target + p[0] * call.drivers[0] }
}
