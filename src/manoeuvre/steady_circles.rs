//! Circles of 100 m at constant speed: what the tire has across, stationary. Steering wheel, drive torque and speed at the start are held over a run and found by
//! runs that are repeated, so that no driver model is part of what is read.

use super::Done;
use super::car::{Car, GRAVITY, WHEELS};
use super::reading::{Reading, View};
use crate::cosimulate::Plan;
use crate::model::Value;
use crate::recording::Recording;
use crate::stats::mean;
use crate::{Error, Result};
use std::path::Path;

/// Radius of the way \[m\]: the one that ISO 4138 prefers.
const RADIUS: f64 = 100.0;
/// Lateral accelerations: Mack 2009, section 7.2 \[m/s²\].
const ACCELERATIONS: [f64; 2] = [4.0, 8.0];
/// The greatest one is looked for in such steps \[m/s²\].
const STEP: f64 = 0.5;
/// More than any tire has without wings \[m/s²\].
const MOST: f64 = 2.0 * GRAVITY;
/// Steering and drive are built up, and what is read begins and ends \[s\]: roll and yaw have settled after some seconds.
const BUILT: [f64; 2] = [0.5, 2.5];
const READ: [f64; 2] = [9.0, 10.0];
/// A circle is driven when radius and speed are off by no more than this share, and the speed changes over the reading by no more.
const CLOSE: f64 = 0.002;
/// So many runs are tried for a circle; beyond the limit of the tires no number would do.
const RUNS: usize = 8;

/// What is held over a run.
#[derive(Debug, Clone, Copy)]
struct Held {
    /// Steering wheel \[rad\].
    steering: f64,
    /// Torque of the drive on both rear wheels \[N.m\].
    drive: f64,
    /// Speed at the start \[m/s\].
    speed: f64,
}

/// A circle that was driven.
struct Circle {
    /// The lateral acceleration that was wanted \[m/s²\].
    wanted: f64,
    plan: Plan,
    run: Recording,
    held: Held,
    /// Means over the reading: lateral acceleration \[m/s²\] and speed \[m/s\].
    aside: f64,
    speed: f64,
}

pub(super) fn run(car: &Car, _: &Path) -> Result<Done> {
    let standing = car.standing((ACCELERATIONS[0] * RADIUS).sqrt())?;
    let inertia = standing.mass * mean(&standing.radii[2..]);
    let mut held = Held { steering: 0.5, drive: 0.0, speed: (ACCELERATIONS[0] * RADIUS).sqrt() };
    let mut circles: Vec<Circle> = Vec::new();
    for wanted in ACCELERATIONS {
        match circle(car, wanted, held, inertia)? {
            Some(found) => {
                held = found.held;
                circles.push(found);
            }
            None if circles.is_empty() => {
                return Err(Error::numeric(format!(
                    "no circle of {RADIUS} m with {wanted} m/s2 was found in {RUNS} runs; is the sign of the steering wheel or of the lateral acceleration another one?"
                )));
            }
            None => break,
        }
    }
    let mut notes = Vec::new();
    let mut wanted = circles.len() as f64 * ACCELERATIONS[0] + STEP;
    let mut last = None;
    while wanted < MOST {
        let Some(found) = circle(car, wanted, held, inertia)? else { break };
        held = found.held;
        last = Some(found);
        wanted += STEP;
    }
    circles.extend(last);
    notes.push(format!("no circle of {RADIUS} m was found with {wanted} m/s2: what is read as greatest is the last one that was, in steps of {STEP} m/s2"));
    let mut readings = Vec::new();
    for circle in &circles {
        readings.extend(read(car, circle)?);
    }
    if let [first, second, ..] = &circles[..]
        && let (Some(little), Some(more)) = (angle(car, first)?, angle(car, second)?)
    {
        let gradient = (more - little) / (second.aside - first.aside);
        let name = "understeer gradient at the wheels between the first two";
        readings.push(Reading::new(name, gradient, "rad.s2/m"));
    }
    let Some(Circle { plan, run, .. }) = circles.pop() else {
        return Err(Error::numeric("no circle was driven"));
    };
    Ok(Done { plan, recording: run, readings, notes })
}

