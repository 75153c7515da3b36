//! How much of a residual is noise of its own.

use super::signals::{channels, even, inputs, interval, outputs, residual};
use crate::fit::{Run, Traces};
use crate::stats::welch::{Lines, count, independent};

/// Segments that are tried, the longest first.
const LENGTHS: [usize; 3] = [256, 128, 64];
/// A signal that follows others to within this share of its square on a line says nothing new there.
const SAME: f64 = 1e-4;

/// The noise of a measured channel, in its unit: root mean square of the part of the residual that is not
/// coherent with any input, simulated output or residual of another channel.
///
/// By conditioned spectra (multiple coherence) with Welch's method, corrected for the number of signals.
/// What is missing in the model and acts on this channel alone, without following any of them linearly,
/// counts as noise: it is an upper bound. `None` if the runs are too short for that, or a channel is not
/// there.
pub fn noise(runs: &[&Run], simulated: &[Traces], channel: usize) -> Option<f64> {
    let step = interval(runs)?;
    let evened = |values: &[Vec<f64>]| -> Vec<Vec<f64>> {
        runs.iter().zip(values).map(|(run, v)| even(&run.time, v, step)).collect()
    };
    let own = evened(&residual(runs, simulated, channel));
    let others = (0..channels(runs)).filter(|c| *c != channel).map(|c| residual(runs, simulated, c));
    let signals = inputs(runs).into_iter().chain(outputs(runs, simulated)).map(|s| s.values);
    let others: Vec<Vec<Vec<f64>>> = signals.chain(others).map(|values| evened(&values)).collect();
    // a run counts if it has everything
    let whole: Vec<usize> = (0..own.len())
        .filter(|r| !own[*r].is_empty() && others.iter().all(|o| o[*r].len() == own[*r].len()))
        .collect();
    let samples: Vec<usize> = whole.iter().map(|r| own[*r].len()).collect();
    let needed = 2.0 * others.len() as f64 + 4.0;
    let length = LENGTHS.into_iter().find(|l| independent(count(&samples, *l)) >= needed)?;
    let lines = |values: &[Vec<f64>]| Lines::of(whole.iter().map(|r| &values[*r][..]), length);

    let mut rest = lines(&own)?;
    let mut used = vec![0.0; rest.count()];
    let mut known: Vec<(Lines, Vec<f64>)> = Vec::new();
    for values in &others {
        let mut signal = lines(values)?;
        let least: Vec<f64> = (0..signal.count()).map(|k| SAME * signal.square(k)).collect();
        for (earlier, least) in &known {
            signal.without(earlier, least);
        }
        rest.without(&signal, &least);
        for (k, used) in used.iter_mut().enumerate() {
            *used += f64::from(u8::from(signal.square(k) > least[k]));
        }
        known.push((signal, least));
    }
    let n = rest.independent();
    let power = |k: usize| rest.power(k) * n / (n - used[k]).max(1.0);
    let total: f64 = (1..rest.count()).map(power).sum();
    // the mean of every segment is gone: as much as beside it, which has two sides
    let square = total + 0.5 * power(1);
    square.is_finite().then(|| square.sqrt())
}

#[cfg(test)]
mod tests {
    use super::super::bed::run;
    use super::*;
    use crate::stats::SplitMix64;
    use crate::stats::testing::coloured;

    #[test]
    fn what_inputs_and_other_channels_explain_is_no_noise() {
        for seed in 0..20 {
            let mut random = SplitMix64::new(seed);
            let n = 6000;
            let input = coloured(&mut random, 0.9, n);
            let shared = coloured(&mut random, 0.8, n);
            let own = coloured(&mut random, 0.5, n);
            let a: Vec<f64> = (0..n).map(|i| 0.3 * own[i] + 0.5 * input[i] + shared[i]).collect();
            let b: Vec<f64> = shared.iter().map(|s| 2.0 * s + 0.02 * random.normal()).collect();
            let flat = vec![0.0; n];
            let run = run("a", 0.01, &[input], &[a, b]);
            let simulated = [vec![flat.clone(), flat]];
            let noise = noise(&[&run], &simulated, 0).unwrap();
            assert!((0.26..0.33).contains(&noise), "{seed}: {noise}");
        }
    }

    #[test]
    fn short_runs_do_not_tell() {
        let run = run("a", 0.01, &[vec![1.0; 150]], &[vec![0.0; 150]]);
        assert_eq!(noise(&[&run], &[vec![vec![0.0; 150]]], 0), None);
        assert_eq!(noise(&[], &[], 0), None);
        assert_eq!(noise(&[&run], &[vec![vec![0.0; 150]]], 3), None);
    }
}
