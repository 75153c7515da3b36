//! Lists of numbers in text parameters.

use crate::{Error, Result};

/// Reads `a b; c d; ...`, groups of N finite numbers up to `limit` in size; `name` is the parameter.
///
/// # Errors
/// Names the first group that is none.
pub fn groups<const N: usize>(name: &str, text: &str, limit: f64) -> Result<Vec<[f64; N]>> {
    let text = text.trim().trim_end_matches(';');
    if text.is_empty() {
        return Ok(Vec::new());
    }
    let what = if N == 2 { "pair" } else { "group" };
    let many = if N == 2 { "two".to_owned() } else { N.to_string() };
    let group = |(i, group): (usize, &str)| {
        let fail =
            |why: String| Error::variable(format!("{name}: {what} {}, {:?}: {why}", i + 1, group.trim()));
        let number = |word: &str| match word.parse::<f64>() {
            Ok(number) if number.abs() <= limit => Ok(number),
            Ok(_) => Err(fail(format!("{word} has to be finite and at most {limit} in size"))),
            Err(_) => Err(fail(format!("{word:?} is not a number (decimal point, no unit)"))),
        };
        let words: Vec<&str> = group.split_whitespace().collect();
        let Ok(words) = <[&str; N]>::try_from(words) else {
            return Err(fail(format!(
                "a {what} is {many} numbers with a space between them; {what}s are separated by semicolons"
            )));
        };
        let mut numbers = [0.0; N];
        for (place, word) in numbers.iter_mut().zip(words) {
            *place = number(word)?;
        }
        Ok(numbers)
    };
    text.split(';').enumerate().map(group).collect()
}
