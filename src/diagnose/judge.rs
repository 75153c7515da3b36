//! The judge of one round: from what each candidate leaves of every block of the runs to the one that is right, if one is,
//! and those that cannot be told from it. Numbers in, verdict out: it knows no model and no recording.

use super::numbers::{CLOSE, LEAST_SHARE, LEFT_OVER, LEVEL, MIN_GAIN, OFTEN_RIGHT};
use super::rest::{Rest, differences};
use crate::stats::{bootstrap_shares, sign_flip};

/// What is said of the candidate that is right.
pub(super) const CHOSEN: &str = "chosen";

/// What is known of a candidate.
pub(super) struct Evidence<'a> {
    /// An effect with a name; else a function that could be anything.
    pub is_named: bool,
    /// The same for the same effect at the same place, whatever signal drives it.
    pub what: usize,
    /// What its form costs, in the units of [`log_likelihood`].
    pub price: f64,
    /// What it leaves of the fit runs and of the check runs.
    pub fit: &'a Rest,
    pub check: &'a Rest,
    /// The share of the squared error that it takes away from them.
    pub fit_gain: f64,
    pub check_gain: f64,
    /// Whether chance does not make its gain ([`is_confirmed`]).
    pub is_confirmed: bool,
    /// Whether it takes away what matters in any one channel.
    pub is_visible: bool,
    /// Whether a parameter of it may be at an end of where it was looked for.
    pub runs_out: bool,
    /// The simpler candidates at its place that it is no more than.
    pub no_more_than: Vec<usize>,
    /// Why it may not be named, if so.
    pub refuted: Option<&'a str>,
}

/// What is judged.
pub(super) struct Case<'a> {
    pub evidence: Vec<Evidence<'a>>,
    /// What the model leaves of the check runs without the candidates, and what it left before any effect was found.
    pub before: &'a Rest,
    pub base: &'a Rest,
    /// Whether nothing has been found yet.
    pub is_first: bool,
    /// How many independent samples the runs have.
    pub independent: f64,
}

/// What a round has come to.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Verdict {
    /// The candidate that is right, if one is.
    pub chosen: Option<Chosen>,
    /// The best function without a name, whether or not it is right.
    pub function: Option<Chosen>,
    /// Of every candidate, why it was chosen or not.
    pub reasons: Vec<String>,
}

/// The candidate that is right.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Chosen {
    pub number: usize,
    /// How often such an answer is right.
    pub confidence: f64,
    /// Those that cannot be told from it, with how likely they are, the likeliest first.
    pub others: Vec<(usize, f64)>,
}

/// Whether the runs have gained from a candidate what chance does not make, with the probabilities `p` that chance makes the gain
/// of the check runs, and `p_in_turn` that it makes this and that of the fit runs foretold by a fit to the check runs.
///
/// The check runs chose nothing, so that they have only the effects that were fitted (`tried`) to choose from. The fit runs chose
/// these from all `places`, so that with them the level is shared by all of those, and the check runs have to gain what chance
/// makes less often than the level as well. Both bounds hold for any number of candidates, however they depend on each other
/// (Bonferroni).
pub(super) fn is_confirmed(p: f64, p_in_turn: Option<f64>, tried: usize, places: usize) -> bool {
    let shared = |among: usize| LEVEL / among.max(1) as f64;
    p <= shared(tried) || (p <= LEVEL && p_in_turn.is_some_and(|p| p <= shared(places)))
}

/// Judges a round.
pub(super) fn judge(case: &Case<'_>) -> Verdict {
    let mut round = Round { case, units: Vec::new() };
    let best = case.evidence.iter().min_by(|a, b| round.score(a).total_cmp(&round.score(b)));
    round.units = best.map_or(Vec::new(), |e| e.fit.by_channel());
    let chosen = round.chosen();
    let rivals = chosen.map_or(Vec::new(), |chosen| round.rivals(chosen));
    Verdict {
        reasons: (0..case.evidence.len()).map(|i| round.reason(i, chosen, &rivals)).collect(),
        chosen: chosen.map(|chosen| round.weighed(chosen, &rivals)),
        function: round.function().map(|function| round.weighed(function, &[function])),
    }
}

