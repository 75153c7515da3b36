//! Unpacking an FMU that nobody has checked: nothing is written outside the temporary folder, and
//! no file can fill the disk.

use crate::temporary::{Folder, before_the_end};
use crate::{Error, Result};
use std::collections::HashSet;
use std::fs::{self, File};
use std::io::{self, BufReader, Read, Write};
use std::path::Path;
use zip::ZipArchive;
use zip::read::ZipFile;
use zip::result::ZipError;

/// More entries than this are refused.
pub const MAX_ENTRIES: usize = 100_000;
/// More bytes than this, unpacked, are refused: 4 GiB.
pub const MAX_UNPACKED: u64 = 4 << 30;

/// How much an archive may hold.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Number of entries.
    pub entries: usize,
    /// Bytes of all entries together, unpacked.
    pub unpacked: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { entries: MAX_ENTRIES, unpacked: MAX_UNPACKED }
    }
}

/// An FMU file, opened for reading.
#[derive(Debug)]
pub struct Archive {
    /// The file's name, for messages.
    name: String,
    zip: ZipArchive<BufReader<File>>,
    limits: Limits,
}

impl Archive {
    /// Opens the archive at `path`.
    ///
    /// # Errors
    /// [`Error::fmu`]: no such file, not a zip archive, too many entries, or two entries with the same
    /// name.
    pub fn open(path: &Path) -> Result<Self> {
        Self::open_within(path, Limits::default())
    }

    /// As [`open`](Self::open), with other limits.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn open_within(path: &Path, limits: Limits) -> Result<Self> {
        let name = path.display().to_string();
        let fail = |what: String| Error::fmu(what).at(&name);
        let closed = |e: io::Error| fail(format!("the file cannot be opened: {e}"));
        // before it is opened, as a pipe that nobody writes to would be waited for
        let about = fs::metadata(path).map_err(closed)?;
        if !about.is_file() {
            let what = if about.is_dir() { "a folder" } else { "no ordinary file" };
            return Err(fail(format!(
                "this is {what}; a zip archive is needed, as which an FMU (.fmu) or an SSP system (.ssp) comes"
            )));
        }
        let file = File::open(path).map_err(closed)?;
        let zip = ZipArchive::new(BufReader::new(file)).map_err(|e| {
            fail(format!("this is not a complete zip archive: it is something else, or damaged ({e})"))
        })?;
        if zip.len() > limits.entries {
            return Err(fail(format!(
                "the archive has {} entries; more than {} are not unpacked",
                zip.len(),
                limits.entries
            )));
        }
        if zip.has_duplicate_names() {
            return Err(fail("the archive has two entries with the same name".into()));
        }
        Ok(Self { name, zip, limits })
    }

    /// The names of the entries, as far as they are text.
    pub fn names(&self) -> impl Iterator<Item = String> {
        self.zip.file_names().filter_map(|name| Some(name.ok()?.into_owned()))
    }

    /// The bytes of the entry called `entry`; `None` if there is none.
    ///
    /// # Errors
    /// [`Error::fmu`]: a damaged or encrypted entry, or one of more than `limit` bytes.
    pub fn read(&mut self, entry: &str, limit: u64) -> Result<Option<Vec<u8>>> {
        let Some(index) = self.zip.index_for_name(entry) else { return Ok(None) };
        let file = entry_at(&mut self.zip, &self.name, index)?;
        let mut bytes = Vec::new();
        // One byte more than allowed tells a file that is too long from one that just fits.
        file.take(limit.saturating_add(1))
            .read_to_end(&mut bytes)
            .map_err(|e| entry_error(&self.name, entry, &damaged(&e)))?;
        if bytes.len() as u64 > limit {
            return Err(entry_error(&self.name, entry, &format!("it has more than {limit} bytes")));
        }
        Ok(Some(bytes))
    }

    /// Unpacks everything into a new temporary folder, which is removed when it is dropped.
    ///
    /// Only plain files and folders are made, with this process's usual rights.
    ///
    /// # Errors
    /// [`Error::fmu`]: an entry that is damaged, encrypted, a link, or whose path would leave the
    /// folder; more bytes than the limit; a disk that is full.
    pub fn unpack(&mut self) -> Result<Folder> {
        let fail = |what: String| Error::fmu(what).at(&self.name);
        // the same bytes would be unpacked again and again
        if self.zip.has_overlapping_entries().map_err(|e| fail(format!("the archive is damaged: {e}")))? {
            return Err(fail(
                "entries of the archive overlap each other; such archives are not unpacked".into(),
            ));
        }
        let folder = Folder::new("latsch-fmu-")
            .map_err(|e| fail(format!("no temporary folder can be made to unpack into: {e}")))?;
        let mut left = self.limits.unpacked;
        let mut seen = HashSet::new();
        for index in 0..self.zip.len() {
            let mut file = entry_at(&mut self.zip, &self.name, index)?;
            let entry = entry_name(&file);
            let wrong = |what: &str| entry_error(&self.name, &entry, what);
            if let Err(what) = check_path(&entry) {
                return Err(wrong(what));
            }
            check_type(&file).map_err(wrong)?;
            if !seen.insert(entry.trim_end_matches('/').to_owned()) {
                return Err(wrong("the archive has two entries with this name"));
            }
            let target = folder.path().join(&entry);
            let io = |e: io::Error| wrong(&format!("it cannot be unpacked: {e}"));
            if file.is_dir() {
                before_the_end(|| fs::create_dir_all(&target)).map_err(io)?;
                continue;
            }
            let mut out = before_the_end(|| {
                if let Some(parent) = target.parent() {
                    fs::create_dir_all(parent)?;
                }
                // Fails if anything is there already, be it through names that differ only in case.
                File::create_new(&target)
            })
            .map_err(io)?;
            left = match copy(&mut file, &mut out, left) {
                Ok(Some(left)) => left,
                Ok(None) => {
                    return Err(wrong(&format!(
                        "with it the archive unpacks to more than {} bytes; that is not done",
                        self.limits.unpacked
                    )));
                }
                Err(Copying::Read(e)) => return Err(wrong(&damaged(&e))),
                Err(Copying::Write(e)) => return Err(io(e)),
            };
        }
        Ok(folder)
    }
}

