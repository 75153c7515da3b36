//! Checks any FMU for co-simulation against the rules of FMI 2.0.
//!
//! [`check`] looks at the archive and at its modelDescription.xml, then runs the binary, one check
//! after the other, each in a process of its own with a time limit: a crash or a hang is a finding.
//!
//! Each file uses only those below it:
//!
//! ```text
//! mod (hands the cases to parent and child)
//! parent  child  cases                what a case tries; processes know cases only as what they are given
//!         lab                         what a case is and works with
//!         unit  reporter              calls of the binary; what a case says
//! archive  description  schema        what needs no binary
//! report  finding  tree  rules
//! ```

mod archive;
mod cases;
mod child;
mod description;
mod finding;
mod float_mode;
mod lab;
mod memory;
mod parent;
mod report;
mod reporter;
mod rules;
mod schema;
mod system;
mod tree;
mod unit;

pub use finding::{Also, Finding, Level, Place};
pub use report::Report;
pub use rules::{RULES, Rule};

use super::import::{Archive, Description, MAX_LENGTH, MAX_UNPACKED};
use crate::{Error, Result};
use std::path::{Path, PathBuf};
use std::time::Duration;
use tree::Node;

/// How to check.
#[derive(Debug, Clone)]
pub struct Options {
    /// The program that runs [`run_child`] when it is called as `latsch check --child CASE --work
    /// FOLDER FMU`; `None` leaves out all checks that run the binary.
    pub program: Option<PathBuf>,
    /// How long each check of the binary may take.
    pub timeout: Duration,
}

/// Checks the FMU at `path`. With a program in `options` this runs the FMU's code.
///
/// # Errors
/// [`Error::fmu`] for a file that is no FMU of FMI 2.0 at all.
pub fn check(path: &Path, options: &Options) -> Result<Report> {
    let mut report = examine(path, options)?;
    report.findings = finding::group(report.findings);
    Ok(report)
}

/// Runs the case called `name` on the FMU unpacked in `folder`; `work` is a folder for notes. Findings go
/// to standard output as lines of JSON. This process should do nothing else.
///
/// # Errors
/// A wrong name, or folders that [`check`] did not make.
pub fn run_child(name: &str, folder: &Path, work: &Path, timeout: Duration) -> Result<()> {
    child::run(cases::CASES, name, folder, work, timeout)
}

/// The report with a finding for each place.
fn examine(path: &Path, options: &Options) -> Result<Report> {
    let at = |what: String| Error::fmu(what).at(path.display());
    let size = std::fs::metadata(path).map_err(|e| at(format!("the file cannot be read: {e}")))?;
    if !size.is_file() {
        let what = if size.is_dir() { "a folder" } else { "no ordinary file" };
        return Err(at(format!("this is {what}; an FMU is a zip archive with the ending .fmu")));
    }
    if size.len() > MAX_UNPACKED {
        return Err(at(format!("the file has more than {MAX_UNPACKED} bytes; such files are not read")));
    }
    let bytes = std::fs::read(path).map_err(|e| at(format!("the file cannot be read: {e}")))?;
    let mut report = Report {
        findings: Vec::new(),
        checks: Vec::new(),
        notes: Vec::new(),
        platforms: Vec::new(),
        ran: None,
    };
    let entries = archive::check_headers(&bytes, &mut report.findings)
        .ok_or_else(|| at("this is no zip archive, so it is no FMU or a damaged one".into()))?;
    drop(bytes);
    report.platforms = archive::platforms(&entries);
    if !entries.iter().any(|e| e.name == "modelDescription.xml") {
        return Err(at("there is no modelDescription.xml: this is no FMU".into()));
    }
    let opened = Archive::open(path).and_then(|mut a| Ok((a.read("modelDescription.xml", MAX_LENGTH)?, a)));
    let (xml, mut archive) = match opened {
        Ok((Some(xml), archive)) => (xml, archive),
        Ok((None, _)) => return Err(at("modelDescription.xml cannot be found in the archive".into())),
        Err(error) => return unreadable(report, &error),
    };
    let (root, found) = read_description(&xml);
    refuse_other_versions(root.as_ref()).map_err(|e| e.at(path.display()))?;
    let parts = |attribute: &str| -> Vec<String> {
        let parts = root.iter().flat_map(|r| r.all("ModelExchange").chain(r.all("CoSimulation")));
        match attribute {
            "modelIdentifier" => parts.filter_map(|p| p.text(attribute)).map(Into::into).collect(),
            _ => parts
                .flat_map(|p| p.all("SourceFiles").flat_map(|s| s.all("File")))
                .filter_map(|f| f.text("name"))
                .map(Into::into)
                .collect(),
        }
    };
    let (mut identifiers, mut sources) = (parts("modelIdentifier"), parts("SourceFiles"));
    // Both parts of an FMU may be made of the same files.
    sources.sort();
    sources.dedup();
    identifiers.dedup();
    archive::check_folders(&entries, &identifiers, &sources, &mut report.findings);
    report.findings.extend(found);
    let (Some(root), Some(program)) = (root, &options.program) else { return Ok(report) };
    if root.child("CoSimulation").is_none() {
        report.notes.push("the binary was not run: there is no <CoSimulation>".into());
        return Ok(report);
    }
    let description = match Description::parse(&xml) {
        Ok(description) => description,
        Err(error) => return not_run(report, "XSD", &error),
    };
    let folder = match archive.unpack() {
        Ok(folder) => folder,
        Err(error) => return not_run(report, "Z1", &error),
    };
    parent::run(cases::CASES, program, options.timeout, folder.path(), &description, &root, &mut report)?;
    Ok(report)
}

