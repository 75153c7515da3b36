//! `latsch rig-program`: what a rig has to do for an identification.

use super::planned::{plan, slave};
use super::{check_outputs, print};
use latsch::identify::{RigLimit, RigRun};
use latsch::model::{Interface, Kind};
use latsch::recording::write_csv;
use latsch::{Error, Result, read_text};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Write the measurement programme that an identification needs
///
/// For each run the inputs over time as CSV, the rig's switches as TOML where there are any, and a table for the person at the rig.
#[derive(clap::Args)]
pub struct Args {
    /// The plan, or the name of one that is shipped: ring-brush-flat-track
    #[arg(value_name = "PLAN|F.toml")]
    plan: String,
    /// Folder to write to; it is made
    #[arg(long, short, value_name = "DIR")]
    output: PathBuf,
    /// What the rig can do: TOML with `slip_angle = { rate = 0.05, between = [-0.2, 0.2] }` and so on, in SI units, in place of the plan's limits
    #[arg(long, value_name = "F.toml")]
    limits: Option<PathBuf>,
}

pub fn run(args: &Args) -> Result<()> {
    let plan = plan(&args.plan)?;
    let slave = slave(&plan, None)?;
    let limits: BTreeMap<String, RigLimit> = match &args.limits {
        None => BTreeMap::new(),
        Some(file) => {
            toml::from_str(&read_text(file)?).map_err(|e| Error::file(e.to_string()).at(file.display()))?
        }
    };
    let runs = plan.runs(slave.interface(), &limits)?;
    std::fs::create_dir_all(&args.output)
        .map_err(|e| Error::file(format!("{} cannot be made: {e}", args.output.display())))?;
    let mut table = format!("# Measurement programme: {}\n\n", plan.title);
    table += "| run | length | what for | rig |\n|---|---|---|---|\n";
    for (number, run) in runs.iter().enumerate() {
        let stem = format!("{:02}-{}", number + 1, run.name);
        let file = args.output.join(format!("{stem}.csv"));
        check_outputs(&[&file], &[])?;
        write_csv(&file, &run.inputs)?;
        let switches = switches(run, slave.interface())?;
        if !switches.is_empty() {
            write(&args.output.join(format!("{stem}.toml")), &format!("[parameters]\n{switches}"))?;
        }
        let length = run.inputs.time.last().copied().unwrap_or(0.0);
        let _ = writeln!(table, "| {stem} | {length:.0} s | {} | {} |", run.purpose, moves(run));
    }
    write(&args.output.join("programme.md"), &table)?;
    let total: f64 = runs.iter().filter_map(|r| r.inputs.time.last()).sum();
    print(&format!("{}: {} runs, {total:.0} s", args.output.display(), runs.len()))
}

fn write(file: &Path, text: &str) -> Result<()> {
    std::fs::write(file, text).map_err(|e| Error::file(format!("{} cannot be written: {e}", file.display())))
}

/// The rig's switches as TOML lines.
fn switches(run: &RigRun, interface: &Interface) -> Result<String> {
    let mut lines = String::new();
    for (name, value) in &run.switches {
        let is_switch = interface.variables[interface.find(name)?].kind == Kind::Boolean;
        // how commands become motions is the rig's own affair
        if name == latsch::simulate::ACTUATORS {
            continue;
        }
        let _ = match is_switch {
            true => writeln!(lines, "{name} = {}", *value != 0.0),
            false => writeln!(lines, "{name} = {value}"),
        };
    }
    Ok(lines)
}

/// What each input does in a run, in words.
fn moves(run: &RigRun) -> String {
    let each = run.inputs.channels.iter().filter_map(|c| {
        let mut values = c.values.clone();
        values.sort_by(f64::total_cmp);
        values.dedup();
        let list: Vec<String> = values.iter().map(|v| format!("{v}")).collect();
        (values != [0.0]).then(|| format!("{} {} {}", c.name, list.join(", "), c.unit))
    });
    let switches = run.switches.iter().filter(|(name, _)| *name != latsch::simulate::ACTUATORS);
    switches.map(|(name, value)| format!("{name} {value}")).chain(each).collect::<Vec<_>>().join("; ")
}
