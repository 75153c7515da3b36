//! A spring and a damper in line, beside what is there.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// -k (x - x_d) is added to a force, T dx_d/dt + x_d = x.
pub const EFFECT: Effect = Effect {
    id: "maxwell-element",
    name: "Maxwell element",
    family: Family::Mechanism,
    port: Port::Force,
    also: &[],
    equation: "F = F_0 - k (x - x_d), T dx_d/dt + x_d = x",
    source: "standard engineering knowledge",
    signature: "stiffness rises once, by k within about a decade around the frequency 1 / (2 pi T), where most is lost per cycle; a rise over several decades needs several of them",
    confused_with: &[
        ("viscous-drag", "loss goes on growing with the frequency"),
        ("bushing-hysteresis", "loss depends on the amplitude, not on the frequency"),
        ("viscoelastic-stiffening", "the same, seen in a force output"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::Position],
    parameters: &[
        Parameter::amplitude(
            "stiffness",
            "Stiffness at high frequency that is gone at low",
            Scale::of("1", 1, [-1, 0, 0]),
            (0.0, 3.0),
            (-3.0, 3.0),
            &[0.02],
        ),
        Parameter::shape(
            "time",
            "Time constant",
            Scale::own_time(1),
            (0.0005, 5.0),
            (0.0002, 10.0),
            &[0.003, 0.03, 0.3],
        ),
    ],
    apply,
};

fn apply(p: &[f64], memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 {
        return call.target;
    }
    let x = call.drivers[0];
    call.target - p[0] * (x - memory.lag(0, x, p[1], call.dt))
}
