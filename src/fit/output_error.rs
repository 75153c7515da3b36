//! [`OutputError`]: what a slave with effects makes of recorded inputs, against what was measured.

use super::bench::{Bench, Drive, Setup, Traces};
use super::least_squares::Problem;
use crate::effect::Attachment;
use std::sync::Arc;

/// A measured channel of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// The output that it is compared with.
    pub variable: usize,
    /// Measured values, in the unit of the output.
    pub values: Vec<f64>,
    /// True if it counts on and on from a zero that means nothing, as the angle of a wheel does: only
    /// its changes within a run are compared.
    pub counts: bool,
}

impl Channel {
    /// Moves a simulated course to the zero from which the measured one counts.
    fn same_zero(&self, simulated: &mut [f64]) {
        if self.counts {
            let sum: f64 = self.values.iter().zip(&*simulated).map(|(m, s)| m - s).sum();
            let mean = sum / self.values.len().max(1) as f64;
            simulated.iter_mut().for_each(|s| *s += mean);
        }
    }
}

/// A recorded run, ready to be simulated.
#[derive(Debug, Clone)]
pub struct Run {
    /// Name of its file.
    pub name: String,
    /// What drives it.
    pub drive: Arc<Drive>,
    /// Times of the measured samples \[s\].
    pub time: Vec<f64>,
    /// Measured channels; the same in every run, and empty where one lacks it.
    pub channels: Vec<Channel>,
}

impl Run {
    /// A trace on the grid of communication points at the times of the samples less `lag` \[s\], linear in
    /// between.
    pub fn sample(&self, trace: &[f64], lag: f64) -> Vec<f64> {
        let last = trace.len().saturating_sub(2);
        self.time
            .iter()
            .map(|t| {
                let place = ((t - lag - self.drive.start) / self.drive.step).max(0.0);
                let k = (place as usize).min(last);
                let share = place - k as f64;
                match trace.get(k + 1) {
                    // samples beside a point are that point
                    Some(_) if share < 1e-9 => trace[k],
                    Some(next) => trace[k] + (next - trace[k]) * share.min(1.0),
                    None => trace[k],
                }
            })
            .collect()
    }
}

/// What an unknown of a fit is, with the size of one unit of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Knob {
    /// A parameter of the slave: index and scale.
    Parameter(usize, f64),
    /// A parameter of an effect that is attached once or at several places.
    Effect {
        /// Number of the first attachment,
        first: usize,
        /// and of the one behind the last.
        end: usize,
        /// Number of the parameter.
        parameter: usize,
        /// Size of one unit.
        scale: f64,
        /// The unknown is the logarithm of the parameter over its scale.
        logarithmic: bool,
    },
    /// A lag of all recorded channels \[s\] behind the inputs, and its scale: filters of the recorder.
    Lag(f64),
}

/// The residuals of some runs as a function of the unknowns.
pub struct OutputError<'a> {
    /// What runs.
    pub bench: &'a Bench,
    /// The runs.
    pub runs: Vec<&'a Run>,
    /// What the unknowns are.
    pub knobs: Vec<Knob>,
    /// Values that stay.
    pub values: Vec<(usize, f64)>,
    /// Effects, with parameters where the unknowns do not say otherwise.
    pub attachments: Vec<Attachment>,
    /// One weight per channel: residuals are multiplied by it.
    pub weights: Vec<f64>,
}

impl OutputError<'_> {
    /// The setup for a point.
    pub fn setup(&self, point: &[f64]) -> Setup {
        let mut setup = Setup { values: self.values.clone(), attachments: self.attachments.clone() };
        for (knob, x) in self.knobs.iter().zip(point) {
            match *knob {
                Knob::Parameter(variable, scale) => {
                    setup.values.retain(|(v, _)| *v != variable);
                    setup.values.push((variable, x * scale));
                }
                Knob::Effect { first, end, parameter, scale, logarithmic } => {
                    let value = if logarithmic { x.exp() } else { *x };
                    for attachment in &mut setup.attachments[first..end] {
                        attachment.parameters[parameter].value = value * scale;
                    }
                }
                Knob::Lag(_) => {}
            }
        }
        setup
    }

    fn lag(&self, point: &[f64]) -> f64 {
        let of = |(knob, x): (&Knob, &f64)| if let Knob::Lag(scale) = knob { x * scale } else { 0.0 };
        self.knobs.iter().zip(point).map(of).sum()
    }

    /// The outputs that are compared.
    pub fn watch(&self) -> Arc<[usize]> {
        self.runs.first().map_or(Arc::from([]), |r| r.channels.iter().map(|c| c.variable).collect())
    }

    /// The simulated channels of every run at its samples, for each point; `None` where a run fails.
    pub fn simulate(&self, points: &[Vec<f64>]) -> Vec<Option<Vec<Traces>>> {
        let setups: Vec<Arc<Setup>> = points.iter().map(|p| Arc::new(self.setup(p))).collect();
        let drives: Vec<Arc<Drive>> = self.runs.iter().map(|r| Arc::clone(&r.drive)).collect();
        let results = self.bench.run(&setups, &drives, &self.watch());
        results
            .chunks(self.runs.len().max(1))
            .zip(points)
            .map(|(runs, point)| {
                let lag = self.lag(point);
                let sampled = runs.iter().zip(&self.runs).map(|(traces, run)| {
                    let sample = |(trace, channel): (&Vec<f64>, &Channel)| {
                        let mut values = run.sample(trace, lag);
                        channel.same_zero(&mut values);
                        values
                    };
                    traces.as_ref().ok().map(|traces| traces.iter().zip(&run.channels).map(sample).collect())
                });
                sampled.collect()
            })
            .collect()
    }

    /// Simulated minus measured, weighted: run by run, channel by channel.
    pub fn difference(&self, simulated: &[Traces]) -> Vec<f64> {
        let mut residuals = Vec::new();
        for (run, traces) in self.runs.iter().zip(simulated) {
            for ((channel, trace), weight) in run.channels.iter().zip(traces).zip(&self.weights) {
                residuals.extend(trace.iter().zip(&channel.values).map(|(s, m)| weight * (s - m)));
            }
        }
        residuals
    }
}

impl Problem for OutputError<'_> {
    fn residuals(&self, points: &[Vec<f64>]) -> Vec<Option<Vec<f64>>> {
        self.simulate(points).into_iter().map(|s| s.map(|s| self.difference(&s))).collect()
    }
}
