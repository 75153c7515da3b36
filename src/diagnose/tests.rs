//! Whole diagnoses of small models: what their answers must not depend on, and what is fitted.

use super::begin::Begun;
use super::candidates::{Before, assess};
use super::one_function::{Law, one_function};
use super::placement::Placement;
use super::precision::within_precision;
use super::refit::from_two_places;
use super::result::Finding;
use super::screen::Screened;
use super::search::{Found, without};
use super::study::{Closeness, Fitted, Model, Study};
use super::*;
use crate::effect::find as find_effect;
use crate::effect::{Attachment, Chosen, Port, Signal, Source};
use crate::fit::{Bench, Channel, Drive, End, Knob, OutputError, Problem, Run, Setup, replay};
use crate::model::Settings;
use crate::recording::{Channel as Recorded, Recording, write_csv};
use crate::report::{CheckRun, diagnosis_report};
use crate::stats::SplitMix64;
use nalgebra::DVector;
use std::f64::consts::TAU;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// No bounds.
const FREE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// Four seconds of a shipped brake, whose torque gauge lags by 12 ms.
fn record_brake(folder: &Path) {
    let subject = Subject::load("brake-hydraulics", &Settings::default()).unwrap();
    let find = |name: &str| subject.interface.index(name).unwrap();
    let bench = Bench::new(&subject.factory, &subject.fixed, 1).unwrap();
    let mut random = SplitMix64::new(5);
    for number in 0..5 {
        let mut uniform = || random.bits() as f64 / u64::MAX as f64;
        let sines: Vec<[f64; 3]> =
            (0..4).map(|_| [6e5 * (0.5 + uniform()), 0.4 + 1.6 * uniform(), TAU * uniform()]).collect();
        let pressure = |t: f64| 4e6 + sines.iter().map(|[a, f, p]| a * (TAU * f * t + p).sin()).sum::<f64>();
        let fine: Vec<f64> = (0..=4000).map(|k| pressure(1e-3 * f64::from(k))).collect();
        let inputs = vec![(find("driver_pressure"), fine)];
        let drive = Arc::new(Drive::new(0.0, 1e-3, 4001, inputs));
        let setup = Arc::new(Setup { values: vec![(find("friction"), 0.43)], attachments: Vec::new() });
        let watch: Arc<[usize]> = Arc::from([find("brake_torque"), find("driver_pressure")]);
        let traces = bench.run(&[setup], &[drive], &watch).pop().unwrap().unwrap();
        let mut late = traces[0][0];
        let torque: Vec<f64> = traces[0]
            .iter()
            .map(|now| {
                late += (now - late) * (1.0 - (-1e-3_f64 / 12e-3).exp());
                late
            })
            .collect();
        let every = |values: &[f64]| values.iter().step_by(10).copied().collect::<Vec<f64>>();
        let noisy = every(&torque).iter().map(|v| v + 8.0 * (uniform() - 0.5)).collect();
        let channel = |name: &str, unit: &str, values: Vec<f64>| Recorded {
            name: name.into(),
            unit: unit.into(),
            values,
        };
        let recording = Recording {
            source: format!("run {number}"),
            time: (0..=400).map(|k| 0.01 * f64::from(k)).collect(),
            channels: vec![
                channel("driver_pressure", "Pa", every(&traces[1])),
                channel("brake_torque", "N.m", noisy),
            ],
        };
        write_csv(&folder.join(format!("run-{number}.csv")), &recording).unwrap();
    }
}

/// All that a diagnosis writes for people and for machines, and the answer itself.
fn written(request: &Request) -> (String, String, Diagnosis) {
    let outcome = diagnose(request, &mut |_, _| {}).unwrap();
    let runs: Vec<CheckRun> = (outcome.check.iter())
        .map(|run| CheckRun {
            name: run.measured.source.clone(),
            recording: run.measured.clone(),
            before: run.before.clone(),
            after: run.after.clone(),
        })
        .collect();
    let page = diagnosis_report(&outcome.diagnosis, &runs).unwrap();
    (outcome.diagnosis.to_json().unwrap(), page, outcome.diagnosis)
}

/// Keeps all cores busy while something is done.
fn under_load<T>(something: impl FnOnce() -> T) -> T {
    let done = AtomicBool::new(false);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..2 * cores {
            scope.spawn(|| {
                while !done.load(Ordering::Relaxed) {
                    std::hint::spin_loop();
                }
            });
        }
        let result = something();
        done.store(true, Ordering::Relaxed);
        result
    })
}

