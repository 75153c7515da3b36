//! The decision of one round: which candidate is right by the check runs, and what cannot be told from it.

use super::blocks::{bootstrap_shares, differences, sign_flip};
use super::candidates::Tried;
use super::locate;
use super::result::{Alternative, Candidate, Finding};
use super::roles::Roles;
use super::study::{Fitted, Rest, Study, negligible};
use super::subject::Subject;
use super::tables::estimates;
use super::wander::wandering;
use crate::effect::{Effect, empirical};

/// Probability of chance below which a gain on the check runs counts, for all that were fitted together.
pub(super) const LEVEL: f64 = 0.05;
/// A gain on the check runs below this share of the squared error is not worth a name.
const MIN_GAIN: f64 = 0.01;
/// A rest that an empirical function explains, as a share of what the named effects explain, above which
/// the names are not enough.
const LEFT_OVER: f64 = 0.2;
/// What is known of the noise is too little by up to this factor, if it is coloured.
pub(super) const NOISE_MARGIN: f64 = 1.4;
/// An error of so many times the noise is no noise, even if nothing can be said of it: of models that lack
/// nothing the largest ratio of seeds 4 to 7 of the blind study was 1.37.
const FAR: f64 = 1.45;
/// And of so many times it nothing is explained, whatever the names have taken away: what was named right left 2.5
/// times at most in seed 6 of the study, 3.2 times in real recordings.
const TOO_FAR: f64 = 10.0;
/// Probability of chance below which what can be foretold counts, and the share from which on.
const FORETOLD_LEVEL: f64 = 0.01;
const MIN_FORETOLD: f64 = 0.03;
/// The share from which on it counts in a model that takes long: it is not exact, and its own error depends on its
/// signals. The usual step of the ring-and-brush tire errs by half of 1.5 % noise, a fifth of the two together.
const MIN_FORETOLD_SLOW: f64 = 0.2;
/// The same for signals that are only said to be likely.
const LIKELY_LEVEL: f64 = 0.2;
const MUCH: f64 = 0.3;
/// A rival is as good if chance makes such a difference with more than this probability.
const TIE: f64 = 0.05;

/// How often a name without a rival was right in the blind study (PROOF.md).
const OFTEN_RIGHT: f64 = 0.94;

pub(super) enum Decision {
    Nothing,
    /// With the numbers of its alternatives, in their order.
    Named(usize, Finding, Vec<usize>),
    Unnamed(usize, Finding),
}

