//! [`Study`]: a model, its runs, and the fits of the model with effects to them.

use super::locate;
use super::numbers::{PRIOR, VISIBLE_ZERO, ZERO};
use super::placement::Placement;
use super::subject::FreeParameter;
use crate::effect::Parameter;
use crate::fit::{
    Bench, Covariance, Fit, Kept, Knob, Options, OutputError, Problem, Run, Traces, Unknown, least_squares,
    settle,
};
use crate::stats::{about_line, about_mean, median, redundancy};
use crate::{Error, Result};
use nalgebra::{DMatrix, DVector};
use std::sync::Mutex;

/// A step of a fit goes at most so many standard deviations of what is known beforehand: bent valleys are
/// followed, not jumped over.
const REACH: f64 = 1.0;
/// Step of differences for parameters, as a share.
const STEP: f64 = 1e-3;
/// What is known beforehand of what a sensor shows at zero: its standard deviation as a share of the most that it may be.
const ZERO_PRIOR: f64 = 0.5;
/// Iterations of a fit of nothing but what the recorder makes: it is nearly linear.
const RECORDER: usize = 5;
/// The effect that says so.
const BIAS: &str = "sensor-bias";
/// Parameters that are fitted at most if the user does not say which; those with the most effect on the outputs. What moves them and
/// is not fitted is taken for something else; each costs a simulation of all runs wherever derivatives are computed.
const MAX_FREE: usize = 20;
/// A parameter that moves the outputs by less than this share of their size, over its whole prior, stays.
const MIN_EFFECT: f64 = 1e-3;
/// Blocks of a run that errors are compared over, at most and at least.
const BLOCKS: usize = 24;
const FEW_BLOCKS: usize = 8;

/// A model with its recordings.
#[derive(Clone)]
pub struct Study<'a> {
    /// What runs.
    pub bench: &'a Bench,
    /// Runs to fit and runs to check.
    pub fit_runs: Vec<&'a Run>,
    /// Runs to check.
    pub check_runs: Vec<&'a Run>,
    /// Parameters that stay, beside those that the bench sets.
    pub values: Vec<(usize, f64)>,
    /// A value with which differences between simulations are simulated, for derivatives and for screening: a longer step.
    pub of_changes: Option<(usize, f64)>,
    /// Parameters that are fitted.
    pub free: Vec<FreeParameter>,
    /// Largest lag of all channels \[s\] that filters of a recorder may make, and no physics.
    pub lag: f64,
    /// Channels that may show something at zero, by number, and how much at most, in their units.
    pub zeros: Vec<(usize, f64)>,
    /// Weight of each measured channel.
    pub weights: Vec<f64>,
    /// How many neighbouring samples tell as much as one.
    pub redundancy: f64,
}

/// Effects at places with their fitted parameters, and the fitted parameters of the model.
#[derive(Debug, Clone)]
pub struct Model {
    /// Values of the free parameters, as multiples of their sizes, of the recorder's lag, and of what channels show at
    /// zero.
    pub parameters: Vec<f64>,
    /// Effects, with parameters as multiples of their scales.
    pub effects: Vec<(Placement, Vec<f64>)>,
}

/// A model fitted to the fit runs.
#[derive(Debug, Clone)]
pub struct Fitted {
    /// The model.
    pub model: Model,
    /// What the unknowns were, in the order: parameters, effects.
    pub unknowns: Vec<Unknown>,
    /// The fit.
    pub fit: Fit,
    /// What was simulated of the fit runs where it ended.
    pub kept: Option<Kept>,
}

/// Derivatives of the residuals of the fit runs by the free parameters, where these are nominal.
pub struct Derivatives {
    /// Rows as residuals, columns as parameters.
    matrix: DMatrix<f64>,
    /// What the channels were weighed with.
    weights: Vec<f64>,
}

impl Derivatives {
    /// With the weights of a study of the same runs.
    fn of(&self, study: &Study<'_>) -> DMatrix<f64> {
        let mut matrix = self.matrix.clone();
        study.weigh_anew(&mut matrix, &self.weights);
        matrix
    }
}

/// What a model leaves of some runs.
#[derive(Debug, Clone)]
pub struct Rest {
    /// Simulated channels of each run at its samples.
    pub simulated: Vec<Traces>,
    /// Weighted squared error in each block: of each channel.
    pub blocks: Vec<Vec<f64>>,
    /// Weighted squared error.
    pub total: f64,
}

