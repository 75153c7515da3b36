//! `latsch plan`: what a plan of a sequential identification relies on.

use super::planned::{numbers, plan, slave};
use super::{Format, check_outputs, print, print_json};
use latsch::identify::check::{Sampling, check};
use latsch::identify::{Readings, Stand, ring_brush, shipped_plan};
use latsch::report::{plan_report, write_html};
use latsch::{Error, Result};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Check a plan of a sequential identification, or show one that is shipped
#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand)]
enum Command {
    Check(Check),
    Show(Show),
}

/// Print a shipped plan as TOML, to be changed, or to take from it what a plan that is like it says otherwise
#[derive(clap::Args)]
struct Show {
    /// Its name: ring-brush-flat-track
    #[arg(value_name = "PLAN")]
    plan: String,
}

/// Test a plan: does each group depend on its own and earlier parameters only, and have one answer?
///
/// By samples: a counter-example is a proof, a pass is evidence. Exit code 1 if there is a counter-example.
#[derive(clap::Args)]
struct Check {
    /// The plan, or the name of one that is shipped: ring-brush-flat-track
    #[arg(value_name = "PLAN|F.toml")]
    plan: String,
    /// Another model for the same plan: an FMU, say one of a third party
    #[arg(long, value_name = "F.fmu")]
    model: Option<PathBuf>,
    /// Values of parameters that the plan does not look for: TOML with [parameters]
    #[arg(long, value_name = "F.toml")]
    parameters: Option<PathBuf>,
    /// Draws of what is held fixed
    #[arg(long, value_name = "N", default_value_t = 3)]
    constants: usize,
    /// Draws of what is looked at, for each of these
    #[arg(long, value_name = "N", default_value_t = 8)]
    draws: usize,
    /// A change of a target by a smaller share of its range is none: limits of small speeds and angles are not quite reached
    #[arg(long, value_name = "SHARE", default_value_t = 1e-6)]
    tolerance: f64,
    /// Of the random numbers
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Page to write: the influence matrix as a picture, what each group's tests say and how much that is, and which targets could come next
    #[arg(long, value_name = "F.html")]
    report: Option<PathBuf>,
    /// How to print
    #[arg(long, value_enum, default_value = "text")]
    format: Format,
}

pub fn run(args: &Args) -> Result<ExitCode> {
    let args = match &args.command {
        Command::Check(args) => args,
        Command::Show(args) => {
            print(shipped_plan(&args.plan)?.trim_end())?;
            return Ok(ExitCode::SUCCESS);
        }
    };
    let read: Vec<&Path> =
        [&args.model, &args.parameters].into_iter().flatten().map(PathBuf::as_path).collect();
    let read = [read, vec![Path::new(&args.plan)]].concat();
    check_outputs(&args.report.iter().map(PathBuf::as_path).collect::<Vec<_>>(), &read)?;
    let plan = plan(&args.plan)?;
    let stand = Stand::new(slave(&plan, args.model.as_deref())?, &[]);
    let start = numbers(args.parameters.as_deref(), stand.interface())?;
    let readings = Readings::new(&plan, &stand, ring_brush::REGISTRY, &start)?;
    let Check { constants, draws, seed, tolerance, .. } = *args;
    let sampling = Sampling { constants, draws, seed, tolerance };
    let report = check(&readings, &sampling)?;
    if let Some(file) = &args.report {
        write_html(file, &plan_report(&report))?;
    }
    if args.format == Format::Json {
        print_json(&serde_json::to_value(&report).map_err(|e| Error::file(e.to_string()))?)?;
    } else {
        print(&report.to_string())?;
    }
    Ok(ExitCode::from(u8::from(report.is_refuted())))
}
