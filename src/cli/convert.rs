//! `latsch convert`: files of roads and tires in other formats.

use super::tire::as_toml;
use super::{check_outputs, note, print, warn};
use latsch::recording::read_settings;
use latsch::road_file::{self, Lanes, Writing};
use latsch::tir::{Document, Kind, Units, create_super_elastic, settings};
use latsch::{Error, Result, VERSION, ending, write_file};
use std::path::{Path, PathBuf};

/// Convert a road file, or the property file of a super-elastic tire, into another format
///
/// Roads: .rdf (METHOD 'USER' with [PROFILE], or two-dimensional roads of Adams), .crg (OpenCRG), .csv (x [m], z [m], z_right [m])
/// and .toml (parameters for --parameters). Tires: .tir (TYR501) and .toml. What the other format has no place for is listed,
/// never left out in silence.
#[derive(clap::Args)]
pub struct Args {
    /// The file to read
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// The file to write: its ending is the format
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// Where the left track, or the only one, is on an OpenCRG road [m]; positive to the left of its reference line [default: 0]
    #[arg(long, value_name = "Y", allow_negative_numbers = true)]
    left: Option<f64>,
    /// Where the right track is on an OpenCRG road [m]; without one both are the same
    #[arg(long, value_name = "Y", allow_negative_numbers = true)]
    right: Option<f64>,
    /// Leave out points of a road as long as no height changes by more than this [m]
    #[arg(long, value_name = "H")]
    tolerance: Option<f64>,
    /// Step along the road of an OpenCRG file [m] [default: the one in which all points lie]
    #[arg(long, value_name = "D")]
    increment: Option<f64>,
    /// A file of the kind that is written (.rdf of METHOD 'USER', or .tir), of which everything but the road, or the tire's values, is kept
    #[arg(long, value_name = "F.rdf|F.tir")]
    like: Option<PathBuf>,
    /// Write a .rdf as Adams reads it (poly_line), also for a road of one track
    #[arg(long)]
    adams: bool,
}

pub fn run(args: &Args) -> Result<()> {
    let read: Vec<&Path> = std::iter::once(&args.input).chain(&args.like).map(PathBuf::as_path).collect();
    check_outputs(&[&args.output], &read)?;
    let lost = match (ending(&args.input).as_str(), ending(&args.output).as_str()) {
        ("tir", _) | (_, "tir") => tire(args)?,
        _ => road(args)?,
    };
    print(&format!("{}: written", args.output.display()))?;
    if lost.is_empty() {
        return print("everything survives");
    }
    print("what does not survive:")?;
    for lost in lost {
        print(&format!("  - {lost}"))?;
    }
    Ok(())
}

fn road(args: &Args) -> Result<Vec<String>> {
    let mut road = road_file::read(&args.input, &Lanes { left: args.left, right: args.right })?;
    road.notes.iter().for_each(|text| note(text));
    let mut lost = Vec::new();
    if let Some(tolerance) = args.tolerance {
        if !(tolerance > 0.0 && tolerance.is_finite()) {
            return Err(Error::call("--tolerance is a height in m, above 0: 0.0005 for half a millimetre"));
        }
        let gone = road.simplify(tolerance);
        lost.push(format!("{gone} points, without which no height is off by more than {tolerance} m"));
    }
    if ending(&args.output) == "toml" {
        let gone = road.thin();
        if gone > 0 {
            note(&format!("{gone} points on straight lines are left out, which changes no height"));
        }
    }
    let writing = Writing { increment: args.increment, like: args.like.as_deref(), adams: args.adams };
    lost.extend(road_file::write(&args.output, &road, &writing)?);
    Ok(lost)
}

fn tire(args: &Args) -> Result<Vec<String>> {
    for (given, option) in [
        (args.left.is_some(), "--left"),
        (args.right.is_some(), "--right"),
        (args.tolerance.is_some(), "--tolerance"),
        (args.increment.is_some(), "--increment"),
        (args.adams, "--adams"),
    ] {
        if given {
            return Err(Error::call(format!("{option} is about roads, and a .tir is a tire; leave it out")));
        }
    }
    if let Some(like) = &args.like
        && (ending(&args.output) != "tir" || ending(like) != "tir")
    {
        return Err(Error::call(format!(
            "--like {}: a .tir is made like another .tir, and {} is written",
            like.display(),
            args.output.display()
        )));
    }
    match (ending(&args.input).as_str(), ending(&args.output).as_str()) {
        ("tir", "toml") => {
            let tire = settings(&args.input)?;
            tire.notes.iter().for_each(|note| warn(note));
            write_file(&args.output, as_toml(&tire.settings, tire.kind).as_bytes())?;
            let mut lost =
                vec!["comments, [MDI_HEADER] and units of the file: values are in SI units".to_string()];
            if tire.kind == Kind::SuperElastic {
                lost.push(
                    "the mass of the rim, which belongs to hub_mass, and the keys that the warnings name"
                        .into(),
                );
            } else {
                lost.push("the keys that the warnings name".into());
            }
            Ok(lost)
        }
        ("toml", "tir") => {
            let own = read_settings(Some(&args.input))?;
            if let Some(like) = &args.like {
                let mut document = Document::open(like)?;
                let mut notes = Vec::new();
                Units::of(&document, &mut notes)?;
                // a unit that the file does not name is one that somebody may have meant otherwise
                notes.retain(|note| note.contains("does not name the unit"));
                notes.iter().for_each(|note| warn(note));
                let (_, lost) = latsch::tir::change(&mut document, &own)?;
                write_file(&args.output, document.bytes())?;
                return Ok(lost);
            }
            let name = args.output.display().to_string();
            let title = format!("Made by latsch {VERSION} of {}", args.input.display());
            let (document, lost) = create_super_elastic(&own, None, &name, &title)?;
            write_file(&args.output, document.bytes())?;
            Ok(lost)
        }
        _ => Err(Error::call(format!(
            "{} to {}: a tire is converted from .tir to .toml or from .toml to .tir; a .tir with other values is written by latsch tire",
            args.input.display(),
            args.output.display()
        ))),
    }
}
