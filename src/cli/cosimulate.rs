//! `latsch cosimulate`: a wired system of models and FMUs.

use super::compared::{Compared, sides};
use super::console::Bar;
use super::mapped::Mapped;
use super::{check_outputs, print, warn};
use latsch::cosimulate::{
    Experiment, FrictionLevel, Outcome, Plan, Port, PortName, System, Until, WheelMatch, cosimulate_until,
    energy_warnings, friction_inputs, friction_level, read_system,
};
use latsch::model::{Kind, Value};
use latsch::recording::{Columns, Recording, profile_value, write_recording};
use latsch::report::{Beside, simulation_report, write_html};
use latsch::{Error, Result};
use std::path::{Path, PathBuf};

/// Run a system of models and FMUs that are wired to each other
///
/// Running an FMU runs its code: use only those that you trust.
#[derive(clap::Args)]
pub struct Args {
    /// The system: TOML, an SSP System Structure Description (.ssd) beside its FMUs, or an SSP archive (.ssp)
    #[arg(value_name = "F.toml|F.ssd|F.ssp")]
    system: PathBuf,
    /// Results to write: CSV with the columns `component.variable [unit]`, TYDEX (.tdx), RPC III (.rsp, .drv, .tim, .rpc), MDF 4 (.mf4) or Parquet (.parquet)
    #[arg(long, short, value_name = "F.csv")]
    output: PathBuf,
    /// Page with plots to write
    #[arg(long, value_name = "F.html")]
    report: Option<PathBuf>,
    /// Also write internal quantities, and inputs that nothing is connected to
    #[arg(long)]
    all: bool,
    /// Start time [s] [default: the file's, or 0]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    start: Option<f64>,
    /// Stop time [s] [default: the file's]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    stop: Option<f64>,
    /// End at the first communication point after the start at which a variable is beyond a value:
    /// `car.speed<"1 km/h"`, `car.distance>100`
    #[arg(long, value_name = "COMPONENT.VARIABLE<VALUE")]
    until: Option<String>,
    /// Communication step [s] [default: the file's]
    #[arg(long, value_name = "H", allow_negative_numbers = true)]
    step: Option<f64>,
    /// Step the components one after the other in this order, later ones with the new outputs of earlier
    /// ones; `none` for side by side [default: the file's, or none]
    #[arg(long, value_name = "A,B,...", value_delimiter = ',')]
    order: Option<Vec<String>>,
    /// Repeat each interval from saved states, at most so often, until the exchanged values agree
    #[arg(long, value_name = "N")]
    iterate: Option<usize>,
    /// Halve an interval from saved states, at most so often, when a component refuses it
    #[arg(long, value_name = "N")]
    halvings: Option<u32>,
    /// Record every Nth communication point
    #[arg(long, value_name = "N")]
    record_every: Option<usize>,
    /// Value of a parameter, or of an unconnected input for the whole run; with a unit it is converted
    #[arg(long = "set", value_name = "COMPONENT.VARIABLE=VALUE")]
    set: Vec<String>,
    /// Open the loop: the connected inputs of this component follow the recording of --replay
    #[arg(long, value_name = "COMPONENT", requires = "replay")]
    open: Vec<String>,
    /// Recording with the columns `component.variable [unit]`, such as the results of an earlier run; shown
    /// and compared beside this one
    #[arg(long, value_name = "F.csv")]
    replay: Option<PathBuf>,
    /// Find the factor on the friction with which the wheels of the opened component turn as the recorded ones, and run with it. Its inputs are
    /// those called `friction_factor`, or these
    #[arg(long, value_name = "COMPONENT.VARIABLE,...", requires = "open", num_args = 0.., value_delimiter = ',')]
    match_friction: Option<Vec<String>>,
    /// Recording in the place of the one that the system's `[[inputs]]` names: the measured pressure of another stop
    #[arg(long, value_name = "F.csv")]
    inputs: Option<PathBuf>,
    #[command(flatten)]
    map: Mapped,
    #[command(flatten)]
    compared: Compared,
}

