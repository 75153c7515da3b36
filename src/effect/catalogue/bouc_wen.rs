//! Hysteresis of joints, wire ropes and metal.

use super::operator::bouc_wen;
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// -F_h z is added to a force; z follows the displacement.
pub const EFFECT: Effect = Effect {
    id: "bouc-wen",
    name: "Bouc-Wen hysteresis",
    family: Family::Mechanism,
    port: Port::Force,
    also: &[],
    equation: "F = F_0 - F_h z, dz = (dx - |dx| z / 2 - dx |z| / 2) / x_0, |z| <= 1",
    source: "Ismail, Ikhouane, Rodellar 2009, Arch Comput Methods Eng 16:161-188; exponent 1, beta = gamma",
    signature: "loops that do not change with the frequency; stiff after each turn, straight back to zero",
    confused_with: &[
        ("maxwell-element", "its loop changes with the frequency"),
        ("coulomb-friction", "jumps at each turn"),
        ("bushing-hysteresis", "rounder, and softer the further it goes"),
        ("payne", "the same family"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::Position],
    parameters: &[
        Parameter::amplitude(
            "force",
            "Largest force of the hysteresis",
            Scale::of("1", 1, [0, 0, 0]),
            (0.0, 2.0),
            (-2.0, 2.0),
            &[0.02, 0.06, 0.2, 0.6],
        ),
        Parameter::shape(
            "length",
            "Way from rest in which 63 % are built up",
            Scale::of("1", 0, [1, 0, 0]),
            (0.001, 2.0),
            (0.003, 2.0),
            &[0.03, 0.3],
        ),
    ],
    apply,
};

fn apply(p: &[f64], memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 {
        return call.target;
    }
    call.target - p[0] * bouc_wen(memory, 0, call.drivers[0], p[1], call.dt)
}
