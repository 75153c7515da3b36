//! Values for a model from a TOML file: a tire file, or the `resources/model.toml` of an FMU.

use super::{Causality, Interface, Value};
use crate::{Error, Result};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use toml::Spanned;

/// Values that replace start values of a model's variable table.
///
/// As a file:
///
/// ```toml
/// model = "ring-brush-flat-track" # optional in a tire file
/// version = "0.1.0"               # optional in a tire file
///
/// [parameters]
/// belt_mass = 8.8                 # SI units
/// vertical_stiffness = "170 N/mm" # or with a unit, which is converted
///
/// belt_stiffness = { value = 9e4, low = 8e4, high = 1e5 } # as a fit writes it, with its interval
///
/// [inputs]                        # start values of inputs
/// deflection = 0.02
///
/// [fit]                           # what `latsch diagnose` may change; nothing else reads it
/// vertical_stiffness = true
/// belt_mass = { min = 5, max = 15 }
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Settings {
    /// The model that the values are for, if the file says.
    pub model: Option<String>,
    /// The version of the library that wrote the file, if the file says.
    pub version: Option<String>,
    /// Values by name of variable, in the order of the file's sections and names.
    pub values: Vec<Setting>,
    /// Parameters that a fit may change, with their bounds where the file gives them.
    pub fit: Vec<Free>,
}

/// A parameter that a fit may change.
#[derive(Debug, Clone, PartialEq)]
pub struct Free {
    /// Name of the parameter.
    pub name: String,
    /// Smallest and largest value, if given.
    pub range: Option<(f64, f64)>,
    /// `file:line`, for messages.
    pub place: String,
}

/// One entry of the section `fit`.
#[derive(Deserialize)]
#[serde(untagged)]
enum FitEntry {
    Switch(bool),
    Range { min: f64, max: f64 },
}

/// One value and where it came from.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// Name of the variable.
    pub name: String,
    /// Its value.
    pub value: Value,
    /// The section it stood in.
    pub causality: Causality,
    /// `file:line`, for messages.
    pub place: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    model: Option<String>,
    version: Option<String>,
    #[serde(default)]
    parameters: BTreeMap<Spanned<String>, toml::Value>,
    #[serde(default)]
    inputs: BTreeMap<Spanned<String>, toml::Value>,
    #[serde(default)]
    fit: BTreeMap<Spanned<String>, FitEntry>,
    /// What makes a model a corrected one; read by `effect::file`.
    #[serde(default)]
    original: bool,
    #[serde(default)]
    effect: Vec<toml::Value>,
    simulation: Option<toml::Value>,
}

impl Settings {
    /// Reads TOML; `place` names the file in messages.
    ///
    /// # Errors
    /// Not TOML, unknown sections, or values that are neither number, switch nor text. Names and
    /// ranges are checked by [`check`](Settings::check).
    pub fn parse(text: &str, place: &str) -> Result<Self> {
        let (settings, corrected) = Self::parse_corrected(text, place)?;
        match corrected {
            false => Ok(settings),
            true => Err(Error::file(format!(
                "{place}: there are effects ([[effect]]): this is a corrected model, not only parameters; `latsch export` takes it with --effects"
            ))),
        }
    }

    /// As [`parse`](Settings::parse), for a file that may also describe effects; `true` if it does.
    ///
    /// # Errors
    /// As [`parse`](Settings::parse).
    pub(crate) fn parse_corrected(text: &str, place: &str) -> Result<(Self, bool)> {
        let file: File = toml::from_str(text).map_err(|e| {
            let line = e.span().map_or(1, |span| line_of(text, span.start));
            Error::file(format!("{place}:{line}: {}", e.message()))
        })?;
        let lines = Lines::new(text);
        let mut values = Vec::new();
        for (section, causality) in [(file.parameters, Causality::Parameter), (file.inputs, Causality::Input)]
        {
            for (name, value) in section {
                let place = format!("{place}:{}", lines.of(name.span().start));
                let name = name.into_inner();
                let value = fitted(&value)
                    .and_then(Value::from_toml)
                    .map_err(|e| Error::file(format!("{place}: {name} {e}")))?;
                values.push(Setting { name, value, causality, place });
            }
        }
        let mut fit = Vec::new();
        for (name, entry) in file.fit {
            let place = format!("{place}:{}", lines.of(name.span().start));
            let name = name.into_inner();
            let range = match entry {
                FitEntry::Switch(false) => continue,
                FitEntry::Switch(true) => None,
                FitEntry::Range { min, max } if min < max => Some((min, max)),
                FitEntry::Range { min, max } => {
                    return Err(Error::file(format!(
                        "{place}: {name}: min = {min} has to be below max = {max}"
                    )));
                }
            };
            fit.push(Free { name, range, place });
        }
        let corrected = file.original || !file.effect.is_empty();
        if file.simulation.is_some() && !corrected {
            return Err(Error::file(format!(
                "{place}: [simulation] says with which step effects were fitted, and there are none ([[effect]])"
            )));
        }
        Ok((Self { model: file.model, version: file.version, values, fit }, corrected))
    }

