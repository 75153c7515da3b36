//! Writes MDF 4.10: one group of channels in double precision, uncompressed.

use crate::recording::Recording;
use crate::recording::form::{BLOCK, check_lengths};
use crate::{Result, VERSION};
use std::io::Write;
use std::path::Path;

/// Writes a recording as MDF 4.10 that [`read_mdf`](super::read_mdf) reads back with the same bits, whole or not at all. Values that are not finite
/// are written as they are, as in CSV.
///
/// # Errors
/// Channels that are not as long as the time; any failure of the file system, with the path.
pub(crate) fn write_mdf(path: &Path, recording: &Recording) -> Result<()> {
    check_lengths(recording).map_err(|e| e.at(path.display()))?;
    crate::file::write_whole(path, |file| write(file, recording))
}

pub(super) fn write(file: &mut dyn Write, recording: &Recording) -> std::io::Result<()> {
    let rows = recording.time.len();
    let width = 8 * (1 + recording.channels.len());
    file.write_all(&description(recording, rows, width))?;
    let mut records = Vec::with_capacity(BLOCK + width);
    for (row, time) in recording.time.iter().enumerate() {
        records.extend(time.to_le_bytes());
        recording.channels.iter().for_each(|channel| records.extend(channel.values[row].to_le_bytes()));
        if records.len() >= BLOCK {
            file.write_all(&records)?;
            records.clear();
        }
    }
    file.write_all(&records)
}

/// All blocks, and the head of the one with the records, which is the last.
fn description(recording: &Recording, rows: usize, width: usize) -> Vec<u8> {
    let mut file = Vec::from(*b"MDF     4.10    latsch  \0\0\0\0");
    file.extend(410u16.to_le_bytes());
    file.resize(64, 0);
    // links are filled in once it is known where they lead to
    let mut links: Vec<(usize, usize)> = Vec::new();
    // start at 0 s after the epoch, which is nothing that a simulation has; the rest is zero as well
    let header = block(&mut file, "HD", 6, &[0; 32]);
    let history = block(&mut file, "FH", 2, &[0; 16]);
    let comment = text(
        &mut file,
        "MD",
        &format!(
            "<FHcomment><TX>written by latsch</TX><tool_id>latsch</tool_id><tool_vendor>latsch</tool_vendor><tool_version>{VERSION}</tool_version></FHcomment>"
        ),
    );
    let data_group = block(&mut file, "DG", 4, &[0; 8]);
    let mut about = [0; 32];
    about[8..16].copy_from_slice(&(rows as u64).to_le_bytes());
    about[24..28].copy_from_slice(&(width as u32).to_le_bytes());
    let group = block(&mut file, "CG", 6, &about);
    links.extend([(link(header, 0), data_group), (link(header, 1), history)]);
    links.extend([(link(history, 1), comment), (link(data_group, 1), group)]);
    let channels = recording.channels.iter().map(|channel| (channel.name.as_str(), channel.unit.as_str()));
    let mut before = link(group, 1);
    for (k, (name, unit)) in std::iter::once(("time", "s")).chain(channels).enumerate() {
        let mut about = [0; 72];
        if k == 0 {
            // the master of the group, over time
            about[..2].copy_from_slice(&[2, 1]);
        }
        // floating point, little-endian
        about[2] = 4;
        about[4..8].copy_from_slice(&(8 * k as u32).to_le_bytes());
        about[8..12].copy_from_slice(&64u32.to_le_bytes());
        let channel = block(&mut file, "CN", 8, &about);
        let (name, unit) = (text(&mut file, "TX", name), text(&mut file, "TX", unit));
        links.extend([(before, channel), (link(channel, 2), name), (link(channel, 6), unit)]);
        before = link(channel, 0);
    }
    let data = head(&mut file, "DT", 0, rows * width);
    links.push((link(data_group, 2), data));
    for (from, to) in links {
        file[from..from + 8].copy_from_slice(&(to as u64).to_le_bytes());
    }
    file
}

/// Where link `k` of a block stands.
fn link(block: usize, k: usize) -> usize {
    block + 24 + 8 * k
}

/// Begins a block at a multiple of eight bytes, and says where.
fn head(file: &mut Vec<u8>, name: &str, links: usize, data: usize) -> usize {
    file.resize(file.len().next_multiple_of(8), 0);
    let at = file.len();
    file.extend(b"##");
    file.extend(name.as_bytes());
    file.extend([0; 4]);
    file.extend(((24 + 8 * links + data) as u64).to_le_bytes());
    file.extend((links as u64).to_le_bytes());
    at
}

fn block(file: &mut Vec<u8>, name: &str, links: usize, data: &[u8]) -> usize {
    let at = head(file, name, links, data.len());
    file.resize(file.len() + 8 * links, 0);
    file.extend(data);
    at
}

fn text(file: &mut Vec<u8>, name: &str, text: &str) -> usize {
    block(file, name, 0, format!("{text}\0").as_bytes())
}
