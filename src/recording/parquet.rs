//! Recordings as Apache Parquet, as data frames of Python write them: columns `name [unit]`, or names alone with a map that has the units.

use super::Recording;
use super::form::{Defect, check_lengths, read_bytes};
use super::header::Columns;
use super::typed::{MAX_NUMBERS, TypedColumn, recording_of, time_of};
use crate::{Error, Result, VERSION};
use ::parquet::basic::{ConvertedType, LogicalType, Repetition, Type as Physical};
use ::parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use ::parquet::data_type::{DataType, DoubleType};
use ::parquet::file::properties::WriterProperties;
use ::parquet::file::reader::{FileReader, SerializedFileReader};
use ::parquet::file::writer::SerializedFileWriter;
use ::parquet::schema::types::{ColumnDescriptor, Type};
use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};
use std::path::Path;
use std::sync::{Arc, Once};

/// What the names of Parquet files end in, in small letters.
pub const PARQUET_ENDINGS: [&str; 2] = ["parquet", "pq"];

/// Rows that stand together, column after column.
const ROWS: usize = 1 << 20;

type Read<T> = std::result::Result<T, String>;

/// Reads a Parquet file: columns of numbers. Others (texts, dates, lists) are left out, and refused where `names` names them. Missing values are
/// not numbers.
///
/// # Errors
/// A file that cannot be read, is damaged or compressed in a way that is not read; what the header of a CSV file is refused for.
pub(super) fn read_parquet(path: &Path, names: &Columns) -> Result<(Recording, Vec<Defect>)> {
    let (bytes, source) = read_bytes(path)?;
    parse_parquet(bytes, names, &source)
}

/// Reads the bytes of a Parquet file, see [`read_parquet`]; `source` stands for its name in messages.
///
/// # Errors
/// As [`read_parquet`].
pub(super) fn parse_parquet(
    bytes: Vec<u8>,
    names: &Columns,
    source: &str,
) -> Result<(Recording, Vec<Defect>)> {
    let columns = without_panic(|| columns(bytes, names)).unwrap_or_else(|| Err("it is damaged".into()));
    recording_of(columns.map_err(|what| Error::file(format!("{source}: {what}")))?, names, source)
}

/// What is made, and nothing where that panics, as the library does over some damaged files. It does so in silence.
fn without_panic<T>(make: impl FnOnce() -> T) -> Option<T> {
    thread_local! {
        static IS_SILENT: Cell<bool> = const { Cell::new(false) };
    }
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let before = panic::take_hook();
        panic::set_hook(Box::new(move |about| {
            if !IS_SILENT.get() {
                before(about);
            }
        }));
    });
    IS_SILENT.set(true);
    let made = panic::catch_unwind(AssertUnwindSafe(make));
    IS_SILENT.set(false);
    made.ok()
}

fn columns(bytes: Vec<u8>, names: &Columns) -> Read<Vec<TypedColumn>> {
    let failed = |e: ::parquet::errors::ParquetError| format!("it cannot be read as Parquet: {e}");
    let file = SerializedFileReader::new(bytes::Bytes::from(bytes)).map_err(failed)?;
    let described = file.metadata().file_metadata().schema_descr_ptr();
    let mut columns = Vec::new();
    let mut places = Vec::new();
    for (k, column) in described.columns().iter().enumerate() {
        let title = column.path().string();
        match no_numbers(column) {
            None => {
                columns.push(TypedColumn { title, values: Vec::new() });
                places.push((k, column));
            }
            Some(why) if names.of(&title).is_some_and(|column| column.variable.is_some()) => {
                return Err(format!("the column {title:?} cannot be read: {why}"));
            }
            Some(_) => {}
        }
    }
    let time = time_of(&columns, names);
    let mut room = MAX_NUMBERS;
    for (own, (k, described)) in places.into_iter().enumerate() {
        let column = &mut columns[own];
        if own != time && names.leaves_out(&column.title) {
            continue;
        }
        for group in 0..file.num_row_groups() {
            let reader = file.get_row_group(group).map_err(failed)?.get_column_reader(k).map_err(failed)?;
            append(reader, described, &mut room, &mut column.values)?;
        }
    }
    Ok(columns)
}

