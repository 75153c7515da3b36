//! Bodies, what acts between them, and the step that moves them.
//!
//! Everything here is a formula on plain values: a machine holds its bodies as fields, adds up the forces of its
//! elements, and moves all bodies in the same halves of a velocity-Verlet step (see [`drift`]).
//! Axes are those of frame 0: x and y horizontal, z up.

mod body;
mod curve;
mod element;
mod motion;
mod point_mass;
mod pose;
mod rigid;
mod spin;
mod stability;
mod verlet;

pub use body::Body;
pub use curve::Curve;
pub use element::{BumpStop, Guide, Rod, Slid, Spanned, SpringDamper};
pub use motion::{Attitude, Motion, Wrench};
pub(crate) use motion::{cross, rotation_x, rotation_y, rotation_z, turn, turn_back};
pub use point_mass::PointMass;
pub use pose::{At, Pose};
pub use rigid::RigidBody;
pub use spin::Spin;
pub use stability::{
    ABOUT, ALONG, Coordinate, Link, Named, Response, check_step_size, check_steps_of_led_rim,
};
pub use verlet::{Drift, drift, kick};
