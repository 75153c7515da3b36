//! Sessions on a flat track: recordings of a ring-and-brush tire whose truth is a tire of its own.
//!
//! Nothing here depends on latsch. The tire is written from the specification of the model alone: `tire` and what it
//! is made of; equation numbers are those of the thesis (Kaden, TU München 2015), as the specification has them.
//! `rig` drives it through a `programme`, `session` with what is `concealed` in it; `case` draws, sizes and records.

mod bristle;
mod case;
mod concealed;
mod fault;
mod footing;
mod frames;
mod odd;
mod offers;
mod parameters;
mod patch;
mod programme;
mod rig;
mod session;
mod sidewall;
mod tire;

pub use case::{case, count};

#[cfg(test)]
mod tests;
