//! Parameters that recordings say nothing about: numerics, numbers of parts, states at the start, the road. The author
//! of a model says which they are. Where nobody does, they are known by whole words of the name together with the
//! unit, never by a piece of it.

use crate::model::unit::Unit;
use crate::model::{Kind, Purpose, Variability, VariableInfo};

/// Exponents of kg, m, s, A, K, mol, cd, rad: of a second, of an acceleration, of a number.
type Dimension = [i8; 8];
const NUMBER: Dimension = [0; 8];
const SECOND: Dimension = [0, 0, 1, 0, 0, 0, 0, 0];
const ACCELERATION: Dimension = [0, 1, -2, 0, 0, 0, 0, 0];

/// Where the words of a rule stand in a name.
enum Place {
    /// They are the name.
    Whole,
    /// One behind the other, anywhere.
    Anywhere,
    /// At the beginning or the end.
    Edge,
    /// At the end.
    End,
}

/// Words and a dimension that tell what a parameter is.
struct Rule {
    words: &'static [&'static str],
    place: Place,
    /// The dimension that it has to have, if that matters.
    dimension: Option<Dimension>,
    why: &'static str,
}

const NUMERICS: &str = "it belongs to the numerics";
pub(super) const DATA: &str = "a file or data sheet gives it, and a few recordings do not tell it";
const COUNT: &str = "it is a number of parts";
const START: &str = "it is a state at the start, which runs do not share";
const CONSTANT: &str = "it is a known constant of nature";
const ROAD: &str = "the road that was driven on is given";

const fn rule(
    words: &'static [&'static str],
    place: Place,
    dimension: Option<Dimension>,
    why: &'static str,
) -> Rule {
    Rule { words, place, dimension, why }
}

const RULES: &[Rule] = &[
    rule(&["step", "size"], Place::Anywhere, Some(SECOND), NUMERICS),
    rule(&["sample", "time"], Place::Anywhere, Some(SECOND), NUMERICS),
    // a tolerance with a unit is a threshold of the machine
    rule(&["tolerance"], Place::Edge, Some(NUMBER), NUMERICS),
    rule(&["seed"], Place::Edge, Some(NUMBER), NUMERICS),
    rule(&["number", "of"], Place::Anywhere, Some(NUMBER), COUNT),
    rule(&["gravity"], Place::Anywhere, Some(ACCELERATION), CONSTANT),
    rule(&["g"], Place::Whole, Some(ACCELERATION), CONSTANT),
    rule(&["initial"], Place::Edge, None, START),
    rule(&["road", "start"], Place::Whole, None, ROAD),
    rule(&["road", "height"], Place::Whole, None, ROAD),
    rule(&["road", "length"], Place::Whole, None, ROAD),
    rule(&["road", "bevel"], Place::Whole, None, ROAD),
    rule(&["road", "spacing"], Place::Whole, None, ROAD),
    rule(&["road", "roughness"], Place::Whole, None, ROAD),
    rule(&["road", "direction"], Place::Whole, None, ROAD),
    rule(&["start"], Place::End, None, START),
    rule(&["start", "time"], Place::Whole, Some(SECOND), START),
];

/// Why a parameter is given and not fitted, if it is.
pub(super) fn why_given(info: &VariableInfo) -> Option<&'static str> {
    match (&info.kind, info.variability) {
        (Kind::Real, Variability::Fixed | Variability::Tunable) => {}
        (Kind::Real, _) => return Some("it is a constant of the model"),
        _ => return Some("it is no real number"),
    }
    if let Some(meaning) = info.meaning {
        return match meaning.purpose {
            Purpose::Physics => None,
            Purpose::Data => Some(DATA),
            Purpose::Numerics => Some(NUMERICS),
            Purpose::Start => Some(START),
            Purpose::Constant => Some(CONSTANT),
            Purpose::Surroundings => Some(ROAD),
        };
    }
    let words = words(info.name.rsplit('.').next().unwrap_or_default());
    // a unit that is not known has no dimension that a rule could ask for
    let dimension = Unit::parse(info.unit.as_deref().unwrap_or("1")).ok().map(|unit| unit.exponents);
    let holds = |rule: &&Rule| {
        let own: Vec<&str> = words.iter().map(String::as_str).collect();
        let named = match rule.place {
            Place::Whole => own == rule.words,
            Place::Anywhere => own.windows(rule.words.len()).any(|some| some == rule.words),
            Place::Edge => own.starts_with(rule.words) || own.ends_with(rule.words),
            Place::End => own.ends_with(rule.words),
        };
        named && rule.dimension.is_none_or(|needed| dimension == Some(needed))
    };
    RULES.iter().find(holds).map(|rule| rule.why)
}

/// The words of a name in lower case: `stepSize_2` is step, size, 2.
fn words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut last = '_';
    for c in name.chars() {
        let begins = !last.is_alphanumeric()
            || (c.is_uppercase() && last.is_lowercase())
            || c.is_numeric() != last.is_numeric();
        if c.is_alphanumeric() {
            if begins {
                words.push(String::new());
            }
            if let Some(word) = words.last_mut() {
                word.extend(c.to_lowercase());
            }
        }
        last = c;
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Causality, Initial, Value};

    fn real(name: &str, unit: &str) -> VariableInfo {
        VariableInfo {
            name: name.into(),
            reference: 0,
            description: String::new(),
            unit: Some(unit.into()),
            kind: Kind::Real,
            causality: Causality::Parameter,
            variability: Variability::Tunable,
            initial: Some(Initial::Exact),
            start: Some(Value::Real(1.0)),
            min: None,
            max: None,
            nominal: None,
            meaning: None,
        }
    }

    #[test]
    fn names_are_taken_by_words() {
        assert_eq!(words("stepSize_2"), ["step", "size", "2"]);
        assert_eq!(words("p[3].kV"), ["p", "3", "k", "v"]);
        assert_eq!(words("road_filter_length"), ["road", "filter", "length"]);
        assert!(words("__").is_empty());
        for (name, unit) in [
            ("step_size", "s"),
            ("solver.stepSize", "ms"),
            ("relative_tolerance", "1"),
            ("initial_speed", "m/s"),
            ("x_start", "m"),
            ("g", "m/s2"),
            ("world.gravity", "m/s2"),
            ("noise_seed", "1"),
        ] {
            assert!(why_given(&real(name, unit)).is_some(), "{name}");
        }
        // what has such a word inside another one, in another place or with another unit is none of them
        for (name, unit) in [
            ("friction_sliding_reference", "1"),
            ("reference_ascent", "m/s2"),
            ("speed_tolerance", "m/s"),
            ("starter_torque", "N.m"),
            ("start_torque", "N.m"),
            ("initialism", "1"),
            ("actuator_gain", "1"),
            ("seeding_rate", "1"),
            ("broad_stiffness", "N/m"),
            ("road_friction", "1"),
            ("g", "N/m"),
        ] {
            assert_eq!(why_given(&real(name, unit)), None, "{name}");
        }
    }
}
