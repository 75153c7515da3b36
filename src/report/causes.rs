//! The page of a wired vehicle's causes: part after part, then the closed loop beside the repeats.

use crate::causes::{ClosedLoop, Found, PartFindings};
use crate::model::Value;
use crate::page::{Html, Page, Section, Table, number};

/// The page of what was found.
pub fn causes_report(title: &str, summary: &str, parts: &[PartFindings], closed: &[ClosedLoop]) -> String {
    let mut page = Page::new(title, summary);
    for part in parts {
        let mut section = Section::new(&part.part).with(found(part));
        for one in &part.found {
            section = section.with(channels(one));
        }
        page = page.section(section.with(rest(part)));
    }
    page.section(loops(closed)).html()
}

fn found(part: &PartFindings) -> Html {
    if part.found.is_empty() && part.of_roads.is_empty() {
        return Html::note(
            "It does nothing that its recorded inputs and the scatter of repeats do not explain.",
        );
    }
    let mut table = Table::new(&[
        "cause",
        "parameter",
        "in the system",
        "in the recordings",
        "explains, fit",
        "check",
        "by chance",
        "or",
    ]);
    for one in &part.found {
        for (k, change) in one.changes.iter().enumerate() {
            let others: Vec<&str> = one.alternatives.iter().map(|other| other.title).collect();
            let first = |text: String| if k == 0 { text } else { String::new() };
            table = table.row(vec![
                first(one.title.to_owned()),
                change.name.clone(),
                value(&change.before),
                value(&change.value),
                first(percent(one.explains[0])),
                first(percent(one.explains[1])),
                first(format!("{:.0e}", one.chance)),
                first(others.join(", ")),
            ]);
        }
    }
    for road in &part.of_roads {
        for (k, change) in road.changes.iter().enumerate() {
            let first = |text: String| if k == 0 { text } else { String::new() };
            table = table.row(vec![
                first(format!("{}, in {} only", road.title, road.group)),
                change.name.clone(),
                value(&change.before),
                value(&change.value),
                first(percent(road.explains)),
                String::new(),
                first(format!("{:.0e}", road.chance)),
                String::new(),
            ]);
        }
    }
    table.html()
}

/// What a cause does to channels.
fn channels(one: &Found) -> Html {
    let mut table = Table::new(&["channel", "error over its scatter, before", "after"]);
    for (name, [before, after]) in &one.channels {
        table = table.row(vec![name.clone(), number(*before), number(*after)]);
    }
    table.html()
}

fn rest(part: &PartFindings) -> Html {
    let mut sentences = Vec::new();
    if let Some(best) = part.left.first() {
        sentences.push(format!(
            "Not named: {}, which explains {}: too little of the runs to fit or of those to check, or they do not agree.",
            best.title,
            percent(best.explains)
        ));
    }
    for hidden in &part.hidden {
        sentences
            .push(format!("These recordings do not show {}; what does: {}.", hidden.title, hidden.shown_by));
    }
    Html::note(&sentences.join(" "))
}

fn loops(closed: &[ClosedLoop]) -> Section {
    let mut table = Table::new(&["runs", "repeats", "quantities", "outside before", "outside after"]);
    let mut damage = Table::new(&["runs", "force", "damage over the recorded, before", "after"]);
    for group in closed {
        table = table.row(vec![
            group.group.clone(),
            group.runs.to_string(),
            group.quantities.to_string(),
            group.outside[0].to_string(),
            group.outside[1].to_string(),
        ]);
        for (name, [before, after]) in &group.damage {
            damage = damage.row(vec![group.group.clone(), name.clone(), number(*before), number(*after)]);
        }
    }
    Section::new("The closed loop beside the repeats").with(table.html()).with(damage.html()).with(Html::note(
        "Driven by the recorded pressure of the first run of each group, as the file has it and with what was found. Quantities are extremes, cycles, ranges, crossings and damage of each force; one is \
         outside where a further recording of the same run would not be with 95 % (Student's t). Errors over time are not compared: closed loops part after their first decision that falls otherwise.",
    ))
}

fn percent(share: f64) -> String {
    format!("{:.0} %", 100.0 * share)
}

fn value(value: &Value) -> String {
    match value {
        Value::Real(v) => number(*v),
        Value::Integer(v) => v.to_string(),
        Value::Boolean(v) => v.to_string(),
        Value::Text(text) => text.clone(),
    }
}
