//! Runs that repeat each other: what of a residual does not come again is no function of what drives the machine.

use super::signals::{channels, even, inputs, interval, residual};
use crate::fit::{Run, Traces};
use crate::stats::{mean, root_mean_square};

/// An input is the same in two runs if they differ by less than this share of how it moves in them,
const ALIKE: f64 = 0.1;
/// or by less than this share of its size in all runs.
const NEGLIGIBLE: f64 = 0.02;
/// The shorter of two repeats has this share of the longer one at least.
const AS_LONG: f64 = 0.8;

/// The noise of every measured channel, in its unit, by runs that repeat each other: root mean square of what their
/// residuals do not share, over the square root of two.
///
/// It has everything that does not come again: noise of sensors, disturbances, other beginnings, and what goes on from
/// run to run, such as warming. It has nothing that a model could tell from the inputs. `None` if no two runs are driven
/// alike.
pub fn scatter(runs: &[&Run], simulated: &[Traces]) -> Option<Vec<f64>> {
    let step = interval(runs)?;
    let evened = |values: &[Vec<f64>]| -> Vec<Vec<f64>> {
        runs.iter().zip(values).map(|(run, v)| even(&run.time, v, step)).collect()
    };
    let driven: Vec<Vec<Vec<f64>>> = inputs(runs).iter().map(|s| evened(&s.values)).collect();
    let pairs = (0..runs.len()).flat_map(|j| (0..j).map(move |i| (i, j)));
    let repeats: Vec<(usize, usize)> = pairs.filter(|(i, j)| are_repeats(&driven, *i, *j)).collect();
    let of = |channel: usize| {
        let rests = evened(&residual(runs, simulated, channel));
        let differences =
            repeats.iter().flat_map(|(i, j)| rests[*i].iter().zip(&rests[*j])).map(|(a, b)| a - b);
        root_mean_square(differences) / 2.0_f64.sqrt()
    };
    (!repeats.is_empty()).then(|| (0..channels(runs)).map(of).collect())
}

/// Whether all inputs do the same in two runs, and one of them moves.
fn are_repeats(driven: &[Vec<Vec<f64>>], i: usize, j: usize) -> bool {
    let mut moves = false;
    for signal in driven {
        let (a, b) = (&signal[i], &signal[j]);
        let (shorter, longer) = (a.len().min(b.len()), a.len().max(b.len()));
        if shorter == 0 || (shorter as f64) < AS_LONG * longer as f64 {
            return false;
        }
        let (a, b) = (&a[..shorter], &b[..shorter]);
        let mean = mean(a);
        let moved = ALIKE * root_mean_square(a.iter().map(|v| v - mean));
        let difference = root_mean_square(a.iter().zip(b).map(|(a, b)| a - b));
        moves |= moved > 0.0 && difference <= moved;
        if difference > moved.max(NEGLIGIBLE * root_mean_square(signal.iter().flatten().copied())) {
            return false;
        }
    }
    moves
}

#[cfg(test)]
mod tests {
    use super::super::bed::run;
    use super::super::noise;
    use super::*;
    use crate::stats::SplitMix64;
    use crate::stats::testing::coloured;

    const N: usize = 3000;

    #[test]
    fn what_comes_again_in_repeats_is_no_noise_whatever_it_follows() {
        let mut random = SplitMix64::new(7);
        let courses = [coloured(&mut random, 0.99, N), coloured(&mut random, 0.99, N)];
        // the sensor of the input has noise, another input rests but for its noise
        let mut measured = |k: usize| {
            let u: Vec<f64> = courses[k].iter().map(|u| u + 0.02 * random.normal()).collect();
            let rests = (0..N).map(|_| 20.0 + 0.1 * random.normal()).collect();
            // even in the input, which no coherence sees
            let y = courses[k].iter().map(|u| u * u + 0.1 * random.normal()).collect();
            run("a", 0.01, &[u, rests], &[y])
        };
        let runs = [measured(0), measured(1), measured(0), measured(0)];
        let runs: Vec<&Run> = runs.iter().collect();
        let simulated = vec![vec![vec![0.0; N]]; 4];
        let scatter = |some: &[usize]| {
            let runs: Vec<&Run> = some.iter().map(|i| runs[*i]).collect();
            scatter(&runs, &simulated[..some.len()])
        };
        let [scattered] = scatter(&[0, 1, 2, 3]).unwrap()[..] else { panic!("one channel") };
        assert!((scattered - 0.1).abs() < 0.005);
        assert!(noise(&runs, &simulated, 0).unwrap() > 0.5);
        assert_eq!(scatter(&[0, 1]), None);
    }

    #[test]
    fn runs_at_rest_and_runs_of_other_lengths_repeat_nothing() {
        let mut random = SplitMix64::new(3);
        let rest = run("a", 0.01, &[vec![1.0; N]], &[coloured(&mut random, 0.5, N)]);
        let simulated = vec![vec![vec![0.0; N]]; 2];
        assert_eq!(scatter(&[&rest, &rest], &simulated), None);
        let moves = coloured(&mut random, 0.9, N);
        let long = run("a", 0.01, std::slice::from_ref(&moves), &[vec![0.0; N]]);
        let short = run("b", 0.01, &[moves[..N / 2].to_vec()], &[vec![0.0; N / 2]]);
        assert_eq!(scatter(&[&long, &short], &[vec![vec![0.0; N]], vec![vec![0.0; N / 2]]]), None);
        assert_eq!(scatter(&[&long, &long], &simulated), Some(vec![0.0]));
        assert_eq!(scatter(&[], &[]), None);
    }
}
