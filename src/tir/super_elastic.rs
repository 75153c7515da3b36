//! The super-elastic tire of a property file: `PROPERTY_FILE_FORMAT = 'USER'`, `FUNCTION_NAME = 'TYR501'` (Oh 2017, 5.2.2).

use super::document::{Document, Entry, Value, number_text, shown};
use super::magic_formula::in_units;
use super::units::Units;
use crate::model::{self, Causality, Kind, Setting, Settings, VariableInfo};
use crate::tire::Tire;
use crate::tire::magic_formula::Dimension;
use crate::tire::super_elastic::SuperElastic;
use crate::{Error, Result};

/// What of the units of a file changes a value.
#[derive(Clone, Copy)]
enum Scale {
    /// Powers of the units.
    Of(Dimension),
    /// Always kN, whatever `[UNITS]` says: the source gives 5 beside newtons, and 5 N would be no slip stiffness.
    Kilonewton,
    /// Force over a power of length; the model has the force at 1 mm.
    AtOneMillimetre,
}

/// A key and the parameter that it gives.
struct Key {
    section: &'static str,
    name: &'static str,
    parameter: &'static str,
    scale: Scale,
    /// Whether a file without it is no tire. Of the others the model has defaults.
    required: bool,
}

const fn key(
    section: &'static str,
    name: &'static str,
    parameter: &'static str,
    scale: Scale,
    required: bool,
) -> Key {
    Key { section, name, parameter, scale, required }
}

const LENGTH: Scale = Scale::Of(Dimension::LENGTH);
const NUMBER: Scale = Scale::Of(Dimension::NONE);
const STIFFNESS: Scale = Scale::Of(Dimension { force: 1, length: -1, ..Dimension::NONE });
const DAMPING: Scale = Scale::Of(Dimension { force: 1, length: -1, time: 1, ..Dimension::NONE });
const ANGLE: Scale = Scale::Of(Dimension::ANGLE);

/// The keys that become parameters one by one. `NUM_CP` is no key of the source, which has none for the contact points.
const KEYS: &[Key] = &[
    key("DIMENSION", "UNLOADED_RADIUS", "tire_radius", LENGTH, true),
    key("DIMENSION", "WIDTH", "tire_width", LENGTH, false),
    key("CONTACTELEMENT", "NUM_CE", "elements", NUMBER, true),
    key("CONTACTELEMENT", "LEN_CE", "element_thickness", LENGTH, true),
    key("CONTACTELEMENT", "ANG_INSIDE_CE", "gap_angle", ANGLE, true),
    key("CONTACTELEMENT", "NUM_CP", "contact_points", NUMBER, false),
    key("PARAMETER", "RADIAL_STIFFNESS", "element_radial_stiffness", STIFFNESS, true),
    key("PARAMETER", "RADIAL_DAMPING", "element_radial_damping", DAMPING, true),
    key("PARAMETER", "ROLLING_RESISTANCE", "rolling_resistance", NUMBER, true),
    key("PARAMETER", "CSLIP", "slip_stiffness", Scale::Kilonewton, true),
    key("PARAMETER", "UMIN", "friction_min", NUMBER, true),
    key("PARAMETER", "UMAX", "friction_max", NUMBER, true),
    key("PARAMETER", "REL_LEN_LON", "relaxation_length", LENGTH, true),
    key("CONTACT_COEFFICIENTS", "EXPONENT", "contact_exponent", NUMBER, true),
    key("CONTACT_COEFFICIENTS", "STIFFNESS", "contact_stiffness", Scale::AtOneMillimetre, true),
    key("CONTACT_COEFFICIENTS", "DAMPING", "contact_damping", DAMPING, true),
    key("CONTACT_COEFFICIENTS", "PENETRATION", "contact_full_damping", LENGTH, true),
];

