//! Causes that may be otherwise on one road only.

use super::{Amounts, CHANCE, Change, Errors, Round, SHARE, beyond_by_chance};
use crate::Result;
use serde::Serialize;

/// A cause that was named for one road.
#[derive(Debug, Clone, Serialize)]
pub struct OnRoad {
    /// The group of runs.
    pub group: String,
    /// Its name for programs.
    pub id: &'static str,
    /// Its name for people.
    pub title: &'static str,
    /// What it makes of parameters in these runs.
    pub changes: Vec<Change>,
    /// Share of the squared error that it explains in them.
    pub explains: f64,
    /// How probable it is that they agree so by chance.
    pub chance: f64,
}

impl Round<'_> {
    /// What a cause is in the runs of one road only, of what is left with what was named: an amount of its first change, which does what it does in proportion. Runs
    /// scatter about the amounts of their roads alike.
    pub(super) fn of_roads(&self, cause: usize, left: &Errors) -> Result<Vec<OnRoad>> {
        let Some((probe, does)) = self.probes[cause].first() else { return Ok(Vec::new()) };
        let tells = self.tells(does, left);
        let mut groups: Vec<(&str, Vec<usize>)> = Vec::new();
        for run in self.all() {
            let group = self.part.runs()[run].group.as_str();
            match groups.iter_mut().find(|(own, _)| *own == group) {
                Some((_, runs)) => runs.push(run),
                None => groups.push((group, vec![run])),
            }
        }
        let of_runs = |runs: &[usize]| Amounts::of(&runs.iter().map(|run| tells[*run]).collect::<Vec<_>>());
        let amounts: Vec<Amounts> = groups.iter().map(|(_, runs)| of_runs(runs)).collect();
        let more: f64 = amounts.iter().map(|one| (one.runs - 1.0).max(0.0)).sum();
        let spread = amounts.iter().map(|one| one.apart).sum::<f64>() / more;
        let mut all = Vec::new();
        for ((group, runs), Amounts { mean, weight, runs: told, .. }) in groups.iter().zip(&amounts) {
            let mut after = left.clone();
            for run in runs {
                for (values, does) in after[*run].iter_mut().zip(&does[*run]) {
                    values.iter_mut().zip(does).for_each(|(a, b)| *a -= mean * b);
                }
            }
            let whole =
                |errors: &Errors| runs.iter().map(|run| self.of_run(*run, &errors[*run])).sum::<f64>();
            let explains = 1.0 - whole(&after) / whole(left).max(f64::MIN_POSITIVE);
            let chance = beyond_by_chance(mean.abs(), (spread / weight).sqrt(), more);
            let enough = *told > 1.0 && explains >= SHARE && self.smaller(left, &after);
            if !enough || chance * groups.len() as f64 > CHANCE {
                continue;
            }
            let x: Vec<f64> = probe.iter().map(|p| p * mean).collect();
            let what = &self.part.causes()[cause];
            all.push(OnRoad {
                group: (*group).to_owned(),
                id: what.id,
                title: what.title,
                changes: self.made(cause, &self.bounded(cause, &x))?,
                explains,
                chance,
            });
        }
        Ok(all)
    }
}
