//! `latsch simulate`: a model or FMU along recorded inputs.

use super::compared::{Compared, sides};
use super::console::Bar;
use super::given::Given;
use super::mapped::Mapped;
use super::{check_outputs, files_in, note, print, warn};
use latsch::comparison::Conditions;
use latsch::fmi::import::ImportedFmu;
use latsch::fmi::{Entry, guid};
use latsch::model::{Causality, Interface, Kind, Model, Native, Settings, Slave, Value};
use latsch::recording::{
    Recording, add_noise, profile_value, read_settings, recording_endings, write_recording,
};
use latsch::report::{Beside, PatchFrame, patch_caption, simulation_report, write_html};
use latsch::rig::RingBrushFlatTrack;
use latsch::shipped::MODELS;
use latsch::simulate::{
    Experiment, Outcome, Schedule, follow_recorded_motions, motions_are_followed, simulate,
};
use latsch::{Error, Result, VERSION};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// A ratio that is as near to a whole number is one: times are sums of steps in binary.
const WHOLE: f64 = 1e-6;

/// Run a model, or any FMI 2.0 co-simulation FMU, along recorded inputs
///
/// Running an FMU runs its code: use only those that you trust.
#[derive(clap::Args)]
pub struct Args {
    /// Name of a shipped model (see `latsch models`) or an FMU file
    #[arg(value_name = "MODEL|F.fmu")]
    model: String,
    /// Recorded inputs: CSV with the columns `time [s]` and `name [unit]`, TYDEX (.tdx, .tda, .tdb), RPC III (.rsp, .drv,
    /// .tim, .rpc), MDF 4 (.mf4), MATLAB (.mat) or Parquet (.parquet); columns named like outputs are shown beside the simulation. A folder, such as `latsch rig-program` writes, is run file by file, each with the values in
    /// the TOML of its name
    #[arg(long, value_name = "F.csv|DIR")]
    inputs: Option<PathBuf>,
    /// A column of the recording that is left out
    #[arg(long, value_name = "COLUMN")]
    ignore: Vec<String>,
    #[command(flatten)]
    map: Mapped,
    /// Value of a parameter, or of an input for the whole run; `path_speed="90 km/h"` is converted, `road_profile=@F.csv` takes the points of a road from a file with the columns `x [m],z [m]`
    #[arg(long = "set", value_name = "NAME=VALUE")]
    set: Vec<String>,
    #[command(flatten)]
    given: Given,
    /// Start time [s] [default: the first recorded time]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    start: Option<f64>,
    /// Stop time [s] [default: the last recorded time]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    stop: Option<f64>,
    /// Communication step [s] [default: the model's]
    #[arg(long, value_name = "H", allow_negative_numbers = true)]
    step: Option<f64>,
    /// Results to write: CSV with the inputs and outputs, or TYDEX, RPC III, MDF 4 or Parquet if the name ends like that; a folder of them, which is made, if --inputs is one
    #[arg(long, short, value_name = "F.csv|DIR")]
    output: PathBuf,
    /// White noise on the outputs, as a share of what each of them ranges over in all that is run: 0.01 for 1 %
    #[arg(long, value_name = "SHARE")]
    noise: Option<f64>,
    /// Seed of the noise
    #[arg(long, value_name = "N", default_value_t = 1, requires = "noise")]
    seed: u64,
    /// Also write the internal quantities
    #[arg(long)]
    all: bool,
    /// Write these variables and no others, in this order
    #[arg(long, value_name = "NAME,NAME,...", value_delimiter = ',', conflicts_with = "all")]
    channels: Vec<String>,
    /// Write a sample every so many seconds, a whole number of steps, and the last [default: each step]
    #[arg(long, value_name = "T")]
    interval: Option<f64>,
    /// Page with plots to write
    #[arg(long, value_name = "F.html")]
    report: Option<PathBuf>,
    #[command(flatten)]
    compared: Compared,
}

pub fn run(args: &Args) -> Result<()> {
    if args.noise.is_some_and(|share| !(share > 0.0 && share < 1.0)) {
        return Err(Error::call("--noise is a share of a range, above 0 and below 1: 0.01 for 1 %"));
    }
    args.map.needs(args.inputs.is_some(), "--inputs")?;
    match &args.inputs {
        Some(folder) if folder.is_dir() => every_file(args, folder),
        _ => one_file(args),
    }
}

