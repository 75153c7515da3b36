//! Where equations jump across zero.

use super::Dual;
use super::newton::{largest, scaled, solve};

/// Two points next to each other between which equations jump, and the mean of both in which they are zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jump<const N: usize> {
    /// The points.
    pub sides: [[f64; N]; 2],
    /// How much the second counts, between 0 and 1.
    pub share: f64,
    /// The largest residual of the mean in units of its scale.
    pub residual: f64,
}

/// Halvings of the line between two points: to neighbouring numbers.
const HALVINGS: usize = 52;
/// Corrections of the line. Each leaves the jump's size times a product of differences of Jacobians and lengths.
const CORRECTIONS: usize = 5;

/// Looks near `x`, where Newton's method got stuck, for a jump of `values` across zero: a point on either side of which
/// the root lies on the other. Filippov's mean of both sides is then zero, in which what jumps in time would stay on
/// average. Arguments are those of [`newton`](super::newton); `None` where no jump explains why there is no root.
pub fn jump<const N: usize>(
    x: &[f64; N],
    scale: &[f64; N],
    tolerance: f64,
    mut values: impl FnMut(&[f64; N]) -> [f64; N],
    mut derivatives: impl FnMut(&[Dual<N>; N]) -> [Dual<N>; N],
) -> Option<Jump<N>> {
    let mut values = |x: &[f64; N]| scaled(values(x), scale);
    let mut jacobian = |x: &[f64; N]| {
        let exact = derivatives(&std::array::from_fn(|i| Dual::variable(x[i], i)));
        std::array::from_fn(|i| exact[i].gradient.map(|slope| slope / scale[i]))
    };
    // the roots that either side would have, were it everywhere
    let matrices = [jacobian(x), [[0.0; N]; N]];
    let first = stepped(x, &matrices[0], &values(x))?;
    let matrices = [matrices[0], jacobian(&first)];
    let second = stepped(&first, &matrices[1], &values(&first))?;
    let mut roots = [first, second];
    for _ in 0..=CORRECTIONS {
        let at = |s: f64| std::array::from_fn(|i| roots[0][i] + s * (roots[1][i] - roots[0][i]));
        // at the first root the second side is there, and the other way round
        let foretold = |k: usize, s: f64| {
            let way: [f64; N] = std::array::from_fn(|i| (s - k as f64) * (roots[1][i] - roots[0][i]));
            std::array::from_fn::<f64, N, _>(|i| (0..N).map(|j| matrices[k][i][j] * way[j]).sum())
        };
        let mut is_second = |s: f64| {
            let found = values(&at(s));
            let [one, other] = [0, 1].map(|k| largest(&difference(&found, &foretold(k, s))));
            other < one
        };
        let (mut from, mut to) = (0.0, 1.0);
        if !is_second(from) || is_second(to) {
            return None;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (from + to);
            if is_second(middle) { from = middle } else { to = middle }
        }
        let sides = [at(from), at(to)];
        let [before, after] = sides.map(|x| values(&x));
        let change = difference(&after, &before);
        let square: f64 = change.iter().map(|c| c * c).sum();
        let share = -before.iter().zip(&change).map(|(r, c)| r * c).sum::<f64>() / square;
        if !(0.0..=1.0).contains(&share) {
            return None;
        }
        let rest: [f64; N] = std::array::from_fn(|i| before[i] + share * change[i]);
        let residual = largest(&rest);
        if residual <= tolerance {
            return Some(Jump { sides, share, residual });
        }
        let mean = std::array::from_fn(|i| {
            std::array::from_fn(|j| matrices[1][i][j] * (1.0 - share) + matrices[0][i][j] * share)
        });
        for root in &mut roots {
            *root = stepped(root, &mean, &rest)?;
        }
    }
    None
}

/// Newton's step from x.
fn stepped<const N: usize>(x: &[f64; N], matrix: &[[f64; N]; N], residual: &[f64; N]) -> Option<[f64; N]> {
    let direction = solve(matrix, residual)?;
    Some(std::array::from_fn(|i| x[i] - direction[i]))
}

fn difference<const N: usize>(a: &[f64; N], b: &[f64; N]) -> [f64; N] {
    std::array::from_fn(|i| a[i] - b[i])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::{Real, newton};

    /// A line and a curve, the second of which falls by `drop` where the sum of both unknowns passes 1.
    fn falls<T: Real>(drop: f64, &[x, y]: &[T; 2]) -> [T; 2] {
        let fallen = if (x + y).value() > 1.0 { drop } else { 0.0 };
        [x - y * 0.5 + x * x * 0.1, x + y * 1.1 - T::from(1.1 - fallen)]
    }

    fn search(drop: f64) -> (f64, Option<Jump<2>>) {
        let mut x = [0.1, 0.2];
        let (values, derivatives) = (|x: &[f64; 2]| falls(drop, x), |x: &[Dual<2>; 2]| falls(drop, x));
        let found = newton(&mut x, &[1.0; 2], 1e-12, 40, &mut None, values, derivatives);
        (found.residual, jump(&x, &[1.0; 2], 1e-12, values, derivatives))
    }

    /// On the line where the unknowns sum up to 1, the first equation gives x, and the second says how much of the drop
    /// counts.
    #[test]
    fn the_mean_of_both_sides_is_zero_where_no_root_is() {
        let drop = 0.2;
        let (stuck, found) = search(drop);
        assert!(stuck > 1e-3, "{stuck}");
        let Jump { sides, share, .. } = found.unwrap();
        // x - (1 - x) / 2 + x² / 10 = 0
        let x = (-1.5 + (2.25_f64 + 0.2).sqrt()) / 0.2;
        for side in sides {
            assert!((side[0] - x).abs() < 1e-11 && (side[0] + side[1] - 1.0).abs() < 1e-11, "{side:?}");
        }
        let fallen = if sides[0][0] + sides[0][1] > 1.0 { 1.0 - share } else { share };
        let lacks = 1.1 - (x + (1.0 - x) * 1.1);
        assert!((fallen * drop - lacks).abs() < 1e-10, "{fallen} of {drop} for {lacks}");
    }

    /// No jump is found where a root is, nor where none is for another reason.
    #[test]
    fn silent_where_nothing_jumps() {
        assert_eq!(search(0.0).1, None);
        fn none<T: Real>(&[x]: &[T; 1]) -> [T; 1] {
            [x * x + 1.0]
        }
        assert_eq!(jump(&[0.5], &[1.0], 1e-12, none, none), None);
    }
}
