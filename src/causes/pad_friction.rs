//! Friction of brake pads over time since they were pressed on, from recorded torque and pressure (6.34).

use super::pads::{torque_channel, turning};
use super::part::{has_all, slave, value_of};
use super::vehicle::onset;
use crate::cosimulate::Plan;
use crate::model::Value;
use crate::recording::Recording;
use crate::stats::{mean_or_zero, median, median_interval, spread};
use crate::{Error, Result};
use std::fmt::Write as _;

/// A pressure of less than so many times its noise would tell the friction to less than a tenth.
const OVER_NOISE: f64 = 10.0;
/// Nor does one of less than so many times that which brings the pads to the disc: how exactly that is known would decide.
const OVER_CONTACT: f64 = 4.0;
/// What is called the first friction is a mean over so long \[s\].
const FIRST: f64 = 0.02;

/// Friction of one brake's pads in several runs.
#[derive(Debug, Clone, PartialEq)]
pub struct PadFriction {
    /// The brake.
    pub brake: String,
    /// Pressures below this tell nothing \[Pa\].
    pub least: f64,
    /// Since the pressure first exceeded that \[s\].
    pub time: Vec<f64>,
    /// Of each run, at these times; none where torque and pressure do not tell it.
    pub runs: Vec<Vec<Option<f64>>>,
    /// Mean over the runs that tell it.
    pub mean: Vec<Option<f64>>,
    /// Mean over the first 20 ms.
    pub first: f64,
    /// Median of the second half.
    pub level: f64,
}

/// Friction coefficient by (6.34): torque \[N.m\] over what presses the pads on, area \[m²\] and radius \[m\]; none where the pressure \[Pa\] is below `least`, or
/// no more than the one that brings the pads to the disc.
pub fn pad_friction(
    torque: f64,
    pressure: f64,
    (area, radius, contact): (f64, f64, f64),
    least: f64,
) -> Option<f64> {
    let friction = torque / ((pressure - contact) * area * radius);
    (pressure >= least && pressure > contact && friction.is_finite()).then_some(friction)
}

/// Friction of all brakes of a system (as `brake-hydraulics`) whose pressure and torque were recorded. `least` is the pressure below which it is unknown \[Pa\]; without
/// it the recordings' noise decides. A locked wheel's torque says nothing of its pads.
///
/// # Errors
/// No such brake, a run in which a brake is never pressed, or channels in other units.
pub fn pad_frictions(plan: &Plan, runs: &[&Recording], least: Option<f64>) -> Result<Vec<PadFriction>> {
    let mut all = Vec::new();
    for component in &plan.components {
        let one = slave(component)?;
        let sizes = ["piston_area", "friction_radius", "contact_pressure"];
        if !has_all(&*one, &["caliper_pressure", "brake_torque"]) || !has_all(&*one, &sizes) {
            continue;
        }
        let pressure = format!("{}.caliper_pressure", component.name);
        let Some(torque) = torque_channel(plan, &component.name, runs) else { continue };
        if !runs.iter().all(|run| run.has(&pressure)) {
            continue;
        }
        let size = |name: &str| match value_of(component, &*one, name) {
            Some(Value::Real(value)) => Ok(value),
            _ => Err(Error::variable(format!("{}.{name} is no number", component.name))),
        };
        let sizes = (size(sizes[0])?, size(sizes[1])?, size(sizes[2])?);
        let channels = (pressure.as_str(), torque.as_str());
        all.push(of_brake(&component.name, channels, sizes, runs, least)?);
    }
    if all.is_empty() {
        return Err(Error::file(format!(
            "{}: there is no brake with piston_area, friction_radius and contact_pressure whose caliper_pressure and torque every recording has",
            plan.source
        )));
    }
    Ok(all)
}

