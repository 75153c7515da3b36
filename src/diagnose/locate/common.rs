//! An omnibus test that something is missing, whether or not anything explains it: sensors make their
//! noise independently, so what the residuals of two channels share comes from the machine.

use super::signals::{channels, even, interval, outputs, residual};
use crate::diagnose::numbers::{MUCH, SHARED_LEVEL};
use crate::fit::{Run, Traces};
use crate::stats::chance::coherent;
use crate::stats::welch::{Lines, count, independent};

/// Segments, the longest that leave enough of them.
const LENGTHS: [usize; 3] = [512, 256, 128];
/// Independent segments that are enough to take the longer ones; and those without which nothing is said.
const ENOUGH: [f64; 3] = [40.0, 20.0, 8.0];
/// Share of the residual of each of both channels that must be in the band that they share.
const MIN_POWER: f64 = 0.1;
/// A lag of all channels up to this share of a sampling interval is the recorder's.
const RECORDER_LAG: f64 = 0.5;
/// A coherent part that goes with the slope of the signals to this share is an error of time.
const OF_TIME: f64 = 0.7;

/// A common cause of the residuals of several channels.
#[derive(Debug, Clone, PartialEq)]
pub struct Common {
    /// Probability that chance makes channels so coherent, corrected for the number of lines and pairs.
    pub p: f64,
    /// Share of the residual's square of the most coherent pair that is coherent, 0 to 1.
    pub share: f64,
    /// Indices of the variables that have it, the most coherent pair first.
    pub channels: Vec<usize>,
    /// Where that pair is coherent \[Hz\].
    pub band: (f64, f64),
}

/// Looks for a common cause of the residuals of several measured channels: coherence of the residuals of
/// two by Welch's method, over all runs. `None` if there is none, if there is one channel only, or if the
/// runs are too short.
///
/// What only looks like one is left out: a small share of the residual, and errors of the time stamps,
/// which go with the slopes of the signals. Noise of a *recorded input* drives the simulation and is a
/// common cause too.
pub fn common_cause(runs: &[&Run], simulated: &[Traces]) -> Option<Common> {
    let step = interval(runs)?;
    let all = channels(runs);
    let residuals: Vec<Vec<Vec<f64>>> = (0..all).map(|c| residual(runs, simulated, c)).collect();
    let signals = outputs(runs, simulated);
    let evened = |values: &[Vec<f64>]| -> Vec<Vec<f64>> {
        runs.iter().zip(values).map(|(run, v)| even(&run.time, v, step)).collect()
    };
    let mut residuals: Vec<Vec<Vec<f64>>> = residuals.iter().map(|v| evened(v)).collect();
    let slopes: Vec<Vec<Vec<f64>>> =
        signals.iter().map(|s| evened(&s.values).iter().map(|v| slope(v)).collect()).collect();
    let whole: Vec<usize> = (0..runs.len())
        .filter(|r| {
            let n = residuals.first().map_or(0, |v| v[*r].len());
            n > 0 && residuals.iter().chain(&slopes).all(|v| v[*r].len() == n)
        })
        .collect();
    for values in &mut residuals {
        *values = whole.iter().map(|r| std::mem::take(&mut values[*r])).collect();
    }
    let slopes: Vec<Vec<Vec<f64>>> =
        slopes.into_iter().map(|mut v| whole.iter().map(|r| std::mem::take(&mut v[*r])).collect()).collect();
    remove_lag(&mut residuals, &slopes);

    let samples: Vec<usize> = residuals.first()?.iter().map(Vec::len).collect();
    let length = LENGTHS
        .into_iter()
        .zip(ENOUGH)
        .find(|(length, enough)| independent(count(&samples, *length)) >= *enough)?
        .0;
    let lines: Vec<Lines> = residuals
        .iter()
        .map(|values| Lines::of(values.iter().map(|v| &v[..]), length))
        .collect::<Option<_>>()?;
    let spacing = 1.0 / (length as f64 * step);
    let pairs: Vec<(usize, usize)> = (0..all).flat_map(|a| (a + 1..all).map(move |b| (a, b))).collect();
    // neither the mean nor the highest line
    let last = length / 2 - 1;
    let looks = (pairs.len() * last) as f64;
    let mut found: Vec<((usize, usize), Shared)> = pairs
        .iter()
        .filter_map(|(a, b)| {
            let shared = shared(&lines[*a], &lines[*b], last, looks)?;
            let of_time = of_time((&residuals[*a], &slopes[*a]), (&residuals[*b], &slopes[*b]));
            (of_time < OF_TIME * shared.coherence.sqrt()).then_some(((*a, *b), shared))
        })
        .collect();
    found.sort_by(|a, b| a.1.p.total_cmp(&b.1.p));
    let (_, best) = found.first()?;
    let mut variables = Vec::new();
    for c in found.iter().flat_map(|((a, b), _)| [*a, *b]) {
        let variable = signals.get(c)?.variable;
        if !variables.contains(&variable) {
            variables.push(variable);
        }
    }
    let band = ((best.low as f64 - 0.5) * spacing, (best.high as f64 + 0.5) * spacing);
    Some(Common { p: best.p, share: best.share, channels: variables, band })
}

