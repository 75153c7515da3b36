//! How the fits of screened effects begin: from where the fit without them ended, or from nominal parameters
//! where that fit has bent them.

use super::candidates::{Before, NEARLY, Tried, assess, choose, screen};
use super::numbers::MIN_GAIN;
use super::plausible::plausible;
use super::recalled::Recalled;
use super::roles::Roles;
use super::screen::Screened;
use super::study::{Fitted, Model, Study};
use super::subject::Subject;
use crate::effect::{Parameter, empirical};
use crate::fit::side_by_side;

/// Iterations of each half of a first fit.
const TRY_OUT: usize = 5;
/// Fits that keep so much of what screening promised need not begin elsewhere.
const KEPT_PROMISE: f64 = 0.7;
/// A parameter is bent if a refit moves it by more than this share.
const BENT: f64 = 0.2;
/// Effects that are fitted beside the chosen ones because they are promising at nominal parameters.
const ALSO: usize = 3;
/// Of those that are promising there, the ones that promise this share of what the best does.
const PROMISING: f64 = 0.5;
/// How often the range of an amplitude is made wider at whose end a fit comes to rest, and how many times wider: its natural
/// size is a guess from what signals move, which may be far from what a machine has, as near a resonance.
const WIDER: usize = 3;
const TIMES: f64 = 10.0;

/// What a fit near a model leaves beyond what it says, as a share of what it says to explain, from which on it is not believed: what is
/// fitted to the end misses three times as much. And how often it goes on near where it has come to: once was enough in what was looked at.
const ASTRAY: f64 = 0.1;
const NEARER: usize = 2;

/// An effect that misses more than this share of what the best one explains is given up.
const HOPELESS: f64 = 0.6;

/// A screened effect whose fit has begun.
pub(super) struct Begun {
    pub screened: Screened,
    pub fitted: Fitted,
}

/// Begins to fit the most promising of the screened effects beside what is known already, in a study that simulates what is near
/// that. `nominal` is the
/// model as it is given; nothing begins there if it is none. Effects that explain much less than the best are
/// left out.
pub(super) fn begin(
    (study, near): (&Study<'_>, &Study<'_>),
    subject: &Subject,
    roles: &Roles,
    current: &Fitted,
    nominal: Option<&Model>,
    (screened, recalled): (&[Screened], &mut Recalled),
    round: usize,
) -> Vec<Begun> {
    let chosen = choose(screened, round);
    let mut begun = in_order(study, &chosen, |s| Begun::from_current(near, current, s));
    let promised = chosen.iter().map(|s| s.gain).fold(0.0, f64::max);
    let reached = begun.iter().map(Begun::cost).fold(f64::INFINITY, f64::min);
    let is_kept = reached <= (1.0 - KEPT_PROMISE * promised) * current.fit.cost;
    let more = nominal.map_or(Vec::new(), |n| {
        from_nominal((study, near), subject, roles, current, n, (&chosen, recalled), (round, is_kept))
    });
    for other in more {
        match begun.iter_mut().find(|b| b.screened.placement.is_same(&other.screened.placement)) {
            Some(same) if same.cost() <= other.cost() => {}
            Some(same) => *same = other,
            // from the end of the refit, near which it promised less, it may come farther than from where nothing has ended
            None => {
                let own = Begun::from_current(near, current, &other.screened);
                begun.push(own.filter(|own| own.cost() < other.cost()).unwrap_or(other));
            }
        }
    }
    // a function without a name keeps more than it promised, so that names are held against names
    for named in [true, false] {
        let alike = |b: &Begun| empirical::is(b.screened.placement.effect) != named;
        let missing =
            |begun: &[Begun], share: f64| Begun::missing(begun.iter().filter(|b| alike(b)), share, current);
        let nearly = missing(&begun, NEARLY);
        let anew = |b: &Begun| if alike(b) { b.anew(near, current, nearly) } else { None };
        let begun_anew = side_by_side(study.bench.threads(), &begun, anew);
        for (own, anew) in begun.iter_mut().zip(begun_anew) {
            if let Some(anew) = anew.flatten() {
                *own = anew;
            }
        }
        let most = missing(&begun, HOPELESS);
        begun.retain(|b| !alike(b) || b.cost() <= most);
    }
    begun
}

