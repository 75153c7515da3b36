//! Units: from the text of a column header or a variable to SI base units and back.
//!
//! A unit is a product of symbols with whole exponents and at most one `/`, which divides by
//! everything behind it: `N.m/rad`, `m/s2`, `m/s^2`, `m/s²`, `kN/mm`, `1/s`, `km/h`, `N m`. Symbols take the SI
//! prefixes where that is customary.

use crate::{Error, Result};

/// Exponents of the SI base units and of the radian, and the way to them:
/// value in base units = factor * value + offset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// Exponents in the order of [`BASE`].
    pub exponents: [i8; 8],
    /// Factor to base units.
    pub factor: f64,
    /// Offset in base units.
    pub offset: f64,
}

/// Names of the base units in FMI 2.0.
pub const BASE: [&str; 8] = ["kg", "m", "s", "A", "K", "mol", "cd", "rad"];

const ONE: Unit = Unit { exponents: [0; 8], factor: 1.0, offset: 0.0 };

/// A symbol: name, exponents, factor, offset, whether it takes prefixes.
type Symbol = (&'static str, [i8; 8], f64, f64, bool);

const SYMBOLS: &[Symbol] = &[
    ("m", [0, 1, 0, 0, 0, 0, 0, 0], 1.0, 0.0, true),
    ("g", [1, 0, 0, 0, 0, 0, 0, 0], 1e-3, 0.0, true),
    ("t", [1, 0, 0, 0, 0, 0, 0, 0], 1e3, 0.0, false),
    ("s", [0, 0, 1, 0, 0, 0, 0, 0], 1.0, 0.0, true),
    ("sec", [0, 0, 1, 0, 0, 0, 0, 0], 1.0, 0.0, false),
    ("min", [0, 0, 1, 0, 0, 0, 0, 0], 60.0, 0.0, false),
    ("h", [0, 0, 1, 0, 0, 0, 0, 0], 3600.0, 0.0, false),
    ("A", [0, 0, 0, 1, 0, 0, 0, 0], 1.0, 0.0, true),
    ("K", [0, 0, 0, 0, 1, 0, 0, 0], 1.0, 0.0, false),
    ("degC", [0, 0, 0, 0, 1, 0, 0, 0], 1.0, 273.15, false),
    ("°C", [0, 0, 0, 0, 1, 0, 0, 0], 1.0, 273.15, false),
    ("mol", [0, 0, 0, 0, 0, 1, 0, 0], 1.0, 0.0, false),
    ("cd", [0, 0, 0, 0, 0, 0, 1, 0], 1.0, 0.0, false),
    ("rad", [0, 0, 0, 0, 0, 0, 0, 1], 1.0, 0.0, true),
    ("deg", [0, 0, 0, 0, 0, 0, 0, 1], std::f64::consts::PI / 180.0, 0.0, false),
    ("°", [0, 0, 0, 0, 0, 0, 0, 1], std::f64::consts::PI / 180.0, 0.0, false),
    ("rev", [0, 0, 0, 0, 0, 0, 0, 1], std::f64::consts::TAU, 0.0, false),
    // German Umdrehung
    ("U", [0, 0, 0, 0, 0, 0, 0, 1], std::f64::consts::TAU, 0.0, false),
    ("rpm", [0, 0, -1, 0, 0, 0, 0, 1], std::f64::consts::TAU / 60.0, 0.0, false),
    ("N", [1, 1, -2, 0, 0, 0, 0, 0], 1.0, 0.0, true),
    ("Nm", [1, 2, -2, 0, 0, 0, 0, 0], 1.0, 0.0, true),
    ("Nmm", [1, 2, -2, 0, 0, 0, 0, 0], 1e-3, 0.0, true),
    ("kgf", [1, 1, -2, 0, 0, 0, 0, 0], 9.80665, 0.0, false),
    ("J", [1, 2, -2, 0, 0, 0, 0, 0], 1.0, 0.0, true),
    ("W", [1, 2, -3, 0, 0, 0, 0, 0], 1.0, 0.0, true),
    ("Pa", [1, -1, -2, 0, 0, 0, 0, 0], 1.0, 0.0, true),
    ("bar", [1, -1, -2, 0, 0, 0, 0, 0], 1e5, 0.0, true),
    ("Hz", [0, 0, -1, 0, 0, 0, 0, 0], 1.0, 0.0, true),
    ("V", [1, 2, -3, -1, 0, 0, 0, 0], 1.0, 0.0, true),
    ("mph", [0, 1, -1, 0, 0, 0, 0, 0], 0.44704, 0.0, false),
    ("kph", [0, 1, -1, 0, 0, 0, 0, 0], 1.0 / 3.6, 0.0, false),
    ("l", [0, 3, 0, 0, 0, 0, 0, 0], 1e-3, 0.0, true),
    ("L", [0, 3, 0, 0, 0, 0, 0, 0], 1e-3, 0.0, true),
    ("in", [0, 1, 0, 0, 0, 0, 0, 0], 0.0254, 0.0, false),
    ("ft", [0, 1, 0, 0, 0, 0, 0, 0], 0.3048, 0.0, false),
    ("lb", [1, 0, 0, 0, 0, 0, 0, 0], 0.453_592_37, 0.0, false),
    ("lbf", [1, 1, -2, 0, 0, 0, 0, 0], 4.448_221_615_260_5, 0.0, false),
    ("psi", [1, -1, -2, 0, 0, 0, 0, 0], 6_894.757_293_168_361, 0.0, false),
    ("%", [0; 8], 0.01, 0.0, false),
    ("-", [0; 8], 1.0, 0.0, false),
    ("1", [0; 8], 1.0, 0.0, false),
];

const PREFIXES: &[(&str, f64)] = &[
    ("n", 1e-9),
    ("u", 1e-6),
    // the sign of its own, and the Greek letter
    ("\u{b5}", 1e-6),
    ("\u{3bc}", 1e-6),
    ("m", 1e-3),
    ("c", 1e-2),
    ("d", 1e-1),
    ("da", 1e1),
    ("h", 1e2),
    ("k", 1e3),
    ("M", 1e6),
    ("G", 1e9),
];

impl Unit {
    /// The unit with this text.
    ///
    /// # Errors
    /// A symbol or a form that is not known.
    pub fn parse(text: &str) -> Result<Self> {
        let text = text.trim();
        let fail = |what: &str| Error::variable(format!("unit {text:?}: {what}"));
        let plain: String = text.chars().map(lowered).collect();
        let mut unit = ONE;
        let mut parts = plain.split('/');
        for (position, side) in [parts.next(), parts.next()].into_iter().flatten().enumerate() {
            let sign = if position == 0 { 1 } else { -1 };
            let side = side.trim().trim_start_matches('(').trim_end_matches(')');
            for factor in side.split(['.', '*', '·', '⋅']).flat_map(words) {
                let digits = factor.trim_end_matches(|c: char| c.is_ascii_digit());
                let (name, exponent) = match digits.trim_end_matches('-').trim_end_matches('^') {
                    "" => (factor, 1),
                    _ if digits.len() == factor.len() => (factor, 1),
                    name => {
                        let exponent = factor[name.len()..].trim_start_matches('^');
                        let exponent = exponent
                            .parse::<i8>()
                            .map_err(|_| fail(&format!("{exponent:?} is not a whole exponent")))?;
                        (name, exponent)
                    }
                };
                let symbol = symbol(name).ok_or_else(|| {
                    fail(&format!("the symbol {name:?} is not known (known are SI units, deg, rpm, km/h, bar and the like){}", similar(name)))
                })?;
                unit = unit.times(symbol, sign * exponent);
            }
        }
        if parts.next().is_some() {
            return Err(fail("at most one '/' is allowed; N/(m.s) divides by both"));
        }
        Ok(unit)
    }

    fn times(self, other: Unit, exponent: i8) -> Unit {
        let mut exponents = self.exponents;
        for (sum, e) in exponents.iter_mut().zip(other.exponents) {
            *sum = sum.saturating_add(e.saturating_mul(exponent));
        }
        // Offsets (degC) only mean something where the unit stands alone.
        let offset = if self == ONE && exponent == 1 { other.offset } else { 0.0 };
        Unit { exponents, factor: self.factor * power(other.factor, exponent), offset }
    }

    /// How to turn a value in this unit into one in `target`: value * factor + offset.
    ///
    /// # Errors
    /// Another dimension.
    pub fn to(self, target: Unit) -> Option<(f64, f64)> {
        (self.exponents == target.exponents)
            .then(|| (self.factor / target.factor, (self.offset - target.offset) / target.factor))
    }
}

/// The number in a text such as `90 km/h`, `90km/h` or `25`, in the unit `own`; a number without unit is
/// in that unit already.
///
/// # Errors
/// No number, or a unit that does not convert.
pub fn quantity(text: &str, own: &str) -> Result<f64> {
    let text = text.trim();
    // the longest beginning that is a number
    let ends = (1..=text.len()).rev().filter(|end| text.is_char_boundary(*end));
    let number = ends.filter_map(|end| Some((text[..end].trim().parse::<f64>().ok()?, end))).next();
    let Some((number, end)) = number else {
        return Err(Error::variable(format!("{text:?} is not a number, or a number and a unit")));
    };
    let unit = text[end..].trim();
    if unit.is_empty() {
        return Ok(number);
    }
    match Unit::parse(unit)?.to(Unit::parse(own)?) {
        Some((factor, offset)) => Ok(number * factor + offset),
        None => Err(Error::variable(format!("{text:?} is not in a unit that converts to {own:?}"))),
    }
}

/// A sign of an exponent on the line.
fn lowered(c: char) -> char {
    match c {
        '²' => '2',
        '³' => '3',
        '¹' => '1',
        '⁻' => '-',
        '⁴' => '4',
        c => c,
    }
}

/// What stands between blanks; of nothing, nothing.
fn words(text: &str) -> impl Iterator<Item = &str> {
    let is_empty = text.trim().is_empty();
    text.split_whitespace().chain(is_empty.then_some(""))
}

/// A hint `; did you mean ...?` for a symbol that is not known, or nothing.
#[cfg(feature = "host")]
fn similar(name: &str) -> String {
    let prefixed = |symbol: &Symbol| {
        let prefixes = PREFIXES.iter().filter(|_| symbol.4).map(|(prefix, _)| *prefix);
        std::iter::once("").chain(prefixes).map(|prefix| format!("{prefix}{}", symbol.0)).collect::<Vec<_>>()
    };
    let all: Vec<String> = SYMBOLS.iter().flat_map(prefixed).collect();
    // a small letter for a capital one is the likeliest mistake; of several, the one with fewest of them
    let same = |known: &String| known.bytes().zip(name.bytes()).filter(|(a, b)| a == b).count();
    match all.iter().filter(|known| known.eq_ignore_ascii_case(name)).max_by_key(|known| same(known)) {
        Some(known) => format!("; did you mean {known:?}?"),
        None => super::did_you_mean(name, all.iter().map(String::as_str)),
    }
}

#[cfg(not(feature = "host"))]
fn similar(_name: &str) -> String {
    String::new()
}

/// A factor to a whole power, by squaring.
fn power(mut factor: f64, exponent: i8) -> f64 {
    let (mut rest, mut product) = (exponent.unsigned_abs(), 1.0);
    while rest > 0 {
        if rest % 2 == 1 {
            product *= factor;
        }
        factor *= factor;
        rest /= 2;
    }
    if exponent < 0 { 1.0 / product } else { product }
}

fn symbol(name: &str) -> Option<Unit> {
    let find = |name: &str, prefixed: bool| {
        SYMBOLS
            .iter()
            .find(|s| s.0 == name && (s.4 || !prefixed))
            .map(|&(_, exponents, factor, offset, _)| Unit { exponents, factor, offset })
    };
    find(name, false).or_else(|| {
        PREFIXES.iter().find_map(|(prefix, scale)| {
            let unit = find(name.strip_prefix(prefix)?, true)?;
            Some(Unit { factor: unit.factor * scale, ..unit })
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn converts_what_rigs_record() {
        for (from, to, value, expected) in [
            ("km/h", "m/s", 90.0, 25.0),
            ("deg", "rad", 180.0, std::f64::consts::PI),
            ("mm", "m", 12.5, 0.0125),
            ("kN", "N", 4.2, 4200.0),
            ("%", "1", 3.0, 0.03),
            ("bar", "Pa", 2.0, 2e5),
            ("deg/s", "rad/s", 90.0, std::f64::consts::FRAC_PI_2),
            ("rpm", "rad/s", 60.0, std::f64::consts::TAU),
            ("kN/mm", "N/m", 0.154, 1.54e5),
            ("m/s^2", "m/s2", 9.81, 9.81),
            ("N*m", "J", 5.0, 5.0),
            ("degC", "K", 22.0, 295.15),
            ("N.m.s/rad", "Nm.s/rad", 1.0, 1.0),
            ("1/min", "Hz", 60.0, 1.0),
            ("ms", "s", 5.0, 0.005),
            ("m/s²", "m/s2", 9.81, 9.81),
            ("s⁻¹", "1/s", 7.0, 7.0),
            ("N m", "Nm", 3.0, 3.0),
            ("N ⋅ mm", "Nmm", 3.0, 3.0),
            ("kgf", "N", 2.0, 19.6133),
            ("daN", "N", 2.0, 20.0),
            ("hPa", "Pa", 2.0, 200.0),
            ("Nmm", "N.m", 2500.0, 2.5),
            ("sec", "s", 2.0, 2.0),
            ("l/min", "m3/s", 60.0, 1e-3),
            ("°C", "K", 22.0, 295.15),
            ("μm", "µm", 4.0, 4.0),
            ("U/min", "rpm", 4.0, 4.0),
            ("deg/s", "rad/s", 180.0, std::f64::consts::PI),
        ] {
            let (factor, offset) = Unit::parse(from).unwrap().to(Unit::parse(to).unwrap()).unwrap();
            let result = value * factor + offset;
            assert!((result - expected).abs() <= 1e-12 * expected.abs(), "{value} {from} = {result} {to}");
        }
    }

    #[test]
    fn reads_quantities() {
        for (text, expected) in
            [("25", 25.0), (" 90 km/h", 25.0), ("90km/h", 25.0), ("1e-3 km/s", 1.0), ("-2mm/s", -0.002)]
        {
            assert!((quantity(text, "m/s").unwrap() - expected).abs() < 1e-12, "{text:?}");
        }
        for text in ["", "fast", "90 kg", "90 km / / h", "é"] {
            assert!(quantity(text, "m/s").is_err(), "{text:?}");
        }
    }

    #[test]
    fn refuses_other_dimensions_and_unknown_symbols() {
        let force = Unit::parse("N").unwrap();
        assert_eq!(force.to(Unit::parse("N.m").unwrap()), None);
        // A frequency is not an angular speed, however often they are confused.
        assert_eq!(Unit::parse("Hz").unwrap().to(Unit::parse("rad/s").unwrap()), None);
        for text in ["furlong", "", " ", "m//s", "m/s/s", "m^x", "N.", "N. .m", "kmin"] {
            assert!(Unit::parse(text).is_err(), "{text:?}");
        }
        for (text, meant) in [("NM", "\"Nm\""), ("KM/h", "\"km\""), ("Rad", "\"rad\""), ("barr", "\"bar\"")] {
            let message = Unit::parse(text).unwrap_err().to_string();
            assert!(message.contains(&format!("did you mean {meant}?")), "{message}");
        }
    }
}