    /// Checks the values against a model's interface and gives them with the variables' indices.
    ///
    /// # Errors
    /// Another model, an unknown name, a name in the wrong section, a value that is not accepted.
    pub fn check(&self, interface: &Interface) -> Result<Vec<(usize, Value)>> {
        if let Some(model) = &self.model
            && *model != interface.name
        {
            return Err(Error::file(format!(
                "the values are for the model {model:?}, not for {:?}",
                interface.name
            )));
        }
        let indices: BTreeMap<&str, usize> = match self.values.is_empty() {
            true => BTreeMap::new(),
            // the first of a name, as `find` has it
            false => {
                interface.variables.iter().enumerate().rev().map(|(i, v)| (v.name.as_str(), i)).collect()
            }
        };
        self.values
            .iter()
            .map(|setting| {
                let at = |e: Error| Error::file(e.to_string()).at(&setting.place);
                let index = match indices.get(setting.name.as_str()) {
                    Some(index) => *index,
                    None => interface.find(&setting.name).map_err(at)?,
                };
                let variable = &interface.variables[index];
                if variable.causality != setting.causality {
                    return Err(Error::file(format!(
                        "{}: {} is {}",
                        setting.place,
                        setting.name,
                        match variable.causality {
                            Causality::Parameter => "a parameter; it belongs under [parameters]",
                            Causality::Input => "an input; it belongs under [inputs]",
                            _ => "computed by the model; it cannot be set",
                        }
                    )));
                }
                Ok((index, variable.accept_quantity(&setting.value).map_err(at)?))
            })
            .collect()
    }

    /// The complete file of a model: every parameter and input with its unit and description, with
    /// these settings in place of the table's start values.
    ///
    /// # Errors
    /// As [`check`](Settings::check).
    pub fn to_file(&self, interface: &Interface) -> Result<String> {
        let set: BTreeMap<usize, Value> = self.check(interface)?.into_iter().collect();
        let mut text =
            format!("model = \"{}\"\nversion = \"{}\"\n", interface.name, env!("CARGO_PKG_VERSION"));
        for (section, causality) in [("parameters", Causality::Parameter), ("inputs", Causality::Input)] {
            let _ = write!(text, "\n[{section}]\n");
            for index in interface.with(causality) {
                let variable = &interface.variables[index];
                let value = set.get(&index).or(variable.start.as_ref());
                let Some(value) = value else { continue };
                let value = value.to_toml();
                let unit = variable.unit.as_deref().map(|u| format!(" [{u}]")).unwrap_or_default();
                let _ = writeln!(text, "{} = {value} # {}{unit}", key(&variable.name), variable.description);
            }
        }
        Ok(text)
    }
}

/// The value of a parameter that was fitted and has an interval: `{ value = 8.8, low = 8.1, high = 9.3 }`.
/// The interval is for readers.
fn fitted(value: &toml::Value) -> std::result::Result<&toml::Value, String> {
    let toml::Value::Table(table) = value else { return Ok(value) };
    if let Some(key) = table.keys().find(|k| !matches!(k.as_str(), "value" | "low" | "high")) {
        return Err(format!("has the unknown key {key}; there are value, low, high"));
    }
    table.get("value").ok_or_else(|| "has no value".into())
}

impl Value {
    /// The value as TOML writes it: [`parse`](Settings::parse) reads the same.
    pub fn to_toml(&self) -> String {
        match self {
            Value::Text(text) => toml::Value::String(text.clone()).to_string(),
            other => other.to_string(),
        }
    }

    /// The value in a TOML file: a number, a switch or a text.
    ///
    /// # Errors
    /// Anything else; the message says what it is.
    pub(crate) fn from_toml(value: &toml::Value) -> std::result::Result<Self, String> {
        Ok(match value {
            toml::Value::Float(v) => Value::Real(*v),
            toml::Value::Integer(v) => match i32::try_from(*v) {
                Ok(v) => Value::Integer(v),
                Err(_) => Value::Real(*v as f64),
            },
            toml::Value::Boolean(v) => Value::Boolean(*v),
            toml::Value::String(v) => Value::Text(v.clone()),
            other => {
                return Err(format!("is a {}; a number, true, false or a text is needed", other.type_str()));
            }
        })
    }
}

/// The line, from 1, that a byte is in.
pub(crate) fn line_of(text: &str, offset: usize) -> usize {
    text.as_bytes().iter().take(offset).filter(|b| **b == b'\n').count() + 1
}

/// The same for many bytes of one text: counting anew for each takes minutes for a long file.
pub(crate) struct Lines(Vec<usize>);

impl Lines {
    /// Of this text.
    pub(crate) fn new(text: &str) -> Self {
        Self(text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n').map(|(i, _)| i).collect())
    }

    /// The line, from 1, that a byte is in.
    pub(crate) fn of(&self, offset: usize) -> usize {
        self.0.partition_point(|end| *end < offset) + 1
    }
}

/// A name as a key of TOML: bare where that is allowed.
pub(crate) fn key(name: &str) -> String {
    let bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if !name.is_empty() && name.chars().all(bare) {
        name.into()
    } else {
        toml::Value::String(name.into()).to_string()
    }
}
