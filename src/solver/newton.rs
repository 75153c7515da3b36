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

/// A step that leaves this share of the residual or less is followed by another without new derivatives. They cost
/// about four evaluations of a tire's patch, in which so many steps with an old Jacobian get to 0.3^4 = 0.008.
const WELL: f64 = 0.3;

/// Solves `values(x) = 0` from the guess `x`, which is replaced by the best point found. `derivatives` is the same
/// function of dual numbers.
///
/// `scale` gives the size of each residual that counts as 1; the search ends when no scaled residual
/// is larger than `tolerance`. A step that does not make the largest scaled residual smaller is
/// halved. Where the residual has kinks (a tire's patch has them), Newton's step may not get below
/// some small residual: the result says how far it came.
///
/// The Jacobian, of scaled residuals, costs more than the values: as long as steps go well it is used again, with
/// what the last step taught (Broyden's update). The search begins with the one in `jacobian` and leaves its last one
/// there.
pub fn newton<const N: usize>(
    x: &mut [f64; N],
    scale: &[f64; N],
    tolerance: f64,
    max_steps: usize,
    jacobian: &mut Option<[[f64; N]; N]>,
    mut values: impl FnMut(&[f64; N]) -> [f64; N],
    mut derivatives: impl FnMut(&[Dual<N>; N]) -> [Dual<N>; N],
) -> Convergence {
    let mut values = |x: &[f64; N]| scaled(values(x), scale);
    let mut residual = values(x);
    let mut renew = false;
    let mut steps = 0;
    loop {
        let best = largest(&residual);
        if best <= tolerance || steps == max_steps {
            return Convergence { residual: best, steps, converged: best <= tolerance };
        }
        let matrix = match *jacobian {
            Some(known) if !renew => known,
            _ => {
                renew = true;
                let exact = derivatives(&std::array::from_fn(|i| Dual::variable(x[i], i)));
                std::array::from_fn(|i| exact[i].gradient.map(|slope| slope / scale[i]))
            }
        };
        let direction = solve(&matrix, &residual);
        // an old Jacobian is not worth a search along its direction
        let least = if renew { 1e-4 } else { 1.0 };
        let fractions = std::iter::successors(Some(1.0), |fraction| Some(fraction * 0.5));
        let better = direction.and_then(|direction| {
            fractions.take_while(|fraction| *fraction >= least).find_map(|fraction| {
                let step: [f64; N] = std::array::from_fn(|i| -fraction * direction[i]);
                let trial: [f64; N] = std::array::from_fn(|i| x[i] + step[i]);
                let next = values(&trial);
                (largest(&next) < best).then_some((fraction, step, trial, next))
            })
        });
        steps += 1;
        *jacobian = Some(matrix);
        match better {
            Some((fraction, step, trial, next)) => {
                renew = largest(&next) > WELL * best;
                let surprise = std::array::from_fn(|i| next[i] - (1.0 - fraction) * residual[i]);
                *jacobian = Some(updated(&matrix, &step, &surprise));
                (*x, residual) = (trial, next);
            }
            None if renew => return Convergence { residual: best, steps, converged: false },
            None => renew = true,
        }
    }
}

/// Residuals in units of their scales.
pub(super) fn scaled<const N: usize>(residual: [f64; N], scale: &[f64; N]) -> [f64; N] {
    std::array::from_fn(|i| residual[i] / scale[i])
}

/// The largest residual.
pub(super) fn largest(residual: &[f64]) -> f64 {
    // `max` would hide a NaN; a residual that is not a number is infinitely bad.
    residual.iter().fold(0.0, |a: f64, b| if b.is_nan() { f64::INFINITY } else { a.max(b.abs()) })
}

/// The solution of linear equations, `None` if they are singular.
pub(super) fn solve<const N: usize>(matrix: &[[f64; N]; N], right: &[f64; N]) -> Option<[f64; N]> {
    let factors = DMatrix::from_fn(N, N, |i, j| matrix[i][j]).lu();
    let solution = factors.solve(&DVector::from_column_slice(right))?;
    Some(std::array::from_fn(|i| solution[i]))
}

/// Broyden's update: the Jacobian that explains by how much the residual after `step` differs from what `matrix`
/// foretold, and else changes least. Unknowns count by what they do to the residual, so their units do not matter.
fn updated<const N: usize>(matrix: &[[f64; N]; N], step: &[f64; N], surprise: &[f64; N]) -> [[f64; N]; N] {
    let weighted: [f64; N] =
        std::array::from_fn(|j| step[j] * matrix.iter().map(|row| row[j] * row[j]).sum::<f64>());
    let square: f64 = weighted.iter().zip(step).map(|(w, s)| w * s).sum();
    if square <= 0.0 {
        return *matrix;
    }
    std::array::from_fn(|i| std::array::from_fn(|j| matrix[i][j] + surprise[i] * weighted[j] / square))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::Real;

    /// Circle and exponential: a classic pair with the root (0, 1).
    fn pair<T: Real>(&[x, y]: &[T; 2]) -> [T; 2] {
        [x * x + y * y - 1.0, x.exp() - y]
    }

    /// Newton's method needs six steps, and as many Jacobians.
    #[test]
    fn finds_the_known_root_with_few_jacobians() {
        let mut x = [0.3, 0.8];
        let mut jacobians = 0;
        let counted = |x: &[Dual<2>; 2]| {
            jacobians += 1;
            pair(x)
        };
        let result = newton(&mut x, &[1.0, 1.0], 1e-14, 20, &mut None, pair, counted);
        assert!(result.converged && result.steps <= 10 && jacobians <= 3, "{result:?} {jacobians}");
        assert!(x[0].abs() < 1e-14 && (x[1] - 1.0).abs() < 1e-14, "{x:?}");
    }

    /// With the Jacobian of the root's neighbourhood none is needed; a useless one is replaced.
    #[test]
    fn begins_with_the_jacobian_that_it_is_given() {
        let count = std::cell::Cell::new(0);
        let search = |x: &mut [f64; 2], jacobian: &mut Option<_>| {
            count.set(0);
            let counted = |x: &[Dual<2>; 2]| {
                count.set(count.get() + 1);
                pair(x)
            };
            assert!(newton(x, &[1.0, 1.0], 1e-13, 20, jacobian, pair, counted).converged);
            assert!(x[0].abs() < 1e-12 && (x[1] - 1.0).abs() < 1e-12, "{x:?}");
            count.get()
        };
        let mut jacobian = None;
        assert!(search(&mut [0.3, 0.8], &mut jacobian) > 0);
        assert_eq!(search(&mut [1e-3, 1.001], &mut jacobian), 0);
        let mut useless = jacobian.map(|rows| rows.map(|row| row.map(|slope: f64| -slope)));
        assert!(search(&mut [0.3, 0.8], &mut useless) > 0);
    }

    #[test]
    fn reports_a_root_that_is_not_there() {
        fn none<T: Real>(&[x]: &[T; 1]) -> [T; 1] {
            [x * x + 1.0]
        }
        let mut x = [3.0];
        let result = newton(&mut x, &[1.0], 1e-12, 50, &mut None, none, none);
        assert!(!result.converged && result.residual >= 1.0, "{result:?}");
    }
}
