//! One case: what was said against what is true.

use super::diagnosis::{Diagnosis, Finding};
use crate::answer::{Answer, Effect, Fault, Reference};
use crate::catalogue::{families, family};
use serde::Deserialize;
use std::collections::BTreeSet;

/// What `scripts/prove` notes of a run.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(default)]
pub struct Timing {
    /// Wall-clock time \[s\].
    pub seconds: Option<f64>,
    /// Why there is no diagnosis.
    pub failure: Option<String>,
}

/// The judgement of a case.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Judgement {
    /// What is true.
    pub answer: Answer,
    /// What was said, in a few words.
    pub said: String,
    /// No diagnosis came.
    pub failed: bool,
    /// The verdict.
    pub verdict: String,
    /// Something is named.
    pub named: bool,
    /// A right id is named first.
    pub id_first: bool,
    /// The right family is named first.
    pub family_first: bool,
    /// The right family is among the first three names.
    pub family_three: bool,
    /// What is named is none of what is right (a family of rivals is right if one of them is).
    pub wrong_name: bool,
    /// Every concealed effect has a finding of its own with a right id.
    pub all_found: bool,
    /// A wrong name that fits the fitting runs is given.
    pub trapped: bool,
    /// Names a variable on which the effect depends; none if there is none to name.
    pub dependence: Option<bool>,
    /// Confidence of the first finding where something is named.
    pub confidence: Option<f64>,
    /// Error on the checking runs over that of noise alone, rms over channels.
    pub error_ratio: Option<f64>,
    /// All parameters that had to be found are right; none if there are none.
    pub parameters_found: Option<bool>,
    /// Per parameter with an interval, whether it holds what is true.
    pub held: Vec<bool>,
    /// Per parameter of an effect that is named as it is called, whether its interval, as one of 90 %, holds what is true.
    pub amounts_held: Vec<bool>,
    /// What is said to be wrong with the recordings is in the runs and channels that have a fault, and in no others.
    pub fault_placed: bool,
    /// Wall-clock time \[s\].
    pub seconds: Option<f64>,
}

fn right_id(finding: &Finding, effect: &Effect) -> bool {
    effect.accept.iter().any(|id| id == finding.id())
}

fn right_family(finding: &Finding, effect: &Effect) -> bool {
    let said = family(finding.id()).or(finding.family.as_deref());
    right_id(finding, effect) || said.is_some_and(|said| families(&effect.accept).contains(&said))
}

/// Judges one diagnosis; none is a failure.
#[must_use]
pub fn judge(
    answer: Answer,
    reference: &Reference,
    diagnosis: Option<&Diagnosis>,
    timing: &Timing,
) -> Judgement {
    let mut judgement = Judgement { seconds: timing.seconds, answer, ..Judgement::default() };
    let Some(diagnosis) = diagnosis else {
        judgement.failed = true;
        judgement.said = timing.failure.clone().unwrap_or_else(|| "no diagnosis".into());
        return judgement;
    };
    let effects = &judgement.answer.effects;
    let ranking = diagnosis.ranking();
    let any =
        |check: fn(&Finding, &Effect) -> bool, finding: &Finding| effects.iter().any(|e| check(finding, e));
    let first = ranking.first();
    judgement.verdict.clone_from(&diagnosis.verdict);
    judgement.named = diagnosis.names();
    judgement.id_first = first.is_some_and(|f| any(right_id, f));
    judgement.family_first = first.is_some_and(|f| any(right_family, f));
    judgement.family_three = ranking.iter().take(3).any(|f| any(right_family, f));
    let rivals = first.map(|f| f.alternatives.as_slice()).unwrap_or_default();
    let rival_right = diagnosis.verdict == "family" && rivals.iter().any(|f| any(right_id, f));
    judgement.wrong_name = judgement.named && !judgement.id_first && !rival_right;
    judgement.all_found = !effects.is_empty() && assign(effects, &diagnosis.findings);
    judgement.trapped =
        judgement.named && first.is_some_and(|f| judgement.answer.decoys.iter().any(|d| d == f.id()));
    judgement.dependence = dependence(effects, diagnosis);
    judgement.confidence = first.and_then(|f| f.confidence);
    judgement.error_ratio = error_ratio(reference, diagnosis);
    judgement.parameters_found = parameters_found(&judgement.answer, diagnosis);
    judgement.held = held(&judgement.answer, diagnosis);
    judgement.amounts_held = amounts_held(effects, diagnosis);
    judgement.fault_placed = judgement.answer.fault.as_ref().is_some_and(|f| placed(f, &diagnosis.faults));
    judgement.said = said(diagnosis);
    judgement
}

/// Every effect gets a finding that no other one has.
fn assign(effects: &[Effect], findings: &[Finding]) -> bool {
    let Some((effect, rest)) = effects.split_first() else { return true };
    (0..findings.len()).any(|k| {
        let mut others = findings.to_vec();
        right_id(&others.remove(k), effect) && assign(rest, &others)
    })
}

