//! Candidates: effects screened at all their places, and the best of them fitted inside the simulation.

use super::excerpt::coarser;
use super::forces::Forces;
use super::numbers::{CLOSE, SPOILT};
use super::placement::{Placement, Site, is_tunable, own_time, shown_twice, sizes};
use super::plausible::{implausible, plausible};
use super::recalled::{Natural, Recalled};
use super::refit::{FINAL, GO_ON};
use super::rest::{Rest, differences};
use super::roles::Roles;
use super::screen::{FIRST, Screen, Screened};
use super::study::{Fitted, Model, Study};
use super::subject::Subject;
use crate::effect::catalogue::nested::simpler;
use crate::effect::{Effect, Role, Source, catalogue, empirical};
use crate::fit::{Channel, Drive, End, Run, Traces, side_by_side};
use crate::model::{Causality, Interface};
use crate::stats::{amplitude, root_mean_square, sign_flip};
use crate::{Error, Result};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Named effects that are fitted inside the simulation, in the first round and later.
const NAMED: [usize; 2] = [7, 5];
/// Empirical functions that are fitted as rivals.
const UNNAMED: [usize; 2] = [3, 2];
/// Runs that effects are screened with.
const SCREENED: usize = 4;
/// Runs of which answers are known are screened with again if they show this share of what is left.
pub(super) const BETTER_PART: f64 = 0.5;
/// An effect that promises less of the squared error of the fit runs is not fitted.
const MIN_PROMISE: [f64; 2] = [0.005, 0.015];

/// Iterations of a fit to the end.
const POLISH: usize = 10;
/// An effect that misses less than this share of what the best one explains is fitted to the end.
pub(super) const NEARLY: f64 = 0.3;

/// What the model leaves without a candidate, of the fit runs and of the check runs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Before<'a> {
    pub fit: &'a Rest,
    pub check: &'a Rest,
}

/// A candidate that was fitted.
pub(super) struct Tried {
    /// Effect and place, and among how many it was chosen.
    pub screened: Screened,
    pub fitted: Fitted,
    pub fit_rest: Rest,
    pub check_rest: Rest,
    pub fit_gain: f64,
    pub check_gain: f64,
    /// Probability that chance makes the gain on the check runs,
    pub p: f64,
    /// and that it makes that and the gain on the fit runs of a fit to the check runs, where that was asked for.
    pub p_in_turn: Option<f64>,
    /// Why it may not be named, if so.
    pub refuted: Option<String>,
}

/// Runs for screening, as numbers among the fit runs: those that together show most of what is left of every channel, or those
/// of which answers are known, if they show this part of that; then others spread evenly.
fn some_of(study: &Study<'_>, rest: &Rest, known: &[usize], part: f64) -> Vec<usize> {
    let count = study.fit_runs.len();
    let left = |i: usize| -> Vec<f64> {
        let run = study.fit_runs[i];
        let channels = run.channels.iter().zip(&rest.simulated[i]).zip(&study.weights);
        let square = |((c, s), w): ((&Channel, &Vec<f64>), &f64)| {
            let errors = c.values.iter().zip(s).map(|(m, s)| (w * (m - s)).powi(2));
            errors.sum::<f64>() / run.time.len().max(1) as f64
        };
        channels.map(square).collect()
    };
    let left: Vec<Vec<f64>> = (0..count).map(left).collect();
    let mut shown = vec![0.0_f64; study.weights.len()];
    let mut chosen: Vec<usize> = Vec::new();
    while chosen.len() < SCREENED.div_ceil(2).min(count) {
        let more = |i: usize| left[i].iter().zip(&shown).map(|(l, s)| (l - s).max(0.0)).sum::<f64>();
        let open = (0..count).filter(|i| !chosen.contains(i));
        let Some(next) = open.max_by(|a, b| more(*a).total_cmp(&more(*b)).then(b.cmp(a))) else { break };
        shown.iter_mut().zip(&left[next]).for_each(|(s, l)| *s = s.max(*l));
        chosen.push(next);
    }
    let show = |runs: &[usize]| -> f64 {
        (0..study.weights.len()).map(|c| runs.iter().map(|i| left[*i][c]).fold(0.0, f64::max)).sum()
    };
    if !known.is_empty() && show(known) >= part * show(&chosen) {
        chosen = known.to_vec();
    }
    let n = SCREENED - SCREENED.div_ceil(2);
    chosen.extend((0..n).map(|i| (2 * i + 1) * count / (2 * n)));
    let mut seen = BTreeSet::new();
    chosen.retain(|i| seen.insert(*i));
    chosen
}

