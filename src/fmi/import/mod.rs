//! The master side of FMI 2.0: any co-simulation FMU as a [`Slave`](crate::model::Slave).
//!
//! `ImportedFmu::load` unpacks the archive, reads the description, loads the binary and makes an
//! instance of it. What comes in the archive is not trusted until the binary is loaded; whoever runs
//! an FMU runs foreign code.

//!
//! What reads archives and XML is behind the feature `host`. The rest goes into FMUs: one that carries
//! another FMU loads it from its own resources.

#[cfg(feature = "host")]
pub(super) mod archive;
mod description;
#[cfg(target_os = "linux")]
pub(super) mod elf;
mod instance;
pub(super) mod library;
pub(super) mod log;
mod printf;
#[cfg(feature = "host")]
mod reader;
pub(super) mod slave;
#[cfg(feature = "host")]
pub(crate) mod xml;

#[cfg(feature = "host")]
pub use archive::{Archive, Limits, MAX_ENTRIES, MAX_UNPACKED};
#[cfg(feature = "host")]
pub(in crate::fmi) use description::ANNOTATIONS;
pub use description::{Capabilities, Description, Experiment};
pub use log::Message;
#[cfg(feature = "host")]
pub use reader::MAX_LENGTH;
pub use slave::ImportedFmu;
