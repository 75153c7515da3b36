//! The data of an OpenCRG file: a record for each cross section, in text or bytes, and what is made of heights that are missing.

use super::Road;
use crate::tir::shown;
use crate::{Error, Result};

impl Road<'_> {
    /// Goes through the records: the line of each (its number in a binary file) and its numbers.
    pub(super) fn records(&self, mut each: impl FnMut(usize, &[f64]) -> Result<()>) -> Result<()> {
        let data = self.bytes.get(self.data.clone()).unwrap_or_default();
        let count = self.header.channels.len();
        let mut record = Vec::with_capacity(count);
        if !self.format.text {
            let width = self.format.width();
            let bytes = match self.format.long {
                true => (count * width).div_ceil(80) * 80,
                false => count * width,
            };
            // programs fill the last block of 80 bytes with NaN
            let mut filled = 0;
            while data.len().is_multiple_of(80) && filled + width < 80 {
                let end = data.len().saturating_sub(filled);
                let number = data.get(end.saturating_sub(width)..end).unwrap_or_default();
                if !big_endian(number).is_nan() || number.is_empty() {
                    break;
                }
                filled += width;
            }
            // of a cross section that has a height, NaN at its end belong to it
            let end = (data.len() - filled).div_ceil(bytes) * bytes;
            let end = if end <= data.len() { end } else { data.len() };
            let mut chunks = data.get(..end).unwrap_or_default().chunks_exact(bytes);
            for (i, chunk) in chunks.by_ref().enumerate() {
                record.clear();
                record.extend(chunk.chunks_exact(width).take(count).map(big_endian));
                each(i + 1, &record)?;
            }
            let rest = chunks.remainder();
            // or with line ends, blanks or zeros
            if rest.iter().any(|b| !matches!(b, 0 | b'\n' | b'\r' | b' ')) {
                return Err(Error::file(format!(
                    "{}: the data end within a cross section: {} bytes are left, and one has {bytes}; the file is cut off, or has been changed by a program that took it for text",
                    self.name,
                    rest.len()
                )));
            }
            return Ok(());
        }
        let mut begun = self.line;
        let is_last = |text: &[u8]| text.as_ptr_range().end == data.as_ptr_range().end;
        for (line, text) in (self.line..).zip(data.split(|b| *b == b'\n')) {
            let text = text.strip_suffix(b"\r").unwrap_or(text);
            // comments are for the header, where a star also begins a number that is missing
            if !text.trim_ascii().is_empty() {
                if record.is_empty() {
                    begun = line;
                }
                let width = self.format.width();
                let mut fields = text;
                while !fields.is_empty() && record.len() < count {
                    let (field, rest) = fields.split_at(width.min(fields.len()));
                    fields = rest;
                    let blank = field.trim_ascii().is_empty();
                    if blank && rest.trim_ascii().is_empty() {
                        fields = &[];
                        break;
                    }
                    // without a line end behind it, nobody knows whether digits are missing
                    if field.len() < width && is_last(text) {
                        return Err(Error::file(format!(
                            "{}:{line}: data: the file is cut off in '{}', a field of {width} characters; if it is whole, end its last line",
                            self.name,
                            shown(field)
                        )));
                    }
                    record.push(self.field(field, line, record.len())?);
                    if record.len() == count && !self.format.long {
                        each(begun, &record)?;
                        record.clear();
                        begun = line;
                    }
                }
                if !fields.trim_ascii().is_empty() {
                    return Err(Error::file(format!(
                        "{}:{line}: data: there is more on the line than the {count} channels of a cross section in fields of {width} characters",
                        self.name
                    )));
                }
                if record.len() == count {
                    each(begun, &record)?;
                    record.clear();
                }
            }
        }
        if !record.is_empty() {
            return Err(Error::file(format!(
                "{}:{begun}: data: the last cross section has {} of {count} numbers; the file is cut off",
                self.name,
                record.len()
            )));
        }
        Ok(())
    }

    /// A number in a field of text; NaN for what is marked as missing.
    fn field(&self, field: &[u8], line: usize, channel: usize) -> Result<f64> {
        let text = String::from_utf8_lossy(field.trim_ascii()).into_owned();
        if text.starts_with('*') || text.eq_ignore_ascii_case("nan") {
            return Ok(f64::NAN);
        }
        let number = text.replace(['d', 'D'], "e").parse::<f64>();
        number.ok().filter(|x| x.is_finite()).ok_or_else(|| {
            Error::file(format!(
                "{}:{line}: data, channel {}: '{}' is no number in a field of {} characters",
                self.name,
                channel + 1,
                shown(text.as_bytes()),
                self.format.width()
            ))
        })
    }
}