impl Rest {
    /// Weighted squared error of each channel.
    pub fn by_channel(&self) -> Vec<f64> {
        let channels = self.blocks.first().map_or(0, Vec::len);
        (0..channels).map(|c| self.blocks.iter().map(|b| b[c]).sum()).collect()
    }

    /// Squared error in each block, with the channels in other units.
    pub fn in_units(&self, units: &[f64]) -> Vec<f64> {
        self.blocks
            .iter()
            .map(|b| b.iter().zip(units).map(|(e, u)| e / u.max(f64::MIN_POSITIVE)).sum())
            .collect()
    }
}

/// What a model leaves in each block less what another leaves.
pub(super) fn differences(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// What is known of the noise of a channel, in the unit of the model's output.
#[derive(Debug, Clone, Copy)]
pub struct Noise {
    /// What follows no other signal.
    pub alone: Option<f64>,
    /// What repeats of a run do not share, if any run is repeated.
    pub scatter: Option<f64>,
}

impl Noise {
    /// Both are upper bounds: the lower one.
    pub fn least(&self) -> Option<f64> {
        self.alone.into_iter().chain(self.scatter).reduce(f64::min)
    }
}

impl Study<'_> {
    pub(super) fn problem<'b>(&'b self, model: &Model, runs: Vec<&'b Run>) -> OutputError<'b> {
        let knob = |p: &FreeParameter| Knob::Parameter(p.variable, p.scale);
        let mut knobs: Vec<Knob> = self.free.iter().map(knob).collect();
        knobs.push(Knob::Lag(self.lag));
        knobs.extend(self.zeros.iter().map(|(channel, most)| Knob::Zero(*channel, *most)));
        let mut first = 0;
        for (placement, _) in &model.effects {
            let end = first + placement.targets.len();
            let parameters = placement.effect.parameters.iter().zip(&placement.scales).enumerate();
            knobs.extend(parameters.map(|(parameter, (p, scale))| Knob::Effect {
                first,
                end,
                parameter,
                scale: *scale,
                logarithmic: p.is_logarithmic(),
            }));
            first = end;
        }
        OutputError {
            bench: self.bench,
            runs,
            knobs,
            values: self.values.clone(),
            attachments: model.effects.iter().flat_map(|(p, v)| p.attach(v)).collect(),
            weights: self.weights.clone(),
            of_changes: self.of_changes,
            kept: Mutex::default(),
        }
    }

    fn unknowns(&self, model: &Model) -> Vec<Unknown> {
        let mut unknowns: Vec<Unknown> = self
            .free
            .iter()
            .map(|p| {
                let nominal = p.nominal / p.scale;
                let (low, high, prior) = (p.low / p.scale, p.high / p.scale, p.prior);
                Unknown { start: nominal, mean: nominal, low, high, step: STEP, prior, reach: REACH * prior }
            })
            .collect();
        let lag = Unknown { start: 0.0, mean: 0.0, low: 0.0, high: 1.0, step: 0.05, prior: 1.0, reach: 1.0 };
        unknowns.push(lag);
        let zero = Unknown {
            start: 0.0,
            mean: 0.0,
            low: -1.0,
            high: 1.0,
            step: 0.01,
            prior: ZERO_PRIOR,
            reach: f64::INFINITY,
        };
        // where an effect says what a channel shows at zero, nothing else does
        let none = Unknown { low: 0.0, high: 0.0, prior: 1e-6, ..zero };
        let is_said = |channel: usize| {
            let variable = self.fit_runs.first().and_then(|r| r.channels.get(channel)).map(|c| c.variable);
            let is_bias =
                |p: &Placement| p.effect.id == BIAS && variable.is_some_and(|v| p.targets.contains(&v));
            model.effects.iter().any(|(placement, _)| is_bias(placement))
        };
        unknowns.extend(self.zeros.iter().map(|(channel, _)| if is_said(*channel) { none } else { zero }));
        for (placement, _) in &model.effects {
            for parameter in placement.effect.parameters {
                let (low, high) = placement.limits(parameter);
                if parameter.is_logarithmic() {
                    let typical = parameter.probes.first().copied().unwrap_or(low).ln();
                    let (low, high) = (low.ln(), high.ln());
                    let prior = 0.5 * (high - low);
                    let (step, reach) = (0.02, 1.0);
                    unknowns.push(Unknown { start: typical, mean: typical, low, high, step, prior, reach });
                    continue;
                }
                let typical = parameter.probes.first().map_or(high - low, |p| p.abs());
                let off = parameter.off.unwrap_or(typical);
                // what is known beforehand: that it is within the search; weak, for directions without data
                let prior = (high - low).abs().max(f64::MIN_POSITIVE);
                let least = if parameter.off.is_some() { 0.0 } else { 1e-9 };
                let step = 0.02 * typical.max(least);
                unknowns.push(Unknown { start: off, mean: off, low, high, step, prior, reach: prior });
            }
        }
        unknowns
    }

    /// The point of a model among its unknowns.
    pub(super) fn point(model: &Model) -> Vec<f64> {
        let of_effects = model.effects.iter().flat_map(|(placement, values)| {
            let unknown = |(p, v): (&Parameter, &f64)| if p.is_logarithmic() { v.ln() } else { *v };
            placement.effect.parameters.iter().zip(values).map(unknown)
        });
        model.parameters.iter().copied().chain(of_effects).collect()
    }

    /// The same without a channel.
    pub fn without_channel(&self, channel: usize) -> Study<'_> {
        let mut other = self.clone();
        other.weights[channel] = 0.0;
        other
    }

    /// The same with its runs exchanged.
    pub fn turned(&self) -> Study<'_> {
        Study { fit_runs: self.check_runs.clone(), check_runs: self.fit_runs.clone(), ..self.clone() }
    }

    /// The model as it is given.
    pub fn nominal(&self) -> Model {
        let mut parameters: Vec<f64> = self.free.iter().map(|p| p.nominal / p.scale).collect();
        parameters.resize(self.own(), 0.0);
        Model { parameters, effects: Vec::new() }
    }

    /// How many unknowns a model without effects has.
    pub(super) fn own(&self) -> usize {
        self.free.len() + 1 + self.zeros.len()
    }

    /// The model as it is given, fitted roughly to the fit runs; derivatives may be known where it begins.
    ///
    /// # Errors
    /// A model that cannot be run.
    pub fn fit_nominal(&self, iterations: usize, known: Option<&Derivatives>) -> Result<Fitted> {
        let known = known.map(|known| known.of(self));
        self.fit_roughly(&self.nominal(), iterations, known.as_ref())
    }

    /// The model as it is given, with the recorder's lag and what channels show at zero fitted, which say nothing of the
    /// machine.
    ///
    /// # Errors
    /// A model that cannot be run.
    pub fn nominal_as_recorded(&self) -> Result<Model> {
        let given = self.free.iter().map(|p| (p.variable, p.nominal));
        let values = self.values.iter().copied().chain(given).collect();
        let recorder = Study { free: Vec::new(), values, ..self.clone() };
        let fitted = recorder.fit_roughly(&recorder.nominal(), RECORDER, None)?;
        let mut model = self.nominal();
        model.parameters.truncate(self.free.len());
        model.parameters.extend(fitted.model.parameters);
        Ok(model)
    }

    /// Takes from the channels that may show something at zero those that show too much for that, with a model fitted to the fit
    /// runs. Returns whether there are any.
    pub fn drop_visible_zeros(&mut self, fitted: &Fitted, rest: &Rest) -> bool {
        let first = self.free.len() + 1;
        let is_small = |k: usize, (channel, most): (usize, f64)| {
            let (mut count, mut sum, mut square) = (0.0, 0.0, 0.0);
            for (run, traces) in self.fit_runs.iter().zip(&rest.simulated) {
                for (m, s) in run.channels[channel].values.iter().zip(&traces[channel]) {
                    count += 1.0;
                    sum += m - s;
                    square += (m - s).powi(2);
                }
            }
            let beside = (square / count - (sum / count).powi(2)).max(0.0).sqrt();
            let zero = fitted.model.parameters[first + k].abs() * most;
            zero < most && zero <= VISIBLE_ZERO * beside
        };
        let all = self.zeros.iter().copied().enumerate();
        let small: Vec<(usize, f64)> = all.filter(|(k, zero)| is_small(*k, *zero)).map(|(_, z)| z).collect();
        let dropped = small.len() < self.zeros.len();
        self.zeros = small;
        dropped
    }

    /// Fits a model to the fit runs, beginning where it stands.
    ///
    /// # Errors
    /// A model that cannot be run.
    pub fn fit(&self, model: &Model, iterations: usize) -> Result<Fitted> {
        self.fit_with(model, None, Options { iterations, ..Options::default() })
    }

    /// Fits with derivatives that are computed once, as far as they are not known, and updated as long as they lead
    /// anywhere.
    ///
    /// # Errors
    /// A model that cannot be run.
    pub fn fit_roughly(
        &self,
        model: &Model,
        iterations: usize,
        known: Option<&DMatrix<f64>>,
    ) -> Result<Fitted> {
        self.fit_with(model, None, Options { iterations, known, update: true, ..Options::default() })
    }

    /// Goes on with a fit whose problem has hardly changed since, with its derivatives. It does not end before new ones
    /// lead nowhere, too.
    ///
    /// # Errors
    /// A model that cannot be run.
    pub fn fit_on(&self, from: &Fitted, iterations: usize) -> Result<Fitted> {
        let known = Some(&from.fit.jacobian);
        let options = Options { iterations, known, update: true, to_the_end: true, ..Options::default() };
        self.fit_with(&from.model, Some(from), options)
    }

    /// As [`Study::fit_roughly`], from a place near where another fit has ended, with its derivatives: they may be those of
    /// a model that lacks the last effect.
    ///
    /// # Errors
    /// A model that cannot be run.
    pub fn fit_near(&self, model: &Model, iterations: usize, near: &Fitted) -> Result<Fitted> {
        let known = Some(&near.fit.jacobian);
        self.fit_with(model, Some(near), Options { iterations, known, update: true, ..Options::default() })
    }

    /// Fits what is left of a fitted model without its last effect, beginning where that has ended, to the end.
    ///
    /// # Errors
    /// A model that cannot be run.
    pub fn fit_without_last(&self, fitted: &Fitted, iterations: usize) -> Result<Fitted> {
        let mut model = fitted.model.clone();
        model.effects.pop();
        let known = fitted.fit.jacobian.columns(0, Self::point(&model).len()).into_owned();
        let options =
            Options { iterations, known: Some(&known), update: true, to_the_end: true, ..Options::default() };
        self.fit_with(&model, None, options)
    }

    fn fit_with(&self, model: &Model, near: Option<&Fitted>, options: Options<'_>) -> Result<Fitted> {
        let problem = self.problem(model, self.fit_runs.clone());
        problem.keep(near.and_then(|near| near.kept.clone()));
        let mut unknowns = self.unknowns(model);
        for (unknown, x) in unknowns.iter_mut().zip(Self::point(model)) {
            unknown.start = x;
        }
        let options = Options { redundancy: self.redundancy, ..options };
        let fit = least_squares(&problem, &unknowns, options)?;
        Ok(self.fitted(model, &problem, unknowns, fit))
    }

    /// A fit with derivatives from both sides where it has ended, which intervals need, and with the steps that they foretell.
    pub fn settled(&self, fitted: Fitted) -> Fitted {
        let Fitted { model, unknowns, fit, kept } = fitted;
        let problem = self.problem(&model, self.fit_runs.clone());
        problem.keep(kept);
        let fit = settle(&problem, &unknowns, fit, self.redundancy);
        self.fitted(&model, &problem, unknowns, fit)
    }

    /// What a fit of a model has come to.
    fn fitted(&self, model: &Model, problem: &OutputError<'_>, unknowns: Vec<Unknown>, fit: Fit) -> Fitted {
        let own = self.own();
        let parameters = fit.x[..own].to_vec();
        let mut rest = fit.x[own..].iter();
        let effects = model
            .effects
            .iter()
            .map(|(placement, _)| {
                let value = |(p, x): (&Parameter, &f64)| {
                    let (low, high) = placement.limits(p);
                    // what is at a bound is at it to the last digit
                    if p.is_logarithmic() { x.exp().clamp(low, high) } else { *x }
                };
                let parameters = placement.effect.parameters;
                (placement.clone(), parameters.iter().zip(rest.by_ref()).map(value).collect())
            })
            .collect();
        let model = Model { parameters, effects };
        // clamped as it is run from here on
        let kept = problem.kept(&Self::point(&model));
        Fitted { model, unknowns, fit, kept }
    }

    /// What a model leaves of some runs.
    ///
    /// # Errors
    /// It cannot be run on one of them.
    pub fn rest(&self, model: &Model, runs: &[&Run]) -> Result<Rest> {
        self.rest_of(model, runs, None)
    }

    /// What a fitted model leaves of the fit runs: they have been simulated.
    ///
    /// # Errors
    /// It cannot be run on one of them.
    pub fn fit_rest(&self, fitted: &Fitted) -> Result<Rest> {
        self.rest_of(&fitted.model, &self.fit_runs, fitted.kept.clone())
    }

    fn rest_of(&self, model: &Model, runs: &[&Run], kept: Option<Kept>) -> Result<Rest> {
        let problem = self.problem(model, runs.to_vec());
        problem.keep(kept);
        let simulated = problem.simulate(&[Self::point(model)]).pop().flatten();
        let simulated =
            simulated.ok_or_else(|| Error::numeric("the model cannot be run on the check runs"))?;
        Ok(self.rest_with(runs, simulated))
    }

    /// What these simulated channels leave of some runs.
    pub(super) fn rest_with(&self, runs: &[&Run], simulated: Vec<Traces>) -> Rest {
        let mut blocks = Vec::new();
        for (run, traces) in runs.iter().zip(&simulated) {
            let n = run.time.len();
            let count = self.blocks(n);
            let mut sums = vec![vec![0.0; run.channels.len()]; count];
            for (c, ((channel, trace), weight)) in
                run.channels.iter().zip(traces).zip(&self.weights).enumerate()
            {
                for (k, (s, m)) in trace.iter().zip(&channel.values).enumerate() {
                    sums[k * count / n][c] += (weight * (s - m)).powi(2);
                }
            }
            blocks.extend(sums);
        }
        let total = blocks.iter().flatten().sum();
        Rest { simulated, blocks, total }
    }

    /// How many blocks a run of so many samples is compared over: what is missing makes a residual's memory long; the noise of
    /// sensors forgets sooner.
    fn blocks(&self, samples: usize) -> usize {
        ((samples as f64 / (4.0 * self.redundancy)) as usize).clamp(FEW_BLOCKS.min(samples), BLOCKS)
    }

    /// How sure a fit to the fit runs is of its unknowns, as the blocks of these runs show it.
    pub fn covariance(&self, fitted: &Fitted) -> Covariance {
        let mut block = Vec::new();
        let mut first = 0;
        for run in &self.fit_runs {
            let n = run.time.len();
            let count = self.blocks(n);
            // all channels of a piece of time are one block: what is missing shows in several of them
            let channels = run.channels.len();
            block.extend((0..channels).flat_map(|_| (0..n).map(|k| first + k * count / n)));
            first += count;
        }
        fitted.fit.covariance_in_blocks(&fitted.unknowns, self.redundancy, &block)
    }

    /// What is left of a channel of the fit runs over what it moves.
    pub fn share_left(&self, rest: &Rest, channel: usize) -> f64 {
        let (mut left, mut moved) = (0.0, 0.0);
        for (run, traces) in self.fit_runs.iter().zip(&rest.simulated) {
            let values = &run.channels[channel].values;
            left += traces[channel].iter().zip(values).map(|(s, m)| (s - m).powi(2)).sum::<f64>();
            moved += about_mean(values);
        }
        (left / moved.max(f64::MIN_POSITIVE)).sqrt()
    }

    /// Root mean square of what is left of a channel of the check runs, in the unit of the model's output.
    pub fn error(&self, rest: &Rest, channel: usize) -> f64 {
        let (mut sum, mut n) = (0.0, 0.0);
        for (run, traces) in self.check_runs.iter().zip(&rest.simulated) {
            let values = &run.channels[channel].values;
            sum += traces[channel].iter().zip(values).map(|(s, m)| (s - m).powi(2)).sum::<f64>();
            n += run.time.len() as f64;
        }
        (sum / f64::max(n, 1.0)).sqrt()
    }

    /// The noise of every channel of the check runs, with what a model leaves of the fit runs and of them.
    pub fn noise(&self, fit: &Rest, check: &Rest) -> Vec<Noise> {
        let runs: Vec<&Run> = self.fit_runs.iter().chain(&self.check_runs).copied().collect();
        let scatter = locate::scatter(&runs, &[&fit.simulated[..], &check.simulated[..]].concat());
        let of = |c: usize| Noise {
            alone: locate::noise(&self.check_runs, &check.simulated, c),
            scatter: scatter.as_ref().and_then(|s| s.get(c).copied()),
        };
        (0..self.weights.len()).map(of).collect()
    }

    /// How many independent samples all runs have.
    pub fn independent(&self) -> f64 {
        let all = self.fit_runs.iter().chain(&self.check_runs);
        let samples: usize = all.map(|r| r.time.len() * r.channels.len()).sum();
        (samples as f64 / self.redundancy).max(2.0)
    }

    /// The parameters that matter: those with the most effect on the outputs, the most important first. If they are
    /// too many, those of which others do the same stay. Returns the derivatives by those that were chosen, from differences as
    /// large as tell whether they matter.
    ///
    /// # Errors
    /// The model cannot be run with its nominal values.
    pub fn choose_free(&mut self, candidates: &[FreeParameter]) -> Result<Derivatives> {
        self.free = candidates.to_vec();
        let model = self.nominal();
        let problem = self.problem(&model, self.fit_runs.clone());
        let from = model.parameters.clone();
        let base = problem.residuals(std::slice::from_ref(&from)).pop().flatten();
        let base = base.ok_or_else(|| self.why_not(&problem))?;
        let mut points = Vec::new();
        for (i, p) in self.free.iter().enumerate() {
            let mut point = from.clone();
            // over the prior if the range allows, else over the range
            let room = ((p.high - p.nominal) / p.scale).min(0.05);
            point[i] += if room > 1e-6 { room } else { -0.05 };
            points.push(point);
        }
        let size = (base.len() as f64).sqrt();
        let mut effects: Vec<(usize, DVector<f64>)> = Vec::new();
        for (i, change) in problem.changes(&from, &base, &points).into_iter().enumerate() {
            let Some(change) = change else { continue };
            let step = points[i][i] - from[i];
            let effect = DVector::from_vec(change) * (PRIOR / size / step);
            if effect.norm() > MIN_EFFECT || self.free[i].asked {
                effects.push((i, effect));
            }
        }
        effects.sort_by(|a, b| b.1.norm_squared().total_cmp(&a.1.norm_squared()));
        // who asks for more gets more
        let asked = self.free.iter().filter(|p| p.asked).count();
        let most = MAX_FREE.max(asked);
        let chosen = most_by_themselves(effects.iter().map(|e| e.1.clone()).collect(), most);
        self.free = chosen.iter().map(|k| candidates[effects[*k].0].clone()).collect();
        let derivatives: Vec<DVector<f64>> = chosen.iter().map(|k| &effects[*k].1 * (size / PRIOR)).collect();
        let matrix = if derivatives.is_empty() {
            DMatrix::zeros(base.len(), 0)
        } else {
            DMatrix::from_columns(&derivatives)
        };
        Ok(Derivatives { matrix, weights: self.weights.clone() })
    }

    /// The error of a run that fails.
    fn why_not(&self, problem: &OutputError<'_>) -> Error {
        let setup = std::sync::Arc::new(problem.setup(&[]));
        for run in &problem.runs {
            let drives = [std::sync::Arc::clone(&run.drive)];
            let answers = self.bench.run(&[std::sync::Arc::clone(&setup)], &drives, &problem.watch());
            if let Some(Err(error)) = answers.into_iter().next() {
                return error.at(format!("{}: the model cannot be run", run.name));
            }
        }
        Error::numeric("the model cannot be run with its nominal values")
    }

    /// Weighs the channels by what a fitted model leaves of the fit runs, and gives the fit with its derivatives in the new
    /// weights.
    pub fn weigh_by(&mut self, fitted: &Fitted, rest: &Rest) -> Fitted {
        let before = self.weights.clone();
        let runs = self.fit_runs.clone();
        self.weigh(&runs, rest);
        let mut fitted = fitted.clone();
        self.weigh_anew(&mut fitted.fit.jacobian, &before);
        fitted
    }

    /// Gives derivatives of the residuals of the fit runs, which have the weights `before`, those of now.
    fn weigh_anew(&self, derivatives: &mut DMatrix<f64>, before: &[f64]) {
        let factors: Vec<f64> = self.weights.iter().zip(before).map(|(now, before)| now / before).collect();
        // rows are run by run, channel by channel
        let mut row = 0;
        for run in &self.fit_runs {
            for (channel, factor) in run.channels.iter().zip(&factors) {
                let n = channel.values.len();
                if row + n <= derivatives.nrows() {
                    derivatives.rows_mut(row, n).scale_mut(*factor);
                }
                row += n;
            }
        }
    }

    /// Sets weights and redundancy from what a model leaves: every channel counts in multiples of its
    /// own error, but none for more than a thousand times its relative precision.
    pub fn weigh(&mut self, runs: &[&Run], rest: &Rest) {
        let mut spans = Vec::new();
        for (c, weight) in self.weights.iter_mut().enumerate() {
            let (mut error, mut n) = (0.0, 0.0);
            for (run, traces) in runs.iter().zip(&rest.simulated) {
                let Some(channel) = run.channels.get(c) else { continue };
                let difference: Vec<f64> =
                    traces[c].iter().zip(&channel.values).map(|(s, m)| s - m).collect();
                error += difference.iter().map(|d| d * d).sum::<f64>();
                n += channel.values.len() as f64;
                spans.push(redundancy(&difference));
            }
            if n > 0.0 && error > 0.0 {
                *weight = 1.0 / (error / n).sqrt().max(negligible(runs, c));
            }
        }
        // without any it is 1, too
        self.redundancy = median(&spans).max(1.0);
    }
}

