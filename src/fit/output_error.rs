//! [`OutputError`]: what a slave with effects makes of recorded inputs, against what was measured.

use super::bench::{Bench, Drive, Setup, Traces};
use super::least_squares::{Problem, changes};
use super::replay::replay;
use crate::Result;
use crate::effect::{Attachment, Course, Earlier, Port, Signal, attached_interface};
use std::sync::{Arc, Mutex, PoisonError};

/// A measured channel of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// The output that it is compared with.
    pub variable: usize,
    /// Measured values, in the unit of the output.
    pub values: Vec<f64>,
    /// True if it counts on and on from a zero that means nothing, as the angle of a wheel does: only
    /// its changes within a run are compared.
    pub counts: bool,
    /// For each sample, an error that its numbers do not tell, or that rounding makes, or the way of inputs between samples, in its unit;
    /// empty as long as it is not known.
    pub unresolved: Vec<f64>,
}

impl Channel {
    /// Some of its samples, as far as it has them.
    pub fn samples(&self, range: std::ops::Range<usize>) -> Self {
        let part = |of: &[f64]| of[range.start.min(of.len())..range.end.min(of.len())].to_vec();
        Self { values: part(&self.values), unresolved: part(&self.unresolved), ..self.clone() }
    }

    /// Moves a simulated course to the zero from which the measured one counts.
    fn same_zero(&self, simulated: &mut [f64]) {
        if self.counts {
            let sum: f64 = self.values.iter().zip(&*simulated).map(|(m, s)| m - s).sum();
            let mean = sum / self.values.len().max(1) as f64;
            simulated.iter_mut().for_each(|s| *s += mean);
        }
    }
}

/// A recorded run, ready to be simulated.
#[derive(Debug, Clone)]
pub struct Run {
    /// Name of its file.
    pub name: String,
    /// What drives it.
    pub drive: Arc<Drive>,
    /// Times of the measured samples \[s\].
    pub time: Vec<f64>,
    /// Measured channels; the same in every run, and empty where one lacks it.
    pub channels: Vec<Channel>,
}

impl Run {
    /// What the runs after it in a session know of it.
    pub fn as_earlier(&self) -> Earlier {
        let inputs = self.drive.inputs.iter().map(|(v, values)| (*v, self.sample(values, 0.0)));
        let measured = self.channels.iter().map(|c| (c.variable, c.values.clone()));
        Earlier { time: self.time.clone(), signals: inputs.chain(measured).collect() }
    }

    /// The same run with other inputs: each value by its variable and communication point.
    pub fn with_inputs(&self, of: impl Fn(usize, usize, f64) -> f64) -> Self {
        let inputs = self.drive.inputs.iter().map(|(variable, values)| {
            (*variable, values.iter().enumerate().map(|(k, v)| of(*variable, k, *v)).collect())
        });
        let drive = Drive { inputs: inputs.collect(), coarser: None, ..Drive::clone(&self.drive) };
        Self { drive: Arc::new(drive), ..self.clone() }
    }

    /// A trace on the grid of communication points at the times of the samples less `lag` \[s\], linear in
    /// between.
    pub fn sample(&self, trace: &[f64], lag: f64) -> Vec<f64> {
        self.sample_of(&self.drive, trace, lag)
    }

    /// The same of a trace on the grid of another drive.
    fn sample_of(&self, drive: &Drive, trace: &[f64], lag: f64) -> Vec<f64> {
        let course = Course { start: drive.start, step: drive.step, values: trace };
        self.time.iter().map(|t| course.at(t - lag)).collect()
    }
}

/// What an unknown of a fit is, with the size of one unit of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Knob {
    /// A parameter of the slave: index and scale.
    Parameter(usize, f64),
    /// A parameter of an effect that is attached once or at several places.
    Effect {
        /// Number of the first attachment,
        first: usize,
        /// and of the one behind the last.
        end: usize,
        /// Number of the parameter.
        parameter: usize,
        /// Size of one unit.
        scale: f64,
        /// The unknown is the logarithm of the parameter over its scale.
        logarithmic: bool,
    },
    /// A lag of all recorded channels \[s\] behind the inputs, and its scale: filters of the recorder.
    Lag(f64),
    /// What a measured channel shows at zero in all runs: number of the channel and scale, in its unit.
    Zero(usize, f64),
}

