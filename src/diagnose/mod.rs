//! Diagnosis: where recordings and simulation differ, and why.

mod blocks;
pub mod hygiene;
pub mod loads;
mod pipeline;
mod placement;
mod result;
mod roles;
mod runs;
mod screen;
pub mod spectrum;
mod study;
mod subject;

pub use pipeline::{CheckTraces, Outcome, Request, diagnose};
pub use result::*;
pub use runs::Map;
pub use subject::{Base, Subject};
