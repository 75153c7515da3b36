//! Candidates, parameters, what is left, and the recordings.

use super::compare::{Compared, rms};
use super::courses::strongest_left;
use crate::diagnose::{Diagnosis, Use, Verdict};
use crate::page::{Html, Section, Table, escape, number};
use std::fmt::Write;

/// An error within this multiple of the noise is explained.
const EXPLAINED: f64 = 1.2;

/// An interval, or that there is none.
pub(super) fn interval(low: Option<f64>, high: Option<f64>) -> String {
    match (low, high) {
        (Some(low), Some(high)) => format!("{} … {}", number(low), number(high)),
        (Some(low), None) => format!("at least {}", number(low)),
        (None, Some(high)) => format!("at most {}", number(high)),
        (None, None) => "not fixed by these recordings".into(),
    }
}

/// A change with one decimal and its sign.
fn signed(change: f64) -> String {
    let text = format!("{change:+.1}").replace('-', "−");
    if matches!(text.as_str(), "+0.0" | "−0.0") { "0".into() } else { text }
}

/// A share as percent.
fn percent(share: Option<f64>) -> String {
    share.map_or_else(
        || number(f64::NAN),
        |s| {
            let text = format!("{:.0}", 100.0 * s).replace('-', "−");
            if text == "−0" { "0".into() } else { text }
        },
    )
}

pub(super) fn candidates(diagnosis: &Diagnosis) -> Section {
    let section = Section::new("What was tried");
    if diagnosis.candidates.is_empty() {
        return section;
    }
    let mut html = String::from("<div class=\"scroll\"><table><thead><tr>");
    for head in ["effect", "family", "where", "why"] {
        let _ = write!(html, "<th>{head}</th>");
        if head == "where" {
            for head in ["gain, fit [%]", "gain, check [%]", "chance"] {
                let _ = write!(html, "<th class=\"number\">{head}</th>");
            }
        }
    }
    html.push_str("</tr></thead>\n<tbody>\n");
    for c in &diagnosis.candidates {
        let chosen = diagnosis.findings.iter().any(|f| f.effect == c.effect && f.place == c.place);
        let name = if c.name.is_empty() { &c.effect } else { &c.name };
        let name = if chosen { format!("<b>{}</b>", escape(name)) } else { escape(name) };
        let _ = writeln!(
            html,
            "<tr{}><td>{name}</td><td>{}</td><td>{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td>\
             <td class=\"number\">{}</td><td>{}</td></tr>",
            if chosen { " class=\"chosen\"" } else { "" },
            escape(&c.family),
            escape(&c.place),
            percent(c.fit_gain),
            percent(c.check_gain),
            c.p.map_or_else(|| number(f64::NAN), number),
            escape(&c.reason),
        );
    }
    html.push_str("</tbody></table></div>\n");
    section.with(Html::raw(html)).with(Html::note(
        "Gain is the share of the squared error that the effect takes away, beyond a refit of the model's own \
         parameters. An effect counts only if the check runs gain from it what chance does not make, and both sets a \
         share that matters; of those that count, the one that fit runs and check runs together make likeliest is chosen, \
         less a price for its parameters and places. Chance is the probability that chance gains as much on the check \
         runs.",
    ))
}

pub(super) fn parameters(diagnosis: &Diagnosis) -> Section {
    let mut section = Section::new("Parameters");
    let mut effects = Table::new(&["effect", "parameter", "value", "unit", "95 % interval"]);
    for finding in &diagnosis.findings {
        for p in &finding.parameters {
            effects = effects.row([
                if finding.name.is_empty() { finding.effect.clone() } else { finding.name.clone() },
                p.name.clone(),
                number(p.value),
                p.unit.clone(),
                interval(p.low, p.high),
            ]);
        }
    }
    if !effects.is_empty() {
        section = section.with(effects.html());
    }
    let mut own = Table::new(&["model's parameter", "start", "value", "unit", "95 % interval", "change [%]"]);
    for p in &diagnosis.parameters {
        let change = 100.0 * (p.value / p.start - 1.0);
        let change = if change.is_finite() { signed(change) } else { number(f64::NAN) };
        let change = if p.held_at.is_some() { format!("{change}, at its bound") } else { change };
        own = own.row([
            p.name.clone(),
            number(p.start),
            number(p.value),
            p.unit.clone(),
            interval(p.low, p.high),
            change,
        ]);
    }
    if !own.is_empty() {
        section = section.with(own.html());
    }
    let mut zeros = Table::new(&["channel shows at zero", "value", "unit", "95 % interval"]);
    for z in &diagnosis.zeros {
        zeros = zeros.row([z.name.clone(), number(z.value), z.unit.clone(), interval(z.low, z.high)]);
    }
    if zeros.is_empty() { section } else { section.with(zeros.html()) }
}

