//! Which signal tells best where the residual is large, or which value it has.

use super::signals::{Signal, bin, bins, blocks, channels, inputs, memory, name, outputs, residual};
use crate::diagnose::roles::Roles;
use crate::effect::Role;
use crate::fit::{Run, Traces};
use crate::model::Interface;

/// Ranges of a signal; of each of two together.
const RANGES: usize = 8;
const RANGES_OF_TWO: usize = 4;
/// Blocks are so many times longer than the residual's memory.
const BLOCK: f64 = 4.0;
/// A gain counts from so many standard errors on.
const SURE: f64 = 2.5;
/// Two signals tell more than one from this ratio on.
const MORE: f64 = 1.3;
/// Signals that tell about as much as the best.
const ALIKE: f64 = 0.9;
/// What stands for the time since the start.
pub const TIME: &str = "time";

/// The names of the one or two signals that tell best how large the residual is or which value it has:
/// inputs and measured channels (as simulated), `rate of` them, `time` since the start, `slid energy`.
///
/// Mean and mean size of every channel's residual in ranges of a signal are taken from every other block
/// of the runs and judged by the logarithmic likelihood (Laplace's distribution) of the blocks between.
/// `["time"]` if no signal tells anything that is sure; empty without residuals.
pub fn depends_on(runs: &[&Run], simulated: &[Traces], interface: &Interface, roles: &Roles) -> Vec<String> {
    let residuals: Vec<Rest> =
        (0..channels(runs)).filter_map(|c| Rest::of(&residual(runs, simulated, c))).collect();
    if residuals.is_empty() {
        return Vec::new();
    }
    let candidates = candidates(runs, simulated, interface, roles);
    let cells = |signal: &[f64], count: usize| -> (Vec<Option<usize>>, usize) {
        let edges = bins(signal, count);
        (signal.iter().map(|v| bin(&edges, *v)).collect(), edges.len().saturating_sub(1))
    };
    let mut scores: Vec<(f64, usize)> = Vec::new();
    for (i, (_, signal)) in candidates.iter().enumerate() {
        let (cells, count) = cells(signal, RANGES);
        let (gain, sure) = gain(&residuals, &cells, count);
        if sure {
            scores.push((gain, i));
        }
    }
    scores.sort_by(|a, b| b.0.total_cmp(&a.0));
    let Some(&(best, first)) = scores.first() else { return vec![TIME.into()] };
    let mut names = vec![candidates[first].0.clone()];
    let pair = |second: usize| {
        let (a, n) = cells(&candidates[first].1, RANGES_OF_TWO);
        let (b, m) = cells(&candidates[second].1, RANGES_OF_TWO);
        let both = a.iter().zip(b).map(|(a, b)| Some(a.as_ref()? * m + b?)).collect::<Vec<_>>();
        gain(&residuals, &both, n * m)
    };
    let second = (0..candidates.len())
        .filter(|i| *i != first)
        .map(|i| (pair(i), i))
        .filter(|((gain, sure), _)| *sure && *gain > MORE * best)
        .max_by(|a, b| a.0.0.total_cmp(&b.0.0))
        .map(|(_, i)| i)
        .or_else(|| scores.get(1).filter(|(gain, _)| *gain > ALIKE * best).map(|(_, i)| *i));
    names.extend(second.map(|i| candidates[i].0.clone()));
    names
}

/// The residual of a channel in all runs on end.
struct Rest {
    values: Vec<f64>,
    block: Vec<usize>,
    blocks: usize,
    /// Samples of a block.
    length: f64,
}

impl Rest {
    fn of(runs: &[Vec<f64>]) -> Option<Self> {
        let length = BLOCK * memory(runs);
        let (mut block, mut end) = (Vec::new(), 0);
        for run in runs {
            let (own, next) = blocks(run.len(), length, end);
            block.extend(own);
            end = next;
        }
        let values: Vec<f64> = runs.concat();
        let some = values.iter().any(|v| v.is_finite() && *v != 0.0);
        (some && runs.iter().all(|r| !r.is_empty())).then_some(Self { values, block, blocks: end, length })
    }

