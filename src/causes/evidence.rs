//! Which causes explain what a part does otherwise than recorded, and whether all runs agree.

mod roads;
mod scan;

pub use roads::OnRoad;

use super::part::Part;
use super::runs::Use;
use super::{Hidden, PartFindings};
use crate::fit::{Options, Problem, Unknown, least_squares};
use crate::model::Value;
use crate::stats::chance::student;
use crate::{Error, Result};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use std::collections::HashMap;
use std::thread;

/// A cause has to explain so much of the squared error, in the runs to fit and in those to check: what a model of the machine that is right leaves beside
/// noise (filters of sensors, its own steps, slips that are not followed in time) looks like small changes of masses and inertias.
const SHARE: f64 = 0.1;
/// A channel scatters by this share of what it varies by in any case: sensors are calibrated to a percent or two, and another program of the same car
/// differs by up to 2.7 % from the shipped one. Errors below that name nothing.
const ACCURACY: f64 = 0.02;
/// Runs agree on a cause by chance less often than this, over all causes that are tried.
const CHANCE: f64 = 0.01;
/// So many causes of a part are named. What a second one would have to explain is not yet told from what following the friction leaves of a wheel that dips: some
/// three percent of what forces vary by, which looks like a slightly other tire.
const MOST: usize = 1;
/// A cause that explains this share of what the best one does is told beside it: recordings of a few runs hardly set them apart.
const NEAR: f64 = 0.8;
/// So many candidates are fitted, those that explain most by their first changes: in the cases of the blind study that were looked at, the right one was among the first two.
const FITTED: usize = 4;
/// A cause whose first changes do less than this share of what there is to explain does not show in these recordings: a hundred times as much would not be named.
const HIDDEN: f64 = 1e-3;
/// First changes are made smaller until they do no more than so many times what there is to explain (as errors, twice as much): beyond, what they do is no longer in proportion.
const TOO_MUCH: f64 = 4.0;
/// A cause that was named.
#[derive(Debug, Clone, Serialize)]
pub struct Found {
    /// Its name for programs.
    pub id: &'static str,
    /// Its name for people.
    pub title: &'static str,
    /// What it makes of parameters.
    pub changes: Vec<Change>,
    /// Share of the squared error that it explains in runs to fit and to check.
    pub explains: [f64; 2],
    /// How probable it is that runs agree so by chance.
    pub chance: f64,
    /// Channels whose error falls most: name, and root mean square before and after over all runs, over the channel's scatter.
    pub channels: Vec<(String, [f64; 2])>,
    /// Other causes that explain nearly as much.
    pub alternatives: Vec<Candidate>,
}

/// A parameter's change.
#[derive(Debug, Clone, Serialize)]
pub struct Change {
    /// `component.variable`, or the name of a recorded input.
    pub name: String,
    /// Its value in the system.
    pub before: Value,
    /// The value that recordings tell.
    pub value: Value,
}

/// A cause that was looked at.
#[derive(Debug, Clone, Serialize)]
pub struct Candidate {
    /// Its name for programs.
    pub id: &'static str,
    /// Its name for people.
    pub title: &'static str,
    /// Share of the squared error that it explains, over all runs,
    pub explains: f64,
    /// and of runs to fit and to check.
    pub in_runs: [f64; 2],
    /// How probable it is that runs agree so by chance.
    pub chance: f64,
}

/// What a part does otherwise than recorded: run, channel, sample.
type Errors = Vec<Vec<Vec<f64>>>;
/// Values of unknowns of causes.
type Changes = Vec<(usize, Vec<f64>)>;

