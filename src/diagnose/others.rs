//! What the other channels of a machine say of one that may be reversed or in another unit: a refit to all of them bends the model towards it.

use super::begin::bent;
use super::free::Derivatives;
use super::hygiene::Fault;
use super::refit::FIRST;
use super::study::{Fitted, Model, Study};
use super::subject::Subject;
use crate::Result;

/// A channel in another unit is off by more than half of what it moves, as twice as large as it should be, if the model is not bent towards it;
/// a refit may take the half of that away.
const ASTRAY: f64 = 0.25;

/// What shows of a channel that is reversed or in another unit beside a model that was refitted to the others; if it does of several, of the
/// one without which the others are met best, because without any other one that channel is still among them. Suspects are channels that the
/// refit to all does not follow, and all where it has bent the model.
pub(super) fn told_by_others(
    study: &Study<'_>,
    subject: &Subject,
    base: &Fitted,
    derivatives: &Derivatives,
    against: impl Fn(&Study<'_>, &Model) -> Result<Vec<Fault>>,
) -> Result<Vec<Fault>> {
    let Some(first) = study.fit_runs.first().filter(|run| run.channels.len() > 1) else {
        return Ok(Vec::new());
    };
    let rest = study.fit_rest(base)?;
    let is_bent = bent(study, &base.model, &study.nominal());
    let (mut least, mut told) = (f64::INFINITY, Vec::new());
    for (number, channel) in first.channels.iter().enumerate() {
        if !is_bent && study.share_left(&rest, number) < ASTRAY {
            continue;
        }
        let others = study.without_channel(number).fit_nominal(FIRST, Some(derivatives));
        let Some(others) = others.ok().filter(|others| others.fit.cost < least) else { continue };
        let name = Some(&subject.interface.variables[channel.variable].name);
        let mut own = against(study, &others.model)?;
        own.retain(|f| f.kind.is_gross() && f.channel.as_ref() == name);
        if !own.is_empty() {
            (least, told) = (others.fit.cost, own);
        }
    }
    Ok(told)
}