/// Those effects, in their order, that do the most which others chosen before them cannot do: of two parameters that do
/// the same one is enough.
fn most_by_themselves(mut effects: Vec<DVector<f64>>, most: usize) -> Vec<usize> {
    let mut left: Vec<usize> = (0..effects.len()).collect();
    let mut chosen = Vec::new();
    while chosen.len() < most && !left.is_empty() {
        let size = |k: &usize| effects[*k].norm_squared();
        let first = (1..left.len()).fold(0, |a, b| if size(&left[b]) > size(&left[a]) { b } else { a });
        let k = left.swap_remove(first);
        chosen.push(k);
        let effect = std::mem::replace(&mut effects[k], DVector::zeros(0));
        let length = effect.norm_squared().max(f64::MIN_POSITIVE);
        for other in &left {
            let along = effect.dot(&effects[*other]) / length;
            effects[*other].axpy(-along, &effect, 1.0);
        }
    }
    chosen.sort_unstable();
    chosen
}

/// An error of a channel that is too small to say anything: a thousandth of what it moves about a straight line: an
/// angle that grows and grows is not more imprecise for that.
pub(super) fn negligible(runs: &[&Run], channel: usize) -> f64 {
    let channels = || runs.iter().filter_map(|r| r.channels.get(channel));
    let size: f64 = channels().map(|c| about_line(&c.values)).sum();
    let n: usize = channels().map(|c| c.values.len()).sum();
    1e-3 * (size / n.max(1) as f64).sqrt()
}