#[allow(clippy::too_many_arguments)]
pub(super) fn decide(
    study: &Study<'_>,
    subject: &Subject,
    tried: &[Tried],
    current_check: &Rest,
    base_check: &Rest,
    round: usize,
    candidates: &mut Vec<Candidate>,
) -> Decision {
    let level = LEVEL / tried.len().max(1) as f64;
    let counts = |t: &Tried| {
        t.p <= level.max(2.5e-4)
            && t.check_gain > MIN_GAIN
            && t.fit_gain > 0.0
            && visible(study, t, current_check)
    };
    let independent = study.independent();
    let price = |t: &Tried| t.price(independent);
    let errors = |t: &Tried| -> Vec<Vec<f64>> { [&t.fit_rest.blocks[..], &t.check_rest.blocks[..]].concat() };
    // simple and bound to one place before manifold and at home anywhere
    let score = |t: &Tried| log_likelihood(errors(t).iter(), independent) + price(t);
    let best = tried.iter().min_by(|a, b| score(a).total_cmp(&score(b)));
    // channels in units of what the best leaves of them
    let units: Vec<f64> = best.map_or(Vec::new(), |t| t.fit_rest.by_channel());
    let total = |rest: &Rest| rest.in_units(&units).iter().sum::<f64>();
    let both = |t: &Tried| total(&t.fit_rest) + total(&t.check_rest);
    let blocks = |t: &Tried| [t.fit_rest.in_units(&units), t.check_rest.in_units(&units)].concat();
    let is_named = |t: &&(usize, &Tried)| !empirical::is(t.1.placement.effect);
    let all: Vec<(usize, &Tried)> = tried.iter().enumerate().collect();
    let best_of = |named: bool| {
        all.iter()
            .filter(|t| is_named(t) == named && counts(t.1) && (t.1.refuted.is_none() || !named))
            .min_by(|a, b| score(a.1).total_cmp(&score(b.1)))
            .copied()
    };
    let (named, unnamed) = (best_of(true), best_of(false));
    // an empirical function wins where it explains clearly more than any name
    let better = |e: &Tried, n: &Tried| {
        let explained = total(current_check) - total(&e.check_rest);
        let missed = total(&n.check_rest) - total(&e.check_rest);
        missed > LEFT_OVER * explained && sign_flip(&differences(&blocks(n), &blocks(e))) < TIE
    };
    let decision = match (named, unnamed) {
        (None, None) => None,
        (Some((i, _)), None) => Some((i, true)),
        (None, Some((i, _))) => Some((i, false)),
        (Some((i, n)), Some((j, e))) => Some(if better(e, n) { (j, false) } else { (i, true) }),
    };
    // after a first name a rest that only an empirical function explains, and that is small, is left alone
    let decision = decision.filter(|(i, named)| {
        let explained_before = total(base_check) - total(current_check);
        let explained_now = total(current_check) - total(&tried[*i].check_rest);
        *named || round == 0 || explained_now > LEFT_OVER * explained_before
    });
    let rivals: Vec<(usize, &Tried)> = match decision {
        Some((chosen, true)) => all
            .iter()
            .filter(|t| is_named(t) && counts(t.1) && t.1.refuted.is_none())
            .filter(|t| {
                t.0 == chosen || {
                    let behind = differences(&blocks(t.1), &blocks(&tried[chosen]));
                    let lag = both(t.1) - both(&tried[chosen]);
                    let gain = total(current_check) - total(&tried[chosen].check_rest);
                    sign_flip(&behind) > TIE || lag < 0.03 * gain
                }
            })
            .copied()
            .collect(),
        Some((chosen, false)) => vec![(chosen, &tried[chosen])],
        None => Vec::new(),
    };
    let prices: Vec<f64> = rivals.iter().map(|t| price(t.1)).collect();
    let of_rivals: Vec<Vec<Vec<f64>>> = rivals.iter().map(|t| errors(t.1)).collect();
    let shares = bootstrap_shares(&of_rivals, |m, drawn| {
        log_likelihood(drawn.iter().copied(), independent) + prices[m]
    });
    for (i, t) in &all {
        let placement = &t.placement;
        let reason = match decision {
            _ if t.refuted.is_some() => t.refuted.clone().unwrap_or_default(),
            Some((chosen, _)) if chosen == *i => "chosen".into(),
            _ if !counts(t) => "no gain on the check runs that chance does not make".into(),
            _ if rivals.iter().any(|r| r.0 == *i) => {
                "as good as the one chosen: these recordings do not separate them".into()
            }
            _ => "explains less than the one chosen".into(),
        };
        candidates.push(Candidate {
            effect: placement.effect.id.into(),
            name: placement.effect.name.into(),
            family: family(placement.effect),
            place: placement.place(&subject.interface),
            fit_gain: Some(t.fit_gain),
            check_gain: Some(t.check_gain),
            p: Some(t.p),
            reason,
        });
    }
    let Some((chosen, is_named)) = decision else { return Decision::Nothing };
    let t = &tried[chosen];
    // the same effect at the same place from a signal that is as good is no rival
    let same = |r: &Tried| {
        r.placement.effect.id == t.placement.effect.id && r.placement.targets == t.placement.targets
    };
    let share_of = |i: usize| rivals.iter().position(|r| r.0 == i).map_or(0.0, |k| shares[k]);
    let share_of_chosen: f64 = rivals.iter().filter(|r| same(r.1)).map(|r| share_of(r.0)).sum();
    let mut alternatives: Vec<(usize, Alternative)> = rivals
        .iter()
        .filter(|r| !same(r.1))
        .map(|r| {
            let alternative = Alternative {
                effect: r.1.placement.effect.id.into(),
                family: family(r.1.placement.effect),
                place: r.1.placement.place(&subject.interface),
                confidence: share_of(r.0),
            };
            (r.0, alternative)
        })
        .collect();
    alternatives.sort_by(|a, b| b.1.confidence.total_cmp(&a.1.confidence));
    let (others, alternatives) = alternatives.into_iter().unzip();
    let placement = &t.placement;
    let channels = affected(study, subject, t, current_check);
    let finding = Finding {
        effect: if is_named { placement.effect.id.into() } else { "unknown".into() },
        name: placement.effect.name.into(),
        family: if is_named { family(placement.effect) } else { "unknown".into() },
        place: placement.place(&subject.interface),
        channels,
        depends_on: placement.depends_on(&subject.interface),
        confidence: OFTEN_RIGHT * if is_named { share_of_chosen.max(0.05) } else { 1.0 },
        parameters: estimates(study, &t.fitted),
        alternatives,
        evidence: format!(
            "It takes away {:.0} % of the squared error of the check runs and {:.0} % of that of the fit runs beyond the refit; chance does so with a probability of {:.1e}.",
            100.0 * t.check_gain,
            100.0 * t.fit_gain,
            t.p
        ),
    };
    if is_named { Decision::Named(chosen, finding, others) } else { Decision::Unnamed(chosen, finding) }
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
            let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
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
    let mut change = vec![0.0; study.weights.len()];
    for ((run, a), b) in study.check_runs.iter().zip(&before.simulated).zip(&t.check_rest.simulated) {
        for (c, channel) in run.channels.iter().enumerate() {
            let sum = |traces: &Vec<f64>| -> f64 {
                traces.iter().zip(&channel.values).map(|(s, m)| (s - m).powi(2)).sum()
            };
            change[c] += (sum(&a[c]) - sum(&b[c])) * study.weights[c].powi(2);
        }
    }
    let most = change.iter().copied().fold(0.0, f64::max);
    let channels = study.check_runs.first().map_or(&[][..], |r| &r.channels[..]);
    let mut order: Vec<usize> = (0..channels.len()).filter(|c| change[*c] > 0.1 * most).collect();
    order.sort_by(|a, b| change[*b].total_cmp(&change[*a]));
    order.iter().map(|c| subject.interface.variables[channels[*c].variable].name.clone()).collect()
}

