//! Fit runs and check runs in turn: what the check runs alone hardly tell from chance is asked of the fit runs, too, by a fit to
//! the check runs.

use super::candidates::Tried;
use super::judge::is_confirmed;
use super::numbers::{LEVEL, MIN_GAIN};
use super::rest::differences;
use super::study::{Fitted, Study};
use crate::fit::side_by_side;
use crate::stats::{product, sign_flip};

/// Iterations of a fit to the check runs, which ends by itself before that as a rule: it has to forget where it began.
const TURNED: usize = 15;

impl Tried {
    /// Whether the runs have gained from it what chance does not make, of so many that were fitted.
    pub fn is_confirmed(&self, tried: usize) -> bool {
        is_confirmed(self.p, self.p_in_turn, tried, self.screened.all_places)
    }
}

/// Fits those to the check runs whose gain there chance makes seldom, but not seldom enough for so many, and looks at what they
/// foretell of the fit runs.
pub(super) fn check_in_turn(study: &Study<'_>, tried: &mut [Tried], current: &Fitted) {
    let count = tried.len();
    let is_open = |t: &Tried| {
        let gains = t.fit_gain > MIN_GAIN && t.check_gain > MIN_GAIN;
        gains && t.refuted.is_none() && t.p <= LEVEL && !t.is_confirmed(count)
    };
    if !tried.iter().any(is_open) {
        return;
    }
    let turned = study.turned();
    let foretold = |fitted: &Fitted| {
        let fitted = turned.fit_roughly(&fitted.model, TURNED, None).ok()?;
        turned.rest(&fitted.model, &turned.check_runs).ok()
    };
    let Some(without) = foretold(current) else { return };
    let of = |t: &Tried| {
        let with = is_open(t).then(|| foretold(&t.fitted))??;
        let units = with.by_channel();
        let p = sign_flip(&differences(&without.in_units(&units), &with.in_units(&units)));
        Some(product(p, t.p))
    };
    let answers = side_by_side(study.bench.threads(), tried, of);
    for (t, answer) in tried.iter_mut().zip(answers) {
        t.p_in_turn = answer.flatten();
    }
}
