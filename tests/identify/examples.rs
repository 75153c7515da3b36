//! The worked examples and counter-examples of the source (3.12, appendix B), and others made for what it leaves open.

use latsch::Result;
use latsch::identify::solve::{Goal, Method, Solution, Targets, Unsolved, local};
use nalgebra::DMatrix;
use std::f64::consts::{PI, TAU};

/// A map that is written down, with its exact derivatives, row by row.
pub(crate) struct Example {
    pub bounds: Vec<[f64; 2]>,
    pub values: fn(&[f64]) -> Vec<f64>,
    pub slopes: fn(&[f64]) -> Vec<f64>,
}

impl Targets for Example {
    fn bounds(&self) -> &[[f64; 2]] {
        &self.bounds
    }

    fn at(&self, p: &[f64]) -> Result<Vec<f64>> {
        Ok((self.values)(p))
    }

    fn jacobian(&self, p: &[f64]) -> Result<DMatrix<f64>> {
        Ok(DMatrix::from_row_slice(p.len(), p.len(), &(self.slopes)(p)))
    }
}

/// Injective, and yet both local methods stall (3.12).
pub(crate) fn stalls() -> Example {
    Example {
        bounds: vec![[-10.0, 10.0], [0.0, 10.0]],
        values: |p| vec![p[0] + p[1] * (0.7 * p[0]).exp(), p[0] * p[0] - 2.0 * p[1] * (-0.3 * p[0]).exp()],
        slopes: |p| {
            let (rise, fall) = ((0.7 * p[0]).exp(), (-0.3 * p[0]).exp());
            vec![1.0 + 0.7 * p[1] * rise, rise, 2.0 * p[0] + 0.6 * p[1] * fall, -2.0 * fall]
        },
    }
}

/// Completely sequential (section B.4).
pub(crate) fn chain() -> Example {
    Example {
        bounds: vec![[0.0, TAU], [0.0, 1.0]],
        values: |p| vec![p[0], 2.0 * p[0].cos() + p[1]],
        slopes: |p| vec![1.0, 0.0, -2.0 * p[0].sin(), 1.0],
    }
}

/// A chain in which Newton's method stalls (made for section B.5).
pub(crate) fn steep_chain() -> Example {
    Example {
        bounds: vec![[0.0, TAU], [0.0, 1.0]],
        values: |p| vec![-(-2.0 * p[0]).exp(), 2.0 * p[0].cos() + p[1]],
        slopes: |p| vec![2.0 * (-2.0 * p[0]).exp(), 0.0, -2.0 * p[0].sin(), 1.0],
    }
}

/// Each relation has one answer, the whole has two (section B.6).
pub(crate) fn twofold() -> Example {
    Example {
        bounds: vec![[0.0, 4.0]; 2],
        values: |p| vec![p[0] + p[1], p[0] + p[1] * p[1]],
        slopes: |p| vec![1.0, 1.0, 1.0, 2.0 * p[1]],
    }
}

/// Injective, and no single relation is (section B.7).
pub(crate) fn spiral() -> Example {
    Example {
        bounds: vec![[0.0, 1.99 * PI], [0.01, 5.0]],
        values: |p| vec![p[1] * (p[0] + p[1]).cos(), p[1] * (p[0] + p[1]).sin()],
        slopes: |p| {
            let (sin, cos) = (p[0] + p[1]).sin_cos();
            vec![-p[1] * sin, cos - p[1] * sin, p[1] * cos, sin + p[1] * cos]
        },
    }
}

/// The domain of the outer relation is split (section B.8).
pub(crate) fn split() -> Example {
    Example {
        bounds: vec![[0.0, TAU], [0.0, 1.0]],
        values: |p| vec![p[0] + 0.2 * p[1], 2.0 * p[0].cos() + p[1]],
        slopes: |p| vec![1.0, 0.2, -2.0 * p[0].sin(), 1.0],
    }
}

/// The gradient method is sure, Newton's is not (section B.9).
pub(crate) fn gradient_only() -> Example {
    Example {
        bounds: vec![[0.01, 1.3], [-0.5, 0.0]],
        values: |p| vec![p[0] + p[1] / (p[0] + 0.3), p[0] * p[0] + 2.0 * p[1]],
        slopes: |p| {
            let d = p[0] + 0.3;
            vec![1.0 - p[1] / (d * d), 1.0 / d, 2.0 * p[0], 2.0]
        },
    }
}

/// Three unknowns that the gradient method does not find, though all derivatives are positive (section B.11).
pub(crate) fn three_stall() -> Example {
    Example {
        bounds: vec![[-15.0, 10.0], [-6.2, 10.0], [-5.0, 0.0]],
        values: |p| {
            let third = 0.5 * p[0] + 0.5 * p[1] + 2.2 * p[2] + 0.04 * p[1] * p[1];
            vec![p[0] + p[1] + p[2], 0.5 * p[0] + 0.7 * p[1] + 0.5 * p[2], third]
        },
        slopes: |p| vec![1.0, 1.0, 1.0, 0.5, 0.7, 0.5, 0.5, 0.5 + 0.08 * p[1], 2.2],
    }
}

/// Three unknowns that respond as extended bisection wants it, all falling.
pub(crate) fn three() -> Example {
    Example {
        bounds: vec![[-1.0, 1.0]; 3],
        values: |p| {
            let cube = |x: f64| 0.1 * x * x * x;
            vec![
                2.0 * p[0] + 0.3 * p[1] + 0.3 * p[2] + cube(p[0]),
                p[0] + 2.0 * p[1] + 0.5 * p[2] + cube(p[1]),
                p[0] + 0.5 * p[1] + 2.0 * p[2] + cube(p[2]),
            ]
        },
        slopes: |p| {
            let square = |x: f64| 0.3 * x * x;
            let [a, b, c] = [p[0], p[1], p[2]].map(square);
            vec![2.0 + a, 0.3, 0.3, 1.0, 2.0 + b, 0.5, 1.0, 0.5, 2.0 + c]
        },
    }
}

/// The same, but the third unknown rises with the first.
pub(crate) fn three_with_tail() -> Example {
    Example {
        values: |p| {
            let mut values = (three().values)(p);
            values[2] -= 2.0 * p[0];
            values
        },
        slopes: |p| {
            let mut slopes = (three().slopes)(p);
            slopes[6] -= 2.0;
            slopes
        },
        ..three()
    }
}

/// A goal in the units of the map, as the source counts distances.
pub(crate) fn goal(map: &Example, solution: &[f64]) -> Goal {
    let values = map.at(solution).unwrap();
    Goal { sizes: vec![1.0; values.len()], values, tolerance: 1e-10 }
}

pub(crate) fn assert_near(a: &[f64], b: &[f64], by: f64) {
    assert!(a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= by), "{a:?} is not {b:?}");
}

#[track_caller]
pub(crate) fn assert_found(found: std::result::Result<Solution, Unsolved>, expected: &[f64], by: f64) {
    assert_near(&found.unwrap().parameters, expected, by);
}

/// Where a method stalls, and how far from the goal in the Euclidean sense.
#[track_caller]
pub(crate) fn stall_of(map: &Example, goal: &Goal, method: Method, start: &[f64]) -> (Vec<f64>, f64) {
    match local(map, goal, method, start) {
        Err(Unsolved::Stalled { at, .. }) => {
            let distance = goal.excess(&map.at(&at).unwrap()).norm();
            (at, distance)
        }
        other => panic!("{other:?}"),
    }
}