/// The residuals of some runs as a function of the unknowns.
pub struct OutputError<'a> {
    /// What runs.
    pub bench: &'a Bench,
    /// The runs.
    pub runs: Vec<&'a Run>,
    /// What the unknowns are.
    pub knobs: Vec<Knob>,
    /// Values that stay.
    pub values: Vec<(usize, f64)>,
    /// Effects, with parameters where the unknowns do not say otherwise.
    pub attachments: Vec<Attachment>,
    /// One weight per channel: residuals are multiplied by it.
    pub weights: Vec<f64>,
    /// A value with which changes are simulated, of which only differences count: a longer step of the slave's own.
    pub of_changes: Option<(usize, f64)>,
    /// Whether it is one of changes: with the longer communication steps of the drives that have such.
    pub is_coarse: bool,
    /// What is added to all residuals, if anything.
    pub beside: Option<Arc<[f64]>>,
    /// What was simulated last.
    pub kept: Mutex<Vec<Kept>>,
}

/// Simulations that are kept at most: the point where a fit stands, and those that it has tried from there.
const KEPT: usize = 8;

/// What the runs of a setup have made of it.
#[derive(Debug, Clone)]
pub struct Kept {
    key: Key,
    drives: Vec<Arc<Drive>>,
    watch: Arc<[usize]>,
    /// `None` if a run has failed.
    traces: Option<Arc<Vec<Traces>>>,
}

impl Kept {
    /// Whether it is of this setup along these drives, with all that is to be watched.
    fn is(&self, key: &Key, drives: &[Arc<Drive>], watch: &[usize]) -> bool {
        self.key == *key
            && self.drives.len() == drives.len()
            && self.drives.iter().zip(drives).all(|(a, b)| Arc::ptr_eq(a, b))
            && watch.iter().all(|v| self.watch.contains(v))
    }
}

/// All that a simulation depends on beside its drive, to the last bit.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Key {
    values: Vec<(usize, u64)>,
    /// Where the effect itself is, where it acts, what drives it, and its parameters.
    attachments: Vec<(usize, usize, Vec<Signal>, Vec<u64>)>,
}

impl Key {
    fn of(setup: &Setup) -> Self {
        let attachment = |a: &Attachment| {
            let parameters = a.parameters.iter().map(|p| p.value.to_bits()).collect();
            (std::ptr::from_ref(a.effect) as usize, a.target, a.drivers.clone(), parameters)
        };
        Self {
            values: setup.values.iter().map(|(v, x)| (*v, x.to_bits())).collect(),
            attachments: setup.attachments.iter().map(attachment).collect(),
        }
    }
}

impl<'a> OutputError<'a> {
    /// The setup for a point.
    pub fn setup(&self, point: &[f64]) -> Setup {
        let mut setup = Setup { values: self.values.clone(), attachments: self.attachments.clone() };
        for (knob, x) in self.knobs.iter().zip(point) {
            match *knob {
                Knob::Parameter(variable, scale) => {
                    setup.values.retain(|(v, _)| *v != variable);
                    setup.values.push((variable, x * scale));
                }
                Knob::Effect { first, end, parameter, scale, logarithmic } => {
                    let value = if logarithmic { x.exp() } else { *x };
                    for attachment in &mut setup.attachments[first..end] {
                        attachment.parameters[parameter].value = value * scale;
                    }
                }
                Knob::Lag(_) | Knob::Zero(..) => {}
            }
        }
        setup
    }

    fn lag(&self, point: &[f64]) -> f64 {
        let of = |(knob, x): (&Knob, &f64)| if let Knob::Lag(scale) = knob { x * scale } else { 0.0 };
        self.knobs.iter().zip(point).map(of).sum()
    }

    /// What each channel shows at zero.
    fn zeros(&self, point: &[f64]) -> Vec<f64> {
        let mut zeros = vec![0.0; self.weights.len()];
        for (knob, x) in self.knobs.iter().zip(point) {
            if let Knob::Zero(channel, scale) = knob {
                zeros[*channel] += x * scale;
            }
        }
        zeros
    }

    /// The outputs that are compared.
    pub fn watch(&self) -> Arc<[usize]> {
        self.runs.first().map_or(Arc::from([]), |r| r.channels.iter().map(|c| c.variable).collect())
    }

