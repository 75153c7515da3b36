//! The decision of one round: which candidates count, by what the check runs gain from them; which of those is named, by
//! how likely it makes fit runs and check runs together; and what cannot be told from it.

use super::candidates::Tried;
use super::plausible::{runs_out, sets_apart};
use super::result::{Alternative, Candidate, Finding};
use super::study::{Rest, Study, differences};
use super::subject::Subject;
use super::tables::estimates;
use crate::effect::catalogue::nested;
use crate::effect::{Effect, empirical};
use crate::stats::{bootstrap_shares, mean_or_zero, sign_flip};

/// Probability of chance below which a gain on the check runs counts, for all that were fitted together.
pub(super) const LEVEL: f64 = 0.05;
/// A gain on the check runs or on the fit runs below this share of the squared error is not worth a name.
pub(super) const MIN_GAIN: f64 = 0.01;
/// A rest that an empirical function explains, as a share of what the named effects explain, above which
/// the names are not enough.
pub(super) const LEFT_OVER: f64 = 0.2;
/// A rival is as good if chance makes such a difference with more than this probability.
const TIE: f64 = 0.05;
/// Or if it misses less than this share of what the best one takes away from the check runs: both are then the same to
/// whoever uses them, however surely one is the better.
const CLOSE: f64 = 0.03;
/// The best by all blocks may win in few of the resampled ones; it is not less likely than this.
const LEAST_SHARE: f64 = 0.05;
/// About how often a name without a rival was right in the blind study: 0.97 in seeds 6 to 10 (PROOF.md), and other machines
/// are not easier.
pub(super) const OFTEN_RIGHT: f64 = 0.94;

/// What a round has come to, by the number of the candidate.
pub(super) enum Decision {
    Nothing,
    /// With the numbers of its alternatives, in their order.
    Named(usize, Finding, Vec<usize>),
    Unnamed(usize, Finding),
}

/// The candidates of one round, with what they are compared by.
pub(super) struct Round<'a> {
    study: &'a Study<'a>,
    tried: &'a [Tried],
    /// What the model leaves of the check runs without them, and what it has left without any effect.
    before: &'a Rest,
    base: &'a Rest,
    is_first: bool,
    independent: f64,
    /// Channels are compared in units of what the best candidate leaves of them.
    units: Vec<f64>,
}

impl<'a> Round<'a> {
    pub fn new(
        study: &'a Study<'a>,
        tried: &'a [Tried],
        (before, base): (&'a Rest, &'a Rest),
        is_first: bool,
    ) -> Self {
        let independent = study.independent();
        let mut this = Self { study, tried, before, base, is_first, independent, units: Vec::new() };
        let best = tried.iter().min_by(|a, b| this.score(a).total_cmp(&this.score(b)));
        this.units = best.map_or(Vec::new(), |t| t.fit_rest.by_channel());
        this
    }

    /// Decides, and says of every candidate why it was chosen or not.
    pub fn decide(&self, subject: &Subject, candidates: &mut Vec<Candidate>) -> Decision {
        let chosen = self.chosen();
        let rivals = chosen.map_or(Vec::new(), |chosen| self.rivals(chosen));
        candidates.extend((0..self.tried.len()).map(|i| {
            let t = &self.tried[i];
            Candidate {
                effect: t.placement().effect.id.into(),
                name: t.placement().effect.name.into(),
                family: family(t.placement().effect),
                place: t.placement().place(&subject.interface),
                fit_gain: Some(t.fit_gain),
                check_gain: Some(t.check_gain),
                p: Some(t.p),
                reason: self.reason(i, chosen, &rivals),
            }
        }));
        let Some(chosen) = chosen else { return Decision::Nothing };
        let (finding, others) = self.finding(subject, chosen, &rivals);
        if is_named(&self.tried[chosen]) {
            Decision::Named(chosen, finding, others)
        } else {
            Decision::Unnamed(chosen, finding)
        }
    }

    /// Whether the check runs have gained from an effect what chance does not make, of so many that were tried, and both
    /// sets of runs a share that matters.
    fn counts(&self, t: &Tried) -> bool {
        self.why_not(t).is_none()
    }

    /// Why an effect does not count, if it does not.
    fn why_not(&self, t: &Tried) -> Option<String> {
        let enough = |gain: f64| gain > MIN_GAIN;
        let little = |runs: &str| {
            format!("takes away less than {} % of the error of the {runs} runs", 100.0 * MIN_GAIN)
        };
        match t {
            _ if !t.is_confirmed(self.tried.len()) => {
                Some("no gain on the check runs that chance does not make".into())
            }
            _ if !enough(t.check_gain) => Some(little("check")),
            _ if !enough(t.fit_gain) => Some(little("fit")),
            _ if !visible(self.study, t, self.before) => {
                Some("takes away too little of the error of any one channel".into())
            }
            _ => None,
        }
    }

