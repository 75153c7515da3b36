//! The command line: one file per subcommand.

mod causes;
mod characterize;
mod check;
mod compared;
mod completions;
mod console;
mod convert;
mod cosimulate;
mod demo;
mod describe;
mod diagnose;
mod digits;
mod export;
mod freeze;
mod given;
mod identify;
mod lint;
mod loads;
mod man;
mod manoeuvre;
mod mapped;
mod models;
mod pad_friction;
mod plan;
mod planned;
mod rig_program;
mod simulate;
mod solid_tire;
mod tire;

use clap::{ColorChoice, Parser, Subcommand, ValueEnum};
use console::{note, warn};
use latsch::temporary::{before_the_end, clean_up_on_signals};
use latsch::{Error, ErrorKind, Result, printable, printable_json};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Physical tire and rig models as FMI 2.0 co-simulation units
///
/// Exit codes: 0 done, 1 the answer is no (a model left its validity, an FMU breaks a rule), 2 the call or a file is wrong.
#[derive(Parser)]
#[command(name = "latsch", version, propagate_version = true)]
struct Cli {
    /// Say nothing beside results but errors: no notes, warnings and progress
    #[arg(long, short, global = true, help_heading = "Global options")]
    quiet: bool,
    /// When messages are colored; auto is on a terminal that shows colors, unless NO_COLOR is set
    #[arg(long, value_name = "WHEN", default_value_t = ColorChoice::Auto, global = true, help_heading = "Global options")]
    color: ColorChoice,
    /// How progress is shown
    #[arg(long, value_name = "HOW", default_value = "auto", global = true, help_heading = "Global options")]
    progress: console::Progress,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Models(models::Args),
    Describe(describe::Args),
    Export(export::Args),
    Simulate(simulate::Args),
    Cosimulate(cosimulate::Args),
    Lint(lint::Args),
    Freeze(freeze::Args),
    Manoeuvre(manoeuvre::Args),
    Check(check::Args),
    Tire(tire::Args),
    Convert(convert::Args),
    Identify(identify::Args),
    Characterize(characterize::Args),
    SolidTire(solid_tire::Args),
    Plan(plan::Args),
    RigProgram(rig_program::Args),
    Loads(loads::Args),
    PadFriction(pad_friction::Args),
    Diagnose(diagnose::Args),
    Demo(demo::Args),
    Completions(completions::Args),
    Man(man::Args),
}

/// How results are printed.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For people
    Text,
    /// For programs
    Json,
}

/// Reads the arguments, runs the subcommand and gives the exit code.
pub fn run() -> ExitCode {
    let done = |()| ExitCode::SUCCESS;
    let Cli { command, quiet, color, progress } = Cli::parse();
    console::set(quiet, color, progress);
    // a child of `check` runs foreign code and has nothing of its own to remove
    if !matches!(&command, Command::Check(args) if args.is_child())
        && let Err(e) = clean_up_on_signals()
    {
        warn(&format!("Ctrl-C will leave temporary folders behind: {e}"));
    }
    let result = match command {
        Command::Models(args) => models::run(&args).map(done),
        Command::Describe(args) => describe::run(&args).map(done),
        Command::Export(args) => export::run(&args).map(done),
        Command::Simulate(args) => simulate::run(&args).map(done),
        Command::Cosimulate(args) => cosimulate::run(&args).map(done),
        Command::Lint(args) => lint::run(&args),
        Command::Freeze(args) => freeze::run(&args),
        Command::Manoeuvre(args) => manoeuvre::run(&args).map(done),
        Command::Check(args) => check::run(&args),
        Command::Tire(args) => tire::run(&args).map(done),
        Command::Convert(args) => convert::run(&args).map(done),
        Command::Identify(args) => identify::run(&args).map(done),
        Command::Characterize(args) => characterize::run(&args).map(done),
        Command::SolidTire(args) => solid_tire::run(&args).map(done),
        Command::Plan(args) => plan::run(&args),
        Command::RigProgram(args) => rig_program::run(&args).map(done),
        Command::Loads(args) => loads::run(&args).map(done),
        Command::PadFriction(args) => pad_friction::run(&args).map(done),
        Command::Diagnose(args) => diagnose::run(&args).map(done),
        Command::Demo(args) => demo::run(&args).map(done),
        Command::Completions(args) => completions::run(&args).map(done),
        Command::Man(args) => man::run(&args).map(done),
    };
    // an error that comes from being ended is not told
    before_the_end(|| match result {
        Ok(code) => code,
        Err(error) => {
            console::error(&error);
            ExitCode::from(if error.kind() == ErrorKind::Numeric { 1 } else { 2 })
        }
    })
}

