//! [`Quadratic`]: what a sum of squares is near a point by its derivatives there, and the steps that these foretell.

use super::least_squares::Unknown;
use nalgebra::{DMatrix, DVector};

/// Steps are damped at least so much, relative to the information on each unknown: then two that do the same have a step,
/// too.
pub(super) const LEAST_DAMPING: f64 = 1e-9;

/// The sum of squares.
pub(super) fn square(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum()
}

/// The variance of residuals of which so many tell as much as one; it is not less than that of rounding, `least`.
pub(super) fn variance(residuals: &[f64], least: f64, redundancy: f64) -> f64 {
    let mean = square(residuals) / residuals.len().max(1) as f64;
    mean.max(least).max(f64::MIN_POSITIVE) * redundancy
}

/// The sum of squares near a point, in units of the residuals' variance there, with what is known beforehand.
pub(super) struct Quadratic<'a> {
    x: &'a [f64],
    unknowns: &'a [Unknown],
    variance: f64,
    /// The sum there,
    pub total: f64,
    /// half of its second derivatives,
    normal: DMatrix<f64>,
    /// and of its first.
    gradient: DVector<f64>,
}

impl<'a> Quadratic<'a> {
    /// Near a point, by the residuals and their derivatives there, and the [`variance`].
    pub fn at(
        x: &'a [f64],
        residuals: &[f64],
        jacobian: &DMatrix<f64>,
        unknowns: &'a [Unknown],
        variance: f64,
    ) -> Self {
        let mut normal = jacobian.tr_mul(jacobian) / variance;
        let mut gradient = jacobian.tr_mul(&DVector::from_column_slice(residuals)) / variance;
        for (i, u) in unknowns.iter().enumerate() {
            normal[(i, i)] += u.prior.powi(-2);
            gradient[i] += (x[i] - u.mean) / u.prior.powi(2);
        }
        let mut here = Self { x, unknowns, variance, total: 0.0, normal, gradient };
        here.total = here.sum(x, residuals);
        here
    }

    /// The sum elsewhere, by the residuals there.
    pub fn sum(&self, x: &[f64], residuals: &[f64]) -> f64 {
        let prior: f64 = self.unknowns.iter().zip(x).map(|(u, x)| ((x - u.mean) / u.prior).powi(2)).sum();
        square(residuals) / self.variance + prior
    }

    /// Where a damped step leads to that stays within bounds and reaches.
    pub fn step(&self, damping: f64) -> Vec<f64> {
        self.within_reach(self.bounded(damping.max(LEAST_DAMPING)))
    }

    /// By how much a step would lower the sum if the derivatives told all.
    pub fn promised(&self, to: &[f64]) -> f64 {
        let step = DVector::from_iterator(self.x.len(), to.iter().zip(self.x).map(|(a, b)| a - b));
        -2.0 * self.gradient.dot(&step) - (&self.normal * &step).dot(&step)
    }

    /// A damped Gauss-Newton step; unknowns that would leave their bounds stop there and the others are
    /// computed again.
    fn bounded(&self, damping: f64) -> Vec<f64> {
        let Self { x, unknowns, normal, gradient, .. } = self;
        let n = x.len();
        let mut fixed: Vec<Option<f64>> = vec![None; n];
        for _ in 0..=n {
            let free: Vec<usize> = (0..n).filter(|i| fixed[*i].is_none()).collect();
            if free.is_empty() {
                break;
            }
            let a = DMatrix::from_fn(free.len(), free.len(), |i, j| {
                let v = normal[(free[i], free[j])];
                if i == j { v * (1.0 + damping) + 1e-300 } else { v }
            });
            let b = DVector::from_fn(free.len(), |i, _| {
                let known: f64 = (0..n).filter_map(|j| fixed[j].map(|d| normal[(free[i], j)] * d)).sum();
                -gradient[free[i]] - known
            });
            let Some(step) = a.cholesky().map(|c| c.solve(&b)) else { return x.to_vec() };
            let mut moved = false;
            for (i, s) in free.iter().zip(step.iter()) {
                let to = x[*i] + s;
                let bound = to.clamp(unknowns[*i].low, unknowns[*i].high);
                if bound != to {
                    fixed[*i] = Some(bound - x[*i]);
                    moved = true;
                }
            }
            if !moved {
                for (i, s) in free.iter().zip(step.iter()) {
                    fixed[*i] = Some(*s);
                }
                break;
            }
        }
        x.iter()
            .zip(&fixed)
            .zip(*unknowns)
            .map(|((x, d), u)| (x + d.unwrap_or(0.0)).clamp(u.low, u.high))
            .collect()
    }

    /// A step shortened to where no unknown goes beyond its reach.
    fn within_reach(&self, to: Vec<f64>) -> Vec<f64> {
        let from = self.x;
        let steps = from.iter().zip(&to).zip(self.unknowns);
        let share = steps.map(|((a, b), u)| u.reach / (b - a).abs()).fold(1.0, f64::min);
        if share >= 1.0 {
            return to;
        }
        from.iter().zip(to).map(|(a, b)| a + share * (b - a)).collect()
    }
}