/// Why a column is none of numbers.
fn no_numbers(column: &ColumnDescriptor) -> Option<&'static str> {
    if column.max_rep_level() > 0 || column.max_def_level() > 1 {
        return Some("it is of lists or structures");
    }
    match column.logical_type_ref() {
        None | Some(LogicalType::Integer(_)) => {}
        Some(LogicalType::Timestamp(_) | LogicalType::Date | LogicalType::Time(_)) => {
            return Some("it is of dates or times of day; a time in seconds is a number");
        }
        Some(LogicalType::String | LogicalType::Json | LogicalType::Enum) => return Some("it is text"),
        Some(_) => return Some("it is of no plain numbers"),
    }
    match (column.converted_type(), column.physical_type()) {
        (_, Physical::BYTE_ARRAY | Physical::FIXED_LEN_BYTE_ARRAY) => Some("it is text or bytes"),
        (_, Physical::INT96) => Some("it is of dates"),
        (
            ConvertedType::NONE
            | ConvertedType::INT_8
            | ConvertedType::INT_16
            | ConvertedType::INT_32
            | ConvertedType::INT_64
            | ConvertedType::UINT_8
            | ConvertedType::UINT_16
            | ConvertedType::UINT_32
            | ConvertedType::UINT_64,
            _,
        ) => None,
        _ => Some("it is of no plain numbers"),
    }
}

fn append(
    reader: ColumnReader,
    column: &ColumnDescriptor,
    room: &mut usize,
    values: &mut Vec<f64>,
) -> Read<()> {
    let is_unsigned = matches!(
        column.converted_type(),
        ConvertedType::UINT_8 | ConvertedType::UINT_16 | ConvertedType::UINT_32 | ConvertedType::UINT_64
    );
    let mut into = Appended { is_nullable: column.max_def_level() > 0, room, values };
    match reader {
        ColumnReader::BoolColumnReader(reader) => into.append(reader, |v| f64::from(u8::from(*v))),
        ColumnReader::Int32ColumnReader(reader) if is_unsigned => {
            into.append(reader, |v| f64::from(v.cast_unsigned()))
        }
        ColumnReader::Int32ColumnReader(reader) => into.append(reader, |v| f64::from(*v)),
        ColumnReader::Int64ColumnReader(reader) if is_unsigned => {
            into.append(reader, |v| v.cast_unsigned() as f64)
        }
        ColumnReader::Int64ColumnReader(reader) => into.append(reader, |v| *v as f64),
        ColumnReader::FloatColumnReader(reader) => into.append(reader, |v| f64::from(*v)),
        ColumnReader::DoubleColumnReader(reader) => into.append(reader, |v| *v),
        _ => Err("a column is not what the file says of it".into()),
    }
}

/// Where the values of a column go.
struct Appended<'a> {
    is_nullable: bool,
    room: &'a mut usize,
    values: &'a mut Vec<f64>,
}

impl Appended<'_> {
    fn append<T: DataType>(
        &mut self,
        mut reader: ColumnReaderImpl<T>,
        number: impl Fn(&T::T) -> f64,
    ) -> Read<()> {
        loop {
            let (mut levels, mut present) = (Vec::new(), Vec::new());
            let (records, _, _) = reader
                .read_records(ROWS, Some(&mut levels), None, &mut present)
                .map_err(|e| format!("it cannot be read as Parquet: {e}"))?;
            if records == 0 {
                return Ok(());
            }
            *self.room = self.room.checked_sub(records).ok_or_else(|| {
                format!("it has more than {MAX_NUMBERS} numbers; a map can leave out columns")
            })?;
            let mut present = present.iter().map(&number);
            if self.is_nullable {
                let all = levels.iter().map(|level| if *level > 0 { present.next() } else { None });
                self.values.extend(all.map(|value| value.unwrap_or(f64::NAN)));
            } else {
                self.values.extend(present);
            }
        }
    }
}

