//! `latsch identify`: sequential identification.

use super::console::Bar;
use super::digits::short;
use super::mapped::Mapped;
use super::planned::{numbers, plan, slave};
use super::{Format, check_outputs, files_in, print, print_json};
use clap::ValueEnum;
use latsch::identify::benchmark::{Benchmark, kaden};
use latsch::identify::recorded::{Answer, Beforehand, Light, Unmet, identify};
use latsch::identify::{Plan, Stand, ring_brush};
use latsch::model::Interface;
use latsch::recording::recording_endings;
use latsch::report::{identification_report, write_html};
use latsch::{Error, Result, with_unit};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Identify parameters group after group, each group from readings that have one answer
///
/// From recordings of a rig, or for the target values of a published benchmark. docs/identify.md has the method.
#[derive(clap::Args)]
#[command(group(clap::ArgGroup::new("what").required(true).args(["plan", "benchmark"])))]
pub struct Args {
    /// The plan, or the name of one that is shipped: ring-brush-flat-track
    #[arg(value_name = "PLAN|F.toml", requires_all = ["recordings", "output"])]
    plan: Option<String>,
    /// Folder with the recordings: CSV with the columns `time [s]` and `name [unit]`, inputs and outputs of the plan's model,
    /// TYDEX, RPC III, MDF 4, MATLAB or Parquet
    #[arg(long, value_name = "DIR", requires = "plan")]
    recordings: Option<PathBuf>,
    #[command(flatten)]
    map: Mapped,
    /// Parameters to write: TOML for `latsch export` and `latsch simulate`, with intervals, within which `latsch diagnose` then looks
    #[arg(long, short, value_name = "F.toml", requires = "plan")]
    output: Option<PathBuf>,
    /// The FMU whose parameters are looked for, in place of the plan's model
    #[arg(long, value_name = "F.fmu", requires = "plan")]
    model: Option<PathBuf>,
    /// Page to write: how well each parameter is known, and what it was read from
    #[arg(long, value_name = "F.html", requires = "plan")]
    report: Option<PathBuf>,
    /// Parameters that are known, and where the search begins: TOML with [parameters]
    #[arg(long, value_name = "F.toml", requires = "plan")]
    parameters: Option<PathBuf>,
    /// What is known of a parameter should recordings not tell it: `sidewall_radial_stiffness=0.1` for within a tenth of its value; without, it may be anywhere in its range, and intervals of others count that
    #[arg(long, value_name = "NAME=SHARE", requires = "plan")]
    within: Vec<String>,
    /// Take the parameters that come nearest to what was read where none within their bounds meet it, in place of an error: of a
    /// tire that the model cannot be. What is missed is told, and widens the intervals
    #[arg(long, requires = "plan")]
    nearest: bool,
    /// A published benchmark: parameters are found from its target values, exact, rounded as printed, and as printed
    #[arg(long, value_enum, value_name = "NAME")]
    benchmark: Option<Name>,
    /// How to print
    #[arg(long, value_enum, default_value = "text")]
    format: Format,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Name {
    /// 15 parameters of the ring-and-brush tire (Kaden 2015, section 4.2.10)
    Kaden,
}

pub fn run(args: &Args) -> Result<()> {
    let json = |e: serde_json::Error| Error::file(e.to_string());
    args.map.needs(args.recordings.is_some(), "--recordings")?;
    if let Some(Name::Kaden) = args.benchmark {
        let answer = kaden()?;
        return match args.format {
            Format::Json => print_json(&serde_json::to_value(&answer).map_err(json)?),
            Format::Text => print(&text(&answer)),
        };
    }
    let (Some(name), Some(folder), Some(output)) = (&args.plan, &args.recordings, &args.output) else {
        return Err(Error::call("a plan, --recordings and --output are needed"));
    };
    let read: Vec<&Path> = args.parameters.as_deref().into_iter().chain(args.map.file()).collect();
    let outputs: Vec<&Path> = std::iter::once(output).chain(&args.report).map(PathBuf::as_path).collect();
    check_outputs(&outputs, &read)?;
    let stated = plan(name)?;
    let stand = Stand::new(slave(&stated, args.model.as_deref())?, &[]);
    let answer = from_recordings(&stated, &stand, folder, args)?;
    if let Some(report) = &args.report {
        let interface = stand.interface();
        let unit = |name: &str| interface.index(name).and_then(|i| interface.variables[i].unit.clone());
        let page = identification_report(&stated.title, &answer, |name| unit(name).unwrap_or_default());
        write_html(report, &page)?;
    }
    let toml = parameter_file(&answer, stand.interface());
    std::fs::write(output, toml)
        .map_err(|e| Error::file(format!("{} cannot be written: {e}", output.display())))?;
    match args.format {
        Format::Json => print_json(&serde_json::to_value(&answer).map_err(json)?),
        Format::Text => print(&told(&answer, stand.interface())),
    }
}

fn from_recordings(plan: &Plan, stand: &Stand, folder: &Path, args: &Args) -> Result<Answer> {
    let values = numbers(args.parameters.as_deref(), stand.interface())?;
    let within = args.within.iter().map(|text| share(text)).collect::<Result<_>>()?;
    let beforehand = Beforehand { values, within };
    let unmet = if args.nearest { Unmet::Nearest } else { Unmet::Refused };
    let recordings = args.map.recordings(&files_in(folder, &recording_endings())?)?;
    let spinner = Bar::spinner();
    spinner.set_what("identifying");
    identify(plan, stand, ring_brush::REGISTRY, &beforehand, unmet, &recordings)
}

/// `name=0.1`
fn share(text: &str) -> Result<(String, f64)> {
    let parsed =
        text.rsplit_once('=').and_then(|(name, share)| Some((name.to_owned(), share.parse::<f64>().ok()?)));
    let is_share = |share: f64| share > 0.0 && share.is_finite();
    parsed.filter(|(_, share)| is_share(*share)).ok_or_else(|| {
        Error::call(format!(
            "--within {text}: a name and a positive share are needed, as in vertical_stiffness=0.1"
        ))
    })
}

/// How far beyond its interval (90 %) a diagnosis may move a parameter, in half intervals: what scatters normally is outside of
/// this once in a thousand times.
const BEYOND: f64 = 2.0;

/// The parameters, and what a diagnosis may move them to: what is not identified is free. Intervals end where the model's own
/// ranges do.
fn parameter_file(answer: &Answer, interface: &Interface) -> String {
    let mut text = String::from("[parameters]\n");
    let within = |name: &str, value: f64| {
        let variable = interface.index(name).map(|k| &interface.variables[k]);
        let [least, most] = [variable.and_then(|v| v.min), variable.and_then(|v| v.max)];
        value.max(least.unwrap_or(f64::NEG_INFINITY)).min(most.unwrap_or(f64::INFINITY))
    };
    let known = |name: &str| answer.parameters.iter().find(|p| p.name == name).and_then(|p| p.half_width);
    for (name, value) in &answer.values {
        let _ = match known(name) {
            Some(half) => {
                let [low, high] = [value - half, value + half].map(|end| within(name, end));
                writeln!(text, "{name} = {{ value = {value:?}, low = {low:?}, high = {high:?} }}")
            }
            None => writeln!(text, "{name} = {value:?}"),
        };
    }
    text += "\n# what `latsch diagnose` may change\n[fit]\n";
    for row in &answer.parameters {
        let _ = match row.half_width {
            Some(half) => {
                let [min, max] = [-BEYOND, BEYOND].map(|side| within(&row.name, row.value + side * half));
                writeln!(text, "{} = {{ min = {min:?}, max = {max:?} }}", row.name)
            }
            None => writeln!(text, "{} = true", row.name),
        };
    }
    text
}

fn told(answer: &Answer, interface: &Interface) -> String {
    let unit = |name: &str| {
        let index = interface.index(name);
        index.and_then(|k| interface.variables[k].unit.as_deref()).unwrap_or("1")
    };
    let mut text = String::new();
    let _ = writeln!(text, "{:44} {:>12} {:>11}  unit", "parameter", "value", "+- (90 %)");
    for row in &answer.parameters {
        let light = match row.light {
            Light::Green => "green",
            Light::Yellow => "yellow",
            Light::Red => "red",
        };
        let half = row.half_width.map_or("-".to_owned(), |half| short(half, 3));
        let (value, unit) = (short(row.value, 6), unit(&row.name));
        let _ = writeln!(text, "{:44} {value:>12} {half:>11}  {unit:10} {light}", row.name);
        if let Some(why) = &row.why {
            let _ = writeln!(text, "    {why}");
        }
    }
    let _ = writeln!(
        text,
        "\n{:44} {:>4} {:>12} {:>11} {:>12}",
        "target", "from", "measured", "+- (90 %)", "modelled"
    );
    for row in &answer.targets {
        let _ = writeln!(
            text,
            "{:44} {:>4} {:>12} {:>11} {:>12}",
            row.name,
            row.readings,
            short(row.measured, 6),
            short(row.half_width, 3),
            short(row.modelled, 6)
        );
    }
    for (name, offset) in answer.offsets.iter().chain(&answer.zeros) {
        let _ = writeln!(text, "offset of {name}: {}", with_unit(short(*offset, 4), unit(name)));
    }
    for misfit in &answer.misfits {
        let _ = writeln!(text, "contradiction: {}", misfit.words());
    }
    for note in &answer.notes {
        let _ = writeln!(text, "note: {note}");
    }
    text.trim_end().to_owned()
}

fn text(answer: &Benchmark) -> String {
    let mut text = String::new();
    let percent = |error: f64| format!("{:.2} %", 100.0 * error);
    let _ = writeln!(
        text,
        "{:29} {:>9} {:>9} {:>13} {:>9} | {:>10} {:>9} | {:>9} | {:>9}",
        "parameter", "true", "start", "identified", "error", "rounded", "at most", "printed", "published"
    );
    for row in &answer.parameters {
        let _ = writeln!(
            text,
            "{:29} {:>9} {:>9} {:>13} {:>9.1e} | {:>10} {:>9} | {:>9} | {:>9}",
            row.name,
            format!("{:.3e}", row.truth),
            format!("{:.3e}", row.start),
            format!("{:.7e}", row.identified),
            row.relative_error,
            percent(row.relative_error_rounded),
            percent(row.rounding_bound),
            percent(row.relative_error_printed),
            percent(row.published_relative_error),
        );
    }
    for why in &answer.refused {
        let _ = writeln!(text, "no answer: {why}");
    }
    let _ = write!(
        text,
        "\nidentified, error: from the exact targets. rounded: from the same targets with the digits of the print; at most: what this\nrounding can do to any method, to first order. printed: from the printed targets, which another simulator made, with bristles of\n14 mm that count as whole ones. published: the source's own error with them. {} starts of the rig.",
        answer.starts
    );
    text
}
