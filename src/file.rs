//! Files that are either whole or not there.

use crate::bounded::{self, MAX_TEXT};
use crate::temporary::Mark;
use crate::{Error, Result};
use std::io::{BufWriter, Write};
use std::path::Path;

/// Writes a file through a temporary one beside it that is renamed at the end: a reader, or whoever
/// finds the file after a crash, never sees half of it. Links are followed; what is there and no
/// ordinary file (a pipe, a device) is written to as it is.
///
/// # Errors
/// Any failure of the file system, with the path.
pub(crate) fn write_whole(
    path: &Path,
    content: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> Result<()> {
    let write = || -> std::io::Result<()> {
        let path = &path.canonicalize().unwrap_or_else(|_| path.into());
        if path.exists() && !path.is_file() {
            let mut writer = BufWriter::new(std::fs::File::options().write(true).open(path)?);
            content(&mut writer)?;
            return writer.flush();
        }
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let mut builder = tempfile::Builder::new();
        builder.prefix(".latsch-");
        // Temporary files are private by default, results are not; the umask still applies.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        // errors without the name of the temporary file, which nobody chose
        let (file, _mark) =
            Mark::of(|| builder.tempfile_in(folder)).map_err(|e| std::io::Error::from(e.kind()))?;
        let mut writer = BufWriter::new(&file);
        content(&mut writer)?;
        writer.flush()?;
        drop(writer);
        file.persist(path).map_err(|e| std::io::Error::from(e.error.kind()))?;
        Ok(())
    };
    write().map_err(|e| Error::file(format!("{} cannot be written: {e}", path.display())))
}

/// The text of a file that a user names: settings, effects, a system.
///
/// # Errors
/// A file that cannot be read, is not UTF-8 or too long, with the path.
pub fn read_text(path: &Path) -> Result<String> {
    bounded::read_text(path, MAX_TEXT).map_err(|e| Error::file(format!("{}: {e}", path.display())))
}

/// The ending of a file's name in small letters, without its dot; empty if it has none.
pub fn ending(path: &Path) -> String {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase()
}

/// Writes bytes to a file, whole or not at all.
///
/// # Errors
/// Any failure of the file system, with the path.
pub fn write_file(path: &Path, content: &[u8]) -> Result<()> {
    write_whole(path, |writer| writer.write_all(content))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_devices_left_alone() {
        use std::os::unix::fs::FileTypeExt;
        let folder = tempfile::tempdir().unwrap();
        let (target, link) = (folder.path().join("target"), folder.path().join("link"));
        std::fs::write(&target, "old").unwrap();
        std::os::unix::fs::symlink(&target, &link).unwrap();
        write_file(&link, b"new").unwrap();
        assert!(link.is_symlink());
        assert_eq!(std::fs::read_to_string(&target).unwrap(), "new");
        write_file(Path::new("/dev/null"), b"gone").unwrap();
        assert!(std::fs::metadata("/dev/null").unwrap().file_type().is_char_device());
        let error = write_file(&folder.path().join("none/x.csv"), b"").unwrap_err().to_string();
        assert!(error.contains("none/x.csv") && !error.contains(".latsch-"), "{error}");
    }

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("result.txt");
        write_whole(&path, |w| w.write_all(b"old")).unwrap();
        let failed = write_whole(&path, |w| {
            w.write_all(b"half")?;
            Err(std::io::Error::other("disk on fire"))
        });
        let message = failed.unwrap_err().to_string();
        assert!(message.contains("result.txt") && message.contains("disk on fire"), "{message}");
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn others_may_read_results() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("result.txt");
        write_whole(&path, |w| w.write_all(b"x")).unwrap();
        let reference = folder.path().join("reference.txt");
        std::fs::write(&reference, "x").unwrap();
        let mode = |p: &Path| std::fs::metadata(p).unwrap().permissions().mode();
        assert_eq!(mode(&path), mode(&reference));
    }
}