pub fn run(args: &Args) -> Result<()> {
    let recorded = args.inputs.is_some() || args.replay.is_some() || args.compared.read().next().is_some();
    args.map.needs(recorded, "--inputs, --replay or --repeat")?;
    let mut file = read_system(&args.system)?;
    let plan = &mut file.plan;
    if let Some(inputs) = &args.inputs {
        drive_with(plan, inputs, args.map.columns()?)?;
    }
    let mut files = plan.files();
    files.push(&args.system);
    files.extend(args.replay.as_deref().into_iter().chain(args.map.file()));
    files.extend(args.compared.read());
    let outputs: Vec<&Path> =
        std::iter::once(&args.output).chain(&args.report).map(PathBuf::as_path).collect();
    check_outputs(&outputs, &files)?;
    if let Some(order) = &args.order {
        plan.order = (order != &["none"]).then(|| order.clone());
    }
    plan.iterate = args.iterate.unwrap_or(plan.iterate);
    plan.halvings = args.halvings.unwrap_or(plan.halvings);
    let replay = args.replay.as_deref().map(|file| args.map.recording(file)).transpose()?;
    let conditions = args.compared.conditions(&args.map)?;
    let fresh = || opened(plan, args, replay.as_ref());
    let (mut system, opened) = fresh()?;
    let experiment = plan.experiment(&system, args.start, args.stop, args.step)?;
    let experiment = Experiment {
        record_every: args.record_every.unwrap_or(experiment.record_every),
        all: args.all,
        ..experiment
    };
    let mut found = Vec::new();
    if let (Some(names), Some(replay)) = (&args.match_friction, &replay) {
        let level = match_friction(|| Ok(fresh()?.0), &mut system, &experiment, replay, (&args.open, names))?;
        found = told(&level);
    }
    let condition = args.until.as_deref();
    let until = condition.map(|u| until(&system, u).map_err(|e| e.at(format!("--until {u}")))).transpose()?;
    let outcome = run_with_progress(&mut system, &experiment, until, &args.system)?;
    let mut warnings = system.warnings().to_vec();
    warnings.extend(energy_warnings(&system, experiment.step));
    for warning in &warnings {
        warn(warning);
    }
    write_recording(&args.output, &outcome.recording)?;
    if let Some(report) = &args.report {
        let mut facts = facts(&system, &experiment, &outcome, &opened, &warnings);
        facts.extend(found.iter().map(|line| ("Friction".into(), line.clone())));
        let measured = replay.as_ref().map(|r| comparable(r, &outcome.recording, &opened));
        let measured = measured.filter(|r| !r.channels.is_empty());
        let (simulated, measured) = sides(&outcome.recording, measured, &conditions)?;
        let title = name_of(&args.system);
        let names = system.components().iter().flat_map(|component| {
            let variables = component.interface().variables.iter();
            variables.filter_map(|v| Some((format!("{}.{}", component.name, v.name), v.items()?)))
        });
        let page = simulation_report(
            &title,
            "A co-simulated system. An input is what the component had until the communication point.",
            &simulated,
            &names.collect(),
            measured.as_ref().map(|measured| Beside { measured, conditions: &conditions }),
            &[],
            &facts,
        );
        write_html(report, &page)?;
    }
    for line in found.iter().chain(&summary(&system, &outcome)) {
        print(line)?;
    }
    if let (Some(condition), Some(end)) = (condition, outcome.recording.time.last())
        && outcome.stopped.is_none()
    {
        let what = if outcome.met { "ended" } else { "not met until the stop time" };
        print(&format!("{condition}: {what}, {end} s"))?;
    }
    let samples = outcome.recording.time.len();
    match outcome.stopped {
        None => print(&format!("{}: {samples} samples", args.output.display())),
        Some(error) => Err(Error::numeric(format!(
            "stopped at {error}; {} has the {samples} samples before that",
            args.output.display()
        ))),
    }
}

/// What a page calls a system: its file's name, or that of the folder where all systems have the same.
fn name_of(file: &Path) -> String {
    const OF_ALL: [&str; 2] = ["system", "SystemStructure"];
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let whole = std::path::absolute(file).unwrap_or_default();
    let folder = whole.parent().and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
    if OF_ALL.contains(&&*stem) { folder.unwrap_or_else(|| stem.into_owned()) } else { stem.into_owned() }
}

/// Lets the system's only recorded inputs follow another file.
fn drive_with(plan: &mut Plan, file: &Path, columns: Columns) -> Result<()> {
    match &mut plan.inputs[..] {
        [inputs] => {
            inputs.file = file.to_owned();
            inputs.columns = columns;
            Ok(())
        }
        all => Err(Error::call(format!(
            "--inputs stands for the file of the system's [[inputs]], of which {} has {}",
            plan.source,
            all.len()
        ))),
    }
}

/// The system with the values of the command line and what is to be opened of it, and the names of the inputs that follow the recording.
fn opened(plan: &Plan, args: &Args, replay: Option<&Recording>) -> Result<(System, Vec<String>)> {
    let mut system = plan.load()?;
    for assignment in &args.set {
        set(&mut system, assignment).map_err(|e| e.at(format!("--set {assignment}")))?;
    }
    let mut names = Vec::new();
    if let Some(replay) = replay {
        for name in &args.open {
            let component = system.component(name).map_err(|e| e.at("--open"))?;
            names.extend(system.open(component, replay)?);
        }
    }
    Ok((system, names))
}

/// Finds the level of the friction and gives it to the system.
fn match_friction(
    fresh: impl Fn() -> Result<System>,
    system: &mut System,
    experiment: &Experiment,
    replay: &Recording,
    (open, names): (&[String], &[String]),
) -> Result<FrictionLevel> {
    let at = |e: Error| e.at("--match-friction");
    let components = open.iter().map(|name| system.component(name)).collect::<Result<Vec<_>>>()?;
    let inputs = match names {
        [] => friction_inputs(system, &components),
        names => names.iter().map(|name| port(system, name)).collect::<Result<_>>().map_err(at)?,
    };
    let level = friction_level(fresh, experiment, replay, &components, &inputs).map_err(at)?;
    for input in inputs {
        system.set(input, &Value::Real(level.level))?;
    }
    Ok(level)
}

