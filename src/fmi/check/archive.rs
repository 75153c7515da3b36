//! The rules on the archive, read from the bytes of its headers: a library for zip archives smooths
//! over what is looked for here.

use super::finding::{Finding, Place};
use crate::fmi::import::archive::check_path;
use std::collections::{BTreeMap, BTreeSet, HashSet};

/// What the archive's directory says of an entry.
pub(super) struct Entry {
    pub(super) name: String,
    utf8: bool,
    made_by: u16,
    version: u16,
    flags: u16,
    method: u16,
    disk: u16,
    attributes: u32,
    offset: u32,
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(bytes.get(at..at.checked_add(2)?)?.try_into().ok()?))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at.checked_add(4)?)?.try_into().ok()?))
}

/// The end record of a zip archive, which may be followed by a comment.
fn end_record(bytes: &[u8]) -> Option<usize> {
    let first = bytes.len().saturating_sub(22 + 65_535);
    (first..bytes.len().saturating_sub(21)).rev().find(|at| bytes[*at..].starts_with(b"PK\x05\x06"))
}

/// Reads the directory and checks all that is written in headers. `None` if the file is no zip archive.
pub(super) fn check_headers(bytes: &[u8], findings: &mut Vec<Finding>) -> Option<Vec<Entry>> {
    let end = end_record(bytes)?;
    let whole = |what: &str| Finding::error("Z1", None, what);
    if u16_at(bytes, end + 4)? != 0 || u16_at(bytes, end + 6)? != 0 {
        findings.push(whole("the archive is one part of several"));
    }
    if end >= 20 && bytes[end - 20..].starts_with(b"PK\x06\x07") {
        findings
            .push(whole("the archive uses zip64, which needs version 4.5 of the format; 2.0 is the limit"));
    }
    let (count, mut at) = (u16_at(bytes, end + 10)?, u32_at(bytes, end + 16)? as usize);
    let mut entries = Vec::new();
    for _ in 0..count {
        let Some(entry) = read_entry(bytes, &mut at) else {
            findings.push(whole("the archive's directory is damaged"));
            break;
        };
        check_entry(&entry, bytes, findings);
        entries.push(entry);
    }
    let mut seen = HashSet::new();
    for entry in &entries {
        if !seen.insert(entry.name.trim_end_matches('/').to_lowercase()) {
            let what =
                "there are two entries with this name (not all systems tell small from capital letters)";
            findings.push(Finding::error("Z1", Some(Place::entry(&entry.name)), what));
        }
    }
    Some(entries)
}

fn read_entry(bytes: &[u8], at: &mut usize) -> Option<Entry> {
    let start = *at;
    if !bytes.get(start..)?.starts_with(b"PK\x01\x02") {
        return None;
    }
    let field = |offset: usize| u16_at(bytes, start + offset);
    let [name, extra, comment] = [field(28)?, field(30)?, field(32)?].map(usize::from);
    let name = bytes.get(start + 46..start + 46 + name)?;
    *at = start + 46 + name.len() + extra + comment;
    Some(Entry {
        utf8: std::str::from_utf8(name).is_ok(),
        name: String::from_utf8_lossy(name).into_owned(),
        made_by: field(4)? >> 8,
        version: field(6)? & 0xff,
        flags: field(8)?,
        method: field(10)?,
        disk: field(34)?,
        attributes: u32_at(bytes, start + 38)?,
        offset: u32_at(bytes, start + 42)?,
    })
}

fn check_entry(entry: &Entry, bytes: &[u8], findings: &mut Vec<Finding>) {
    let mut report = |what: String| {
        findings.push(Finding::error("Z1", Some(Place::entry(&entry.name)), what));
    };
    match entry.method {
        0 | 8 => {}
        method => {
            let name = match method {
                9 => "deflate64",
                12 => "bzip2",
                14 => "lzma",
                93 => "zstd",
                95 => "xz",
                99 => "AES",
                _ => "unknown",
            };
            report(format!(
                "the compression method is {method} ({name}); only store and deflate are allowed"
            ));
        }
    }
    if entry.version > 20 {
        let (major, minor) = (entry.version / 10, entry.version % 10);
        report(format!("version {major}.{minor} of the zip format is needed to read it; 2.0 is the limit"));
    }
    if entry.flags & 0x2041 != 0 {
        report("it is encrypted".into());
    }
    if entry.flags & 0x20 != 0 {
        report("it is patched data, which few programs read".into());
    }
    if entry.flags & 0x08 != 0 && entry.method != 8 {
        report("its size follows the data (flag 3), which is allowed with deflate only".into());
    }
    if entry.disk != 0 {
        report("it is in another part of the archive".into());
    }
    // Unix, macOS: the upper half holds the mode.
    if matches!(entry.made_by, 3 | 19) {
        match entry.attributes >> 16 & 0o170_000 {
            0o120_000 => report("it is a symbolic link".into()),
            0 | 0o040_000 | 0o100_000 => {}
            _ => report("it is neither a file nor a folder".into()),
        }
    }
    if let Err(what) = check_path(&entry.name) {
        report(what.into());
    }
    if !entry.utf8 {
        report("its name is not UTF-8".into());
    }
    // The header beside the data has to say the same.
    let local = entry.offset as usize;
    let same = bytes.get(local..).is_some_and(|b| b.starts_with(b"PK\x03\x04"))
        && u16_at(bytes, local + 6) == Some(entry.flags)
        && u16_at(bytes, local + 8) == Some(entry.method)
        && bytes.get(local + 30..).is_some_and(|b| !entry.utf8 || b.starts_with(entry.name.as_bytes()));
    if !same {
        report("its header and the archive's directory contradict each other".into());
    }
}

