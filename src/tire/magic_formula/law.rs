//! The Magic Formula as the law of a tire with one contact point.

use super::{
    Coefficients, Input, RelaxationLengths, effective_rolling_radius, gyroscopic_couple, relaxation_lengths,
    static_deflection, steady, vertical_force,
};
use crate::Result;
use crate::clone_in_place;
use crate::mechanics::Link;
use crate::model::Table;
use crate::tire::one_point::{Law, OnePoint, Pressed, Standstill, Steady};
use serde::{Deserialize, Serialize};

/// The Magic Formula tire.
pub type MagicFormula = OnePoint<Formula>;

/// Coefficients, and what belongs to them.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Formula {
    /// Name of the tire, for reports.
    pub name: String,
    /// The coefficients.
    pub coefficients: Coefficients,
    /// The coefficients are those of a tire for the other side of the vehicle.
    pub mirrored: bool,
    /// Damping of the deflection at standstill \[N.s/m\].
    pub low_speed_damping: f64,
}

clone_in_place!(Formula { name, coefficients, mirrored, low_speed_damping });

impl Law for Formula {
    const NAME: &'static str = "magic-formula";
    const TITLE: &'static str = "Magic Formula tire";
    const DOCUMENTATION: &'static str = include_str!("documentation.html");

    fn rows() -> Table<Self> {
        Self::table()
    }

    fn mount(&mut self) -> Result<()> {
        self.coefficients.check()
    }

    fn mirror(&mut self) {
        self.mirrored = !self.mirrored;
    }

    fn radius(&self) -> f64 {
        self.coefficients.unloaded_radius
    }

    fn normal_force(&self, pressed: &Pressed) -> f64 {
        vertical_force(&self.coefficients, pressed.deflection, pressed.rate)
    }

    fn deflection(&self, load: f64, _spin: f64) -> f64 {
        static_deflection(&self.coefficients, load)
    }

    fn rolling_radius(&self, deflection: f64, _spin: f64) -> f64 {
        effective_rolling_radius(&self.coefficients, vertical_force(&self.coefficients, deflection, 0.0))
    }

    fn relaxation(&self, load: f64, camber: f64) -> [f64; 2] {
        let RelaxationLengths { kappa, alpha } = relaxation_lengths(&self.coefficients, load, camber);
        [kappa, alpha]
    }

    /// Forces of the formula, seen from the side that the coefficients are of.
    fn steady(&self, input: &Input) -> Steady {
        let c = &self.coefficients;
        let output = match self.mirrored {
            true => steady(c, &input.mirrored()).mirrored(),
            false => steady(c, input),
        };
        Steady {
            force: [output.fx, output.fy],
            moment: [output.mx, output.my, output.mz],
            trail: output.trail,
            friction: [output.mu_x, output.mu_y],
            stiffness: [output.slip_stiffness, output.cornering_stiffness],
            couple: gyroscopic_couple(c, 1.0, 1.0, output.residual_decay),
            outside: output.outside.any(),
        }
    }

    fn standstill(&self) -> Standstill {
        Standstill { speed: self.coefficients.vxlow, damping: self.low_speed_damping }
    }

    fn vertical_link(&self) -> Link {
        let c = &self.coefficients;
        Link {
            stiffness: ("VERTICAL_STIFFNESS", c.lcz * c.vertical_stiffness),
            damping: ("VERTICAL_DAMPING", c.vertical_damping),
            mass: ("the road", f64::INFINITY),
        }
    }

    fn usual_load(&self) -> (f64, [&'static str; 2]) {
        let along = "stiffness along (PKX1 over PTX1) times the radius squared";
        (self.coefficients.fnomin, [along, "stiffness across (PKY1 over PTY1)"])
    }
}
