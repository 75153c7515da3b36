//! A shaft that winds up before it passes a torque on.

use super::operator::share_through_mode;
use crate::effect::{Effect, Family, Parameter, Port, Role, Scale};

/// A share of the torque passes a mode of torsion.
pub const EFFECT: Effect = Effect {
    id: "driveline-compliance",
    name: "Soft shaft",
    family: Family::Brake,
    port: Port::Input,
    also: &[],
    equation: "M = M_0 + a (u - M_0), u'' + 2 D w u' + w^2 (u - M_0) = 0, w = 2 pi f",
    source: "standard engineering knowledge",
    signature: "a decaying vibration at a fixed frequency after each step of the torque",
    confused_with: &[
        ("belt-mode", "in the tire: changes with the pressure"),
        ("backlash", "only when the torque changes sign"),
        ("hydraulic-lag", "no overshoot"),
    ],
    targets: &[Role::Force],
    drivers: &[],
    parameters: &[
        Parameter::amplitude(
            "share",
            "Share that passes the shaft",
            Scale::plain("1"),
            (0.0, 1.3),
            (-0.5, 1.5),
            &[0.05],
        ),
        Parameter::shape(
            "frequency",
            "Frequency",
            Scale::own_time(-1),
            (0.5, 60.0),
            (0.3, 100.0),
            &[1.5, 4.0, 12.0, 35.0],
        ),
        Parameter::shape("damping", "Damping ratio", Scale::plain("1"), (0.005, 0.7), (0.003, 0.9), &[0.15]),
    ],
    apply: share_through_mode,
};
