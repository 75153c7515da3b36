//! Least squares with bounds: Levenberg and Marquardt's method on differences, with the points of a
//! Jacobian evaluated together, and with Broyden's update of columns that are known nearly enough.

use super::derivatives::{broyden, differentiate};
use super::quadratic::{LEAST_DAMPING, Quadratic, square, variance};
use crate::{Error, Result};
use nalgebra::{DMatrix, DVector};

/// Residuals at many points at once, so that they can be computed side by side.
pub trait Problem {
    /// One vector of residuals per point, all of one length; `None` where the model cannot be run.
    fn residuals(&self, points: &[Vec<f64>]) -> Vec<Option<Vec<f64>>>;

    /// What the residuals at points near another one, which has these `residuals`, differ from those, for derivatives on the way: a
    /// problem that has a cheaper way to tell than by all residuals may take that.
    fn changes(&self, _from: &[f64], residuals: &[f64], points: &[Vec<f64>]) -> Vec<Option<Vec<f64>>> {
        changes(residuals, self.residuals(points))
    }

    /// A variance of the residuals below which they are rounding: unknowns are not known any better for less.
    fn least_variance(&self) -> f64 {
        0.0
    }
}

/// What residuals differ from others.
pub(super) fn changes(from: &[f64], to: Vec<Option<Vec<f64>>>) -> Vec<Option<Vec<f64>>> {
    let change = |to: Vec<f64>| to.iter().zip(from).map(|(a, b)| a - b).collect();
    to.into_iter().map(|to| to.map(change)).collect()
}

/// One unknown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unknown {
    /// Where the search begins.
    pub start: f64,
    /// What is known beforehand: the mean,
    pub mean: f64,
    /// Bounds.
    pub low: f64,
    /// Bounds.
    pub high: f64,
    /// Step of differences.
    pub step: f64,
    /// and the standard deviation; infinite for nothing.
    pub prior: f64,
    /// How far one step may go: what derivatives foretell beyond that is not believed.
    pub reach: f64,
}

impl Unknown {
    /// The step of differences at a place: backwards where the upper bound is nearer than that.
    pub fn step_at(&self, x: f64) -> f64 {
        if x + self.step <= self.high { self.step } else { -self.step }
    }
}

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options<'a> {
    /// Number of Jacobians.
    pub iterations: usize,
    /// Relative decrease of the sum of squares that is not worth another.
    pub tolerance: f64,
    /// How many residuals tell as much as one that is independent of its neighbours: the weight of
    /// data against prior.
    pub redundancy: f64,
    /// Derivatives by the first unknowns, as many as there are columns, from a problem that differs
    /// little: they are updated from step to step instead of computed by differences.
    pub known: Option<&'a DMatrix<f64>>,
    /// Derivatives that were computed once are updated, too, until they lead nowhere.
    pub update: bool,
    /// Where known or updated derivatives lead hardly any farther, or nowhere, the fit does not end before ones that were
    /// computed nearby do neither.
    pub to_the_end: bool,
}

impl Default for Options<'_> {
    fn default() -> Self {
        Self {
            iterations: 12,
            tolerance: 1e-4,
            redundancy: 1.0,
            known: None,
            update: false,
            to_the_end: false,
        }
    }
}

/// Why a fit ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// The last step lowered the sum, but by less than the tolerance: another is not worth it.
    Decrease,
    /// The gradient is as good as zero: no step lowers the sum, and by the derivatives the best one would lower it by
    /// less than the tolerance.
    Gradient,
    /// No step that was tried lowers the sum, though by the derivatives one should. These are wrong, or the model
    /// cannot be run where they lead to.
    Step,
    /// All iterations were used up; or there was nothing to find.
    Iterations,
}

impl End {
    /// Whether more iterations from here would be of no use, if the derivatives were computed and not only updated.
    pub fn is_converged(self) -> bool {
        matches!(self, Self::Decrease | Self::Gradient)
    }
}

