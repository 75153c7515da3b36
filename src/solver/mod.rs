//! Numerical methods: exact derivatives by dual numbers, Newton's method, elementary functions of four numbers at once.

pub mod lanes;
mod newton;
mod real;

pub use newton::{Convergence, newton};
pub use real::{Dual, Real};
