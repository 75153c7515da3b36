//! A pad that needs some time to bite.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// x (1 - a (1 - S(t / T))) acts, t being the time in contact.
pub const EFFECT: Effect = Effect {
    id: "pad-onset",
    name: "Friction of the pad that builds up after contact",
    family: Family::Brake,
    port: Port::Input,
    also: &[],
    equation: "x = x_0 (1 - a (1 - S(t / T))), S(u) = 3 u^2 - 2 u^3",
    source: "Mack 2009 (pad friction as a function of the time since the onset of braking; the polynomial is a placeholder)",
    signature: "too little in the first tenths of a second after the first contact, right later",
    confused_with: &[
        ("hydraulic-lag", "late when released too"),
        ("pad-fade", "falls, over seconds"),
        ("hydraulic-hold-off", "at low pressure, at any time"),
    ],
    targets: &[Role::Pressure, Role::BrakeForce],
    drivers: &[],
    parameters: &[LACK, TIME, contact(Scale::of("1", 1, [0, 0, 0]))],
    apply: |p, memory, call| rising(p, memory, call, call.target),
};

/// The same in the brake's own factor, where the pressure is known.
pub const BY_PRESSURE: Effect = Effect {
    port: Port::Parameter,
    targets: &[Role::BrakeGain],
    drivers: &[Role::Pressure],
    parameters: &[LACK, TIME, contact(Scale::of("1", 0, [1, 0, 0]))],
    apply: |p, memory, call| rising(p, memory, call, call.drivers[0]),
    ..EFFECT
};

const LACK: Parameter = Parameter::amplitude(
    "lack",
    "Share that is missing at first",
    Scale::plain("1"),
    (0.0, 0.95),
    (-1.0, 1.0),
    &[0.02],
);

const TIME: Parameter = Parameter::shape(
    "time",
    "Time in which it is built up",
    Scale::plain("s"),
    (0.02, 1.0),
    (0.01, 2.0),
    &[0.05, 0.2, 0.6],
);

const fn contact(scale: Scale) -> Parameter {
    Parameter::shape("contact", "Least pressure of contact", scale, (0.0001, 0.3), (0.001, 0.3), &[0.03])
}

fn rising(p: &[f64], memory: &mut Memory, call: &Call<'_>, pressure: f64) -> f64 {
    if p[0] == 0.0 || p[1] <= 0.0 {
        return call.target;
    }
    // the time in contact; a release undoes it, so that noise around the threshold does not restart it
    let touches = pressure.abs() > p[2];
    let before = if call.dt > 0.0 { memory.states[0] } else { f64::INFINITY };
    memory.states[0] = (before + if touches { call.dt } else { -call.dt }).clamp(0.0, p[1]);
    if call.dt <= 0.0 && !touches {
        memory.states[0] = 0.0;
    }
    let u = memory.states[0] / p[1];
    call.target * (1.0 - p[0] * (1.0 - u * u * (3.0 - 2.0 * u)))
}
