//! Half of the greatest deceleration, from 80 km/h: how the load moves forward.

use super::Done;
use super::car::{Car, GRAVITY, WHEELS};
use super::reading::{Reading, View};
use crate::cosimulate::Plan;
use crate::model::Value;
use crate::stats::mean;
use crate::{Error, Result};
use std::path::Path;

const SPEED: f64 = 80.0 / 3.6;
/// Torque of a rear brake over that of a front one: pistons of 30 and 43 cm2, as in the example of the stop.
const REAR: f64 = 30.0 / 43.0;
/// How fast the brakes of the search ask for more deceleration \[m/s3\]: slow beside pitch and suspension, and at the limit while half of the speed is left.
const RAMP: f64 = 3.5;
/// A deceleration is a mean over this time \[s\]: a period of the body's pitch would be longer, one of the suspension is not.
const SMOOTH: f64 = 0.1;
/// The share of the greatest deceleration: Mack 2009, L2616.
const SHARE: f64 = 0.5;
/// Brakes begin, and are built up \[s\].
const BEGIN: f64 = 0.5;
const BUILT: f64 = 0.7;
/// From then on pitch has settled \[s\].
const SETTLED: f64 = 1.7;
/// Readings end, and the run, above these speeds \[m/s\]: below, brakes that hold wheels jerk.
const SLOW: f64 = 3.0;
const END: f64 = 1.0;

pub(super) fn run(car: &Car, _: &Path) -> Result<Done> {
    let standing = car.standing(SPEED)?;
    let radius = mean(&standing.radii);
    // of one front brake, for a deceleration of all of it
    let torque = |deceleration: f64| standing.mass * deceleration * radius / (2.0 * (1.0 + REAR));
    let (most, front) = greatest(car, &torque)?;
    let plan = braking(car, "brakes.csv", &[0.0, BEGIN, BUILT, 60.0], &[0.0, 0.0, front, front], 60.0)?;
    let run = car.run(&plan, Some(END))?;
    let view = View { run: &run, car };
    let speed = view.course("vehicle_speed", "m/s")?;
    let slow = run.time.iter().zip(&speed).find(|(_, v)| **v < SLOW).map_or(0.0, |(t, _)| *t);
    let window = view.samples(SETTLED, slow);
    if window.len() < 2 {
        return Err(Error::numeric(format!(
            "it was slower than {SLOW} m/s at {slow} s already, before its pitch settled"
        )));
    }
    let (first, last) = (window.start, window.end - 1);
    let deceleration = (speed[first] - speed[last]) / (run.time[last] - run.time[first]);
    let way = view.course("vehicle_distance", "m")?;
    let squares = (speed[first].powi(2) - speed[last].powi(2)) / (2.0 * deceleration);
    let mut readings = vec![
        Reading::new("greatest deceleration of the search", most, "m/s2"),
        Reading::new("torque of a front brake", front, "N.m"),
        Reading::new("mean deceleration", deceleration, "m/s2").beside(Some(SHARE * most)),
        Reading::new("way from settled to slow", way[last] - way[first], "m").beside(Some(squares)),
    ];
    let known = |name| car.parameter(&plan, name);
    let transfer = match (known("vehicle_mass")?, known("centre_of_mass_z")?, known("wheelbase")?) {
        (Some(mass), Some(height), Some(base)) => Some(0.5 * mass * deceleration * height / base),
        _ => None,
    };
    for wheel in &WHEELS[..2] {
        let load = view.course(&format!("{wheel}.force_z"), "N")?;
        let before = mean(&load[view.samples(0.0, BEGIN)]);
        let more = mean(&load[window.clone()]) - before;
        readings.push(Reading::new(format!("load transfer {wheel}"), more, "N").beside(transfer));
    }
    let pitch = view.course("pitch", "rad")?;
    let dive = mean(&pitch[window]) - mean(&pitch[view.samples(0.0, BEGIN)]);
    readings.push(Reading::new("settled pitch", dive, "rad"));
    let notes = vec![format!(
        "the greatest deceleration, {:.2} g, is of brakes that are slowly applied, without a controller, split {:.0} to {:.0} %",
        most / GRAVITY,
        100.0 / (1.0 + REAR),
        100.0 * REAR / (1.0 + REAR)
    )];
    Ok(Done { plan, recording: run, readings, notes })
}

/// The greatest deceleration \[m/s2\] of brakes that are slowly applied, and the torque of a front brake \[N.m\] at the share of it.
fn greatest(car: &Car, torque: &dyn Fn(f64) -> f64) -> Result<(f64, f64)> {
    // more than tires have by far, in a time in which the vehicle still moves
    let seconds = 2.0 * (SPEED / RAMP).sqrt();
    let rate = torque(RAMP);
    let plan = braking(car, "search.csv", &[0.0, seconds], &[0.0, rate * seconds], seconds)?;
    let run = car.run(&plan, Some(END))?;
    let view = View { run: &run, car };
    let speed = view.course("vehicle_speed", "m/s")?;
    let half = 0.5 * SMOOTH;
    let means =
        run.time.iter().filter(|t| **t > half && **t + half < run.time[run.time.len() - 1]).map(|t| {
            let [before, after] = [t - half, t + half].map(|t| view.at(t, &speed));
            (*t, (before - after) / SMOOTH)
        });
    let means: Vec<(f64, f64)> = means.collect();
    let most = means.iter().map(|(_, a)| *a).fold(0.0, f64::max);
    let reached = means.iter().find(|(_, a)| *a >= SHARE * most).filter(|_| most > 0.0);
    let Some((time, _)) = reached else {
        return Err(Error::numeric(format!(
            "the vehicle does not slow down with a front brake torque of {:.0} N.m; is the sign of a variable another one?",
            rate * seconds
        )));
    };
    Ok((most, rate * time))
}

/// The vehicle with brake torques from a file: time \[s\] and torque of a front brake \[N.m\].
fn braking(car: &Car, file: &str, time: &[f64], front: &[f64], stop: f64) -> Result<Plan> {
    let mut plan = car.plan(stop, &[("initial_speed", Value::Real(SPEED))]);
    let names: Vec<String> = WHEELS.iter().map(|wheel| format!("{wheel}.brake_torque")).collect();
    let courses = names.iter().enumerate().map(|(i, name)| {
        let share = if i < 2 { 1.0 } else { REAR };
        (name.as_str(), "N.m", front.iter().map(|torque| share * torque).collect())
    });
    car.follow(&mut plan, file, time, &courses.collect::<Vec<_>>())?;
    Ok(plan)
}
