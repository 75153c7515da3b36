//! From the candidates of one round to evidence for the judge, and from its verdict to what is found.

use super::candidates::Tried;
use super::judge::{Case, Chosen, Evidence, judge};
use super::negligible::resolution;
use super::numbers::{MIN_OF_A_CHANNEL, MIN_OF_ITS_MOTION};
use super::plausible::{runs_out, sets_apart};
use super::rest::Rest;
use super::result::{Alternative, Candidate, Finding};
use super::study::Study;
use super::subject::Subject;
use super::tables::all_estimates;
use crate::effect::catalogue::nested;
use crate::effect::{Effect, empirical};
use crate::stats::mean_or_zero;

/// What a round has come to, by the number of the candidate.
pub(super) enum Decision {
    Nothing,
    Named {
        number: usize,
        finding: Finding,
        /// The numbers of its alternatives, in their order.
        others: Vec<usize>,
        /// The best function without a name that takes the same signals, and what would be said of it.
        function: Option<Box<(usize, Finding)>>,
    },
    Unnamed(usize, Finding),
}

impl Decision {
    /// The candidate that was chosen, by number.
    pub fn chosen(&self) -> Option<usize> {
        match self {
            Self::Nothing => None,
            Self::Named { number, .. } | Self::Unnamed(number, _) => Some(*number),
        }
    }
}

/// The candidates of one round, with what they are compared by.
pub(super) struct Round<'a> {
    pub study: &'a Study<'a>,
    pub tried: &'a [Tried],
    /// What the model leaves of the check runs without them, and what it has left without any effect.
    pub before: &'a Rest,
    pub base: &'a Rest,
    pub is_first: bool,
}

impl Round<'_> {
    /// Decides, and says of every candidate why it was chosen or not.
    pub fn decide(&self, subject: &Subject, candidates: &mut Vec<Candidate>) -> Decision {
        let case = Case {
            evidence: (0..self.tried.len()).map(|i| self.evidence(i)).collect(),
            before: self.before,
            base: self.base,
            is_first: self.is_first,
            independent: self.study.independent(),
        };
        let verdict = judge(&case);
        candidates.extend(self.tried.iter().zip(verdict.reasons).map(|(t, reason)| Candidate {
            effect: t.placement().effect.id.into(),
            name: t.placement().effect.name.into(),
            family: family(t.placement().effect),
            place: t.placement().place(&subject.interface),
            fit_gain: Some(t.fit_gain),
            check_gain: Some(t.check_gain),
            p: Some(t.p),
            reason,
        }));
        let Some(chosen) = verdict.chosen else { return Decision::Nothing };
        let finding = self.finding(subject, &chosen);
        if is_named(&self.tried[chosen.number]) {
            let others = chosen.others.iter().map(|(i, _)| *i).collect();
            let function = verdict.function.map(|f| (f.number, self.finding(subject, &f)));
            let function = function.filter(|(_, f)| f.depends_on == finding.depends_on).map(Box::new);
            Decision::Named { number: chosen.number, finding, others, function }
        } else {
            Decision::Unnamed(chosen.number, finding)
        }
    }

    fn evidence(&self, i: usize) -> Evidence<'_> {
        let t = &self.tried[i];
        let place = |t: &Tried| (t.placement().effect.id, t.placement().targets.clone());
        Evidence {
            is_named: is_named(t),
            what: self.tried.iter().position(|o| place(o) == place(t)).unwrap_or(i),
            price: t.price(self.study.independent()),
            fit: &t.fit_rest,
            check: &t.check_rest,
            fit_gain: t.fit_gain,
            check_gain: t.check_gain,
            is_confirmed: t.is_confirmed(self.tried.len()),
            is_visible: visible(self.study, t, self.before),
            runs_out: runs_out(self.study, &t.fitted),
            no_more_than: (0..self.tried.len()).filter(|o| self.says_no_more(t, &self.tried[*o])).collect(),
            refuted: t.refuted.as_deref(),
        }
    }

    /// Whether an effect is no more than a simpler one at the same place.
    fn says_no_more(&self, t: &Tried, simple: &Tried) -> bool {
        let (own, other) = (t.placement(), simple.placement());
        own.targets == other.targets
            && nested::simpler(own.effect)
                .any(|n| n.is_simpler(other.effect) && !sets_apart(self.study, &t.fitted, n))
    }

    fn finding(&self, subject: &Subject, chosen: &Chosen) -> Finding {
        let t = &self.tried[chosen.number];
        let alternative = |(i, share): &(usize, f64)| {
            let placement = self.tried[*i].placement();
            Alternative {
                effect: placement.effect.id.into(),
                family: family(placement.effect),
                place: placement.place(&subject.interface),
                confidence: *share,
            }
        };
        let is_named = is_named(t);
        Finding {
            effect: if is_named { t.placement().effect.id.into() } else { "unknown".into() },
            name: t.placement().effect.name.into(),
            family: if is_named { family(t.placement().effect) } else { "unknown".into() },
            place: t.placement().place(&subject.interface),
            channels: affected(self.study, subject, t, self.before),
            depends_on: t.placement().depends_on(&subject.interface),
            confidence: chosen.confidence,
            parameters: all_estimates(self.study, &t.fitted).pop().unwrap_or_default(),
            alternatives: chosen.others.iter().map(alternative).collect(),
            evidence: format!(
                "It takes away {:.0} % of the squared error of the check runs and {:.0} % of that of the fit runs beyond the refit; chance does so with a probability of {:.1e}{}.",
                100.0 * t.check_gain,
                100.0 * t.fit_gain,
                t.p,
                t.p_in_turn.map_or(String::new(), |p| format!(
                    " in the check runs, and of {p:.1e} there and in the fit runs, foretold by a fit to the check runs"
                ))
            ),
        }
    }
}

