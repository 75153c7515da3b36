//! `latsch export`: an FMU of a model.

use super::given::Given;
use super::{check_outputs, print};
use latsch::effect::file::Corrections;
use latsch::fmi::archive::{Binary, ModelLibrary};
use latsch::fmi::corrected::{CorrectedBase, export_corrections};
use latsch::fmi::import::ImportedFmu;
use latsch::fmi::{Entry, Fmi};
use latsch::model::{Settings, Slave};
use latsch::shipped::MODELS;
use latsch::temporary::Folder;
use latsch::{Error, Result, read_text, write_file};
use std::path::{Path, PathBuf};

/// Write a model as an FMU for co-simulation, or an FMU with effects added to it
#[derive(clap::Args)]
pub struct Args {
    /// Name of the model (see `latsch models`), or with --effects an FMU file of any maker
    #[arg(value_name = "MODEL|F.fmu")]
    model: String,
    #[command(flatten)]
    given: Given,
    /// What is added to the model, such as the corrected.toml of a diagnosis: TOML with [[effect]] and [parameters]
    #[arg(long, value_name = "F.toml")]
    effects: Option<PathBuf>,
    /// The FMU to write [default: MODEL.fmu, with --effects MODEL-corrected.fmu]
    #[arg(long, short, value_name = "F.fmu")]
    output: Option<PathBuf>,
    /// Version of the standard: 2 for FMI 2.0, 3 for FMI 3.0
    #[arg(long, value_name = "VERSION", value_enum, default_value = "2")]
    fmi: Version,
    /// A library of own models made from fmu-template, instead of the shipped one
    #[arg(long, value_name = "LIBRARY")]
    library: Option<PathBuf>,
    /// What goes into the FMU instead of that library: a binary built from the same sources for the platform
    /// linux64, win64, ...; can be given more than once
    #[arg(long, value_name = "PLATFORM=FILE")]
    binary: Vec<Binary>,
}

/// A version of the standard, as one writes it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Version {
    #[value(name = "2", alias = "2.0")]
    Two,
    #[value(name = "3", alias = "3.0")]
    Three,
}

impl From<Version> for Fmi {
    fn from(version: Version) -> Self {
        match version {
            Version::Two => Self::Two,
            Version::Three => Self::Three,
        }
    }
}

pub fn run(args: &Args) -> Result<()> {
    if args.fmi == Version::Three && args.effects.is_some() {
        return Err(Error::call("with --effects, FMUs are of FMI 2.0: leave out --fmi 3"));
    }
    let file = Path::new(&args.model);
    let is_fmu = file.extension().is_some_and(|e| e.eq_ignore_ascii_case("fmu")) || file.is_file();
    // a wrong name is the nearer mistake than a library that is missing
    let interface = match !is_fmu && args.library.is_none() {
        true => Some((Entry::find(MODELS, &args.model)?.table)()),
        false => None,
    };
    let settings = args.given.settings(interface.as_ref())?;
    let suffix = if args.effects.is_some() { "-corrected" } else { "" };
    let stem = if is_fmu {
        file.file_stem().unwrap_or_default().to_string_lossy()
    } else {
        args.model.as_str().into()
    };
    let output = args.output.clone().unwrap_or_else(|| format!("{stem}{suffix}.fmu").into());
    let read = args.given.read().chain(args.library.iter().chain(&args.effects).map(PathBuf::as_path));
    check_outputs(&[&output], &read.chain(is_fmu.then_some(file)).collect::<Vec<_>>())?;
    let library = match &args.library {
        Some(path) => ModelLibrary::open(path)?,
        None => ModelLibrary::shipped(MODELS)?,
    };
    let fmu = match &args.effects {
        None if is_fmu => {
            return Err(Error::call("an FMU is exported only with something added to it: --effects F.toml"));
        }
        None => {
            try_out(args, &settings, &library)?;
            library.fmu_of(args.fmi.into(), &args.model, &settings, &args.binary)?
        }
        Some(effects) => {
            if is_fmu && args.given.any() {
                return Err(Error::call(
                    "with an FMU, its parameters go into the file of --effects, under [parameters]",
                ));
            }
            let base = match is_fmu {
                true => CorrectedBase::Fmu(file.into()),
                false => CorrectedBase::Model(args.model.clone(), settings),
            };
            let fmu = export_corrections(&base, &read_corrections(effects)?, &library, &args.binary)?;
            if args.binary.is_empty() {
                start_fmu(&fmu).map_err(|e| would_not_start(effects, &e))?;
            }
            fmu
        }
    };
    write_file(&output, &fmu)?;
    print(&format!("{}: {} kB", output.display(), fmu.len() / 1000))
}

/// The corrections in a file.
fn read_corrections(path: &Path) -> Result<Corrections> {
    let text = read_text(path)?;
    let corrections = Corrections::parse(&text, &path.display().to_string())?;
    if corrections.original {
        return Err(Error::file(format!(
            "{}: this is the model.toml of an FMU that carries another one; name that FMU instead",
            path.display()
        )));
    }
    Ok(corrections)
}

fn would_not_start(place: &Path, error: &Error) -> Error {
    Error::variable(format!("{}: the FMU would not start: {error}", place.display()))
}

fn start(slave: &mut dyn Slave) -> Result<()> {
    slave.start(0.0, None)?;
    slave.finish_start()
}

/// Starts an FMU that is not written yet.
fn start_fmu(fmu: &[u8]) -> Result<()> {
    let io = |e: std::io::Error| Error::file(format!("a temporary folder cannot be used: {e}"));
    let folder = Folder::new("latsch-export-").map_err(io)?;
    let path = folder.path().join("new.fmu");
    write_file(&path, fmu)?;
    start(&mut ImportedFmu::load(&path)?)
}

/// Initializes the model once: parameters may contradict each other, which no range can say.
fn try_out(args: &Args, settings: &Settings, library: &ModelLibrary) -> Result<()> {
    let tried = if args.library.is_none() {
        start(Entry::find(MODELS, &args.model)?.slave(settings)?.as_mut())
    } else {
        // the model of another library runs in its FMU only
        start_fmu(&library.fmu(&args.model, settings, &args.binary)?)
    };
    let place =
        args.given.parameters.as_ref().map(|path| format!("{}: ", path.display())).unwrap_or_default();
    tried.map_err(|e| Error::variable(format!("{place}the FMU would not start: {e}")))
}