    /// Logarithmic likelihood of each block, in independent samples, beyond that without the signal.
    fn gains(&self, cells: &[Option<usize>], count: usize) -> Vec<f64> {
        let mut gains = vec![0.0; self.blocks];
        for fold in 0..2 {
            let fitted = |b: usize| b % 2 == fold;
            let samples = || {
                let each = self.values.iter().zip(&self.block).zip(cells);
                each.map(|((e, b), c)| (*e, *b, *c)).filter(|(e, ..)| e.is_finite())
            };
            let mean = average(samples().filter(|s| fitted(s.1)).map(|s| s.0));
            let size = average(samples().filter(|s| fitted(s.1)).map(|s| (s.0 - mean).abs()));
            if mean.is_nan() || size.is_nan() || size <= 0.0 {
                continue;
            }
            // a range begins with a block's worth of what is so everywhere
            let mut means = vec![(self.length * mean, self.length); count];
            for (e, b, cell) in samples() {
                if let Some(c) = cell.filter(|_| fitted(b)) {
                    means[c].0 += e;
                    means[c].1 += 1.0;
                }
            }
            let means: Vec<f64> = means.iter().map(|(sum, n)| sum / n).collect();
            let mut sizes = vec![(self.length * size, self.length); count];
            for (e, b, cell) in samples() {
                if let Some(c) = cell.filter(|_| fitted(b)) {
                    sizes[c].0 += (e - means[c]).abs();
                    sizes[c].1 += 1.0;
                }
            }
            let sizes: Vec<f64> = sizes.iter().map(|(sum, n)| (sum / n).max(1e-6 * size)).collect();
            let likelihood = |e: f64, mean: f64, size: f64| -size.ln() - (e - mean).abs() / size;
            for (e, b, cell) in samples().filter(|s| !fitted(s.1)) {
                if let Some(c) = cell {
                    let more = likelihood(e, means[c], sizes[c]) - likelihood(e, mean, size);
                    gains[b] += more * BLOCK / self.length;
                }
            }
        }
        gains
    }
}

fn average(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0.0), |(sum, n), v| (sum + v, n + 1.0));
    sum / n
}

/// Gain of all channels, and whether it is sure in one of them.
fn gain(residuals: &[Rest], cells: &[Option<usize>], count: usize) -> (f64, bool) {
    let (mut total, mut sure) = (0.0, false);
    if count < 2 {
        return (total, sure);
    }
    for rest in residuals.iter().filter(|r| r.values.len() == cells.len()) {
        let gains = rest.gains(cells, count);
        let sum: f64 = gains.iter().sum();
        let n = gains.len() as f64;
        let spread = gains.iter().map(|g| (g - sum / n).powi(2)).sum::<f64>();
        sure |= n >= 4.0 && sum > SURE * spread.sqrt();
        total += sum;
    }
    (total, sure)
}

/// Names and values in all runs on end.
pub(super) fn candidates(
    runs: &[&Run],
    simulated: &[Traces],
    interface: &Interface,
    roles: &Roles,
) -> Vec<(String, Vec<f64>)> {
    // runs that lack a signal have a hole there
    let joined = |of: &dyn Fn(usize) -> Vec<f64>| -> Vec<f64> {
        let filled = |(r, run): (usize, &&Run)| {
            let values = of(r);
            if values.len() == run.time.len() { values } else { vec![f64::NAN; run.time.len()] }
        };
        runs.iter().enumerate().flat_map(filled).collect()
    };
    let signals: Vec<Signal> = inputs(runs).into_iter().chain(outputs(runs, simulated)).collect();
    let mut all = Vec::new();
    for signal in &signals {
        all.push((name(interface, signal.variable), joined(&|r| signal.values[r].clone())));
    }
    for signal in &signals {
        let rate = |r: usize| rate(&runs[r].time, &signal.values[r]);
        all.push((format!("rate of {}", name(interface, signal.variable)), joined(&rate)));
    }
    let since = |r: usize| runs[r].time.iter().map(|t| t - runs[r].drive.start).collect::<Vec<f64>>();
    all.push((TIME.to_owned(), joined(&since)));
    // of a run that was cut in two, only since then
    let slid = |r: usize| {
        let power = sliding_power(&signals, roles, r);
        let mut energy = 0.0;
        let steps = runs[r].time.windows(2).zip(power.windows(2));
        let rest = steps.map(|(t, p)| {
            energy += (t[1] - t[0]) * 0.5 * (p[0] + p[1]);
            energy
        });
        if power.is_empty() { Vec::new() } else { std::iter::once(0.0).chain(rest).collect() }
    };
    all.push(("slid energy".to_owned(), joined(&slid)));
    all
}

/// Power of friction in a run: as it is given, else forces times the speed that their slip makes; empty if
/// the signals do not have it.
fn sliding_power(signals: &[Signal], roles: &Roles, run: usize) -> Vec<f64> {
    let with = |role: Role| {
        signals
            .iter()
            .find(|s| roles.is(s.variable, role) && !s.values[run].is_empty())
            .map(|s| &s.values[run])
    };
    if let Some(power) = with(Role::FrictionPower) {
        return power.iter().map(|p| p.abs()).collect();
    }
    let Some(speed) = with(Role::TravelSpeed) else { return Vec::new() };
    let part = |force: Role, slip: Role, ratio: fn(f64) -> f64| -> Option<Vec<f64>> {
        let (force, slip) = (with(force)?, with(slip)?);
        let power = force.iter().zip(slip).zip(speed).map(|((f, s), v)| (f * ratio(*s) * v).abs());
        Some(power.collect())
    };
    let along = part(Role::LongitudinalForce, Role::Slip, |s| s);
    let across = part(Role::LateralForce, Role::SlipAngle, f64::tan);
    match (along, across) {
        (Some(a), Some(b)) => a.iter().zip(&b).map(|(a, b)| a + b).collect(),
        (a, b) => a.or(b).unwrap_or_default(),
    }
}

