//! A tire's force that follows its stationary value over a distance.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// sigma dF/dt + |V| F = |V| F_stationary.
pub const EFFECT: Effect = Effect {
    id: "relaxation-length",
    name: "Relaxation length of the tire",
    family: Family::Tire,
    port: Port::Output,
    also: &[(Port::Input, Role::SlipAngle), (Port::Input, Role::Slip)],
    equation: "sigma dF/dt + |V| F = |V| F_s",
    source: "first-order tire transients, standard engineering knowledge",
    signature: "a lag of force behind slip that is fixed in distance: its time constant goes with 1/V",
    confused_with: &[
        ("sensor-lag", "fixed in time: two speeds tell"),
        ("sensor-delay", "fixed in time: two speeds tell"),
        ("carcass-compliance", "the same at low frequency: a static pull of the standing tire tells"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::TravelSpeed],
    parameters: &[Parameter {
        name: "length",
        description: "Distance in which 63 % of a step are reached",
        scale: Scale::plain("m"),
        off: Some(0.0),
        plausible: (0.0, 2.0),
        search: (0.0, 5.0),
        probes: &[0.05],
        of_session: false,
    }],
    apply,
};

fn apply(p: &[f64], memory: &mut Memory, call: &Call<'_>) -> f64 {
    let (length, speed) = (p[0], call.drivers[0].abs());
    if length <= 0.0 {
        return call.target;
    }
    // at standstill nothing rolls in: the force stays
    memory.lag(0, call.target, if speed > 0.0 { length / speed } else { f64::INFINITY }, call.dt)
}
