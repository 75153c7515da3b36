//! What a unit of somebody else calls its variables.

use crate::model::line_of;
use crate::{Error, Result, read_text};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Names of variables, by those that the shipped models have for them.
pub type Names = BTreeMap<String, String>;

/// Reads names: TOML with a table `[names]` of `"front_left.brake_torque" = "M_B_FL"`.
///
/// # Errors
/// A file that cannot be read or has another form, with its line.
pub fn read_names(path: &Path) -> Result<Names> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct File {
        names: Names,
    }
    let text = read_text(path)?;
    let file: File = toml::from_str(&text).map_err(|e| {
        let line = e.span().map_or(1, |span| line_of(&text, span.start));
        Error::file(format!("{}:{line}: {}", path.display(), e.message()))
    })?;
    Ok(file.names)
}
