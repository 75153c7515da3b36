//! What recordings fix of a plan's parameters, and the plan without the rest.

use crate::identify::plan::Plan;
use crate::{Error, Result};
use nalgebra::{DMatrix, DVector};

/// An interval of half of this share of a parameter's range to each side fixes nothing.
const OPEN: f64 = 0.5;
/// What rounding may make of a correlation of 1.
const ROUNDING: f64 = 1e-10;

/// A plan less what recordings do not tell.
#[derive(Clone)]
pub(super) struct Reduced {
    /// What is left of it.
    pub plan: Plan,
    /// Numbers of the targets that are left, among those of the whole plan.
    targets: Vec<usize>,
    /// What is not looked for, and why.
    pub dropped: Vec<(String, String)>,
}

impl Reduced {
    pub fn new(plan: &Plan) -> Self {
        let count = plan.groups.iter().map(|g| g.targets.len()).sum();
        Self { plan: plan.clone(), targets: (0..count).collect(), dropped: Vec::new() }
    }

    /// Whether a parameter is not looked for.
    pub fn drops(&self, name: &str) -> bool {
        self.dropped.iter().any(|(dropped, _)| dropped == name)
    }

    /// Group, and place in it, of a number among what is left.
    fn place(&self, number: usize) -> Option<(usize, usize)> {
        let mut from = 0;
        for (g, group) in self.plan.groups.iter().enumerate() {
            if number < from + group.parameters.len() {
                return Some((g, number - from));
            }
            from += group.parameters.len();
        }
        None
    }

    /// Leaves out the group of a target that cannot be read.
    pub fn without_group_of(&mut self, target: usize, why: &str) {
        let Some(place) = self.targets.iter().position(|t| *t == target).and_then(|k| self.place(k)) else {
            return;
        };
        let from: usize = self.plan.groups[..place.0].iter().map(|g| g.targets.len()).sum();
        let group = self.plan.groups.remove(place.0);
        let name = &group.targets[place.1].name;
        for parameter in &group.parameters {
            self.dropped.push((parameter.name.clone(), format!("\"{name}\" cannot be read: {why}")));
        }
        self.targets.drain(from..from + group.targets.len());
    }

    /// There is something left.
    ///
    /// # Errors
    /// Recordings tell nothing: the first reason.
    pub fn has_something(&self) -> Result<()> {
        match self.dropped.first() {
            Some((name, why)) if self.plan.groups.is_empty() => {
                Err(Error::file(format!("these recordings identify nothing: {name}: {why}")))
            }
            _ => Ok(()),
        }
    }

    /// Leaves out parameters that the targets do not fix, each with the target of its group without which the others are fixed
    /// best. Returns whether there were any.
    pub fn drop_open(&mut self, known: &Known) -> bool {
        let (mut known, mut at) = (known.clone(), known.at.clone());
        let mut any = false;
        while let Some((open, half)) = known.most_open() {
            let Some((g, k)) = self.place(open) else { break };
            let first = open - k;
            let size = self.plan.groups[g].parameters.len();
            let mut best: Option<(f64, usize, Known)> = None;
            for target in first..first + size {
                let rest = known.without(open, target);
                let worst = rest.worst(first..first + size - 1);
                if best.as_ref().is_none_or(|(least, ..)| worst < *least) {
                    best = Some((worst, target, rest));
                }
            }
            let Some((_, target, rest)) = best else { break };
            let group = &mut self.plan.groups[g];
            let parameter = group.parameters.remove(k);
            let gone = group.targets.remove(target - first);
            group.inversion = None;
            group.nesting = None;
            if group.transform.is_some() {
                // the place among all that the transform takes
                let free = (0..).filter(|place| !group.fixed.contains_key(place));
                group.fixed.extend(free.clone().nth(k).map(|place| (place, at[open])));
            }
            at.remove(open);
            let [low, high] = parameter.bounds;
            let width = if half.is_finite() {
                format!("{:.0} %", 100.0 * half / (high - low))
            } else {
                "more than all".into()
            };
            self.dropped.push((
                parameter.name,
                format!("ill-conditioned: what was recorded fixes it within {width} of its range to each side; \"{}\" is not used", gone.name),
            ));
            if self.plan.groups[g].parameters.is_empty() {
                self.plan.groups.remove(g);
            }
            self.targets.remove(target);
            known = rest;
            any = true;
        }
        any
    }
}

/// What is known of parameters at a point: how targets, read as recorded, respond, and how sure they are.
#[derive(Clone)]
pub(super) struct Known {
    /// Derivatives of the model's readings (rows) by what is looked for (columns).
    pub jacobian: DMatrix<f64>,
    /// Covariance of the readings.
    pub covariance: DMatrix<f64>,
    /// The values of what is looked for,
    pub at: Vec<f64>,
    /// and their ranges.
    pub ranges: Vec<f64>,
    /// Half an interval has so many standard deviations.
    pub side: f64,
}

impl Known {
    /// Covariance of the parameters, if there is one. Each is known beforehand to within its range, as one standard deviation:
    /// that tells next to nothing where the readings tell something, and keeps what they do not fix finite.
    pub fn variance(&self) -> Option<DMatrix<f64>> {
        let n = self.ranges.len();
        let sizes = DVector::from_fn(n, |i, _| self.covariance[(i, i)].sqrt().max(f64::MIN_POSITIVE));
        let scaled = DMatrix::from_fn(n, n, |i, k| self.jacobian[(i, k)] * self.ranges[k] / sizes[i]);
        let correlation = DMatrix::from_fn(n, n, |i, k| {
            let rounding = if i == k { ROUNDING } else { 0.0 };
            self.covariance[(i, k)] / sizes[i] / sizes[k] + rounding
        });
        let told = correlation.cholesky()?.l().solve_lower_triangular(&scaled)?;
        let information = told.tr_mul(&told) + DMatrix::identity(n, n);
        let variance = information.cholesky()?.inverse();
        Some(DMatrix::from_fn(n, n, |i, k| self.ranges[i] * self.ranges[k] * variance[(i, k)]))
    }

    /// Half intervals of the parameters.
    fn half_widths(&self) -> Vec<f64> {
        match self.variance() {
            Some(variance) => variance.diagonal().iter().map(|v| self.side * v.sqrt()).collect(),
            None => vec![f64::INFINITY; self.ranges.len()],
        }
    }

    /// The parameter that is least fixed, if it is not fixed at all.
    fn most_open(&self) -> Option<(usize, f64)> {
        let half = self.half_widths();
        let share = |k: &usize| half[*k] / self.ranges[*k];
        let worst = (0..half.len()).max_by(|a, b| share(a).total_cmp(&share(b)))?;
        (share(&worst) >= OPEN).then_some((worst, half[worst]))
    }

    /// The largest half interval of some parameters, as a share of their range.
    fn worst(&self, of: std::ops::Range<usize>) -> f64 {
        let half = self.half_widths();
        of.map(|k| half[k] / self.ranges[k]).fold(0.0, f64::max)
    }

    fn without(&self, parameter: usize, target: usize) -> Self {
        let (mut at, mut ranges) = (self.at.clone(), self.ranges.clone());
        at.remove(parameter);
        ranges.remove(parameter);
        Self {
            at,
            jacobian: self.jacobian.clone().remove_row(target).remove_column(parameter),
            covariance: self.covariance.clone().remove_row(target).remove_column(target),
            ranges,
            side: self.side,
        }
    }
}
