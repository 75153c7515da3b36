//! Tires that touch the road in one point: steady forces of a law, at a load and at slips that lag by relaxation lengths.
//!
//! [`OnePoint`] is the tire, generic over its [`Law`]: contact, relaxation, standstill and the way to the rim are the same for
//! all of them. Axes and signs are those of ISO-W, the W axis system of TYDEX: x forward in the wheel plane, y to the left, z up
//! along the road's normal, origin in the contact point.

mod tire;

pub use tire::{OnePoint, State};

use crate::Result;
use crate::mechanics::Link;
use crate::model::Table;
use serde::{Serialize, de::DeserializeOwned};

/// What every tire with one contact point makes of a road, for its documentation.
pub(super) const ON_ROAD: &str = include_str!("on_road.html");

/// What the steady forces depend on, in ISO-W axes and SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Input {
    /// Wheel load \[N\]; zero or less means that the tire is off the ground.
    pub fz: f64,
    /// Longitudinal slip −Vsx/|Vx| \[1\]: positive driven, −1 locked.
    pub kappa: f64,
    /// Slip angle atan(Vsy/|Vx|) \[rad\]: positive when the wheel travels to its left; beyond ±π/2 it is taken as ±π/2.
    pub alpha: f64,
    /// Inclination angle \[rad\]: positive when the top of the wheel leans to −y.
    pub gamma: f64,
    /// Speed of travel along x \[m/s\]; negative in reverse.
    pub vx: f64,
    /// Friction factor of the road \[1\]: multiplies friction coefficients; 1 on the road of the measurement.
    pub friction: f64,
}

impl Input {
    /// The mirror image of this input at the xz plane.
    ///
    /// For a tire whose property file was made for the other side of the vehicle, the forces are the
    /// mirrored forces at the mirrored input.
    #[must_use]
    pub fn mirrored(self) -> Self {
        Self { alpha: -self.alpha, gamma: -self.gamma, ..self }
    }
}

/// How far a tire is pressed onto the road.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pressed {
    /// Radius without load at rest, less the distance of the wheel's centre from the contact point \[m\].
    pub deflection: f64,
    /// Its rate \[m/s\].
    pub rate: f64,
    /// Spin speed of the wheel \[rad/s\].
    pub spin: f64,
    /// Forces along and across of the instant before \[N\].
    pub force: [f64; 2],
}

/// Steady forces and moments that the road puts on the tire in the contact point, in ISO-W axes and SI units, and what
/// belongs to them.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Steady {
    /// Force along and across \[N\].
    pub force: [f64; 2],
    /// Moment about x, y and z \[N.m\].
    pub moment: [f64; 3],
    /// Pneumatic trail \[m\], for an output.
    pub trail: f64,
    /// Friction coefficients along and across \[1\].
    pub friction: [f64; 2],
    /// Slopes of the forces over slip \[N\] and slip angle \[N/rad\] at none; of any sign.
    pub stiffness: [f64; 2],
    /// Moment about z over rolling speed and rate of the lateral deflection \[N.s²/m\]: gyroscopic couple of the belt.
    pub couple: f64,
    /// An input was outside of the range that the law holds for, and was kept at its end.
    pub outside: bool,
}

/// What a tire with one contact point is at low speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Standstill {
    /// Speed from which on nothing of it is left \[m/s\].
    pub speed: f64,
    /// Damping of the deflections at rest \[N.s/m\].
    pub damping: f64,
}

/// The law of a tire with one contact point: its parameters, and the forces that follow from them.
pub trait Law: Clone + Default + PartialEq + Serialize + DeserializeOwned + Send + 'static {
    /// As [`Tire::NAME`](super::Tire::NAME).
    const NAME: &'static str;
    /// As [`Tire::TITLE`](super::Tire::TITLE).
    const TITLE: &'static str;
    /// As [`Tire::DOCUMENTATION`](super::Tire::DOCUMENTATION).
    const DOCUMENTATION: &'static str;

    /// The parameters.
    fn rows() -> Table<Self>;

    /// Checks them against each other and makes what follows from them, at the start and when they were tuned.
    ///
    /// # Errors
    /// Parameters that contradict each other.
    fn mount(&mut self) -> Result<()> {
        Ok(())
    }

    /// As [`Tire::mirror`](super::Tire::mirror).
    fn mirror(&mut self) {}

    /// Radius without load at rest \[m\].
    fn radius(&self) -> f64;

    /// Normal force \[N\], not negative.
    fn normal_force(&self, pressed: &Pressed) -> f64;

    /// The deflection \[m\] at which a load \[N\] rests on the tire, with `spin` \[rad/s\] and without other forces.
    fn deflection(&self, load: f64, spin: f64) -> f64;

    /// Effective rolling radius \[m\] at a deflection and spin.
    fn rolling_radius(&self, deflection: f64, spin: f64) -> f64;

    /// Relaxation lengths of slip and of the slip angle \[m\].
    fn relaxation(&self, load: f64, camber: f64) -> [f64; 2];

    /// The steady forces.
    fn steady(&self, input: &Input) -> Steady;

    /// What it is at low speed.
    fn standstill(&self) -> Standstill;

    /// Spring and damper between the rim and the road, with the names of their parameters, for how long a step may be.
    fn vertical_link(&self) -> Link;

    /// The load for which steps have to be short enough \[N\], and what makes the stiffnesses along and across there, for a message.
    fn usual_load(&self) -> (f64, [&'static str; 2]);
}