fn dependence(effects: &[Effect], diagnosis: &Diagnosis) -> Option<bool> {
    let wanted: Vec<String> = effects.iter().flat_map(|e| &e.depends_on).map(|s| s.to_lowercase()).collect();
    if wanted.is_empty() {
        return None;
    }
    let said =
        diagnosis.findings.iter().flat_map(|f| &f.depends_on).map(|s| s.to_lowercase().replace('-', "_"));
    Some(
        said.into_iter().any(|s| wanted.iter().any(|w| s == *w || s.split([' ', ',']).any(|part| part == w))),
    )
}

/// rms over the channels of (error after correction / noise), over the runs that were for checking.
#[allow(clippy::cast_precision_loss)] // thousands
fn error_ratio(reference: &Reference, diagnosis: &Diagnosis) -> Option<f64> {
    let stem = |name: &str| name.rsplit('/').next().unwrap_or(name).trim_end_matches(".csv").to_owned();
    let checking: Vec<String> =
        diagnosis.runs.iter().filter(|r| r.used == "check").map(|r| stem(&r.name)).collect();
    let mut squares = Vec::new();
    for check in &diagnosis.check {
        let (mut sum, mut samples) = (0.0, 0.0);
        for run in reference.runs.iter().filter(|r| checking.contains(&stem(&r.name))) {
            if let Some((_, square)) = run.channels.iter().find(|(name, _)| *name == check.channel) {
                sum += square * run.samples as f64;
                samples += run.samples as f64;
            }
        }
        if let (Some(after), true) = (check.after, sum > 0.0) {
            squares.push(after * after * samples / sum);
        }
    }
    let count = squares.len() as f64;
    (!squares.is_empty()).then(|| (squares.iter().sum::<f64>() / count).sqrt())
}

fn parameters_found(answer: &Answer, diagnosis: &Diagnosis) -> Option<bool> {
    let found = |(name, off): &(String, f64)| {
        let truth = answer.parameters.iter().find(|p| p.name == *name)?;
        let value = diagnosis.parameters.iter().find(|p| p.name == *name)?.value?;
        Some((value / truth.value - 1.0).abs() <= *off)
    };
    (!answer.to_find.is_empty()).then(|| answer.to_find.iter().all(|p| found(p).unwrap_or(false)))
}

fn held(answer: &Answer, diagnosis: &Diagnosis) -> Vec<bool> {
    let truth = |name: &str| answer.parameters.iter().find(|p| p.name == name).map(|p| p.value);
    let of = |p: &super::Parameter| {
        let (low, high, truth) = (p.low?, p.high?, truth(&p.name)?);
        Some(low <= truth && truth <= high)
    };
    diagnosis.parameters.iter().filter_map(of).collect()
}

/// Ends of a 90 % interval of a normal deviation over those of a 95 % one.
const NARROWER: f64 = 1.644_85 / 1.959_96;

fn amounts_held(effects: &[Effect], diagnosis: &Diagnosis) -> Vec<bool> {
    let of = |effect: &Effect| -> Vec<bool> {
        let found = diagnosis.findings.iter().filter(|f| f.id() == effect.id);
        // which of two of one name is meant, is not known
        let [finding] = found.collect::<Vec<_>>()[..] else { return Vec::new() };
        let held = |p: &super::Parameter| {
            let truth = effect.amounts.iter().find(|(name, _)| *name == p.name)?.1;
            let (value, low, high) = (p.value?, p.low?, p.high?);
            Some(value + NARROWER * (low - value) <= truth && truth <= value + NARROWER * (high - value))
        };
        finding.parameters.iter().filter_map(held).collect()
    };
    effects.iter().flat_map(of).collect()
}

/// Whether what was said of the recordings is about what the fault struck: of the channels that it is in one at least and no
/// others, and of the runs all and no others. Of copies, the one or the other will do.
fn placed(truth: &Fault, said: &[super::Fault]) -> bool {
    let stem = |name: &String| name.trim_end_matches(".csv").to_owned();
    let wanted: BTreeSet<String> = truth.runs.iter().map(stem).collect();
    let runs: BTreeSet<String> = said.iter().flat_map(|f| &f.runs).map(stem).collect();
    let right_runs = if truth.name == "duplicated" {
        !runs.is_empty() && runs.is_subset(&wanted)
    } else {
        wanted.is_empty() || runs == wanted
    };
    // exchanged channels are named together
    let mut channels = said.iter().filter_map(|f| f.channel.as_ref()).flat_map(|c| c.split(", ")).peekable();
    let right_channels = truth.channels.is_empty()
        || channels.peek().is_some() && channels.all(|c| truth.channels.iter().any(|t| t == c));
    !said.is_empty() && right_runs && right_channels
}

fn said(diagnosis: &Diagnosis) -> String {
    let name = |f: &Finding| {
        let confidence = f.confidence.map_or(String::new(), |c| format!(" ({c:.2})"));
        let on = if f.id().is_empty() { f.depends_on.join(", ") } else { f.id().to_owned() };
        on + &confidence
    };
    let all: Vec<String> = diagnosis.findings.iter().map(name).collect();
    format!("{} {}", diagnosis.verdict, all.join(" + ")).trim_end().to_owned()
}
