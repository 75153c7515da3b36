//! [`Study`]: a model, its runs, and the fits of the model with effects to them.

use super::placement::Placement;
use super::subject::FreeParameter;
use crate::Result;
use crate::effect::Parameter;
use crate::fit::{
    Bench, Fit, Kept, Knob, Options, OutputError, Problem, Run, Unknown, least_squares, settle,
};
use nalgebra::DMatrix;
use std::sync::{Arc, Mutex};

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

/// How closely a study simulates.
#[derive(Debug, Clone)]
pub enum Closeness {
    /// With the steps of its runs.
    Precisely,
    /// With the longer steps that are enough for differences between simulations.
    Roughly,
    /// With these, and this beside the residuals of the fit runs: what is left out where a fit stands.
    Beside(Arc<[f64]>),
}

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
    /// How closely all is simulated.
    pub closeness: Closeness,
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
        let problem = OutputError {
            bench: self.bench,
            runs,
            knobs,
            values: self.values.clone(),
            attachments: model.effects.iter().flat_map(|(p, v)| p.attach(v)).collect(),
            weights: self.weights.clone(),
            of_changes: self.of_changes,
            is_coarse: false,
            beside: None,
            kept: Mutex::default(),
        };
        match &self.closeness {
            Closeness::Precisely => problem,
            Closeness::Roughly => problem.of_changes().unwrap_or(problem),
            Closeness::Beside(beside) => match problem.of_changes() {
                Some(rough) => OutputError { beside: Some(Arc::clone(beside)), ..rough },
                None => problem,
            },
        }
    }

    /// The same, to try what is near a fitted model: simulated as roughly as differences are, with what this leaves out where the model stands.
    pub fn near(&self, fitted: &Fitted) -> Self {
        let precise = self.problem(&fitted.model, self.fit_runs.clone());
        precise.keep(fitted.kept.clone());
        let point = [Self::point(&fitted.model)];
        let residuals = |problem: &OutputError<'_>| problem.residuals(&point).pop().flatten();
        let beside = precise.of_changes().and_then(|rough| {
            let (precise, rough) = (residuals(&precise)?, residuals(&rough)?);
            Some(precise.iter().zip(&rough).map(|(p, r)| p - r).collect())
        });
        let closeness = beside.map_or_else(|| self.closeness.clone(), Closeness::Beside);
        Self { closeness, ..self.clone() }
    }

    /// The same, simulated as roughly as differences are.
    pub fn roughly(&self) -> Self {
        Self { closeness: Closeness::Roughly, ..self.clone() }
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

    /// The same without a channel, simulated roughly: for what the others say of it.
    pub fn without_channel(&self, channel: usize) -> Study<'_> {
        let mut other = self.roughly();
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

    /// Fits what is left of a fitted model without its last effect, beginning where that has ended, with its derivatives.
    ///
    /// # Errors
    /// A model that cannot be run.
    pub fn fit_without_last(&self, fitted: &Fitted, iterations: usize) -> Result<Fitted> {
        let mut model = fitted.model.clone();
        model.effects.pop();
        let known = fitted.fit.jacobian.columns(0, Self::point(&model).len()).into_owned();
        self.fit_roughly(&model, iterations, Some(&known))
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
}