fn is_named(t: &Tried) -> bool {
    !empirical::is(t.placement().effect)
}

fn family(effect: &Effect) -> String {
    serde_json::to_value(effect.family).ok().and_then(|v| v.as_str().map(str::to_owned)).unwrap_or_default()
}

/// True if an effect takes away an error that matters in some channel.
fn visible(study: &Study<'_>, t: &Tried, before: &Rest) -> bool {
    let channels = study.check_runs.first().map_or(0, |r| r.channels.len());
    let samples: usize = study.check_runs.iter().map(|r| r.time.len()).sum();
    (0..channels).any(|c| {
        let (mut a, mut b, mut spread) = (0.0, 0.0, 0.0);
        for ((run, old), new) in study.check_runs.iter().zip(&before.simulated).zip(&t.check_rest.simulated) {
            let values = &run.channels[c].values;
            let mean = mean_or_zero(values);
            for ((m, x), y) in values.iter().zip(&old[c]).zip(&new[c]) {
                a += (x - m).powi(2);
                b += (y - m).powi(2);
                spread += (m - mean).powi(2);
            }
        }
        let least =
            (MIN_OF_ITS_MOTION * spread).max(samples as f64 * resolution(&study.check_runs, c).powi(2));
        a - b > MIN_OF_A_CHANNEL * a && a - b > least
    })
}

/// The channels whose error an effect changes most: all with at least a tenth of the change.
fn affected(study: &Study<'_>, subject: &Subject, t: &Tried, before: &Rest) -> Vec<String> {
    let pairs = before.by_channel().into_iter().zip(t.check_rest.by_channel());
    let change: Vec<f64> = pairs.map(|(before, after)| before - after).collect();
    let most = change.iter().copied().fold(0.0, f64::max);
    let channels = study.check_runs.first().map_or(&[][..], |r| &r.channels[..]);
    let mut order: Vec<usize> = (0..channels.len()).filter(|c| change[*c] > 0.1 * most).collect();
    order.sort_by(|a, b| change[*b].total_cmp(&change[*a]));
    order.iter().map(|c| subject.interface.variables[channels[*c].variable].name.clone()).collect()
}
