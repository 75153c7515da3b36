//! What the check needs of the operating system: a note that outlives a crash, the standard streams elsewhere, how a
//! process ended.

use std::ffi::c_int;
use std::fs::File;
use std::path::Path;
use std::process::ExitStatus;
use std::sync::atomic::{AtomicU8, Ordering};

/// The name of the call that is being made, where another process can read it after a crash.
pub(super) struct CallNote(&'static [AtomicU8]);

/// The length of a [`CallNote`].
pub(super) const NOTE: usize = 128;

impl CallNote {
    /// A note in the file at `path`, which has to have [`NOTE`] bytes; else one that nobody reads.
    pub(super) fn at(path: &Path) -> Self {
        let file = File::options().read(true).write(true).open(path).ok();
        let file = file.filter(|f| f.metadata().is_ok_and(|m| m.len() >= NOTE as u64));
        let Some(mapped) = file.and_then(|file| memmap2::MmapRaw::map_raw(&file).ok()) else {
            return Self(&[]);
        };
        // SAFETY: the mapping has this length at least and is never undone; atomic bytes may be shared.
        let cells = unsafe { std::slice::from_raw_parts(mapped.as_mut_ptr().cast::<AtomicU8>(), NOTE) };
        std::mem::forget(mapped);
        Self(cells)
    }

    pub(super) fn write(&self, call: &str) {
        for (cell, byte) in self.0.iter().zip(call.bytes().chain([0])) {
            cell.store(byte, Ordering::Relaxed);
        }
    }
}

/// Writes out what C code has printed so far.
pub(super) fn flush_c_streams() {
    // SAFETY: NULL stands for all streams.
    unsafe { libc::fflush(std::ptr::null_mut()) };
}

/// How a process ended.
pub(super) enum End {
    Code(i32),
    /// A crash, by the system's name for it.
    Crash(String),
    /// It was killed after the time limit.
    Late,
}

#[cfg(unix)]
mod kind {
    use super::*;
    use std::os::fd::{AsRawFd, FromRawFd};
    use std::os::unix::process::ExitStatusExt;

    /// Puts the file descriptor `from`, 1 or 2, on another file, and returns a copy of what was there.
    pub(in crate::fmi::check) fn redirect(from: c_int, to: &File) -> Option<File> {
        // SAFETY: descriptors are plain numbers; wrong ones make the calls fail. The new one belongs to
        // nobody else.
        unsafe {
            let copy = libc::fcntl(from, libc::F_DUPFD_CLOEXEC, 10);
            if copy < 0 || libc::dup2(to.as_raw_fd(), from) < 0 {
                return None;
            }
            Some(File::from_raw_fd(copy))
        }
    }

    /// A crash of this process is expected: it leaves no memory image on the disk.
    pub(in crate::fmi::check) fn expect_a_crash() {
        let limit = libc::rlimit { rlim_cur: 0, rlim_max: 0 };
        // SAFETY: a limit of this process and its value.
        unsafe { libc::setrlimit(libc::RLIMIT_CORE, &limit) };
    }

    /// The folder `of` at a second path.
    pub(in crate::fmi::check) fn same_folder(of: &Path, path: &Path) -> std::io::Result<()> {
        let _ = std::fs::remove_file(path);
        std::os::unix::fs::symlink(of, path)
    }

    /// How a process ended by itself.
    pub(in crate::fmi::check) fn end(status: ExitStatus) -> End {
        let Some(signal) = status.signal() else { return End::Code(status.code().unwrap_or(-1)) };
        let name = match signal {
            libc::SIGSEGV => "SIGSEGV",
            libc::SIGABRT => "SIGABRT",
            libc::SIGFPE => "SIGFPE",
            libc::SIGILL => "SIGILL",
            libc::SIGBUS => "SIGBUS",
            libc::SIGTRAP => "SIGTRAP",
            libc::SIGKILL => "SIGKILL",
            _ => return End::Crash(format!("signal {signal}")),
        };
        End::Crash(name.into())
    }
}

#[cfg(windows)]
mod kind {
    use super::*;
    use std::os::windows::io::{AsHandle, AsRawHandle, BorrowedHandle, IntoRawHandle};
    use windows_sys::Win32::System::Console::{STD_ERROR_HANDLE, STD_OUTPUT_HANDLE, SetStdHandle};
    use windows_sys::Win32::System::Diagnostics::Debug::{
        SEM_FAILCRITICALERRORS, SEM_NOGPFAULTERRORBOX, SetErrorMode,
    };

    /// Puts standard output, 1, or standard error, 2, on another file, and returns a copy of what was there: the
    /// system's handle, which C libraries look at when they are loaded, and the descriptor of the one that is there
    /// already.
    pub(in crate::fmi::check) fn redirect(from: c_int, to: &File) -> Option<File> {
        let copied = |stream: BorrowedHandle| stream.try_clone_to_owned().ok().map(File::from);
        let (copy, which) = match from {
            1 => (copied(std::io::stdout().as_handle())?, STD_OUTPUT_HANDLE),
            _ => (copied(std::io::stderr().as_handle())?, STD_ERROR_HANDLE),
        };
        // both keep the file for as long as the process lives
        let (handle, descriptor) = (to.try_clone().ok()?, to.try_clone().ok()?.into_raw_handle());
        // SAFETY: handles that are open, and numbers; wrong ones make the calls fail.
        let done = unsafe {
            SetStdHandle(which, handle.as_raw_handle()) != 0
                && libc::dup2(libc::open_osfhandle(descriptor as libc::intptr_t, 0), from) == 0
        };
        std::mem::forget(handle);
        done.then_some(copy)
    }

    /// A crash of this process is expected: it opens no window that waits for somebody.
    pub(in crate::fmi::check) fn expect_a_crash() {
        // SAFETY: it takes numbers.
        unsafe { SetErrorMode(SEM_FAILCRITICALERRORS | SEM_NOGPFAULTERRORBOX) };
    }

    /// The folder `of` at a second path: a copy, as users may not make links here.
    pub(in crate::fmi::check) fn same_folder(of: &Path, path: &Path) -> std::io::Result<()> {
        std::fs::create_dir_all(path)?;
        for entry in std::fs::read_dir(of)? {
            let (from, to) = {
                let e = entry?;
                (e.path(), path.join(e.file_name()))
            };
            if from.is_dir() {
                same_folder(&from, &to)?;
            } else {
                std::fs::copy(from, to)?;
            }
        }
        Ok(())
    }

    /// How a process ended by itself.
    pub(in crate::fmi::check) fn end(status: ExitStatus) -> End {
        let code = status.code().unwrap_or(-1);
        let name = match code as u32 {
            0xC000_0005 => "an access violation",
            0xC000_001D => "an illegal instruction",
            0xC000_0094 => "an integer divided by zero",
            0xC000_00FD => "a stack overflow",
            0xC000_0374 => "a corrupted heap",
            0xC000_0409 => "a fast failure",
            // what the first two bits say is an error of the system
            0xC000_0000.. => return End::Crash(format!("exception 0x{:08X}", code as u32)),
            _ => return End::Code(code),
        };
        End::Crash(name.into())
    }
}

pub(super) use kind::{end, expect_a_crash, redirect, same_folder};
