//! A step of Newton's method that keeps to bounds and to the order of the groups.

use crate::identify::solve::{Goal, Part, Problem, Targets, nearest};
use crate::{Error, Result};
use nalgebra::{DMatrix, DVector};

/// The groups have one answer where none of their parameters moves by more than this share of its range from sweep to sweep.
const SETTLED: f64 = 1e-12;
/// Sweeps over the groups. Targets hardly depend on later groups' parameters, so that each takes off a power of ten or more.
const SWEEPS: usize = 100;

/// Readings of the model in the neighbourhood of a point, to first order.
pub(super) struct Tangent<'a> {
    /// Bounds of what is looked for.
    pub bounds: &'a [[f64; 2]],
    /// The point.
    pub at: &'a [f64],
    /// The readings there,
    pub values: &'a [f64],
    /// and their derivatives.
    pub jacobian: &'a DMatrix<f64>,
}

impl Targets for Tangent<'_> {
    fn bounds(&self) -> &[[f64; 2]] {
        self.bounds
    }

    fn at(&self, parameters: &[f64]) -> Result<Vec<f64>> {
        let moved = DVector::from_fn(self.at.len(), |k, _| parameters[k] - self.at[k]);
        let values = DVector::from_column_slice(self.values) + self.jacobian * moved;
        Ok(values.as_slice().to_vec())
    }
}

impl Tangent<'_> {
    /// The parameters of which those of each group, of these sizes, are the nearest within their bounds to its own targets, with
    /// all others as they are: Newton's step, with which it begins, where all targets can be met. What a group cannot explain it leaves
    /// to no other.
    pub fn nearest(&self, goal: &Goal, groups: impl Iterator<Item = usize> + Clone) -> Result<Vec<f64>> {
        let missing = DVector::from_fn(self.at.len(), |k, _| goal.values[k] - self.values[k]);
        let step = self.jacobian.clone().lu().solve(&missing);
        let step = step.filter(|step| step.iter().all(|d| d.is_finite()));
        let whole = |k: usize| self.at[k] + step.as_ref().map_or(0.0, |step| step[k]);
        let within = |(k, [low, high]): (usize, &[f64; 2])| whole(k).clamp(*low, *high);
        let mut found: Vec<f64> = self.bounds.iter().enumerate().map(within).collect();
        for _ in 0..SWEEPS {
            let before = found.clone();
            let mut from = 0;
            for size in groups.clone() {
                let rows = from..from + size;
                let part = Part::new(self, rows.clone().collect(), rows.clone().collect(), &found);
                let goal = goal.part(rows.clone());
                let own = nearest(&Problem::new(&part, &goal)?, &found[rows.clone()])?;
                found.splice(rows.clone(), own.at);
                from = rows.end;
            }
            let moved = found.iter().zip(&before).zip(self.bounds);
            let moved = moved.map(|((a, b), [low, high])| (a - b).abs() / (high - low));
            if moved.fold(0.0, f64::max) <= SETTLED {
                return Ok(found);
            }
        }
        Err(Error::numeric("the groups depend on each other too much to be solved one after the other"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three readings of three parameters, all from 0 to 1, in a group of two and one of one.
    fn nearest(jacobian: [[f64; 3]; 3], goal: [f64; 3], sizes: [f64; 3]) -> Vec<f64> {
        let jacobian = DMatrix::from_row_slice(3, 3, &jacobian.concat());
        let (bounds, at, values) = ([[0.0, 1.0]; 3], [0.5; 3], &jacobian * DVector::from_element(3, 0.5));
        let tangent = Tangent { bounds: &bounds, at: &at, values: values.as_slice(), jacobian: &jacobian };
        let goal = Goal { values: goal.to_vec(), sizes: sizes.to_vec(), tolerance: 1e-12 };
        tangent.nearest(&goal, [2, 1].into_iter()).unwrap()
    }

    #[track_caller]
    fn assert_near(found: &[f64], expected: [f64; 3]) {
        let is_near = found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-8);
        assert!(is_near, "{found:?} for {expected:?}");
    }

    const COUPLED: [[f64; 3]; 3] = [[2.0, 1.0, 0.1], [1.0, 3.0, -0.2], [0.5, -0.4, 4.0]];

    #[test]
    fn targets_within_reach_are_met_whatever_they_weigh() {
        let jacobian = DMatrix::from_row_slice(3, 3, &COUPLED.concat());
        let answer = DVector::from_column_slice(&[0.2, 0.9, 0.6]);
        let goal = &jacobian * &answer;
        for sizes in [[1.0, 1.0, 1.0], [0.1, 30.0, 2.0]] {
            assert_near(&nearest(COUPLED, [goal[0], goal[1], goal[2]], sizes), [0.2, 0.9, 0.6]);
        }
    }

    /// One group after the other would go away from the answer here: each corrects by three times what the other does.
    #[test]
    fn groups_that_depend_on_each_other_are_solved_at_once() {
        let jacobian = [[1.0, 0.0, 3.0], [0.0, 1.0, 0.0], [3.0, 0.0, 1.0]];
        assert_near(&nearest(jacobian, [0.2 + 3.0 * 0.6, 0.9, 0.6 + 0.6], [1.0; 3]), [0.2, 0.9, 0.6]);
    }

    #[test]
    fn a_parameter_on_its_bound_leaves_the_others_the_least_squares() {
        // with the first at 1: 2 + y = 4 and 1 + 3 y = 2.5, each by how sure it is; the last group has its own answer
        let apart = [[2.0, 1.0, 0.0], [1.0, 3.0, 0.0], [0.0, 0.0, 4.0]];
        for [first, second] in [[1.0, 1.0], [1.0, 5.0], [0.2, 1.0]] {
            let (a, b): (f64, f64) = (1.0 / first, 1.0 / second);
            let y: f64 = (2.0 * a * a + 3.0 * 1.5 * b * b) / (a * a + 9.0 * b * b);
            assert_near(&nearest(apart, [4.0, 2.5, 1.0], [first, second, 1.0]), [1.0, y.min(1.0), 0.25]);
        }
    }

    #[test]
    fn what_a_group_misses_is_left_to_no_other() {
        // the first group asks for more than there is; the last one meets its own target beside it, though it could help
        let found = nearest(COUPLED, [9.0, 9.0, 2.0], [1.0; 3]);
        assert_near(&found, [1.0, 1.0, (2.0 - 0.5 + 0.4) / 4.0]);
    }
}
