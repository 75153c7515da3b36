//! The answer, to be read at a glance: what, how sure, where, and how much it helps.

use super::tables::interval;
use crate::diagnose::{ChannelCheck, Diagnosis, Finding, Verdict};
use crate::page::{Html, Section, Table, escape, number};
use crate::shown::with_unit;
use std::fmt::Write;

/// The answer in a few words.
pub(super) fn title(diagnosis: &Diagnosis) -> String {
    let names: Vec<&str> = diagnosis.findings.iter().map(|f| name(&f.name, &f.effect)).collect();
    match (diagnosis.verdict, &names[..]) {
        (Verdict::Nothing, _) => "Nothing is missing".into(),
        (Verdict::Parameters, _) => "Only parameters were off".into(),
        (Verdict::Recording, names) => {
            let mut text = String::from("The recordings are at fault");
            if let (Some(without), [_, ..]) = (&diagnosis.without_faults, names) {
                let rest = Diagnosis { verdict: without.verdict, without_faults: None, ..diagnosis.clone() };
                let _ = write!(text, ". {}", title(&rest));
            }
            text
        }
        (Verdict::Unknown, [_, names @ ..]) if diagnosis.is_mostly_named() => {
            format!(
                "Missing: {}, or what looks alike, and something that has no name here",
                names.join(" and ")
            )
        }
        (Verdict::Unknown, _) | (_, []) => "Something is missing that has no name here".into(),
        (Verdict::Effect, names) => format!("Missing: {}", names.join(" and ")),
        (Verdict::Family, names) => format!("Missing: {}, or what looks alike", names.join(" and ")),
    }
}

/// A name for people.
fn name<'a>(name: &'a str, id: &'a str) -> &'a str {
    if name.is_empty() { id } else { name }
}

/// The class of the badge of a verdict, and its text.
fn kind(verdict: Verdict) -> (&'static str, &'static str) {
    match verdict {
        Verdict::Nothing => ("nothing", "nothing missing"),
        Verdict::Parameters => ("parameters", "parameters"),
        Verdict::Recording => ("recording", "recording at fault"),
        Verdict::Effect => ("effect", "named effect"),
        Verdict::Family => ("family", "one of a family"),
        Verdict::Unknown => ("unknown", "not explained"),
    }
}

/// The verdict and its findings beside the errors of the check runs.
pub(super) fn section(diagnosis: &Diagnosis) -> Section {
    let mut html = String::from("<div class=\"answer\">\n<div>\n");
    let badge = |verdict: Verdict| {
        let (class, text) = kind(verdict);
        let text = if verdict == Verdict::Unknown && diagnosis.is_mostly_named() {
            "not all explained"
        } else {
            text
        };
        format!("<span class=\"kind {class}\">{text}</span>\n")
    };
    html.push_str(&badge(diagnosis.verdict));
    if diagnosis.verdict == Verdict::Recording {
        for fault in &diagnosis.faults {
            let place = match &fault.channel {
                Some(channel) => format!("{} of {channel}", words(&fault.kind)),
                None => words(&fault.kind),
            };
            let _ = write!(
                html,
                "<p class=\"big\">{}</p>\n<p>{}</p>\n<p class=\"note\">{}</p>\n",
                escape(&place),
                escape(&fault.text),
                escape(&fault.runs.join(", "))
            );
        }
    }
    if let Some(without) = &diagnosis.without_faults {
        let _ = writeln!(html, "<h2>Without {}</h2>", escape(&without.words()));
        html.push_str(&badge(without.verdict));
    }
    // in the order of the title: what has no name is the first finding
    let names_first = usize::from(diagnosis.is_mostly_named());
    let (later, first) = diagnosis.findings.split_at(names_first);
    for finding in first.iter().chain(later) {
        html.push_str(&found(finding));
    }
    if diagnosis.verdict == Verdict::Parameters {
        html.push_str(parameters_in_short(diagnosis).as_str());
    }
    html.push_str("</div>\n<div>\n");
    html.push_str(&errors(&diagnosis.check));
    html.push_str("</div>\n</div>\n");
    Section::default().with(Html::raw(html))
}

/// The parameters that moved most, relative to their start.
fn parameters_in_short(diagnosis: &Diagnosis) -> Html {
    let moved =
        |p: &&crate::diagnose::Fitted| ((p.value - p.start) / p.start.abs().max(1e-300)).abs().min(f64::MAX);
    let mut parameters: Vec<_> = diagnosis.parameters.iter().collect();
    parameters.sort_by(|a, b| moved(b).total_cmp(&moved(a)));
    let mut table = Table::new(&["parameter", "from", "to", "unit"]);
    for p in parameters.into_iter().take(5) {
        table = table.row([p.name.clone(), number(p.start), number(p.value), p.unit.clone()]);
    }
    if table.is_empty() { Html::default() } else { table.html() }
}

