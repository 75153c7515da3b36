//! How fast the super-elastic tire is, over its number of elements: `cargo bench --bench elements`. Every figure is the median of
//! several runs, in turn, in one process.
#![allow(clippy::unwrap_used)]

use latsch::model::{Native, Settings, Slave};
use latsch::rig::Wheel;
use latsch::tire::super_elastic::SuperElastic;
use std::hint::black_box;
use std::time::Instant;

const ROUNDS: usize = 7;
/// Communication step, which is the model's own \[s\].
const STEP: f64 = 1e-3;
const STEPS: usize = 4000;

/// A wheel that rolls under the load of a truck, with so many elements and contact points of each.
fn wheel(elements: f64, points: f64) -> Native<Wheel<SuperElastic>> {
    let mut slave = Native::new(&Settings::default()).unwrap();
    let values = [
        ("elements", elements),
        ("contact_points", points),
        ("gap_angle", if points == 1.0 { 0.0 } else { 0.125 * std::f64::consts::TAU / elements }),
        // what carries the load is the same for any number of them
        ("element_radial_stiffness", 1.22e5 * 45.0 / elements),
        ("element_radial_damping", 280.0 * 45.0 / elements),
        ("hub_mass", 643.2),
        ("axle_force_z", 0.0),
        ("initial_load", 6309.8),
        ("initial_speed", 2.0),
        ("step_size", STEP),
    ];
    for (name, value) in values {
        let variable = slave.find(name).unwrap();
        slave.set(variable, value).unwrap();
    }
    slave.start(0.0, None).unwrap();
    slave.finish_start().unwrap();
    slave
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() {
    const CASES: [(f64, f64); 5] = [(45.0, 1.0), (45.0, 3.0), (105.0, 1.0), (105.0, 3.0), (1000.0, 1.0)];
    let mut seconds = vec![Vec::new(); CASES.len()];
    for _ in 0..ROUNDS {
        for ((elements, points), taken) in CASES.iter().zip(&mut seconds) {
            let mut wheel = wheel(*elements, *points);
            let load = wheel.find("force_z").unwrap();
            let start = Instant::now();
            for k in 0..STEPS {
                wheel.step(k as f64 * STEP, STEP).unwrap();
                black_box(wheel.get(load).unwrap());
            }
            taken.push(start.elapsed().as_secs_f64() / (STEPS as f64 * STEP));
        }
    }
    println!("super-elastic wheel, steps of {} ms", 1e3 * STEP);
    println!("  elements  points   cost of a step   per element   times real time   of the first");
    for ((elements, points), taken) in CASES.iter().zip(&seconds) {
        let second = median(taken.clone());
        let ratio = median(taken.iter().zip(&seconds[0]).map(|(a, b)| a / b).collect());
        println!(
            "  {elements:8}  {points:6}   {:11.2} us   {:8.1} ns   {:15.0}   {ratio:12.2}",
            second * STEP * 1e6,
            second * STEP / elements * 1e9,
            1.0 / second
        );
    }
}
