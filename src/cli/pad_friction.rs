//! `latsch pad-friction`: what pads had for friction in recordings.

use super::mapped::Mapped;
use super::{Format, check_outputs, print, print_json};
use latsch::causes::{pad_friction_csv, pad_frictions};
use latsch::cosimulate::read_system;
use latsch::model::unit::quantity;
use latsch::recording::Recording;
use latsch::{Result, write_file};
use serde_json::json;
use std::path::{Path, PathBuf};

/// Find the friction of brake pads over time in recorded torques and pressures
///
/// Of each brake of the system whose caliper pressure and torque (its own, or the moment in the measuring rim of its wheel) every recording has: torque over what presses
/// the pads on, from the time on at which the pressure is high enough to tell it. It is blank where the pressure is lower or the wheel is locked.
#[derive(clap::Args)]
pub struct Args {
    /// System with the brakes, TOML or SSP
    #[arg(value_name = "SYSTEM")]
    system: PathBuf,
    /// A recording. Can be given several times: the mean of all is formed
    #[arg(long, value_name = "F.csv", required = true)]
    recording: Vec<PathBuf>,
    #[command(flatten)]
    map: Mapped,
    /// Pressure below which the friction is not told, with its unit: "5 bar" [default: ten times the noise before braking, and four times the pads' contact_pressure]
    #[arg(long, value_name = "PRESSURE")]
    least: Option<String>,
    /// Table to write: friction over time of each brake in each recording, and the mean
    #[arg(long, short, value_name = "F.csv")]
    output: PathBuf,
    /// How to print what was found
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

pub fn run(args: &Args) -> Result<()> {
    let read: Vec<&Path> =
        args.recording.iter().chain([&args.system]).map(PathBuf::as_path).chain(args.map.file()).collect();
    check_outputs(&[&args.output], &read)?;
    let least =
        args.least.as_deref().map(|text| quantity(text, "Pa").map_err(|e| e.at("--least"))).transpose()?;
    let system = read_system(&args.system)?;
    let runs = args.map.recordings(&args.recording)?;
    let all = pad_frictions(&system.plan, &runs.iter().collect::<Vec<&Recording>>(), least)?;
    write_file(&args.output, pad_friction_csv(&all).as_bytes())?;
    if args.format == Format::Json {
        let brakes = all.iter().map(
            |b| json!({ "brake": b.brake, "first": b.first, "level": b.level, "least_pressure": b.least }),
        );
        return print_json(&brakes.collect());
    }
    for brake in &all {
        print(&format!(
            "{}: {:.4} in the first 20 ms, {:.4} in the second half; not told below {:.1} bar",
            brake.brake,
            brake.first,
            brake.level,
            1e-5 * brake.least
        ))?;
    }
    print(&args.output.display().to_string())
}