/// What is made of heights that are missing (`GRID_NAN_MODE`).
pub(super) enum NanMode {
    Keep,
    Level(f64),
    Neighbour(f64),
}

impl NanMode {
    pub(super) fn of(road: &Road<'_>) -> Result<Self> {
        let offset = road.modifier("GRID_NAN_OFFSET").unwrap_or(0.0);
        match road.modifier("GRID_NAN_MODE") {
            None => Ok(Self::Neighbour(offset)),
            Some(0.0) => Ok(Self::Keep),
            Some(1.0) => Ok(Self::Level(offset)),
            Some(2.0) => Ok(Self::Neighbour(offset)),
            Some(mode) => Err(Error::file(format!(
                "{}: $ROAD_CRG_MODS: GRID_NAN_MODE = {mode} is none of 0 (keep), 1 (zero) and 2 (keep last)",
                road.name
            ))),
        }
    }

    pub(super) fn words(&self) -> String {
        let with = |offset: f64| if offset == 0.0 { String::new() } else { format!(", {offset} m higher") };
        match self {
            Self::Keep => String::new(),
            Self::Level(height) => format!("they are {height} m high (GRID_NAN_MODE = 1)"),
            Self::Neighbour(offset) => format!(
                "they have the height of the nearest long section to the right, or else to the left, that has one{} (GRID_NAN_MODE = 2, the default)",
                with(*offset)
            ),
        }
    }

    /// Puts heights where there are none, from the right to the left.
    pub(super) fn fill(&self, section: &mut [f64]) -> std::result::Result<(), String> {
        match self {
            Self::Keep => {
                return Err("a track has no height (NaN), and GRID_NAN_MODE = 0 asks to leave it so; choose another place across the road, or another mode".into());
            }
            Self::Level(height) => section.iter_mut().filter(|z| z.is_nan()).for_each(|z| *z = *height),
            Self::Neighbour(offset) => {
                if section.iter().all(|z| z.is_nan()) {
                    return Err("no long section has a height (NaN); cut the file before or behind it".into());
                }
                let mut last: Option<f64> = None;
                let mut fill = |z: &mut f64| match last {
                    // once it is higher, what follows is as high
                    Some(height) if z.is_nan() => *z = height,
                    _ if !z.is_nan() => last = Some(*z + offset),
                    _ => {}
                };
                section.iter_mut().for_each(&mut fill);
                let mut last: Option<f64> = None;
                for z in section.iter_mut().rev() {
                    match last {
                        Some(height) if z.is_nan() => *z = height,
                        _ if !z.is_nan() => last = Some(*z + offset),
                        _ => {}
                    }
                }
            }
        }
        Ok(())
    }
}

/// A number of four or eight bytes, the highest one first; NaN for what is none.
fn big_endian(bytes: &[u8]) -> f64 {
    match *bytes {
        [a, b, c, d] => f64::from(f32::from_be_bytes([a, b, c, d])),
        [a, b, c, d, e, f, g, h] => f64::from_be_bytes([a, b, c, d, e, f, g, h]),
        _ => f64::NAN,
    }
}
