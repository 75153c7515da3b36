//! Diagnosis: where recordings and simulation differ, and why.

pub mod loads;
mod result;
pub mod spectrum;

pub use result::*;
