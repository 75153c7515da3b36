//! The Magic Formula tire of version 5.2, also known as PAC2002: an empirical tire whose steady forces are sines and
//! cosines of arc tangents of slip.
//!
//! # Sources
//! - H. B. Pacejka, *Tyre and Vehicle Dynamics*, 2nd edition, chapter 4.3.2: the equations without turn slip.
//! - MSC Software, *Using the PAC2002 Tire Model* (Adams/Tire help): the same equations with the names of the
//!   coefficients that stand in tire property files.
//!
//! The equations were checked against public implementations of these sources. Where those differ, [`steady_with`] says
//! what was chosen and why.
//!
//! # Axes and signs
//! ISO-W, the W axis system of TYDEX, which is the tire system of ISO 8855: x forward in the wheel plane, y to the left,
//! z up, origin in the contact point. So:
//! - the slip angle α is positive when the wheel travels to its left (tan α = Vsy/|Vx|); the lateral force is then
//!   negative and, with a positive pneumatic trail, the aligning moment positive;
//! - longitudinal slip κ = −Vsx/|Vx| is positive when the wheel is driven, −1 when it is locked;
//! - the inclination angle γ is a rotation about x, positive when the top of the wheel leans to −y (to the right); it
//!   pushes the tire to the right, Fy < 0;
//! - the rolling resistance moment about y is negative in forward travel.
//!
//! # What is left out
//! Turn slip (the factors ζ are 1) and with it parking torque, the dependence on inflation pressure, contact other than
//! in a point, belt dynamics. The gyroscopic couple is a function of its own as it is no part of the steady state.

mod coefficients;
mod forces;
mod law;
mod rows;
#[cfg(test)]
#[allow(clippy::field_reassign_with_default)] // one coefficient a line
mod tests;

pub use super::one_point::Input;
#[cfg(feature = "host")]
pub(crate) use coefficients::out_of_bound;
pub use coefficients::{Bound, Coefficients, Dimension, FIELDS, Field, field};
pub use forces::{
    Limits, Options, Output, Outside, RelaxationLengths, Slip, effective_rolling_radius, gyroscopic_couple,
    relaxation_lengths, static_deflection, steady, steady_with, vertical_force,
};
pub use law::{Formula, MagicFormula};
