//! The zeros of the outputs: what they show off the road, where the model knows what there is.

use super::matching::{Reading, Signals, Track, nearest};
use crate::identify::plan::{Plan, Recordings};
use crate::identify::readings::Readings;
use crate::identify::registry::Numbers;
use crate::stats::{about_mean, mean, median};
use crate::{Error, Result};
use std::collections::BTreeMap;

/// A zero that is so much of the range of its channel beside the others is none: load cells drift by less, and a tire that touches the
/// road by a millimetre or two, because the height is off, shows more.
const DRIFTS: f64 = 0.03;

/// What outputs show more than there is.
pub struct Zeros {
    /// For each output, the mean over the recordings.
    pub offsets: Vec<f64>,
    /// For each output, the standard deviation from recording to recording.
    pub drift: Vec<f64>,
    /// In so many recordings there was one.
    pub recordings: usize,
    /// Stretches that were left out.
    pub notes: Vec<String>,
}

impl Zeros {
    /// The zeros of recordings.
    ///
    /// # Errors
    /// None of them has any: what comes nearest.
    pub fn of(
        plan: &Plan,
        how: &Recordings,
        model: &Readings<'_>,
        signals: &Signals,
        tracks: &[Track<'_>],
        ranges: &[f64],
        parameters: &Numbers,
    ) -> Result<Self> {
        let condition = plan.condition(&how.zero)?;
        let (mut stretches, mut all) = (Vec::<(Reading, Vec<f64>)>::new(), Vec::new());
        for (number, track) in tracks.iter().enumerate() {
            for reading in track.stretches(number, signals, plan, ranges) {
                if condition.is_met(&reading, signals).is_ok() && reading.moving.is_none() {
                    let known = model.respond(condition, &reading, signals, &[], parameters)?;
                    let more = reading.point.outputs.iter().zip(known).map(|(value, known)| value - known);
                    stretches.push((reading.clone(), more.collect()));
                }
                all.push(reading);
            }
        }
        if stretches.is_empty() {
            let names: Vec<String> = tracks.iter().map(|t| t.recording.source.clone()).collect();
            return Err(Error::file(format!(
                "the zero of the load cell is not known: no recording is one of \"{}\": {}",
                how.zero,
                nearest(condition, &all, signals, &names)
            )));
        }
        let usual: Vec<f64> = (0..signals.outputs.len())
            .map(|output| median(&stretches.iter().map(|(_, more)| more[output]).collect::<Vec<_>>()))
            .collect();
        let mut notes = Vec::new();
        let mut found = BTreeMap::<usize, Vec<Vec<f64>>>::new();
        for (reading, more) in stretches {
            let apart = |output: &usize| (more[*output] - usual[*output]).abs() > DRIFTS * ranges[*output];
            match (0..more.len()).find(apart) {
                None => found.entry(reading.recording).or_default().push(more),
                Some(output) => notes.push(format!(
                    "{} from {:.2} to {:.2} s: {} is {:.3e} where zeros elsewhere are {:.3e}: not taken for a zero; is the tire off the road?",
                    tracks[reading.recording].recording.source,
                    reading.time[0],
                    reading.time[1],
                    signals.outputs[output].0,
                    more[output],
                    usual[output]
                )),
            }
        }
        let (mut offsets, mut drift) = (Vec::new(), Vec::new());
        for output in 0..signals.outputs.len() {
            let of_recording = |stretches: &Vec<Vec<f64>>| {
                mean(&stretches.iter().map(|values| values[output]).collect::<Vec<f64>>())
            };
            let zeros: Vec<f64> = found.values().map(of_recording).collect();
            offsets.push(mean(&zeros));
            drift.push((about_mean(&zeros) / (zeros.len().max(2) - 1) as f64).sqrt());
        }
        Ok(Self { offsets, drift, recordings: found.len(), notes })
    }
}