/// Begins at nominal parameters: with what is screened there if the refit has bent any, because what such a refit leaves says
/// little of what bent it; else with the same effects, if fits from where it ended have not kept what was promised.
fn from_nominal(
    (study, near): (&Study<'_>, &Study<'_>),
    subject: &Subject,
    roles: &Roles,
    current: &Fitted,
    nominal: &Model,
    (chosen, recalled): (&[Screened], &mut Recalled),
    (round, is_kept): (usize, bool),
) -> Vec<Begun> {
    let model = Model { parameters: nominal.parameters.clone(), ..current.model.clone() };
    let is_bent = bent(study, &current.model, &model);
    if is_kept && !is_bent {
        return Vec::new();
    }
    let Ok(there) = study.fit(&model, 1) else { return Vec::new() };
    // far from the end, but where the derivatives are known
    let begin = |s: &Screened| {
        let fitted = near.fit_near(&with(&there, s, small(s)), TRY_OUT + 1, &there).ok()?;
        Some(Begun { screened: s.clone(), fitted })
    };
    if !is_bent {
        return in_order(study, chosen, begin);
    }
    let rest = study.fit_rest(&there);
    // what the given parameters leave is mostly what others explain: the runs that show what these cannot are those of the refit
    let screened = rest.and_then(|rest| screen(study, subject, roles, &there, &rest, (recalled, 0.0)));
    let Ok(screened) = screened else { return Vec::new() };
    let most = screened.iter().map(|s| s.gain).fold(0.0, f64::max);
    let is_chosen = |s: &&Screened| chosen.iter().any(|c| c.placement.is_same(&s.placement));
    let also = choose(&screened, round);
    let also = also.iter().filter(|s| !is_chosen(s)).take(ALSO);
    let promising = screened.iter().filter(is_chosen).chain(also).filter(|s| s.gain > PROMISING * most);
    in_order(study, &promising.cloned().collect::<Vec<_>>(), begin)
}

/// What comes of the beginnings, in their order.
fn in_order(
    study: &Study<'_>,
    screened: &[Screened],
    begin: impl Fn(&Screened) -> Option<Begun> + Sync,
) -> Vec<Begun> {
    side_by_side(study.bench.threads(), screened, begin).into_iter().flatten().flatten().collect()
}

/// The model with one effect more.
fn with(from: &Fitted, screened: &Screened, values: Vec<f64>) -> Model {
    let mut model = from.model.clone();
    model.effects.push((screened.placement.clone(), values));
    model
}

/// What was screened, near its off value, so that the parameters move along.
fn small(screened: &Screened) -> Vec<f64> {
    let near = |(value, parameter): (&f64, &Parameter)| match parameter.off {
        Some(off) => {
            let small = parameter.probes.first().map_or(f64::INFINITY, |p| p.abs());
            off + (0.1 * (value - off)).clamp(-small, small)
        }
        None => *value,
    };
    screened.values.iter().zip(screened.placement.effect.parameters).map(near).collect()
}

/// Whether a parameter is far from its nominal value.
pub(super) fn bent(study: &Study<'_>, model: &Model, nominal: &Model) -> bool {
    let parameters = model.parameters.iter().zip(&nominal.parameters);
    parameters.take(study.free.len()).any(|(x, n)| (x - n).abs() > BENT * n.abs())
}

impl Begun {
    /// Begins where the fit without the effect ended: near its off value, with the size with which it explains something as a
    /// whole, and for one that is there as a whole or not at all in the middle of what is plausible.
    fn from_current(study: &Study<'_>, current: &Fitted, screened: &Screened) -> Option<Self> {
        let begin =
            |values: Vec<f64>| study.fit_near(&with(current, screened, values), TRY_OUT, current).ok();
        let near = begin(small(screened));
        let parameters = screened.placement.effect.parameters;
        let whole = |p: &Parameter| p.off.is_some_and(|off| off < p.plausible.0);
        let there = parameters.iter().any(whole).then(|| {
            let of = |(value, p): (&f64, &Parameter)| {
                if whole(p) { 0.5 * (p.plausible.0 + p.plausible.1) } else { *value }
            };
            begin(screened.values.iter().zip(parameters).map(of).collect())
        });
        // what sticks or touches comes to rest elsewhere from another size; far from where an effect is off its derivatives
        // are others
        let sizes = (screened.wholes.iter()).filter_map(|whole| {
            study.fit_roughly(&with(current, screened, whole.clone()), TRY_OUT, None).ok()
        });
        let fits = near.into_iter().chain(there.flatten()).chain(sizes);
        let fitted = fits.min_by(|a, b| a.fit.cost.total_cmp(&b.fit.cost))?;
        Some(Self { screened: screened.clone(), fitted })
    }

