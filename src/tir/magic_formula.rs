//! The Magic Formula tire of a tire property file.

use super::document::{Document, Entry, Value, number_text, shown};
use super::units::Units;
use crate::tire::magic_formula::{Coefficients, FIELDS, Field, out_of_bound};
use crate::{Error, Result};

/// The side of the vehicle that a tire property file was made for (`TYRESIDE`).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The left side.
    Left,
    /// The right side. On the other side the tire is the mirror image: see
    /// [`Input::mirrored`](crate::tire::magic_formula::Input::mirrored).
    Right,
}

/// What a tire property file says of a Magic Formula tire.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// The coefficients in SI units. They have passed [`Coefficients::check`].
    pub coefficients: Coefficients,
    /// The side that the file was made for; `None` if it does not say so, then the tire is used as it is on both sides.
    pub side: Option<Side>,
    /// Keys that the file does not have or leaves empty; they have the value of [`Field::absent`].
    pub missing: Vec<&'static str>,
    /// Keys of the file that the model does not use, as `[SECTION] KEY`.
    pub unused: Vec<String>,
    /// What the user should know: what of the file is not modelled, what looks odd. Sentences with file and line.
    pub notes: Vec<String>,
}

/// Sections whose keys say something about the file, not about the tire.
const ABOUT: &[&str] = &["MDI_HEADER", "UNITS"];

/// Sections with tables of vertical forces.
const CURVES: &[&str] = &["DEFLECTION_LOAD_CURVE", "BOTTOMING_CURVE"];

/// Keys that do not change the forces of this model, or that [`model`] looks at.
const MODEL_KEYS: &[&str] =
    &["FITTYP", "PROPERTY_FILE_FORMAT", "TYRESIDE", "USE_MODE", "FE_METHOD", "FUNCTION_NAME"];

/// Versions of the Magic Formula by `FITTYP` that have the equations of 5.2.
const FITTYPS: &[f64] = &[5.0, 6.0, 21.0];

/// `PROPERTY_FILE_FORMAT`s that have the equations of 5.2.
const FORMATS: &[&str] = &["PAC2002", "MF_05"];

/// `PROPERTY_FILE_FORMAT`s that leave it to `FITTYP` which equations hold.
const OPEN: &[&str] = &["USER", "MF-TYRE", "MF_TYRE", "MF-TIRE", "MF_TIRE"];

/// Keys of later versions, and the values with which they have no effect. Any other value is a term that this model
/// lacks. (`QSY7` is the exponent of the load in versions 6 and an addition to it in PAC2002.)
const LATER: &[(&str, &[f64])] = &[
    ("PKY4", &[2.0]),
    ("PKY5", &[0.0]),
    ("PKY6", &[0.0]),
    ("PKY7", &[0.0]),
    ("PEY5", &[0.0]),
    ("RBX3", &[0.0]),
    ("RBY4", &[0.0]),
    ("PPX1", &[0.0]),
    ("PPX2", &[0.0]),
    ("PPX3", &[0.0]),
    ("PPX4", &[0.0]),
    ("PPY1", &[0.0]),
    ("PPY2", &[0.0]),
    ("PPY3", &[0.0]),
    ("PPY4", &[0.0]),
    ("PPY5", &[0.0]),
    ("PPZ1", &[0.0]),
    ("PPZ2", &[0.0]),
    ("QPZ1", &[0.0]),
    ("QPZ2", &[0.0]),
    ("PPMX1", &[0.0]),
    ("QPX1", &[0.0]),
    ("QSX4", &[0.0]),
    ("QSX10", &[0.0]),
    ("QSX12", &[0.0]),
    ("QSX13", &[0.0]),
    ("QSX14", &[0.0]),
    ("QSY5", &[0.0]),
    ("QSY6", &[0.0]),
    ("QSY7", &[0.0, 1.0]),
    ("QDZ10", &[0.0]),
    ("QDZ11", &[0.0]),
    ("LMUV", &[0.0]),
    ("LKYC", &[1.0]),
    ("LKZC", &[1.0]),
    ("LKG", &[1.0]),
    ("Q_V1", &[0.0]),
    ("Q_V2", &[0.0]),
    ("Q_FCX", &[0.0]),
    ("Q_FCY", &[0.0]),
    ("Q_RE0", &[1.0]),
];

