//! Recordings as ASAM MDF 4, the files of measurement systems in vehicles and on rigs: groups of channels, each group with times of its own.
//!
//! Read are versions 4.0 to 4.2 as far as data are stored record by record: sorted or not, in pieces, compressed by deflate, with all
//! conversions but formulas. What is no number (texts, arrays, messages of buses) is left out, and refused where a map names it.

mod blocks;
mod conversion;
mod records;
mod write;

#[cfg(test)]
mod tests;

pub(super) use write::write_mdf;

use super::Recording;
use super::form::{Defect, MAX_COLUMNS, read_bytes};
use super::header::Columns;
use super::typed::{MAX_NUMBERS, TypedColumn, recording_of};
use crate::stats::interpolate;
use crate::{Error, Result};
use blocks::{Block, Blocks, Read};
use conversion::Conversion;
use records::{Layout, Length};
use std::borrow::Cow;
use std::cmp::Ordering;
use std::collections::HashMap;
use std::path::Path;

/// What the names of MDF files end in, in small letters.
pub const MDF_ENDINGS: [&str; 2] = ["mf4", "mdf"];

/// Reads an MDF 4 file. `names` says which of its channels are what, by their names, with the unit or without.
///
/// # Errors
/// A file that cannot be read, is no MDF 4 file, is damaged or stored in a way that is not read; a channel that has no unit, or is no number
/// though it is named; channels of several rates, unless it is said at which times they are wanted.
pub(super) fn read_mdf(path: &Path, names: &Columns) -> Result<(Recording, Vec<Defect>)> {
    let (bytes, source) = read_bytes(path)?;
    parse_mdf(&bytes, names, &source)
}

/// Reads the bytes of an MDF 4 file, see [`read_mdf`]; `source` stands for its name in messages.
///
/// # Errors
/// As [`read_mdf`].
pub(super) fn parse_mdf(bytes: &[u8], names: &Columns, source: &str) -> Result<(Recording, Vec<Defect>)> {
    let columns = columns(bytes, names).map_err(|what| Error::file(format!("{source}: {what}")))?;
    recording_of(columns, names, source)
}

/// A channel of numbers, before any is read.
struct Channel {
    title: String,
    /// Nothing for the number of the record.
    layout: Option<Layout>,
    conversion: Conversion,
    /// Whether the channel has no valid number at all.
    is_invalid: bool,
    /// The bit behind the record's data that says that a number is not valid.
    invalid_bit: Option<usize>,
}

/// A group of channels over one time.
struct Group<'a> {
    time: Channel,
    channels: Vec<Channel>,
    records: Cow<'a, [u8]>,
    /// Of one record \[bytes\].
    length: usize,
    count: usize,
    /// Bytes of a record before those that say what is invalid.
    data_bytes: usize,
}

fn columns(bytes: &[u8], names: &Columns) -> Read<Vec<TypedColumn>> {
    let groups = groups(bytes, names)?;
    let numbers = groups.iter().map(|group| group.count.saturating_mul(1 + group.channels.len()));
    if numbers.fold(0, usize::saturating_add) > MAX_NUMBERS {
        return Err(format!(
            "it has more than {MAX_NUMBERS} numbers; a map with only_named = true leaves out channels"
        ));
    }
    let times: Vec<Vec<f64>> = groups.iter().map(|group| group.values(&group.time)).collect();
    let (base, wanted) = match time_of_all(&groups, &times, names)? {
        // all have the same times
        None => (0, None),
        Some(base) => (base, Some(span(&times)?)),
    };
    let channels: usize = groups.iter().map(|group| group.channels.len()).sum();
    if times[base].len().saturating_mul(channels) > MAX_NUMBERS {
        return Err(format!("at those times it has more than {MAX_NUMBERS} numbers"));
    }
    let is_wanted = |time: &&f64| wanted.is_none_or(|(first, last)| (first..=last).contains(*time));
    let time: Vec<f64> = times[base].iter().filter(is_wanted).copied().collect();
    let mut columns = Vec::new();
    for (group, own) in groups.iter().zip(&times) {
        for channel in &group.channels {
            let values = group.values(channel);
            let values = match wanted {
                None => values,
                Some(_) => time.iter().map(|t| interpolate(own, &values, *t)).collect(),
            };
            columns.push(TypedColumn { title: channel.title.clone(), values });
        }
    }
    let title = groups[base].time.title.clone();
    columns.insert(0, TypedColumn { title, values: time });
    Ok(columns)
}

