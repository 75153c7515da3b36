//! Solvers of as many equations as unknowns, in a box: each with what it guarantees, and with a reason where it finds nothing.

mod bracket;
mod conditioning;
mod descent;
mod local;
mod nested;
mod outcome;
mod sequence;
mod tail;
mod targets;

pub(super) use bracket::Next;
pub use conditioning::intervals;
pub(super) use descent::nearest;
pub use local::{Method, local};
pub use nested::{Nesting, nested};
pub use outcome::{Side, Solution, Stall, Unsolved};
pub use sequence::{Direct, Group, Sequence, Way, sequence};
pub use tail::Tail;
pub(super) use targets::Problem;
pub use targets::{Goal, Part, Targets};
