//! A stop with ABS on a level road: what the tire has along.

use super::Done;
use super::car::{Car, WHEELS, shipped};
use super::reading::{Reading, View};
use crate::Result;
use crate::cosimulate::PortName;
use crate::model::Value;
use crate::recording::{Channel, Recording};
use std::path::Path;

/// The driver begins, and has the full pressure \[s\]: a kick of 0.15 s.
const BEGIN: f64 = 0.2;
const FULL: f64 = 0.35;
/// \[bar\]: more than the tires can use on any dry road.
const PRESSURE: f64 = 150.0;
/// Rear brakes have smaller pistons \[m2\], as in the example.
const REAR_PISTON: f64 = 30e-4;
/// The run ends here \[m/s\]: 1 km/h.
const END: f64 = 1.0 / 3.6;
/// Longest run \[s\].
const LONGEST: f64 = 30.0;
/// A force over a load that is smaller than this share of the static one of a wheel says nothing of the friction: the tire leaves the road.
const LOADED: f64 = 0.3;

pub(super) fn run(car: &Car, _: &Path, initial: f64) -> Result<Done> {
    let standing = car.standing(initial)?;
    let mut plan = car.plan(LONGEST, &[("initial_speed", Value::Real(initial))]);
    let mut set = vec![("select_low".to_owned(), Value::Boolean(true))];
    let radii = standing.radii.iter().enumerate();
    set.extend(radii.map(|(i, radius)| (format!("rolling_radius_{}", i + 1), Value::Real(*radius))));
    let set: Vec<(&str, Value)> = set.iter().map(|(name, value)| (name.as_str(), value.clone())).collect();
    plan.components.push(shipped("abs", "abs-controller", &set));
    let mut order = vec!["abs".to_owned()];
    let mut pressed = vec![PortName { component: "abs".into(), variable: "driver_pressure".into() }];
    for (i, wheel) in WHEELS.iter().enumerate() {
        let (number, brake) = (i + 1, format!("brake_{wheel}"));
        let pistons = [("piston_area", Value::Real(REAR_PISTON))];
        plan.components.push(shipped(&brake, "brake-hydraulics", if i < 2 { &[] } else { &pistons }));
        car.connect(
            &mut plan,
            ("car", &format!("{wheel}.wheel_speed")),
            ("abs", &format!("wheel_speed_{number}")),
        );
        for valve in ["inlet_valve", "outlet_valve"] {
            car.connect(&mut plan, ("abs", &format!("{valve}_{number}")), (&brake, valve));
        }
        car.connect(&mut plan, (&brake, "brake_torque"), ("car", &format!("{wheel}.brake_torque")));
        pressed.push(PortName { component: brake.clone(), variable: "driver_pressure".into() });
        order.push(brake);
    }
    order.push("car".into());
    plan.order = Some(order);
    let channel = Channel {
        name: "driver_pressure".into(),
        unit: "bar".into(),
        values: vec![0.0, 0.0, PRESSURE, PRESSURE],
    };
    let driver = Recording {
        time: vec![0.0, BEGIN, FULL, LONGEST],
        channels: vec![channel],
        source: "driver.csv".into(),
    };
    let pressed = pressed.into_iter().map(|port| ("driver_pressure".to_owned(), port)).collect();
    car.drive(&mut plan, "driver.csv", &driver, pressed)?;
    let run = car.run(&plan, Some(END))?;
    let view = View { run: &run, car };
    let (speed, way) = (view.course("vehicle_speed", "m/s")?, view.course("vehicle_distance", "m")?);
    let begin = view.at(BEGIN, &speed);
    let (last, end) = (speed.len() - 1, run.time[speed.len() - 1]);
    let stopping = way[last] - view.at(BEGIN, &way);
    let mut readings = vec![
        Reading::new("stopping distance", stopping, "m"),
        Reading::new("stopping time", end - BEGIN, "s"),
        Reading::new(
            "mean deceleration over the way",
            (begin.powi(2) - speed[last].powi(2)) / (2.0 * stopping),
            "m/s2",
        ),
        Reading::new("mean deceleration over the time", (begin - speed[last]) / (end - BEGIN), "m/s2"),
    ];
    for (i, wheel) in WHEELS.iter().enumerate() {
        let force = view.course(&format!("{wheel}.force_x"), "N")?;
        let load = view.course(&format!("{wheel}.force_z"), "N")?;
        let least = LOADED * load[0];
        let ratios =
            force.iter().zip(&load).filter(|(_, load)| **load > least).map(|(f, load)| f.abs() / load);
        readings.push(Reading::new(
            format!("greatest force over load {wheel}"),
            ratios.fold(0.0, f64::max),
            "1",
        ));
        let valve = run.channel_in(&format!("abs.outlet_valve_{}", i + 1), "1")?;
        let openings = valve.windows(2).filter(|pair| pair[0] <= 0.0 && pair[1] > 0.0).count();
        readings.push(Reading::new(format!("openings of the outlet valve {wheel}"), openings as f64, "1"));
    }
    let mut notes = vec!["brakes and controller are placeholders".to_owned()];
    if speed[last] > END {
        notes.push(format!("it still moves with {:.1} m/s after {LONGEST} s", speed[last]));
    }
    Ok(Done { plan, recording: run, readings, notes })
}
