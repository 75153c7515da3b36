//! Whether targets have one answer: the half-space criterion (3.43), and a search for two.

use super::samples::{Sampled, draw};
use crate::identify::solve::{Goal, Part, Problem, Targets, nearest};
use crate::stats::SplitMix64;
use crate::{Error, Result};
use microlp::{ComparisonOp, OptimizationDirection, Problem as Program, SolveOutcome};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

/// Two points that are less than this share of the box's diagonal apart are not told apart.
const APART: f64 = 0.02;
/// Targets that agree to this share of their ranges are the same.
const SAME: f64 = 1e-9;
/// Pieces of the range of a single parameter in which its target is looked at for a turn.
const PIECES: usize = 32;
/// Rounds of looking for the point that violates a half-space most, and adding it.
const CUTS: usize = 3;
/// More parameters have too many orthants to try all.
const MOST: usize = 12;

/// A margin below this is what rounding leaves of none.
const ROUNDING: f64 = 1e-9;

/// What became of an orthant: the largest number by which all directions of parameters in it move the targets into one
/// half-space, with all of unit length. 0: they do not.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Orthant {
    /// A sign for each parameter; the opposite orthant is the same.
    pub signs: Vec<f64>,
    /// The margin, the least over all draws.
    pub margin: f64,
}

/// What the test says.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Injectivity {
    /// Two points with the same targets: a proof that there is no unique answer.
    Refuted {
        /// Values of all parameters.
        points: [Vec<f64>; 2],
    },
    /// No two were found, but in some orthant the criterion does not hold. It is sufficient, not necessary.
    Open {
        /// All orthants.
        orthants: Vec<Orthant>,
        /// At how many points derivatives were looked at.
        points: usize,
    },
    /// The criterion holds at all points that were tried: evidence, not proof.
    Passed {
        /// All orthants.
        orthants: Vec<Orthant>,
        /// At how many points derivatives were looked at.
        points: usize,
    },
}

/// Tests whether the targets `rows` have one answer for `parameters`, whatever the others are (s1_inj).
///
/// # Errors
/// Their number is not that of the parameters, or too large to try all orthants.
pub fn injective(sampled: &Sampled<'_>, rows: &[usize], parameters: &[usize]) -> Result<Injectivity> {
    let Sampled { targets, sampling, .. } = *sampled;
    let m = parameters.len();
    if rows.len() != m || m == 0 || m > MOST {
        return Err(Error::call(format!(
            "{} targets cannot be tested for one answer of {m} parameters (as many are needed, 1 to {MOST})",
            rows.len()
        )));
    }
    let sizes: Vec<f64> = rows.iter().map(|row| sampled.sizes[*row]).collect();
    let mut random = SplitMix64::new(sampling.seed);
    let signs = |number: usize| (0..m).map(|k| if number >> k & 1 == 1 { -1.0 } else { 1.0 }).collect();
    let mut orthants: Vec<Orthant> =
        (0..1usize << (m - 1)).map(|n| Orthant { signs: signs(n), margin: f64::INFINITY }).collect();
    let mut points = 0;
    for base in &sampled.bases {
        let part = Part::new(targets, rows.to_vec(), parameters.to_vec(), base);
        let turned = if m == 1 { turn(&part, sizes[0], sampling.tolerance) } else { None };
        let found = turned.or_else(|| collision(&part, &sizes, sampling.draws, &mut random));
        if let Some(points) = found {
            return Ok(Injectivity::Refuted { points: points.map(|p| part.whole(&p)) });
        }
        let own: Vec<f64> = parameters.iter().map(|k| base[*k]).collect();
        let cloud = Cloud::new(&part, &sizes, &own, sampling.draws, &mut random);
        if cloud.jacobians.is_empty() {
            continue;
        }
        points += cloud.jacobians.len();
        for orthant in &mut orthants {
            let margin = cloud.margin(&orthant.signs, &mut random)?;
            orthant.margin = orthant.margin.min(margin);
        }
    }
    if points == 0 {
        return Err(Error::numeric("the derivatives of the targets cannot be computed at any draw"));
    }
    let holds = orthants.iter().all(|o| o.margin > 0.0);
    Ok(if holds { Injectivity::Passed { orthants, points } } else { Injectivity::Open { orthants, points } })
}

