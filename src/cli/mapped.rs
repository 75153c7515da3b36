//! What the columns of recordings are, as an argument of every command that reads one recording or several.

use latsch::diagnose::Map;
use latsch::recording::{Columns, Recording, read_recording_as};
use latsch::{Error, Result};
use std::path::{Path, PathBuf};

/// How recordings are read.
#[derive(clap::Args)]
pub struct Mapped {
    /// What columns of recordings are: TOML with a table [channels] of "Force (kN)" = { variable = "axle_force_z", unit = "kN" }, or {} for one that is left out; the time's variable is time. Above it, only_named = true leaves out all others
    #[arg(long, value_name = "F.toml")]
    map: Option<PathBuf>,
}

impl Mapped {
    /// # Errors
    /// There is a map and no recording that it could be of.
    pub fn needs(&self, recording: bool, options: &str) -> Result<()> {
        match &self.map {
            Some(_) if !recording => Err(Error::call(format!(
                "--map says what columns of recordings are, and there is none: it needs {options}"
            ))),
            _ => Ok(()),
        }
    }

    /// The file that is read.
    pub fn file(&self) -> Option<&Path> {
        self.map.as_deref()
    }

    /// What is said of columns; nothing without a file.
    ///
    /// # Errors
    /// A file that cannot be read or is no map.
    pub fn columns(&self) -> Result<Columns> {
        Ok(match &self.map {
            Some(file) => Map::read(file)?.columns().clone(),
            None => Columns::default(),
        })
    }

    /// A recording whose columns are what is said of them.
    ///
    /// # Errors
    /// That of the map, or of the recording.
    pub fn recording(&self, path: &Path) -> Result<Recording> {
        read_recording_as(path, &self.columns()?)
    }

    /// The same of several.
    ///
    /// # Errors
    /// That of the map, or of the first recording that has one.
    pub fn recordings(&self, paths: &[PathBuf]) -> Result<Vec<Recording>> {
        let columns = self.columns()?;
        paths.iter().map(|path| read_recording_as(path, &columns)).collect()
    }
}