/// The masses, of which the model has the difference: what is rubber.
const WEIGHT: (&str, &str) = ("DIMENSION", "WEIGHT");
const WEIGHT_RIM: (&str, &str) = ("RIM", "WEIGHT_RIM");
const RUBBER: &str = "rubber_mass";
/// The factor on the curve of the stiffness.
const FACTOR: (&str, &str) = ("PARAMETER", "COR_FACTOR_RSTIFF");
const FACTOR_PARAMETER: &str = "stiffness_factor";

/// Keys that are known and change nothing, with the reason.
const KNOWN: &[(&str, &str, &str)] = &[
    ("MODEL", "NUM_INT_METHODE", "the model has its own integration"),
    ("MODEL", "SIM_TIME", "the length of a run is the run's"),
    ("MODEL", "SIM_STEPSIZE", "the step is the rig's step_size"),
    ("MODEL", "USE_MODE", "the model starts in a stationary state, so no force has to be let in slowly"),
    ("MODEL", "FREE_ROLL", "whether a wheel is driven is the rig's"),
    ("DIMENSION", "ASPECT_RATIO", "no equation uses it"),
    ("RIM", "NUM_RIM", "no equation uses it"),
    ("RIM", "RADIUS_RIM", "no equation uses it"),
    ("CONTACTELEMENT", "DIS_LAYER", "the source does not say what it is"),
    ("CONTACTELEMENT", "NUM_LAYER", "the source does not say what it is"),
    ("CONTACT_COEFFICIENTS", "MU", "friction is that of the brush, from UMAX to UMIN"),
];

/// Springs that turn, which the source reserves and which this model does not have.
const TORSION: &[&str] =
    &["ROT_RIM_STIFFNESS", "ROT_RIM_DAMPING", "ROT_CE_STIFFNESS", "ROT_CE_DAMPING", "ROT_-CE_DAMPING"];

/// Keys that say something about the file, or that this reader looks at.
const ABOUT: &[(&str, &str)] = &[
    ("MODEL", "PROPERTY_FILE_FORMAT"),
    ("MODEL", "FUNCTION_NAME"),
    ("MODEL", "FUNKTION_NAME"),
    ("PARAMETER", "RADIAL_NONLINEAR"),
    ("CONTACT_COEFFICIENTS", "CONTACT_MODEL"),
    WEIGHT,
    WEIGHT_RIM,
    FACTOR,
];

/// Whether a document is of this tire: it calls the routine TYR501, with or without the name of a library before it, and has no
/// version of the Magic Formula.
pub(super) fn is_one(document: &Document) -> bool {
    let routine = ["FUNCTION_NAME", "FUNKTION_NAME"].iter().find_map(|key| document.word("MODEL", key));
    let called = routine.is_some_and(|(name, _)| {
        name.rsplit("::").next().is_some_and(|name| name.eq_ignore_ascii_case("TYR501"))
    });
    let user = document
        .word("MODEL", "PROPERTY_FILE_FORMAT")
        .is_none_or(|(format, _)| format.eq_ignore_ascii_case("USER"));
    called && user && document.get("MODEL", "FITTYP").is_none()
}

