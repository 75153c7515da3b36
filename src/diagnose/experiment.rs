//! What to measure next: the names that the recordings do not separate are simulated as rivals on a library of
//! rig programmes, and the programme is proposed on which they differ most.
//!
//! Rivals were fitted to the same recordings. How far two of them differ on a programme is counted after
//! either has been fitted once more to what the other does there, as far as the recordings leave its own
//! parameters open: to first order, with their covariance from the fit as what is known beforehand. The unit
//! is the noise of each measured channel.

use super::locate;
use super::negligible::{error, negligible};
use super::placement::Placement;
use super::programmes::{Programme, library, rounded};
use super::rest::Rest;
use super::result::{Experiment, Separation};
use super::roles::Roles;
use super::study::{Fitted, Model, Study};
use crate::fit::{Drive, Run, Setup};
use crate::stats::mean_or_zero;
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// Rivals that differ by less than so many times the noise are not separated.
const ENOUGH: f64 = 2.0;
/// What is less has no number of its own in words.
const NOTHING: f64 = 0.1;
/// Of programmes that separate by this share of the most, the shortest is proposed.
const NEARLY: f64 = 0.9;
/// Rivals at most: the one that was named and the likeliest of the others.
const MAX_RIVALS: usize = 5;
/// Programmes that are simulated together.
const TOGETHER: usize = 4;
/// What may be simulated at most, as a multiple of what was recorded, and the share of it after which no more programmes
/// are begun: a small part of what a diagnosis simulates, some hundred times the recordings.
const BUDGET: f64 = 30.0;
const FIRST_LOOK: f64 = 0.6;

/// A fitted model that explains the recordings as well as others do.
pub(super) struct Rival {
    /// Id of the effect that it has more than the model that all of them begin with.
    effect: String,
    /// Where that acts.
    place: String,
    model: Model,
    /// Steps of differences of the effect's parameters, which are the last of the unknowns.
    steps: Vec<f64>,
    /// What the recordings leave open of them: a matrix L with the covariance L L^T.
    spread: DMatrix<f64>,
}

impl Rival {
    /// The model that was fitted with an effect.
    pub(super) fn of(study: &Study<'_>, placement: &Placement, fitted: &Fitted) -> Self {
        let point = Study::point(&fitted.model);
        let own = placement.effect.parameters.len().min(point.len());
        let first = point.len() - own;
        let step = |(u, x): (&crate::fit::Unknown, &f64)| u.step_at(*x);
        let covariance = study.covariance(fitted);
        let block = covariance.matrix().view((first, first), (own, own)).into_owned();
        // rounding may leave it a hair from positive; then each parameter by itself
        let alone = DMatrix::from_diagonal(&block.diagonal().map(|v| v.max(0.0).sqrt()));
        Self {
            effect: placement.effect.id.into(),
            place: placement.place(study.bench.interface()),
            steps: fitted.unknowns[first..].iter().zip(&point[first..]).map(step).collect(),
            spread: block.cholesky().map_or(alone, |c| c.l()),
            model: fitted.model.clone(),
        }
    }

    /// Where it stands, and beside that with each of its effect's parameters one step on.
    fn points(&self) -> Vec<Vec<f64>> {
        let point = Study::point(&self.model);
        let first = point.len() - self.steps.len();
        let moved = self.steps.iter().enumerate().map(|(i, step)| {
            let mut moved = point.clone();
            moved[first + i] += step;
            moved
        });
        std::iter::once(point.clone()).chain(moved).collect()
    }
}

/// The experiment that separates the first rival from the others, as far as there is one. `left` is what the
/// last model leaves of the check runs. `None` if there is nothing to separate, or no programme can be run.
pub(super) fn propose(study: &Study<'_>, roles: &Roles, rivals: &[Rival], left: &Rest) -> Option<Experiment> {
    let runs = study.fit_runs.iter().chain(&study.check_runs);
    let recorded: f64 = runs.map(|run| run.drive.length()).sum();
    propose_within(study, roles, rivals, &noises(study, left), BUDGET * recorded)
}

