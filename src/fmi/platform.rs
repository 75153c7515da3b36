//! Machines that an FMU can have binaries for, and what their folders are called.

use super::c::Fmi;

/// The folder of binaries of the machine that this runs on, in FMI 2.0.
pub const PLATFORM: &str = if cfg!(windows) {
    "win64"
} else if cfg!(target_os = "macos") {
    "darwin64"
} else {
    "linux64"
};

/// A kind of machine that an FMU can have a binary for.
pub(super) struct Platform {
    /// Folder of its binaries in FMI 2.0, and that of FMI 3.0 for ARM, which the other does not have.
    pub name: &'static str,
    /// That of FMI 3.0.
    pub three: &'static str,
    /// The suffix of a library there, and how such a file begins.
    pub suffix: &'static str,
    pub start: &'static [u8],
}

const fn platform(
    name: &'static str,
    three: &'static str,
    suffix: &'static str,
    start: &'static [u8],
) -> Platform {
    Platform { name, three, suffix, start }
}

/// Those that are known.
pub(super) const PLATFORMS: [Platform; 5] = [
    platform("linux64", "x86_64-linux", ".so", b"\x7fELF"),
    platform("aarch64-linux", "aarch64-linux", ".so", b"\x7fELF"),
    platform("win64", "x86_64-windows", ".dll", b"MZ"),
    platform("darwin64", "x86_64-darwin", ".dylib", b"\xcf\xfa\xed\xfe"),
    platform("aarch64-darwin", "aarch64-darwin", ".dylib", b"\xcf\xfa\xed\xfe"),
];

/// The folder of a platform's binaries in an FMU.
pub(super) fn folder_of(platform: &'static str, fmi: Fmi) -> &'static str {
    let known = PLATFORMS.iter().find(|p| p.name == platform && fmi == Fmi::Three);
    known.map_or(platform, |p| p.three)
}
