//! The linear tire: springs, dampers and stiffnesses, up to the friction.

use super::Basics;
use super::basics::Forces;
use crate::model::Table;
use crate::tire::one_point::{Input, Steady};
use serde::{Deserialize, Serialize};

/// Forces in proportion to slip and slip angle, no longer than the friction.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Linear;

impl Forces for Linear {
    const NAME: &'static str = "linear";
    const TITLE: &'static str = "Linear spring-damper tire";
    const DOCUMENTATION: &'static str =
        concat!(include_str!("linear.html"), include_str!("basics.html"), include_str!("linear_limits.html"));

    fn rows() -> Table<Self> {
        Table::new([])
    }

    fn steady(&self, b: &Basics, input: &Input) -> Steady {
        let slip = libm::hypot(input.kappa, libm::tan(input.alpha.abs()));
        let friction = b.friction_at(slip) * input.friction;
        let wanted = [b.slip_stiffness * input.kappa, -b.cornering_stiffness * input.alpha];
        let length = libm::hypot(wanted[0], wanted[1]);
        let share = if length > friction * input.fz { friction * input.fz / length } else { 1.0 };
        Steady {
            force: wanted.map(|force| share * force),
            moment: [0.0, b.resistance(input.fz, input.vx), 0.0],
            friction: [friction; 2],
            stiffness: [b.slip_stiffness, -b.cornering_stiffness],
            ..Steady::default()
        }
    }
}
