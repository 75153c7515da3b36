//! How much of a hidden effect remains when the parameters are refitted, over the noise.

use crate::programme::Run;
use crate::simulate::World;

/// Steps are longer here than in recordings \[s\].
const STEP: f64 = 1e-3;
/// Every how manieth sample counts.
const EVERY: usize = 3;

/// Per channel the rms of what is left of the difference that the hidden effects make, after a linear
/// refit of all parameters to all channels, over `deviations`.
#[must_use]
pub fn over_noise(with: &World, runs: &[(u64, Run)], deviations: &[f64]) -> Vec<f64> {
    let without = World { hidden: Vec::new(), ..with.clone() };
    over_noise_of(&flat(with, runs, deviations), &Refit::new(&without, runs, deviations), deviations.len())
}

/// The part of a refit that does not depend on the effect.
#[derive(Debug, Clone)]
pub struct Refit {
    nominal: Vec<f64>,
    columns: Vec<Vec<f64>>,
}

impl Refit {
    /// Sensitivities of all channels to all parameters.
    #[must_use]
    pub fn new(without: &World, runs: &[(u64, Run)], deviations: &[f64]) -> Self {
        let nominal = flat(without, runs, deviations);
        let columns = (0..without.parameters.len())
            .map(|i| {
                let mut moved = without.clone();
                moved.parameters[i] *= 1.005;
                let mut column = flat(&moved, runs, deviations);
                column.iter_mut().zip(&nominal).for_each(|(a, b)| *a -= b);
                column
            })
            .collect();
        Self::of(nominal, columns)
    }

    /// From all samples as they are, and how they change with each parameter; channels take turns.
    #[must_use]
    pub(crate) fn of(nominal: Vec<f64>, columns: Vec<Vec<f64>>) -> Self {
        Self { nominal, columns: orthonormal(columns) }
    }

    /// Per channel the rms of what is left of samples that are otherwise.
    #[must_use]
    pub(crate) fn left(&self, with: &[f64], channels: usize) -> Vec<f64> {
        over_noise_of(with, self, channels)
    }

    /// As [`over_noise`], for another world on the same runs.
    #[must_use]
    pub fn over_noise(&self, with: &World, runs: &[(u64, Run)], deviations: &[f64]) -> Vec<f64> {
        over_noise_of(&flat(with, runs, deviations), self, deviations.len())
    }
}

/// All channels at some of the samples, over their deviations.
fn flat(world: &World, runs: &[(u64, Run)], deviations: &[f64]) -> Vec<f64> {
    let mut all = Vec::new();
    for (number, run) in runs {
        let ideal = world.run(run, *number, STEP);
        for k in (0..run.time.len()).step_by(EVERY) {
            all.extend(ideal.outputs.iter().zip(deviations).map(|(values, deviation)| values[k] / deviation));
        }
    }
    all
}

/// The largest rest, and the channels in which it is at least 0.4 of that: the largest first.
#[must_use]
pub(crate) fn strongest(left: &[f64]) -> (f64, Vec<usize>) {
    let largest = left.iter().copied().fold(0.0, f64::max);
    let mut order: Vec<usize> = (0..left.len()).filter(|c| left[*c] > 0.4 * largest).collect();
    order.sort_by(|a, b| left[*b].total_cmp(&left[*a]));
    (largest, order)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Gram and Schmidt, twice; what is linearly dependent falls away.
fn orthonormal(columns: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let mut done: Vec<Vec<f64>> = Vec::new();
    for mut column in columns {
        let before = dot(&column, &column).sqrt();
        for _ in 0..2 {
            remove(&mut column, &done);
        }
        let left = dot(&column, &column).sqrt();
        if left > 1e-6 * before && before > 0.0 {
            column.iter_mut().for_each(|v| *v /= left);
            done.push(column);
        }
    }
    done
}

fn remove(from: &mut [f64], basis: &[Vec<f64>]) {
    for column in basis {
        let share = dot(from, column);
        from.iter_mut().zip(column).for_each(|(a, b)| *a -= share * b);
    }
}

#[allow(clippy::cast_precision_loss)] // a few ten thousand samples
fn over_noise_of(with: &[f64], refit: &Refit, channels: usize) -> Vec<f64> {
    let mut rest: Vec<f64> = with.iter().zip(&refit.nominal).map(|(a, b)| a - b).collect();
    remove(&mut rest, &refit.columns);
    let count = (rest.len() / channels) as f64;
    (0..channels)
        .map(|c| (rest.iter().skip(c).step_by(channels).map(|v| v * v).sum::<f64>() / count).sqrt())
        .collect()
}