struct Round<'a> {
    case: &'a Case<'a>,
    /// Channels are compared in units of what the best candidate leaves of them.
    units: Vec<f64>,
}

impl Evidence<'_> {
    /// Why it does not count, if it does not: chance, or too little for anybody.
    fn why_not(&self) -> Option<String> {
        let little = |runs: &str| {
            format!("takes away less than {} % of the error of the {runs} runs", 100.0 * MIN_GAIN)
        };
        match self {
            _ if !self.is_confirmed => Some("no gain on the check runs that chance does not make".into()),
            _ if self.check_gain <= MIN_GAIN => Some(little("check")),
            _ if self.fit_gain <= MIN_GAIN => Some(little("fit")),
            _ if !self.is_visible => Some("takes away too little of the error of any one channel".into()),
            _ => None,
        }
    }

    fn counts(&self) -> bool {
        self.why_not().is_none()
    }

    /// Counts, and is not refuted as a name.
    fn may_be_named(&self) -> bool {
        self.is_named && self.counts() && self.refuted.is_none()
    }

    /// What it leaves of each channel in each block of all runs.
    fn errors(&self) -> Vec<Vec<f64>> {
        [&self.fit.blocks[..], &self.check.blocks[..]].concat()
    }
}

impl Round<'_> {
    fn of(&self, i: usize) -> &Evidence<'_> {
        &self.case.evidence[i]
    }

    fn all(&self) -> std::ops::Range<usize> {
        0..self.case.evidence.len()
    }

    /// The less, the better: simple and bound to one place before manifold and at home anywhere.
    fn score(&self, e: &Evidence<'_>) -> f64 {
        log_likelihood(e.errors().iter(), self.case.independent) + e.price
    }

    fn total(&self, rest: &Rest) -> f64 {
        rest.in_units(&self.units).iter().sum()
    }

    /// What a candidate leaves of each block of all runs.
    fn blocks(&self, e: &Evidence<'_>) -> Vec<f64> {
        [e.fit.in_units(&self.units), e.check.in_units(&self.units)].concat()
    }

    /// The best by score of some.
    fn best(&self, some: impl Iterator<Item = usize>) -> Option<usize> {
        some.min_by(|a, b| self.score(self.of(*a)).total_cmp(&self.score(self.of(*b))))
    }

    /// The number of the candidate that is right, if one is.
    fn chosen(&self) -> Option<usize> {
        let named = self.best(self.all().filter(|i| self.of(*i).may_be_named()));
        let named = named.map(|n| self.no_more_than_needed(self.within_its_ranges(n)));
        let chosen = match (named, self.function()) {
            (Some(n), Some(u)) if self.is_clearly_better(self.of(u), self.of(n)) => u,
            (Some(n), _) => n,
            (None, u) => u?,
        };
        // after a first name a rest that only a function without a name explains, and that is small, is left alone
        let explained_before = self.total(self.case.base) - self.total(self.case.before);
        let explained_now = self.total(self.case.before) - self.total(self.of(chosen).check);
        let counts =
            self.of(chosen).is_named || self.case.is_first || explained_now > LEFT_OVER * explained_before;
        counts.then_some(chosen)
    }

    /// The best function without a name that counts.
    fn function(&self) -> Option<usize> {
        self.best(self.all().filter(|i| !self.of(*i).is_named && self.of(*i).counts()))
    }

    /// The candidate itself, or one as good whose parameters do not run to the ends of their ranges: a mode far above
    /// what is sampled is a delay.
    fn within_its_ranges(&self, named: usize) -> usize {
        if !self.of(named).runs_out {
            return named;
        }
        let inside = self.rivals(named).into_iter().filter(|i| !self.of(*i).runs_out);
        self.best(inside).unwrap_or(named)
    }

    /// The candidate itself, or the simpler one at its place that it is no more than: the parameter that sets it apart is known
    /// to be where it says nothing, or not known.
    fn no_more_than_needed(&self, named: usize) -> usize {
        let is_simpler = |i: &usize| self.of(named).no_more_than.contains(i);
        self.rivals(named).into_iter().find(is_simpler).unwrap_or(named)
    }

    /// A function without a name wins where it explains clearly more than any name.
    fn is_clearly_better(&self, unnamed: &Evidence<'_>, named: &Evidence<'_>) -> bool {
        let explained = self.total(self.case.before) - self.total(unnamed.check);
        let missed = self.total(named.check) - self.total(unnamed.check);
        missed > LEFT_OVER * explained
            && sign_flip(&differences(&self.blocks(named), &self.blocks(unnamed))) < LEVEL
    }

    /// Those that these data cannot tell from the chosen one, and that one.
    fn rivals(&self, chosen: usize) -> Vec<usize> {
        let best = self.of(chosen);
        if !best.is_named {
            return vec![chosen];
        }
        let both = |e: &Evidence<'_>| self.total(e.fit) + self.total(e.check);
        let gain = self.total(self.case.before) - self.total(best.check);
        let is_as_good = |e: &Evidence<'_>| {
            let behind = differences(&self.blocks(e), &self.blocks(best));
            sign_flip(&behind) > LEVEL || both(e) - both(best) < CLOSE * gain
        };
        let fits = |e: &Evidence<'_>| {
            let is_inside = best.runs_out || !e.runs_out;
            // what is no more than the chosen one is no rival of it
            e.may_be_named() && is_as_good(e) && is_inside && !e.no_more_than.contains(&chosen)
        };
        self.all().filter(|i| *i == chosen || fits(self.of(*i))).collect()
    }

    fn reason(&self, i: usize, chosen: Option<usize>, rivals: &[usize]) -> String {
        let e = self.of(i);
        let scores_better = chosen.is_some_and(|c| self.score(e) < self.score(self.of(c)));
        match e.refuted {
            Some(why) => why.into(),
            None if chosen == Some(i) => CHOSEN.into(),
            None if !e.counts() => e.why_not().unwrap_or_default(),
            None if rivals.contains(&i) => {
                "as good as the one chosen: these recordings do not separate them".into()
            }
            None if scores_better && !e.is_named => {
                "explains too little more than the one chosen for a function that could be anything".into()
            }
            None if scores_better && e.runs_out => {
                "its parameters run to the ends of their ranges, and the one chosen is hardly worse".into()
            }
            None => "explains less than the one chosen".into(),
        }
    }

    /// The chosen one among its rivals, by how often each is the best when blocks are drawn anew.
    fn weighed(&self, chosen: usize, rivals: &[usize]) -> Chosen {
        let errors: Vec<Vec<Vec<f64>>> = rivals.iter().map(|i| self.of(*i).errors()).collect();
        let shares = bootstrap_shares(&errors, |m, drawn| {
            log_likelihood(drawn.iter().copied(), self.case.independent) + self.of(rivals[m]).price
        });
        // the same effect at the same place from a signal that is as good is no rival
        let is_same = |(i, _): &(usize, f64)| self.of(*i).what == self.of(chosen).what;
        let (same, mut others): (Vec<_>, Vec<_>) = rivals.iter().copied().zip(shares).partition(is_same);
        others.sort_by(|a, b| b.1.total_cmp(&a.1));
        let share: f64 = same.iter().map(|(_, share)| share).sum();
        let share = if self.of(chosen).is_named { share.max(LEAST_SHARE) } else { 1.0 };
        Chosen { number: chosen, confidence: OFTEN_RIGHT * share, others }
    }
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

#[cfg(test)]
mod tests;
