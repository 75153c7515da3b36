//! Two names at one place for what one signal does there are one function of it, unless they say more than that function does.
//!
//! A stop and a clearance of a spring add up to many a characteristic that is neither: each name is then a piece of another law.

use super::candidates::Tried;
use super::numbers::CLOSE;
use super::placement::Placement;
use super::refit::FINAL;
use super::rest::Rest;
use super::result::Finding;
use super::study::{Fitted, Model, Study};
use crate::Result;

/// A name that was given, and what else could be there.
pub(super) struct Law {
    /// Effect and place.
    pub placement: Placement,
    /// The model before it.
    pub before: Model,
    /// The name in words.
    pub name: String,
    /// The best function without a name of the same signals, and the model with it in place of the name.
    pub function: Option<(Finding, Model)>,
}

/// A function without a name that is as good as several names.
pub(super) struct OneFunction {
    /// The number of the first of these names.
    pub first: usize,
    /// What is said of it.
    pub finding: Finding,
    /// The model with it in place of the names, fitted,
    pub fitted: Fitted,
    /// and what that leaves of the check runs.
    pub check: Rest,
    /// What the model before the names leaves of them.
    pub before: Rest,
}

/// The function that a name and an earlier one at the same place are together, if it misses as little of what they explain as a rival that is
/// as good.
///
/// # Errors
/// A model that cannot be run.
pub(super) fn one_function(study: &Study<'_>, laws: &[Law], named: &Tried) -> Result<Option<OneFunction>> {
    let own = named.placement();
    // one motion may be known as a position and as what a velocity sums up to
    let kinds = own.effect.drivers;
    let is_same = |law: &Law| law.placement.targets == own.targets && law.placement.effect.drivers == kinds;
    let Some(first) = laws.iter().position(is_same) else { return Ok(None) };
    let Some((finding, model)) = &laws[first].function else { return Ok(None) };
    // channels have other weights since
    let fitted = study.fit(model, FINAL)?;
    let check = study.rest(&fitted.model, &study.check_runs)?;
    let before = study.rest(&laws[first].before, &study.check_runs)?;
    let without = study.rest(&laws[first].before, &study.fit_runs)?.total + before.total;
    let both = named.fit_rest.total + named.check_rest.total;
    let one = study.fit_rest(&fitted)?.total + check.total;
    if one - both >= CLOSE * (without - both) {
        return Ok(None);
    }
    let finding = Finding {
        evidence: format!(
            "{} Two names at this place, \u{201c}{}\u{201d} and \u{201c}{}\u{201d}, explain no more of the error than this one function.",
            finding.evidence, laws[first].name, own.effect.name
        ),
        ..finding.clone()
    };
    Ok(Some(OneFunction { first, finding, fitted, check, before }))
}
