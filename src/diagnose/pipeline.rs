//! The chain from recordings to a verdict.

use super::clock::Drift;
use super::excerpt::{finer, without_coarser};
use super::hygiene::Fault;
use super::numbers::{LEVEL, NOISE_MARGIN, RECORDER_LAG};
use super::off_data::{OffData, off_data};
use super::others::told_by_others;
use super::parts::errors_of_parts;
use super::placement::Placement;
use super::reading::{Known, Recorded, fault, shortest_interval, with};
use super::refit::{FINAL, refit};
use super::rest::differences;
use super::result::{Diagnosis, Estimate, Finding, Use, Verdict};
use super::roles::Roles;
use super::runs::Map;
use super::search::{Found, search};
use super::steps::{LongerSteps, are_alike};
use super::study::{Closeness, Fitted, Model, Study};
use super::subject::{FreeParameter, Subject};
use super::tables::{all_estimates, channel_checks, fitted_parameters, next_experiment, summary, traces};
use super::weights::first_weights;
use super::zeros::zeros;
use super::{experiment, locate, tables};
use crate::Result;
use crate::effect::Attachment;
use crate::fit::{Bench, Run};
use crate::model::Settings;
use crate::recording::Recording;
use crate::simulate::motions_are_followed;
use crate::stats::sign_flip;
use std::path::PathBuf;

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
    /// Runs at the same time; 0: as many as there are cores. It changes no answer.
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
    pub attachments: Vec<Attachment>,
    /// 95 % intervals of their parameters, where the recordings fix them.
    pub intervals: Vec<Vec<Option<(f64, f64)>>>,
    /// The corrected model: the communication step with which its effects were fitted \[s\], if not the model's own.
    pub step: Option<f64>,
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

/// Diagnoses a model against a folder of recordings. `progress` is told what is being done and how far
/// it is, from 0 to 1.
///
/// # Errors
/// Files that cannot be read or do not fit each other, a model that cannot be run.
pub fn diagnose(request: &Request, progress: &mut dyn FnMut(&str, f64)) -> Result<Outcome> {
    progress("reading", 0.0);
    let mut subject = Subject::load(&request.model, &request.settings)?;
    let roles = Roles::of(&subject.interface, &request.map.roles())?;
    let mut known = Recorded::read(request, &subject, &roles)?;
    let switched = subject.follow_recorded_motions(&known.recorded.inputs())?;
    let mut notes: Vec<String> =
        switched.iter().map(|v| motions_are_followed(&subject.interface.variables[*v].name)).collect();
    notes.extend(subject.what_stays(&known.recorded.inputs(), &roles));
    let threads = if request.threads > 0 {
        request.threads
    } else {
        std::thread::available_parallelism().map_or(1, usize::from)
    };
    let bench = Bench::new(&subject.factory, &subject.fixed, threads)?;
    notes.extend(known.recorded.take_shorter_steps(&bench, &subject, &roles)?);
    let asked = Asked { subject: &subject, roles: &roles, bench: &bench, given: Vec::new(), notes };
    let Explained { diagnosis, parameters, attachments, intervals, step, check } =
        asked.explain(&known, progress)?;
    Ok(Outcome { diagnosis, parameters, attachments, intervals, step, check, subject })
}

/// What is diagnosed.
struct Asked<'a> {
    subject: &'a Subject,
    roles: &'a Roles,
    bench: &'a Bench,
    /// Given values that are fitted because they were found to be off.
    given: Vec<FreeParameter>,
    /// What a reader has to know of how it is simulated.
    notes: Vec<String>,
}

/// An [`Outcome`] but for its model.
struct Explained {
    diagnosis: Diagnosis,
    parameters: Vec<(usize, f64)>,
    attachments: Vec<Attachment>,
    intervals: Vec<Vec<Option<(f64, f64)>>>,
    step: Option<f64>,
    check: Vec<CheckTraces>,
}

impl Explained {
    /// Whether the model's parameters are all that was off, and none of them is at a bound.
    fn is_of_parameters(&self) -> bool {
        let rest = self.diagnosis.without_faults.as_ref().map_or(self.diagnosis.verdict, |rest| rest.verdict);
        rest == Verdict::Parameters && self.diagnosis.held().next().is_none()
    }

    /// Whether all that is left without what is at fault has an explanation.
    fn leaves_nothing(&self) -> bool {
        let rest = self.diagnosis.without_faults.as_ref().map(|rest| rest.verdict);
        rest.is_some_and(|verdict| !matches!(verdict, Verdict::Unknown | Verdict::Recording))
    }
}

