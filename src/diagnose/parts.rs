//! In which part of a wired system a difference is made: the loop is opened at one part after the other, and what its
//! connected inputs had is replayed from the recordings.

use super::decision::NOISE_MARGIN;
use super::pipeline::FINAL;
use super::result::{Part, PartChannel};
use super::study::{Rest, Study};
use super::subject::{Base, Subject, wired};
use crate::Result;
use crate::cosimulate::{Cut, Port, System, SystemSlave};
use crate::fit::{Bench, Drive, Factory, Run};
use crate::model::{Causality, Interface, Slave};
use crate::recording::Smooth;
use std::path::Path;
use std::sync::Arc;

/// A system with the loop open at one part.
pub(super) struct Opened {
    name: String,
    bench: Bench,
    inputs: Vec<Replayed>,
}

/// A connected input that is to be replayed, by indices in the interface of the system.
struct Replayed {
    input: usize,
    output: usize,
    cut: Cut,
}

/// The system opened at each part that has connected inputs; nothing for what is no wired system.
///
/// # Errors
/// A system that cannot be loaded once more.
pub(super) fn opened(subject: &Subject, threads: usize) -> Result<Vec<Opened>> {
    let Base::System(file) = &subject.base else { return Ok(Vec::new()) };
    let (system, _) = wired(file)?;
    let mut all = Vec::new();
    for (component, part) in system.components().iter().enumerate() {
        let inputs = replayed(&subject.interface, wired(file)?.0, component)?;
        if inputs.is_empty() {
            continue;
        }
        let bench = Bench::new(&factory(file, component), &subject.fixed, threads)?;
        all.push(Opened { name: part.name.clone(), bench, inputs });
    }
    Ok(all)
}

fn factory(file: &Path, component: usize) -> Factory {
    let file = file.to_path_buf();
    Arc::new(move || {
        let (mut system, step) = wired(&file)?;
        system.cut(component);
        Ok(Box::new(SystemSlave::new("system", system, step)?) as Box<dyn Slave>)
    })
}

fn replayed(interface: &Interface, mut system: System, component: usize) -> Result<Vec<Replayed>> {
    let find = |system: &System, port: Port| interface.find(&system.name(port));
    let of = |cut: Cut, system: &System| {
        Ok(Replayed { input: find(system, cut.to)?, output: find(system, cut.from)?, cut })
    };
    system.cut(component).into_iter().map(|cut| of(cut, &system)).collect()
}

impl Replayed {
    /// What the input had in a run, at the run's communication points: as it was recorded itself, or as the output that
    /// it is connected to was.
    fn course(&self, run: &Run) -> Option<Vec<f64>> {
        let recorded = |variable: usize| run.channels.iter().find(|c| c.variable == variable);
        let (channel, factor, offset) = match (recorded(self.input), recorded(self.output)) {
            (Some(own), _) => (own, 1.0, 0.0),
            (None, Some(source)) => (source, self.cut.factor, self.cut.offset),
            (None, None) => return None,
        };
        let smooth = Smooth::new(&run.time, &channel.values);
        let last = run.time.last().copied()?;
        let at = |k: usize| factor * smooth.at(run.drive.time(k).min(last)) + offset;
        Some((0..run.drive.points).map(at).collect())
    }
}

/// What each part leaves of its own outputs if it is fitted by itself, with recorded inputs, beside what it leaves in the
/// wired system. `wired` is what the refitted model leaves of the check runs there, `noise` that of each channel.
///
/// # Errors
/// The opened system cannot be run.
pub(super) fn errors_of_parts(
    study: &Study<'_>,
    subject: &Subject,
    opened: &[Opened],
    wired: &Rest,
    noise: &[Option<f64>],
) -> Result<Vec<Part>> {
    let errors = opened.iter().map(|part| part.errors(study, subject, wired, noise));
    Ok(errors.collect::<Result<Vec<_>>>()?.into_iter().flatten().collect())
}

impl Opened {
    fn errors(
        &self,
        study: &Study<'_>,
        subject: &Subject,
        wired: &Rest,
        noise: &[Option<f64>],
    ) -> Result<Option<Part>> {
        let info = |variable: usize| &subject.interface.variables[variable];
        let own = |variable: usize| {
            let name = info(variable).name.split_once('.').map(|(part, _)| part);
            name == Some(&self.name)
        };
        let Some(first) = study.check_runs.first() else { return Ok(None) };
        let measured: Vec<usize> = (0..first.channels.len())
            .filter(|c| {
                let variable = first.channels[*c].variable;
                own(variable) && info(variable).causality == Causality::Output
            })
            .collect();
        if measured.is_empty() {
            return Ok(None);
        }
        let unknown = self.inputs.iter().filter(|i| i.course(first).is_none());
        let missing: Vec<String> = unknown.map(|i| info(i.input).name.clone()).collect();
        let mut part = Part { part: self.name.clone(), missing, channels: Vec::new() };
        if !part.missing.is_empty() {
            return Ok(Some(part));
        }
        let replay = |runs: &[&Run]| runs.iter().map(|run| self.replay(run, &measured)).collect::<Vec<Run>>();
        let (fit_runs, check_runs) = (replay(&study.fit_runs), replay(&study.check_runs));
        let alone = Study {
            bench: &self.bench,
            fit_runs: fit_runs.iter().collect(),
            check_runs: check_runs.iter().collect(),
            free: study.free.iter().filter(|p| own(p.variable)).cloned().collect(),
            weights: measured.iter().map(|c| study.weights[*c]).collect(),
            ..*study
        };
        // parameters that fit the whole system may be bent by what another part lacks
        let fitted = alone.fit(&alone.nominal(), FINAL)?;
        let rest = alone.rest(&fitted.model, &alone.check_runs)?;
        for (place, c) in measured.iter().copied().enumerate() {
            let variable = first.channels[c].variable;
            let (closed, open) = (study.error(wired, c), alone.error(&rest, place));
            let noise = noise.get(c).copied().flatten();
            let differs = noise.filter(|noise| closed > NOISE_MARGIN * noise);
            part.channels.push(PartChannel {
                channel: info(variable).name.clone(),
                unit: info(variable).unit.clone().unwrap_or_else(|| "1".into()),
                wired: closed,
                replayed: open,
                made_here: differs.map(|noise| open > NOISE_MARGIN * noise),
            });
        }
        Ok(Some(part))
    }

    /// The run with what the connected inputs had, and with some of its channels.
    fn replay(&self, run: &Run, channels: &[usize]) -> Run {
        let courses = self.inputs.iter().filter_map(|i| Some((i.input, i.course(run)?)));
        let inputs = run.drive.inputs.iter().cloned().chain(courses).collect();
        Run {
            drive: Arc::new(Drive { inputs, ..Drive::clone(&run.drive) }),
            channels: channels.iter().map(|c| run.channels[*c].clone()).collect(),
            ..run.clone()
        }
    }
}