enum Copying {
    Read(io::Error),
    Write(io::Error),
}

/// Copies at most `left` bytes; what is then left, or `None` if there was more. The size in the
/// header counts for nothing: it may lie.
fn copy(from: &mut impl Read, to: &mut impl Write, left: u64) -> std::result::Result<Option<u64>, Copying> {
    let mut buffer = [0; 1 << 16];
    let mut left = left;
    loop {
        let count = match from.read(&mut buffer) {
            Ok(0) => return Ok(Some(left)),
            Ok(count) => count,
            Err(e) if e.kind() == io::ErrorKind::Interrupted => continue,
            Err(e) => return Err(Copying::Read(e)),
        };
        match left.checked_sub(count as u64) {
            Some(rest) => left = rest,
            None => return Ok(None),
        }
        to.write_all(&buffer[..count]).map_err(Copying::Write)?;
    }
}

fn entry_at<'a>(
    zip: &'a mut ZipArchive<BufReader<File>>,
    name: &str,
    index: usize,
) -> Result<ZipFile<'a, BufReader<File>>> {
    let entry = match zip.name_for_index(index) {
        Some(Ok(entry)) => entry.into_owned(),
        _ => format!("number {}", index + 1),
    };
    zip.by_index(index).map_err(|e| {
        let what = match e {
            ZipError::UnsupportedArchive(ZipError::PASSWORD_REQUIRED) | ZipError::InvalidPassword => {
                "it is encrypted, which FMI forbids; ask for the FMU without password".into()
            }
            ZipError::CompressionMethodNotSupported(_) => {
                format!("{e}; FMI 2.0 allows only deflate and store")
            }
            e => format!("it is damaged: {e}"),
        };
        entry_error(name, &entry, &what)
    })
}

fn entry_name(file: &ZipFile<'_, BufReader<File>>) -> String {
    file.name().map_or_else(|_| String::from_utf8_lossy(file.name_raw()).into_owned(), |n| n.into_owned())
}

fn entry_error(name: &str, entry: &str, what: &str) -> Error {
    Error::fmu(format!("{name}: entry {entry:?}: {what}"))
}

fn damaged(error: &io::Error) -> String {
    format!("it is damaged: {error}")
}

/// Fails unless joining the path to a folder stays in that folder, on any system.
pub(in crate::fmi) fn check_path(path: &str) -> std::result::Result<(), &'static str> {
    if path.contains('\0') {
        return Err("its path holds a NUL character; this archive is not unpacked");
    }
    if path.contains('\\') {
        return Err("its path holds a backslash; zip archives separate folders by '/'");
    }
    if path.starts_with('/') {
        return Err("its path is absolute and would be written outside the folder to unpack into");
    }
    if path.as_bytes().get(1) == Some(&b':') {
        return Err("its path starts with a drive letter and would be written outside the folder");
    }
    let path = path.strip_suffix('/').unwrap_or(path);
    for part in path.split('/') {
        match part {
            ".." => return Err("its path contains '..' and could be written outside the folder"),
            "" | "." => return Err("its path has an empty part or '.'; this archive is not unpacked"),
            _ => {}
        }
    }
    Ok(())
}