/// The Magic Formula tire of version 5.2 that a document describes.
///
/// # Errors
/// Each with file and line: the file is of another model or version; a unit is not known; a coefficient that must be
/// there is missing; a value is no number, not finite or out of its bound; a key stands twice with different values.
pub fn read(document: &Document) -> Result<Reading> {
    let mut notes = Vec::new();
    model(document, &mut notes)?;
    let units = Units::of(document, &mut notes)?;
    let mut coefficients = Coefficients::absent();
    let mut missing = Vec::new();
    let mut required = Vec::new();
    let mut used = Vec::new();
    for field in FIELDS {
        let entry = only_entry(document, field, &mut notes)?;
        if let Some(entry) = &entry {
            used.push(entry.line);
        }
        match value(document, field, entry, &units, &mut notes)? {
            Some(value) => (field.set)(&mut coefficients, value),
            None if field.absent.is_some() => missing.push(field.name),
            None => required.push(format!("[{}] {}", field.section, field.name)),
        }
    }
    if !required.is_empty() {
        return Err(Error::file(format!(
            "{}: it has no value for {}, without which there is no tire; add what is missing",
            document.name(),
            required.join(", ")
        )));
    }
    coefficients.check().map_err(|e| Error::file(format!("{}: {e}", document.name())))?;

    let mut unused = Vec::new();
    for entry in document.entries() {
        let about =
            ABOUT.contains(&entry.section) || entry.section == "MODEL" && MODEL_KEYS.contains(&entry.key);
        let double = FIELDS.iter().any(|f| f.name == entry.key && f.section == entry.section);
        if about || double || used.contains(&entry.line) {
            continue;
        }
        if let (Some((_, neutral)), Value::Number(number)) =
            (LATER.iter().find(|(key, _)| *key == entry.key), &entry.value)
            && !neutral.contains(number)
        {
            notes.push(format!(
                "{}: {} = {number} belongs to a term that version 5.2 of the Magic Formula does not have; it is not used",
                document.place(entry.line),
                entry.key
            ));
        }
        unused.push(format!("[{}] {}", entry.section, entry.key));
    }
    for table in CURVES {
        if document.sections().any(|section| section == *table) {
            notes.push(format!(
                "{}: the table in [{table}] is not used; the vertical force is VERTICAL_STIFFNESS times deflection",
                document.name()
            ));
        }
    }
    notes.extend(document.unused_tables(CURVES));
    if coefficients.rbx1 == 0.0 || coefficients.rby1 == 0.0 {
        notes.push(format!(
            "{}: RBX1 or RBY1 is 0 or missing, so that slip in one direction does not reduce the force in the other; \
             with slip in both the forces together exceed friction",
            document.name()
        ));
    }
    let c = &coefficients;
    for (name, range, direction) in [
        ("KPUMIN", c.kpumin, "braking"),
        ("KPUMAX", c.kpumax, "driving"),
        ("ALPMIN", c.alpmin, "negative slip angles"),
        ("ALPMAX", c.alpmax, "positive slip angles"),
    ] {
        if range == 0.0 {
            notes.push(format!(
                "{}: {name} is 0, the tire was not measured at {direction}; while slip is limited to the ranges of the \
                 file it makes no force there",
                document.name()
            ));
        }
    }
    for (names, none) in [("PTX1", c.ptx1 == 0.0), ("PTY1 or PTY2", c.pty1 == 0.0 || c.pty2 == 0.0)] {
        if none {
            notes.push(format!(
                "{}: {names} is 0 or missing, so that the relaxation length is 0: the model takes 0.01 m, over which force follows slip almost at once",
                document.name()
            ));
        }
    }
    notes.extend(document.told());
    let side = side(document, &mut notes);
    Ok(Reading { coefficients, side, missing, unused, notes })
}

/// Writes coefficients into a document, in its units. Only values that are not the same already are touched; a missing
/// key is added only if its coefficient is not what its absence means. Returns how many values were written.
///
/// # Errors
/// Of [`Coefficients::check`]; a unit of the document is not known; the document would become too long.
pub fn write(coefficients: &Coefficients, document: &mut Document) -> Result<usize> {
    coefficients.check()?;
    let units = Units::of(document, &mut Vec::new())?;
    let mut values = Vec::new();
    for field in FIELDS {
        let wanted = (field.get)(coefficients);
        let factor = units.factor(field.dimension);
        let entry = find(document, field);
        let section = entry.as_ref().map_or(field.section, |e| e.section).to_string();
        let there = match entry.map(|e| e.value) {
            Some(Value::Number(number)) => Some(number * factor),
            // what is no number was read as if it were not there
            _ => field.absent,
        };
        if there != Some(wanted) {
            let text = number_text(in_units(wanted, factor)).ok_or_else(|| {
                Error::file(format!(
                    "{}: {} cannot become {wanted} in the units of the file",
                    document.name(),
                    field.name
                ))
            })?;
            values.push((section, field.name.to_string(), text));
        }
    }
    if !values.is_empty() {
        document.set_all(&values)?;
    }
    Ok(values.len())
}

