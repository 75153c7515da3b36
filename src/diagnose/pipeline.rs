//! The chain from recordings to a verdict.

use super::blocks::{bootstrap_shares, sign_flip};
use super::placement::{Placement, Site, is_tunable, sizes};
use super::result::{
    Alternative, Candidate, ChannelCheck, Diagnosis, Estimate, Finding, Fitted as FittedParameter, RunUse,
    Use, Verdict,
};
use super::roles::Roles;
use super::runs::{Map, prepare, uses};
use super::screen::{Screen, Screened};
use super::study::{Fitted, Model, Rest, Study, first_weights};
use super::subject::Subject;
use super::{hygiene, locate};
use crate::effect::{Effect, catalogue, empirical};
use crate::fit::{Bench, Drive, Run};
use crate::model::{Causality, Settings};
use crate::recording::Recording;
use crate::{Error, Result};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Named effects that are fitted inside the simulation.
const NAMED: usize = 7;
/// Empirical functions that are fitted as rivals.
const UNNAMED: usize = 3;
/// Runs that effects are screened with.
const SCREENED: usize = 4;
/// Effects that are found one after the other.
const MAX_EFFECTS: usize = 3;
/// Probability of chance below which a gain on the check runs counts, for all that were fitted together.
const LEVEL: f64 = 0.05;
/// An effect that promises less of the squared error of the fit runs is not fitted.
const MIN_PROMISE: f64 = 0.005;
/// A gain on the check runs below this share of the squared error is not worth a name.
const MIN_GAIN: f64 = 0.01;
/// A rest that an empirical function explains, as a share of what the named effects explain, above which
/// the names are not enough.
const LEFT_OVER: f64 = 0.2;
/// A lag of all channels up to this share of the sampling interval is the recorder's filter, no finding.
const RECORDER_LAG: f64 = 0.3;
/// A rival is as good if chance makes such a difference with more than this probability.
const TIE: f64 = 0.05;

/// What is to be diagnosed.
#[derive(Debug, Clone, Default)]
pub struct Request {
    /// A shipped model, an FMU, a system.
    pub model: String,
    /// Its parameters, and which of them may be fitted.
    pub settings: Settings,
    /// Folder of the recordings.
    pub recordings: PathBuf,
    /// What the channels are.
    pub map: Map,
    /// Communication step \[s\], if not the one that suits model and recording.
    pub step: Option<f64>,
    /// Runs at the same time; 0: as many as there are cores.
    pub threads: usize,
}

/// What came out.
pub struct Outcome {
    /// The verdict and all that led to it.
    pub diagnosis: Diagnosis,
    /// The model that was diagnosed.
    pub subject: Subject,
    /// The corrected model: fitted parameters by index.
    pub parameters: Vec<(usize, f64)>,
    /// The corrected model: its effects.
    pub attachments: Vec<crate::effect::Attachment>,
    /// 95 % intervals of their parameters, where the recordings fix them.
    pub intervals: Vec<Vec<Option<(f64, f64)>>>,
    /// The check runs: as measured, with the refitted model, with the corrected model.
    pub check: Vec<CheckTraces>,
}

/// A check run, measured and simulated.
pub struct CheckTraces {
    /// As recorded, inputs and outputs, in the units of the model.
    pub measured: Recording,
    /// The refitted model's outputs at the same times.
    pub before: Recording,
    /// The corrected model's.
    pub after: Recording,
}

/// A candidate that was fitted.
struct Tried {
    placement: Placement,
    fitted: Fitted,
    fit_rest: Rest,
    check_rest: Rest,
    fit_gain: f64,
    check_gain: f64,
    p: f64,
    /// Why it may not be named, if so.
    refuted: Option<String>,
}

