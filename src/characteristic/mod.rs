//! Characteristics of a solid tire from its rig recordings: force-deflection loops of a standing wheel, and decays after a cleat on a
//! drum, become the stiffness and the damping of one contact element over load and speed.
//!
//! After S. Y. Oh, dissertation, TU München 2017, chapter 6; numbers in parentheses are equation numbers of that work.

pub mod decay;
pub mod geometry;
pub mod laws;
pub mod loops;
pub mod series;