/// The platforms of FMI 2.0.
const PLATFORMS: &[&str] = &["win32", "win64", "linux32", "linux64", "darwin32", "darwin64"];

/// True for the tuples of FMI 3.0, such as aarch64-darwin, which newer machines need.
fn is_tuple(platform: &str) -> bool {
    let Some((machine, rest)) = platform.split_once('-') else { return false };
    let system = rest.split('-').next().unwrap_or_default();
    matches!(machine, "x86" | "x86_64" | "aarch32" | "aarch64" | "riscv32" | "riscv64" | "ppc32" | "ppc64")
        && matches!(system, "darwin" | "linux" | "windows")
}

fn ending(platform: &str) -> &'static str {
    if platform.contains("win") && !platform.contains("darwin") {
        "dll"
    } else if platform.contains("darwin") {
        "dylib"
    } else {
        "so"
    }
}

/// The platforms that there are files for.
pub(super) fn platforms(entries: &[Entry]) -> Vec<String> {
    let names = entries.iter().filter_map(|e| e.name.strip_prefix("binaries/")?.split_once('/'));
    let platforms: BTreeSet<&str> = names.filter(|(_, file)| !file.is_empty()).map(|(p, _)| p).collect();
    platforms.into_iter().map(Into::into).collect()
}

/// Checks the folders; `identifiers` and `sources` are those that the description names.
pub(super) fn check_folders(
    entries: &[Entry],
    identifiers: &[String],
    sources: &[String],
    findings: &mut Vec<Finding>,
) {
    let names: BTreeSet<&str> = entries.iter().map(|e| e.name.as_str()).collect();
    let mut platforms: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for name in &names {
        if let Some((platform, file)) = name.strip_prefix("binaries/").and_then(|rest| rest.split_once('/')) {
            platforms.entry(platform).or_default().push(file);
        } else if let Some(rest) = name.strip_prefix("extra/")
            && let Some((folder, _)) = rest.split_once('/')
            && !folder.contains('.')
        {
            let what = format!("the folder {folder:?} in extra is no reversed domain name");
            findings.push(Finding::warning("Z4", Some(Place::entry(*name)), what));
        }
    }
    for (platform, files) in &platforms {
        let place = || Some(Place::entry(format!("binaries/{platform}/")));
        if !PLATFORMS.contains(platform) && !is_tuple(platform) {
            findings.push(Finding::warning("Z2", place(), format!("there is no platform {platform:?}")));
            continue;
        }
        for identifier in identifiers {
            let file = format!("{identifier}.{}", ending(platform));
            if files.contains(&file.as_str()) {
                continue;
            }
            let what = format!("there is no {file}, although the modelIdentifier is {identifier:?}");
            // Windows finds files whatever the case of their letters.
            let found = ending(platform) == "dll" && files.iter().any(|f| f.eq_ignore_ascii_case(&file));
            findings.push(match found {
                true => Finding::warning("X2", place(), format!("{what}; the case of the letters differs")),
                false => Finding::error("X2", place(), what),
            });
        }
    }
    let has_sources = names.iter().any(|n| n.starts_with("sources/") && !n.ends_with('/'));
    if platforms.is_empty() && !has_sources {
        findings.push(Finding::error("Z2", None, "the FMU has neither binaries nor sources"));
    }
    for source in sources {
        if !names.contains(format!("sources/{source}").as_str()) {
            let what = "the description lists this source file, but it is not in the archive";
            findings.push(Finding::error("Z4", Some(Place::entry(format!("sources/{source}"))), what));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Cursor, Write};
    use zip::CompressionMethod;
    use zip::write::{SimpleFileOptions, ZipWriter};

    type Writer = ZipWriter<Cursor<Vec<u8>>>;

    fn archive(write: impl FnOnce(&mut Writer)) -> Vec<u8> {
        let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
        write(&mut zip);
        zip.finish().unwrap().into_inner()
    }

    fn add(zip: &mut Writer, name: &str) {
        let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
        zip.start_file(name, options).unwrap();
        zip.write_all(name.as_bytes()).unwrap();
    }

    fn plain() -> Vec<u8> {
        archive(|zip| {
            add(zip, "modelDescription.xml");
            add(zip, "binaries/linux64/hub.so");
            add(zip, "sources/hub.c");
        })
    }

    fn found(bytes: &[u8]) -> Vec<String> {
        let mut findings = Vec::new();
        let entries = check_headers(bytes, &mut findings).unwrap();
        check_folders(&entries, &["hub".into()], &["hub.c".into()], &mut findings);
        findings.iter().map(Finding::as_text).collect()
    }

    #[track_caller]
    fn finds(bytes: &[u8], words: &[&str]) {
        let found = found(bytes);
        assert_eq!(found.len(), 1, "{}", found.join("\n"));
        for word in words {
            assert!(found[0].contains(word), "{word:?} is not in:\n{}", found[0]);
        }
    }

    /// Changes the field of 16 bits at `offset` of the last entry of the directory, and at `local` of
    /// its local header.
    fn forge(mut bytes: Vec<u8>, offset: usize, local: Option<usize>, value: u16) -> Vec<u8> {
        let last = |bytes: &[u8], sign: &[u8]| bytes.windows(4).rposition(|w| w == sign).unwrap();
        let at = last(&bytes, b"PK\x01\x02") + offset;
        bytes[at..at + 2].copy_from_slice(&value.to_le_bytes());
        if let Some(local) = local {
            let at = last(&bytes, b"PK\x03\x04") + local;
            bytes[at..at + 2].copy_from_slice(&value.to_le_bytes());
        }
        bytes
    }

    #[test]
    fn plain_archives_are_clean() {
        assert_eq!(found(&plain()), Vec::<String>::new());
        assert!(check_headers(b"no archive", &mut Vec::new()).is_none());
        assert!(check_headers(b"", &mut Vec::new()).is_none());
    }

    #[test]
    fn every_trick_is_found() {
        finds(&forge(plain(), 10, Some(8), 93), &["error[Z1]", "93 (zstd)", "--> sources/hub.c", "2.3"]);
        finds(&forge(plain(), 6, None, 45), &["Z1", "version 4.5"]);
        finds(&forge(plain(), 8, Some(6), 1), &["Z1", "encrypted"]);
        finds(&forge(forge(plain(), 8, Some(6), 8), 10, Some(8), 0), &["Z1", "flag 3"]);
        finds(&forge(plain(), 34, None, 1), &["Z1", "another part"]);
        finds(&forge(plain(), 10, None, 0), &["Z1", "contradict"]);
        // The mode of a symbolic link, made on Unix.
        finds(&forge(forge(plain(), 40, None, 0o120_777), 4, None, 0x0314), &["Z1", "symbolic link"]);
        let text = |from: &str, to: &str| {
            let (mut bytes, from, to) = (plain(), from.as_bytes(), to.as_bytes());
            for at in 0..bytes.len() - from.len() {
                if bytes[at..].starts_with(from)
                    && (bytes[..at].ends_with(&[0, 0]) || bytes[at - 4..at] != *b"    ")
                {
                    bytes[at..at + from.len()].copy_from_slice(to);
                }
            }
            bytes
        };
        let found_names = found(&text("sources/hub.c", "sources\\hub.c"));
        assert!(found_names.iter().any(|f| f.contains("Z1") && f.contains("backslash")), "{found_names:?}");
        let found_names = found(&text("sources/hub.c", "../../../hub."));
        assert!(found_names.iter().any(|f| f.contains("Z1") && f.contains("'..'")), "{found_names:?}");
        let mut cut = plain();
        let at = cut.windows(4).position(|w| w == b"PK\x01\x02").unwrap();
        cut[at] = b'X';
        assert!(found(&cut).iter().any(|f| f.contains("directory is damaged")));
    }

    #[test]
    fn folders() {
        let with = |name: &str| {
            let mut files = vec!["binaries/linux64/hub.so", "sources/hub.c"];
            files.push(name);
            archive(|zip| files.iter().for_each(|name| add(zip, name)))
        };
        finds(&with("SOURCES/hub.c"), &["Z1", "two entries"]);
        finds(&with("binaries/amiga/hub.so"), &["warning[Z2]", "amiga"]);
        finds(&with("binaries/win64/rim.dll"), &["error[X2]", "binaries/win64/", "hub.dll"]);
        finds(&with("binaries/win64/Hub.DLL"), &["warning[X2]", "hub.dll", "case"]);
        finds(&with("extra/mine/data"), &["warning[Z4]", "mine"]);
        for good in ["extra/org.example/data", "binaries/win64/hub.dll", "binaries/aarch64-darwin/hub.dylib"]
        {
            assert_eq!(found(&with(good)), Vec::<String>::new());
        }
        finds(&archive(|zip| add(zip, "binaries/linux64/hub.so")), &["error[Z4]", "sources/hub.c"]);
        let found = found(&archive(|zip| add(zip, "modelDescription.xml")));
        assert!(found[0].contains("neither binaries nor sources"));
    }

    #[test]
    fn any_cut_is_survived() {
        let bytes = plain();
        for end in 0..bytes.len() {
            check_headers(&bytes[..end], &mut Vec::new());
        }
    }
}
