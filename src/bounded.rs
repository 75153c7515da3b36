//! Reading files of which nobody knows how long they are: no more than a limit, whatever the file system says. A file may
//! be a pipe without end, and memory that runs out ends the process.

use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Settings, systems, effects and lists of runs are no longer \[bytes\]: a hundred times the longest that latsch writes.
/// In memory, TOML takes up to some fifty times its length.
pub(crate) const MAX_TEXT: u64 = 16 << 20;

/// The bytes of a file.
///
/// # Errors
/// What is wrong, without the file's name: it cannot be read, or has more than `limit` bytes.
pub(crate) fn read(path: &Path, limit: u64) -> Result<Vec<u8>, String> {
    let file = File::open(path).map_err(|e| e.to_string())?;
    // a first look, so that a file that says it is too long is not read at all
    let length = file.metadata().map_err(|e| e.to_string())?.len();
    let too_long = || format!("it has more than {} MB, the most that is read of such a file", limit >> 20);
    if length > limit {
        return Err(too_long());
    }
    let mut bytes = Vec::new();
    // one byte more than allowed tells a file that is too long from one that just fits
    file.take(limit + 1).read_to_end(&mut bytes).map_err(|e| e.to_string())?;
    if bytes.len() as u64 > limit { Err(too_long()) } else { Ok(bytes) }
}

/// The text of a file.
///
/// # Errors
/// As [`read`]; not UTF-8.
pub(crate) fn read_text(path: &Path, limit: u64) -> Result<String, String> {
    String::from_utf8(read(path, limit)?).map_err(|e| {
        let valid = &e.as_bytes()[..e.utf8_error().valid_up_to()];
        let line = 1 + valid.iter().filter(|b| **b == b'\n').count();
        format!("line {line} is not UTF-8 text; save the file as UTF-8")
    })
}

/// As [`read_text`], for files that others put in a folder: what is no ordinary file is not opened, as a pipe that nobody
/// writes to would be waited for.
///
/// # Errors
/// As [`read_text`]; no ordinary file.
pub(crate) fn read_own_text(path: &Path, limit: u64) -> Result<String, String> {
    match std::fs::metadata(path) {
        Ok(about) if !about.is_file() => Err("this is no ordinary file".into()),
        Ok(_) => read_text(path, limit),
        Err(e) => Err(e.to_string()),
    }
}
