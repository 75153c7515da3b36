//! Rivals on a plain spring, where it is known by hand how far they differ.

use super::*;
use crate::diagnose::study::Closeness;
use crate::effect::{Port, Signal, Source, find};
use crate::fit::{Bench, Channel, Factory};
use crate::model::{Interface, Model as Native, Settings, Slave, Table, input, output, parameter};
use crate::{Error, Result, real};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// F = k x; a travel beyond the limit is refused.
#[derive(Clone, Default, PartialEq, Serialize, Deserialize)]
struct Spring {
    travel: f64,
    speed: f64,
    force: f64,
    limit: f64,
}

const TRAVEL: usize = 0;
const SPEED: usize = 1;
const FORCE: usize = 2;

impl Native for Spring {
    const NAME: &'static str = "spring";
    const DESCRIPTION: &'static str = "A spring";
    fn variables() -> Table<Self> {
        Table::new([
            input("travel", "m", real!(travel), 0.0, "Travel").range(-2.0, 2.0),
            input("speed", "m/s", real!(speed), 20.0, "Speed of the belt"),
            output("force", "N", real!(force), "Force"),
            parameter("limit", "m", real!(limit), 10.0, "Largest travel"),
        ])
    }

    fn step_size(&self) -> f64 {
        1e-3
    }

    fn initialize(&mut self) -> Result<()> {
        self.step(0.0)
    }

    fn step(&mut self, _h: f64) -> Result<()> {
        self.force = self.travel;
        if self.travel.abs() > self.limit { Err(Error::numeric("too far")) } else { Ok(()) }
    }
}

/// A bench with a limit of the travel.
fn bench(limit: f64) -> Bench {
    let settings = Settings::parse(&format!("[parameters]\nlimit = {limit}\n"), "limit.toml").unwrap();
    let factory: Factory = Arc::new(move || {
        let slave: Box<dyn Slave> = Box::new(crate::model::Native::<Spring>::new(&settings)?);
        Ok(slave)
    });
    Bench::new(&factory, &[], 2).unwrap()
}

/// 10 s of a sine of 1 Hz and 1 m at a speed.
fn run(step: f64, speed: f64) -> Run {
    let points = (10.0 / step).round() as usize + 1;
    let time: Vec<f64> = (0..points).map(|k| k as f64 * step).collect();
    let travel: Vec<f64> = time.iter().map(|t| (2.0 * PI * t).sin()).collect();
    let inputs = vec![(TRAVEL, travel.clone()), (SPEED, vec![speed; points])];
    let channels = vec![Channel { variable: FORCE, values: travel, counts: false, unresolved: Vec::new() }];
    Run { name: String::new(), drive: Arc::new(Drive::new(0.0, step, points, inputs)), time, channels }
}

fn study<'a>(bench: &'a Bench, runs: &'a [Run]) -> Study<'a> {
    let all: Vec<&Run> = runs.iter().collect();
    Study {
        bench,
        fit_runs: all.clone(),
        check_runs: all,
        values: Vec::new(),
        of_changes: None,
        closeness: Closeness::Precisely,
        free: Vec::new(),
        lag: 0.0,
        zeros: Vec::new(),
        weights: vec![1.0],
        redundancy: 1.0,
    }
}

fn placement(id: &str, drivers: Vec<Signal>) -> Placement {
    let effect = find(id).unwrap();
    let n = effect.parameters.len();
    let (scales, units) = (vec![1.0; n], vec![None; n]);
    Placement { effect, port: Port::Output, targets: vec![FORCE], drivers, scales, units, bounded: false }
}

/// A rival whose parameters are known to a standard deviation each.
fn rival(id: &str, drivers: Vec<Signal>, values: &[f64], known_to: &[f64]) -> Rival {
    Rival {
        effect: id.into(),
        place: "output force".into(),
        model: Model { parameters: vec![0.0], effects: vec![(placement(id, drivers), values.to_vec())] },
        steps: vec![1e-4; values.len()],
        spread: DMatrix::from_diagonal(&DVector::from_column_slice(known_to)),
    }
}

