//! Diagnosis: where recordings and simulation differ, and why.

mod aside;
mod begin;
mod candidates;
mod clock;
mod decision;
mod excerpt;
mod experiment;
mod forces;
mod given;
pub mod hygiene;
mod in_turn;
mod judge;
mod left;
pub mod locate;
mod numbers;
mod others;
mod parts;
mod pipeline;
mod placement;
mod plausible;
mod precision;
mod prepared;
mod programmes;
mod reading;
mod recalled;
mod refit;
mod result;
mod roles;
mod runs;
mod screen;
mod search;
mod span;
mod steps;
mod study;
mod subject;
mod tables;
#[cfg(test)]
mod tests;
mod wander;
mod witnesses;

pub use pipeline::{CheckTraces, Outcome, Request, diagnose};
pub use result::*;
pub use runs::Map;
pub use subject::{Base, FreeParameter, LeftOut, Subject};
