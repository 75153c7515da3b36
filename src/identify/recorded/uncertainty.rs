//! How far the parameters of the model may be from what was found.

use super::reduced::{Known, Reduced};
use super::search::{Search, beside};
use crate::identify::plan::Plan;
use crate::identify::readings::Readings;
use crate::identify::registry::Numbers;
use crate::identify::solve::Targets;
use crate::{Error, Result};
use nalgebra::{DMatrix, DVector};

/// A parameter of which more than this share of what it can be is up to what is held is not identified.
const HELD: f64 = 0.5;

/// A parameter of the model that a plan gives a value, and what is known of it.
pub(super) struct Given {
    /// Its name.
    pub name: String,
    /// The group that gives it last.
    pub group: String,
    /// Its value.
    pub value: f64,
    /// Its standard deviation: by what scatters, and by what is held and may be elsewhere.
    pub deviation: f64,
    /// What is held that decides it, among what the plan looks for.
    pub by_held: Option<usize>,
}

impl Search<'_> {
    /// The parameters of the model that a plan gives values.
    pub fn given(
        &self,
        plan: &Plan,
        reduced: &Reduced,
        known: &Known,
        within: &Numbers,
    ) -> Result<Vec<Given>> {
        let whole = self.model(plan)?;
        let sought = whole.sought_values(&self.numbers)?;
        let values = whole.model_values(&sought)?;
        let covariance = self.covariance_of_sought(&whole, &sought, reduced, known, within)?;
        let is_held = held(plan, reduced);
        let held_names = whole.held_names(|name| reduced.drops(name))?;
        let slopes = slopes(&whole, &sought)?;
        let mut all = Vec::new();
        for (name, group) in whole.given()? {
            let by = slopes.iter().map(|change| change.get(&name).copied().unwrap_or(0.0));
            let by = DVector::from_iterator(sought.len(), by);
            // how much of what it can be is up to each
            let shares: Vec<f64> =
                by.iter().zip(whole.bounds()).map(|(b, [low, high])| (b * (high - low)).powi(2)).collect();
            let largest =
                (0..shares.len()).filter(|k| is_held[*k]).max_by(|a, b| shares[*a].total_cmp(&shares[*b]));
            let up_to_held: f64 = (0..shares.len()).filter(|k| is_held[*k]).map(|k| shares[k]).sum();
            let variance = (&covariance * &by).dot(&by);
            if !variance.is_finite() {
                return Err(Error::numeric(format!("how well {name} is known is no number")));
            }
            all.push(Given {
                value: values.get(&name).copied().unwrap_or(f64::NAN),
                deviation: variance.max(0.0).sqrt(),
                by_held: largest
                    .filter(|_| held_names.contains(&name) || up_to_held > HELD * shares.iter().sum::<f64>()),
                name,
                group,
            });
        }
        Ok(all)
    }

    /// Covariance of all that a plan looks for. What is held may be as far away as `within` says, or evenly anywhere in its range;
    /// what is found then moves with it, so that the readings stay what they are.
    pub fn covariance_of_sought(
        &self,
        whole: &Readings<'_>,
        sought: &[f64],
        reduced: &Reduced,
        known: &Known,
        within: &Numbers,
    ) -> Result<DMatrix<f64>> {
        let told = known.variance();
        let told = told.ok_or_else(|| Error::numeric("the readings do not fix the parameters"))?;
        let reads = self.reads(&reduced.plan)?;
        let is_held = held(whole.plan(), reduced);
        let found: Vec<usize> = (0..sought.len()).filter(|k| !is_held[*k]).collect();
        let mut covariance = DMatrix::zeros(sought.len(), sought.len());
        for (row, i) in found.iter().enumerate() {
            for (column, k) in found.iter().enumerate() {
                covariance[(*i, *k)] = told[(row, column)];
            }
        }
        let factor = known.jacobian.clone().lu();
        let names = whole.plan().groups.iter().flat_map(|g| &g.parameters).map(|p| &p.name);
        for (k, name) in names.enumerate().filter(|(k, _)| is_held[*k]) {
            let [low, high] = whole.bounds()[k];
            let half = within.get(name).map_or(0.5 * (high - low), |share| share * sought[k].abs());
            let [(below, less), (above, more)] = beside(whole, sought, k, |numbers| {
                Ok(DVector::from_vec(self.modelled(whole, &reads, numbers)?))
            })?;
            let moved = factor.solve(&((less - more) / (above - below)));
            let moved = moved.ok_or_else(|| Error::numeric("the readings do not fix the parameters"))?;
            let mut by = DVector::zeros(sought.len());
            by[k] = 1.0;
            found.iter().zip(&moved).for_each(|(i, moved)| by[*i] = *moved);
            // the standard deviation of what is even between two ends
            by *= half / 3f64.sqrt();
            covariance += &by * by.transpose();
        }
        Ok(covariance)
    }
}

/// Which of all that a plan looks for is held.
fn held(plan: &Plan, reduced: &Reduced) -> Vec<bool> {
    let names = plan.groups.iter().flat_map(|g| &g.parameters).map(|p| &p.name);
    names.map(|name| reduced.drops(name)).collect()
}

/// For each of what is looked for: derivatives of the model's parameters by it.
fn slopes(whole: &Readings<'_>, sought: &[f64]) -> Result<Vec<Numbers>> {
    let one = |k: usize| {
        let [(below, less), (above, more)] = beside(whole, sought, k, |numbers| Ok(numbers.clone()))?;
        let slope = |(name, value): (String, f64)| {
            let change = value - less.get(&name).copied().unwrap_or(f64::NAN);
            (name, change / (above - below))
        };
        Ok(more.into_iter().map(slope).collect())
    };
    (0..sought.len()).map(one).collect()
}