    /// Goes on with derivatives where it has come to, if those near its off value have not led to what screening promised: by all that is
    /// unknown, because beside what sticks or touches or has a shape the others do something else; a sum of amplitudes changes
    /// little of that, and needs those by its own parameters only. Such a sum, which cannot keep more than was promised, has none
    /// if it would not even so be one of those that are fitted to the end, which
    /// miss no more than `nearly`; nor has what would be no effect if it kept all of it.
    fn anew(&self, study: &Study<'_>, current: &Fitted, nearly: f64) -> Option<Self> {
        let Self { screened, fitted } = self;
        let with = |share: f64| (1.0 - share * screened.gain) * current.fit.cost;
        // what is no sum of amplitudes, or sticks or touches, may keep more than what a few of its shapes and a small amount promised
        let parameters = screened.placement.effect.parameters;
        let is_sum = screened.wholes.is_empty() && parameters.iter().all(|p| p.off.is_some());
        let loses = is_sum && with(1.0) > nearly;
        if screened.gain < MIN_GAIN || loses || self.cost() < with(KEPT_PROMISE) {
            return None;
        }
        let fitted = if is_sum {
            study.fit_near(&fitted.model, TRY_OUT, current).ok()?
        } else {
            study.fit_roughly(&fitted.model, TRY_OUT, None).ok()?
        };
        Some(Self { screened: screened.clone(), fitted })
    }

    fn cost(&self) -> f64 {
        self.fitted.fit.cost
    }

    /// What those leave that miss this share of what the best of some explains.
    fn missing<'a>(some: impl Iterator<Item = &'a Self>, share: f64, current: &Fitted) -> f64 {
        let best = some.map(Self::cost).fold(f64::INFINITY, f64::min);
        best + share * (current.fit.cost - best).max(0.0)
    }

    /// Goes on with the fits in the study in which they have begun, and looks at what they leave. Where that is more than this study
    /// says, because parameters have moved far, those go on near there that would be fitted to the end if they left what it says.
    pub fn finish(
        begun: &[Self],
        studies: (&Study<'_>, &Study<'_>),
        current: &Fitted,
        before: Before<'_>,
    ) -> Vec<Tried> {
        let nearly = Self::missing(begun.iter(), NEARLY, current);
        let finish = |begun: &Self| begun.finish_one(studies, before, nearly);
        side_by_side(studies.0.bench.threads(), begun, finish).into_iter().flatten().flatten().collect()
    }

    fn finish_one(
        &self,
        (study, near): (&Study<'_>, &Study<'_>),
        before: Before<'_>,
        nearly: f64,
    ) -> Option<Tried> {
        let Self { screened, fitted } = self;
        let ended = |near: &Study<'_>, from: &Fitted| {
            let fitted = near.fit_near(&from.model, TRY_OUT, from).unwrap_or_else(|_| from.clone());
            let fitted = widened(near, fitted);
            let fitted = plausible(near, &fitted, before.fit).unwrap_or(fitted);
            assess(study, screened, fitted, before)
        };
        let is_astray = |tried: &Tried| {
            let said = tried.fitted.fit.cost;
            said <= nearly && tried.fit_rest.cost - said > ASTRAY * (before.fit.cost - said)
        };
        let mut tried = ended(near, fitted)?;
        for _ in 0..NEARER {
            if !is_astray(&tried) {
                break;
            }
            let here = ended(&study.near(&tried.fitted), &tried.fitted);
            let Some(here) = here.filter(|here| here.fit_rest.cost < tried.fit_rest.cost) else { break };
            tried = here;
        }
        Some(tried)
    }
}

/// The fit with wider ranges of those amplitudes of the last effect that are at an end of theirs, as long as it gets better.
/// What is a plain number, a share or a gain, has the range that it has, and so has a function without a name, which can be
/// anything within it.
fn widened(study: &Study<'_>, mut fitted: Fitted) -> Fitted {
    for _ in 0..WIDER {
        let mut model = fitted.model.clone();
        let Some((placement, values)) = model.effects.last_mut() else { break };
        let ended: Vec<usize> = (placement.effect.parameters.iter().zip(&*values).enumerate())
            .filter(|(_, (p, value))| {
                let (low, high) = placement.limits(p);
                p.off.is_some() && !p.scale.is_plain() && (**value <= low || **value >= high)
            })
            .map(|(i, _)| i)
            .collect();
        if ended.is_empty() || placement.bounded || empirical::is(placement.effect) {
            break;
        }
        for i in ended {
            placement.scales[i] *= TIMES;
            values[i] /= TIMES;
        }
        match study.fit_roughly(&model, TRY_OUT, None) {
            Ok(wider) if wider.fit.cost < fitted.fit.cost => fitted = wider,
            _ => break,
        }
    }
    fitted
}