/// From when to when all groups have samples.
///
/// # Errors
/// Times between which no line can be drawn.
fn span(times: &[Vec<f64>]) -> Read<(f64, f64)> {
    let goes_on = |pair: &&[f64]| pair[0].partial_cmp(&pair[1]) == Some(Ordering::Less);
    if let Some(pair) = times.iter().flat_map(|time| time.windows(2)).find(|pair| !goes_on(pair)) {
        return Err(format!(
            "{} s comes after {} s in a group, so that it cannot be brought to the times of another",
            pair[1], pair[0]
        ));
    }
    let first = times.iter().filter_map(|time| time.first()).fold(f64::NEG_INFINITY, |a, b| a.max(*b));
    let last = times.iter().filter_map(|time| time.last()).fold(f64::INFINITY, |a, b| a.min(*b));
    Ok((first, last))
}

/// The group at whose times all channels are to be taken; nothing where all groups have the same times.
///
/// # Errors
/// Nobody said it, or a channel that is not there.
fn time_of_all(groups: &[Group], times: &[Vec<f64>], names: &Columns) -> Read<Option<usize>> {
    if times.iter().all(|time| *time == times[0]) {
        return Ok(None);
    }
    if let Some(wanted) = &names.times_of {
        let is_it = |channel: &Channel| channel.title == *wanted || split(&channel.title).0 == wanted;
        let group = groups.iter().position(|group| group.channels.iter().any(is_it));
        return group.map(Some).ok_or_else(|| {
            format!("there is no channel {wanted:?} among those that are read, which times_of names")
        });
    }
    let told = groups.iter().zip(times).take(4).map(|(group, time)| {
        let between = (time[time.len() - 1] - time[0]) / (time.len() - 1).max(1) as f64;
        let name = group.channels.first().map_or("", |channel| split(&channel.title).0);
        format!("{name} every {between:.3e} s")
    });
    Err(format!(
        "its channels have times of their own ({}{}); in a file of --map, times_of = \"{}\" takes all at the times of that one, on straight lines between their samples, or only_named = true leaves out what it does not name",
        told.collect::<Vec<_>>().join(", "),
        if groups.len() > 4 { ", ..." } else { "" },
        groups[0].channels.first().map_or("", |channel| split(&channel.title).0),
    ))
}

/// Name and unit of a title.
fn split(title: &str) -> (&str, Option<&str>) {
    match title.strip_suffix(']').and_then(|title| title.rsplit_once(" [")) {
        Some((name, unit)) => (name, Some(unit)),
        None => (title, None),
    }
}

impl Group<'_> {
    fn values(&self, channel: &Channel) -> Vec<f64> {
        let value = |k: usize| {
            let record = &self.records[k * self.length..(k + 1) * self.length];
            let is_invalid = |bit: usize| record[self.data_bytes + bit / 8] >> (bit % 8) & 1 == 1;
            if channel.is_invalid || channel.invalid_bit.is_some_and(is_invalid) {
                return f64::NAN;
            }
            let (stored, is_whole) = match &channel.layout {
                Some(layout) => (layout.number(record), layout.is_whole()),
                None => (k as f64, true),
            };
            channel.conversion.value(stored, is_whole)
        };
        (0..self.count).map(value).collect()
    }
}

