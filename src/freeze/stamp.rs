//! [`Stamp`]: a file by its name and its bytes.

use crate::{Error, Result};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fmt::Write as _;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// How much of a file is in memory at a time \[bytes\]: recordings may have gigabytes.
const PIECE: usize = 1 << 16;

/// A file that a system is made from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stamp {
    /// Its name beside the system's file, with `/` between folders; of a file elsewhere its name alone.
    pub file: String,
    /// SHA-256 of its bytes, in hexadecimal digits.
    pub sha256: String,
}

impl Stamp {
    /// Reads a file, which the system in `folder` names.
    ///
    /// # Errors
    /// A file that cannot be read, with its path.
    pub(super) fn of(path: &Path, folder: &Path) -> Result<Self> {
        let hash =
            sha256(path).map_err(|e| Error::file(format!("{} cannot be read: {e}", path.display())))?;
        Ok(Self { file: beside(path, folder), sha256: hash })
    }
}

fn sha256(path: &Path) -> std::io::Result<String> {
    let mut file = File::open(path)?;
    let mut hash = Sha256::new();
    let mut piece = vec![0; PIECE];
    loop {
        match file.read(&mut piece)? {
            0 => break,
            length => hash.update(&piece[..length]),
        }
    }
    let mut digits = String::new();
    for byte in hash.finalize() {
        // writing to a text does not fail
        let _ = write!(digits, "{byte:02x}");
    }
    Ok(digits)
}

/// The path seen from the folder. Nothing of the machine is in it: of an absolute path elsewhere only the last name is left.
fn beside(path: &Path, folder: &Path) -> String {
    let inside = path.strip_prefix(folder).ok().filter(|inside| inside.is_relative());
    let own = || path.file_name().unwrap_or_default().into();
    let inside = inside.map_or_else(own, Path::to_path_buf);
    let parts: Vec<_> = inside.components().map(|part| part.as_os_str().to_string_lossy()).collect();
    parts.join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_are_those_of_the_standard_and_names_have_no_machine_in_them() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("parts");
        std::fs::create_dir(&path).unwrap();
        let path = path.join("abc");
        std::fs::write(&path, "abc").unwrap();
        let stamp = Stamp::of(&path, folder.path()).unwrap();
        // FIPS 180-4, example of one block
        assert_eq!(stamp.sha256, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
        assert_eq!(stamp.file, "parts/abc");
        assert_eq!(beside(Path::new("/opt/there/x.fmu"), folder.path()), "x.fmu");
        assert_eq!(beside(Path::new("../x.fmu"), Path::new("")), "../x.fmu");
        assert!(Stamp::of(folder.path(), folder.path()).unwrap_err().to_string().contains("cannot be read"));
    }
}
