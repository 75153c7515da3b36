//! From a folder of recordings to runs: reading, what they have in common, faults that show beside a simulation.

use super::hygiene;
use super::result::Use;
use super::runs::Map;
use super::study::{Model, Study};
use super::subject::Subject;
use crate::fit::Run;
use crate::recording::Recording;
use crate::{Error, Result};
use std::path::{Path, PathBuf};

pub(super) fn read_folder(folder: &Path, map: &Map) -> Result<(Vec<String>, Vec<hygiene::RawRecording>)> {
    let place = folder.display();
    let entries =
        std::fs::read_dir(folder).map_err(|e| Error::file(format!("{place} cannot be read: {e}")))?;
    let mut files: Vec<PathBuf> = entries
        .filter_map(|e| e.ok().map(|e| e.path()))
        .filter(|p| p.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv")))
        .collect();
    files.sort();
    if files.is_empty() {
        return Err(Error::file(format!("{place}: there is no recording, that is no file *.csv")));
    }
    let mut recordings = Vec::new();
    for file in &files {
        let mut raw = hygiene::read_raw(file)?;
        map.apply(&mut raw.recording);
        recordings.push(raw);
    }
    let name = |p: &PathBuf| p.file_name().unwrap_or_default().to_string_lossy().into_owned();
    Ok((files.iter().map(name).collect(), recordings))
}

pub(super) fn same_channels(subject: &Subject, runs: &[(Run, Use)]) -> Result<()> {
    let Some((first, _)) = runs.first() else { return Ok(()) };
    let list = |run: &Run| run.channels.iter().map(|c| c.variable).collect::<Vec<_>>();
    for (run, _) in runs {
        if list(run) != list(first) {
            let name = |v: &usize| subject.interface.variables[*v].name.clone();
            let words = |run: &Run| list(run).iter().map(name).collect::<Vec<_>>().join(", ");
            return Err(Error::file(format!(
                "{} has the measured channels {}, {} has {}: all runs need the same; leave runs out in runs.toml or channels out in a map",
                first.name,
                words(first),
                run.name,
                words(run)
            )));
        }
    }
    Ok(())
}

/// The shortest of the runs' median sampling intervals \[s\].
pub(super) fn shortest_interval(runs: &[&Run]) -> f64 {
    let median = |run: &&Run| {
        let mut all: Vec<f64> = run.time.windows(2).map(|w| w[1] - w[0]).collect();
        all.sort_by(f64::total_cmp);
        all.get(all.len() / 2).copied().unwrap_or(0.0)
    };
    let least = runs.iter().map(median).fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

/// Faults that show against the refitted model.
pub(super) fn faults_against(
    study: &Study<'_>,
    subject: &Subject,
    model: &Model,
    runs: &[&Run],
    recordings: &[Recording],
    names: &[String],
) -> Result<Vec<hygiene::Fault>> {
    let rest = study.rest(model, runs)?;
    let (mut measured, mut simulated) = (Vec::new(), Vec::new());
    let Some(first) = runs.first() else { return Ok(Vec::new()) };
    let name = |v: usize| subject.interface.variables[v].name.clone();
    let unit = |v: usize| subject.interface.variables[v].unit.clone().unwrap_or_else(|| "1".into());
    for (run, traces) in runs.iter().zip(&rest.simulated) {
        let Some(original) = names.iter().position(|n| *n == run.name).and_then(|i| recordings.get(i)) else {
            continue;
        };
        let channel = |(c, values): (&crate::fit::Channel, &Vec<f64>)| crate::recording::Channel {
            name: name(c.variable),
            unit: unit(c.variable),
            values: values.clone(),
        };
        let mut own = original.clone();
        for c in &run.channels {
            if let Some(channel) = own.channels.iter_mut().find(|o| o.name == name(c.variable)) {
                channel.values.clone_from(&c.values);
                channel.unit = unit(c.variable);
            }
        }
        measured.push(own);
        simulated.push(Recording {
            time: run.time.clone(),
            channels: run.channels.iter().zip(traces).map(channel).collect(),
            source: original.source.clone(),
        });
    }
    let channels: Vec<String> = first.channels.iter().map(|c| name(c.variable)).collect();
    Ok(hygiene::faults_against(&measured, &simulated, &channels))
}

pub(super) fn fault(fault: &hygiene::Fault) -> super::result::Fault {
    super::result::Fault {
        kind: serde_json::to_value(fault.kind)
            .ok()
            .and_then(|v| v.as_str().map(str::to_owned))
            .unwrap_or_default(),
        runs: fault.runs.clone(),
        channel: fault.channel.clone(),
        text: format!("{} {}", fault.evidence, fault.advice),
    }
}
