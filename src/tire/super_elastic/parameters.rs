//! The parameters of the super-elastic tire, and what follows from them.

use super::Characteristic;
use super::contact::Contact;
use crate::{Error, Result, clone_in_place};
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// Ways to give a coefficient, as items of an enumeration from 1.
pub(super) const LAWS: &[(&str, &str)] = &[
    ("constant", "the same at every load and speed"),
    ("power", "a power of load and speed over their references"),
    ("table", "points with straight lines between them"),
];
/// What adhering share of the contact the brush force is made with.
pub(super) const ADHESIONS: &[(&str, &str)] = &[
    ("brush", "from the slip, where the stress of bristles meets that of friction"),
    (
        "contact",
        "that of the positions of the elements in contact, and not more than the slip leaves; the source says so and gives no algorithm",
    ),
];
/// What is summed up to the force on the rim.
pub(super) const RIM_FORCES: &[(&str, &str)] = &[
    (
        "radial",
        "the forces of the radial springs and dampers, as printed: what the guides of the elements carry is lost, 4 % of the load",
    ),
    ("exact", "all that the elements put on the rim: springs, guides, weight and inertia"),
];
/// What resists rolling.
pub(super) const RESISTANCES: &[(&str, &str)] =
    &[("force", "a force at the wheel's centre (4-64)"), ("moment", "a moment about the axle (2-1)")];
/// What the contact stiffness is of.
pub(super) const SHARINGS: &[(&str, &str)] =
    &[("element", "of an element; its contact points share it"), ("point", "of each contact point")];
/// The rate at which the slip follows.
pub(super) const RATES: &[(&str, &str)] = &[
    ("faster", "the faster one of travelling and rolling, so that a wheel starts from rest"),
    ("travel", "the speed of travelling, as printed (2-16): a wheel that is driven from rest gets no force"),
];

/// Parameters. Items of enumerations count from 1.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Parameters {
    /// Radius without load r0 \[m\].
    pub radius: f64,
    /// Thickness of an element along its ray \[m\].
    pub element_thickness: f64,
    /// Width, for pictures \[m\].
    pub width: f64,
    /// Number of elements N.
    pub elements: i32,
    /// Contact points of an element.
    pub contact_points: i32,
    /// Angle between the ends of neighbouring elements \[rad\].
    pub gap_angle: f64,
    /// Mass of all elements \[kg\].
    pub rubber_mass: f64,
    /// Stiffness of an element k_ce \[N/m\].
    pub stiffness: f64,
    /// Damping of an element c_ce \[N.s/m\].
    pub damping: f64,
    /// Factor on the stiffness for tires of other makers.
    pub stiffness_factor: f64,
    /// Law of the stiffness: 1 constant, 2 a power, 3 a table.
    pub stiffness_law: i32,
    /// Exponent of the load in the stiffness.
    pub stiffness_load_exponent: f64,
    /// Points of the stiffness.
    pub stiffness_points: String,
    /// Law of the damping, likewise.
    pub damping_law: i32,
    /// Exponent of the load in the damping.
    pub damping_load_exponent: f64,
    /// Exponent of the speed in it.
    pub damping_speed_exponent: f64,
    /// Points of the damping.
    pub damping_points: String,
    /// Load at which the constants hold \[N\].
    pub reference_load: f64,
    /// Speed at which they hold \[m/s\].
    pub reference_speed: f64,
    /// The load that coefficients are taken at \[N\]; 0: the present one behind a lag.
    pub characteristic_load: f64,
    /// Time constant of that lag \[s\].
    pub characteristic_lag: f64,
    /// Stiffness of an element that relaxes, beside the spring \[N/m\].
    pub relaxing_stiffness: f64,
    /// Time in which it does \[s\].
    pub relaxing_time: f64,
    /// Friction of an element \[N\].
    pub friction_force: f64,
    /// Stiffness up to that friction \[N/m\].
    pub friction_stiffness: f64,
    /// How neighbours are coupled: 1 not, 2 around the wheel, 3 against bending too.
    pub coupling: i32,
    /// Stiffness between neighbours along the chord between them k_t \[N/m\].
    pub coupling_stiffness: f64,
    /// Damping there c_t \[N.s/m\].
    pub coupling_damping: f64,
    /// Stiffness against a bend from chord to chord kt_y \[N.m/rad\].
    pub bending_stiffness: f64,
    /// Damping of that \[N.m.s/rad\].
    pub bending_damping: f64,
    /// Contact with the road.
    pub contact: Contact,
    /// What that is of: 1 an element, 2 a point.
    pub contact_of: i32,
    /// Slip stiffness C_s \[N\].
    pub slip_stiffness: f64,
    /// Friction coefficient without slip.
    pub friction_max: f64,
    /// Friction coefficient at a slip of 1.
    pub friction_min: f64,
    /// Relaxation length \[m\].
    pub relaxation_length: f64,
    /// The speed with which the slip follows: 1 the faster one of travelling and rolling, 2 that of travelling.
    pub relaxation_rate: i32,
    /// Where the adhering share of the contact is from: 1 the slip, 2 the elements in contact as well.
    pub adhesion: i32,
    /// Rolling resistance over the load.
    pub rolling_resistance: f64,
    /// What resists rolling: 1 a force, 2 a moment.
    pub resistance_as: i32,
    /// What is summed up to the force on the rim: 1 the radial forces, 2 all.
    pub rim_force: i32,
    /// Gravity \[m/s²\].
    pub gravity: f64,
}

