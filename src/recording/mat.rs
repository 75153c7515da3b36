//! Recordings as MATLAB files of version 5 to 7 (`save -v6`, `-v7`): variables that are vectors, by themselves or in structures. They have no units: a map
//! says them, and which variable is the time.

use super::Recording;
use super::form::{Defect, MAX_COLUMNS, MAX_LENGTH, read_bytes};
use super::header::Columns;
use super::typed::{MAX_NUMBERS, TypedColumn, inflated, recording_of};
use crate::{Error, Result};
use std::path::Path;

/// What the names of MATLAB files end in, in small letters.
pub const MAT_ENDINGS: [&str; 1] = ["mat"];

/// Reads a MATLAB file. `names` says what its variables are: `data.Fz` is the field of a structure, `F(:,2)` a column of a matrix.
///
/// # Errors
/// A file that cannot be read, is none of version 5 to 7, or is damaged; no variable that is said to be the time; one that is named and no
/// vector as long as that.
pub(super) fn read_mat(path: &Path, names: &Columns) -> Result<(Recording, Vec<Defect>)> {
    let (bytes, source) = read_bytes(path)?;
    parse_mat(&bytes, names, &source)
}

/// Reads the bytes of a MATLAB file, see [`read_mat`]; `source` stands for its name in messages.
///
/// # Errors
/// As [`read_mat`].
pub(super) fn parse_mat(bytes: &[u8], names: &Columns, source: &str) -> Result<(Recording, Vec<Defect>)> {
    let columns = columns(bytes, names).map_err(|what| Error::file(format!("{source}: {what}")))?;
    recording_of(columns, names, source)
}

type Read<T> = std::result::Result<T, String>;

/// A variable or a field of one.
struct Variable {
    name: String,
    content: Content,
}

enum Content {
    /// Column after column.
    Numbers { rows: usize, values: Vec<f64> },
    /// What it is in place of numbers.
    Other(&'static str),
}

fn columns(bytes: &[u8], names: &Columns) -> Read<Vec<TypedColumn>> {
    let variables = variables(bytes)?;
    let vectors = vectors(variables);
    let is_time =
        |name: &str| names.of(name).is_some_and(|column| column.variable.as_deref() == Some("time"));
    let Some(time) = vectors.iter().position(|(name, _)| is_time(name)) else {
        return Err(format!(
            "its variables have no units, and none is said to be the time: a file of --map says both, as \"t\" = {{ variable = \"time\", unit = \"s\" }} below [channels]; there are {}",
            told(&vectors)
        ));
    };
    let rows = match &vectors[time].1 {
        Content::Numbers { values, .. } => values.len(),
        Content::Other(what) => {
            return Err(format!("{:?} is said to be the time, and is {what}", vectors[time].0));
        }
    };
    let mut columns = Vec::new();
    for (name, content) in vectors {
        let is_named = names.of(&name).is_some_and(|column| column.variable.is_some());
        match content {
            Content::Numbers { values, .. } if values.len() == rows && !names.leaves_out(&name) => {
                let at = if is_time(&name) { 0 } else { columns.len() };
                columns.insert(at, TypedColumn { title: name, values });
            }
            Content::Numbers { values, .. } if is_named => {
                return Err(format!("{name:?} has {} values, and the time {rows}", values.len()));
            }
            Content::Other(what) if is_named => return Err(format!("{name:?} is {what}")),
            _ => {}
        }
    }
    Ok(columns)
}

/// Vectors as they are, matrices column by column.
fn vectors(variables: Vec<Variable>) -> Vec<(String, Content)> {
    let mut vectors = Vec::new();
    for Variable { name, content } in variables {
        match content {
            Content::Numbers { rows, values } if rows > 1 && rows < values.len() => {
                let columns = values.chunks_exact(rows).enumerate();
                vectors.extend(columns.map(|(k, column)| {
                    let content = Content::Numbers { rows, values: column.to_vec() };
                    (format!("{name}(:,{})", k + 1), content)
                }));
            }
            content => vectors.push((name, content)),
        }
    }
    vectors
}

/// What there is, for a message.
fn told(vectors: &[(String, Content)]) -> String {
    let one = |(name, content): &(String, Content)| match content {
        Content::Numbers { values, .. } => format!("{name} ({})", values.len()),
        Content::Other(what) => format!("{name} ({what})"),
    };
    let some: Vec<String> = vectors.iter().take(12).map(one).collect();
    match vectors.len() {
        0 => "none".into(),
        n if n > some.len() => format!("{} and {} more", some.join(", "), n - some.len()),
        _ => some.join(", "),
    }
}

fn variables(bytes: &[u8]) -> Read<Vec<Variable>> {
    let head =
        bytes.get(..128).ok_or("this is no MATLAB file of version 5 to 7: it has less than 128 bytes")?;
    if head.starts_with(b"MATLAB 7.3") {
        return Err("it is of version 7.3, an HDF5 file, which is not read: save it with -v7".into());
    }
    let is_big_endian = match &head[126..] {
        b"IM" => false,
        b"MI" => true,
        _ => return Err("this is no MATLAB file of version 5 to 7".into()),
    };
    let mut reading = Reading { is_big_endian, variables: Vec::new(), numbers: 0 };
    let mut rest = &bytes[128..];
    while !rest.is_empty() {
        let (kind, data, behind) = reading.element(rest)?;
        rest = behind;
        match kind {
            MATRIX => reading.matrix(data, "", DEPTH)?,
            COMPRESSED => {
                let room = MAX_LENGTH as usize;
                let inner = inflated(data, room)?;
                let (kind, data, _) = reading.element(&inner)?;
                if kind == MATRIX {
                    reading.matrix(data, "", DEPTH)?;
                }
            }
            _ => {}
        }
    }
    Ok(reading.variables)
}

/// Types of elements.
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
/// Structures within structures.
const DEPTH: usize = 8;

struct Reading {
    is_big_endian: bool,
    variables: Vec<Variable>,
    numbers: usize,
}

impl Reading {
    fn u32(&self, bytes: &[u8], at: usize) -> Read<u32> {
        let word = bytes.get(at..at + 4).and_then(|word| word.try_into().ok());
        let word: [u8; 4] = word.ok_or("it is cut off")?;
        Ok(if self.is_big_endian { u32::from_be_bytes(word) } else { u32::from_le_bytes(word) })
    }

