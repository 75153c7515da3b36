//! A tire property file as parameters of a model.

use super::{Document, MAX_BYTES, Side, read};
use crate::bounded;
use crate::model::{Causality, Setting, Settings, Value};
use crate::tire::magic_formula::FIELDS;
use crate::{Error, Result};
use std::path::Path;

impl Document {
    /// Reads the file at `path`.
    ///
    /// # Errors
    /// The file cannot be read, is too long, or is no text of this kind.
    pub fn open(path: &Path) -> Result<Self> {
        let bytes = bounded::read(path, MAX_BYTES as u64)
            .map_err(|e| Error::file(format!("{}: {e}", path.display())))?;
        Self::parse(bytes, &path.display().to_string())
    }
}

/// The parameters of a model with a Magic Formula tire (`magic-formula-wheel` and others) that the file at `path` gives, and
/// what the user should know about them.
///
/// Every coefficient that an equation uses gets a value: a key that the file does not have, that of its absence.
///
/// # Errors
/// The file cannot be read, or is no tire of the Magic Formula 5.2.
pub fn settings(path: &Path) -> Result<(Settings, Vec<String>)> {
    let document = Document::open(path)?;
    let reading = read(&document)?;
    let place_of = |section: &str, key: &str| match document.get(section, key) {
        Some(entry) => document.place(entry.line),
        None => document.name().into(),
    };
    let setting = |name: &str, value: Value, place: String| Setting {
        name: name.into(),
        value,
        causality: Causality::Parameter,
        place,
    };
    let mut values: Vec<Setting> = FIELDS
        .iter()
        .filter(|field| field.is_used())
        .map(|field| {
            let value = Value::Real((field.get)(&reading.coefficients));
            setting(field.name, value, place_of(field.section, field.name))
        })
        .collect();
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    values.push(setting("tire_name", Value::Text(name), document.name().into()));
    let mut notes = reading.notes;
    if !reading.missing.is_empty() {
        notes.push(format!(
            "{}: {} keys are missing, their terms are left out: {}",
            document.name(),
            reading.missing.len(),
            reading.missing.join(", ")
        ));
    }
    if !reading.unused.is_empty() {
        notes.push(format!(
            "{}: {} keys are not used by the model: {}",
            document.name(),
            reading.unused.len(),
            reading.unused.join(", ")
        ));
    }
    if let Some(side) = reading.side {
        let (is, other) = match side {
            Side::Left => ("left", "right"),
            Side::Right => ("right", "left"),
        };
        notes.push(format!(
            "{}: the tire is one for the {is} side; for a wheel on the {other} set mirrored = true under [parameters]",
            document.name()
        ));
    }
    Ok((Settings { values, ..Settings::default() }, notes))
}
