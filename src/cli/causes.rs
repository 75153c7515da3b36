//! `latsch diagnose` of a wired vehicle from recordings that repeat each other.

use super::console::Bar;
use super::diagnose::Args;
use super::{Format, print, print_json};
use latsch::causes::{Change, PartFindings, closed_loops, correct, find, read_runs};
use latsch::cosimulate::read_system;
use latsch::model::Value;
use latsch::report::{causes_report, write_html};
use latsch::{Error, Result, write_file};
use serde_json::json;
use std::path::Path;

pub fn run(args: &Args) -> Result<()> {
    for (given, name) in [
        (args.parameters.is_some(), "--parameters"),
        (args.map.is_some(), "--map"),
        (args.step.is_some(), "--step"),
    ] {
        if given {
            return Err(Error::call(format!(
                "{name} is for recordings without [repeats]; of a wired system the file says all of that"
            )));
        }
    }
    let file = read_system(Path::new(&args.model))?;
    let runs = read_runs(&args.recordings)?;
    std::fs::create_dir_all(&args.output)
        .map_err(|e| Error::file(format!("{} cannot be made: {e}", args.output.display())))?;
    let spinner = Bar::spinner();
    let findings = find(&file.plan, &runs, args.jobs, &mut |what| spinner.set_what(what))?;
    drop(spinner);
    let mut plan = file.plan.clone();
    for change in findings.iter().flat_map(|part| &part.found).flat_map(|found| &found.changes) {
        if change.name.contains('.') {
            correct(&mut plan, &change.name, change.value.clone())?;
        }
    }
    let absolute =
        |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned()).display().to_string();
    write_file(&args.output.join("corrected.toml"), plan.to_toml(&absolute).as_bytes())?;
    let closed = closed_loops(&file.plan, &plan, &runs)?;
    let summary = summary(&findings);
    let page = causes_report(&format!("Diagnosis of {}", args.model), &summary, &findings, &closed);
    write_html(&args.output.join("report.html"), &page)?;
    let verdict = if findings.iter().all(|part| part.found.is_empty() && part.of_roads.is_empty()) {
        "nothing"
    } else {
        "causes"
    };
    let answer = json!({ "verdict": verdict, "summary": summary, "parts": findings, "closed_loop": closed });
    let whole = serde_json::to_string_pretty(&answer).map_err(|e| Error::file(e.to_string()))?;
    write_file(&args.output.join("diagnosis.json"), whole.as_bytes())?;
    match args.format {
        Format::Json => print_json(&answer),
        Format::Text => {
            findings.iter().flat_map(lines).try_for_each(|line| print(&line))?;
            for group in &closed {
                print(&format!(
                    "closed loop beside {} runs {}: {} of {} quantities of forces are outside of what a further run would be in, {} with what was found",
                    group.runs, group.group, group.outside[0], group.quantities, group.outside[1]
                ))?;
            }
            print(&args.output.join("report.html").display().to_string())
        }
    }
}

/// A sentence.
fn summary(findings: &[PartFindings]) -> String {
    let everywhere = findings.iter().flat_map(|part| &part.found).map(|found| found.title.to_owned());
    let roads = findings.iter().flat_map(|part| &part.of_roads);
    let titles: Vec<String> =
        everywhere.chain(roads.map(|road| format!("{} in {}", road.title, road.group))).collect();
    match titles[..] {
        [] => {
            "No part does anything that its recorded inputs and the scatter of repeats do not explain.".into()
        }
        _ => format!("Recordings and system differ by: {}.", titles.join("; ")),
    }
}

fn lines(part: &PartFindings) -> Vec<String> {
    let mut lines = vec![part.part.clone()];
    for found in &part.found {
        lines.push(format!(
            "  {}: explains {:.0} % of the runs to fit and {:.0} % of those to check (by chance {:.1e})",
            found.title,
            100.0 * found.explains[0],
            100.0 * found.explains[1],
            found.chance
        ));
        lines.extend(changes(&found.changes));
        for other in &found.alternatives {
            lines.push(format!("    or {}: {:.0} %", other.title, 100.0 * other.explains));
        }
    }
    for road in &part.of_roads {
        lines.push(format!(
            "  in {} only, {}: explains {:.0} % of these runs (by chance {:.1e}); say it under [set] of their runs",
            road.group,
            road.title,
            100.0 * road.explains,
            road.chance
        ));
        lines.extend(changes(&road.changes));
    }
    if part.found.is_empty() && part.of_roads.is_empty() {
        lines.push("  nothing beyond the scatter of repeats".into());
    }
    if let Some(best) = part.left.first() {
        lines.push(format!(
            "  not named: {}, which by itself explains {:.1} % of what there was to explain",
            best.title,
            100.0 * best.explains
        ));
    }
    for hidden in &part.hidden {
        lines
            .push(format!("  these recordings do not show {}; what does: {}", hidden.title, hidden.shown_by));
    }
    lines
}

fn changes(changes: &[Change]) -> Vec<String> {
    let text = |value: &Value| match value {
        Value::Real(v) => format!("{v:.5}"),
        Value::Integer(v) => v.to_string(),
        Value::Boolean(v) => v.to_string(),
        Value::Text(text) => format!("{text:?}"),
    };
    changes
        .iter()
        .map(|change| format!("    {}: {} -> {}", change.name, text(&change.before), text(&change.value)))
        .collect()
}