/// Finds the causes of a part.
///
/// # Errors
/// A part that does not run as it is.
pub(super) fn search(part: &dyn Part, jobs: usize) -> Result<PartFindings> {
    let mut changes = Changes::new();
    let mut findings = PartFindings {
        part: part.name(),
        found: Vec::new(),
        left: Vec::new(),
        of_roads: Vec::new(),
        hidden: Vec::new(),
    };
    loop {
        let mut round = Round::new(part, &changes, jobs)?;
        if findings.found.is_empty() {
            findings.hidden = round.hidden();
        }
        let mut fitted = round.fitted();
        round.sharpen(&fitted);
        // with what its channels really scatter by, the likeliest one is found more exactly
        let gain = |one: &Tried| round.whole() - round.weighted(&one.errors);
        let likeliest = (0..fitted.len()).max_by(|a, b| gain(&fitted[*a]).total_cmp(&gain(&fitted[*b])));
        if let Some(k) = likeliest
            && let Some(again) = round.fit(fitted[k].cause, &fitted[k].x)
        {
            fitted[k] = again;
        }
        let mut fitted: Vec<Fitted> = fitted.drain(..).map(|one| round.judged(one)).collect();
        let unknown = |cause: &usize| !changes.iter().any(|(known, _)| known == cause);
        let scanned =
            (0..part.causes().len()).filter(|cause| part.causes()[*cause].scanned.is_some()).filter(unknown);
        fitted.extend(scanned.filter_map(|cause| round.scanned(cause)));
        fitted.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        let candidate = |f: &Fitted| Candidate {
            id: part.causes()[f.cause].id,
            title: part.causes()[f.cause].title,
            explains: f.gain / round.whole(),
            in_runs: f.explains,
            chance: f.chance,
        };
        let named = fitted.first().filter(|best| best.counts(fitted.len().max(part.causes().len())));
        findings.left = fitted[usize::from(named.is_some())..].iter().map(candidate).collect();
        let named_ids = |id: &str| named.is_some_and(|best| part.causes()[best.cause].id == id);
        let roads = (0..part.causes().len())
            .filter(|k| part.causes()[*k].of_roads && !named_ids(part.causes()[*k].id));
        findings.of_roads =
            roads.map(|cause| round.of_roads(cause, named)).collect::<Result<Vec<_>>>()?.concat();
        let Some(best) = named else { return Ok(findings) };
        let cause = &part.causes()[best.cause];
        let near = |f: &&Fitted| f.gain > NEAR * best.gain;
        findings.found.push(Found {
            id: cause.id,
            title: cause.title,
            changes: round.made(best.cause, &best.x)?,
            explains: best.explains,
            chance: best.chance,
            channels: round.channels(best),
            alternatives: fitted[1..].iter().filter(near).map(candidate).collect(),
        });
        if findings.found.len() == MOST {
            return Ok(findings);
        }
        changes.push((best.cause, best.x.clone()));
    }
}

/// A cause with values of its unknowns, and what is left with them.
struct Tried {
    cause: usize,
    x: Vec<f64>,
    errors: Errors,
}

/// A cause, fitted and judged.
struct Fitted {
    cause: usize,
    x: Vec<f64>,
    /// Squared error that it explains, over all runs.
    gain: f64,
    explains: [f64; 2],
    chance: f64,
    /// It is more than what models, sensors and tires are believed to, in the runs to fit and in those to check.
    enough: bool,
    errors: Errors,
}

impl Fitted {
    fn counts(&self, tried: usize) -> bool {
        self.enough && self.chance * tried as f64 <= CHANCE
    }
}

/// What is looked at once some causes are known.
struct Round<'a> {
    part: &'a dyn Part,
    known: &'a Changes,
    /// Runs that are simulated at the same time.
    jobs: usize,
    base: Errors,
    /// Squared scatter of each channel in each group of repeats.
    scatter: HashMap<(String, usize), f64>,
    /// The least that it can be.
    least: HashMap<(String, usize), f64>,
    /// First changes of each cause and what they do.
    probes: Vec<Vec<(Vec<f64>, Errors)>>,
}

