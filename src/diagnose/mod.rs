//! Diagnosis: where recordings and simulation differ, and why.

pub mod hygiene;
