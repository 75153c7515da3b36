//! A tire property file as parameters of a model.

use super::document::{by_section, counted};
use super::{Document, MAX_BYTES, Side, magic_formula, read, super_elastic};
use crate::bounded;
use crate::model::{Causality, Interface, Setting, Settings, Value};
use crate::tire::Tire;
use crate::tire::magic_formula::{FIELDS, MagicFormula};
use crate::tire::super_elastic::SuperElastic;
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

/// The tire that a file is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The Magic Formula 5.2.
    MagicFormula,
    /// The super-elastic tire.
    SuperElastic,
}

impl Kind {
    /// Whether models with this tire have a parameter of that name from it.
    fn has(self, name: &str) -> bool {
        match self {
            Self::MagicFormula => FIELDS.iter().any(|field| field.name == name),
            Self::SuperElastic => super_elastic::has(name),
        }
    }

    /// What of some settings is no parameter of this tire, for whom a file of it is written.
    ///
    /// # Errors
    /// Parameters of another tire, or none of this one: such a file would have other values than those that are meant.
    fn foreign(self, own: &Settings, document: &str) -> Result<Option<String>> {
        let title = self.title();
        let (known, others): (Vec<&Setting>, Vec<&Setting>) =
            own.values.iter().partition(|setting| self.has(&setting.name));
        let other_kind = match self {
            Self::MagicFormula => Self::SuperElastic,
            Self::SuperElastic => Self::MagicFormula,
        };
        if let Some(setting) = others.iter().find(|setting| other_kind.has(&setting.name)) {
            return Err(Error::call(format!(
                "{}: {} is a parameter of a {}, and {document} is the file of a {title}; name one of the same tire",
                setting.place,
                setting.name,
                other_kind.title()
            )));
        }
        let Some(first) = others.first() else { return Ok(None) };
        if known.is_empty() {
            return Err(Error::call(format!(
                "{}: {} and all others there are no parameters of a {title}, of which {document} is the file; name parameters of that tire",
                first.place, first.name
            )));
        }
        let names: Vec<&str> = others.iter().take(20).map(|setting| setting.name.as_str()).collect();
        let more = match others.len() - names.len() {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        Ok(Some(format!("what is no parameter of a {title}: {}{more}", names.join(", "))))
    }

    /// What a document is of: the super-elastic tire if it calls `TYR501`, otherwise the Magic Formula, of which
    /// [`read`] says whether it is one that is modelled.
    pub fn of(document: &Document) -> Self {
        match super_elastic::is_one(document) {
            true => Self::SuperElastic,
            false => Self::MagicFormula,
        }
    }

    /// The name that models with this tire begin with: `super-elastic`.
    pub fn name(self) -> &'static str {
        match self {
            Self::MagicFormula => MagicFormula::NAME,
            Self::SuperElastic => SuperElastic::NAME,
        }
    }

    /// What messages call it.
    pub fn title(self) -> &'static str {
        match self {
            Self::MagicFormula => "Magic Formula tire",
            Self::SuperElastic => "super-elastic tire",
        }
    }
}

/// What a tire property file gives.
#[derive(Debug, Clone, PartialEq)]
pub struct TireFile {
    /// The tire that it is of.
    pub kind: Kind,
    /// The parameters of models with that tire.
    pub settings: Settings,
    /// What the user should know: sentences with file and line.
    pub notes: Vec<String>,
}

impl TireFile {
    /// Checks that a model has this tire: all of the file's parameters.
    ///
    /// # Errors
    /// It has not; the message says which models have.
    pub fn check_fits(&self, interface: &Interface) -> Result<()> {
        let lacks = self.settings.values.iter().find(|setting| interface.index(&setting.name).is_none());
        match lacks {
            None => Ok(()),
            Some(setting) => Err(Error::call(format!(
                "{} is the file of a {}, and {} has no such tire (no parameter {}); models that take it are called {}-...",
                match setting.place.rsplit_once(':') {
                    Some((file, _)) => file,
                    None => &setting.place,
                },
                self.kind.title(),
                interface.name,
                setting.name,
                self.kind.name()
            ))),
        }
    }
}