/// What two channels share.
struct Shared {
    p: f64,
    share: f64,
    /// Coherence in the band, weighted with the power there.
    coherence: f64,
    low: usize,
    high: usize,
}

fn shared(a: &Lines, b: &Lines, last: usize, looks: f64) -> Option<Shared> {
    let n = a.independent();
    let mut p = 1.0_f64;
    let (mut low, mut high) = (usize::MAX, 0);
    for line in 1..=last {
        let chance = coherent(a.coherence(b, line), n) * looks;
        p = p.min(chance);
        if chance < SHARED_LEVEL {
            (low, high) = (low.min(line), high.max(line));
        }
    }
    if p >= SHARED_LEVEL {
        return None;
    }
    let (mut share, mut carried, mut coherence) = (0.0, 0.0, 0.0);
    for lines in [a, b] {
        let total: f64 = (0..lines.count()).map(|k| lines.power(k)).sum();
        let within: f64 = (low..=high).map(|k| lines.power(k)).sum();
        // coherence of nothing is 1 / n on average
        let unbiased = |k: usize| ((a.coherence(b, k) - 1.0 / n) / (1.0 - 1.0 / n)).max(0.0);
        let common: f64 = (low..=high).map(|k| unbiased(k) * lines.power(k)).sum();
        if within < MIN_POWER * total {
            return None;
        }
        share += 0.5 * common / total;
        carried += 0.5 * within / total;
        coherence += 0.5 * common / within;
    }
    let enough = coherence > MUCH && carried > MUCH;
    enough.then_some(Shared { p, share, coherence, low, high })
}

/// Half the difference of the neighbours: slope per sample.
fn slope(values: &[f64]) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    (0..values.len()).map(|i| 0.5 * (values[(i + 1).min(last)] - values[i.saturating_sub(1)])).collect()
}

/// Takes off what a small common lag and the filter behind it make: the slopes of all channels by the same
/// factor, and the slopes of those.
fn remove_lag(residuals: &mut [Vec<Vec<f64>>], slopes: &[Vec<Vec<f64>>]) {
    let (mut aa, mut ab, mut bb, mut ae, mut be) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (residual, slopes) in residuals.iter().zip(slopes) {
        let n = residual.iter().map(Vec::len).sum::<usize>().max(1) as f64;
        let square = residual.iter().flatten().map(|e| e * e).sum::<f64>() / n;
        if square <= 0.0 {
            continue;
        }
        for (e, s) in residual.iter().zip(slopes) {
            for ((e, s), curve) in e.iter().zip(s).zip(slope(s)) {
                aa += s * s / square;
                ab += s * curve / square;
                bb += curve * curve / square;
                ae += s * e / square;
                be += curve * e / square;
            }
        }
    }
    let determinant = aa * bb - ab * ab;
    if determinant <= 1e-12 * aa * bb {
        return;
    }
    let lag = ((ae * bb - be * ab) / determinant).clamp(-RECORDER_LAG, RECORDER_LAG);
    let most = RECORDER_LAG * RECORDER_LAG;
    let curvature = ((be * aa - ae * ab) / determinant).clamp(-most, most);
    for (residual, slopes) in residuals.iter_mut().zip(slopes) {
        for (e, s) in residual.iter_mut().zip(slopes) {
            let curves = slope(s);
            for ((e, s), curve) in e.iter_mut().zip(s).zip(curves) {
                *e -= lag * s + curvature * curve;
            }
        }
    }
}