/// What the named effects leave that is no noise of sensors.
pub(super) struct Left {
    /// What several channels share.
    common: Option<locate::Common>,
    /// What can be foretold in one channel, the most important one.
    structure: Option<locate::Structure>,
    /// The channel whose error is the most times its noise, and how many, if they are too many.
    far: Option<(usize, f64)>,
    /// The signals that it depends on.
    depends_on: Vec<String>,
    /// Weighted squared error of the check runs that is foretold, or shared, or far above the noise where
    /// something is.
    error: f64,
}

impl Left {
    /// Looks at what a model leaves of the fit runs and the check runs.
    pub(super) fn of(
        study: &Study<'_>,
        subject: &Subject,
        roles: &Roles,
        current: &Fitted,
        (fit, check): (&Rest, &Rest),
    ) -> Self {
        let runs = &study.check_runs;
        let errors = check.by_channel();
        let before = locate::Seen { runs: &study.fit_runs, simulated: &fit.simulated };
        let then = locate::Seen { runs, simulated: &check.simulated };
        let mut foretold = 0.0;
        let mut structure = None;
        let mut most = 0.0;
        let wandering = wandering(study, current, (fit, check));
        let structures = locate::structure(before, then, &wandering, &subject.interface, roles);
        let least = if study.slow { MIN_FORETOLD_SLOW } else { MIN_FORETOLD };
        for s in structures.iter().cloned() {
            if s.p < FORETOLD_LEVEL && s.share > least {
                let part = s.share * errors[s.channel];
                foretold += part;
                if part > most {
                    (most, structure) = (part, Some(s));
                }
            }
        }
        // sensors have noise of their own: what their residuals share has a cause in the machine
        let all: Vec<&crate::fit::Run> = study.fit_runs.iter().chain(runs).copied().collect();
        let simulated = [&fit.simulated[..], &check.simulated[..]].concat();
        let common = locate::common_cause(&all, &simulated);
        let shared = common.as_ref().map_or(0.0, |common| {
            let channels = study.check_runs.first().map_or(&[][..], |r| &r.channels[..]);
            let pair = common.channels.iter().take(2);
            let numbers = pair.filter_map(|v| channels.iter().position(|c| c.variable == *v));
            common.share * numbers.map(|c| errors[c]).sum::<f64>()
        });
        let samples: usize = runs.iter().map(|r| r.time.len()).sum();
        let squared_noise: Vec<f64> = (0..study.weights.len())
            .map(|c| {
                let noise = locate::noise(runs, &check.simulated, c).unwrap_or(f64::INFINITY);
                samples as f64 * (noise * study.weights[c]).powi(2)
            })
            .collect();
        // recordings without noise are met to what steps and rounding allow
        let is_visible =
            |c: usize| errors[c] > samples as f64 * (FAR * negligible(runs, c) * study.weights[c]).powi(2);
        let far = (0..study.weights.len())
            .filter(|c| is_visible(*c))
            .map(|c| (c, (errors[c] / squared_noise[c]).sqrt()))
            .filter(|(_, ratio)| *ratio > FAR)
            .max_by(|a, b| a.1.total_cmp(&b.1));
        let beyond: f64 = if common.is_some() || structure.is_some() || far.is_some() {
            let beyond = |(e, n): (&f64, &f64)| (e - NOISE_MARGIN.powi(2) * n).max(0.0);
            errors.iter().zip(&squared_noise).map(beyond).sum()
        } else {
            0.0
        };
        // what would foretell much in one of these channels, if less surely, says more than where the error is large
        let concerns = |channel: usize| {
            let variable = runs.first().and_then(|r| r.channels.get(channel)).map(|c| c.variable);
            far.is_some_and(|(c, _)| c == channel)
                || common
                    .as_ref()
                    .is_some_and(|common| variable.is_some_and(|v| common.channels.contains(&v)))
        };
        let likely = structures.iter().find(|s| concerns(s.channel) && s.p < LIKELY_LEVEL && s.share > MUCH);
        let depends_on = match (&structure, &common, far) {
            (Some(s), ..) => s.depends_on.clone(),
            (None, None, None) => Vec::new(),
            _ => match likely {
                Some(s) => s.depends_on.clone(),
                None => locate::depends_on(runs, &check.simulated, &subject.interface, roles),
            },
        };
        Self { common, structure, far, depends_on, error: foretold.max(shared).max(beyond) }
    }

