//! Whether a registered closed form gives back the parameters that made the targets.

use super::samples::{Sampled, draw};
use crate::Result;
use crate::identify::Readings;
use crate::stats::SplitMix64;
use serde::Serialize;

/// What is farther away than this share of a parameter's range is not what a limit leaves that is not quite reached.
const WRONG: f64 = 1e-3;

/// What became of a closed form at draws.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ClosedForm {
    /// Its name.
    pub name: String,
    /// At how many points it was tried.
    pub points: usize,
    /// By how much it misses a parameter, at most, as a share of the parameter's range.
    pub deviation: f64,
    /// Where it is wrong: values of all parameters, and why it says that there is no answer if it does.
    pub counter_example: Option<(Vec<f64>, Option<String>)>,
}

/// Inverts the targets of a group at draws by its closed form, if it has one.
///
/// # Errors
/// The closed form is not registered.
pub(super) fn closed_form(
    readings: &Readings<'_>,
    sampled: &Sampled<'_>,
    group: usize,
    own: &[usize],
) -> Result<Option<ClosedForm>> {
    let group = &readings.plan().groups[group];
    let Some(inversion) = readings.inversion(group)? else { return Ok(None) };
    let Sampled { targets, sampling, .. } = *sampled;
    let mut random = SplitMix64::new(sampling.seed);
    let draws = (0..sampling.constants * sampling.draws).map(|_| draw(targets.bounds(), &mut random));
    let mut found =
        ClosedForm { name: inversion.name.into(), points: 0, deviation: 0.0, counter_example: None };
    for point in sampled.bases.iter().cloned().chain(draws) {
        let Ok(values) = targets.some(&point, own) else { continue };
        found.points += 1;
        let before = &point[..own.first().copied().unwrap_or(0)];
        match readings.invert(inversion, group, &values, before) {
            Ok(given) => {
                let miss = own.iter().enumerate().map(|(i, k)| {
                    let [low, high] = targets.bounds()[*k];
                    let given = given.get(i).copied().filter(|x| x.is_finite());
                    given.map_or(f64::INFINITY, |given| (given - point[*k]).abs() / (high - low))
                });
                let worst = miss.fold(0.0, f64::max);
                if worst > WRONG && worst > found.deviation {
                    found.counter_example = Some((point, None));
                }
                found.deviation = found.deviation.max(worst);
            }
            Err(why) => found.counter_example = Some((point, Some(why.to_string()))),
        }
    }
    Ok(Some(found))
}