/// Diagnoses a model against a folder of recordings. `progress` is told what is being done and how far
/// it is, from 0 to 1.
///
/// # Errors
/// Files that cannot be read or do not fit each other, a model that cannot be run.
pub fn diagnose(request: &Request, progress: &mut dyn FnMut(&str, f64)) -> Result<Outcome> {
    progress("reading", 0.0);
    let subject = Subject::load(&request.model, &request.settings)?;
    let (names, raw) = read_folder(&request.recordings, &request.map)?;
    let mut faults = hygiene::faults_of_runs(&raw);
    let recordings: Vec<Recording> = raw.into_iter().map(|r| r.recording).collect();
    let uses = uses(&request.recordings, &names)?;
    let roles = Roles::of(&subject.interface, &request.map.roles())?;
    let mut runs: Vec<(Run, Use)> = Vec::new();
    for ((name, recording), use_) in names.iter().zip(&recordings).zip(&uses) {
        if *use_ != Use::Leave {
            runs.push((prepare(&subject.interface, recording, name, request.step)?, *use_));
        }
    }
    same_channels(&subject, &runs)?;
    let threads = if request.threads > 0 {
        request.threads
    } else {
        std::thread::available_parallelism().map_or(1, usize::from)
    };
    let bench = Bench::new(&subject.factory, &subject.fixed, threads)?;
    let with = |wanted: Use| runs.iter().filter(|(_, u)| *u == wanted).map(|(r, _)| r).collect::<Vec<&Run>>();
    let mut study = Study {
        bench: &bench,
        fit_runs: with(Use::Fit),
        check_runs: with(Use::Check),
        free: Vec::new(),
        lag: 0.0,
        weights: Vec::new(),
        redundancy: 1.0,
    };
    let check_runs = study.check_runs.clone();
    let fit_runs = study.fit_runs.clone();
    study.weights = first_weights(&fit_runs);
    study.lag = RECORDER_LAG * shortest_interval(&fit_runs);

    progress("fitting the model's own parameters", 0.05);
    study.choose_free(&subject.free)?;
    let nominal = study.nominal();
    let mut base = study.fit(&nominal, 8)?;
    for _ in 0..2 {
        let rest = study.rest(&base.model, &fit_runs)?;
        study.weigh(&fit_runs, &rest);
        base = study.fit(&base.model, 6)?;
    }
    let nominal_rest = study.rest(&nominal, &check_runs)?;
    let base_rest = study.rest(&base.model, &check_runs)?;

    // a command may rest as long as it likes, at the end of its range too
    let is_input = |name: &String| {
        subject
            .interface
            .index(name)
            .is_some_and(|v| subject.interface.variables[v].causality == Causality::Input)
    };
    faults.retain(|f| {
        !(matches!(f.kind, hygiene::FaultKind::Stuck | hygiene::FaultKind::Saturated)
            && f.channel.as_ref().is_some_and(is_input))
    });
    let all_runs: Vec<&Run> = runs.iter().map(|(run, _)| run).collect();
    faults.extend(faults_against(&study, &subject, &base.model, &all_runs, &recordings, &names)?);
    let fatal = faults.iter().any(|f| f.severity == hygiene::Severity::Fatal);

    let mut candidates: Vec<Candidate> = Vec::new();
    let mut current = base;
    let mut current_check = base_rest.clone();
    let mut current_fit = study.rest(&current.model, &fit_runs)?;
    let base_model = current.model.clone();
    let mut findings: Vec<Finding> = Vec::new();
    let mut unknown: Option<Finding> = None;
    for round in 0..if fatal { 0 } else { MAX_EFFECTS } {
        let progressed = 0.15 + 0.8 * round as f64 / MAX_EFFECTS as f64;
        progress("screening effects", progressed);
        let screened = screen(&study, &subject, &roles, &current)?;
        progress("fitting effects inside the simulation", progressed + 0.05);
        let mut tried = Vec::new();
        for screened in choose(&screened) {
            if let Some(t) = try_out(&study, &current.model, &screened, &current_fit, &current_check) {
                tried.push(t);
            }
        }
        let verdict = decide(&study, &subject, &tried, &current_check, &base_rest, round, &mut candidates);
        match verdict {
            Decision::Nothing => break,
            Decision::Named(i, finding) => {
                findings.push(finding);
                let t = tried.swap_remove(i);
                current_check = t.check_rest;
                current_fit = t.fit_rest;
                current = t.fitted;
            }
            Decision::Unnamed(i, finding) => {
                unknown = Some(finding);
                let t = tried.swap_remove(i);
                current_check = t.check_rest;
                current = t.fitted;
                break;
            }
        }
    }
    let fine: Vec<(Run, Use)>;
    if !current.model.effects.is_empty() {
        // effects act at communication points: what is handed on is fitted where shorter steps change nothing
        progress("fitting the corrected model with short steps", 0.9);
        fine = runs.iter().map(|(run, use_)| (finer(run), *use_)).collect();
        let of =
            |wanted: Use| fine.iter().filter(|(_, u)| *u == wanted).map(|(r, _)| r).collect::<Vec<&Run>>();
        study.fit_runs = of(Use::Fit);
        study.check_runs = of(Use::Check);
        current = study.fit(&current.model, 4)?;
        current_check = study.rest(&current.model, &study.check_runs)?;
        for (finding, estimates) in
            findings.iter_mut().chain(&mut unknown).zip(all_estimates(&study, &current))
        {
            finding.parameters = estimates;
        }
    }
    progress("locating what is left", 0.93);
    // sensors have noise of their own: what their residuals share has a cause in the machine
    let left = study.check_runs.clone();
    let common = if findings.is_empty() && unknown.is_none() && !fatal {
        locate::common_cause(&left, &current_check.simulated)
    } else {
        None
    };
    if let Some(common) = &common {
        unknown = Some(unnamed(&study, &subject, &roles, common, &current_check));
    }
    let noise: Vec<Option<f64>> =
        (0..study.weights.len()).map(|c| locate::noise(&check_runs, &base_rest.simulated, c)).collect();
    let map = locate::map(&check_runs, &base_rest.simulated, &subject.interface, &roles, &noise);
    progress("writing it down", 0.95);
    let improved = sign_flip(&differences(&nominal_rest.blocks, &base_rest.blocks));
    let verdict = match (&findings[..], &unknown) {
        _ if fatal => Verdict::Recording,
        // what was mended explains what is seen if nothing else does
        ([], None) if faults.iter().any(hygiene::Fault::counts) => Verdict::Recording,
        (_, Some(_)) => Verdict::Unknown,
        ([], None) if improved < LEVEL && base_rest.total < 0.98 * nominal_rest.total => Verdict::Parameters,
        ([], None) => Verdict::Nothing,
        ([first, ..], None) if first.alternatives.iter().any(|a| a.confidence > 0.25) => Verdict::Family,
        _ => Verdict::Effect,
    };
    if let Some(finding) = unknown {
        findings.insert(0, finding);
    }
    let mut diagnosis = Diagnosis {
        verdict,
        findings,
        check: channel_checks(&study, &subject, &base_rest, &current_check),
        parameters: fitted_parameters(&study, &subject, &current),
        candidates,
        map,
        faults: faults.iter().filter(|f| f.counts()).map(fault).collect(),
        runs: names
            .iter()
            .zip(&uses)
            .map(|(name, use_)| RunUse { name: name.clone(), use_: *use_ })
            .collect(),
        ..Diagnosis::default()
    };
    let total = (nominal_rest.total, base_rest.total, current_check.total);
    diagnosis.summary = summary(&diagnosis, total);
    diagnosis.next_experiment = next_experiment(&diagnosis);
    let check = traces(&study, &subject, &base_model, &current.model, &recordings, &names)?;
    let parameters =
        study.free.iter().zip(&current.model.parameters).map(|(p, x)| (p.variable, p.scale * x)).collect();
    let attachments = current.model.effects.iter().flat_map(|(p, v)| p.attach(v)).collect();
    let ends = |e: &Estimate| Some((e.low?, e.high?));
    let mut intervals = Vec::new();
    for ((placement, _), estimates) in current.model.effects.iter().zip(all_estimates(&study, &current)) {
        let own: Vec<_> = estimates.iter().map(ends).collect();
        // one attachment for each place
        intervals.extend(placement.targets.iter().map(|_| own.clone()));
    }
    Ok(Outcome { diagnosis, parameters, attachments, intervals, check, subject })
}

