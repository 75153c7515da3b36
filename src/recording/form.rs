//! What all forms of files share: how much is read, and which recordings can be written.

use super::Recording;
use super::header::Axis;
use crate::bounded;
use crate::{Error, Result};
use std::path::Path;

/// A longer file is not read \[bytes\]: 4 GiB, an hour of a hundred channels at 1 kHz.
pub(super) const MAX_LENGTH: u64 = 4 << 30;
/// Files with more columns are refused: a column takes a hundred bytes in memory, and in the file perhaps one.
pub(super) const MAX_COLUMNS: usize = 100_000;

/// Text is passed on to the file in pieces of about this length \[bytes\].
pub(super) const BLOCK: usize = 1 << 16;

/// Something that reading refuses, but that leaves the other rows readable.
pub(crate) struct Defect {
    /// Index of the row among the rows of numbers.
    pub row: usize,
    /// The channel, `None` for the time or the whole row.
    pub channel: Option<usize>,
    /// What is wrong, as a sentence.
    pub error: Error,
}

/// The bytes of a file of recordings, and its name for messages.
///
/// # Errors
/// A file that cannot be read or is too long.
pub(super) fn read_bytes(path: &Path) -> Result<(Vec<u8>, String)> {
    let source = path.display().to_string();
    match bounded::read(path, MAX_LENGTH) {
        Ok(bytes) => Ok((bytes, source)),
        Err(e) => Err(Error::file(format!("{source} cannot be read: {e}"))),
    }
}

/// That channels are as long as the time.
///
/// # Errors
/// The first that is not.
pub(super) fn check_lengths(recording: &Recording) -> Result<()> {
    let rows = recording.time.len();
    match recording.channels.iter().find(|c| c.values.len() != rows) {
        None => Ok(()),
        Some(channel) => Err(Error::file(format!(
            "channel {:?} has {} values for {rows} times",
            channel.name,
            channel.values.len()
        ))),
    }
}

/// That there are two rows.
pub(super) fn long_enough(recording: Recording) -> Result<Recording> {
    match recording.time.len() {
        n @ (0 | 1) => Err(Error::file(format!(
            "{}: {n} row{} of numbers; at least 2 are needed",
            recording.source,
            if n == 1 { "" } else { "s" }
        ))),
        _ => Ok(recording),
    }
}

/// What is wrong with `time` as the next one of the recording, at a place in it.
pub(super) fn out_of_order(
    axis: &Axis,
    recording: &Recording,
    time: f64,
    place: &dyn Fn() -> String,
) -> Option<Error> {
    let Axis { name, unit, repeats, .. } = axis;
    let before =
        recording.time.last().filter(|before| if *repeats { time < **before } else { time <= **before })?;
    let rule = if *repeats { "must not decrease" } else { "has to increase" };
    Some(Error::file(format!(
        "{}: {time} {unit} comes after {before} {unit}; {name} {rule} from row to row",
        place()
    )))
}
