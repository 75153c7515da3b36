//! The rigid ring of SWIFT, as far as it stands on the road: vertical force and rolling radius with centrifugal growth, on the
//! forces of the Magic Formula.
//!
//! S. Y. Oh (2017), 2.4.3 (2-22 to 2-29). The ring itself, a body on springs that vibrates, is not in it.

use crate::clone_in_place;
use crate::mechanics::Link;
use crate::model::{Role, Table, integer_parameter, parameter};
use crate::tire::magic_formula::Formula;
use crate::tire::one_point::{Input, Law, Pressed, Standstill, Steady};
use crate::{Error, Result, integer, lens, real};
use serde::{Deserialize, Serialize};

/// What the vertical force of a rigid ring is made of. Names are those of tire property files.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Ring {
    /// Radius at rest over the radius without load, q_re0.
    pub qre0: f64,
    /// Growth with the square of the spin, q_v1.
    pub qv1: f64,
    /// Stiffening with the spin, q_v2.
    pub qv2: f64,
    /// Softening by the force along, q_Fcx.
    pub qfcx: f64,
    /// Softening by the force across, q_Fcy.
    pub qfcy: f64,
    /// Force over deflection, q_Fz1.
    pub qfz1: f64,
    /// Force over its square, q_Fz2.
    pub qfz2: f64,
    /// Stiffening with the inflation pressure, p_Fz1.
    pub pfz1: f64,
    /// Inflation pressure less that of the measurement, over the latter.
    pub pressure_change: f64,
    /// The speed V0 that spin counts over, from 1 in the order of its items.
    pub reference: i32,
}

/// What V0 is, from 1.
const REFERENCES: &[(&str, &str)] = &[
    ("LONGVL", "the speed of the measurement, with which property files are made"),
    ("printed", "sqrt(g UNLOADED_RADIUS), as the source has it, with 9.81 m/s2: some 1.8 m/s"),
];

impl Ring {
    #[rustfmt::skip] // a row is a line
    fn rows() -> Table<Self> {
        Table::new([
            parameter("Q_RE0", "1", real!(qre0), 1.0, "Radius without load at rest over UNLOADED_RADIUS").range(0.8, 1.2),
            parameter("Q_V1", "1", real!(qv1), 7e-4, "Growth of the radius with the square of spin speed times radius over the reference speed").range(0.0, 0.1),
            parameter("Q_V2", "1", real!(qv2), 0.046, "Stiffening with spin speed times radius over the reference speed").range(0.0, 1.0),
            parameter("Q_FCX", "1", real!(qfcx), 0.0, "Softening by the longitudinal force").range(-1.0, 1.0),
            parameter("Q_FCY", "1", real!(qfcy), 0.0, "Softening by the lateral force").range(-1.0, 1.0),
            parameter("Q_FZ1", "1", real!(qfz1), 13.4, "Vertical force over deflection, in nominal loads and radii").range(0.01, 1e3).role(Role::Stiffness).tunable(),
            parameter("Q_FZ2", "1", real!(qfz2), 14.4, "The same over its square").range(0.0, 1e4).tunable(),
            parameter("PFZ1", "1", real!(pfz1), 0.7, "Stiffening with the inflation pressure").range(0.0, 5.0),
            integer_parameter("reference_speed", integer!(reference), 1, "The speed that the spin's is counted over in Q_V1 and Q_V2").items(REFERENCES),
            parameter("pressure_change", "1", real!(pressure_change), 0.0, "Inflation pressure less that at which the coefficients were measured, over the latter").range(-0.9, 5.0).tunable(),
        ])
    }
}

/// A Magic Formula tire on the vertical law of a rigid ring.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Swift {
    /// The forces along and across.
    pub formula: Formula,
    /// The vertical force.
    pub ring: Ring,
}

clone_in_place!(Swift { formula, ring });

/// Gravity in the printed V0 = sqrt(g R0) \[m/s²\].
const STANDARD_GRAVITY: f64 = 9.81;

impl Swift {
    /// Spin speed times R0 over V0.
    fn speed(&self, spin: f64) -> f64 {
        let c = &self.formula.coefficients;
        let reference = match self.ring.reference {
            2 => libm::sqrt(STANDARD_GRAVITY * c.unloaded_radius),
            _ => c.longvl,
        };
        spin * c.unloaded_radius / reference
    }

    /// By how much the turning tire is larger than that at rest \[m\]; with R_Ω of (2-22).
    fn growth(&self, spin: f64) -> f64 {
        let speed = self.speed(spin);
        self.formula.coefficients.unloaded_radius * self.ring.qv1 * speed * speed
    }

