//! TYDEX files become recordings.

use super::channels::{KNOWN, LONGVEL, of_tydex};
use super::sections::{Line, Sections};
use super::table::{MISSING, Table};
use super::{record, write};
use crate::recording::form::read_bytes;
use crate::recording::{Channel, Recording};
use crate::{Error, Result};
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// Where the cosine of the slip angle is smaller, LONGVEL says too little of the path speed: beyond 84 degrees.
const LEAST_COSINE: f64 = 0.1;

/// Reads a TYDEX file; text that is not UTF-8 is taken for Latin-1. RUNTIME is the time. Channels that mean the same as
/// channels of latsch's rigs get their names (`SLIPANGL` is `slip_angle`, `FZH` is `force_z`), all others keep their own in small
/// letters, forces and moments of other axis systems too (`fyw`), as those are not a rig's. LONGVEL divided by the cosine of the
/// slip angle is `path_speed` where there is no TRAJVELW. A constant of the file becomes a channel if it is an input of a rig of
/// which there is no channel. Channels without any value (`NOTAVAIL` in all rows) are left out. Values are converted as the file
/// says, and stay in its units.
///
/// # Errors
/// A file that cannot be read, or that is no measurement over time: no RUNTIME, a section that is missing or there twice, a
/// unit that is not known or is one of something else, a row that has not one number per channel, a missing value, a time
/// that does not increase, fewer than two rows. The message begins with `file:line:channel`.
pub fn read_tydex(path: &Path) -> Result<Recording> {
    let (bytes, source) = read_bytes(path)?;
    let text = String::from_utf8(bytes)
        .unwrap_or_else(|e| e.as_bytes().iter().map(|byte| char::from(*byte)).collect());
    parse_tydex(&text, &source)
}

/// Reads the text of a TYDEX file, see [`read_tydex`]; `source` stands for the file's name in messages.
///
/// # Errors
/// As [`read_tydex`].
pub fn parse_tydex(text: &str, source: &str) -> Result<Recording> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let sections = Sections::of(text, source)?;
    let mut table = Table::of(&sections, source)?;
    let time = table.take_time()?;
    table.leave_out_what_is_missing()?;
    let own = own_names(sections.lines("COMMENTS"), source)?;
    let recording = Recording { time, channels: channels(&table, &own, source)?, source: source.into() };
    let in_heading =
        table.columns.iter().position(|column| column.tydex == LONGVEL && !own.contains_key(LONGVEL));
    with_constants(recording, in_heading, &table, sections.lines("CONSTANTS"))
}

/// The names that latsch has noted in the comments, as eight characters do not hold them.
fn own_names(comments: &[Line<'_>], source: &str) -> Result<HashMap<String, String>> {
    let mut names = HashMap::new();
    for Line { number, text } in comments {
        let Some((tydex, name)) = text.strip_prefix(write::NOTE).and_then(|note| note.split_once(" = "))
        else {
            continue;
        };
        let name: String = serde_json::from_str(name).map_err(|_| {
            Error::file(format!(
                "{source}:{number}: {name} is no name in quotation marks; latsch wrote one here"
            ))
        })?;
        names.insert(tydex.to_owned(), name);
    }
    Ok(names)
}

/// The channels of a recording, with their names and units.
fn channels(table: &Table<'_>, own: &HashMap<String, String>, source: &str) -> Result<Vec<Channel>> {
    let there: HashSet<&str> = table.columns.iter().map(|column| column.tydex.as_str()).collect();
    let mut seen = HashMap::from([("time".to_owned(), "the time")]);
    let mut channels = Vec::new();
    for column in &table.columns {
        let at = |what: String| Error::file(format!("{source}:{}:{}: {what}", column.line, column.tydex));
        let tydex = column.tydex.as_str();
        // of two names for one channel the first of the table is the channel
        let known = of_tydex(tydex).filter(|row| {
            let mut same = KNOWN.iter().filter(|other| other.name == row.name && there.contains(other.tydex));
            same.next().is_some_and(|first| first.tydex == tydex) && !own.contains_key(tydex)
        });
        let unit = match known {
            Some(row) => row.unit(column.unit.as_deref()).map_err(at)?,
            None => column.unit.clone().unwrap_or_else(|| "1".into()),
        };
        let name = match (own.get(tydex), known) {
            (Some(name), _) => name.clone(),
            (None, Some(row)) => row.name.into(),
            (None, None) => tydex.to_ascii_lowercase(),
        };
        if let Some(first) = seen.insert(name.clone(), tydex) {
            return Err(at(format!("this is {name}, but so is {first}; leave one of them out")));
        }
        channels.push(Channel { name, unit, values: column.values.clone() });
    }
    Ok(channels)
}

/// The recording with what its file says of inputs of a rig that no channel tells: what the rig held. `in_heading` is the channel
/// that is LONGVEL.
fn with_constants(
    mut recording: Recording,
    mut in_heading: Option<usize>,
    table: &Table<'_>,
    lines: &[Line<'_>],
) -> Result<Recording> {
    let mut seen = HashSet::new();
    let mut speed = None;
    for Line { number, text } in lines {
        // what is no constant that is looked for may be anything
        let Ok(name) = record::name(text) else { continue };
        let Some(row) = of_tydex(&name).filter(|row| row.held.is_some()) else { continue };
        let at = |what: String| Error::file(format!("{}:{number}:{name}: {what}", recording.source));
        if !seen.insert(row.tydex) {
            return Err(at("this constant is there twice".into()));
        }
        let held = row.held.unwrap_or(row.name);
        let is_measured = table.columns.iter().any(|column| column.tydex == name) || recording.has(held);
        if is_measured || text.split_whitespace().any(|word| word == MISSING) {
            continue;
        }
        let said = record::record(text, 1).map_err(at)?;
        let Some(value) = said.numbers[0] else {
            return Err(at("there is no number behind the unit".into()));
        };
        let unit = row.unit(said.unit.as_deref()).map_err(at)?;
        let channel = Channel { name: held.into(), unit, values: vec![value; recording.time.len()] };
        match row.tydex == LONGVEL {
            true => speed = Some(channel),
            false => recording.channels.push(channel),
        }
    }
    if recording.has("path_speed") {
        return Ok(recording);
    }
    if let Some(speed) = speed {
        in_heading = Some(recording.channels.len());
        recording.channels.push(speed);
    }
    if let Some(channel) = in_heading {
        along_the_path(&mut recording, channel)?;
    }
    Ok(recording)
}

/// Makes the path speed of the speed in the wheel's heading. A file without slip angle is of a wheel that rolls straight.
fn along_the_path(recording: &mut Recording, channel: usize) -> Result<()> {
    let mut values = recording.channels[channel].values.clone();
    if recording.has("slip_angle") {
        let angles = recording.channel_in("slip_angle", "rad")?;
        for ((value, angle), time) in values.iter_mut().zip(angles).zip(&recording.time) {
            let cosine = libm::cos(angle);
            if cosine < LEAST_COSINE {
                return Err(Error::file(format!(
                    "{}: at {time} s the slip angle is {angle} rad, so that LONGVEL does not tell the speed along the path; TRAJVELW \
                     is needed",
                    recording.source
                )));
            }
            *value /= cosine;
        }
    }
    let channel = &mut recording.channels[channel];
    channel.values = values;
    channel.name = "path_speed".into();
    Ok(())
}
