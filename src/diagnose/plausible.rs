//! What the name of an effect allows its parameters to be.

use super::numbers::AT_LITTLE_COST;
use super::rest::Rest;
use super::study::{Fitted, Model, Study};
use super::tables::estimates;
use crate::effect::catalogue::nested::{Nested, Place};

/// Iterations of a fit within what is plausible.
const KEEP: usize = 10;

/// A coefficient of the last effect that its name does not allow.
pub(super) fn implausible(model: &Model) -> Option<String> {
    let (placement, values) = model.effects.last()?;
    placement.effect.parameters.iter().zip(values).zip(&placement.scales).find_map(|((p, v), scale)| {
        let (low, high) = p.plausible;
        let slack = 1e-6 * (high - low).abs();
        (*v < low - slack || *v > high + slack)
            .then(|| format!("{} = {:.3e} is not plausible for this name", p.name, v * scale))
    })
}

/// The fit with the last effect's parameters kept to what its name allows, where they are not and that costs
/// little of what it explains: then chance has led them there, not need.
pub(super) fn plausible(study: &Study<'_>, fitted: &Fitted, current_fit: &Rest) -> Option<Fitted> {
    implausible(&fitted.model)?;
    let mut model = fitted.model.clone();
    let (placement, values) = model.effects.last_mut()?;
    placement.bounded = true;
    for (value, parameter) in values.iter_mut().zip(placement.effect.parameters) {
        let (low, high) = placement.limits(parameter);
        *value = value.clamp(low, high);
    }
    let kept = study.fit_near(&model, KEEP, fitted).ok()?;
    let explained = (current_fit.cost - fitted.fit.cost).max(0.0);
    (kept.fit.cost - fitted.fit.cost < AT_LITTLE_COST * explained).then_some(kept)
}

/// Whether a parameter of the last effect is not known, or may be at an end of where it is looked for, other than that
/// where the effect is off. How runs follow each other says nothing of the effect.
pub(super) fn runs_out(study: &Study<'_>, fitted: &Fitted) -> bool {
    let Some((placement, _)) = fitted.model.effects.last() else { return false };
    let parameters = placement.effect.parameters.iter().zip(&placement.scales);
    estimates(study, fitted).iter().zip(parameters).any(|(estimate, (p, scale))| {
        let (low, high) = placement.limits(p);
        let reaches = |end: f64, reached: Option<bool>| p.off != Some(end) && reached.unwrap_or(true);
        !p.of_session
            && (reaches(low, estimate.low.map(|e| e <= low * scale))
                || reaches(high, estimate.high.map(|e| e >= high * scale)))
    })
}

/// Whether the parameter of the last effect that sets it apart from a simpler one is away from where it does not, beyond its
/// interval.
pub(super) fn sets_apart(study: &Study<'_>, fitted: &Fitted, nested: &Nested) -> bool {
    let Some((placement, _)) = fitted.model.effects.last() else { return false };
    let parameters = placement.effect.parameters.iter().zip(&placement.scales);
    let mut all = estimates(study, fitted).into_iter().zip(parameters);
    let Some((estimate, (parameter, scale))) = all.find(|(e, _)| e.name == nested.parameter) else {
        return false;
    };
    let (Some(low), Some(high)) = (estimate.low, estimate.high) else { return false };
    match nested.place {
        Place::Off => parameter.off.is_some_and(|off| low > off * scale || high < off * scale),
        Place::Low => low > parameter.search.0 * scale,
    }
}
