//! The zeros of the outputs: what they show off the road, where the model knows what there is.

use super::matching::{Signals, Track, nearest};
use crate::identify::plan::{Plan, Recordings};
use crate::identify::readings::Readings;
use crate::identify::registry::Numbers;
use crate::stats::{about_mean, mean};
use crate::{Error, Result};
use std::collections::BTreeMap;

/// What outputs show more than there is.
pub struct Zeros {
    /// For each output, the mean over the recordings.
    pub offsets: Vec<f64>,
    /// For each output, the standard deviation from recording to recording.
    pub drift: Vec<f64>,
    /// In so many recordings there was one.
    pub recordings: usize,
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
        let (mut found, mut all) = (BTreeMap::<usize, Vec<Vec<f64>>>::new(), Vec::new());
        for (number, track) in tracks.iter().enumerate() {
            for reading in track.stretches(number, signals, plan, ranges) {
                if condition.is_met(&reading, signals).is_ok() && reading.moving.is_none() {
                    let known = model.respond(condition, &reading, signals, &[], parameters)?;
                    let more = reading.point.outputs.iter().zip(known).map(|(value, known)| value - known);
                    found.entry(number).or_default().push(more.collect());
                }
                all.push(reading);
            }
        }
        if found.is_empty() {
            let names: Vec<String> = tracks.iter().map(|t| t.recording.source.clone()).collect();
            return Err(Error::file(format!(
                "the zero of the load cell is not known: no recording is one of \"{}\": {}",
                how.zero,
                nearest(condition, &all, signals, &names)
            )));
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
        Ok(Self { offsets, drift, recordings: found.len() })
    }
}
