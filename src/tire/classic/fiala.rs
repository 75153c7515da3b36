//! Fiala's tire: a brush under uniform pressure, slip and slip angle each for itself.

use super::Basics;
use super::basics::Forces;
use crate::model::{Table, integer_parameter, parameter};
use crate::tire::one_point::{Input, Steady};
use crate::{integer, real};
use serde::{Deserialize, Serialize};

/// The forms of the aligning moment, from 1.
const MOMENTS: &[(&str, &str)] = &[
    ("usual", "mu Fz w (1 - H) H^3, as it is implemented everywhere"),
    ("printed", "mu Fz w (1 - H^3) H^3, as the source prints it (2-39)"),
];

/// Fiala's forces.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Fiala {
    /// Width of the contact \[m\], the lever of the aligning moment.
    pub width: f64,
    /// Which form of the aligning moment, from 1 in the order of its items.
    pub moment: i32,
}

impl Forces for Fiala {
    const NAME: &'static str = "fiala";
    const TITLE: &'static str = "Fiala tire";
    const DOCUMENTATION: &'static str =
        concat!(include_str!("fiala.html"), include_str!("basics.html"), include_str!("fiala_limits.html"));

    #[rustfmt::skip] // a row is a line
    fn rows() -> Table<Self> {
        Table::new([
            parameter("tire_width", "m", real!(width), 0.152, "Width of the contact, the lever of the aligning moment").range(0.01, 1.5),
            integer_parameter("aligning_moment", integer!(moment), 1, "Form of the aligning moment").items(MOMENTS),
        ])
    }

    /// (2-31) to (2-42).
    fn steady(&self, b: &Basics, input: &Input) -> Steady {
        let tangent = libm::tan(input.alpha.abs());
        let slip = input.kappa.abs();
        let friction = b.friction_at(libm::hypot(slip, tangent)) * input.friction;
        let most = friction * input.fz;
        let resistance = b.resistance(input.fz, input.vx);
        if most <= 0.0 {
            return Steady { moment: [0.0, resistance, 0.0], ..Steady::default() };
        }
        let along = match slip <= 0.5 * most / b.slip_stiffness {
            true => b.slip_stiffness * slip,
            false => most - most * most / (4.0 * slip * b.slip_stiffness),
        };
        // what adheres; none from the critical angle on (2-38)
        let h = (1.0 - b.cornering_stiffness * tangent / (3.0 * most)).max(0.0);
        let cube = h * h * h;
        let share = if self.moment == 2 { 1.0 - cube } else { 1.0 - h };
        let aligning = most * self.width * share * cube;
        Steady {
            force: [along.copysign(input.kappa), -(most * (1.0 - cube)).copysign(input.alpha)],
            moment: [0.0, resistance, aligning.copysign(input.alpha)],
            // in the limit of no slip angle too
            trail: self.width * cube * if self.moment == 2 { 1.0 } else { 1.0 / (1.0 + h + h * h) },
            friction: [friction; 2],
            stiffness: [b.slip_stiffness, -b.cornering_stiffness],
            ..Steady::default()
        }
    }
}
