//! How slippery the road was: the factor on the friction with which the wheels of an opened vehicle, braked with the
//! torques of a recording, turn as the recorded ones did.
//!
//! After G. Mack (2009), section 6.3: a level that is too high hides the dips of the wheels' speeds, one that is too low
//! locks a wheel for good, so the level is raised and lowered until the speeds match. Here all levels between half and
//! twice the road's own are looked at before the best is refined, because the error jumps where a wheel locks and a
//! search that only goes downhill would stay on the wrong side.

use super::run::{Experiment, cosimulate};
use super::system::{Port, System};
use crate::model::{Causality, Role, Value};
use crate::recording::{Recording, interpolate};
use crate::{Error, Result};

/// The least and the greatest level that is looked at.
const LEVELS: [f64; 2] = [0.5, 2.0];
/// Levels between them, in equal ratios of 5 %: dips of a wheel's speed change with the level over some percent.
const LOOKED_AT: usize = 28;
/// The best level is known to this ratio when the search ends: recordings of repeated stops differ by more.
const REFINED: f64 = 1e-3;
/// A wheel that turns slower than this share of the fastest wheel is locked.
const LOCKED: f64 = 0.05;
/// Locking is not counted where the fastest wheel is slower than this share of its speed at the start: there every
/// wheel is about to stand.
const SLOW: f64 = 0.2;

/// What was found.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionLevel {
    /// Factor on the friction.
    pub level: f64,
    /// What the wheels do with it.
    pub wheels: Vec<WheelMatch>,
    /// All levels that were tried, from low to high.
    pub tried: Vec<Tried>,
}

/// A wheel with the level that was found.
#[derive(Debug, Clone, PartialEq)]
pub struct WheelMatch {
    /// Its speed's name, `component.variable`.
    pub name: String,
    /// Root mean square of simulated less recorded speed \[rad/s\].
    pub error: f64,
    /// How long it is locked in the simulation and in the recording \[s\].
    pub locked: [f64; 2],
}

/// A level that was tried.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tried {
    /// Factor on the friction.
    pub level: f64,
    /// Root mean square over all wheels \[rad/s\]; infinite where the simulation ended before the recording.
    pub error: f64,
    /// How long wheels are locked, added up \[s\].
    pub locked: f64,
}

/// Inputs called `friction_factor` of these components that have no source and no value.
pub fn friction_inputs(system: &System, components: &[usize]) -> Vec<Port> {
    ports(system, components, Causality::Input, |port| {
        let name = &system.info(port).name;
        name.rsplit('.').next() == Some("friction_factor") && system.is_free(port)
    })
}

/// Finds the level. `fresh` makes the system, with its loop opened and all values but `inputs` set; `inputs` are given the level.
///
/// # Errors
/// No inputs, no speed of a wheel that the recording has, an experiment that does not fit, or no best level between half
/// and twice the road's own.
pub fn friction_level(
    fresh: impl Fn() -> Result<System>,
    experiment: &Experiment,
    recording: &Recording,
    components: &[usize],
    inputs: &[Port],
) -> Result<FrictionLevel> {
    let system = fresh()?;
    if inputs.is_empty() {
        return Err(Error::call(
            "no input called friction_factor is free in the opened components; name those that set the friction",
        ));
    }
    let wheels = ports(&system, components, Causality::Output, |port| {
        let role = system.info(port).meaning.and_then(|meaning| meaning.role);
        let turns = match role {
            Some(role) => role == Role::WheelSpeed,
            None => system.info(port).unit.as_deref() == Some("rad/s"),
        };
        turns && recording.has(&system.name(port))
    });
    if wheels.is_empty() {
        return Err(Error::call(format!(
            "{}: there is no speed of a wheel to match: a column component.variable in rad/s, such as an opened component's wheel_speed",
            recording.source
        )));
    }
    let search = Search { fresh, experiment, recording, inputs, wheels };
    let ratio = (LEVELS[1] / LEVELS[0]).powf(1.0 / LOOKED_AT as f64);
    let mut tried = (0..=LOOKED_AT)
        .map(|k| search.at(LEVELS[0] * ratio.powi(k as i32)).map(|(tried, _)| tried))
        .collect::<Result<Vec<_>>>()?;
    let best = lowest(&tried);
    if best == 0 || best == LOOKED_AT {
        return Err(Error::numeric(format!(
            "the wheels turn more and more like the recorded ones {} a level of {:.2} on the friction: other things differ than the road, or the recorded torques are not those of these brakes",
            if best == 0 { "below" } else { "above" },
            tried[best].level
        )));
    }
    let ends = [tried[best - 1].level, tried[best + 1].level];
    search.refine(ends, &mut tried)?;
    tried.sort_by(|a, b| a.level.total_cmp(&b.level));
    let level = tried[lowest(&tried)].level;
    Ok(FrictionLevel { level, wheels: search.at(level)?.1, tried })
}

fn lowest(tried: &[Tried]) -> usize {
    (0..tried.len()).min_by(|a, b| tried[*a].error.total_cmp(&tried[*b].error)).unwrap_or(0)
}

