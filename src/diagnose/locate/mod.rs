//! Where recordings and simulation differ: in which channel, when, at which frequencies, under which
//! operating conditions, and whether chance can make that.
//!
//! Everything here takes the runs and the simulated channels of each run at its samples; the residual is
//! measured minus simulated. Residuals are coloured, so that tests go by blocks longer than their memory
//! or by independent segments of a spectrum.

mod common;
mod depends;
mod map;
mod noise;
mod repeats;
mod signals;
mod structure;

pub use common::{Common, common_cause};
pub use depends::{TIME, depends_on};
pub use map::map;
pub use noise::noise;
pub use repeats::scatter;
pub use structure::{Seen, Sensitivity, Structure, structure};

#[cfg(test)]
mod bed;
