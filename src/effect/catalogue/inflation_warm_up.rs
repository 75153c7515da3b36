//! A tire that warms up and gets stiffer.

use super::operator::{HEAT_KEPT, bounded, store};
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// Rolling warms it: dU/dt = |V| / T - U / T; F (1 + a U).
pub const EFFECT: Effect = Effect {
    id: "inflation-warm-up",
    name: "Inflation pressure that rises while rolling",
    family: Family::Tire,
    port: Port::Output,
    also: &[(Port::Parameter, Role::Stiffness)],
    equation: "F = F_0 (1 + a U), T dU/dt + U = |V|, U = 0 at the start",
    source: "ideal gas at constant volume, standard engineering knowledge; here one heat store",
    signature: "a slow rise of the stiffness of tire and carcass from the start of a run, the more the faster it rolls",
    confused_with: &[
        ("thermal-softening", "less force, from sliding"),
        ("sensor-drift", "in zero too"),
        ("pressure-dependent-friction", "follows a pressure that is known"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::TravelSpeed],
    parameters: &[rise(Scale::of("1", 0, [-1, 0, 0])), TIME, HEAT_KEPT],
    apply: |p, memory, call| warmed(p, memory, call, call.drivers[0]),
};

/// The same with the load: what flexes the tire heats it.
pub const BY_LOAD: Effect = Effect {
    equation: "F = F_0 (1 + a U), T dU/dt + U = |V Fz|, U = 0 at the start",
    drivers: &[Role::TravelSpeed, Role::Load],
    parameters: &[rise(Scale::of("1", 0, [-1, -1, 0])), TIME, HEAT_KEPT],
    apply: |p, memory, call| warmed(p, memory, call, bounded(call.drivers[0]) * bounded(call.drivers[1])),
    ..EFFECT
};

/// Warmed through, that is after several time constants: more than a run of seconds ever shows.
const fn rise(scale: Scale) -> Parameter {
    Parameter::amplitude(
        "rise",
        "Relative rise per speed (and load), warmed through",
        scale,
        (0.0, 5.0),
        (-1.0, 5.0),
        &[0.02],
    )
}

const TIME: Parameter = Parameter::shape(
    "time",
    "Time constant of the warming",
    Scale::plain("s"),
    (2.0, 3000.0),
    (1.0, 3000.0),
    &[5.0, 100.0],
);

fn warmed(p: &[f64], memory: &mut Memory, call: &Call<'_>, heating: f64) -> f64 {
    if p[0] == 0.0 || p[1] <= 0.0 {
        return call.target;
    }
    let warm = store(memory, 0, bounded(heating.abs()), p[1], call.dt) / p[1];
    call.target * (1.0 + p[0] * warm)
}
