//! A pad that loses friction when it gets hot.

use super::operator::{HEAT_KEPT, bounded, remaining, store};
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// The work of the brake heats it: dE/dt = |x w| - E / T; x (1 - tanh(a E)) acts.
pub const EFFECT: Effect = Effect {
    id: "pad-fade",
    name: "Brake that fades with its heat",
    family: Family::Brake,
    port: Port::Input,
    also: &[],
    equation: "x = x_0 (1 - tanh(a E)), dE/dt = |x_0 w| - E / T",
    source: "standard engineering knowledge",
    signature: "a slow loss within a stop and from stop to stop that comes back in pauses",
    confused_with: &[
        ("thermal-softening", "the tire: the wheel torque is right"),
        ("sensor-gain", "the same from the start"),
        ("pad-onset", "rises, in the first tenths of a second"),
    ],
    targets: &[Role::Pressure, Role::Force],
    drivers: &[Role::WheelSpeed],
    parameters: &[loss(Scale::of("1/s", -1, [-1, 0, 0])), TIME, HEAT_KEPT],
    apply: |p, memory, call| faded(p, memory, call, call.target, call.drivers[0]),
};

/// The same in the brake's own factor, where the pressure is known.
pub const BY_PRESSURE: Effect = Effect {
    port: Port::Parameter,
    also: &[],
    equation: "x = x_0 (1 - tanh(a E)), dE/dt = |p w| - E / T",
    targets: &[Role::BrakeGain],
    drivers: &[Role::Pressure, Role::WheelSpeed],
    parameters: &[loss(Scale::of("1/s", 0, [-1, -1, 0])), TIME, HEAT_KEPT],
    apply: |p, memory, call| faded(p, memory, call, call.drivers[0], call.drivers[1]),
    ..EFFECT
};

const fn loss(scale: Scale) -> Parameter {
    Parameter::amplitude("loss", "Loss per work", scale, (0.0, 0.5), (-1.0, 1.0), &[0.01])
}

const TIME: Parameter = Parameter::shape(
    "time",
    "Time in which the heat leaves",
    Scale::plain("s"),
    (2.0, 3000.0),
    (1.0, 3000.0),
    &[5.0, 100.0],
);

fn faded(p: &[f64], memory: &mut Memory, call: &Call<'_>, force: f64, speed: f64) -> f64 {
    if p[0] == 0.0 {
        return call.target;
    }
    let power = (bounded(force) * bounded(speed)).abs();
    call.target * remaining(p[0] * store(memory, 0, power, p[1], call.dt))
}