#[test]
fn the_speed_of_the_machine_and_the_number_of_threads_change_no_answer() {
    let folder = tempfile::tempdir().unwrap();
    record_brake(folder.path());
    let request = |threads: usize| Request {
        model: "brake-hydraulics".into(),
        recordings: folder.path().into(),
        threads,
        ..Request::default()
    };
    let (json, page, diagnosis) = written(&request(1));
    assert!(page.contains("Simulated for this: ") && diagnosis.simulated > 100.0, "{}", diagnosis.simulated);
    let (again, same_page, _) = under_load(|| written(&request(3)));
    assert_eq!(json, again);
    assert!(page == same_page, "the pages differ");
    // something was looked for, found and fitted
    assert!(diagnosis.candidates.len() > 1 && !diagnosis.findings.is_empty(), "{json}");
}

#[test]
fn friction_at_the_reference_pressure_is_fitted() {
    let subject = Subject::load("ring-brush-flat-track", &Settings::default()).unwrap();
    let find = |name: &str| subject.interface.index(name).unwrap();
    let bench = Bench::new(&subject.factory, &subject.fixed, 2).unwrap();
    // one second from free rolling to a wheel that nearly locks, under a load that moves
    let truth = 0.8;
    let setup = Setup { values: vec![(find("friction_sliding_reference"), truth)], attachments: Vec::new() };
    let measured: Vec<usize> = vec![find("force_x"), find("force_z")];
    let watch: Arc<[usize]> = measured.clone().into();
    let runs: Vec<Run> = [0.016, 0.02]
        .iter()
        .map(|deflection| {
            let points = 501;
            let slip = (0..points).map(|k| -0.8 * k as f64 / (points - 1) as f64).collect();
            let load = |k: usize| deflection + 0.004 * (TAU * 4e-3 * k as f64).sin();
            let mut inputs = vec![
                (find("deflection"), (0..points).map(load).collect()),
                (find("path_speed"), vec![10.0; points]),
                (find("slip"), slip),
            ];
            inputs.sort_by_key(|i| i.0);
            let drive = Arc::new(Drive::new(0.0, 2e-3, points, inputs));
            let traces =
                bench.run(&[Arc::new(setup.clone())], &[Arc::clone(&drive)], &watch).pop().unwrap().unwrap();
            let channels = measured.iter().zip(traces).map(|(v, values)| Channel {
                variable: *v,
                values,
                counts: false,
                unresolved: Vec::new(),
            });
            Run {
                name: deflection.to_string(),
                time: (0..points).map(|k| drive.time(k)).collect(),
                drive,
                channels: channels.collect(),
            }
        })
        .collect();
    let all: Vec<&Run> = runs.iter().collect();
    let mut study = Study {
        bench: &bench,
        weights: super::weights::first_weights(&all),
        fit_runs: all.clone(),
        check_runs: all,
        values: Vec::new(),
        of_changes: None,
        closeness: Closeness::Precisely,
        free: Vec::new(),
        lag: 0.0,
        zeros: Vec::new(),
        redundancy: 1.0,
    };
    study.choose_free(&subject.free).unwrap();
    let place = study.free.iter().position(|p| p.variable == find("friction_sliding_reference"));
    let fitted = study.fit(&study.nominal(), 8).unwrap();
    let value = fitted.model.parameters[place.unwrap()];
    // from 1.0 at least half of the way: friction at no pressure does a part of the same
    assert!(value < 0.9 && value > 0.7, "{value}");

    // near it, longer steps and what they leave out there tell as much as the model's own; by themselves they do not
    study.of_changes = Some((find("step_size"), 1e-3));
    let rough = study.roughly();
    let near = study.near(&fitted);
    let all = study.fit_runs.clone();
    let at = |study: &Study<'_>, moved: f64| {
        let mut point = Study::point(&fitted.model);
        point[place.unwrap()] += moved;
        DVector::from_vec(study.problem(&fitted.model, all.clone()).residuals(&[point]).remove(0).unwrap())
    };
    let off = |other: &Study<'_>, moved: f64| (at(other, moved) - at(&study, moved)).norm();
    let left_out = off(&rough, 0.0);
    assert!(left_out > 0.0 && off(&near, 0.0) < 1e-9 * left_out, "{left_out}");
    let (wrong, change) = (off(&near, 0.02), (at(&study, 0.02) - at(&study, 0.0)).norm());
    // a wheel that nearly locks is where steps matter most
    assert!(wrong < 0.1 * change && wrong < 0.5 * off(&rough, 0.02), "{wrong} of {change}");
}

