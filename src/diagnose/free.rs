//! Which parameters of the model are fitted: those that matter.

use super::negligible::resolution;
use super::numbers::PRIOR;
use super::study::Study;
use super::subject::FreeParameter;
use crate::fit::{OutputError, Problem};
use crate::{Error, Result};
use nalgebra::{DMatrix, DVector};

/// Parameters that are fitted at most if the user does not say which; those with the most effect on the outputs. What moves them and
/// is not fitted is taken for something else; each costs a simulation of all runs wherever derivatives are computed.
const MAX_FREE: usize = 20;
/// A parameter that moves the outputs by less than this share of their size, over its whole prior, stays.
const MIN_EFFECT: f64 = 1e-3;

/// Derivatives of the residuals of the fit runs by the free parameters, where these are nominal.
pub struct Derivatives {
    /// Rows as residuals, columns as parameters.
    matrix: DMatrix<f64>,
    /// What the channels were weighed with.
    weights: Vec<f64>,
}

impl Derivatives {
    /// With the weights of a study of the same runs.
    pub(super) fn of(&self, study: &Study<'_>) -> DMatrix<f64> {
        let mut matrix = self.matrix.clone();
        study.weigh_anew(&mut matrix, &self.weights);
        matrix
    }
}

impl Study<'_> {
    /// The parameters that matter: those with the most effect on the outputs, the most important first. If they are
    /// too many, those of which others do the same stay. Returns the derivatives by those that were chosen, from differences as
    /// large as tell whether they matter.
    ///
    /// # Errors
    /// The model cannot be run with its nominal values.
    pub fn choose_free(&mut self, candidates: &[FreeParameter]) -> Result<Derivatives> {
        self.free = candidates.to_vec();
        let model = self.nominal();
        let problem = self.problem(&model, self.fit_runs.clone());
        let from = model.parameters.clone();
        let base = problem.residuals(std::slice::from_ref(&from)).pop().flatten();
        let base = base.ok_or_else(|| self.why_not(&problem))?;
        let mut points = Vec::new();
        for (i, p) in self.free.iter().enumerate() {
            let mut point = from.clone();
            // over the prior if the range allows, else over the range
            let room = ((p.high - p.nominal) / p.scale).min(0.05);
            point[i] += if room > 1e-6 { room } else { -0.05 };
            points.push(point);
        }
        let size = (base.len() as f64).sqrt();
        let mut effects: Vec<(usize, DVector<f64>)> = Vec::new();
        for (i, change) in problem.changes(&from, &base, &points).into_iter().enumerate() {
            let Some(change) = change else { continue };
            let step = points[i][i] - from[i];
            let mut effect = DVector::from_vec(change) * (PRIOR / size / step);
            self.clear_unresolved(&mut effect, size);
            if effect.norm() > MIN_EFFECT || self.free[i].asked {
                effects.push((i, effect));
            }
        }
        effects.sort_by(|a, b| b.1.norm_squared().total_cmp(&a.1.norm_squared()));
        // who asks for more gets more
        let asked = self.free.iter().filter(|p| p.asked).count();
        let most = MAX_FREE.max(asked);
        let chosen = most_by_themselves(effects.iter().map(|e| e.1.clone()).collect(), most);
        self.free = chosen.iter().map(|k| candidates[effects[*k].0].clone()).collect();
        let derivatives: Vec<DVector<f64>> = chosen.iter().map(|k| &effects[*k].1 * (size / PRIOR)).collect();
        let matrix = if derivatives.is_empty() {
            DMatrix::zeros(base.len(), 0)
        } else {
            DMatrix::from_columns(&derivatives)
        };
        Ok(Derivatives { matrix, weights: self.weights.clone() })
    }

    /// Clears what a parameter does to channels by less than these tell: that is rounding. `effect` is over the root of the number of all
    /// samples, `size`.
    fn clear_unresolved(&self, effect: &mut DVector<f64>, size: f64) {
        // rows are run by run, channel by channel
        let lengths =
            self.fit_runs.iter().flat_map(|run| run.channels.iter().map(|c| c.values.len()).enumerate());
        let rows: Vec<(usize, usize, usize)> = lengths
            .scan(0, |first, (channel, n)| {
                *first += n;
                Some((channel, *first - n, n))
            })
            .collect();
        for channel in 0..self.weights.len() {
            let own = || rows.iter().filter(|(c, ..)| *c == channel);
            let square: f64 = own().map(|(_, first, n)| effect.rows(*first, *n).norm_squared()).sum();
            let samples: usize = own().map(|(.., n)| n).sum();
            let least = self.weights[channel] * resolution(&self.fit_runs, channel);
            if square * size.powi(2) < samples as f64 * least.powi(2) {
                own().for_each(|(_, first, n)| effect.rows_mut(*first, *n).fill(0.0));
            }
        }
    }

    /// The error of a run that fails.
    fn why_not(&self, problem: &OutputError<'_>) -> Error {
        let setup = std::sync::Arc::new(problem.setup(&[]));
        for run in &problem.runs {
            let drives = [std::sync::Arc::clone(&run.drive)];
            let answers = self.bench.run(&[std::sync::Arc::clone(&setup)], &drives, &problem.watch());
            if let Some(Err(error)) = answers.into_iter().next() {
                return error.at(format!("{}: the model cannot be run", run.name));
            }
        }
        Error::numeric("the model cannot be run with its nominal values")
    }
}

/// Those effects, in their order, that do the most which others chosen before them cannot do: of two parameters that do
/// the same one is enough.
fn most_by_themselves(mut effects: Vec<DVector<f64>>, most: usize) -> Vec<usize> {
    let mut left: Vec<usize> = (0..effects.len()).collect();
    let mut chosen = Vec::new();
    while chosen.len() < most && !left.is_empty() {
        let size = |k: &usize| effects[*k].norm_squared();
        let first = (1..left.len()).fold(0, |a, b| if size(&left[b]) > size(&left[a]) { b } else { a });
        let k = left.swap_remove(first);
        chosen.push(k);
        let effect = std::mem::replace(&mut effects[k], DVector::zeros(0));
        let length = effect.norm_squared().max(f64::MIN_POSITIVE);
        for other in &left {
            let along = effect.dot(&effects[*other]) / length;
            effects[*other].axpy(-along, &effect, 1.0);
        }
    }
    chosen.sort_unstable();
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_parameters_that_do_the_same_one_is_chosen() {
        let effect = |values: [f64; 3]| DVector::from_vec(values.to_vec());
        // the second does what the first does, but for little; the third is smaller and does something else
        let effects = vec![effect([3.0, 0.0, 0.0]), effect([2.9, 0.1, 0.0]), effect([0.5, 0.0, 0.4])];
        assert_eq!(most_by_themselves(effects.clone(), 2), [0, 2]);
        assert_eq!(most_by_themselves(effects.clone(), 3), [0, 1, 2]);
        assert_eq!(most_by_themselves(effects, 9), [0, 1, 2]);
        assert!(most_by_themselves(Vec::new(), 2).is_empty());
    }
}
