//! Several unknowns, one inside the other: extended bisection (3.35), (3.36).
//!
//! For each trial of the first unknown the others are found so that the later targets are met; then the first target is a
//! rising function of it alone. Where the others cannot meet theirs within the bounds, they say on which side, and the signs
//! in which they respond to the first (3.32) say on which side that one has to go on.
//!
//! Beyond what is printed: a bracket that has become a point ends the search, also within a jump; signs may differ from level to
//! level; ends count as met within a tolerance; what was found is accepted only if it meets all targets.

use super::bracket::{Next, Value};
use super::descent::nearest;
use super::outcome::{Side, Solution, Unsolved};
use super::tail::{self, Tail};
use super::targets::{Goal, Problem, Targets};
use serde::Serialize;
use std::cell::RefCell;

/// Width of the outermost bracket, as a share of the range, at which it counts as a point; that of each inner one is a fifth
/// of the one around it.
const WIDTH: f64 = 1e-12;
const INNER: f64 = 0.2;
/// The narrowest bracket: a few units in the last place.
const NARROWEST: f64 = 1e-15;

/// By so much faster than lately a target is allowed to change on the rest of the way to where it has no number.
const FASTER: f64 = 10.0;

/// So far from a solution at which a target falls, as a share of the range, it is looked for where it rises.
const ASIDE: f64 = 1e-4;

/// In which order a group is nested, and with which signs its targets respond (3.32).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Nesting {
    /// The parameters, the outermost first.
    pub parameters: Vec<usize>,
    /// The targets that belong to them.
    pub targets: Vec<usize>,
    /// Whether a target rises with its parameter while the later ones are met: 1, or falls: -1.
    pub rises: Vec<f64>,
    /// `falls[j][r]` for r > j: whether parameter r falls while parameter j rises and the targets from j + 1 on are met: 1,
    /// or rises: -1. The other entries are never read.
    pub falls: Vec<Vec<f64>>,
}

impl Nesting {
    /// In the order of the parameters and targets, with all targets rising and all later parameters falling.
    pub fn plain(size: usize) -> Self {
        Self {
            parameters: (0..size).collect(),
            targets: (0..size).collect(),
            rises: vec![1.0; size],
            falls: vec![vec![1.0; size]; size],
        }
    }
}

/// A parameter, by its level, that would have to be beyond its bounds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Beyond {
    level: usize,
    side: Side,
}

/// What a level found: the values from it on, or what would have to be beyond its bounds.
pub(super) enum Found {
    At(Vec<f64>),
    Beyond(Vec<Beyond>),
}

/// Solves a group by nested bisection; `tail` solves its last two unknowns at once.
///
/// Guarantee: with targets that are continuous, injective from every level on (3.27), and respond with the signs of `nesting`
/// (3.32) (or, of the last two, as a [`Tail`] demands), the one solution is found wherever it is in the box, in at most
/// (log2(1/width) + 3)^n evaluations. That nothing turns around is checked where values tell, not everywhere.
///
/// # Errors
/// Outside of that guarantee: the goal is out of reach, a target is not monotone, signs contradict each other, or the targets
/// cannot be computed.
pub fn nested(
    targets: &dyn Targets,
    goal: &Goal,
    nesting: &Nesting,
    tail: Option<&Tail>,
) -> Result<Solution, Unsolved> {
    let problem = Problem::new(targets, goal)?;
    let n = problem.len();
    let search = Search { problem: &problem, nesting, tail, last_tail: RefCell::default() };
    let outcome = search.level(0, &[])?;
    let parameters = match &outcome {
        Found::At(values) => search.point(values),
        Found::Beyond(_) => nearest(&problem, &problem.middle())?.at,
    };
    let excess = problem.excess(&parameters)?;
    let residual = excess.amax();
    let solution = Solution { parameters, residual, evaluations: problem.evaluations() };
    match outcome {
        Found::At(values) if residual <= goal.tolerance => match search.wrong_slope(&values)? {
            Some(twice) => Err(twice),
            None => Ok(solution),
        },
        // the level with the largest difference has a jump or is not what it was taken for
        Found::At(_) => {
            let worst = (0..n).find(|j| excess[nesting.targets[*j]].abs() == residual).unwrap_or(0);
            Err(Unsolved::Undecided { parameter: nesting.parameters[worst], at: solution.parameters })
        }
        // it is met after all: the signs are not those that were promised
        Found::Beyond(beyond) if residual <= goal.tolerance => Err(Unsolved::Undecided {
            parameter: nesting.parameters[beyond[0].level],
            at: solution.parameters,
        }),
        Found::Beyond(beyond) => {
            let Beyond { level, side } = beyond[0];
            Err(Unsolved::OutOfReach {
                parameter: nesting.parameters[level],
                side,
                nearest: solution.parameters,
                residual,
            })
        }
    }
}

