//! Candidates: effects screened at all their places, and the best of them fitted inside the simulation.

use super::excerpt::coarser;
use super::placement::{Placement, Site, is_tunable, sizes};
use super::plausible::{implausible, plausible};
use super::roles::Roles;
use super::screen::{Screen, Screened};
use super::study::{Fitted, Model, Rest, Study, differences};
use super::subject::Subject;
use crate::effect::{Effect, catalogue, empirical};
use crate::fit::{Drive, Run, Traces, side_by_side};
use crate::model::Causality;
use crate::stats::{root_mean_square, sign_flip};
use crate::{Error, Result};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Named effects that are fitted inside the simulation, in the first round and later.
const NAMED: [usize; 2] = [7, 5];
/// Empirical functions that are fitted as rivals.
const UNNAMED: [usize; 2] = [3, 2];
/// Runs that effects are screened with.
const SCREENED: usize = 4;
/// An effect that promises less of the squared error of the fit runs is not fitted.
const MIN_PROMISE: [f64; 2] = [0.005, 0.015];

/// A squared error that is so many times larger with an effect than without refutes it.
const SPOILT: f64 = 1.5;
/// Iterations of a fit to the end.
const POLISH: usize = 10;
/// An effect that misses less than this share of what the best one explains is fitted to the end.
const NEARLY: f64 = 0.3;

/// A candidate that was fitted.
pub(super) struct Tried {
    pub placement: Placement,
    /// Number of places at which its effect was looked for.
    pub places: usize,
    pub fitted: Fitted,
    pub fit_rest: Rest,
    pub check_rest: Rest,
    pub fit_gain: f64,
    pub check_gain: f64,
    pub p: f64,
    /// Why it may not be named, if so.
    pub refuted: Option<String>,
}

/// Runs for screening, as numbers among the fit runs: those that leave most, then others spread evenly.
fn some_of(study: &Study<'_>, rest: &Rest) -> Vec<usize> {
    let count = study.fit_runs.len();
    let left = |i: usize| {
        let run = study.fit_runs[i];
        let square: f64 = run
            .channels
            .iter()
            .zip(&rest.simulated[i])
            .zip(&study.weights)
            .map(|((c, s), w)| c.values.iter().zip(s).map(|(m, s)| (w * (m - s)).powi(2)).sum::<f64>())
            .sum();
        square / run.time.len().max(1) as f64
    };
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|a, b| left(*b).total_cmp(&left(*a)));
    let mut chosen: Vec<usize> = order.iter().copied().take(SCREENED.div_ceil(2)).collect();
    let n = SCREENED - chosen.len();
    chosen.extend((0..n).map(|i| (2 * i + 1) * count / (2 * n)));
    let mut seen = BTreeSet::new();
    chosen.retain(|i| seen.insert(*i));
    chosen
}

