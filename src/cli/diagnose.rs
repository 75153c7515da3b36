//! `latsch diagnose`: what a model leaves out.

use super::console::Bar;
use super::digits::{digits, short};
use super::{Format, print, print_json_text};
use latsch::cosimulate::write_corrected;
use latsch::diagnose::{Base, Map, Outcome, Request, diagnose};
use latsch::effect::file::{Fitted, corrected_text};
use latsch::fmi::archive::ModelLibrary;
use latsch::fmi::corrected::{CorrectedBase, export_corrected};
use latsch::recording::read_settings;
use latsch::report::{CheckRun, diagnosis_report, write_html};
use latsch::shipped::MODELS;
use latsch::{Error, Result, write_file};
use std::path::{Path, PathBuf};

/// Find where recordings and a model differ, and name the physics that the model leaves out
///
/// Fits the model's parameters to some of the recordings and tries every effect of the catalogue inside the simulation.
/// An effect counts only if the other recordings, to which nothing is fitted, gain from it what chance does not make;
/// which one of those that count is named, all recordings decide together.
///
/// Of a wired vehicle and recordings that repeat each other ([repeats] in runs.toml) it opens the loops instead and names parameters of its parts.
#[derive(clap::Args)]
pub struct Args {
    /// Name of a shipped model (see `latsch models`), an FMU file or a wired system
    #[arg(value_name = "MODEL|F.fmu|F.ssd|F.toml")]
    pub(super) model: String,
    /// Folder of recordings, CSV with the columns `time [s]` and `name [unit]`, TYDEX, RPC III, MDF 4, MATLAB or Parquet; columns named like inputs drive the
    /// model, columns named like outputs are compared. `runs.toml` in it says which runs are to fit and which to check
    #[arg(long, value_name = "DIR")]
    pub(super) recordings: PathBuf,
    /// Parameters of the model: TOML with [parameters], [inputs] for those that no recording holds, and [fit] for those that may be fitted
    #[arg(long, value_name = "F.toml")]
    pub(super) parameters: Option<PathBuf>,
    /// What the channels are: TOML with [channels] and [roles]; above them, only_named = true leaves out all others, times_of = "NAME" takes those of several rates at the times of one
    #[arg(long, value_name = "F.toml")]
    pub(super) map: Option<PathBuf>,
    /// Communication step [s] [default: one that suits model and recordings]
    #[arg(long, value_name = "H")]
    pub(super) step: Option<f64>,
    /// Runs at the same time; the answer is the same with any number [default: the number of cores]
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    pub(super) jobs: usize,
    /// Folder for what comes out
    #[arg(long, short, value_name = "DIR")]
    pub(super) output: PathBuf,
    /// How the verdict is printed
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub(super) format: Format,
}

pub fn run(args: &Args) -> Result<()> {
    if args.step.is_some_and(|s| !(s.is_finite() && s > 0.0)) {
        return Err(Error::call("--step has to be a positive time"));
    }
    if latsch::causes::has_repeats(&args.recordings) {
        return super::causes::run(args);
    }
    // what a long search ends with is not missed then
    let library = ModelLibrary::shipped(MODELS)?;
    let request = Request {
        model: args.model.clone(),
        settings: read_settings(args.parameters.as_deref())?,
        recordings: args.recordings.clone(),
        map: args.map.as_deref().map(Map::read).transpose()?.unwrap_or_default(),
        step: args.step,
        threads: args.jobs,
    };
    std::fs::create_dir_all(&args.output)
        .map_err(|e| Error::file(format!("{} cannot be made: {e}", args.output.display())))?;
    let bar = Bar::of_share();
    let outcome = diagnose(&request, &mut |what, share| {
        bar.set_what(what);
        bar.set_share(share);
    })?;
    drop(bar);
    write(&args.output, &outcome, &library)?;
    match args.format {
        Format::Json => print_json_text(outcome.diagnosis.to_json()?.trim_end()),
        Format::Text => print(&format!("{}\n{}", text(&outcome), args.output.join("report.html").display())),
    }
}

