//! From a folder of recordings to runs: reading, what they have in common, faults that show beside a simulation.

use super::aside::Aside;
use super::clock::Drift;
use super::hygiene;
use super::negligible::unresolved;
use super::pipeline::Request;
use super::prepared::{leave_out_after, leave_out_rails, unwrap};
use super::result::{RunUse, Use, Verdict, WithoutFaults};
use super::roles::Roles;
use super::runs::{Between, Map, are_given, courses, prepare, split, uses};
use super::steps::ShorterSteps;
use super::study::{Model, Study};
use super::subject::Subject;
use super::witnesses::{Shared, share_out};
use crate::effect::{Earlier, Role};
use crate::fit::{Bench, Drive, Run, Traces};
use crate::model::Causality;
use crate::recording::{Recording, recording_endings};
use crate::stats::median_interval;
use crate::{Error, Result, ending};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Communication steps, where there is usually one, with which it is looked at how inputs run between samples.
const BETWEEN_SAMPLES: u32 = 2;

/// The recordings of a diagnosis.
#[derive(Clone)]
pub(super) struct Recorded {
    /// Names of the files.
    names: Vec<String>,
    /// What is in them.
    recordings: Vec<Recording>,
    /// What drives the model in them, in rows that are not compared, too.
    drives: Vec<Recording>,
    /// What they are used for as long as nothing is known of a model.
    uses: Vec<Use>,
    /// Whether the user said so.
    are_given: bool,
    /// The communication step, where it is given \[s\].
    step: Option<f64>,
    /// Those that are used, ready to be simulated.
    pub runs: Vec<(Run, Use)>,
    /// What is not resolved of each sample of those, once that is known.
    unresolved: Vec<Traces>,
    /// Runs and measured channels that are not used because they are at fault, by name.
    runs_aside: BTreeSet<String>,
    channels_aside: BTreeSet<String>,
}

/// What is known of recordings before they are explained.
pub(super) struct Known {
    pub recorded: Recorded,
    /// Faults that they show by themselves.
    pub faults: Vec<hygiene::Fault>,
    /// Faults for which runs, channels or samples are left aside.
    pub aside: Vec<hygiene::Fault>,
}

impl Known {
    /// What is left if all that has these faults is left aside; `None` if there are none, or nothing would be left.
    pub fn without(&self, faults: &[hygiene::Fault], subject: &Subject) -> Option<Self> {
        self.leaving(faults, subject, |name| subject.interface.index(name))
    }

    /// The same with all channels of what is left, so that what shows in a channel can still be seen in it.
    pub fn without_runs(&self, faults: &[hygiene::Fault], subject: &Subject) -> Option<Self> {
        self.leaving(faults, subject, |_| None)
    }

    /// Without what has these faults: runs, or channels that `variable` knows.
    fn leaving(
        &self,
        faults: &[hygiene::Fault],
        subject: &Subject,
        variable: impl Fn(&str) -> Option<usize>,
    ) -> Option<Self> {
        let recorded = self.recorded.without(&faults.iter().collect::<Vec<_>>(), subject, variable)?;
        let others = self.faults.iter().filter(|f| !faults.contains(f) && recorded.can_show(f));
        Some(Self {
            faults: others.cloned().collect(),
            aside: self.aside.iter().chain(faults).cloned().collect(),
            recorded,
        })
    }

    /// The same with the times of all that was measured put right; `None` if that was done before.
    pub fn with_clock_put_right(&self, drift: &Drift) -> Option<Self> {
        let fault = drift.fault();
        if self.aside.iter().any(|f| f.kind == fault.kind) {
            return None;
        }
        let mut recorded = self.recorded.clone();
        for (run, _) in &mut recorded.runs {
            let Some(k) = recorded.names.iter().position(|name| *name == run.name) else { continue };
            drift.put_right(run, &mut recorded.recordings[k], &recorded.drives[k]);
        }
        let aside = self.aside.iter().cloned().chain([fault]).collect();
        Some(Self { recorded, faults: self.faults.clone(), aside })
    }
}

