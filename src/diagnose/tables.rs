//! What a diagnosis tells in numbers and sentences: estimates, errors, traces, the summary.

use super::negligible::negligible;
use super::off_data;
use super::pipeline::CheckTraces;
use super::placement::Placement;
use super::reading::Recorded;
use super::rest::{Noise, Rest};
use super::result::{ChannelCheck, Diagnosis, Estimate, Finding, Fitted as FittedParameter, Verdict};
use super::roles::Roles;
use super::study::{Fitted, Model, Study};
use super::subject::Subject;
use crate::Result;
use crate::effect::Role;
use crate::fit::Covariance;
use crate::model::Causality;
use crate::recording::Recording;

/// The 95 % interval of a number whose logarithm is an unknown.
type OfExponential = fn(&Covariance, usize, f64) -> Option<[f64; 2]>;

/// Parameters of the last effect with the intervals that linear residuals give, in which the search compares what is beside each other.
pub(super) fn estimates(study: &Study<'_>, fitted: &Fitted) -> Vec<Estimate> {
    let linear: OfExponential =
        |covariance, unknown, value| Some(covariance.interval_of_exponential(unknown, value));
    estimates_by(study, fitted, linear).pop().unwrap_or_default()
}

/// Parameters of all effects with the 95 % intervals that are told.
pub(super) fn all_estimates(study: &Study<'_>, fitted: &Fitted) -> Vec<Vec<Estimate>> {
    estimates_by(study, fitted, Covariance::interval_however_counted)
}

fn estimates_by(study: &Study<'_>, fitted: &Fitted, of_exponential: OfExponential) -> Vec<Vec<Estimate>> {
    let covariance = study.covariance(fitted);
    let mut first = study.own();
    let mut all = Vec::new();
    for (placement, values) in &fitted.model.effects {
        all.push(estimates_of(placement, values, &covariance, first, of_exponential));
        first += values.len();
    }
    all
}

fn estimates_of(
    placement: &Placement,
    values: &[f64],
    covariance: &Covariance,
    first: usize,
    of_exponential: OfExponential,
) -> Vec<Estimate> {
    placement
        .effect
        .parameters
        .iter()
        .enumerate()
        .map(|(i, p)| {
            let scale = placement.scales[i];
            let (low, high) = p.search;
            let (ends, room) = if p.is_logarithmic() {
                (of_exponential(covariance, first + i, values[i]), (high / low).ln())
            } else {
                (Some(covariance.interval(first + i, values[i])), high - low)
            };
            let ends = ends.filter(|_| covariance.is_within(first + i, room));
            Estimate {
                name: p.name.into(),
                value: values[i] * scale,
                low: ends.map(|ends| ends[0].max(low) * scale),
                high: ends.map(|ends| ends[1].min(high) * scale),
                unit: placement.units[i].clone().unwrap_or_else(|| "1".into()),
            }
        })
        .collect()
}

pub(super) fn fitted_parameters(
    study: &Study<'_>,
    subject: &Subject,
    fitted: &Fitted,
) -> Vec<FittedParameter> {
    let covariance = study.covariance(fitted);
    let held = fitted.fit.held_by_bounds(&fitted.unknowns);
    let of = |(i, p): (usize, &super::subject::FreeParameter)| {
        let x = fitted.model.parameters[i];
        let known = covariance.is_told(i, &fitted.unknowns[i]);
        let info = &subject.interface.variables[p.variable];
        let ends = covariance.interval(i, x).map(|end| end * p.scale);
        FittedParameter {
            name: info.name.clone(),
            start: p.nominal,
            value: x * p.scale,
            low: known.then_some(ends[0].min(ends[1])),
            high: known.then_some(ends[0].max(ends[1])),
            unit: info.unit.clone().unwrap_or_else(|| "1".into()),
            held_at: held.contains(&i).then_some(x * p.scale),
        }
    };
    study.free.iter().enumerate().map(of).collect()
}

