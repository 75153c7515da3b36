//! Which stretches of which recordings meet which condition of a plan.

use super::estimate::Point;
use super::stretches::{Sampled, Watched, piece_length, sections, stretches};
use crate::Result;
use crate::identify::plan::{Condition, Plan, Ramp};
use crate::model::Interface;
use crate::recording::Recording;
use crate::stats::{even_line, mean, median_interval};
use std::collections::BTreeSet;
use std::ops::Range;

/// A ramp may be so much faster or slower than the plan's, as a share.
const OTHER_RATE: f64 = 0.3;
/// A ramp goes back to where the input is this share of its window beside the line: so far it cannot be said where it began.
const BESIDE: f64 = 0.25;

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
    /// And of the outputs.
    pub noise: Vec<f64>,
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
    /// Where the ramp began.
    pub begins: f64,
    /// Where the tire touches the road, by the model.
    pub touch: f64,
}

/// A recording in the units of the model.
#[derive(Clone)]
pub struct Track<'a> {
    /// The recording.
    pub recording: &'a Recording,
    inputs: Vec<Sampled>,
    outputs: Vec<Sampled>,
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
        let piece = piece_length(&recording.time);
        let unit = |variable: usize| interface.variables[variable].unit.as_deref().unwrap_or("1");
        let mut inputs = Vec::new();
        for (name, variable) in &signals.inputs {
            let measured = plan.recordings.as_ref().and_then(|r| r.measured_by.get(name));
            let actual = format!("actual_{name}");
            let names = [measured.map_or(name.as_str(), String::as_str), &actual];
            let found = names.iter().rev().find(|n| recording.has(n));
            let values = match found {
                Some(channel) => recording.channel_in(channel, unit(*variable))?,
                None => {
                    assumed.push(name.clone());
                    vec![plan.set.get(name).copied().unwrap_or(0.0); recording.time.len()]
                }
            };
            inputs.push(Sampled::new(values, piece));
        }
        let outputs = signals
            .outputs
            .iter()
            .map(|(name, variable)| Ok(Sampled::new(recording.channel_in(name, unit(*variable))?, piece)))
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
            .map(|(channel, within)| {
                let held_within = Some(within.unwrap_or(f64::INFINITY));
                Watched { channel, held_within, range: 0.0 }
            })
            .collect();
        let responses = self.outputs.iter().zip(ranges);
        watched.extend(responses.map(|(channel, range)| Watched {
            channel,
            held_within: None,
            range: *range,
        }));
        let n = self.inputs.len();
        let time = &self.recording.time;
        stretches(time, &watched)
            .into_iter()
            .map(|s| Reading {
                recording: number,
                time: [time[s.samples[0]], time[s.samples[1] - 1]],
                point: Point { inputs: s.means[..n].to_vec(), outputs: s.means[n..].to_vec() },
                errors: s.errors[..n].to_vec(),
                noise: s.errors[n..].to_vec(),
                moved: None,
                moving: s.moving.and_then(|m| m.checked_sub(n)),
            })
            .collect()
    }

    /// All ramps of a condition, of which the tire touches the road where the input has the value `touch`.
    pub fn ramps(&self, number: usize, signals: &Signals, ramp: &Ramp, touch: f64) -> Vec<Reading> {
        let (Some(input), Some(window)) = (signals.input(&ramp.input), ramp.window) else {
            return Vec::new();
        };
        let time = &self.recording.time;
        let mut found = Vec::new();
        for section in sections(time) {
            self.ramps_within(section, input, (ramp.rate, window), touch, |samples, moved| {
                let means =
                    |all: &[Sampled]| all.iter().map(|c| mean(&c.values()[samples.clone()])).collect();
                let errors = |all: &[Sampled]| all.iter().map(|c| c.noise().error(samples.len())).collect();
                found.push(Reading {
                    recording: number,
                    time: [time[samples.start], time[samples.end - 1]],
                    point: Point { inputs: means(&self.inputs), outputs: means(&self.outputs) },
                    errors: errors(&self.inputs),
                    noise: errors(&self.outputs),
                    moved: Some(moved),
                    moving: None,
                });
            });
        }
        found
    }

    /// Hands on those among some samples: an input passes a window, which counts from `touch` on, at about a rate.
    fn ramps_within(
        &self,
        section: Range<usize>,
        input: usize,
        (usual, [from, to]): (f64, [f64; 2]),
        touch: f64,
        mut found: impl FnMut(Range<usize>, Moved),
    ) {
        let step = median_interval(&self.recording.time);
        let values = self.inputs[input].values();
        // the window as it is at the plan's rate, and where its middle is passed
        let length = (to - from) / usual.abs();
        let half = ((0.5 * length / step).round() as usize).max(2);
        let middle = touch + 0.5 * (from + to);
        let side = usual.signum();
        let mut k = section.start + half;
        while k + half < section.end {
            let near = &values[k - half..=k + half];
            let (level, slope) = even_line(near);
            let centre = level + slope * half as f64;
            let rate = slope / step;
            let passes = side * (centre - middle) >= 0.0 && side * (centre - slope - middle) < 0.0;
            if !passes || (rate / usual - 1.0).abs() > OTHER_RATE {
                k += 1;
                continue;
            }
            let span = (0.5 * (to - from) / slope).abs().round() as usize;
            let samples = k.saturating_sub(span).max(section.start)..(k + span + 1).min(section.end);
            let on_line = |j: &usize| {
                let line = centre + slope * (*j as f64 - k as f64);
                (values[*j] - line).abs() <= BESIDE * (to - from)
            };
            let begin = (section.start..samples.start).rev().take_while(on_line).last();
            let window = [-1.0, 1.0].map(|side| centre + side * slope * span as f64);
            let begins = values[begin.unwrap_or(samples.start)];
            k = samples.end + half;
            found(samples, Moved { rate, window, begins, touch });
        }
    }

    /// What it was between, of each gap \[s\].
    pub fn gaps(&self) -> Vec<[f64; 2]> {
        let time = &self.recording.time;
        let sections = sections(time);
        sections.windows(2).map(|two| [time[two[0].end - 1], time[two[1].start]]).collect()
    }

    /// The same with an input, and the output that measures it, times a factor.
    pub fn with_scaled(&self, input: usize, factor: f64) -> Self {
        let mut scaled = self.clone();
        scaled.inputs[input].change(|v| v * factor);
        if let Some(output) = self.measured_by[input] {
            scaled.outputs[output].change(|v| v * factor);
        }
        scaled
    }

    /// Least and largest value of each output.
    pub fn ends(&self) -> impl Iterator<Item = [f64; 2]> {
        let wider = |[low, high]: [f64; 2], v: &f64| [low.min(*v), high.max(*v)];
        self.outputs.iter().map(move |c| c.values().iter().fold([f64::INFINITY, f64::NEG_INFINITY], wider))
    }

    /// Takes offsets off the outputs, and off inputs that are what an output measures.
    pub fn correct(&mut self, offsets: &[f64]) {
        for (channel, offset) in self.outputs.iter_mut().zip(offsets) {
            channel.change(|v| v - offset);
        }
        for (channel, output) in self.inputs.iter_mut().zip(&self.measured_by) {
            if let Some(measured) = output.and_then(|o| self.outputs.get(o)) {
                channel.clone_from(measured);
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
    let none = || match &condition.ramp {
        Some(ramp) => format!("there is no ramp of {} at about {} per second", ramp.input, ramp.rate),
        None => "there is no stretch in which nothing moves".to_owned(),
    };
    best.map_or_else(none, |(_, text)| text)
}
