//! Classic tires with one contact point, from the linear one to the vertical part of SWIFT's rigid ring.
//!
//! Each is a [`Law`](super::one_point::Law) with the equations that S. Y. Oh (2017), 2.4, sums up, and what is missing there.
//! None of them is for obstacles shorter than a contact.

mod basics;
mod fiala;
mod linear;
mod swift;
mod tmeasy;
mod ua;

pub use basics::{Basics, Forces, Simple};
pub use fiala::Fiala;
pub use linear::Linear;
pub use swift::{Ring, Swift};
pub use tmeasy::{AtTwoLoads, Curve, TmEasy, Trail};
pub use ua::Ua;

use super::one_point::OnePoint;

/// `linear-...`
pub type LinearTire = OnePoint<Simple<Linear>>;
/// `fiala-...`
pub type FialaTire = OnePoint<Simple<Fiala>>;
/// `ua-...`
pub type UaTire = OnePoint<Simple<Ua>>;
/// `tmeasy-...`
pub type TmEasyTire = OnePoint<TmEasy>;
/// `swift-...`
pub type SwiftTire = OnePoint<Swift>;
