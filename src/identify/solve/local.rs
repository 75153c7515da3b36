//! Newton's method and the gradient method, with step control and projection on the bounds (text section 2.3, B.5).

use super::outcome::{Solution, Stall, Unsolved};
use super::targets::{Goal, Problem, Targets};
use nalgebra::DVector;

/// Samples of a step, even and over the orders of magnitude below its first thousandth, before the best of them is refined.
const EVEN: usize = 64;
const ORDERS: usize = 40;
/// A component that is by so small a share of the range away from a bound is on it.
const ON_BOUND: f64 = 1e-13;
/// Iterations of Newton's method; the gradient method is of the first order and takes thousands.
const NEWTON_STEPS: usize = 100;
const GRADIENT_STEPS: usize = 20_000;
/// A decrease by a smaller share is none.
const DECREASE: f64 = 1e-13;

/// Which direction is gone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// J⁻¹ (Z0 - Z), and no farther than that. Guarantee: none in general; a convex distance, or a start that is near enough.
    Newton,
    /// The same, but where the projected direction leads uphill on a bound a step of this length is taken all the same
    /// (inner step control). Guarantee: for a chain of single unknowns, each monotone in its own, the direction never
    /// vanishes away from the solution; that the iteration converges is not proven.
    ChainNewton {
        /// Length of such a step.
        longest: f64,
    },
    /// -Jᵀ (Z - Z0). Guarantee: for two unknowns whose targets rise with both (3.39) and whose determinant has one sign
    /// (3.40), the solution is found from every start, if there is one.
    Gradient,
}

/// Searches from `start` along one direction after the other, each to its nearest point to the goal.
///
/// The distance counts in units of the goal's sizes, the unknowns in their own.
///
/// # Errors
/// It stalls away from the goal: by Lemma 1 where the Jacobian is singular or on the boundary, if the nearest point on each
/// segment was found. Or the targets cannot be computed.
pub fn local(
    targets: &dyn Targets,
    goal: &Goal,
    method: Method,
    start: &[f64],
) -> Result<Solution, Unsolved> {
    let problem = Problem::new(targets, goal)?;
    let n = problem.len();
    let mut at: Vec<f64> =
        (0..n).map(|k| start[k].clamp(problem.bounds(k)[0], problem.bounds(k)[1])).collect();
    let mut excess = problem.excess(&at)?;
    let steps = if method == Method::Gradient { GRADIENT_STEPS } else { NEWTON_STEPS };
    let stalled = |at: Vec<f64>, excess: &DVector<f64>, stall| {
        Err(Unsolved::Stalled { at, residual: excess.amax(), stall })
    };
    for _ in 0..steps {
        if excess.amax() <= goal.tolerance {
            return Ok(Solution {
                parameters: at,
                residual: excess.amax(),
                evaluations: problem.evaluations(),
            });
        }
        let jacobian = problem.jacobian(&at)?;
        let downhill = -jacobian.tr_mul(&excess);
        let direction = match method {
            Method::Gradient => downhill.clone(),
            _ => match jacobian.lu().solve(&-&excess) {
                Some(direction) if direction.iter().all(|d| d.is_finite()) => direction,
                _ => return stalled(at, &excess, Stall::Singular),
            },
        };
        let on_bound = |k: usize, toward: f64| {
            let [low, high] = problem.bounds(k);
            let margin = ON_BOUND * (high - low);
            (toward < 0.0 && at[k] <= low + margin) || (toward > 0.0 && at[k] >= high - margin)
        };
        let projected = |d: &DVector<f64>| {
            DVector::from_iterator(
                n,
                d.iter().enumerate().map(|(k, d)| if on_bound(k, *d) { 0.0 } else { *d }),
            )
        };
        let (step, descent) = (projected(&direction), projected(&downhill));
        if step.amax() == 0.0 {
            // no direction at all, away from the goal: Jᵀ or J⁻¹ takes it to nothing
            let stall = if direction.amax() == 0.0 { Stall::Singular } else { Stall::Boundary };
            return stalled(at, &excess, stall);
        }
        // up to the first bound
        let to_bound = (0..n).filter(|k| step[*k] != 0.0).map(|k| {
            let [low, high] = problem.bounds(k);
            (if step[k] > 0.0 { high } else { low } - at[k]) / step[k]
        });
        let longest = to_bound.fold(1.0, f64::min);
        let move_by = |t: f64| -> Vec<f64> {
            (0..n).map(|k| (at[k] + t * step[k]).clamp(problem.bounds(k)[0], problem.bounds(k)[1])).collect()
        };
        let on_a_bound = step.iter().zip(&direction).any(|(s, d)| s != d);
        match method {
            Method::ChainNewton { longest: reach } if on_a_bound && step.dot(&descent) <= 0.0 => {
                at = move_by(longest.min(reach / step.norm()));
                excess = problem.excess(&at)?;
                continue;
            }
            _ => {}
        }
        let (t, least) = nearest_on(longest, |t| Ok(problem.excess(&move_by(t))?.norm_squared()))?;
        if least >= (1.0 - DECREASE) * excess.norm_squared() {
            let stall = if on_a_bound { Stall::Boundary } else { Stall::NoDecrease };
            return stalled(at, &excess, stall);
        }
        at = move_by(t);
        excess = problem.excess(&at)?;
    }
    stalled(at, &excess, Stall::Iterations)
}

/// Where a function is least on (0, longest]: the best of many samples, refined by golden sections.
fn nearest_on(longest: f64, value: impl Fn(f64) -> Result<f64, Unsolved>) -> Result<(f64, f64), Unsolved> {
    let even = (1..=EVEN).map(|k| longest * k as f64 / EVEN as f64);
    let orders =
        (0..ORDERS).map(|k| longest / EVEN as f64 * 10f64.powf(-12.0 * (k as f64 + 1.0) / ORDERS as f64));
    let mut places: Vec<f64> = even.chain(orders).collect();
    places.sort_by(f64::total_cmp);
    let values: Vec<f64> = places.iter().map(|t| value(*t)).collect::<Result<_, _>>()?;
    let best = (0..values.len()).min_by(|a, b| values[*a].total_cmp(&values[*b])).unwrap_or(0);
    let ratio = (5f64.sqrt() - 1.0) / 2.0;
    let mut ends = [if best > 0 { places[best - 1] } else { 0.0 }, places[(best + 1).min(places.len() - 1)]];
    let (mut t, mut least) = (places[best], values[best]);
    let inner = |[a, b]: [f64; 2]| [b - ratio * (b - a), a + ratio * (b - a)];
    let mut at = inner(ends);
    let mut values = [value(at[0])?, value(at[1])?];
    for _ in 0..60 {
        for (x, v) in at.iter().zip(values) {
            if v < least {
                (t, least) = (*x, v);
            }
        }
        if values[0] < values[1] {
            ends[1] = at[1];
            at = inner(ends);
            values = [value(at[0])?, values[0]];
        } else {
            ends[0] = at[0];
            at = inner(ends);
            values = [values[1], value(at[1])?];
        }
    }
    Ok((t, least))
}
