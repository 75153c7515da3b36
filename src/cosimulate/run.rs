//! [`cosimulate`]: runs a system and records.

use super::energy::Bond;
use super::master::Turn;
use super::system::{Port, System};
use crate::model::unit::Unit;
use crate::model::{Causality, Kind};
use crate::recording::{Channel, Recording};
use crate::simulate::{Reader, Schedule};
use crate::{Error, Result};
use std::collections::HashMap;

/// More values than this (4 GB) are not recorded.
const MAX_VALUES: f64 = 5e8;
/// How far a last step may be from a whole one, in steps, to count as whole.
const STEP_TOLERANCE: f64 = 1e-6;
/// A coupling that makes more than this share of the energy that it passes on is warned of.
pub const ENERGY_SHARE: f64 = 0.01;

/// What to run and what to keep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Experiment {
    /// Start \[s\].
    pub start: f64,
    /// Stop \[s\].
    pub stop: f64,
    /// Communication step \[s\].
    pub step: f64,
    /// Every how many communication points are recorded. The last one is, in any case.
    pub record_every: usize,
    /// Internal quantities and inputs that nothing is connected to are recorded, too.
    pub all: bool,
    /// Keep a [log](Outcome::log) of who stepped when.
    pub log: bool,
}

/// A condition that ends a run: a variable is beyond a value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Until {
    /// The variable.
    pub port: Port,
    /// Whether it has to be greater than the value; otherwise less.
    pub above: bool,
    /// The value, in the variable's unit.
    pub value: f64,
}

impl Until {
    fn is_met(&self, system: &mut System) -> Result<bool> {
        let value = system.number(self.port)?;
        Ok(if self.above { value > self.value } else { value < self.value })
    }
}

/// What came out.
#[derive(Debug)]
pub struct Outcome {
    /// Outputs, inputs and energies at the recorded communication points, as `component.variable`.
    ///
    /// An input is what the component had at the end of the interval before the sample, so that it
    /// belongs to the outputs beside it.
    pub recording: Recording,
    /// Why a component ended it before the stop time, if one did.
    pub stopped: Option<Error>,
    /// Whether the condition was met that was to end it.
    pub met: bool,
    /// Who stepped from when to when, in order, if that was asked for.
    pub log: Vec<Turn>,
    /// Intervals that were repeated as often as allowed and whose exchanged values still changed.
    pub unconverged: usize,
    /// Intervals that were halved.
    pub halved: usize,
}

impl Experiment {
    /// The communication points.
    ///
    /// # Errors
    /// Times that are not finite or reversed, a step that is not positive.
    pub fn schedule(&self) -> Result<Schedule> {
        let Self { start, stop, step, .. } = *self;
        if !(start.is_finite() && stop.is_finite() && stop > start) {
            return Err(Error::call(format!(
                "the stop time {stop} s has to be after the start time {start} s"
            )));
        }
        if !(step.is_finite() && step > 0.0) {
            return Err(Error::call(format!("the step {step} s has to be a positive time")));
        }
        let steps = ((stop - start) / step - STEP_TOLERANCE).ceil().max(1.0);
        if steps > MAX_VALUES {
            return Err(Error::call(format!("{steps:.1e} steps of {step} s are too many; take longer ones")));
        }
        Ok(Schedule { start, stop, step, steps: steps as usize })
    }
}

/// Runs a system that was not started yet. `observe` is called at every communication point with its
/// number.
///
/// # Errors
/// An experiment that does not fit the system, or a system that does not start. A component that stops on
/// the way is no error of this function: see [`Outcome::stopped`].
pub fn cosimulate(
    system: &mut System,
    experiment: &Experiment,
    observe: impl FnMut(usize),
) -> Result<Outcome> {
    cosimulate_until(system, experiment, None, observe)
}