/// Runs what `--inputs` names, or the model without any.
fn one_file(args: &Args) -> Result<()> {
    let mut read: Vec<&Path> = vec![Path::new(&args.model)];
    read.extend(args.inputs.as_deref().into_iter().chain(args.map.file()));
    read.extend(args.given.read().chain(args.compared.read()));
    let outputs: Vec<&Path> =
        std::iter::once(&args.output).chain(&args.report).map(PathBuf::as_path).collect();
    check_outputs(&outputs, &read)?;
    let inputs = args.inputs.as_deref().map(|file| read_inputs(args, file)).transpose()?;
    let conditions = args.compared.conditions(&args.map)?;
    let given = given(args)?;
    let Ran { subject, experiment, mut outcome, notes } =
        one_run(args, &given, inputs.as_ref(), &Settings::default())?;
    notes.iter().for_each(|text| note(text));
    let interface = subject.slave.interface();
    sense(args, interface, std::slice::from_mut(&mut outcome.recording));
    let written = written(args, interface, &outcome.recording)?;
    write_recording(&args.output, &written)?;
    if let Some(report) = &args.report {
        let page = subject.report(&experiment, &outcome, &conditions)?;
        write_html(report, &page)?;
    }
    finish(&args.output, outcome, written.time.len())
}

/// Runs every recording of a folder, each with the values in the TOML of its name.
fn every_file(args: &Args, folder: &Path) -> Result<()> {
    if args.report.is_some() {
        return Err(Error::call("--report shows one run: name one of the folder's files as --inputs"));
    }
    let files = files_in(folder, &recording_endings())?;
    std::fs::create_dir_all(&args.output)
        .map_err(|e| Error::file(format!("{} cannot be made: {e}", args.output.display())))?;
    let outputs: Vec<PathBuf> =
        files.iter().filter_map(|file| Some(args.output.join(file.file_name()?))).collect();
    let read: Vec<&Path> = files.iter().map(PathBuf::as_path).chain(args.given.read()).collect();
    check_outputs(&outputs.iter().map(PathBuf::as_path).collect::<Vec<_>>(), &read)?;
    let given = given(args)?;
    let (mut recordings, mut interface, mut said) = (Vec::new(), None, BTreeSet::new());
    for file in &files {
        let inputs = read_inputs(args, file)?;
        let switches = Some(file.with_extension("toml")).filter(|toml| toml.is_file());
        let switches = read_settings(switches.as_deref())?;
        let Ran { subject, outcome, notes, .. } = one_run(args, &given, Some(&inputs), &switches)?;
        for text in notes {
            if said.insert(text.clone()) {
                note(&text);
            }
        }
        if let Some(error) = outcome.stopped {
            return Err(Error::numeric(format!(
                "{}: stopped at {error}; nothing is written",
                file.display()
            )));
        }
        recordings.push(written(args, subject.slave.interface(), &outcome.recording)?);
        interface = Some(subject.slave.interface().clone());
    }
    if let Some(interface) = &interface {
        sense(args, interface, &mut recordings);
    }
    for (file, recording) in outputs.iter().zip(&recordings) {
        write_recording(file, recording)?;
    }
    let samples: usize = recordings.iter().map(|r| r.time.len()).sum();
    print(&format!("{}: {} runs, {samples} samples", args.output.display(), recordings.len()))
}

/// A recording without what is to be left out.
fn read_inputs(args: &Args, file: &Path) -> Result<Recording> {
    let mut inputs = args.map.recording(file)?;
    for name in &args.ignore {
        inputs.channel(name)?;
        inputs.channels.retain(|c| c.name != *name);
    }
    Ok(inputs)
}

/// The noise of sensors, where it is asked for.
fn sense(args: &Args, interface: &Interface, recordings: &mut [Recording]) {
    let is_output = |name: &str| {
        interface.index(name).is_some_and(|i| interface.variables[i].causality == Causality::Output)
    };
    if let Some(share) = args.noise {
        add_noise(recordings, is_output, share, args.seed);
    }
}

/// A run: what ran, along what, and what came of it.
struct Ran<'a> {
    subject: Subject,
    experiment: Experiment<'a>,
    outcome: Outcome,
    /// What its user may not expect.
    notes: Vec<String>,
}

