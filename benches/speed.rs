//! How fast the tire's models are: `cargo bench`. Every figure is the median of several runs, in turn, in
//! one process; ratios are what to compare between machines.
#![allow(clippy::unwrap_used)]

use latsch::fmi::archive::ModelLibrary;
use latsch::fmi::import::ImportedFmu;
use latsch::model::{Model, Native, Settings, Slave};
use latsch::rig::{Corner, FlatTrack as FlatTrackOf, RingBrushCorner, RingBrushFlatTrack, RingBrushWheel};
use latsch::shipped::MODELS;
use latsch::tire::magic_formula::MagicFormula;
use std::hint::black_box;
use std::time::Instant;

const ROUNDS: usize = 7;
const COMMUNICATION_STEP: f64 = 1e-3;
const STEPS: usize = 1000;

type FlatTrack = Native<RingBrushFlatTrack>;

/// Seconds that `work` takes.
fn time(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Rolling at combined slip under 4 kN, `bristles` per stripe of a total stiffness that stays.
fn start(slave: &mut dyn Slave, speed: f64, bristles: f64) {
    let scale = 30.0 / bristles;
    let values = [
        ("path_speed", speed),
        ("slip", 0.03),
        ("slip_angle", 0.03),
        ("bristles_per_stripe", bristles),
        ("bristle_length", 0.014 * scale),
        ("bristle_stiffness", 4e4 * scale),
        ("bristle_damping", 0.65 * scale),
    ];
    start_with(slave, &values);
}

fn start_with(slave: &mut dyn Slave, values: &[(&str, f64)]) {
    for (name, value) in values {
        let index = slave.find(name).unwrap();
        slave.set(index, *value).unwrap();
    }
    slave.start(0.0, None).unwrap();
    slave.finish_start().unwrap();
}

fn run(slave: &mut dyn Slave) {
    let force = slave.find("force_x").unwrap();
    for k in 0..STEPS {
        slave.step(k as f64 * COMMUNICATION_STEP, COMMUNICATION_STEP).unwrap();
        black_box(slave.get(force).unwrap());
    }
}

/// Seconds per simulated second of the flat track, then of corner and wheel, in turn in each round: these
/// brake from 100 km/h, on a flat road and on one of ISO 8608, with the model's 30 bristles per stripe.
fn vehicle_units(rounds: usize) {
    const ROADS: [(&str, f64); 2] = [("flat", 1.0), ("ISO 8608", 6.0)];
    // the wheel by itself is pushed with what it brakes with
    const CORNER: [(&str, f64); 1] = [("brake_torque", 1000.0)];
    const WHEEL: [(&str, f64); 3] =
        [("initial_speed", 27.8), ("brake_torque", 1000.0), ("axle_force_x", 3000.0)];
    let mut seconds = vec![Vec::new(); 8];
    for _ in 0..rounds {
        let mut measure = |row: usize, slave: &mut dyn Slave| {
            let taken = time(|| run(slave)) / (STEPS as f64 * COMMUNICATION_STEP);
            seconds[row].push(taken);
        };
        let mut rig = FlatTrack::new(&Settings::default()).unwrap();
        start(&mut rig, 27.8, 30.0);
        measure(0, &mut rig);
        for (k, (_, kind)) in ROADS.iter().enumerate() {
            let values = |of: &[(&'static str, f64)]| [of, &[("road_kind", *kind)]].concat();
            let mut corner = Native::<RingBrushCorner>::new(&Settings::default()).unwrap();
            start_with(&mut corner, &values(&CORNER));
            measure(1 + k, &mut corner);
            let mut wheel = Native::<RingBrushWheel>::new(&Settings::default()).unwrap();
            start_with(&mut wheel, &values(&WHEEL));
            measure(3 + k, &mut wheel);
        }
        let mut rig = Native::<FlatTrackOf<MagicFormula>>::new(&Settings::default()).unwrap();
        let commands = [("path_speed", 27.8), ("slip", 0.03), ("slip_angle", 0.03)];
        start_with(&mut rig, &commands);
        measure(5, &mut rig);
        for (k, (_, kind)) in ROADS.iter().enumerate() {
            let mut corner = Native::<Corner<MagicFormula>>::new(&Settings::default()).unwrap();
            start_with(&mut corner, &[&CORNER[..], &[("road_kind", *kind)]].concat());
            measure(6 + k, &mut corner);
        }
    }
    println!("\ncorner and wheel braking from 27.8 m/s at 1 kHz, 6x30 bristles, model step 0.1 ms");
    println!(
        "  model                      road       communication step   times real time   of the flat track"
    );
    let ratio = |row: usize| median(seconds[row].iter().zip(&seconds[0]).map(|(a, b)| a / b).collect());
    let names = ["flat track", "corner", "corner", "wheel", "wheel"].map(String::from);
    let others = ["flat track", "corner", "corner"].map(|rig| format!("magic-formula {rig}"));
    const ON: [usize; 8] = [0, 0, 1, 0, 1, 0, 0, 1];
    for (row, name) in names.iter().chain(&others).enumerate() {
        let road = ROADS[ON[row]].0;
        let second = median(seconds[row].clone());
        println!(
            "  {name:<26} {road:<10} {:15.1} us   {:15.1}   {:17.2}",
            second * COMMUNICATION_STEP * 1e6,
            1.0 / second,
            ratio(row)
        );
    }
}

fn main() {
    // cargo test runs benchmarks with --test to see that they work
    let rounds = if std::env::args().any(|a| a == "--test") { 1 } else { ROUNDS };
    let simulated = STEPS as f64 * COMMUNICATION_STEP;
    let model_steps = {
        let mut rig = FlatTrack::new(&Settings::default()).unwrap();
        start(&mut rig, 10.0, 30.0);
        simulated / rig.model().step_size()
    };

    // A yardstick for the machine: the dearest function of the pressure distribution.
    let powers = 1_000_000;
    let power = median(
        (0..rounds)
            .map(|_| {
                time(|| {
                    for k in 0..powers {
                        black_box(libm::pow(black_box(1e-6 * f64::from(k)), black_box(5.3)));
                    }
                }) / f64::from(powers)
            })
            .collect(),
    );
    println!("yardstick: libm pow                         {:8.1} ns", power * 1e9);
    let made = 200;
    let make = || {
        time(|| {
            for _ in 0..made {
                black_box(FlatTrack::new(&Settings::default()).unwrap());
            }
        }) / f64::from(made)
    };
    println!(
        "a slave of the flat track, with its table   {:8.1} us",
        median((0..rounds).map(|_| make()).collect()) * 1e6
    );

    println!("\nflat track at 1 kHz, 6 stripes, model step 0.1 ms");
    println!("  speed  bristles   model step   per bristle   of a pow   times real time");
    for (speed, bristles) in [(10.0, 30.0), (30.0, 30.0), (10.0, 60.0), (10.0, 120.0)] {
        let seconds = median(
            (0..rounds)
                .map(|_| {
                    let mut rig = FlatTrack::new(&Settings::default()).unwrap();
                    start(&mut rig, speed, bristles);
                    time(|| run(&mut rig))
                })
                .collect(),
        );
        let step = seconds / model_steps;
        let bristle = step / (6.0 * bristles);
        println!(
            "  {speed:2.0} m/s     6x{bristles:<4.0}   {:8.2} us   {:8.1} ns   {:8.2}   {:15.1}",
            step * 1e6,
            bristle * 1e9,
            bristle / power,
            simulated / seconds
        );
    }

    vehicle_units(rounds);

    let library = match ModelLibrary::shipped(MODELS) {
        Ok(library) => library,
        Err(error) => {
            println!("\nthe FMU is not measured: {error}");
            return;
        }
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flat-track.fmu");
    let make = || library.fmu(RingBrushFlatTrack::NAME, &Settings::default(), &[]).unwrap();
    std::fs::write(&path, make()).unwrap();
    let mut fmu = ImportedFmu::load(&path).unwrap();
    let mut rig = FlatTrack::new(&Settings::default()).unwrap();
    let (mut export, mut initialize, mut ratios) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..rounds {
        export.push(time(|| {
            black_box(make());
        }));
        rig.reset().unwrap();
        initialize.push(time(|| start(&mut rig, 10.0, 30.0)));
        fmu.reset().unwrap();
        start(&mut fmu, 10.0, 30.0);
        let (native, through_fmi) = (time(|| run(&mut rig)), time(|| run(&mut fmu)));
        ratios.push(through_fmi / native);
    }
    println!("\nexport of an FMU                             {:8.1} ms", median(export) * 1e3);
    println!("initialization with a stationary state       {:8.1} ms", median(initialize) * 1e3);
    println!("run through FMI over native run              {:8.3}", median(ratios));
}