/// The groups that have samples of channels that are wanted.
fn groups<'a>(bytes: &'a [u8], names: &Columns) -> Read<Vec<Group<'a>>> {
    let blocks = Blocks(bytes);
    let head = bytes.get(..64).ok_or("this is no MDF file: it has less than 64 bytes")?;
    match &head[..8] {
        b"MDF     " => {}
        b"UnFinMF " => {
            return Err("its recorder has not finished it; Python's asammdf makes a whole file of it: MDF(file).save(other)".into());
        }
        _ => return Err("this is no MDF file: it does not begin with MDF".into()),
    }
    let version = u16::from_le_bytes([head[28], head[29]]);
    if !(400..500).contains(&version) {
        return Err(format!(
            "it is of MDF version {}.{:02}, and 4 is read; Python's asammdf makes one of the other: MDF(file).convert(\"4.10\").save(other)",
            version / 100,
            version % 100
        ));
    }
    let header = blocks.block(64, "HD")?;
    let mut reading = Reading {
        blocks,
        names,
        taken: HashMap::from([("time".into(), 1)]),
        left_out: Vec::new(),
        room: conversion::MAX_NUMBERS,
    };
    let mut groups = Vec::new();
    for block in blocks.chain(header.link(0), "DG")? {
        reading.data_group(&block, &mut groups)?;
    }
    for (name, why) in &reading.left_out {
        if names.of(name).is_some_and(|column| column.variable.is_some()) {
            return Err(format!("the channel {name:?} cannot be read: {why}"));
        }
    }
    if groups.is_empty() {
        let left_out: Vec<String> =
            reading.left_out.iter().take(3).map(|(name, why)| format!("{name:?}: {why}")).collect();
        return Err(format!(
            "it has no channels of numbers over a time, or none that are wanted{}{}",
            if left_out.is_empty() { "" } else { "; left out are " },
            left_out.join(", ")
        ));
    }
    Ok(groups)
}

struct Reading<'a, 'n> {
    blocks: Blocks<'a>,
    names: &'n Columns,
    /// Names of the channels so far, and how many had one.
    taken: HashMap<String, usize>,
    /// Names of channels that are no numbers, and why.
    left_out: Vec<(String, &'static str)>,
    /// For the numbers of conversions.
    room: usize,
}

/// What the block of a channel is.
enum Found {
    Time(Channel),
    Wanted(Channel),
    Nothing,
}

impl<'a> Reading<'a, '_> {
    /// The groups of one stream of data.
    fn data_group(&mut self, block: &Block, groups: &mut Vec<Group<'a>>) -> Read<()> {
        let id_bytes = usize::from(block.data.u8(0)?);
        let described = self.blocks.chain(block.link(1), "CG")?;
        if id_bytes == 0 && described.len() > 1 {
            return Err("groups share their data, and records do not say of which they are".into());
        }
        let mut lengths = HashMap::new();
        let mut found = Vec::new();
        for group in &described {
            let (id, count) = (group.data.u64(0)?, group.data.u64(8)?);
            let [data, invalid] = [24, 28].map(|at| group.data.u32(at).map(|n| n as usize));
            let (data, invalid) = (data?, invalid?);
            // bit 0: values of one channel, of any length
            if group.data.u16(16)? & 1 == 1 {
                lengths.insert(id, Length::Said);
                continue;
            }
            lengths.insert(id, Length::Fixed(data + invalid));
            if count == 0 {
                continue;
            }
            match self.channels(group, data, invalid)? {
                (_, channels) if channels.is_empty() => {}
                (Some(time), channels) => found.push((id, count, data, invalid, time, channels)),
                (None, channels) => {
                    let names = channels.iter().map(|channel| split(&channel.title).0.to_owned());
                    self.left_out.extend(names.map(|name| (name, "its group has no times")));
                }
            }
        }
        if found.is_empty() {
            return Ok(());
        }
        let mut data = records::data(self.blocks, block.link(2))?;
        let mut sorted = match id_bytes {
            0 => None,
            1 | 2 | 4 | 8 => Some(records::sorted(&data, id_bytes, &lengths)?),
            _ => {
                return Err(format!(
                    "its records say of which group they are in {id_bytes} bytes; 1, 2, 4 or 8 are read"
                ));
            }
        };
        for (id, count, data_bytes, invalid, time, channels) in found {
            let length = data_bytes + invalid;
            let records = match &mut sorted {
                None => std::mem::take(&mut data),
                Some(sorted) => Cow::Owned(sorted.remove(&id).unwrap_or_default()),
            };
            let count = usize::try_from(count).ok().filter(|count| *count <= MAX_NUMBERS);
            let is_there =
                |count: &usize| count.checked_mul(length).is_some_and(|bytes| bytes <= records.len());
            let Some(count) = count.filter(is_there) else {
                return Err(format!(
                    "a group says that it has more records than the {} that are there: the file is cut off",
                    records.len().checked_div(length).unwrap_or_default()
                ));
            };
            groups.push(Group { time, channels, records, length, count, data_bytes });
        }
        Ok(())
    }

