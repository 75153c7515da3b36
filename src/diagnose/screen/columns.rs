//! What screening knows of an effect: how outputs change with each of its amounts, replayed, simulated, or as a sum of others.

use super::super::placement::Placement;
use super::super::span::sums;
use super::{Column, MAX_ROWS, Probe, Screen};
use crate::Result;
use crate::effect::{Attachment, Port};
use crate::fit::{Channel, Drive, Run, Setup, Traces, replay, side_by_side};
use crate::model::{Causality, Interface};
use crate::stats::mean_or_zero;
use nalgebra::DVector;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

impl Screen<'_> {
    /// True for an effect on outputs that nothing inside the model gets and that no output drives which another effect
    /// changes: traces tell all about it, behind the effects that are there.
    pub(super) fn is_replayed(&self, placement: &Placement) -> bool {
        let changed = |v: usize| {
            self.model.effects.iter().any(|(p, _)| p.port == Port::Output && p.targets.contains(&v))
        };
        let behind = placement.drivers.iter().any(|signal| changed(signal.variable));
        let inside = placement.targets.iter().any(|v| self.bench.is_passed_on(*v));
        placement.port == Port::Output && !behind && !inside
    }

    /// Change of the weighted outputs of some runs per unit of one amplitude: of each probe, for each of its amplitudes.
    /// What is known of these is taken as it is; `how` closely others are made of each other, [`sums`] says.
    pub(super) fn columns(
        &self,
        interface: &Interface,
        placements: &[Placement],
        probes: &[Probe],
        runs: Range<usize>,
        (how, known): (f64, Vec<Option<Column>>),
    ) -> Vec<Option<Column>> {
        let jobs: Vec<(&Probe, Option<usize>)> = probes.iter().flat_map(Probe::jobs).collect();
        let step_of = |(probe, amplitude): &(&Probe, Option<usize>)| {
            let parameters = placements[probe.placement].effect.parameters;
            amplitude.map_or(1.0, |i| parameters[i].probes.first().copied().unwrap_or(0.01))
        };
        let attach = |job: &(&Probe, Option<usize>)| {
            let mut values = job.0.shape.clone();
            if let Some(amplitude) = job.1 {
                values[amplitude] += step_of(job);
            }
            placements[job.0.placement].attach(&values)
        };
        let mut columns = known;
        columns.resize(jobs.len(), None);
        let (replayed, of_setup): (Vec<usize>, Vec<usize>) =
            (0..jobs.len()).partition(|k| self.is_replayed(&placements[jobs[*k].0.placement]));
        let of_setup: Vec<usize> = of_setup.into_iter().filter(|k| columns[*k].is_none()).collect();
        let replay_one = |k: &usize| {
            let job = &jobs[*k];
            self.replayed(interface, &attach(job), runs.clone(), step_of(job))
        };
        let done = side_by_side(self.bench.threads(), &replayed, replay_one);
        for (k, column) in replayed.iter().zip(done) {
            columns[*k] = column;
        }
        // the first answer to a change at a place is in proportion: sums of changes are answered by the sums
        let courses: HashMap<usize, DVector<f64>> = of_setup
            .iter()
            .filter_map(|k| {
                // a whole is no sum of what others do
                let small = jobs[*k].1.map(|_| attach(&jobs[*k]))?;
                Some((*k, self.course(interface, &small, runs.clone(), step_of(&jobs[*k]))?))
            })
            .collect();
        let place = |k: usize| {
            let placement = &placements[jobs[k].0.placement];
            (&placement.targets[..], placement.port)
        };
        let with = |k: &usize| {
            let mut setup = self.setup.clone();
            setup.attachments.extend(attach(&jobs[*k]));
            (setup, step_of(&jobs[*k]))
        };
        // what would be a sum of one that cannot be simulated is held against the others anew
        let (mut open, mut simulated) = (of_setup, Vec::new());
        while !open.is_empty() {
            let sums = sums(&open, &simulated, &courses, place, how);
            let own: Vec<usize> = open.iter().copied().filter(|k| !sums.contains_key(k)).collect();
            for (k, column) in own.iter().zip(self.simulated(own.iter().map(with), runs.clone())) {
                simulated.extend(column.as_ref().map(|_| *k));
                columns[*k] = column;
            }
            open.retain(|k| sums.contains_key(k));
            for (k, sum) in sums {
                let terms = sum.iter().map(|(t, factor)| Some((columns[*t].as_ref()?, *factor)));
                if let Some(terms) = terms.collect::<Option<Vec<_>>>() {
                    columns[k] = Some(self.sum(&terms, runs.clone()));
                }
            }
            open.retain(|k| columns[*k].is_none());
        }
        columns
    }

    /// What an effect changes at its targets along the runs, per unit of an amplitude, as the traces tell: effects that are
    /// off hardly change what drives them. `None` where a course is not known.
    fn course(
        &self,
        interface: &Interface,
        attachments: &[Attachment],
        runs: Range<usize>,
        step: f64,
    ) -> Option<DVector<f64>> {
        let mut all = Vec::new();
        for (run, traces) in self.runs[runs.clone()].iter().zip(&self.traces[runs]) {
            let behind =
                |effect: &Attachment, course: &[f64]| replay(effect, course, &run.drive, &self.watch, traces);
            for attachment in attachments {
                let traced = self.watch.iter().position(|v| *v == attachment.target);
                let held = || self.setup.values.iter().find(|(v, _)| *v == attachment.target);
                let mut target = match traced {
                    Some(column) => traces[column].clone(),
                    None => vec![held()?.1; run.drive.points],
                };
                // outputs are traced behind the effects that are there already
                if attachment.port(interface) != Port::Output {
                    for known in self.setup.attachments.iter().filter(|a| a.target == attachment.target) {
                        target = behind(known, &target)?;
                    }
                }
                let changed = behind(attachment, &target)?;
                all.extend(changed.iter().zip(&target).map(|(a, b)| (a - b) / step));
            }
        }
        let course = thin(&all, all.len().div_ceil(MAX_ROWS).max(1));
        course.iter().all(|v| v.is_finite()).then_some(course)
    }

    /// A sum of columns.
    fn sum(&self, terms: &[(&Column, f64)], runs: Range<usize>) -> Column {
        let of = |run: usize| {
            let mut sum: Option<DVector<f64>> = None;
            for (column, factor) in terms {
                match &mut sum {
                    Some(sum) => sum.axpy(*factor, &column[run], 1.0),
                    None => sum = Some(&column[run] * *factor),
                }
            }
            // of what changes nothing
            sum.unwrap_or_else(|| &self.residual[runs.start + run] * 0.0)
        };
        (0..runs.len()).map(of).collect()
    }

    /// Change of the weighted outputs of some runs per step, of each setup with its step.
    fn simulated(
        &self,
        setups: impl Iterator<Item = (Setup, f64)>,
        runs: Range<usize>,
    ) -> Vec<Option<Column>> {
        let own = &self.runs[runs.clone()];
        let drives: Vec<Arc<Drive>> = own.iter().map(|r| Arc::clone(&r.drive)).collect();
        let measured: Arc<[usize]> =
            self.runs.first().map_or(Arc::from([]), |r| r.channels.iter().map(|c| c.variable).collect());
        let (setups, steps): (Vec<Arc<Setup>>, Vec<f64>) =
            setups.map(|(setup, step)| (Arc::new(setup), step)).unzip();
        let mut columns = Vec::new();
        // not all at once: traces take memory
        for (chunk, steps) in setups.chunks(32).zip(steps.chunks(32)) {
            let answers = self.bench.run(chunk, &drives, &measured);
            for (answers, step) in answers.chunks(own.len().max(1)).zip(steps) {
                let change = |((run, traces), base): ((&&Run, &Result<Traces>), &Traces)| {
                    let traces = traces.as_ref().ok()?;
                    let mut change = Vec::new();
                    for ((channel, trace), weight) in run.channels.iter().zip(traces).zip(self.weights) {
                        let column = self.watch.iter().position(|v| *v == channel.variable)?;
                        change.extend(difference(run, channel, trace, &base[column], *weight));
                    }
                    Some(thin(&change, self.stride) / *step)
                };
                columns.push(own.iter().zip(answers).zip(&self.traces[runs.clone()]).map(change).collect());
            }
        }
        columns
    }

    /// The change that an effect on an output makes, from the traces: nothing has to be simulated.
    fn replayed(
        &self,
        interface: &Interface,
        attachments: &[Attachment],
        runs: Range<usize>,
        step: f64,
    ) -> Column {
        debug_assert!(
            attachments.iter().all(|a| interface.variables[a.target].causality != Causality::Input)
        );
        let of = |(run, traces): (&&Run, &Traces)| {
            let mut change = Vec::new();
            for (channel, weight) in run.channels.iter().zip(self.weights) {
                let target = self.watch.iter().position(|v| *v == channel.variable).map(|c| &traces[c][..]);
                let own = attachments.iter().find(|a| a.target == channel.variable);
                let changed = own
                    .zip(target)
                    .and_then(|(a, target)| replay(a, target, &run.drive, &self.watch, traces));
                match changed.zip(target) {
                    Some((changed, target)) => {
                        change.extend(difference(run, channel, &changed, target, *weight));
                    }
                    None => change.extend(std::iter::repeat_n(0.0, channel.values.len())),
                }
            }
            thin(&change, self.stride) / step
        };
        self.runs[runs.clone()].iter().zip(&self.traces[runs]).map(of).collect()
    }
}

/// Every so many of the values.
pub(super) fn thin(values: &[f64], stride: usize) -> DVector<f64> {
    DVector::from_iterator(values.len().div_ceil(stride), values.iter().step_by(stride).copied())
}

/// Weighted change of a channel at its samples.
fn difference(run: &Run, channel: &Channel, after: &[f64], before: &[f64], weight: f64) -> Vec<f64> {
    let before = run.sample(before, 0.0);
    let mut change: Vec<f64> = run.sample(after, 0.0).iter().zip(before).map(|(a, b)| a - b).collect();
    if channel.counts {
        let mean = mean_or_zero(&change);
        change.iter_mut().for_each(|c| *c -= mean);
    }
    change.iter_mut().for_each(|c| *c *= weight);
    change
}
