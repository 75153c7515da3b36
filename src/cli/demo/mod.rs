//! `latsch demo`: an ABS stop as a system of FMUs, a car's stop, a tire on its rig, and pages to look at.

mod abs_stop;
mod car_stop;
mod flat_track;
mod stop;
mod twin;

use super::print;
use latsch::fmi::archive::ModelLibrary;
use latsch::model::{Settings, Value};
use latsch::shipped::MODELS;
use latsch::{Error, Result};
use std::path::{Path, PathBuf};

/// The tire of the demo: a passenger car's.
const TIRE: &str = include_str!("../../../examples/tires/ring-brush-205-60-r15.toml");

fn tire() -> Result<Settings> {
    Settings::parse(TIRE, "ring-brush-205-60-r15.toml")
}

/// The rolling radius of that tire \[m\], which a controller has to know.
fn rolling_radius(tire: &Settings) -> Result<f64> {
    match tire.values.iter().find(|setting| setting.name == "rolling_radius").map(|setting| &setting.value) {
        Some(Value::Real(radius)) => Ok(*radius),
        _ => Err(Error::file("the demo's tire has no rolling radius")),
    }
}

/// Export FMUs, brake a wheel and a car with and without ABS, run a rig programme; write pages with the results
#[derive(clap::Args)]
pub struct Args {
    /// Folder for the FMUs, the systems, the results and the pages
    #[arg(long, short, value_name = "DIR", default_value = "demo")]
    output: PathBuf,
}

pub fn run(args: &Args) -> Result<()> {
    let folder = &args.output;
    let (runs, car, track) = (folder.join("runs"), folder.join("car"), folder.join("flat-track"));
    for folder in [&runs, &car, &track] {
        std::fs::create_dir_all(folder).map_err(|e| Error::file(format!("{}: {e}", folder.display())))?;
    }
    let library = ModelLibrary::shipped(MODELS)?;
    // they have nothing to do with each other
    let (stop, others) = std::thread::scope(|scope| {
        let others = scope.spawn(|| flat_track::run(&track, &library).and_then(|()| car_stop::run(&car)));
        (abs_stop::run(folder, &library), others.join())
    });
    stop?;
    others.unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
    for (path, what) in [
        ("index.html", "an ABS stop on four roads: open this in a browser"),
        ("abs-stop.toml", "the system of three FMUs, for `latsch cosimulate`"),
        ("runs", "the system, the inputs and the results of each stop"),
        ("car/index.html", "a car's stop: forces in links, four contact patches"),
        ("car/slabs-abs.toml", "the car, its brakes and controller, for `latsch cosimulate`"),
        ("flat-track/index.html", "a tire on its rig: forces over slip, the contact patch"),
        ("flat-track/ring-brush-flat-track.fmu", "the rig, for any FMI 2.0 co-simulation master"),
    ] {
        print(&format!("{:45} {what}", folder.join(Path::new(path)).display().to_string()))?;
    }
    Ok(())
}
