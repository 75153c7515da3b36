//! In which part of a wired system the difference is made.

use crate::diagnose::Diagnosis;
use crate::page::{Html, Section, Table, number};

pub(super) fn section(diagnosis: &Diagnosis) -> Section {
    let section = Section::new("In which part");
    if diagnosis.parts.is_empty() {
        return section;
    }
    let mut table =
        Table::new(&["part", "channel", "unit", "error in the system", "with recorded inputs", "made here"]);
    for part in &diagnosis.parts {
        for c in &part.channels {
            let made = match c.made_here {
                Some(true) => "yes",
                Some(false) => "no, in another part",
                None => "nothing to tell",
            };
            table = table.row([
                part.part.clone(),
                c.channel.clone(),
                c.unit.clone(),
                number(c.wired),
                number(c.replayed),
                made.into(),
            ]);
        }
    }
    let mut section = if table.is_empty() { section } else { section.with(table.html()) };
    for part in &diagnosis.parts {
        if let Some(why) = &part.closed {
            section = section.with(Html::text(&format!("{} could not be run by itself: {why}.", part.part)));
        }
    }
    section.with(Html::note(
        "Each part was fitted and run by itself, with what its connected inputs had replayed from the recordings. If more than \
         noise is left of the check runs then, the difference is made in the part; else it comes from another one.",
    ))
}