/// Runs the model along some inputs, with values of their own.
fn one_run<'a>(
    args: &Args,
    given: &Settings,
    inputs: Option<&'a Recording>,
    switches: &Settings,
) -> Result<Ran<'a>> {
    if inputs.is_none() && !args.ignore.is_empty() {
        return Err(Error::call("--ignore goes with --inputs"));
    }
    let mut subject = Subject::load(&args.model, given)?;
    let mut experiment =
        Experiment { inputs, values: Vec::new(), start: args.start, stop: args.stop, step: args.step };
    let interface = subject.slave.interface();
    for assignment in &args.set {
        let value = parse_assignment(interface, assignment)?;
        if experiment.values.iter().any(|(index, _)| *index == value.0) {
            return Err(Error::variable(format!("--set {assignment}: the variable is set twice")));
        }
        experiment.values.push(value);
    }
    for switch in &switches.values {
        let index = interface.find(&switch.name).map_err(|e| e.at(&switch.place))?;
        if experiment.values.iter().any(|(given, _)| *given == index) {
            return Err(Error::variable(format!("{}: {} is set by --set, too", switch.place, switch.name)));
        }
        let value = interface.variables[index].accept(&switch.value).map_err(|e| e.at(&switch.place))?;
        experiment.values.push((index, value));
    }
    if is_file(&args.model) {
        // what files say of an FMU is set as a user would set it
        for (index, value) in given.check(interface)? {
            if !experiment.values.iter().any(|(set, _)| *set == index) {
                experiment.values.push((index, value));
            }
        }
    }
    let switched = {
        let is_given = |variable: usize| {
            experiment.values.iter().any(|(v, _)| *v == variable)
                || given.values.iter().any(|s| s.name == interface.variables[variable].name)
        };
        follow_recorded_motions(interface, &recorded(interface, inputs), is_given)
    };
    let notes =
        switched.iter().map(|(variable, _)| motions_are_followed(&interface.variables[*variable].name));
    let notes = notes.collect();
    experiment.values.extend(switched);
    check_written(args, interface, &experiment.schedule(interface)?)?;
    let outcome = subject.run(&experiment, &args.model)?;
    Ok(Ran { subject, experiment, outcome, notes })
}

/// The values that files give.
fn given(args: &Args) -> Result<Settings> {
    if is_file(&args.model) {
        if args.given.parameters.is_some() || args.given.tire.is_some() {
            return Err(Error::call("an FMU has its parameters inside; change them with --set"));
        }
        return args.given.settings(None);
    }
    args.given.settings(Some(&(model(&args.model)?.table)()))
}

/// Whether what is called so is an FMU and no model.
pub fn is_file(model: &str) -> bool {
    let path = Path::new(model);
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("fmu")) || path.is_file()
}

/// A shipped model.
fn model(name: &str) -> Result<Entry> {
    Entry::find(MODELS, name).map_err(|e| Error::variable(format!("{e}; an FMU is named by its file, F.fmu")))
}

/// The inputs that a recording holds.
fn recorded(interface: &Interface, inputs: Option<&Recording>) -> Vec<usize> {
    let variables = inputs.iter().flat_map(|r| &r.channels).filter_map(|c| interface.index(&c.name));
    variables.filter(|v| interface.variables[*v].causality == Causality::Input).collect()
}

/// Says how many samples were written, or why the run ended early.
fn finish(output: &Path, outcome: Outcome, samples: usize) -> Result<()> {
    match outcome.stopped {
        None => print(&format!("{}: {samples} samples", output.display())),
        Some(error) => Err(Error::numeric(format!(
            "stopped at {error}; {} has the {samples} samples before that",
            output.display()
        ))),
    }
}

/// What is run: the slave, and what else is known of it.
pub struct Subject {
    pub slave: Box<dyn Slave>,
    /// Settings of the flat track that the slave is, which can also be run in this process.
    flat_track: Option<Settings>,
    even_steps_only: bool,
    description: String,
    /// Names and values of text parameters, such as the name of the tire.
    texts: Vec<(String, String)>,
}

impl Subject {
    /// A shipped model by name, with settings, or an FMU by its file, which has its own.
    ///
    /// # Errors
    /// Neither; or an FMU or settings that cannot be used.
    pub fn load(name: &str, settings: &Settings) -> Result<Self> {
        if !is_file(name) {
            let slave = model(name)?.slave(settings)?;
            let flat_track = (name == RingBrushFlatTrack::NAME).then(|| settings.clone());
            let description = format!("{name}, in this program (latsch {VERSION})");
            return Ok(Self { slave, flat_track, even_steps_only: false, description, texts: Vec::new() });
        }
        let path = Path::new(name);
        let fmu = ImportedFmu::load(path)?;
        let about = fmu.description();
        let maker = about.generation_tool.as_deref().unwrap_or("an unnamed tool");
        let description = format!("{} ({}), made by {maker}", path.display(), about.model_name);
        let even_steps_only = !about.capabilities.can_handle_variable_step;
        let flat_track = own_flat_track(&fmu);
        Ok(Self { slave: Box::new(fmu), flat_track, even_steps_only, description, texts: Vec::new() })
    }

