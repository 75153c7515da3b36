//! TMeasy (Rill): curves of force over slip that are given by a few points, in one slip of both directions.
//!
//! S. Y. Oh (2017), 2.4.6, has the vertical force and the slips (2-54 to 2-57); the curve between its points is that of
//! G. Rill, *Road Vehicle Dynamics*.

use super::basics::{forward, spring_force};
use crate::mechanics::Link;
use crate::model::{Purpose, Role, Table, parameter, text_parameter};
use crate::tire::one_point::{Input, Law, Pressed, Standstill, Steady};
use crate::{Error, Result, clone_in_place, lens, real, text};
use serde::{Deserialize, Serialize};

/// A parameter at the nominal load and at twice that.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct AtTwoLoads {
    /// At the nominal load.
    pub once: f64,
    /// At twice that.
    pub twice: f64,
}

impl AtTwoLoads {
    /// A force at a load over the nominal one: the parabola through nothing at no load and both values.
    fn parabola(&self, ratio: f64) -> f64 {
        let Self { once, twice } = *self;
        ratio * (2.0 * once - 0.5 * twice - (once - 0.5 * twice) * ratio)
    }

    /// A slip or a share at a load over the nominal one: the line through both values.
    fn line(&self, ratio: f64) -> f64 {
        self.once + (self.twice - self.once) * (ratio - 1.0)
    }

    /// The value that the line has without load.
    fn without_load(&self) -> f64 {
        2.0 * self.once - self.twice
    }

    /// # Errors
    /// The parabola falls below 0 at little load.
    fn check_force(&self, name: &str) -> Result<()> {
        if self.twice < 4.0 * self.once {
            return Ok(());
        }
        Err(Error::variable(format!(
            "{name}_2 has to be less than four times {name}: {} and {} N; at little load the force would be negative",
            self.twice, self.once
        )))
    }

    /// # Errors
    /// The line reaches 0 before the load does.
    fn check_slip(&self, name: &str) -> Result<()> {
        if self.without_load() > 0.0 {
            return Ok(());
        }
        Err(Error::variable(format!(
            "{name}_2 has to be less than twice {name}: {} and {}; at little load the slip would be negative",
            self.twice, self.once
        )))
    }
}

/// A force over slip: its slope at none, its maximum and from where on it slides.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Curve {
    /// Slope at no slip \[N\].
    pub slope: AtTwoLoads,
    /// Slip of the maximum.
    pub peak_slip: AtTwoLoads,
    /// The maximum \[N\].
    pub peak: AtTwoLoads,
    /// Slip from which on all slides.
    pub sliding_slip: AtTwoLoads,
    /// Force of sliding \[N\].
    pub sliding: AtTwoLoads,
}

/// The same at one load, or for one direction of slip.
#[derive(Debug, Clone, Copy)]
struct Points {
    slope: f64,
    peak_slip: f64,
    peak: f64,
    sliding_slip: f64,
    sliding: f64,
}

impl Curve {
    #[rustfmt::skip] // a row is a line
    fn rows([slope, peak_slip, peak, sliding_slip, sliding]: [[f64; 2]; 5]) -> Table<Self> {
        Table::new([
            parameter("slope", "N", real!(slope.once), slope[0], "Slope of the force (x along, y across) over slip at none, at the nominal load (dF0)").range(1.0, 1e8).tunable().role(Role::Stiffness),
            parameter("slope_2", "N", real!(slope.twice), slope[1], "The same at twice the nominal load").range(1.0, 1e8).tunable().role(Role::Stiffness),
            parameter("peak_slip", "1", real!(peak_slip.once), peak_slip[0], "Slip of the maximum, at the nominal load (sM)").range(1e-3, 10.0).tunable(),
            parameter("peak_slip_2", "1", real!(peak_slip.twice), peak_slip[1], "The same at twice the nominal load").range(1e-3, 10.0).tunable(),
            parameter("peak", "N", real!(peak.once), peak[0], "The maximum of the force, at the nominal load (FM)").range(1.0, 1e7).tunable().role(Role::Friction),
            parameter("peak_2", "N", real!(peak.twice), peak[1], "The same at twice the nominal load").range(1.0, 1e7).tunable().role(Role::Friction),
            parameter("sliding_slip", "1", real!(sliding_slip.once), sliding_slip[0], "Slip from which on the tire slides, at the nominal load (sS)").range(1e-3, 100.0).tunable(),
            parameter("sliding_slip_2", "1", real!(sliding_slip.twice), sliding_slip[1], "The same at twice the nominal load").range(1e-3, 100.0).tunable(),
            parameter("sliding", "N", real!(sliding.once), sliding[0], "The force of sliding, at the nominal load (FS)").range(1.0, 1e7).tunable().role(Role::Friction),
            parameter("sliding_2", "N", real!(sliding.twice), sliding[1], "The same at twice the nominal load").range(1.0, 1e7).tunable().role(Role::Friction),
        ])
    }