fn of_brake(
    brake: &str,
    (pressure, torque): (&str, &str),
    sizes: (f64, f64, f64),
    recordings: &[&Recording],
    least: Option<f64>,
) -> Result<PadFriction> {
    let mut pressed = Vec::new();
    let mut noise = 0.0_f64;
    for run in recordings {
        let torque_of = run.channel_in(torque, "N.m")?;
        let rests = onset(std::slice::from_ref(&torque_of)).max(1);
        let above = |values: Vec<f64>| -> Vec<f64> {
            // not the mean: the last samples may have a little of the begin
            let rest = median(&values[..rests]);
            values.into_iter().map(|v| v - rest).collect()
        };
        let pressure_of = run.channel_in(pressure, "Pa")?;
        noise = noise.max(spread(&pressure_of[..rests]));
        pressed.push((above(pressure_of), above(torque_of)));
    }
    let least = least.unwrap_or((OVER_NOISE * noise).max(OVER_CONTACT * sizes.2));
    let interval = median_interval(&recordings[0].time);
    let mut runs = Vec::new();
    for (run, (pressure, torque_of)) in recordings.iter().zip(&pressed) {
        let Some(first) = pressure.iter().position(|p| *p >= least) else {
            return Err(Error::file(format!(
                "{}: {brake} is never pressed with {:.1} bar, and below that its pads tell nothing",
                run.source,
                1e-5 * least
            )));
        };
        let turns = turning(run, torque);
        let friction =
            |k: usize| turns[k].then(|| pad_friction(torque_of[k], pressure[k], sizes, least)).flatten();
        // the sample that is nearest to each time
        let time = &run.time;
        let count = ((time[time.len() - 1] - time[first]) / interval + 1e-6) as usize + 1;
        let nearest = |n: usize| {
            time.partition_point(|t| *t < time[first] + (n as f64 - 0.5) * interval).min(time.len() - 1)
        };
        runs.push((0..count).map(|n| friction(nearest(n))).collect::<Vec<_>>());
    }
    let longest = runs.iter().map(Vec::len).max().unwrap_or(0);
    runs.iter_mut().for_each(|run| run.resize(longest, None));
    let known = |n: usize| -> Vec<f64> { runs.iter().filter_map(|run| run[n]).collect() };
    let mean_of = |values: &[f64]| (!values.is_empty()).then(|| mean_or_zero(values));
    let mean: Vec<Option<f64>> = (0..longest).map(|n| mean_of(&known(n))).collect();
    let between = |from: usize, to: usize| -> Vec<f64> { mean[from..to].iter().flatten().copied().collect() };
    let first = ((FIRST / interval).round() as usize).clamp(1, longest);
    let (begin, level) = (between(0, first), between(longest / 2, longest));
    let (Some(first), false) = (mean_of(&begin), level.is_empty()) else {
        return Err(Error::file(format!(
            "{brake}: the friction of its pads is not told at the begin and in the second half"
        )));
    };
    Ok(PadFriction {
        brake: brake.to_owned(),
        least,
        time: (0..longest).map(|n| n as f64 * interval).collect(),
        first,
        level: median(&level),
        runs,
        mean,
    })
}

