//! Cheap screening of many effects: how much of the residual each can explain at its off value, beyond
//! what the model's own parameters can.

use super::placement::Placement;
use super::study::Model;
use crate::effect::{Call, MAX_DRIVERS, Memory, Port, Source};
use crate::fit::{Bench, Channel, Drive, OutputError, Run, Setup, Traces};
use crate::model::{Causality, Interface};
use crate::stats::mean_or_zero;
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// Rows of the linear problem at most.
const MAX_ROWS: usize = 12_000;
/// Combinations of shapes that are tried for one placement.
pub const MAX_SHAPES: usize = 6;
/// And where nothing has to be simulated.
const MAX_REPLAYED: usize = 240;

/// What screening knows: the model as fitted, its residual and sensitivities, and all its signals.
pub struct Screen<'a> {
    /// What runs.
    pub bench: &'a Bench,
    /// Runs that are looked at.
    pub runs: Vec<&'a Run>,
    /// The model as fitted.
    pub model: &'a Model,
    /// Its setup.
    pub setup: Setup,
    /// Weights of the channels.
    pub weights: &'a [f64],
    /// Indices of the traced variables.
    pub watch: Arc<[usize]>,
    /// Their traces in each run.
    pub traces: Vec<Traces>,
    /// Orthonormal columns that span what the fitted parameters can explain; rows as the residual.
    pub basis: DMatrix<f64>,
    /// Weighted residual, measured minus simulated, less what the parameters can explain.
    pub residual: DVector<f64>,
    /// Every how many samples count.
    pub stride: usize,
    /// Combinations of shapes that are tried for one placement.
    pub shapes: usize,
}

/// A placement with its best shape, by linear prediction.
#[derive(Debug, Clone)]
pub struct Screened {
    /// Where.
    pub placement: Placement,
    /// Parameters, as multiples of their scales.
    pub values: Vec<f64>,
    /// Share of the squared residual that it explains.
    pub gain: f64,
    /// Number of places at which the effect was looked for.
    pub places: usize,
}

impl<'a> Screen<'a> {
    /// Prepares: traces of all signals and the linear problem of the fitted parameters.
    ///
    /// `problem` is that of the model on the runs, `point` where it stands, `simulated` what it gives there.
    pub fn new(
        problem: &OutputError<'a>,
        simulated: &[Traces],
        model: &'a Model,
        point: &[f64],
        steps: &[f64],
        watch: Arc<[usize]>,
        weights: &'a [f64],
    ) -> Option<Self> {
        let runs = problem.runs.clone();
        let drives: Vec<Arc<Drive>> = runs.iter().map(|r| Arc::clone(&r.drive)).collect();
        let setup = problem.setup(point);
        let traces: Option<Vec<Traces>> = problem
            .bench
            .run(&[Arc::new(setup.clone())], &drives, &watch)
            .into_iter()
            .map(std::result::Result::ok)
            .collect();
        let mut points = vec![point.to_vec()];
        for (i, step) in steps.iter().enumerate() {
            let mut moved = point.to_vec();
            moved[i] += step;
            points.push(moved);
        }
        let mut answers = problem.simulate(&points).into_iter();
        let base = problem.difference(&answers.next()??);
        let residual = problem.difference(simulated);
        let stride = residual.len().div_ceil(MAX_ROWS).max(1);
        let thin = |values: Vec<f64>| {
            DVector::from_iterator(values.len().div_ceil(stride), values.into_iter().step_by(stride))
        };
        let residual = -thin(residual);
        let base = thin(base);
        let columns: Vec<DVector<f64>> = answers
            .zip(steps)
            .filter_map(|(answer, step)| {
                answer.map(|moved| (thin(problem.difference(&moved)) - &base) / *step)
            })
            .collect();
        let basis = orthonormal(residual.len(), &columns);
        let residual = &residual - &basis * basis.tr_mul(&residual);
        Some(Self {
            bench: problem.bench,
            runs,
            model,
            setup,
            weights,
            watch,
            traces: traces?,
            basis,
            residual,
            stride,
            shapes: MAX_SHAPES,
        })
    }

