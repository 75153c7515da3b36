//! Reports: one HTML file each that opens without a network, prints, and carries its plots inside.
//!
//! A [`Page`] has sections, a section has parts: text, [`Table`], [`Plot`], [`patch_frames`].
//! [`simulation_report`] makes the page of a run, [`stop_page`] that of braking runs with moving patches,
//! [`diagnosis_report`] that of a diagnosis.

mod diagnosis;
mod heat;
mod patch;
mod plot;
mod simulation;
mod stop;

pub use crate::page::{Html, Page, Section, Table};
pub use diagnosis::{CheckRun, diagnosis_report};
pub use heat::{HeatCell, HeatMap};
pub use patch::{Cell, PatchFrame, patch_caption, patch_frames};
pub use plot::{Axis, Plot, Size, Tone};
pub use simulation::simulation_report;
pub use stop::{StopFigures, StopRun, StopScene, stop_page};

use crate::Result;
use std::path::Path;

/// Writes a page to a file, as a whole or not at all.
///
/// # Errors
/// Any failure of the file system, with the path.
pub fn write_html(path: &Path, html: &str) -> Result<()> {
    crate::file::write_whole(path, |file| file.write_all(html.as_bytes()))
}
