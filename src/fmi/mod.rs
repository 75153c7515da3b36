//! FMI 2.0 for co-simulation: the C interface of exported models, and the import of any FMU. FMUs can be exported for FMI 3.0, too.
//!
//! The only place of `unsafe`.

#[cfg(feature = "host")]
pub mod archive;
pub mod c;
#[cfg(feature = "host")]
#[allow(clippy::disallowed_methods)] // host only
pub mod check;
#[cfg(feature = "host")]
pub mod corrected;
#[cfg(feature = "host")]
pub mod description;
#[cfg(feature = "host")]
mod description3;
#[cfg(feature = "host")]
mod documentation;
mod entry;
pub mod export;
pub mod export3;
mod float;
#[cfg(all(test, feature = "host"))]
mod hostile;
pub mod import;
mod instance;
mod log;
mod make;
mod panics;
#[cfg(feature = "host")]
mod platform;
mod pointers;
mod resources;
#[cfg(all(unix, feature = "host"))]
pub(crate) mod signal;
mod state;
mod symbols;
#[cfg(feature = "host")]
pub mod tire_function;

pub use c::Fmi;
pub use entry::{Entry, guid};
pub use state::Function;
