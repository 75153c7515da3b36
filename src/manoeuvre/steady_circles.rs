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
use nalgebra::{Matrix3, Vector3};
use std::path::Path;

/// Radius of the way \[m\]: the one that ISO 4138 prefers.
const RADIUS: f64 = 100.0;
/// Lateral accelerations: Mack 2009, section 7.2 \[m/s²\].
const ACCELERATIONS: [f64; 2] = [4.0, 8.0];
/// From circle to circle, so that each shows how the next one is held; and how exactly the greatest is found \[m/s²\].
const STEP: f64 = 0.5;
/// More than any tire has without wings \[m/s²\].
const MOST: f64 = 2.0 * GRAVITY;
/// Steering and drive are built up, and what is read begins and ends \[s\]: roll and yaw have settled after some seconds.
const BUILT: [f64; 2] = [0.5, 2.5];
const READ: [f64; 2] = [9.0, 10.0];
/// A circle is driven when radius and speed are off by no more than this share, the speed changes over the reading by no more, and the lateral acceleration is that of the
/// way: at the limit of the tires the body's slip angle creeps on.
const CLOSE: f64 = 0.002;
/// So many runs are tried for a circle; beyond the limit of the tires no number would do.
const RUNS: usize = 8;

/// What is held over a run, steering wheel \[rad\], torque of the drive on both rear wheels over mass and radius
/// \[m/s²\], and speed at the start over the one that is wanted.
type Held = Vector3<f64>;

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
    let mut search = Search::from(Held::new(0.5, 0.2, 1.0));
    let mut circles: Vec<Circle> = Vec::new();
    let mut wanted = ACCELERATIONS[0];
    while wanted < MOST {
        let Some(found) = circle(car, wanted, &mut search, inertia)? else { break };
        search.goes_on(found.held);
        if circles.last().is_some_and(|last| !ACCELERATIONS.contains(&last.wanted)) {
            circles.pop();
        }
        circles.push(found);
        wanted += STEP;
    }
    if circles.is_empty() {
        return Err(Error::numeric(format!(
            "no circle of {RADIUS} m with {wanted} m/s2 was found in {RUNS} runs; is the sign of the steering wheel or of the lateral acceleration another one?"
        )));
    }
    let notes = vec![format!(
        "no circle of {RADIUS} m was found with {wanted} m/s2: the last one that was is the greatest"
    )];
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

/// Where the search for a circle begins, and what changes of what is held do.
struct Search {
    from: Held,
    /// What the circle before was held with.
    last: Option<Held>,
    /// Changes of what is held over those of radius, what the speed gains, and speed.
    inverse: Matrix3<f64>,
}

impl Search {
    /// With what each does by itself: twice the angle is half of the radius, a drive takes away what is lost, and a higher speed stays one.
    fn from(held: Held) -> Self {
        Self { from: held, last: None, inverse: Matrix3::from_diagonal(&Vector3::new(-held[0], -1.0, 1.0)) }
    }

    /// The next circle is as far from this one as this one from the one before.
    fn goes_on(&mut self, held: Held) {
        self.from = self.last.map_or(held, |last| 2.0 * held - last);
        self.last = Some(held);
    }
}

/// Looks for a circle: what is held is changed by Broyden's method (1965) until radius, speed and what the speed loses are as they should be.
fn circle(car: &Car, wanted: f64, search: &mut Search, inertia: f64) -> Result<Option<Circle>> {
    let target = (wanted * RADIUS).sqrt();
    let mut held = search.from;
    let inverse = &mut search.inverse;
    let mut before: Option<(Held, Vector3<f64>)> = None;
    for _ in 0..RUNS {
        let (steering, drive) = (held[0], held[1] * inertia);
        let mut plan = car.plan(READ[1], &[("initial_speed", Value::Real(held[2] * target))]);
        let built = |most: f64| vec![0.0, 0.0, most, most];
        car.follow(
            &mut plan,
            "circle.csv",
            &[0.0, BUILT[0], BUILT[1], READ[1]],
            &[("steering_wheel_angle", "rad", built(steering)), ("rear_drive_torque", "N.m", built(drive))],
        )?;
        let run = car.run(&plan, Some(0.5 * target))?;
        let view = View { run: &run, car };
        let read = view.samples(READ[0], READ[1]);
        if read.len() < 2 || run.time[run.time.len() - 1] < READ[1] - 1e-6 {
            return Ok(None);
        }
        let speeds = &view.course("vehicle_speed", "m/s")?[read.clone()];
        let (speed, yaw) = (mean(speeds), mean(&view.course("yaw_rate", "rad/s")?[read.clone()]));
        let gains = (speeds[speeds.len() - 1] - speeds[0]) / (READ[1] - READ[0]);
        let off = Vector3::new(speed / yaw / RADIUS - 1.0, gains, speed / target - 1.0);
        let aside = mean(&view.course("lateral_acceleration", "m/s2")?[read]);
        let creeps = (aside / (speed * yaw) - 1.0).abs();
        if off[0].abs().max(off[2].abs()).max(off[1].abs() / speed).max(creeps) < CLOSE {
            return Ok(Some(Circle { wanted, plan, run, held, aside, speed }));
        }
        if !off.iter().all(|v| v.is_finite()) || yaw <= 0.0 {
            return Ok(None);
        }
        if let Some((last, was)) = before {
            let (moved, changed) = (held - last, off - was);
            let told = *inverse * changed;
            *inverse += (moved - told) * (moved.transpose() * *inverse) / moved.dot(&told);
        }
        before = Some((held, off));
        held -= *inverse * off;
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
        Reading::new(name("steering wheel"), circle.held[0], "rad"),
        Reading::new(name("drive"), circle.held[1], "m/s2"),
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
