//! Waves of the road, one as the other: the uneven road on which it is certain where the vehicle is (Mack 2009, L2514).

use super::Done;
use super::car::{Car, WHEELS};
use super::reading::{Reading, View};
use crate::model::Value;
use crate::stats::{deviation, extent, mean};
use crate::{Error, Result};
use std::path::Path;

/// \[m/s\]: 50 km/h make 6.9 waves of 2 m a second, between the body's modes and those of the wheels.
const SPEED: f64 = 50.0 / 3.6;
/// The source names no waves; these are placeholders \[m\].
const LENGTH: f64 = 2.0;
const HEIGHT: f64 = 0.02;
/// The waves begin \[m\].
const BEGIN: f64 = 5.0;
/// What is read, from when the beginning has faded \[s\].
const WINDOW: [f64; 2] = [2.0, 5.0];
/// Forces of the suspension, of which a vehicle may have some.
const FORCES: [&str; 4] =
    ["longitudinal_link_force", "transverse_link_force", "tie_rod_force", "strut_force"];

pub(super) fn run(car: &Car, _: &Path) -> Result<Done> {
    let plan = car.plan(
        WINDOW[1],
        &[
            ("initial_speed", Value::Real(SPEED)),
            ("road_kind", Value::Text("sine".into())),
            ("road_start", Value::Real(BEGIN)),
            ("road_length", Value::Real(LENGTH)),
            ("road_height", Value::Real(HEIGHT)),
        ],
    );
    let run = car.run(&plan, None)?;
    let view = View { run: &run, car };
    let window = view.samples(WINDOW[0], WINDOW[1]);
    let speed = mean(&view.course("vehicle_speed", "m/s")?[window.clone()]);
    let mut readings = vec![Reading::new("mean speed", speed, "m/s")];
    let load = &view.course("front_left.force_z", "N")?[window.clone()];
    let middle = mean(load);
    let rises: Vec<usize> = (1..load.len()).filter(|k| load[k - 1] < middle && load[*k] >= middle).collect();
    let (Some(first), Some(last), 2..) = (rises.first(), rises.last(), rises.len()) else {
        return Err(Error::numeric(format!(
            "the load of the front left wheel stays at {middle:.0} N: it does not feel the waves"
        )));
    };
    let time = &run.time[window.clone()];
    let frequency = (rises.len() - 1) as f64 / (time[*last] - time[*first]);
    readings.push(Reading::new("frequency of the wheel load", frequency, "Hz").beside(Some(speed / LENGTH)));
    let mut missing = Vec::new();
    for wheel in WHEELS {
        for (force, named) in
            std::iter::once(("force_z", true)).chain(FORCES.map(|force| (force, wheel.starts_with("front"))))
        {
            let name = format!("{wheel}.{force}");
            let Ok(values) = view.course(&name, "N") else {
                if named {
                    missing.push(name);
                }
                continue;
            };
            let values = &values[window.clone()];
            let (low, high) = extent(values.iter().copied());
            readings.push(Reading::new(format!("smallest {name}"), low, "N"));
            readings.push(Reading::new(format!("largest {name}"), high, "N"));
            readings.push(Reading::new(format!("rms {name} about its mean"), deviation(values), "N"));
        }
    }
    let mut notes =
        vec![format!("waves of {LENGTH} m and {HEIGHT} m are placeholders; the vehicle rolls freely")];
    if !missing.is_empty() {
        notes.push(format!("the vehicle does not tell {}", missing.join(", ")));
    }
    Ok(Done { plan, recording: run, readings, notes })
}