    /// Counts, and is not refuted as a name.
    fn may_be_named(&self, t: &Tried) -> bool {
        is_named(t) && self.counts(t) && t.refuted.is_none()
    }

    fn price(&self, t: &Tried) -> f64 {
        t.price(self.independent)
    }

    /// The less, the better: simple and bound to one place before manifold and at home anywhere.
    fn score(&self, t: &Tried) -> f64 {
        log_likelihood(errors(t).iter(), self.independent) + self.price(t)
    }

    fn total(&self, rest: &Rest) -> f64 {
        rest.in_units(&self.units).iter().sum()
    }

    /// What a candidate leaves of each block of all runs.
    fn blocks(&self, t: &Tried) -> Vec<f64> {
        [t.fit_rest.in_units(&self.units), t.check_rest.in_units(&self.units)].concat()
    }

    /// The best by score of those that fit.
    fn best(&self, fits: impl Fn(&Tried) -> bool) -> Option<usize> {
        let score = |i: &usize| self.score(&self.tried[*i]);
        (0..self.tried.len()).filter(|i| fits(&self.tried[*i])).min_by(|a, b| score(a).total_cmp(&score(b)))
    }

    /// The number of the candidate that is right, if one is.
    fn chosen(&self) -> Option<usize> {
        let named = self.best(|t| self.may_be_named(t)).map(|n| self.within_its_ranges(n));
        let named = named.map(|n| self.no_more_than_needed(n));
        let unnamed = self.best(|t| !is_named(t) && self.counts(t));
        let chosen = match (named, unnamed) {
            (Some(n), Some(e)) if self.is_clearly_better(&self.tried[e], &self.tried[n]) => e,
            (Some(n), _) => n,
            (None, e) => e?,
        };
        // after a first name a rest that only an empirical function explains, and that is small, is left alone
        let explained_before = self.total(self.base) - self.total(self.before);
        let explained_now = self.total(self.before) - self.total(&self.tried[chosen].check_rest);
        let counts =
            is_named(&self.tried[chosen]) || self.is_first || explained_now > LEFT_OVER * explained_before;
        counts.then_some(chosen)
    }

    /// The candidate itself, or one as good whose parameters do not run to the ends of their ranges: a mode far above
    /// what is sampled is a delay.
    fn within_its_ranges(&self, named: usize) -> usize {
        if !self.runs_out(named) {
            return named;
        }
        let rivals = self.rivals(named).into_iter().filter(|i| !self.runs_out(*i));
        let score = |i: &usize| self.score(&self.tried[*i]);
        rivals.min_by(|a, b| score(a).total_cmp(&score(b))).unwrap_or(named)
    }

    /// The candidate itself, or the simpler one at its place that it is no more than: the parameter that sets it apart is known
    /// to be where it says nothing, or not known.
    fn no_more_than_needed(&self, named: usize) -> usize {
        let (rivals, t) = (self.rivals(named), &self.tried[named]);
        let is_simpler = |i: &usize| self.says_no_more(t, &self.tried[*i]);
        rivals.into_iter().find(is_simpler).unwrap_or(named)
    }

    /// Whether an effect is no more than a simpler one at the same place.
    fn says_no_more(&self, t: &Tried, simple: &Tried) -> bool {
        let (own, other) = (t.placement(), simple.placement());
        own.targets == other.targets
            && nested::simpler(own.effect.id)
                .any(|n| n.simpler == other.effect.id && !sets_apart(self.study, &t.fitted, n))
    }

    fn runs_out(&self, i: usize) -> bool {
        runs_out(self.study, &self.tried[i].fitted)
    }

    /// An empirical function wins where it explains clearly more than any name.
    fn is_clearly_better(&self, empirical: &Tried, named: &Tried) -> bool {
        let explained = self.total(self.before) - self.total(&empirical.check_rest);
        let missed = self.total(&named.check_rest) - self.total(&empirical.check_rest);
        missed > LEFT_OVER * explained
            && sign_flip(&differences(&self.blocks(named), &self.blocks(empirical))) < TIE
    }

    /// Those that these data cannot tell from the chosen one, and that one.
    fn rivals(&self, chosen: usize) -> Vec<usize> {
        let best = &self.tried[chosen];
        if !is_named(best) {
            return vec![chosen];
        }
        let both = |t: &Tried| self.total(&t.fit_rest) + self.total(&t.check_rest);
        let gain = self.total(self.before) - self.total(&best.check_rest);
        let is_as_good = |t: &Tried| {
            let behind = differences(&self.blocks(t), &self.blocks(best));
            sign_flip(&behind) > TIE || both(t) - both(best) < CLOSE * gain
        };
        let may_run_out = self.runs_out(chosen);
        let fits = |i: usize| {
            let t = &self.tried[i];
            self.may_be_named(t) && is_as_good(t) && (may_run_out || !self.runs_out(i))
        };
        // what is no more than the chosen one is no rival of it
        let is_more = |i: usize| !self.says_no_more(&self.tried[i], best);
        (0..self.tried.len()).filter(|i| *i == chosen || (fits(*i) && is_more(*i))).collect()
    }