/// Prints lines to standard output, with nothing in them that a terminal obeys. A reader that has gone away (`latsch models | head -1`) is no
/// reason for a message.
fn print(text: &str) -> Result<()> {
    use std::io::{ErrorKind, Write};
    match writeln!(std::io::stdout(), "{}", printable(text)) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            Err(Error::file(format!("standard output cannot be written: {e}")))
        }
        _ => Ok(()),
    }
}

/// Prints a value as JSON.
fn print_json(value: &serde_json::Value) -> Result<()> {
    print_json_text(&serde_json::to_string_pretty(value).unwrap_or_default())
}

/// Prints JSON.
fn print_json_text(json: &str) -> Result<()> {
    print(&printable_json(json))
}

/// Checks before a long run that its results can be written: the folders are there, and no result
/// overwrites what is read or another result.
fn check_outputs(outputs: &[&Path], read: &[&Path]) -> Result<()> {
    for (i, output) in outputs.iter().enumerate() {
        if let Some(folder) = output.parent().filter(|f| !f.as_os_str().is_empty())
            && !folder.is_dir()
        {
            return Err(Error::file(format!(
                "{} cannot be written: there is no folder {}",
                output.display(),
                folder.display()
            )));
        }
        let same = |other: &&&Path| match (output.canonicalize(), other.canonicalize()) {
            (Ok(a), Ok(b)) => a == b && a.is_file(),
            _ => output == *other,
        };
        if let Some(other) = read.iter().chain(&outputs[..i]).find(same) {
            return Err(Error::file(format!(
                "writing {} would overwrite {}",
                output.display(),
                other.display()
            )));
        }
    }
    Ok(())
}

/// The two numbers of an argument of the form FROM:TO \[s\].
///
/// # Errors
/// Another form, or an end before the beginning.
fn span(argument: &str, text: &str) -> Result<[f64; 2]> {
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|t| t.is_finite());
    text.split_once(':')
        .and_then(|(from, to)| Some([number(from)?, number(to)?]))
        .filter(|[from, to]| from < to)
        .ok_or_else(|| {
            Error::call(format!("{argument} {text}: the form is FROM:TO in s, with FROM before TO"))
        })
}

/// The files of a folder with some endings, in the order of their names.
///
/// # Errors
/// A folder that cannot be read, or without any.
fn files_in(folder: &Path, endings: &[&str]) -> Result<Vec<PathBuf>> {
    let entries = std::fs::read_dir(folder)
        .map_err(|e| Error::file(format!("{} cannot be read: {e}", folder.display())))?;
    let is_one = |file: &PathBuf| {
        file.extension().is_some_and(|own| endings.iter().any(|ending| own.eq_ignore_ascii_case(ending)))
    };
    let mut files: Vec<PathBuf> =
        entries.filter_map(|entry| Some(entry.ok()?.path())).filter(is_one).collect();
    files.sort();
    if files.is_empty() {
        return Err(Error::file(format!(
            "{} has no recordings: files are needed that end in .{}",
            folder.display(),
            endings.join(", .")
        )));
    }
    Ok(files)
}