/// A tire property file with all coefficients, in SI units. `title` becomes a comment.
///
/// # Errors
/// Of [`Coefficients::check`].
pub fn create(coefficients: &Coefficients, side: Option<Side>, name: &str, title: &str) -> Result<Document> {
    coefficients.check()?;
    let mut text = String::new();
    for line in title.lines() {
        text.push_str(&format!("$ {line}\n"));
    }
    text.push_str("[MDI_HEADER]\nFILE_TYPE                = 'tir'\nFILE_VERSION             = 3.0\n");
    text.push_str("FILE_FORMAT              = 'ASCII'\n");
    text.push_str("[UNITS]\nLENGTH                   = 'meter'\nFORCE                    = 'newton'\n");
    text.push_str("ANGLE                    = 'radian'\nMASS                     = 'kg'\n");
    text.push_str("TIME                     = 'second'\n");
    text.push_str("[MODEL]\nPROPERTY_FILE_FORMAT     = 'PAC2002'\nFITTYP                   = 6\n");
    text.push_str("USE_MODE                 = 14\n");
    if let Some(side) = side {
        let side = if side == Side::Left { "LEFT" } else { "RIGHT" };
        text.push_str(&format!("TYRESIDE                 = '{side}'\n"));
    }
    let mut section = "MODEL";
    for field in FIELDS {
        if field.section != section {
            section = field.section;
            text.push_str(&format!("[{section}]\n"));
        }
        let value = number_text((field.get)(coefficients)).unwrap_or_default();
        text.push_str(&format!("{:<24} = {value:<12} $ {}\n", field.name, field.description));
    }
    Document::parse(text, name)
}

/// Refuses what is not version 5.2 of the Magic Formula.
fn model(document: &Document, notes: &mut Vec<String>) -> Result<()> {
    let fittyp = match document.get("MODEL", "FITTYP") {
        Some(Entry { value: Value::Number(number), line, .. }) => Some((number, line)),
        Some(Entry { value: Value::Empty, .. }) | None => None,
        Some(entry) => {
            return Err(Error::file(format!("{}: FITTYP is no number", document.place(entry.line))));
        }
    };
    let modelled = "modelled is version 5.2: FITTYP 5, 6 or 21, or PROPERTY_FILE_FORMAT 'PAC2002', and the super-elastic \
                    tire: PROPERTY_FILE_FORMAT 'USER' with FUNCTION_NAME 'TYR501'";
    if let Some((number, line)) = fittyp
        && !FITTYPS.contains(&number)
    {
        let place = document.place(line);
        let what = if (60.0..70.0).contains(&number) {
            format!(
                "FITTYP {number} is version {:.1} of the Magic Formula; {modelled}. The later versions have other \
                 equations: inflation pressure (PPX, PPY, PPZ), camber stiffness by PKY6 and PKY7 instead of PHY3, more \
                 terms of the overturning and rolling resistance moments (QSX4 to QSX14, QSY5 to QSY8), relaxation \
                 lengths from the stiffness of the carcass instead of PTX and PTY. With the equations of 5.2 the forces \
                 would be wrong, so the file is not used; export the tire as version 5.2",
                number / 10.0
            )
        } else {
            format!("FITTYP {number} is a version of the Magic Formula that is not modelled; {modelled}")
        };
        return Err(Error::file(format!("{place}: {what}")));
    }
    match document.word("MODEL", "PROPERTY_FILE_FORMAT") {
        Some((format, _)) if FORMATS.iter().any(|f| f.eq_ignore_ascii_case(&format)) => {}
        Some((format, _)) if fittyp.is_some() && OPEN.iter().any(|f| f.eq_ignore_ascii_case(&format)) => {}
        None if fittyp.is_some() => {}
        Some((format, line)) => {
            return Err(Error::file(format!(
                "{}: PROPERTY_FILE_FORMAT is '{}'; {modelled}",
                document.place(line),
                shown(format.as_bytes())
            )));
        }
        None => {
            return Err(Error::file(format!(
                "{}: it does not say which tire model it is for; {modelled}. If its coefficients are of that version, \
                 write FITTYP = 6 below [MODEL]",
                document.name()
            )));
        }
    }
    if let Some((method, line)) = document.word("MODEL", "FE_METHOD")
        && method.eq_ignore_ascii_case("YES")
    {
        notes.push(format!(
            "{}: the file asks for combined slip by a friction ellipse (FE_METHOD), which is not modelled; combined slip \
             follows the coefficients RBX1 to RVY6",
            document.place(line)
        ));
    }
    if let Some(Entry { value: Value::Number(mode), line, .. }) = document.get("MODEL", "USE_MODE")
        && (mode < 0.0 || mode % 10.0 != 4.0)
    {
        notes.push(format!(
            "{}: USE_MODE {mode} asks for something else than forces in combined slip, unmirrored; this model always \
             computes those",
            document.place(line)
        ));
    }
    Ok(())
}