/// All that the catalogue and the empirical functions offer on this model, screened: all with two runs,
/// the best of them with more. Runs of which answers are known serve if they show this part of what is left.
pub(super) fn screen(
    study: &Study<'_>,
    subject: &Subject,
    roles: &Roles,
    current: &Fitted,
    current_fit: &Rest,
    (recalled, part): (&mut Recalled, f64),
) -> Result<Vec<Screened>> {
    let interface = &subject.interface;
    let chosen = some_of(study, current_fit, &recalled.runs, part);
    let first = &chosen[..FIRST.min(chosen.len())];
    let stride = (first == recalled.runs).then_some(recalled.stride);
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
    // what is held by a bound explains no more of what is left
    let held = current.fit.held_by_bounds(&current.unknowns);
    let steps: Vec<(usize, f64)> = (current.unknowns.iter().zip(&point).enumerate())
        .filter(|(i, _)| !held.contains(i))
        .map(|(i, (u, x))| (i, u.step_at(*x)))
        .collect();
    let rough = study.roughly();
    let problem = rough.problem(&current.model, runs.clone());
    let model = &current.model;
    let screen =
        Screen::new(&problem, &simulated, model, &point, &steps, Arc::clone(&watch), &study.weights, stride)
            .ok_or_else(|| Error::numeric("the fitted model cannot be run"))?;
    if stride.is_none() {
        recalled.begin(first.to_vec(), screen.stride(), &study.weights);
    }
    let measured: Vec<usize> =
        runs.first().map_or(Vec::new(), |r| r.channels.iter().map(|c| c.variable).collect());
    let driven: Vec<usize> =
        runs.first().map_or(Vec::new(), |r| r.drive.inputs.iter().map(|(v, _)| *v).collect());
    // what holds one value in each run, such as a state at the start, has no way on which something could happen to it
    let moves = |v: &usize| {
        let courses = study.fit_runs.iter().flat_map(|r| &r.drive.inputs).filter(|(w, _)| w == v);
        courses
            .into_iter()
            .any(|(_, course)| amplitude(course) > 1e-9 * root_mean_square(course.iter().copied()))
    };
    let moving: Vec<usize> = driven.iter().copied().filter(moves).collect();
    let first_seen = || natural(study, interface, roles, model, &runs, &screen, &watch, (&measured, &driven));
    let natural = recalled.natural.get_or_insert_with(first_seen).clone();
    let tunable = study.free.iter().map(|p| p.variable).filter(|v| is_tunable(interface, *v)).collect();
    let site = Site { interface, roles, measured: &measured, driven: moving, tunable, natural };
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
    let all = placements.len();
    let counted = |screened: Vec<Screened>| -> Vec<Screened> {
        let own = |s: Screened| Screened { places: places(s.placement.effect.id), all_places: all, ..s };
        screened.into_iter().map(own).collect()
    };
    Ok(counted(screen.screen(interface, &placements, recalled)))
}