/// The parameters of a model that the file at `path` gives, and what the user should know about them: of a Magic Formula tire
/// (`magic-formula-wheel` and others) or of a super-elastic one (`super-elastic-wheel` and others).
///
/// Every coefficient of the Magic Formula that an equation uses gets a value: a key that the file does not have, that of its absence.
///
/// # Errors
/// The file cannot be read, is of neither tire, or has values that are none.
pub fn settings(path: &Path) -> Result<TireFile> {
    let document = Document::open(path)?;
    let kind = Kind::of(&document);
    let (mut settings, notes) = match kind {
        Kind::MagicFormula => magic_formula_settings(&document)?,
        Kind::SuperElastic => super_elastic::read(&document)?,
    };
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    settings.values.push(Setting {
        name: "tire_name".into(),
        value: Value::Text(name),
        causality: Causality::Parameter,
        place: document.name().into(),
    });
    Ok(TireFile { kind, settings, notes })
}

fn magic_formula_settings(document: &Document) -> Result<(Settings, Vec<String>)> {
    let reading = read(document)?;
    let place_of = |section: &str, key: &str| match document.get(section, key) {
        Some(entry) => document.place(entry.line),
        None => document.name().into(),
    };
    let values: Vec<Setting> = FIELDS
        .iter()
        .filter(|field| field.is_used())
        .map(|field| Setting {
            name: field.name.into(),
            value: Value::Real((field.get)(&reading.coefficients)),
            causality: Causality::Parameter,
            place: place_of(field.section, field.name),
        })
        .collect();
    let mut notes = reading.notes;
    let section = |key: &&str| FIELDS.iter().find(|f| f.name == *key).map_or("", |f| f.section);
    for (section, keys) in by_section(reading.missing.iter().map(|key| (section(key), *key))) {
        notes.push(format!(
            "{}: [{section}] lacks {}, whose terms are left out: {keys}",
            document.name(),
            counted(&keys)
        ));
    }
    notes.extend(document.unused_keys(&reading.unused));
    if let Some(side) = reading.side {
        let said = match side {
            Side::Left => {
                "one for the left side, as a vehicle takes it; for a wheel on the right set mirrored = true under [parameters]"
            }
            Side::Right => {
                "one for the right side; for a wheel on the left, and for a vehicle, whose tires are given as those of its left side, set mirrored = true under [parameters]"
            }
        };
        notes.push(format!("{}: the tire is {said}", document.name()));
    }
    Ok((Settings { values, ..Settings::default() }, notes))
}

/// Writes parameters of a model into a document of its tire, in the document's units, and changes nothing else. Returns how many
/// values differ from what was there, and what the format has no place for, names that are not the tire's among it.
///
/// # Errors
/// Parameters of another tire than the document's, or none of that; a value that the tire does not take, with its place; a document
/// that cannot be read.
pub fn change(document: &mut Document, own: &Settings) -> Result<(usize, Vec<String>)> {
    let kind = Kind::of(document);
    let foreign = kind.foreign(own, document.name())?;
    let (count, mut lost) = match kind {
        Kind::SuperElastic => super_elastic::write(own, document)?,
        Kind::MagicFormula => {
            let mut coefficients = read(document)?.coefficients;
            for setting in &own.values {
                let Some(field) = FIELDS.iter().find(|field| field.name == setting.name) else { continue };
                let value = match &setting.value {
                    Value::Real(value) => *value,
                    Value::Integer(value) => f64::from(*value),
                    Value::Text(text) => {
                        crate::model::unit::quantity(text, field.unit).map_err(|e| e.at(&setting.place))?
                    }
                    Value::Boolean(_) => {
                        return Err(Error::file(format!("{}: {} is a number", setting.place, setting.name)));
                    }
                };
                (field.set)(&mut coefficients, value);
            }
            (magic_formula::write(&coefficients, document)?, Vec::new())
        }
    };
    lost.extend(foreign);
    Ok((count, lost))
}

/// A property file of the super-elastic tire from parameters of a model, those that are not given with their defaults. Returns
/// also what the format has no place for. `name` is what messages call it, `title` becomes a comment.
///
/// # Errors
/// As [`change`].
pub fn create_super_elastic(
    own: &Settings,
    rim_mass: Option<f64>,
    name: &str,
    title: &str,
) -> Result<(Document, Vec<String>)> {
    let mut document = super_elastic::create(name, title)?;
    // the rubber's mass is written on top of it
    document.set_number("RIM", "WEIGHT_RIM", rim_mass.unwrap_or(0.0))?;
    let (_, mut lost) = change(&mut document, own)?;
    if rim_mass.is_none() {
        lost.push(
            "the mass of the rim: it is in the hub's, so WEIGHT_RIM is 0 and WEIGHT is the rubber's".into(),
        );
    }
    Ok((document, lost))
}
