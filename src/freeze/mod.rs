//! What a wired system is made of, as a list that can be kept and compared with: which sub-models, which files with
//! which bytes, which values, which connections.
//!
//! Sub-models of a virtual prototype are exchanged at fixed dates, by parameter files and controller blocks (G. Mack 2009,
//! section 7.2): a result is worth what is known of the freeze that it comes from.

mod differ;
mod manifest;
mod stamp;
mod taken;

pub use differ::{Difference, differences};
pub use manifest::{Connection, Driven, Manifest, Pair, Part, Structure, read_manifest};
pub use stamp::Stamp;
pub use taken::freeze;