    /// The first element: its type and its data, and what is behind it.
    fn element<'a>(&self, bytes: &'a [u8]) -> Read<(u32, &'a [u8], &'a [u8])> {
        let first = self.u32(bytes, 0)?;
        let (kind, start, length, end) = match first >> 16 {
            0 => {
                let length = self.u32(bytes, 4)? as usize;
                let padded = if first == COMPRESSED { length } else { length.next_multiple_of(8) };
                (first, 8, length, 8 + padded)
            }
            // up to four bytes stand in the head
            length => (first & 0xffff, 4, length as usize, 8),
        };
        let data = bytes.get(start..start + length).ok_or("it is cut off")?;
        // the last element may lack what fills it up
        Ok((kind, data, bytes.get(end..).unwrap_or_default()))
    }

    /// A variable, a field or an element of one.
    fn matrix(&mut self, bytes: &[u8], within: &str, depth: usize) -> Read<()> {
        if bytes.is_empty() {
            return Ok(());
        }
        let (_, flags, rest) = self.element(bytes)?;
        let flags = self.u32(flags, 0)?;
        let (_, dimensions, rest) = self.element(rest)?;
        let dimensions: Vec<usize> = (0..dimensions.len() / 4)
            .map(|k| self.u32(dimensions, 4 * k).map(|n| n as usize))
            .collect::<Read<_>>()?;
        let (_, name, rest) = self.element(rest)?;
        let name = match (within, String::from_utf8_lossy(name)) {
            ("", name) => name.into_owned(),
            (within, _) => within.to_owned(),
        };
        if self.variables.len() >= MAX_COLUMNS {
            return Err(format!("it has more than {MAX_COLUMNS} variables"));
        }
        let count = dimensions.iter().try_fold(1usize, |n, d| n.checked_mul(*d));
        let content = match flags & 0xff {
            2 if count == Some(1) && depth > 0 => return self.fields(rest, &name, depth),
            2 => Content::Other("an array of structures"),
            1 => Content::Other("of cells"),
            4 => Content::Other("text"),
            5 => Content::Other("sparse"),
            6..=15 if flags & 0x800 != 0 => Content::Other("of complex numbers"),
            6..=15 if dimensions.len() > 2 => Content::Other("an array with more than two dimensions"),
            6..=15 => {
                let (kind, data, _) = self.element(rest)?;
                let values = self.numbers(kind, data)?;
                if count != Some(values.len()) {
                    return Err(format!("{name:?} has not as many numbers as it says"));
                }
                Content::Numbers { rows: dimensions.first().copied().unwrap_or_default(), values }
            }
            _ => Content::Other("an object"),
        };
        self.variables.push(Variable { name, content });
        Ok(())
    }

    /// The fields of a structure.
    fn fields(&mut self, bytes: &[u8], name: &str, depth: usize) -> Read<()> {
        let (_, length, rest) = self.element(bytes)?;
        let length = self.u32(length, 0)? as usize;
        let (_, names, mut rest) = self.element(rest)?;
        if length == 0 {
            return Err(format!("{name:?} is a structure whose fields have no names"));
        }
        for field in names.chunks_exact(length) {
            let field = field.split(|byte| *byte == 0).next().unwrap_or_default();
            let (kind, data, behind) = self.element(rest)?;
            rest = behind;
            if kind == MATRIX {
                self.matrix(data, &format!("{name}.{}", String::from_utf8_lossy(field)), depth - 1)?;
            }
        }
        Ok(())
    }

