//! Recordings become TYDEX files.

use super::channels::{RUNTIME, is_taken, of_channel};
use crate::model::unit::Unit;
use crate::recording::form::{BLOCK, check_lengths};
use crate::recording::shortest::push_shortest;
use crate::recording::{Channel, Recording};
use crate::shown::visible;
use crate::{Error, Result, VERSION, one_line};
use std::fmt::Write as _;
use std::io::Write;
use std::path::Path;

/// What a comment begins with that says the name of a channel.
pub const NOTE: &str = "latsch: ";
/// Names of channels that have none of eight characters: these letters and a number.
const NUMBERED: &str = "CHN";

/// Writes a recording as a TYDEX file that [`read_tydex`](super::read_tydex) reads back with the same bits, through a temporary
/// file. Fields are ten characters wide as far as the shortest text of a number fits: longer ones are longer, and readers
/// that tell them apart by blanks read them. Channels whose names are longer than eight characters, or have a meaning in TYDEX
/// that they do not have here, are numbered, and the comments say their names. Values that are not finite are written as they
/// are; [`read_tydex`](super::read_tydex) refuses them.
///
/// # Errors
/// As [`to_tydex`]; any failure of the file system, with the path.
pub fn write_tydex(path: &Path, recording: &Recording) -> Result<()> {
    check(recording).map_err(|e| e.at(path.display()))?;
    crate::file::write_whole(path, |file| write(file, recording))
}

/// The text that [`write_tydex`] writes.
///
/// # Errors
/// Channels that are not as long as the time, or have a unit that is not known: no reader could tell where it ends.
pub fn to_tydex(recording: &Recording) -> Result<String> {
    check(recording)?;
    let mut bytes = Vec::new();
    write(&mut bytes, recording).map_err(|e| Error::file(e.to_string()))?;
    String::from_utf8(bytes).map_err(|e| Error::file(e.to_string()))
}

fn check(recording: &Recording) -> Result<()> {
    check_lengths(recording)?;
    for channel in &recording.channels {
        Unit::parse(&channel.unit).map_err(|e| e.at(format!("channel {:?}", channel.name)))?;
    }
    Ok(())
}

fn write(file: &mut dyn Write, recording: &Recording) -> std::io::Result<()> {
    let mut text = String::from("**HEADER\n");
    let mut header = |name, comment, value: &str| {
        let _ = writeln!(text, "{name:<10}{comment:<40}{value}");
    };
    header("RELEASE", "Release of TYDEX-Format", "1.3");
    header("MEASID", "Measurement id", one_line(&recording.source).trim());
    header("SUPPLIER", "Data supplier", &format!("latsch {VERSION}"));
    text += "**COMMENTS\n";
    let mut lines = format!("{RUNTIME:<10}{:<30}{:<10}1         0         0\n", "running time", "s");
    for (i, channel) in recording.channels.iter().enumerate() {
        let (tydex, comment) = name(i, channel);
        if comment.is_none() && tydex.starts_with(NUMBERED) {
            let quoted = serde_json::to_string(&channel.name).map_err(std::io::Error::other)?;
            let _ = writeln!(text, "{NOTE}{tydex} = {quoted}");
        }
        let comment = match comment {
            Some(comment) => comment.into(),
            None => channel.name.chars().map(visible).take(29).collect::<String>(),
        };
        let unit: String = channel.unit.split_whitespace().collect();
        // a longer unit pushes the numbers away
        let gap = if unit.chars().count() < 10 { "" } else { " " };
        let _ = writeln!(lines, "{tydex:<10}{comment:<30}{unit:<10}{gap}1         0         0");
    }
    text += "**CONSTANTS\n**MEASURCHANNELS\n";
    text += &lines;
    text += "**MEASURDATA\n";
    for (i, time) in recording.time.iter().enumerate() {
        let mut begin = text.len();
        push_shortest(&mut text, *time);
        for channel in &recording.channels {
            let width = text.len() - begin;
            text.extend(std::iter::repeat_n(' ', 10_usize.saturating_sub(width).max(1)));
            begin = text.len();
            push_shortest(&mut text, channel.values[i]);
        }
        text.push('\n');
        if text.len() >= BLOCK {
            file.write_all(text.as_bytes())?;
            text.clear();
        }
    }
    text += "**END\n";
    file.write_all(text.as_bytes())
}

/// The name of the channel with this number, and what TYDEX calls it.
fn name(number: usize, channel: &Channel) -> (String, Option<&'static str>) {
    if let Some(row) = of_channel(&channel.name, &channel.unit) {
        return (row.tydex.into(), Some(row.comment));
    }
    let own = channel.name.to_ascii_uppercase();
    let is_name = own.len() <= 8
        && own.starts_with(|c: char| c.is_ascii_alphabetic())
        && own.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
        && own.to_ascii_lowercase() == channel.name;
    if is_name && !is_taken(&own) && !own.starts_with(NUMBERED) {
        return (own, None);
    }
    (format!("{NUMBERED}{:05}", number + 1), None)
}
