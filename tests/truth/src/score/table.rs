//! Judgements as Markdown.

use super::judge::Judgement;
use super::wilson::Share;
use crate::flat_track;

/// A diagnosis of a cheap base model shall take no longer \[s\].
const QUICK: f64 = 20.0;
/// A diagnosis of the flat track shall take no longer \[s\].
const PATIENT: f64 = 360.0;
/// The error after correction shall be no larger, over that of noise alone.
const RATIO: f64 = 1.1;

fn of<'a>(all: &'a [Judgement], kinds: &'a [&str]) -> impl Iterator<Item = &'a Judgement> {
    all.iter().filter(move |j| kinds.contains(&j.answer.kind.as_str()))
}

fn row(text: &mut String, what: &str, bar: &str, share: Share, met: Option<bool>) {
    let met = match met {
        _ if share.of == 0 => "no case",
        None => "",
        Some(true) => "yes",
        Some(false) => "no",
    };
    *text += &format!("| {what} | {bar} | {} | {met} |\n", share.cells());
}

fn at_least(text: &mut String, what: &str, percent: f64, share: Share) {
    let met = share.percent().is_some_and(|p| p >= percent);
    row(text, what, &format!("{percent:.0} %"), share, Some(met));
}

fn at_most(text: &mut String, what: &str, percent: f64, share: Share) {
    let met = share.percent().is_some_and(|p| p <= percent);
    row(text, what, &format!("at most {percent:.0} %"), share, Some(met));
}

fn plain(text: &mut String, what: &str, share: Share) {
    row(text, what, "", share, None);
}

/// The whole report: table, calibration, list of cases.
#[must_use]
pub fn report(all: &[Judgement]) -> String {
    let mut text = bars(all);
    text += &errors(all);
    text += &calibration(all);
    text += &by_detail(all);
    text += &list(all);
    text
}