impl Recorded {
    /// Reads a folder, with what shows in recordings by themselves.
    ///
    /// # Errors
    /// Files that cannot be read, or do not fit each other or the model.
    pub fn read(request: &Request, subject: &Subject, roles: &Roles) -> Result<Known> {
        let is_input = |name: &str| {
            let variable = subject.interface.index(name).map(|v| &subject.interface.variables[v]);
            variable.is_some_and(|v| v.causality == Causality::Input)
        };
        let (names, raw) = read_folder(&request.recordings, &request.map, &is_input)?;
        let are_given = are_given(&request.recordings);
        // what the user leaves out is not looked at either
        let given = are_given.then(|| uses(&request.recordings, &names, &[])).transpose()?;
        let is_left = |k: usize| given.as_ref().is_some_and(|uses| uses[k] == Use::Leave);
        let looked_at = raw.iter().enumerate().filter(|(k, _)| !is_left(*k)).map(|(_, raw)| raw);
        let mut faults = hygiene::faults_of_runs(&looked_at.collect::<Vec<_>>());
        // a command may rest as long as it likes, at the end of its range too
        let may_rest = |f: &hygiene::Fault| {
            matches!(f.kind, hygiene::FaultKind::Stuck | hygiene::FaultKind::Saturated)
                && f.channel.as_deref().is_some_and(is_input)
        };
        faults.retain(|f| !may_rest(f));
        let (mut recordings, drives): (Vec<Recording>, Vec<Recording>) =
            raw.into_iter().map(|r| (r.recording, r.drive)).unzip();
        let mut unknown_after = Vec::new();
        for (name, recording) in names.iter().zip(&mut recordings) {
            let gaps =
                faults.iter_mut().filter(|f| f.kind == hygiene::FaultKind::Gap && f.runs.contains(name));
            for gap in gaps {
                if !leave_out_after(recording, gap) {
                    unknown_after.push(gap.clone());
                }
            }
        }
        let aside = leave_out_rails(&names, &mut recordings, &mut faults);
        let uses = match given {
            Some(uses) => uses,
            None => uses(&request.recordings, &names, &courses(&recordings))?,
        };
        let step = request.step.or(subject.own_step());
        let mut recorded = Self {
            names,
            recordings,
            drives,
            uses,
            are_given,
            step,
            runs: Vec::new(),
            unresolved: Vec::new(),
            runs_aside: BTreeSet::new(),
            channels_aside: BTreeSet::new(),
        };
        recorded.runs = recorded.prepared(subject, roles, (Between::Smoothly, 1))?;
        same_channels(subject, &recorded.runs)?;
        // where other runs are left, those are not needed
        let known = Known { recorded, faults, aside };
        Ok(known.without(&unknown_after, subject).unwrap_or(known))
    }

    /// All runs that are used, ready to be simulated, with communication points so much closer than usual, where no step is
    /// given.
    fn prepared(
        &self,
        subject: &Subject,
        roles: &Roles,
        (between, finer): (Between, u32),
    ) -> Result<Vec<(Run, Use)>> {
        let counts =
            |variable: usize| [Role::WheelAngle, Role::TravelDistance].iter().any(|r| roles.is(variable, *r));
        let used = self.names.iter().zip(&self.recordings).zip(&self.drives).zip(&self.uses);
        let used = used.filter(|(_, use_)| **use_ != Use::Leave);
        let mut runs: Vec<(Run, Use)> = used
            .map(|(((name, recording), drive), use_)| {
                let mut run =
                    prepare(&subject.interface, (recording, drive, between), name, self.step, finer)?;
                run.channels.iter_mut().for_each(|c| c.counts = counts(c.variable));
                let angles = run.channels.iter_mut().filter(|c| roles.is(c.variable, Role::WheelAngle));
                angles.for_each(|c| unwrap(&mut c.values));
                let counting = run.channels.iter().filter(|c| c.counts);
                let begins = counting.filter_map(|c| Some((c.variable, *c.values.first()?))).collect();
                run.drive = Arc::new(Drive { begins, ..Drive::clone(&run.drive) });
                Ok((run, *use_))
            })
            .collect::<Result<_>>()?;
        self.set_unresolved(&mut runs);
        follow_each_other(&mut runs);
        Ok(runs)
    }

    /// Finds what errors each channel tells, with communication steps so much shorter than usual.
    ///
    /// # Errors
    /// Too many steps.
    fn find_unresolved(&mut self, bench: &Bench, subject: &Subject, roles: &Roles, finer: u32) -> Result<()> {
        let [smooth, straight] = [Between::Smoothly, Between::Straight]
            .map(|between| self.prepared(subject, roles, (between, finer)));
        let (smooth, straight) = (smooth?, straight?);
        self.unresolved = unresolved(bench, &self.all(), (&runs_of(&smooth), &runs_of(&straight)));
        let mut runs = std::mem::take(&mut self.runs);
        self.set_unresolved(&mut runs);
        self.runs = runs;
        Ok(())
    }

