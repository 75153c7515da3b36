//! `latsch freeze`: what a system is made of, and what of that has changed.

use super::{Format, check_outputs, print, print_json};
use latsch::cosimulate::read_system;
use latsch::freeze::{Difference, differences, freeze, read_manifest};
use latsch::{Result, write_file};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// List what a wired system is made of, or say what has changed since it was listed
///
/// Writes which models and FMUs there are, all values, connections and times, and the SHA-256 of all files, or compares with what was written.
/// The same system gives the same file, wherever it lies. Loads the FMUs, which runs their code. Exit code 1 if something differs.
#[derive(clap::Args)]
#[command(group(clap::ArgGroup::new("what").required(true).args(["output", "against"])))]
pub struct Args {
    /// The system: TOML, an SSP System Structure Description (.ssd) beside its FMUs, or an SSP archive (.ssp)
    #[arg(value_name = "F.toml|F.ssd|F.ssp")]
    system: PathBuf,
    /// Manifest to write
    #[arg(long, short, value_name = "MANIFEST.toml")]
    output: Option<PathBuf>,
    /// Manifest of an earlier time to compare with
    #[arg(long, value_name = "MANIFEST.toml", conflicts_with = "output")]
    against: Option<PathBuf>,
    /// How the differences are printed
    #[arg(long, value_enum, default_value_t = Format::Text, requires = "against")]
    format: Format,
}

pub fn run(args: &Args) -> Result<ExitCode> {
    if let Some(output) = &args.output {
        let file = read_system(&args.system)?;
        let read: Vec<&Path> = file.plan.files().into_iter().chain([args.system.as_path()]).collect();
        check_outputs(&[output], &read)?;
    }
    let was = args.against.as_deref().map(read_manifest).transpose()?;
    let is = freeze(&args.system)?;
    if let Some(output) = &args.output {
        write_file(output, is.to_toml()?.as_bytes())?;
        let values: usize = is.component.values().map(|part| part.values.len()).sum();
        print(&format!(
            "{}: {} components, {values} values, {} connections",
            output.display(),
            is.component.len(),
            is.connection.len()
        ))?;
    }
    let Some(was) = was else { return Ok(ExitCode::SUCCESS) };
    let found = differences(&was, &is);
    match args.format {
        Format::Json => print_json(&json!({ "system": args.system, "differences": found }))?,
        Format::Text => {
            found.iter().map(line).try_for_each(|line| print(&line))?;
            print(&format!("{}: {} differences", args.system.display(), found.len()))?;
        }
    }
    Ok(ExitCode::from(u8::from(!found.is_empty())))
}

fn line(found: &Difference) -> String {
    format!("{}: {} -> {}", found.what, found.was, found.is)
}
