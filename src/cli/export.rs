//! `latsch export`: an FMU of a model.

use super::print;
use latsch::fmi::archive::{Binary, ModelLibrary};
use latsch::model::Settings;
use latsch::{Error, Result, write_file};
use std::path::{Path, PathBuf};

/// Write a model as an FMU for co-simulation
#[derive(clap::Args)]
pub struct Args {
    /// Name of the model (see `latsch models`)
    model: String,
    /// Values of parameters and start values of inputs: TOML with [parameters] and [inputs], SI units
    #[arg(long, value_name = "F.toml")]
    parameters: Option<PathBuf>,
    /// The FMU to write [default: MODEL.fmu]
    #[arg(long, short, value_name = "F.fmu")]
    output: Option<PathBuf>,
    /// A library of own models made from fmu-template, instead of the shipped one
    #[arg(long, value_name = "LIBRARY")]
    library: Option<PathBuf>,
    /// What goes into the FMU instead of that library: a binary built from the same sources for the platform
    /// linux64, win64, ...; can be given more than once
    #[arg(long, value_name = "PLATFORM=FILE")]
    binary: Vec<Binary>,
}

pub fn run(args: &Args) -> Result<()> {
    let settings = read_settings(args.parameters.as_deref())?;
    let library = match &args.library {
        Some(path) => ModelLibrary::open(path)?,
        None => ModelLibrary::shipped()?,
    };
    let fmu = library.fmu(&args.model, &settings, &args.binary)?;
    let output = args.output.clone().unwrap_or_else(|| format!("{}.fmu", args.model).into());
    write_file(&output, &fmu)?;
    print(&format!("{}: {} kB", output.display(), fmu.len() / 1000));
    Ok(())
}

/// The settings in a file; none without a file.
pub fn read_settings(path: Option<&Path>) -> Result<Settings> {
    let Some(path) = path else { return Ok(Settings::default()) };
    let text = std::fs::read_to_string(path).map_err(|e| Error::file(format!("{}: {e}", path.display())))?;
    Settings::parse(&text, &path.display().to_string())
}
