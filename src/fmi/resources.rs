//! Where an FMU's resources are: from the location that the master gives, else from the library's
//! own place.

use crate::bounded::{self, MAX_TEXT};
use crate::{Error, Result};
use std::path::{Path, PathBuf};

/// The folder `resources` and the text of `model.toml` in it.
///
/// # Errors
/// A location that is not a `file:` URI, or a file that cannot be read.
pub fn model_file(location: Option<&str>) -> Result<(PathBuf, String)> {
    let folder = match location.filter(|l| !l.trim().is_empty()) {
        Some(location) => folder_of_uri(location)?,
        None => beside_library().ok_or_else(|| {
            Error::fmu(
                "no resource location was given, and the library does not know where it was loaded from",
            )
        })?,
    };
    let path = folder.join("model.toml");
    let text = bounded::read_own_text(&path, MAX_TEXT).map_err(|e| {
        Error::fmu(format!(
            "{}: {e}; is the resource location the folder resources of the FMU, as it was exported?",
            path.display()
        ))
    })?;
    Ok((folder, text))
}

/// The folder of a `file:` URI with or without authority (RFC 3986). A plain absolute path is taken
/// as well: some masters give one.
fn folder_of_uri(uri: &str) -> Result<PathBuf> {
    let fail = |what: &str| Error::fmu(format!("resource location {uri:?}: {what}"));
    let Some(rest) = uri.strip_prefix("file:") else {
        let is_path = uri.starts_with('/') || Path::new(uri).is_absolute();
        return if is_path { Ok(uri.into()) } else { Err(fail("a file: URI is needed")) };
    };
    let path = match rest.strip_prefix("//") {
        Some(with_authority) => {
            let slash = with_authority.find('/').ok_or_else(|| fail("there is no path"))?;
            let (host, path) = with_authority.split_at(slash);
            if !host.is_empty() && !host.eq_ignore_ascii_case("localhost") {
                return Err(fail("it is on another machine"));
            }
            path
        }
        None => rest,
    };
    let bytes =
        percent_decode(path).ok_or_else(|| fail("a % has to be followed by two hexadecimal digits"))?;
    let text = String::from_utf8(bytes).map_err(|_| fail("it is not UTF-8"))?;
    // file:///C:/folder
    let text = match text.as_bytes() {
        [b'/', drive, b':', ..] if drive.is_ascii_alphabetic() => &text[1..],
        _ => &text,
    };
    Ok(text.into())
}

fn percent_decode(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((&byte, tail)) = rest.split_first() {
        if byte == b'%' {
            let digits = std::str::from_utf8(tail.get(..2)?).ok()?;
            if !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
                return None;
            }
            bytes.push(u8::from_str_radix(digits, 16).ok()?);
            rest = &tail[2..];
        } else {
            bytes.push(byte);
            rest = tail;
        }
    }
    Some(bytes)
}

/// `<fmu>/resources` for a library at `<fmu>/binaries/<platform>/<library>`.
fn beside_library() -> Option<PathBuf> {
    let library = own_library()?.canonicalize().ok()?;
    Some(library.parent()?.parent()?.parent()?.join("resources"))
}

/// The file that this code was loaded from.
#[cfg(unix)]
fn own_library() -> Option<PathBuf> {
    use std::os::unix::ffi::OsStrExt;
    let mut info = std::mem::MaybeUninit::<libc::Dl_info>::zeroed();
    let here: fn() -> Option<PathBuf> = own_library;
    // SAFETY: dladdr only compares the address with those of loaded libraries and fills `info`.
    let found = unsafe { libc::dladdr(here as *const libc::c_void, info.as_mut_ptr()) };
    // SAFETY: zeroed is a valid Dl_info: all its fields are pointers.
    let info = unsafe { info.assume_init() };
    if found == 0 || info.dli_fname.is_null() {
        return None;
    }
    // SAFETY: on success dli_fname is a zero-terminated text that lives as long as the library.
    let name = unsafe { std::ffi::CStr::from_ptr(info.dli_fname) };
    Some(std::ffi::OsStr::from_bytes(name.to_bytes()).into())
}

/// The file that this code was loaded from.
#[cfg(windows)]
fn own_library() -> Option<PathBuf> {
    use std::os::windows::ffi::OsStringExt;
    use windows_sys::Win32::System::LibraryLoader::{
        GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS, GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT,
        GetModuleFileNameW, GetModuleHandleExW,
    };
    /// Paths of Windows are no longer, in 16-bit units.
    const LONGEST: u32 = 32_768;
    let here: fn() -> Option<PathBuf> = own_library;
    let flags = GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS | GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT;
    let mut module = std::ptr::null_mut();
    let mut name = vec![0; LONGEST as usize];
    // SAFETY: the address is that of a function here; the system writes a handle, which is not to be closed.
    if unsafe { GetModuleHandleExW(flags, here as *const u16, &mut module) } == 0 {
        return None;
    }
    // SAFETY: the buffer has the length that is said.
    let length = unsafe { GetModuleFileNameW(module, name.as_mut_ptr(), LONGEST) };
    if !(1..LONGEST).contains(&length) {
        return None;
    }
    name.truncate(length as usize);
    Some(std::ffi::OsString::from_wide(&name).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decodes_file_uris() {
        for (uri, path) in [
            ("file:///srv/a%20b/resources", "/srv/a b/resources"),
            ("file:/srv/resources", "/srv/resources"),
            ("file://localhost/srv/r%C3%A4der", "/srv/räder"),
            ("file:///C:/fmu/resources", "C:/fmu/resources"),
            ("/plain/path", "/plain/path"),
        ] {
            assert_eq!(folder_of_uri(uri).unwrap(), PathBuf::from(path), "{uri}");
        }
        for uri in [
            "http://host/x",
            "file://server/share",
            "file:///bad%2",
            "file:///bad%zz",
            "resources",
            "file://",
        ] {
            let error = folder_of_uri(uri).unwrap_err().to_string();
            assert!(error.contains(uri), "{error}");
        }
    }

    #[test]
    fn files_of_any_length_and_pipes_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("model.toml");
        let refused = || model_file(folder.path().to_str()).unwrap_err().to_string();
        std::fs::File::create(&path).unwrap().set_len(1 << 40).unwrap();
        assert!(refused().contains("model.toml: it has more than 16 MB"), "{}", refused());
        std::fs::remove_file(&path).unwrap();
        #[cfg(unix)]
        pipes(&path, &refused);
    }

    #[cfg(unix)]
    fn pipes(path: &Path, refused: &dyn Fn() -> String) {
        std::os::unix::fs::symlink("/dev/zero", path).unwrap();
        assert!(refused().contains("no ordinary file"), "{}", refused());
        std::fs::remove_file(path).unwrap();
        // nobody writes to it: whoever opens it waits
        assert!(std::process::Command::new("mkfifo").arg(path).status().unwrap().success());
        assert!(refused().contains("no ordinary file"), "{}", refused());
    }
}