/// Writes a recording as Parquet that [`read_parquet`] reads back with the same bits, whole or not at all. Values that are not finite are written as
/// they are, as in CSV.
///
/// # Errors
/// Channels that are not as long as the time; any failure of the file system, with the path.
pub(super) fn write_parquet(path: &Path, recording: &Recording) -> Result<()> {
    check_lengths(recording).map_err(|e| e.at(path.display()))?;
    let bytes = to_parquet(recording)
        .map_err(|e| Error::file(format!("{} cannot be written: {e}", path.display())))?;
    crate::file::write_file(path, &bytes)
}

/// The bytes that [`write_parquet`] writes.
pub(super) fn to_parquet(recording: &Recording) -> ::parquet::errors::Result<Vec<u8>> {
    let titles = recording.channels.iter().map(|c| format!("{} [{}]", c.name, c.unit));
    let fields = std::iter::once("time [s]".to_owned()).chain(titles).map(|title| {
        let field = Type::primitive_type_builder(&title, Physical::DOUBLE);
        field.with_repetition(Repetition::REQUIRED).build().map(Arc::new)
    });
    let fields = fields.collect::<::parquet::errors::Result<Vec<_>>>()?;
    let schema = Arc::new(Type::group_type_builder("recording").with_fields(fields).build()?);
    let properties = WriterProperties::builder().set_created_by(format!("latsch {VERSION}")).build();
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, schema, Arc::new(properties))?;
    for start in (0..recording.time.len()).step_by(ROWS) {
        let rows = start..(start + ROWS).min(recording.time.len());
        let mut group = writer.next_row_group()?;
        let channels = recording.channels.iter().map(|channel| &channel.values);
        for values in std::iter::once(&recording.time).chain(channels) {
            let mut column = group
                .next_column()?
                .ok_or_else(|| ::parquet::errors::ParquetError::General("a column has no place".into()))?;
            column.typed::<DoubleType>().write_batch(&values[rows.clone()], None, None)?;
            column.close()?;
        }
        group.close()?;
    }
    writer.close()?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::Channel;
    use crate::recording::typed::faultless;
    use proptest::prelude::*;

    fn recording(rows: usize) -> Recording {
        let time: Vec<f64> = (0..rows).map(|k| 0.1 + k as f64 * 1e-3).collect();
        let channel = |name: &str, f: fn(f64) -> f64| Channel {
            name: name.into(),
            unit: "N".into(),
            values: time.iter().map(|t| f(*t)).collect(),
        };
        let channels = vec![channel("left.force_z", |t| 1.0 / t), channel("x[1]", |_| -0.0)];
        Recording { time, channels, source: "rig.parquet".into() }
    }

    fn read(bytes: Vec<u8>) -> Result<Recording> {
        faultless(parse_parquet(bytes, &Columns::default(), "rig.parquet")?)
    }

    #[test]
    fn what_is_written_is_read_to_the_last_bit() {
        for rows in [2, 5000] {
            let original = recording(rows);
            let back = read(to_parquet(&original).unwrap()).unwrap();
            assert_eq!(back, original);
            assert!(back.channels[1].values.iter().all(|v| v.is_sign_negative()));
        }
    }

    proptest! {
        /// Whatever is wrong with a file, it is a recording or an error.
        #[test]
        fn damage_is_an_error(at in 0usize..2000, byte: u8, cut in 0usize..2500) {
            let mut bytes = to_parquet(&recording(20)).unwrap();
            let at = at % bytes.len();
            bytes[at] = byte;
            let _ = read(bytes.clone());
            bytes.truncate(cut);
            let _ = read(bytes);
        }
    }
}