/// Friction over time as CSV: a column for each run and the mean of each brake; what is not told is blank.
pub fn pad_friction_csv(all: &[PadFriction]) -> String {
    let mut text = String::from("time [s]");
    for brake in all {
        for run in 1..=brake.runs.len() {
            let _ = write!(text, ",{}.pad_friction_{run} [1]", brake.brake);
        }
        let _ = write!(text, ",{}.pad_friction [1]", brake.brake);
    }
    text.push('\n');
    let Some(longest) = all.iter().map(|brake| &brake.time).max_by_key(|time| time.len()) else {
        return text;
    };
    for (n, time) in longest.iter().enumerate() {
        let _ = write!(text, "{time:.6}");
        for brake in all {
            for course in brake.runs.iter().chain(std::iter::once(&brake.mean)) {
                text.push(',');
                if let Some(Some(friction)) = course.get(n) {
                    let _ = write!(text, "{friction}");
                }
            }
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cosimulate::parse_toml;
    use crate::recording::Channel;

    const BRAKE: (f64, f64, f64) = (43e-4, 0.14, 5e4);

    #[test]
    fn it_undoes_the_torque_of_pads_and_knows_nothing_without_pressure() {
        for friction in [0.1, 0.37, 0.6] {
            for pressure in [3e5, 5e6, 1.5e7] {
                // (6.33)
                let torque = friction * (pressure - BRAKE.2) * BRAKE.0 * BRAKE.1;
                let found = pad_friction(torque, pressure, BRAKE, 2e5).unwrap();
                assert!((found / friction - 1.0).abs() < 1e-15, "{found} {friction}");
            }
        }
        for pressure in [0.0, -1e5, 1.9e5] {
            assert_eq!(pad_friction(100.0, pressure, BRAKE, 2e5), None);
        }
        // never a division by nothing, whatever the least is
        assert_eq!(pad_friction(100.0, BRAKE.2, BRAKE, 0.0), None);
        assert_eq!(pad_friction(0.0, BRAKE.2, BRAKE, -1e5), None);
    }

    /// Pressure that rises, is held and falls; friction that grows from 0.1 to 0.4 in 0.2 s; the wheel is locked for a while.
    #[test]
    fn the_course_is_found_in_runs_that_begin_at_other_times() {
        let run = |begin: f64| {
            let time: Vec<f64> = (0..1000).map(|k| f64::from(k) * 2e-3).collect();
            let pressure =
                |t: f64| 1e7 * ((t - begin) / 0.05).clamp(0.0, 1.0) * ((1.9 - t) / 0.1).clamp(0.0, 1.0);
            let friction = |t: f64| 0.1 + 0.3 * ((t - begin) / 0.2).clamp(0.0, 1.0);
            let locked = |t: f64| (1.0..1.2).contains(&t);
            let torque = |t: f64| {
                let most = friction(t) * (pressure(t) - BRAKE.2).max(0.0) * BRAKE.0 * BRAKE.1;
                if locked(t) { 0.5 * most } else { most }
            };
            let channel = |name: &str, unit: &str, f: &dyn Fn(f64) -> f64| Channel {
                name: name.into(),
                unit: unit.into(),
                values: time.iter().map(|t| f(*t)).collect(),
            };
            let channels = vec![
                channel("brake.caliper_pressure", "bar", &|t| 1e-5 * pressure(t) + 0.3),
                channel("car.front_left.carrier_moment_y", "N.m", &|t| torque(t) - 7.0),
                channel("car.front_left.wheel_speed", "rad/s", &|t| if locked(t) { 0.0 } else { 50.0 }),
                channel("car.rear_left.wheel_speed", "rad/s", &|_| 60.0),
            ];
            Recording { time, channels, source: "run".into() }
        };
        let system = "step = 1e-3\n[component.car]\nmodel = \"ring-brush-vehicle\"\n[component.brake]\nmodel = \"brake-hydraulics\"\n\
                      [connect]\n\"brake.brake_torque\" = \"car.front_left.brake_torque\"\n";
        let plan = parse_toml(system, "system.toml", std::path::Path::new(".")).unwrap();
        let runs = [run(0.3), run(0.5)];
        let all = pad_frictions(&plan, &runs.iter().collect::<Vec<_>>(), None).unwrap();
        let [brake] = &all[..] else { panic!("{all:?}") };
        // four times the pressure that brings pads to the disc, which the pressure reaches after 1 ms
        assert_eq!(brake.least, 2e5);
        for (n, time) in brake.time.iter().enumerate().filter(|(_, t)| **t < 0.4) {
            let friction = 0.1 + 0.3 * ((time + 2e-3) / 0.2).min(1.0);
            let found = brake.mean[n].unwrap();
            assert!((found - friction).abs() < 3e-3, "{time}: {found} instead of {friction}");
        }
        assert!((brake.level - 0.4).abs() < 1e-6 && (brake.first - 0.118).abs() < 5e-3, "{brake:?}");
        // the locked wheel, and the brake that is let go
        let at = |run: usize, time: f64| brake.runs[run][(time / 2e-3).round() as usize];
        assert!(at(0, 1.1 - 0.302).is_none() && at(1, 1.1 - 0.502).is_none() && at(0, 1.9 - 0.302).is_none());
        assert!(at(0, 1.4 - 0.302).is_some());
        let table = pad_friction_csv(&all);
        assert!(table.starts_with(
            "time [s],brake.pad_friction_1 [1],brake.pad_friction_2 [1],brake.pad_friction [1]\n"
        ));
        assert!(table.lines().any(|line| line.ends_with(",,,")) && !table.contains("NaN"));
        let unpressed = pad_frictions(&plan, &[&runs[0]], Some(2e7)).unwrap_err().to_string();
        assert!(unpressed.contains("200.0 bar"), "{unpressed}");
    }
}
