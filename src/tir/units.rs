//! The units of a tire property file.

use super::document::{Document, Value, shown};
use crate::tire::magic_formula::Dimension;
use crate::{Error, Result};
use std::f64::consts::PI;

/// What one unit of the file is in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Units {
    /// m.
    pub length: f64,
    /// N.
    pub force: f64,
    /// rad.
    pub angle: f64,
    /// kg.
    pub mass: f64,
    /// s.
    pub time: f64,
}

/// The words for a unit, in the singular, and what it is in SI units. Definitions, exact but for rounding; a slug is a
/// pound-force s²/ft.
type Words = &'static [(&'static [&'static str], f64)];

const LENGTHS: Words = &[
    (&["m", "meter", "metre"], 1.0),
    (&["mm", "millimeter", "millimetre"], 1e-3),
    (&["cm", "centimeter", "centimetre"], 1e-2),
    (&["km", "kilometer", "kilometre"], 1e3),
    (&["inch", "in", "inche"], 0.0254),
    (&["ft", "foot", "feet"], 0.3048),
    (&["mile"], 1609.344),
];
const POUND_FORCE: f64 = 4.448_221_615_260_5;
const FORCES: Words = &[
    (&["newton", "n"], 1.0),
    (&["knewton", "kn", "kilonewton"], 1e3),
    (&["dyne"], 1e-5),
    (&["pound_force", "lbf"], POUND_FORCE),
    (&["kpound_force", "klbf"], 1e3 * POUND_FORCE),
    (&["ounce_force"], POUND_FORCE / 16.0),
    (&["kg_force", "kgf"], 9.80665),
];
const ANGLES: Words = &[(&["radian", "rad"], 1.0), (&["degree", "deg"], PI / 180.0)];
const MASSES: Words = &[
    (&["kg", "kilogram"], 1.0),
    (&["g", "gram"], 1e-3),
    (&["tonne"], 1e3),
    (&["pound_mass", "lb", "lbs", "lbm", "pound"], 0.453_592_37),
    (&["slug"], POUND_FORCE / 0.3048),
    (&["ounce_mass"], 0.453_592_37 / 16.0),
];
const TIMES: Words = &[
    (&["second", "sec", "s"], 1.0),
    (&["ms", "millisecond"], 1e-3),
    (&["min", "minute"], 60.0),
    (&["hour", "h"], 3600.0),
];

impl Units {
    /// m, N, rad, kg, s.
    pub const SI: Self = Self { length: 1.0, force: 1.0, angle: 1.0, mass: 1.0, time: 1.0 };

    /// The units that `[UNITS]` of a document names. A unit that is not named is the SI unit, with a note in `notes`;
    /// units that do not belong together (force is not mass times length over time squared) are noted as well, as the
    /// file's author may have thought of other values.
    ///
    /// # Errors
    /// A unit of which the factor is not known, with its line.
    pub fn of(document: &Document, notes: &mut Vec<String>) -> Result<Self> {
        let mut one = |key: &str, words: Words, si: &str| match document.get("UNITS", key) {
            Some(entry) => {
                let text = match &entry.value {
                    Value::Text(text) | Value::Word(text) => text.trim().to_ascii_lowercase(),
                    _ => String::new(),
                };
                // the plural of a word, not that of a symbol: ms is no plural of m
                let singular = text.strip_suffix('s').filter(|t| t.len() > 2).unwrap_or(&text);
                let known = words
                    .iter()
                    .find(|(names, _)| names.contains(&text.as_str()) || names.contains(&singular));
                known.map(|(_, factor)| *factor).ok_or_else(|| {
                    let names: Vec<&str> =
                        words.iter().filter_map(|(names, _)| names.first().copied()).collect();
                    Error::file(format!(
                        "{}: the unit of {} is '{}', which is not known; known are {}",
                        document.place(entry.line),
                        key.to_ascii_lowercase(),
                        shown(text.as_bytes()),
                        names.join(", ")
                    ))
                })
            }
            None => {
                notes.push(format!(
                    "{}: [UNITS] does not name the unit of {}; it is taken as {si}",
                    document.name(),
                    key.to_ascii_lowercase()
                ));
                Ok(1.0)
            }
        };
        let units = Self {
            length: one("LENGTH", LENGTHS, "meter")?,
            force: one("FORCE", FORCES, "newton")?,
            angle: one("ANGLE", ANGLES, "radian")?,
            mass: one("MASS", MASSES, "kg")?,
            time: one("TIME", TIMES, "second")?,
        };
        let consistent = units.mass * units.length / (units.time * units.time);
        if (units.force / consistent - 1.0).abs() > 1e-9 {
            notes.push(format!(
                "{}: the unit of force is {:.6} times that of mass times length over time squared; each value is \
                 converted by its own unit, masses by that of mass",
                document.name(),
                units.force / consistent
            ));
        }
        Ok(units)
    }

    /// What a value of this dimension has to be multiplied by to be in SI units.
    pub fn factor(&self, dimension: Dimension) -> f64 {
        power(self.length, dimension.length)
            * power(self.force, dimension.force)
            * power(self.angle, dimension.angle)
            * power(self.mass, dimension.mass)
            * power(self.time, dimension.time)
    }
}

fn power(base: f64, exponent: i8) -> f64 {
    let mut product = 1.0;
    for _ in 0..exponent.unsigned_abs() {
        product *= base;
    }
    if exponent < 0 { 1.0 / product } else { product }
}