/// What came out.
#[derive(Debug, Clone)]
pub struct Fit {
    /// The unknowns.
    pub x: Vec<f64>,
    /// The residuals there.
    pub residuals: Vec<f64>,
    /// Their derivatives: rows as residuals, columns as unknowns; at or one step before the end.
    pub jacobian: DMatrix<f64>,
    /// Sum of squared residuals, without the prior.
    pub cost: f64,
    /// The least variance that residuals of the problem have.
    pub least_variance: f64,
    /// Why the fit ended,
    pub end: End,
    /// with derivatives that were known or updated instead of computed where the last step began: then the end may be
    /// one by wrong derivatives.
    pub updated: bool,
    /// How many Jacobians it took, computed or updated.
    pub iterations: usize,
}

impl Fit {
    /// The unknowns that are at one of their bounds, by number.
    pub fn at_bounds(&self, unknowns: &[Unknown]) -> Vec<usize> {
        let at_one = |i: &usize| self.x[*i] <= unknowns[*i].low || self.x[*i] >= unknowns[*i].high;
        (0..self.x.len().min(unknowns.len())).filter(at_one).collect()
    }

    /// Those of them that would go on if there were no bound, by the derivatives at the end.
    pub fn held_by_bounds(&self, unknowns: &[Unknown]) -> Vec<usize> {
        let residuals = DVector::from_column_slice(&self.residuals);
        let is_held = |i: &usize| {
            let slope = self.jacobian.column(*i).dot(&residuals);
            let (is_low, is_high) = (self.x[*i] <= unknowns[*i].low, self.x[*i] >= unknowns[*i].high);
            is_low && (is_high || slope > 0.0) || is_high && slope < 0.0
        };
        self.at_bounds(unknowns).into_iter().filter(is_held).collect()
    }
}

/// Derivatives that were computed where the sum of squares was larger by no more than this share, and updated since, count as
/// computed: the fit has hardly moved.
const NEARBY: f64 = 0.01;

