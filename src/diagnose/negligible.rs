//! Errors that say nothing, whatever their course: below a thousandth of what a channel moves, below what numbers tell, and below what
//! nobody knows of inputs. Without noise the rounding of files and solvers, and the way of inputs between samples, is all that is left, and it
//! has causes and courses as physics has.

use super::numbers::{LITTLE, RESOLUTION};
use super::rest::Rest;
use super::steps::simulated;
use super::study::Study;
use crate::fit::{Bench, Run, Traces};
use crate::stats::{SplitMix64, about_line, root_mean_square};
use std::cell::RefCell;

/// By how much inputs are changed at most to see what rounding makes: some units in the last places, so many that each change is another.
const LAST_DIGITS: f64 = 64.0 * f64::EPSILON;
/// How many times as much it may be at most: steps, of which others are taken later, are up to 16 times as many.
const AT_MOST: f64 = 16.0;
/// How many times what two ways between samples differ the way that inputs took may differ from either.
const WAYS: f64 = 2.0;

/// An error of a channel that is too small to say anything: a thousandth of what it moves about a straight line, since an
/// angle that grows and grows is not more imprecise for that, or its resolution.
pub(super) fn negligible(runs: &[&Run], channel: usize) -> f64 {
    (LITTLE * per_sample(runs, channel, about_line)).max(resolution(runs, channel))
}

/// An error of a channel that its numbers do not tell, or that rounding makes, or the way of inputs between samples, root mean square.
pub(super) fn resolution(runs: &[&Run], channel: usize) -> f64 {
    let channels = runs.iter().filter_map(|r| r.channels.get(channel));
    root_mean_square(channels.flat_map(|c| c.unresolved.iter().copied()))
}

/// What is not resolved of each sample of each channel of each run: what their numbers do not tell, and what two things change of it. What
/// rounding makes is measured, with inputs that are changed by their last digits: a channel's size does not tell it, as of a force that is
/// the difference of two others and ought to be 0. And nobody knows how inputs ran between their samples: `smooth` and `straight` are the
/// runs with both ways. What they change is told where it is: after a step of an input, and not where nothing moves.
pub(super) fn unresolved(
    bench: &Bench,
    runs: &[&Run],
    (smooth, straight): (&[&Run], &[&Run]),
) -> Vec<Traces> {
    let variables = &bench.interface().variables;
    let random = RefCell::new(SplitMix64::new(0));
    let moved = |run: &&Run| {
        run.with_inputs(|variable, _, v| {
            let by = LAST_DIGITS * (2.0 * random.borrow_mut().uniform() - 1.0);
            if variables[variable].is_real() { v * (1.0 + by) } else { v }
        })
    };
    let moved: Vec<Run> = runs.iter().map(moved).collect();
    let rounding = changes(bench, runs, &moved.iter().collect::<Vec<_>>());
    let between = changes(bench, smooth, straight);
    let told = |c: usize| RESOLUTION * per_sample(runs, c, |values| values.iter().map(|v| v * v).sum());
    let made = |c: usize| root_mean_square(rounding.iter().filter_map(|run| run.get(c)).flatten().copied());
    let mut unresolved = between;
    for channels in &mut unresolved {
        for (c, samples) in channels.iter_mut().enumerate() {
            let least = told(c).max(AT_MOST * made(c));
            samples.iter_mut().for_each(|between| *between = least.max(WAYS * *between));
        }
    }
    unresolved
}

/// How much each sample differs between runs and others that are driven otherwise. All zeros if the model cannot be run, which is told by
/// what comes next.
fn changes(bench: &Bench, runs: &[&Run], others: &[&Run]) -> Vec<Traces> {
    let all = [runs, others].concat();
    let traces = simulated(bench, &all, None).unwrap_or_default();
    let change = |run: usize, channel: usize, sample: usize| -> Option<f64> {
        let of = |run: usize| traces.get(run)?.get(channel)?.get(sample).copied();
        Some((of(run)? - of(runs.len() + run)?).abs()).filter(|change| change.is_finite())
    };
    let of_channel = |run: usize, channel: usize| {
        (0..runs[run].channels[channel].values.len())
            .map(|k| change(run, channel, k).unwrap_or(0.0))
            .collect()
    };
    (0..runs.len()).map(|i| (0..runs[i].channels.len()).map(|c| of_channel(i, c)).collect()).collect()
}

