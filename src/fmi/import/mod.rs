//! The master side of FMI 2.0: any co-simulation FMU as a [`Slave`](crate::model::Slave).
//!
//! [`ImportedFmu::load`] unpacks the archive, reads the description, loads the binary and makes an
//! instance of it. What comes in the archive is not trusted until the binary is loaded; whoever runs
//! an FMU runs foreign code.

pub(super) mod archive;
mod description;
mod instance;
pub(super) mod library;
pub(super) mod log;
pub(super) mod slave;
pub(crate) mod xml;

pub use archive::{Archive, Limits, MAX_ENTRIES, MAX_UNPACKED};
pub use description::{Capabilities, Description, Experiment, MAX_LENGTH};
pub use log::Message;
pub use slave::ImportedFmu;
