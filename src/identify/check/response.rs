//! With which signs a group's targets respond: what nested bisection relies on (3.32), (3.39) to (3.41).

use super::samples::{Sampled, draw};
use crate::Result;
use crate::identify::solve::{Nesting, Part, Tail, Targets};
use crate::stats::SplitMix64;
use nalgebra::DMatrix;
use serde::Serialize;

/// Larger groups have too many orders.
const MOST: usize = 4;

/// Signs that were the same at all points that were tried: evidence, not proof.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Response {
    /// An order in which extended bisection may be nested, with its signs.
    pub nesting: Nesting,
    /// Where only the last two together respond as a gradient method needs it: how.
    pub tail: Option<Tail>,
}

/// An order of nesting and its signs, the plain order first; `None` if there is no order with one set of signs.
///
/// The signs come from derivatives: with the determinants D of the trailing blocks of the Jacobian, the target of a level
/// changes with its parameter by D / D' while the later ones are met, and these by what the trailing block then demands.
///
/// # Errors
/// The targets cannot be computed anywhere.
pub fn responds(sampled: &Sampled<'_>, rows: &[usize], parameters: &[usize]) -> Result<Option<Response>> {
    Ok(found(&slopes(sampled, rows, parameters)?, parameters.len()))
}

/// Derivatives of the targets at all draws at which there are any.
pub(super) fn slopes(
    sampled: &Sampled<'_>,
    rows: &[usize],
    parameters: &[usize],
) -> Result<Vec<DMatrix<f64>>> {
    let Sampled { targets, sampling, .. } = *sampled;
    let mut random = SplitMix64::new(sampling.seed);
    let mut jacobians = Vec::new();
    let mut failure = None;
    let draws = (0..sampling.constants * sampling.draws).map(|_| draw(targets.bounds(), &mut random));
    for base in sampled.bases.iter().cloned().chain(draws) {
        let part = Part::new(targets, rows.to_vec(), parameters.to_vec(), &base);
        let at: Vec<f64> = parameters.iter().map(|k| base[*k]).collect();
        match part.jacobian(&at) {
            Ok(jacobian) => jacobians.push(jacobian),
            Err(error) => failure = Some(error),
        }
    }
    match failure {
        Some(error) if jacobians.is_empty() => Err(error),
        _ => Ok(jacobians),
    }
}

/// The first order in which `n` targets with these derivatives have one set of signs.
pub(super) fn found(jacobians: &[DMatrix<f64>], n: usize) -> Option<Response> {
    if n > MOST {
        return None;
    }
    let orders = permutations(n);
    let pairs = orders.iter().flat_map(|parameters| orders.iter().map(move |targets| (parameters, targets)));
    let mut found = pairs.filter_map(|(parameters, targets)| {
        signs(jacobians, parameters, targets, None).or_else(|| {
            let tail = if n < 2 { None } else { tail(jacobians, parameters, targets) };
            signs(jacobians, parameters, targets, Some(tail?))
        })
    });
    found.next()
}

/// Whether targets with these derivatives respond as `stated`, in the order in which they stand.
pub(super) fn responds_as(jacobians: &[DMatrix<f64>], stated: &Response) -> bool {
    let n = stated.nesting.rises.len();
    let plain: Vec<usize> = (0..n).collect();
    let own_tail = stated.tail.as_ref().and_then(|_| tail(jacobians, &plain, &plain));
    if own_tail != stated.tail {
        return false;
    }
    let levels = if own_tail.is_some() { n.saturating_sub(2) } else { n };
    let Some(Response { nesting, .. }) = signs(jacobians, &plain, &plain, own_tail) else { return false };
    let later = |falls: &[Vec<f64>], j: usize| falls[j][j + 1..].to_vec();
    (0..levels).all(|j| {
        nesting.rises[j] == stated.nesting.rises[j]
            && later(&nesting.falls, j) == later(&stated.nesting.falls, j)
    })
}

/// The signs of an order, if all Jacobians have the same; of the levels before the last two, if these are a tail.
fn signs(
    jacobians: &[DMatrix<f64>],
    parameters: &[usize],
    targets: &[usize],
    tail: Option<Tail>,
) -> Option<Response> {
    let n = parameters.len();
    let levels = if tail.is_some() { n - 2 } else { n };
    let mut nesting = Nesting {
        parameters: parameters.to_vec(),
        targets: targets.to_vec(),
        rises: vec![1.0; n],
        falls: vec![vec![1.0; n]; n],
    };
    for (number, jacobian) in jacobians.iter().enumerate() {
        let ordered = jacobian.select_rows(targets).select_columns(parameters);
        let agree = |known: &mut f64, value: f64| {
            if number == 0 {
                *known = value.signum();
            }
            value * *known > 0.0
        };
        for level in 0..levels {
            let rest = n - level - 1;
            let block = ordered.view((level + 1, level + 1), (rest, rest)).clone_owned();
            let column = ordered.view((level + 1, level), (rest, 1)).clone_owned();
            // the later parameters along the curve on which the later targets are met
            let along = if rest > 0 { -(block.lu().solve(&column)?) } else { column };
            let slope = ordered[(level, level)]
                + (0..rest).map(|k| ordered[(level, level + 1 + k)] * along[k]).sum::<f64>();
            if !agree(&mut nesting.rises[level], slope) {
                return None;
            }
            for k in 0..rest {
                if !agree(&mut nesting.falls[level][level + 1 + k], -along[k]) {
                    return None;
                }
            }
        }
    }
    // what is beyond its bounds at two levels has to say one thing to a third
    let falls = &nesting.falls;
    let contradicts = |j: usize, r: usize, t: usize| falls[j][r] * falls[r][t] != falls[j][t];
    let contradictory =
        (0..levels).any(|j| (j + 1..levels).any(|r| (r + 1..n).any(|t| contradicts(j, r, t))));
    (!contradictory).then_some(Response { nesting, tail })
}

/// How the last two targets of an order respond, if they rise with both of their parameters, their determinant has one
/// sign, and the parameter before moves them in opposite directions.
fn tail(jacobians: &[DMatrix<f64>], parameters: &[usize], targets: &[usize]) -> Option<Tail> {
    let n = parameters.len();
    let mut known: Option<(f64, f64)> = None;
    for jacobian in jacobians {
        let ordered = jacobian.select_rows(targets).select_columns(parameters);
        let block = ordered.view((n - 2, n - 2), (2, 2));
        if block.iter().any(|d| *d <= 0.0) {
            return None;
        }
        let determinant = block[(0, 0)] * block[(1, 1)] - block[(0, 1)] * block[(1, 0)];
        let [first, last] =
            if n > 2 { [ordered[(n - 2, n - 3)], ordered[(n - 1, n - 3)]] } else { [1.0, -1.0] };
        if determinant == 0.0 || first * last >= 0.0 {
            return None;
        }
        let signs = (determinant.signum(), first.signum());
        if *known.get_or_insert(signs) != signs {
            return None;
        }
    }
    known.map(|(_, sign)| Tail { sign })
}

/// All orders, the plain one first.
fn permutations(n: usize) -> Vec<Vec<usize>> {
    if n == 0 {
        return vec![Vec::new()];
    }
    let shorter = permutations(n - 1);
    // where the last is put, from the end on
    (0..n)
        .rev()
        .flat_map(|place| {
            shorter.iter().map(move |order| {
                let mut order = order.clone();
                order.insert(place, n - 1);
                order
            })
        })
        .collect()
}