fn write(folder: &Path, outcome: &Outcome, library: &ModelLibrary) -> Result<()> {
    let diagnosis = &outcome.diagnosis;
    write_file(&folder.join("diagnosis.json"), diagnosis.to_json()?.as_bytes())?;
    let runs: Vec<CheckRun> = outcome
        .check
        .iter()
        .map(|run| CheckRun {
            name: run.measured.source.clone(),
            recording: run.measured.clone(),
            before: run.before.clone(),
            after: run.after.clone(),
        })
        .collect();
    write_html(&folder.join("report.html"), &diagnosis_report(diagnosis, &runs)?)?;
    let interface = &outcome.subject.interface;
    let interval = |name: &str| {
        let fitted = diagnosis.parameters.iter().find(|p| p.name == name)?;
        Some((fitted.low?, fitted.high?))
    };
    let fitted: Vec<Fitted> = outcome
        .parameters
        .iter()
        .map(|(variable, value)| {
            let name = interface.variables[*variable].name.clone();
            Fitted { interval: interval(&name), name, value: *value }
        })
        .collect();
    let text = corrected_text(interface, &fitted, &outcome.attachments, &outcome.intervals, outcome.step)?;
    write_file(&folder.join("corrected.toml"), text.as_bytes())?;
    let base = match &outcome.subject.base {
        Base::Shipped(name, settings) => CorrectedBase::Model(name.clone(), settings.clone()),
        Base::Fmu(path) => CorrectedBase::Fmu(path.clone()),
        Base::System(path) => return write_system(folder, path, &fitted, outcome, library),
    };
    let parameters: Vec<(String, f64)> = fitted.into_iter().map(|f| (f.name, f.value)).collect();
    let fmu = export_corrected(&base, &parameters, &outcome.attachments, outcome.step, library, &[])?;
    write_file(&folder.join("corrected.fmu"), &fmu)
}

/// A wired system again, with corrected parts.
fn write_system(
    folder: &Path,
    path: &Path,
    fitted: &[Fitted],
    outcome: &Outcome,
    library: &ModelLibrary,
) -> Result<()> {
    let folder = folder.join("corrected-system");
    let parameters: Vec<(String, f64)> = fitted.iter().map(|f| (f.name.clone(), f.value)).collect();
    write_corrected(path, &folder, &parameters, &outcome.attachments, library)
        .map_err(|e| e.at("the corrected system cannot be written; all else is there"))
}

/// The verdict for people.
fn text(outcome: &Outcome) -> String {
    let diagnosis = &outcome.diagnosis;
    let mut lines = vec![diagnosis.summary.clone()];
    for check in &diagnosis.check {
        let noise = check.noise.filter(|noise| *noise > 0.0);
        let times = noise.map(|noise| match check.after / noise {
            few if few < 0.01 => ", less than a hundredth of its noise".to_owned(),
            times => format!(", {} times its noise", digits(times, 2)),
        });
        let [before, after] = [check.before, check.after].map(|error| short(error, 3));
        // where nothing was corrected there is one number
        let error = match before == after {
            true => format!("{after} {} after the refit", check.unit),
            false => format!("{before} -> {after} {}", check.unit),
        };
        lines.push(format!(
            "  {:<28} error on the check runs {error}{}",
            check.channel,
            times.unwrap_or_default()
        ));
    }
    for part in &diagnosis.parts {
        let channels = |made: bool| {
            let own = part.channels.iter().filter(move |c| c.made_here == Some(made));
            own.map(|c| c.channel.as_str()).collect::<Vec<_>>().join(", ")
        };
        if let Some(why) = &part.closed {
            lines.push(format!("  {} could not be run by itself: {why}", part.part));
        }
        let (here, elsewhere) = (channels(true), channels(false));
        if !here.is_empty() {
            let name = &part.part;
            lines.push(format!(
                "  {name} differs by itself: with recorded inputs {here} keep more than noise"
            ));
        } else if !elsewhere.is_empty() {
            lines.push(format!(
                "  {} does not differ by itself: with recorded inputs only noise is left",
                part.part
            ));
        }
    }
    if !diagnosis.next_experiment.is_empty() {
        lines.push(format!("What would tell them apart: {}", diagnosis.next_experiment));
    }
    lines.extend(diagnosis.notes.iter().cloned());
    lines.join("\n")
}
