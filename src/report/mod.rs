//! Reports: one HTML file each that opens without a network, prints, and carries its plots inside.
//!
//! A [`Page`] has sections, a section has parts: text, [`Table`], [`Plot`], [`patch_frames`].
//! [`simulation_report`] makes the page of a run.

mod patch;
mod plot;
mod simulation;

pub use crate::page::{Html, Page, Section, Table};
pub use patch::{Cell, PatchFrame, patch_caption, patch_frames};
pub use plot::{Axis, Plot, Size};
pub use simulation::simulation_report;

use crate::Result;
use std::path::Path;

/// Writes a page to a file, as a whole or not at all.
///
/// # Errors
/// Any failure of the file system, with the path.
pub fn write_html(path: &Path, html: &str) -> Result<()> {
    crate::file::write_whole(path, |file| file.write_all(html.as_bytes()))
}
