//! The lines of `**MEASURCHANNELS` and `**CONSTANTS`: name, comment, unit and numbers, in columns or apart from each other.

use super::channels::unit;
use crate::model::unit::Unit;

/// Where fields begin \[characters\]: name, comment, unit, and three numbers.
const FIELDS: [usize; 6] = [0, 10, 40, 50, 60, 70];

/// A line that has been understood.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// In capitals.
    pub name: String,
    /// In the notation of recordings, and known there; `None` where the file names none.
    pub unit: Option<String>,
    /// What stands behind the unit; what is not there is `None`.
    pub numbers: [Option<f64>; 3],
}

/// A line as it could be meant.
struct Candidate<'a> {
    unit: String,
    numbers: [&'a str; 3],
}

/// Reads a line with at most `most` numbers. Files do not all keep to the columns: a line that makes no sense in columns is
/// one of words with blanks between, and where comment and unit touch, only columns tell them apart.
///
/// # Errors
/// What is wrong with the line.
pub fn record(line: &str, most: usize) -> Result<Record, String> {
    let name = name(line)?;
    let candidates = [columns(line, most, false), words(line, most), columns(line, most, true)];
    let mut wrong = None;
    for candidate in candidates.into_iter().flatten() {
        match candidate.understood() {
            Ok((unit, numbers)) => return Ok(Record { name, unit, numbers }),
            Err(what) => wrong = wrong.or(Some(what)),
        }
    }
    Err(wrong.unwrap_or_else(|| "there is nothing behind the name; a unit is needed, - for none".into()))
}

/// The name at the beginning of a line, in capitals.
///
/// # Errors
/// What stands there is no name.
pub fn name(line: &str) -> Result<String, String> {
    let field = slice(line, 0, FIELDS[1]);
    let word = field.split_whitespace().next().unwrap_or("");
    let is_name = word.starts_with(|c: char| c.is_ascii_alphabetic())
        && word.chars().all(|c| c.is_ascii_graphic() && c != '!');
    if is_name {
        return Ok(word.to_ascii_uppercase());
    }
    Err(format!("{word:?} is no name; a line has to begin with one, a comment with !"))
}

/// The fields in their columns. `None` if the line does not look as if it kept to them: fields with several words, or,
/// unless `touching`, words that reach from one field into the next.
fn columns(line: &str, most: usize, touching: bool) -> Option<Candidate<'_>> {
    let crosses = |at: usize| {
        let pair = slice(line, at - 1, at + 1);
        pair.chars().count() == 2 && !pair.contains(char::is_whitespace)
    };
    let checked: &[usize] = if touching { &FIELDS[3..4] } else { &FIELDS[1..4] };
    if line.contains('\t') || checked.iter().any(|at| crosses(*at)) {
        return None;
    }
    let unit = slice(line, FIELDS[2], FIELDS[3]).trim();
    let mut numbers = [""; 3];
    for (i, number) in numbers.iter_mut().enumerate().take(most) {
        let end = if i + 1 == most { usize::MAX } else { FIELDS[i + 4] };
        *number = slice(line, FIELDS[i + 3], end).trim();
    }
    let one_word = |text: &&str| text.split_whitespace().count() <= 1;
    // without both, the fields of a narrower line have been looked for in vain
    let empty = unit.is_empty() && numbers[0].is_empty();
    let fits = !empty && (one_word(&unit) || unit == "deg C") && numbers.iter().all(one_word);
    fits.then(|| Candidate { unit: unit.into(), numbers })
}

/// The words of a line: the numbers at its end, before them the unit.
fn words(line: &str, most: usize) -> Option<Candidate<'_>> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let is_number = |word: &&&str| word.parse::<f64>().is_ok();
    let count =
        words.iter().rev().take(most).take_while(is_number).count().min(words.len().saturating_sub(2));
    let (front, back) = words.split_at(words.len() - count);
    let unit = match front {
        [_, .., "deg", "C"] => "deg C".into(),
        [_, .., unit] => (*unit).to_owned(),
        _ => return None,
    };
    let mut numbers = [""; 3];
    numbers.iter_mut().zip(back).for_each(|(number, word)| *number = word);
    Some(Candidate { unit, numbers })
}

impl Candidate<'_> {
    fn understood(&self) -> Result<(Option<String>, [Option<f64>; 3]), String> {
        let mut numbers = [None; 3];
        for (number, text) in numbers.iter_mut().zip(self.numbers) {
            *number = match text.parse::<f64>() {
                _ if text.is_empty() => None,
                Ok(value) if value.is_finite() => Some(value),
                _ => return Err(format!("{text:?} is no finite number")),
            };
        }
        let unit = unit(&self.unit);
        if unit.is_empty() {
            return Ok((None, numbers));
        }
        Unit::parse(unit).map_err(|e| format!("{e}; write - for a number without unit"))?;
        Ok((Some(unit.into()), numbers))
    }
}

/// Characters `from` to `to` of a line, as far as it goes.
pub fn slice(line: &str, from: usize, to: usize) -> &str {
    let byte = |n: usize| match line.is_ascii() {
        true => n.min(line.len()),
        false => line.char_indices().nth(n).map_or(line.len(), |(byte, _)| byte),
    };
    &line[byte(from)..byte(to)]
}
