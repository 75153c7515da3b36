//! How fast the car is, alone and with brakes and controller: `cargo bench --bench vehicle`. Every figure is the median of several
//! runs, in turn, in one process.
#![allow(clippy::unwrap_used)]

use latsch::model::{Settings, Slave};
use std::hint::black_box;
use std::time::Instant;

const ROUNDS: usize = 5;
/// Communication step \[s\].
const STEP: f64 = 1e-3;
/// Of a stop from 100 km/h that is not finished then.
const STEPS: usize = 1500;
const WHEELS: [&str; 4] = ["front_left", "front_right", "rear_left", "rear_right"];

type Unit = Box<dyn Slave + Send>;

/// A wire: where from, unit and variable, and where to.
type Wire = ((usize, usize), (usize, usize));

struct Case {
    model: &'static str,
    /// Step of the car's own grid \[s\].
    own: f64,
    with_brakes: bool,
}

const CASES: [Case; 5] = [
    Case { model: "ring-brush-vehicle", own: 5e-4, with_brakes: false },
    Case { model: "ring-brush-vehicle", own: 5e-4, with_brakes: true },
    Case { model: "ring-brush-vehicle", own: 2e-4, with_brakes: true },
    Case { model: "magic-formula-vehicle", own: 5e-4, with_brakes: true },
    Case { model: "magic-formula-vehicle", own: 2e-4, with_brakes: true },
];

fn unit(model: &str, values: &[(&str, f64)]) -> Unit {
    let entry = latsch::fmi::Entry::find(latsch::shipped::MODELS, model).unwrap();
    let mut slave = entry.slave(&Settings::default()).unwrap();
    for (name, value) in values {
        let variable = slave.find(name).unwrap();
        slave.set(variable, *value).unwrap();
    }
    slave.start(0.0, None).unwrap();
    slave.finish_start().unwrap();
    slave
}

impl Case {
    /// Car, controller, brakes, in the order in which they step, and wires.
    fn made(&self) -> (Vec<Unit>, Vec<Wire>) {
        // a column that swings with the rack within one step of 1 ms asks for a heavier rack
        let rack = if self.own > 5e-4 { 20.0 } else { 4.0 };
        let car =
            unit(self.model, &[("step_size", self.own), ("initial_speed", 100.0 / 3.6), ("rack_mass", rack)]);
        if !self.with_brakes {
            return (vec![car], Vec::new());
        }
        let speeds: Vec<_> = (1..=4).map(|i| format!("wheel_speed_{i}")).collect();
        let mut start: Vec<(&str, f64)> = speeds.iter().map(|name| (name.as_str(), 84.0)).collect();
        start.extend([("driver_pressure", 1.5e7), ("select_low", 1.0)]);
        let mut units = vec![unit("abs-controller", &start)];
        for _ in WHEELS {
            units.push(unit("brake-hydraulics", &[("driver_pressure", 1.5e7)]));
        }
        units.push(car);
        let mut wires = Vec::new();
        let mut wire = |from: (usize, String), to: (usize, String)| {
            let [a, b] =
                [&from, &to].map(|(at, name): &(usize, String)| (*at, units[*at].find(name).unwrap()));
            wires.push((a, b));
        };
        for (i, wheel) in WHEELS.iter().enumerate() {
            let (n, brake) = (i + 1, i + 1);
            wire((5, format!("{wheel}.wheel_speed")), (0, format!("wheel_speed_{n}")));
            wire((0, format!("inlet_valve_{n}")), (brake, "inlet_valve".into()));
            wire((0, format!("outlet_valve_{n}")), (brake, "outlet_valve".into()));
            wire((brake, "brake_torque".into()), (5, format!("{wheel}.brake_torque")));
        }
        (units, wires)
    }

    /// Seconds that a simulated second takes.
    fn taken(&self) -> f64 {
        let (mut units, wires) = self.made();
        let last = units.len() - 1;
        let load = units[last].find("front_left.longitudinal_link_force").unwrap();
        let start = Instant::now();
        for k in 0..STEPS {
            for at in 0..units.len() {
                for ((from, out), (to, into)) in &wires {
                    if *to == at {
                        let value = units[*from].get(*out).unwrap();
                        units[at].set(*into, value).unwrap();
                    }
                }
                units[at].step(k as f64 * STEP, STEP).unwrap();
            }
            black_box(units[last].get(load).unwrap());
        }
        start.elapsed().as_secs_f64() / (STEPS as f64 * STEP)
    }
}

fn main() {
    let mut seconds = vec![Vec::new(); CASES.len()];
    for _ in 0..ROUNDS {
        for (case, taken) in CASES.iter().zip(&mut seconds) {
            taken.push(case.taken());
        }
    }
    println!("car, communication steps of {} ms", 1e3 * STEP);
    for (Case { model, own, with_brakes }, mut taken) in CASES.iter().zip(seconds) {
        taken.sort_by(f64::total_cmp);
        let second = taken[ROUNDS / 2];
        println!(
            "  {model:22} own step {:4} ms, {:20} {:6.0} times real time",
            1e3 * own,
            if *with_brakes { "brakes, controller" } else { "alone" },
            1.0 / second
        );
    }
}
