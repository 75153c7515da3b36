//! Reading a system from a file of any form.

use super::plan::Plan;
use super::ssd::parse_ssd;
use super::toml::parse_toml;
use crate::fmi::import::Archive;
use crate::{Error, Result};
use std::path::Path;
use tempfile::TempDir;

/// The name of the description in an SSP archive.
const IN_ARCHIVE: &str = "SystemStructure.ssd";

/// What a file says, and where its parts lie.
#[derive(Debug)]
pub struct SystemFile {
    /// The system.
    pub plan: Plan,
    /// An unpacked archive, removed with this value.
    _folder: Option<TempDir>,
}

/// Reads a system: the short form (`.toml`), a System Structure Description (`.ssd`) or an SSP archive
/// (`.ssp`).
///
/// # Errors
/// A file that cannot be read or has another ending; see [`parse_toml`] and [`parse_ssd`].
pub fn read_system(path: &Path) -> Result<SystemFile> {
    let name = path.display().to_string();
    let io = |e: std::io::Error| Error::file(format!("{name} cannot be read: {e}"));
    let folder = path.parent().unwrap_or(Path::new(""));
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    match ending.as_str() {
        "toml" => {
            let text = std::fs::read_to_string(path).map_err(io)?;
            Ok(SystemFile { plan: parse_toml(&text, &name, folder)?, _folder: None })
        }
        "ssd" => {
            let bytes = std::fs::read(path).map_err(io)?;
            Ok(SystemFile { plan: parse_ssd(&bytes, &name, folder)?, _folder: None })
        }
        "ssp" => {
            std::fs::metadata(path).map_err(io)?;
            let folder = Archive::open(path)?.unpack()?;
            let bytes = std::fs::read(folder.path().join(IN_ARCHIVE)).map_err(|_| {
                Error::file(format!("{name}: there is no {IN_ARCHIVE}: this is no SSP archive"))
            })?;
            let plan = parse_ssd(&bytes, &format!("{name}/{IN_ARCHIVE}"), folder.path())?;
            Ok(SystemFile { plan, _folder: Some(folder) })
        }
        _ => Err(Error::file(format!("{name}: a system is a .toml, .ssd or .ssp file"))),
    }
}