/// All that the catalogue and the empirical functions offer on this model, screened: all with two runs,
/// the best of them with more.
pub(super) fn screen(
    study: &Study<'_>,
    subject: &Subject,
    roles: &Roles,
    current: &Fitted,
    current_fit: &Rest,
) -> Result<Vec<Screened>> {
    let interface = &subject.interface;
    let chosen = some_of(study, current_fit);
    let coarse: Vec<Run> = chosen.iter().map(|i| coarser(study.fit_runs[*i])).collect();
    let runs: Vec<&Run> = coarse.iter().collect();
    let simulated: Vec<Traces> = chosen.iter().map(|i| current_fit.simulated[*i].clone()).collect();
    let watch: Arc<[usize]> = interface
        .variables
        .iter()
        .enumerate()
        .filter(|(_, v)| v.is_real() && matches!(v.causality, Causality::Input | Causality::Output))
        .map(|(i, _)| i)
        .chain(runs.iter().flat_map(|r| r.channels.iter().map(|c| c.variable)))
        .collect::<BTreeSet<usize>>()
        .into_iter()
        .collect();
    let point = Study::point(&current.model);
    let steps: Vec<f64> = current.unknowns.iter().zip(&point).map(|(u, x)| u.step_at(*x)).collect();
    let problem = study.problem(&current.model, runs.clone());
    let model = &current.model;
    let screen = Screen::new(&problem, &simulated, model, &point, &steps, Arc::clone(&watch), &study.weights)
        .ok_or_else(|| Error::numeric("the fitted model cannot be run"))?;
    let drives: Vec<Arc<Drive>> = runs.iter().map(|r| Arc::clone(&r.drive)).collect();
    let (mut size, rate) = sizes(interface.variables.len(), &watch, &drives, &screen.traces);
    for p in &study.free {
        size[p.variable] = p.scale;
    }
    // a model may leave an output at rest that moves
    for channel in runs.iter().flat_map(|r| &r.channels) {
        let own = root_mean_square(channel.values.iter().copied());
        size[channel.variable] = size[channel.variable].max(own);
    }
    let measured: Vec<usize> =
        runs.first().map_or(Vec::new(), |r| r.channels.iter().map(|c| c.variable).collect());
    let driven: Vec<usize> =
        runs.first().map_or(Vec::new(), |r| r.drive.inputs.iter().map(|(v, _)| *v).collect());
    for variable in 0..size.len() {
        if size[variable] == 0.0
            && roles.is(variable, crate::effect::Role::Force)
            && interface.variables[variable].causality == Causality::Input
        {
            size[variable] = force_size(study, &current.model, variable, &measured, &size);
        }
    }
    let tunable = study.free.iter().map(|p| p.variable).filter(|v| is_tunable(interface, *v)).collect();
    let site = Site { interface, roles, measured: &measured, driven, tunable, size, rate };
    let known = |placement: &Placement| {
        current
            .model
            .effects
            .iter()
            .any(|(p, _)| p.effect.id == placement.effect.id && p.targets == placement.targets)
    };
    let placements: Vec<Placement> = catalogue::EFFECTS
        .iter()
        .chain(empirical::EFFECTS)
        .flat_map(|effect: &'static Effect| site.placements(effect))
        .filter(|p| !known(p))
        .collect();
    let places = |id: &str| placements.iter().filter(|p| p.effect.id == id).count();
    let counted = |screened: Vec<Screened>| -> Vec<Screened> {
        screened.into_iter().map(|s| Screened { places: places(s.placement.effect.id), ..s }).collect()
    };
    Ok(counted(screen.screen(interface, &placements)))
}

/// The size of a force at an input that nothing drives: what moves an output as much as it moves anyway.
fn force_size(study: &Study<'_>, model: &Model, variable: usize, measured: &[usize], size: &[f64]) -> f64 {
    let Some(run) = study.fit_runs.first() else { return 0.0 };
    let setup = Arc::new(study.problem(model, vec![run]).setup(&Study::point(model)));
    let watch: Arc<[usize]> = measured.into();
    let respond = |force: f64| {
        let mut drive = (*run.drive).clone();
        drive.inputs.retain(|(v, _)| *v != variable);
        // on and off, so that also what only shows in motion answers
        let wave = (0..drive.points).map(|k| if (k / 50) % 2 == 0 { force } else { 0.0 }).collect();
        drive.inputs.push((variable, wave));
        study.bench.run(std::slice::from_ref(&setup), &[Arc::new(drive)], &watch).pop().and_then(Result::ok)
    };
    let (Some(still), Some(moved)) = (respond(0.0), respond(1.0)) else { return 0.0 };
    let mut least = f64::INFINITY;
    for ((a, b), variable) in still.iter().zip(&moved).zip(measured) {
        let change = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len().max(1) as f64;
        if change > 0.0 && size[*variable] > 0.0 {
            least = least.min(size[*variable] / change.sqrt());
        }
    }
    if least.is_finite() { least } else { 0.0 }
}

/// The best placement of the best effects: named ones and empirical functions; fewer after the first round.
pub(super) fn choose(screened: &[Screened], round: usize) -> Vec<Screened> {
    let mut chosen: Vec<Screened> = Vec::new();
    for (named, limits) in [(true, NAMED), (false, UNNAMED)] {
        let (limit, least) = (limits[round.min(1)], MIN_PROMISE[round.min(1)]);
        let mut count = 0;
        for s in screened.iter().filter(|s| empirical::is(s.placement.effect) != named) {
            let best =
                screened.iter().find(|s| empirical::is(s.placement.effect) != named).map_or(0.0, |b| b.gain);
            if count == limit || s.gain < 0.1 * best || s.gain < least {
                break;
            }
            // other places of the same effect only if they are about as good
            let mut same = chosen.iter().filter(|c| c.placement.effect.id == s.placement.effect.id);
            if same.clone().count() > 1 || same.next().is_some_and(|first| s.gain < 0.6 * first.gain) {
                continue;
            }
            chosen.push(s.clone());
            count += 1;
        }
    }
    chosen
}

impl Tried {
    /// What its form costs, in units of twice the logarithm of a likelihood with so many independent
    /// samples (Schwarz's criterion): its parameters, and the places among which it could choose.
    pub fn price(&self, independent: f64) -> f64 {
        self.placement.effect.parameters.len() as f64 * independent.ln() + 2.0 * (self.places as f64).ln()
    }
}

/// Fits those that are nearly the best to the end.
pub(super) fn polish(study: &Study<'_>, tried: &mut [Tried], current_fit: &Rest, current_check: &Rest) {
    let both = |t: &Tried| t.fit_rest.total + t.check_rest.total;
    let best = tried.iter().map(both).fold(f64::INFINITY, f64::min);
    let explained = (current_fit.total + current_check.total - best).max(0.0);
    let better = |t: &Tried| {
        if both(t) > best + NEARLY * explained {
            return None;
        }
        let fitted = study.fit_on(&t.fitted, POLISH).ok()?;
        let fitted = plausible(study, &fitted, current_fit).unwrap_or(fitted);
        assess(study, (t.placement.clone(), t.places), fitted, current_fit, current_check)
            .filter(|b| b.fit_rest.total <= t.fit_rest.total)
    };
    let better = side_by_side(study.bench.threads(), tried, better);
    for (t, better) in tried.iter_mut().zip(better) {
        if let Some(better) = better.flatten() {
            *t = better;
        }
    }
}

pub(super) fn assess(
    study: &Study<'_>,
    (placement, places): (Placement, usize),
    fitted: Fitted,
    current_fit: &Rest,
    current_check: &Rest,
) -> Option<Tried> {
    let fit_rest = study.fit_rest(&fitted).ok()?;
    let check_rest = study.rest(&fitted.model, &study.check_runs).ok()?;
    // every channel in units of what is left of it, so that a small effect in one is not lost among the others
    let units = fit_rest.by_channel();
    let p = sign_flip(&differences(&current_check.in_units(&units), &check_rest.in_units(&units)));
    let refuted = implausible(&fitted.model)
        .or_else(|| spoils(&current_check.by_channel(), &check_rest.by_channel(), study));
    Some(Tried {
        placement,
        places,
        fit_gain: 1.0 - fit_rest.total / current_fit.total.max(f64::MIN_POSITIVE),
        check_gain: 1.0 - check_rest.total / current_check.total.max(f64::MIN_POSITIVE),
        fitted,
        fit_rest,
        check_rest,
        p,
        refuted,
    })
}

/// A channel that gets much worse: what is right in one place of a machine is not wrong in another.
fn spoils(before: &[f64], after: &[f64], study: &Study<'_>) -> Option<String> {
    let worst = (0..before.len())
        .filter(|c| after[*c] > SPOILT * before[*c])
        .max_by(|a, b| (after[*a] / before[*a]).total_cmp(&(after[*b] / before[*b])))?;
    let variable = study.check_runs.first()?.channels.get(worst)?.variable;
    let name = &study.bench.interface().variables[variable].name;
    Some(format!("makes {name} worse by {:.0} %", 100.0 * ((after[worst] / before[worst]).sqrt() - 1.0)))
}