    /// Whether it is worth a word beside effects that have taken away `explained`.
    pub(super) fn counts(&self, explained: f64) -> bool {
        if self.far.is_some_and(|(_, ratio)| ratio > TOO_FAR) {
            true
        } else if explained > 0.0 {
            self.error > LEFT_OVER * (explained + self.error)
        } else {
            self.common.is_some() || self.structure.is_some() || self.far.is_some()
        }
    }

    /// How much less sure effects are that have taken away `explained` and leave this: the share that they are of all
    /// that there was to explain, and the noise over what they leave where that is too much.
    pub(super) fn doubt(&self, explained: f64) -> f64 {
        let all = (explained.max(0.0) + self.error).max(f64::MIN_POSITIVE);
        let share = if self.counts(explained) { explained.max(0.0) / all } else { 1.0 };
        share.min(self.far.map_or(1.0, |(_, ratio)| 1.0 / ratio))
    }

    /// The signals that an empirical function should have had, if that is known.
    pub(super) fn depends_on(&self) -> Option<Vec<String>> {
        self.structure.as_ref().map(|s| s.depends_on.clone())
    }

    /// Something that is missing and that nothing explains.
    pub(super) fn finding(&self, subject: &Subject, study: &Study<'_>) -> Finding {
        let name_of = |v: usize| subject.interface.variables[v].name.clone();
        let (name, channels, evidence) = match (&self.common, &self.structure) {
            (Some(common), _) => (
                "Something in the machine that several channels share",
                common.channels.iter().map(|v| name_of(*v)).collect::<Vec<_>>(),
                format!(
                    "{:.0} % of what is left in these channels between {:.3} and {:.3} Hz is coherent, which noise of separate sensors is not; chance does so with a probability of {:.1e}.",
                    100.0 * common.share,
                    common.band.0,
                    common.band.1,
                    common.p
                ),
            ),
            (None, Some(s)) => (
                "Something that other signals foretell",
                study.check_runs.first().iter().map(|r| name_of(r.channels[s.channel].variable)).collect(),
                format!(
                    "Functions of {}{} that were found in the fit runs foretell {:.0} % of the squared error of the check runs; chance does so with a probability of {:.1e}.",
                    s.depends_on.join(", "),
                    s.through
                        .as_ref()
                        .map_or(String::new(), |p| format!(", by which {p} would have to change,")),
                    100.0 * s.share,
                    s.p
                ),
            ),
            (None, None) => {
                let (channel, ratio) = self.far.unwrap_or_default();
                let channel = study.check_runs.first().and_then(|r| r.channels.get(channel));
                (
                    "Something that no signal foretells",
                    channel.iter().map(|c| name_of(c.variable)).collect(),
                    format!("The error of the check runs is {ratio:.1} times the noise."),
                )
            }
        };
        Finding {
            effect: "unknown".into(),
            name: name.into(),
            family: "unknown".into(),
            place: format!("output{} {}", if channels.len() == 1 { "" } else { "s" }, channels.join(", ")),
            channels,
            depends_on: self.depends_on.clone(),
            confidence: OFTEN_RIGHT,
            evidence,
            ..Finding::default()
        }
    }
}
