//! Sequential identification: solvers and checks on the source's worked examples, and the plan of the ring-and-brush tire.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod appendix;
mod benchmark;
mod checks;
mod examples;
mod groups;
mod recorded;
mod solvers;
mod theorems;