/// Noise of every measured channel, in its unit: what is left of it where it cannot be told from that, and never
/// less than what says something of a channel.
fn noises(study: &Study<'_>, left: &Rest) -> Vec<f64> {
    let (runs, left) = (&study.check_runs, &left.simulated);
    let noise = |c: usize| locate::noise(runs, left, c).unwrap_or_else(|| error(runs, left, c));
    (0..study.weights.len()).map(|c| noise(c).max(negligible(runs, c))).collect()
}

fn propose_within(
    study: &Study<'_>,
    roles: &Roles,
    rivals: &[Rival],
    noise: &[f64],
    budget: f64,
) -> Option<Experiment> {
    let stand = Stand { study, rivals: &rivals[..rivals.len().min(MAX_RIVALS)], noise };
    let (chosen, others) = stand.rivals.split_first().filter(|(_, others)| !others.is_empty())?;
    let runs: Vec<&Run> = study.fit_runs.iter().chain(&study.check_runs).copied().collect();
    let programmes = library(study.bench.interface(), roles, &runs);

    // a fit never makes rivals differ more: what they differ by as they are is the most that is possible
    let mut bounds: Vec<(Score, &Programme)> = Vec::new();
    let (mut tried, mut spent) = (0, 0.0);
    let close_points: usize = stand.rivals.iter().map(|r| 1 + r.steps.len()).sum();
    let length = |programme: &Programme| programme.drive.length();
    for some in programmes.chunks(TOGETHER) {
        if tried > 0 && spent > FIRST_LOOK * budget {
            break;
        }
        tried += some.len();
        spent += stand.rivals.len() as f64 * some.iter().map(length).sum::<f64>();
        let differences = stand.differ(some).into_iter().zip(some);
        bounds.extend(differences.filter_map(|(d, programme)| Some((Score::of(&d?), programme))));
    }
    bounds.sort_by(|a, b| b.0.order(&a.0));
    let mut close: Vec<(Score, &Programme, Vec<Shown>)> = Vec::new();
    let mut best: Option<Score> = None;
    for (bound, programme) in &bounds {
        if best.is_some_and(|best| spent > budget || !bound.is_near(&best)) {
            break;
        }
        spent += close_points as f64 * length(programme);
        let Some(shown) = stand.differ_refitted(programme) else { continue };
        let score = Score::of(&shown);
        if best.is_none_or(|best| score.order(&best).is_gt()) {
            best = Some(score);
        }
        close.push((score, programme, shown));
    }
    let best = best?;
    close.retain(|(score, ..)| score.is_near(&best));
    let shortest = |programme: &Programme| (programme.beyond, programme.drive.points);
    let (_, programme, shown) = close.into_iter().min_by_key(|(_, programme, _)| shortest(programme))?;

    // the hardest of those that are separated, or of all
    let separated = |s: &&Shown| best.count == 0 || s.by >= ENOUGH;
    let hardest = shown.iter().filter(separated).min_by(|a, b| a.by.total_cmp(&b.by))?;
    let channel = study.fit_runs.first()?.channels.get(hardest.channel)?.variable;
    let of = |(rival, shown): (&Rival, &Shown)| Separation {
        effect: rival.effect.clone(),
        place: rival.place.clone(),
        separation: shown.by,
    };
    Some(Experiment {
        effect: chosen.effect.clone(),
        place: chosen.place.clone(),
        programme: programme.words.clone(),
        channel: study.bench.interface().variables[channel].name.clone(),
        separation: hardest.by,
        rivals: others.iter().zip(&shown).map(of).collect(),
        tried,
    })
}

/// How far a rival differs from the first one: root mean square over noise, in the channel that shows it best.
#[derive(Debug, Clone, Copy)]
struct Shown {
    by: f64,
    channel: usize,
}

/// What a programme is worth: rivals that it separates from the first one, and how far the nearest of them is;
/// without any, how far the nearest of all.
#[derive(Debug, Clone, Copy)]
struct Score {
    count: usize,
    nearest: f64,
}