/// As [`cosimulate`]; ends at the first communication point after the start at which the condition is met. That
/// point is recorded in any case.
///
/// # Errors
/// As [`cosimulate`].
pub fn cosimulate_until(
    system: &mut System,
    experiment: &Experiment,
    until: Option<Until>,
    mut observe: impl FnMut(usize),
) -> Result<Outcome> {
    let schedule = experiment.schedule()?;
    let every = experiment.record_every.max(1);
    let samples = schedule.steps.div_ceil(every) + 1;
    let mut recorder = Recorder::new(system, experiment.all, samples)?;
    for feed in &system.feeds {
        let recording =
            Recording { time: feed.time.to_vec(), source: system.name(feed.to), ..Recording::default() };
        recording.covers(schedule.start, schedule.stop)?;
    }
    for warning in coarse_replay(system, &schedule) {
        system.warn(warning);
    }
    if !schedule.is_even()
        && let Some(component) = system.components.iter().find(|c| c.even_steps_only)
    {
        return Err(Error::call(format!(
            "{} cannot vary its step, and {} s to {} s is no whole number of steps of {} s",
            component.name, schedule.start, schedule.stop, schedule.step
        )));
    }
    system.exchange.log = experiment.log.then(Vec::new);
    system.start(schedule.start, Some(schedule.stop), schedule.step)?;

    let (mut stopped, mut met) = (None, false);
    observe(0);
    recorder.take(system, schedule.start)?;
    for k in 0..schedule.steps {
        let (now, next) = (schedule.point(k), schedule.point(k + 1));
        let step = system.advance(now, next - now).and_then(|()| match until {
            Some(until) => until.is_met(system),
            None => Ok(false),
        });
        met = matches!(step, Ok(true));
        let (sample, last) = ((k + 1) / every, met || k + 1 == schedule.steps);
        // no sum of steps, so that the samples do not drift; the last interval may be a shorter one
        let time = if every == 1 || last {
            next
        } else {
            schedule.start + sample as f64 * (every as f64 * schedule.step)
        };
        let step = step.and_then(|_| match (k + 1) % every {
            0 => recorder.take(system, time),
            _ if last => recorder.take(system, time),
            _ => Ok(()),
        });
        if let Err(error) = step {
            stopped = Some(error.at(format!("{now} s")));
            break;
        }
        observe(k + 1);
        if met {
            break;
        }
    }
    Ok(Outcome {
        recording: recorder.recording,
        stopped,
        met,
        log: system.exchange.log.take().unwrap_or_default(),
        unconverged: system.exchange.unconverged,
        halved: system.exchange.halved,
    })
}

/// Warnings about inputs of an opened component whose recording has not every communication point: what held
/// its value there, such as a valve that switched, goes evenly from sample to sample here.
fn coarse_replay(system: &System, schedule: &Schedule) -> Vec<String> {
    let gap = |time: &[f64]| {
        let inside = |pair: &&[f64]| pair[1] > schedule.start && pair[0] < schedule.stop;
        time.windows(2).filter(inside).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max)
    };
    let mut coarse: Vec<(f64, Vec<String>)> = Vec::new();
    for feed in system.feeds.iter().filter(|feed| feed.lead && feed.continuous) {
        let longest = gap(&feed.time);
        if longest > schedule.step * (1.0 + STEP_TOLERANCE) {
            match coarse.iter_mut().find(|(other, _)| *other == longest) {
                Some((_, names)) => names.push(system.name(feed.to)),
                None => coarse.push((longest, vec![system.name(feed.to)])),
            }
        }
    }
    let warning = |(gap, names): &(f64, Vec<String>)| {
        format!(
            "samples of the recording are up to {gap:.3e} s apart, and the communication step is {} s: {} go evenly from sample to sample, also where they jumped; record every communication point",
            schedule.step,
            names.join(", ")
        )
    };
    coarse.iter().map(warning).collect()
}

/// Warnings about the energies of the bonds after a run with this communication step.
pub fn energy_warnings(system: &System, step: f64) -> Vec<String> {
    let warning = |bond: &Bond| {
        let (effort, motion) = &bond.name;
        format!(
            "the coupling of {effort} and {motion} {} {:.3e} J, {:.1} % of the {:.3e} J that it passed on, as a damper of {:.4e} {} on {motion} would; a communication step of {:e} s would bring that below {} %, or --iterate, or one component for both",
            if bond.generated > 0.0 { "made" } else { "took" },
            bond.generated.abs(),
            100.0 * bond.share().abs(),
            bond.exchanged,
            bond.equivalent_damping(),
            if bond.turns(system) { "N.m.s/rad" } else { "N.s/m" },
            round_down(step * ENERGY_SHARE / bond.share().abs()),
            100.0 * ENERGY_SHARE
        )
    };
    system.bonds().iter().filter(|bond| bond.share().abs() > ENERGY_SHARE).map(warning).collect()
}

