//! `latsch loads`: a simulation beside recordings of the same run, by what matters for damage.

use super::digits::digits;
use super::mapped::Mapped;
use super::{check_outputs, print, warn};
use latsch::loads::{Band, Conditions, Event, compare, counts, matrices, quantities};
use latsch::recording::read_recording;
use latsch::report::{loads_report, write_html};
use latsch::{Error, Result, write_file};
use std::path::{Path, PathBuf};

/// Compare simulated loads with one or several recordings of the same run
///
/// Extremes, rainflow cycles, level crossings and damage of each channel, simulated and recorded, counted alike. With several
/// recordings it says where the simulation is outside of what a further recording would be in with 95 %. RMS errors mix size and timing; damage knows no timing.
#[derive(clap::Args)]
pub struct Args {
    /// Results of a simulation
    #[arg(value_name = "RESULTS.csv")]
    results: PathBuf,
    /// A recording of the same run. Can be given several times: repeats say how far runs differ by themselves
    #[arg(long, value_name = "F.csv", required = true)]
    recording: Vec<PathBuf>,
    #[command(flatten)]
    map: Mapped,
    /// A channel, and what the recordings call it if that is something else. Can be given several times [default: all that are in every file]
    #[arg(long, value_name = "NAME[=RECORDED]")]
    channel: Vec<String>,
    /// What happens in every run at the time that is made 0: the first sample with "brake.pressure>5 bar"
    #[arg(long, value_name = "CHANNEL>VALUE")]
    event: Option<String>,
    /// From when to when [s], from the event on if there is one
    #[arg(long, value_name = "FROM:TO", allow_hyphen_values = true)]
    window: Option<String>,
    /// Take errors over this channel instead of time: a distance, where runs are not equally fast
    #[arg(long, value_name = "CHANNEL")]
    over: Option<String>,
    /// Slope of the S-N line: damage is the sum of range to this power
    #[arg(long, value_name = "K", default_value_t = 5.0)]
    slope: f64,
    /// Movements below this share of the recorded span are no cycles
    #[arg(long, value_name = "SHARE", default_value_t = 0.05)]
    gate: f64,
    /// Classes of levels and ranges over the recorded span
    #[arg(long, value_name = "N", default_value_t = 64)]
    classes: usize,
    /// Page to write
    #[arg(long, value_name = "F.html")]
    report: Option<PathBuf>,
    /// Table of the quantities to write
    #[arg(long, value_name = "F.csv")]
    table: Option<PathBuf>,
    /// Table of the classes to write: level crossings and range pairs
    #[arg(long, value_name = "F.csv")]
    counts: Option<PathBuf>,
    /// From-to matrices of the cycles to write: a row for each cell of each channel and run that has cycles
    #[arg(long, value_name = "F.csv")]
    matrix: Option<PathBuf>,
}

/// More would be a plot of nothing but classes.
const MOST_CLASSES: usize = 1024;

pub fn run(args: &Args) -> Result<()> {
    let written: Vec<&Path> = [&args.report, &args.table, &args.counts, &args.matrix]
        .into_iter()
        .flatten()
        .map(PathBuf::as_path)
        .collect();
    let read: Vec<&Path> = std::iter::once(&args.results)
        .chain(&args.recording)
        .map(PathBuf::as_path)
        .chain(args.map.file())
        .collect();
    check_outputs(&written, &read)?;
    let conditions = conditions(args)?;
    let simulated = read_recording(&args.results)?;
    let recorded = args.map.recordings(&args.recording)?;
    let (all, level) = compare(&simulated, &recorded, &conditions)?;
    for name in &level {
        warn(&format!("{name} does not vary in the recordings and is left out"));
    }
    if all.is_empty() {
        return Err(Error::file("nothing is compared: the recorded channels do not vary"));
    }
    for one in &all {
        print(&format!("{} [{}]", one.name, one.unit))?;
        for (name, band) in one.bands() {
            print(&format!("  {name:14}  {}", line(&band, recorded.len())))?;
        }
    }
    if let Some(file) = &args.table {
        write_file(file, quantities(&all, recorded.len())?.as_bytes())?;
    }
    if let Some(file) = &args.counts {
        write_file(file, counts(&all, recorded.len())?.as_bytes())?;
    }
    if let Some(file) = &args.matrix {
        write_file(file, matrices(&all)?.as_bytes())?;
    }
    if let Some(file) = &args.report {
        let names: Vec<String> = args.recording.iter().map(|f| f.display().to_string()).collect();
        let title = format!("Loads of {}", args.results.display());
        write_html(file, &loads_report(&title, &names, &all, &conditions))?;
    }
    Ok(())
}

fn five(value: f64) -> String {
    digits(value, 5)
}

fn line(band: &Band, runs: usize) -> String {
    let [low, high] = band.recorded.map(five);
    let simulated = five(band.simulated);
    if runs == 1 {
        return format!("{simulated:>10} simulated, {low:>10} recorded");
    }
    let judged = match (band.further, band.off()) {
        (Some(ends), Some(off)) => {
            let [from, to] = ends.map(five);
            let side = if off < 0.0 { "BELOW" } else { "ABOVE" };
            let where_ = if off.abs() <= 1.0 { "within" } else { side };
            format!("; {where_} the {from} to {to} of a further one")
        }
        _ => String::new(),
    };
    format!("{simulated:>10} simulated, {low:>10} to {high} recorded{judged}")
}

fn conditions(args: &Args) -> Result<Conditions> {
    if !(args.slope > 0.0 && args.slope.is_finite()) {
        return Err(Error::call(
            "--slope is a power above 0: 5 for welds and links, 3 to 10 as materials have it",
        ));
    }
    if !(0.0..1.0).contains(&args.gate) {
        return Err(Error::call("--gate is a share from 0 to below 1: 0.05 for 5 %"));
    }
    if !(2..=MOST_CLASSES).contains(&args.classes) {
        return Err(Error::call(format!("--classes is a number from 2 to {MOST_CLASSES}")));
    }
    let channel = |text: &String| match text.split_once('=') {
        Some((own, theirs)) => [own.trim(), theirs.trim()].map(str::to_owned),
        None => [text.trim(), text.trim()].map(str::to_owned),
    };
    Ok(Conditions {
        channels: args.channel.iter().map(channel).collect(),
        slope: args.slope,
        gate: args.gate,
        classes: args.classes,
        event: args.event.as_deref().map(Event::parse).transpose().map_err(|e| e.at("--event"))?,
        window: args.window.as_deref().map(|w| super::span("--window", w)).transpose()?,
        over: args.over.clone(),
    })
}
