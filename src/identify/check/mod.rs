//! Tests of a plan: whether targets depend only on what they may, and whether they have one answer (text section 3.5).
//!
//! All are tests by samples. A counter-example is a proof; a pass is evidence, no more: to decide either question is NP-hard
//! (B.14, B.15).

mod closed_form;
mod independence;
mod injectivity;
mod next_group;
mod report;
mod response;
mod samples;
mod text;

pub use closed_form::ClosedForm;
pub use independence::{Dependence, Search, depends, influence};
pub use injectivity::{Injectivity, Orthant, injective};
pub use next_group::{Choice, Finder, Next, Step};
pub use report::{GroupReport, Report, Standing, check};
pub use response::{Response, responds};
pub use samples::{Sampled, Sampling};
