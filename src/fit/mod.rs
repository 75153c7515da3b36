//! Least squares on any slave: parameters, and effects attached to it, from recordings.

mod bench;
mod covariance;
mod least_squares;
mod output_error;

pub use bench::{Bench, Drive, Factory, Setup, Traces};
pub use covariance::Covariance;
pub use least_squares::{End, Fit, Options, Problem, Unknown, least_squares};
pub use output_error::{Channel, Knob, OutputError, Run};