impl<'a> Round<'a> {
    fn new(part: &'a dyn Part, known: &'a Changes, jobs: usize) -> Result<Self> {
        let runs: Vec<usize> = (0..part.runs().len()).collect();
        let base: Errors = at_once(jobs, &runs, |run| centred(part, part.errors(*run, known)))
            .into_iter()
            .collect::<Result<_>>()?;
        let mut round = Self {
            part,
            known,
            jobs,
            base,
            scatter: HashMap::new(),
            least: HashMap::new(),
            probes: Vec::new(),
        };
        round.least = round.accuracy()?;
        round.scatter = round.squares(&round.base);
        round.keep_accuracy();
        for cause in 0..part.causes().len() {
            let probes = if known.iter().any(|(c, _)| *c == cause) || part.causes()[cause].scanned.is_some() {
                Vec::new()
            } else {
                part.causes()[cause].probes.clone()
            };
            round.probes.push(probes.iter().filter_map(|probe| round.probe(cause, probe)).collect());
        }
        // what no sum of first changes explains is scatter
        for _ in 0..2 {
            let left = round.unexplained();
            round.scatter = round.squares(&left);
            round.keep_accuracy();
        }
        Ok(round)
    }

    fn changes(&self, cause: usize, x: &[f64]) -> Changes {
        let mut changes = self.known.clone();
        changes.push((cause, x.to_vec()));
        changes
    }

    fn errors(&self, cause: usize, x: &[f64], runs: &[usize]) -> Option<Errors> {
        let changes = self.changes(cause, x);
        at_once(self.jobs, runs, |run| centred(self.part, self.part.errors(*run, &changes)).ok())
            .into_iter()
            .collect()
    }

    fn all(&self) -> Vec<usize> {
        (0..self.part.runs().len()).collect()
    }

    fn used(&self, used: Use) -> Vec<usize> {
        self.all().into_iter().filter(|run| self.part.runs()[*run].used == used).collect()
    }

    /// What a first change does, made smaller until it is no more than there is.
    fn probe(&self, cause: usize, probe: &[f64]) -> Option<(Vec<f64>, Errors)> {
        let mut x = probe.to_vec();
        for _ in 0..6 {
            if let Some(errors) = self.errors(cause, &x, &self.all()) {
                let does = difference(&self.base, &errors);
                if self.weighted(&does) <= TOO_MUCH * self.whole() {
                    return Some((x, does));
                }
            }
            x.iter_mut().for_each(|v| *v /= 3.0);
        }
        None
    }

    /// Mean square of each channel in each group of repeats.
    fn squares(&self, errors: &Errors) -> HashMap<(String, usize), f64> {
        let mut sums: HashMap<(String, usize), (f64, usize)> = HashMap::new();
        for (run, channels) in self.part.runs().iter().zip(errors) {
            for (c, values) in channels.iter().enumerate() {
                let sum = sums.entry((run.group.clone(), c)).or_default();
                sum.0 += values.iter().map(|v| v * v).sum::<f64>();
                sum.1 += values.len();
            }
        }
        sums.into_iter().map(|(key, (sum, n))| (key, sum / n.max(1) as f64)).collect()
    }

    /// Squared errors of a run over the scatter.
    fn of_run(&self, run: usize, errors: &[Vec<f64>]) -> f64 {
        self.product(run, errors, errors)
    }

    /// Products of two kinds of errors of a run over the scatter.
    fn product(&self, run: usize, a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
        let group = &self.part.runs()[run].group;
        let of = |(c, (a, b)): (usize, (&Vec<f64>, &Vec<f64>))| {
            let scatter = self.scatter.get(&(group.clone(), c)).copied().unwrap_or(0.0);
            if scatter > 0.0 { a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / scatter } else { 0.0 }
        };
        a.iter().zip(b).enumerate().map(of).sum()
    }

    fn weighted(&self, errors: &Errors) -> f64 {
        errors.iter().enumerate().map(|(run, errors)| self.of_run(run, errors)).sum()
    }

    fn whole(&self) -> f64 {
        self.weighted(&self.base)
    }