/// The parameters of the tire, in the order of [`KEYS`], and what the user should know.
///
/// # Errors
/// Each with file and line: a key that is missing or has no number, one that stands twice with different values, a unit that is
/// not known, a value that the model does not take, another law of contact.
pub(super) fn read(document: &Document) -> Result<(Settings, Vec<String>)> {
    let mut notes = Vec::new();
    let units = Units::of(document, &mut notes)?;
    // mm, N, kg and s do not belong together, and every such file has them
    notes.retain(|note| note.contains("does not name the unit"));
    let infos = infos();
    let missing: Vec<String> = KEYS
        .iter()
        .filter(|key| key.required)
        .map(|key| (key.section, key.name))
        .chain([WEIGHT, WEIGHT_RIM])
        .filter(|(section, name)| find(document, section, name).is_none_or(|e| e.value == Value::Empty))
        .map(|(section, name)| format!("[{section}] {name}"))
        .collect();
    if !missing.is_empty() {
        return Err(Error::file(format!(
            "{}: it has no value for {}, without which there is no super-elastic tire; add what is missing",
            document.name(),
            missing.join(", ")
        )));
    }
    contact_model(document)?;
    let mut values = Vec::new();
    let mut used = Vec::new();
    for key in KEYS {
        let Some((entry, number)) = number(document, key.section, key.name, &mut notes)? else { continue };
        let place = document.place(entry.line);
        let value = number * factor(document, &units, key.scale)?;
        let value = match kind(&infos, key.parameter) {
            Some(Kind::Integer) => whole(value).ok_or_else(|| {
                Error::file(format!("{place}: {} is {number}; it is a whole number", key.name))
            })?,
            _ => model::Value::Real(value),
        };
        values.push(setting(&infos, key.name, key.parameter, value, place)?);
        used.push(entry.line);
    }
    if let (Some((entry, all)), Some((_, rim))) = (
        number(document, WEIGHT.0, WEIGHT.1, &mut notes)?,
        number(document, WEIGHT_RIM.0, WEIGHT_RIM.1, &mut notes)?,
    ) {
        let (place, rubber) = (document.place(entry.line), all * units.mass - rim * units.mass);
        if !(rubber > 0.0 && rim >= 0.0) {
            return Err(Error::file(format!(
                "{place}: WEIGHT = {all} less WEIGHT_RIM = {rim} is the mass of the rubber, which has to be more than 0, and that of the rim must not be negative"
            )));
        }
        values.push(setting(&infos, WEIGHT.1, RUBBER, model::Value::Real(rubber), place)?);
        notes.push(format!(
            "{}: of WEIGHT the rim's {} kg belong to the hub: to hub_mass of the rig, and {rubber} kg are rubber",
            document.name(),
            rim * units.mass
        ));
    }
    curve(document, &mut notes)?;
    notes.extend(document.unused_tables(&[]));
    slip_stiffness(document, &mut notes);
    let unused = unused(document, &used, &mut notes);
    notes.extend(document.unused_keys(&unused));
    notes.extend(document.told());
    Ok((Settings { values, ..Settings::default() }, notes))
}

/// Writes parameters into a document, in its units. Only values that are not the same already are touched. Returns how many were
/// written, and what of the tire's parameters such a file has no key for.
///
/// # Errors
/// A value that the model does not take, with its place; a unit of the document that is not known.
pub(super) fn write(own: &Settings, document: &mut Document) -> Result<(usize, Vec<String>)> {
    let units = Units::of(document, &mut Vec::new())?;
    let infos = infos();
    let mut values = Vec::new();
    let mut lost = Vec::new();
    let mut exponent = None;
    for setting in &own.values {
        // of others the caller says so
        let Some(info) = infos.iter().find(|info| is_parameter(info, &setting.name)) else { continue };
        let value = info.accept_quantity(&setting.value).map_err(|e| e.at(&setting.place))?;
        let wanted = match value {
            model::Value::Real(value) => value,
            model::Value::Integer(value) => f64::from(value),
            _ => f64::NAN,
        };
        if setting.name == RUBBER {
            let (_, rim) = required(document, WEIGHT_RIM)?;
            let (_, all) = required(document, WEIGHT)?;
            if all * units.mass - rim * units.mass != wanted {
                let sum = in_units(wanted + rim * units.mass, units.mass);
                values.push(assignment(document, WEIGHT.0, WEIGHT.1, sum)?);
            }
        } else if setting.name == FACTOR_PARAMETER {
            if there(document, FACTOR.0, FACTOR.1) != Some(wanted) {
                values.push(assignment(document, FACTOR.0, FACTOR.1, wanted)?);
            }
            if wanted != 1.0 {
                lost.push(format!(
                    "{FACTOR_PARAMETER} = {wanted}: COR_FACTOR_RSTIFF of the file is a factor on the curve of the stiffness only, and in the model it is one on the constant, too"
                ));
            }
        } else if let Some(key) = KEYS.iter().find(|key| key.parameter == setting.name) {
            if key.name == "EXPONENT" {
                exponent = Some(wanted);
            }
            if !matches!(key.scale, Scale::AtOneMillimetre) {
                let factor = factor(document, &units, key.scale)?;
                if there(document, key.section, key.name).map(|v| v * factor) != Some(wanted) {
                    values.push(assignment(document, key.section, key.name, in_units(wanted, factor))?);
                }
            }
        } else if info.start.as_ref() != Some(&value) {
            lost.push(format!("{} = {value}: such a file has no key for it", setting.name));
        }
    }
    // its unit has the exponent in it, so it is written with the one that will be there
    if let Some(key) = KEYS.iter().find(|key| matches!(key.scale, Scale::AtOneMillimetre)) {
        let before = factor(document, &units, key.scale)?;
        let after = match exponent {
            Some(exponent) => at_one_millimetre(&units, exponent),
            None => before,
        };
        let given = own.values.iter().find(|setting| setting.name == key.parameter);
        let held = there(document, key.section, key.name);
        let wanted = match given.zip(infos.iter().find(|info| info.name == key.parameter)) {
            Some((setting, info)) => match info.accept_quantity(&setting.value) {
                Ok(model::Value::Real(value)) => Some(value),
                Ok(_) => None,
                Err(e) => return Err(e.at(&setting.place)),
            },
            None => held.map(|number| number * before),
        };
        if let Some(wanted) = wanted
            && held.map(|number| number * after) != Some(wanted)
        {
            values.push(assignment(document, key.section, key.name, in_units(wanted, after))?);
        }
    }
    if !values.is_empty() {
        document.set_all(&values)?;
    }
    Ok((values.len(), lost))
}

