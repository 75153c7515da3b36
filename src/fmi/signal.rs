//! What the process does with signals.

/// True if the process was started with this signal ignored.
pub(crate) fn is_ignored(signal: std::ffi::c_int) -> bool {
    let mut now = std::mem::MaybeUninit::<libc::sigaction>::zeroed();
    // SAFETY: without a new action, sigaction only fills the old one.
    let done = unsafe { libc::sigaction(signal, std::ptr::null(), now.as_mut_ptr()) };
    // SAFETY: zeroed is a valid sigaction: numbers, and an optional function pointer that is none.
    done == 0 && unsafe { now.assume_init() }.sa_sigaction == libc::SIG_IGN
}