fn ports(
    system: &System,
    components: &[usize],
    causality: Causality,
    wanted: impl Fn(Port) -> bool,
) -> Vec<Port> {
    let of = |component: &usize| {
        let interface = system.components()[*component].interface();
        interface.with(causality).map(|variable| Port { component: *component, variable }).collect::<Vec<_>>()
    };
    components.iter().flat_map(of).filter(|port| wanted(*port)).collect()
}

struct Search<'a, F> {
    fresh: F,
    experiment: &'a Experiment,
    recording: &'a Recording,
    inputs: &'a [Port],
    wheels: Vec<Port>,
}

impl<F: Fn() -> Result<System>> Search<'_, F> {
    fn at(&self, level: f64) -> Result<(Tried, Vec<WheelMatch>)> {
        let mut system = (self.fresh)()?;
        for input in self.inputs {
            system.set(*input, &Value::Real(level))?;
        }
        let names: Vec<String> = self.wheels.iter().map(|port| system.name(*port)).collect();
        let outcome = cosimulate(&mut system, self.experiment, |_| {})?;
        let run = outcome.recording;
        let end = self.recording.time.last().copied().unwrap_or_default();
        let samples: Vec<usize> = (0..run.time.len()).filter(|k| run.time[*k] <= end).collect();
        let mut speeds = Vec::new();
        for name in &names {
            let recorded = self.recording.channel_in(name, "rad/s")?;
            let simulated = run.channel_in(name, "rad/s")?;
            let at = |k: &usize| [simulated[*k], interpolate(&self.recording.time, &recorded, run.time[*k])];
            speeds.push(samples.iter().map(at).collect::<Vec<_>>());
        }
        let locked = [0, 1].map(|side| locked(&run.time, &speeds, side));
        let wheels: Vec<WheelMatch> = names
            .into_iter()
            .zip(&speeds)
            .enumerate()
            .map(|(i, (name, speeds))| {
                let squares: f64 = speeds.iter().map(|[a, b]| (a - b) * (a - b)).sum();
                let error = (squares / speeds.len() as f64).sqrt();
                WheelMatch { name, error, locked: [locked[0][i], locked[1][i]] }
            })
            .collect();
        let square: f64 = wheels.iter().map(|wheel| wheel.error * wheel.error).sum();
        let whole = outcome.stopped.is_none() && square.is_finite();
        let error = if whole { (square / wheels.len() as f64).sqrt() } else { f64::INFINITY };
        Ok((Tried { level, error, locked: locked[0].iter().sum() }, wheels))
    }

    /// Golden section between two levels, in their logarithm.
    fn refine(&self, ends: [f64; 2], tried: &mut Vec<Tried>) -> Result<()> {
        let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
        let [mut low, mut high] = ends.map(f64::ln);
        let mut try_at = |level: f64| -> Result<f64> {
            let (one, _) = self.at(level.exp())?;
            tried.push(one);
            Ok(one.error)
        };
        let (mut a, mut b) = (high - golden * (high - low), low + golden * (high - low));
        let (mut at_a, mut at_b) = (try_at(a)?, try_at(b)?);
        while high - low > REFINED {
            if at_a <= at_b {
                (high, b, at_b) = (b, a, at_a);
                a = high - golden * (high - low);
                at_a = try_at(a)?;
            } else {
                (low, a, at_a) = (a, b, at_b);
                b = low + golden * (high - low);
                at_b = try_at(b)?;
            }
        }
        Ok(())
    }
}

/// How long each wheel is locked \[s\], simulated (side 0) or recorded (side 1).
fn locked(time: &[f64], speeds: &[Vec<[f64; 2]>], side: usize) -> Vec<f64> {
    let samples = speeds.first().map_or(0, Vec::len);
    let fastest = |k: usize| speeds.iter().map(|wheel| wheel[k][1].abs()).fold(0.0, f64::max);
    let start = if samples > 0 { fastest(0) } else { 0.0 };
    let of = |wheel: &Vec<[f64; 2]>| {
        (1..samples)
            .filter(|k| fastest(*k) > SLOW * start && wheel[*k][side].abs() < LOCKED * fastest(*k))
            .fold(0.0, |sum, k| sum + time[k] - time[k - 1])
    };
    speeds.iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wheel_is_locked_where_the_others_roll_and_not_where_all_stand() {
        let time = [0.0, 0.1, 0.2, 0.3, 0.4];
        let rolls = [60.0, 50.0, 40.0, 30.0, 5.0].map(|speed| [speed, speed]).to_vec();
        let locks = [60.0, 1.0, 1.0, 30.0, 0.0].map(|speed| [speed, 60.0]).to_vec();
        let found = locked(&time, &[rolls, locks], 0);
        // the recorded 60 rad/s of the second wheel are the vehicle's speed all the time
        assert_eq!(found[0], 0.0);
        assert!((found[1] - 0.3).abs() < 1e-12, "{found:?}");
    }
}
