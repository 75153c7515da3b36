//! Recordings as RPC III time histories, the files that rig controllers play: a header of entries with 32 bytes of name and 96 of value,
//! four to a block of 512, and behind it groups of samples, channel after channel.
//!
//! What is known of the format is from files and from programs that read them (`rpc3-file`, `rpc-reader`); the manual could not be had. A
//! sample of two bytes times SCALE is the value, as `rpc3-file` has it. `rpc-reader` multiplies by INT_FULL_SCALE / 32768 as well, which is
//! 0.05 % less for what is usual, 32752.

use super::form::{check_lengths, read_bytes};
use super::{Channel, Recording};
use crate::model::unit::Unit;
use crate::{Error, Result, VERSION};
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// What the names of RPC III files end in, in small letters: responses, drives, histories of any kind.
pub const RPC_ENDINGS: [&str; 4] = ["rsp", "drv", "tim", "rpc"];

const BLOCK: usize = 512;
const NAME: usize = 32;
const ENTRY: usize = 128;
/// Samples of a channel that stand together.
const FRAME: usize = 1024;
/// The greatest number of two bytes that is used.
const FULL_SCALE: f64 = 32752.0;
/// Channels of a file: what rig controllers take.
const MAX_CHANNELS: usize = 256;
/// Intervals of samples may differ by so much of their mean: what six decimals of a time make of it at some kHz.
const UNEVEN: f64 = 5e-3;

/// Reads an RPC III time history. The first sample is at 0 s. Descriptions become the channels' names; of several with one name, later ones get
/// their number added. A unit that is not known is put in the name, and the channel's unit is then `1`.
///
/// # Errors
/// A file that cannot be read, or whose header is no such header or does not fit the file's length; with what it says.
pub fn read_rpc(path: &Path) -> Result<Recording> {
    let (bytes, source) = read_bytes(path)?;
    parse_rpc(&bytes, &source)
}

/// Reads the bytes of an RPC III file, see [`read_rpc`]; `source` stands for the file's name in messages.
///
/// # Errors
/// As [`read_rpc`].
pub fn parse_rpc(bytes: &[u8], source: &str) -> Result<Recording> {
    let header = Header::parse(bytes).map_err(|what| Error::file(format!("{source}: {what}")))?;
    header.recording(bytes, source).map_err(|what| Error::file(format!("{source}: {what}")))
}

struct Header {
    entries: HashMap<String, String>,
    length: usize,
}

impl Header {
    fn parse(bytes: &[u8]) -> std::result::Result<Self, String> {
        let latin = |bytes: &[u8]| -> String {
            let text: String = bytes.iter().take_while(|b| **b != 0).map(|b| char::from(*b)).collect();
            text.trim().to_owned()
        };
        let entry = |k: usize| {
            let entry = bytes.get(k * ENTRY..(k + 1) * ENTRY)?;
            Some((latin(&entry[..NAME]), latin(&entry[NAME..])))
        };
        let first = |k: usize, name: &str| match entry(k) {
            Some((own, value)) if own == name => Ok(value),
            _ => Err(format!("this is no RPC III file: entry {} of its header is not {name}", k + 1)),
        };
        let format = first(0, "FORMAT")?;
        if !["BINARY", "BINARY_IEEE_LITTLE_END"].contains(&format.as_str()) {
            return Err(format!("the format {format:?} is not read; BINARY and BINARY_IEEE_LITTLE_END are"));
        }
        let count = |text: &str, name: &str| {
            whole(text).filter(|n| *n > 0).ok_or_else(|| format!("{name} is {text:?}, no number above 0"))
        };
        let blocks = count(&first(1, "NUM_HEADER_BLOCKS")?, "NUM_HEADER_BLOCKS")?;
        let number = count(&first(2, "NUM_PARAMS")?, "NUM_PARAMS")?;
        let length = blocks.checked_mul(BLOCK).filter(|length| *length <= bytes.len());
        let length =
            length.ok_or_else(|| format!("the header of {blocks} blocks is longer than the file"))?;
        if number > length / ENTRY {
            return Err(format!("{number} entries do not fit into a header of {blocks} blocks"));
        }
        let entries = (0..number).filter_map(entry).filter(|(name, _)| !name.is_empty()).collect();
        Ok(Self { entries, length })
    }

    fn text(&self, name: &str) -> std::result::Result<&str, String> {
        self.entries.get(name).map(String::as_str).ok_or_else(|| format!("the header has no {name}"))
    }

    fn count(&self, name: &str) -> std::result::Result<usize, String> {
        let text = self.text(name)?;
        whole(text).filter(|n| *n > 0).ok_or_else(|| format!("{name} is {text:?}, no number above 0"))
    }

