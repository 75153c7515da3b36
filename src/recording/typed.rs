//! Files whose columns are numbers already: they become recordings by the rules that hold for the cells of a CSV file.

use super::Recording;
use super::csv::TIME;
use super::form::{Defect, MAX_COLUMNS, long_enough, out_of_order};
use super::header::{Columns, Header, Titles};
use crate::{Error, Result};

/// A column as it is in a file: what stands above it, `name [unit]` or a name alone, and its numbers; what is not a number is missing.
pub(super) struct TypedColumn {
    pub title: String,
    pub values: Vec<f64>,
}

/// The most numbers that are read of one file: 4 GiB of memory.
pub(super) const MAX_NUMBERS: usize = 1 << 29;

fn titles(columns: &[TypedColumn]) -> Titles {
    Titles { names: columns.iter().map(|c| c.title.as_str()).collect(), line: None, units: None }
}

/// Which of the columns is the time, if any is.
pub(super) fn time_of(columns: &[TypedColumn], names: &Columns) -> usize {
    titles(columns).time(&TIME, names)
}

/// The recording that columns of one length make, with what [`read_csv`](super::read_csv) refuses of single cells and rows.
///
/// # Errors
/// What a header of a CSV file is refused for; fewer than two rows.
pub(super) fn recording_of(
    columns: Vec<TypedColumn>,
    names: &Columns,
    source: &str,
) -> Result<(Recording, Vec<Defect>)> {
    if columns.len() > MAX_COLUMNS {
        return Err(Error::file(format!(
            "{source}: it has {} columns; no more than {MAX_COLUMNS} are read",
            columns.len()
        )));
    }
    let titles = titles(&columns);
    let Header { mut recording, columns: called, places, factor } =
        Header::parse(&TIME, names, &titles, source)?;
    let mut defects = Vec::new();
    for ((column, place), called) in columns.into_iter().zip(places).zip(&called) {
        let Some(channel) = place else { continue };
        let at = |row: usize| format!("{source}: {called}, row {}", row + 1);
        let missing = column.values.iter().enumerate().filter(|(_, value)| !value.is_finite());
        defects.extend(missing.map(|(row, value)| Defect {
            row,
            channel,
            error: Error::file(format!("{}: {value} is no finite number", at(row))),
        }));
        let Some(channel) = channel else {
            for (row, value) in column.values.into_iter().enumerate() {
                let time = value * factor;
                if let Some(error) = out_of_order(&TIME, &recording, time, &|| at(row)) {
                    defects.push(Defect { row, channel: None, error });
                }
                recording.time.push(time);
            }
            continue;
        };
        recording.channels[channel].values = column.values;
    }
    Ok((long_enough(recording)?, defects))
}

/// That a recording has no defects.
///
/// # Errors
/// The first, and how many more there are.
pub(super) fn faultless((recording, defects): (Recording, Vec<Defect>)) -> Result<Recording> {
    let more = defects.len().saturating_sub(1);
    match defects.into_iter().next() {
        None => Ok(recording),
        Some(first) if more == 0 => Err(first.error),
        Some(first) => Err(Error::file(format!("{} (and {more} more)", first.error))),
    }
}

/// Inflates what is no longer than said.
///
/// # Errors
/// What is wrong with it.
pub(super) fn inflated(packed: &[u8], length: usize) -> std::result::Result<Vec<u8>, String> {
    use std::io::Read;
    let mut bytes = Vec::new();
    let mut reader = flate2::read::ZlibDecoder::new(packed).take(length as u64 + 1);
    reader.read_to_end(&mut bytes).map_err(|e| format!("what is compressed in it is damaged: {e}"))?;
    if bytes.len() > length {
        return Err(format!("what is compressed in it is longer than the {length} bytes that it may have"));
    }
    Ok(bytes)
}