/// A file with the default parameters of the model, as the source prints it, and `title` as comment. The model knows no mass of
/// the rim, so `WEIGHT_RIM` is 0 and `WEIGHT` that of the rubber.
///
/// # Errors
/// None that parameters of the model could make.
pub(super) fn create(name: &str, title: &str) -> Result<Document> {
    let mut text = String::new();
    for line in title.lines() {
        text.push_str(&format!("$ {line}\n"));
    }
    text.push_str("[MDI_HEADER]\nFILE_TYPE                = 'tir'\nFILE_VERSION             = 2.0\n");
    text.push_str("FILE_FORMAT              = 'ASCII'\n");
    text.push_str("[UNITS]\nLENGTH                   = 'mm'\nFORCE                    = 'newton'\n");
    text.push_str("ANGLE                    = 'degree'\nMASS                     = 'kg'\n");
    text.push_str("TIME                     = 'sec'\n");
    text.push_str("[MODEL]\nPROPERTY_FILE_FORMAT     = 'USER'\nFUNCTION_NAME            = 'TYR501'\n");
    text.push_str("NUM_INT_METHODE          = 'DOPRI5'\n");
    text.push_str(
        "[DIMENSION]\nWEIGHT                   = 0\n[RIM]\nWEIGHT_RIM               = 0 $ not known here\n",
    );
    text.push_str("[PARAMETER]\nRADIAL_NONLINEAR         = 'no'\nCOR_FACTOR_RSTIFF        = 1\n");
    text.push_str("[CONTACT_COEFFICIENTS]\nCONTACT_MODEL            = 'fml_imp'\n");
    let mut document = Document::parse(text, name)?;
    let defaults = infos()
        .into_iter()
        .filter(|info| info.name == RUBBER || KEYS.iter().any(|key| key.parameter == info.name))
        .filter_map(|info| {
            Some(Setting {
                name: info.name,
                value: info.start?,
                causality: Causality::Parameter,
                place: name.into(),
            })
        });
    let defaults = Settings { values: defaults.collect(), ..Settings::default() };
    write(&defaults, &mut document)?;
    Ok(document)
}

/// Whether models with this tire have a parameter of that name from it.
pub(super) fn has(name: &str) -> bool {
    infos().iter().any(|info| is_parameter(info, name))
}

fn is_parameter(info: &VariableInfo, name: &str) -> bool {
    info.name == name && info.causality == Causality::Parameter
}

/// The tire's variables.
fn infos() -> Vec<VariableInfo> {
    SuperElastic::rows().infos()
}