fn bars(all: &[Judgement]) -> String {
    let mut text =
        String::from("| | bar | reached | cases | 95 % interval | met |\n|---|---|---|---|---|---|\n");
    let t = &mut text;
    at_least(
        t,
        "clear effects: the right family named first",
        95.0,
        Share::of(of(all, &["clear"]).map(|j| j.family_first)),
    );
    at_least(
        t,
        "clear effects: among the first three",
        98.0,
        Share::of(of(all, &["clear"]).map(|j| j.family_three)),
    );
    plain(
        t,
        "clear effects: the right effect named first",
        Share::of(of(all, &["clear"]).map(|j| j.id_first)),
    );
    at_least(
        t,
        "plain effects (1.4 to 2.5 times the noise): the right effect named first",
        95.0,
        Share::of(of(all, &["plain"]).map(|j| j.id_first)),
    );
    at_most(t, "plain effects: a wrong name", 2.0, Share::of(of(all, &["plain"]).map(|j| j.wrong_name)));
    at_most(t, "faint effects: a wrong name", 2.0, Share::of(of(all, &["faint"]).map(|j| j.wrong_name)));
    plain(t, "faint effects: the right effect", Share::of(of(all, &["faint"]).map(|j| j.id_first)));
    let nulls = || of(all, &["null", "parameters"]);
    at_most(
        t,
        "nothing missing, or parameters only: something named",
        2.0,
        Share::of(nulls().map(|j| j.named)),
    );
    plain(
        t,
        "nothing missing, or parameters only: said to be unknown",
        Share::of(nulls().map(|j| j.verdict == "unknown")),
    );
    let outside = || of(all, &["outside"]);
    at_least(t, "not in the catalogue: says so", 93.0, Share::of(outside().map(|j| j.verdict == "unknown")));
    at_least(
        t,
        "not in the catalogue: names a variable it depends on",
        75.0,
        Share::of(outside().filter_map(|j| j.dependence)),
    );
    plain(t, "not in the catalogue: a name of the catalogue", Share::of(outside().map(|j| j.named)));
    let faults = || of(all, &["fault"]);
    at_least(
        t,
        "recording faults: reported as such",
        95.0,
        Share::of(faults().map(|j| j.verdict == "recording")),
    );
    at_least(
        t,
        "recording faults: reported as such, with the runs and channels that have it and no others",
        90.0,
        Share::of(faults().map(|j| j.verdict == "recording" && j.fault_placed)),
    );
    at_least(t, "mixes: both found", 85.0, Share::of(of(all, &["mix"]).map(|j| j.all_found)));
    plain(
        t,
        "decoys: the right effect first, or nothing where nothing is",
        Share::of(of(all, &["decoy"]).map(decoy_right)),
    );
    plain(t, "decoys: the decoy named", Share::of(of(all, &["decoy"]).map(|j| j.trapped)));
    plain(t, "Mack's cases: right", Share::of(of(all, &["mack"]).map(mack_right)));
    let intervals = all.iter().filter(|j| understood(j)).flat_map(|j| j.held.iter().copied());
    plain(
        t,
        "95 % intervals of the model's parameters that hold the truth, where all is understood",
        Share::of(intervals),
    );
    let amounts = all.iter().filter(|j| understood(j)).flat_map(|j| j.amounts_held.iter().copied());
    let share = Share::of(amounts);
    let met = share.percent().is_some_and(|p| (85.0..=95.0).contains(&p));
    row(
        t,
        "90 % intervals of the named effect's parameters that hold the truth, where its law is the name's",
        "85 to 95 %",
        share,
        Some(met),
    );
    let close = correctable(all).filter_map(|j| j.error_ratio).map(|r| r <= RATIO);
    at_least(
        t,
        "error on checking runs at most 1.1 times that of the true structure",
        95.0,
        Share::of(close),
    );
    let sure = all.iter().filter(|j| j.named && j.confidence.is_some_and(|c| (0.85..0.95).contains(&c)));
    let share = Share::of(sure.map(right));
    let met = share.percent().is_some_and(|p| (85.0..=95.0).contains(&p));
    row(t, "stated confidence of 0.85 to 0.95: right", "85 to 95 %", share, Some(met));
    let within = |flat: bool, bar: f64| Share::of(times(all, flat).map(move |s| s <= bar));
    at_least(t, "diagnosis of a cheap base model within 20 s", 100.0, within(false, QUICK));
    at_least(t, "diagnosis of the flat track within 6 minutes", 100.0, within(true, PATIENT));
    plain(t, "no diagnosis came", Share::of(all.iter().map(|j| j.failed)));
    text
}

/// Whether what was said is all that is true.
fn understood(j: &Judgement) -> bool {
    match j.answer.kind.as_str() {
        "null" | "parameters" => matches!(j.verdict.as_str(), "nothing" | "parameters"),
        "mix" => j.all_found,
        "clear" | "plain" => j.id_first,
        _ => false,
    }
}

/// Times of the diagnoses of the flat track, or of all others \[s\].
fn times(all: &[Judgement], flat: bool) -> impl Iterator<Item = f64> {
    all.iter().filter(move |j| (j.answer.model == flat_track::NAME) == flat).filter_map(|j| j.seconds)
}

fn decoy_right(j: &Judgement) -> bool {
    if j.answer.effects.is_empty() { !j.failed && !j.named && j.verdict != "unknown" } else { j.id_first }
}

fn mack_right(j: &Judgement) -> bool {
    let modest = matches!(j.verdict.as_str(), "parameters" | "nothing");
    match j.answer.detail.as_str() {
        "K8" => modest,
        "K7" => j.all_found,
        "K1" => j.id_first,
        _ => j.verdict == "parameters" && j.parameters_found == Some(true),
    }
}

/// Whether what is named first is right, whatever the kind.
fn right(j: &Judgement) -> bool {
    match j.answer.kind.as_str() {
        "fault" => j.verdict == "recording",
        _ => j.id_first,
    }
}

fn correctable(all: &[Judgement]) -> impl Iterator<Item = &Judgement> {
    of(all, &["clear", "plain", "mix", "decoy", "null", "parameters"])
}

