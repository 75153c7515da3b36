//! Writes cases and answers.

use crate::draw::draw;
use crate::flat_track::rig::session;
use crate::recording::{Recorded, record};
use serde::Serialize;
use std::path::Path;

/// A case of a study, simulated.
///
/// # Errors
/// A case that does not exist or cannot be drawn, or a machine that left what its equations are good for.
pub fn case(seed: u64, number: usize) -> Result<Recorded, String> {
    let recorded = record(&draw(seed, number)?);
    let mut squares = recorded.reference.runs.iter().flat_map(|run| &run.channels);
    match squares.find(|(_, square)| !square.is_finite()) {
        None => Ok(recorded),
        Some((channel, _)) => Err(format!("{}: {channel} is not finite", recorded.answer.case)),
    }
}

/// Writes what a rig records of a tire along a measurement programme, and the truth beside it.
///
/// # Errors
/// A programme that cannot be read, a tire that cannot be driven, or a folder that cannot be written.
pub fn write_session(seed: u64, number: u64, programme: &Path, folder: &Path) -> Result<(), String> {
    let session = session(seed, number, programme)?;
    for (name, content) in session.files {
        write(&folder.join("recordings").join(name), &content)?;
    }
    write_json(&folder.join("truth.json"), &session.truth)
}

/// Writes what can be told as JSON.
///
/// # Errors
/// A place that cannot be written.
pub(crate) fn write_json(path: &Path, value: &impl Serialize) -> Result<(), String> {
    let text = serde_json::to_string_pretty(value).map_err(|e| format!("{}: {e}", path.display()))?;
    write(path, &(text + "\n"))
}

/// Writes a file, with the folders above it.
///
/// # Errors
/// A place that cannot be written.
pub fn write(path: &Path, content: &str) -> Result<(), String> {
    let folder = path.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder)
        .and_then(|()| std::fs::write(path, content))
        .map_err(|e| format!("{} cannot be written: {e}", path.display()))
}
