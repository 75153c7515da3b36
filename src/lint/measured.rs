//! What was measured on the standing or freely rolling machine, beside what the system has at its start.

use super::{Remark, View};
use crate::cosimulate::PortName;
use crate::model::unit::quantity;
use crate::{Error, Result, read_text};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

const TOPIC: &str = "measured values";
/// How far apart a value without a `within` may be, as a share of it: scales repeat to less, and a car's load changes by more
/// with a tank of fuel.
const APART: f64 = 0.02;

/// A measured value.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// What it is in the system: an output at the start, or a parameter.
    pub variable: PortName,
    /// The value, with a unit or in the variable's own.
    pub value: String,
    /// How far away the system may be, with a unit, or as a share in %; `None`: 2 %.
    pub within: Option<String>,
    /// Where it stands in the file.
    pub place: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    measured: BTreeMap<String, Entry>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Entry {
    Number(f64),
    Text(String),
    Whole(Whole),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Whole {
    value: Quantity,
    within: Option<Quantity>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Quantity {
    Number(f64),
    Text(String),
}

impl Quantity {
    fn text(self) -> String {
        match self {
            Self::Number(number) => number.to_string(),
            Self::Text(text) => text,
        }
    }
}

/// Reads a file of measured values: a table `[measured]` with `"component.variable" = "3350 N"`, or
/// `{ value = "0.7 deg", within = "0.05 deg" }`.
///
/// # Errors
/// A file that cannot be read or says something else.
pub fn read_measured(path: &Path) -> Result<Vec<Measured>> {
    let source = path.display().to_string();
    let text = read_text(path)?;
    let file: File = toml::from_str(&text).map_err(|e| Error::file(format!("{source}: {}", e.message())))?;
    file.measured
        .into_iter()
        .map(|(name, entry)| {
            let place = format!("{source}: {name:?}");
            let variable = name.parse().map_err(|e: String| Error::file(format!("{place}: {e}")))?;
            let (value, within) = match entry {
                Entry::Number(number) => (number.to_string(), None),
                Entry::Text(text) => (text, None),
                Entry::Whole(whole) => (whole.value.text(), whole.within.map(Quantity::text)),
            };
            Ok(Measured { variable, value, within, place })
        })
        .collect()
}

/// Each measured value beside the system's.
///
/// # Errors
/// A variable that is not there or no number, a value in another unit.
pub(super) fn compared(view: &View<'_>, measured: &[Measured]) -> Result<Vec<Remark>> {
    if measured.is_empty() {
        return Ok(vec![Remark::open(
            TOPIC,
            "static loads, toe and camber of an alignment rig, mass and inertia of measuring rims: give them with --measured",
        )]);
    }
    measured
        .iter()
        .map(|one| {
            let at = |e: Error| e.at(&one.place);
            let port = view.system.port(&one.variable.component, &one.variable.variable).map_err(at)?;
            let info = view.system.info(port);
            let unit = info.unit.as_deref().unwrap_or("1");
            let wanted = quantity(&one.value, unit).map_err(at)?;
            let within = match &one.within {
                None => APART * wanted.abs(),
                Some(text) => match text.trim().strip_suffix('%') {
                    Some(share) => 0.01 * quantity(share, "1").map_err(at)? * wanted.abs(),
                    None => quantity(text, unit).map_err(at)?,
                },
            };
            let parameter = view.parameters.get(&port).copied();
            let here = parameter.or_else(|| view.course(port, unit).map(|values| values[0]));
            let here = here.ok_or_else(|| at(Error::variable(format!("{} is no number", view.name(port)))))?;
            let text = format!(
                "{} is {here:.5} {unit} at the start, measured {wanted:.5} {unit}: {:+.3} {unit}, {within:.3} {unit} are allowed",
                view.name(port),
                here - wanted
            );
            Ok(Remark::judged((here - wanted).abs() <= within, TOPIC, text))
        })
        .collect()
}
