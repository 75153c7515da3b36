//! The search for effects: one after the other, each on what the ones before leave, and then a look at what
//! is left.

use super::begin::{Begun, begin};
use super::candidates::{BETTER_PART, Before, polish, screen};
use super::decision::{Decision, Round};
use super::experiment::Rival;
use super::in_turn::check_in_turn;
use super::judge::CHOSEN;
use super::left::Left;
use super::locate;
use super::numbers::{MIN_GAIN, NO_MORE};
use super::one_function::{Law, OneFunction, one_function};
use super::recalled::Recalled;
use super::refit::FINAL;
use super::rest::Rest;
use super::result::{Candidate, Finding};
use super::roles::Roles;
use super::study::{Fitted, Model, Study};
use super::subject::Subject;
use crate::Result;

/// Effects that are found one after the other.
const MAX_EFFECTS: usize = 3;
/// How often a round begins anew because the model without what was found in it had not been fitted to its end.
const ANEW: usize = 3;
/// Two fits that leave the same but for this share have come to the same place: each ends where a step lowers the sum of squares by less
/// than a tenth of it.
const BACK: f64 = 1e-3;

/// What was found.
pub(super) struct Found {
    /// The refitted model, without anything that was found.
    pub base: Fitted,
    /// The model with what was found, fitted.
    pub current: Fitted,
    /// What it leaves of the check runs.
    pub check: Rest,
    /// What the refitted model leaves of them, with the same weights.
    pub base_check: Rest,
    /// Effects with names.
    pub findings: Vec<Finding>,
    /// Something without one.
    pub unknown: Option<Finding>,
    /// All that was tried.
    pub candidates: Vec<Candidate>,
    /// Of the first effect that has alternatives: its model, and those of the alternatives.
    pub rivals: Vec<Rival>,
}

impl Found {
    /// Nothing is looked for.
    pub(super) fn nothing(base: Fitted, base_check: Rest) -> Self {
        Self {
            current: base.clone(),
            base,
            check: base_check.clone(),
            base_check,
            findings: Vec::new(),
            unknown: None,
            candidates: Vec::new(),
            rivals: Vec::new(),
        }
    }

    /// Fits on, and gives what that leaves of the fit runs.
    fn go_on(&mut self, study: &Study<'_>, from: &Fitted) -> Result<Rest> {
        self.current = study.fit_on(from, FINAL)?;
        self.check = study.rest(&self.current.model, &study.check_runs)?;
        self.base_check = study.rest(&self.base.model, &study.check_runs)?;
        study.fit_rest(&self.current)
    }

    /// Ends with a function without a name, which may stand for physics of which the names before it show a part.
    fn end_with(&mut self, function: Finding, current: Fitted, check: Rest) {
        let (names, own) = (self.base_check.total - self.check.total, self.check.total - check.total);
        self.doubt(names.max(0.0) / (names.max(0.0) + own.max(f64::MIN_POSITIVE)));
        (self.unknown, self.current, self.check) = (Some(function), current, check);
    }

    /// Ends with a function without a name in place of the names that are no more than it.
    fn end_with_one(&mut self, one: OneFunction) {
        for candidate in self.candidates.iter_mut().filter(|c| c.reason == CHOSEN).skip(one.first) {
            candidate.reason =
                "one function without a name explains as much as this and another name at its place".into();
        }
        self.findings.truncate(one.first);
        if one.first == 0 {
            self.rivals.clear();
        }
        self.check = one.before;
        self.end_with(one.finding, one.fitted, one.check);
    }

    /// Makes all names less sure, by this factor.
    fn doubt(&mut self, factor: f64) {
        for finding in &mut self.findings {
            finding.confidence *= factor;
            finding.alternatives.iter_mut().for_each(|a| a.confidence *= factor);
        }
    }
}

/// Whether hardly more than the noise is left of every channel of the check runs.
fn is_noise(study: &Study<'_>, rest: &Rest) -> bool {
    let noise = |channel: usize| locate::noise(&study.check_runs, &rest.simulated, channel);
    (0..study.weights.len()).all(|c| noise(c).is_some_and(|n| study.error(rest, c) < NO_MORE * n))
}

/// The model without the last effect of one that was tried, fitted from where that ended, if this is better than where it stands: then it
/// stands where only its own way had led, and what seems to be missing is what an effect has opened another way for.
pub(super) fn without(study: &Study<'_>, tried: &Fitted, found: &Found) -> Option<Fitted> {
    let here = found.current.fit.cost;
    let roughly = study.fit_without_last(tried, FINAL).ok()?;
    if (roughly.fit.cost - here).abs() <= BACK * here {
        return None;
    }
    let other = study.fit_on(&roughly, FINAL).ok()?;
    if other.fit.cost >= (1.0 - MIN_GAIN) * here {
        return None;
    }
    let check = study.rest(&other.model, &study.check_runs).ok()?;
    (check.total < found.check.total).then_some(other)
}