/// A kebab-case id as words.
fn words(id: &str) -> String {
    id.replace('-', " ")
}

fn found(finding: &Finding) -> String {
    let mut html = String::new();
    let _ = writeln!(html, "<p class=\"big\">{}</p>", escape(name(&finding.name, &finding.effect)));
    html.push_str("<div class=\"likely\">");
    let this = if finding.alternatives.is_empty() { "confidence" } else { &words(&finding.effect) };
    bar(&mut html, "b", this, "", finding.confidence);
    for other in &finding.alternatives {
        let place = if other.place == finding.place { "" } else { &other.place };
        bar(&mut html, "span", &words(&other.effect), place, other.confidence);
    }
    html.push_str("</div>\n<table class=\"facts\"><tbody>\n");
    let mut row = |head: &str, text: &str| {
        if !text.is_empty() {
            let _ = writeln!(html, "<tr><td>{head}</td><td>{}</td></tr>", escape(text));
        }
    };
    row("family", &words(&finding.family));
    row("where", &finding.place);
    row("seen in", &finding.channels.join(", "));
    row("depends on", &finding.depends_on.join(", "));
    for p in &finding.parameters {
        let value = with_unit(number(p.value), &p.unit);
        row("with", &format!("{} = {value} ({})", words(&p.name).replace('_', " "), interval(p.low, p.high)));
    }
    html.push_str("</tbody></table>\n");
    if !finding.evidence.is_empty() {
        let _ = writeln!(html, "<p>{}</p>", escape(&finding.evidence));
    }
    html
}

/// A line with a bar for a probability.
fn bar(html: &mut String, tag: &str, text: &str, place: &str, probability: f64) {
    let share = if probability.is_finite() { probability.clamp(0.0, 1.0) } else { 0.0 };
    let place = if place.is_empty() { String::new() } else { format!(" ({})", escape(place)) };
    let _ = write!(
        html,
        // room for the number beside the longest
        "<{tag}>{}{place}</{tag}><div><i style=\"width:{:.1}%\"></i>{:.0} %</div>",
        escape(text),
        80.0 * share,
        100.0 * share
    );
}

/// The errors of the check runs as bars, each channel relative to its largest.
fn errors(check: &[ChannelCheck]) -> String {
    if check.is_empty() {
        return String::new();
    }
    let mut html = String::from(
        "<h2>Error on the check runs</h2>\n<p class=\"note\">\
         <i class=\"swatch\" style=\"background:#d55e00\"></i>before\
         <i class=\"swatch\" style=\"background:#0072b2\"></i>after\
         <i class=\"swatch tick\" style=\"background:#1c2329\"></i>noise of the recordings</p>\n\
         <div class=\"errors\">\n",
    );
    for c in check {
        let noise = c.noise.filter(|n| n.is_finite());
        let all = [c.before, c.after, noise.unwrap_or(0.0)];
        let largest = all.into_iter().filter(|v| v.is_finite()).fold(f64::MIN_POSITIVE, f64::max);
        let width = |v: f64| if v.is_finite() { 100.0 * (v / largest).clamp(0.0, 1.0) } else { 0.0 };
        let change = if c.before > 0.0 && c.after.is_finite() {
            let change = format!("{:+.0} %", 100.0 * (c.after / c.before - 1.0)).replace('-', "−");
            if matches!(change.as_str(), "+0 %" | "−0 %") { "unchanged".into() } else { change }
        } else {
            String::new()
        };
        let _ = write!(
            html,
            "<div><p><span><b>{}</b> {change}</span><span>{} → {} {}</span></p>\
             <div class=\"track\"><i class=\"b\" style=\"width:{:.1}%\"></i><i class=\"a\" style=\"width:{:.1}%\"></i>",
            escape(&c.channel),
            number(c.before),
            number(c.after),
            escape(&c.unit),
            width(c.before),
            width(c.after),
        );
        if let Some(noise) = noise {
            let _ = write!(
                html,
                "<i class=\"n\" style=\"left:{:.1}%\" title=\"noise {}\"></i>",
                width(noise),
                number(noise)
            );
        }
        html.push_str("</div></div>\n");
    }
    html + "</div>\n"
}
