//! The super-elastic tire: solid rubber with a soft layer inside, for industrial trucks, as a wheel of many masses in a plane.
//!
//! # Source
//! S. Y. Oh, *Modellierung und Entwicklung eines Flurförderzeugreifenmodells als Mehrkörpersystem*, dissertation, TU
//! München 2017, the second of its two implementations (chapter 4.3 and 5.2.3). Numbers in parentheses are its equations.
//!
//! # The model
//! The tread is N equal contact elements, each on a ray from the rim's centre at the angle φ (4-24). An element moves along
//! its ray only, on a spring and a damper that stand for the soft layer (4-30); its contact points meet the road, a raw
//! polyline, by a one-sided law (4-60). The longitudinal force is that of a brush (Gim, 2-49) at a slip that lags by a way
//! (2-16), and there is a rolling resistance (4-64).
//!
//! # Axes
//! In the wheel's plane x runs forward and z up; φ is measured from x towards z and falls as the wheel rolls forward. The wheel
//! spins about y, which points to the left (ISO 8855).
//!
//! # What is left out
//! Forces across the wheel, camber and turning: the source's model is a plane one. Camber changes nothing, and a force to the side
//! is never there. Tread pattern, wear and temperature. The hysteresis that the source itself misses can be added
//! ([`Parameters::relaxing_stiffness`], [`Parameters::friction_force`]); it is no part of the source.
//!
//! # Where the print is open
//! Every place that can be read in two ways is a switch among the [`Parameters`], with the reading that is nearest to the print as
//! default. One exception: the printed lag of the slip (2-16) has the travelling speed as its rate, with which a wheel that starts
//! from rest never gets a force; the default takes the faster one of travelling and rolling, which is the same for a wheel that is
//! braked.

mod characteristic;
mod contact;
mod coupling;
mod element;
mod parameters;
mod ring;
mod rows;
mod stationary;
mod tire;

pub use characteristic::Characteristic;
pub use contact::{Contact, smooth_step};
pub use parameters::Parameters;
pub use ring::{RimInPlane, Ring};
pub use tire::{State, SuperElastic};