    /// The share that each placement explains, the best first.
    pub fn screen(&self, interface: &Interface, placements: &[Placement]) -> Vec<Screened> {
        let mut probes: Vec<(usize, Vec<f64>, Vec<usize>)> = Vec::new();
        for (number, placement) in placements.iter().enumerate() {
            let parameters = placement.effect.parameters;
            let amplitudes: Vec<usize> =
                (0..parameters.len()).filter(|i| parameters[*i].off.is_some()).collect();
            let mut shapes: Vec<Vec<f64>> = vec![parameters.iter().map(|p| p.off.unwrap_or(0.0)).collect()];
            for (i, parameter) in parameters.iter().enumerate().filter(|(_, p)| p.off.is_none()) {
                shapes = shapes
                    .iter()
                    .flat_map(|shape| {
                        parameter.probes.iter().map(move |probe| {
                            let mut shape = shape.clone();
                            shape[i] = *probe;
                            shape
                        })
                    })
                    .collect();
            }
            // an even choice if there are too many
            let most = if self.is_replayed(placement) { MAX_REPLAYED } else { self.shapes };
            let skip = shapes.len().div_ceil(most).max(1);
            for shape in shapes.into_iter().step_by(skip) {
                probes.push((number, shape, amplitudes.clone()));
            }
        }
        let mut jobs: Vec<(usize, Vec<f64>, usize)> = Vec::new();
        for (k, (_, shape, amplitudes)) in probes.iter().enumerate() {
            for i in amplitudes {
                jobs.push((k, shape.clone(), *i));
            }
        }
        let columns = self.columns(interface, placements, &probes, &jobs);
        let mut best: Vec<Option<Screened>> = vec![None; placements.len()];
        let total = self.residual.norm_squared().max(f64::MIN_POSITIVE);
        let mut columns = columns.into_iter();
        for (number, shape, amplitudes) in &probes {
            let own: Vec<Option<DVector<f64>>> = columns.by_ref().take(amplitudes.len()).collect();
            let Some(own) = own.into_iter().collect::<Option<Vec<_>>>() else { continue };
            let clean: Vec<DVector<f64>> =
                own.iter().map(|c| c - &self.basis * self.basis.tr_mul(c)).collect();
            let Some((gain, amounts)) = explain(&clean, &own, &self.residual) else { continue };
            let parameters = placements[*number].effect.parameters;
            let mut values = shape.clone();
            for (i, amount) in amplitudes.iter().zip(amounts) {
                let (low, high) = parameters[*i].search;
                values[*i] = (parameters[*i].off.unwrap_or(0.0) + amount).clamp(low, high);
            }
            let gain = gain / total;
            if best[*number].as_ref().is_none_or(|b| b.gain < gain) {
                best[*number] =
                    Some(Screened { placement: placements[*number].clone(), values, gain, places: 1 });
            }
        }
        let mut found: Vec<Screened> = best.into_iter().flatten().collect();
        found.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        found
    }

    /// True for an effect on outputs that no other effect changes and that nothing inside the model gets: traces
    /// tell all about it.
    fn is_replayed(&self, placement: &Placement) -> bool {
        let behind =
            self.model.effects.iter().any(|(p, _)| {
                p.port == Port::Output && p.targets.iter().any(|v| placement.targets.contains(v))
            });
        let inside = placement.targets.iter().any(|v| self.bench.is_passed_on(*v));
        placement.port == Port::Output && !behind && !inside
    }

