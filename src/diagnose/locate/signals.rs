//! Residuals, and the signals that they may depend on, of all runs alike.

use crate::fit::{Run, Traces};
use crate::model::Interface;
use crate::stats::{mean, median, quantile_below, redundancy};

/// Series longer than this are thinned before their memory is measured.
const MANY: usize = 20_000;

/// A signal in all runs.
pub struct Signal {
    /// The variable.
    pub variable: usize,
    /// By run, at its samples; empty where a run lacks it.
    pub values: Vec<Vec<f64>>,
}

/// Number of measured channels.
pub fn channels(runs: &[&Run]) -> usize {
    runs.iter().map(|r| r.channels.len()).min().unwrap_or(0)
}

/// Measured minus simulated of a channel in each run; empty where a run lacks it.
pub fn residual(runs: &[&Run], simulated: &[Traces], channel: usize) -> Vec<Vec<f64>> {
    let of = |(run, traces): (&&Run, &Traces)| match (run.channels.get(channel), traces.get(channel)) {
        (Some(measured), Some(trace)) if measured.values.len() == run.time.len() => {
            measured.values.iter().zip(trace).map(|(m, s)| m - s).collect()
        }
        _ => Vec::new(),
    };
    runs.iter().zip(simulated).map(of).collect()
}

/// The driven inputs.
pub fn inputs(runs: &[&Run]) -> Vec<Signal> {
    let mut variables: Vec<usize> =
        runs.iter().flat_map(|r| r.drive.inputs.iter().map(|(v, _)| *v)).collect();
    variables.sort_unstable();
    variables.dedup();
    let of = |variable: usize| Signal {
        variable,
        values: runs
            .iter()
            .map(|run| {
                let input = run.drive.inputs.iter().find(|(v, _)| *v == variable);
                input.map_or(Vec::new(), |(_, values)| run.sample(values, 0.0))
            })
            .collect(),
    };
    variables.into_iter().map(of).collect()
}

/// The measured channels as simulated: without the noise that the residual has too.
pub fn outputs(runs: &[&Run], simulated: &[Traces]) -> Vec<Signal> {
    let Some(first) = runs.first() else { return Vec::new() };
    let values = |c: usize| {
        let of = |(run, traces): (&&Run, &Traces)| {
            traces.get(c).filter(|t| t.len() == run.time.len()).cloned().unwrap_or_default()
        };
        runs.iter().zip(simulated).map(of).collect()
    };
    first
        .channels
        .iter()
        .take(channels(runs))
        .enumerate()
        .map(|(c, channel)| Signal { variable: channel.variable, values: values(c) })
        .collect()
}

/// Name of a variable.
pub fn name(interface: &Interface, variable: usize) -> String {
    interface.variables.get(variable).map_or_else(String::new, |v| v.name.clone())
}

/// Name of a variable and its unit in brackets.
pub fn label(interface: &Interface, variable: usize) -> String {
    let unit = interface.variables.get(variable).and_then(|v| v.unit.clone());
    format!("{} [{}]", name(interface, variable), unit.unwrap_or_else(|| "1".into()))
}

/// The median sampling interval of all runs \[s\].
pub fn interval(runs: &[&Run]) -> Option<f64> {
    let all: Vec<f64> = runs.iter().flat_map(|r| r.time.windows(2).map(|w| w[1] - w[0])).collect();
    Some(median(&all)).filter(|step| step.is_finite() && *step > 0.0)
}

/// Samples at equal distances: as they are if their times are within half an interval of that, else linear
/// between them.
pub fn even(time: &[f64], values: &[f64], step: f64) -> Vec<f64> {
    let Some(first) = time.first() else { return Vec::new() };
    if values.len() != time.len() {
        return Vec::new();
    }
    let straight = time.iter().enumerate().all(|(i, t)| (t - first - i as f64 * step).abs() < 0.5 * step);
    if straight && values.iter().all(|v| v.is_finite()) {
        return values.to_vec();
    }
    let (time, values): (Vec<f64>, Vec<f64>) =
        time.iter().zip(values).filter(|(t, v)| t.is_finite() && v.is_finite()).unzip();
    let (Some(first), Some(last)) = (time.first(), time.last()) else { return Vec::new() };
    // a recording with a wild time stamp would fill the memory
    if (last - first) / step > 8.0 * time.len() as f64 {
        return Vec::new();
    }
    let mut k = 0;
    (0..=((last - first) / step + 1e-9) as usize)
        .map(|i| {
            let t = first + i as f64 * step;
            while k + 2 < time.len() && time[k + 1] < t {
                k += 1;
            }
            let Some(next) = values.get(k + 1) else { return values[k] };
            let share = (t - time[k]) / (time[k + 1] - time[k]).max(f64::MIN_POSITIVE);
            values[k] + (next - values[k]) * share.clamp(0.0, 1.0)
        })
        .collect()
}

