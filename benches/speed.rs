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

/// Rolling at combined slip under 4 kN, with stripes of so many bristles, whose total stiffness stays.
fn start(slave: &mut dyn Slave, speed: f64, stripes: f64, bristles: f64) {
    let scale = 30.0 / bristles;
    let values = [
        ("path_speed", speed),
        ("slip", 0.03),
        ("slip_angle", 0.03),
        ("stripes", stripes),
        ("bristles_per_stripe", bristles),
        ("bristle_length", 0.014 * scale),
        ("bristle_stiffness", 4e4 * scale * 6.0 / stripes),
        ("bristle_damping", 0.65 * scale * 6.0 / stripes),
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
    run_in_steps(slave, STEPS, COMMUNICATION_STEP);
}

fn run_in_steps(slave: &mut dyn Slave, steps: usize, length: f64) {
    let force = slave.find("force_x").unwrap();
    for k in 0..steps {
        slave.step(k as f64 * length, length).unwrap();
        black_box(slave.get(force).unwrap());
    }
}

/// The flat track at several speeds, grids and communication steps, and over a rough road, in turn in each round.
fn flat_track(rounds: usize, power: f64) {
    const CASES: [(f64, f64, f64, f64, f64, f64); 11] = [
        // speed, stripes, bristles, step of the model, communication step, road
        (10.0, 6.0, 30.0, 5e-4, 1e-3, 1.0),
        (30.0, 6.0, 30.0, 5e-4, 1e-3, 1.0),
        (10.0, 6.0, 30.0, 1e-3, 1e-3, 1.0),
        (30.0, 6.0, 30.0, 1e-3, 1e-3, 1.0),
        (10.0, 6.0, 30.0, 5e-4, 1e-3, 6.0),
        (30.0, 6.0, 30.0, 5e-4, 1e-3, 6.0),
        (10.0, 5.0, 48.0, 5e-4, 1e-3, 1.0),
        (10.0, 6.0, 60.0, 5e-4, 1e-3, 1.0),
        (10.0, 6.0, 120.0, 5e-4, 1e-3, 1.0),
        (10.0, 20.0, 48.0, 5e-4, 1e-3, 1.0),
        (10.0, 20.0, 48.0, 5e-4, 2.5e-4, 1.0),
    ];
    let mut seconds = vec![Vec::new(); CASES.len()];
    for _ in 0..rounds {
        for ((speed, stripes, bristles, own, length, road), taken) in CASES.iter().zip(&mut seconds) {
            let mut rig = FlatTrack::new(&Settings::default()).unwrap();
            for (name, value) in [("road_kind", *road), ("step_size", *own)] {
                let variable = rig.find(name).unwrap();
                rig.set(variable, value).unwrap();
            }
            start(&mut rig, *speed, *stripes, *bristles);
            let steps = (STEPS as f64 * COMMUNICATION_STEP / length).round() as usize;
            taken.push(time(|| run_in_steps(&mut rig, steps, *length)) / (STEPS as f64 * COMMUNICATION_STEP));
        }
    }
    println!("\nflat track");
    println!(
        "  speed  bristles  road       steps: model   communication   cost of one   per bristle   of a pow   times real time   of the first"
    );
    for ((speed, stripes, bristles, own, length, road), taken) in CASES.iter().zip(&seconds) {
        let second = median(taken.clone());
        let step = second * own.min(*length);
        let bristle = step / (stripes * bristles);
        let ratio = median(taken.iter().zip(&seconds[0]).map(|(a, b)| a / b).collect());
        let road = if *road == 1.0 { "flat" } else { "ISO 8608" };
        println!(
            "  {speed:2.0} m/s   {stripes:2.0}x{bristles:<4.0} {road:<10} {:9.2} ms   {:10.2} ms   {:8.2} us   {:8.1} ns   {:8.2}   {:15.1}   {ratio:12.2}",
            own.min(*length) * 1e3,
            length * 1e3,
            step * 1e6,
            bristle * 1e9,
            bristle / power,
            1.0 / second,
        );
    }
}

/// Many tires: one after the other at each communication point on one core, and on two.
fn instances(rounds: usize) {
    let run_all = |rigs: &mut [FlatTrack]| {
        for k in 0..STEPS {
            for rig in rigs.iter_mut() {
                rig.step(k as f64 * COMMUNICATION_STEP, COMMUNICATION_STEP).unwrap();
            }
        }
    };
    const COUNTS: [usize; 3] = [1, 4, 16];
    let mut alone = vec![Vec::new(); COUNTS.len()];
    let mut shared = Vec::new();
    for _ in 0..rounds {
        for (count, taken) in COUNTS.iter().zip(&mut alone) {
            let make = || {
                let mut rig = FlatTrack::new(&Settings::default()).unwrap();
                start(&mut rig, 10.0, 6.0, 30.0);
                rig
            };
            let mut rigs: Vec<FlatTrack> = (0..*count).map(|_| make()).collect();
            taken.push(time(|| run_all(&mut rigs)));
            if *count == 16 {
                let mut rigs: Vec<FlatTrack> = (0..*count).map(|_| make()).collect();
                let (first, second) = rigs.split_at_mut(8);
                shared.push(time(|| {
                    std::thread::scope(|scope| {
                        scope.spawn(|| run_all(first));
                        run_all(second);
                    });
                }));
            }
        }
    }
    let simulated = STEPS as f64 * COMMUNICATION_STEP;
    println!("\ntires side by side, 6x30, 10 m/s, 1 kHz");
    for (count, taken) in COUNTS.iter().zip(&alone) {
        let ratio = taken.iter().zip(&alone[0]).map(|(a, b)| a / b / *count as f64).collect();
        println!(
            "  {count:2} on one core   {:6.1} times real time   {:5.2} of the cost of one, each",
            simulated / median(taken.clone()),
            median(ratio)
        );
    }
    let faster = shared.iter().zip(&alone[2]).map(|(two, one)| one / two).collect();
    println!("  16 on two cores  {:5.2} times as fast as on one", median(faster));
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
        start(&mut rig, 27.8, 6.0, 30.0);
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
    println!("\ncorner and wheel braking from 27.8 m/s at 1 kHz, 6x30 bristles");
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

    flat_track(rounds, power);
    instances(rounds);
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
        initialize.push(time(|| start(&mut rig, 10.0, 6.0, 30.0)));
        fmu.reset().unwrap();
        start(&mut fmu, 10.0, 6.0, 30.0);
        let (native, through_fmi) = (time(|| run(&mut rig)), time(|| run(&mut fmu)));
        ratios.push(through_fmi / native);
    }
    println!("\nexport of an FMU                             {:8.1} ms", median(export) * 1e3);
    println!("initialization with a stationary state       {:8.1} ms", median(initialize) * 1e3);
    println!("run through FMI over native run              {:8.3}", median(ratios));
}