    /// The time and the wanted channels of a group.
    fn channels(
        &mut self,
        group: &Block,
        data: usize,
        invalid: usize,
    ) -> Read<(Option<Channel>, Vec<Channel>)> {
        let (mut time, mut channels) = (None, Vec::new());
        let mut waiting = self.blocks.chain(group.link(1), "CN")?;
        waiting.reverse();
        let mut seen = 0;
        while let Some(block) = waiting.pop() {
            seen += 1;
            if seen > MAX_COLUMNS {
                return Err(format!("a group has more than {MAX_COLUMNS} channels"));
            }
            // a structure: its parts are channels with places of their own
            if let Some(part) = block.link(1)
                && &self.blocks.any(part)?.name == b"CN"
            {
                waiting.extend(self.blocks.chain(Some(part), "CN")?.into_iter().rev());
                continue;
            }
            match self.channel(&block, data, invalid)? {
                Found::Time(channel) => time = Some(channel),
                Found::Wanted(channel) => channels.push(channel),
                Found::Nothing => {}
            }
        }
        Ok((time, channels))
    }

    fn channel(&mut self, block: &Block, data: usize, invalid: usize) -> Read<Found> {
        let (kind, sync) = (block.data.u8(0)?, block.data.u8(1)?);
        let is_master = matches!(kind, 2 | 3);
        if is_master && sync != 1 {
            return Ok(Found::Nothing);
        }
        let name = self.blocks.text(block.link(2))?;
        let conversion_link = block.link(4);
        let unit = self.unit(block, conversion_link)?;
        let title = |unit: &str| match unit {
            "" => name.clone(),
            unit => format!("{name} [{unit}]"),
        };
        if !is_master && self.names.leaves_out(&title(&unit)) {
            return Ok(Found::Nothing);
        }
        let layout = match kind {
            0 | 2 => Layout::of(block, data)?.map(Some),
            3 | 6 => Ok(None),
            1 | 5 => Err("its values have lengths of their own"),
            _ => Err("it is for synchronisation"),
        };
        let is_array = block.link(1).is_some();
        let layout = if is_array { Err("it is an array") } else { layout };
        let conversion = Conversion::of(self.blocks, conversion_link, &mut self.room)?;
        let (layout, conversion) = match (layout, conversion) {
            (Ok(layout), Ok(conversion)) => (layout, conversion),
            (Err(why), _) | (_, Err(why)) => {
                self.left_out.push((name, why));
                return Ok(Found::Nothing);
            }
        };
        let is_code = unit.is_empty() && Conversion::is_code(self.blocks, conversion_link, &conversion)?;
        let title = title(if is_code { "1" } else { &unit });
        let flags = block.data.u32(12)?;
        let invalid_bit = match flags & 2 {
            0 => None,
            _ => Some(block.data.u32(16)? as usize),
        };
        if invalid_bit.is_some_and(|bit| bit / 8 >= invalid) {
            return Err(format!(
                "the channel {name:?} says in a byte that records do not have what is invalid"
            ));
        }
        let channel = Channel { title, layout, conversion, is_invalid: flags & 1 == 1, invalid_bit };
        if is_master {
            return Ok(Found::Time(Channel { title: "time [s]".into(), ..channel }));
        }
        let title = self.unique(channel.title);
        Ok(Found::Wanted(Channel { title, ..channel }))
    }

    /// A channel's unit, its own or that of its conversion; empty if none is known.
    fn unit(&self, block: &Block, conversion: Option<u64>) -> Read<String> {
        let own = self.blocks.text(block.link(6))?;
        match conversion {
            Some(at) if own.is_empty() => self.blocks.text(self.blocks.block(at, "CC")?.link(1)),
            _ => Ok(own),
        }
    }

    /// A title with a name that no channel has yet: of several with one name, later ones get a number.
    fn unique(&mut self, title: String) -> String {
        let (name, unit) = split(&title);
        let unit = unit.map(|unit| format!(" [{unit}]")).unwrap_or_default();
        let mut name = name.to_owned();
        while let Some(count) = self.taken.get_mut(&name) {
            *count += 1;
            name = format!("{name} ({count})");
        }
        let title = format!("{name}{unit}");
        self.taken.insert(name, 1);
        title
    }
}
