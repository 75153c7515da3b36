//! A motion that rings.

use super::actuator_lag::ACTUATED;
use super::operator::share_through_mode;
use crate::effect::{Effect, Family, Parameter, Port, Scale};

/// A share of the commanded motion passes a mode.
pub const EFFECT: Effect = Effect {
    id: "actuator-resonance",
    name: "Actuator or mount with a mode",
    family: Family::Rig,
    port: Port::Input,
    also: &[],
    equation: "x = x_cmd + a (u - x_cmd), u'' + 2 D w u' + w^2 (u - x_cmd) = 0, w = 2 pi f",
    source: "standard engineering knowledge",
    signature: "all outputs ring at one fixed frequency after fast commands",
    confused_with: &[("frame-resonance", "one output only"), ("actuator-lag", "no overshoot")],
    targets: ACTUATED,
    drivers: &[],
    parameters: &[
        Parameter::amplitude(
            "share",
            "Share that passes the mode",
            Scale::plain("1"),
            (0.0, 1.3),
            (-0.5, 1.5),
            &[0.05],
        ),
        Parameter::shape(
            "frequency",
            "Frequency",
            Scale::own_time(-1),
            (0.5, 100.0),
            (0.3, 200.0),
            &[1.5, 5.0, 15.0, 40.0],
        ),
        Parameter::shape("damping", "Damping ratio", Scale::plain("1"), (0.005, 0.7), (0.003, 0.9), &[0.15]),
    ],
    apply: share_through_mode,
};
