//! [`Manifest`]: the list, and its form as a file.

use super::stamp::Stamp;
use crate::model::line_of;
use crate::{Error, Result, read_text};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// What a system is made of. The same system gives the same text: names are sorted, there is no time and no place in it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// The version of latsch, which the shipped models belong to.
    pub latsch: String,
    /// The file of the system, and how it is run.
    pub system: Structure,
    /// The components by name.
    pub component: BTreeMap<String, Part>,
    /// The connections, by the input that they lead to.
    #[serde(default)]
    pub connection: BTreeMap<String, Connection>,
    /// Inputs that follow recordings, by their names.
    #[serde(default)]
    pub input: BTreeMap<String, Driven>,
    /// Pairs whose energy is watched, if the file names them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bond: Vec<Pair>,
}

/// The system as a whole.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Structure {
    /// Its file.
    #[serde(flatten)]
    pub file: Stamp,
    /// Communication step \[s\], if the file has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step: Option<f64>,
    /// Start \[s\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<f64>,
    /// Stop \[s\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stop: Option<f64>,
    /// Components in the order in which they are stepped; side by side if there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub order: Option<Vec<String>>,
    /// How often an interval is repeated at most.
    pub iterate: usize,
    /// How often an interval is halved at most.
    pub halvings: u32,
    /// Communication points per sample.
    pub record_every: usize,
}

/// A component.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// The shipped model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<String>,
    /// The name that the FMU's model has.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model_name: Option<String>,
    /// The FMU's GUID.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub guid: Option<String>,
    /// The tool that made the FMU, if that says so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub generation_tool: Option<String>,
    /// The FMU's file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fmu: Option<Stamp>,
    /// The file of the model's parameters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub parameters: Option<Stamp>,
    /// What all parameters are, and all inputs that nothing drives, with their units.
    #[serde(default)]
    pub values: BTreeMap<String, toml::Value>,
}

/// Where an input has its values from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Connection {
    /// The output.
    pub from: String,
    /// What the output is multiplied by.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub factor: Option<f64>,
    /// What is added then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub offset: Option<f64>,
    /// The numbers are taken as they are, whatever the units.
    #[serde(default, skip_serializing_if = "is_not")]
    pub keep_units: bool,
    /// Linear within an interval instead of held.
    #[serde(default, skip_serializing_if = "is_not")]
    pub derivative: bool,
}

/// A recording that an input follows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Driven {
    /// The channel.
    pub channel: String,
    /// Linear within an interval instead of held.
    #[serde(default, skip_serializing_if = "is_not")]
    pub derivative: bool,
    /// The file.
    #[serde(flatten)]
    pub recording: Stamp,
}

/// An effort and a motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pair {
    /// The force or moment.
    pub effort: String,
    /// What goes the other way.
    pub motion: String,
    /// The motion is a place and no velocity.
    pub displacement: bool,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde calls it so")]
fn is_not(switch: &bool) -> bool {
    !switch
}

const HEAD: &str = "# What a system is made of, written by `latsch freeze`. `latsch freeze SYSTEM --against` this file says what has changed.\n\
# Names of files are seen from the system's file.\n\n";

impl Manifest {
    /// The text of the file.
    ///
    /// # Errors
    /// A value that TOML has no form for.
    pub fn to_toml(&self) -> Result<String> {
        let text = toml::to_string(self).map_err(|e| Error::file(format!("the manifest: {e}")))?;
        Ok(format!("{HEAD}{text}"))
    }
}

/// Reads a manifest.
///
/// # Errors
/// A file that cannot be read or is no manifest, with its line.
pub fn read_manifest(path: &Path) -> Result<Manifest> {
    let text = read_text(path)?;
    toml::from_str(&text).map_err(|e| {
        let line = e.span().map_or(1, |span| line_of(&text, span.start));
        Error::file(format!(
            "{}:{line}: this is no manifest of `latsch freeze`: {}",
            path.display(),
            e.message()
        ))
    })
}