    /// Change of the weighted outputs per unit of one amplitude, for each job.
    fn columns(
        &self,
        interface: &Interface,
        placements: &[Placement],
        probes: &[(usize, Vec<f64>, Vec<usize>)],
        jobs: &[(usize, Vec<f64>, usize)],
    ) -> Vec<Option<DVector<f64>>> {
        let step_of = |job: &(usize, Vec<f64>, usize)| {
            let parameter = &placements[probes[job.0].0].effect.parameters[job.2];
            parameter.probes.first().copied().unwrap_or(0.01)
        };
        let attach = |job: &(usize, Vec<f64>, usize)| {
            let placement = &placements[probes[job.0].0];
            let mut values = job.1.clone();
            values[job.2] += step_of(job);
            placement.attach(&values)
        };
        let mut columns: Vec<Option<DVector<f64>>> = vec![None; jobs.len()];
        let (replayed, of_setup): (Vec<usize>, Vec<usize>) =
            (0..jobs.len()).partition(|k| self.is_replayed(&placements[probes[jobs[*k].0].0]));
        let share = replayed.len().div_ceil(self.bench.threads()).max(1);
        let replay_one = |k: &usize| {
            let job = &jobs[*k];
            self.replayed(interface, &attach(job)) / step_of(job)
        };
        std::thread::scope(|scope| {
            let shares: Vec<_> = replayed
                .chunks(share)
                .map(|own| scope.spawn(move || own.iter().map(replay_one).collect::<Vec<_>>()))
                .collect();
            for (own, thread) in replayed.chunks(share).zip(shares) {
                // a thread that fails has its columns missing, as runs that fail have
                for (k, column) in own.iter().zip(thread.join().unwrap_or_default()) {
                    columns[*k] = Some(column);
                }
            }
        });
        let with = |k: &usize| {
            let mut setup = self.setup.clone();
            setup.attachments.extend(attach(&jobs[*k]));
            Arc::new(setup)
        };
        let setups: Vec<Arc<Setup>> = of_setup.iter().map(with).collect();
        let drives: Vec<Arc<Drive>> = self.runs.iter().map(|r| Arc::clone(&r.drive)).collect();
        let measured: Arc<[usize]> =
            self.runs.first().map_or(Arc::from([]), |r| r.channels.iter().map(|c| c.variable).collect());
        // not all at once: traces take memory
        for (chunk, places) in setups.chunks(32).zip(of_setup.chunks(32)) {
            let answers = self.bench.run(chunk, &drives, &measured);
            for (runs, place) in answers.chunks(self.runs.len().max(1)).zip(places) {
                let mut change = Vec::new();
                let mut complete = true;
                for ((run, traces), base) in self.runs.iter().zip(runs).zip(&self.traces) {
                    let Ok(traces) = traces else {
                        complete = false;
                        break;
                    };
                    for ((channel, trace), weight) in run.channels.iter().zip(traces).zip(self.weights) {
                        let Some(column) = self.watch.iter().position(|v| *v == channel.variable) else {
                            continue;
                        };
                        change.extend(difference(run, channel, trace, &base[column], *weight));
                    }
                }
                if complete {
                    columns[*place] = Some(self.thin(&change) / step_of(&jobs[*place]));
                }
            }
        }
        columns
    }

    fn thin(&self, values: &[f64]) -> DVector<f64> {
        DVector::from_iterator(
            values.len().div_ceil(self.stride),
            values.iter().step_by(self.stride).copied(),
        )
    }

