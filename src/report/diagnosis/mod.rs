//! The page of a diagnosis: the answer first, then what supports it.

mod answer;
mod compare;
mod conditions;
mod courses;
mod loads;
mod map;
mod parts;
mod tables;
#[cfg(test)]
mod tests;

pub use compare::CheckRun;

use crate::Result;
use crate::diagnose::Diagnosis;
use crate::page::{Html, Page, Section};
use compare::Compared;

const STYLE: &str = include_str!("diagnosis.css");

/// The page of a diagnosis, with the check runs as they were measured and as they were simulated before
/// and after the correction.
///
/// The channels are those of the diagnosis' check, and those that a run has both measured and simulated if
/// the check lists none; residuals are measurement minus simulation at the times of the measurement, in
/// the unit of the check. Of very many runs and channels only the first are drawn; the page says so.
///
/// # Errors
/// A channel that is not as long as its time, or whose unit does not fit; the message has run and channel.
pub fn diagnosis_report(diagnosis: &Diagnosis, runs: &[CheckRun]) -> Result<String> {
    let compared = runs.iter().map(|run| Compared::new(diagnosis, run)).collect::<Result<Vec<_>>>()?;
    let mut page = Page::new(&answer::title(diagnosis), &diagnosis.summary)
        .section(answer::section(diagnosis).with(Html::raw(format!("<style>\n{STYLE}</style>\n"))));
    for section in [
        map::section(diagnosis),
        parts::section(diagnosis),
        courses::clearest(diagnosis, &compared),
        conditions::section(diagnosis, &compared),
        courses::section(&compared),
        tables::candidates(diagnosis),
        tables::parameters(diagnosis),
        loads::section(diagnosis, &compared),
        tables::unexplained(diagnosis, &compared),
        next(diagnosis),
        tables::recordings(diagnosis),
        notes(diagnosis),
    ] {
        page = page.section(section);
    }
    Ok(page.html())
}

fn notes(diagnosis: &Diagnosis) -> Section {
    let section = Section::new("How it was done");
    diagnosis.notes.iter().fold(section, |section, note| section.with(Html::text(note)))
}

fn next(diagnosis: &Diagnosis) -> Section {
    let section = Section::new("What to measure next");
    if diagnosis.next_experiment.is_empty() {
        return section;
    }
    section.with(Html::text(&diagnosis.next_experiment))
}