    /// Normal equations of the base errors by these changes.
    fn normal(&self, columns: &[&Errors]) -> (DMatrix<f64>, DVector<f64>) {
        let n = columns.len();
        let (mut matrix, mut right) = (DMatrix::zeros(n, n), DVector::zeros(n));
        for (run, base) in self.base.iter().enumerate() {
            let group = &self.part.runs()[run].group;
            for (c, error) in base.iter().enumerate() {
                let scatter = self.scatter.get(&(group.clone(), c)).copied().unwrap_or(0.0);
                if scatter <= 0.0 {
                    continue;
                }
                let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / scatter;
                for i in 0..n {
                    right[i] += dot(&columns[i][run][c], error);
                    for j in 0..=i {
                        let product = dot(&columns[i][run][c], &columns[j][run][c]);
                        matrix[(i, j)] += product;
                        if i != j {
                            matrix[(j, i)] += product;
                        }
                    }
                }
            }
        }
        (matrix, right)
    }

    fn solved(&self, columns: &[&Errors]) -> DVector<f64> {
        let (mut matrix, right) = self.normal(columns);
        for i in 0..columns.len() {
            // changes that do the same share it
            matrix[(i, i)] *= 1.0 + 1e-6;
            if matrix[(i, i)] == 0.0 {
                matrix[(i, i)] = 1.0;
            }
        }
        matrix.cholesky().map_or_else(|| DVector::zeros(columns.len()), |c| c.solve(&right))
    }

    /// What all first changes together leave.
    fn unexplained(&self) -> Errors {
        let columns: Vec<&Errors> = self.probes.iter().flatten().map(|(_, does)| does).collect();
        let weights = self.solved(&columns);
        let mut left = self.base.clone();
        for (column, weight) in columns.iter().zip(weights.iter()) {
            subtract(&mut left, column, *weight);
        }
        left
    }

    fn hidden(&self) -> Vec<Hidden> {
        let whole = self.whole();
        let causes = self.part.causes().iter().zip(&self.probes);
        causes
            .filter(|(_, probes)| !probes.is_empty())
            .filter(|(_, probes)| probes.iter().all(|(_, does)| self.weighted(does) < HIDDEN * whole))
            .map(|(cause, _)| Hidden { id: cause.id, title: cause.title, shown_by: cause.shown_by })
            .collect()
    }

    /// The likeliest causes, fitted to the runs to fit and tried on all.
    fn fitted(&self) -> Vec<Tried> {
        let mut first: Vec<(f64, usize, Vec<f64>)> = Vec::new();
        let mut fitted = Vec::new();
        for (cause, probes) in self.probes.iter().enumerate() {
            if self.known.iter().any(|(c, _)| *c == cause) {
                continue;
            }
            if probes.is_empty() {
                continue;
            }
            let columns: Vec<&Errors> = probes.iter().map(|(_, does)| does).collect();
            let weights = self.solved(&columns);
            let (_, right) = self.normal(&columns);
            let mut x = vec![0.0; probes[0].0.len()];
            for ((probe, _), weight) in probes.iter().zip(weights.iter()) {
                x.iter_mut().zip(probe).for_each(|(x, p)| *x += weight * p);
            }
            let mut start = (weights.dot(&right), x);
            // of what is bent the sum foretells too much: a first change by itself is known
            let known = |does: &Errors| self.whole() - self.weighted(&difference(&self.base, does));
            if self.part.causes()[cause].is_bent() {
                start = probes
                    .iter()
                    .map(|(probe, does)| (known(does), probe.clone()))
                    .max_by(|a, b| a.0.total_cmp(&b.0))
                    .unwrap_or(start);
                start.1 = self.best_start(cause).unwrap_or(start.1);
            }
            first.push((start.0, cause, start.1));
        }
        first.sort_by(|a, b| b.0.total_cmp(&a.0));
        // first changes say little of what is bent
        let likely = first
            .iter()
            .enumerate()
            .filter(|(k, (_, cause, _))| *k < FITTED || self.part.causes()[*cause].is_bent());
        fitted.extend(likely.filter_map(|(_, (_, cause, x))| self.fit(*cause, x)));
        fitted
    }

