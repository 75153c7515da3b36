//! A belt that vibrates between the road and the rim.

use super::operator::share_through_mode;
use crate::effect::{Effect, Family, Parameter, Port, Role, Scale};

/// A share of the force passes a mode.
pub const EFFECT: Effect = Effect {
    id: "belt-mode",
    name: "Mode of the belt on its sidewalls",
    family: Family::Tire,
    port: Port::Output,
    also: &[],
    equation: "F = F_0 + a (u - F_0), u'' + 2 D w u' + w^2 (u - F_0) = 0, w = 2 pi f",
    source: "TST 48(3):188 (cleat response is governed by rigid belt modes)",
    signature: "a peak at some tens of Hz after obstacles and steps of torque; moves with the inflation pressure",
    confused_with: &[
        ("frame-resonance", "there with another tire and without one"),
        ("driveline-compliance", "moves with the inertia of the driveline"),
        ("sensor-lag", "no peak"),
    ],
    targets: &[Role::Force],
    drivers: &[],
    parameters: &[
        Parameter::amplitude(
            "share",
            "Share that passes the belt",
            Scale::plain("1"),
            (0.0, 1.3),
            (-0.5, 1.5),
            &[0.05],
        ),
        Parameter::shape(
            "frequency",
            "Frequency",
            Scale::plain("Hz"),
            (20.0, 150.0),
            (10.0, 200.0),
            &[30.0, 60.0, 100.0],
        ),
        Parameter::shape("damping", "Damping ratio", Scale::plain("1"), (0.005, 0.4), (0.003, 0.9), &[0.05]),
    ],
    apply: share_through_mode,
};