/// Slope between the neighbours.
fn rate(time: &[f64], values: &[f64]) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    let of = |i: usize| {
        let (a, b) = (i.saturating_sub(1), (i + 1).min(last));
        if b > a { (values[b] - values[a]) / (time[b] - time[a]) } else { f64::NAN }
    };
    if values.len() == time.len() { (0..values.len()).map(of).collect() } else { Vec::new() }
}

/// Slope per sample between the neighbours.
pub(super) fn rate_by_sample(values: &[f64]) -> Vec<f64> {
    let samples: Vec<f64> = (0..values.len()).map(|k| k as f64).collect();
    rate(&samples, values)
}

#[cfg(test)]
mod tests {
    use super::super::bed::{interface, run};
    use super::*;
    use crate::stats::SplitMix64;
    use crate::stats::testing::coloured;

    const INPUTS: [(&str, &str); 3] = [("load", "N"), ("slip_angle", "rad"), ("speed", "m/s")];
    const OUTPUTS: [(&str, &str); 2] = [("force_y", "N"), ("moment", "N.m")];

    struct Now {
        load: f64,
        speed: f64,
        rate: f64,
        slid: f64,
        noise: f64,
    }

    fn ask(seed: u64, wrong: impl Fn(Now) -> f64) -> Vec<String> {
        let mut random = SplitMix64::new(seed);
        let n = 3000;
        let mut runs = Vec::new();
        let mut simulated = Vec::new();
        for _ in 0..4 {
            let [load, angle, speed] = [0, 1, 2].map(|_| coloured(&mut random, 0.98, n));
            let load: Vec<f64> = load.iter().map(|v| 3000.0 + 600.0 * v).collect();
            let angle: Vec<f64> = angle.iter().map(|v| 0.05 * v).collect();
            let speed: Vec<f64> = speed.iter().map(|v| 20.0 + 3.0 * v).collect();
            let force: Vec<f64> = load.iter().zip(&angle).map(|(f, a)| 10.0 * f * a).collect();
            let moment = coloured(&mut random, 0.9, n);
            let (mut slid, mut measured) = (0.0, Vec::new());
            for i in 0..n {
                slid += 0.01 * (force[i] * angle[i].tan() * speed[i]).abs();
                let rate = if i > 0 { (angle[i] - angle[i - 1]) / 0.01 } else { 0.0 };
                let now = Now { load: load[i], speed: speed[i], rate, slid, noise: random.normal() };
                measured.push(force[i] + 20.0 * random.normal() + wrong(now));
            }
            let other = moment.iter().map(|m| m + 0.1 * random.normal()).collect();
            runs.push(run("a", 0.01, &[load, angle, speed], &[measured, other]));
            simulated.push(vec![force, moment]);
        }
        let interface = interface(&INPUTS, &OUTPUTS);
        let roles = Roles::of(&interface, &[]).unwrap();
        depends_on(&runs.iter().collect::<Vec<_>>(), &simulated, &interface, &roles)
    }

    #[test]
    fn the_signal_that_matters_is_named() {
        for seed in 0..5 {
            assert_eq!(ask(seed, |now| 0.02 * (now.load - 3000.0)), ["load"]);
            // only the size of the residual tells
            assert_eq!(ask(seed, |now| 8.0 * (now.speed - 14.0).max(0.0) * now.noise), ["speed"]);
            // the force follows the angle, and its rate tells nearly as much
            assert_eq!(ask(seed, |now| 20.0 * now.rate.signum())[0], "rate of slip_angle");
        }
    }

    #[test]
    fn a_product_has_two_names() {
        let mut names = ask(3, |now| 0.02 * (now.load - 3000.0) * (now.speed - 20.0));
        names.sort();
        assert_eq!(names, ["load", "speed"]);
    }

    #[test]
    fn what_builds_up_is_history() {
        let names = ask(5, |now| -0.005 * now.slid);
        assert!(names.iter().all(|n| n == "slid energy" || n == "time"), "{names:?}");
        // noise tells nothing
        assert_eq!(ask(6, |_| 0.0), ["time"]);
        let interface = interface(&INPUTS, &OUTPUTS);
        assert!(depends_on(&[], &[], &interface, &Roles::default()).is_empty());
    }
}