/// Two points of a box with the same targets.
fn collision(
    part: &Part<'_>,
    sizes: &[f64],
    searches: usize,
    random: &mut SplitMix64,
) -> Option<[Vec<f64>; 2]> {
    let bounds = part.bounds();
    let apart = |a: &[f64], b: &[f64]| {
        let each = a.iter().zip(b).zip(bounds).map(|((a, b), [low, high])| ((a - b) / (high - low)).powi(2));
        (each.sum::<f64>() / bounds.len() as f64).sqrt()
    };
    (0..searches).find_map(|_| {
        let (a, start) = (draw(bounds, random), draw(bounds, random));
        let goal = Goal { values: part.at(&a).ok()?, sizes: sizes.to_vec(), tolerance: SAME };
        let problem = Problem::new(part, &goal).ok()?;
        let found = nearest(&problem, &start).ok()?;
        (found.excess.amax() <= SAME && apart(&a, &found.at) > APART).then_some([a, found.at])
    })
}

/// Two values of a single parameter that give the same target, on both sides of where it turns: a target that does not go one way
/// has them. A change by less than the share `least` of its size is no turn.
fn turn(part: &Part<'_>, size: f64, least: f64) -> Option<[Vec<f64>; 2]> {
    let [low, high] = part.bounds()[0];
    let place = |k: usize| low + (high - low) * k as f64 / PIECES as f64;
    let value = |x: f64| part.at(&[x]).ok()?.first().copied().filter(|v| v.is_finite());
    let values: Vec<Option<f64>> = (0..=PIECES).map(|k| value(place(k))).collect();
    let ends = |k: usize| Some([values[k]?.min(values[k + 1]?), values[k]?.max(values[k + 1]?)]);
    // where a piece has the value, which it has at its ends on both sides of it
    let meets = |k: usize, goal: f64| -> Option<(f64, f64)> {
        let (mut from, mut to) = (place(k), place(k + 1));
        let is_below = values[k]? < goal;
        for _ in 0..60 {
            let middle = 0.5 * (from + to);
            if (value(middle)? < goal) == is_below { from = middle } else { to = middle }
        }
        Some((from, value(from)?))
    };
    // the farther apart, the better
    let pairs = (1..PIECES).rev().flat_map(|apart| (0..PIECES - apart).map(move |k| (k, k + apart)));
    pairs.into_iter().find_map(|(i, j)| {
        let ([a, b], [c, d]) = (ends(i)?, ends(j)?);
        let (from, to) = (a.max(c), b.min(d));
        if to - from <= least * size {
            return None;
        }
        let goal = 0.5 * (from + to);
        let ((x, at_x), (y, at_y)) = (meets(i, goal)?, meets(j, goal)?);
        let same = (at_x - at_y).abs() <= SAME * size && (x - y).abs() > APART * (high - low);
        same.then(|| [vec![x], vec![y]])
    })
}

/// Derivatives at many points, in units of ranges and sizes: what a direction of each parameter does to the targets.
struct Cloud<'a> {
    part: &'a Part<'a>,
    sizes: &'a [f64],
    jacobians: Vec<DMatrix<f64>>,
}

impl<'a> Cloud<'a> {
    fn new(
        part: &'a Part<'a>,
        sizes: &'a [f64],
        base: &[f64],
        draws: usize,
        random: &mut SplitMix64,
    ) -> Self {
        let mut cloud = Self { part, sizes, jacobians: Vec::new() };
        let points = std::iter::once(base.to_vec()).chain((0..draws).map(|_| draw(part.bounds(), random)));
        cloud.jacobians = points.filter_map(|p| cloud.jacobian(&p)).collect();
        cloud
    }

