//! How readings scatter, and how sure that leaves what is read from them.

use super::estimate::Point;
use super::evidence::Read;
use super::search::{Asked, MISSED, Search};
use crate::identify::readings::Readings;
use crate::identify::registry::Numbers;
use crate::stats::chance::student_beyond;
use crate::stats::mean;
use crate::{Error, Result};
use nalgebra::{DMatrix, DVector};
use std::collections::{BTreeMap, BTreeSet};

/// Intervals hold the true value with this probability, where the model is right and what scatters does so normally.
const PROBABILITY: f64 = 0.9;

/// How readings scatter.
pub(super) struct Scatter {
    /// Standard deviation of each output: of means over stretches, and of the shorter ones over ramps.
    sizes: [Vec<f64>; 2],
    /// What of it is new from one reading to the next; the rest drifts while a recording lasts.
    own: [Vec<f64>; 2],
    /// From so many readings more than there are unknowns.
    freedom: [f64; 2],
}

impl Scatter {
    /// Standard deviation of each output, of readings of ramps or of stretches.
    pub fn sizes(&self, of_ramps: bool) -> &[f64] {
        &self.sizes[usize::from(of_ramps)]
    }

    /// What a reading has of its own, and what drifts through a recording, of each output.
    fn parts(&self, of_ramps: bool) -> impl Iterator<Item = (f64, f64)> {
        let kind = usize::from(of_ramps);
        let rest = |(size, own): (&f64, &f64)| (*own, (size * size - own * own).max(0.0).sqrt());
        self.sizes[kind].iter().zip(&self.own[kind]).map(rest)
    }

    /// From so many readings more than there are unknowns.
    pub fn freedom(&self) -> f64 {
        self.freedom.iter().sum()
    }

    /// By how much an interval has to be wider for what is known from readings of one kind only.
    fn unsure(&self, of_ramps: bool) -> f64 {
        let own = self.freedom[usize::from(of_ramps)];
        if own > 0.0 { side(own) / side(self.freedom()) } else { 1.0 }
    }
}

/// Student's t for half an interval.
pub(super) fn side(freedom: f64) -> f64 {
    student_beyond(1.0 - PROBABILITY, freedom)
}

/// An error that several readings have in common.
struct Shared {
    /// The readings, and its standard deviation in each.
    sizes: BTreeMap<usize, f64>,
    /// The output, or after all outputs the input.
    channel: usize,
}

