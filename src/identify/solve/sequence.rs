//! The overall solver: group after group, by what each of them allows (text section 3.3).

use super::descent::nearest;
use super::local::{Method, local};
use super::nested::{Nesting, nested};
use super::outcome::{Side, Solution, Unsolved};
use super::tail::Tail;
use super::targets::{Goal, Part, Problem, Targets};
use crate::Error;
use std::ops::Range;

/// An inversion in closed form: the parameters of a group from its target quantities and the parameters before it. What it gives is
/// tested like any other answer.
pub type Direct<'a> = dyn Fn(&[f64], &[f64]) -> Result<Vec<f64>, Unsolved> + 'a;

/// How the parameters of a group are found for sure.
pub enum Way<'a> {
    /// In closed form.
    Direct(&'a Direct<'a>),
    /// By bisection, one inside the other; the last two together if there is a tail.
    Nested {
        /// Order and signs.
        nesting: Nesting,
        /// How the last two respond.
        tail: Option<Tail>,
        /// Descent is tried before.
        descends: bool,
    },
    /// By one method from where it begins, with its guarantee.
    Local(Method),
}

/// Parameters that are found together, from as many targets. They stand next to each other, in the same order.
pub struct Group<'a> {
    /// How many.
    pub size: usize,
    /// How they are found where descent does not get there.
    pub way: Way<'a>,
}

impl Group<'_> {
    /// A group of one whose target rises with its parameter.
    pub fn single() -> Self {
        Self { size: 1, way: Way::Nested { nesting: Nesting::plain(1), tail: None, descends: true } }
    }
}

/// What became of a sequence of groups.
#[derive(Debug, Clone, PartialEq)]
pub struct Sequence {
    /// The parameters; of a group that was not solved, the nearest to its targets that was met.
    pub parameters: Vec<f64>,
    /// Largest scaled difference that is left in each group.
    pub residuals: Vec<f64>,
    /// The groups that were not solved, by number, and why; those after the first of them rely on it.
    pub unsolved: Vec<(usize, Unsolved)>,
    /// How often the targets were asked for.
    pub evaluations: usize,
}

/// Solves the groups one after the other, each with the parameters before it as found and those after it as in `start`.
///
/// A group is first tried by descent from `start`, which near an answer is Newton's method: where that meets the targets,
/// injectivity makes it the answer. Only where it does not, the group is solved in its own sure, longer way. With `all_at_once`
/// the whole of what remains is tried before each group.
///
/// Guarantee: that of each group's way, if no target depends on parameters of later groups (3.23).
///
/// # Errors
/// Numbers of parameters, targets and bounds that do not fit each other, or targets that cannot be computed where it ends.
pub fn sequence(
    targets: &dyn Targets,
    goal: &Goal,
    groups: &[Group<'_>],
    start: &[f64],
    all_at_once: bool,
) -> Result<Sequence, Unsolved> {
    let problem = Problem::new(targets, goal)?;
    let n = problem.len();
    let (mut parameters, mut evaluations, mut from) = (start.to_vec(), 0, 0);
    let mut unsolved = Vec::new();
    for (number, group) in groups.iter().enumerate() {
        if all_at_once && let Ok(Some(found)) = descend(targets, goal, from..n, &parameters) {
            parameters.splice(from.., found.parameters);
            evaluations += found.evaluations;
            break;
        }
        let rows = from..from + group.size;
        let found = match &group.way {
            Way::Direct(direct) => {
                direct(&goal.values[rows.clone()], &parameters[..from]).and_then(|given| {
                    let part = part(targets, rows.clone(), &parameters);
                    proven(&part, &goal.part(rows.clone()), &given)
                })
            }
            Way::Nested { nesting, tail, descends } => {
                let found =
                    if *descends { descend(targets, goal, rows.clone(), &parameters) } else { Ok(None) };
                match found {
                    Ok(Some(found)) => Ok(found),
                    _ => {
                        let part = part(targets, rows.clone(), &parameters);
                        nested(&part, &goal.part(rows.clone()), nesting, tail.as_ref())
                    }
                }
            }
            Way::Local(method) => {
                let part = part(targets, rows.clone(), &parameters);
                local(&part, &goal.part(rows.clone()), *method, &parameters[rows.clone()])
            }
        };
        match found {
            Ok(found) => {
                evaluations += found.evaluations;
                parameters.splice(rows.clone(), found.parameters);
            }
            Err(why) => {
                if let Some(nearest) = why.nearest().filter(|at| at.len() == group.size) {
                    parameters.splice(rows.clone(), nearest.iter().copied());
                }
                unsolved.push((number, why.in_whole(from)));
            }
        }
        from = rows.end;
    }
    let excess = problem.excess(&parameters)?;
    evaluations += problem.evaluations();
    let mut from = 0;
    let of = |group: &Group<'_>| {
        from += group.size;
        excess.rows(from - group.size, group.size).amax()
    };
    Ok(Sequence { residuals: groups.iter().map(of).collect(), parameters, unsolved, evaluations })
}

