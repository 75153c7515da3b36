//! Runs the cases, each in a child process with a time limit, and collects what they find.

use super::finding::{Finding, Place};
use super::lab::Case;
use super::report::Report;
use super::reporter::{CALL, FRAGILE, Found, Line};
use super::system::{self, End, NOTE};
use super::tree::Node;
use crate::fmi::import::Description;
use crate::fmi::import::library::find;
use crate::temporary::{Folder, Running};
use crate::{Error, Result};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// How often a child is looked after.
const PAUSE: Duration = Duration::from_millis(2);

/// Runs those of the cases that apply. The first two tell whether the others make sense.
pub(super) fn run(
    cases: &[Case],
    program: &Path,
    timeout: Duration,
    folder: &Path,
    description: &Description,
    root: &Node,
    report: &mut Report,
) -> Result<()> {
    let work = Folder::new("latsch-check-")
        .map_err(|e| Error::file(format!("no temporary folder can be made: {e}")))?;
    let platform = find(folder, &description.model_identifier).ok().and_then(|(file, _)| {
        let platform = file.strip_prefix("binaries/")?.split_once('/')?.0;
        Some(platform.to_owned())
    });
    let others: Vec<&str> =
        report.platforms.iter().filter(|p| Some(*p) != platform.as_ref()).map(String::as_str).collect();
    if let (Some(platform), false) = (&platform, others.is_empty()) {
        report.notes.push(format!(
            "only the binary for {platform} was run; those for {} cannot be run on this machine",
            others.join(", ")
        ));
    }
    report.ran = platform;
    for (number, case) in cases.iter().enumerate() {
        if !(case.applies)(description) {
            continue;
        }
        report.checks.push(case.name);
        let (lines, end) = run_case(program, timeout, folder, work.path(), case)?;
        let mut stop = None;
        let mut done = false;
        for line in lines {
            match line {
                Line::Found(found) => add(report, finding(found, root)),
                Line::Stop(why) => stop = Some(why),
                Line::Done => done = true,
            }
        }
        let call = last_call(work.path());
        let accident = match end {
            End::Late => {
                Some(format!("{call} did not return within {} s, {}", timeout.as_secs_f64(), case.title))
            }
            End::Crash(name) => Some(format!("{call} crashed with {name}, {}", case.title)),
            End::Code(0) if done || stop.is_some() => None,
            End::Code(code) => Some(format!("{call} ended the process with the code {code}, {}", case.title)),
        };
        if let Some(what) = accident {
            add(report, Finding::new(case.level, case.rule, None, what));
            if case.name == "unknown-reference" {
                // Other cases make errors in this way; they would find the same once more.
                let _ = std::fs::write(work.path().join(FRAGILE), []);
            }
            // If the binary can neither be loaded nor run, everything else fails in the same way.
            if number < 2 {
                stop = stop.or(Some(format!("nothing works after an accident {}", case.title)));
            }
        }
        if let Some(why) = stop {
            report.notes.push(format!("the other checks of the binary were left out: {why}"));
            break;
        }
    }
    Ok(())
}

/// Adds a finding that is not there yet: many cases meet the same one.
fn add(report: &mut Report, finding: Finding) {
    if !report.findings.contains(&finding) {
        report.findings.push(finding);
    }
}

/// The finding with its place in the description.
fn finding(found: Found, root: &Node) -> Finding {
    let Found { rule, level, what, variable, attribute } = found;
    let variable = variable.and_then(|name| {
        root.child("ModelVariables")?.all("ScalarVariable").find(|v| v.text("name") == Some(&name))
    });
    let place = match (variable, &attribute) {
        (Some(v), None) => Some(Place::tag(&v.element)),
        (Some(v), Some(attribute)) => {
            let node = v.children.iter().find(|c| c.text(attribute).is_some()).unwrap_or(v);
            Some(Place::attribute(&node.element, attribute))
        }
        (None, Some(attribute)) => {
            root.child("CoSimulation").map(|c| Place::attribute(&c.element, attribute))
        }
        (None, None) => None,
    };
    Finding::new(level, &rule, place, what)
}

fn run_case(
    program: &Path,
    timeout: Duration,
    folder: &Path,
    work: &Path,
    case: &Case,
) -> Result<(Vec<Line>, End)> {
    let io = |e: std::io::Error| Error::file(format!("{}: the check cannot be run: {e}", program.display()));
    std::fs::write(work.join(CALL), [0; NOTE]).map_err(io)?;
    let mut command = Command::new(program);
    command
        .args(["check", "--child", case.name, "--timeout", &timeout.as_secs_f64().to_string(), "--work"])
        .args([work, folder])
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::null());
    let child = Running::start(&mut command).map_err(io)?;
    let pipe = child.with(|child| child.stdout.take());
    // A thread of its own, as the child may hang with the pipe open.
    let reader = std::thread::spawn(move || {
        let lines = pipe.into_iter().flat_map(|pipe| BufReader::new(pipe).lines()).map_while(|l| l.ok());
        lines.filter_map(|line| serde_json::from_str(&line).ok()).collect::<Vec<Line>>()
    });
    let begin = Instant::now();
    let end = loop {
        if let Some(status) = child.with(Child::try_wait).map_err(io)? {
            break system::end(status);
        }
        if begin.elapsed() > timeout {
            child.with(|child| child.kill().and_then(|()| child.wait())).map_err(io)?;
            break End::Late;
        }
        std::thread::sleep(PAUSE);
    };
    Ok((reader.join().unwrap_or_default(), end))
}

/// The call that was being made.
fn last_call(work: &Path) -> String {
    let bytes = std::fs::read(work.join(CALL)).unwrap_or_default();
    let text: Vec<u8> = bytes.into_iter().take_while(|b| *b != 0).collect();
    match String::from_utf8_lossy(&text) {
        text if text.is_empty() => "the start of the check".into(),
        text => text.into_owned(),
    }
}
