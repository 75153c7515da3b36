//! Recordings of machines in which an effect is concealed, the sealed answers to them, and the score.
//!
//! Nothing here depends on latsch, but for the tire that [`flat_track`] rolls. A [`study`] is a list of kinds, shuffled by its seed; [`draw`] makes
//! a case of one of them: a base machine with parameters of its own, what is [hidden] in it, a
//! [`programme`], [sensors](sensor) and perhaps a [`fault`] of the recording; [`recording`] simulates it.
//! The same seed gives the same bytes on every machine. [`machines`], [`sessions`], [`solid`] and [`car`] are studies of
//! their own.
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]
// the same bits on every processor, as clippy.toml says
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod answer;
pub mod base;
mod bessel;
pub mod car;
pub mod catalogue;
pub mod draw;
pub mod fault;
pub mod files;
pub mod flat_track;
mod follow;
pub mod hidden;
pub mod machines;
pub mod programme;
pub mod random;
mod recorder;
pub mod recording;
pub mod score;
pub mod sensor;
pub mod sessions;
pub mod simulate;
pub mod sizing;
pub mod solid;
pub mod study;
