//! The last two unknowns of a group at once, and what their nearest point says of the one before (3.42), (B.14).

use super::bracket::Value;
use super::descent::nearest_of;
use super::nested::Search;
use super::outcome::{Stall, Unsolved};
use serde::Serialize;

/// How the last two targets of a group respond to the third-last parameter (3.41). Beside that they rise with both of their
/// own parameters (3.39), whose determinant has one sign (3.40).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Tail {
    /// 1 if the second-last target rises and the last falls with the third-last parameter, -1 if it is the other way round.
    pub sign: f64,
}

/// The last two unknowns for given outer ones, or in which direction the innermost of these has to go.
///
/// The image of the box is bounded by two rising curves. What is nearest to a goal outside of it lies on one of them, with the
/// goal to its upper left or lower right, or in a corner; there is nothing on the other side, so that the third-last
/// parameter has to move the image towards the goal. Beyond a corner no parameter helps: then the outer levels are told as if a
/// target were too large or too small.
pub(super) fn solve(search: &Search<'_>, outer: &[f64]) -> Result<Value<Vec<f64>>, Unsolved> {
    let (problem, nesting) = (search.problem, search.nesting);
    let n = problem.len();
    let [parameters, targets] = [&nesting.parameters[n - 2..], &nesting.targets[n - 2..]];
    // any start leads to the one stationary point; that of the last search is near
    let middle = |k: &usize| problem.bounds(*k).iter().sum::<f64>() / 2.0;
    let last = search.last_tail.borrow().clone();
    let inner = last.unwrap_or_else(|| parameters.iter().map(middle).collect());
    let start = search.point(&[outer, &inner].concat());
    let nearest = nearest_of(problem, parameters, targets, &start)?;
    *search.last_tail.borrow_mut() = Some(parameters.iter().map(|k| nearest.at[*k]).collect());
    let [first, last] = [nearest.excess[0], nearest.excess[1]];
    if nearest.excess.amax() <= problem.goal.tolerance {
        return Ok(Value::At(0.0, parameters.iter().map(|k| nearest.at[*k]).collect()));
    }
    if !nearest.is_stationary {
        // a direction from here would be a guess
        let residual = nearest.excess.amax();
        return Err(Unsolved::Stalled { at: nearest.at, residual, stall: Stall::Iterations });
    }
    let sign = search.tail.map_or(1.0, |tail| tail.sign);
    let smaller = if first * last > 0.0 { first > 0.0 } else { sign * (last - first) < 0.0 };
    Ok(if smaller { Value::Smaller(Vec::new()) } else { Value::Larger(Vec::new()) })
}
