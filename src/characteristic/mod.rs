//! Characteristics of a solid tire from its rig recordings: force-deflection loops of a standing wheel, and decays after a cleat on a
//! drum, become the stiffness and the damping of one contact element over load and speed.
//!
//! After S. Y. Oh, dissertation, TU München 2017, chapter 6; numbers in parentheses are equation numbers of that work. A [`Plan`] names
//! recordings and what is known of the rig; [`characterize`] follows it: [`loops`] and [`decay`] read recordings, [`geometry`] makes
//! one element of the whole tire, [`laws`] are curves through points, [`parameters`] writes.

mod answer;
mod damping;
pub mod decay;
pub mod geometry;
pub mod laws;
pub mod loops;
mod plan;
mod power_law;
pub mod series;
mod stiffness;
pub mod swing;
mod write;

pub use answer::{
    Answer, AtLoad, Coefficient, DecayAnswer, ForElements, LoopAnswer, OverSpeed, Point, characterize,
    characterize_with, value_at,
};
pub use plan::{DecayPlan, Law, LoopPlan, MassFrom, Plan, Quantity, Tire, Wanted};
pub use write::parameters;
