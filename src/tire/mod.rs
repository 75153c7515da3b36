//! Tire models: equations only; no files, no FMI.

mod motion;
pub mod ring_brush;

pub use motion::{Motion, Wrench};
