//! Tire property files (`.tir`): text files of sections `[NAME]`, assignments `KEY = value`, tables and comments.
//!
//! [`Document`] keeps every byte of a file and knows where its keys and values are: what is not changed is written as it
//! was read, comments, blank lines, tables and unknown sections included. [`read`] makes a Magic Formula tire of a
//! document, [`write()`] puts changed coefficients back into it, [`create`] writes a file from nothing. [`settings`] makes
//! parameters of a model of either kind of file, [`change`] puts them back.

mod document;
mod magic_formula;
mod settings;
mod super_elastic;
mod units;

pub use document::{Document, Entry, MAX_BYTES, MAX_ENTRIES, Note, Row, Value};
pub(crate) use document::{number, number_text, shown};
pub use magic_formula::{Reading, Side, create, read, write};
pub use settings::{Kind, TireFile, change, create_super_elastic, settings};
pub use units::Units;

#[cfg(test)]
mod super_elastic_tests;
#[cfg(test)]
#[allow(clippy::field_reassign_with_default)] // one coefficient a line
mod tests;
