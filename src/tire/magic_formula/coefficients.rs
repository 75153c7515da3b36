//! The coefficients of the Magic Formula tire: one field each, and one table that describes all of them.
//!
//! [`FIELDS`] is the only list of names, sections, defaults, units and meanings. Reading `.tir` files, writing them and a
//! table of model variables are derived from it, so that they cannot disagree.

use crate::shown::with_unit;
use crate::{Error, Result};
use serde::{Deserialize, Serialize};

/// How a value changes with the units of a tire property file: the exponents of length, force, angle, mass and time.
///
/// A stiffness in N/m is force¹ length⁻¹. The dimension concerns only the conversion by `[UNITS]`: the dimensionless
/// coefficients of the Magic Formula are per radian whatever `[UNITS]` says, as the published equations take angles in
/// radian, and so their dimension is [`Dimension::NONE`] though their unit may be 1/rad.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dimension {
    /// Exponent of length.
    pub length: i8,
    /// Exponent of force.
    pub force: i8,
    /// Exponent of angle.
    pub angle: i8,
    /// Exponent of mass.
    pub mass: i8,
    /// Exponent of time.
    pub time: i8,
}

impl Dimension {
    /// Independent of the units of a file.
    pub const NONE: Self = Self { length: 0, force: 0, angle: 0, mass: 0, time: 0 };
    /// m.
    pub const LENGTH: Self = Self { length: 1, ..Self::NONE };
    /// N.
    pub const FORCE: Self = Self { force: 1, ..Self::NONE };
    /// rad.
    pub const ANGLE: Self = Self { angle: 1, ..Self::NONE };
    /// kg.
    pub const MASS: Self = Self { mass: 1, ..Self::NONE };
    /// kg m².
    pub const INERTIA: Self = Self { mass: 1, length: 2, ..Self::NONE };
    /// m/s.
    pub const SPEED: Self = Self { length: 1, time: -1, ..Self::NONE };
    /// N/m.
    pub const STIFFNESS: Self = Self { force: 1, length: -1, ..Self::NONE };
    /// N s/m.
    pub const DAMPING: Self = Self { force: 1, length: -1, time: 1, ..Self::NONE };
}

/// The values that a coefficient may have. All must be finite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bound {
    /// Any number.
    Any,
    /// More than zero: the equations divide by it, or it is a stiffness, a size or a friction.
    Positive,
    /// Anything but zero.
    NotZero,
    /// Zero or more.
    NotNegative,
    /// Zero or less: the lower end of a range.
    NotPositive,
    /// Less than zero: `PKY1`, whose sign says that the file is written in ISO-W axes.
    Negative,
}

impl Bound {
    /// Whether `value` is finite and within the bound.
    pub fn holds(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Bound::Any => true,
                Bound::Positive => value > 0.0,
                Bound::NotZero => value != 0.0,
                Bound::NotNegative => value >= 0.0,
                Bound::NotPositive => value <= 0.0,
                Bound::Negative => value < 0.0,
            }
    }

    /// The bound in words, as in "it must be …".
    pub fn words(self) -> &'static str {
        match self {
            Bound::Any => "a finite number",
            Bound::Positive => "more than 0",
            Bound::NotZero => "another number than 0",
            Bound::NotNegative => "0 or more",
            Bound::NotPositive => "0 or less",
            Bound::Negative => "less than 0",
        }
    }
}

/// What is known of one coefficient.
#[derive(Debug, Clone, Copy)]
pub struct Field {
    /// Name as in a tire property file, in capitals: `PCX1`. In lower case it is the name of the field of
    /// [`Coefficients`].
    pub name: &'static str,
    /// Section of a tire property file, without brackets: `LONGITUDINAL_COEFFICIENTS`.
    pub section: &'static str,
    /// Value in the default tire, in SI units.
    pub default: f64,
    /// Value that holds if a tire property file does not have the key, in SI units: the one that takes its term out of
    /// the equations. `None`: there is none, a file without the key is refused.
    pub absent: Option<f64>,
    /// SI unit; "1" for a pure number.
    pub unit: &'static str,
    /// How the units of a file change the value.
    pub dimension: Dimension,
    /// The values that are allowed.
    pub bound: Bound,
    /// Meaning, one sentence.
    pub description: &'static str,
    /// Reads the value.
    pub get: fn(&Coefficients) -> f64,
    /// Sets the value, unchecked; see [`Coefficients::check`].
    pub set: fn(&mut Coefficients, f64),
}