fn proposed(study: &Study<'_>, rivals: &[Rival], noise: f64) -> Option<Experiment> {
    // as long as it takes
    propose_within(study, &Roles::default(), rivals, &[noise], f64::INFINITY)
}

/// How far rivals differ on the programme whose words begin so: as they are, and after refits.
fn on(study: &Study<'_>, rivals: &[Rival], noise: f64, words: &str) -> (f64, f64) {
    let runs = study.fit_runs.clone();
    let mut library = library(study.bench.interface(), &Roles::default(), &runs);
    library.retain(|p| p.words.starts_with(words));
    let stand = Stand { study, rivals, noise: &[noise] };
    let as_they_are = stand.differ(&library[..1]).pop().unwrap().unwrap();
    (as_they_are[0].by, stand.differ_refitted(&library[0]).unwrap()[0].by)
}

fn close(value: f64, expected: f64, share: f64) {
    assert!((value - expected).abs() <= share * expected.abs(), "{value} instead of {expected}");
}

#[test]
fn a_lag_and_a_delay_differ_where_it_is_fast() {
    let (bench, runs) = (bench(1.2), [run(1e-3, 20.0)]);
    let study = study(&bench, &runs);
    let (time, noise) = (0.02, 0.02);
    let rivals =
        [rival("sensor-lag", vec![], &[time], &[0.0]), rival("sensor-delay", vec![], &[time], &[0.0])];
    // a sine that begins at rest, five periods of it: late by a lag, and by a delay
    let sine = |frequency: f64| {
        let w = 2.0 * PI * frequency;
        let x = w * time;
        let difference = |t: f64| {
            let lag = ((w * t).sin() - x * (w * t).cos() + x * (-t / time).exp()) / (1.0 + x * x);
            lag - if t > time { (w * (t - time)).sin() } else { 0.0 }
        };
        let square: f64 = (0..50_000).map(|k| difference(f64::from(k) * 1e-4 / frequency).powi(2)).sum();
        (square / 50_000.0).sqrt() / noise
    };
    let words = |frequency: u32| format!("sine of travel, amplitude 1 m, {frequency} Hz");
    let (slow, fast) = (on(&study, &rivals, noise, &words(1)).0, on(&study, &rivals, noise, &words(4)).0);
    close(slow, sine(1.0), 0.02);
    close(fast, sine(4.0), 0.02);
    assert!(slow < 0.5 && fast > ENOUGH, "{slow} {fast}");
    // a step of 2 m every half second: of each T (int_0^1 (1 - e^-x)^2 dx + int_1^inf e^-2x dx)
    let e = (-1.0_f64).exp();
    let integral = 1.0 - 2.0 * (1.0 - e) + 0.5 * (1.0 - e * e) + 0.5 * e * e;
    let found = proposed(&study, &rivals, noise).unwrap();
    // nine steps in ten halves of a second
    close(found.separation, (0.9 * 4.0 * time * integral / 0.5).sqrt() / noise, 0.05);
    let steps = "steps of travel between −1 m and 1 m, each held for 0.5 s, speed held at 20 m/s, 5 s";
    assert_eq!((found.programme.as_str(), found.channel.as_str()), (steps, "force"));
    assert_eq!((found.effect.as_str(), found.rivals[0].effect.as_str()), ("sensor-lag", "sensor-delay"));
}

