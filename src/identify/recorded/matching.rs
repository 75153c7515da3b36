//! Which stretches of which recordings meet which condition of a plan.

use super::estimate::Point;
use super::stretches::{Watched, stretches};
use crate::Result;
use crate::identify::plan::{Condition, Plan, Ramp};
use crate::model::Interface;
use crate::recording::Recording;
use crate::stats::{even_line, mean, median_interval};
use std::collections::BTreeSet;

/// A ramp may be so much faster or slower than the plan's, as a share.
const OTHER_RATE: f64 = 0.3;

/// What recordings are made of: the inputs and outputs that a plan speaks of.
#[derive(Debug, Clone, PartialEq)]
pub struct Signals {
    /// Inputs: names and numbers of variables.
    pub inputs: Vec<(String, usize)>,
    /// Outputs.
    pub outputs: Vec<(String, usize)>,
}

impl Signals {
    /// Those of the plan's recorded conditions; `outputs` are those that its targets read.
    ///
    /// # Errors
    /// The model does not have one.
    pub fn of(plan: &Plan, interface: &Interface, outputs: &BTreeSet<String>) -> Result<Self> {
        let names: BTreeSet<&String> = plan.conditions.iter().flat_map(|c| c.recorded.keys()).collect();
        let measuring = plan.recordings.iter().flat_map(|r| r.measured_by.values());
        let outputs: BTreeSet<&String> = outputs.iter().chain(measuring).collect();
        let find = |name: &&String| Ok(((*name).clone(), interface.find(name)?));
        Ok(Self {
            inputs: names.iter().map(find).collect::<Result<_>>()?,
            outputs: outputs.iter().map(find).collect::<Result<_>>()?,
        })
    }

    /// For each input the output that measures it, if it is no motion.
    pub fn measured_by(&self, plan: &Plan) -> Vec<Option<usize>> {
        let measured = |name: &String| plan.recordings.as_ref().and_then(|r| r.measured_by.get(name));
        self.inputs.iter().map(|(name, _)| measured(name).and_then(|o| self.output(o))).collect()
    }

    /// The place of an input.
    pub fn input(&self, name: &str) -> Option<usize> {
        self.inputs.iter().position(|(own, _)| own == name)
    }

    /// The place of an output.
    pub fn output(&self, name: &str) -> Option<usize> {
        self.outputs.iter().position(|(own, _)| own == name)
    }
}

/// What was read from a recording at once: a stretch in which nothing moves, or a ramp.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Number of the recording.
    pub recording: usize,
    /// When \[s\].
    pub time: [f64; 2],
    /// Means.
    pub point: Point,
    /// Standard errors of the inputs, from what scatters within.
    pub errors: Vec<f64>,
    /// How the input moves, of a ramp.
    pub moved: Option<Moved>,
    /// The output that has not come to rest, if there is one.
    pub moving: Option<usize>,
}

/// A move of an input.
#[derive(Debug, Clone, PartialEq)]
pub struct Moved {
    /// Its rate, in its unit per second.
    pub rate: f64,
    /// Where it is when the reading begins and ends.
    pub window: [f64; 2],
}

/// A recording in the units of the model.
pub struct Track<'a> {
    /// The recording.
    pub recording: &'a Recording,
    inputs: Vec<Vec<f64>>,
    outputs: Vec<Vec<f64>>,
    /// The output that an input is measured by.
    measured_by: Vec<Option<usize>>,
    /// Inputs that are not recorded, for which the plan's value is taken.
    pub assumed: Vec<String>,
}

impl<'a> Track<'a> {
    /// Takes the signals from a recording.
    ///
    /// # Errors
    /// An output is not recorded; a unit of another dimension; values that are no numbers.
    pub fn new(
        recording: &'a Recording,
        signals: &Signals,
        plan: &Plan,
        interface: &Interface,
    ) -> Result<Self> {
        let mut assumed = Vec::new();
        let unit = |variable: usize| interface.variables[variable].unit.as_deref().unwrap_or("1");
        let mut inputs = Vec::new();
        for (name, variable) in &signals.inputs {
            let measured = plan.recordings.as_ref().and_then(|r| r.measured_by.get(name));
            let actual = format!("actual_{name}");
            let names = [measured.map_or(name.as_str(), String::as_str), &actual];
            let found = names.iter().rev().find(|n| recording.has(n));
            inputs.push(match found {
                Some(channel) => recording.channel_in(channel, unit(*variable))?,
                None => {
                    assumed.push(name.clone());
                    vec![plan.set.get(name).copied().unwrap_or(0.0); recording.time.len()]
                }
            });
        }
        let outputs = signals
            .outputs
            .iter()
            .map(|(name, variable)| recording.channel_in(name, unit(*variable)))
            .collect::<Result<_>>()?;
        let measured_by = signals.measured_by(plan);
        Ok(Self { recording, inputs, outputs, measured_by, assumed })
    }

