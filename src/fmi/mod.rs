//! FMI 2.0 for co-simulation: the C interface of exported models, and the import of any FMU.
//!
//! The only place of `unsafe`.

pub mod c;
#[cfg(feature = "host")]
pub mod import;