/// The report on an archive whose description cannot be read.
fn unreadable(report: Report, error: &Error) -> Result<Report> {
    not_run(report, "Z1", error)
}

/// The report where the binary cannot be run because of something that is an error at any rate.
fn not_run(mut report: Report, rule: &str, error: &Error) -> Result<Report> {
    if report.count(Level::Error) == 0 {
        report.findings.push(Finding::error(rule, None, error.to_string()));
    }
    report.notes.push(format!("the binary was not run: {error}"));
    Ok(report)
}

/// FMI 1.0 and 3.0 have other rules: their FMUs are not wrong, but are not for this check.
fn refuse_other_versions(root: Option<&Node>) -> Result<()> {
    match root.and_then(|r| r.text("fmiVersion")) {
        Some(version) if !version.trim().starts_with('2') => {
            Err(Error::fmu(format!("the FMU is of FMI {version}; this check is for FMI 2.0")))
        }
        _ => Ok(()),
    }
}

/// The tree of a description, if it is XML, and what is wrong with it.
fn read_description(xml: &[u8]) -> (Option<Node>, Vec<Finding>) {
    let mut findings = Vec::new();
    check_encoding(xml, &mut findings);
    let root = match Node::parse(xml) {
        Ok(root) => root,
        Err(broken) => {
            let place = broken.place.map(|p| Place::xml(&p, 1));
            findings.push(Finding::error("XML", place, broken.what));
            return (None, findings);
        }
    };
    schema::check(&root, &mut findings);
    if root.name() == "fmiModelDescription" {
        description::check(&root, &mut findings);
    }
    (Some(root), findings)
}

/// What is wrong with a modelDescription.xml, as far as it shows there.
pub fn static_findings(xml: &[u8]) -> Vec<Finding> {
    read_description(xml).1
}

/// The encoding that the XML declares has to be UTF-8, which is also the default.
fn check_encoding(xml: &[u8], findings: &mut Vec<Finding>) {
    let head = String::from_utf8_lossy(&xml[..xml.len().min(200)]);
    let Some((head, _)) = head.split_once("?>") else { return };
    let Some((before, rest)) = head.split_once("encoding") else { return };
    let value = rest.trim_start_matches(|c: char| c == '=' || c.is_whitespace());
    let value: String = value.chars().skip(1).take_while(|c| !matches!(c, '"' | '\'')).collect();
    if !value.eq_ignore_ascii_case("utf-8") {
        let column = before.chars().filter(|c| *c != '\u{feff}').count();
        let place = Place::Xml {
            line: before.matches('\n').count() + 1,
            column: column + 1,
            excerpt: format!("{}?>", head.trim_start_matches('\u{feff}')),
            mark: (column, value.chars().count() + 11),
        };
        findings.push(Finding::error(
            "X1",
            Some(place),
            format!("the encoding is {value}; FMI demands UTF-8"),
        ));
    }
}