#[test]
fn what_a_refit_absorbs_does_not_count() {
    let (bench, runs) = (bench(10.0), [run(2e-3, 20.0)]);
    let study = study(&bench, &runs);
    let rate = vec![Signal { source: Source::Rate, ..Signal::value(TRAVEL) }];
    let (friction, curve, noise) = (0.5, 0.1, 0.01);
    // a square wave in phase with the velocity, and y |y| in phase with the travel: they have nothing in common
    let rivals = |known_to: f64| {
        [
            rival("guide-friction", rate.clone(), &[friction, 0.0], &[known_to, 0.0]),
            rival("sensor-nonlinearity", vec![], &[curve, 0.0], &[known_to, known_to]),
        ]
    };
    let curved = |amplitude: f64| curve * amplitude * amplitude * 0.375_f64.sqrt() / noise;
    for (amplitude, words) in [(0.5, "0.5 m"), (1.0, "1 m"), (1.5, "1.5 m")] {
        let words = format!("sine of travel, amplitude {words}, 1 Hz");
        let (as_they_are, refitted) = on(&study, &rivals(1e3), noise, &words);
        close(as_they_are, (friction / noise).hypot(curved(amplitude)), 0.02);
        // the friction is all but known from what it does here, the curve is what it cannot make
        close(refitted, curved(amplitude), 0.05);
        let (as_they_are, refitted) = on(&study, &rivals(0.0), noise, &words);
        close(refitted, as_they_are, 1e-9);
    }
    // the curve grows with the square of the amplitude
    let found = proposed(&study, &rivals(1e3), noise).unwrap();
    assert!(found.programme.starts_with("sine of travel, amplitude 1.5 m"), "{}", found.programme);
    close(found.separation, curved(1.5), 0.05);
    // if friction is the smaller one it decides, and is the same at any amplitude: the range need not be left
    let weak = [
        rival("guide-friction", rate, &[0.03, 0.0], &[1e3, 0.0]),
        rival("sensor-nonlinearity", vec![], &[curve, 0.0], &[1e3, 1e3]),
    ];
    let found = proposed(&study, &weak, noise).unwrap();
    close(found.separation, 3.0, 0.1);
    assert!(!found.programme.contains("1.5 m"), "{}", found.programme);
}

#[test]
fn a_drift_shows_when_it_is_waited_for() {
    let (bench, runs) = (bench(10.0), [run(1e-2, 20.0)]);
    let study = study(&bench, &runs);
    // over a run the best offset is half of what the drift reaches
    let (rate, noise) = (0.01, 0.04);
    let rivals = |known_to: f64| {
        [
            rival("sensor-drift", vec![], &[rate], &[0.0]),
            rival("sensor-bias", vec![], &[5.0 * rate], &[known_to]),
        ]
    };
    close(on(&study, &rivals(0.0), noise, "slow triangle").0, rate * 10.0 / 12.0_f64.sqrt() / noise, 0.01);
    let found = proposed(&study, &rivals(0.0), noise).unwrap();
    assert_eq!(found.programme, "travel held at 1 m for long, speed held at 20 m/s, 50 s");
    let square = 50.0_f64.powi(2) / 3.0 - 50.0 * 5.0 + 5.0_f64.powi(2);
    close(found.separation, rate * square.sqrt() / noise, 0.01);
    // an offset that is not known goes to the middle
    let found = proposed(&study, &rivals(1e3), noise).unwrap();
    close(found.separation, rate * 50.0 / 12.0_f64.sqrt() / noise, 0.01);
}

#[test]
fn a_lag_in_metres_and_one_in_seconds_differ_at_another_speed() {
    let (bench, runs) = (bench(1.2), [run(2e-3, 10.0), run(2e-3, 20.0), run(2e-3, 25.0)]);
    let study = study(&bench, &runs);
    let speed = vec![Signal::value(SPEED)];
    let rivals =
        [rival("relaxation-length", speed, &[0.4], &[0.0]), rival("sensor-lag", vec![], &[0.02], &[0.0])];
    let words = "sine of travel, amplitude 1 m, 1 Hz, speed held at";
    assert!(on(&study, &rivals, 0.01, &format!("{words} 20")).0 < 0.1);
    let x = |time: f64| 2.0 * PI * time;
    let difference = |a: f64, b: f64| (0.5 * (a - b).powi(2) / ((1.0 + a * a) * (1.0 + b * b))).sqrt();
    // 0.4 m at 10 m/s are 0.04 s
    close(on(&study, &rivals, 0.01, &format!("{words} 10")).0, difference(x(0.04), x(0.02)) / 0.01, 0.05);
    let found = proposed(&study, &rivals, 0.01).unwrap();
    assert!(found.programme.contains("speed held at 10 m/s"), "{}", found.programme);
}

