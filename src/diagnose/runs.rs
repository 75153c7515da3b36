//! The recordings of a diagnosis: which channel is which variable, which run is for what, and each run
//! ready to be simulated.

use super::result::Use;
use crate::bounded::{self, MAX_TEXT};
use crate::effect::Role;
use crate::fit::{Channel, Drive, Run};
use crate::model::{Causality, Interface, Kind};
use crate::recording::{Column, Columns, Recording, Smooth, interpolate, recording_endings};
use crate::stats::{about_mean, deviation, mean, mean_or_zero, median_interval};
use crate::{Error, Result};
use serde::Deserialize;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;
use std::sync::Arc;

/// Names that tell the use of recordings.
const RUNS_FILE: &str = "runs.toml";
/// Communication steps per sample at most, as long as the model does not ask for more: inputs are nearly straight between
/// samples, and the model has a step of its own.
const MAX_PARTS: f64 = 2.0;
/// Communication steps in one run at most.
const MAX_POINTS: usize = 2_000_000;

/// What the channels of the recordings are: the content of a file of `--map`.
#[derive(Debug, Clone, Default)]
pub struct Map {
    columns: Columns,
    /// Roles of variables whose names do not tell.
    roles: BTreeMap<String, Role>,
}

/// A map as it is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MapFile {
    #[serde(default)]
    only_named: bool,
    times_of: Option<String>,
    #[serde(default)]
    channels: BTreeMap<String, Column>,
    #[serde(default)]
    roles: BTreeMap<String, Role>,
}

impl Map {
    /// Reads a map.
    ///
    /// # Errors
    /// A file that cannot be read or is no map.
    pub fn read(path: &Path) -> Result<Self> {
        let place = path.display();
        let text = bounded::read_text(path, MAX_TEXT).map_err(|e| Error::file(format!("{place}: {e}")))?;
        let file: MapFile = toml::from_str(&text).map_err(|e| {
            let line = e.span().map_or(1, |s| crate::model::line_of(&text, s.start));
            Error::file(format!("{place}:{line}: {}", e.message()))
        })?;
        let MapFile { only_named, times_of, channels, roles } = file;
        Ok(Self { columns: Columns { named: channels, only_named, times_of }, roles })
    }

    /// Roles that the user gave.
    pub fn roles(&self) -> Vec<(String, Role)> {
        self.roles.iter().map(|(name, role)| (name.clone(), *role)).collect()
    }