    fn number(&self, name: &str) -> std::result::Result<f64, String> {
        let text = self.text(name)?;
        let number = text.parse().ok().filter(|n: &f64| n.is_finite());
        number.ok_or_else(|| format!("{name} is {text:?}, no number"))
    }

    fn recording(&self, bytes: &[u8], source: &str) -> std::result::Result<Recording, String> {
        if let Some(kind) = self.entries.get("FILE_TYPE").filter(|kind| *kind != "TIME_HISTORY") {
            return Err(format!("it is a {kind}, not a TIME_HISTORY"));
        }
        let channels = self.count("CHANNELS")?;
        let (frame, group) = (self.count("PTS_PER_FRAME")?, self.count("PTS_PER_GROUP")?);
        let frames = self.count("FRAMES")?;
        if !group.is_multiple_of(frame) {
            return Err(format!("PTS_PER_GROUP {group} is no multiple of PTS_PER_FRAME {frame}"));
        }
        let interval = self.number("DELTA_T")?;
        if interval <= 0.0 {
            return Err(format!("DELTA_T is {interval}, no time above 0"));
        }
        let wide = match self.entries.get("DATA_TYPE").map(String::as_str) {
            None | Some("SHORT_INTEGER") => 2,
            Some("FLOATING_POINT") => 4,
            Some(other) => {
                return Err(format!(
                    "the data type {other:?} is not read; SHORT_INTEGER and FLOATING_POINT are"
                ));
            }
        };
        let groups = frames.div_ceil(group / frame);
        let needed =
            groups.checked_mul(group).and_then(|n| n.checked_mul(channels)).and_then(|n| n.checked_mul(wide));
        let there = bytes.len() - self.length;
        if needed.is_none_or(|needed| needed > there) {
            return Err(format!(
                "its header speaks of {channels} channels with {frames} frames of {frame} samples, and behind it are {there} bytes"
            ));
        }
        let whole_frames = frames * frame;
        let samples = match self.entries.get("SAMPLES") {
            Some(text) => whole(text)
                .filter(|n| (1..=whole_frames).contains(n))
                .ok_or_else(|| format!("SAMPLES is {text:?}, not 1 to {whole_frames}"))?,
            None => whole_frames,
        };
        let mut names = HashSet::new();
        let channels = (0..channels)
            .map(|c| {
                let entry = |name: &str| self.entries.get(&format!("{name}.CHAN_{}", c + 1)).cloned();
                let scale = match wide {
                    2 => self.number(&format!("SCALE.CHAN_{}", c + 1))?,
                    _ => 1.0,
                };
                let values = (0..samples).map(|k| {
                    let place = self.length + wide * ((k / group * channels + c) * group + k % group);
                    match bytes[place..place + wide] {
                        [a, b] => f64::from(i16::from_le_bytes([a, b])) * scale,
                        [a, b, c, d] => f64::from(f32::from_le_bytes([a, b, c, d])),
                        _ => f64::NAN,
                    }
                });
                let unit = entry("UNITS").filter(|unit| !unit.is_empty()).unwrap_or_else(|| "1".into());
                let name = entry("DESC").filter(|name| !name.is_empty());
                let mut name = name.unwrap_or_else(|| format!("channel {}", c + 1));
                let (known, unit) = if Unit::parse(&unit).is_ok() { (true, unit) } else { (false, unit) };
                if !known {
                    name += &format!(" [{unit}]");
                }
                if !names.insert(name.clone()) {
                    name += &format!(" ({})", c + 1);
                    names.insert(name.clone());
                }
                Ok(Channel { name, unit: if known { unit } else { "1".into() }, values: values.collect() })
            })
            .collect::<std::result::Result<Vec<_>, String>>()?;
        if let Some(channel) = channels.iter().find(|c| c.values.iter().any(|v| !v.is_finite())) {
            return Err(format!("the channel {:?} has a value that is no number", channel.name));
        }
        let time = (0..samples).map(|k| k as f64 * interval).collect();
        Ok(Recording { time, channels, source: source.into() })
    }
}

/// A whole number, also one that is written with decimals that are zero.
fn whole(text: &str) -> Option<usize> {
    text.parse().ok().or_else(|| {
        let number: f64 = text.parse().ok()?;
        // the cast is exact up to there
        ((0.0..9e15).contains(&number) && number.fract() == 0.0).then_some(number as usize)
    })
}

