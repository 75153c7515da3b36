//! A tire that leaves the road.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// The part of the load below its least value is cut.
pub const EFFECT: Effect = Effect {
    id: "loss-of-contact",
    name: "Loss of contact",
    family: Family::Tire,
    port: Port::Output,
    also: &[],
    equation: "Fz = F_0 + a max(0, -F_s - F_0), a = 1",
    source: "standard engineering knowledge",
    signature: "clipped on one side at zero load, with all harmonics",
    confused_with: &[
        ("saturation", "on both sides, at a limit of the amplifier"),
        ("bump-stop", "on the side of large displacements"),
    ],
    targets: &[Role::Force, Role::Load],
    drivers: &[],
    parameters: &[
        Parameter::amplitude(
            "share",
            "How much is cut: 1 when it is there",
            Scale::plain("1"),
            (0.3, 1.3),
            (-0.5, 1.5),
            &[0.1],
        ),
        Parameter::shape(
            "static_load",
            "Load that the number leaves out: 0 if it is the whole load",
            Scale::of("1", 1, [0, 0, 0]),
            (-0.1, 2.0),
            (-0.5, 2.0),
            &[0.0, 0.5],
        ),
    ],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 { call.target } else { call.target + p[0] * (-p[1] - call.target).max(0.0) }
}
