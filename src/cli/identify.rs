//! `latsch identify`: sequential identification.

use super::{Format, print, print_json};
use clap::ValueEnum;
use latsch::identify::benchmark::{Benchmark, kaden};
use latsch::{Error, Result};
use std::fmt::Write as _;

/// Identify parameters group after group, each group from readings that have one answer
///
/// So far for target values that are known, as those of a published benchmark; docs/identify.md has the method.
#[derive(clap::Args)]
pub struct Args {
    /// A published benchmark: parameters are found from its target values, exact, rounded as printed, and as printed
    #[arg(long, value_enum, value_name = "NAME")]
    benchmark: Name,
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
    let Name::Kaden = args.benchmark;
    let answer = kaden()?;
    if args.format == Format::Json {
        return print_json(&serde_json::to_value(&answer).map_err(|e| Error::file(e.to_string()))?);
    }
    print(&text(&answer))
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