    fn set_unresolved(&self, runs: &mut [(Run, Use)]) {
        for ((run, _), own) in runs.iter_mut().zip(&self.unresolved) {
            run.channels.iter_mut().zip(own).for_each(|(channel, own)| channel.unresolved.clone_from(own));
        }
    }

    /// Has the runs simulated with as many communication steps per sample as the model needs, and finds what errors each channel tells then;
    /// says so, if these are more than usual.
    ///
    /// # Errors
    /// Too many steps.
    pub fn take_shorter_steps(
        &mut self,
        bench: &Bench,
        subject: &Subject,
        roles: &Roles,
    ) -> Result<Option<String>> {
        // with one step from sample to sample there is nothing between
        self.find_unresolved(bench, subject, roles, BETWEEN_SAMPLES)?;
        if self.step.is_some() {
            return Ok(None);
        }
        let with = |finer: u32| self.prepared(subject, roles, (Between::Smoothly, finer));
        let Some((shorter, runs)) = ShorterSteps::of(bench, &self.runs, with)? else { return Ok(None) };
        self.runs = runs;
        // the more there is between samples, the more the ways differ
        if shorter.finer() > BETWEEN_SAMPLES {
            self.find_unresolved(bench, subject, roles, shorter.finer())?;
        }
        Ok(Some(shorter.words()))
    }

    /// The inputs that recordings hold.
    pub fn inputs(&self) -> Vec<usize> {
        let inputs = self.runs.iter().flat_map(|(run, _)| run.drive.inputs.iter().map(|(v, _)| *v));
        inputs.collect::<BTreeSet<usize>>().into_iter().collect()
    }

    /// All runs that are used.
    pub fn all(&self) -> Vec<&Run> {
        runs_of(&self.runs)
    }

    /// Those for one use.
    pub fn with(&self, wanted: Use) -> Vec<&Run> {
        with(&self.runs, wanted)
    }

    /// The recordings without what has these faults, runs or channels that `variable` knows. `None` if there is no fault, or too little would be left.
    fn without(
        &self,
        faults: &[&hygiene::Fault],
        subject: &Subject,
        variable: impl Fn(&str) -> Option<usize>,
    ) -> Option<Self> {
        if faults.is_empty() {
            return None;
        }
        let aside = Aside::of(faults, (&self.runs, self.are_given), variable)?;
        let mut rest = self.clone();
        for (name, use_) in rest.names.iter().zip(&mut rest.uses) {
            if aside.runs.contains(name) {
                *use_ = Use::Leave;
            }
        }
        if !self.are_given {
            rest.share_out();
        }
        rest.runs.retain(|(run, _)| !aside.runs.contains(&run.name));
        for (run, _) in &mut rest.runs {
            run.channels.retain(|channel| !aside.channels.contains(&channel.variable));
        }
        let name = |variable: &usize| subject.interface.variables[*variable].name.clone();
        rest.channels_aside.extend(aside.channels.iter().map(name));
        rest.runs_aside.extend(aside.runs);
        // what is at fault has warmed nothing that is known of
        follow_each_other(&mut rest.runs);
        Some(rest)
    }

    /// Sees to it that some of the runs that are used are for fitting and some for checking.
    fn share_out(&mut self) {
        if [Use::Fit, Use::Check].iter().all(|use_| self.uses.contains(use_)) {
            return;
        }
        let used: Vec<usize> = (0..self.uses.len()).filter(|k| self.uses[*k] != Use::Leave).collect();
        let recordings: Vec<Recording> = used.iter().map(|k| self.recordings[*k].clone()).collect();
        for (k, use_) in used.into_iter().zip(split(&courses(&recordings))) {
            self.uses[k] = use_;
        }
        for (run, use_) in &mut self.runs {
            if let Some(k) = self.names.iter().position(|name| *name == run.name) {
                *use_ = self.uses[k];
            }
        }
    }

    /// Whether a fault can be seen in what is used.
    fn can_show(&self, fault: &hygiene::Fault) -> bool {
        fault.runs.iter().any(|name| self.runs.iter().any(|(run, _)| run.name == *name))
            && fault.channel.as_ref().is_none_or(|channel| !self.channels_aside.contains(channel))
    }

    /// The verdict on what is left, with what is left aside.
    pub fn without_faults(&self, verdict: Verdict, aside: &[hygiene::Fault]) -> WithoutFaults {
        let list = |names: &BTreeSet<String>| names.iter().cloned().collect();
        let at_rail = aside.iter().filter(|f| f.kind == hygiene::FaultKind::Saturated);
        WithoutFaults {
            verdict,
            runs: list(&self.runs_aside),
            channels: list(&self.channels_aside),
            at_rail: list(&at_rail.filter_map(|f| f.channel.clone()).collect()),
            is_on_time: aside.iter().any(|f| f.kind == hygiene::FaultKind::ClockDrift && !f.is_fatal()),
        }
    }