fn read_folder(folder: &Path, map: &Map) -> Result<(Vec<String>, Vec<hygiene::RawRecording>)> {
    let place = folder.display();
    let entries =
        std::fs::read_dir(folder).map_err(|e| Error::file(format!("{place} cannot be read: {e}")))?;
    let mut files: Vec<PathBuf> = entries
        .filter_map(|e| e.ok().map(|e| e.path()))
        .filter(|p| p.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv")))
        .collect();
    files.sort();
    if files.is_empty() {
        return Err(Error::file(format!("{place}: there is no recording, that is no file *.csv")));
    }
    let mut recordings = Vec::new();
    for file in &files {
        let mut raw = hygiene::read_raw(file)?;
        map.apply(&mut raw.recording);
        recordings.push(raw);
    }
    let name = |p: &PathBuf| p.file_name().unwrap_or_default().to_string_lossy().into_owned();
    Ok((files.iter().map(name).collect(), recordings))
}

/// Something that is missing in the dynamics and that nothing explains.
fn unnamed(
    study: &Study<'_>,
    subject: &Subject,
    roles: &Roles,
    common: &locate::Common,
    rest: &Rest,
) -> Finding {
    let names: Vec<String> =
        common.channels.iter().map(|v| subject.interface.variables[*v].name.clone()).collect();
    Finding {
        effect: "unknown".into(),
        name: "Something in the machine that several channels share".into(),
        family: "unknown".into(),
        place: format!("outputs {}", names.join(", ")),
        channels: names,
        depends_on: locate::depends_on(&study.check_runs, &rest.simulated, &subject.interface, roles),
        confidence: 0.9,
        evidence: format!(
            "{:.0} % of what is left in these channels between {:.3} and {:.3} Hz is coherent, which noise of separate sensors is not; chance does so with a probability of {:.1e}.",
            100.0 * common.share,
            common.band.0,
            common.band.1,
            common.p
        ),
        ..Finding::default()
    }
}

/// Faults that show against the refitted model.
fn faults_against(
    study: &Study<'_>,
    subject: &Subject,
    model: &Model,
    runs: &[&Run],
    recordings: &[Recording],
    names: &[String],
) -> Result<Vec<hygiene::Fault>> {
    let rest = study.rest(model, runs)?;
    let (mut measured, mut simulated) = (Vec::new(), Vec::new());
    let Some(first) = runs.first() else { return Ok(Vec::new()) };
    let name = |v: usize| subject.interface.variables[v].name.clone();
    let unit = |v: usize| subject.interface.variables[v].unit.clone().unwrap_or_else(|| "1".into());
    for (run, traces) in runs.iter().zip(&rest.simulated) {
        let Some(original) = names.iter().position(|n| *n == run.name).and_then(|i| recordings.get(i)) else {
            continue;
        };
        let channel = |(c, values): (&crate::fit::Channel, &Vec<f64>)| crate::recording::Channel {
            name: name(c.variable),
            unit: unit(c.variable),
            values: values.clone(),
        };
        let mut own = original.clone();
        for c in &run.channels {
            if let Some(channel) = own.channels.iter_mut().find(|o| o.name == name(c.variable)) {
                channel.values.clone_from(&c.values);
                channel.unit = unit(c.variable);
            }
        }
        measured.push(own);
        simulated.push(Recording {
            time: run.time.clone(),
            channels: run.channels.iter().zip(traces).map(channel).collect(),
            source: original.source.clone(),
        });
    }
    let channels: Vec<String> = first.channels.iter().map(|c| name(c.variable)).collect();
    Ok(hygiene::faults_against(&measured, &simulated, &channels))
}

fn fault(fault: &hygiene::Fault) -> super::result::Fault {
    super::result::Fault {
        kind: serde_json::to_value(fault.kind)
            .ok()
            .and_then(|v| v.as_str().map(str::to_owned))
            .unwrap_or_default(),
        runs: fault.runs.clone(),
        channel: fault.channel.clone(),
        text: format!("{} {}", fault.evidence, fault.advice),
    }
}

fn same_channels(subject: &Subject, runs: &[(Run, Use)]) -> Result<()> {
    let Some((first, _)) = runs.first() else { return Ok(()) };
    let list = |run: &Run| run.channels.iter().map(|c| c.variable).collect::<Vec<_>>();
    for (run, _) in runs {
        if list(run) != list(first) {
            let name = |v: &usize| subject.interface.variables[*v].name.clone();
            let words = |run: &Run| list(run).iter().map(name).collect::<Vec<_>>().join(", ");
            return Err(Error::file(format!(
                "{} has the measured channels {}, {} has {}: all runs need the same; leave runs out in runs.toml or channels out in a map",
                first.name,
                words(first),
                run.name,
                words(run)
            )));
        }
    }
    Ok(())
}

/// Runs for screening: a few, spread evenly.
fn some_of<'a>(runs: &[&'a Run]) -> Vec<&'a Run> {
    let n = runs.len().min(SCREENED);
    (0..n).map(|i| runs[(2 * i + 1) * runs.len() / (2 * n)]).collect()
}