impl Search<'_> {
    /// What is left of readings of one kind beside what their estimates read of them.
    pub fn scatter(
        &self,
        model: &Readings<'_>,
        reads: &[Read],
        numbers: &Numbers,
        asked: &mut Asked,
    ) -> Result<Scatter> {
        let count = self.evidence.signals.outputs.len();
        let (mut squares, mut freedom) = ([vec![0.0; count], vec![0.0; count]], [0.0; 2]);
        let (mut changes, mut pairs) = (squares.clone(), [0.0; 2]);
        let mut seen = BTreeSet::new();
        for read in reads {
            if !seen.insert(read.members.clone()) {
                continue;
            }
            let measured = self.evidence.points(read);
            let simulated = self.simulated_once(model, read, numbers, asked)?;
            let design = read.estimate.design(&measured);
            let unknowns = design.ncols();
            let kind = usize::from(read.is_ramp(self.evidence));
            let svd = design.clone().svd(true, true);
            let next = read.members.windows(2).enumerate();
            let next: Vec<usize> = next
                .filter(|(_, pair)| {
                    let [a, b] = [0, 1].map(|k| self.evidence.readings[pair[k]].recording);
                    a == b
                })
                .map(|(k, _)| k)
                .collect();
            let unbiased = measured.len() as f64 / (measured.len() - unknowns).max(1) as f64;
            for output in 0..count {
                let rest = DVector::from_fn(measured.len(), |k, _| {
                    measured[k].outputs[output] - simulated[k].outputs[output]
                });
                let found = svd.solve(&rest, 1e-10).map_err(|e| Error::numeric(e.to_owned()))?;
                let rest = &rest - &design * found;
                squares[kind][output] += rest.norm_squared();
                // half the mean square of the change from one to the next is the variance of what is new in each (von Neumann)
                let change: f64 = next.iter().map(|k| 0.5 * (rest[k + 1] - rest[*k]).powi(2)).sum();
                changes[kind][output] += unbiased * change;
            }
            freedom[kind] += (measured.len() - unknowns) as f64;
            pairs[kind] += next.len() as f64;
        }
        let size = |square: &f64, count: f64| (square / count.max(1.0)).sqrt().max(f64::MIN_POSITIVE);
        let sizes: [Vec<f64>; 2] =
            [0, 1].map(|kind| squares[kind].iter().map(|square| size(square, freedom[kind])).collect());
        let own = [0, 1].map(|kind| {
            let new = |(change, whole): (&f64, &f64)| {
                if pairs[kind] > 0.0 { size(change, pairs[kind]).min(*whole) } else { *whole }
            };
            changes[kind].iter().zip(&sizes[kind]).map(new).collect()
        });
        Ok(Scatter { sizes, own, freedom })
    }

    /// The errors that readings have: each its own, those of a recording the drift of the zeros in common and a straight drift from
    /// its first to its last, and all the error of the zeros.
    fn errors(&self, reads: &[Read], scatter: &Scatter) -> Vec<Shared> {
        let used: BTreeSet<usize> = reads.iter().flat_map(|read| read.members.iter().copied()).collect();
        let mut all = Vec::new();
        for number in &used {
            let reading = &self.evidence.readings[*number];
            let of_ramps = reading.moved.is_some();
            let outputs = scatter.parts(of_ramps).map(|(own, _)| scatter.unsure(of_ramps) * own);
            for (channel, size) in outputs.chain(reading.errors.iter().copied()).enumerate() {
                all.push(Shared { sizes: BTreeMap::from([(*number, size)]), channel });
            }
        }
        let zeros = &self.evidence.zeros;
        let recordings: BTreeSet<usize> = used.iter().map(|k| self.evidence.readings[*k].recording).collect();
        // few recordings tell less well how zeros drift than many readings how they scatter
        let freedom = (zeros.recordings.max(2) - 1) as f64;
        let unsure = side(freedom) / side(scatter.freedom());
        let middle = |k: usize| mean(&self.evidence.readings[k].time);
        let drifting = [false, true].map(|of_ramps| scatter.parts(of_ramps).map(|(_, rest)| rest).collect());
        let drifting: [Vec<f64>; 2] = drifting;
        for (channel, drift) in zeros.drift.iter().enumerate() {
            for recording in &recordings {
                let of = |k: &usize| self.evidence.readings[*k].recording == *recording;
                let own: Vec<usize> = used.iter().copied().filter(of).collect();
                all.push(Shared { sizes: own.iter().map(|k| (*k, unsure * drift)).collect(), channel });
                let times = own.iter().map(|k| middle(*k));
                let [first, last] = [times.clone().fold(f64::INFINITY, f64::min), times.fold(0.0, f64::max)];
                let straight = |k: &usize| {
                    let of_ramps = self.evidence.readings[*k].moved.is_some();
                    let place =
                        if last > first { 2.0 * (middle(*k) - first) / (last - first) - 1.0 } else { 0.0 };
                    // a straight line has this standard deviation over its time
                    let at_ends = 3f64.sqrt() * drifting[usize::from(of_ramps)][channel];
                    (*k, scatter.unsure(of_ramps) * at_ends * place)
                };
                all.push(Shared { sizes: own.iter().map(straight).collect(), channel });
            }
            let size = unsure * drift / (zeros.recordings as f64).sqrt();
            all.push(Shared { sizes: used.iter().map(|k| (*k, size)).collect(), channel });
        }
        all
    }

    /// Covariance of what is measured less what the model says at the inputs that were measured.
    pub fn covariance(
        &self,
        model: &Readings<'_>,
        reads: &[Read],
        numbers: &Numbers,
        scatter: &Scatter,
        asked: &mut Asked,
    ) -> Result<DMatrix<f64>> {
        let signals = &self.evidence.signals;
        // an input that an output measures is as wrong as that
        let measured_by = signals.measured_by(model.plan());
        let outputs = signals.outputs.len();
        let mut before = Vec::new();
        for read in reads {
            let own = self.evidence.points(read);
            let simulated = self.simulated_once(model, read, numbers, asked)?;
            let base = read.estimate.of(&own) - read.estimate.of(&simulated);
            before.push((own, simulated, base));
        }
        let mut covariance = DMatrix::zeros(reads.len(), reads.len());
        for (row, (read, (own, ..))) in reads.iter().zip(&before).enumerate() {
            covariance[(row, row)] = (MISSED * read.factor * read.estimate.of(own)).powi(2);
        }
        for error in self.errors(reads, scatter) {
            let input = error.channel.checked_sub(outputs);
            if error.sizes.values().all(|size| *size == 0.0)
                || input.is_some_and(|k| measured_by[k].is_some())
            {
                continue;
            }
            let moves = |k: usize| input == Some(k) || measured_by[k] == Some(error.channel);
            let mut change = DVector::zeros(reads.len());
            let mut moved_once = Asked::new();
            for (row, (read, (own, simulated, base))) in reads.iter().zip(&before).enumerate() {
                let condition = &model.plan().conditions[read.condition];
                let (mut own, mut simulated) = (own.clone(), simulated.clone());
                let mut any = false;
                for (place, number) in read.members.iter().enumerate() {
                    let Some(size) = error.sizes.get(number) else { continue };
                    any = true;
                    let mut moved = self.evidence.readings[*number].clone();
                    if input.is_none() {
                        moved.point.outputs[error.channel] += size;
                    }
                    let moving: Vec<usize> = (0..measured_by.len()).filter(|k| moves(*k)).collect();
                    moving.iter().for_each(|k| moved.point.inputs[*k] += size);
                    if !moving.is_empty() {
                        let key = (read.condition, *number);
                        let outputs = match moved_once.remove(&key) {
                            Some(outputs) => outputs,
                            None => model.respond(condition, &moved, signals, &self.offsets, numbers)?,
                        };
                        moved_once.insert(key, outputs.clone());
                        simulated[place] = Point { inputs: moved.point.inputs.clone(), outputs };
                    }
                    own[place] = moved.point;
                }
                if any {
                    change[row] =
                        read.factor * (read.estimate.of(&own) - read.estimate.of(&simulated) - base);
                }
            }
            covariance += &change * change.transpose();
        }
        Ok(covariance)
    }
}
