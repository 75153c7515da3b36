//! Sequential identification: parameters found group after group, each from few readings that only it and those before it
//! influence, by an inversion that is known to have one answer.
//!
//! After Kaden, dissertation, TU München 2015 (chapter 3 for the method, section 4.2 for the ring-and-brush tire). Numbers in
//! parentheses are equation numbers of that work, B.n sections of its appendix.
//!
//! A [`Plan`] is data: groups of parameters, the conditions that a rig has to meet, and what is read. [`Readings`] are a plan on a
//! [`Stand`], which is any slave that starts in a stationary state: target quantities as functions of parameters
//! ([`solve::Targets`]). [`solve`] inverts such functions, [`check`] tests what the inversion relies on. What no data can say (a
//! closed form, a change of parameters) is registered by name ([`Registry`]).

pub mod benchmark;
pub mod check;
mod like;
mod named;
mod plan;
mod programme;
mod readings;
pub mod recorded;
mod registry;
pub mod ring_brush;
mod setup;
pub mod solve;
mod sought;
mod stand;

pub use like::{shipped, shipped_plan};
pub use plan::{
    Condition, GroupPlan, Limit, NestingPlan, Plan, Ramp, Reach, Recordings, Require, Sought, Target, Touch,
};
pub use programme::{Programme, RigLimit, RigRun, Run};
pub use readings::Readings;
pub use registry::{Changed, Functional, Inversion, Invert, Numbers, Registry, Transform};
pub use stand::{Stand, Values, number};