/// Fails for links, devices and the like.
fn check_type(file: &ZipFile<'_, BufReader<File>>) -> std::result::Result<(), &'static str> {
    const TYPE: u32 = 0o170_000;
    const FOLDER: u32 = 0o040_000;
    const PLAIN: u32 = 0o100_000;
    if file.is_symlink() {
        return Err("it is a symbolic link, which FMI forbids");
    }
    match file.unix_mode().unwrap_or(0) & TYPE {
        0 | FOLDER | PLAIN => Ok(()),
        _ => Err("it is neither a file nor a folder"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;
    use tempfile::TempDir;
    use zip::CompressionMethod;
    use zip::write::{SimpleFileOptions, ZipWriter};

    type Writer = ZipWriter<File>;

    /// An archive in a folder of its own.
    fn archive(write: impl FnOnce(&mut Writer)) -> (TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("unit.fmu");
        let mut zip = ZipWriter::new(File::create(&path).unwrap());
        write(&mut zip);
        zip.finish().unwrap();
        (folder, path)
    }

    fn add(zip: &mut Writer, name: &str, bytes: &[u8]) {
        zip.start_file(name, SimpleFileOptions::default()).unwrap();
        zip.write_all(bytes).unwrap();
    }

    fn refusal(path: &Path, limits: Limits) -> String {
        let error = Archive::open_within(path, limits).and_then(|mut a| a.unpack()).unwrap_err();
        assert_eq!(error.kind(), crate::ErrorKind::Fmu);
        error.to_string()
    }

    /// Replaces every occurrence of `from` in the file: for names that the writer would clean up.
    fn forge(path: &Path, from: &[u8], to: &[u8]) {
        assert_eq!(from.len(), to.len());
        let mut bytes = fs::read(path).unwrap();
        let mut found = 0;
        for i in 0..bytes.len() - from.len() {
            if bytes[i..].starts_with(from) {
                bytes[i..i + from.len()].copy_from_slice(to);
                found += 1;
            }
        }
        assert_eq!(found, 2, "local and central header");
        fs::write(path, bytes).unwrap();
    }

    #[test]
    fn unpacks_files_and_folders() {
        let (_folder, path) = archive(|zip| {
            add(zip, "modelDescription.xml", b"<x/>");
            zip.add_directory("resources", SimpleFileOptions::default()).unwrap();
            add(zip, "resources/deep/a b.txt", b"text");
        });
        let mut archive = Archive::open(&path).unwrap();
        assert_eq!(archive.read("modelDescription.xml", 4).unwrap().as_deref(), Some(&b"<x/>"[..]));
        assert_eq!(archive.read("nothing", 4).unwrap(), None);
        let message = archive.read("modelDescription.xml", 3).unwrap_err().to_string();
        assert!(message.contains("more than 3 bytes"), "{message}");
        let unpacked = archive.unpack().unwrap();
        assert_eq!(fs::read(unpacked.path().join("resources/deep/a b.txt")).unwrap(), b"text");
        let kept = unpacked.path().to_owned();
        drop(unpacked);
        assert!(!kept.exists());
    }

    #[test]
    fn refuses_paths_that_leave_the_folder() {
        for (forged, word) in [
            ("../../../evil.txt", "'..'"),
            ("resources/../../e", "'..'"),
            ("/evil-latsch0", "absolute"),
            ("..\\..\\..\\evil.txt", "backslash"),
            ("C:/windows/evil.t", "drive letter"),
            ("resources/e\0.text", "NUL"),
            ("resources//ee.txt", "empty part"),
            ("resources/./e.txt", "empty part"),
        ] {
            let honest = "a".repeat(forged.len());
            let (folder, path) = archive(|zip| add(zip, &honest, b"evil"));
            forge(&path, honest.as_bytes(), forged.as_bytes());
            let message = refusal(&path, Limits::default());
            assert!(message.contains(word), "{forged:?}: {message}");
            assert!(message.contains("unit.fmu") && message.contains("entry"), "{message}");
            // Nothing appears beside the archive.
            assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        }
        assert!(!Path::new("/evil-latsch0").exists());
    }

    #[test]
    fn refuses_links_and_duplicates() {
        let (_folder, path) = archive(|zip| {
            zip.add_symlink("resources", "/etc", SimpleFileOptions::default()).unwrap();
            add(zip, "resources/passwd", b"evil");
        });
        let message = refusal(&path, Limits::default());
        assert!(message.contains("symbolic link"), "{message}");

        let (_folder, path) = archive(|zip| {
            add(zip, "twin-a", b"one");
            add(zip, "twin-b", b"two");
        });
        forge(&path, b"twin-b", b"twin-a");
        let message = refusal(&path, Limits::default());
        assert!(message.contains("same name"), "{message}");

        let (_folder, path) = archive(|zip| {
            add(zip, "node", b"file");
            add(zip, "node/leaf", b"below a file");
        });
        let message = refusal(&path, Limits::default());
        assert!(message.contains("node/leaf"), "{message}");
    }

    #[test]
    fn refuses_bombs_by_what_comes_out() {
        let (_folder, path) = archive(|zip| {
            add(zip, "first", &[1; 1000]);
            add(zip, "bomb", &vec![0; 10_000_000]);
        });
        assert!(fs::metadata(&path).unwrap().len() < 50_000);
        // The archive now claims that the bomb unpacks to one byte.
        let mut bytes = fs::read(&path).unwrap();
        let size = 10_000_000u32.to_le_bytes();
        for i in 0..bytes.len() - 4 {
            if bytes[i..i + 4] == size {
                bytes[i..i + 4].copy_from_slice(&1u32.to_le_bytes());
            }
        }
        let lying = path.with_file_name("lying.fmu");
        fs::write(&lying, bytes).unwrap();
        for path in [&path, &lying] {
            let message = refusal(path, Limits { unpacked: 1_000_000, ..Limits::default() });
            assert!(message.contains("bomb"), "{message}");
        }
        let message = refusal(&path, Limits { entries: 1, ..Limits::default() });
        assert!(message.contains("2 entries"), "{message}");
    }

    #[test]
    fn refuses_what_is_broken() {
        let folder = tempfile::tempdir().unwrap();
        let text = folder.path().join("text.fmu");
        fs::write(&text, "not an archive").unwrap();
        assert!(refusal(&text, Limits::default()).contains("not a complete zip archive"));
        assert!(refusal(folder.path(), Limits::default()).contains("folder"));
        let message = refusal(&folder.path().join("none.fmu"), Limits::default());
        assert!(message.contains("cannot be opened"), "{message}");

        let (_folder, path) = archive(|zip| {
            let stored = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
            zip.start_file("data", stored).unwrap();
            zip.write_all(b"some data, some more data").unwrap();
        });
        let bytes = fs::read(&path).unwrap();
        for length in [bytes.len() / 3, bytes.len() - 5] {
            fs::write(&path, &bytes[..length]).unwrap();
            assert!(refusal(&path, Limits::default()).contains("not a complete zip archive"));
        }
        let mut flipped = bytes.clone();
        let at = bytes.windows(4).position(|w| w == b"more").unwrap();
        flipped[at] ^= 1;
        fs::write(&path, flipped).unwrap();
        let message = refusal(&path, Limits::default());
        assert!(message.contains("\"data\"") && message.contains("damaged"), "{message}");

        // The flag that says "encrypted" in both headers.
        let mut locked = bytes;
        for (signature, flags) in [(b"PK\x03\x04", 6), (b"PK\x01\x02", 8)] {
            let at = locked.windows(4).position(|w| w == signature).unwrap();
            locked[at + flags] |= 1;
        }
        fs::write(&path, locked).unwrap();
        let message = refusal(&path, Limits::default());
        assert!(message.contains("encrypted"), "{message}");
    }

    #[test]
    fn survives_any_damage() {
        let (folder, path) = archive(|zip| {
            add(zip, "modelDescription.xml", b"some text, some text");
            add(zip, "resources/a", b"");
        });
        let bytes = fs::read(&path).unwrap();
        for position in 0..bytes.len() {
            for change in [0x01, 0x2f, 0x80, 0xff] {
                let mut damaged = bytes.clone();
                damaged[position] ^= change;
                fs::write(&path, damaged).unwrap();
                // Right or refused, but never a panic, nor a file beside the archive.
                if let Ok(mut archive) = Archive::open(&path) {
                    let _ = archive.read("modelDescription.xml", 1000);
                    let _ = archive.unpack();
                }
                assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
            }
        }
    }
}