pub(super) struct Search<'a> {
    pub problem: &'a Problem<'a>,
    pub nesting: &'a Nesting,
    pub tail: Option<&'a Tail>,
    /// Where the last two unknowns ended last.
    pub last_tail: RefCell<Option<Vec<f64>>>,
}

impl Search<'_> {
    fn bounds(&self, level: usize) -> [f64; 2] {
        self.problem.bounds(self.nesting.parameters[level])
    }

    /// The parameters in their own order.
    pub fn point(&self, values: &[f64]) -> Vec<f64> {
        let mut point = vec![0.0; values.len()];
        for (parameter, value) in self.nesting.parameters.iter().zip(values) {
            point[*parameter] = *value;
        }
        point
    }

    /// Finds the values from a level on that meet its target and the later ones.
    fn level(&self, level: usize, outer: &[f64]) -> Result<Found, Unsolved> {
        if self.tail.is_some() && level + 2 == self.problem.len() {
            // two unknowns alone: what a direction would be for is not there
            return match tail::solve(self, outer)? {
                Value::At(_, inner) => Ok(Found::At(inner)),
                Value::Larger(_) => Ok(Found::Beyond(vec![Beyond { level, side: Side::Above }])),
                Value::Smaller(_) => Ok(Found::Beyond(vec![Beyond { level, side: Side::Below }])),
            };
        }
        let bounds = self.bounds(level);
        let range = bounds[1] - bounds[0];
        let width = (WIDTH * INNER.powi(level as i32)).max(NARROWEST) * range;
        let tolerance = self.problem.goal.tolerance;
        let mut ends = bounds;
        let mut values = [self.value(level, outer, ends[0])?, self.value(level, outer, ends[1])?];
        // what has to be beyond which bound, if the ends say so
        let own = |side: Side, mut inner: Vec<Beyond>| {
            inner.insert(0, Beyond { level, side });
            Ok(Found::Beyond(inner))
        };
        // between a value and a direction: the solution would leave the box through the bound that gave the direction
        let flipped = |side: Side, inner: Vec<Beyond>| {
            if inner.is_empty() { own(side, inner) } else { Ok(Found::Beyond(inner)) }
        };
        let found = |end: f64, inner: Vec<f64>| Ok(Found::At([vec![end], inner].concat()));
        match &values[0] {
            Value::Smaller(inner) => return own(Side::Below, inner.clone()),
            Value::At(value, _) if *value > tolerance => return own(Side::Below, Vec::new()),
            Value::At(value, inner) if value.abs() <= tolerance => return found(ends[0], inner.clone()),
            _ => {}
        }
        match &values[1] {
            Value::Larger(inner) => return own(Side::Above, inner.clone()),
            Value::At(value, _) if *value < -tolerance => return own(Side::Above, Vec::new()),
            Value::At(value, inner) if value.abs() <= tolerance => return found(ends[1], inner.clone()),
            _ => {}
        }
        let mut next = Next::new(range, width);
        loop {
            let width = ends[1] - ends[0];
            let is_met = |value: &Value<_>| value.number().is_some_and(|v| v.abs() <= tolerance);
            // a steep target may need more than the width says
            if width <= NARROWEST * range || (width <= next.width && values.iter().any(is_met)) {
                break;
            }
            let x = next.between(ends, [values[0].number(), values[1].number()]);
            if x <= ends[0] || x >= ends[1] {
                break;
            }
            let value = self.value(level, outer, x)?;
            if let Some(number) = value.number() {
                if number == 0.0 {
                    (ends, values[0]) = ([x, x], value);
                    break;
                }
                // a rising function stays between its ends
                let slack = 10.0 * tolerance;
                let beyond =
                    |end: &Value<_>, sign: f64| end.number().is_some_and(|end| sign * (number - end) > slack);
                if beyond(&values[0], -1.0) || beyond(&values[1], 1.0) {
                    return Err(self.twice(level, outer, [ends[0], x, ends[1]]));
                }
            }
            let end = usize::from(match &value {
                Value::At(number, _) => *number > 0.0,
                Value::Larger(_) => false,
                Value::Smaller(_) => true,
            });
            // towards an end without a number nothing can be met any more: the target would have to change faster than it does
            if let (Some(now), Some(before)) = (value.number(), values[end].number())
                && values[1 - end].number().is_none()
            {
                let slope = ((now - before) / (x - ends[end])).abs();
                if now.abs() > tolerance + FASTER * slope * (ends[1 - end] - x).abs() {
                    (ends[end], values[end]) = (x, value);
                    break;
                }
            }
            (ends[end], values[end]) = (x, value);
        }
        let [low, high] = values;
        match (low, high) {
            (Value::At(a, inner), Value::At(b, other)) => {
                if a.abs() <= b.abs() {
                    found(ends[0], inner)
                } else {
                    found(ends[1], other)
                }
            }
            (Value::At(a, inner), Value::Smaller(beyond)) => {
                if a.abs() <= tolerance {
                    found(ends[0], inner)
                } else {
                    flipped(Side::Below, beyond)
                }
            }
            (Value::Larger(beyond), Value::At(b, inner)) => {
                if b.abs() <= tolerance {
                    found(ends[1], inner)
                } else {
                    flipped(Side::Above, beyond)
                }
            }
            // too large on one side and too small on the other, and nothing between
            _ => Err(Unsolved::Undecided {
                parameter: self.nesting.parameters[level],
                at: [outer, &[ends[0]]].concat(),
            }),
        }
    }

    /// The target of a level, rising, over its goal, with the later targets met.
    fn value(&self, level: usize, outer: &[f64], x: f64) -> Result<Value<Vec<f64>>, Unsolved> {
        let Nesting { targets, rises, falls, .. } = self.nesting;
        let outer = [outer, &[x]].concat();
        let mut inner = Vec::new();
        if outer.len() < self.problem.len() {
            if self.tail.is_some() && outer.len() + 2 == self.problem.len() {
                match tail::solve(self, &outer)? {
                    Value::At(_, values) => inner = values,
                    direction => return Ok(direction),
                }
            } else {
                match self.level(level + 1, &outer)? {
                    Found::At(values) => inner = values,
                    Found::Beyond(beyond) => {
                        // below its bound: it has to rise; what falls with this unknown does so if that gets smaller
                        let smaller = |b: &Beyond| (falls[level][b.level] > 0.0) == (b.side == Side::Below);
                        let count = beyond.iter().filter(|b| smaller(b)).count();
                        return if count == beyond.len() {
                            Ok(Value::Smaller(beyond))
                        } else if count == 0 {
                            Ok(Value::Larger(beyond))
                        } else {
                            Err(Unsolved::Undecided { parameter: self.nesting.parameters[level], at: outer })
                        };
                    }
                }
            }
        }
        let point = self.point(&[outer.as_slice(), &inner].concat());
        let excess = self.problem.excess(&point)?;
        Ok(Value::At(rises[level] * excess[targets[level]], inner))
    }

    /// Two solutions where the one that was found is one at which a target falls that should rise: between a bound, where it
    /// is below its goal, and there it then rises through the goal as well.
    fn wrong_slope(&self, values: &[f64]) -> Result<Option<Unsolved>, Unsolved> {
        let Nesting { parameters, targets, rises, .. } = self.nesting;
        let n = values.len();
        let jacobian = self.problem.jacobian(&self.point(values))?;
        let jacobian = jacobian.select_rows(targets).select_columns(parameters);
        let minor = |from: usize| jacobian.view((from, from), (n - from, n - from)).determinant();
        // the levels below are solved as one
        let last = if self.tail.is_some() { n - 2 } else { n };
        let falls = |level: &usize| {
            let inner = if level + 1 < n { minor(level + 1) } else { 1.0 };
            rises[*level] * minor(*level) * inner < 0.0
        };
        let Some(level) = (0..last).find(falls) else { return Ok(None) };
        let [low, high] = self.bounds(level);
        let (outer, x) = (&values[..level], values[level]);
        let aside = ASIDE * (high - low);
        let twice = if x - aside > low {
            self.twice(level, outer, [low, x - aside, x])
        } else {
            self.twice(level, outer, [x, x + aside, high])
        };
        Ok(Some(twice))
    }

    /// Two values of a level's unknown with the same target, around one where it turns.
    fn twice(&self, level: usize, outer: &[f64], [low, turn, high]: [f64; 3]) -> Unsolved {
        let number = |x: f64| self.value(level, outer, x).ok().and_then(|v| v.number());
        let undecided = || Unsolved::Undecided {
            parameter: self.nesting.parameters[level],
            at: [outer, &[turn]].concat(),
        };
        let (Some(a), Some(top), Some(b)) = (number(low), number(turn), number(high)) else {
            return undecided();
        };
        // a value between the turn and the nearer of the ends is taken on both sides of the turn
        let rest = if top > a.max(b) { a.max(b) } else { a.min(b) };
        let goal = 0.5 * (top + rest);
        let meets = |mut from: f64, mut to: f64| {
            // `to` is the turn
            for _ in 0..60 {
                let middle = 0.5 * (from + to);
                let value = number(middle)?;
                if (value > goal) == (top > goal) { to = middle } else { from = middle }
            }
            Some(0.5 * (from + to))
        };
        let whole = |x: f64| match self.value(level, outer, x) {
            Ok(Value::At(_, inner)) => Some(self.point(&[outer, &[x], &inner].concat())),
            _ => None,
        };
        let witnesses = (meets(low, turn).and_then(whole), meets(high, turn).and_then(whole));
        match witnesses {
            (Some(a), Some(b)) => {
                Unsolved::NotUnique { target: self.nesting.targets[level], witnesses: [a, b] }
            }
            _ => undecided(),
        }
    }
}