/// What is natural for the machine, as it moves in these runs.
#[allow(clippy::too_many_arguments)] // one caller
fn natural(
    study: &Study<'_>,
    interface: &Interface,
    roles: &Roles,
    model: &Model,
    runs: &[&Run],
    screen: &Screen<'_>,
    watch: &[usize],
    (measured, driven): (&[usize], &[usize]),
) -> Natural {
    let drives: Vec<Arc<Drive>> = runs.iter().map(|r| Arc::clone(&r.drive)).collect();
    let (mut size, rate) = sizes(interface.variables.len(), watch, &drives, &screen.traces);
    for p in &study.free {
        size[p.variable] = p.scale;
    }
    // a model may leave an output at rest that moves
    for channel in runs.iter().flat_map(|r| &r.channels) {
        let own = root_mean_square(channel.values.iter().copied());
        size[channel.variable] = size[channel.variable].max(own);
    }
    let setup = Arc::new(study.problem(model, runs.to_vec()).setup(&Study::point(model)));
    let forces = Forces { bench: study.bench, setup, drives: &drives };
    let inputs = Forces::inputs(interface, roles);
    for force in &inputs {
        if size[*force] == 0.0 {
            size[*force] = forces.size(*force, measured, &size);
        }
    }
    let moving: Vec<usize> = measured.iter().chain(driven).copied().collect();
    let time = own_time(&moving, watch, &drives, &screen.traces);
    let against = (inputs.into_iter())
        .flat_map(|force| {
            forces.against(force, size[force], roles).into_iter().map(move |motion| (force, motion))
        })
        .collect();
    let own = |role: Role| -> Vec<usize> {
        let signals = roles.signals(interface, role).into_iter();
        signals.filter(|s| s.source == Source::Value).map(|s| s.variable).collect()
    };
    let shown = shown_twice(&own(Role::Velocity), &own(Role::Position), watch, &screen.traces);
    Natural { size, rate, time, against, shown }
}

/// The best placement of the best effects: named ones and empirical functions; fewer after the first round.
pub(super) fn choose(screened: &[Screened], round: usize) -> Vec<Screened> {
    let mut chosen: Vec<Screened> = Vec::new();
    let is_new =
        |chosen: &[Screened], o: &Screened| !chosen.iter().any(|c| c.placement.is_same(&o.placement));
    for (named, limits) in [(true, NAMED), (false, UNNAMED)] {
        let (limit, least) = (limits[round.min(1)], MIN_PROMISE[round.min(1)]);
        let mut count = 0;
        for s in screened.iter().filter(|s| empirical::is(s.placement.effect) != named) {
            let best =
                screened.iter().find(|s| empirical::is(s.placement.effect) != named).map_or(0.0, |b| b.gain);
            if count == limit || s.gain < 0.1 * best || s.gain < least {
                break;
            }
            if !is_new(&chosen, s) {
                continue;
            }
            // other places of the same effect only if they are about as good
            let has_part = |c: &Screened| chosen.iter().any(|o| c.placement.is_fuller(&o.placement));
            let mut same =
                chosen.iter().filter(|c| c.placement.effect.id == s.placement.effect.id && !has_part(c));
            if same.clone().count() > 1 || same.next().is_some_and(|first| s.gain < 0.6 * first.gain) {
                continue;
            }
            // what it may be no more than is tried beside it
            let place = &s.placement;
            for nested in simpler(place.effect) {
                let same = |o: &&Screened| {
                    nested.is_simpler(o.placement.effect) && o.placement.targets == place.targets
                };
                let found = screened.iter().find(same).filter(|o| is_new(&chosen, o)).cloned();
                chosen.extend(found);
            }
            // and what it may be a part of, as sliding along one axis is of sliding along both
            let found = screened.iter().find(|o| o.placement.is_fuller(place));
            let found = found.filter(|o| is_new(&chosen, o)).cloned();
            chosen.push(s.clone());
            chosen.extend(found);
            count += 1;
        }
    }
    chosen
}

impl Tried {
    /// Which effect, and where.
    pub fn placement(&self) -> &Placement {
        &self.screened.placement
    }

    /// What its form costs, in units of twice the logarithm of a likelihood with so many independent
    /// samples (Schwarz's criterion): its parameters, and the places among which it could choose.
    pub fn price(&self, independent: f64) -> f64 {
        let parameters = self.placement().effect.parameters.len() as f64;
        parameters * independent.ln() + 2.0 * (self.screened.places as f64).ln()
    }
}

/// Fits those that are nearly the best to the end; of these, those that are as good as the best go on as long as they have used up all
/// of their iterations, because a name that is still on its way down a valley is neither better nor worse than another.
pub(super) fn polish(study: &Study<'_>, tried: &mut [Tried], before: Before<'_>) {
    fit_on(study, tried, before, (NEARLY, POLISH), |_| true);
    for _ in 0..GO_ON {
        if !fit_on(study, tried, before, (CLOSE, FINAL), |t| t.fitted.fit.end == End::Iterations) {
            break;
        }
    }
}