/// Writes a recording as an RPC III time history with two bytes per sample, whole or not at all: each channel with a resolution of 1/32752 of its
/// greatest value. The last frame is filled up with the last sample; the entry SAMPLES says where it is. What time the first sample has is not kept.
///
/// # Errors
/// Samples that are not evenly spaced, more than 256 channels, a value that is no number, a name or unit that is too long or not of Latin-1; any
/// failure of the file system, with the path.
pub fn write_rpc(path: &Path, recording: &Recording) -> Result<()> {
    let bytes = to_rpc(recording).map_err(|e| e.at(path.display()))?;
    crate::file::write_whole(path, |file| file.write_all(&bytes))
}

/// The bytes that [`write_rpc`] writes.
///
/// # Errors
/// As [`write_rpc`].
pub fn to_rpc(recording: &Recording) -> Result<Vec<u8>> {
    check_lengths(recording)?;
    let interval = interval(recording)?;
    let count = recording.channels.len();
    if !(1..=MAX_CHANNELS).contains(&count) {
        return Err(Error::file(format!("an RPC III file has 1 to {MAX_CHANNELS} channels, not {count}")));
    }
    let samples = recording.time.len();
    let frames = samples.div_ceil(FRAME);
    let mut entries: Vec<(String, String)> = [
        ("FILE_TYPE", "TIME_HISTORY".to_owned()),
        ("TIME_TYPE", "RESPONSE".into()),
        ("DATA_TYPE", "SHORT_INTEGER".into()),
        ("OPERATION", format!("latsch {VERSION}")),
        ("DELTA_T", real(interval)),
        ("CHANNELS", count.to_string()),
        ("PTS_PER_FRAME", FRAME.to_string()),
        ("PTS_PER_GROUP", FRAME.to_string()),
        ("FRAMES", frames.to_string()),
        ("SAMPLES", samples.to_string()),
        ("INT_FULL_SCALE", FULL_SCALE.to_string()),
        ("HALF_FRAMES", "0".into()),
        ("REPEATS", "1".into()),
        ("BYPASS_FILTER", "0".into()),
        ("PARTITIONS", "1".into()),
        ("PART.CHAN_1", "1".into()),
        ("PART.NCHAN_1", count.to_string()),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into();
    let mut scales = Vec::new();
    for (c, channel) in recording.channels.iter().enumerate() {
        let ends =
            [f64::min, f64::max].map(|of| channel.values.iter().copied().reduce(of).unwrap_or_default());
        if !channel.values.iter().all(|v| v.is_finite()) {
            return Err(Error::file(format!("the channel {:?} has a value that is no number", channel.name)));
        }
        let most = ends.map(f64::abs).into_iter().fold(0.0, f64::max);
        let scale = if most > 0.0 { most / FULL_SCALE } else { 1.0 };
        scales.push(scale);
        let mut push = |name: &str, value: String| entries.push((format!("{name}.CHAN_{}", c + 1), value));
        push("DESC", channel.name.clone());
        push("UNITS", channel.unit.clone());
        push("SCALE", real(scale));
        push("LOWER_LIMIT", real(ends[0]));
        push("UPPER_LIMIT", real(ends[1]));
        push("MAP", (c + 1).to_string());
    }
    let number = entries.len() + 3;
    let blocks = number.div_ceil(BLOCK / ENTRY);
    let first = [
        ("FORMAT".to_owned(), "BINARY_IEEE_LITTLE_END".to_owned()),
        ("NUM_HEADER_BLOCKS".into(), blocks.to_string()),
        ("NUM_PARAMS".into(), number.to_string()),
    ];
    let mut bytes = vec![0; blocks * BLOCK];
    for (entry, (name, value)) in bytes.chunks_exact_mut(ENTRY).zip(first.iter().chain(&entries)) {
        let (to_name, to_value) = entry.split_at_mut(NAME);
        put(to_name, name)?;
        put(to_value, value)?;
    }
    for frame in 0..frames {
        for (channel, scale) in recording.channels.iter().zip(&scales) {
            for k in 0..FRAME {
                let value = channel.values[(frame * FRAME + k).min(samples - 1)];
                // within the range by the choice of the scale; the cast stops at its ends
                bytes.extend(((value / scale).round() as i16).to_le_bytes());
            }
        }
    }
    Ok(bytes)
}

/// A real number with a point, without which `rpc3-file` takes it for a whole one and fails at the exponent.
fn real(number: f64) -> String {
    let text = format!("{number:e}");
    if text.contains('.') { text } else { text.replace('e', ".0e") }
}

/// The interval of evenly spaced samples \[s\].
fn interval(recording: &Recording) -> Result<f64> {
    let time = &recording.time;
    let (Some(first), Some(last)) = (time.first(), time.last()) else {
        return Err(Error::file("there are no samples"));
    };
    let mean = (last - first) / (time.len() - 1) as f64;
    if !(mean.is_finite() && mean > 0.0) {
        return Err(Error::file("an RPC III file needs two samples or more"));
    }
    match time.windows(2).position(|pair| ((pair[1] - pair[0]) / mean - 1.0).abs() > UNEVEN) {
        None => Ok(mean),
        Some(k) => Err(Error::file(format!(
            "an RPC III file has evenly spaced samples; behind {} s the next is after {:.6} s, in the mean it is {mean:.6} s",
            time[k],
            time[k + 1] - time[k]
        ))),
    }
}

/// Puts text into a field, as Latin-1.
fn put(field: &mut [u8], text: &str) -> Result<()> {
    let latin: Option<Vec<u8>> = text.chars().map(|c| u8::try_from(c).ok()).collect();
    let latin = latin
        .ok_or_else(|| Error::file(format!("{text:?} has characters that RPC III files do not have")))?;
    // a zero ends it
    let room = field.len() - 1;
    let Some(start) = field.get_mut(..latin.len()).filter(|_| latin.len() <= room) else {
        return Err(Error::file(format!("{text:?} is longer than the {room} characters of an RPC III file")));
    };
    start.copy_from_slice(&latin);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording(samples: usize) -> Recording {
        let time: Vec<f64> = (0..samples).map(|k| k as f64 * 2e-3).collect();
        let channel = |name: &str, unit: &str, f: fn(f64) -> f64| Channel {
            name: name.into(),
            unit: unit.into(),
            values: time.iter().map(|t| f(*t)).collect(),
        };
        let channels = vec![
            channel("left.force_z", "N", |t| 4000.0 + 1500.0 * (20.0 * t).sin()),
            channel("rest", "mm", |_| 0.0),
            channel("Weg \u{fc}ber Grund", "m", |t| -t),
        ];
        Recording { time, channels, source: "rig.rsp".into() }
    }

    #[test]
    fn what_is_written_is_read_to_the_resolution_of_two_bytes() {
        for samples in [2, 1024, 1025, 3000] {
            let original = recording(samples);
            let back = parse_rpc(&to_rpc(&original).unwrap(), "rig.rsp").unwrap();
            assert_eq!(back.time.len(), samples);
            assert!(back.time.iter().zip(&original.time).all(|(a, b)| (a - b).abs() < 1e-9));
            for (a, b) in back.channels.iter().zip(&original.channels) {
                assert_eq!((&a.name, &a.unit), (&b.name, &b.unit));
                let most = b.values.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
                let off = a.values.iter().zip(&b.values).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(off <= 0.5000001 * most / 32752.0, "{}: {off}", a.name);
            }
        }
    }

    #[test]
    fn what_cannot_be_such_a_file_is_refused() {
        let uneven = Recording { time: vec![0.0, 0.1, 0.3], channels: Vec::new(), source: String::new() };
        let channel =
            |name: &str, value: f64| Channel { name: name.into(), unit: "N".into(), values: vec![value; 3] };
        let with = |time: [f64; 3], channel: Channel| Recording {
            time: time.to_vec(),
            channels: vec![channel],
            source: String::new(),
        };
        let even = [0.0, 0.1, 0.2];
        for (recording, words) in [
            (uneven, "evenly spaced"),
            (with(even, channel("F", f64::NAN)), "no number"),
            (with(even, channel(&"F".repeat(97), 1.0)), "longer than"),
            (with(even, channel("\u{3b1}", 1.0)), "characters"),
        ] {
            let message = to_rpc(&recording).unwrap_err().to_string();
            assert!(message.contains(words), "{message}");
        }
        let good = to_rpc(&recording(1500)).unwrap();
        let damaged = |from: &str, to: &str| {
            let mut bytes = good.clone();
            let place = bytes.windows(from.len()).position(|w| w == from.as_bytes()).unwrap();
            bytes[place..place + to.len()].copy_from_slice(to.as_bytes());
            parse_rpc(&bytes, "rig.rsp").unwrap_err().to_string()
        };
        assert!(damaged("FORMAT", "FARMER").contains("entry 1"));
        assert!(damaged("SHORT_INTEGER", "SHORT_INTEGEB").contains("SHORT_INTEGEB"));
        assert!(damaged("TIME_HISTORY", "TIME_MYSTERY").contains("TIME_MYSTERY"));
        assert!(parse_rpc(&good[..good.len() - 1], "rig.rsp").unwrap_err().to_string().contains("bytes"));
    }
}
