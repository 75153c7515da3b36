//! `latsch check`: is an FMU what FMI 2.0 demands?

use super::{Format, print, print_json};
use latsch::fmi::check::{self, Level, Options, Report};
use latsch::{Error, Result};
use serde_json::json;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

/// Check any FMU for co-simulation: archive, description, and the binary in many runs
///
/// The binary's code is run, in processes of their own. Exit codes: 0 no errors, 1 errors, 2 the file
/// is no FMU of FMI 2.0.
#[derive(clap::Args)]
pub struct Args {
    /// The FMU
    fmu: PathBuf,
    /// How to print
    #[arg(long, value_enum, default_value = "text")]
    format: Format,
    /// Longest time for each check of the binary [s]
    #[arg(long, value_name = "SECONDS", default_value_t = 10.0)]
    timeout: f64,
    /// Do not run the binary
    #[arg(long)]
    no_run: bool,
    /// Run one check of an FMU that is unpacked, and end
    #[arg(long, hide = true, value_name = "CHECK", requires = "work")]
    child: Option<String>,
    /// Where the child notes what it does
    #[arg(long, hide = true, value_name = "FOLDER")]
    work: Option<PathBuf>,
}

impl Args {
    /// This process was started by another check.
    pub fn is_child(&self) -> bool {
        self.child.is_some()
    }
}

pub fn run(args: &Args) -> Result<ExitCode> {
    let timeout =
        Duration::try_from_secs_f64(args.timeout).ok().filter(|t| !t.is_zero()).ok_or_else(|| {
            Error::call(format!("--timeout {}: a positive number of seconds is needed", args.timeout))
        })?;
    if let (Some(child), Some(work)) = (&args.child, &args.work) {
        check::run_child(child, &args.fmu, work, timeout)?;
        return Ok(ExitCode::SUCCESS);
    }
    let program = if args.no_run {
        None
    } else {
        Some(
            std::env::current_exe()
                .map_err(|e| Error::file(format!("the program cannot find itself: {e}")))?,
        )
    };
    let report = check::check(&args.fmu, &Options { program, timeout })?;
    match args.format {
        Format::Text => print_text(args, &report),
        Format::Json => print_json(&json!({
            "file": args.fmu.display().to_string(),
            "errors": report.count(Level::Error),
            "warnings": report.count(Level::Warning),
            "findings": report.findings,
            "checks": report.checks,
            "platforms": report.platforms,
            "ran": report.ran,
            "notes": report.notes,
        })),
    }?;
    Ok(if report.count(Level::Error) == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn print_text(args: &Args, report: &Report) -> Result<()> {
    for finding in &report.findings {
        print(&finding.as_text())?;
    }
    for note in &report.notes {
        print(&format!("note: {note}\n"))?;
    }
    let number = |count: usize, what: &str| match count {
        0 => format!("no {what}s"),
        1 => format!("1 {what}"),
        n => format!("{n} {what}s"),
    };
    let ran = match (report.checks.len(), &report.ran) {
        (n, Some(platform)) if n > 0 => format!("{} of the binary for {platform}", number(n, "check")),
        _ if report.platforms.is_empty() => "the binary was not run: there is none".to_owned(),
        _ => format!("the binary was not run; there are binaries for {}", report.platforms.join(", ")),
    };
    print(&format!(
        "{}: {}, {}; {ran}",
        args.fmu.display(),
        number(report.count(Level::Error), "error"),
        number(report.count(Level::Warning), "warning")
    ))
}