    /// The change that an effect on an output makes, from the traces: nothing has to be simulated.
    fn replayed(&self, interface: &Interface, attachments: &[crate::effect::Attachment]) -> DVector<f64> {
        let mut change = Vec::new();
        for (run, traces) in self.runs.iter().zip(&self.traces) {
            for (channel, weight) in run.channels.iter().zip(self.weights) {
                let own = attachments.iter().find(|a| a.target == channel.variable);
                let changed = own.and_then(|a| replay(interface, a, &run.drive, &self.watch, traces));
                let Some(changed) = changed else {
                    change.extend(std::iter::repeat_n(0.0, channel.values.len()));
                    continue;
                };
                let Some(column) = self.watch.iter().position(|v| *v == channel.variable) else { continue };
                change.extend(difference(run, channel, &changed, &traces[column], *weight));
            }
        }
        self.thin(&change)
    }
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

/// An output after an effect on it, from traces of the slave without that effect.
pub fn replay(
    interface: &Interface,
    attachment: &crate::effect::Attachment,
    drive: &Drive,
    watch: &[usize],
    traces: &Traces,
) -> Option<Vec<f64>> {
    let column = |variable: usize| watch.iter().position(|v| *v == variable).map(|c| &traces[c]);
    let target = column(attachment.target)?;
    let parameters: Vec<f64> = attachment.parameters.iter().map(|p| p.value).collect();
    let signals: Option<Vec<&Vec<f64>>> = attachment.drivers.iter().map(|s| column(s.variable)).collect();
    let signals = signals?;
    let mut memory = Memory::default();
    let mut integrals = [0.0; MAX_DRIVERS];
    let changed = (0..target.len()).map(|k| {
        let dt = if k == 0 { 0.0 } else { drive.time(k) - drive.time(k - 1) };
        let mut drivers = [0.0; MAX_DRIVERS];
        for (i, (signal, values)) in attachment.drivers.iter().zip(&signals).enumerate().take(MAX_DRIVERS) {
            let (now, last) = (values[k], values[k.saturating_sub(1)]);
            drivers[i] = match signal.source {
                Source::Value => now,
                Source::Rate if k > 0 => (now - last) / dt,
                Source::Rate => 0.0,
                Source::Integral => {
                    integrals[i] += 0.5 * dt * (now + last);
                    integrals[i]
                }
            };
        }
        let used = &drivers[..signals.len().min(MAX_DRIVERS)];
        let call = Call { time: drive.time(k), dt, target: target[k], drivers: used };
        (attachment.effect.apply)(&parameters, &mut memory, &call)
    });
    debug_assert!(interface.variables[attachment.target].causality != Causality::Input);
    Some(changed.collect())
}

/// Orthonormal columns with the same span.
fn orthonormal(rows: usize, columns: &[DVector<f64>]) -> DMatrix<f64> {
    let mut basis: Vec<DVector<f64>> = Vec::new();
    for column in columns {
        let size = column.norm();
        let mut rest = column.clone();
        // twice is enough
        for _ in 0..2 {
            for b in &basis {
                rest -= b * b.dot(&rest);
            }
        }
        if rest.norm() > 1e-8 * size && size > 0.0 {
            let norm = rest.norm();
            basis.push(rest / norm);
        }
    }
    if basis.is_empty() { DMatrix::zeros(rows, 0) } else { DMatrix::from_columns(&basis) }
}

/// What columns explain of a residual: squared error taken away, and the amounts. Columns that the
/// parameters explain all but fully explain nothing by themselves.
fn explain(clean: &[DVector<f64>], own: &[DVector<f64>], residual: &DVector<f64>) -> Option<(f64, Vec<f64>)> {
    let n = clean.len();
    let kept: Vec<usize> =
        (0..n).filter(|i| clean[*i].norm() > 1e-3 * own[*i].norm() && own[*i].norm() > 0.0).collect();
    if kept.is_empty() {
        return None;
    }
    let matrix = DMatrix::from_fn(kept.len(), kept.len(), |i, j| {
        let v = clean[kept[i]].dot(&clean[kept[j]]);
        if i == j { v * (1.0 + 1e-9) } else { v }
    });
    let right = DVector::from_fn(kept.len(), |i, _| clean[kept[i]].dot(residual));
    let amounts = matrix.cholesky()?.solve(&right);
    let gain = amounts.dot(&right);
    let mut all = vec![0.0; n];
    for (i, amount) in kept.iter().zip(amounts.iter()) {
        all[*i] = *amount;
    }
    gain.is_finite().then_some((gain, all))
}