/// A shipped brake behind a sine of the driver's pressure.
struct Brake {
    subject: Subject,
    bench: Bench,
    torque: usize,
    drive: Arc<Drive>,
}

impl Brake {
    /// With so many communication points, a millisecond apart, and this amplitude of the pressure \[Pa\].
    fn behind(points: usize, amplitude: f64) -> Self {
        let subject = Subject::load("brake-hydraulics", &Settings::default()).unwrap();
        let bench = Bench::new(&subject.factory, &subject.fixed, 2).unwrap();
        let find = |name: &str| subject.interface.index(name).unwrap();
        let course = (0..points).map(|k| 4e6 + amplitude * (0.02 * k as f64).sin()).collect();
        let inputs = vec![(find("driver_pressure"), course)];
        let drive = Arc::new(Drive::new(0.0, 1e-3, points, inputs));
        Self { torque: find("brake_torque"), subject, bench, drive }
    }

    /// Its torque, with some values set.
    fn torque(&self, values: Vec<(usize, f64)>) -> Vec<f64> {
        let setup = Arc::new(Setup { values, ..Setup::default() });
        let traces = self.bench.run(&[setup], &[Arc::clone(&self.drive)], &Arc::from([self.torque]));
        traces.into_iter().next().unwrap().unwrap().remove(0)
    }

    /// A run with these values of the torque.
    fn run(&self, values: Vec<f64>) -> Run {
        Run {
            name: String::new(),
            time: (0..self.drive.points).map(|k| self.drive.time(k)).collect(),
            drive: Arc::clone(&self.drive),
            channels: vec![Channel { variable: self.torque, values, counts: false, unresolved: Vec::new() }],
        }
    }

    /// A run that is fitted to and checked with, nothing free, and its torque weighed by this noise.
    fn study<'a>(&'a self, run: &'a Run, noise: f64) -> Study<'a> {
        Study {
            bench: &self.bench,
            fit_runs: vec![run],
            check_runs: vec![run],
            values: Vec::new(),
            of_changes: None,
            closeness: Closeness::Precisely,
            free: Vec::new(),
            lag: 0.0,
            zeros: Vec::new(),
            weights: vec![1.0 / noise],
            redundancy: 1.0,
        }
    }
}

#[test]
fn what_only_changes_outputs_or_the_lag_is_not_simulated_again() {
    let points = 1001;
    let brake = Brake::behind(points, 1e6);
    let Brake { subject, bench, torque, drive } = &brake;
    let (torque, find) = (*torque, |name: &str| subject.interface.index(name).unwrap());
    let (pressure, friction) = (find("driver_pressure"), find("friction"));
    let run = brake.run(vec![0.0; points]);
    // one with a memory and the rate of what it changes, behind one that an input drives
    let attachment = |id: &str, drivers: Vec<Signal>, parameters: &[f64]| Attachment {
        effect: find_effect(id).unwrap(),
        target: torque,
        drivers,
        parameters: parameters
            .iter()
            .map(|value| Chosen { value: *value, range: FREE, unit: None })
            .collect(),
    };
    let driven = Signal::value(pressure);
    let attachments =
        vec![attachment("cross-talk", vec![driven], &[1e-5]), attachment("sensor-lag", vec![], &[0.02])];
    let problem = OutputError {
        bench,
        runs: vec![&run],
        knobs: vec![
            Knob::Parameter(friction, 1.0),
            Knob::Lag(1e-3),
            Knob::Effect { first: 1, end: 2, parameter: 0, scale: 1.0, logarithmic: false },
        ],
        values: Vec::new(),
        attachments,
        weights: vec![1.0],
        of_changes: None,
        is_coarse: false,
        beside: None,
        kept: std::sync::Mutex::default(),
    };
    let point = vec![0.4, 0.0, 0.02];
    let first = problem.simulate(std::slice::from_ref(&point)).pop().unwrap().unwrap();
    // as the effects do inside the slave, to rounding
    let inside = bench.run(&[Arc::new(problem.setup(&point))], &[Arc::clone(drive)], &Arc::from([torque]));
    let inside = &inside[0].as_ref().unwrap()[0];
    let size = inside.iter().copied().fold(0.0, f64::max);
    assert!(first[0][0].iter().zip(inside).all(|(a, b)| (a - b).abs() < 1e-9 * size));
    let before = bench.simulated();
    assert!((before - 2.0).abs() < 1e-6, "{before}");
    let moved = problem.simulate(&[vec![0.4, 1.0, 0.02], vec![0.4, 0.0, 0.03]]);
    assert!(moved.iter().all(|answer| answer.as_ref().unwrap()[0][0] != first[0][0]));
    assert_eq!(bench.simulated(), before);
    problem.simulate(&[vec![0.41, 0.0, 0.02]]);
    assert!((bench.simulated() - before - 1.0).abs() < 1e-6);
}

