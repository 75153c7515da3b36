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

use crate::tir::MAX_BYTES;
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

impl Writing<'_> {
    /// Checks that what is asked for means something to the format of a file.
    fn check(&self, path: &Path) -> Result<()> {
        let own = ending(path);
        for (given, option, fits) in [
            (self.increment.is_some(), "--increment is the step of an OpenCRG file (.crg)", "crg"),
            (self.like.is_some(), "--like is for a .rdf of METHOD = 'USER'", "rdf"),
            (self.adams, "--adams is for a .rdf", "rdf"),
        ] {
            if given && own != fits {
                return Err(Error::call(format!("{}: {option}; leave it out", path.display())));
            }
        }
        match self.like {
            Some(like) if ending(like) != "rdf" => Err(Error::call(format!(
                "--like {}: {} is made like another .rdf, and that is none",
                like.display(),
                path.display()
            ))),
            Some(like) if self.adams => Err(Error::call(format!(
                "--adams writes a file of METHOD = '2D', and --like {} keeps one of METHOD = 'USER'; leave one of them out",
                like.display()
            ))),
            _ => Ok(()),
        }
    }
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

/// Writes a road to `path` and returns what does not survive: of the file that it was read from, and of the road what the format
/// does not hold. A file that is made like the one that was read keeps what that has beside the road.
///
/// # Errors
/// An ending that is none of [`ENDINGS`]; something of `writing` that the format does not know; a road that the format cannot hold;
/// a file that cannot be written.
pub fn write(path: &Path, road: &RoadProfile, writing: &Writing<'_>) -> Result<Vec<String>> {
    let name = path.display().to_string();
    writing.check(path)?;
    let (bytes, beyond) = match ending(path).as_str() {
        "rdf" => rdf::write(road, writing, &name)?,
        "crg" => crg::write(road, writing.increment)?,
        "csv" => profile::write_csv(road)?,
        "toml" => settings::write(road)?,
        _ => {
            return Err(Error::call(format!("{name}: a road file ends in .{}", ENDINGS.join(", ."))));
        }
    };
    let mut lost: Vec<String> = match writing.like.filter(|like| same_file(like, Path::new(&road.source))) {
        // the file itself, byte for byte
        Some(like) if bytes_of(like, MAX_BYTES as u64)? == bytes => Vec::new(),
        Some(_) => road.lost.clone(),
        None => road.left_out().cloned().collect(),
    };
    lost.extend(beyond);
    write_file(path, &bytes)?;
    Ok(lost)
}

fn same_file(one: &Path, other: &Path) -> bool {
    matches!((one.canonicalize(), other.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

/// The bytes of a file that may be long.
fn bytes_of(path: &Path, limit: u64) -> Result<Vec<u8>> {
    bounded::read(path, limit).map_err(|e| Error::file(format!("{}: {e}", path.display())))
}

#[cfg(test)]
mod tests;
