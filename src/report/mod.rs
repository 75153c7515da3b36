//! Reports: one HTML file each that opens without a network, prints, and carries its plots inside.
//!
//! A [`Page`] has sections, a section has parts: text, [`Table`], [`Plot`], [`patch_frames`].
//! [`simulation_report`] makes the page of a run, [`diagnosis_report`] that of a
//! diagnosis, [`identification_report`] that of an identification, [`characteristic_report`] that of a characterization, [`plan_report`] that of a plan's check, [`loads_report`] that of loads, [`curves_report`] that of a tire's curves. Whoever makes a page of
//! their own with drawings of patches has their scales in [`Picture`].

mod causes;
mod channels;
mod characteristic;
mod compared;
mod curves;
mod diagnosis;
mod heat;
mod identification;
mod influence;
mod loads;
mod patch;
mod plan;
mod plot;
mod scale;
mod shade;
mod short;
mod simulation;

pub use crate::page::{Html, Page, Section, Table, escape};
pub use causes::causes_report;
pub use characteristic::characteristic_report;
pub use curves::curves_report;
pub use diagnosis::{CheckRun, diagnosis_report};
pub use heat::{HeatCell, HeatMap};
pub use identification::identification_report;
pub use loads::loads_report;
pub use patch::{PULLING, PatchFrame, Picture, SLIDING, patch_caption, patch_frames, pressure_color};
pub use plan::plan_report;
pub use plot::{Axis, Plot, Size, Tone};
pub use simulation::{Beside, Names, simulation_report};

use crate::Result;
use std::path::Path;

/// Writes a page to a file, as a whole or not at all.
///
/// # Errors
/// Any failure of the file system, with the path.
pub fn write_html(path: &Path, html: &str) -> Result<()> {
    crate::file::write_whole(path, |file| file.write_all(html.as_bytes()))
}