pub(super) fn unexplained(diagnosis: &Diagnosis, runs: &[Compared]) -> Section {
    let section = Section::new("Still unexplained");
    if diagnosis.check.is_empty() {
        return section;
    }
    let mut table = Table::new(&[
        "channel",
        "unit",
        "error left",
        "noise",
        "error / noise",
        "explained [%]",
        "worst run",
        "strongest at [Hz]",
        "amplitude",
    ]);
    let mut open = Vec::new();
    for c in &diagnosis.check {
        let noise = c.noise.filter(|n| *n > 0.0);
        let floor = noise.unwrap_or(0.0);
        // of what is not noise
        let explained = (c.before * c.before - c.after * c.after) / (c.before * c.before - floor * floor);
        let explained = (c.before > EXPLAINED * floor).then(|| explained.clamp(-9.99, 1.0));
        if noise.is_none_or(|n| c.after > EXPLAINED * n) {
            open.push(c.channel.as_str());
        }
        let worst = runs
            .iter()
            .filter_map(|r| {
                let trace = r.traces.iter().find(|t| t.name == c.channel)?;
                Some((rms(&trace.residual_left()), r.run.name.clone()))
            })
            .max_by(|a, b| a.0.total_cmp(&b.0));
        let (place, amplitude) = strongest_left(runs, &c.channel).unwrap_or((f64::NAN, f64::NAN));
        table = table.row([
            c.channel.clone(),
            c.unit.clone(),
            number(c.after),
            number(noise.unwrap_or(f64::NAN)),
            noise.map_or_else(|| number(f64::NAN), |n| format!("{:.2}", c.after / n)),
            percent(explained),
            worst.map_or_else(|| number(f64::NAN), |w| w.1),
            number(place),
            number(amplitude),
        ]);
    }
    let text = if open.is_empty() {
        format!("Nothing that stands out: the error of every channel is within {EXPLAINED} times its noise.")
    } else if diagnosis.verdict == Verdict::Recording {
        format!(
            "Not decided while the recordings are at fault; the error exceeds the noise in {}.",
            open.join(", ")
        )
    } else {
        format!(
            "The error exceeds {EXPLAINED} times the noise, or the noise is not known, in {}.",
            open.join(", ")
        )
    };
    section.with(Html::text(&text)).with(table.html()).with(Html::note(
        "Explained is the share of the squared error beyond the noise that the correction takes away.",
    ))
}

pub(super) fn recordings(diagnosis: &Diagnosis) -> Section {
    let mut section = Section::new("Recordings");
    let names = |use_: Use| {
        let names: Vec<&str> =
            diagnosis.runs.iter().filter(|r| r.use_ == use_).map(|r| r.name.as_str()).collect();
        names.join(", ")
    };
    let mut uses = Table::new(&[]);
    for (use_, text) in [(Use::Fit, "for fitting"), (Use::Check, "for checking"), (Use::Leave, "not used")] {
        let names = names(use_);
        if !names.is_empty() {
            uses = uses.row([text, &names]);
        }
    }
    if !uses.is_empty() {
        section = section.with(uses.html());
    }
    let mut faults = Table::new(&["fault", "channel", "what was seen", "recordings"]);
    for fault in &diagnosis.faults {
        faults = faults.row([
            fault.kind.replace('-', " "),
            fault.channel.clone().unwrap_or_default(),
            fault.text.clone(),
            fault.runs.join(", "),
        ]);
    }
    if faults.is_empty() { section } else { section.with(faults.html()) }
}