/// The same run with a quarter of the communication step.
fn finer(run: &Run) -> Run {
    const PARTS: usize = 4;
    let drive = &run.drive;
    let points = (drive.points - 1) * PARTS + 1;
    let refine = |values: &Vec<f64>| {
        (0..points)
            .map(|k| {
                let (i, part) = (k / PARTS, k % PARTS);
                let next = values[(i + 1).min(values.len() - 1)];
                if part == 0 {
                    values[i]
                } else {
                    values[i] + (next - values[i]) * part as f64 / PARTS as f64
                }
            })
            .collect()
    };
    let drive = Drive {
        start: drive.start,
        step: drive.step / PARTS as f64,
        inputs: drive.inputs.iter().map(|(v, values)| (*v, refine(values))).collect(),
        points,
    };
    Run { drive: Arc::new(drive), ..run.clone() }
}

/// The shortest of the runs' median sampling intervals \[s\].
fn shortest_interval(runs: &[&Run]) -> f64 {
    let median = |run: &&Run| {
        let mut all: Vec<f64> = run.time.windows(2).map(|w| w[1] - w[0]).collect();
        all.sort_by(f64::total_cmp);
        all.get(all.len() / 2).copied().unwrap_or(0.0)
    };
    let least = runs.iter().map(median).fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

fn differences(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// All that the catalogue and the empirical functions offer on this model, screened.
fn screen<'a>(
    study: &'a Study<'a>,
    subject: &'a Subject,
    roles: &'a Roles,
    current: &'a Fitted,
) -> Result<Vec<Screened>> {
    let interface = &subject.interface;
    let runs = &some_of(&study.fit_runs);
    let watch: Arc<[usize]> = interface
        .variables
        .iter()
        .enumerate()
        .filter(|(_, v)| v.is_real() && matches!(v.causality, Causality::Input | Causality::Output))
        .map(|(i, _)| i)
        .chain(runs.iter().flat_map(|r| r.channels.iter().map(|c| c.variable)))
        .collect::<std::collections::BTreeSet<usize>>()
        .into_iter()
        .collect();
    let problem = study.problem(&current.model, runs.clone());
    let point = Study::point(&current.model);
    let steps: Vec<f64> = current
        .unknowns
        .iter()
        .zip(&point)
        .map(|(u, x)| if x + u.step <= u.high { u.step } else { -u.step })
        .collect();
    let screen = Screen::new(&problem, &current.model, &point, &steps, Arc::clone(&watch), &study.weights);
    let screen = screen.ok_or_else(|| Error::numeric("the fitted model cannot be run"))?;
    let drives: Vec<Arc<Drive>> = runs.iter().map(|r| Arc::clone(&r.drive)).collect();
    let (mut size, rate) = sizes(interface.variables.len(), &watch, &drives, &screen.traces);
    for p in &study.free {
        size[p.variable] = p.scale;
    }
    // a model may leave an output at rest that moves
    for channel in runs.iter().flat_map(|r| &r.channels) {
        let n = channel.values.len().max(1) as f64;
        let own = (channel.values.iter().map(|v| v * v).sum::<f64>() / n).sqrt();
        size[channel.variable] = size[channel.variable].max(own);
    }
    let measured: Vec<usize> =
        runs.first().map_or(Vec::new(), |r| r.channels.iter().map(|c| c.variable).collect());
    let driven: Vec<usize> =
        runs.first().map_or(Vec::new(), |r| r.drive.inputs.iter().map(|(v, _)| *v).collect());
    for variable in 0..size.len() {
        if size[variable] == 0.0
            && roles.is(variable, crate::effect::Role::Force)
            && interface.variables[variable].causality == Causality::Input
        {
            size[variable] = force_size(study, &current.model, variable, &measured, &size);
        }
    }
    let tunable =
        study.free.iter().map(|p| p.variable).filter(|v| is_tunable(interface, *v)).take(5).collect();
    let site = Site { interface, roles, measured: &measured, driven, tunable, size, rate };
    let known = |placement: &Placement| {
        current
            .model
            .effects
            .iter()
            .any(|(p, _)| p.effect.id == placement.effect.id && p.targets == placement.targets)
    };
    let placements: Vec<Placement> = catalogue::EFFECTS
        .iter()
        .chain(empirical::EFFECTS)
        .flat_map(|effect: &'static Effect| site.placements(effect))
        .filter(|p| !known(p))
        .collect();
    Ok(screen.screen(interface, &placements))
}

/// The size of a force at an input that nothing drives: what moves an output as much as it moves anyway.
fn force_size(study: &Study<'_>, model: &Model, variable: usize, measured: &[usize], size: &[f64]) -> f64 {
    let Some(run) = study.fit_runs.first() else { return 0.0 };
    let setup = Arc::new(study.problem(model, vec![run]).setup(&Study::point(model)));
    let watch: Arc<[usize]> = measured.into();
    let respond = |force: f64| {
        let mut drive = (*run.drive).clone();
        drive.inputs.retain(|(v, _)| *v != variable);
        // on and off, so that also what only shows in motion answers
        let wave = (0..drive.points).map(|k| if (k / 50) % 2 == 0 { force } else { 0.0 }).collect();
        drive.inputs.push((variable, wave));
        study.bench.run(std::slice::from_ref(&setup), &[Arc::new(drive)], &watch).pop().and_then(Result::ok)
    };
    let (Some(still), Some(moved)) = (respond(0.0), respond(1.0)) else { return 0.0 };
    let mut least = f64::INFINITY;
    for ((a, b), variable) in still.iter().zip(&moved).zip(measured) {
        let change = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len().max(1) as f64;
        if change > 0.0 && size[*variable] > 0.0 {
            least = least.min(size[*variable] / change.sqrt());
        }
    }
    if least.is_finite() { least } else { 0.0 }
}

/// The best placement of the best effects: named ones and empirical functions.
fn choose(screened: &[Screened]) -> Vec<Screened> {
    let mut chosen: Vec<Screened> = Vec::new();
    for (named, limit) in [(true, NAMED), (false, UNNAMED)] {
        let mut count = 0;
        for s in screened.iter().filter(|s| empirical::is(s.placement.effect) != named) {
            let best =
                screened.iter().find(|s| empirical::is(s.placement.effect) != named).map_or(0.0, |b| b.gain);
            if count == limit || s.gain < 0.1 * best || s.gain < MIN_PROMISE {
                break;
            }
            // other places of the same effect only if they are about as good
            let mut same = chosen.iter().filter(|c| c.placement.effect.id == s.placement.effect.id);
            if same.clone().count() > 1 || same.next().is_some_and(|first| s.gain < 0.6 * first.gain) {
                continue;
            }
            chosen.push(s.clone());
            count += 1;
        }
    }
    chosen
}

fn try_out(
    study: &Study<'_>,
    current: &Model,
    screened: &Screened,
    current_fit: &Rest,
    current_check: &Rest,
) -> Option<Tried> {
    let mut model = current.clone();
    model.effects.push((screened.placement.clone(), screened.values.clone()));
    // from near the off value, so that the parameters move along
    if let Some((placement, values)) = model.effects.last_mut() {
        for (value, parameter) in values.iter_mut().zip(placement.effect.parameters) {
            if let Some(off) = parameter.off {
                let small = parameter.probes.first().map_or(f64::INFINITY, |p| p.abs());
                *value = off + (0.1 * (*value - off)).clamp(-small, small);
            }
        }
    }
    let mut fitted = study.fit(&model, 6).ok();
    if fitted.as_ref().is_none_or(|f| f.fit.cost > current_fit.total * (1.0 - 0.5 * screened.gain)) {
        // a refit without the effect may have bent the parameters far: from the nominal ones as well
        model.parameters = study.nominal().parameters;
        let other = study.fit(&model, 5).ok();
        fitted = match (fitted, other) {
            (Some(a), Some(b)) => Some(if a.fit.cost <= b.fit.cost { a } else { b }),
            (a, b) => a.or(b),
        };
    }
    let fitted = fitted?;
    let fit_rest = study.rest(&fitted.model, &study.fit_runs).ok()?;
    let check_rest = study.rest(&fitted.model, &study.check_runs).ok()?;
    let p = sign_flip(&differences(&current_check.blocks, &check_rest.blocks));
    let refuted = implausible(&fitted.model);
    Some(Tried {
        placement: screened.placement.clone(),
        fit_gain: 1.0 - fit_rest.total / current_fit.total.max(f64::MIN_POSITIVE),
        check_gain: 1.0 - check_rest.total / current_check.total.max(f64::MIN_POSITIVE),
        fitted,
        fit_rest,
        check_rest,
        p,
        refuted,
    })
}

/// A coefficient of the last effect that its name does not allow.
fn implausible(model: &Model) -> Option<String> {
    let (placement, values) = model.effects.last()?;
    placement.effect.parameters.iter().zip(values).zip(&placement.scales).find_map(|((p, v), scale)| {
        let (low, high) = p.plausible;
        let slack = 1e-6 * (high - low).abs();
        (*v < low - slack || *v > high + slack)
            .then(|| format!("{} = {:.3e} is not plausible for this name", p.name, v * scale))
    })
}

enum Decision {
    Nothing,
    Named(usize, Finding),
    Unnamed(usize, Finding),
}

#[allow(clippy::too_many_arguments)]
fn decide(
    study: &Study<'_>,
    subject: &Subject,
    tried: &[Tried],
    current_check: &Rest,
    base_check: &Rest,
    round: usize,
    candidates: &mut Vec<Candidate>,
) -> Decision {
    let level = LEVEL / tried.len().max(1) as f64;
    let counts = |t: &Tried| {
        t.p <= level.max(2.5e-4)
            && t.check_gain > MIN_GAIN
            && t.fit_gain > 0.0
            && visible(study, t, current_check)
    };
    let both = |t: &Tried| t.fit_rest.total + t.check_rest.total;
    let blocks = |t: &Tried| [&t.fit_rest.blocks[..], &t.check_rest.blocks[..]].concat();
    let is_named = |t: &&(usize, &Tried)| !empirical::is(t.1.placement.effect);
    let all: Vec<(usize, &Tried)> = tried.iter().enumerate().collect();
    let best_of = |named: bool| {
        all.iter()
            .filter(|t| is_named(t) == named && counts(t.1) && (t.1.refuted.is_none() || !named))
            .min_by(|a, b| both(a.1).total_cmp(&both(b.1)))
            .copied()
    };
    let (named, unnamed) = (best_of(true), best_of(false));
    // an empirical function wins where it explains clearly more than any name
    let better = |e: &Tried, n: &Tried| {
        let explained = current_check.total - e.check_rest.total;
        let missed = n.check_rest.total - e.check_rest.total;
        missed > LEFT_OVER * explained && sign_flip(&differences(&blocks(n), &blocks(e))) < TIE
    };
    let decision = match (named, unnamed) {
        (None, None) => None,
        (Some((i, _)), None) => Some((i, true)),
        (None, Some((i, _))) => Some((i, false)),
        (Some((i, n)), Some((j, e))) => Some(if better(e, n) { (j, false) } else { (i, true) }),
    };
    // after a first name a rest that only an empirical function explains, and that is small, is left alone
    let decision = decision.filter(|(i, named)| {
        let explained_before = base_check.total - current_check.total;
        let explained_now = current_check.total - tried[*i].check_rest.total;
        *named || round == 0 || explained_now > LEFT_OVER * explained_before
    });
    let rivals: Vec<(usize, &Tried)> = match decision {
        Some((chosen, true)) => all
            .iter()
            .filter(|t| is_named(t) && counts(t.1) && t.1.refuted.is_none())
            .filter(|t| {
                t.0 == chosen || {
                    let behind = differences(&blocks(t.1), &blocks(&tried[chosen]));
                    let lag = both(t.1) - both(&tried[chosen]);
                    let gain = current_check.total - tried[chosen].check_rest.total;
                    sign_flip(&behind) > TIE || lag < 0.03 * gain
                }
            })
            .copied()
            .collect(),
        Some((chosen, false)) => vec![(chosen, &tried[chosen])],
        None => Vec::new(),
    };
    let shares = bootstrap_shares(&rivals.iter().map(|t| blocks(t.1)).collect::<Vec<_>>());
    for (i, t) in &all {
        let placement = &t.placement;
        let reason = match decision {
            _ if t.refuted.is_some() => t.refuted.clone().unwrap_or_default(),
            Some((chosen, _)) if chosen == *i => "chosen".into(),
            _ if !counts(t) => "no gain on the check runs that chance does not make".into(),
            _ if rivals.iter().any(|r| r.0 == *i) => {
                "as good as the one chosen: these recordings do not separate them".into()
            }
            _ => "explains less than the one chosen".into(),
        };
        candidates.push(Candidate {
            effect: placement.effect.id.into(),
            name: placement.effect.name.into(),
            family: family(placement.effect),
            place: placement.place(&subject.interface),
            fit_gain: Some(t.fit_gain),
            check_gain: Some(t.check_gain),
            p: Some(t.p),
            reason,
        });
    }
    let Some((chosen, is_named)) = decision else { return Decision::Nothing };
    let t = &tried[chosen];
    let share_of = |i: usize| rivals.iter().position(|r| r.0 == i).map_or(0.0, |k| shares[k]);
    let mut alternatives: Vec<Alternative> = rivals
        .iter()
        .filter(|r| r.0 != chosen)
        .map(|r| Alternative {
            effect: r.1.placement.effect.id.into(),
            family: family(r.1.placement.effect),
            place: r.1.placement.place(&subject.interface),
            confidence: share_of(r.0),
        })
        .collect();
    alternatives.sort_by(|a, b| b.confidence.total_cmp(&a.confidence));
    let placement = &t.placement;
    let channels = affected(study, subject, t, current_check);
    let finding = Finding {
        effect: if is_named { placement.effect.id.into() } else { "unknown".into() },
        name: placement.effect.name.into(),
        family: if is_named { family(placement.effect) } else { "unknown".into() },
        place: placement.place(&subject.interface),
        channels,
        depends_on: placement.depends_on(&subject.interface),
        confidence: 0.97 * if is_named { share_of(chosen).max(0.05) } else { 1.0 },
        parameters: estimates(study, &t.fitted),
        alternatives,
        evidence: format!(
            "It takes away {:.0} % of the squared error of the check runs and {:.0} % of that of the fit runs beyond the refit; chance does so with a probability of {:.1e}.",
            100.0 * t.check_gain,
            100.0 * t.fit_gain,
            t.p
        ),
    };
    if is_named { Decision::Named(chosen, finding) } else { Decision::Unnamed(chosen, finding) }
}

fn family(effect: &Effect) -> String {
    serde_json::to_value(effect.family).ok().and_then(|v| v.as_str().map(str::to_owned)).unwrap_or_default()
}

/// True if an effect takes away an error that matters in some channel: a twentieth of the squared error
/// and a thousandth of what the channel moves.
fn visible(study: &Study<'_>, t: &Tried, before: &Rest) -> bool {
    let channels = study.check_runs.first().map_or(0, |r| r.channels.len());
    (0..channels).any(|c| {
        let (mut a, mut b, mut spread) = (0.0, 0.0, 0.0);
        for ((run, old), new) in study.check_runs.iter().zip(&before.simulated).zip(&t.check_rest.simulated) {
            let values = &run.channels[c].values;
            let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
            for ((m, x), y) in values.iter().zip(&old[c]).zip(&new[c]) {
                a += (x - m).powi(2);
                b += (y - m).powi(2);
                spread += (m - mean).powi(2);
            }
        }
        a - b > 0.05 * a && a - b > 1e-6 * spread
    })
}

/// The channels whose error an effect changes most: all with at least a tenth of the change.
fn affected(study: &Study<'_>, subject: &Subject, t: &Tried, before: &Rest) -> Vec<String> {
    let mut change = vec![0.0; study.weights.len()];
    for ((run, a), b) in study.check_runs.iter().zip(&before.simulated).zip(&t.check_rest.simulated) {
        for (c, channel) in run.channels.iter().enumerate() {
            let sum = |traces: &Vec<f64>| -> f64 {
                traces.iter().zip(&channel.values).map(|(s, m)| (s - m).powi(2)).sum()
            };
            change[c] += (sum(&a[c]) - sum(&b[c])) * study.weights[c].powi(2);
        }
    }
    let most = change.iter().copied().fold(0.0, f64::max);
    let channels = study.check_runs.first().map_or(&[][..], |r| &r.channels[..]);
    let mut order: Vec<usize> = (0..channels.len()).filter(|c| change[*c] > 0.1 * most).collect();
    order.sort_by(|a, b| change[*b].total_cmp(&change[*a]));
    order.iter().map(|c| subject.interface.variables[channels[*c].variable].name.clone()).collect()
}

/// Parameters of the last effect with 95 % intervals.
fn estimates(study: &Study<'_>, fitted: &Fitted) -> Vec<Estimate> {
    all_estimates(study, fitted).pop().unwrap_or_default()
}

/// Parameters of all effects with 95 % intervals.
fn all_estimates(study: &Study<'_>, fitted: &Fitted) -> Vec<Vec<Estimate>> {
    let covariance = fitted.fit.covariance(&fitted.unknowns, study.redundancy);
    let mut first = study.free.len() + 1;
    let mut all = Vec::new();
    for (placement, values) in &fitted.model.effects {
        all.push(estimates_of(placement, values, &covariance, first));
        first += values.len();
    }
    all
}

fn estimates_of(
    placement: &Placement,
    values: &[f64],
    covariance: &nalgebra::DMatrix<f64>,
    first: usize,
) -> Vec<Estimate> {
    placement
        .effect
        .parameters
        .iter()
        .enumerate()
        .map(|(i, p)| {
            let scale = placement.scales[i];
            let half = 1.96 * covariance[(first + i, first + i)].max(0.0).sqrt();
            let known = half < 0.5 * (p.search.1 - p.search.0);
            Estimate {
                name: p.name.into(),
                value: values[i] * scale,
                low: known.then_some((values[i] - half).max(p.search.0) * scale),
                high: known.then_some((values[i] + half).min(p.search.1) * scale),
                unit: placement.units[i].clone().unwrap_or_else(|| "1".into()),
            }
        })
        .collect()
}

fn fitted_parameters(study: &Study<'_>, subject: &Subject, fitted: &Fitted) -> Vec<FittedParameter> {
    let covariance = fitted.fit.covariance(&fitted.unknowns, study.redundancy);
    let of = |(i, p): (usize, &super::subject::FreeParameter)| {
        let (x, half) = (fitted.model.parameters[i], 1.96 * covariance[(i, i)].max(0.0).sqrt());
        // as wide as what was known beforehand: the recordings say nothing
        let known = half < 1.8 * fitted.unknowns[i].prior;
        let info = &subject.interface.variables[p.variable];
        let ends = [(x - half) * p.scale, (x + half) * p.scale];
        FittedParameter {
            name: info.name.clone(),
            start: p.nominal,
            value: x * p.scale,
            low: known.then_some(ends[0].min(ends[1])),
            high: known.then_some(ends[0].max(ends[1])),
            unit: info.unit.clone().unwrap_or_else(|| "1".into()),
        }
    };
    study.free.iter().enumerate().map(of).collect()
}

fn channel_checks(study: &Study<'_>, subject: &Subject, before: &Rest, after: &Rest) -> Vec<ChannelCheck> {
    let channels = study.check_runs.first().map_or(&[][..], |r| &r.channels[..]);
    let error = |rest: &Rest, c: usize| {
        let (mut sum, mut n) = (0.0, 0.0);
        for (run, traces) in study.check_runs.iter().zip(&rest.simulated) {
            sum += traces[c].iter().zip(&run.channels[c].values).map(|(s, m)| (s - m).powi(2)).sum::<f64>();
            n += run.time.len() as f64;
        }
        (sum / f64::max(n, 1.0)).sqrt()
    };
    let of = |(c, channel): (usize, &crate::fit::Channel)| {
        let info = &subject.interface.variables[channel.variable];
        ChannelCheck {
            channel: info.name.clone(),
            unit: info.unit.clone().unwrap_or_else(|| "1".into()),
            before: error(before, c),
            after: error(after, c),
            noise: locate::noise(&study.check_runs, &after.simulated, c),
        }
    };
    channels.iter().enumerate().map(of).collect()
}

fn traces(
    study: &Study<'_>,
    subject: &Subject,
    base: &Model,
    corrected: &Model,
    recordings: &[Recording],
    names: &[String],
) -> Result<Vec<CheckTraces>> {
    let before = study.rest(base, &study.check_runs)?;
    let after = study.rest(corrected, &study.check_runs)?;
    let mut check = Vec::new();
    for (k, run) in study.check_runs.iter().enumerate() {
        let Some(original) = names.iter().position(|n| *n == run.name).and_then(|i| recordings.get(i)) else {
            continue;
        };
        let unit = |v: usize| subject.interface.variables[v].unit.clone().unwrap_or_else(|| "1".into());
        let name = |v: usize| subject.interface.variables[v].name.clone();
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
            source: run.name.clone(),
        };
        let mut measured = record(&run.channels.iter().map(|c| c.values.clone()).collect::<Vec<_>>());
        for channel in &original.channels {
            if !measured.has(&channel.name) {
                measured.channels.push(channel.clone());
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

fn summary(diagnosis: &Diagnosis, (nominal, base, after): (f64, f64, f64)) -> String {
    let root = |a: f64, b: f64| 100.0 * (1.0 - (a / b.max(f64::MIN_POSITIVE)).sqrt());
    let gain = root(after, base);
    let name = |f: &Finding| format!("{} ({})", f.name, f.place);
    match (diagnosis.verdict, &diagnosis.findings[..]) {
        (Verdict::Recording, _) => {
            let words: Vec<&str> = diagnosis.faults.iter().take(2).map(|f| f.text.as_str()).collect();
            format!("A recording is at fault, not the model: {}", words.join(" "))
        }
        (Verdict::Parameters, _) => format!(
            "The parameters were off, nothing is missing: refitted on other runs they lower the error of the check runs by {:.0} %. What remains is not explained by anything in the catalogue or by a function of any signal.",
            root(base, nominal)
        ),
        (Verdict::Effect, findings) => format!(
            "The model lacks: {}. With it the error of the check runs is {gain:.0} % lower than after refitting the parameters alone.",
            findings.iter().map(name).collect::<Vec<_>>().join("; then "),
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
        (Verdict::Unknown, [first, ..]) if first.parameters.is_empty() => format!(
            "Something is missing that has no name here: {} have errors in common that depend on {}. Nothing that was tried explains them on other runs, so the model is only refitted.",
            first.channels.join(" and "),
            if first.depends_on.is_empty() { "nothing that was recorded".to_owned() } else { first.depends_on.join(", ") }
        ),
        (Verdict::Unknown, [first, ..]) => format!(
            "Something is missing that has no name here; it acts at {} and depends on {}. An empirical function of that lowers the error of the check runs by {gain:.0} %.",
            first.place,
            if first.depends_on.is_empty() { "time".to_owned() } else { first.depends_on.join(", ") }
        ),
        _ => "Nothing is missing: the model explains the check runs as well as anything that was tried. Its parameters need no change.".into(),
    }
}

fn next_experiment(diagnosis: &Diagnosis) -> String {
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
