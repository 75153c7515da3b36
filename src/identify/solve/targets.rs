//! Target quantities as functions of as many parameters.

use crate::{Error, Result};
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Relative step of central differences, in units of a parameter's range: what truncation and rounding of a smooth function
/// then leave is about 1e-10 of its change over the range.
const STEP: f64 = 1e-5;

/// Target quantities, each a number that is read from a rig under a condition, as functions of as many parameters in a box
/// (3.8), (3.15). What is known, and what was identified before, is inside.
pub trait Targets {
    /// Least and largest value of each parameter.
    fn bounds(&self) -> &[[f64; 2]];

    /// The target quantities.
    ///
    /// # Errors
    /// They cannot be computed there: the rig does not reach the condition.
    fn at(&self, parameters: &[f64]) -> Result<Vec<f64>>;

    /// Some of them. Those of a group do not depend on the parameters of later groups (3.23), and need not wait for the
    /// others.
    ///
    /// # Errors
    /// As [`at`](Self::at).
    fn some(&self, parameters: &[f64], rows: &[usize]) -> Result<Vec<f64>> {
        let all = self.at(parameters)?;
        Ok(rows.iter().filter_map(|row| all.get(*row).copied()).collect())
    }

    /// Their derivatives: a row for each target, a column for each parameter. By differences within the bounds, if there
    /// is nothing better.
    ///
    /// # Errors
    /// As [`at`](Self::at).
    fn jacobian(&self, parameters: &[f64]) -> Result<DMatrix<f64>> {
        let columns: Vec<DVector<f64>> = (0..parameters.len())
            .map(|k| {
                let [low, high] = self.bounds()[k];
                let step = STEP * (high - low);
                let value = |x: f64| {
                    let mut moved = parameters.to_vec();
                    moved[k] = x.clamp(low, high);
                    self.at(&moved).map(|values| (moved[k], DVector::from_vec(values)))
                };
                let ((below, less), (above, more)) =
                    (value(parameters[k] - step)?, value(parameters[k] + step)?);
                Ok((more - less) / (above - below))
            })
            .collect::<Result<_>>()?;
        Ok(DMatrix::from_columns(&columns))
    }
}

/// Some targets as functions of some parameters, the others being as they are.
pub struct Part<'a> {
    targets: &'a dyn Targets,
    rows: Vec<usize>,
    parameters: Vec<usize>,
    bounds: Vec<[f64; 2]>,
    /// Values of all parameters; those of the part are replaced.
    others: Vec<f64>,
}

impl<'a> Part<'a> {
    /// The targets `rows` as functions of `parameters`, with all other parameters as in `others`.
    pub fn new(targets: &'a dyn Targets, rows: Vec<usize>, parameters: Vec<usize>, others: &[f64]) -> Self {
        let bounds = parameters.iter().filter_map(|k| targets.bounds().get(*k).copied()).collect();
        Self { targets, rows, parameters, bounds, others: others.to_vec() }
    }

    /// The values of all parameters, with these in their places.
    pub fn whole(&self, parameters: &[f64]) -> Vec<f64> {
        let mut all = self.others.clone();
        for (k, value) in self.parameters.iter().zip(parameters) {
            all[*k] = *value;
        }
        all
    }
}

impl Targets for Part<'_> {
    fn bounds(&self) -> &[[f64; 2]] {
        &self.bounds
    }

    fn at(&self, parameters: &[f64]) -> Result<Vec<f64>> {
        self.targets.some(&self.whole(parameters), &self.rows)
    }
}

/// What the targets were measured to be.
#[derive(Debug, Clone, PartialEq)]
pub struct Goal {
    /// The values.
    pub values: Vec<f64>,
    /// What counts as 1 of each when they are compared: its own size, or a range.
    pub sizes: Vec<f64>,
    /// Largest scaled difference at which a target is met.
    pub tolerance: f64,
}