impl Sequence {
    /// The answer, if all groups were solved.
    ///
    /// # Errors
    /// Why the first of them was not.
    pub fn solved(mut self) -> Result<Solution, Unsolved> {
        if !self.unsolved.is_empty() {
            return Err(self.unsolved.remove(0).1);
        }
        let residual = self.residuals.iter().fold(0.0, |a: f64, b| a.max(*b));
        Ok(Solution { parameters: self.parameters, residual, evaluations: self.evaluations })
    }
}

/// How far beyond a bound, as a share of the range, rounding may put what a closed form gives.
const ROUNDING: f64 = 1e-9;

/// What a closed form gives, if it is within the bounds and meets the targets; where a limit that the form counts on is not quite
/// reached, descent from there does the rest.
fn proven(targets: &dyn Targets, goal: &Goal, given: &[f64]) -> Result<Solution, Unsolved> {
    let problem = Problem::new(targets, goal)?;
    let n = problem.len();
    if given.len() != n || given.iter().any(|x| !x.is_finite()) {
        return Err(Unsolved::Failed(Error::numeric(format!(
            "the closed form gives {given:?} for {n} parameters"
        ))));
    }
    let beyond = given.iter().enumerate().find_map(|(k, x)| {
        let ([low, high], margin) = (problem.bounds(k), ROUNDING * problem.range(k));
        match x {
            x if *x < low - margin => Some((k, Side::Below)),
            x if *x > high + margin => Some((k, Side::Above)),
            _ => None,
        }
    });
    let found = nearest(&problem, given)?;
    let residual = found.excess.amax();
    if residual <= goal.tolerance {
        return Ok(Solution { parameters: found.at, residual, evaluations: problem.evaluations() });
    }
    Err(match beyond {
        Some((parameter, side)) => Unsolved::OutOfReach { parameter, side, nearest: found.at, residual },
        None => Unsolved::Contradicted { given: given.to_vec(), at: found.at, residual },
    })
}

fn part<'a>(targets: &'a dyn Targets, rows: Range<usize>, all: &[f64]) -> Part<'a> {
    Part::new(targets, rows.clone().collect(), rows.collect(), all)
}

/// The targets `rows` by descent from what is in `all`, if that meets them.
fn descend(
    targets: &dyn Targets,
    goal: &Goal,
    rows: Range<usize>,
    all: &[f64],
) -> Result<Option<Solution>, Unsolved> {
    let (part, goal) = (part(targets, rows.clone(), all), goal.part(rows.clone()));
    let problem = Problem::new(&part, &goal)?;
    let found = nearest(&problem, &all[rows])?;
    let (residual, evaluations) = (found.excess.amax(), problem.evaluations());
    Ok((residual <= goal.tolerance).then_some(Solution { parameters: found.at, residual, evaluations }))
}
