//! Numerical methods: exact derivatives by dual numbers, Newton's method.

mod newton;
mod real;

pub use newton::{Convergence, newton};
pub use real::{Dual, Real};
