//! What the linear tire, Fiala's and the UA tire share: a linear spring, friction that falls with slip, stiffnesses at no slip. They
//! differ in their [`Forces`].

use crate::mechanics::Link;
use crate::model::{Purpose, Role, Table, parameter, text_parameter};
use crate::tire::one_point::{Input, Law, Pressed, Standstill, Steady};
use crate::{clone_in_place, lens, real, text};
use serde::{Deserialize, Serialize, de::DeserializeOwned};

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

    /// Friction coefficient at a slip (2-31).
    pub(super) fn friction_at(&self, slip: f64) -> f64 {
        let [most, least] = self.friction;
        most - (most - least) * slip.min(1.0)
    }

    /// Moment of the rolling resistance about y (2-42) at a load, with its lever; it fades out below the low speed.
    pub(super) fn resistance(&self, load: f64, vx: f64) -> f64 {
        -self.rolling_resistance * self.radius * load * forward(vx, self.low_speed[0])
    }
}

/// What a simple tire makes of slips and load, with parameters of its own.
pub trait Forces: Clone + Default + PartialEq + Serialize + DeserializeOwned + Send + 'static {
    /// As [`Law::NAME`].
    const NAME: &'static str;
    /// As [`Law::TITLE`].
    const TITLE: &'static str;
    /// As [`Law::DOCUMENTATION`].
    const DOCUMENTATION: &'static str;

    /// Its own parameters.
    fn rows() -> Table<Self>;

    /// As [`Law::steady`].
    fn steady(&self, basics: &Basics, input: &Input) -> Steady;
}

/// A simple tire: the basics, and forces along and across.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Simple<F> {
    /// What it shares with the others.
    pub basics: Basics,
    /// What sets it apart.
    pub forces: F,
}

clone_in_place!(Simple<F> { basics, forces });

impl<F: Forces> Law for Simple<F> {
    const NAME: &'static str = F::NAME;
    const TITLE: &'static str = F::TITLE;
    const DOCUMENTATION: &'static str = F::DOCUMENTATION;

    fn rows() -> Table<Self> {
        Table::new([]).part("", lens!(basics), Basics::rows()).part("", lens!(forces), F::rows())
    }

    fn radius(&self) -> f64 {
        self.basics.radius
    }

    /// Spring and damper that never pull (2-30).
    fn normal_force(&self, pressed: &Pressed) -> f64 {
        let [stiffness, damping] = self.basics.vertical;
        spring_force(&[stiffness, 0.0], damping, pressed)
    }

    fn deflection(&self, load: f64, _spin: f64) -> f64 {
        load / self.basics.vertical[0]
    }

    /// The distance of the wheel's centre from the road.
    fn rolling_radius(&self, deflection: f64, _spin: f64) -> f64 {
        self.basics.radius - deflection.max(0.0)
    }

    /// (2-15)
    fn relaxation(&self, _load: f64, _camber: f64) -> [f64; 2] {
        let Basics { slip_stiffness, cornering_stiffness, carcass, .. } = self.basics;
        [slip_stiffness / carcass[0], cornering_stiffness / carcass[1]]
    }

    fn steady(&self, input: &Input) -> Steady {
        self.forces.steady(&self.basics, input)
    }

    fn standstill(&self) -> Standstill {
        let [speed, damping] = self.basics.low_speed;
        Standstill { speed, damping }
    }

    fn vertical_link(&self) -> Link {
        let [stiffness, damping] = self.basics.vertical;
        Link {
            stiffness: ("vertical_stiffness", stiffness),
            damping: ("vertical_damping", damping),
            mass: ("the road", f64::INFINITY),
        }
    }

    /// A deflection of a twentieth of the radius.
    fn usual_load(&self) -> (f64, [&'static str; 2]) {
        let names = ["carcass_stiffness_x times the radius squared", "carcass_stiffness_y"];
        (0.05 * self.basics.radius * self.basics.vertical[0], names)
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
