//! Lists of pairs in text parameters.

use crate::{Error, Result};

/// Reads `a b; c d; ...`, pairs of finite numbers up to `limit` in size; `name` is the parameter.
///
/// # Errors
/// Names the first pair that is none.
pub(super) fn pairs(name: &str, text: &str, limit: f64) -> Result<Vec<[f64; 2]>> {
    let text = text.trim().trim_end_matches(';');
    if text.is_empty() {
        return Ok(Vec::new());
    }
    let pair = |(i, pair): (usize, &str)| {
        let fail =
            |what: String| Error::variable(format!("{name}: pair {}, {:?}: {what}", i + 1, pair.trim()));
        let number = |word: &str| match word.parse::<f64>() {
            Ok(number) if number.abs() <= limit => Ok(number),
            Ok(_) => Err(fail(format!("{word} has to be finite and at most {limit} in size"))),
            Err(_) => Err(fail(format!("{word:?} is not a number (decimal point, no unit)"))),
        };
        let mut words = pair.split_whitespace();
        match (words.next(), words.next(), words.next()) {
            (Some(first), Some(second), None) => Ok([number(first)?, number(second)?]),
            _ => Err(fail(
                "a pair is two numbers with a space between them; pairs are separated by semicolons".into(),
            )),
        }
    };
    text.split(';').enumerate().map(pair).collect()
}
