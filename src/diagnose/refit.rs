//! The refit: the model's own parameters, fitted from where they are given.

use super::free::Derivatives;
use super::study::{Fitted, Study};
use crate::Result;
use crate::fit::End;

/// Iterations of the fits before the channels have their weights, and of those after, which end by
/// themselves before that as a rule.
pub(super) const FIRST: usize = 8;
pub(super) const FINAL: usize = 25;
/// How often a fit goes on that has used up all of its iterations.
pub(super) const GO_ON: usize = 3;

impl Study<'_> {
    /// The model as it is given, fitted roughly to the fit runs; derivatives may be known where it begins.
    ///
    /// # Errors
    /// A model that cannot be run.
    pub fn fit_nominal(&self, iterations: usize, known: Option<&Derivatives>) -> Result<Fitted> {
        let known = known.map(|known| known.of(self));
        self.fit_roughly(&self.nominal(), iterations, known.as_ref())
    }
}

/// Fits the model's own parameters from where they are given, and weighs the channels by what is left of them. Derivatives where it begins may be
/// known.
pub(super) fn refit(study: &mut Study<'_>, known: Option<&Derivatives>) -> Result<Fitted> {
    let mut base = study.fit_nominal(FIRST, known)?;
    let rest = study.fit_rest(&base)?;
    if study.drop_visible_zeros(&base, &rest) {
        base = study.fit_nominal(FIRST, known)?;
    }
    for iterations in [FIRST, FINAL] {
        let rest = study.fit_rest(&base)?;
        let from = study.weigh_by(&base, &rest);
        base = study.fit_on(&from, iterations)?;
    }
    if base.fit.end == End::Iterations {
        base = from_two_places(study, base)?;
    }
    let rest = study.fit_rest(&base)?;
    // what did not stand out from the errors of a fit on its way may do so at its end
    if study.drop_visible_zeros(&base, &rest) {
        return refit(study, known);
    }
    Ok(base)
}

/// What is better of going on with a fit that has not come to its end and of a new one from where the parameters are given, with derivatives that
/// are computed for each step: a valley in which several parameters go together is long, and has its end elsewhere as a rule.
pub(super) fn from_two_places(study: &mut Study<'_>, base: Fitted) -> Result<Fitted> {
    let mut on = base;
    for _ in 0..GO_ON {
        on = study.fit_on(&on, FINAL)?;
        if on.fit.end != End::Iterations {
            break;
        }
    }
    let anew = study.fit(&study.nominal(), FINAL)?;
    let better = if anew.fit.cost < on.fit.cost { anew } else { on };
    let rest = study.fit_rest(&better)?;
    let from = study.weigh_by(&better, &rest);
    study.fit_on(&from, FINAL)
}