    /// The best of the changes that a cause is looked for at, in the one run to fit in which its first changes do most.
    fn best_start(&self, cause: usize) -> Option<Vec<f64>> {
        let starts = self.part.causes()[cause].starts();
        let does = |run: usize| -> f64 {
            self.probes[cause].iter().map(|(_, does)| self.of_run(run, &does[run])).fold(0.0, f64::max)
        };
        let run = self.used(Use::Fit).into_iter().max_by(|a, b| does(*a).total_cmp(&does(*b)))?;
        let all: Vec<usize> = (0..starts.len()).collect();
        let left = at_once(self.jobs, &all, |k| {
            let errors = centred(self.part, self.part.errors(run, &self.changes(cause, &starts[*k]))).ok()?;
            Some(self.of_run(run, &errors))
        });
        let best = left.iter().enumerate().filter_map(|(k, left)| Some((k, (*left)?)));
        best.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| starts[k].clone())
    }

    fn bounded(&self, cause: usize, x: &[f64]) -> Vec<f64> {
        let ranges = self.part.causes()[cause].unknowns.iter().map(|u| u.range);
        x.iter().zip(ranges).map(|(x, [low, high])| x.clamp(low, high)).collect()
    }

    fn fit(&self, cause: usize, start: &[f64]) -> Option<Tried> {
        let start = self.bounded(cause, start);
        let probe = &self.probes[cause].first()?.0;
        let unknowns: Vec<Unknown> = self.part.causes()[cause]
            .unknowns
            .iter()
            .enumerate()
            .map(|(i, unknown)| {
                let size = self.probes[cause].iter().map(|(p, _)| p[i].abs()).fold(probe[i].abs(), f64::max);
                Unknown {
                    start: start[i],
                    mean: 0.0,
                    low: unknown.range[0],
                    high: unknown.range[1],
                    // of what swings a share of itself
                    step: if self.part.causes()[cause].swings { 0.05 * (1.0 + start[i]) } else { 0.2 * size },
                    prior: f64::INFINITY,
                    reach: f64::INFINITY,
                }
            })
            .collect();
        let problem = Fitting { round: self, cause, runs: self.used(Use::Fit) };
        let options = Options {
            iterations: 4,
            tolerance: 1e-3,
            redundancy: 1.0,
            known: None,
            update: false,
            ..Options::default()
        };
        let fit = least_squares(&problem, &unknowns, options).ok()?;
        self.tried(cause, fit.x)
    }

    fn tried(&self, cause: usize, x: Vec<f64>) -> Option<Tried> {
        let errors = self.errors(cause, &x, &self.all())?;
        Some(Tried { cause, x, errors })
    }

    /// What the best of all causes leaves of a channel is the most that its scatter can be: what is bent, sums of first changes do not foretell.
    fn sharpen(&mut self, all: &[Tried]) {
        for tried in all {
            for (key, square) in self.squares(&tried.errors) {
                let scatter = self.scatter.entry(key).or_insert(square);
                *scatter = scatter.min(square);
            }
        }
        self.keep_accuracy();
    }

    /// What models and sensors are believed to at best.
    fn accuracy(&self) -> Result<HashMap<(String, usize), f64>> {
        let mut sums: HashMap<(String, usize), (f64, f64)> = HashMap::new();
        for (k, run) in self.part.runs().iter().enumerate() {
            for (c, square) in self.part.variation(k)?.into_iter().enumerate() {
                let sum = sums.entry((run.group.clone(), c)).or_default();
                *sum = (sum.0 + square, sum.1 + 1.0);
            }
        }
        Ok(sums.into_iter().map(|(key, (sum, n))| (key, ACCURACY * ACCURACY * sum / n)).collect())
    }

    /// It makes a channel's error smaller by more than what models and sensors are believed to.
    fn smaller(&self, before: &Errors, after: &Errors) -> bool {
        let (before, after) = (self.squares(before), self.squares(after));
        self.least.iter().any(|(key, least)| match (before.get(key), after.get(key)) {
            (Some(before), Some(after)) => *least > 0.0 && before - after >= *least,
            _ => false,
        })
    }

    fn keep_accuracy(&mut self) {
        for (key, least) in &self.least {
            let scatter = self.scatter.entry(key.clone()).or_insert(*least);
            *scatter = scatter.max(*least);
        }
    }

    /// What values of a cause make of parameters.
    fn made(&self, cause: usize, x: &[f64]) -> Result<Vec<Change>> {
        let changed = self.part.values(cause, x)?.into_iter();
        Ok(changed.map(|(name, before, value)| Change { name, before, value }).collect())
    }

    /// Of each run how much a change does, squared, and that with what there is to explain.
    fn tells(&self, does: &Errors, left: &Errors) -> Vec<[f64; 2]> {
        let of = |run: usize| [self.of_run(run, &does[run]), self.product(run, &does[run], &left[run])];
        self.all().into_iter().map(of).collect()
    }

    /// What a cause explains of all runs.
    fn judged(&self, Tried { cause, x, errors }: Tried) -> Fitted {
        let gains: Vec<f64> = self
            .all()
            .into_iter()
            .map(|run| self.of_run(run, &self.base[run]) - self.of_run(run, &errors[run]))
            .collect();
        let explains = [Use::Fit, Use::Check].map(|used| {
            let runs = self.used(used);
            let whole: f64 = runs.iter().map(|run| self.of_run(*run, &self.base[*run])).sum();
            runs.iter().map(|run| gains[*run]).sum::<f64>() / whole.max(f64::MIN_POSITIVE)
        });
        let does = difference(&self.base, &errors);
        let tells = self.tells(&does, &self.base);
        Fitted {
            cause,
            x,
            gain: gains.iter().sum(),
            explains,
            chance: by_chance(&tells),
            enough: self.smaller(&self.base, &errors) && explains.iter().all(|share| *share >= SHARE),
            errors,
        }
    }

    /// Channels by how much their error falls.
    fn channels(&self, fitted: &Fitted) -> Vec<(String, [f64; 2])> {
        let rms = |errors: &Errors, c: usize| {
            let (mut sum, mut n) = (0.0, 0usize);
            for (run, channels) in errors.iter().enumerate() {
                let key = (self.part.runs()[run].group.clone(), c);
                let scatter = self.scatter.get(&key).copied().unwrap_or(0.0);
                if scatter > 0.0 {
                    sum += channels[c].iter().map(|v| v * v).sum::<f64>() / scatter;
                    n += channels[c].len();
                }
            }
            (sum / n.max(1) as f64).sqrt()
        };
        let names = self.part.channels().iter().enumerate();
        let mut all: Vec<(String, [f64; 2])> =
            names.map(|(c, name)| (name.clone(), [rms(&self.base, c), rms(&fitted.errors, c)])).collect();
        all.sort_by(|(_, [a, b]), (_, [c, d])| (b - a).total_cmp(&(d - c)));
        all.truncate(6);
        all
    }
}

