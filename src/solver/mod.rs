//! Numerical methods: exact derivatives by dual numbers, Newton's method, elementary functions of four numbers at once.

mod jump;
pub mod lanes;
mod newton;
mod real;

pub use jump::{Jump, jump};
pub use newton::{Convergence, newton};
pub use real::{Dual, Real};
