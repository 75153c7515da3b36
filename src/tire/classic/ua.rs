//! The UA tire (Gim): a brush under parabolic pressure for slip, slip angle and camber together.

use super::Basics;
use super::basics::{Forces, slip_over_faster};
use crate::model::{Role, Table, parameter};
use crate::real;
use crate::tire::brush::{adhesion, brush_force};
use crate::tire::one_point::{Input, Steady};
use serde::{Deserialize, Serialize};

/// The forces of the UA tire.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Ua {
    /// Slope of the lateral force over the sine of camber at none, C_γ \[N/rad\] (2-12); positive.
    pub camber_stiffness: f64,
}

impl Forces for Ua {
    const NAME: &'static str = "ua";
    const TITLE: &'static str = "UA tire";
    const DOCUMENTATION: &'static str =
        concat!(include_str!("ua.html"), include_str!("basics.html"), include_str!("ua_limits.html"));

    #[rustfmt::skip] // a row is a line
    fn rows() -> Table<Self> {
        Table::new([
            parameter("camber_stiffness", "N/rad", real!(camber_stiffness), 2000.0, "Slope of the lateral force over camber at none, counted positive (C_gamma)").range(0.0, 1e6).tunable().role(Role::Stiffness),
        ])
    }

    /// (2-43) to (2-53) in both directions: bristles are sheared by both slips at their stiffnesses and slide in the direction
    /// of the slip.
    fn steady(&self, b: &Basics, input: &Input) -> Steady {
        let (along, tangent) = (slip_over_faster(input.kappa), libm::tan(input.alpha));
        // driven, the way over the road is shorter than that of the tread (2-8)
        let side = if along > 0.0 { (1.0 - along) * tangent } else { tangent };
        // camber is a further slip to the side
        let aside = side + self.camber_stiffness / b.cornering_stiffness * libm::sin(input.gamma);
        let slip = libm::hypot(along, aside);
        let friction = b.friction_at(slip) * input.friction;
        let most = friction * input.fz;
        let sheared = libm::hypot(b.slip_stiffness * along, b.cornering_stiffness * aside);
        let adhering = adhesion(1.0, sheared, most);
        let [most_along, most_aside] =
            [along, aside].map(|part| if slip > 0.0 { most * part.abs() / slip } else { 0.0 });
        let fx = brush_force(b.slip_stiffness, along, most_along, adhering);
        let fy = -brush_force(b.cornering_stiffness, aside, most_aside, adhering);
        let length = Self::contact_length(b, input.fz);
        let aligning = length * Self::moment(b, [along, aside], [most_along, most_aside], adhering);
        Steady {
            force: [fx, fy],
            moment: [0.0, b.resistance(input.fz, input.vx), aligning],
            trail: if fy == 0.0 { length / 6.0 } else { -aligning / fy },
            friction: [friction; 2],
            stiffness: [b.slip_stiffness, -b.cornering_stiffness],
            ..Steady::default()
        }
    }
}

impl Ua {
    /// The chord that the road cuts off the circle without load \[m\], at a load.
    fn contact_length(b: &Basics, load: f64) -> f64 {
        let radius = b.radius;
        let loaded = (radius - load / b.vertical[0]).max(0.0);
        2.0 * libm::sqrt(radius * radius - loaded * loaded)
    }

    /// Moment about the middle of the contact over its length \[N\]. Of the lateral stresses: where bristles adhere (2-46)
    /// C S l² (2 l/3 − 1/2), where they slide (2-47) 3/2 μ F l² (1 − l)². And of the longitudinal ones, which act where the bristles
    /// have gone to the side: 2/3 C_s S_s S_α l³ and 3/5 μ_x μ_y F² / C_α (1 − 10 l³ + 15 l⁴ − 6 l⁵).
    fn moment(
        b: &Basics,
        [along, aside]: [f64; 2],
        [most_along, most_aside]: [f64; 2],
        adhering: f64,
    ) -> f64 {
        let (l, slides) = (adhering, 1.0 - adhering);
        let lateral = b.cornering_stiffness * aside.abs() * l * l * (2.0 / 3.0 * l - 0.5)
            + 1.5 * most_aside * l * l * slides * slides;
        let cube = l * l * l;
        let shifted = 2.0 / 3.0 * b.slip_stiffness * along * aside.abs() * cube
            + 0.6 * most_along.copysign(along) * most_aside / b.cornering_stiffness
                * (1.0 - cube * (10.0 - l * (15.0 - 6.0 * l)));
        if aside < 0.0 { -lateral - shifted } else { lateral + shifted }
    }
}
