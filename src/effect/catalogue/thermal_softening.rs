//! Rubber that loses friction when it gets hot.

use super::operator::{HEAT_KEPT, bounded, remaining, store};
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
        ("frictional-heating", "the same with a power that the model tells"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::Slip, Role::TravelSpeed],
    parameters: &[loss(Scale::of("1/s", -1, [-1, -1, 0]), 1.0), TIME, HEAT_KEPT],
    apply: |p, memory, call| {
        let power = bounded(call.target) * bounded(call.drivers[0]) * bounded(call.drivers[1]);
        softened(p, memory, call, power.abs())
    },
};

/// The same with the power of both axes, for a friction that both forces share.
pub const BOTH_AXES: Effect = Effect {
    equation: "mu = mu_0 (1 - tanh(a E)), dE/dt = |V| (|F_x slip| + |F_y tan(alpha)|) - E / T",
    drivers: &[Role::TravelSpeed, Role::LateralForce, Role::LongitudinalForce, Role::SlipAngle, Role::Slip],
    // slips are far below 1
    parameters: &[loss(Scale::of("1/s", 0, [-1, -1, 0]), 20.0), TIME, HEAT_KEPT],
    apply: |p, memory, call| {
        let d = |i: usize| bounded(call.drivers[i]);
        let force_times_slip = (d(1) * libm::tan(d(3))).abs() + (d(2) * d(4)).abs();
        softened(p, memory, call, bounded(force_times_slip) * d(0).abs())
    },
    ..EFFECT
};

/// The same with the power of the lateral axis, where the wheel rolls freely.
pub const SIDEWAYS: Effect = Effect {
    equation: "mu = mu_0 (1 - tanh(a E)), dE/dt = |V F_y tan(alpha)| - E / T",
    drivers: &[Role::TravelSpeed, Role::LateralForce, Role::SlipAngle],
    apply: |p, memory, call| {
        let [speed, force, angle] = [0, 1, 2].map(|i| bounded(call.drivers[i]));
        softened(p, memory, call, (bounded(force * libm::tan(angle)) * speed).abs())
    },
    ..BOTH_AXES
};

const fn loss(scale: Scale, most: f64) -> Parameter {
    Parameter::amplitude("loss", "Loss per work", scale, (0.0, most), (-2.0 * most, 2.0 * most), &[0.01])
}

const TIME: Parameter = Parameter::shape(
    "time",
    "Time in which the heat leaves",
    Scale::plain("s"),
    (0.5, 3000.0),
    (0.2, 3000.0),
    &[3.0, 60.0],
);

fn softened(p: &[f64], memory: &mut Memory, call: &Call<'_>, power: f64) -> f64 {
    if p[0] == 0.0 {
        return call.target;
    }
    call.target * remaining(p[0] * store(memory, 0, power, p[1], call.dt))
}
