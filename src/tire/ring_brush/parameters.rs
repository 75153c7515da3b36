//! The numbers of a ring-and-brush tire.

use crate::{Error, Result};
use serde::{Deserialize, Serialize};

/// Parameters of the tire, in SI units. The table of [`RingBrush`](super::RingBrush) gives each its description,
/// the source's symbol, its default (the source's example, section 4.2.10) and its range.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[allow(missing_docs)] // said once, in the variable table
pub struct Parameters {
    // belt shell
    pub radius: f64,
    pub width: f64,
    pub cross_section_radius: f64,
    pub rolling_radius: f64,
    /// Length of the contact that bridges edges of the road.
    pub filter_length: f64,
    // belt
    pub belt_mass: f64,
    pub belt_inertia_diametral: f64,
    pub belt_inertia_polar: f64,
    pub gravity: f64,
    // vertical spring between belt and road
    pub vertical_stiffness: f64,
    pub vertical_stiffness_quadratic: f64,
    pub vertical_damping: f64,
    // side wall: spring-dampers between rim and belt, in belt axes
    pub sidewall_radial_stiffness: f64,
    pub sidewall_lateral_stiffness: f64,
    pub sidewall_tilt_stiffness: f64,
    pub sidewall_windup_stiffness: f64,
    pub sidewall_radial_damping: f64,
    pub sidewall_lateral_damping: f64,
    pub sidewall_tilt_damping: f64,
    pub sidewall_windup_damping: f64,
    // bristles
    pub stripes: i32,
    pub bristles_per_stripe: i32,
    pub bristle_length: f64,
    pub bristle_stiffness: f64,
    pub bristle_damping: f64,
    pub stripe_length_factor: f64,
    // patch on its carcass
    pub patch_compliance_x: f64,
    pub patch_compliance_y: f64,
    pub patch_compliance_twist: f64,
    pub patch_lag_x: f64,
    pub patch_lag_y: f64,
    pub patch_lag_twist: f64,
    // pressure and friction
    pub pressure_exponent_long: [f64; 3],
    pub pressure_exponent_lat: [f64; 3],
    pub rolling_resistance_lever: f64,
    pub friction_static: [f64; 2],
    pub friction_sliding: [f64; 2],
    pub friction_pressure: f64,
    pub friction_pressure_scale: f64,
    pub friction_speed_falloff: f64,
    // readings of ambiguous places
    pub even_stripes: bool,
    pub antisymmetric_coupling: bool,
    pub limit_pressure_tilt: bool,
    pub whole_step_entry: bool,
}

impl Parameters {
    /// Width of a stripe \[m\]: as printed in (4.16), or the tire's width in even parts.
    pub fn stripe_width(&self) -> f64 {
        let n = f64::from(self.stripes);
        if self.even_stripes { self.width / n } else { 3.0 * self.width / (3.0 * n - 1.0) }
    }

    /// Lateral position of stripe `i`, counted from 0 at the largest +y \[m\] (4.16).
    pub fn stripe_position(&self, i: usize) -> f64 {
        self.stripe_width() * ((f64::from(self.stripes) + 1.0) / 2.0 - (i as f64 + 1.0))
    }

    /// Radius of the belt shell above stripe `i` \[m\] (4.19).
    pub fn stripe_radius(&self, i: usize) -> f64 {
        let (y, r) = (self.stripe_position(i), self.cross_section_radius);
        self.radius + (r * r - y * y).sqrt() - r
    }

    /// Area of a bristle \[m²\].
    pub fn cell_area(&self) -> f64 {
        self.bristle_length * self.stripe_width()
    }

    /// Length of the ring of bristles over which x is wrapped \[m\] (4.17).
    pub fn ring_length(&self) -> f64 {
        f64::from(self.bristles_per_stripe) * self.bristle_length
    }

    /// Bending compliance of the patch \[1/(N.m)\] (4.28).
    pub fn bend_compliance(&self) -> f64 {
        self.patch_compliance_y / (self.radius * self.radius)
    }

    /// Checks what the ranges of the single parameters cannot say.
    ///
    /// # Errors
    /// A sentence for the first contradiction found.
    pub fn check(&self) -> Result<()> {
        let fail = |message: String| Err(Error::variable(message));
        let half = self.width / 2.0;
        if self.cross_section_radius <= half {
            return fail(format!(
                "cross_section_radius = {} m has to be larger than half the tire_width, {half} m",
                self.cross_section_radius
            ));
        }
        if self.rolling_radius > self.radius {
            return fail(format!(
                "rolling_radius = {} m is larger than tire_radius = {} m",
                self.rolling_radius, self.radius
            ));
        }
        if self.stripe_radius(0) <= 0.0 {
            return fail(format!(
                "tire_radius = {} m is too small for tire_width and cross_section_radius: the outer stripe has no radius left",
                self.radius
            ));
        }
        for (i, at) in ["zero", "reference"].into_iter().enumerate() {
            let (stick, slide) = (self.friction_static[i], self.friction_sliding[i]);
            if stick < slide {
                return fail(format!(
                    "friction_static_{at} = {stick} is below friction_sliding_{at} = {slide}; a bristle that breaks away would stick again at once"
                ));
            }
        }
        Ok(())
    }
}