    /// Which effects only change outputs that nothing inside the slave gets: no other signal depends on them.
    fn is_outside(&self, attachment: &Attachment) -> bool {
        attachment.port(self.bench.interface()) == Port::Output && !self.bench.is_passed_on(attachment.target)
    }

    fn is_attachable(&self) -> bool {
        attached_interface(self.bench.interface(), &self.attachments).is_ok()
    }

    /// What drives each run.
    fn drives(&self) -> Vec<Arc<Drive>> {
        let of =
            |run: &&Run| run.drive.coarser.as_ref().filter(|_| self.is_coarse).unwrap_or(&run.drive).clone();
        self.runs.iter().map(of).collect()
    }

    /// What has to be simulated for a setup, and the effects that are replayed behind it.
    fn parted(&self, setup: Setup) -> (Setup, Vec<Attachment>) {
        let (outside, attachments) = setup.attachments.into_iter().partition(|a| self.is_outside(a));
        (Setup { attachments, ..setup }, outside)
    }

    /// The outputs that are compared, and what drives the effects that are replayed.
    fn watch_for(&self, outside: &[Attachment]) -> Arc<[usize]> {
        let mut watch = self.watch().to_vec();
        for signal in outside.iter().flat_map(|a| &a.drivers) {
            let drives = |run: &Arc<Drive>| run.inputs.iter().any(|(v, _)| *v == signal.variable);
            if !watch.contains(&signal.variable) && !self.runs.iter().all(|run| drives(&run.drive)) {
                watch.push(signal.variable);
            }
        }
        watch.into()
    }

    /// The simulated channels of every run at its samples, for each point; `None` where a run fails. What differs in
    /// effects on outputs, in the lag or in zeros only is simulated once, and what was simulated last is not simulated again.
    pub fn simulate(&self, points: &[Vec<f64>]) -> Vec<Option<Vec<Traces>>> {
        let parted: Vec<(Setup, Vec<Attachment>)> =
            points.iter().map(|p| self.parted(self.setup(p))).collect();
        let watch = parted.first().map_or(self.watch(), |(_, outside)| self.watch_for(outside));
        let drives = self.drives();
        let keys: Vec<Key> = parted.iter().map(|(setup, _)| Key::of(setup)).collect();
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let mut new: Vec<(&Key, Arc<Setup>)> = Vec::new();
        for (key, (setup, _)) in keys.iter().zip(&parted) {
            if !kept.iter().any(|k| k.is(key, &drives, &watch)) && !new.iter().any(|(n, _)| *n == key) {
                new.push((key, Arc::new(setup.clone())));
            }
        }
        let setups: Vec<Arc<Setup>> = new.iter().map(|(_, setup)| Arc::clone(setup)).collect();
        let results = self.bench.run(&setups, &drives, &watch);
        let mut results = results.into_iter();
        let fresh: Vec<Kept> = (new.into_iter())
            .map(|(key, _)| {
                let runs: Vec<Result<Traces>> = results.by_ref().take(drives.len()).collect();
                let traces = runs.into_iter().map(Result::ok).collect::<Option<Vec<Traces>>>();
                Kept {
                    key: key.clone(),
                    drives: drives.clone(),
                    watch: Arc::clone(&watch),
                    traces: traces.map(Arc::new),
                }
            })
            .collect();
        let answer = |key: &Key, outside: &[Attachment], point: &[f64]| {
            // what cannot be attached to the slave is not replayed either
            if !outside.is_empty() && !self.is_attachable() {
                return None;
            }
            let found = fresh.iter().chain(kept.iter()).find(|k| k.is(key, &drives, &watch))?;
            self.sampled(found, outside, self.lag(point), &self.zeros(point))
        };
        let answers = (keys.iter().zip(&parted).zip(points))
            .map(|((key, (_, outside)), point)| answer(key, outside, point))
            .collect();
        // points of derivatives are not asked for again
        if points.len() == 1 {
            kept.extend(fresh);
            let old = kept.len().saturating_sub(KEPT);
            kept.drain(..old);
        }
        answers
    }

