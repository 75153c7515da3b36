//! Tires: equations only; no files, no FMI.
//!
//! A [`Tire`] is what happens between a rim and a road. It fits every rig: a rig moves the rim and knows the road, the
//! tire answers with the force and the moment on the rim.

mod brush;
pub mod classic;
mod ground;
pub mod magic_formula;
mod mounted;
pub mod one_point;
mod relaxation;
pub mod ring_brush;
pub mod super_elastic;

pub use crate::mechanics::{Link, Motion, Wrench};
pub use ground::{Flat, Ground, Plane};
pub use mounted::{Mounted, Start, to_heading};

use crate::model::Table;
use crate::road::{Road, Window};
use crate::solver::Dual;
use crate::{Error, Result};
use nalgebra::Vector3;
use serde::{Serialize, de::DeserializeOwned};

/// What holds the rim in the vertical direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Vertical {
    /// The height of the rim's centre over the road \[m\].
    Height(f64),
    /// The vertical force of the tire on the rim \[N\].
    Load(f64),
}

/// A state in which a tire stays as long as its rim keeps moving as it does, on a plane road.
#[derive(Debug, Clone, PartialEq)]
pub struct Rest<S> {
    /// Height of the rim's centre over the plane \[m\].
    pub rim_height: f64,
    /// Force and moment of the tire on the rim about its centre, in the axes in which the plane is level.
    pub on_rim: Wrench<f64>,
    /// What the tire has to know of itself to be in that state.
    pub inside: S,
}

/// Masses that ride on a rim.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Carried {
    /// Mass that goes where the rim goes \[kg\]. Its weight is in the force on the rim.
    pub mass: f64,
    /// Inertia that spins as the rim spins \[kg.m²\].
    pub inertia: f64,
    /// Acceleration of the rim's centre, frame 0 \[m/s²\].
    pub acceleration: Vector3<f64>,
    /// Acceleration of its spin \[rad/s²\].
    pub spin_acceleration: f64,
}

/// How what a tire tells changes along a direction, in which the rim's motion and the friction change.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// Force and moment on the rim, frame 0, with their derivative.
    pub on_rim: Wrench<Dual<1>>,
    /// Derivatives of own outputs, by name.
    pub outputs: Vec<(&'static str, f64)>,
    /// Derivative of the own outputs that are not named: `None` where there is no formula.
    pub others: Option<f64>,
    /// Own outputs that have no derivative at all, and why.
    pub refused: (&'static [&'static str], &'static str),
}

/// A bristle, or whatever else carries a piece of a contact patch, for pictures. Contact axes: x along the patch in
/// the wheel's heading, y to the left.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Cell {
    /// Centre along the patch \[m\].
    pub x: f64,
    /// Centre across the patch \[m\].
    pub y: f64,
    /// Extent along x \[m\].
    pub length: f64,
    /// Extent along y \[m\].
    pub width: f64,
    /// Pressure \[Pa\].
    pub pressure: f64,
    /// It slides over the road.
    pub sliding: bool,
    /// Shear deflection, the foot on the road as seen from the top \[m\]: the force of the road on the tire has
    /// its direction.
    pub deflection: [f64; 2],
}