fn kind<'a>(infos: &'a [VariableInfo], parameter: &str) -> Option<&'a Kind> {
    infos.iter().find(|info| info.name == parameter).map(|info| &info.kind)
}

/// A parameter of the model, checked; `key` is what the file calls it.
fn setting(
    infos: &[VariableInfo],
    key: &str,
    parameter: &str,
    value: model::Value,
    place: String,
) -> Result<Setting> {
    if let Some(info) = infos.iter().find(|info| info.name == parameter) {
        info.accept(&value).map_err(|e| Error::file(format!("{place}: {key} cannot be used: {e}")))?;
    }
    Ok(Setting { name: parameter.into(), value, causality: Causality::Parameter, place })
}

/// A real number as whole one.
fn whole(value: f64) -> Option<model::Value> {
    (value == value.trunc() && value.abs() < 1e9).then_some(model::Value::Integer(value as i32))
}

/// What a number of the file is multiplied by to be in SI units, or in N at 1 mm.
fn factor(document: &Document, units: &Units, scale: Scale) -> Result<f64> {
    Ok(match scale {
        Scale::Of(dimension) => units.factor(dimension),
        Scale::Kilonewton => 1e3,
        Scale::AtOneMillimetre => match find(document, "CONTACT_COEFFICIENTS", "EXPONENT") {
            Some(Entry { value: Value::Number(exponent), .. }) => at_one_millimetre(units, exponent),
            // of a file that is being made
            _ => at_one_millimetre(units, 1.0),
        },
    })
}

/// The force at 1 mm over a stiffness that is force over length to the power of the exponent.
fn at_one_millimetre(units: &Units, exponent: f64) -> f64 {
    units.force * libm::pow(1e-3 / units.length, exponent)
}

/// An entry: in its section, or else in the only other section that has the key.
fn find<'a>(document: &'a Document, section: &str, key: &str) -> Option<Entry<'a>> {
    // keys that mean something else elsewhere
    if matches!(key, "DAMPING" | "STIFFNESS" | "WIDTH" | "WEIGHT") || document.get(section, key).is_some() {
        return document.get(section, key);
    }
    let mut others = document.entries().filter(|e| e.key == key);
    let first = others.next()?;
    others.all(|e| e.section == first.section).then_some(first)
}

/// The number of a key, if it is there.
fn number<'a>(
    document: &'a Document,
    section: &str,
    key: &str,
    notes: &mut Vec<String>,
) -> Result<Option<(Entry<'a>, f64)>> {
    let Some(found) = find(document, section, key) else { return Ok(None) };
    let Some(entry) = document.only(found.section, key, key)? else { return Ok(None) };
    let place = document.place(entry.line);
    if entry.section != section {
        notes.push(format!(
            "{place}: {key} stands in [{}] instead of [{section}]; it is used all the same",
            entry.section
        ));
    }
    let number = document.number(&entry, key)?;
    if number.is_none() {
        notes.push(format!("{place}: {key} is empty, as if it were not there"));
    }
    Ok(number.map(|number| (entry, number)))
}

fn required<'a>(document: &'a Document, (section, key): (&str, &str)) -> Result<(Entry<'a>, f64)> {
    number(document, section, key, &mut Vec::new())?.ok_or_else(|| {
        Error::file(format!("{}: it has no value for [{section}] {key}; add it", document.name()))
    })
}

/// The number that is there now.
fn there(document: &Document, section: &str, key: &str) -> Option<f64> {
    match find(document, section, key)?.value {
        Value::Number(number) => Some(number),
        _ => None,
    }
}

/// Section, key and text of a value to write; the section is the one where the key stands.
fn assignment(
    document: &Document,
    section: &str,
    key: &str,
    number: f64,
) -> Result<(String, String, String)> {
    let section = find(document, section, key).map_or(section, |entry| entry.section).to_string();
    let text = number_text(number).ok_or_else(|| {
        Error::file(format!("{}: {key} cannot be written in the units of the file", document.name()))
    })?;
    Ok((section, key.to_string(), text))
}

