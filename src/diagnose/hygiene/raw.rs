//! Reads recordings that may be faulty, and mends what can be mended.

use super::copies::copies;
use super::time::mend;
use super::values::faults_of_values;
use super::{Fault, FaultKind, Severity, run_name, short};
use crate::recording::{Channel, Defect, Recording, read_csv_with_defects};
use crate::{Error, Result};
use std::path::Path;

/// A channel that lacks more than this share of its cells is left out, not its rows.
const TOO_EMPTY: f64 = 0.2;

/// A recording as it could be mended, and what was wrong with it.
#[derive(Debug, Clone, PartialEq)]
pub struct RawRecording {
    /// Increasing times, finite values; faulty samples are left out.
    pub recording: Recording,
    /// What was found in this recording by itself.
    pub faults: Vec<Fault>,
}

/// Reads a CSV file as [`read_csv`](crate::recording::read_csv) does, but goes on where that stops: time
/// stamps that step back or repeat, empty cells, cells that are no finite number, short rows. All of these
/// become faults, as do gaps, jitter, rails, frozen values and spikes.
///
/// # Errors
/// A file that cannot be read, a header that cannot be understood, fewer than two rows that are left.
pub fn read_raw(path: &Path) -> Result<RawRecording> {
    let (recording, defects) = read_csv_with_defects(path)?;
    mended(recording, &defects)
}

impl RawRecording {
    /// Looks at a recording that is already in memory. Values may be NaN, times need no order.
    ///
    /// # Errors
    /// Fewer than two rows that are left.
    pub fn new(recording: Recording) -> Result<Self> {
        mended(recording, &[])
    }
}

/// All faults that the recordings show by themselves: of each one, and runs that are copies of others.
pub fn faults_of_runs(raw: &[RawRecording]) -> Vec<Fault> {
    let mut faults: Vec<Fault> = raw.iter().flat_map(|r| r.faults.iter().cloned()).collect();
    faults.extend(copies(&raw.iter().map(|r| &r.recording).collect::<Vec<_>>()));
    faults
}

fn mended(mut recording: Recording, defects: &[Defect]) -> Result<RawRecording> {
    let mut faults = empty_cells(&mut recording, defects);
    let time = mend(&recording.time);
    faults.extend(time.faults);
    let rows: Vec<(usize, f64)> = time
        .rows
        .into_iter()
        .filter(|(row, _)| {
            recording.channels.iter().all(|c| c.values.get(*row).is_some_and(|v| v.is_finite()))
        })
        .collect();
    let mut recording = Recording {
        time: rows.iter().map(|r| r.1).collect(),
        channels: recording
            .channels
            .iter()
            .map(|c| Channel {
                values: rows.iter().map(|r| c.values[r.0]).collect(),
                name: c.name.clone(),
                unit: c.unit.clone(),
            })
            .collect(),
        source: recording.source,
    };
    let found = faults_of_values(&recording);
    faults.extend(found.faults);
    if !found.spikes.is_empty() {
        let keep = |row: &usize| found.spikes.binary_search(row).is_err();
        let pick =
            |values: &[f64]| (0..values.len()).filter(keep).map(|row| values[row]).collect::<Vec<f64>>();
        recording.time = pick(&recording.time);
        recording.channels.iter_mut().for_each(|c| c.values = pick(&c.values));
    }
    if recording.time.len() < 2 {
        return Err(Error::file(format!(
            "{}: {} row(s) are left without the faulty ones; at least 2 are needed{}",
            recording.source,
            recording.time.len(),
            defects.first().map(|d| format!("; the first defect: {}", d.error)).unwrap_or_default()
        )));
    }
    let run = run_name(&recording.source);
    faults.iter_mut().for_each(|fault| fault.runs = vec![run.clone()]);
    Ok(RawRecording { recording, faults })
}

/// Cells without a finite number; channels that have too many of them are taken out of the recording.
fn empty_cells(recording: &mut Recording, defects: &[Defect]) -> Vec<Fault> {
    let mut faults = Vec::new();
    let rows = recording.time.len();
    // rows that are bad throughout are the time's fault
    let whole: Vec<bool> = (0..rows)
        .map(|row| recording.time[row].is_nan() || recording.channels.iter().all(|c| c.values[row].is_nan()))
        .collect();
    let said = |channel: Option<usize>, row: usize| {
        defects
            .iter()
            .find(|d| d.row == row && (d.channel == channel || d.channel.is_none()))
            .map(|d| format!(" The first: {}.", d.error))
            .unwrap_or_default()
    };
    let bad: Vec<usize> = (0..rows).filter(|row| whole[*row]).collect();
    if let (Some(&first), Some(&last)) = (bad.first(), bad.last()) {
        faults.push(Fault {
            kind: FaultKind::EmptyCells,
            severity: Severity::Repaired,
            runs: Vec::new(),
            channel: None,
            span: Some((recording.time[first], recording.time[last]))
                .filter(|s| s.0.is_finite() && s.1.is_finite()),
            value: bad.len() as f64,
            unit: "1".into(),
            evidence: format!("{} of {rows} rows cannot be read.{}", bad.len(), said(None, first)),
            advice: "These rows were left out; check whether the file was cut off or edited.".into(),
        });
    }
    recording.channels = std::mem::take(&mut recording.channels)
        .into_iter()
        .enumerate()
        .filter_map(|(i, channel)| {
            let bad: Vec<usize> =
                (0..rows).filter(|row| !whole[*row] && !channel.values[*row].is_finite()).collect();
            let (Some(&first), Some(&last)) = (bad.first(), bad.last()) else { return Some(channel) };
            let share = bad.len() as f64 / rows as f64;
            let lost = share > TOO_EMPTY;
            faults.push(Fault {
                kind: FaultKind::EmptyCells,
                severity: if lost { Severity::Fatal } else { Severity::Repaired },
                runs: Vec::new(),
                channel: Some(channel.name.clone()),
                span: Some((recording.time[first], recording.time[last])),
                value: bad.len() as f64,
                unit: "1".into(),
                evidence: format!(
                    "{} has no number in {} of {rows} rows ({} %).{}",
                    channel.name,
                    bad.len(),
                    short(100.0 * share),
                    said(Some(i), first)
                ),
                advice: if lost {
                    "The channel was left out; write channels of different rates on one time, or into files of their own."
                } else {
                    "These rows were left out."
                }
                .into(),
            });
            (!lost).then_some(channel)
        })
        .collect();
    faults
}