impl Asked<'_> {
    /// Explains recordings; if some are at fault, what is left without those.
    fn explain(&self, known: &Known, progress: &mut dyn FnMut(&str, f64)) -> Result<Explained> {
        let Self { subject, roles, bench, .. } = *self;
        let Known { recorded, aside, .. } = known;
        let fatal =
            |faults: &[Fault]| -> Vec<Fault> { faults.iter().filter(|f| f.is_fatal()).cloned().collect() };
        if let Some(rest) = known.without(&fatal(&known.faults), subject) {
            return self.explain(&rest, progress);
        }
        let mut faults = known.faults.clone();
        let mut notes = self.notes.clone();
        let mut study = Study {
            bench,
            fit_runs: recorded.with(Use::Fit),
            check_runs: recorded.with(Use::Check),
            values: Vec::new(),
            of_changes: None,
            closeness: Closeness::Precisely,
            free: Vec::new(),
            lag: 0.0,
            zeros: Vec::new(),
            weights: Vec::new(),
            redundancy: 1.0,
        };
        let steps = LongerSteps::of(bench, subject, &study.fit_runs, &study.check_runs);
        if let Some(longer) = steps.longer {
            notes.push(longer.words(subject));
            study.values.push((longer.variable, longer.step));
        }
        study.of_changes = steps.of_changes;
        study.weights = first_weights(&study.fit_runs);
        study.lag = RECORDER_LAG * shortest_interval(&study.fit_runs);
        study.zeros = zeros(&recorded.all());

        progress("fitting the model's own parameters", 0.05);
        let derivatives = study.choose_free(&subject.free)?;
        study.free.extend(self.given.iter().cloned());
        // of those that are given no derivatives are known
        let derivatives = self.given.is_empty().then_some(derivatives);
        let mut base = refit(&mut study, derivatives.as_ref())?;
        let mut base_rest = study.rest(&base.model, &study.check_runs)?;

        let against = |study: &Study<'_>, model: &Model| recorded.faults_against(study, subject, model);
        faults.extend(against(&study, &base.model)?);
        // a refit bends the model towards channels that are exchanged or in other units, as far as it can
        let gross = against(&study, &study.nominal())?.into_iter().filter(|f| f.kind.is_gross());
        let is_new = |g: &Fault| !faults.iter().any(|f| f.kind.is_gross() && f.channel == g.channel);
        let new: Vec<Fault> = gross.filter(is_new).collect();
        faults.extend(new);
        // what is known is left aside before the others are asked
        if let Some(derivatives) = &derivatives
            && !faults.iter().any(|f| f.kind.is_gross())
        {
            faults.extend(told_by_others(&study, subject, &base, derivatives, against)?);
        }
        let mut of_all = fatal(&faults);
        of_all.retain(|f| !f.kind.is_of_some_runs());
        if let Some(rest) = known.without(&of_all, subject) {
            return self.explain(&rest, progress);
        }
        let shared = if faults.iter().any(Fault::is_fatal) {
            None
        } else {
            recorded.shared_out(&study, &base.model, &faults)?
        };
        if let Some(shared) = &shared {
            (study.fit_runs, study.check_runs) = (with(shared, Use::Fit), with(shared, Use::Check));
            study.weights = first_weights(&study.fit_runs);
            // what was fitted to other runs is no place to begin
            base = refit(&mut study, None)?;
            base_rest = study.rest(&base.model, &study.check_runs)?;
        }
        let nominal = study.nominal();
        let check_runs = study.check_runs.clone();
        let found = if faults.iter().any(|f| f.is_fatal() && !f.kind.is_of_some_runs()) {
            Found::nothing(base, base_rest)
        } else {
            let found = search(&mut study, subject, roles, &nominal, (base, base_rest), progress)?;
            if let Some(drift) = Drift::of(&found, &study, &recorded.all())
                && let Some(rest) = known.with_clock_put_right(&drift)
            {
                return self.explain(&rest, progress);
            }
            let mut explained = Vec::new();
            if faults.iter().any(Fault::is_fatal) {
                // what single runs have may be physics: of a fault that is there no name makes runs like the others, while a
                // function without one may
                let there = against(&study, &found.current.model)?;
                let is_named = found.unknown.as_ref().is_none_or(|left| left.parameters.is_empty());
                let is_explained = |f: &Fault| f.is_fatal() && is_named && !there.iter().any(|t| t.is_of(f));
                (explained, faults) = faults.into_iter().partition(is_explained);
            }
            if let Some(rest) = known.without(&fatal(&faults), subject) {
                return self.explain(&rest, progress);
            }
            // but names that leave something are no better than the faults if nothing is left without these
            if found.unknown.is_some()
                && let Some(rest) = known.without_runs(&explained, subject)
            {
                let other = self.explain(&rest, progress)?;
                if other.leaves_nothing() {
                    return Ok(other);
                }
            }
            if faults.iter().any(Fault::is_fatal) {
                Found::nothing(found.base, found.base_check)
            } else {
                found
            }
        };
        let base_model = found.base.model;
        let Found { mut current, check: checked, .. } = found;
        let experiment = experiment::propose(&study, roles, &found.rivals, &checked);
        let (mut findings, mut unknown, candidates) = (found.findings, found.unknown, found.candidates);
        let of_fine = |coarse: &[&Run]| coarse.iter().map(|run| finer(run)).collect::<Vec<Run>>();
        let (fine_fit, fine_check);
        let mut step = None;
        let has_effects = !current.model.effects.is_empty();
        if has_effects && subject.own_step().is_none() {
            // effects act at communication points: what is handed on is fitted where shorter steps change nothing
            progress("fitting the corrected model with short steps", 0.9);
            let longer = study.fit_rest(&current)?.simulated;
            let mut shorter = of_fine(&study.fit_runs);
            let answer = study.rest(&current.model, &shorter.iter().collect::<Vec<_>>())?.simulated;
            if !are_alike(&longer, &answer) {
                shorter.iter_mut().for_each(|run| *run = without_coarser(run));
            }
            (fine_fit, fine_check) = (shorter, of_fine(&study.check_runs));
            study.fit_runs = fine_fit.iter().collect();
            study.check_runs = fine_check.iter().collect();
            step = fine_fit.iter().map(|run| run.drive.step).min_by(f64::total_cmp).map(plain_step);
        }
        if has_effects {
            current = study.fit_on(&current, FINAL)?;
        }
        current = study.settled(current);
        if has_effects {
            for (finding, estimates) in
                findings.iter_mut().chain(&mut unknown).zip(all_estimates(&study, &current))
            {
                finding.parameters = estimates;
            }
        }
        let current_check = study.rest(&current.model, &study.check_runs)?;
        let base_rest = study.rest(&base_model, &check_runs)?;
        let told = study.telling(&check_runs, &base_rest);
        let noise: Vec<Option<f64>> =
            (0..study.weights.len()).map(|c| locate::noise(&check_runs, &told, c)).collect();
        let map = locate::map(&check_runs, &told, &subject.interface, roles, &noise);
        progress("writing it down", 0.95);
        let nominal_rest = study.rest(&study.nominal_as_recorded()?, &study.check_runs)?;
        let units = base_rest.by_channel();
        let improved = sign_flip(&differences(&nominal_rest.in_units(&units), &base_rest.in_units(&units)));
        let current_fit = study.fit_rest(&current)?;
        let check = channel_checks(&study, subject, &base_rest, &current_check, &current_fit);
        let left: Vec<Option<f64>> = check.iter().map(|c| c.noise).collect();
        let parts = errors_of_parts(&study, subject, &base_rest, &left, &recorded.all())?;
        let facts = Facts {
            is_at_fault: faults.iter().any(Fault::is_fatal),
            is_mended: faults.iter().any(Fault::counts),
            is_noise: check.iter().all(|c| c.noise.is_none_or(|noise| c.after < NOISE_MARGIN * noise)),
            is_refitted: improved < LEVEL
                && base_rest.total < 0.98 * nominal_rest.total
                && study.is_better(&study.check_runs, (&nominal_rest, &base_rest)),
        };
        let verdict = facts.verdict(&findings, unknown.as_ref());
        let without_faults = (!aside.is_empty()).then(|| recorded.without_faults(verdict, aside));
        if let Some(finding) = unknown {
            findings.insert(0, finding);
        }
        let mut diagnosis = Diagnosis {
            verdict: if without_faults.is_some() { Verdict::Recording } else { verdict },
            without_faults,
            findings,
            check,
            parameters: fitted_parameters(&study, subject, &current),
            zeros: tables::zeros(&study, subject, &current),
            candidates,
            map,
            parts,
            faults: aside.iter().chain(&faults).filter(|f| f.counts()).map(fault).collect(),
            runs: recorded.used(shared.as_ref()),
            notes,
            ..Diagnosis::default()
        };
        let total = (nominal_rest.cost, base_rest.cost, current_check.cost);
        let name = |p: &FreeParameter| subject.interface.variables[p.variable].name.as_str();
        let given: Vec<&str> = self.given.iter().map(name).collect();
        diagnosis.summary = summary(&diagnosis, total, &given);
        diagnosis.next_experiment = experiment::sentence(experiment.as_ref(), &next_experiment(&diagnosis));
        diagnosis.experiment = experiment;
        diagnosis.notes.extend(tables::cautions(&diagnosis, subject, roles));
        let may_be_data = match verdict {
            Verdict::Recording => false,
            Verdict::Nothing | Verdict::Parameters => diagnosis.held().next().is_some(),
            Verdict::Effect | Verdict::Family | Verdict::Unknown => true,
        };
        if self.given.is_empty() && may_be_data {
            let off = off_data(&study, subject, &current, (&base_rest, &current_check))?;
            if let Some(other) = self.with_data(known, verdict, &off, &mut diagnosis, progress)? {
                return Ok(other);
            }
        }
        let check = traces(&study, subject, &base_model, &current.model, recorded)?;
        diagnosis.notes.extend(step.map(|step| {
            format!("The corrected model proposes a communication step of {step:?} s: with longer ones it leaves more than is said here.")
        }));
        diagnosis.simulated = bench.simulated();
        diagnosis.notes.push(words_on(diagnosis.simulated, &recorded.all()));
        let parameters = study
            .free
            .iter()
            .zip(&current.model.parameters)
            .map(|(p, x)| (p.variable, p.scale * x))
            .collect();
        let attachments = current.model.effects.iter().flat_map(|(p, v)| p.attach(v)).collect();
        let intervals = intervals(&study, &current);
        Ok(Explained { diagnosis, parameters, attachments, intervals, step, check })
    }

    /// What given values change that may be off: names may be right as well, which is said beside them; but one that leaves nothing explains
    /// more than a function without a name, or parameters where they cannot be, and is the answer in place of these.
    fn with_data(
        &self,
        known: &Known,
        verdict: Verdict,
        off: &[OffData],
        diagnosis: &mut Diagnosis,
        progress: &mut dyn FnMut(&str, f64),
    ) -> Result<Option<Explained>> {
        let Some((best, others)) = off.split_first() else { return Ok(None) };
        let others = others.iter().map(|other| other.words(self.subject));
        if matches!(verdict, Verdict::Effect | Verdict::Family) {
            diagnosis.summary = format!("{} {}", diagnosis.summary, best.words(self.subject));
            diagnosis.notes.extend(others);
            return Ok(None);
        }
        let asked = Asked { given: vec![best.parameter.clone()], notes: self.notes.clone(), ..*self };
        let mut other = asked.explain(known, progress)?;
        if !other.is_of_parameters() {
            return Ok(None);
        }
        other.diagnosis.notes.extend(others);
        Ok(Some(other))
    }
}

