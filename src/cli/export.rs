//! `latsch export`: an FMU of a model.

use super::{check_outputs, print};
use latsch::fmi::Entry;
use latsch::fmi::archive::{Binary, ModelLibrary};
use latsch::fmi::import::ImportedFmu;
use latsch::model::{Settings, Slave};
use latsch::recording::profile_value;
use latsch::shipped::MODELS;
use latsch::{Error, Result, write_file};
use std::path::{Path, PathBuf};

/// Write a model as an FMU for co-simulation
#[derive(clap::Args)]
pub struct Args {
    /// Name of the model (see `latsch models`)
    model: String,
    /// Values of parameters and start values of inputs: TOML with [parameters] and [inputs], in SI units or as "170 N/mm"
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
    check_outputs(
        &[&output],
        &args.parameters.iter().chain(&args.library).map(|p| p.as_path()).collect::<Vec<_>>(),
    )?;
    try_out(args, &settings, &fmu)?;
    write_file(&output, &fmu)?;
    print(&format!("{}: {} kB", output.display(), fmu.len() / 1000))
}

/// Initializes the model once: parameters may contradict each other, which no range can say.
fn try_out(args: &Args, settings: &Settings, fmu: &[u8]) -> Result<()> {
    let start = |slave: &mut dyn Slave| {
        slave.start(0.0, None)?;
        slave.finish_start()
    };
    let tried = if args.library.is_none() {
        start(Entry::find(MODELS, &args.model)?.slave(settings)?.as_mut())
    } else {
        // the model of another library runs in its FMU only
        let io = |e: std::io::Error| Error::file(format!("a temporary folder cannot be used: {e}"));
        let folder = tempfile::tempdir().map_err(io)?;
        let path = folder.path().join("new.fmu");
        write_file(&path, fmu)?;
        start(&mut ImportedFmu::load(&path)?)
    };
    let place = args.parameters.as_ref().map(|path| format!("{}: ", path.display())).unwrap_or_default();
    tried.map_err(|e| Error::variable(format!("{place}the FMU would not start: {e}")))
}

/// The settings in a file; none without a file.
pub fn read_settings(path: Option<&Path>) -> Result<Settings> {
    let Some(path) = path else { return Ok(Settings::default()) };
    let text = std::fs::read_to_string(path).map_err(|e| Error::file(format!("{}: {e}", path.display())))?;
    let mut settings = Settings::parse(&text, &path.display().to_string())?;
    let folder = path.parent().unwrap_or(Path::new(""));
    for setting in &mut settings.values {
        let value = profile_value(&setting.name, setting.value.clone(), folder);
        setting.value = value.map_err(|e| e.at(&setting.place))?;
    }
    Ok(settings)
}
