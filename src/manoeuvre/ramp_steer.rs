//! The steering wheel turned slowly and evenly at 100 km/h: what the tire has across. Nothing drives the vehicle, so it gets slower; what is
//! read of it takes the speed as it is then.

use super::Done;
use super::car::{Car, WHEELS};
use super::reading::{Reading, View};
use crate::Result;
use crate::model::Value;
use crate::stats::{Line, mean};
use std::path::Path;

const SPEED: f64 = 100.0 / 3.6;
/// Turning begins \[s\].
const BEGIN: f64 = 0.5;
/// Rate of the steering wheel \[rad/s\]: 30 deg/s, Mack 2009, L2616.
const RATE: f64 = 30.0 / 180.0 * std::f64::consts::PI;
/// How long it is turned \[s\]: to 240 deg, beyond the greatest lateral acceleration of a passenger car at this speed.
const TURNED: f64 = 8.0;
/// The run ends where less than this share of the speed is left: a vehicle that loses so much in these seconds slides aside.
const LEFT: f64 = 0.8;
/// The linear range, in which gradients are read \[m/s2\].
const LINEAR: [f64; 2] = [1.0, 4.0];

pub(super) fn run(car: &Car, _: &Path) -> Result<Done> {
    let end = BEGIN + TURNED;
    let mut plan = car.plan(end, &[("initial_speed", Value::Real(SPEED))]);
    let turned = (0.0, RATE * TURNED);
    car.follow(
        &mut plan,
        "steering.csv",
        &[0.0, BEGIN, end],
        &[("steering_wheel_angle", "rad", vec![turned.0, turned.0, turned.1])],
    )?;
    let run = car.run(&plan, Some(LEFT * SPEED))?;
    let view = View { run: &run, car };
    let speed = view.course("vehicle_speed", "m/s")?;
    let aside = view.course("lateral_acceleration", "m/s2")?;
    let yaw = view.course("yaw_rate", "rad/s")?;
    let angle = view.course("steering_wheel_angle", "rad")?;
    let steer: Vec<Vec<f64>> = WHEELS[..2]
        .iter()
        .map(|wheel| view.course(&format!("{wheel}.steer_angle"), "rad"))
        .collect::<Result<_>>()?;
    let greatest = (0..aside.len()).max_by(|a, b| aside[*a].total_cmp(&aside[*b])).unwrap_or(0);
    let mut notes = vec!["coasting: nothing drives the vehicle, and it gets slower".to_owned()];
    let mut readings = vec![
        Reading::new("greatest lateral acceleration", aside[greatest], "m/s2"),
        Reading::new("steering wheel at that", angle[greatest], "rad"),
        Reading::new("speed at that", speed[greatest], "m/s"),
    ];
    if greatest + 1 == aside.len() {
        notes.push("the lateral acceleration still grows at the end".to_owned());
    }
    // on the way there only
    let linear: Vec<usize> = (0..greatest).filter(|k| (LINEAR[0]..LINEAR[1]).contains(&aside[*k])).collect();
    if linear.len() < 10 {
        notes.push(format!(
            "it was hardly between {} and {} m/s2: no gradients are read",
            LINEAR[0], LINEAR[1]
        ));
        return Ok(Done { plan, recording: run, readings, notes });
    }
    let of = |value: &dyn Fn(usize) -> f64| -> Vec<f64> { linear.iter().map(|k| value(*k)).collect() };
    let gain = mean(&of(&|k| yaw[k] / angle[k]));
    readings.push(Reading::new("yaw rate over steering wheel", gain, "1/s"));
    // on a circle that gets narrower: speed times yaw rate, and what the speed across changes by
    let aslant = view.course("vehicle_speed_left", "m/s")?;
    let [first, last] = [linear[0], linear[linear.len() - 1]];
    let drift = (aslant[last] - aslant[first]) / (run.time[last] - run.time[first]);
    let circle = mean(&of(&|k| speed[k] * yaw[k])) + drift;
    readings.push(
        Reading::new("mean lateral acceleration of the linear range", mean(&of(&|k| aside[k])), "m/s2")
            .beside(Some(circle)),
    );
    if let Some(base) = car.parameter(&plan, "wheelbase")? {
        let more = of(&|k| 0.5 * (steer[0][k] + steer[1][k]) - base * aside[k] / speed[k].powi(2));
        if let Some(line) = Line::through(&of(&|k| aside[k]), &more) {
            readings.push(Reading::new("understeer gradient at the wheels", line.slope, "rad.s2/m"));
        }
    }
    Ok(Done { plan, recording: run, readings, notes })
}