/// A tire: one plain value with its parameters and its state.
///
/// It stands between a rim, whose motion somebody else decides, and a [`Ground`], through which alone it knows of
/// road and friction. It is used in this order: `default()`, then its parameters are written through its
/// [`rows`](Tire::rows), then [`mount`](Tire::mount), [`begin`](Tire::begin) from a state that
/// [`stationary`](Tire::stationary) found, and steps.
///
/// Positions are seen from the point of the road's datum below the rim's centre: x and y of the rim's position are 0.
/// Velocities are over the road. Axes are ISO 8855: x forward, y to the left, z up.
pub trait Tire: Clone + Default + PartialEq + Serialize + DeserializeOwned + Send + 'static {
    /// Its name in kebab-case; models are called by it and by the rig: `ring-brush-wheel`.
    const NAME: &'static str;
    /// Its name in a sentence that begins with it: "Ring-and-brush tire".
    const TITLE: &'static str;
    /// What the documentation of a model with this tire says of it: HTML, as in
    /// [`Model::DOCUMENTATION`](crate::model::Model::DOCUMENTATION).
    const DOCUMENTATION: &'static str = "";
    /// The same of what it makes of a road, which stands behind the description of roads.
    const ON_ROAD: &'static str = "";
    /// True if [`stationary_change`](Tire::stationary_change) and [`step_change`](Tire::step_change) have answers.
    const DERIVATIVES: bool = false;
    /// True if its forces ripple with parts that come and go, faster than communication points see: then the last change of an output
    /// does not tell how it goes on, and outputs of models with this tire have no derivative over time.
    const RIPPLES: bool = false;
    /// Step of the rigs' own time grids if none is set \[s\].
    const STEP: f64 = 1e-4;
    /// What a [`Rest`] of this tire has inside.
    type Inside;

    /// Its parameters, and its own outputs and locals besides force and moment on the rim.
    fn rows() -> Table<Self>;

    /// Checks the parameters against each other and makes what follows from them; `road` is what the rig will move
    /// it over.
    ///
    /// # Errors
    /// Parameters that contradict each other.
    fn mount(&mut self, road: &Road) -> Result<()>;

    /// Takes over parameters that were tuned between steps.
    ///
    /// # Errors
    /// Parameters that contradict each other.
    fn tune(&mut self) -> Result<()> {
        Ok(())
    }

    /// Takes over the parameters of another one of its kind, and keeps its own state: where several tires share parameters.
    /// [`tune`](Tire::tune) has to follow.
    fn share_parameters(&mut self, of: &Self);

    /// Makes of a tire for one side of a vehicle the one for the other side, its mirror image at the wheel's plane. Its state stays.
    /// Nothing to do for a tire that is alike on both sides.
    fn mirror(&mut self) {}

    /// Checks a value that was read from bytes: whatever [`step`](Tire::step) takes for granted.
    ///
    /// # Errors
    /// Its parts do not fit each other.
    fn check(&self, road: &Road) -> Result<()> {
        let _ = road;
        Ok(())
    }

    /// Radius without load \[m\].
    fn radius(&self) -> f64;

    /// Way per angle of a wheel that rolls straight and free \[m/rad\], which longitudinal slip refers to, where the
    /// wheel's centre is `deflection` \[m\] lower over the road than the radius without load.
    fn rolling_radius(&self, deflection: f64) -> f64;

    /// The length over which it bridges the road: [`Window::default`] where it feels one point.
    fn window(&self) -> &Window;

    /// Gravity that pulls on masses of its own \[m/s²\], as its parameters have it; rigs' bodies fall with it.
    fn gravity(&self) -> f64;

    /// What ties the rim to the masses inside or to the road, for how long a step may be: in the plane of the
    /// wheel, along its axis, about its axis.
    fn links(&self) -> [Link; 3];

    /// The state that stays as long as the rim keeps its horizontal velocity, camber, steer angle and spin
    /// rate, on a level plane with a factor on its friction.
    ///
    /// # Errors
    /// There is none, or none was found.
    fn stationary(&self, rim: &Motion<f64>, vertical: Vertical, friction: f64) -> Result<Rest<Self::Inside>>;

    /// [`stationary`](Tire::stationary) where a state of a motion that differs little is known.
    ///
    /// # Errors
    /// As [`stationary`](Tire::stationary).
    fn stationary_near(
        &self,
        near: &Rest<Self::Inside>,
        rim: &Motion<f64>,
        vertical: Vertical,
        friction: f64,
    ) -> Result<Rest<Self::Inside>> {
        let _ = near;
        self.stationary(rim, vertical, friction)
    }

    /// Puts the tire into a state that [`stationary`](Tire::stationary) found for the motion that `rim` has against
    /// `plane`; `ground` has that plane under the rim.
    ///
    /// # Errors
    /// As [`step`](Tire::step).
    fn begin(
        &mut self,
        rest: &Rest<Self::Inside>,
        rim: &Motion<f64>,
        plane: &Plane,
        ground: &impl Ground,
    ) -> Result<()>;

    /// Advances by `dt` seconds, in which the rim moves from `before` to `after` over `ground`.
    ///
    /// # Errors
    /// A state outside the tire's validity.
    fn step(
        &mut self,
        before: &Motion<f64>,
        after: &Motion<f64>,
        ground: &impl Ground,
        dt: f64,
    ) -> Result<()>;

    /// Lets the tire lag behind by a way \[m\] in x and y: the rim has moved so much farther than its velocities say.
    fn shift(&mut self, way: [f64; 2]) {
        let _ = way;
    }

    /// Force and moment on the rim about its centre at the last instant, frame 0.
    fn on_rim(&self) -> Wrench<f64>;

    /// Masses of the tire that ride on the rim, with the accelerations of the rim for which [`on_rim`](Self::on_rim) has what they
    /// take. A body whose acceleration is made by that force has to carry them itself.
    fn carried(&self) -> Carried {
        Carried::default()
    }

    /// Energy lost in the contact since the start \[J\].
    fn energy_loss(&self) -> f64;

    /// What a picture shows of its contact.
    fn cells(&self) -> Vec<Cell> {
        Vec::new()
    }

    /// How a stationary state on a level road moves with the rim's motion and the friction, which carry their
    /// derivatives.
    ///
    /// # Errors
    /// There is no derivative here.
    fn stationary_change(
        &self,
        rest: &Rest<Self::Inside>,
        rim: &Motion<Dual<1>>,
        friction: Dual<1>,
    ) -> Result<Change> {
        let _ = (rest, rim, friction);
        Err(Error::call(format!("the tire {} has no directional derivatives", Self::NAME)))
    }

    /// The same between steps, in which the state inside stays.
    ///
    /// # Errors
    /// As [`stationary_change`](Tire::stationary_change).
    fn step_change(&self, rim: &Motion<Dual<1>>, friction: Dual<1>) -> Result<Change> {
        let _ = (rim, friction);
        Err(Error::call(format!("the tire {} has no directional derivatives", Self::NAME)))
    }
}

/// Checks that a wheel has not fallen over: its camber to the road and the most that its tire is good for \[rad\].
///
/// # Errors
/// It has.
fn check_upright(camber: f64, most: f64) -> Result<()> {
    if camber.abs() <= most {
        return Ok(());
    }
    Err(Error::numeric(format!(
        "the wheel has fallen over: its camber of {camber:.3} rad to the road is outside the tire's validity of {most} rad"
    )))
}
