//! Recordings of a car that brakes, with and without a controller, on level road and on slabs.
//!
//! Nothing here depends on latsch. The car is written from what the models say of themselves to a user, by somebody who had not seen
//! their code; equation numbers are those of the source (Mack, Karlsruhe 2009). `vehicle` moves body, carriers and wheels on what
//! `axle` joins them with and `tire` does on a `road`; `start` puts all in balance; `brake` and `controller` close the loop; `world`
//! drives and records; `concealed` sets the car and what is believed of it apart. Steps are explicit, of Kutta's classical rule.

mod axle;
mod brake;
mod case;
mod concealed;
mod controller;
mod parameters;
mod programme;
mod road;
mod start;
mod system;
mod tire;
mod vector;
mod vehicle;
mod world;

pub use case::{case, count};

#[cfg(test)]
mod tests;
