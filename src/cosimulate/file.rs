//! Reading a system from a file of any form.

use super::plan::Plan;
use super::ssd::{parse_ssd, parse_ssd_in_archive};
use super::toml::parse_toml;
use crate::bounded::{self, MAX_TEXT};
use crate::fmi::import::Archive;
use crate::temporary::Folder;
use crate::{Error, Result};
use std::path::{Path, PathBuf};

/// The name of the description in an SSP archive.
pub(super) const IN_ARCHIVE: &str = "SystemStructure.ssd";

/// What a file says, and where its parts lie.
#[derive(Debug)]
pub struct SystemFile {
    /// The system.
    pub plan: Plan,
    /// Where its parts lie: the file's own folder, or that of an unpacked archive. Paths of the plan begin with it, unless the file has absolute
    /// ones.
    pub folder: PathBuf,
    /// An unpacked archive, removed with this value.
    _unpacked: Option<Folder>,
}

/// Reads a system: the short form (`.toml`), a System Structure Description (`.ssd`) or an SSP archive
/// (`.ssp`).
///
/// # Errors
/// A file that cannot be read or has another ending; see [`parse_toml`] and [`parse_ssd`]. An archive
/// whose description names files outside it.
pub fn read_system(path: &Path) -> Result<SystemFile> {
    let name = path.display().to_string();
    let io = |e: String| Error::file(format!("{name} cannot be read: {e}"));
    let folder = path.parent().unwrap_or(Path::new(""));
    match crate::ending(path).as_str() {
        "toml" => {
            let text = bounded::read_text(path, MAX_TEXT).map_err(io)?;
            let plan = parse_toml(&text, &name, folder)?;
            Ok(SystemFile { plan, folder: folder.into(), _unpacked: None })
        }
        "ssd" => {
            let bytes = bounded::read(path, MAX_TEXT).map_err(io)?;
            let plan = parse_ssd(&bytes, &name, folder)?;
            Ok(SystemFile { plan, folder: folder.into(), _unpacked: None })
        }
        "ssp" => {
            std::fs::metadata(path).map_err(|e| io(e.to_string()))?;
            let folder = Archive::open(path)?.unpack()?;
            let description = folder.path().join(IN_ARCHIVE);
            if !description.is_file() {
                return Err(Error::file(format!("{name}: there is no {IN_ARCHIVE}: this is no SSP archive")));
            }
            let place = format!("{name}/{IN_ARCHIVE}");
            let bytes =
                bounded::read(&description, MAX_TEXT).map_err(|e| Error::file(format!("{place}: {e}")))?;
            let plan = parse_ssd_in_archive(&bytes, &place, folder.path())?;
            Ok(SystemFile { plan, folder: folder.path().into(), _unpacked: Some(folder) })
        }
        _ => Err(Error::file(format!("{name}: a system is a .toml, .ssd or .ssp file"))),
    }
}
