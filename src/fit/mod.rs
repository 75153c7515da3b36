//! Least squares on any slave: parameters, and effects attached to it, from recordings.

mod bench;
mod covariance;
mod derivatives;
mod least_squares;
mod output_error;
mod quadratic;
mod replay;
mod settle;
mod side_by_side;

pub use bench::{Bench, Drive, Factory, Setup, Traces};
pub use covariance::Covariance;
pub use least_squares::{End, Fit, Options, Problem, Unknown, least_squares};
pub use output_error::{Channel, Kept, Knob, OutputError, Run};
pub use replay::replay;
pub use settle::settle;
pub use side_by_side::side_by_side;