    /// The channels of every run at its samples, behind effects on outputs.
    fn sampled(&self, kept: &Kept, outside: &[Attachment], lag: f64, zeros: &[f64]) -> Option<Vec<Traces>> {
        let of = |((run, drive), traces): ((&&Run, &Arc<Drive>), &Traces)| -> Option<Traces> {
            let channel = |(c, channel): (usize, &Channel)| {
                let column = kept.watch.iter().position(|v| *v == channel.variable)?;
                let mut changed: Option<Vec<f64>> = None;
                for effect in outside.iter().filter(|a| a.target == channel.variable) {
                    let course = changed.as_deref().unwrap_or(&traces[column]);
                    let now = replay(effect, course, drive, &kept.watch, traces)?;
                    if now.iter().any(|v| !v.is_finite()) {
                        return None;
                    }
                    changed = Some(now);
                }
                let mut values = run.sample_of(drive, changed.as_deref().unwrap_or(&traces[column]), lag);
                let zero = zeros.get(c).copied().unwrap_or_default();
                values.iter_mut().for_each(|v| *v += zero);
                channel.same_zero(&mut values);
                Some(values)
            };
            run.channels.iter().enumerate().map(channel).collect()
        };
        self.runs.iter().zip(&kept.drives).zip(kept.traces.as_ref()?.iter()).map(of).collect()
    }

    /// Begins with what another problem has simulated.
    pub fn keep(&self, kept: Option<Kept>) {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner).extend(kept);
    }

    /// What was simulated last at a point, for another problem to begin with.
    pub fn kept(&self, point: &[f64]) -> Option<Kept> {
        let key = Key::of(&self.parted(self.setup(point)).0);
        let kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.iter().rev().find(|k| k.key == key).cloned()
    }

    /// The same problem with the value and the drives with which changes are simulated.
    pub fn of_changes(&self) -> Option<Self> {
        if self.is_coarse || self.of_changes.is_none() && self.runs.iter().all(|r| r.drive.coarser.is_none())
        {
            return None;
        }
        let mut values = self.values.clone();
        values.retain(|(v, _)| self.of_changes.is_none_or(|(of_changes, _)| *v != of_changes));
        values.extend(self.of_changes);
        Some(Self {
            bench: self.bench,
            runs: self.runs.clone(),
            knobs: self.knobs.clone(),
            values,
            attachments: self.attachments.clone(),
            weights: self.weights.clone(),
            of_changes: None,
            is_coarse: true,
            beside: None,
            kept: Mutex::default(),
        })
    }

    /// Simulated minus measured, weighted: run by run, channel by channel.
    pub fn difference(&self, simulated: &[Traces]) -> Vec<f64> {
        let mut residuals = Vec::new();
        for (run, traces) in self.runs.iter().zip(simulated) {
            for ((channel, trace), weight) in run.channels.iter().zip(traces).zip(&self.weights) {
                residuals.extend(trace.iter().zip(&channel.values).map(|(s, m)| weight * (s - m)));
            }
        }
        residuals
    }
}

impl Problem for OutputError<'_> {
    fn residuals(&self, points: &[Vec<f64>]) -> Vec<Option<Vec<f64>>> {
        let residuals = |simulated: Vec<Traces>| {
            let mut residuals = self.difference(&simulated);
            let beside = self.beside.iter().flat_map(|beside| beside.iter());
            residuals.iter_mut().zip(beside).for_each(|(residual, more)| *residual += more);
            residuals
        };
        self.simulate(points).into_iter().map(|simulated| simulated.map(residuals)).collect()
    }

    fn least_variance(&self) -> f64 {
        let (mut square, mut n) = (0.0, 0.0);
        for run in &self.runs {
            for (channel, weight) in run.channels.iter().zip(&self.weights) {
                square += channel.unresolved.iter().map(|u| (weight * u).powi(2)).sum::<f64>();
                n += channel.values.len() as f64;
            }
        }
        square / f64::max(n, 1.0)
    }

    fn changes(&self, from: &[f64], residuals: &[f64], points: &[Vec<f64>]) -> Vec<Option<Vec<f64>>> {
        let Some(other) = self.of_changes().filter(|_| !points.is_empty()) else {
            return changes(residuals, self.residuals(points));
        };
        let all: Vec<Vec<f64>> = std::iter::once(from.to_vec()).chain(points.iter().cloned()).collect();
        let mut answers = other.residuals(&all).into_iter();
        match answers.next().flatten() {
            Some(base) => changes(&base, answers.collect()),
            None => changes(residuals, self.residuals(points)),
        }
    }
}