    /// The recording of a run.
    pub fn of(&self, run: &Run) -> Option<&Recording> {
        self.recordings.get(self.names.iter().position(|n| *n == run.name)?)
    }

    /// The runs shared out anew, if what the refitted model leaves asks for it and the user did not say what they are
    /// for.
    ///
    /// # Errors
    /// The model cannot be run.
    pub fn shared_out(
        &self,
        study: &Study<'_>,
        base: &Model,
        faults: &[hygiene::Fault],
    ) -> Result<Option<Shared>> {
        if self.are_given {
            return Ok(None);
        }
        let uses: Vec<Use> = self.runs.iter().map(|(_, use_)| *use_).collect();
        let all = self.all();
        let rest = study.rest(base, &all)?;
        let has_fault = |run: &&Run| faults.iter().any(|f| f.counts() && f.runs.contains(&run.name));
        let faulty: Vec<bool> = all.iter().map(has_fault).collect();
        Ok(share_out(&all, &uses, &faulty, &rest))
    }

    /// What each recording was used for in the end.
    pub fn used(&self, shared: Option<&Shared>) -> Vec<RunUse> {
        let of = |(name, first): (&String, &Use)| {
            let parts: Vec<&(Run, Use)> =
                shared.into_iter().flatten().filter(|(run, _)| run.name == *name).collect();
            let (use_, check_from) = match parts[..] {
                [_, (end, _)] => (Use::Fit, end.time.first().copied()),
                [(_, use_)] => (*use_, None),
                _ => (*first, None),
            };
            RunUse { name: name.clone(), use_, check_from }
        };
        self.names.iter().zip(&self.uses).map(of).collect()
    }