impl Score {
    fn of(shown: &[Shown]) -> Self {
        let mut by: Vec<f64> = shown.iter().map(|s| s.by).collect();
        by.sort_by(|a, b| b.total_cmp(a));
        let count = by.partition_point(|by| *by >= ENOUGH);
        let last = if count > 0 { count } else { by.len() };
        Self { count, nearest: by[..last].last().copied().unwrap_or_default() }
    }

    fn order(&self, other: &Self) -> std::cmp::Ordering {
        self.count.cmp(&other.count).then(self.nearest.total_cmp(&other.nearest))
    }

    fn is_near(&self, best: &Self) -> bool {
        self.count > best.count || (self.count == best.count && self.nearest >= NEARLY * best.nearest)
    }
}

/// Measured channels on a programme at the samples of a recorder, one after the other, in units of their noise.
type Answer = DVector<f64>;

/// The rivals, ready to be driven.
struct Stand<'a> {
    study: &'a Study<'a>,
    rivals: &'a [Rival],
    noise: &'a [f64],
}

impl Stand<'_> {
    /// What rivals at points make of programmes: for each point and programme; `None` where it cannot be run.
    fn answers(&self, points: &[(&Rival, Vec<f64>)], programmes: &[Programme]) -> Vec<Vec<Option<Answer>>> {
        let Some(first) = self.study.fit_runs.first() else { return Vec::new() };
        let watch: Arc<[usize]> = first.channels.iter().map(|c| c.variable).collect();
        let setups: Vec<Arc<Setup>> = points
            .iter()
            .map(|(rival, point)| Arc::new(self.study.problem(&rival.model, Vec::new()).setup(point)))
            .collect();
        let drives: Vec<Arc<Drive>> = programmes.iter().map(|p| Arc::clone(&p.drive)).collect();
        let mut results = self.study.bench.run(&setups, &drives, &watch).into_iter();
        let mut answers = Vec::new();
        for (rival, _) in points {
            let lag =
                rival.model.parameters.get(self.study.free.len()).map_or(0.0, |lag| lag * self.study.lag);
            let of = |drive: &Arc<Drive>| {
                let traces = results.next()?.ok()?;
                let run = Run {
                    name: String::new(),
                    time: (0..drive.points).map(|k| drive.time(k)).collect(),
                    drive: Arc::clone(drive),
                    channels: Vec::new(),
                };
                let mut values = Vec::with_capacity(drive.points * traces.len());
                for ((trace, channel), noise) in traces.iter().zip(&first.channels).zip(self.noise) {
                    let own = run.sample(trace, lag);
                    let mean = mean_or_zero(&own);
                    // what counts on and on has no zero of its own, what has no noise says nothing
                    let zero = if channel.counts { mean } else { 0.0 };
                    let unit = if *noise > 0.0 { 1.0 / noise } else { 0.0 };
                    values.extend(own.iter().map(|v| unit * (v - zero)));
                }
                Some(DVector::from_vec(values)).filter(|v| v.iter().all(|v| v.is_finite()))
            };
            answers.push(drives.iter().map(of).collect());
        }
        answers
    }

    /// How far every rival differs from the first on each programme, as they are; `None` where one of them
    /// cannot be run.
    fn differ(&self, programmes: &[Programme]) -> Vec<Option<Vec<Shown>>> {
        let points: Vec<_> = self.rivals.iter().map(|r| (r, Study::point(&r.model))).collect();
        let answers = self.answers(&points, programmes);
        let on = |k: usize| {
            let (first, others) = answers.split_first()?;
            let chosen = first.get(k)?.as_ref()?;
            others.iter().map(|other| Some(self.shown(&(chosen - other.get(k)?.as_ref()?)))).collect()
        };
        (0..programmes.len()).map(on).collect()
    }

    /// The same on one programme after refits: of the rival to what the first one does, and the other way round;
    /// the smaller counts, because either may be right.
    fn differ_refitted(&self, programme: &Programme) -> Option<Vec<Shown>> {
        let points: Vec<_> =
            self.rivals.iter().flat_map(|r| r.points().into_iter().map(move |p| (r, p))).collect();
        let answers = self.answers(&points, std::slice::from_ref(programme));
        let mut rest = answers.into_iter().map(|mut a| a.pop().flatten());
        // base, and what the parameters within their spread do to it
        let mut all: Vec<(Answer, DMatrix<f64>)> = Vec::new();
        for rival in self.rivals {
            let base = rest.next()??;
            let mut moves = DMatrix::zeros(base.len(), rival.steps.len());
            for (i, step) in rival.steps.iter().enumerate() {
                // a parameter that leads to where the model cannot be run absorbs nothing
                if let Some(moved) = rest.next()? {
                    moves.set_column(i, &((moved - &base) / *step));
                }
            }
            all.push((base, moves * &rival.spread));
        }
        let ((chosen, its_moves), others) = all.split_first()?;
        let of = |(other, moves): &(Answer, DMatrix<f64>)| {
            let difference = chosen - other;
            let both =
                [moves, its_moves].map(|m| self.shown(&absorbed(&difference, m, self.study.redundancy)));
            if both[0].by <= both[1].by { both[0] } else { both[1] }
        };
        Some(others.iter().map(of).collect())
    }

    /// The channel that shows a difference best, and by how many times its noise.
    fn shown(&self, difference: &Answer) -> Shown {
        let samples = difference.len() / self.noise.len().max(1);
        let by =
            |c: usize| (difference.rows(c * samples, samples).norm_squared() / samples.max(1) as f64).sqrt();
        let all = (0..self.noise.len()).map(|channel| Shown { by: by(channel), channel });
        all.max_by(|a, b| a.by.total_cmp(&b.by)).unwrap_or(Shown { by: 0.0, channel: 0 })
    }
}