/// The unknowns with the least sum of squares within their bounds.
///
/// The sum is that of the residuals over their present variance, which is not less than the problem's least, and redundancy, plus what
/// is known beforehand.
///
/// # Errors
/// The model cannot be run at the start.
pub fn least_squares(problem: &dyn Problem, unknowns: &[Unknown], options: Options<'_>) -> Result<Fit> {
    let n = unknowns.len();
    let least_variance = problem.least_variance();
    let mut x: Vec<f64> = unknowns.iter().map(|u| u.start.clamp(u.low, u.high)).collect();
    let first = problem.residuals(std::slice::from_ref(&x)).pop().flatten();
    let mut residuals =
        first.ok_or_else(|| Error::numeric("the model cannot be run with the start values"))?;
    let mut jacobian = DMatrix::zeros(residuals.len(), n);
    let known = options.known.filter(|k| k.nrows() == residuals.len() && k.ncols() <= n);
    // columns that are updated, and whether all of them were computed at this point
    let mut updated = known.map_or(0, DMatrix::ncols);
    let mut exact = updated == 0;
    if let Some(known) = known {
        jacobian.columns_mut(0, updated).copy_from(known);
    }
    let mut damping = 1e-3;
    let (mut end, mut last_exact, mut iterations) = (End::Iterations, exact, 0);
    // the sum of squares where all derivatives were computed last
    let mut computed = f64::INFINITY;
    for iteration in 0..options.iterations {
        (last_exact, iterations) = (exact, iteration + 1);
        let from = if exact { 0 } else { updated };
        differentiate(problem, unknowns, &x, &residuals, &mut jacobian, from);
        if options.update {
            updated = n;
        }
        if n == 0 || iteration + 1 == options.iterations {
            break;
        }
        let cost = square(&residuals);
        if exact {
            computed = cost;
        }
        let variance = variance(&residuals, least_variance, options.redundancy);
        let here = Quadratic::at(&x, &residuals, &jacobian, unknowns, variance);
        let total = here.total;
        // less damping than what was good before, then more and more
        let mut better: Option<(f64, Vec<f64>, Vec<f64>, f64)> = None;
        let factors = [0.1, 1.0, 10.0, 100.0, 1e4, 1e6, 1e8];
        // derivatives that may be wrong are not worth short steps
        for factor in &factors[..if exact { factors.len() } else { 4 }] {
            let tried = f64::clamp(damping * factor, LEAST_DAMPING, 1e9);
            let point = here.step(tried);
            let Some(r) = problem.residuals(std::slice::from_ref(&point)).pop().flatten() else { continue };
            let reached = here.sum(&point, &r);
            let best = better.as_ref().map_or(total, |b| b.3);
            if reached < best {
                better = Some((tried, point, r, reached));
            }
            if better.is_some() {
                break;
            }
        }
        let Some((tried, point, r, reached)) = better else {
            if exact {
                let promised = here.promised(&here.step(0.0));
                end = if promised < options.tolerance * total { End::Gradient } else { End::Step };
                break;
            }
            // what was known leads nowhere
            if !options.to_the_end {
                end = End::Step;
                break;
            }
            exact = true;
            continue;
        };
        let step: Vec<f64> = point.iter().zip(&x).map(|(a, b)| a - b).collect();
        let was_exact = exact;
        if updated > 0 {
            broyden(&mut jacobian, unknowns, &step, &residuals, &r);
            exact = false;
        }
        x = point;
        residuals = r;
        damping = tried;
        if total - reached < options.tolerance * total {
            if was_exact || !options.to_the_end || cost > (1.0 - NEARBY) * computed {
                end = End::Decrease;
                break;
            }
            exact = true;
        }
    }
    let cost = square(&residuals);
    Ok(Fit { x, residuals, jacobian, cost, least_variance, end, updated: !last_exact, iterations })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::settle;

    /// Residuals of an exponential, with a hole where the rate is negative.
    struct Decay {
        data: Vec<f64>,
    }

    fn decay(x: &[f64]) -> Vec<f64> {
        (0..50).map(|i| x[0] * (-x[1] * f64::from(i) * 0.1).exp()).collect()
    }

    impl Problem for Decay {
        fn residuals(&self, points: &[Vec<f64>]) -> Vec<Option<Vec<f64>>> {
            points
                .iter()
                .map(|x| (x[1] > 0.0).then(|| decay(x).iter().zip(&self.data).map(|(a, b)| a - b).collect()))
                .collect()
        }
    }

    fn unknown(start: f64, low: f64, high: f64) -> Unknown {
        let (prior, reach) = (f64::INFINITY, f64::INFINITY);
        Unknown { start, mean: start, low, high, step: 1e-6, prior, reach }
    }

    #[test]
    fn finds_the_truth_from_afar_and_stops_at_bounds() {
        let problem = Decay { data: decay(&[3.0, 0.7]) };
        let free = [unknown(1.0, 0.0, 10.0), unknown(3.0, -1.0, 5.0)];
        let options = Options { iterations: 40, tolerance: 1e-14, ..Options::default() };
        let fit = least_squares(&problem, &free, options).unwrap();
        assert!((fit.x[0] - 3.0).abs() < 1e-6 && (fit.x[1] - 0.7).abs() < 1e-6, "{:?}", fit.x);
        // with a bound the other unknown is the best for that bound: a linear problem
        let bound = [unknown(1.0, 0.0, 10.0), unknown(3.0, 1.0, 5.0)];
        let fit = least_squares(&problem, &bound, options).unwrap();
        let (truth, shape) = (decay(&[3.0, 0.7]), decay(&[1.0, 1.0]));
        let best: f64 = truth.iter().zip(&shape).map(|(a, b)| a * b).sum::<f64>() / square(&shape);
        assert!((fit.x[1] - 1.0).abs() < 1e-9 && (fit.x[0] - best).abs() < 1e-6, "{:?} {best}", fit.x);
    }

    /// Residuals of exp(-a t) + noise, where a is the ratio of both unknowns.
    struct Ratio;

    impl Problem for Ratio {
        fn residuals(&self, points: &[Vec<f64>]) -> Vec<Option<Vec<f64>>> {
            let of = |k: i32, x: &[f64]| {
                let (t, noise) = (3e-3 * f64::from(k), if k % 2 == 0 { 1e-4 } else { -1e-4 });
                (-x[0] / x[1] * t).exp() - (-t).exp() + noise
            };
            points.iter().map(|x| Some((0..1000).map(|k| of(k, x)).collect())).collect()
        }
    }

    #[test]
    fn what_only_a_ratio_tells_is_not_known_by_itself() {
        let one = Unknown { step: 1e-3, prior: 0.3, ..unknown(1.0, 0.1, 10.0) };
        let free = [Unknown { start: 1.2, mean: 1.2, ..one }, Unknown { mean: 1.2, ..one }];
        let fit = least_squares(&Ratio, &free, Options { iterations: 20, ..Options::default() });
        let fit = fit.unwrap();
        // both may be anything that their priors allow, if their ratio is 1: of two with 0.3 each that is 0.3 / sqrt(2)
        let whole = 1.96 * 0.3 / 2.0_f64.sqrt();
        let half = |fit: &Fit| fit.covariance(&free, 1.0).half_width(0);
        assert!(half(&fit) < 0.5 * whole, "{}", half(&fit));
        let settled = settle(&Ratio, &free, fit, 1.0);
        assert!((half(&settled) / whole - 1.0).abs() < 0.02, "{} {whole}", half(&settled));
        // and it is where both are nearest to what was known beforehand
        assert!((settled.x[0] - 1.2).abs() < 0.01 && (settled.x[1] - 1.2).abs() < 0.01, "{:?}", settled.x);
    }

    /// A line of which rounding is all that is left, and what an unknown does to it, too.
    struct Rounding(f64);

    impl Problem for Rounding {
        fn residuals(&self, points: &[Vec<f64>]) -> Vec<Option<Vec<f64>>> {
            let of = |k: i32, x: &[f64]| 1e-12 * (x[0] - 7.0 + f64::from(k % 3));
            points.iter().map(|x| Some((0..300).map(|k| of(k, x)).collect())).collect()
        }

        fn least_variance(&self) -> f64 {
            self.0
        }
    }

    #[test]
    fn rounding_tells_nothing_of_an_unknown() {
        let free = [Unknown { prior: 0.3, step: 1e-3, ..unknown(1.0, -5.0, 5.0) }];
        let fit = |least| least_squares(&Rounding(least), &free, Options::default()).unwrap();
        // taken for noise it leads far away
        assert_eq!(fit(0.0).x, [5.0]);
        let fit = fit(1e-18);
        let half = fit.covariance(&free, 1.0).half_width(0);
        assert!(
            (fit.x[0] - 1.0).abs() < 1e-3 && (half / (1.96 * 0.3) - 1.0).abs() < 1e-3,
            "{:?} {half}",
            fit.x
        );
    }

    #[test]
    fn a_fit_says_why_it_ended() {
        let noise = (0..50).map(|i| if i % 2 == 0 { 0.1 } else { -0.1 });
        let problem = Decay { data: decay(&[3.0, 0.7]).iter().zip(noise).map(|(a, b)| a + b).collect() };
        let free = [unknown(1.0, 0.0, 10.0), unknown(3.0, -1.0, 5.0)];
        let fit = |free: &[Unknown], iterations, tolerance| {
            let options = Options { iterations, tolerance, ..Options::default() };
            least_squares(&problem, free, options).unwrap()
        };
        let found = fit(&free, 40, 1e-4);
        assert_eq!((found.end, found.updated), (End::Decrease, false));
        assert!(found.end.is_converged() && found.at_bounds(&free).is_empty() && found.iterations < 40);
        // two steps are too few
        let early = fit(&free, 3, 1e-4);
        assert_eq!((early.end, early.iterations), (End::Iterations, 3));
        assert!(!early.end.is_converged() && early.cost > 1.01 * found.cost, "{} {}", early.cost, found.cost);
        // one unknown is met by its bound; a fit that begins where this one ended has nothing left to do
        let bound = [unknown(1.0, 0.0, 10.0), unknown(3.0, 1.0, 5.0)];
        let there = fit(&bound, 40, 1e-12);
        assert_eq!((there.at_bounds(&bound), there.held_by_bounds(&bound)), (vec![1], vec![1]));
        // from above, too; and one that is at a bound and would go inwards is not held by it
        let above = [unknown(1.0, 0.0, 10.0), unknown(0.2, 0.0, 0.5)];
        assert_eq!(fit(&above, 40, 1e-12).held_by_bounds(&above), [1]);
        let begun = [unknown(3.0, 3.0, 10.0), unknown(1.5, 0.0, 1.5)];
        let begun = (fit(&begun, 1, 1e-4), begun);
        assert_eq!(begun.0.at_bounds(&begun.1), [0, 1]);
        assert_eq!(begun.0.held_by_bounds(&begun.1), [0_usize; 0]);
        let again = fit(&[unknown(there.x[0], 0.0, 10.0), unknown(1.0, 1.0, 5.0)], 40, 1e-4);
        assert!(again.end.is_converged() && again.iterations == 1, "{:?} {}", again.end, again.iterations);
    }

    #[test]
    fn no_gradient_and_wrong_derivatives_are_told_apart() {
        struct Fixed;
        impl Problem for Fixed {
            fn residuals(&self, points: &[Vec<f64>]) -> Vec<Option<Vec<f64>>> {
                points.iter().map(|_| Some(vec![1.0])).collect()
            }
        }
        assert_eq!(least_squares(&Fixed, &[], Options::default()).unwrap().end, End::Iterations);
        // |x| + 1 has no derivative at its least, and steps of differences say that it falls
        struct Corner;
        impl Problem for Corner {
            fn residuals(&self, points: &[Vec<f64>]) -> Vec<Option<Vec<f64>>> {
                points.iter().map(|x| Some(vec![x[0].abs() + 1.0])).collect()
            }
        }
        let fit = least_squares(&Corner, &[unknown(0.0, -1.0, 1.0)], Options::default()).unwrap();
        assert_eq!((fit.end, fit.x[0]), (End::Step, 0.0));
        assert!(!fit.end.is_converged());
        // x^2 + 1 is as flat there as differences of 1e-6 tell
        struct Bowl;
        impl Problem for Bowl {
            fn residuals(&self, points: &[Vec<f64>]) -> Vec<Option<Vec<f64>>> {
                points.iter().map(|x| Some(vec![x[0] * x[0], 1.0])).collect()
            }
        }
        let fit = least_squares(&Bowl, &[unknown(0.0, -1.0, 1.0)], Options::default()).unwrap();
        assert_eq!((fit.end, fit.updated), (End::Gradient, false));
        // derivatives that are known and wrong lead nowhere, and it is said that none were computed
        let problem = Decay { data: decay(&[3.0, 0.7]) };
        let free = [unknown(2.5, 0.0, 9.0), unknown(0.9, 0.1, 5.0)];
        let near = least_squares(&problem, &free, Options { iterations: 1, ..Options::default() }).unwrap();
        let wrong = -near.jacobian;
        let options = Options { known: Some(&wrong), iterations: 1, ..Options::default() };
        let fit = least_squares(&problem, &free, options).unwrap();
        assert_eq!((fit.end, fit.updated), (End::Iterations, true));
    }

    #[test]
    fn a_jacobian_from_nearby_leads_to_the_same_place() {
        let problem = Decay { data: decay(&[3.0, 0.7]) };
        let free = [unknown(2.5, 0.0, 10.0), unknown(0.9, -1.0, 5.0)];
        let near = least_squares(&problem, &free, Options { iterations: 1, ..Options::default() }).unwrap();
        for columns in 1..=2 {
            let known = near.jacobian.columns(0, columns).into_owned();
            let options =
                Options { iterations: 40, tolerance: 1e-14, known: Some(&known), ..Options::default() };
            let fit = least_squares(&problem, &free, options).unwrap();
            assert!((fit.x[0] - 3.0).abs() < 1e-6 && (fit.x[1] - 0.7).abs() < 1e-6, "{:?}", fit.x);
        }
    }

    #[test]
    fn derivatives_that_are_updated_lead_to_the_same_place_with_fewer_residuals() {
        struct Counted(Decay, std::cell::Cell<usize>);
        impl Problem for Counted {
            fn residuals(&self, points: &[Vec<f64>]) -> Vec<Option<Vec<f64>>> {
                self.1.set(self.1.get() + points.len());
                self.0.residuals(points)
            }
        }
        // twelve unknowns do something, and the last two are those of the exponential
        struct Many(Counted);
        impl Problem for Many {
            fn residuals(&self, points: &[Vec<f64>]) -> Vec<Option<Vec<f64>>> {
                let own: Vec<Vec<f64>> = points.iter().map(|x| x[10..].to_vec()).collect();
                let add = |(r, x): (Option<Vec<f64>>, &Vec<f64>)| {
                    r.map(|r| r.into_iter().chain(x[..10].iter().map(|x| x - 1.0)).collect())
                };
                self.0.residuals(&own).into_iter().zip(points).map(add).collect()
            }
        }
        let fit = |update: bool| {
            let problem = Many(Counted(Decay { data: decay(&[3.0, 0.7]) }, 0.into()));
            let mut free = vec![unknown(0.5, 0.0, 2.0); 10];
            free.extend([unknown(2.0, 0.0, 10.0), unknown(1.2, -1.0, 5.0)]);
            let options = Options { iterations: 40, update, to_the_end: true, ..Options::default() };
            (least_squares(&problem, &free, options).unwrap(), problem.0.1.get())
        };
        let ((computed, many), (updated, few)) = (fit(false), fit(true));
        for found in [&computed, &updated] {
            assert!((found.x[10] - 3.0).abs() < 1e-4 && (found.x[11] - 0.7).abs() < 1e-4, "{:?}", found.x);
        }
        assert!(!updated.updated && few < many, "{few} {many}");
    }

    #[test]
    fn a_wrong_jacobian_does_not_end_a_fit_to_the_end() {
        let problem = Decay { data: decay(&[3.0, 0.7]) };
        let free = [unknown(2.5, 0.0, 10.0), unknown(0.9, -1.0, 5.0)];
        let near = least_squares(&problem, &free, Options { iterations: 1, ..Options::default() }).unwrap();
        // steps are a thousand times too short
        let known = 1e3 * near.jacobian;
        let fit = |to_the_end| {
            let options = Options {
                iterations: 40,
                tolerance: 1e-2,
                to_the_end,
                known: Some(&known),
                ..Options::default()
            };
            least_squares(&problem, &free, options).unwrap().cost
        };
        assert!(fit(false) > 0.9 * near.cost, "{} {}", fit(false), near.cost);
        assert!(fit(true) < 1e-6 * near.cost, "{} {}", fit(true), near.cost);
    }

    #[test]
    fn no_step_goes_beyond_its_reach() {
        struct Watched(Decay, std::cell::RefCell<Vec<f64>>);
        impl Problem for Watched {
            fn residuals(&self, points: &[Vec<f64>]) -> Vec<Option<Vec<f64>>> {
                // steps are tried one at a time, differences all together
                if let [point] = points {
                    self.1.borrow_mut().push(point[0]);
                }
                self.0.residuals(points)
            }
        }
        let problem = Watched(Decay { data: decay(&[3.0, 0.7]) }, Vec::new().into());
        let mut unknowns = [unknown(1.0, 0.0, 10.0), unknown(0.9, -1.0, 5.0)];
        unknowns[0].reach = 0.25;
        let options = Options { iterations: 40, tolerance: 1e-14, ..Options::default() };
        let fit = least_squares(&problem, &unknowns, options).unwrap();
        assert!((fit.x[0] - 3.0).abs() < 1e-6 && (fit.x[1] - 0.7).abs() < 1e-6, "{:?}", fit.x);
        let tried = problem.1.borrow();
        // 1, 1.25, ... 3: a model that is nearly linear in it takes whole steps
        assert!((tried[1] - 1.25).abs() < 1e-9 && tried.len() > 8, "{tried:?}");
        assert!(tried.windows(2).all(|w| w[1] - w[0] < 0.25 + 1e-9), "{tried:?}");
    }
}