    /// At a load over the nominal one, with the friction of the road: forces and slips of maximum and sliding go with it, the slope
    /// does not.
    fn at(&self, ratio: f64, friction: f64) -> Points {
        Points {
            slope: self.slope.parabola(ratio),
            peak_slip: friction * self.peak_slip.line(ratio),
            peak: friction * self.peak.parabola(ratio),
            sliding_slip: friction * self.sliding_slip.line(ratio),
            sliding: friction * self.sliding.parabola(ratio),
        }
    }

    fn check(&self, axis: &str) -> Result<()> {
        let Self { slope, peak_slip, peak, sliding_slip, sliding } = self;
        for (force, name) in [(slope, "slope"), (peak, "peak"), (sliding, "sliding")] {
            force.check_force(&format!("{axis}_{name}"))?;
        }
        for (slip, name) in [(peak_slip, "peak_slip"), (sliding_slip, "sliding_slip")] {
            slip.check_slip(&format!("{axis}_{name}"))?;
        }
        if sliding_slip.without_load() <= peak_slip.without_load() {
            return Err(Error::variable(format!(
                "{axis}_sliding_slip falls below {axis}_peak_slip at little load: lines through their values reach {} and {} without load",
                sliding_slip.without_load(),
                peak_slip.without_load()
            )));
        }
        // a share of the load, the maximum less sliding is a line over it: in order at no load and at twice the nominal one is so between
        let at_little = |force: &AtTwoLoads| 4.0 * force.once - force.twice;
        if at_little(sliding) > at_little(peak) {
            return Err(Error::variable(format!(
                "{axis}_sliding is more than {axis}_peak at little load: four times the first less the second is {} and {} N",
                at_little(sliding),
                at_little(peak)
            )));
        }
        for (load, pick) in [("the nominal load", 0), ("twice the nominal load", 1)] {
            let at = |value: &AtTwoLoads| if pick == 0 { value.once } else { value.twice };
            if at(sliding_slip) <= at(peak_slip) {
                return Err(Error::variable(format!(
                    "{axis}_sliding_slip has to be larger than {axis}_peak_slip at {load}: {} and {}",
                    at(sliding_slip),
                    at(peak_slip)
                )));
            }
            if at(sliding) > at(peak) {
                return Err(Error::variable(format!(
                    "{axis}_sliding is more than {axis}_peak at {load}: {} and {} N",
                    at(sliding),
                    at(peak)
                )));
            }
            // below, the curve would first rise faster than its slope
            if at(slope) * at(peak_slip) < 2.0 * at(peak) {
                return Err(Error::variable(format!(
                    "{axis}_slope times {axis}_peak_slip has to be at least twice {axis}_peak at {load}: {} and {} N",
                    at(slope) * at(peak_slip),
                    at(peak)
                )));
            }
        }
        Ok(())
    }
}

impl Points {
    /// The force at a slip that is not negative: a rational piece up to the maximum, from there two parabolas, the first with the
    /// curvature that the piece before ends with, or a cubic where these do not fit between maximum and sliding.
    fn force(&self, slip: f64) -> f64 {
        let Self { peak_slip, peak, sliding_slip, sliding, .. } = *self;
        // between axes and loads it may come out smaller than the curve can have
        let slope = self.slope.max(2.0 * peak / peak_slip);
        if slip >= sliding_slip {
            return sliding;
        }
        if slip < peak_slip {
            let part = slip / peak_slip;
            return slope * slip / (1.0 + part * (part + slope * peak_slip / peak - 2.0));
        }
        let curvature = (peak / peak_slip) * (peak / peak_slip) / (slope * peak_slip);
        let way = sliding_slip - peak_slip;
        let turn = (peak - sliding) / (curvature * way);
        if turn > way {
            let part = (slip - peak_slip) / way;
            peak - (peak - sliding) * part * part * (3.0 - 2.0 * part)
        } else if slip <= peak_slip + turn {
            peak - curvature * (slip - peak_slip) * (slip - peak_slip)
        } else {
            let left = sliding_slip - slip;
            sliding + curvature * turn / (way - turn) * left * left
        }
    }
}