/// The next of 1, 2, 5, 10, ... times a power of ten that is not larger: most components' own steps are
/// such numbers.
fn round_down(value: f64) -> f64 {
    let power = value.log10().floor() as i32;
    let text = |digit: u32| format!("{digit}e{power}").parse().unwrap_or(value);
    [5, 2].map(text).into_iter().find(|round| *round <= value).unwrap_or_else(|| text(1))
}

/// Where a column that is no variable of a component comes from.
enum Source {
    Wire(usize),
    Feed(usize),
    Energy(usize),
}

struct Recorder {
    /// What the master knows, and the columns of that.
    known: Vec<(Source, usize)>,
    /// What is read from components: component, variables, and the columns of those.
    read: Vec<(usize, Reader, Vec<usize>)>,
    /// Values on their way, by column, and those of one component.
    values: Vec<f64>,
    part: Vec<f64>,
    recording: Recording,
}

impl Recorder {
    fn new(system: &System, all: bool, samples: usize) -> Result<Self> {
        let mut channels = Vec::new();
        let (mut known, mut read) = (Vec::new(), Vec::new());
        let push = |channels: &mut Vec<Channel>, name: String, unit: Option<&str>| {
            // a unit from outside that is not known here could not be written to a file that reads back
            let unit = unit.filter(|u| Unit::parse(u).is_ok()).unwrap_or("1").to_string();
            channels.push(Channel { name, unit, values: Vec::new() });
            channels.len() - 1
        };
        let wires = by_input(system.wires.iter().map(|w| w.to));
        let feeds = by_input(system.feeds.iter().map(|f| f.to));
        for (index, component) in system.components.iter().enumerate() {
            let (mut variables, mut columns) = (Vec::new(), Vec::new());
            for causality in [Causality::Input, Causality::Output, Causality::Local] {
                for variable in component.interface().with(causality) {
                    let port = Port { component: index, variable };
                    let info = system.info(port);
                    if info.kind == Kind::Text {
                        continue;
                    }
                    let wire = wires.get(&port).map(|i| Source::Wire(*i));
                    let source = wire.or_else(|| feeds.get(&port).map(|i| Source::Feed(*i)));
                    if source.is_none() && !all && causality != Causality::Output {
                        continue;
                    }
                    let column = push(&mut channels, system.name(port), info.unit.as_deref());
                    match source {
                        Some(source) => known.push((source, column)),
                        None => {
                            variables.push(variable);
                            columns.push(column);
                        }
                    }
                }
            }
            read.push((index, Reader::new(component.interface(), variables), columns));
        }
        for (i, bond) in system.bonds.iter().enumerate() {
            let name = format!("generated energy {} {}", bond.name.0, bond.name.1);
            known.push((Source::Energy(i), push(&mut channels, name, Some("J"))));
        }
        let values = samples as f64 * channels.len() as f64;
        if values > MAX_VALUES {
            return Err(Error::call(format!(
                "{samples} samples of {} channels are more than the {MAX_VALUES:.0e} values that are kept in memory; record fewer points (record_every)",
                channels.len()
            )));
        }
        for channel in &mut channels {
            channel.values.reserve_exact(samples);
        }
        let values = vec![0.0; channels.len()];
        let recording =
            Recording { time: Vec::with_capacity(samples), channels, source: "co-simulation".into() };
        Ok(Self { known, read, part: values.clone(), values, recording })
    }

    fn take(&mut self, system: &mut System, time: f64) -> Result<()> {
        for (index, reader, columns) in &mut self.read {
            let component = &mut system.components[*index];
            let part = &mut self.part[..columns.len()];
            reader.read(component.slave.as_mut(), part).map_err(|e| e.at(&component.name))?;
            for (column, value) in columns.iter().zip(part) {
                self.values[*column] = *value;
            }
        }
        for (source, column) in &self.known {
            self.values[*column] = match source {
                Source::Wire(i) => system.exchange.flows[*i].applied.1,
                Source::Feed(i) => system.exchange.fed[*i],
                Source::Energy(i) => system.bonds[*i].generated,
            };
        }
        self.recording.time.push(time);
        for (channel, value) in self.recording.channels.iter_mut().zip(&self.values) {
            channel.values.push(*value);
        }
        Ok(())
    }
}

/// The first place of each input in a list.
fn by_input(inputs: impl Iterator<Item = Port>) -> HashMap<Port, usize> {
    let mut places = HashMap::new();
    for (i, port) in inputs.enumerate() {
        places.entry(port).or_insert(i);
    }
    places
}
