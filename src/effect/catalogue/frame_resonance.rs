//! A frame that vibrates with what it carries.

use super::operator::share_through_mode;
use crate::effect::{Effect, Family, Parameter, Port, Scale};

/// A share of the number passes a mode.
pub const EFFECT: Effect = Effect {
    id: "frame-resonance",
    name: "Mode of the rig or of a fixture",
    family: Family::Rig,
    port: Port::Output,
    also: &[],
    equation: "y_m = y + a (u - y), u'' + 2 D w u' + w^2 (u - y) = 0, w = 2 pi f",
    source: "PMC2665306 (structure compliance and dynamics reduce load fidelity); the mode: standard engineering knowledge",
    signature: "a peak at a fixed frequency, whatever the speed, the pressure and the tire",
    confused_with: &[
        ("belt-mode", "moves with the inflation pressure; needs the tire"),
        ("belt-order", "moves with the speed"),
        ("mains-hum", "there without excitation"),
        ("sensor-lag", "no peak"),
    ],
    targets: &[],
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
            (0.5, 300.0),
            (0.3, 400.0),
            // a quarter apart: a mode answers within twice its damping ratio
            &[
                0.7, 0.9, 1.1, 1.4, 1.7, 2.1, 2.7, 3.3, 4.2, 5.2, 6.5, 8.1, 10.0, 13.0, 16.0, 20.0, 25.0,
                31.0, 39.0, 48.0, 60.0, 75.0, 94.0, 120.0,
            ],
        ),
        Parameter::shape("damping", "Damping ratio", Scale::plain("1"), (0.005, 0.4), (0.003, 0.9), &[0.05]),
    ],
    apply: share_through_mode,
};