/// Where the lateral force acts.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Trail {
    /// Trail over the length of the contact at no slip, (n/L)0.
    pub ratio: AtTwoLoads,
    /// Lateral slip at which it first vanishes, sy0.
    pub none: AtTwoLoads,
    /// Lateral slip from which on it stays so, syE.
    pub end: AtTwoLoads,
}

impl Trail {
    #[rustfmt::skip] // a row is a line
    fn rows() -> Table<Self> {
        Table::new([
            parameter("trail", "1", real!(ratio.once), 0.16, "Pneumatic trail over the length of the contact at no slip, at the nominal load (n/L)").range(0.0, 1.0).tunable(),
            parameter("trail_2", "1", real!(ratio.twice), 0.16, "The same at twice the nominal load").range(0.0, 1.0).tunable(),
            parameter("no_trail_slip", "1", real!(none.once), 0.2, "Lateral slip at which the trail first vanishes, at the nominal load (sy0)").range(1e-3, 10.0).tunable(),
            parameter("no_trail_slip_2", "1", real!(none.twice), 0.22, "The same at twice the nominal load").range(1e-3, 10.0).tunable(),
            parameter("trail_end_slip", "1", real!(end.once), 0.5, "Lateral slip from which on there is no trail, at the nominal load (syE)").range(1e-3, 10.0).tunable(),
            parameter("trail_end_slip_2", "1", real!(end.twice), 0.55, "The same at twice the nominal load").range(1e-3, 10.0).tunable(),
        ])
    }

    /// Trail over the length of the contact at a lateral slip, a load over the nominal one and a friction factor of the road.
    fn at(&self, slip: f64, ratio: f64, friction: f64) -> f64 {
        let (none, end) = (friction * self.none.line(ratio), friction * self.end.line(ratio));
        let (s, weight) = (slip.abs() / none, none / end);
        let share = if s < 1.0 {
            (1.0 - weight) * (1.0 - s) + weight * (1.0 - s * s * (3.0 - 2.0 * s))
        } else if slip.abs() < end {
            let left = (end - slip.abs()) / (end - none);
            -(1.0 - weight) * (s - 1.0) * left * left
        } else {
            0.0
        };
        self.ratio.line(ratio) * share
    }
}

/// TMeasy.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct TmEasy {
    /// Name of the tire, for reports.
    pub name: String,
    /// Radius without load \[m\].
    pub radius: f64,
    /// k1 \[N/m\] and k2 \[N/m²\] of (2-55).
    pub vertical: [f64; 2],
    /// Vertical damping \[N.s/m\].
    pub damping: f64,
    /// Load that the parameters are at \[N\], and at twice that.
    pub nominal_load: f64,
    /// Forces along and across.
    pub curves: [Curve; 2],
    /// Where the lateral force acts.
    pub trail: Trail,
    /// Share of the radius without load in the rolling radius; the rest is the loaded radius.
    pub rolling: AtTwoLoads,
    /// Stiffness of the carcass along and across \[N/m\], for the relaxation lengths.
    pub carcass: [f64; 2],
    /// Rolling resistance over the load.
    pub rolling_resistance: f64,
    /// Speed up to which the tire is a spring at rest \[m/s\], and damping of that \[N.s/m\].
    pub low_speed: [f64; 2],
}

clone_in_place!(TmEasy {
    name,
    radius,
    vertical,
    damping,
    nominal_load,
    curves,
    trail,
    rolling,
    carcass,
    rolling_resistance,
    low_speed,
});

/// Up to this load over the nominal one the parabolas of forces are meant; beyond they stay. They would fall from some load on.
const MOST_LOAD: f64 = 2.0;

impl TmEasy {
    /// Load over the nominal one, as far as the parameters hold.
    fn ratio(&self, load: f64) -> f64 {
        (load / self.nominal_load).min(MOST_LOAD)
    }

