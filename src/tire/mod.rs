//! Tire models: equations only; no files, no FMI.

mod ground;
mod motion;
pub mod ring_brush;

pub use ground::{Flat, Ground, Plane};
pub use motion::{Motion, Wrench};
