//! Gears that lose contact when the torque changes sign.

use super::operator::bounded;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// While a part crosses the gap, driven by the torque alone, nothing is passed on.
pub const EFFECT: Effect = Effect {
    id: "backlash",
    name: "Backlash of a driveline",
    family: Family::Brake,
    port: Port::Input,
    also: &[],
    equation: "M = M_0 - a (M_0 - g), g = 0 while |phi| < b, phi'' = M_0; a = 1",
    source: "standard engineering knowledge",
    signature: "torque comes late after each change of its sign, then at once",
    confused_with: &[
        ("hydraulic-hold-off", "at any low pressure"),
        ("driveline-compliance", "without change of sign too"),
        ("play", "a motion, not a torque"),
    ],
    targets: &[Role::Force],
    drivers: &[],
    parameters: &[
        Parameter::amplitude(
            "share",
            "How much of the gap acts: 1 when it is there",
            Scale::plain("1"),
            (0.3, 1.3),
            (-0.5, 1.5),
            &[0.1],
        ),
        Parameter::shape(
            "gap",
            "Half of the gap, times the inertia that crosses it",
            Scale::of("1", 1, [0, 0, 0]).per_time(-2),
            (1e-06, 0.3),
            (1e-06, 0.3),
            &[0.0001, 0.003],
        ),
    ],
    apply,
};

fn apply(p: &[f64], memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 || p[1] <= 0.0 {
        return call.target;
    }
    let (torque, gap) = (bounded(call.target), p[1]);
    let [mut place, mut rate, last, ..] = memory.states;
    if call.dt <= 0.0 {
        place = gap * torque.signum();
        rate = 0.0;
    } else {
        place += call.dt * (rate + call.dt * (2.0 * last + torque) / 6.0);
        rate += 0.5 * call.dt * (last + torque);
    }
    let touches = place.abs() >= gap && place * torque >= 0.0;
    if place.abs() >= gap {
        // no way on: what was gained by pushing is lost
        place = place.clamp(-gap, gap);
        if rate * place > 0.0 {
            rate = 0.0;
        }
    }
    (memory.states[0], memory.states[1], memory.states[2]) = (place, rate, torque);
    if touches { call.target } else { call.target - p[0] * call.target }
}
