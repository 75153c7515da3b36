//! Drag of the air.

use super::operator::bounded;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// -c V |V| is added to a longitudinal force.
pub const EFFECT: Effect = Effect {
    id: "aero-drag",
    name: "Air drag",
    family: Family::Mechanism,
    port: Port::Output,
    also: &[],
    equation: "F = F_0 - c V |V|",
    source: "standard engineering knowledge",
    signature: "grows with the square of the speed of travel, with the tire lifted too",
    confused_with: &[
        ("rolling-resistance", "goes with the load, hardly with the speed"),
        ("imbalance", "a line at the order of the wheel"),
    ],
    targets: &[Role::LongitudinalForce],
    drivers: &[Role::TravelSpeed],
    parameters: &[Parameter::amplitude(
        "quadratic",
        "Force per square of the speed",
        Scale::of("1", 1, [-2, 0, 0]),
        (0.0, 2.0),
        (-2.0, 2.0),
        &[0.02],
    )],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    let v = bounded(call.drivers[0]);
    if p[0] == 0.0 { call.target } else { call.target - p[0] * v * v.abs() }
}