/// Searches, beginning with the refitted model and what it leaves of the check runs. Weights of channels
/// change on the way.
pub(super) fn search(
    study: &mut Study<'_>,
    subject: &Subject,
    roles: &Roles,
    nominal: &Model,
    (base, base_check): (Fitted, Rest),
    progress: &mut dyn FnMut(&str, f64),
) -> Result<Found> {
    let mut fit = study.fit_rest(&base)?;
    let mut found = Found::nothing(base, base_check);
    let mut recalled = Recalled::default();
    let (mut round, mut anew) = (0, 0);
    let mut laws: Vec<Law> = Vec::new();
    while round < MAX_EFFECTS {
        let says_anything = study.says_anything(&study.fit_runs, &fit)
            || study.says_anything(&study.check_runs, &found.check);
        if !says_anything || round > 1 && is_noise(study, &found.check) {
            break;
        }
        let progressed = 0.15 + 0.7 * round as f64 / MAX_EFFECTS as f64;
        progress("screening effects", progressed);
        let screened = screen(study, subject, roles, &found.current, &fit, (&mut recalled, BETTER_PART))?;
        progress("fitting effects inside the simulation", progressed + 0.05);
        // what is found first unbends parameters
        let nominal = (round == 0).then_some(nominal);
        let near = study.near(&found.current);
        let studies = (&*study, &near);
        let begun =
            begin(studies, subject, roles, &found.current, nominal, (&screened, &mut recalled), round);
        let before = Before { fit: &fit, check: &found.check };
        let mut tried = Begun::finish(&begun, studies, &found.current, before);
        polish(study, &mut tried, before);
        check_in_turn(study, &mut tried, &found.current);
        let judged = Round {
            study,
            tried: &tried,
            before: &found.check,
            base: &found.base_check,
            is_first: round == 0,
        };
        let before_this = found.candidates.len();
        let decision = judged.decide(subject, &mut found.candidates);
        if let Some(i) = decision.chosen().filter(|_| anew < ANEW)
            && let Some(better) = without(study, &tried[i].fitted, &found)
        {
            found.candidates.truncate(before_this);
            let rest = study.fit_rest(&better)?;
            let from = study.weigh_by(&better, &rest);
            fit = found.go_on(study, &from)?;
            if round == 0 {
                (found.base, found.base_check) = (found.current.clone(), found.check.clone());
            }
            anew += 1;
            continue;
        }
        match decision {
            Decision::Nothing => break,
            Decision::Named { number: i, finding, others, function } => {
                if let Some(one) = one_function(study, &laws, &tried[i])? {
                    found.end_with_one(one);
                    return Ok(found);
                }
                laws.push(Law {
                    placement: tried[i].placement().clone(),
                    before: found.current.model.clone(),
                    name: finding.name.clone(),
                    function: function.map(|f| (f.1, tried[f.0].fitted.model.clone())),
                });
                found.findings.push(finding);
                if found.rivals.is_empty() && !others.is_empty() {
                    let rivals = std::iter::once(i).chain(others).map(|k| &tried[k]);
                    found.rivals = rivals.map(|t| Rival::of(study, t.placement(), &t.fitted)).collect();
                }
                let t = tried.swap_remove(i);
                // what is left of a channel is what counts from here on
                let mut from = study.weigh_by(&t.fitted, &t.fit_rest);
                // a name stays what it is beside others: none of its parameters goes to where the name does not allow it
                if let Some((placement, _)) = from.model.effects.last_mut() {
                    placement.bounded = true;
                }
                fit = found.go_on(study, &from)?;
                round += 1;
            }
            Decision::Unnamed(i, mut finding) => {
                // the function is of one signal; more may be known of what it should have been of
                let left = Left::of(study, subject, roles, &found.current, (&fit, &found.check));
                let more = left.depends_on().unwrap_or_default();
                let is_new = |signal: &String| !finding.depends_on.contains(signal);
                let more: Vec<String> = more.into_iter().filter(is_new).collect();
                finding.depends_on.extend(more);
                let t = tried.swap_remove(i);
                found.end_with(finding, t.fitted, t.check_rest);
                return Ok(found);
            }
        }
    }
    progress("locating what is left", 0.88);
    let left = Left::of(study, subject, roles, &found.current, (&fit, &found.check));
    let explained = found.base_check.total - found.check.total;
    // what leaves much is less sure to be what it is called
    found.doubt(left.doubt(explained));
    if left.counts(explained) {
        found.unknown = Some(left.finding(subject, study));
    }
    Ok(found)
}