    /// What the columns of recordings are, by their headers.
    pub fn columns(&self) -> &Columns {
        &self.columns
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RunsFile {
    runs: BTreeMap<String, Use>,
}

/// Whether the user said what the recordings in a folder are for.
pub fn are_given(folder: &Path) -> bool {
    folder.join(RUNS_FILE).is_file()
}

/// What the channels do that all recordings have, in the same order for each.
pub fn courses(recordings: &[Recording]) -> Vec<Vec<&[f64]>> {
    let names = recordings.first().map_or(&[][..], |r| &r.channels[..]).iter().map(|c| &c.name);
    let common: Vec<&String> = names.filter(|name| recordings.iter().all(|r| r.has(name))).collect();
    let values = |name: &&String, i: usize| recordings[i].channel(name).ok().map(|c| &c.values[..]);
    (0..recordings.len()).map(|i| common.iter().filter_map(|name| values(name, i)).collect()).collect()
}

/// The uses of the runs with these names: as `runs.toml` in the folder says, else every third run is for
/// checking, chosen so that what `courses` do is alike in both: those of inputs, and of outputs, which may rest while
/// inputs move.
///
/// # Errors
/// A file that is wrong, names no run that is there, or leaves nothing to fit or to check.
pub fn uses(folder: &Path, names: &[String], courses: &[Vec<&[f64]>]) -> Result<Vec<Use>> {
    let path = folder.join(RUNS_FILE);
    let place = path.display();
    let uses: Vec<Use> = if path.is_file() {
        let text =
            bounded::read_own_text(&path, MAX_TEXT).map_err(|e| Error::file(format!("{place}: {e}")))?;
        let file: RunsFile = toml::from_str(&text).map_err(|e| {
            let line = e.span().map_or(1, |s| crate::model::line_of(&text, s.start));
            Error::file(format!("{place}:{line}: {}", e.message()))
        })?;
        let recordings: HashSet<&str> = names.iter().map(|name| without_ending(name)).collect();
        let mut given = HashMap::new();
        for (name, use_) in &file.runs {
            if !recordings.contains(without_ending(name)) {
                return Err(Error::file(format!("{place}: there is no recording {name:?}")));
            }
            given.insert(without_ending(name), *use_);
        }
        names.iter().map(|name| given.get(without_ending(name)).copied().unwrap_or(Use::Fit)).collect()
    } else {
        split(courses)
    };
    for (needed, word) in [(Use::Fit, "to fit"), (Use::Check, "to check")] {
        if !uses.contains(&needed) {
            return Err(Error::file(format!(
                "{}: no run is left {word}; a diagnosis needs runs for both, and never the same samples (`runs.toml` says which)",
                folder.display()
            )));
        }
    }
    Ok(uses)
}

/// A run's name may have the ending of its file or not.
fn without_ending(name: &str) -> &str {
    match name.rsplit_once('.') {
        Some((stem, end)) if recording_endings().iter().any(|known| known.eq_ignore_ascii_case(end)) => stem,
        _ => name,
    }
}

/// A third of the runs for checking, the middle of every three changed for what is like the others: a programme
/// often repeats itself, and a set that lacks one kind of run checks nothing there.
pub fn split(courses: &[Vec<&[f64]>]) -> Vec<Use> {
    let checked = evened(courses, (0..courses.len()).map(|i| i % 3 == 1).collect());
    checked.into_iter().map(|c| if c { Use::Check } else { Use::Fit }).collect()
}

/// Runs are marked or not; marks are exchanged as long as that makes the two sets more alike: in how much and
/// around what each signal moves, and which of them move together. `courses` has those of the same signals for each
/// run.
fn evened(courses: &[Vec<&[f64]>], mut marked: Vec<bool>) -> Vec<bool> {
    let mut traits: Vec<Vec<f64>> = courses.iter().map(|run| traits(run)).collect();
    let n = traits.len();
    let count = traits.iter().map(Vec::len).min().unwrap_or(0);
    for k in 0..count {
        let all: Vec<f64> = traits.iter().map(|t| t[k]).collect();
        let (mean, spread) = (mean(&all), deviation(&all));
        // what differs by rounding only is the same
        let scale = if spread > 1e-6 * mean.abs() { 1.0 / spread } else { 0.0 };
        traits.iter_mut().for_each(|t| t[k] = (t[k] - mean) * scale);
    }
    let unlike = |marked: &[bool]| -> f64 {
        (0..count)
            .map(|k| {
                let mean = |which: bool| {
                    let own = traits.iter().zip(marked).filter(|(_, c)| **c == which).map(|(t, _)| t[k]);
                    let (sum, n) = own.fold((0.0, 0.0), |(sum, n), v| (sum + v, n + 1.0));
                    sum / f64::max(n, 1.0)
                };
                (mean(true) - mean(false)).powi(2)
            })
            .sum()
    };
    let mut least = unlike(&marked);
    loop {
        let mut best = None;
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            if marked[i] && !marked[j] {
                marked.swap(i, j);
                let now = unlike(&marked);
                marked.swap(i, j);
                if now < 0.999 * best.map_or(least, |(_, _, b)| b) {
                    best = Some((i, j, now));
                }
            }
        }
        let Some((i, j, now)) = best else { break };
        marked.swap(i, j);
        least = now;
    }
    marked
}

/// Mean and movement of each signal of a run, and the common movement of each two.
fn traits(run: &[&[f64]]) -> Vec<f64> {
    let mut all = Vec::new();
    let mut moves = Vec::new();
    for values in run {
        all.push(mean_or_zero(values));
        moves.push((about_mean(values) / values.len().max(1) as f64).sqrt());
    }
    for (i, a) in moves.iter().enumerate() {
        all.push(*a);
        all.extend(moves[i + 1..].iter().map(|b| (a * b).sqrt()));
    }
    all
}

/// How inputs run between samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Between {
    /// Smoothly, as [`Smooth`] has them.
    Smoothly,
    /// On straight lines.
    Straight,
}

