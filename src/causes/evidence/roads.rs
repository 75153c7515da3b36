//! Causes that may be otherwise on one road only.

use super::{Amounts, CHANCE, Change, Errors, Fitted, Round, SHARE, at_once, beyond_by_chance, centred};
use crate::Result;
use crate::model::Value;
use serde::Serialize;

/// So often an amount is corrected by what it leaves: 12 % less friction does not do just four times what 3 % do. With two, the level of a simulated road was found to 2 %.
const CORRECTIONS: usize = 2;

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

/// A road on which a change does less than this share, squared, of what it does where it does most hardly shows it: gentle stops do not
/// show a level of friction. What it would be there is something else that is left.
const SHOWN: f64 = 0.1;
/// Two levels of which each is known as well as a friction is, to 3.5 % (three sensors of 2 % each), are different ones where they are further
/// apart than both together.
const APART: f64 = 0.07;

impl Round<'_> {
    /// What a cause is in the runs of one road only, of what is left with what was named: an amount of its first change, which does what it does in proportion. Runs
    /// scatter about the amounts of their roads alike.
    pub(super) fn of_roads(&self, cause: usize, named: Option<&Fitted>) -> Result<Vec<OnRoad>> {
        let Some((_, does)) = self.probes[cause].first() else { return Ok(Vec::new()) };
        let left = named.map_or(&self.base, |best| &best.errors);
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
        let most = amounts.iter().map(|one| one.weight / one.runs).fold(0.0, f64::max);
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
            let shows = weight / told >= SHOWN * most;
            let enough = shows && *told > 1.0 && explains >= SHARE && self.smaller(left, &after);
            if !enough || chance * groups.len() as f64 > CHANCE {
                continue;
            }
            let x = self.of_road(cause, (named, left), runs, *mean)?;
            let changes = self.made(cause, &x)?;
            if !changes.iter().any(|change| is_apart(&change.before, &change.value)) {
                continue;
            }
            let what = &self.part.causes()[cause];
            all.push(OnRoad {
                group: (*group).to_owned(),
                id: what.id,
                title: what.title,
                changes,
                explains,
                chance,
            });
        }
        Ok(all)
    }

    /// Values of the unknowns for the runs of one road: what the first change foretells, and what it foretells of what is left then.
    fn of_road(
        &self,
        cause: usize,
        (named, left): (Option<&Fitted>, &Errors),
        runs: &[usize],
        mean: f64,
    ) -> Result<Vec<f64>> {
        let (probe, does) = &self.probes[cause][0];
        let mut times = mean;
        for _ in 0..CORRECTIONS {
            let x = self.bounded(cause, &probe.iter().map(|p| p * times).collect::<Vec<_>>());
            let mut changes = self.changes(cause, &x);
            changes.extend(named.map(|best| (best.cause, best.x.clone())));
            let mut after = left.clone();
            for (run, errors) in runs
                .iter()
                .zip(at_once(self.jobs, runs, |run| centred(self.part, self.part.errors(*run, &changes))))
            {
                after[*run] = errors?;
            }
            let tells = self.tells(does, &after);
            times += Amounts::of(&runs.iter().map(|run| tells[*run]).collect::<Vec<_>>()).mean;
        }
        Ok(self.bounded(cause, &probe.iter().map(|p| p * times).collect::<Vec<_>>()))
    }
}

/// Whether two levels are different ones.
fn is_apart(before: &Value, value: &Value) -> bool {
    match (before, value) {
        (Value::Real(before), Value::Real(value)) => (value - before).abs() > APART * before.abs(),
        _ => false,
    }
}
