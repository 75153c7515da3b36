//! The linear tire: springs, dampers and stiffnesses, up to the friction.

use super::Basics;
use crate::mechanics::Link;
use crate::model::Table;
use crate::tire::one_point::{Input, Law, Pressed, Standstill, Steady};
use crate::{clone_in_place, lens};
use serde::{Deserialize, Serialize};

/// Forces in proportion to slip and slip angle, on a spring and a damper; no longer than the friction.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Linear {
    /// The parameters.
    pub basics: Basics,
}

clone_in_place!(Linear { basics });

impl Law for Linear {
    const NAME: &'static str = "linear";
    const TITLE: &'static str = "Linear spring-damper tire";
    const DOCUMENTATION: &'static str =
        concat!(include_str!("linear.html"), include_str!("basics.html"), include_str!("linear_limits.html"));

    fn rows() -> Table<Self> {
        Table::new([]).part("", lens!(basics), Basics::rows())
    }

    fn radius(&self) -> f64 {
        self.basics.radius
    }

    fn normal_force(&self, pressed: &Pressed) -> f64 {
        self.basics.normal_force(pressed)
    }

    fn deflection(&self, load: f64, _spin: f64) -> f64 {
        load / self.basics.vertical[0]
    }

    /// The distance of the wheel's centre from the road.
    fn rolling_radius(&self, deflection: f64, _spin: f64) -> f64 {
        self.basics.radius - deflection.max(0.0)
    }

    fn relaxation(&self, _load: f64, _camber: f64) -> [f64; 2] {
        self.basics.relaxation()
    }

    fn steady(&self, input: &Input) -> Steady {
        let b = &self.basics;
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

    fn standstill(&self) -> Standstill {
        self.basics.standstill()
    }

    fn vertical_link(&self) -> Link {
        self.basics.vertical_link()
    }

    fn usual_load(&self) -> (f64, [&'static str; 2]) {
        self.basics.usual_load()
    }
}