/// The largest step of 1, 2 or 5 times a power of ten that is not longer: shorter ones change nothing that recordings can tell.
fn plain_step(step: f64) -> f64 {
    let power = step.log10().floor() as i32;
    let slack = 1.0 + 1e-9;
    let plain = [5.0, 2.0, 1.0].into_iter().find(|digit| digit * 10f64.powi(power) <= step * slack);
    // as it is written
    format!("{}e{power}", plain.unwrap_or(1.0)).parse().unwrap_or(step)
}

/// How much was simulated.
fn words_on(simulated: f64, runs: &[&Run]) -> String {
    let recorded: f64 = runs.iter().map(|run| run.drive.length()).sum();
    let decimals = if recorded < 10.0 { 1 } else { 0 };
    format!(
        "Simulated for this: {simulated:.0} s, {:.0} times the {recorded:.decimals$} s of recordings.",
        simulated / recorded.max(f64::MIN_POSITIVE)
    )
}

/// 95 % intervals of the parameters of every attachment.
fn intervals(study: &Study<'_>, current: &Fitted) -> Vec<Vec<Option<(f64, f64)>>> {
    let ends = |e: &Estimate| Some((e.low?, e.high?));
    let effects = current.model.effects.iter().zip(all_estimates(study, current));
    // one attachment for each place
    let of = |((placement, _), estimates): (&(Placement, Vec<f64>), Vec<Estimate>)| {
        let own: Vec<_> = estimates.iter().map(ends).collect();
        placement.targets.iter().map(|_| own.clone()).collect::<Vec<_>>()
    };
    effects.flat_map(of).collect()
}

/// What a verdict needs to know beside what was found.
struct Facts {
    /// A recording has a fault that no name explains.
    is_at_fault: bool,
    /// Samples or channels of a recording were mended.
    is_mended: bool,
    /// Hardly more than noise is left of every channel of the check runs.
    is_noise: bool,
    /// The refit of the model's own parameters makes a difference.
    is_refitted: bool,
}

impl Facts {
    fn verdict(&self, findings: &[Finding], unknown: Option<&Finding>) -> Verdict {
        match (findings, unknown) {
            _ if self.is_at_fault => Verdict::Recording,
            // what was mended explains what is seen if nothing else does
            ([], None) if self.is_mended => Verdict::Recording,
            // and so it does the little that samples which were mended leave
            ([], Some(left)) if self.is_mended && self.is_noise && left.parameters.is_empty() => {
                Verdict::Recording
            }
            (_, Some(_)) => Verdict::Unknown,
            ([], None) if self.is_refitted => Verdict::Parameters,
            ([], None) => Verdict::Nothing,
            ([first, ..], None) if first.is_open() => Verdict::Family,
            _ => Verdict::Effect,
        }
    }
}