#[test]
fn what_is_locked_to_a_wheel_has_its_phase_from_the_recorded_angle() {
    let subject = Subject::load("magic-formula-flat-track", &Settings::default()).unwrap();
    let find = |name: &str| subject.interface.index(name).unwrap();
    let [force, angle, speed] = ["force_x", "wheel_angle", "wheel_speed"].map(find);
    let bench = Bench::new(&subject.factory, &subject.fixed, 2).unwrap();
    let (points, begin) = (501, 2.0);
    let slip = (0..points).map(|k| -0.05 * (0.02 * k as f64).sin()).collect();
    let inputs = vec![(find("path_speed"), vec![10.0; points]), (find("slip"), slip)];
    let drive = Arc::new(Drive {
        start: 0.0,
        step: 2e-3,
        inputs,
        begins: vec![(angle, begin)],
        earlier: Arc::default(),
        points,
        coarser: None,
    });
    let watch: Arc<[usize]> = Arc::from([force, angle, speed]);
    let run_one = |attachments: Vec<Attachment>| {
        let setup = Setup { values: Vec::new(), attachments };
        bench.run(&[Arc::new(setup)], &[Arc::clone(&drive)], &watch).pop().unwrap().unwrap()
    };
    let signal = Signal::value;
    let (a, b) = (0.03, -0.02);
    let imbalance = Attachment {
        effect: find_effect("imbalance").unwrap(),
        target: force,
        drivers: vec![signal(angle), signal(speed)],
        parameters: [a, b].map(|value| Chosen { value, range: FREE, unit: None }).to_vec(),
    };
    let without = run_one(Vec::new());
    assert!(without[1][0].abs() < 1e-9, "the model's wheel begins at {}", without[1][0]);
    let with = run_one(vec![imbalance.clone()]);
    let replayed = replay(&imbalance, &without[0], &drive, &watch, &without).unwrap();
    for k in 0..points {
        let theta = without[1][k] + begin;
        let added = without[2][k].powi(2) * (a * theta.cos() + b * theta.sin());
        assert!((with[0][k] - without[0][k] - added).abs() < 1e-6, "{k}");
        assert!((with[0][k] - replayed[k]).abs() < 1e-6, "{k}");
    }
}

#[test]
fn a_small_zero_of_a_sensor_is_fitted_and_one_that_shows_is_left_to_an_effect() {
    let points = 1001;
    let brake = Brake::behind(points, 3e6);
    let simulated = brake.torque(Vec::new());
    let (least, most) =
        (simulated.iter().copied().fold(1e9, f64::min), simulated.iter().copied().fold(0.0, f64::max));
    let span = most - least;
    let noise = 0.002 * span;
    let zeros_with = |offset: f64| {
        let mut random = SplitMix64::new(6);
        let run = brake.run(simulated.iter().map(|t| t + offset + noise * random.normal()).collect());
        let mut study = brake.study(&run, noise);
        study.zeros = super::zeros::zeros(&[&run]);
        let fitted = study.fit(&study.nominal(), 8).unwrap();
        let rest = study.fit_rest(&fitted).unwrap();
        let most = study.zeros[0].1;
        let dropped = study.drop_visible_zeros(&fitted, &rest);
        assert_eq!(study.zeros.is_empty(), dropped);
        (fitted.model.parameters[1] * most, dropped)
    };
    // twice the noise, 0.4 % of the span: found to the noise over the root of the samples
    let (zero, dropped) = zeros_with(2.0 * noise);
    assert!((zero - 2.0 * noise).abs() < 4.0 * noise / (points as f64).sqrt() && !dropped, "{zero}");
    // more than three times the noise shows, and so does what is beyond 2 % of the span
    assert!(zeros_with(4.0 * noise).1);
    assert!(zeros_with(-0.05 * span).1);
}