    fn jacobian(&self, point: &[f64]) -> Option<DMatrix<f64>> {
        let mut jacobian = self.part.jacobian(point).ok()?;
        for (mut column, [low, high]) in jacobian.column_iter_mut().zip(self.part.bounds()) {
            column *= high - low;
        }
        for (mut row, size) in jacobian.row_iter_mut().zip(self.sizes) {
            row /= *size;
        }
        jacobian.iter().all(|d| d.is_finite()).then_some(jacobian)
    }

    /// The largest margin of a half-space that all directions of an orthant point into, wherever it was looked.
    fn margin(&self, signs: &[f64], random: &mut SplitMix64) -> Result<f64> {
        let unit = |d: DVector<f64>| {
            let length = d.norm();
            if length > 0.0 { d / length } else { d }
        };
        let into = |jacobian: &DMatrix<f64>| -> Vec<DVector<f64>> {
            (0..signs.len()).map(|k| unit(jacobian.column(k) * signs[k])).collect()
        };
        let mut directions: Vec<DVector<f64>> = self.jacobians.iter().flat_map(&into).collect();
        let worst = |normal: &DVector<f64>, directions: &[DVector<f64>]| {
            directions.iter().map(|d| d.dot(normal)).fold(f64::INFINITY, f64::min)
        };
        loop {
            let normal = half_space(&directions, signs.len())?;
            let margin = worst(&normal, &directions);
            // the best normal is 0 where no half-space takes up all
            if margin < ROUNDING {
                return Ok(0.0);
            }
            if directions.len() >= (self.jacobians.len() + CUTS) * signs.len() {
                return Ok(margin);
            }
            // the point near which the half-space is violated most
            let violates = |point: &[f64]| self.jacobian(point).map(|j| (worst(&normal, &into(&j)), j));
            let Some((least, jacobian)) = self.lowest(violates, random) else { return Ok(margin) };
            if least >= margin {
                return Ok(margin);
            }
            directions.extend(into(&jacobian));
        }
    }

    /// Where a function is least: draws, and steps along each parameter from the best of them, halved where none helps.
    fn lowest<T>(
        &self,
        value: impl Fn(&[f64]) -> Option<(f64, T)>,
        random: &mut SplitMix64,
    ) -> Option<(f64, T)> {
        let bounds = self.part.bounds();
        let tried = (0..2 * bounds.len()).filter_map(|_| {
            let point = draw(bounds, random);
            value(&point).map(|found| (point, found))
        });
        let (mut point, mut best) = tried.min_by(|a, b| a.1.0.total_cmp(&b.1.0))?;
        let mut step = 0.25;
        while step > 0.1 {
            let mut moved = false;
            for k in 0..bounds.len() {
                for side in [-1.0, 1.0] {
                    let [low, high] = bounds[k];
                    let mut trial = point.clone();
                    trial[k] = (trial[k] + side * step * (high - low)).clamp(low, high);
                    if let Some(found) = value(&trial).filter(|found| found.0 < best.0) {
                        (point, best, moved) = (trial, found, true);
                    }
                }
            }
            if !moved {
                step *= 0.5;
            }
        }
        Some(best)
    }
}

/// The normal of the half-space that all directions point into by the most: a linear program.
fn half_space(directions: &[DVector<f64>], size: usize) -> Result<DVector<f64>> {
    let mut program = Program::new(OptimizationDirection::Maximize);
    let normal: Vec<_> = (0..size).map(|_| program.add_var(0.0, (-1.0, 1.0))).collect();
    let margin = program.add_var(1.0, (-(size as f64), size as f64));
    for direction in directions {
        let row = normal.iter().zip(direction.iter()).map(|(a, d)| (*a, *d)).chain([(margin, -1.0)]);
        program.add_constraint(row, ComparisonOp::Ge, 0.0);
    }
    // margin -size and normal 0 are always possible, so that there is an answer
    let outcome =
        program.solve().map_err(|e| Error::numeric(format!("a linear program has no answer: {e}")))?;
    let SolveOutcome::Solution(solution) = outcome else {
        return Err(Error::numeric("a linear program was interrupted"));
    };
    Ok(DVector::from_iterator(size, normal.iter().map(|a| solution[*a])))
}
