//! A carcass that moves sideways before the contact patch feels an angle.

use super::operator::bounded;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// The slip angle lags over a distance that is compliance times cornering stiffness; the secant is used.
pub const EFFECT: Effect = Effect {
    id: "carcass-compliance",
    name: "Soft carcass",
    family: Family::Tire,
    port: Port::Input,
    also: &[],
    equation: "s da'/dt + |V| a' = |V| a, s = c |F / a'|",
    source: "standard engineering knowledge",
    signature: "a lag of force behind slip that is fixed in distance and gets shorter at large slip angles",
    confused_with: &[
        ("relaxation-length", "the same at small slip angles; not shorter at large ones"),
        ("steering-compliance", "at standstill too, does not change with the speed"),
        ("sensor-lag", "fixed in time"),
    ],
    targets: &[Role::SlipAngle, Role::Slip],
    drivers: &[Role::Force, Role::TravelSpeed],
    parameters: &[Parameter::amplitude(
        "compliance",
        "Displacement per force",
        Scale::of("m", 1, [-1, 0, 0]),
        (0.0, 2.0),
        (0.0, 5.0),
        &[0.05],
    )],
    apply,
};

fn apply(p: &[f64], memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] <= 0.0 {
        return call.target;
    }
    let (force, speed) = (bounded(call.drivers[0]), call.drivers[1].abs());
    // states: lagged slip and last goal; secant stiffness; largest slip so far
    let slip = bounded(memory.states[0]);
    memory.states[3] = memory.states[3].max(slip.abs());
    // the secant says little at small slip: there the last one stays
    let little = 0.1 * memory.states[3];
    let trust = slip * slip + little * little;
    if trust > 0.0 {
        let stay = memory.states[2] * (little * little);
        memory.states[2] = ((force * slip).abs() + stay) / trust;
    }
    let length = p[0] * memory.states[2];
    let time = if speed > 0.0 { length / speed } else { f64::INFINITY };
    memory.lag(0, call.target, time, call.dt)
}