#[test]
fn what_a_fit_has_missed_is_no_missing_physics() {
    let brake = Brake::behind(501, 1e6);
    let friction = brake.subject.interface.index("friction").unwrap();
    let free = brake.subject.free.iter().find(|p| p.variable == friction).unwrap();
    let with = |share: f64| brake.torque(vec![(friction, share * free.nominal)]);
    let noise = 1e-3 * with(1.0).into_iter().fold(0.0, f64::max);
    let mut random = SplitMix64::new(8);
    let run = brake.run(with(1.2).into_iter().map(|t| t + noise * random.normal()).collect());
    let study = Study { free: vec![free.clone()], ..brake.study(&run, noise) };
    let found = |current: Fitted| {
        let rest = study.rest(&current.model, &study.check_runs).unwrap();
        Found::nothing(current, rest)
    };
    // where the fit has not moved at all, a gain of the sensor takes a part of what is wrong with the friction
    let stuck = study.fit(&study.nominal(), 1).unwrap();
    let mut model = stuck.model.clone();
    let effect = find_effect("sensor-gain").unwrap();
    let gain = Placement {
        effect,
        port: Port::Output,
        targets: vec![brake.torque],
        drivers: Vec::new(),
        scales: vec![1.0; effect.parameters.len()],
        units: vec![None; effect.parameters.len()],
        bounded: false,
    };
    model.effects.push((gain, vec![0.01]));
    let named = study.fit(&model, 12).unwrap();
    assert!(named.model.effects[0].1[0] > 0.05 && named.fit.cost < 0.01 * stuck.fit.cost);
    let put_right = without(&study, &named, &found(stuck)).unwrap();
    assert!(put_right.model.effects.is_empty() && put_right.fit.cost < 1.01 * named.fit.cost);
    assert!((put_right.model.parameters[0] * free.scale / free.nominal - 1.2).abs() < 1e-3);
    // a model that was fitted to its end stays
    assert!(without(&study, &named, &found(put_right)).is_none());
}

#[test]
fn a_refit_that_has_used_up_its_iterations_comes_to_its_end() {
    let brake = Brake::behind(501, 1e6);
    let friction = brake.subject.interface.index("friction").unwrap();
    let free = brake.subject.free.iter().find(|p| p.variable == friction).unwrap();
    let torque = brake.torque(vec![(friction, 1.2 * free.nominal)]);
    let noise = 1e-3 * torque.iter().copied().fold(0.0, f64::max);
    let mut random = SplitMix64::new(9);
    let run = brake.run(torque.into_iter().map(|t| t + noise * random.normal()).collect());
    let mut study = Study { free: vec![free.clone()], ..brake.study(&run, noise) };
    // far to the other side of where it is given
    let mut far = study.nominal();
    far.parameters[0] *= 0.6;
    let short = study.fit(&far, 1).unwrap();
    assert_eq!(short.fit.end, End::Iterations);
    let share = |fitted: &Fitted| fitted.model.parameters[0] * free.scale / free.nominal;
    assert!(share(&short) < 1.0);
    let ended = from_two_places(&mut study, short).unwrap();
    assert!(ended.fit.end != End::Iterations && (share(&ended) - 1.2).abs() < 1e-3, "{}", share(&ended));
    // and the channel counts in multiples of its own noise
    assert!((study.weights[0] * noise - 1.0).abs() < 0.1, "{}", study.weights[0] * noise);
}

#[test]
fn what_inputs_may_be_off_by_is_taken_off_and_no_more() {
    let brake = Brake::behind(501, 1e6);
    let left = |off: f64| {
        let mut other = Brake::behind(501, 1e6);
        let scaled = |(v, values): &(usize, Vec<f64>)| (*v, values.iter().map(|x| x * (1.0 + off)).collect());
        let inputs = other.drive.inputs.iter().map(scaled).collect();
        other.drive = Arc::new(Drive { inputs, coarser: None, ..Drive::clone(&other.drive) });
        let run = brake.run(other.torque(Vec::new()));
        let study = brake.study(&run, 1.0);
        let model = study.nominal();
        let before = study.rest(&model, &[&run]).unwrap();
        let after = within_precision(&study, &model, &[&run], &before).unwrap();
        (after.total / before.total).sqrt()
    };
    // half of what it may be, in either direction, is all of it; of ten times as much nine tenths stay
    assert!(left(5e-5) < 0.01 && left(-5e-5) < 0.01);
    let most = left(1e-3);
    assert!((most - 0.9).abs() < 0.005, "{most}");
}