#[test]
fn rivals_that_nothing_separates_are_said_to_be_alike() {
    let (bench, runs) = (bench(10.0), [run(1e-2, 20.0)]);
    let study = study(&bench, &runs);
    let of = |id: &str, value: f64| rival(id, vec![], &[value], &[0.0]);
    let rivals = [of("sensor-lag", 0.02), of("sensor-lag", 0.02)];
    let found = proposed(&study, &rivals, 0.01).unwrap();
    assert!(found.separation < 1e-9 && found.tried > 8, "{found:?}");
    let words = sentence(Some(&found), "hint");
    assert!(words.contains("less than 0.1 times the noise of force at the most"), "{words}");
    assert!(words.starts_with(&format!("None of the {} programmes", found.tried)), "{words}");
    assert!(words.ends_with("In general: hint."), "{words}");
    // of several the ones that can be separated are
    let three = [of("sensor-lag", 0.02), of("sensor-lag", 0.02), of("sensor-gain", 0.5)];
    let found = proposed(&study, &three, 0.01).unwrap();
    assert!(found.rivals[0].separation < 1e-9 && found.rivals[1].separation > ENOUGH, "{found:?}");
    assert_eq!(found.separation, found.rivals[1].separation);
    let words = sentence(Some(&found), "");
    assert!(words.starts_with("To separate sensor-lag (output force) from sensor-gain"), "{words}");
    assert!(words.contains("separates sensor-lag (output force) too"), "{words}");
    assert_eq!(sentence(None, "hint"), "hint");
    assert!(proposed(&study, &rivals[..1], 0.01).is_none() && proposed(&study, &[], 0.01).is_none());
}

#[test]
fn a_budget_is_counted_in_simulations() {
    let (bench, runs) = (bench(10.0), [run(1e-2, 20.0)]);
    let study = study(&bench, &runs);
    let rivals =
        [rival("sensor-lag", vec![], &[0.02], &[0.0]), rival("sensor-delay", vec![], &[0.02], &[0.0])];
    let tried = |budget: f64| {
        propose_within(&study, &Roles::default(), &rivals, &[0.01], budget).map(|found| found.tried)
    };
    let all = library(bench.interface(), &Roles::default(), &[&runs[0]]);
    // without any budget the first are tried, with enough all of them, and in between what it pays for
    assert_eq!((tried(0.0), tried(f64::INFINITY)), (Some(TOGETHER), Some(all.len())));
    let cost = |some: &[Programme]| -> f64 {
        rivals.len() as f64 * some.iter().map(|p| p.drive.length()).sum::<f64>()
    };
    assert_eq!(tried(0.99 * cost(&all[..TOGETHER]) / FIRST_LOOK), Some(TOGETHER));
    assert_eq!(tried(1.01 * cost(&all[..TOGETHER]) / FIRST_LOOK), Some(2 * TOGETHER));
}

#[test]
fn programmes_that_cannot_be_run_are_left_out() {
    let runs = [run(1e-2, 20.0)];
    let rivals = || {
        [
            rival("sensor-nonlinearity", vec![], &[0.2, 0.0], &[0.0, 0.0]),
            rival("sensor-lag", vec![], &[0.01], &[0.0]),
        ]
    };
    let programme = |limit: f64| {
        let bench = bench(limit);
        proposed(&study(&bench, &runs), &rivals(), 0.01).map(|found| found.programme)
    };
    assert!(programme(10.0).unwrap().contains("1.5 m"));
    assert!(!programme(1.2).unwrap().contains("1.5 m"));
    assert_eq!(programme(0.01), None);
}

