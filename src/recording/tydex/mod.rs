//! Recordings as TYDEX files (Tyre Data Exchange format, release 1.3): sections that begin with `**KEYWORD`, fields in
//! fixed columns, channels by names of eight characters such as `SLIPANGL`, `FZH`.
//!
//! ```text
//! **HEADER
//! RELEASE   Release of TYDEX-Format                 1.3
//! **CONSTANTS
//! INCLANGL  inclination angle             deg       2
//! **MEASURCHANNELS
//! RUNTIME   running time                  s         1         0         0
//! FZH       vertical force                kN        0.001     0         0
//! **MEASURDATA
//! 0         4012.5
//! 0.01      4013.1
//! **END
//! ```
//!
//! What is known of the format is from files and from programs that read them; the manual could not be had. Above all the
//! order of a channel's conversion (`table::Conversion`) is what the names of its three numbers say.

mod channels;
mod read;
mod record;
mod sections;
mod table;
mod write;

pub use read::{parse_tydex, read_tydex};
pub use write::{to_tydex, write_tydex};

/// What the names of TYDEX files end in, in small letters.
pub const TYDEX_ENDINGS: [&str; 3] = ["tdx", "tda", "tdb"];

#[cfg(test)]
mod tests;
