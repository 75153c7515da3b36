//! Test rigs and vehicles: a tire and what drives and measures it.

mod actuator;
mod bare;
mod corner;
mod flat_track;
mod hub;
mod mounted;
mod on_road;
mod stability;
mod table;
mod wheel;

pub use actuator::{Actuation, Actuator, Command};
pub use bare::RingBrushTire;
pub use corner::RingBrushCorner;
pub use flat_track::RingBrushFlatTrack;
pub use hub::{Hub, HubParameters};
pub use mounted::MountedTire;
pub use on_road::OnRoad;
pub use wheel::RingBrushWheel;
