//! The theorems of the source's appendix, as properties of many maps.

use crate::examples::{Example, assert_found, assert_near, twofold};
use latsch::Result;
use latsch::identify::check::{Injectivity, Sampled, Sampling, injective};
use latsch::identify::solve::{Goal, Method, Nesting, Stall, Tail, Targets, Unsolved, local, nested};
use latsch::stats::SplitMix64;
use nalgebra::{DMatrix, Matrix2, Vector2};

const BOUNDS: [[f64; 2]; 2] = [[-1.0, 1.0]; 2];

/// Two targets that rise with both of two unknowns, and whose determinant has one sign: z_i = sum over k of
/// a_ik (p_k + w sin(f_k p_k + s_k) / f_k), in which slopes are between 1 - w and 1 + w.
struct Rising {
    slopes: Matrix2<f64>,
    waves: [[f64; 3]; 2],
}

impl Rising {
    fn draw(random: &mut SplitMix64) -> Self {
        let mut between = |a: f64, b: f64| a + (b - a) * random.uniform();
        // one wave for each unknown, so that it stretches the columns of the Jacobian and leaves the determinant its sign
        let waves = [(); 2].map(|()| [between(0.0, 0.4), between(1.0, 4.0), between(0.0, 6.0)]);
        let [a, b, c] = [(); 3].map(|()| between(0.5, 2.0));
        // far enough from singular for a method of the first order to end within its iterations; the fourth makes the determinant positive by some factor, or negative with the targets exchanged
        let d = b * c / a * between(2.0, 4.0);
        let slopes =
            if between(0.0, 1.0) < 0.5 { Matrix2::new(a, b, c, d) } else { Matrix2::new(c, d, a, b) };
        Self { slopes, waves }
    }

    fn point(random: &mut SplitMix64) -> [f64; 2] {
        BOUNDS.map(|[a, b]| a + (b - a) * random.uniform())
    }
}

impl Targets for Rising {
    fn bounds(&self) -> &[[f64; 2]] {
        &BOUNDS
    }

    fn at(&self, p: &[f64]) -> Result<Vec<f64>> {
        let wave = |k: usize| {
            let [w, f, s] = self.waves[k];
            p[k] + w * (f * p[k] + s).sin() / f
        };
        // not additive: the sum is bent, which keeps all signs
        let bent = |x: f64| x + 0.3 * x.sin();
        Ok((self.slopes * Vector2::new(wave(0), wave(1))).iter().map(|x| bent(*x)).collect())
    }

    fn jacobian(&self, p: &[f64]) -> Result<DMatrix<f64>> {
        let wave = |k: usize| {
            let [w, f, s] = self.waves[k];
            (p[k] + w * (f * p[k] + s).sin() / f, 1.0 + w * (f * p[k] + s).cos())
        };
        let (values, rates) = ([wave(0).0, wave(1).0], [wave(0).1, wave(1).1]);
        let sums = self.slopes * Vector2::from(values);
        Ok(DMatrix::from_fn(2, 2, |i, k| (1.0 + 0.3 * sums[i].cos()) * self.slopes[(i, k)] * rates[k]))
    }
}

/// What the theorems ask for holds at any point.
fn sign_of_determinant(map: &Rising, random: &mut SplitMix64) -> f64 {
    let signs: Vec<f64> = (0..20)
        .map(|_| {
            let jacobian = map.jacobian(&Rising::point(random)).unwrap();
            assert!(jacobian.iter().all(|d| *d > 0.0));
            jacobian.determinant().signum()
        })
        .collect();
    assert!(signs.iter().all(|s| *s == signs[0]));
    signs[0]
}

/// Section B.10: with (3.39) and (3.40) the gradient method finds the solution from every start. So does what the tail uses in
/// its place.
#[test]
fn the_gradient_method_finds_two_that_rise_with_both_from_everywhere() {
    let mut random = SplitMix64::new(21);
    let mut seen = [0; 2];
    for _ in 0..40 {
        let map = Rising::draw(&mut random);
        seen[usize::from(sign_of_determinant(&map, &mut random) > 0.0)] += 1;
        for _ in 0..5 {
            let (p, start) = (Rising::point(&mut random), Rising::point(&mut random));
            let to = Goal { values: map.at(&p).unwrap(), sizes: vec![1.0; 2], tolerance: 1e-8 };
            assert_found(local(&map, &to, Method::Gradient, &start), &p, 1e-6);
            assert_found(nested(&map, &to, &Nesting::plain(2), Some(&Tail { sign: 1.0 })), &p, 1e-6);
        }
    }
    assert!(seen.iter().all(|n| *n > 10), "{seen:?}");
}

