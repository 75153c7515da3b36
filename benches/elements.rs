//! How fast the super-elastic tire is: over its number of elements, with coupled ones, and four under a truck:
//! `cargo bench --bench elements`. Every figure is the median of several runs, in turn, in one process.
#![allow(clippy::unwrap_used)]

use latsch::model::{Settings, Slave};
use std::hint::black_box;
use std::time::Instant;

const ROUNDS: usize = 7;
/// Communication step, which is the model's own \[s\].
const STEP: f64 = 1e-3;
const STEPS: usize = 4000;

struct Case {
    title: &'static str,
    model: &'static str,
    elements: f64,
    points: f64,
    more: &'static [(&'static str, f64)],
}

const WHEEL: &str = "super-elastic-wheel";
const CASES: [Case; 7] = [
    Case { title: "wheel", model: WHEEL, elements: 45.0, points: 1.0, more: &[] },
    Case { title: "wheel", model: WHEEL, elements: 45.0, points: 3.0, more: &[] },
    Case { title: "wheel", model: WHEEL, elements: 105.0, points: 1.0, more: &[] },
    Case { title: "wheel", model: WHEEL, elements: 105.0, points: 3.0, more: &[] },
    Case { title: "wheel", model: WHEEL, elements: 1000.0, points: 1.0, more: &[] },
    Case {
        title: "coupled",
        model: WHEEL,
        elements: 45.0,
        points: 3.0,
        more: &[("coupling", 3.0), ("rim_force", 2.0)],
    },
    Case {
        title: "truck",
        model: "super-elastic-counterbalance-truck",
        elements: 45.0,
        points: 3.0,
        more: &[("road_start", 1.0)],
    },
];

impl Case {
    /// A wheel that rolls under the load of a truck, with so many elements and contact points of each; or a truck over a cleat.
    fn started(&self) -> Box<dyn Slave + Send> {
        let entry = latsch::fmi::Entry::find(latsch::shipped::MODELS, self.model).unwrap();
        let mut slave = entry.slave(&Settings::default()).unwrap();
        let mut set = |name: &str, value: f64| {
            let variable = slave.find(name).unwrap();
            slave.set(variable, value).unwrap();
        };
        if self.model == WHEEL {
            set("elements", self.elements);
            set("contact_points", self.points);
            let gap = 0.125 * std::f64::consts::TAU / self.elements;
            set("gap_angle", if self.points == 1.0 { 0.0 } else { gap });
            // what carries the load is the same for any number of them
            set("element_radial_stiffness", 1.22e5 * 45.0 / self.elements);
            set("element_radial_damping", 280.0 * 45.0 / self.elements);
            set("hub_mass", 643.2);
            set("axle_force_z", 0.0);
            set("initial_load", 6309.8);
            set("initial_speed", 2.0);
        }
        set("step_size", STEP);
        self.more.iter().for_each(|(name, value)| set(name, *value));
        slave.start(0.0, None).unwrap();
        slave.finish_start().unwrap();
        slave
    }

    /// Seconds that a simulated second takes.
    fn taken(&self) -> f64 {
        let mut slave = self.started();
        let load = slave.find(if self.model == WHEEL { "force_z" } else { "front_left.force_z" }).unwrap();
        let start = Instant::now();
        for k in 0..STEPS {
            slave.step(k as f64 * STEP, STEP).unwrap();
            black_box(slave.get(load).unwrap());
        }
        start.elapsed().as_secs_f64() / (STEPS as f64 * STEP)
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() {
    let mut seconds = vec![Vec::new(); CASES.len()];
    for _ in 0..ROUNDS {
        for (case, taken) in CASES.iter().zip(&mut seconds) {
            taken.push(case.taken());
        }
    }
    println!("super-elastic tire, steps of {} ms", 1e3 * STEP);
    println!("             elements  points   cost of a step   times real time   of the second");
    for (Case { title, elements, points, .. }, taken) in CASES.iter().zip(&seconds) {
        let second = median(taken.clone());
        let ratio = median(taken.iter().zip(&seconds[1]).map(|(a, b)| a / b).collect());
        println!(
            "  {title:8}   {elements:8}  {points:6}   {:11.2} us   {:15.0}   {ratio:13.2}",
            second * STEP * 1e6,
            1.0 / second
        );
    }
}
