//! Test rigs and vehicles: a tire, whichever it is, and what drives and measures it.

mod actuator;
mod bare;
mod corner;
mod drum;
mod excitation;
mod flat_track;
mod hub;
mod hydropulse;
mod load_control;
mod on_road;
mod rolling;
mod truck;
pub mod vehicle;
mod wheel;

pub use actuator::{Actuation, Actuator, Command};
pub use bare::Bare;
pub use corner::Corner;
pub use drum::Drum;
pub use excitation::Excitation;
pub use flat_track::FlatTrack;
pub use hub::{Hub, HubParameters};
pub use hydropulse::HydroPulse;
pub use on_road::OnRoad;
pub use rolling::Rolling;
pub use truck::CounterbalanceTruck;
pub use vehicle::{AxleRig, Vehicle};
pub use wheel::Wheel;

use crate::tire::ring_brush::RingBrush;

/// `ring-brush-flat-track`
pub type RingBrushFlatTrack = FlatTrack<RingBrush>;
/// `ring-brush-tire`
pub type RingBrushTire = Bare<RingBrush>;
/// `ring-brush-wheel`
pub type RingBrushWheel = Wheel<RingBrush>;
/// `ring-brush-corner`
pub type RingBrushCorner = Corner<RingBrush>;