    /// Faults that show against a fitted model.
    ///
    /// # Errors
    /// It cannot be run.
    pub fn faults_against(
        &self,
        study: &Study<'_>,
        subject: &Subject,
        model: &Model,
    ) -> Result<Vec<hygiene::Fault>> {
        let runs = self.all();
        let rest = study.rest(model, &runs)?;
        let (mut measured, mut simulated) = (Vec::new(), Vec::new());
        let Some(first) = runs.first() else { return Ok(Vec::new()) };
        let name = |v: usize| subject.interface.variables[v].name.clone();
        let unit = |v: usize| subject.interface.variables[v].unit.clone().unwrap_or_else(|| "1".into());
        for (run, traces) in runs.iter().zip(&rest.simulated) {
            let Some(original) = self.of(run) else { continue };
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
        // what says nothing says nothing of a fault
        let channels =
            first.channels.iter().enumerate().filter(|(c, _)| study.says_something(&runs, &rest, *c));
        let channels: Vec<String> = channels.map(|(_, c)| name(c.variable)).collect();
        Ok(hygiene::faults_against(&measured, &simulated, &channels))
    }
}

/// Tells each run which were before it.
fn follow_each_other(runs: &mut [(Run, Use)]) {
    let all: Vec<Arc<Earlier>> = runs.iter().map(|(run, _)| Arc::new(run.as_earlier())).collect();
    for (k, (run, _)) in runs.iter_mut().enumerate() {
        let after = |drive: &Drive| Drive { earlier: all[..k].into(), ..drive.clone() };
        let coarser = run.drive.coarser.as_ref().map(|coarser| Arc::new(after(coarser)));
        run.drive = Arc::new(Drive { coarser, ..after(&run.drive) });
    }
}

fn runs_of(runs: &[(Run, Use)]) -> Vec<&Run> {
    runs.iter().map(|(run, _)| run).collect()
}

/// Runs for one use.
pub(super) fn with(runs: &[(Run, Use)], wanted: Use) -> Vec<&Run> {
    runs.iter().filter(|(_, use_)| *use_ == wanted).map(|(run, _)| run).collect()
}

fn read_folder(
    folder: &Path,
    map: &Map,
    is_input: &dyn Fn(&str) -> bool,
) -> Result<(Vec<String>, Vec<hygiene::RawRecording>)> {
    let place = folder.display();
    let entries =
        std::fs::read_dir(folder).map_err(|e| Error::file(format!("{place} cannot be read: {e}")))?;
    let mut files: Vec<PathBuf> = entries
        .filter_map(|e| e.ok().map(|e| e.path()))
        .filter(|p| recording_endings().contains(&ending(p).as_str()))
        .collect();
    files.sort_by_cached_key(|file| in_counting_order(&file_name(file)));
    if files.is_empty() {
        return Err(Error::file(format!(
            "{place}: there is no recording, that is no file *.{}",
            recording_endings().join(", *.")
        )));
    }
    let mut recordings = Vec::new();
    for file in &files {
        // a pipe that nobody writes to would be waited for
        if !file.is_file() {
            return Err(Error::file(format!(
                "{}: this is no ordinary file; take it out of the folder",
                file.display()
            )));
        }
        recordings.push(hygiene::read_raw(file, map.columns(), is_input)?);
    }
    Ok((files.iter().map(|p| file_name(p)).collect(), recordings))
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// What names are sorted by so that `run-10` comes after `run-9`: their pieces, of which those of digits count by their value, and,
/// where these are alike, the names.
fn in_counting_order(name: &str) -> (Vec<(u128, String)>, String) {
    let mut pieces: Vec<String> = Vec::new();
    for c in name.chars() {
        match pieces.last_mut() {
            Some(piece) if piece.ends_with(|last: char| last.is_ascii_digit()) == c.is_ascii_digit() => {
                piece.push(c)
            }
            _ => pieces.push(c.into()),
        }
    }
    // what is no number, or none of a run, counts as text
    let key = |piece: String| {
        piece.parse().map_or_else(|_| (u128::MAX, piece.clone()), |number| (number, String::new()))
    };
    (pieces.into_iter().map(key).collect(), name.into())
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

/// The shortest of the runs' median sampling intervals \[s\].
pub(super) fn shortest_interval(runs: &[&Run]) -> f64 {
    // a run of one sample has none
    let least = runs.iter().map(|run| median_interval(&run.time).max(0.0)).fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

pub(super) fn fault(fault: &hygiene::Fault) -> super::result::Fault {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_come_in_the_order_in_which_people_count() {
        let sorted = [
            "",
            "2.csv",
            "10.csv",
            "a1b2.csv",
            "a1b10.csv",
            "a2b1.csv",
            "run-9.csv",
            "run-09.csv",
            "run-10.csv",
            "run.csv",
        ];
        let mut names = sorted.map(String::from);
        names.reverse();
        names.sort_by_cached_key(|name| in_counting_order(name));
        // alike but for how they are written
        assert!(names[6] == "run-09.csv" && names[7] == "run-9.csv");
        names.swap(6, 7);
        assert_eq!(names, sorted);
        // more digits than a number has
        let long = |last: char| format!("{}{last}", "7".repeat(60));
        assert!(in_counting_order(&long('1')) < in_counting_order(&long('2')));
    }

    #[test]
    fn a_run_knows_those_before_it_that_are_used() {
        let run = |k: usize| {
            let coarser = Arc::new(Drive::new(0.0, 1.0, 2, vec![(0, vec![k as f64; 2])]));
            let drive = Drive::new(0.0, 0.5, 3, vec![(0, vec![k as f64; 3])]);
            let channels = vec![crate::fit::Channel {
                variable: 1,
                values: vec![7.0, 8.0],
                counts: false,
                unresolved: Vec::new(),
            }];
            let drive = Arc::new(Drive { coarser: Some(coarser), ..drive });
            (Run { name: format!("{k}"), drive, time: vec![0.0, 1.0], channels }, Use::Fit)
        };
        let mut runs: Vec<(Run, Use)> = (0..4).map(run).collect();
        let known = |runs: &[(Run, Use)]| -> Vec<Vec<f64>> {
            let inputs =
                |drive: &Drive| drive.earlier.iter().map(|e| e.signals[0].1[0]).collect::<Vec<f64>>();
            for (run, _) in runs {
                assert_eq!(run.drive.coarser.as_ref().map(|c| inputs(c)), Some(inputs(&run.drive)));
            }
            runs.iter().map(|(run, _)| inputs(&run.drive)).collect()
        };
        follow_each_other(&mut runs);
        assert_eq!(known(&runs), [vec![], vec![0.0], vec![0.0, 1.0], vec![0.0, 1.0, 2.0]]);
        assert_eq!(runs[1].0.drive.earlier[0].signals, [(0, vec![0.0; 2]), (1, vec![7.0, 8.0])]);
        // one is left aside, and a channel of all
        runs.remove(1);
        runs.iter_mut().for_each(|(run, _)| run.channels.clear());
        follow_each_other(&mut runs);
        assert_eq!(known(&runs), [vec![], vec![0.0], vec![0.0, 2.0]]);
        assert_eq!(runs[1].0.drive.earlier[0].signals, [(0, vec![0.0; 2])]);
    }
}