/// Mean angle of the front wheels less that of the way \[rad\].
fn angle(car: &Car, circle: &Circle) -> Result<Option<f64>> {
    let Some(base) = car.parameter(&circle.plan, "wheelbase")? else { return Ok(None) };
    let view = View { run: &circle.run, car };
    let read = view.samples(READ[0], READ[1]);
    let mut sum = 0.0;
    for wheel in &WHEELS[..2] {
        sum += mean(&view.course(&format!("{wheel}.steer_angle"), "rad")?[read.clone()]);
    }
    Ok(Some(0.5 * sum - base * circle.aside / circle.speed.powi(2)))
}

/// Looks for a circle, beginning with what another one was held by.
fn circle(car: &Car, wanted: f64, from: Held, inertia: f64) -> Result<Option<Circle>> {
    let target = (wanted * RADIUS).sqrt();
    let mut held = Held { steering: from.steering * 1.02, speed: target, ..from };
    for _ in 0..RUNS {
        let mut plan = car.plan(READ[1], &[("initial_speed", Value::Real(held.speed))]);
        let built = |most: f64| vec![0.0, 0.0, most, most];
        car.follow(
            &mut plan,
            "circle.csv",
            &[0.0, BUILT[0], BUILT[1], READ[1]],
            &[
                ("steering_wheel_angle", "rad", built(held.steering)),
                ("rear_drive_torque", "N.m", built(held.drive)),
            ],
        )?;
        let run = car.run(&plan, Some(0.5 * target))?;
        let view = View { run: &run, car };
        let read = view.samples(READ[0], READ[1]);
        if read.len() < 2 || run.time[run.time.len() - 1] < READ[1] - 1e-6 {
            return Ok(None);
        }
        let speeds = &view.course("vehicle_speed", "m/s")?[read.clone()];
        let (speed, yaw) = (mean(speeds), mean(&view.course("yaw_rate", "rad/s")?[read.clone()]));
        let slows = (speeds[0] - speeds[speeds.len() - 1]) / (READ[1] - READ[0]);
        let radius = speed / yaw;
        let close = [radius / RADIUS - 1.0, speed / target - 1.0, slows / speed];
        if close.iter().all(|off| off.abs() < CLOSE) {
            let aside = mean(&view.course("lateral_acceleration", "m/s2")?[read]);
            return Ok(Some(Circle { wanted, plan, run, held, aside, speed }));
        }
        if !(radius > 0.0 && radius.is_finite()) {
            return Ok(None);
        }
        // too wide a circle: more angle, in proportion; no more at once than what a tire near its limit takes kindly
        held.steering *= (radius / RADIUS).clamp(0.8, 1.25);
        held.drive += inertia * slows;
        held.speed += target - speed;
    }
    Ok(None)
}

/// What is read of a circle.
fn read(car: &Car, circle: &Circle) -> Result<Vec<Reading>> {
    let view = View { run: &circle.run, car };
    let read = view.samples(READ[0], READ[1]);
    let course = |name: &str, unit: &str| Ok::<_, Error>(mean(&view.course(name, unit)?[read.clone()]));
    let yaw = course("yaw_rate", "rad/s")?;
    let at = format!("at {} m/s2", circle.wanted);
    let name = |what: &str| format!("{what} {at}");
    let mut readings = vec![
        Reading::new(name("lateral acceleration"), circle.aside, "m/s2").beside(Some(circle.speed * yaw)),
        Reading::new(name("steering wheel"), circle.held.steering, "rad"),
        Reading::new(name("drive torque"), circle.held.drive, "N.m"),
        Reading::new(name("roll"), course("roll", "rad")?, "rad"),
        Reading::new(
            name("slip angle of the body"),
            -course("vehicle_speed_left", "m/s")? / circle.speed,
            "rad",
        ),
    ];
    let load = |wheel: &str| course(&format!("{wheel}.force_z"), "N");
    let known = |name| car.parameter(&circle.plan, name);
    if let (Some(mass), Some(height), Some(front), Some(rear)) =
        (known("vehicle_mass")?, known("centre_of_mass_z")?, known("front_track")?, known("rear_track")?)
    {
        // to the left: the right wheels bear more, and the body leans out, about the ground in the main
        let lean = GRAVITY * course("roll", "rad")?;
        let moment = 0.5 * front * (load(WHEELS[1])? - load(WHEELS[0])?)
            + 0.5 * rear * (load(WHEELS[3])? - load(WHEELS[2])?);
        readings.push(
            Reading::new(name("moment of the wheel loads about the way"), moment, "N.m")
                .beside(Some(mass * height * (circle.aside + lean))),
        );
    }
    Ok(readings)
}
