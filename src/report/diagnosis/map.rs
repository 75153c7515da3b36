//! Where simulation and recordings differ: the significance map.

use super::compare::bare;
use crate::diagnose::{Cell, CellKind, Diagnosis};
use crate::page::{Html, Section, number};
use crate::report::heat::{HeatCell, HeatMap};
use crate::report::scale::{self, exponent_of};

/// Below this probability a cell is not chance.
pub(super) const SIGNIFICANT: f64 = 0.05;
/// More rows than this of one map are thinned out to those that show something.
const MAX_ROWS: usize = 12;
/// The shade is full at this level at the latest.
const MIN_SCALE: f64 = 3.0;

pub(super) fn section(diagnosis: &Diagnosis) -> Section {
    let map = &diagnosis.map;
    let section = Section::new("Where it differs");
    if map.is_empty() {
        return section;
    }
    let most = map.iter().map(|c| c.level).filter(|l| l.is_finite()).fold(MIN_SCALE, f64::max);
    let mut groups: Vec<(CellKind, &str)> = Vec::new();
    for cell in map {
        // time windows of all runs stand below each other
        let what = if cell.kind == CellKind::Time { "" } else { cell.what.as_str() };
        if !groups.contains(&(cell.kind, what)) {
            groups.push((cell.kind, what));
        }
    }
    groups.sort_by_key(|(kind, _)| match kind {
        CellKind::Condition => 0,
        CellKind::Band => 1,
        CellKind::Order => 2,
        CellKind::Time => 3,
    });
    let mut left_out = 0;
    let maps: Vec<Html> = groups
        .into_iter()
        .map(|(kind, what)| {
            let cells: Vec<&Cell> =
                map.iter().filter(|c| c.kind == kind && (kind == CellKind::Time || c.what == what)).collect();
            group(kind, what, &cells, most, &mut left_out)
        })
        .collect();
    let mut section = section
        .with(Html::text(
            "What is left after the refit of the model's own parameters, before anything was added to it, in \
             multiples of the noise (of the channel itself where its noise is not known). Colour: chance makes \
             it in less than 5 % of all cases, corrected for the number of cells; grey: it may be chance.",
        ))
        .side_by_side(maps);
    if left_out > 0 {
        section = section
            .with(Html::note(&format!("{left_out} rows in which nothing is significant are left out.")));
    }
    section
}

fn group(kind: CellKind, what: &str, cells: &[&Cell], most: f64, left_out: &mut usize) -> Html {
    let (name, unit) = bare(what);
    let (title, unit) = match kind {
        CellKind::Time => ("over time".to_owned(), "s"),
        CellKind::Band => ("over frequency".to_owned(), "Hz"),
        CellKind::Order if name.is_empty() => ("over order".to_owned(), "orders"),
        CellKind::Order => (format!("over order of {name}"), "orders"),
        CellKind::Condition => (format!("over {name}"), unit),
    };
    let mut spans: Vec<(f64, f64)> = cells.iter().map(|c| (c.low, c.high)).collect();
    spans.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    spans.dedup();
    // in one power of ten and to a thousandth of the largest, so that a head is no wider than its column
    let largest = spans.iter().map(|(low, high)| low.abs().max(high.abs())).fold(0.0, f64::max);
    let power = exponent_of(largest);
    let step = 10_f64.powi(largest.max(f64::MIN_POSITIVE).log10().floor() as i32 - 3);
    let edge = |value: f64| (value / step).round() * step * 10_f64.powi(-power);
    let heads: Vec<String> = spans.iter().map(|(low, high)| span(edge(*low), edge(*high), plain)).collect();
    let title = if unit.is_empty() && power == 0 {
        title
    } else {
        scale::title(&title, if unit.is_empty() { "1" } else { unit }, power)
    };

    let mut rows: Vec<(&str, &str)> = Vec::new();
    for cell in cells {
        let run = if kind == CellKind::Time { cell.what.as_str() } else { "" };
        if !rows.contains(&(&cell.channel, run)) {
            rows.push((&cell.channel, run));
        }
    }
    if rows.len() > MAX_ROWS {
        let before = rows.len();
        let shows = |row: &(&str, &str)| {
            cells.iter().any(|c| c.channel == row.0 && c.what == row.1 && is_significant(c))
        };
        rows.retain(shows);
        *left_out += before - rows.len();
    }
    let mut map = HeatMap::new(&title, "", &heads);
    for (channel, run) in rows {
        let head = if run.is_empty() { channel.to_owned() } else { format!("{channel}, {run}") };
        let of_row = |c: &&&Cell| c.channel == channel && (kind != CellKind::Time || c.what == run);
        let row = spans.iter().map(|s| {
            let cell = cells.iter().filter(of_row).find(|c| (c.low, c.high) == *s)?;
            Some(shaded(cell, &head, unit, most))
        });
        map = map.row(&head, row.collect());
    }
    map.html()
}

/// True if chance hardly makes the cell.
pub(super) fn is_significant(cell: &Cell) -> bool {
    cell.p.is_none_or(|p| p <= SIGNIFICANT)
}

fn span(low: f64, high: f64, write: fn(f64) -> String) -> String {
    if low == high { number(low) } else { format!("{} … {}", write(low), write(high)) }
}

fn shaded(cell: &Cell, head: &str, unit: &str, most: f64) -> HeatCell {
    let significant = is_significant(cell);
    // equal steps of colour are equal factors
    let shade = if significant { (cell.level.max(1.0).ln() / most.ln()).clamp(0.04, 1.0) } else { 0.0 };
    let chance = match cell.p {
        Some(p) if significant => format!("chance {}", number(p)),
        Some(p) => format!("may be chance ({})", number(p)),
        None => "not tested".into(),
    };
    HeatCell {
        text: short(cell.level),
        shade,
        title: format!(
            "{head}, {} {unit}: {} times the noise, {chance}",
            span(cell.low, cell.high, short),
            number(cell.level)
        ),
    }
}

/// With two digits.
fn short(value: f64) -> String {
    number(two_digits(value))
}

/// With two digits and without a power of ten, for what is hardly smaller than its neighbours.
fn plain(value: f64) -> String {
    if value.is_finite() { two_digits(value).to_string().replace('-', "−") } else { number(value) }
}

/// Rounded to two digits.
fn two_digits(value: f64) -> f64 {
    if !value.is_finite() || value == 0.0 {
        return value;
    }
    let digits = (1.0 - value.abs().log10().floor()).max(0.0);
    let power = 10_f64.powf(digits);
    (value * power).round() / power
}
