//! A spring with filled rubber: softer the larger the amplitude.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// A part of the stiffness that the amplitude of the last moments breaks down.
pub const EFFECT: Effect = Effect {
    id: "amplitude-softening",
    name: "Spring that is softer at large amplitudes",
    family: Family::Mechanism,
    port: Port::Force,
    also: &[],
    equation: "F = F_0 - k x / (1 + A / A_c), T dA/dt + A = pi / 2 |x|",
    source: "Kraus' form of the Payne effect with exponent 1 (standard engineering knowledge); the amplitude as a running mean",
    signature: "resonance falls with the amplitude; no harmonics at a steady amplitude",
    confused_with: &[
        ("payne", "the same, seen in a force output, with friction"),
        ("bushing-hysteresis", "loss per cycle that does not depend on the frequency"),
        ("progressive-spring", "depends on where it is, not on the amplitude: harmonics"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::Position],
    parameters: &[
        Parameter::amplitude(
            "stiffness",
            "Stiffness at small amplitudes that is gone at large ones",
            Scale::of("1", 1, [-1, 0, 0]),
            (0.0, 5.0),
            (-5.0, 5.0),
            &[0.02],
        ),
        Parameter::shape(
            "amplitude",
            "Amplitude at which half of it is gone",
            Scale::of("1", 0, [1, 0, 0]),
            (0.01, 10.0),
            (0.02, 10.0),
            &[0.2, 0.7, 2.5],
        ),
        Parameter::shape(
            "time",
            "Time over which the amplitude is felt",
            Scale::own_time(1),
            (0.01, 10.0),
            (0.02, 5.0),
            &[0.1, 0.5],
        ),
    ],
    apply,
};

fn apply(p: &[f64], memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 || p[1] <= 0.0 {
        return call.target;
    }
    let x = call.drivers[0];
    let amplitude = memory.lag(0, 0.5 * std::f64::consts::PI * x.abs(), p[2], call.dt);
    call.target - p[0] * x / (1.0 + amplitude / p[1])
}
