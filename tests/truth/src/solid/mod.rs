//! Recordings of a solid rubber tire on two rigs: under a hydropulse cylinder and on a drum with a cleat.
//!
//! Nothing here depends on latsch. The tire is written from its specification alone: elements on rays with springs and
//! dampers, contact points with the IMPACT law, a brush along the road; equation numbers are those of the source (Oh,
//! TU München 2017), as the specification has them. `tire` is that, `rubber` what rubber does beyond it, `world` puts it
//! on a rig; `case` draws, sizes and records. Steps are explicit, of Kutta's classical rule, and short.

mod case;
mod concealed;
mod parameters;
mod programme;
mod rubber;
mod tire;
mod world;

pub use case::{case, count};

#[cfg(test)]
mod tests;