impl Goal {
    /// Values that count by their own size, met to 1e-9.
    pub fn new(values: &[f64]) -> Self {
        let size = |v: &f64| if *v == 0.0 { 1.0 } else { v.abs() };
        Self { values: values.to_vec(), sizes: values.iter().map(size).collect(), tolerance: 1e-9 }
    }

    /// That of a part.
    #[must_use]
    pub fn part(&self, rows: Range<usize>) -> Self {
        Self {
            values: self.values[rows.clone()].to_vec(),
            sizes: self.sizes[rows].to_vec(),
            tolerance: self.tolerance,
        }
    }

    /// By how much these values exceed the goal, scaled.
    pub fn excess(&self, values: &[f64]) -> DVector<f64> {
        let each = values.iter().zip(&self.values).zip(&self.sizes);
        DVector::from_iterator(values.len(), each.map(|((value, goal), size)| (value - goal) / size))
    }

    /// Whether these values meet it.
    pub fn is_met(&self, values: &[f64]) -> bool {
        self.excess(values).iter().all(|e| e.abs() <= self.tolerance)
    }
}

/// Targets that count how often they were asked, refuse what is no number, and have the goal's sizes.
pub(in crate::identify) struct Problem<'a> {
    targets: &'a dyn Targets,
    pub goal: &'a Goal,
    evaluations: std::cell::Cell<usize>,
}

impl<'a> Problem<'a> {
    /// # Errors
    /// Bounds, targets and goal do not have one number.
    pub fn new(targets: &'a dyn Targets, goal: &'a Goal) -> Result<Self> {
        let numbers = [targets.bounds().len(), goal.values.len(), goal.sizes.len()];
        if numbers.iter().any(|n| *n != numbers[0]) {
            return Err(Error::call(format!("{} parameters for {} targets", numbers[0], numbers[1])));
        }
        let wrong =
            targets.bounds().iter().find(|[low, high]| !(low < high && low.is_finite() && high.is_finite()));
        if let Some([low, high]) = wrong {
            return Err(Error::variable(format!("{low} ... {high} is no range to search in")));
        }
        Ok(Self { targets, goal, evaluations: 0.into() })
    }

    pub fn len(&self) -> usize {
        self.goal.values.len()
    }

    pub fn bounds(&self, k: usize) -> [f64; 2] {
        self.targets.bounds()[k]
    }

    pub fn range(&self, k: usize) -> f64 {
        let [low, high] = self.bounds(k);
        high - low
    }

    pub fn middle(&self) -> Vec<f64> {
        self.targets.bounds().iter().map(|[low, high]| 0.5 * (low + high)).collect()
    }

    pub fn evaluations(&self) -> usize {
        self.evaluations.get()
    }

    /// The targets.
    pub fn at(&self, parameters: &[f64]) -> Result<Vec<f64>> {
        self.evaluations.set(self.evaluations.get() + 1);
        let values = self.targets.at(parameters)?;
        if values.len() != self.len() || values.iter().any(|v| !v.is_finite()) {
            return Err(Error::numeric(format!("the target quantities at {parameters:?} are {values:?}")));
        }
        Ok(values)
    }

    /// By how much they exceed the goal, scaled.
    pub fn excess(&self, parameters: &[f64]) -> Result<DVector<f64>> {
        Ok(self.goal.excess(&self.at(parameters)?))
    }

    /// Derivatives of that by the parameters.
    pub fn jacobian(&self, parameters: &[f64]) -> Result<DMatrix<f64>> {
        let mut jacobian = self.targets.jacobian(parameters)?;
        self.evaluations.set(self.evaluations.get() + 2 * parameters.len());
        for (mut row, size) in jacobian.row_iter_mut().zip(&self.goal.sizes) {
            row /= *size;
        }
        if jacobian.iter().all(|d| d.is_finite()) {
            Ok(jacobian)
        } else {
            Err(Error::numeric(format!(
                "the derivatives of the target quantities at {parameters:?} are no numbers"
            )))
        }
    }
}
