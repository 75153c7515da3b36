//! Mass on the side of the load cell that moves.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// F_m = F + m a.
pub const EFFECT: Effect = Effect {
    id: "fixture-inertia",
    name: "Mass between load cell and specimen",
    family: Family::Rig,
    port: Port::Output,
    also: &[],
    equation: "F_m = F + m a",
    source: "Hnat, van den Bogert 2014, J Biomech 47(15):3758-3761",
    signature: "in phase with the acceleration, in the empty rig too; the motion is right",
    confused_with: &[
        ("added-inertia", "changes the motion"),
        ("frame-resonance", "a peak, with the phase turning over"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::Acceleration],
    parameters: &[Parameter::amplitude(
        "mass",
        "Mass, or moment of inertia",
        Scale::of("1", 1, [-1, 0, 0]),
        (-2.0, 2.0),
        (-3.0, 3.0),
        &[0.02],
    )],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 { call.target } else { call.target + p[0] * call.drivers[0] }
}