/// What is left of a difference after a refit: the least sum of squares over the noise, of which `redundancy`
/// samples tell as much as one, and of the amounts of `moves`, which have the standard deviation 1 beforehand.
fn absorbed(difference: &Answer, moves: &DMatrix<f64>, redundancy: f64) -> Answer {
    let mut normal = moves.tr_mul(moves);
    for i in 0..normal.nrows() {
        normal[(i, i)] += redundancy.max(1.0);
    }
    let amounts = normal.cholesky().map(|c| c.solve(&moves.tr_mul(difference)));
    amounts.map_or_else(|| difference.clone(), |amounts| difference - moves * amounts)
}

/// What to measure next in words: the programme and what it shows, and what the catalogue says of the rivals.
pub(super) fn sentence(experiment: Option<&Experiment>, catalogue: &str) -> String {
    let Some(e) = experiment else { return catalogue.into() };
    let number = crate::page::number;
    let names = |rivals: &[&Separation]| {
        let each: Vec<String> = rivals.iter().map(|r| format!("{} ({})", r.effect, r.place)).collect();
        each.join(" and ")
    };
    let (near, far): (Vec<_>, Vec<_>) = e.rivals.iter().partition(|r| r.separation < ENOUGH);
    let chosen = format!("{} ({})", e.effect, e.place);
    let by = match e.separation {
        small if small < NOTHING => format!("less than {NOTHING} times the noise of {}", e.channel),
        by => format!("{} times the noise of {}", number(rounded(by)), e.channel),
    };
    let mut words = if far.is_empty() {
        format!(
            "None of the {} programmes that were simulated separates {chosen} from {}: with the fitted models they differ by {by} at the most ({}).",
            e.tried,
            names(&near),
            e.programme
        )
    } else {
        format!(
            "To separate {chosen} from {}: {}. Simulated with the fitted models they then differ by {by}, after what a refit of their parameters takes away.",
            names(&far),
            e.programme
        )
    };
    if !far.is_empty() && !near.is_empty() {
        let none = format!(
            " None of the {} programmes that were simulated separates {} too.",
            e.tried,
            names(&near)
        );
        words += &none;
    }
    if !catalogue.is_empty() {
        words += &format!(" In general: {catalogue}.");
    }
    words
}

#[cfg(test)]
mod tests;