    /// Runs it, with a progress bar on a terminal.
    ///
    /// # Errors
    /// See [`simulate`].
    pub fn run(&mut self, experiment: &Experiment<'_>, title: &str) -> Result<Outcome> {
        let schedule = experiment.schedule(self.slave.interface())?;
        if self.even_steps_only && !schedule.is_even() {
            return Err(Error::call(format!(
                "this FMU cannot vary its step, and {} s to {} s is no whole number of steps of {} s",
                schedule.start, schedule.stop, schedule.step
            )));
        }
        let bar = Bar::of_steps(schedule.steps as u64, title);
        let outcome = simulate(self.slave.as_mut(), experiment, |k, slave| {
            if k == 0
                && let Some(warning) = slave.warning()
            {
                bar.above(|| warn(&warning));
            }
            bar.set(k as u64);
        });
        drop(bar);
        let texts: Vec<usize> = (0..self.slave.interface().variables.len())
            .filter(|&i| self.slave.interface().variables[i].kind == Kind::Text)
            .collect();
        for index in texts {
            if let Ok(text) = self.slave.text(index) {
                self.texts.push((self.slave.interface().variables[index].name.clone(), text));
            }
        }
        outcome
    }

    /// The page of a run, which is compared with recorded outputs, if there are any, under these conditions.
    ///
    /// # Errors
    /// As [`simulate`], and as [`sides`].
    pub fn report(
        &self,
        experiment: &Experiment<'_>,
        outcome: &Outcome,
        conditions: &Conditions,
    ) -> Result<String> {
        let interface = self.slave.interface();
        let schedule = experiment.schedule(interface)?;
        let mut facts = vec![
            ("Model".into(), self.description.clone()),
            ("Time".into(), format!("{} s to {} s", schedule.start, schedule.stop)),
            ("Communication step".into(), format!("{} ms", schedule.step * 1e3)),
        ];
        facts.extend(self.texts.iter().filter(|(_, text)| !text.is_empty()).cloned());
        if let Some(inputs) = experiment.inputs {
            facts.push(("Inputs".into(), inputs.source.clone()));
        }
        for (variable, value) in &experiment.values {
            let info = &interface.variables[*variable];
            if info.kind == Kind::Text {
                continue;
            }
            let unit = info.unit.as_deref().map(|u| format!(" {u}")).unwrap_or_default();
            facts.push((info.name.clone(), format!("{value}{unit}")));
        }
        if let Some(error) = &outcome.stopped {
            facts.push(("Stopped".into(), error.to_string()));
        }
        let frames = match &self.flat_track {
            Some(settings) => patch_frames(settings, experiment, &schedule)?,
            None => Vec::new(),
        };
        let measured = experiment.inputs.map(|r| measured(interface, r)).filter(|r| !r.channels.is_empty());
        let (simulated, measured) = sides(&outcome.recording, measured, conditions)?;
        let names = interface.variables.iter().filter_map(|v| Some((v.name.clone(), v.items()?)));
        Ok(simulation_report(
            &interface.name,
            &interface.description,
            &simulated,
            &names.collect(),
            measured.as_ref().map(|measured| Beside { measured, conditions }),
            &frames,
            &facts,
        ))
    }
}

/// The settings of an FMU that is this version's flat track: the same code runs here as in its binary,
/// and its variables have the same numbers.
fn own_flat_track(fmu: &ImportedFmu) -> Option<Settings> {
    let text = String::from_utf8(fmu.resource("model.toml")?).ok()?;
    let table = Native::<RingBrushFlatTrack>::table();
    let same_variables = fmu.interface().variables.iter().map(|v| (&v.name, v.reference));
    let same = guid(&table, &text) == fmu.description().guid
        && same_variables.eq(table.variables.iter().map(|v| (&v.name, v.reference)));
    if same { Settings::parse(&text, "model.toml").ok() } else { None }
}