/// What channels show at zero.
pub(super) fn zeros(study: &Study<'_>, subject: &Subject, fitted: &Fitted) -> Vec<Estimate> {
    let covariance = study.covariance(fitted);
    let channels = study.fit_runs.first().map_or(&[][..], |run| &run.channels[..]);
    let of = |(k, (channel, most)): (usize, &(usize, f64))| {
        let info = &subject.interface.variables[channels.get(*channel)?.variable];
        let i = study.free.len() + 1 + k;
        let x = fitted.model.parameters[i];
        let ends = covariance.interval(i, x).map(|end| end * most);
        Some(Estimate {
            name: info.name.clone(),
            value: x * most,
            low: Some(ends[0]),
            high: Some(ends[1]),
            unit: info.unit.clone().unwrap_or_else(|| "1".into()),
        })
    };
    study.zeros.iter().enumerate().filter_map(of).collect()
}

/// What a reader has to know of parameters that ended at a bound, and of forces that could not be looked for.
pub(super) fn cautions(diagnosis: &Diagnosis, subject: &Subject, roles: &Roles) -> Vec<String> {
    let mut notes: Vec<String> = diagnosis
        .held()
        .map(|p| {
            format!(
                "{} ended at {:.3e} {}, the bound of its range: its range is too narrow ([fit] can give another), or it stands in for what is missing.",
                p.name, p.value, p.unit
            )
        })
        .collect();
    let takes_forces = |v: usize| {
        let info = &subject.interface.variables[v];
        info.causality == Causality::Input && info.is_real() && roles.is(v, Role::Force)
    };
    if diagnosis.verdict == Verdict::Unknown && !(0..subject.interface.variables.len()).any(takes_forces) {
        notes.push(
            "The model has no input for a force or moment: friction, stops, springs and all else that would push at its parts could not be tried. An input in N or N.m that is zero by itself lets them in."
                .into(),
        );
    }
    notes
}

pub(super) fn channel_checks(
    study: &Study<'_>,
    subject: &Subject,
    before: &Rest,
    after: &Rest,
    after_fit: &Rest,
) -> Vec<ChannelCheck> {
    let channels = study.check_runs.first().map_or(&[][..], |r| &r.channels[..]);
    let noise = study.noise(after_fit, after);
    let noise_of = |c: usize| {
        let (noise, least) = (noise.get(c).and_then(Noise::least), negligible(&study.check_runs, c));
        // of an error that says nothing the noise is not missed
        let noise = noise.or_else(|| (!study.says_something(&study.check_runs, after, c)).then_some(least));
        noise.map(|noise| noise.max(least))
    };
    let of = |(c, channel): (usize, &crate::fit::Channel)| {
        let info = &subject.interface.variables[channel.variable];
        ChannelCheck {
            channel: info.name.clone(),
            unit: info.unit.clone().unwrap_or_else(|| "1".into()),
            before: study.error(before, c),
            after: study.error(after, c),
            noise: noise_of(c),
        }
    };
    channels.iter().enumerate().map(of).collect()
}