/// Root mean square over all runs of what a square sums up.
fn per_sample(runs: &[&Run], channel: usize, square: impl Fn(&[f64]) -> f64) -> f64 {
    let channels = || runs.iter().filter_map(|r| r.channels.get(channel));
    let sum: f64 = channels().map(|c| square(&c.values)).sum();
    let n: usize = channels().map(|c| c.values.len()).sum();
    (sum / n.max(1) as f64).sqrt()
}

impl Study<'_> {
    /// Whether what a model leaves of runs says something of a channel.
    pub(super) fn says_something(&self, runs: &[&Run], rest: &Rest, channel: usize) -> bool {
        error(runs, &rest.simulated, channel) > negligible(runs, channel)
    }

    /// Whether it does of any.
    pub(super) fn says_anything(&self, runs: &[&Run], rest: &Rest) -> bool {
        (0..self.weights.len()).any(|c| self.says_something(runs, rest, c))
    }

    /// Whether a model leaves less of a channel than another one, by more than what says nothing.
    pub(super) fn is_better(&self, runs: &[&Run], (before, after): (&Rest, &Rest)) -> bool {
        let square = |rest: &Rest, c: usize| error(runs, &rest.simulated, c).powi(2);
        let is_better = |c: usize| square(before, c) - square(after, c) > negligible(runs, c).powi(2);
        (0..self.weights.len()).any(is_better)
    }

    /// Simulated channels of runs: those of which nothing is said as they were measured, so that nothing is seen in them.
    pub(super) fn telling(&self, runs: &[&Run], rest: &Rest) -> Vec<Traces> {
        let silent: Vec<usize> =
            (0..self.weights.len()).filter(|c| !self.says_something(runs, rest, *c)).collect();
        let mut simulated = rest.simulated.clone();
        for (run, traces) in runs.iter().zip(&mut simulated) {
            for c in &silent {
                if let Some((channel, trace)) = run.channels.get(*c).zip(traces.get_mut(*c)) {
                    trace.clone_from(&channel.values);
                }
            }
        }
        simulated
    }
}

/// Root mean square of measured less simulated.
pub(super) fn error(runs: &[&Run], simulated: &[Traces], channel: usize) -> f64 {
    let (mut square, mut n) = (0.0, 0.0);
    for (run, traces) in runs.iter().zip(simulated) {
        let Some((channel, trace)) = run.channels.get(channel).zip(traces.get(channel)) else { continue };
        square += channel.values.iter().zip(trace).map(|(m, s)| (m - s).powi(2)).sum::<f64>();
        n += trace.len() as f64;
    }
    (square / f64::max(n, 1.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::subject::Subject;
    use crate::fit::{Channel, Drive};
    use crate::model::Settings;
    use std::sync::Arc;

    #[test]
    fn what_ought_to_be_zero_has_the_resolution_of_what_it_is_made_of() {
        let subject = Subject::load("magic-formula-flat-track", &Settings::default()).unwrap();
        let bench = Bench::new(&subject.factory, &subject.fixed, 2).unwrap();
        let find = |name: &str| subject.interface.index(name).unwrap();
        let points = 201;
        let constant = |(name, value): (&str, f64)| (find(name), vec![value; points]);
        let mut inputs: Vec<_> =
            [("deflection", 0.02), ("path_speed", 15.0), ("slip_angle", 0.01)].map(constant).into();
        inputs.sort_by_key(|i| i.0);
        let drive = Arc::new(Drive::new(0.0, 1e-3, points, inputs));
        let watch: Arc<[usize]> = ["force_x", "force_z"].map(find).into();
        let traces = bench.run(&[Arc::default()], &[Arc::clone(&drive)], &watch).pop().unwrap().unwrap();
        let channels = watch.iter().zip(traces);
        let channel = |(variable, values): (&usize, Vec<f64>)| Channel {
            variable: *variable,
            values,
            counts: false,
            unresolved: Vec::new(),
        };
        let time = (0..points).map(|k| drive.time(k)).collect();
        let run = Run { name: String::new(), drive, time, channels: channels.map(channel).collect() };
        let load = run.channels[1].values[points - 1];
        let unresolved = unresolved(&bench, &[&run], (&[&run], &[&run]));
        let [along, up] = &unresolved[0][..] else { panic!() };
        let [along, up] = [along, up].map(|samples| root_mean_square(samples.iter().copied()));
        // no slip, so no longitudinal force: it is some last digits of forces of thousands of newtons
        assert!(run.channels[0].values.iter().all(|f| f.abs() < 1e-9) && load > 4000.0);
        assert!(along > f64::EPSILON * load && along < 1e-9, "{along}");
        assert!((up / load / 2.0_f64.powi(-23) - 1.0).abs() < 1e-6, "{up}");
    }
}