/// How many neighbouring samples tell as much as one that is independent, in several runs.
pub fn memory(series: &[Vec<f64>]) -> f64 {
    let of = |values: &Vec<f64>| {
        let thin = values.len().div_ceil(MANY);
        let means: Vec<f64> = values.chunks(thin).map(mean).collect();
        redundancy(&means) * thin as f64
    };
    series.iter().filter(|s| s.len() >= 8).map(of).fold(1.0, f64::max)
}

/// Block of each sample: blocks of one run that are at least `length` samples long, numbered on from
/// `first`. Returns the blocks and the number after the last.
pub fn blocks(samples: usize, length: f64, first: usize) -> (Vec<usize>, usize) {
    let count = ((samples as f64 / length.max(1.0)) as usize).max(1);
    let of = |i: usize| first + i * count / samples.max(1);
    ((0..samples).map(of).collect(), first + if samples > 0 { count } else { 0 })
}

/// Ends of ranges with about as many samples each; of values that are few, each has a range.
pub fn bins(values: &[f64], count: usize) -> Vec<f64> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let (Some(low), Some(high)) = (sorted.first().copied(), sorted.last().copied()) else {
        return Vec::new();
    };
    let range = high - low;
    if range <= 1e-9 * low.abs().max(high.abs()) {
        return Vec::new();
    }
    let mut distinct = sorted.clone();
    distinct.dedup_by(|b, a| *b - *a < 1e-3 * range);
    if distinct.len() <= count {
        let between = distinct.windows(2).map(|w| 0.5 * (w[0] + w[1]));
        return std::iter::once(low).chain(between).chain([high]).collect();
    }
    let mut edges: Vec<f64> = (0..=count).map(|i| quantile_below(&sorted, i, count)).collect();
    edges.dedup_by(|b, a| *b - *a < 1e-6 * range);
    if edges.len() < 3 { vec![low, 0.5 * (low + high), high] } else { edges }
}

/// The range that a value is in.
pub fn bin(edges: &[f64], value: f64) -> Option<usize> {
    let last = edges.len().checked_sub(2)?;
    value.is_finite().then(|| edges[1..=last].partition_point(|e| *e <= value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_even_and_few_values_have_their_own() {
        let values: Vec<f64> = (0..600).map(|i| f64::from(i).powi(2)).collect();
        let edges = bins(&values, 6);
        assert_eq!(edges.len(), 7);
        for k in 0..6 {
            let n = values.iter().filter(|v| bin(&edges, **v) == Some(k)).count();
            assert!((99..=101).contains(&n), "{k}: {n}");
        }
        let levels: Vec<f64> = (0..90).map(|i| [5.0, 10.0, 20.0][i / 30]).collect();
        assert_eq!(bins(&levels, 6), [5.0, 7.5, 15.0, 20.0]);
        assert_eq!(bin(&bins(&levels, 6), 20.0), Some(2));
        assert!(bins(&[3.0; 50], 6).is_empty() && bins(&[], 6).is_empty());
        assert_eq!(bin(&[], 1.0), None);
        // a switch with ramps of interpolation
        let mut switch = vec![0.0; 500];
        switch.extend((0..20).map(|i| f64::from(i) / 20.0));
        switch.extend([1.0; 500]);
        assert_eq!(bins(&switch, 6).len(), 3);
    }

    #[test]
    fn gaps_are_bridged_and_jitter_is_left() {
        let time: Vec<f64> = [0.0, 1.1, 1.9, 3.0, 6.0, 7.0].to_vec();
        let values: Vec<f64> = time.iter().map(|t| 2.0 * t).collect();
        for (i, v) in even(&time, &values, 1.0).iter().enumerate() {
            assert!((v - 2.0 * i as f64).abs() < 1e-12, "{i} {v}");
        }
        assert_eq!(even(&time[..4], &values[..4], 1.0), values[..4]);
        assert!(even(&[0.0, 1.0, 1e9], &[0.0; 3], 1.0).is_empty());
    }

    #[test]
    fn blocks_are_never_shorter_than_asked() {
        let (of, end) = blocks(100, 30.0, 4);
        assert_eq!((of[0], of[99], end), (4, 6, 7));
        assert_eq!(blocks(10, 30.0, 0), (vec![0; 10], 1));
    }
}