/// Section B.12: the same is injective, with the inverse's derivatives (B.13), which have one sign each.
#[test]
fn two_that_rise_with_both_have_one_answer() {
    let mut random = SplitMix64::new(22);
    for _ in 0..40 {
        let map = Rising::draw(&mut random);
        let sign = sign_of_determinant(&map, &mut random);
        let sampled = Sampled::new(&map, Sampling::default()).unwrap();
        let answer = injective(&sampled, &[0, 1], &[0, 1]).unwrap();
        assert!(!matches!(answer, Injectivity::Refuted { .. }), "{answer:?}");
        // the answers at a goal and at one beside it
        let p = Rising::point(&mut random).map(|x| 0.8 * x);
        let jacobian = map.jacobian(&p).unwrap();
        let determinant = jacobian[(0, 0)] * jacobian[(1, 1)] - jacobian[(0, 1)] * jacobian[(1, 0)];
        let printed = Matrix2::new(jacobian[(1, 1)], -jacobian[(0, 1)], -jacobian[(1, 0)], jacobian[(0, 0)])
            / determinant;
        let step = 1e-4;
        for k in 0..2 {
            let solve = |by: f64| {
                let mut values = map.at(&p).unwrap();
                values[k] += by;
                let to = Goal { values, sizes: vec![1.0; 2], tolerance: 1e-12 };
                nested(&map, &to, &Nesting::plain(2), Some(&Tail { sign: 1.0 })).unwrap().parameters
            };
            let (less, more) = (solve(-step), solve(step));
            for j in 0..2 {
                let slope = (more[j] - less[j]) / (2.0 * step);
                let expected = printed[(j, k)];
                assert!((slope - expected).abs() < 1e-3 * printed.norm(), "{slope} instead of {expected}");
                assert_eq!(slope.signum(), if j == k { sign } else { -sign });
            }
        }
    }
    // with a determinant that changes its sign there are two answers (B.6)
    let sampled = twofold();
    let sampled = Sampled::new(&sampled, Sampling::default()).unwrap();
    assert!(matches!(injective(&sampled, &[0, 1], &[0, 1]).unwrap(), Injectivity::Refuted { .. }));
}

/// Convex in each unknown and not in both (on section 3.6): the Hessian has the eigenvalues -1 and 5, so that a point can be
/// least along each axis and not least at all.
#[test]
fn convex_in_each_is_not_convex_in_all() {
    let f = |p: &[f64]| p[0] * p[0] + p[1] * p[1] - 3.0 * p[0] * p[1];
    /// Its gradient, of which differences make the Hessian.
    struct Gradient;

    impl Targets for Gradient {
        fn bounds(&self) -> &[[f64; 2]] {
            &BOUNDS
        }

        fn at(&self, p: &[f64]) -> Result<Vec<f64>> {
            Ok(vec![2.0 * p[0] - 3.0 * p[1], 2.0 * p[1] - 3.0 * p[0]])
        }
    }

    let hessian = Gradient.jacobian(&[0.2, -0.3]).unwrap();
    let mut values: Vec<f64> = hessian.symmetric_eigen().eigenvalues.iter().copied().collect();
    values.sort_by(f64::total_cmp);
    assert_near(&values, &[-1.0, 5.0], 1e-6);
    for step in [-0.5, 0.5] {
        assert!(f(&[step, 0.0]) > f(&[0.0, 0.0]) && f(&[0.0, step]) > f(&[0.0, 0.0]));
        assert!(f(&[step, step]) < f(&[0.0, 0.0]));
    }
}

/// Fig. 3.9: the distance to a goal is convex along a curve of targets up to its centre of curvature. Beyond it, descent runs
/// away from what is nearest on the other side.
#[test]
fn convexity_of_the_distance_ends_at_the_centre_of_curvature() {
    // the curve is a quarter of a circle about (0, 0) to each side of (1, 0), a little thick
    let ring = Example {
        bounds: vec![[-1.5, 1.5], [1.0, 1.01]],
        values: |p| vec![p[1] * p[0].cos(), p[1] * p[0].sin()],
        slopes: |p| vec![-p[1] * p[0].sin(), p[0].cos(), p[1] * p[0].cos(), p[0].sin()],
    };
    let second_difference = |goal: f64| {
        let distance = |angle: f64| {
            let z = ring.at(&[angle, 1.0]).unwrap();
            0.5 * ((z[0] - goal).powi(2) + z[1].powi(2))
        };
        (distance(0.01) - 2.0 * distance(0.0) + distance(-0.01)) / 1e-4
    };
    // goal times radius, in closed form
    for goal in [0.5, -0.5] {
        assert!((second_difference(goal) - goal).abs() < 1e-4);
    }
    let end_of = |goal: f64, start: f64| {
        let to = Goal { values: vec![goal, 0.0], sizes: vec![1.0; 2], tolerance: 1e-10 };
        match local(&ring, &to, Method::Gradient, &[start, 1.0]) {
            Err(Unsolved::Stalled { at, stall: Stall::Boundary, .. }) => at[0],
            other => panic!("{other:?}"),
        }
    };
    for start in [-0.3, 0.3] {
        assert!(end_of(0.5, start).abs() < 1e-5);
        assert!((end_of(-0.5, start) - 1.5 * f64::signum(start)).abs() < 1e-9);
    }
}
