//! The linear problem of screening: what columns explain of a residual beyond what others can.

use nalgebra::{DMatrix, DVector};

/// Sweeps over amounts that have to stay within their rooms: of the few amplitudes that effects have all but the last digits are
/// there by then.
const SWEEPS: usize = 30;

/// A residual, beside what fitted parameters can explain.
pub(super) struct Linear {
    /// Orthonormal columns that span what the parameters can explain; rows as the residual.
    basis: DMatrix<f64>,
    /// The residual, less what they can explain.
    pub residual: DVector<f64>,
}

impl Linear {
    /// Of a residual and its derivatives by the parameters.
    pub fn new(residual: DVector<f64>, parameters: &[DVector<f64>]) -> Self {
        let basis = orthonormal(residual.len(), parameters);
        let residual = without(&basis, &residual);
        Self { basis, residual }
    }

    /// A column, less what the parameters can explain.
    pub fn clean(&self, column: &DVector<f64>) -> DVector<f64> {
        without(&self.basis, column)
    }
}

/// A column without what lies in the span of orthonormal ones.
fn without(basis: &DMatrix<f64>, column: &DVector<f64>) -> DVector<f64> {
    column - basis * basis.tr_mul(column)
}

/// Orthonormal columns with the same span.
fn orthonormal(rows: usize, columns: &[DVector<f64>]) -> DMatrix<f64> {
    let mut basis: Vec<DVector<f64>> = Vec::new();
    for column in columns {
        let size = column.norm();
        let mut rest = column.clone();
        // twice is enough
        for _ in 0..2 {
            for b in &basis {
                rest -= b * b.dot(&rest);
            }
        }
        if rest.norm() > 1e-8 * size && size > 0.0 {
            let norm = rest.norm();
            basis.push(rest / norm);
        }
    }
    if basis.is_empty() { DMatrix::zeros(rows, 0) } else { DMatrix::from_columns(&basis) }
}

/// What columns explain of a residual with amounts that have these rooms: squared error taken away, and the amounts. Columns that
/// the parameters explain all but fully explain nothing by themselves.
pub(super) fn explain(
    clean: &[DVector<f64>],
    own: &[DVector<f64>],
    residual: &DVector<f64>,
    rooms: &[(f64, f64)],
) -> Option<(f64, Vec<f64>)> {
    let n = clean.len();
    let kept: Vec<usize> =
        (0..n).filter(|i| clean[*i].norm() > 1e-3 * own[*i].norm() && own[*i].norm() > 0.0).collect();
    if kept.is_empty() {
        return None;
    }
    let matrix = DMatrix::from_fn(kept.len(), kept.len(), |i, j| {
        let v = clean[kept[i]].dot(&clean[kept[j]]);
        if i == j { v * (1.0 + 1e-9) } else { v }
    });
    let right = DVector::from_fn(kept.len(), |i, _| clean[kept[i]].dot(residual));
    let mut amounts = matrix.clone().cholesky()?.solve(&right);
    let within = |amounts: &DVector<f64>, i: usize| {
        let (low, high) = rooms[kept[i]];
        amounts[i].clamp(low, high)
    };
    if (0..kept.len()).any(|i| within(&amounts, i) != amounts[i]) {
        // one amount after the other, each the best within its room: the function is convex
        for _ in 0..SWEEPS {
            for i in 0..kept.len() {
                amounts[i] += (right[i] - matrix.row(i).transpose().dot(&amounts)) / matrix[(i, i)];
                amounts[i] = within(&amounts, i);
            }
        }
    }
    let gain = 2.0 * amounts.dot(&right) - amounts.dot(&(&matrix * &amounts));
    let mut all = vec![0.0; n];
    for (i, amount) in kept.iter().zip(amounts.iter()) {
        all[*i] = *amount;
    }
    (gain.is_finite() && gain > 0.0).then_some((gain, all))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amounts_that_are_looked_for_keep_to_the_sign_and_to_the_search() {
        let column = DVector::from_vec(vec![1.0, 2.0, -1.0]);
        let explain = |share: f64, room: (f64, f64)| {
            let residual = &column * share;
            let own = std::slice::from_ref(&column);
            explain(own, own, &residual, &[room]).map(|(gain, a)| (gain, a[0]))
        };
        // 5 is twice what is looked for: of the square 1 - (1 - 1/2)^2 is explained
        let (gain, amount) = explain(5.0, (0.0, 2.5)).unwrap();
        assert!((amount - 2.5).abs() < 1e-9 && (gain / (25.0 * 6.0) - 0.75).abs() < 1e-9, "{gain}");
        let (gain, amount) = explain(5.0, (0.0, f64::INFINITY)).unwrap();
        assert!((amount - 5.0).abs() < 1e-6 && (gain / 150.0 - 1.0).abs() < 1e-6);
        assert!(explain(-5.0, (0.0, f64::INFINITY)).is_none());
    }
}
