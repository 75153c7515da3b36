//! Rubber that loses friction when it gets hot.

use super::operator::{bounded, remaining, store};
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// The work of sliding heats it: dE/dt = |F slip V| - E / T; F (1 - tanh(a E)).
pub const EFFECT: Effect = Effect {
    id: "thermal-softening",
    name: "Friction that falls with the heat of sliding",
    family: Family::Tire,
    port: Port::Output,
    also: &[(Port::Parameter, Role::Friction)],
    equation: "F = F_0 (1 - tanh(a E)), dE/dt = |F_0 slip V| - E / T",
    source: "Persson, Miyashita arXiv 2602.22078; Mavros 2018, 10.1080/00423114.2018.1484147; here one heat store and a linear loss",
    signature: "a slow loss that goes with the work of sliding and comes back in pauses; up and down of a sweep differ",
    confused_with: &[
        ("sensor-drift", "without sliding too"),
        ("speed-dependent-friction", "does not depend on what went before"),
        ("inflation-warm-up", "more force, from rolling alone"),
        ("frictional-heating", "the same with a friction power that the model tells"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::Slip, Role::TravelSpeed],
    parameters: &[
        Parameter::amplitude(
            "loss",
            "Loss per work",
            Scale::of("1/s", -1, [-1, -1, 0]),
            (0.0, 1.0),
            (-2.0, 2.0),
            &[0.01],
        ),
        Parameter::shape(
            "time",
            "Time in which the heat leaves",
            Scale::plain("s"),
            (0.5, 3000.0),
            (0.2, 3000.0),
            &[3.0, 60.0],
        ),
    ],
    apply,
};

fn apply(p: &[f64], memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 {
        return call.target;
    }
    let power = (bounded(call.target) * bounded(call.drivers[0]) * bounded(call.drivers[1])).abs();
    call.target * remaining(p[0] * store(memory, 0, power, p[1], call.dt))
}