#[test]
fn below_what_is_not_resolved_there_is_nothing_to_win() {
    let brake = Brake::behind(480, 1e6);
    let torque = brake.torque(Vec::new());
    // off by 2 in the first half, and by 2 in the second, of which 5 are not resolved
    let mut run = brake.run(torque.iter().map(|v| v + 2.0).collect());
    run.channels[0].unresolved = (0..480).map(|k| if k < 240 { 0.0 } else { 5.0 }).collect();
    let study = brake.study(&run, 1.0);
    let runs = [&run];
    let rest = |off: f64| study.rest_with(&runs, vec![vec![torque.iter().map(|v| v + off).collect()]]);
    let (before, after) = (rest(0.0), rest(2.0));
    let blocks = before.blocks.len();
    assert!(blocks > 4 && blocks.is_multiple_of(2));
    let each = 480.0 / blocks as f64;
    for (k, (before, after)) in before.blocks.iter().zip(&after.blocks).enumerate() {
        let expected = if k < blocks / 2 { (4.0 * each, 0.0) } else { (25.0 * each, 25.0 * each) };
        assert!((before[0] - expected.0).abs() < 1e-6 && (after[0] - expected.1).abs() < 1e-6, "{k}");
    }
    // fits see all of it
    assert!((before.cost - 4.0 * 480.0).abs() < 1e-6 && after.cost < 1e-6);
    // and whoever makes it worse than it may be has made it worse
    assert!(rest(-8.0).blocks[blocks - 1][0] > 90.0 * each);
}

#[test]
fn two_names_at_one_place_are_one_function_unless_they_say_more() {
    let (points, amplitude) = (1001, 3e6);
    let brake = Brake::behind(points, amplitude);
    let pressure = brake.drive.inputs[0].0;
    // the rate of the pressure goes both ways
    let rate = Signal { variable: pressure, source: Source::Rate, is_turned: false };
    let (most, size) = (0.02 * amplitude / 1e-3, 0.1 * amplitude);
    let slope = size / most;
    let place = |id: &str, port: Port, scales: &[f64]| Placement {
        effect: find_effect(id).unwrap(),
        port,
        targets: vec![pressure],
        drivers: vec![rate],
        scales: scales.to_vec(),
        units: vec![None; scales.len()],
        bounded: false,
    };
    let clearance = || place("clearance", Port::Force, &[slope, most]);
    let stop = || place("bump-stop", Port::Force, &[slope, slope, most]);
    let powers = [slope, slope / most, slope / most / most, slope, size, most];
    let any = || place("empirical-input", Port::Input, &powers);
    let is_one = |law: &dyn Fn(f64) -> f64| {
        let mut real = Brake::behind(points, amplitude);
        let given = &brake.drive.inputs[0].1;
        let x = |k: usize| if k == 0 { 0.0 } else { (given[k] - given[k - 1]) / 1e-3 / most };
        let changed = (0..points).map(|k| given[k] + size * law(x(k))).collect();
        real.drive =
            Arc::new(Drive { inputs: vec![(pressure, changed)], coarser: None, ..Drive::clone(&real.drive) });
        let torque = real.torque(Vec::new());
        let noise = 1e-3 * torque.iter().copied().fold(0.0, f64::max);
        let mut random = SplitMix64::new(4);
        let run = brake.run(torque.into_iter().map(|t| t + noise * random.normal()).collect());
        let study = brake.study(&run, noise);
        let with = |effects: Vec<(Placement, Vec<f64>)>| Model { effects, ..study.nominal() };
        let law = Law {
            placement: clearance(),
            before: study.nominal(),
            name: "Clearance".into(),
            function: Some((Finding::default(), with(vec![(any(), vec![0.0, 0.0, 0.0, 0.0, 0.1, 0.3])]))),
        };
        let both = with(vec![(clearance(), vec![0.5, 0.3]), (stop(), vec![0.5, 0.5, 0.7])]);
        let both = study.fit(&both, 25).unwrap();
        let rest = study.rest(&study.nominal(), &study.check_runs).unwrap();
        let screened = Screened {
            placement: stop(),
            values: Vec::new(),
            wholes: Vec::new(),
            gain: 0.0,
            places: 1,
            all_places: 1,
        };
        let both = assess(&study, &screened, both, Before { fit: &rest, check: &rest }).unwrap();
        assert!(both.fit_gain > 0.9, "{}", both.fit_gain);
        one_function(&study, &[law], &both).unwrap().map(|one| one.finding.evidence)
    };
    // a spring that snaps is neither, though both together follow it
    let snaps = |x: f64| 2.0 * x / 0.8 * (-2.0 * (x / 0.8).powi(2)).exp();
    let said = is_one(&snaps).unwrap();
    assert!(said.contains("\u{201c}Clearance\u{201d}") && said.contains("Bump stop"), "{said}");
    // a gap and a stiff stop on one side, which no smooth function follows
    let knees = |x: f64| 1.5 * x.clamp(-0.2, 0.2) - 10.0 * (x - 0.8).max(0.0);
    assert_eq!(is_one(&knees), None);
}