/// A run of a recording on a model: inputs on an even grid, outputs as measured. Inputs are those of `drive`, in all rows in which
/// they are known, and run `between` these as said. Communication points are `step` apart, if that is given, or else `finer` times as close as usual.
///
/// # Errors
/// Channels that are no variables or cannot be converted, no inputs or outputs, too many steps.
pub fn prepare(
    interface: &Interface,
    (recording, drive, between): (&Recording, &Recording, Between),
    name: &str,
    step: Option<f64>,
    finer: u32,
) -> Result<Run> {
    let at = |e: Error| e.at(name);
    let (Some(first), Some(last)) = (drive.time.first().or(recording.time.first()), recording.time.last())
    else {
        return Err(Error::file(format!("{name}: the recording is empty")));
    };
    let interval = match recording.time.len() {
        1 => interface.communication_step,
        _ => median_interval(&recording.time),
    };
    let step = step.unwrap_or_else(|| {
        let whole = (interval / interface.communication_step - 1e-6).ceil();
        // a whole part of the interval between samples: effects act at communication points, and a unit may not know how fast
        // it is recorded
        interval / whole.clamp(1.0, MAX_PARTS) / f64::from(finer)
    });
    let points = ((last - first) / step - 1e-6).ceil() as usize + 1;
    if points > MAX_POINTS {
        return Err(Error::file(format!("{name}: {points} steps of {step} s are more than can be kept")));
    }
    let mut driven = Drive::new(*first, step, points, Vec::new());
    let grid: Vec<f64> = (0..points).map(|k| driven.time(k).min(*last)).collect();
    let mut channels = Vec::new();
    let measured = |c: &&crate::recording::Channel| !drive.has(&c.name);
    let all = drive.channels.iter().map(|c| (drive, c));
    for (recording, channel) in all.chain(recording.channels.iter().filter(measured).map(|c| (recording, c)))
    {
        let variable = interface.find(&channel.name).map_err(|e| {
            at(Error::file(format!(
                "{e}; `[channels]` in a file of --map says what a channel is, or leaves it out"
            )))
        })?;
        let info = &interface.variables[variable];
        let values = recording.channel_in(&channel.name, info.unit.as_deref().unwrap_or("1"))?;
        match info.causality {
            Causality::Input if info.kind == Kind::Real => {
                let smooth = Smooth::new(&recording.time, &values);
                let at = |t: &f64| match between {
                    Between::Smoothly => smooth.at(*t),
                    Between::Straight => interpolate(&recording.time, &values, *t),
                };
                driven.inputs.push((variable, grid.iter().map(at).collect()));
            }
            Causality::Input => {
                let hold = |t: &f64| {
                    let next = recording.time.partition_point(|s| *s <= t + 1e-6 * step);
                    values[next.saturating_sub(1)]
                };
                driven.inputs.push((variable, grid.iter().map(hold).collect()));
            }
            Causality::Output | Causality::Local if info.kind == Kind::Real => {
                channels.push(Channel { variable, values, counts: false, unresolved: Vec::new() });
            }
            _ => {
                return Err(at(Error::file(format!("{} is neither an input nor an output", channel.name))));
            }
        }
    }
    if channels.is_empty() {
        return Err(at(Error::file("there is no measured output to compare with")));
    }
    channels.sort_by_key(|c| c.variable);
    driven.inputs.sort_by_key(|i| i.0);
    Ok(Run { name: name.into(), drive: Arc::new(driven), time: recording.time.clone(), channels })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_that_rest_are_no_check_of_what_moves() {
        // the angle moves in all runs, the force only in those under load
        let wave: Vec<f64> = (0..200).map(|k| (0.1 * f64::from(k)).sin()).collect();
        let channel = |name: &str, values: &[f64]| crate::recording::Channel {
            name: name.into(),
            unit: "1".into(),
            values: values.to_vec(),
        };
        let recordings: Vec<Recording> = (0..6)
            .map(|i| {
                let force: Vec<f64> = wave.iter().map(|v| if i % 3 == 1 { 0.0 } else { 9.0 * v }).collect();
                let mut channels = vec![channel("angle", &wave), channel("force", &force)];
                if i == 4 {
                    channels.insert(0, channel("only here", &wave));
                    channels.swap(1, 2);
                }
                Recording { source: "a run".into(), time: (0..200).map(f64::from).collect(), channels }
            })
            .collect();
        let courses = courses(&recordings);
        assert!(courses.iter().all(|run| run.len() == 2 && run[0] == wave), "by name, not by column");
        let uses = split(&courses);
        let moves = |i: &usize| i % 3 != 1;
        assert_eq!((0..6).filter(|i| uses[*i] == Use::Check).count(), 2);
        assert!((0..6).any(|i| uses[i] == Use::Check && moves(&i)), "{uses:?}");
        // by the inputs alone all runs are alike
        let angles: Vec<Vec<&[f64]>> = courses.iter().map(|run| run[..1].to_vec()).collect();
        assert!(!(0..6).any(|i| split(&angles)[i] == Use::Check && moves(&i)));
    }

    #[test]
    fn every_kind_of_run_is_fitted_and_checked() {
        // a programme that repeats itself every three runs: slip alone, angle alone, both
        let wave: Vec<f64> = (0..200).map(|k| (0.1 * f64::from(k)).sin()).collect();
        let rest = vec![0.0; 200];
        let kinds: Vec<[&[f64]; 2]> = vec![[&wave, &rest], [&rest, &wave], [&wave, &wave]];
        let runs: Vec<Vec<&[f64]>> = (0..9).map(|i| kinds[i % 3].to_vec()).collect();
        let uses = split(&runs);
        assert_eq!(uses.iter().filter(|u| **u == Use::Check).count(), 3);
        for kind in 0..3 {
            let own: Vec<Use> = (0..9).filter(|i| i % 3 == kind).map(|i| uses[i]).collect();
            assert!(own.contains(&Use::Check) && own.contains(&Use::Fit), "{kind}: {own:?}");
        }
        // nothing to choose by: the middle of every three
        let same: Vec<Vec<&[f64]>> = (0..6).map(|_| vec![&wave[..]]).collect();
        let checked: Vec<usize> = (0..6).filter(|i| split(&same)[*i] == Use::Check).collect();
        assert_eq!(checked, [1, 4]);
    }

    #[test]
    fn runs_are_named_with_and_without_ending() {
        const COUNT: usize = 1000;
        let folder = tempfile::tempdir().unwrap();
        let mut text = String::from("[runs]\n");
        let names: Vec<String> = (0..COUNT).map(|i| format!("run{i}")).collect();
        for (i, name) in names.iter().enumerate() {
            let (ending, use_) = if i % 2 == 0 { ("", "fit") } else { (".csv", "check") };
            text += &format!("\"{name}{ending}\" = \"{use_}\"\n");
        }
        std::fs::write(folder.path().join(RUNS_FILE), &text).unwrap();
        let given = uses(folder.path(), &names, &[]).unwrap();
        assert!((0..COUNT).all(|i| given[i] == if i % 2 == 0 { Use::Fit } else { Use::Check }));
        let files: Vec<String> = names.iter().map(|name| format!("{name}.tdx")).collect();
        assert_eq!(uses(folder.path(), &files, &[]).unwrap(), given);
        let error = uses(folder.path(), &names[1..], &[]).unwrap_err().to_string();
        assert!(error.contains("there is no recording \"run0\""), "{error}");
    }
}
