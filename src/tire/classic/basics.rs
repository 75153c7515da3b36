//! What the linear tire, Fiala's and the UA tire share: a linear spring, friction that falls with slip, stiffnesses at no slip.

use crate::mechanics::Link;
use crate::model::{Purpose, Role, Table, parameter, text_parameter};
use crate::tire::one_point::{Pressed, Standstill};
use crate::{clone_in_place, real, text};
use serde::{Deserialize, Serialize};

/// Parameters of a tire with one contact point.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Basics {
    /// Name of the tire, for reports.
    pub name: String,
    /// Radius without load \[m\].
    pub radius: f64,
    /// Vertical stiffness \[N/m\] and damping \[N.s/m\] (2-30).
    pub vertical: [f64; 2],
    /// Slope of the longitudinal force over slip at none, C_s \[N\] (2-7).
    pub slip_stiffness: f64,
    /// Slope of the lateral force over the slip angle at none, C_α \[N/rad\] (2-9); positive.
    pub cornering_stiffness: f64,
    /// Friction coefficients without slip and at a slip of 1 (2-31).
    pub friction: [f64; 2],
    /// Stiffness of the carcass along and across \[N/m\], for the relaxation lengths (2-15).
    pub carcass: [f64; 2],
    /// Rolling resistance over the load, f_R (2-1).
    pub rolling_resistance: f64,
    /// Speed up to which the tire is a spring at rest \[m/s\], and damping of that \[N.s/m\].
    pub low_speed: [f64; 2],
}

clone_in_place!(Basics {
    name,
    radius,
    vertical,
    slip_stiffness,
    cornering_stiffness,
    friction,
    carcass,
    rolling_resistance,
    low_speed,
});

impl Basics {
    #[rustfmt::skip] // a row is a line
    pub(super) fn rows() -> Table<Self> {
        Table::new([
            text_parameter("tire_name", text!(name), "Solid tire 18x7-8, round numbers", "Name of the tire, for reports"),
            parameter("tire_radius", "m", real!(radius), 0.2265, "Radius without load").range(0.02, 2.0),
            parameter("vertical_stiffness", "N/m", real!(vertical[0]), 5e5, "Vertical stiffness").range(1.0, 1e9).tunable().role(Role::Stiffness),
            parameter("vertical_damping", "N.s/m", real!(vertical[1]), 1400.0, "Vertical damping; the tire never pulls").range(0.0, 1e7).tunable(),
            parameter("slip_stiffness", "N", real!(slip_stiffness), 6e4, "Slope of the longitudinal force over slip at none (C_s)").range(1.0, 1e7).tunable().role(Role::Stiffness),
            parameter("cornering_stiffness", "N/rad", real!(cornering_stiffness), 4e4, "Slope of the lateral force over the slip angle at none, counted positive (C_alpha)").range(1.0, 1e7).tunable().role(Role::Stiffness),
            parameter("friction_max", "1", real!(friction[0]), 0.94, "Friction coefficient without slip").range(0.0, 10.0).tunable().role(Role::Friction),
            parameter("friction_min", "1", real!(friction[1]), 0.85, "Friction coefficient at a slip of 1; beyond it stays").range(0.0, 10.0).tunable().role(Role::Friction),
            parameter("carcass_stiffness_x", "N/m", real!(carcass[0]), 6e5, "Stiffness of the tire along, which the slip stiffness over it makes the relaxation length of").range(1e3, 1e9),
            parameter("carcass_stiffness_y", "N/m", real!(carcass[1]), 2e5, "Stiffness of the tire across, which the cornering stiffness over it makes the relaxation length of").range(1e3, 1e9),
            parameter("rolling_resistance", "1", real!(rolling_resistance), 0.015, "Rolling resistance over the load (f_R)").range(0.0, 1.0).tunable(),
            parameter("low_speed", "m/s", real!(low_speed[0]), 0.5, "Below this speed the tire turns into a spring along and across, with a damper; and rolling resistance fades out").range(0.0, 10.0).purpose(Purpose::Numerics),
            parameter("low_speed_damping", "N.s/m", real!(low_speed[1]), 1000.0, "Damping of the tire's deflection along and across at standstill; a placeholder").range(0.0, 1e5).purpose(Purpose::Data).tunable(),
        ])
    }

    /// Spring and damper that never pull.
    pub(super) fn normal_force(&self, pressed: &Pressed) -> f64 {
        spring_force(&[self.vertical[0], 0.0], self.vertical[1], pressed)
    }

    /// Friction coefficient at a slip (2-31).
    pub(super) fn friction_at(&self, slip: f64) -> f64 {
        let [most, least] = self.friction;
        most - (most - least) * slip.min(1.0)
    }

    pub(super) fn relaxation(&self) -> [f64; 2] {
        [self.slip_stiffness / self.carcass[0], self.cornering_stiffness / self.carcass[1]]
    }

    pub(super) fn standstill(&self) -> Standstill {
        Standstill { speed: self.low_speed[0], damping: self.low_speed[1] }
    }

    /// Moment of the rolling resistance about y (2-42) at a load, with its lever; it fades out below the low speed.
    pub(super) fn resistance(&self, load: f64, vx: f64) -> f64 {
        -self.rolling_resistance * self.radius * load * forward(vx, self.low_speed[0])
    }

    pub(super) fn vertical_link(&self) -> Link {
        let [stiffness, damping] = self.vertical;
        Link {
            stiffness: ("vertical_stiffness", stiffness),
            damping: ("vertical_damping", damping),
            mass: ("the road", f64::INFINITY),
        }
    }

    /// A deflection of a twentieth of the radius.
    pub(super) fn usual_load(&self) -> (f64, [&'static str; 2]) {
        (
            0.05 * self.radius * self.vertical[0],
            ["carcass_stiffness_x times the radius squared", "carcass_stiffness_y"],
        )
    }
}

/// Direction of travel, from −1 to 1 within the low speed.
pub(super) fn forward(vx: f64, low_speed: f64) -> f64 {
    if low_speed > 0.0 { (vx / low_speed).clamp(-1.0, 1.0) } else { vx.signum() }
}

/// k1 ρ + k2 ρ² + c ρ̇ (2-55), not below 0; nothing in the air.
pub(super) fn spring_force([linear, square]: &[f64; 2], damping: f64, pressed: &Pressed) -> f64 {
    let Pressed { deflection, rate, .. } = *pressed;
    if deflection <= 0.0 {
        return 0.0;
    }
    ((linear + square * deflection) * deflection + damping * rate).max(0.0)
}

/// Longitudinal slip with the faster of travelling and rolling below: (2-4) for driving and braking, in one sign convention.
pub(super) fn slip_over_faster(kappa: f64) -> f64 {
    if kappa > 0.0 { kappa / (1.0 + kappa) } else { kappa.max(-1.0) }
}