/// Refuses another law of contact than the one that is modelled.
fn contact_model(document: &Document) -> Result<()> {
    match document.word("CONTACT_COEFFICIENTS", "CONTACT_MODEL") {
        Some((name, line)) if !name.eq_ignore_ascii_case("fml_imp") => Err(Error::file(format!(
            "{}: CONTACT_MODEL is '{}'; modelled is 'fml_imp', a one-sided spring with a power of the penetration",
            document.place(line),
            shown(name.as_bytes())
        ))),
        _ => Ok(()),
    }
}

/// What is made of `RADIAL_NONLINEAR` and of the factor on its curve.
fn curve(document: &Document, notes: &mut Vec<String>) -> Result<()> {
    let factor = number(document, FACTOR.0, FACTOR.1, notes)?;
    let without = match &factor {
        Some((_, factor)) => format!(
            "; COR_FACTOR_RSTIFF = {factor}, a factor on that curve only, is not used: with a curve of your own set stiffness_factor = {factor} beside it"
        ),
        None => String::new(),
    };
    match document.word("PARAMETER", "RADIAL_NONLINEAR") {
        Some((text, line)) if text.eq_ignore_ascii_case("yes") => {
            notes.push(format!(
                "{}: RADIAL_NONLINEAR is 'yes', but such a file carries no curve: the constants RADIAL_STIFFNESS and RADIAL_DAMPING hold at every load and speed until --parameters brings stiffness_law with stiffness_points or an exponent, and damping_law likewise{without}",
                document.place(line)
            ));
            Ok(())
        }
        Some((text, line)) if !text.eq_ignore_ascii_case("no") => Err(Error::file(format!(
            "{}: RADIAL_NONLINEAR is '{}'; it is 'yes' or 'no'",
            document.place(line),
            shown(text.as_bytes())
        ))),
        _ => {
            if let Some((entry, factor)) = factor
                && factor != 1.0
            {
                notes.push(format!(
                    "{}: COR_FACTOR_RSTIFF = {factor} is not used: it is a factor on the curve of the stiffness, and without RADIAL_NONLINEAR = 'yes' the constants hold",
                    document.place(entry.line)
                ));
            }
            Ok(())
        }
    }
}

fn slip_stiffness(document: &Document, notes: &mut Vec<String>) {
    if let Some(Entry { value: Value::Number(number), line, .. }) = find(document, "PARAMETER", "CSLIP") {
        notes.push(format!(
            "{}: CSLIP = {number} is taken as kN whatever [UNITS] says: slip_stiffness = {} N. The source prints a unit that cannot be; solid tires have some ten times its 5 kN",
            document.place(line),
            number * 1e3
        ));
    }
}

/// Says which known keys change nothing, and returns those that nobody knows.
fn unused(document: &Document, used: &[usize], notes: &mut Vec<String>) -> Vec<String> {
    let mut unknown = Vec::new();
    let mut known = Vec::new();
    for entry in document.entries() {
        let is = |&(section, key): &(&str, &str)| {
            entry.key == key && (entry.section == section || !matches!(key, "WEIGHT"))
        };
        let about = matches!(entry.section, "MDI_HEADER" | "UNITS") || ABOUT.iter().any(is);
        let double = KEYS.iter().any(|key| key.name == entry.key && key.section == entry.section);
        if about || double || used.contains(&entry.line) {
            continue;
        }
        if TORSION.contains(&entry.key) {
            if entry.value != Value::Number(0.0) {
                notes.push(format!(
                    "{}: {} belongs to springs that turn, which this model does not have; it is not used",
                    document.place(entry.line),
                    entry.key
                ));
            }
        } else if let Some((.., why)) = KNOWN.iter().find(|(_, key, _)| entry.key == *key) {
            known.push(format!("{} ({why})", entry.key));
        } else {
            unknown.push(format!("[{}] {}", entry.section, entry.key));
        }
    }
    if !known.is_empty() {
        notes.push(format!("{}: not used are {}", document.name(), known.join(", ")));
    }
    unknown
}
