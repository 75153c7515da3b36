//! Reads recordings that may be faulty, and mends what can be mended.

use super::copies::copies;
use super::time::mend;
use super::values::faults_of_values;
use super::{Fault, FaultKind, Severity, run_name, short};
use crate::recording::{Channel, Columns, Defect, Recording, read_with_defects};
use crate::stats::quantile;
use crate::{Error, Result};
use std::path::Path;

/// A channel that lacks more than this share of its cells is left out, not its rows.
const TOO_EMPTY: f64 = 0.2;

/// A recording as it could be mended, and what was wrong with it.
#[derive(Debug, Clone, PartialEq)]
pub struct RawRecording {
    /// Increasing times, finite values; rows with faulty samples are left out.
    pub recording: Recording,
    /// The channels that drive a model, in all rows in which they are known.
    pub drive: Recording,
    /// What was found in this recording by itself.
    pub faults: Vec<Fault>,
}

/// Reads a recording as [`read_recording`](crate::recording::read_recording) does, but goes on where that stops: time
/// stamps that step back or repeat, empty cells, cells that are no finite number, short rows. All of these
/// become faults, as do gaps, jitter, rails, frozen values and spikes. `names` says what columns are: what is left out is not
/// looked at; `drives` which channels drive a model.
///
/// # Errors
/// A file that cannot be read, a header that cannot be understood, fewer than two rows that are left.
pub(crate) fn read_raw(path: &Path, names: &Columns, drives: &dyn Fn(&str) -> bool) -> Result<RawRecording> {
    let (recording, defects) = read_with_defects(path, names)?;
    mended(recording, &defects, drives)
}

impl RawRecording {
    /// Looks at a recording that is already in memory, in which any channel may drive. Values may be NaN, times need no order.
    ///
    /// # Errors
    /// Fewer than two rows that are left.
    pub fn new(recording: Recording) -> Result<Self> {
        mended(recording, &[], &|_| true)
    }
}

/// All faults that the recordings show by themselves: of each one, and runs that are copies of others.
pub fn faults_of_runs(raw: &[&RawRecording]) -> Vec<Fault> {
    let recordings: Vec<&Recording> = raw.iter().map(|r| &r.recording).collect();
    let own = raw.iter().flat_map(|r| r.faults.iter().map(|fault| (&r.recording, fault)));
    let real =
        own.filter(|(own, fault)| fault.kind != FaultKind::Saturated || is_rail(own, fault, &recordings));
    let mut faults: Vec<Fault> = real.map(|(_, fault)| fault.clone()).collect();
    faults.extend(copies(&recordings));
    faults
}

/// Whether what looks like a rail in one run is one for all: met more than once, and exceeded by none. Else it is where a motion
/// turns, and not where a sensor ends.
fn is_rail(own: &Recording, fault: &Fault, all: &[&Recording]) -> bool {
    let Some(name) = &fault.channel else { return true };
    let Ok(here) = own.channel(name) else { return true };
    let rail = fault.value;
    let is_top = rail >= quantile(&here.values, 1.0);
    let alike = all.iter().filter_map(|recording| recording.channel(name).ok());
    let alike: Vec<&Channel> = alike.filter(|c| c.unit == here.unit).collect();
    let beyond = |v: &f64| if is_top { *v > rail } else { *v < rail };
    let is_exceeded = alike.iter().any(|c| c.values.iter().any(beyond));
    // a peak may be two samples wide by chance
    let visits =
        |c: &Channel| c.values.chunk_by(|a, b| a == b).filter(|w| w.len() > 2 && w[0] == rail).count();
    !is_exceeded && alike.into_iter().map(visits).sum::<usize>() > 1
}

fn mended(
    mut recording: Recording,
    defects: &[Defect],
    drives: &dyn Fn(&str) -> bool,
) -> Result<RawRecording> {
    let mut faults = empty_cells(&mut recording, defects);
    let time = mend(&recording.time);
    faults.extend(time.faults);
    let known = |wanted: &dyn Fn(&str) -> bool| -> Recording {
        let channels: Vec<&Channel> = recording.channels.iter().filter(|c| wanted(&c.name)).collect();
        let is_known = |row: usize| channels.iter().all(|c| c.values.get(row).is_some_and(|v| v.is_finite()));
        let rows: Vec<(usize, f64)> = time.rows.iter().copied().filter(|(row, _)| is_known(*row)).collect();
        let of = |c: &&Channel| Channel {
            values: rows.iter().map(|r| c.values[r.0]).collect(),
            name: c.name.clone(),
            unit: c.unit.clone(),
        };
        Recording {
            time: rows.iter().map(|r| r.1).collect(),
            channels: channels.iter().map(of).collect(),
            source: recording.source.clone(),
        }
    };
    let (mut drive, mut recording) = (known(drives), known(&|_| true));
    let found = faults_of_values(&recording);
    faults.extend(found.faults);
    let spikes: Vec<f64> = found.spikes.iter().map(|row| recording.time[*row]).collect();
    for recording in [&mut drive, &mut recording] {
        let is_spike: Vec<bool> = recording.time.iter().map(|t| spikes.contains(t)).collect();
        leave_out_rows(recording, &is_spike);
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
    Ok(RawRecording { recording, drive, faults })
}

/// Leaves out the rows that are marked.
pub(crate) fn leave_out_rows(recording: &mut Recording, marked: &[bool]) {
    let leave = |values: &mut Vec<f64>| {
        let mut marks = marked.iter();
        values.retain(|_| !marks.next().copied().unwrap_or(false));
    };
    leave(&mut recording.time);
    recording.channels.iter_mut().for_each(|c| leave(&mut c.values));
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
                    "These rows are not compared."
                }
                .into(),
            });
            (!lost).then_some(channel)
        })
        .collect();
    faults
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A swing of 1 Hz with a little noise that goes from `bottom` to `top` at most.
    fn swing(source: &str, (bottom, top): (f64, f64)) -> RawRecording {
        let time: Vec<f64> = (0..800).map(|k| 0.01 * f64::from(k)).collect();
        let mut noise = crate::stats::SplitMix64::new(source.len() as u64);
        let value = |t: &f64| {
            let clean = 2.0 * (std::f64::consts::TAU * t).sin() + 0.02 * noise.normal();
            (clean.clamp(bottom, top) * 500.0).round() / 500.0
        };
        let values = time.iter().map(value).collect();
        let channels = vec![Channel { name: "angle".into(), unit: "rad".into(), values }];
        RawRecording::new(Recording { time, channels, source: source.into() }).unwrap()
    }

    #[test]
    fn a_rail_is_one_for_all_runs() {
        let kinds = |runs: &[RawRecording]| -> Vec<FaultKind> {
            faults_of_runs(&runs.iter().collect::<Vec<_>>()).into_iter().map(|f| f.kind).collect()
        };
        let at_rail = [swing("a.csv", (-9.0, 1.8)), swing("bb.csv", (-9.0, 1.8))];
        assert_eq!(kinds(&at_rail), [FaultKind::Saturated; 2]);
        // another run goes far beyond: the first ones only turn there
        assert_eq!(kinds(&[at_rail[0].clone(), swing("ccc.csv", (-9.0, 9.0))]), []);
        // an amplifier has one at either end
        let both = [swing("a.csv", (-1.6, 1.8)), swing("bb.csv", (-1.6, 1.8))];
        assert_eq!(kinds(&both), [FaultKind::Saturated; 4]);
    }
}
