//! Road files: profiles along one or two tracks from files of other programs, and back.
//!
//! | ending | read | written |
//! |---|---|---|
//! | `.rdf` | the road file of the super-elastic tire's source (`METHOD = 'USER'`, `{XZ}`) and two-dimensional roads of Adams (`METHOD = '2D'`) | one track: the former, two: the latter as `poly_line` |
//! | `.crg` | OpenCRG, text and binary, at one or two lateral positions | OpenCRG text of double length |
//! | `.csv` | columns `x [m]`, `z [m]` and `z_right [m]` | the same |
//! | `.toml` | parameters of a road in a model | the same |
//!
//! What a file has and a [`RoadProfile`] has not is listed in it, with the consequence; what a format that is written lacks is
//! listed by [`write()`]. docs/files.md has the readings of what the formats leave open.

mod adams;
mod crg;
mod profile;
mod rdf;
mod settings;

pub use crg::Lanes;
pub use profile::{MAX_POINTS_READ, RoadProfile};

use crate::{Error, Result, bounded, ending, write_file};
use std::path::Path;

/// The endings of road files, without dots.
pub const ENDINGS: &[&str] = &["rdf", "crg", "csv", "toml"];

/// What a writer is told beside the road.
#[derive(Debug, Clone, Default)]
pub struct Writing<'a> {
    /// Step along the road of a `.crg` file \[m\]; it has no other points.
    pub increment: Option<f64>,
    /// A `.rdf` file of which everything but the points is kept.
    pub like: Option<&'a Path>,
    /// `.rdf` in the form of Adams where the other would do.
    pub adams: bool,
}

/// Reads the road file at `path`; `lanes` says where across an OpenCRG road the tracks are.
///
/// # Errors
/// A file that cannot be read, is of no known kind, or holds no road that two tracks can have; with file, line, block and key.
pub fn read(path: &Path, lanes: &Lanes) -> Result<RoadProfile> {
    let ending = ending(path);
    if ending != "crg" && (lanes.left.is_some() || lanes.right.is_some()) {
        return Err(Error::call(format!(
            "{}: only an OpenCRG road (.crg) has lateral positions to choose from",
            path.display()
        )));
    }
    match ending.as_str() {
        "rdf" => rdf::read(path),
        "crg" => crg::read(path, lanes),
        "csv" => profile::read_csv(path),
        "toml" => settings::read(path),
        _ => Err(Error::file(format!("{}: a road file ends in .{}", path.display(), ENDINGS.join(", .")))),
    }
}

/// Writes a road to `path` and returns what the format does not hold of it.
///
/// # Errors
/// An ending that is none of [`ENDINGS`]; a road that the format cannot hold; a file that cannot be written.
pub fn write(path: &Path, road: &RoadProfile, writing: &Writing<'_>) -> Result<Vec<String>> {
    let name = path.display().to_string();
    let (bytes, lost) = match ending(path).as_str() {
        "rdf" => rdf::write(road, writing, &name)?,
        "crg" => crg::write(road, writing.increment)?,
        "csv" => profile::write_csv(road)?,
        "toml" => settings::write(road)?,
        _ => {
            return Err(Error::call(format!("{name}: a road file ends in .{}", ENDINGS.join(", ."))));
        }
    };
    write_file(path, &bytes)?;
    Ok(lost)
}

/// The bytes of a file that may be long.
fn bytes_of(path: &Path, limit: u64) -> Result<Vec<u8>> {
    bounded::read(path, limit).map_err(|e| Error::file(format!("{}: {e}", path.display())))
}

#[cfg(test)]
mod tests;