#[allow(clippy::cast_precision_loss)] // hundreds
fn errors(all: &[Judgement]) -> String {
    let mut ratios: Vec<f64> = correctable(all).filter_map(|j| j.error_ratio).collect();
    ratios.sort_by(f64::total_cmp);
    let at =
        |share: f64| ratios.get(((ratios.len() as f64 * share) as usize).min(ratios.len().saturating_sub(1)));
    let show = |share| at(share).map_or("-".into(), |r| format!("{r:.3}"));
    let longest =
        |flat: bool| times(all, flat).max_by(f64::total_cmp).map_or("none".into(), |s| format!("{s:.1} s"));
    format!(
        "\nError on the checking runs after correction over that of noise alone (rms over channels; clear effects, mixes, decoys and \
         nulls): median {}, 90 % of the cases below {}, largest {}; bar {RATIO}.\nLongest diagnosis of a cheap base model: {}, of the flat track: {}.\n",
        show(0.5),
        show(0.9),
        show(1.0),
        longest(false),
        longest(true)
    )
}

fn calibration(all: &[Judgement]) -> String {
    let mut text = String::from(
        "\n## Is stated confidence right?\n\nAll cases in which something is named; right is a right effect named first, or a fault that is there.\n\n| stated | right | cases | 95 % interval |\n|---|---|---|---|\n",
    );
    for (low, high) in [(0.0, 0.5), (0.5, 0.7), (0.7, 0.85), (0.85, 0.95), (0.95, 1.001)] {
        let bin = all.iter().filter(|j| j.named && j.confidence.is_some_and(|c| (low..high).contains(&c)));
        text +=
            &format!("| {low:.2} to {:.2} | {} |\n", f64::min(high, 1.0), Share::of(bin.map(right)).cells());
    }
    text
}

/// Clear, plain and faint effects by id: which names are found and which are missed.
fn by_detail(all: &[Judgement]) -> String {
    let mut text = String::from(
        "\n## By effect\n\n| effect | clear: right | clear: family | plain: right | faint: right | faint: wrong name |\n|---|---|---|---|---|---|\n",
    );
    let mut details: Vec<&str> =
        of(all, &["clear", "plain", "faint"]).map(|j| j.answer.detail.as_str()).collect();
    details.sort_unstable();
    details.dedup();
    for detail in details {
        let count = |kind: &str, so: fn(&Judgement) -> bool| {
            let share =
                Share::of(all.iter().filter(|j| j.answer.kind == kind && j.answer.detail == detail).map(so));
            format!("{} of {}", share.hits, share.of)
        };
        text += &format!(
            "| {detail} | {} | {} | {} | {} | {} |\n",
            count("clear", |j| j.id_first),
            count("clear", |j| j.family_first),
            count("plain", |j| j.id_first),
            count("faint", |j| j.id_first),
            count("faint", |j| j.wrong_name)
        );
    }
    text
}

fn list(all: &[Judgement]) -> String {
    let mut text = String::from(
        "\n## Every case\n\n| case | kind | model | true | said | error / noise | s |\n|---|---|---|---|---|---|---|\n",
    );
    for j in all {
        let a = &j.answer;
        let size = a.effects.iter().map(|e| format!("{:.1}", e.over_noise)).collect::<Vec<_>>().join(", ");
        let size = if size.is_empty() { size } else { format!(" ({size} x noise)") };
        let truth = a.fault.as_ref().map_or_else(|| a.detail.clone(), ToString::to_string);
        let number =
            |value: Option<f64>, digits: usize| value.map_or("-".into(), |v| format!("{v:.digits$}"));
        let (ratio, seconds) = (number(j.error_ratio, 2), number(j.seconds, 1));
        text += &format!(
            "| {} | {} | {} | {truth}{size} | {} | {ratio} | {seconds} |\n",
            a.case,
            a.kind,
            a.model,
            j.said.replace('|', "/")
        );
    }
    text
}
