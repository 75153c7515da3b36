//! A recorder whose clock is not that of the inputs. It is found among the effects, on the same evidence as these, but no machine has it: it
//! is a fault of the recordings, whose times can be put right.

use super::hygiene::{Fault, FaultKind, Severity};
use super::result::Estimate;
use super::search::Found;
use super::study::Study;
use super::tables::all_estimates;
use crate::fit::Run;
use crate::recording::{Recording, interpolate};

/// The effect.
const EFFECT: &str = "clock-drift";

/// All that was measured is shown later and later, or earlier and earlier, by the same share of the time in all runs.
pub(super) struct Drift {
    /// Time that is lost per time, with its interval.
    error: Estimate,
    /// Names of the runs.
    runs: Vec<String>,
}

impl Drift {
    /// If it was found, and may not as well be something else. Beside something that has no name it may be a part of that.
    pub fn of(found: &Found, study: &Study<'_>, runs: &[&Run]) -> Option<Self> {
        let measured = runs.first().map_or(0, |run| run.channels.len());
        let is_drift = |i: &usize| {
            let (placement, _) = &found.current.model.effects[*i];
            found.findings[*i].effect == EFFECT
                && !found.findings[*i].is_open()
                && placement.targets.len() == measured
        };
        if found.unknown.is_some() {
            return None;
        }
        let i = (0..found.findings.len()).find(is_drift)?;
        let error = all_estimates(study, &found.current).into_iter().nth(i)?.into_iter().next()?;
        Some(Self { error, runs: runs.iter().map(|run| run.name.clone()).collect() })
    }

    /// What is wrong.
    pub fn fault(&self) -> Fault {
        let error = self.error.value;
        let (how, sign) = if error < 0.0 { ("earlier", -1e3) } else { ("later", 1e3) };
        let between = |(a, b): (f64, f64)| format!(" ({:.3} to {:.3})", a.min(b), a.max(b));
        let ends = self.error.low.zip(self.error.high).map(|(low, high)| (sign * low, sign * high));
        Fault {
            kind: FaultKind::ClockDrift,
            severity: Severity::Repaired,
            runs: self.runs.clone(),
            channel: None,
            span: None,
            value: 1e6 * error,
            unit: "1e-6".into(),
            evidence: format!(
                "The clock of all that was measured is not that of the inputs: in every run it comes {how} and {how}, by {:.3}{} ms per second.",
                sign * error,
                ends.map(between).unwrap_or_default()
            ),
            advice: format!(
                "Record inputs and outputs with one clock; the times of what was measured, counted from the start of a run, are right if multiplied by {:.6}.",
                1.0 - error
            ),
        }
    }

    /// Puts the times of a run and of its recording right. What was measured after the inputs end is left out, because nobody knows what
    /// drove it.
    pub fn put_right(&self, run: &mut Run, recording: &mut Recording, drive: &Recording) {
        let start = run.drive.start;
        let right = |t: &f64| start + (t - start) * (1.0 - self.error.value);
        let end = drive.time.last().copied().unwrap_or(start);
        run.time = run.time.iter().map(right).take_while(|t| *t <= end).collect();
        run.channels.iter_mut().for_each(|c| *c = c.samples(0..run.time.len()));
        recording.time = recording.time.iter().map(right).take_while(|t| *t <= end).collect();
        for channel in &mut recording.channels {
            // inputs have times of their own
            match drive.channel(&channel.name) {
                Ok(input) => {
                    let at = |t: &f64| interpolate(&drive.time, &input.values, *t);
                    channel.values = recording.time.iter().map(at).collect();
                }
                Err(_) => channel.values.truncate(recording.time.len()),
            }
        }
    }
}
