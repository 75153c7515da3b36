//! How much of a residual is noise of its own.

use super::signals::{channels, even, inputs, interval, outputs, residual};
use crate::fit::{Run, Traces};
use crate::stats::mean_or_zero;
use crate::stats::welch::{Lines, count, independent};

/// Segments that are tried, the longest first.
const LENGTHS: [usize; 3] = [256, 128, 64];
/// A signal that follows others to within this share of its square on a line says nothing new there.
const SAME: f64 = 1e-4;
/// The noise of a sensor is at no frequency so many times denser than where its spectrum ends, if it ends flat: what is, is
/// missing physics. Of noise with the poles that the blind study draws, the most coloured is 723 times as dense, computed from
/// the poles.
const COLOUR: f64 = 1e3;
/// It ends flat if the third quarter of it is at most so many times denser than the last. Power that falls with the square of the
/// frequency makes 2.0 of it, with the fourth power, as behind a filter of second order, 4.1.
const FLAT: f64 = 3.0;

/// The noise of a measured channel, in its unit: root mean square of the part of the residual that is not
/// coherent with any input, simulated output or residual of another channel.
///
/// By conditioned spectra (multiple coherence) with Welch's method, corrected for the number of signals.
/// What is missing in the model and acts on this channel alone, without following any of them linearly,
/// counts as noise, as long as the end of the spectrum does not tell that the sensor has less: it is an upper bound.
/// `None` if the runs are too short for that, or a channel is not there.
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
    let most = most_of_a_line(&(1..rest.count() - 1).map(power).collect::<Vec<f64>>());
    let power = |k: usize| power(k).min(most);
    let total: f64 = (1..rest.count()).map(power).sum();
    // the mean of every segment is gone: as much as beside it, which has two sides
    let square = total + 0.5 * power(1);
    square.is_finite().then(|| square.sqrt())
}

/// What a line can have of noise, if the spectrum ends flat.
fn most_of_a_line(powers: &[f64]) -> f64 {
    let quarter = powers.len() / 4;
    let end = |k: usize| mean_or_zero(&powers[powers.len() - k * quarter..powers.len() - (k - 1) * quarter]);
    if quarter > 0 && end(2) <= FLAT * end(1) { COLOUR * end(1) } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::super::bed::run;
    use super::*;
    use crate::stats::SplitMix64;
    use crate::stats::testing::coloured;
    use std::f64::consts::PI;

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
    fn what_wanders_slowly_far_above_the_end_of_the_spectrum_is_no_noise() {
        let mut random = SplitMix64::new(4);
        let n = 6000;
        // within 0.2 to 1 Hz, with 100 samples a second
        let sines: Vec<[f64; 2]> =
            (0..9).map(|k| [0.2 + 0.1 * f64::from(k), 6.0 * random.uniform()]).collect();
        let slow: Vec<f64> = (0..n)
            .map(|k| sines.iter().map(|[f, p]| (0.02 * PI * f * k as f64 + p).sin()).sum::<f64>() / 2.0)
            .collect();
        let of = |own: &[f64], wander: f64| {
            let channel = own.iter().zip(&slow).map(|(o, s)| o + wander * s).collect();
            let run = run("a", 0.01, &[vec![1.0; n]], &[channel]);
            noise(&[&run], &[vec![vec![0.0; n]]], 0).unwrap()
        };
        let white: Vec<f64> = (0..n).map(|_| 0.01 * random.normal()).collect();
        assert!((0.009..0.011).contains(&of(&white, 0.0)));
        let beside = of(&white, 1.0);
        assert!((0.01..0.1).contains(&beside), "{beside}");
        // coloured noise is what it is
        let own = coloured(&mut random, 0.85, n);
        let (size, found) = (crate::stats::root_mean_square(own.iter().copied()), of(&own, 0.0));
        assert!((0.93..1.07).contains(&(found / size)), "{found} of {size}");
    }

    #[test]
    fn short_runs_do_not_tell() {
        let run = run("a", 0.01, &[vec![1.0; 150]], &[vec![0.0; 150]]);
        assert_eq!(noise(&[&run], &[vec![vec![0.0; 150]]], 0), None);
        assert_eq!(noise(&[], &[], 0), None);
        assert_eq!(noise(&[&run], &[vec![vec![0.0; 150]]], 3), None);
    }
}
