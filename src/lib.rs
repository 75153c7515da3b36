//! Physical tire and rig models as FMI 2.0 co-simulation units.
//!
//! See ARCHITECTURE.md for the map of the code. SI units inside and at every interface; signs and
//! axes at every interface are ISO 8855 / TYDEX (C, H, W).
#![deny(unsafe_code)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]
// Elementary functions of the C library (clippy.toml) are for what never runs in an FMU: the modules under the feature
// "host", and tests. Without that feature this holds for the whole library.
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]
#![cfg_attr(test, allow(clippy::disallowed_methods))]

mod bounded;
#[cfg(feature = "host")]
#[allow(clippy::disallowed_methods)] // host only
pub mod causes;
#[cfg(feature = "host")]
#[allow(clippy::disallowed_methods)] // host only
pub mod characteristic;
#[cfg(feature = "host")]
#[allow(clippy::disallowed_methods)] // host only
pub mod comparison;
pub mod control;
#[cfg(feature = "host")]
#[allow(clippy::disallowed_methods)] // host only
pub mod cosimulate;
#[cfg(feature = "host")]
#[allow(clippy::disallowed_methods)] // host only
pub mod curves;
#[cfg(feature = "host")]
#[allow(clippy::disallowed_methods)] // host only
pub mod diagnose;
pub mod effect;
mod error;
#[cfg(feature = "host")]
#[allow(clippy::disallowed_methods)] // host only
mod file;
#[cfg(feature = "host")]
#[allow(clippy::disallowed_methods)] // host only
pub mod fit;
#[allow(unsafe_code)]
pub mod fmi;
#[cfg(feature = "host")]
#[allow(clippy::disallowed_methods)] // host only
pub mod freeze;
#[cfg(feature = "host")]
#[allow(clippy::disallowed_methods)] // host only
pub mod identify;
#[cfg(feature = "host")]
#[allow(clippy::disallowed_methods)] // host only
pub mod lint;
#[cfg(feature = "host")]
#[allow(clippy::disallowed_methods)] // host only
pub mod loads;
#[cfg(feature = "host")]
#[allow(clippy::disallowed_methods)] // host only
pub mod manoeuvre;
pub mod mechanics;
pub mod model;
#[cfg(feature = "host")]
#[allow(clippy::disallowed_methods)] // host only
mod page;
#[cfg(feature = "host")]
#[allow(clippy::disallowed_methods)] // host only
pub mod recording;
#[cfg(feature = "host")]
#[allow(clippy::disallowed_methods)] // host only
pub mod report;
pub mod rig;
pub mod road;
#[cfg(feature = "host")]
#[allow(clippy::disallowed_methods)] // host only
pub mod road_file;
pub mod shipped;
mod shown;
#[cfg(feature = "host")]
#[allow(clippy::disallowed_methods)] // host only
pub mod simulate;
pub mod solver;
pub mod stats;
#[cfg(feature = "host")]
pub mod temporary;
#[cfg(feature = "host")]
pub mod tir;
pub mod tire;
#[cfg(feature = "host")]
#[allow(clippy::disallowed_methods)] // host only
pub mod tire_function;

pub use error::{Error, ErrorKind, Result};
#[cfg(feature = "host")]
pub use file::{ending, read_text, write_file};
pub use shown::{one_line, printable, printable_json, with_unit};

/// The version of the library: part of every FMU's GUID.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