    /// Numbers, which may be stored in a smaller type than they have.
    fn numbers(&mut self, kind: u32, data: &[u8]) -> Read<Vec<f64>> {
        let mut of = |width: usize, number: fn([u8; 8]) -> f64| -> Read<Vec<f64>> {
            self.numbers += data.len() / width;
            if self.numbers > MAX_NUMBERS {
                return Err(format!("it has more than {MAX_NUMBERS} numbers"));
            }
            let wide = |bytes: &[u8]| {
                let mut word = [0; 8];
                word[..width].copy_from_slice(bytes);
                if self.is_big_endian {
                    word[..width].reverse();
                }
                number(word)
            };
            Ok(data.chunks_exact(width).map(wide).collect())
        };
        match kind {
            1 => of(1, |b| f64::from(b[0] as i8)),
            2 => of(1, |b| f64::from(b[0])),
            3 => of(2, |b| f64::from(i16::from_le_bytes([b[0], b[1]]))),
            4 => of(2, |b| f64::from(u16::from_le_bytes([b[0], b[1]]))),
            5 => of(4, |b| f64::from(i32::from_le_bytes([b[0], b[1], b[2], b[3]]))),
            6 => of(4, |b| f64::from(u32::from_le_bytes([b[0], b[1], b[2], b[3]]))),
            7 => of(4, |b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]))),
            9 => of(8, f64::from_le_bytes),
            12 => of(8, |b| i64::from_le_bytes(b) as f64),
            13 => of(8, |b| u64::from_le_bytes(b) as f64),
            _ => Err(format!("it has numbers of type {kind}, which MATLAB does not write")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::Column;
    use crate::recording::typed::faultless;
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    /// An element, in either order of bytes.
    fn element(kind: u32, data: &[u8], is_big_endian: bool) -> Vec<u8> {
        let word = |n: u32| if is_big_endian { n.to_be_bytes() } else { n.to_le_bytes() };
        let mut bytes = [word(kind), word(data.len() as u32)].concat();
        bytes.extend(data);
        bytes.resize(bytes.len().next_multiple_of(8), 0);
        bytes
    }

    /// A file with a structure `rig` of the vectors `t` in double precision and `F` as whole numbers of two bytes.
    fn file(is_big_endian: bool) -> Vec<u8> {
        let words = |all: &[u32]| -> Vec<u8> {
            all.iter().flat_map(|n| if is_big_endian { n.to_be_bytes() } else { n.to_le_bytes() }).collect()
        };
        let order = |mut bytes: Vec<u8>| {
            if is_big_endian {
                bytes.reverse();
            }
            bytes
        };
        let doubles =
            [0.0, 0.5, 1.0].iter().flat_map(|v: &f64| order(v.to_le_bytes().to_vec())).collect::<Vec<_>>();
        let shorts = [-3i16, 4, 500].iter().flat_map(|v| order(v.to_le_bytes().to_vec())).collect::<Vec<_>>();
        let e = |kind, data: &[u8]| element(kind, data, is_big_endian);
        let vector = |kind, data: &[u8]| {
            e(14, &[e(6, &words(&[6, 0])), e(5, &words(&[3, 1])), e(1, b""), e(kind, data)].concat())
        };
        // the length of names stands in a head of its own
        let small = order(vec![5, 0, 4, 0]).into_iter().chain(words(&[2])).collect::<Vec<u8>>();
        let parts = [
            e(6, &words(&[2, 0])),
            e(5, &words(&[1, 1])),
            e(1, b"rig"),
            small,
            e(1, b"t\0F\0"),
            vector(9, &doubles),
            vector(3, &shorts),
        ];
        let mut bytes = vec![b' '; 124];
        bytes.extend(if is_big_endian { *b"\x01\0MI" } else { *b"\0\x01IM" });
        bytes.extend(e(14, &parts.concat()));
        bytes
    }

    fn read(bytes: &[u8]) -> Result<Recording> {
        let column = |name: &str, unit: &str| Column { variable: Some(name.into()), unit: Some(unit.into()) };
        let named = BTreeMap::from([
            ("rig.t".to_owned(), column("time", "s")),
            ("rig.F".to_owned(), column("force", "kN")),
        ]);
        faultless(parse_mat(bytes, &Columns { named, ..Columns::default() }, "rig.mat")?)
    }

    #[test]
    fn fields_of_structures_are_read_in_both_orders_of_bytes() {
        for is_big_endian in [false, true] {
            let recording = read(&file(is_big_endian)).unwrap();
            assert_eq!(recording.time, [0.0, 0.5, 1.0]);
            let [force] = &recording.channels[..] else { panic!("{recording:?}") };
            assert_eq!(
                (&*force.name, &*force.unit, &force.values[..]),
                ("force", "kN", &[-3.0, 4.0, 500.0][..])
            );
        }
    }

    proptest! {
        /// Whatever is wrong with a file, it is a recording or an error.
        #[test]
        fn damage_is_an_error(at in 128usize..600, byte: u8, cut in 0usize..600) {
            let mut bytes = file(false);
            let at = at % bytes.len();
            bytes[at] = byte;
            let _ = read(&bytes);
            bytes.truncate(cut);
            let _ = read(&bytes);
        }
    }
}
