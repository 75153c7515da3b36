//! What holds a wheel carrier under the body: rods with bushings, and the strut.

use crate::mechanics::{BumpStop, Curve, Rod, Spanned, SpringDamper};
use crate::model::{Purpose, Role, Table, parameter};
use crate::{clone_in_place, real};
use serde::{Deserialize, Serialize};

/// A link between two ball joints, with the compliance of its bushings.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Link {
    /// From the body to the carrier.
    pub rod: Rod,
    /// Where the vehicle stands \[m\].
    pub length: f64,
    /// The force there, positive if it pulls \[N\].
    pub preload: f64,
    pub bushing: SpringDamper,
}

impl Link {
    /// Force of the link, positive if it pulls \[N\].
    pub fn pull(&self, at: &Spanned) -> f64 {
        self.preload + self.bushing.force(at.length - self.length, at.rate)
    }

    /// Energy in it beyond that where the vehicle stands \[J\].
    pub fn energy(&self, at: &Spanned) -> f64 {
        let longer = at.length - self.length;
        self.preload * longer + self.bushing.energy(longer)
    }
}

/// Springs and dampers of an axle.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Springs {
    pub stiffness: f64,
    /// Points of the damper's force over its speed.
    pub damper_points: String,
    pub damper: Curve,
    pub bump: BumpStop,
    pub rebound: BumpStop,
    /// Of the anti-roll bar: force on each strut over the difference of their ways \[N/m\].
    pub anti_roll: f64,
}

clone_in_place!(Springs { stiffness, damper_points, damper, bump, rebound, anti_roll });

/// The largest speed and force in a damper's curve.
const LARGEST: f64 = 1e7;

impl Springs {
    #[rustfmt::skip] // a row is a line
    pub fn rows() -> Table<Self> {
        Table::new([
            parameter("spring_stiffness", "N/m", real!(stiffness), 38e3, "Spring of a strut").range(1.0, 1e7).role(Role::Stiffness).tunable(),
            crate::model::text_parameter("damper", crate::text!(damper_points), "-2 -5200; 2 5200", "Force of a strut's damper over the speed with which it shortens, as points 'speed [m/s] force [N]; ...' with straight lines between them, and on beyond"),
            parameter("bump_stop_gap", "m", real!(bump.gap), 0.06, "Way by which a strut shortens from where the vehicle stands until it meets the bump stop").range(0.0, 1.0).purpose(Purpose::Data),
            parameter("bump_stop_stiffness", "N/m2", real!(bump.stiffness), 2e7, "Force of the bump stop over the square of the way into it").range(0.0, 1e10).role(Role::Stiffness).tunable(),
            parameter("rebound_stop_gap", "m", real!(rebound.gap), 0.09, "Way by which it lengthens until it meets the rebound stop").range(0.0, 1.0).purpose(Purpose::Data),
            parameter("rebound_stop_stiffness", "N/m2", real!(rebound.stiffness), 1e8, "Force of the rebound stop over the square of the way into it").range(0.0, 1e10).role(Role::Stiffness).tunable(),
            parameter("anti_roll_stiffness", "N/m", real!(anti_roll), 20e3, "Force of the anti-roll bar on each of the two struts over the difference of their ways").range(0.0, 1e7).role(Role::Stiffness).tunable(),
        ])
    }

    /// Reads the damper's curve; `name` is its parameter.
    ///
    /// # Errors
    /// It is none, or pushes the way that it moves.
    pub fn prepare(&mut self, name: &str) -> crate::Result<()> {
        self.damper = Curve::new(name, crate::model::groups(name, &self.damper_points, LARGEST)?)?;
        self.damper.check_resists(name)
    }

    /// Force with which a strut pushes body and carrier apart beyond that where the vehicle stands \[N\], shortened by a way \[m\]
    /// at a rate \[m/s\]; the other strut of the axle is shortened by `other`.
    pub fn push(&self, shortened: f64, rate: f64, other: f64) -> f64 {
        self.stiffness * shortened + self.damper.at(rate) + self.bump.force(shortened)
            - self.rebound.force(-shortened)
            + self.anti_roll * (shortened - other)
    }

    /// Energy of both struts of an axle beyond that where the vehicle stands, without the preload's \[J\].
    pub fn energy(&self, shortened: [f64; 2]) -> f64 {
        let [left, right] = shortened;
        let own = |s: f64| 0.5 * self.stiffness * s * s + self.bump.energy(s) + self.rebound.energy(-s);
        own(left) + own(right) + 0.5 * self.anti_roll * (left - right) * (left - right)
    }
}