/// What channels may show at zero: by number and in their units. What counts from any zero has none.
pub fn zeros(runs: &[&Run]) -> Vec<(usize, f64)> {
    let count = runs.first().map_or(0, |r| r.channels.len());
    let span = |c: usize| {
        let values = || runs.iter().filter_map(|r| r.channels.get(c)).flat_map(|c| &c.values).copied();
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
    };
    let counts = |c: usize| runs.iter().filter_map(|r| r.channels.get(c)).any(|c| c.counts);
    let channels = (0..count).filter(|c| !counts(*c)).map(|c| (c, ZERO * span(c)));
    channels.filter(|(_, most)| most.is_finite() && *most > 0.0).collect()
}

/// Weights of channels before anything is known: one over their spread.
pub fn first_weights(runs: &[&Run]) -> Vec<f64> {
    let count = runs.first().map_or(0, |r| r.channels.len());
    (0..count)
        .map(|c| {
            let (mut square, mut n) = (0.0, 0.0);
            for channel in runs.iter().filter_map(|r| r.channels.get(c)) {
                square += about_mean(&channel.values);
                n += channel.values.len() as f64;
            }
            let spread = (square / f64::max(n, 1.0)).sqrt();
            if spread > 0.0 { 1.0 / spread } else { 1.0 }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_parameters_that_do_the_same_one_is_chosen() {
        let effect = |values: [f64; 3]| DVector::from_vec(values.to_vec());
        // the second does what the first does, but for little; the third is smaller and does something else
        let effects = vec![effect([3.0, 0.0, 0.0]), effect([2.9, 0.1, 0.0]), effect([0.5, 0.0, 0.4])];
        assert_eq!(most_by_themselves(effects.clone(), 2), [0, 2]);
        assert_eq!(most_by_themselves(effects.clone(), 3), [0, 1, 2]);
        assert_eq!(most_by_themselves(effects, 9), [0, 1, 2]);
        assert!(most_by_themselves(Vec::new(), 2).is_empty());
    }
}