    /// All stretches in which nothing moves.
    pub fn stretches(&self, number: usize, signals: &Signals, plan: &Plan, ranges: &[f64]) -> Vec<Reading> {
        let Some(recordings) = &plan.recordings else { return Vec::new() };
        let motions = signals.inputs.iter().map(|(name, _)| recordings.held_within.get(name).copied());
        let mut watched: Vec<Watched<'_>> = self
            .inputs
            .iter()
            .zip(motions)
            .map(|(values, within)| {
                let held_within = Some(within.unwrap_or(f64::INFINITY));
                Watched { values, held_within, range: 0.0 }
            })
            .collect();
        let responses = self.outputs.iter().zip(ranges);
        watched.extend(responses.map(|(values, range)| Watched { values, held_within: None, range: *range }));
        let n = self.inputs.len();
        let time = &self.recording.time;
        stretches(time, &watched)
            .into_iter()
            .map(|s| Reading {
                recording: number,
                time: [time[s.samples[0]], time[s.samples[1] - 1]],
                point: Point { inputs: s.means[..n].to_vec(), outputs: s.means[n..].to_vec() },
                errors: s.errors[..n].to_vec(),
                moved: None,
                moving: s.moving.and_then(|m| m.checked_sub(n)),
            })
            .collect()
    }

    /// All ramps of a condition, of which the tire touches the road where the input has the value `touch`.
    pub fn ramps(&self, number: usize, signals: &Signals, ramp: &Ramp, touch: f64) -> Vec<Reading> {
        let (Some(input), Some([from, to])) = (signals.input(&ramp.input), ramp.window) else {
            return Vec::new();
        };
        let time = &self.recording.time;
        let step = median_interval(time);
        let values = &self.inputs[input];
        // the window as it is at the plan's rate, and where its middle is passed
        let length = (to - from) / ramp.rate.abs();
        let half = ((0.5 * length / step).round() as usize).max(2);
        let middle = touch + 0.5 * (from + to);
        let side = ramp.rate.signum();
        let mut found = Vec::new();
        let mut k = half;
        while k + half < values.len() {
            let near = &values[k - half..=k + half];
            let (level, slope) = even_line(near);
            let centre = level + slope * half as f64;
            let rate = slope / step;
            let passes = side * (centre - middle) >= 0.0 && side * (centre - slope - middle) < 0.0;
            if !passes || (rate / ramp.rate - 1.0).abs() > OTHER_RATE {
                k += 1;
                continue;
            }
            let span = (0.5 * (to - from) / slope).abs().round() as usize;
            let (first, last) = (k.saturating_sub(span), (k + span + 1).min(values.len()));
            let means = |all: &[Vec<f64>]| all.iter().map(|v| mean(&v[first..last])).collect();
            found.push(Reading {
                recording: number,
                time: [time[first], time[last - 1]],
                point: Point { inputs: means(&self.inputs), outputs: means(&self.outputs) },
                errors: vec![0.0; self.inputs.len()],
                moved: Some(Moved {
                    rate,
                    window: [-1.0, 1.0].map(|side| centre + side * slope * span as f64),
                }),
                moving: None,
            });
            k = last + half;
        }
        found
    }

    /// Least and largest value of each output.
    pub fn ends(&self) -> impl Iterator<Item = [f64; 2]> {
        let wider = |[low, high]: [f64; 2], v: &f64| [low.min(*v), high.max(*v)];
        self.outputs.iter().map(move |values| values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], wider))
    }

    /// Takes offsets off the outputs, and off inputs that are what an output measures.
    pub fn correct(&mut self, offsets: &[f64]) {
        for (values, offset) in self.outputs.iter_mut().zip(offsets) {
            values.iter_mut().for_each(|v| *v -= offset);
        }
        for (values, output) in self.inputs.iter_mut().zip(&self.measured_by) {
            if let Some(measured) = output.and_then(|o| self.outputs.get(o)) {
                values.clone_from(measured);
            }
        }
    }
}

impl Condition {
    /// Whether a reading is one of this condition; else by which input it is not, and how far away that is in units of what is
    /// allowed.
    pub(super) fn is_met(
        &self,
        reading: &Reading,
        signals: &Signals,
    ) -> std::result::Result<(), (String, f64)> {
        let mut worst: Option<(String, f64)> = None;
        for (name, [low, high]) in &self.recorded {
            let Some(place) = signals.input(name) else { continue };
            let value = reading.point.inputs[place];
            let beyond = (low - value).max(value - high) / (high - low);
            if beyond > 0.0 && worst.as_ref().is_none_or(|(_, most)| beyond > *most) {
                worst = Some((name.clone(), beyond));
            }
        }
        worst.map_or(Ok(()), Err)
    }
}

/// Why no reading is one of a condition: what comes nearest to it.
pub fn nearest(condition: &Condition, readings: &[Reading], signals: &Signals, names: &[String]) -> String {
    let mut best: Option<(f64, String)> = None;
    for reading in readings {
        if let Err((input, beyond)) = condition.is_met(reading, signals)
            && best.as_ref().is_none_or(|(least, _)| beyond < *least)
        {
            let value = signals.input(&input).map_or(f64::NAN, |k| reading.point.inputs[k]);
            let [low, high] = condition.recorded.get(&input).copied().unwrap_or([f64::NAN; 2]);
            let [from, to] = reading.time;
            let text = format!(
                "nearest is {} from {from:.2} to {to:.2} s with {input} = {value:.4}, which has to be {low} to {high}",
                names[reading.recording]
            );
            best = Some((beyond, text));
        }
    }
    best.map_or_else(|| "there is no stretch in which nothing moves".to_owned(), |(_, text)| text)
}