macro_rules! coefficients {
    ($($field:ident, $name:literal, $section:ident, $default:expr, $absent:expr, $unit:literal, $dimension:ident, $bound:ident, $text:literal;)*) => {
        /// All coefficients of a Magic Formula tire of version 5.2, in SI units and ISO-W axes.
        ///
        /// The default is a passenger-car tire of 225 mm width and 0.338 m radius, symmetric (no ply steer, no
        /// conicity), with round numbers of our own choice: no measured tire, but slopes and peaks as such tires have.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
        pub struct Coefficients {
            $(#[doc = concat!("`", $name, "` \\[", $unit, "\\]: ", $text)] pub $field: f64,)*
        }

        impl Default for Coefficients {
            fn default() -> Self {
                Self { $($field: $default,)* }
            }
        }

        /// Every coefficient, in the order in which they are written to a tire property file.
        pub const FIELDS: &[Field] = &[
            $(Field {
                name: $name,
                section: $section,
                default: $default,
                absent: $absent,
                unit: $unit,
                dimension: Dimension::$dimension,
                bound: Bound::$bound,
                description: $text,
                get: |c| c.$field,
                set: |c, value| c.$field = value,
            },)*
        ];
    };
}

const MODEL: &str = "MODEL";
const SIZE: &str = "DIMENSION";
const INERTIA: &str = "INERTIA";
const VERTICAL: &str = "VERTICAL";
const SLIP_RANGE: &str = "LONG_SLIP_RANGE";
const ANGLE_RANGE: &str = "SLIP_ANGLE_RANGE";
const CAMBER_RANGE: &str = "INCLINATION_ANGLE_RANGE";
const FORCE_RANGE: &str = "VERTICAL_FORCE_RANGE";
const SCALE: &str = "SCALING_COEFFICIENTS";
const LONG: &str = "LONGITUDINAL_COEFFICIENTS";
const OVERTURN: &str = "OVERTURNING_COEFFICIENTS";
const LATERAL: &str = "LATERAL_COEFFICIENTS";
const ROLLING: &str = "ROLLING_COEFFICIENTS";
const ALIGN: &str = "ALIGNING_COEFFICIENTS";

const ZERO: Option<f64> = Some(0.0);
const ONE: Option<f64> = Some(1.0);

/// Beyond every slip that is met: a range that a file does not give limits nothing.
const NO_LIMIT: f64 = 1e6;
/// A wheel cannot be inclined or slip sideways by more.
const QUARTER_TURN: f64 = std::f64::consts::FRAC_PI_2;

coefficients! {
    longvl, "LONGVL", MODEL, 16.0, Some(16.0), "m/s", SPEED, Positive, "Speed at which the tire was measured; the rolling resistance refers to it.";
    vxlow, "VXLOW", MODEL, 1.0, ONE, "m/s", SPEED, NotNegative, "Speed of travel below which everything that is not symmetric fades out towards standstill.";

    unloaded_radius, "UNLOADED_RADIUS", SIZE, 0.338, None, "m", LENGTH, Positive, "Radius of the tire without load, R0.";
    width, "WIDTH", SIZE, 0.225, ZERO, "m", LENGTH, NotNegative, "Nominal section width; no equation uses it.";
    aspect_ratio, "ASPECT_RATIO", SIZE, 0.6, ZERO, "1", NONE, NotNegative, "Section height over section width; no equation uses it.";
    rim_radius, "RIM_RADIUS", SIZE, 0.203, ZERO, "m", LENGTH, NotNegative, "Radius of the rim; no equation uses it.";
    rim_width, "RIM_WIDTH", SIZE, 0.165, ZERO, "m", LENGTH, NotNegative, "Width of the rim; no equation uses it.";

    mass, "MASS", INERTIA, 10.0, ZERO, "kg", MASS, NotNegative, "Mass of the tire; no equation uses it.";
    ixx, "IXX", INERTIA, 0.4, ZERO, "kg.m2", INERTIA, NotNegative, "Moment of inertia of the tire about a diameter; no equation uses it.";
    iyy, "IYY", INERTIA, 0.8, ZERO, "kg.m2", INERTIA, NotNegative, "Moment of inertia of the tire about its axis; no equation uses it.";

    fnomin, "FNOMIN", VERTICAL, 4500.0, None, "N", FORCE, Positive, "Nominal wheel load, Fz0.";
    vertical_stiffness, "VERTICAL_STIFFNESS", VERTICAL, 220e3, None, "N/m", STIFFNESS, Positive, "Vertical stiffness, Cz.";
    vertical_damping, "VERTICAL_DAMPING", VERTICAL, 200.0, ZERO, "N.s/m", DAMPING, NotNegative, "Vertical damping, Kz.";
    breff, "BREFF", VERTICAL, 8.0, ZERO, "1", NONE, NotNegative, "Slope of the effective rolling radius over load at low load.";
    dreff, "DREFF", VERTICAL, 0.25, ZERO, "1", NONE, Any, "Peak of the saturating part of the effective rolling radius.";
    freff, "FREFF", VERTICAL, 0.05, ZERO, "1", NONE, Any, "Slope of the effective rolling radius over load at high load.";

    kpumin, "KPUMIN", SLIP_RANGE, -1.5, Some(-NO_LIMIT), "1", NONE, NotPositive, "Least longitudinal slip at which the coefficients hold.";
    kpumax, "KPUMAX", SLIP_RANGE, 1.5, Some(NO_LIMIT), "1", NONE, NotNegative, "Greatest longitudinal slip at which the coefficients hold.";
    alpmin, "ALPMIN", ANGLE_RANGE, -1.5, Some(-QUARTER_TURN), "rad", ANGLE, NotPositive, "Least slip angle at which the coefficients hold.";
    alpmax, "ALPMAX", ANGLE_RANGE, 1.5, Some(QUARTER_TURN), "rad", ANGLE, NotNegative, "Greatest slip angle at which the coefficients hold.";
    cammin, "CAMMIN", CAMBER_RANGE, -0.25, Some(-QUARTER_TURN), "rad", ANGLE, NotPositive, "Least inclination angle at which the coefficients hold.";
    cammax, "CAMMAX", CAMBER_RANGE, 0.25, Some(QUARTER_TURN), "rad", ANGLE, NotNegative, "Greatest inclination angle at which the coefficients hold.";
    fzmin, "FZMIN", FORCE_RANGE, 200.0, ZERO, "N", FORCE, NotNegative, "Least wheel load at which the coefficients hold.";
    fzmax, "FZMAX", FORCE_RANGE, 10000.0, Some(NO_LIMIT), "N", FORCE, Positive, "Greatest wheel load at which the coefficients hold.";

    lfzo, "LFZO", SCALE, 1.0, ONE, "1", NONE, Positive, "Scales the nominal wheel load.";
    lcz, "LCZ", SCALE, 1.0, ONE, "1", NONE, Positive, "Scales the vertical stiffness.";
    lcx, "LCX", SCALE, 1.0, ONE, "1", NONE, Positive, "Scales the shape factor of the longitudinal force.";
    lmux, "LMUX", SCALE, 1.0, ONE, "1", NONE, NotNegative, "Scales the peak of longitudinal friction.";
    lex, "LEX", SCALE, 1.0, ONE, "1", NONE, Any, "Scales the curvature factor of the longitudinal force.";
    lkx, "LKX", SCALE, 1.0, ONE, "1", NONE, NotNegative, "Scales the longitudinal slip stiffness.";
    lhx, "LHX", SCALE, 1.0, ONE, "1", NONE, Any, "Scales the horizontal shift of the longitudinal force.";
    lvx, "LVX", SCALE, 1.0, ONE, "1", NONE, Any, "Scales the vertical shift of the longitudinal force.";
    lgax, "LGAX", SCALE, 1.0, ONE, "1", NONE, Any, "Scales the inclination angle in the longitudinal force.";
    lcy, "LCY", SCALE, 1.0, ONE, "1", NONE, Positive, "Scales the shape factor of the lateral force.";
    lmuy, "LMUY", SCALE, 1.0, ONE, "1", NONE, NotNegative, "Scales the peak of lateral friction.";
    ley, "LEY", SCALE, 1.0, ONE, "1", NONE, Any, "Scales the curvature factor of the lateral force.";
    lky, "LKY", SCALE, 1.0, ONE, "1", NONE, NotNegative, "Scales the cornering stiffness.";
    lhy, "LHY", SCALE, 1.0, ONE, "1", NONE, Any, "Scales the horizontal shift of the lateral force without inclination.";
    lvy, "LVY", SCALE, 1.0, ONE, "1", NONE, Any, "Scales the vertical shift of the lateral force without inclination.";
    lgay, "LGAY", SCALE, 1.0, ONE, "1", NONE, Any, "Scales the inclination angle in the lateral force.";
    ltr, "LTR", SCALE, 1.0, ONE, "1", NONE, Any, "Scales the peak of the pneumatic trail.";
    lres, "LRES", SCALE, 1.0, ONE, "1", NONE, Any, "Scales the residual torque without inclination.";
    lgaz, "LGAZ", SCALE, 1.0, ONE, "1", NONE, Any, "Scales the inclination angle in the aligning moment.";
    lxal, "LXAL", SCALE, 1.0, ONE, "1", NONE, NotNegative, "Scales the influence of the slip angle on the longitudinal force.";
    lyka, "LYKA", SCALE, 1.0, ONE, "1", NONE, NotNegative, "Scales the influence of longitudinal slip on the lateral force.";
    lvyka, "LVYKA", SCALE, 1.0, ONE, "1", NONE, Any, "Scales the lateral force that longitudinal slip induces.";
    ls, "LS", SCALE, 1.0, ONE, "1", NONE, Any, "Scales the lever arm of the longitudinal force in the aligning moment.";
    lsgkp, "LSGKP", SCALE, 1.0, ONE, "1", NONE, NotNegative, "Scales the longitudinal relaxation length.";
    lsgal, "LSGAL", SCALE, 1.0, ONE, "1", NONE, NotNegative, "Scales the lateral relaxation length.";
    lgyr, "LGYR", SCALE, 1.0, ONE, "1", NONE, Any, "Scales the gyroscopic couple.";
    lmx, "LMX", SCALE, 1.0, ONE, "1", NONE, Any, "Scales the overturning moment.";
    lvmx, "LVMX", SCALE, 1.0, ONE, "1", NONE, Any, "Scales the overturning moment of a straight running, upright wheel.";
    lmy, "LMY", SCALE, 1.0, ONE, "1", NONE, Any, "Scales the rolling resistance moment.";

    pcx1, "PCX1", LONG, 1.6, None, "1", NONE, Positive, "Shape factor of the longitudinal force.";
    pdx1, "PDX1", LONG, 1.1, None, "1", NONE, NotZero, "Peak longitudinal friction at nominal load.";
    pdx2, "PDX2", LONG, -0.1, ZERO, "1", NONE, Any, "Change of peak longitudinal friction with load.";
    pdx3, "PDX3", LONG, 0.0, ZERO, "1/rad2", NONE, Any, "Loss of peak longitudinal friction with inclination squared.";
    pex1, "PEX1", LONG, 0.2, ZERO, "1", NONE, Any, "Curvature factor of the longitudinal force at nominal load.";
    pex2, "PEX2", LONG, 0.0, ZERO, "1", NONE, Any, "Change of the longitudinal curvature factor with load.";
    pex3, "PEX3", LONG, 0.0, ZERO, "1", NONE, Any, "Change of the longitudinal curvature factor with load squared.";
    pex4, "PEX4", LONG, 0.0, ZERO, "1", NONE, Any, "Difference of the longitudinal curvature factor between driving and braking.";
    pkx1, "PKX1", LONG, 25.0, None, "1", NONE, Positive, "Longitudinal slip stiffness over load at nominal load.";
    pkx2, "PKX2", LONG, 0.0, ZERO, "1", NONE, Any, "Change of slip stiffness over load with load.";
    pkx3, "PKX3", LONG, 0.2, ZERO, "1", NONE, Any, "Exponent of the change of slip stiffness over load with load.";
    phx1, "PHX1", LONG, 0.0, ZERO, "1", NONE, Any, "Horizontal shift of the longitudinal force at nominal load.";
    phx2, "PHX2", LONG, 0.0, ZERO, "1", NONE, Any, "Change of the longitudinal horizontal shift with load.";
    pvx1, "PVX1", LONG, 0.0, ZERO, "1", NONE, Any, "Vertical shift of the longitudinal force over load at nominal load.";
    pvx2, "PVX2", LONG, 0.0, ZERO, "1", NONE, Any, "Change of the longitudinal vertical shift over load with load.";
    rbx1, "RBX1", LONG, 12.0, ZERO, "1/rad", NONE, Any, "Slope with which the slip angle reduces the longitudinal force.";
    rbx2, "RBX2", LONG, -10.0, ZERO, "1", NONE, Any, "Change of that slope with longitudinal slip.";
    rcx1, "RCX1", LONG, 1.0, ZERO, "1", NONE, NotNegative, "Shape factor of the reduction of the longitudinal force.";
    rex1, "REX1", LONG, 0.0, ZERO, "1", NONE, Any, "Curvature factor of the reduction of the longitudinal force.";
    rex2, "REX2", LONG, 0.0, ZERO, "1", NONE, Any, "Change of that curvature factor with load.";
    rhx1, "RHX1", LONG, 0.0, ZERO, "rad", NONE, Any, "Shift of the slip angle in the reduction of the longitudinal force.";
    ptx1, "PTX1", LONG, 1.0, ZERO, "1", NONE, Any, "Longitudinal relaxation length over radius at nominal load.";
    ptx2, "PTX2", LONG, 0.0, ZERO, "1", NONE, Any, "Change of the longitudinal relaxation length over load with load.";
    ptx3, "PTX3", LONG, -0.2, ZERO, "1", NONE, Any, "Negative exponent of the change of the longitudinal relaxation length over load with load.";

    qsx1, "QSX1", OVERTURN, 0.0, ZERO, "1", NONE, Any, "Overturning moment over load and radius of a straight running, upright wheel.";
    qsx2, "QSX2", OVERTURN, 0.6, ZERO, "1/rad", NONE, Any, "Overturning moment induced by inclination.";
    qsx3, "QSX3", OVERTURN, 0.03, ZERO, "1", NONE, Any, "Overturning moment induced by the lateral force.";

    pcy1, "PCY1", LATERAL, 1.4, None, "1", NONE, Positive, "Shape factor of the lateral force.";
    pdy1, "PDY1", LATERAL, 1.0, None, "1", NONE, NotZero, "Peak lateral friction at nominal load.";
    pdy2, "PDY2", LATERAL, -0.15, ZERO, "1", NONE, Any, "Change of peak lateral friction with load.";
    pdy3, "PDY3", LATERAL, 1.0, ZERO, "1/rad2", NONE, Any, "Loss of peak lateral friction with inclination squared.";
    pey1, "PEY1", LATERAL, -0.5, ZERO, "1", NONE, Any, "Curvature factor of the lateral force at nominal load.";
    pey2, "PEY2", LATERAL, 0.0, ZERO, "1", NONE, Any, "Change of the lateral curvature factor with load.";
    pey3, "PEY3", LATERAL, 0.0, ZERO, "1", NONE, Any, "Difference of the lateral curvature factor between the directions.";
    pey4, "PEY4", LATERAL, 0.0, ZERO, "1/rad", NONE, Any, "Change of that difference with inclination.";
    pky1, "PKY1", LATERAL, -20.0, None, "1/rad", NONE, Negative, "Greatest cornering stiffness over nominal load; negative in ISO-W axes.";
    pky2, "PKY2", LATERAL, 2.0, None, "1", NONE, Positive, "Load over nominal load at which the cornering stiffness is greatest.";
    pky3, "PKY3", LATERAL, 0.3, ZERO, "1/rad", NONE, Any, "Relative loss of cornering stiffness with inclination.";
    phy1, "PHY1", LATERAL, 0.0, ZERO, "rad", NONE, Any, "Horizontal shift of the lateral force at nominal load.";
    phy2, "PHY2", LATERAL, 0.0, ZERO, "rad", NONE, Any, "Change of the lateral horizontal shift with load.";
    phy3, "PHY3", LATERAL, 0.02, ZERO, "1", NONE, Any, "Change of the lateral horizontal shift with inclination.";
    pvy1, "PVY1", LATERAL, 0.0, ZERO, "1", NONE, Any, "Vertical shift of the lateral force over load at nominal load.";
    pvy2, "PVY2", LATERAL, 0.0, ZERO, "1", NONE, Any, "Change of the lateral vertical shift over load with load.";
    pvy3, "PVY3", LATERAL, -0.5, ZERO, "1/rad", NONE, Any, "Change of the lateral vertical shift over load with inclination.";
    pvy4, "PVY4", LATERAL, -0.2, ZERO, "1/rad", NONE, Any, "Change of that with load.";
    rby1, "RBY1", LATERAL, 10.0, ZERO, "1", NONE, Any, "Slope with which longitudinal slip reduces the lateral force.";
    rby2, "RBY2", LATERAL, 8.0, ZERO, "1/rad", NONE, Any, "Change of that slope with slip angle.";
    rby3, "RBY3", LATERAL, 0.0, ZERO, "rad", NONE, Any, "Shift of the slip angle in that change.";
    rcy1, "RCY1", LATERAL, 1.0, ZERO, "1", NONE, NotNegative, "Shape factor of the reduction of the lateral force.";
    rey1, "REY1", LATERAL, 0.0, ZERO, "1", NONE, Any, "Curvature factor of the reduction of the lateral force.";
    rey2, "REY2", LATERAL, 0.0, ZERO, "1", NONE, Any, "Change of that curvature factor with load.";
    rhy1, "RHY1", LATERAL, 0.0, ZERO, "1", NONE, Any, "Shift of longitudinal slip in the reduction of the lateral force.";
    rhy2, "RHY2", LATERAL, 0.0, ZERO, "1", NONE, Any, "Change of that shift with load.";
    rvy1, "RVY1", LATERAL, 0.0, ZERO, "1", NONE, Any, "Lateral force induced by longitudinal slip, over peak friction force.";
    rvy2, "RVY2", LATERAL, 0.0, ZERO, "1", NONE, Any, "Change of that force with load.";
    rvy3, "RVY3", LATERAL, -0.2, ZERO, "1/rad", NONE, Any, "Change of that force with inclination.";
    rvy4, "RVY4", LATERAL, 10.0, ZERO, "1/rad", NONE, Any, "Decay of that force with slip angle.";
    rvy5, "RVY5", LATERAL, 1.9, ZERO, "1", NONE, Any, "Shape factor of that force over longitudinal slip.";
    rvy6, "RVY6", LATERAL, 10.0, ZERO, "1", NONE, Any, "Slope of that force over longitudinal slip.";
    pty1, "PTY1", LATERAL, 2.0, ZERO, "1", NONE, NotNegative, "Greatest lateral relaxation length over radius.";
    pty2, "PTY2", LATERAL, 2.0, ZERO, "1", NONE, NotNegative, "Load over nominal load at which the lateral relaxation length is greatest; 0 for no relaxation.";

    qsy1, "QSY1", ROLLING, 0.01, ZERO, "1", NONE, Any, "Rolling resistance moment over load and radius.";
    qsy2, "QSY2", ROLLING, 0.0, ZERO, "1", NONE, Any, "Rolling resistance moment induced by the longitudinal force.";
    qsy3, "QSY3", ROLLING, 0.001, ZERO, "1", NONE, Any, "Rolling resistance moment that grows with speed.";
    qsy4, "QSY4", ROLLING, 0.0001, ZERO, "1", NONE, Any, "Rolling resistance moment that grows with the fourth power of speed.";

    qbz1, "QBZ1", ALIGN, 10.0, ZERO, "1/rad", NONE, Any, "Slope of the pneumatic trail at nominal load.";
    qbz2, "QBZ2", ALIGN, -1.0, ZERO, "1/rad", NONE, Any, "Change of that slope with load.";
    qbz3, "QBZ3", ALIGN, 0.0, ZERO, "1/rad", NONE, Any, "Change of that slope with load squared.";
    qbz4, "QBZ4", ALIGN, 0.0, ZERO, "1/rad", NONE, Any, "Change of that slope with inclination.";
    qbz5, "QBZ5", ALIGN, 0.0, ZERO, "1/rad", NONE, Any, "Change of that slope with the amount of inclination.";
    qbz9, "QBZ9", ALIGN, 15.0, ZERO, "1/rad", NONE, Any, "Slope of the residual torque.";
    qbz10, "QBZ10", ALIGN, 0.0, ZERO, "1", NONE, Any, "Slope of the residual torque, in products of the lateral stiffness and shape factors.";
    qcz1, "QCZ1", ALIGN, 1.1, ZERO, "1", NONE, NotNegative, "Shape factor of the pneumatic trail.";
    qdz1, "QDZ1", ALIGN, 0.1, ZERO, "1", NONE, Any, "Greatest pneumatic trail over radius at nominal load.";
    qdz2, "QDZ2", ALIGN, 0.0, ZERO, "1", NONE, Any, "Change of the greatest pneumatic trail with load.";
    qdz3, "QDZ3", ALIGN, 0.0, ZERO, "1/rad", NONE, Any, "Change of the greatest pneumatic trail with inclination.";
    qdz4, "QDZ4", ALIGN, 0.0, ZERO, "1/rad2", NONE, Any, "Change of the greatest pneumatic trail with inclination squared.";
    qdz6, "QDZ6", ALIGN, 0.0, ZERO, "1", NONE, Any, "Greatest residual torque over load and radius.";
    qdz7, "QDZ7", ALIGN, 0.0, ZERO, "1", NONE, Any, "Change of the greatest residual torque with load.";
    qdz8, "QDZ8", ALIGN, -0.1, ZERO, "1/rad", NONE, Any, "Change of the greatest residual torque with inclination.";
    qdz9, "QDZ9", ALIGN, 0.0, ZERO, "1/rad", NONE, Any, "Change of that with load.";
    qez1, "QEZ1", ALIGN, -1.0, ZERO, "1", NONE, Any, "Curvature factor of the pneumatic trail at nominal load.";
    qez2, "QEZ2", ALIGN, 0.0, ZERO, "1", NONE, Any, "Change of that curvature factor with load.";
    qez3, "QEZ3", ALIGN, 0.0, ZERO, "1", NONE, Any, "Change of that curvature factor with load squared.";
    qez4, "QEZ4", ALIGN, 0.0, ZERO, "1", NONE, Any, "Difference of that curvature factor between the directions.";
    qez5, "QEZ5", ALIGN, 0.0, ZERO, "1/rad", NONE, Any, "Change of that difference with inclination.";
    qhz1, "QHZ1", ALIGN, 0.0, ZERO, "rad", NONE, Any, "Shift of the slip angle in the pneumatic trail at nominal load.";
    qhz2, "QHZ2", ALIGN, 0.0, ZERO, "rad", NONE, Any, "Change of that shift with load.";
    qhz3, "QHZ3", ALIGN, 0.0, ZERO, "1", NONE, Any, "Change of that shift with inclination.";
    qhz4, "QHZ4", ALIGN, 0.0, ZERO, "1", NONE, Any, "Change of that shift with inclination and load.";
    ssz1, "SSZ1", ALIGN, 0.0, ZERO, "1", NONE, Any, "Lever arm of the longitudinal force over radius.";
    ssz2, "SSZ2", ALIGN, 0.03, ZERO, "1", NONE, Any, "Change of that lever arm with the lateral force.";
    ssz3, "SSZ3", ALIGN, 0.0, ZERO, "1/rad", NONE, Any, "Change of that lever arm with inclination.";
    ssz4, "SSZ4", ALIGN, 0.0, ZERO, "1/rad", NONE, Any, "Change of that lever arm with inclination and load.";
    qtz1, "QTZ1", ALIGN, 0.2, ZERO, "1", NONE, Any, "Factor of the gyroscopic couple.";
    mbelt, "MBELT", ALIGN, 5.0, ZERO, "kg", MASS, NotNegative, "Mass of the belt in the gyroscopic couple.";
}

impl Coefficients {
    /// The coefficients of a tire of which nothing is known: what [`Field::absent`] says, and zero where it says
    /// nothing. No tire that can roll, but what a file fills in.
    pub fn absent() -> Self {
        let mut coefficients = Self::default();
        for field in FIELDS {
            (field.set)(&mut coefficients, field.absent.unwrap_or(0.0));
        }
        coefficients
    }

    /// Checks every coefficient against its [`Bound`], and each range against its other end.
    ///
    /// # Errors
    /// The first coefficient that is out of bound, with its value and its bound.
    pub fn check(&self) -> Result<()> {
        for field in FIELDS {
            let value = (field.get)(self);
            if !field.bound.holds(value) {
                return Err(Error::variable(out_of_bound(field, value)));
            }
        }
        if self.fzmax <= self.fzmin {
            return Err(Error::variable(format!(
                "FZMAX is {} N and FZMIN {} N; FZMAX must be the greater one",
                self.fzmax, self.fzmin
            )));
        }
        Ok(())
    }
}

/// The sentence about a value that is out of its bound.
pub(crate) fn out_of_bound(field: &Field, value: f64) -> String {
    let hint = match field.bound {
        Bound::Negative => {
            "; a file with the other sign is not written in ISO-W axes, which this model needs: convert it first"
        }
        _ => "",
    };
    format!("{} is {}; it must be {}{hint}", field.name, with_unit(value, field.unit), field.bound.words())
}

/// Fields that describe the tire and stand in no equation.
const DESCRIPTIVE: &[&str] = &["WIDTH", "ASPECT_RATIO", "RIM_RADIUS", "RIM_WIDTH", "MASS", "IXX", "IYY"];

impl Field {
    /// Whether an equation uses it.
    pub fn is_used(&self) -> bool {
        !DESCRIPTIVE.contains(&self.name)
    }
}

/// The field with this name, capitals or not; `None` if there is none.
pub fn field(name: &str) -> Option<&'static Field> {
    FIELDS.iter().find(|field| field.name.eq_ignore_ascii_case(name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_name_stands_once() {
        let names: BTreeSet<_> = FIELDS.iter().map(|f| f.name).collect();
        assert_eq!(names.len(), FIELDS.len());
    }

    #[test]
    fn each_field_reads_what_it_sets_and_touches_no_other() {
        for (i, field) in FIELDS.iter().enumerate() {
            let mut c = Coefficients::default();
            (field.set)(&mut c, 1234.5);
            for (j, other) in FIELDS.iter().enumerate() {
                let expected = if i == j { 1234.5 } else { other.default };
                assert_eq!((other.get)(&c), expected, "{} after setting {}", other.name, field.name);
            }
        }
    }

    #[test]
    fn units_and_dimensions_agree_where_a_file_s_units_count() {
        for f in FIELDS {
            let expected = match f.unit {
                "m" => Dimension::LENGTH,
                "N" => Dimension::FORCE,
                "kg" => Dimension::MASS,
                "kg.m2" => Dimension::INERTIA,
                "m/s" => Dimension::SPEED,
                "N/m" => Dimension::STIFFNESS,
                "N.s/m" => Dimension::DAMPING,
                "rad" if f.section.ends_with("_RANGE") => Dimension::ANGLE,
                "1" | "rad" | "1/rad" | "1/rad2" => Dimension::NONE,
                other => panic!("{other}"),
            };
            assert_eq!(f.dimension, expected, "{}", f.name);
        }
    }

    #[test]
    fn the_default_is_sound_and_what_is_absent_is_in_bounds() {
        Coefficients::default().check().unwrap();
        for f in FIELDS {
            assert!(f.absent.is_none_or(|v| f.bound.holds(v)), "{}", f.name);
            assert!(f.description.ends_with('.') && !f.description.contains(". "), "{}", f.name);
        }
    }
}