    /// Weights of the slips along and across in the one of both: what makes both directions alike.
    fn weights([x, y]: &[Points; 2]) -> [f64; 2] {
        let slips = x.peak_slip + y.peak_slip;
        let of_slope = [x, y].map(|curve| curve.peak / curve.slope);
        let slopes = of_slope[0] + of_slope[1];
        [x.peak_slip / slips + of_slope[0] / slopes, y.peak_slip / slips + of_slope[1] / slopes]
    }

    /// The curve in a direction of the slip in which it has shares of the slips over their weights.
    fn together([x, y]: &[Points; 2], weights: [f64; 2], [cos, sin]: [f64; 2]) -> Points {
        let mean = |pick: fn(&Points) -> f64, scale: [f64; 2]| {
            libm::hypot(pick(x) * scale[0] * cos, pick(y) * scale[1] * sin)
        };
        let [wx, wy] = weights;
        Points {
            slope: mean(|p| p.slope, [wx, wy]),
            peak_slip: mean(|p| p.peak_slip, [1.0 / wx, 1.0 / wy]),
            peak: mean(|p| p.peak, [1.0; 2]),
            sliding_slip: mean(|p| p.sliding_slip, [1.0 / wx, 1.0 / wy]),
            sliding: mean(|p| p.sliding, [1.0; 2]),
        }
    }
}

impl Law for TmEasy {
    const NAME: &'static str = "tmeasy";
    const TITLE: &'static str = "TMeasy tire";
    const DOCUMENTATION: &'static str = include_str!("tmeasy.html");

    #[rustfmt::skip] // a row is a line
    fn rows() -> Table<Self> {
        Table::new([
            text_parameter("tire_name", text!(name), "Solid tire 18x7-8, round numbers", "Name of the tire, for reports"),
            parameter("tire_radius", "m", real!(radius), 0.2265, "Radius without load").range(0.02, 2.0),
            parameter("vertical_stiffness", "N/m", real!(vertical[0]), 3.5e5, "Vertical stiffness at no load (k1)").range(1.0, 1e9).tunable().role(Role::Stiffness),
            parameter("vertical_stiffness_growth", "N/m2", real!(vertical[1]), 1.2e7, "Force over the square of the deflection (k2)").range(0.0, 1e12).tunable(),
            parameter("vertical_damping", "N.s/m", real!(damping), 1400.0, "Vertical damping; the tire never pulls").range(0.0, 1e7).tunable(),
            parameter("nominal_load", "N", real!(nominal_load), 6500.0, "Load that the parameters are at; those that end in _2 are at twice that").range(1.0, 1e6).purpose(Purpose::Data),
        ])
        .part("x_", lens!(curves[0]), Curve::rows([[6e4, 1e5], [0.22, 0.24], [6100.0, 11500.0], [0.7, 0.8], [5500.0, 10300.0]]))
        .part("y_", lens!(curves[1]), Curve::rows([[4e4, 6.4e4], [0.3, 0.35], [5900.0, 10900.0], [0.9, 1.0], [5500.0, 10300.0]]))
        .part("", lens!(trail), Trail::rows())
        .and([
            parameter("rolling_share", "1", real!(rolling.once), 0.375, "Share of the radius without load in the rolling radius, at the nominal load; the rest is the loaded radius").range(0.0, 1.0).tunable(),
            parameter("rolling_share_2", "1", real!(rolling.twice), 0.75, "The same at twice the nominal load").range(-1.0, 2.0).tunable(),
            parameter("carcass_stiffness_x", "N/m", real!(carcass[0]), 6e5, "Stiffness of the tire along, which the slope of the force over it makes the relaxation length of").range(1e3, 1e9),
            parameter("carcass_stiffness_y", "N/m", real!(carcass[1]), 2e5, "Stiffness of the tire across, which the slope of the force over it makes the relaxation length of").range(1e3, 1e9),
            parameter("rolling_resistance", "1", real!(rolling_resistance), 0.015, "Rolling resistance over the load").range(0.0, 1.0).tunable(),
            parameter("low_speed", "m/s", real!(low_speed[0]), 0.5, "Below this speed the tire turns into a spring along and across, with a damper; and rolling resistance fades out").range(0.0, 10.0).purpose(Purpose::Numerics),
            parameter("low_speed_damping", "N.s/m", real!(low_speed[1]), 1000.0, "Damping of the tire's deflection along and across at standstill; a placeholder").range(0.0, 1e5).purpose(Purpose::Data).tunable(),
        ])
    }