    /// Vertical force over its value at rest without horizontal forces: first factor of (2-24).
    fn factor(&self, spin: f64, [fx, fy]: [f64; 2]) -> f64 {
        let Ring { qv2, qfcx, qfcy, .. } = self.ring;
        let nominal = self.formula.coefficients.fnomin;
        let (x, y) = (qfcx * fx / nominal, qfcy * fy / nominal);
        (1.0 + qv2 * self.speed(spin).abs() - x * x - y * y).max(0.0)
    }

    /// 1 + p_Fz1 dp: stiffness over that at the measurement's pressure (2-25).
    fn inflation(&self) -> f64 {
        1.0 + self.ring.pfz1 * self.ring.pressure_change
    }

    /// k_z of (2-25, 2-26) \[N/m\]: the slope of the force at rest at the nominal load.
    pub fn stiffness(&self) -> f64 {
        let Ring { qfz1, qfz2, .. } = self.ring;
        let c = &self.formula.coefficients;
        c.fnomin / c.unloaded_radius * libm::sqrt(qfz1 * qfz1 + 4.0 * qfz2) * self.inflation()
    }
}

impl Law for Swift {
    const NAME: &'static str = "swift";
    const TITLE: &'static str = "Magic Formula tire on SWIFT's vertical law";
    const DOCUMENTATION: &'static str =
        concat!(include_str!("swift.html"), include_str!("../magic_formula/documentation.html"));

    fn rows() -> Table<Self> {
        Table::new([])
            .part("", lens!(ring), Ring::rows())
            .part("", lens!(formula), Formula::rows())
            .without("VERTICAL_STIFFNESS")
            .without("LCZ")
    }

    fn mount(&mut self) -> Result<()> {
        if self.inflation() <= 0.0 {
            return Err(Error::variable("PFZ1 times pressure_change leaves no vertical stiffness"));
        }
        // what property files call so, and equations along and across may refer to
        let stiffness = self.stiffness();
        let c = &mut self.formula.coefficients;
        (c.vertical_stiffness, c.lcz) = (stiffness, 1.0);
        self.formula.mount()
    }

    /// R_Ω at rest.
    fn radius(&self) -> f64 {
        self.ring.qre0 * self.formula.coefficients.unloaded_radius
    }

    /// (2-23, 2-24), with a damper.
    fn normal_force(&self, pressed: &Pressed) -> f64 {
        let deflection = pressed.deflection + self.growth(pressed.spin);
        if deflection <= 0.0 {
            return 0.0;
        }
        let c = &self.formula.coefficients;
        let ratio = deflection / c.unloaded_radius;
        let spring = (self.ring.qfz1 + self.ring.qfz2 * ratio) * ratio * c.fnomin * self.inflation();
        (self.factor(pressed.spin, pressed.force) * spring + c.vertical_damping * pressed.rate).max(0.0)
    }

    fn deflection(&self, load: f64, spin: f64) -> f64 {
        let c = &self.formula.coefficients;
        let Ring { qfz1, qfz2, .. } = self.ring;
        let force = load / (c.fnomin * self.inflation() * self.factor(spin, [0.0; 2]));
        // the root of the parabola in the form that does not cancel
        let ratio = 2.0 * force / (qfz1 + libm::sqrt(qfz1 * qfz1 + 4.0 * qfz2 * force));
        ratio * c.unloaded_radius - self.growth(spin)
    }

    /// (2-28).
    fn rolling_radius(&self, deflection: f64, spin: f64) -> f64 {
        let c = &self.formula.coefficients;
        let load = self.normal_force(&Pressed { deflection, spin, ..Pressed::default() }) / c.fnomin;
        let compressed = c.dreff * libm::atan(c.breff * load) + c.freff * load;
        self.radius() + self.growth(spin) - c.fnomin / self.stiffness() * compressed
    }

    fn relaxation(&self, load: f64, camber: f64) -> [f64; 2] {
        self.formula.relaxation(load, camber)
    }

    fn steady(&self, input: &Input) -> Steady {
        self.formula.steady(input)
    }

    fn standstill(&self) -> Standstill {
        self.formula.standstill()
    }

    /// The slope at twice the nominal load.
    fn vertical_link(&self) -> Link {
        let c = &self.formula.coefficients;
        let Ring { qfz1, qfz2, .. } = self.ring;
        let slope = libm::sqrt(qfz1 * qfz1 + 8.0 * qfz2) * c.fnomin / c.unloaded_radius * self.inflation();
        Link {
            stiffness: ("Q_FZ1 and Q_FZ2", slope),
            damping: ("VERTICAL_DAMPING", c.vertical_damping),
            mass: ("the road", f64::INFINITY),
        }
    }

    fn usual_load(&self) -> (f64, [&'static str; 2]) {
        self.formula.usual_load()
    }
}