/// Goes on with the fits of those that miss no more than a share of what the best one explains. False if none of them came farther.
fn fit_on(
    study: &Study<'_>,
    tried: &mut [Tried],
    before: Before<'_>,
    (share, iterations): (f64, usize),
    of: impl Fn(&Tried) -> bool + Sync,
) -> bool {
    let both = |t: &Tried| t.fit_rest.total + t.check_rest.total;
    let best = tried.iter().map(both).fold(f64::INFINITY, f64::min);
    let explained = (before.fit.total + before.check.total - best).max(0.0);
    let better = |t: &Tried| {
        if !of(t) || both(t) > best + share * explained {
            return None;
        }
        let fitted = study.fit_on(&t.fitted, iterations).ok()?;
        let fitted = plausible(study, &fitted, before.fit).unwrap_or(fitted);
        assess(study, &t.screened, fitted, before).filter(|b| b.fit_rest.cost <= t.fit_rest.cost)
    };
    let better = side_by_side(study.bench.threads(), tried, better);
    let mut came_farther = false;
    for (t, better) in tried.iter_mut().zip(better) {
        if let Some(better) = better.flatten() {
            came_farther |= better.fit_rest.cost < t.fit_rest.cost;
            *t = better;
        }
    }
    came_farther
}

pub(super) fn assess(
    study: &Study<'_>,
    screened: &Screened,
    fitted: Fitted,
    before: Before<'_>,
) -> Option<Tried> {
    let fit_rest = study.fit_rest(&fitted).ok()?;
    let check_rest = study.rest(&fitted.model, &study.check_runs).ok()?;
    // every channel in units of what is left of it, so that a small effect in one is not lost among the others
    let units = fit_rest.by_channel();
    let chance = |a: &Rest, b: &Rest| sign_flip(&differences(&a.in_units(&units), &b.in_units(&units)));
    let p = chance(before.check, &check_rest);
    let refuted = implausible(&fitted.model)
        .or_else(|| spoils(&before.check.by_channel(), &check_rest.by_channel(), study));
    Some(Tried {
        screened: screened.clone(),
        fit_gain: 1.0 - fit_rest.total / before.fit.total.max(f64::MIN_POSITIVE),
        check_gain: 1.0 - check_rest.total / before.check.total.max(f64::MIN_POSITIVE),
        fitted,
        fit_rest,
        check_rest,
        p,
        p_in_turn: None,
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{Port, Signal};

    /// An effect at a parameter, driven by these signals, that promises so much.
    fn promised(id: &str, target: usize, drivers: &[usize], gain: f64) -> Screened {
        let is_form = |e: &&Effect| e.id == id && e.drivers.len() == drivers.len();
        let effect = catalogue::EFFECTS.iter().find(is_form).unwrap();
        let count = effect.parameters.len();
        Screened {
            placement: Placement {
                effect,
                port: Port::Parameter,
                targets: vec![target],
                drivers: drivers.iter().map(|v| Signal::value(*v)).collect(),
                scales: vec![1.0; count],
                units: vec![None; count],
                bounded: false,
            },
            values: vec![0.0; count],
            wholes: Vec::new(),
            gain,
            places: 1,
            all_places: 1,
        }
    }

    #[test]
    fn sliding_along_both_axes_is_fitted_beside_sliding_along_one() {
        let of = |target: usize, drivers: &[usize], gain: f64| {
            promised("speed-dependent-friction", target, drivers, gain)
        };
        // two places of an effect are enough, unless what is driven by more signals has one of them as a part
        let screened = [
            of(7, &[1, 2], 0.15),
            of(8, &[1, 2], 0.14),
            of(9, &[1, 2], 0.13),
            of(9, &[1, 2, 3], 0.12),
            of(8, &[1, 4, 5], 0.12),
            of(7, &[1, 2, 3], 0.11),
        ];
        let chosen = choose(&screened, 0);
        let kept: Vec<f64> = chosen.iter().map(|s| s.gain).collect();
        assert_eq!(kept, [0.15, 0.11, 0.14]);
    }
}
