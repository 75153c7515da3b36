//! In which part of a wired system a difference is made: the loop is opened at one part after the other, and what its
//! connected inputs had is replayed from the recordings.

use super::numbers::NOISE_MARGIN;
use super::refit::FINAL;
use super::rest::Rest;
use super::result::{Part, PartChannel};
use super::study::{Closeness, Study};
use super::subject::{Base, Subject, wired};
use crate::cosimulate::{Cut, Port, System, SystemSlave, read_system};
use crate::fit::{Bench, Drive, Factory, Run};
use crate::model::{Causality, Interface, Slave};
use crate::recording::Smooth;
use crate::{Error, Result};
use std::path::Path;
use std::sync::Arc;

/// A system with the loop open at one part.
struct Opened<'a> {
    name: String,
    /// The runs with all their samples: of one that was cut in two, what was recorded before is replayed, too.
    whole: &'a [&'a Run],
    bench: Bench,
    inputs: Vec<Replayed>,
}

/// A connected input that is to be replayed, by indices in the interface of the system.
struct Replayed {
    input: usize,
    output: usize,
    cut: Cut,
}

/// What each part leaves of its own outputs if it is fitted by itself, with recorded inputs, beside what it leaves in the
/// wired system; nothing for what is no wired system. `rest` is what the refitted model leaves of the check runs there,
/// `noise` that of each channel, `whole` are all runs as they were recorded. A part whose loop cannot be opened says why.
///
/// # Errors
/// The system's file cannot be read any more.
pub(super) fn errors_of_parts(
    study: &Study<'_>,
    subject: &Subject,
    rest: &Rest,
    noise: &[Option<f64>],
    whole: &[&Run],
) -> Result<Vec<Part>> {
    let Base::System(file) = &subject.base else { return Ok(Vec::new()) };
    let plan = read_system(file)?.plan;
    let threads = study.bench.threads();
    let mut parts = Vec::new();
    for (component, planned) in plan.components.into_iter().enumerate() {
        let name = planned.name;
        let channels = Opened::new(subject, (file, component), &name, whole, threads)
            .and_then(|opened| opened.map_or(Ok(None), |o| o.errors(study, subject, rest, noise)));
        match channels {
            Ok(None) => {}
            Ok(Some(channels)) => parts.push(Part { part: name, closed: None, channels }),
            Err(why) => parts.push(Part { part: name, closed: Some(why.to_string()), channels: Vec::new() }),
        }
    }
    Ok(parts)
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
    /// it is connected to was. `whole` is the run with all its samples.
    fn course(&self, run: &Run, whole: &Run) -> Option<Vec<f64>> {
        let recorded = |variable: usize| whole.channels.iter().find(|c| c.variable == variable);
        let (channel, factor, offset) = match (recorded(self.input), recorded(self.output)) {
            (Some(own), _) => (own, 1.0, 0.0),
            (None, Some(source)) => (source, self.cut.factor, self.cut.offset),
            (None, None) => return None,
        };
        let smooth = Smooth::new(&whole.time, &channel.values);
        let last = whole.time.last().copied()?;
        let at = |k: usize| factor * smooth.at(run.drive.time(k).min(last)) + offset;
        Some((0..run.drive.points).map(at).collect())
    }
}

impl<'a> Opened<'a> {
    /// The system opened at a part; nothing if no input of it is connected.
    fn new(
        subject: &Subject,
        (file, component): (&Path, usize),
        name: &str,
        whole: &'a [&'a Run],
        threads: usize,
    ) -> Result<Option<Self>> {
        let inputs = replayed(&subject.interface, wired(file)?.0, component)?;
        if inputs.is_empty() {
            return Ok(None);
        }
        // what comes from a recording now is a motion, too
        let now_recorded: Vec<usize> = inputs.iter().map(|i| i.input).collect();
        let switched = subject.actuators_of(&now_recorded);
        let fixed: Vec<_> = subject.fixed.iter().cloned().chain(switched).collect();
        let bench = Bench::new(&factory(file, component), &fixed, threads)?;
        Ok(Some(Self { name: name.into(), whole, bench, inputs }))
    }

    /// Nothing if none of the part's outputs was measured.
    fn errors(
        &self,
        study: &Study<'_>,
        subject: &Subject,
        wired: &Rest,
        noise: &[Option<f64>],
    ) -> Result<Option<Vec<PartChannel>>> {
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
        let unknown = self.inputs.iter().filter(|i| i.course(first, self.whole(first)).is_none());
        let missing: Vec<&str> = unknown.map(|i| info(i.input).name.as_str()).collect();
        if !missing.is_empty() {
            return Err(Error::file(format!("no channel tells {}", missing.join(", "))));
        }
        let replay = |runs: &[&Run]| runs.iter().map(|run| self.replay(run, &measured)).collect::<Vec<Run>>();
        let (fit_runs, check_runs) = (replay(&study.fit_runs), replay(&study.check_runs));
        let alone = Study {
            bench: &self.bench,
            fit_runs: fit_runs.iter().collect(),
            check_runs: check_runs.iter().collect(),
            values: Vec::new(),
            of_changes: None,
            closeness: Closeness::Precisely,
            free: study.free.iter().filter(|p| own(p.variable)).cloned().collect(),
            zeros: zeros(&study.zeros, &measured),
            weights: measured.iter().map(|c| study.weights[*c]).collect(),
            ..*study
        };
        // parameters that fit the whole system may be bent by what another part lacks
        let fitted = alone.fit(&alone.nominal(), FINAL)?;
        let rest = alone.rest(&fitted.model, &alone.check_runs)?;
        let of = |(place, c): (usize, &usize)| {
            let (closed, open) = (study.error(wired, *c), alone.error(&rest, place));
            let noise = noise.get(*c).copied().flatten();
            let differs = noise.filter(|noise| closed > NOISE_MARGIN * noise);
            let info = info(first.channels[*c].variable);
            PartChannel {
                channel: info.name.clone(),
                unit: info.unit.clone().unwrap_or_else(|| "1".into()),
                wired: closed,
                replayed: open,
                made_here: differs.map(|noise| open > NOISE_MARGIN * noise),
            }
        };
        Ok(Some(measured.iter().enumerate().map(of).collect()))
    }

    /// The run as it was recorded, of which this may be a part.
    fn whole<'b>(&'b self, run: &'b Run) -> &'b Run {
        self.whole.iter().find(|whole| whole.name == run.name).copied().unwrap_or(run)
    }

    /// The run with what the connected inputs had, and with some of its channels.
    fn replay(&self, run: &Run, channels: &[usize]) -> Run {
        let courses = self.inputs.iter().filter_map(|i| Some((i.input, i.course(run, self.whole(run))?)));
        let inputs = run.drive.inputs.iter().cloned().chain(courses).collect();
        Run {
            drive: Arc::new(Drive { inputs, coarser: None, ..Drive::clone(&run.drive) }),
            channels: channels.iter().map(|c| run.channels[*c].clone()).collect(),
            ..run.clone()
        }
    }
}

/// What those channels may show at zero, by their numbers among them.
fn zeros(all: &[(usize, f64)], channels: &[usize]) -> Vec<(usize, f64)> {
    let own = |(place, channel): (usize, &usize)| {
        all.iter().find(|(c, _)| c == channel).map(|(_, most)| (place, *most))
    };
    channels.iter().enumerate().filter_map(own).collect()
}