    fn reason(&self, i: usize, chosen: Option<usize>, rivals: &[usize]) -> String {
        let t = &self.tried[i];
        let scores_better = chosen.is_some_and(|c| self.score(t) < self.score(&self.tried[c]));
        match &t.refuted {
            Some(why) => why.clone(),
            None if chosen == Some(i) => "chosen".into(),
            None if !self.counts(t) => self.why_not(t).unwrap_or_default(),
            None if rivals.contains(&i) => {
                "as good as the one chosen: these recordings do not separate them".into()
            }
            None if scores_better && !is_named(t) => {
                "explains too little more than the one chosen for a function that could be anything".into()
            }
            None if scores_better && self.runs_out(i) => {
                "its parameters run to the ends of their ranges, and the one chosen is hardly worse".into()
            }
            None => "explains less than the one chosen".into(),
        }
    }

    /// What is found, and the numbers of its alternatives in their order.
    fn finding(&self, subject: &Subject, chosen: usize, rivals: &[usize]) -> (Finding, Vec<usize>) {
        let of = |i: &usize| &self.tried[*i];
        let prices: Vec<f64> = rivals.iter().map(|i| self.price(of(i))).collect();
        let errors: Vec<Vec<Vec<f64>>> = rivals.iter().map(|i| errors(of(i))).collect();
        let shares = bootstrap_shares(&errors, |m, drawn| {
            log_likelihood(drawn.iter().copied(), self.independent) + prices[m]
        });
        let t = &self.tried[chosen];
        // the same effect at the same place from a signal that is as good is no rival
        let is_same = |r: &Tried| {
            r.placement().effect.id == t.placement().effect.id
                && r.placement().targets == t.placement().targets
        };
        let (same, mut others): (Vec<_>, Vec<_>) =
            rivals.iter().copied().zip(shares).partition(|(i, _)| is_same(of(i)));
        others.sort_by(|a, b| b.1.total_cmp(&a.1));
        let alternative = |(i, share): &(usize, f64)| Alternative {
            effect: of(i).placement().effect.id.into(),
            family: family(of(i).placement().effect),
            place: of(i).placement().place(&subject.interface),
            confidence: *share,
        };
        let is_named = is_named(t);
        let share: f64 = same.iter().map(|(_, share)| share).sum();
        let finding = Finding {
            effect: if is_named { t.placement().effect.id.into() } else { "unknown".into() },
            name: t.placement().effect.name.into(),
            family: if is_named { family(t.placement().effect) } else { "unknown".into() },
            place: t.placement().place(&subject.interface),
            channels: affected(self.study, subject, t, self.before),
            depends_on: t.placement().depends_on(&subject.interface),
            confidence: OFTEN_RIGHT * if is_named { share.max(LEAST_SHARE) } else { 1.0 },
            parameters: estimates(self.study, &t.fitted),
            alternatives: others.iter().map(alternative).collect(),
            evidence: format!(
                "It takes away {:.0} % of the squared error of the check runs and {:.0} % of that of the fit runs beyond the refit; chance does so with a probability of {:.1e}{}.",
                100.0 * t.check_gain,
                100.0 * t.fit_gain,
                t.p,
                t.p_in_turn.map_or(String::new(), |p| format!(
                    " in the check runs, and of {p:.1e} there and in the fit runs, foretold by a fit to the check runs"
                ))
            ),
        };
        (finding, others.into_iter().map(|(i, _)| i).collect())
    }
}

fn is_named(t: &Tried) -> bool {
    !empirical::is(t.placement().effect)
}

/// What a candidate leaves of each channel in each block of all runs.
fn errors(t: &Tried) -> Vec<Vec<f64>> {
    [&t.fit_rest.blocks[..], &t.check_rest.blocks[..]].concat()
}

/// Minus twice the logarithm of the likelihood of errors of unknown size in each channel.
fn log_likelihood<'a>(blocks: impl Iterator<Item = &'a Vec<f64>>, independent: f64) -> f64 {
    let mut sums: Vec<f64> = Vec::new();
    for block in blocks {
        sums.resize(block.len(), 0.0);
        sums.iter_mut().zip(block).for_each(|(s, e)| *s += e);
    }
    let each = independent / sums.len().max(1) as f64;
    sums.iter().map(|s| each * s.max(f64::MIN_POSITIVE).ln()).sum()
}

fn family(effect: &Effect) -> String {
    serde_json::to_value(effect.family).ok().and_then(|v| v.as_str().map(str::to_owned)).unwrap_or_default()
}

/// True if an effect takes away an error that matters in some channel: a twentieth of the squared error
/// and a thousandth of what the channel moves.
fn visible(study: &Study<'_>, t: &Tried, before: &Rest) -> bool {
    let channels = study.check_runs.first().map_or(0, |r| r.channels.len());
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
        a - b > 0.05 * a && a - b > 1e-6 * spread
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