#[test]
fn a_fit_that_longer_steps_have_led_astray_goes_on_near_where_it_has_come_to() {
    let brake = Brake::behind(501, 1e6);
    let friction = brake.subject.interface.index("friction").unwrap();
    let free = brake.subject.free.iter().find(|p| p.variable == friction).unwrap();
    let every_tenth = |(v, values): &(usize, Vec<f64>)| (*v, values.iter().step_by(10).copied().collect());
    let inputs = brake.drive.inputs.iter().map(every_tenth).collect();
    let coarser = Drive { step: 1e-2, points: 51, inputs, ..Drive::clone(&brake.drive) };
    let drive = Arc::new(Drive { coarser: Some(Arc::new(coarser)), ..Drive::clone(&brake.drive) });
    let of_values = |values: Vec<f64>| Run { drive: Arc::clone(&drive), ..brake.run(values) };
    let placement = Placement {
        effect: find_effect("sensor-gain").unwrap(),
        port: Port::Output,
        targets: vec![brake.torque],
        drivers: Vec::new(),
        scales: vec![1.0],
        units: vec![None],
        bounded: false,
    };
    let with = |gain: f64| Model { parameters: vec![0.0], effects: vec![(placement.clone(), vec![gain])] };

    // beside what longer steps leave out of twice the friction, a gain of a thousandth says to explain all that is measured
    let blank = of_values(vec![0.0; 501]);
    let at =
        |share: f64| Study { values: vec![(friction, share * free.nominal)], ..brake.study(&blank, 1.0) };
    let closeness = |study: &Study<'_>| study.near(&study.fit(&study.nominal(), 1).unwrap()).closeness;
    let astray = closeness(&at(1.2));
    let near = Study { closeness: astray.clone(), ..at(0.6) };
    let problem = near.problem(&with(1e-3), near.fit_runs.clone());
    let measured = of_values(problem.residuals(&[Study::point(&with(1e-3))]).remove(0).unwrap());
    let study = Study { fit_runs: vec![&measured], check_runs: vec![&measured], ..at(0.6) };
    let near = Study { closeness: astray, ..study.clone() };

    let current = study.fit(&study.nominal(), 1).unwrap();
    let (fit, check) =
        (study.fit_rest(&current).unwrap(), study.rest(&current.model, &study.check_runs).unwrap());
    let fitted = near.fit_near(&with(1e-4), 8, &current).unwrap();
    let really = study.fit_rest(&fitted).unwrap().cost;
    let best = study.fit(&with(1e-4), 20).unwrap();
    assert!(fitted.fit.cost < 0.01 * really && best.fit.cost < 0.99 * really, "{} {really}", fitted.fit.cost);
    let values = vec![1e-3];
    let screened = Screened { placement, values, wholes: Vec::new(), gain: 0.5, places: 1, all_places: 1 };
    let before = Before { fit: &fit, check: &check };
    let tried = Begun::finish(&[Begun { screened, fitted }], (&study, &near), &current, before).remove(0);
    assert!(
        (tried.fit_rest.cost / best.fit.cost - 1.0).abs() < 1e-6,
        "{} and {}, {really}",
        tried.fit_rest.cost,
        best.fit.cost
    );
    assert!((tried.fitted.fit.cost / tried.fit_rest.cost - 1.0).abs() < 0.01, "{}", tried.fitted.fit.cost);
}
