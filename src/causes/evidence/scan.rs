//! Causes on which decisions of a controller depend: tried value after value.

use super::{Errors, Fitted, Round, beyond_by_chance};
use crate::causes::part::samples_in;
use crate::causes::runs::{Recorded, Use};

/// Steps of a cause that is tried value after value, on each side: up to 6 % of a radius in steps of 0.5 %.
const SCANNED: i32 = 12;
/// Values on each side that count with one that is tried.
const NEIGHBOURS: usize = 2;
/// Between two values that are tried, as a share of the first change.
const STEP: f64 = 0.5;
/// A decision is seen in how a channel changes over this time: valves are open for some 10 to 40 ms \[s\].
const DECISION: f64 = 0.02;

impl Round<'_> {
    /// A cause that is tried value after value. Decisions fall otherwise for reasons as small as a sensor's noise, so that what is left jumps from value to value: each
    /// counts with its neighbours. A controller that is out of step tells nothing while it is, and one that is in step shows a right value by a deep dip: over runs and
    /// channels, what counts is the logarithm of what is left. By how much the value at which least is left changes when a run is left out tells how far runs agree.
    pub(super) fn scanned(&self, cause: usize) -> Option<Fitted> {
        let none = self.part.causes()[cause].scanned?;
        let probe = &self.part.causes()[cause].probes[0];
        // places are counted from no change on
        let at =
            |place: f64| self.bounded(cause, &probe.iter().map(|p| STEP * place * p).collect::<Vec<_>>());
        let runs = self.all();
        let tried: Vec<Errors> = (-SCANNED..=SCANNED)
            .map(|k| self.errors(cause, &at(f64::from(k)), &runs))
            .collect::<Option<_>>()?;
        let left: Vec<Vec<Vec<f64>>> = tried.iter().map(|errors| self.decided(errors)).collect();
        let middle = SCANNED as usize;
        // a run in which the controller decides nothing tells nothing
        let told: Vec<usize> =
            runs.into_iter().filter(|run| left.iter().any(|all| all[*run] != left[middle][*run])).collect();
        let of = |used: Use| -> Vec<usize> {
            told.iter().copied().filter(|run| self.part.runs()[*run].used == used).collect()
        };
        let (fit, check) = (of(Use::Fit), of(Use::Check));
        if fit.is_empty() || check.is_empty() || told.len() < 3 {
            return None;
        }
        let mean = crate::stats::mean_or_zero;
        let around = |k: usize, run: usize, c: usize| {
            let near = k - NEIGHBOURS..k + NEIGHBOURS + 1;
            mean(&left[near].iter().map(|all| all[run][c]).collect::<Vec<_>>()).max(f64::MIN_POSITIVE)
        };
        let channels = self.part.channels().len();
        let of_run = |k: usize, run: usize| {
            mean(
                &(0..channels).map(|c| (around(middle, run, c) / around(k, run, c)).ln()).collect::<Vec<_>>(),
            )
        };
        let falls: Vec<Vec<f64>> = (NEIGHBOURS..tried.len() - NEIGHBOURS)
            .map(|k| (0..self.all().len()).map(|run| of_run(k, run)).collect())
            .collect();
        let fall =
            |k: usize, runs: &[usize]| mean(&runs.iter().map(|run| falls[k][*run]).collect::<Vec<_>>());
        let place_of = |runs: &[usize]| {
            let over: Vec<f64> = (0..falls.len()).map(|k| fall(k, runs)).collect();
            highest(&over) - (middle - NEIGHBOURS) as f64
        };
        let place = place_of(&told);
        let without: Vec<f64> = told
            .iter()
            .map(|out| place_of(&told.iter().copied().filter(|run| run != out).collect::<Vec<_>>()))
            .collect();
        let error = jackknife(&without);
        let beyond = |place: f64| STEP * place.abs() * probe[0].abs() - none;
        let nearest = (place.round() + f64::from(SCANNED)) as usize;
        let share = |runs: &[usize]| 1.0 - (-fall(nearest - NEIGHBOURS, runs)).exp();
        let places = [place_of(&fit), place_of(&check)];
        Some(Fitted {
            cause,
            x: at(place),
            gain: share(&told) * self.whole(),
            explains: [share(&fit), share(&check)],
            chance: beyond_by_chance(beyond(place) / (STEP * probe[0].abs()), error, told.len() as f64 - 1.0),
            enough: places.iter().all(|own| own * place > 0.0 && beyond(*own) > 0.0),
            errors: tried.into_iter().nth(nearest)?,
        })
    }

    /// What each channel in each run does otherwise within the time of a decision, beside what models and sensors are believed to at best: how far it is off adds up what
    /// was decided before.
    fn decided(&self, errors: &Errors) -> Vec<Vec<f64>> {
        let of = |(run, channels): (usize, &Vec<Vec<f64>>)| {
            let Recorded { group, recording, .. } = &self.part.runs()[run];
            let apart = samples_in(&recording.time, DECISION).max(1);
            let one = |(c, values): (usize, &Vec<f64>)| {
                let least = self.least.get(&(group.clone(), c)).copied().unwrap_or(0.0);
                let changes = values.iter().zip(values.iter().skip(apart)).map(|(a, b)| (b - a).powi(2));
                changes.sum::<f64>() + values.len() as f64 * least
            };
            channels.iter().enumerate().map(one).collect()
        };
        errors.iter().enumerate().map(of).collect()
    }
}

/// Where a curve that is known at 0, 1, 2 ... is highest: of the parabola through the highest value and its neighbours.
fn highest(values: &[f64]) -> f64 {
    let best = (0..values.len()).max_by(|a, b| values[*a].total_cmp(&values[*b])).unwrap_or(0);
    if best == 0 || best + 1 >= values.len() {
        return best as f64;
    }
    let [before, at, after] = [values[best - 1], values[best], values[best + 1]];
    let bent = before - 2.0 * at + after;
    if bent < 0.0 { best as f64 + 0.5 * (before - after) / bent } else { best as f64 }
}

/// Standard error of an estimate, of what it is without each of its parts in turn (Quenouille and Tukey).
fn jackknife(without: &[f64]) -> f64 {
    let n = without.len() as f64;
    let mean = crate::stats::mean_or_zero(without);
    (without.iter().map(|v| (v - mean).powi(2)).sum::<f64>() * (n - 1.0) / n).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_highest_where_it_is() {
        let values: Vec<f64> = (0..9).map(|k| 2.0 - (f64::from(k) - 3.3).powi(2)).collect();
        assert!((highest(&values) - 3.3).abs() < 1e-12);
        assert_eq!(highest(&[3.0, 2.0, 1.0]), 0.0);
    }

    /// Of a mean, the jackknife's standard error is the usual one.
    #[test]
    fn of_a_mean_the_error_is_that_of_means() {
        let values = [1.0, 4.0, 2.0, 7.0, 3.5];
        let sum: f64 = values.iter().sum();
        let without: Vec<f64> = values.iter().map(|v| (sum - v) / 4.0).collect();
        let mean = sum / 5.0;
        let usual = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 4.0 / 5.0).sqrt();
        assert!((jackknife(&without) - usual).abs() < 1e-12);
    }
}
