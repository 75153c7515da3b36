//! Check runs with measurement and simulation at the same times.

use crate::diagnose::{CellKind, Diagnosis};
use crate::recording::{Channel, Recording, interpolate};
use crate::stats::root_mean_square;
use crate::{Error, Result};
use std::f64::consts::PI;

/// A rotation covers at least so many revolutions.
const REVOLUTIONS: f64 = 4.0;

/// A run that nothing was fitted to: as it was measured, and as it was simulated.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CheckRun {
    /// Its name.
    pub name: String,
    /// What was measured: commands and measured channels.
    pub recording: Recording,
    /// The outputs of the given model with its own parameters refitted.
    pub before: Recording,
    /// The outputs of the corrected model; without channels if nothing was corrected.
    pub after: Recording,
}

/// A channel at the times of the measurement; NaN where there is no simulation.
pub(super) struct Trace<'a> {
    pub name: &'a str,
    pub unit: &'a str,
    pub measured: Vec<f64>,
    pub before: Vec<f64>,
    pub after: Option<Vec<f64>>,
}

/// A check run and its channels that are both measured and simulated.
pub(super) struct Compared<'a> {
    pub run: &'a CheckRun,
    pub traces: Vec<Trace<'a>>,
    /// Name and angle \[rad\] of what turns.
    pub rotation: Option<(String, Vec<f64>)>,
}

impl Trace<'_> {
    pub fn residual_before(&self) -> Vec<f64> {
        difference(&self.measured, &self.before)
    }

    pub fn residual_after(&self) -> Option<Vec<f64>> {
        self.after.as_ref().map(|after| difference(&self.measured, after))
    }

    /// The corrected model's residual, the given model's if nothing was corrected.
    pub fn residual_left(&self) -> Vec<f64> {
        self.residual_after().unwrap_or_else(|| self.residual_before())
    }
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// The root mean square of the finite values; NaN without any.
pub(super) fn rms(values: &[f64]) -> f64 {
    let mut finite = values.iter().copied().filter(|v| v.is_finite()).peekable();
    if finite.peek().is_none() { f64::NAN } else { root_mean_square(finite) }
}

impl<'a> Compared<'a> {
    pub fn new(diagnosis: &'a Diagnosis, run: &'a CheckRun) -> Result<Self> {
        for (kind, recording) in
            [("measured", &run.recording), ("simulated before", &run.before), ("simulated after", &run.after)]
        {
            for Channel { name, values, .. } in &recording.channels {
                if values.len() != recording.time.len() {
                    return Err(Error::file(format!(
                        "{}: {kind} channel {name:?} has {} values at {} times",
                        run.name,
                        values.len(),
                        recording.time.len()
                    )));
                }
            }
        }
        let both = |name: &str| run.recording.has(name) && run.before.has(name);
        let channels: Vec<(&str, &str)> = if diagnosis.check.is_empty() {
            run.before.channels.iter().map(|c| (c.name.as_str(), c.unit.as_str())).collect()
        } else {
            diagnosis.check.iter().map(|c| (c.channel.as_str(), c.unit.as_str())).collect()
        };
        let mut traces = Vec::new();
        for (name, unit) in channels.into_iter().filter(|(name, _)| both(name)) {
            let at_run = |e: Error| e.at(&run.name);
            let simulated = |recording: &Recording| -> Result<Vec<f64>> {
                let values = recording.channel_in(name, unit).map_err(at_run)?;
                Ok(run.recording.time.iter().map(|t| interpolate(&recording.time, &values, *t)).collect())
            };
            traces.push(Trace {
                name,
                unit,
                measured: run.recording.channel_in(name, unit).map_err(at_run)?,
                before: simulated(&run.before)?,
                after: if run.after.has(name) { Some(simulated(&run.after)?) } else { None },
            });
        }
        let named = diagnosis.map.iter().filter(|c| c.kind == CellKind::Order).map(|c| bare(&c.what).0);
        let rotation = rotation(run, named.collect());
        Ok(Self { run, traces, rotation })
    }

    pub fn time(&self) -> &[f64] {
        &self.run.recording.time
    }

    /// A variable at the times of the measurement, and its unit: as measured, or as simulated.
    pub fn variable(&self, name: &str) -> Option<(Vec<f64>, &'a str)> {
        let run = self.run;
        if let Ok(channel) = run.recording.channel(name) {
            return Some((channel.values.clone(), &channel.unit));
        }
        [&run.after, &run.before].into_iter().find_map(|recording| {
            let channel = recording.channel(name).ok()?;
            let at = |t: &f64| interpolate(&recording.time, &channel.values, *t);
            Some((run.recording.time.iter().map(at).collect(), channel.unit.as_str()))
        })
    }
}