clone_in_place!(Parameters {
    radius,
    element_thickness,
    width,
    elements,
    contact_points,
    gap_angle,
    rubber_mass,
    stiffness,
    damping,
    stiffness_factor,
    stiffness_law,
    stiffness_load_exponent,
    stiffness_points,
    damping_law,
    damping_load_exponent,
    damping_speed_exponent,
    damping_points,
    reference_load,
    reference_speed,
    characteristic_load,
    characteristic_lag,
    relaxing_stiffness,
    relaxing_time,
    friction_force,
    friction_stiffness,
    coupling,
    coupling_stiffness,
    coupling_damping,
    bending_stiffness,
    bending_damping,
    contact,
    contact_of,
    slip_stiffness,
    friction_max,
    friction_min,
    relaxation_length,
    relaxation_rate,
    adhesion,
    rolling_resistance,
    resistance_as,
    rim_force,
    gravity
});

/// What follows from the parameters.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Prepared {
    /// Angle between neighbours \[rad\].
    pub pitch: f64,
    /// Cosine and sine of the angle of each element at a spin angle of 0: the first one is straight below.
    pub rays: Vec<[f64; 2]>,
    /// Places of the contact points along the tread, from the middle of the element \[m\].
    pub offsets: Vec<f64>,
    /// Mass of an element \[kg\].
    pub mass: f64,
    /// Distance of an element's middle from the rim's centre without load \[m\].
    pub free: f64,
    /// Contact of one point.
    pub contact: Contact,
    pub stiffness: Characteristic,
    pub damping: Characteristic,
    /// Of the drum that it rolls on \[1/m\]; 0: of none.
    pub curvature: f64,
}

clone_in_place!(Prepared { pitch, rays, offsets, mass, free, contact, stiffness, damping, curvature });

impl Parameters {
    pub(super) fn prepare(&self, curvature: f64) -> Result<Prepared> {
        self.check()?;
        let pitch = TAU / f64::from(self.elements);
        let ray = |n: i32| {
            let (sin, cos) = libm::sincos(f64::from(n) * pitch - 0.5 * PI);
            [cos, sin]
        };
        let half = self.radius * libm::sin(0.5 * (pitch - self.gap_angle));
        let points = f64::from(self.contact_points);
        let offset = |i: i32| half * (2.0 * f64::from(i) / (points - 1.0) - 1.0);
        let offsets = match self.contact_points {
            1 => vec![0.0],
            points => (0..points).map(offset).collect(),
        };
        let mut contact = self.contact;
        if self.contact_of == 1 {
            contact.force /= points;
            contact.damping /= points;
        }
        let reference = [self.reference_load, self.reference_speed];
        let law = |law: i32, exponent: [f64; 2], name: &str, points: &str, with_speed: bool| match law {
            2 => Ok(Characteristic::Power { reference, exponent }),
            3 => Characteristic::table(name, points, with_speed),
            _ => Ok(Characteristic::Constant),
        };
        let damping = [self.damping_load_exponent, self.damping_speed_exponent];
        Ok(Prepared {
            pitch,
            rays: (0..self.elements).map(ray).collect(),
            offsets,
            mass: self.rubber_mass / f64::from(self.elements),
            free: self.radius - 0.5 * self.element_thickness,
            contact,
            stiffness: law(
                self.stiffness_law,
                [self.stiffness_load_exponent, 0.0],
                "stiffness_points",
                &self.stiffness_points,
                false,
            )?,
            damping: law(self.damping_law, damping, "damping_points", &self.damping_points, true)?,
            curvature,
        })
    }

    fn check(&self) -> Result<()> {
        if self.element_thickness >= self.radius {
            return Err(Error::variable(format!(
                "element_thickness = {:?} m has to be smaller than tire_radius = {:?} m",
                self.element_thickness, self.radius
            )));
        }
        // the radial sum has no place for what neighbours put into the rays' guides: half of the load with stiff ones
        if self.coupling > 1 && self.rim_force != 2 {
            return Err(Error::variable(
                "coupling needs rim_force = exact: neighbours put forces into the rays' guides, which the printed sum of radial forces leaves out",
            ));
        }
        let pitch = TAU / f64::from(self.elements);
        if self.gap_angle >= pitch {
            return Err(Error::variable(format!(
                "gap_angle = {:?} rad has to be smaller than the angle between neighbouring elements, {pitch:.4} rad with elements = {}",
                self.gap_angle, self.elements
            )));
        }
        if self.friction_min > self.friction_max {
            return Err(Error::variable(format!(
                "friction_min = {:?} has to be at most friction_max = {:?}",
                self.friction_min, self.friction_max
            )));
        }
        Ok(())
    }

    /// mu at a slip (4-63).
    pub(super) fn friction(&self, slip: f64) -> f64 {
        let slip = slip.abs().min(1.0);
        self.friction_max + slip * (self.friction_min - self.friction_max)
    }

    /// Dynamic radius where the rim's centre is so high over the road (4-62) \[m\].
    pub(super) fn dynamic_radius(&self, height: f64) -> f64 {
        (2.0 * self.radius + height.clamp(0.0, self.radius)) / 3.0
    }
}