#[test]
fn fitted_models_become_rivals() {
    let (bench, mut runs) = (bench(10.0), [run(2e-3, 20.0)]);
    // a lag of 20 ms with noise
    let (noise, mut random) = (0.02, crate::stats::SplitMix64::new(3));
    let x = 2.0 * PI * 0.02;
    for (value, time) in runs[0].channels[0].values.iter_mut().zip(&runs[0].time) {
        let uniform = random.bits() as f64 / u64::MAX as f64 - 0.5;
        let wave = ((2.0 * PI * time).sin() - x * (2.0 * PI * time).cos()) / (1.0 + x * x);
        *value = wave + noise * 12.0_f64.sqrt() * uniform;
    }
    let study = Study { weights: vec![1.0 / noise], ..study(&bench, &runs) };
    let fitted = |id: &str| {
        let placement = placement(id, vec![]);
        let model = Model { parameters: vec![0.0], effects: vec![(placement.clone(), vec![0.01])] };
        let fitted = study.fit(&model, 10).unwrap();
        (Rival::of(&study, &placement, &fitted), study.rest(&fitted.model, &study.check_runs).unwrap())
    };
    let ((lag, left), (delay, _)) = (fitted("sensor-lag"), fitted("sensor-delay"));
    close(lag.model.effects[0].1[0], 0.02, 0.05);
    // standard deviation of a phase from n samples of a sine: sqrt(2 / n) noise / (2 pi f)
    close(delay.spread[(0, 0)], (2.0_f64 / 5001.0).sqrt() * noise / (2.0 * PI), 0.1);
    let found = propose(&study, &Roles::default(), &[lag, delay], &left).unwrap();
    assert!(found.separation > ENOUGH, "{found:?}");
}

#[test]
fn a_library_keeps_to_what_a_rig_can_do() {
    let interface: Interface = bench(10.0).interface().clone();
    let programmes = |run: &Run| library(&interface, &Roles::default(), &[run]);
    let usual = run(1e-2, 20.0);
    // what is never negative stays so, and the speed, which did not move, is held
    let mut load = usual.clone();
    let mut drive = (*load.drive).clone();
    drive.inputs[0].1.iter_mut().for_each(|v| *v = 0.5 + 0.4 * *v);
    load.drive = Arc::new(drive);
    let all = programmes(&load);
    assert!(all.iter().any(|p| p.beyond) && all.len() > 8);
    for programme in &all {
        assert!(programme.drive.inputs[0].1.iter().all(|v| *v >= -1e-12), "{}", programme.words);
        assert!(programme.drive.inputs[1].1.iter().all(|v| *v == 20.0), "{}", programme.words);
    }
    // 1.5 times 1.6 m is more than the variable takes
    let mut wide = usual.clone();
    let mut drive = (*wide.drive).clone();
    drive.inputs[0].1.iter_mut().for_each(|v| *v *= 1.6);
    wide.drive = Arc::new(drive);
    assert!(programmes(&wide).iter().all(|p| !p.beyond));
    // a velocity beside its position follows it
    let mut both = usual;
    let mut drive = (*both.drive).clone();
    drive.inputs[1].1 = both.time.iter().map(|t| 2.0 * PI * (2.0 * PI * t).cos()).collect();
    both.drive = Arc::new(drive);
    let all = programmes(&both);
    let sine = all.iter().find(|p| p.words.starts_with("sine of travel, amplitude 1 m, 4 Hz")).unwrap();
    let most = sine.drive.inputs[1].1.iter().copied().fold(0.0, f64::max);
    close(most, 8.0 * PI, 0.02);
    assert!(!all.iter().any(|p| p.words.contains("of speed")));
    // recordings without anything in them are no reason to stop
    let mut empty = both;
    (empty.drive, empty.time) = (Arc::new(Drive::new(0.0, 0.0, 0, vec![(0, vec![])])), vec![]);
    assert!(programmes(&empty).is_empty() && library(&interface, &Roles::default(), &[]).is_empty());
}