struct Fitting<'a, 'b> {
    round: &'a Round<'b>,
    cause: usize,
    runs: Vec<usize>,
}

impl Problem for Fitting<'_, '_> {
    fn residuals(&self, points: &[Vec<f64>]) -> Vec<Option<Vec<f64>>> {
        let one = |x: &Vec<f64>| {
            let errors = self.round.errors(self.cause, x, &self.runs)?;
            let mut all = Vec::new();
            for (run, channels) in self.runs.iter().zip(&errors) {
                let group = &self.round.part.runs()[*run].group;
                for (c, values) in channels.iter().enumerate() {
                    let scatter = self.round.scatter.get(&(group.clone(), c)).copied().unwrap_or(0.0);
                    let weight = if scatter > 0.0 { scatter.sqrt().recip() } else { 0.0 };
                    all.extend(values.iter().map(|v| weight * v));
                }
            }
            Some(all)
        };
        points.iter().map(one).collect()
    }
}

/// Amounts of a change in several runs. Of each run `tells` is the square of what the change does there, and that with what there is to explain.
struct Amounts {
    /// Their mean, each weighted by how much its run tells of it.
    mean: f64,
    /// Sum of the weights.
    weight: f64,
    /// Weighted squares by which they are apart.
    apart: f64,
    /// How many runs tell of it at all.
    runs: f64,
}

