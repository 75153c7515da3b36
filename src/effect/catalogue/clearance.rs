//! A spring that first has to cross a gap.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// Inside the gap the force of a spring is taken away.
pub const EFFECT: Effect = Effect {
    id: "clearance",
    name: "Clearance of a spring",
    family: Family::Mechanism,
    port: Port::Force,
    also: &[],
    equation: "F = F_0 + k min(max(x, -b), b)",
    source: "standard engineering knowledge",
    signature: "no stiffness around the middle; third and fifth harmonics",
    confused_with: &[
        ("play", "the middle wanders with the motion"),
        ("progressive-spring", "no flat in the middle"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::Position],
    parameters: &[
        Parameter::amplitude(
            "stiffness",
            "Stiffness that is missing inside the gap",
            Scale::of("1", 1, [-1, 0, 0]),
            (0.0, 2.0),
            (-2.0, 2.0),
            &[0.02, 0.3, 1.0],
        ),
        Parameter::shape(
            "gap",
            "Half of the gap",
            Scale::of("1", 0, [1, 0, 0]),
            (0.001, 1.0),
            (0.001, 1.0),
            &[0.05, 0.3],
        ),
    ],
    apply,
};

fn apply(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 {
        return call.target;
    }
    let gap = p[1].abs();
    call.target + p[0] * call.drivers[0].clamp(-gap, gap)
}