/// Name and unit of `speed [m/s]`.
pub(super) fn bare(what: &str) -> (&str, &str) {
    match what.trim_end().strip_suffix(']').and_then(|w| w.rsplit_once('[')) {
        Some((name, unit)) => (name.trim(), unit.trim()),
        None => (what.trim(), ""),
    }
}

/// An angle that grows or falls over several revolutions, or the integral of a rate that does not change
/// its sign; those that the diagnosis names come first.
fn rotation(run: &CheckRun, named: Vec<&str>) -> Option<(String, Vec<f64>)> {
    let recordings = || [&run.recording, &run.after, &run.before];
    let all: Vec<&Channel> = recordings().into_iter().flat_map(|r| &r.channels).collect();
    let mut channels: Vec<&Channel> =
        all.iter().copied().filter(|c| named.contains(&c.name.as_str())).collect();
    channels.extend(all.iter().copied().filter(|c| !named.contains(&c.name.as_str())));
    let time = &run.recording.time;
    let sampled = |channel: &Channel, unit: &str| -> Option<Vec<f64>> {
        let recording = recordings().into_iter().find(|r| r.has(&channel.name))?;
        let values = recording.channel_in(&channel.name, unit).ok()?;
        Some(time.iter().map(|t| interpolate(&recording.time, &values, *t)).collect())
    };
    let angle = |channel: &Channel| {
        let angle = sampled(channel, "rad")?;
        let turns = (angle.last()? - angle.first()?).abs() / (2.0 * PI);
        let steady = angle.windows(2).all(|w| (w[1] - w[0]) * (angle[angle.len() - 1] - angle[0]) >= 0.0);
        (turns >= REVOLUTIONS && steady).then_some(angle)
    };
    let integral = |channel: &Channel| {
        let rate = sampled(channel, "rad/s")?;
        let still = rate.iter().all(|r| *r >= 0.0) || rate.iter().all(|r| *r <= 0.0);
        let mut angle = vec![0.0];
        for (t, r) in time.windows(2).zip(rate.windows(2)) {
            angle.push(angle[angle.len() - 1] + 0.5 * (r[0] + r[1]) * (t[1] - t[0]));
        }
        (still && angle[angle.len() - 1].abs() >= 2.0 * PI * REVOLUTIONS).then_some(angle)
    };
    let find = |f: &dyn Fn(&Channel) -> Option<Vec<f64>>| {
        channels.iter().find_map(|c| f(c).map(|angle| (c.name.clone(), angle)))
    };
    find(&angle).or_else(|| find(&integral))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Name, unit, course.
    type Course<'a> = (&'a str, &'a str, &'a dyn Fn(f64) -> f64);

    fn run(channels: &[Course]) -> CheckRun {
        let time: Vec<f64> = (0..1000).map(|i| f64::from(i) * 0.01).collect();
        let channel = |(name, unit, f): &Course| Channel {
            name: (*name).into(),
            unit: (*unit).into(),
            values: time.iter().map(|t| f(*t)).collect(),
        };
        let recording = Recording {
            channels: channels.iter().map(channel).collect(),
            time: time.clone(),
            source: "r".into(),
        };
        CheckRun { recording, ..CheckRun::default() }
    }

    #[test]
    fn what_turns_is_found() {
        let steer: Course = ("steer", "deg", &|t| 30.0 * t.sin());
        let found =
            |channels: &[_]| rotation(&run(channels), Vec::new()).map(|(name, angle)| (name, angle[999]));
        assert_eq!(found(&[steer]), None);
        let (name, end) = found(&[steer, ("wheel_speed", "rad/s", &|t| -6.0 * t)]).unwrap();
        assert!(name == "wheel_speed" && (end + 3.0 * 9.99 * 9.99).abs() < 1e-6, "{name} {end}");
        // an angle is better than a rate
        let (name, end) =
            found(&[("wheel_speed", "rad/s", &|_| 40.0), ("drum_angle", "deg", &|t| 360.0 * t)]).unwrap();
        assert!(name == "drum_angle" && (end - 2.0 * PI * 9.99).abs() < 1e-9, "{name} {end}");
    }

    #[test]
    fn units_are_taken_off() {
        assert_eq!(bare("speed [m/s]"), ("speed", "m/s"));
        assert_eq!(bare(" speed "), ("speed", ""));
        assert_eq!(bare("a[0] [m]"), ("a[0]", "m"));
    }

    #[test]
    fn the_root_mean_square_leaves_holes_out() {
        assert_eq!(rms(&[3.0, f64::NAN, -3.0]), 3.0);
        assert!(rms(&[]).is_nan());
    }
}
