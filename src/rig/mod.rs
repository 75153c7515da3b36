//! Test rigs: a tire and what drives and measures it.

mod actuator;
mod flat_track;

pub use actuator::{Actuator, Command};
pub use flat_track::RingBrushFlatTrack;