/// What was found of the friction, a line for the level and one for each wheel.
fn told(found: &FrictionLevel) -> Vec<String> {
    let level = format!(
        "level of the friction {:.3}, the best of {} between {:.2} and {:.2}",
        found.level,
        found.tried.len(),
        found.tried.first().map_or(0.0, |tried| tried.level),
        found.tried.last().map_or(0.0, |tried| tried.level)
    );
    let wheel = |wheel: &WheelMatch| {
        let [simulated, recorded] = wheel.locked;
        format!(
            "{}: off by {:.3} rad/s (rms), locked for {simulated:.3} s, recorded {recorded:.3} s",
            wheel.name, wheel.error
        )
    };
    std::iter::once(level).chain(found.wheels.iter().map(wheel)).collect()
}

/// A variable as a user names it.
fn port(system: &System, name: &str) -> Result<Port> {
    let PortName { component, variable } = name.trim().parse().map_err(Error::variable)?;
    system.port(&component, &variable)
}

fn set(system: &mut System, assignment: &str) -> Result<()> {
    let Some((name, value)) = assignment.split_once('=') else {
        return Err(Error::variable("the form is COMPONENT.VARIABLE=VALUE"));
    };
    let port = port(system, name)?;
    let value = Value::from_text(system.info(port), value.trim())?;
    let value = profile_value(&system.info(port).name, value, Path::new(""))?;
    system.set(port, &value)
}

/// A condition as a user writes it.
fn until(system: &System, condition: &str) -> Result<Until> {
    let Some(sign) = condition.find(['<', '>']) else {
        return Err(Error::variable("the form is COMPONENT.VARIABLE<VALUE or COMPONENT.VARIABLE>VALUE"));
    };
    let (name, value) = (condition[..sign].trim(), condition[sign + 1..].trim());
    let port = port(system, name)?;
    let info = system.info(port);
    let value = match Value::from_text(info, value)? {
        Value::Real(value) => value,
        Value::Integer(value) => f64::from(value),
        Value::Boolean(value) => f64::from(u8::from(value)),
        Value::Text(_) => {
            let what = if info.kind == Kind::Text { "a text has no order" } else { "give the item's number" };
            return Err(Error::variable(what));
        }
    };
    if !value.is_finite() {
        return Err(Error::variable("a finite number is needed"));
    }
    Ok(Until { port, above: condition[sign..].starts_with('>'), value })
}

fn run_with_progress(
    system: &mut System,
    experiment: &Experiment,
    until: Option<Until>,
    path: &Path,
) -> Result<Outcome> {
    let bar = Bar::of_steps(experiment.schedule()?.steps as u64, &path.display().to_string());
    cosimulate_until(system, experiment, until, |k| bar.set(k as u64))
}

/// What a recording and this run have in common, without the inputs that follow the recording.
fn comparable(replay: &Recording, run: &Recording, opened: &[String]) -> Recording {
    let mut common = replay.clone();
    common.channels.retain(|c| run.has(&c.name) && !opened.contains(&c.name));
    common
}

fn facts(
    system: &System,
    experiment: &Experiment,
    outcome: &Outcome,
    opened: &[String],
    warnings: &[String],
) -> Vec<(String, String)> {
    let names = |order: &[usize]| -> String {
        order.iter().map(|c| system.components()[*c].name.as_str()).collect::<Vec<_>>().join(", ")
    };
    let mut facts: Vec<(String, String)> =
        system.components().iter().map(|c| (format!("Component {}", c.name), c.about.clone())).collect();
    let mut fact = |name: &str, value: String| facts.push((name.into(), value));
    fact("Time", format!("{} s to {} s", experiment.start, experiment.stop));
    fact("Communication step", format!("{} ms", experiment.step * 1e3));
    fact(
        "Order",
        match &system.coupling.order {
            Some(order) => format!("one after the other: {}", names(order)),
            None => "side by side, each with the others' outputs at the beginning of the interval".into(),
        },
    );
    if system.coupling.iterate > 0 {
        fact("Iteration", format!("each interval repeated at most {} times", system.coupling.iterate));
    }
    if !opened.is_empty() {
        fact("Opened, from the recording", opened.join(", "));
    }
    for line in summary(system, outcome) {
        fact("Coupling", line);
    }
    for warning in warnings {
        fact("Warning", warning.clone());
    }
    facts
}

/// What the coupling did.
fn summary(system: &System, outcome: &Outcome) -> Vec<String> {
    let mut lines: Vec<String> = system
        .bonds()
        .iter()
        .map(|bond| {
            format!(
                "{} and {}: the coupling made {:.3e} J of {:.3e} J passed on ({:.2} %)",
                bond.name.0,
                bond.name.1,
                bond.generated,
                bond.exchanged,
                100.0 * bond.share()
            )
        })
        .collect();
    if outcome.halved > 0 {
        lines.push(format!("{} intervals were halved because a component refused them", outcome.halved));
    }
    if outcome.unconverged > 0 {
        lines.push(format!(
            "{} intervals were repeated as often as allowed and did not converge",
            outcome.unconverged
        ));
    }
    lines
}