impl Amounts {
    fn of(tells: &[[f64; 2]]) -> Self {
        // a run that the change does nothing in has no amount, and no weight
        let told: Vec<[f64; 2]> = tells.iter().copied().filter(|[own, _]| *own > 0.0).collect();
        let weight: f64 = told.iter().map(|[own, _]| own).sum();
        let mean = if weight > 0.0 { told.iter().map(|[_, with]| with).sum::<f64>() / weight } else { 0.0 };
        let apart = told.iter().map(|[own, with]| own * (with / own - mean).powi(2)).sum();
        Self { mean, weight, apart, runs: told.len() as f64 }
    }
}

/// How probable it is by chance that runs agree so on the amount of a change: Student's t of the mean of their own amounts.
fn by_chance(tells: &[[f64; 2]]) -> f64 {
    let Amounts { mean, weight, apart, runs } = Amounts::of(tells);
    if !(mean > 0.0 && runs > 1.0) {
        return 1.0;
    }
    // the fit chose the sign
    0.5 * beyond_by_chance(mean, (apart / (runs - 1.0) / weight).sqrt(), runs - 1.0)
}

/// How probable it is by chance that an estimate is as far beyond a limit, on either side, with the degrees of freedom that its standard error has.
fn beyond_by_chance(beyond: f64, error: f64, dof: f64) -> f64 {
    if beyond <= 0.0 {
        return 1.0;
    }
    if error == 0.0 { 0.0 } else { student(beyond / error, dof) }
}

/// Errors of channels without what sensors show at zero.
fn centred(part: &dyn Part, errors: Result<Vec<Vec<f64>>>) -> Result<Vec<Vec<f64>>> {
    let mut errors = errors?;
    for (c, values) in errors.iter_mut().enumerate() {
        if part.has_offset(c) {
            let mean = crate::stats::mean_or_zero(values);
            values.iter_mut().for_each(|v| *v -= mean);
        }
        if !values.iter().all(|v| v.is_finite()) {
            return Err(Error::numeric(format!("{} is no longer finite", part.channels()[c])));
        }
    }
    Ok(errors)
}

/// What a change does: errors before less errors after.
fn difference(before: &Errors, after: &Errors) -> Errors {
    let mut all = before.clone();
    subtract(&mut all, after, 1.0);
    all
}

fn subtract(from: &mut Errors, what: &Errors, times: f64) {
    for (from, what) in from.iter_mut().zip(what) {
        for (from, what) in from.iter_mut().zip(what) {
            from.iter_mut().zip(what).for_each(|(a, b)| *a -= times * b);
        }
    }
}

/// Does something for all runs, some at the same time, and gives what came out in their order. 0: as many as there are cores.
fn at_once<R: Send>(jobs: usize, runs: &[usize], what: impl Fn(&usize) -> R + Sync) -> Vec<R> {
    let cores = if jobs == 0 { thread::available_parallelism().map_or(1, usize::from) } else { jobs };
    let workers = cores.min(runs.len()).max(1);
    let mut results: Vec<Option<R>> = runs.iter().map(|_| None).collect();
    thread::scope(|scope| {
        let what = &what;
        let workers: Vec<_> = (0..workers)
            .map(|worker| {
                scope.spawn(move || {
                    (worker..runs.len()).step_by(workers).map(|k| (k, what(&runs[k]))).collect::<Vec<_>>()
                })
            })
            .collect();
        for worker in workers {
            match worker.join() {
                Ok(all) => all.into_iter().for_each(|(k, result)| results[k] = Some(result)),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
    });
    results.into_iter().flatten().collect()
}