fn side(document: &Document, notes: &mut Vec<String>) -> Option<Side> {
    let entry = document.get("MODEL", "TYRESIDE")?;
    let (Value::Text(text) | Value::Word(text)) = &entry.value else { return None };
    match text.to_ascii_uppercase().as_str() {
        "LEFT" => Some(Side::Left),
        "RIGHT" => Some(Side::Right),
        "SYMMETRIC" => None,
        _ => {
            notes.push(format!(
                "{}: TYRESIDE is '{}', neither 'LEFT' nor 'RIGHT'; the tire is used as it is on both sides",
                document.place(entry.line),
                shown(text.as_bytes())
            ));
            None
        }
    }
}

/// The entry of a field: in its section, or else in the only other section that has the key.
fn find<'a>(document: &'a Document, field: &Field) -> Option<Entry<'a>> {
    if let Some(entry) = document.get(field.section, field.name) {
        return Some(entry);
    }
    let mut others = document.entries().filter(|e| e.key == field.name && !ABOUT.contains(&e.section));
    let first = others.next()?;
    others.all(|e| e.section == first.section).then_some(first)
}

/// As [`find`], checked: several assignments must agree, and one in another section is noted.
fn only_entry<'a>(
    document: &'a Document,
    field: &Field,
    notes: &mut Vec<String>,
) -> Result<Option<Entry<'a>>> {
    let Some(found) = find(document, field) else { return Ok(None) };
    let Some(entry) = document.only(found.section, field.name, field.name)? else { return Ok(None) };
    if entry.section != field.section {
        notes.push(format!(
            "{}: {} stands in [{}] instead of [{}]; it is used all the same",
            document.place(entry.line),
            field.name,
            entry.section,
            field.section
        ));
    }
    Ok(Some(entry))
}

/// The value of a field in SI units; `None` if the file has none.
fn value(
    document: &Document,
    field: &Field,
    entry: Option<Entry<'_>>,
    units: &Units,
    notes: &mut Vec<String>,
) -> Result<Option<f64>> {
    let Some(entry) = entry else { return Ok(None) };
    let place = document.place(entry.line);
    let wrong = match &entry.value {
        Value::Empty => {
            notes.push(format!("{place}: {} is empty, as if it were not there", field.name));
            return Ok(None);
        }
        Value::Number(number) => {
            let value = number * units.factor(field.dimension);
            if !value.is_finite() {
                format!("{} is too large for a number", field.name)
            } else if !field.bound.holds(value) {
                out_of_bound(field, value)
            } else {
                return Ok(Some(value));
            }
        }
        Value::Text(text) | Value::Word(text) => {
            format!("{} is '{}', which is no number", field.name, shown(text.as_bytes()))
        }
    };
    if !field.is_used() {
        notes.push(format!("{place}: {wrong}; no equation uses it"));
        return Ok(None);
    }
    Err(Error::file(format!("{place}: {wrong}")))
}

/// The number that, times `factor`, is `value`; if rounding leaves none, the nearest.
pub(super) fn in_units(value: f64, factor: f64) -> f64 {
    let quotient = value / factor;
    for candidate in [quotient, quotient.next_up(), quotient.next_down()] {
        if candidate * factor == value {
            return candidate;
        }
    }
    quotient
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_called_informative_is_used_by_no_equation() {
        for field in FIELDS {
            assert_eq!(
                !field.is_used(),
                field.description.ends_with("no equation uses it."),
                "{}",
                field.name
            );
        }
    }
}
