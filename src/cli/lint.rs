//! `latsch lint`: what is odd about a system before anyone believes its results.

use super::{Format, print, print_json};
use latsch::Result;
use latsch::cosimulate::read_system;
use latsch::lint::{Judgement, Remark, lint, read_measured};
use serde_json::json;
use std::path::PathBuf;
use std::process::ExitCode;

/// Look for what is odd about a wired system before its results are believed
///
/// Runs it once and looks at inputs that nothing drives, radii that a controller believes, pads that grip at once, friction and deceleration that no
/// car has, communication steps too long for a stiffness, and measured values. Exit code 1 if something should be looked at.
#[derive(clap::Args)]
pub struct Args {
    /// The system: TOML, an SSP System Structure Description (.ssd) beside its FMUs, or an SSP archive (.ssp)
    #[arg(value_name = "F.toml|F.ssd|F.ssp")]
    system: PathBuf,
    /// What was measured on the standing machine: TOML with a table [measured] of "component.variable" = "3350 N"
    #[arg(long, value_name = "F.toml")]
    measured: Option<PathBuf>,
    /// Stop time [s] [default: the file's]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    stop: Option<f64>,
    /// Communication step [s] [default: the file's]
    #[arg(long, value_name = "H", allow_negative_numbers = true)]
    step: Option<f64>,
    /// How the remarks are printed
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

pub fn run(args: &Args) -> Result<ExitCode> {
    let plan = read_system(&args.system)?;
    let plan = &plan.plan;
    let measured = args.measured.as_deref().map(read_measured).transpose()?.unwrap_or_default();
    let experiment = plan.experiment(&plan.load()?, None, args.stop, args.step)?;
    let remarks = lint(|| plan.load(), &experiment, &measured)?;
    let doubtful = remarks.iter().filter(|remark| remark.judgement == Judgement::Doubtful).count();
    match args.format {
        Format::Json => print_json(&json!({ "system": plan.source, "remarks": remarks }))?,
        Format::Text => {
            remarks.iter().map(line).try_for_each(|line| print(&line))?;
            let open = remarks.iter().filter(|remark| remark.judgement == Judgement::Open).count();
            print(&format!(
                "{}: {} remarks, {doubtful} to look at, {open} not checked",
                args.system.display(),
                remarks.len()
            ))?;
        }
    }
    Ok(ExitCode::from(u8::from(doubtful > 0)))
}

fn line(remark: &Remark) -> String {
    let judgement = match remark.judgement {
        Judgement::Fine => "fine",
        Judgement::Open => "not checked",
        Judgement::Doubtful => "LOOK",
    };
    format!("{judgement:11}  {}: {}", remark.topic, remark.text)
}