pub(super) fn traces(
    study: &Study<'_>,
    subject: &Subject,
    base: &Model,
    corrected: &Model,
    recorded: &Recorded,
) -> Result<Vec<CheckTraces>> {
    let before = study.rest(base, &study.check_runs)?;
    let after = study.rest(corrected, &study.check_runs)?;
    let mut check = Vec::new();
    for (k, run) in study.check_runs.iter().enumerate() {
        let Some(original) = recorded.of(run) else { continue };
        let unit = |v: usize| subject.interface.variables[v].unit.clone().unwrap_or_else(|| "1".into());
        let name = |v: usize| subject.interface.variables[v].name.clone();
        // of a run that was cut the end is for checking
        let first = original.time.len().saturating_sub(run.time.len());
        let source = match run.time.first() {
            Some(time) if first > 0 => format!("{} from {time:.2} s on", run.name),
            _ => run.name.clone(),
        };
        let record = |traces: &[Vec<f64>]| Recording {
            time: run.time.clone(),
            channels: run
                .channels
                .iter()
                .zip(traces)
                .map(|(c, values)| crate::recording::Channel {
                    name: name(c.variable),
                    unit: unit(c.variable),
                    values: values.clone(),
                })
                .collect(),
            source: source.clone(),
        };
        let mut measured = record(&run.channels.iter().map(|c| c.values.clone()).collect::<Vec<_>>());
        for channel in &original.channels {
            if !measured.has(&channel.name) {
                let values = channel.values[first..].to_vec();
                measured.channels.push(crate::recording::Channel { values, ..channel.clone() });
            }
        }
        check.push(CheckTraces {
            measured,
            before: record(&before.simulated[k]),
            after: record(&after.simulated[k]),
        });
    }
    Ok(check)
}

/// The answer in sentences; `given` are the names of given values that are fitted because they were found to be off.
pub(super) fn summary(
    diagnosis: &Diagnosis,
    (nominal, base, after): (f64, f64, f64),
    given: &[&str],
) -> String {
    if let Some(without) = &diagnosis.without_faults {
        let rest = Diagnosis { verdict: without.verdict, without_faults: None, ..diagnosis.clone() };
        let rest = summary(&rest, (nominal, base, after), given);
        return format!("{} Without {}: {rest}", at_fault(diagnosis), without.words());
    }
    let root = |a: f64, b: f64| 100.0 * (1.0 - (a / b.max(f64::MIN_POSITIVE)).sqrt());
    let gain = root(after, base);
    let name = |f: &Finding| format!("{} ({})", f.name, f.place);
    let all = |findings: &[Finding]| findings.iter().map(name).collect::<Vec<_>>().join("; then ");
    match (diagnosis.verdict, &diagnosis.findings[..]) {
        (Verdict::Recording, _) => at_fault(diagnosis),
        (Verdict::Parameters, _) => {
            let held: Vec<&str> = diagnosis.held().map(|p| p.name.as_str()).collect();
            let off: Vec<String> = (diagnosis.parameters.iter())
                .filter(|p| given.contains(&p.name.as_str()))
                .map(|p| format!("the given {}", off_data::in_words(p)))
                .collect();
            let off = match (&off[..], &held[..]) {
                ([], []) => {
                    "The parameters were off, nothing is missing: refitted on other runs they".to_owned()
                }
                ([], held) => format!(
                    "The parameters were off, or stand in for what is missing ({} ended at a bound): refitted on other runs they",
                    held.join(", ")
                ),
                (off, _) => format!(
                    "Nothing is missing, but {}: refitted with it on other runs the parameters",
                    off.join(" and ")
                ),
            };
            format!(
                "{off} lower the error of the check runs by {:.0} %. {}",
                root(base, nominal),
                what_remains(&diagnosis.check)
            )
        }
        (Verdict::Effect, findings) => format!(
            "The model lacks: {}. With {} the error of the check runs is {gain:.0} % lower than after refitting the parameters alone.",
            all(findings),
            if findings.len() > 1 { "them" } else { "it" }
        ),
        (Verdict::Family, [first, ..]) => {
            let others: Vec<String> =
                first.alternatives.iter().map(|a| format!("{} ({})", a.effect, a.place)).collect();
            format!(
                "The model lacks one of these, which the recordings do not tell apart: {}; {}. With the first the error of the check runs is {gain:.0} % lower than after refitting the parameters alone.",
                name(first),
                others.join("; ")
            )
        }
        (Verdict::Unknown, [first, names @ ..]) => {
            unknown(first, &all(names), gain, diagnosis.is_mostly_named())
        }
        _ => {
            let parameters =
                if diagnosis.held().next().is_some() { "" } else { " Its parameters need no change." };
            format!(
                "Nothing is missing: the model explains the check runs as well as anything that was tried.{parameters}"
            )
        }
    }
}