    fn mount(&mut self) -> Result<()> {
        self.curves[0].check("x")?;
        self.curves[1].check("y")?;
        let Trail { none, end, .. } = self.trail;
        none.check_slip("no_trail_slip")?;
        end.check_slip("trail_end_slip")?;
        // lines: between no load and twice the nominal one both are in order if they are at these ends
        if end.without_load() <= none.without_load() || end.twice <= none.twice {
            return Err(Error::variable(
                "trail_end_slip has to be larger than no_trail_slip at all loads; so have the values without load, twice the first less the second",
            ));
        }
        Ok(())
    }

    fn radius(&self) -> f64 {
        self.radius
    }

    /// (2-55).
    fn normal_force(&self, pressed: &Pressed) -> f64 {
        spring_force(&self.vertical, self.damping, pressed)
    }

    fn deflection(&self, load: f64, _spin: f64) -> f64 {
        let [linear, square] = self.vertical;
        // the root of the parabola in the form that does not cancel
        2.0 * load / (linear + libm::sqrt(linear * linear + 4.0 * square * load))
    }

    fn rolling_radius(&self, deflection: f64, _spin: f64) -> f64 {
        let pressed = Pressed { deflection, ..Pressed::default() };
        let share = self.rolling.line(self.ratio(self.normal_force(&pressed)));
        self.radius - (1.0 - share) * deflection.max(0.0)
    }

    fn relaxation(&self, load: f64, _camber: f64) -> [f64; 2] {
        [0, 1].map(|i| self.curves[i].slope.parabola(self.ratio(load)) / self.carcass[i])
    }

    /// Forces of the one slip (2-56, 2-57).
    fn steady(&self, input: &Input) -> Steady {
        let resistance =
            -self.rolling_resistance * self.radius * input.fz * forward(input.vx, self.low_speed[0]);
        if input.friction <= 0.0 {
            return Steady { moment: [0.0, resistance, 0.0], ..Steady::default() };
        }
        let ratio = self.ratio(input.fz);
        let curves = [0, 1].map(|i| self.curves[i].at(ratio, input.friction));
        let weights = Self::weights(&curves);
        // over the way of the tread, and of a locked wheel without end
        let tread = (1.0 + input.kappa).abs().max(LEAST_TREAD);
        let slips = [input.kappa / tread, libm::tan(input.alpha) / tread];
        let [x, y] = [slips[0] / weights[0], slips[1] / weights[1]];
        let slip = libm::hypot(x, y);
        let direction = if slip > 0.0 { [x / slip, y / slip] } else { [1.0, 0.0] };
        let force = Self::together(&curves, weights, direction).force(slip);
        let (fx, fy) = (force * direction[0], -force * direction[1]);
        let trail = self.contact_length(input.fz) * self.trail.at(slips[1], ratio, input.friction);
        Steady {
            force: [fx, fy],
            moment: [0.0, resistance, -trail * fy],
            trail,
            friction: curves.map(|curve| curve.peak / input.fz),
            stiffness: [curves[0].slope, -curves[1].slope],
            outside: input.fz > MOST_LOAD * self.nominal_load,
            ..Steady::default()
        }
    }

    fn standstill(&self) -> Standstill {
        Standstill { speed: self.low_speed[0], damping: self.low_speed[1] }
    }

    fn vertical_link(&self) -> Link {
        let [linear, square] = self.vertical;
        let deflection = self.deflection(MOST_LOAD * self.nominal_load, 0.0);
        Link {
            stiffness: ("vertical_stiffness with its growth", linear + 2.0 * square * deflection),
            damping: ("vertical_damping", self.damping),
            mass: ("the road", f64::INFINITY),
        }
    }

    fn usual_load(&self) -> (f64, [&'static str; 2]) {
        (self.nominal_load, ["carcass_stiffness_x times the radius squared", "carcass_stiffness_y"])
    }
}

/// Way of the tread over that of the wheel, below which slips are no longer counted over it: all slides.
const LEAST_TREAD: f64 = 1e-6;

impl TmEasy {
    /// 2 sqrt(R e) \[m\], of the contact at a load.
    fn contact_length(&self, load: f64) -> f64 {
        2.0 * libm::sqrt(self.radius * self.deflection(load, 0.0))
    }
}
