//! What rolling costs.

use super::operator::soft_sign;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// -f |Fz| tanh(V / 0.1 m/s) is added to a longitudinal force.
pub const EFFECT: Effect = Effect {
    id: "rolling-resistance",
    name: "Rolling resistance",
    family: Family::Tire,
    port: Port::Output,
    also: &[],
    equation: "F = F_0 - f |Fz| tanh(V / 0.1 m/s)",
    source: "TST 6(3):163 (in proportion to the load)",
    signature: "an offset of the longitudinal force or the wheel moment that goes with the load and turns with the direction",
    confused_with: &[
        ("aero-drag", "grows with the square of the speed"),
        ("load-dependent-friction", "changes the motion"),
        ("sensor-bias", "does not turn with the direction"),
        ("plysteer", "in the lateral force"),
        ("drum-curvature", "a factor on the rolling resistance that is there: another drum tells"),
    ],
    targets: &[Role::LongitudinalForce],
    drivers: &[Role::Load, Role::TravelSpeed],
    parameters: &[Parameter::amplitude(
        "coefficient",
        "Force per load",
        Scale::of("1", 1, [-1, 0, 0]),
        (0.0, 2.0),
        (-2.0, 2.0),
        &[0.01],
    )],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 {
        return call.target;
    }
    call.target - p[0] * call.drivers[0].abs() * soft_sign(call.drivers[1], 0.1)
}