/// A sentence on what no name explains, where nothing is missing.
fn what_remains(check: &[ChannelCheck]) -> String {
    let times = |c: &ChannelCheck| c.noise.filter(|n| *n > 0.0).map(|noise| c.after / noise);
    let most = check.iter().map(times).collect::<Option<Vec<f64>>>().unwrap_or_default();
    match most.into_iter().reduce(f64::max) {
        Some(most) => {
            format!(
                "What remains is in no channel more than {:.1} times its noise.",
                (10.0 * most).ceil() / 10.0
            )
        }
        None => "Nothing in the catalogue and no function of a signal explains more.".into(),
    }
}

fn at_fault(diagnosis: &Diagnosis) -> String {
    let words: Vec<&str> = diagnosis.faults.iter().take(2).map(|f| f.text.as_str()).collect();
    let not_the_model = if diagnosis.findings.is_empty() { ", not the model" } else { "" };
    format!("A recording is at fault{not_the_model}: {}", words.join(" "))
}

/// The sentences of what has no name, with the names that stand beside it.
fn unknown(finding: &Finding, names: &str, gain: f64, is_mostly_named: bool) -> String {
    let on = |nothing: &str| match &finding.depends_on[..] {
        [] => nothing.to_owned(),
        signals => signals.join(", "),
    };
    if !finding.parameters.is_empty() {
        let beside = if names.is_empty() { String::new() } else { format!(", together with {names},") };
        return format!(
            "Something is missing that has no name here; it acts at {} and depends on {}. An empirical function of that lowers{beside} the error of the check runs by {gain:.0} %.",
            finding.place,
            on("time")
        );
    }
    let errs = match finding.channels.len() {
        0 | 1 => "has an error that is no noise and depends",
        _ => "have errors in common that depend",
    };
    let left = |left: &str| {
        let signals = on("nothing that was recorded");
        format!("{left}: {} {errs} on {signals}.", finding.channels.join(" and "))
    };
    if is_mostly_named {
        return format!(
            "The model lacks {names}, or what looks alike: with that the error of the check runs is {gain:.0} % lower than after refitting the parameters alone. {}",
            left("Something that has no name here is left")
        );
    }
    let explained = if names.is_empty() {
        "Nothing that was tried explains that on other runs, so the model is only refitted.".to_owned()
    } else {
        format!(
            "With {names} the error of the check runs is {gain:.0} % lower than after refitting the parameters alone; that is not all, and may be something else that looks alike."
        )
    };
    format!("{} {explained}", left("Something is missing that has no name here"))
}

pub(super) fn next_experiment(diagnosis: &Diagnosis) -> String {
    let Some(first) = diagnosis.findings.first() else { return String::new() };
    let lead = |id: &str, other: &str| {
        let effect = crate::effect::find(id)?;
        effect
            .confused_with
            .iter()
            .find(|(o, _)| *o == other)
            .map(|(_, how)| format!("{id} or {other}: {how}"))
    };
    let hints: Vec<String> = first
        .alternatives
        .iter()
        .filter_map(|a| lead(&first.effect, &a.effect).or_else(|| lead(&a.effect, &first.effect)))
        .collect();
    hints.join("; ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_remains_is_told_in_units_of_noise_and_never_less_than_it_is() {
        let check = |after: f64, noise| ChannelCheck { after, noise, ..ChannelCheck::default() };
        let told = |check: &[ChannelCheck]| what_remains(check);
        assert!(told(&[check(1.0, Some(1.0)), check(2.26, Some(2.0))]).contains("more than 1.2 times"));
        // of a channel whose noise is not known nothing of the kind is said
        assert!(told(&[check(1.0, Some(1.0)), check(1.0, None)]).starts_with("Nothing in the catalogue"));
    }
}
