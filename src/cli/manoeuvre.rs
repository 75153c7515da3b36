//! `latsch manoeuvre`: drives a vehicle through a manoeuvre by which models are validated.

use super::digits::digits;
use super::{Format, print, print_json, warn};
use latsch::manoeuvre::{MANOEUVRES, Manoeuvre, Reading, Vehicle, readings_csv};
use latsch::recording::{read_names, write_recording};
use latsch::{Error, Result, write_file};
use serde_json::json;
use std::path::PathBuf;

/// Drive a vehicle through a manoeuvre that validates it, and read from it what it is for
///
/// Without a name the manoeuvres are listed. The folder gets the system (system.toml, for `latsch cosimulate`), its input files, results.csv and
/// readings.csv. Running an FMU runs its code: use only those that you trust.
#[derive(clap::Args)]
pub struct Args {
    /// The manoeuvre
    #[arg(value_name = "NAME", requires_all = ["vehicle", "output"])]
    name: Option<String>,
    /// The vehicle: a shipped model (ring-brush-vehicle, magic-formula-vehicle) or an FMU
    #[arg(long, value_name = "MODEL|F.fmu", requires = "name")]
    vehicle: Option<String>,
    /// Folder to write, which is made
    #[arg(long, short, value_name = "DIR", requires = "name")]
    output: Option<PathBuf>,
    /// What the vehicle calls its variables: TOML with a table [names] of "front_left.brake_torque" = "M_B_FL"; names that are not there are those of the shipped vehicles
    #[arg(long, value_name = "F.toml", requires = "name")]
    names: Option<PathBuf>,
    /// How the readings are printed
    #[arg(long, value_enum, default_value_t = Format::Text, requires = "name")]
    format: Format,
}

pub fn run(args: &Args) -> Result<()> {
    let (Some(name), Some(vehicle), Some(folder)) = (&args.name, &args.vehicle, &args.output) else {
        return MANOEUVRES.iter().try_for_each(|m| print(&format!("{:16}  {}", m.name, m.what)));
    };
    let manoeuvre = Manoeuvre::find(name)?;
    let names = args.names.as_deref().map(read_names).transpose()?.unwrap_or_default();
    let path = PathBuf::from(vehicle);
    let is_file = path.exists() || path.extension().is_some_and(|e| e.eq_ignore_ascii_case("fmu"));
    let vehicle = if is_file { Vehicle::Fmu(path) } else { Vehicle::Model(vehicle.clone()) };
    std::fs::create_dir_all(folder)
        .map_err(|e| Error::file(format!("{} cannot be made: {e}", folder.display())))?;
    let done = manoeuvre.drive(vehicle, names, folder)?;
    let inside = |path: &std::path::Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    write_file(&folder.join("system.toml"), done.plan.to_toml(&inside).as_bytes())?;
    write_recording(&folder.join("results.csv"), &done.recording)?;
    write_file(&folder.join("readings.csv"), readings_csv(&done.readings).as_bytes())?;
    for note in &done.notes {
        warn(note);
    }
    match args.format {
        Format::Json => {
            print_json(&json!({ "manoeuvre": name, "readings": done.readings, "notes": done.notes }))
        }
        Format::Text => done.readings.iter().try_for_each(|reading| print(&line(reading))),
    }
}

fn line(reading: &Reading) -> String {
    let expected =
        reading.expected.map_or(String::new(), |e| format!("   {} by its closed form", digits(e, 5)));
    format!("{:44} {:>12} {:8}{expected}", reading.name, digits(reading.value, 5), reading.unit)
}