/// To what share the residuals of two channels are those of wrong times: each its slope times the same
/// error of time, however that varies. Then the residual of one times the slope of the other are equal both
/// ways, and the residuals are large where the slopes are; the lesser of the two.
fn of_time(a: (&[Vec<f64>], &[Vec<f64>]), b: (&[Vec<f64>], &[Vec<f64>])) -> f64 {
    let (mut product, mut squares) = (0.0, 0.0);
    for r in 0..a.0.len() {
        for i in 0..a.0[r].len() {
            let (x, y) = (a.0[r][i] * b.1[r][i], b.0[r][i] * a.1[r][i]);
            product += 2.0 * x * y;
            squares += x * x + y * y;
        }
    }
    let equal = if squares > 0.0 { product / squares } else { 0.0 };
    [a, b].into_iter().map(|(e, s)| with_slope(e, s)).fold(equal, f64::min)
}

/// The share of a residual's square that grows with the square of the slope.
fn with_slope(residual: &[Vec<f64>], slope: &[Vec<f64>]) -> f64 {
    let pairs = || residual.iter().flatten().map(|e| e * e).zip(slope.iter().flatten().map(|s| s * s));
    let n = pairs().count().max(1) as f64;
    let (mean_e, mean_s) = pairs().fold((0.0, 0.0), |(e, s), (a, b)| (e + a / n, s + b / n));
    let covariance: f64 = pairs().map(|(e, s)| (e - mean_e) * (s - mean_s)).sum();
    let variance: f64 = pairs().map(|(_, s)| (s - mean_s).powi(2)).sum();
    if variance > 0.0 && mean_e > 0.0 { covariance / variance * mean_s / mean_e } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::super::bed::run;
    use super::*;
    use crate::stats::SplitMix64;
    use crate::stats::testing::coloured;
    use std::f64::consts::PI;

    /// An oscillator under a wandering force: position, velocity, load cell.
    fn oscillator(n: usize, stiffness: impl Fn(usize) -> f64) -> (Vec<f64>, [Vec<f64>; 3]) {
        let (parts, h) = (10, 1e-3);
        let mut random = SplitMix64::new(77);
        let force = coloured(&mut random, 0.9, n);
        let (mut x, mut v) = (0.0, 0.0);
        let mut all = [Vec::new(), Vec::new(), Vec::new()];
        for (i, force) in force.iter().enumerate() {
            let spring = stiffness(i) * x;
            for (trace, value) in all.iter_mut().zip([x, v, spring + 0.5 * v]) {
                trace.push(value);
            }
            for _ in 0..parts {
                v += h * (100.0 * force - stiffness(i) * x - 2.0 * v);
                x += h * v;
            }
        }
        (force, all)
    }

    fn spread(values: &[f64]) -> f64 {
        (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
    }

    #[test]
    fn independent_noise_has_no_common_cause() {
        let mut alarms = 0;
        for seed in 0..200 {
            let mut random = SplitMix64::new(1000 + seed);
            let n = [700, 1500, 3000][seed as usize % 3];
            let memory = [0.0, 0.7, 0.95, 0.995];
            let runs: Vec<Run> = (0..3)
                .map(|r| {
                    let noise: Vec<Vec<f64>> = (0..3)
                        .map(|c| coloured(&mut random, memory[(seed as usize + c + r / 3) % 4], n))
                        .collect();
                    run("a", 0.01, &[], &noise)
                })
                .collect();
            let signal: Vec<f64> = (0..n).map(|i| (0.05 * i as f64).sin()).collect();
            let simulated = vec![vec![signal; 3]; 3];
            // noise is measured minus simulated
            let runs: Vec<Run> = runs
                .into_iter()
                .map(|mut r| {
                    for channel in &mut r.channels {
                        for (v, s) in channel.values.iter_mut().zip(&simulated[0][0]) {
                            *v += s;
                        }
                    }
                    r
                })
                .collect();
            alarms += usize::from(common_cause(&runs.iter().collect::<Vec<_>>(), &simulated).is_some());
        }
        assert!(alarms <= 2, "{alarms} of 200");
    }

    #[test]
    fn a_wandering_parameter_is_found() {
        for seed in 0..10 {
            let n = 4000;
            let mut random = SplitMix64::new(seed);
            let wander = coloured(&mut random, 0.995, n);
            let (input, mut measured) = oscillator(n, |i| 400.0 * (1.0 + 0.08 * wander[i]));
            let (_, simulated) = oscillator(n, |_| 400.0);
            for (m, s) in measured.iter_mut().zip(&simulated) {
                let error = spread(&m.iter().zip(s).map(|(a, b)| a - b).collect::<Vec<_>>());
                m.iter_mut().for_each(|v| *v += 0.5 * error * random.normal());
            }
            let run = run("a", 0.01, &[input], &measured);
            let common = common_cause(&[&run], &[simulated.to_vec()]).unwrap();
            assert!(common.p < 1e-6 && common.share > 0.3, "{seed}: {common:?}");
            assert!(common.channels.len() == 3 && common.channels.contains(&1), "{common:?}");
            // where the oscillator resonates: 3.2 Hz
            assert!(common.band.0 < 3.2 && common.band.1 > 3.2, "{common:?}");
        }
    }

    #[test]
    fn errors_of_time_are_no_common_cause() {
        for seed in 0..20 {
            let mut random = SplitMix64::new(seed);
            let n = 3000;
            let wave = |t: f64, f: f64| (2.0 * PI * f * t).sin() + 0.5 * (2.0 * PI * 1.7 * f * t + 1.0).cos();
            let jitter: Vec<f64> = (0..n).map(|_| 0.002 * random.normal()).collect();
            let trace = |c: usize, late: &dyn Fn(usize) -> f64| -> Vec<f64> {
                let f = [1.0, 1.0, 1.3][c];
                let gain = [1.0, 2.0, 1.0][c];
                (0..n).map(|i| gain * wave(0.01 * i as f64 + 0.1 * c as f64 - late(i), f)).collect()
            };
            let simulated: Vec<Vec<f64>> = (0..3).map(|c| trace(c, &|_| 0.0)).collect();
            let lagging = |i: usize| 0.003 + 0.0 * i as f64;
            let jittery = |i: usize| jitter[i];
            for (word, late) in
                [("lag", &lagging as &dyn Fn(usize) -> f64), ("jitter", &jittery as &dyn Fn(usize) -> f64)]
            {
                let measured: Vec<Vec<f64>> = (0..3)
                    .map(|c| trace(c, late).iter().map(|v| v + 0.002 * random.normal()).collect())
                    .collect();
                let run = run("a", 0.01, &[], &measured);
                let common = common_cause(&[&run], std::slice::from_ref(&simulated));
                assert_eq!(common, None, "{seed} {word}");
            }
        }
    }

    #[test]
    fn too_little_has_no_common_cause() {
        assert_eq!(common_cause(&[], &[]), None);
        let one = run("a", 0.01, &[], &[vec![1.0; 5000]]);
        assert_eq!(common_cause(&[&one], &[vec![vec![0.0; 5000]]]), None);
        let still = run("a", 0.01, &[], &[vec![1.0; 5000], vec![2.0; 5000]]);
        assert_eq!(common_cause(&[&still], &[vec![vec![1.0; 5000], vec![2.0; 5000]]]), None);
        let short = run("a", 0.01, &[], &[vec![1.0; 50], vec![2.0; 50]]);
        assert_eq!(common_cause(&[&short], &[vec![vec![0.0; 50]; 2]]), None);
    }
}