/// Pictures of the contact patch along the run. An FMU does not tell of single bristles; the same
/// model in this process has the same bits.
fn patch_frames(
    settings: &Settings,
    experiment: &Experiment<'_>,
    schedule: &Schedule,
) -> Result<Vec<PatchFrame>> {
    const FRAMES: usize = 48;
    let every = schedule.steps.div_ceil(FRAMES).max(1);
    let mut twin = Native::<RingBrushFlatTrack>::new(settings)?;
    let mut frames = Vec::new();
    simulate(&mut twin, experiment, |k, twin| {
        if k % every != 0 {
            return;
        }
        let mut value = |name: &str| twin.find(name).and_then(|i| twin.get(i)).unwrap_or(f64::NAN);
        let title = patch_caption(value("force_z"), value("actual_slip"), value("actual_slip_angle"));
        frames.push(PatchFrame::of(twin.model().tire(), schedule.point(k), &title));
    })?;
    Ok(frames)
}

/// The recorded channels that are no inputs: what was measured.
fn measured(interface: &Interface, recording: &Recording) -> Recording {
    let mut measured = recording.clone();
    measured.channels.retain(|c| {
        interface.index(&c.name).is_some_and(|i| interface.variables[i].causality != Causality::Input)
    });
    measured
}

/// Checks before a long run that what is asked for can be written of it.
fn check_written(args: &Args, interface: &Interface, schedule: &Schedule) -> Result<()> {
    for name in &args.channels {
        let info = &interface.variables[interface.find(name).map_err(|e| e.at("--channels"))?];
        if info.causality == Causality::Parameter || info.kind == Kind::Text {
            return Err(Error::call(format!("--channels: {name} does not change during a run")));
        }
    }
    let Some(interval) = args.interval else { return Ok(()) };
    let steps = interval / schedule.step;
    if steps.round() >= 1.0 && (steps / steps.round() - 1.0).abs() < WHOLE {
        return Ok(());
    }
    Err(Error::call(format!("--interval {interval}: no whole number of steps of {} s", schedule.step)))
}

/// What is written of a run: the variables and samples that are asked for.
fn written(args: &Args, interface: &Interface, recording: &Recording) -> Result<Recording> {
    let mut chosen = if args.channels.is_empty() {
        selected(interface, recording, args.all)
    } else {
        let mut channels = Vec::new();
        for name in &args.channels {
            let info = &interface.variables[interface.find(name).map_err(|e| e.at("--channels"))?];
            channels.push(recording.channel(&info.name).map_err(|e| e.at("--channels"))?.clone());
        }
        Recording { channels, ..recording.clone() }
    };
    let ([first, second, ..], Some(interval)) = (&recording.time[..], args.interval) else {
        return Ok(chosen);
    };
    let (every, last) = ((interval / (second - first)).round() as usize, recording.time.len() - 1);
    let thinned = |values: &[f64]| -> Vec<f64> {
        let kept = values.iter().enumerate().filter(|(k, _)| k.is_multiple_of(every) || *k == last);
        kept.map(|(_, value)| *value).collect()
    };
    chosen.time = thinned(&chosen.time);
    for channel in &mut chosen.channels {
        channel.values = thinned(&channel.values);
    }
    Ok(chosen)
}

/// Inputs and outputs, or everything.
pub fn selected(interface: &Interface, recording: &Recording, all: bool) -> Recording {
    let mut selected = recording.clone();
    selected.channels.retain(|c| {
        let causality = interface.index(&c.name).map(|i| interface.variables[i].causality);
        all || causality != Some(Causality::Local)
    });
    selected
}

/// NAME=VALUE, with an optional unit behind the value.
pub fn parse_assignment(interface: &Interface, text: &str) -> Result<(usize, Value)> {
    let at = |e: Error| Error::variable(e.to_string()).at(format!("--set {text}"));
    let Some((name, value)) = text.split_once('=') else {
        return Err(at(Error::variable("the form is NAME=VALUE")));
    };
    let index = interface.find(name.trim()).map_err(at)?;
    let variable = &interface.variables[index];
    if !matches!(variable.causality, Causality::Parameter | Causality::Input) {
        return Err(at(Error::variable("computed by the model; it cannot be set")));
    }
    let value = Value::from_text(variable, value.trim())
        .and_then(|v| profile_value(&variable.name, v, Path::new("")))
        .and_then(|v| variable.accept(&v))
        .map_err(at)?;
    Ok((index, value))
}
