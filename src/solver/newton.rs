//! Newton's method with exact derivatives and step halving.

use super::Dual;
use nalgebra::{DMatrix, DVector};

/// How a search ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Convergence {
    /// Largest residual in units of its scale.
    pub residual: f64,
    /// Steps taken.
    pub steps: usize,
    /// The residual is below the tolerance.
    pub converged: bool,
}

/// Solves `residual(x) = 0` from the guess `x`, which is replaced by the best point found.
///
/// `scale` gives the size of each residual that counts as 1; the search ends when no scaled residual
/// is larger than `tolerance`. A step that does not make the largest scaled residual smaller is
/// halved. Where the residual has kinks (a tire's patch has them), Newton's step may not get below
/// some small residual: the result says how far it came.
pub fn newton<const N: usize>(
    x: &mut [f64; N],
    scale: &[f64; N],
    tolerance: f64,
    max_steps: usize,
    mut residual: impl FnMut(&[Dual<N>; N]) -> [Dual<N>; N],
) -> Convergence {
    let mut evaluate = |x: &[f64; N]| residual(&std::array::from_fn(|i| Dual::variable(x[i], i)));
    let size = |r: &[Dual<N>; N]| {
        // `max` would hide a NaN; a residual that is not a number is infinitely bad.
        r.iter()
            .zip(scale)
            .map(|(r, s)| (r.value / s).abs())
            .fold(0.0, |a: f64, b| if b.is_nan() { f64::INFINITY } else { a.max(b) })
    };
    let mut current = evaluate(x);
    let mut best = size(&current);
    for step in 0..max_steps {
        if best <= tolerance {
            return Convergence { residual: best, steps: step, converged: true };
        }
        let jacobian = DMatrix::from_fn(N, N, |i, j| current[i].gradient[j] / scale[i]);
        let right = DVector::from_fn(N, |i, _| current[i].value / scale[i]);
        let Some(direction) = jacobian.lu().solve(&right) else {
            return Convergence { residual: best, steps: step, converged: false };
        };
        let mut fraction = 1.0;
        loop {
            let trial: [f64; N] = std::array::from_fn(|i| x[i] - fraction * direction[i]);
            let next = evaluate(&trial);
            let next_size = size(&next);
            if next_size < best {
                (*x, current, best) = (trial, next, next_size);
                break;
            }
            fraction *= 0.5;
            if fraction < 1e-4 {
                return Convergence { residual: best, steps: step + 1, converged: best <= tolerance };
            }
        }
    }
    Convergence { residual: best, steps: max_steps, converged: best <= tolerance }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::Real;

    #[test]
    fn finds_the_known_root_quadratically() {
        // Circle and exponential: a classic pair with the root (0, 1) nearby.
        let mut x = [0.3, 0.8];
        let result = newton(&mut x, &[1.0, 1.0], 1e-14, 10, |&[x, y]| [x * x + y * y - 1.0, x.exp() - y]);
        assert!(result.converged && result.steps <= 6, "{result:?}");
        assert!(x[0].abs() < 1e-14 && (x[1] - 1.0).abs() < 1e-14, "{x:?}");
    }

    #[test]
    fn reports_a_root_that_is_not_there() {
        let mut x = [3.0];
        let result = newton(&mut x, &[1.0], 1e-12, 50, |&[x]| [x * x + 1.0]);
        assert!(!result.converged && result.residual >= 1.0, "{result:?}");
    }
}
