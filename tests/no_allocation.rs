//! A step of a shipped model does not touch the heap, on the grid and between grid points, nor does
//! saving into an existing snapshot.
#![allow(missing_docs, clippy::unwrap_used)]

mod common;

use common::set;
use latsch::fmi::Entry;
use latsch::model::{Causality, Settings};
use latsch::shipped::MODELS;

/// What the names of models end with (every tire on a rig, or a name), start values that let something happen, and an input that moves, with its rate.
type Run = (&'static str, &'static [(&'static str, f64)], (&'static str, f64));

const RUNS: [Run; 11] = [
    ("-flat-track", &[("slip", 0.05), ("slip_angle", 0.03), ("camber", 0.02)], ("deflection", 0.01)),
    ("-tire", &[("rim_velocity_y", 0.3), ("road_slope_x", 0.02)], ("rim_spin_rate", 20.0)),
    ("-wheel", &[("steer", 0.02), ("camber", 0.02)], ("brake_torque", 3e4)),
    ("-corner", &[("friction_factor", 0.8)], ("brake_torque", 3e4)),
    ("-hydropulse", &[("excitation", 4.0), ("excitation_amplitude", 500.0)], ("force", 3e4)),
    ("-drum", &[("brake_torque", 20.0)], ("drum_speed", 30.0)),
    ("-counterbalance-truck", &[("speed", 8.0)], ("speed", 10.0)),
    ("-vehicle", &[("steering_wheel_angle", 0.1)], ("front_left.brake_torque", 3e4)),
    ("axle", &[("steering_wheel_angle", 0.1)], ("left.carrier_force_x", -1e4)),
    ("brake-hydraulics", &[("outlet_valve", 0.3)], ("driver_pressure", 1e8)),
    ("abs-controller", &[("driver_pressure", 1e7)], ("wheel_speed_1", -100.0)),
];

/// Kinds of road whose evaluation differs: sinusoids, and straight pieces with friction patches.
const ROADS: [f64; 2] = [6.0, 8.0];

fn count_allocations(entry: &Entry, (_, start, (moving, rate)): Run, road: f64) -> u64 {
    let mut slave = entry.slave(&Settings::default()).unwrap();
    set(&mut *slave, start);
    // a drum's road has to close, as its own does
    if let Ok(kind) = slave.find("road_kind")
        && !entry.name.ends_with("-drum")
    {
        slave.set(kind, road).unwrap();
        // what has several wheels starts on a level piece
        let wheeled = entry.name.ends_with("-truck") || entry.name.ends_with("-vehicle");
        let start = if wheeled { 0.5 } else { 0.05 };
        set(&mut *slave, &[("road_start", start)]);
        for (name, text) in [("road_profile", "0 0; 0 0.005; 0.3 0"), ("road_friction", "0.1 0.7; 0.3 0.9")] {
            slave.set_text(slave.find(name).unwrap(), text).unwrap();
        }
    }
    slave.start(0.0, None).unwrap();
    slave.finish_start().unwrap();

    let moving = slave.find(moving).unwrap();
    let middle = slave.get(moving).unwrap().max(200.0 * 1.3e-4 * rate.abs());
    let outputs: Vec<usize> = slave
        .interface()
        .with(Causality::Output)
        .filter(|i| slave.interface().variables[*i].is_real())
        .collect();
    let mut snapshot = slave.save().unwrap();
    let mut time = 0.0;
    let info = allocation_counter::measure(|| {
        // off the grid of 1e-4 s every time but the tenth
        for k in 0..200 {
            slave.set(moving, middle + rate * 1e-3 * f64::from(k % 10)).unwrap();
            slave.set_rate(moving, rate).unwrap();
            slave.step(time, 1.3e-4).unwrap();
            time += 1.3e-4;
            assert!(outputs.iter().all(|i| slave.get(*i).unwrap().is_finite()));
            slave.save_into(&mut snapshot).unwrap();
            if k == 150 {
                slave.restore(&snapshot).unwrap();
            }
        }
    });
    info.count_total
}

#[test]
fn steps_and_repeated_saves_do_not_allocate() {
    for entry in MODELS {
        let run = RUNS.into_iter().find(|(name, ..)| entry.name.ends_with(name)).unwrap();
        for road in ROADS {
            assert_eq!(count_allocations(entry, run, road), 0, "{} on road {road}", entry.name);
        }
    }
}
