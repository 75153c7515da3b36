use super::*;
use crate::hidden::{Hidden, Law};
use crate::programme::{self, EVERYTHING, Sampling};
use crate::random::Random;
use crate::simulate::STEP;

fn world(hidden: Vec<Hidden>) -> World {
    World { base: Base::FlatTrack, parameters: Base::FlatTrack.defaults(), hidden, filter: 1e-9 }
}

/// An effect on this channel with a form of 0.5.
fn hidden(law: Law, size: f64, channel: usize) -> Hidden {
    Hidden { id: "", law, size, channel, other: 1, form: [0.5; 3], seed: 3 }
}

/// A run at 200 Hz with these commands.
fn run_of(duration: f64, command: impl Fn(f64) -> [f64; 5]) -> Run {
    let time: Vec<f64> = (0..).map(|k| f64::from(k) * 0.005).take_while(|t| *t <= duration).collect();
    let inputs = (0..5).map(|i| time.iter().map(|t| command(*t)[i]).collect()).collect();
    Run { time, inputs }
}

fn drawn(index: usize, duration: f64) -> Run {
    let sampling = Sampling { rate: 200.0, duration, jitter: 0.03 };
    programme::draw(Base::FlatTrack, &mut Random::new(5, index as u64), &sampling, &EVERYTHING, index, 1.0)
}

fn rms(a: &[f64], b: &[f64]) -> f64 {
    let square = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
    (square / a.len() as f64).sqrt()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The shipped model as anyone would run it: from sample to sample, with this step of its own.
fn shipped(run: &Run, step: f64) -> Vec<Vec<f64>> {
    let mut slave = Native::<RingBrushFlatTrack>::new(&Settings::default()).unwrap();
    let find = |slave: &Native<RingBrushFlatTrack>, row: &Row| slave.find(row.0).unwrap();
    let inputs: Vec<usize> = INPUTS.iter().map(|row| find(&slave, row)).collect();
    let outputs: Vec<usize> = OUTPUTS.iter().map(|row| find(&slave, row)).collect();
    let variable = slave.find("step_size").unwrap();
    slave.set(variable, step).unwrap();
    // recorded are motions
    let variable = slave.find("command_actuators").unwrap();
    slave.set(variable, 0.0).unwrap();
    for (variable, values) in inputs.iter().zip(&run.inputs) {
        slave.set(*variable, values[0]).unwrap();
    }
    slave.start(0.0, None).unwrap();
    slave.finish_start().unwrap();
    let mut all: Vec<Vec<f64>> = outputs.iter().map(|v| vec![slave.get(*v).unwrap()]).collect();
    for k in 1..run.time.len() {
        let span = run.time[k] - run.time[k - 1];
        for (variable, values) in inputs.iter().zip(&run.inputs) {
            slave.set(*variable, values[k - 1]).unwrap();
            slave.set_rate(*variable, (values[k] - values[k - 1]) / span).unwrap();
        }
        slave.step(run.time[k - 1], span).unwrap();
        for (variable, values) in outputs.iter().zip(&mut all) {
            values.push(slave.get(*variable).unwrap());
        }
    }
    all
}

#[test]
fn with_nothing_hidden_it_is_the_shipped_model() {
    let mut slave = Native::<RingBrushFlatTrack>::new(&Settings::default()).unwrap();
    slave.start(0.0, None).unwrap();
    slave.finish_start().unwrap();
    let usual_step = slave.get(slave.find("step_size").unwrap()).unwrap();
    // with errors in proportion to the step h, of either sign: those of 0.08 ms and h differ by 1.16 e h at most where h is
    // 0.5 ms, those of h / 2 and h by e h / 2 at least
    let most = 2.0 * (1.0 + FINE / usual_step);
    for index in [4, 5] {
        let run = drawn(index, 2.0);
        let truth = world(vec![]).run(&run, 0, STEP);
        let (usual, half) = (shipped(&run, usual_step), shipped(&run, 0.5 * usual_step));
        for (c, row) in OUTPUTS.iter().enumerate() {
            let (off, error) = (rms(&truth.outputs[c], &usual[c]), rms(&half[c], &usual[c]));
            assert!(
                off <= most * error + 1e-9 * row.2,
                "{} of run {index}: {off}, convergence {error}",
                row.0
            );
            // and that is less than the least noise, a share of the spread
            assert!(off < LEAST_NOISE * row.2, "{} of run {index}: {off}", row.0);
        }
        assert_eq!(truth.inputs.len(), INPUTS.len());
    }
}

#[test]
fn effects_of_no_size_change_nothing() {
    let run = drawn(9, 0.5);
    let without = world(vec![]).run(&run, 0, 1e-3);
    let all = OFFERS.iter().chain(&OUTSIDE);
    for offer in all {
        for (share, changes) in [(0.0, false), (1.0, true)] {
            let with = world(vec![hidden(offer.law, share, offer.channels[0])]).run(&run, 0, 1e-3);
            assert_eq!(with.inputs, without.inputs);
            let off = |c: usize| rms(&with.outputs[c], &without.outputs[c]) / OUTPUTS[c].2;
            let largest = (0..OUTPUTS.len()).map(off).fold(0.0, f64::max);
            assert_eq!(largest > 1e-9, changes, "{}: {largest}", offer.id);
        }
    }
}

#[test]
fn a_slip_angle_that_is_off_moves_the_place_where_the_side_force_is_zero() {
    let with =
        |angle: f64, hidden| world(hidden).run(&run_of(0.3, |_| [12.0, 0.018, angle, 0.0, 0.0]), 0, STEP);
    let offset = 1.7 * 0.01;
    let (there, none) = (with(-offset, vec![hidden(Law::SideSlip, 1.7, 1)]), with(0.0, vec![]));
    for (a, b) in there.outputs.iter().zip(&none.outputs) {
        assert!(rms(a, b) < 1e-6);
    }
    // without turning the wheel it pulls, and by ISO 8855 to the right
    let here = with(0.0, vec![hidden(Law::SideSlip, 1.7, 1)]);
    assert!(mean(&here.outputs[1]) < -500.0, "{}", mean(&here.outputs[1]));
}

#[test]
fn a_relaxation_is_a_distance_and_not_a_time() {
    for (speed, size) in [(8.0, 1.0), (16.0, 1.0), (16.0, 2.0)] {
        let ramp = run_of(1.5, |t| [speed, 0.018, 0.01 * t, 0.0, 0.0]);
        let (with, without) = (
            world(vec![hidden(Law::Relaxation, size, 2)]).run(&ramp, 0, 1e-3),
            world(vec![]).run(&ramp, 0, 1e-3),
        );
        // behind a ramp it is late by length over speed
        let end = 200..300;
        let behind = mean(&with.outputs[1][end.clone()]) - mean(&without.outputs[1][end]);
        let slope = (mean(&without.outputs[1][250..300]) - mean(&without.outputs[1][200..250])) / 0.25;
        let distance = -behind / slope * speed;
        assert!((distance / (0.4 * size) - 1.0).abs() < 0.1, "{distance} m at {speed} m/s");
    }
}

#[test]
fn at_constant_power_heat_comes_near_what_leaves_it() {
    let world = world(vec![hidden(Law::Thermal, 1.0, 1)]);
    let at = Ports { slide_power: 2000.0, ..Ports::default() };
    let mut beside = Beside::start(&world, &at, 0);
    let (dt, stay, capacity) = (2e-3, 12.0, 1.85e4);
    for _ in 0..5000 {
        beside.advance(&world, (&at, &at), dt);
    }
    let expected = 2000.0 / capacity * stay * -libm::expm1(-10.0 / stay);
    let heat = beside.states[0][0];
    assert!((heat / expected - 1.0).abs() < 1e-6, "{heat} {expected}");
    let friction = beside.influence(&world, &at).friction;
    assert!((friction - (1.0 - 0.3 * expected)).abs() < 1e-6, "{friction}");
}

#[test]
fn a_locked_wheel_slides_with_the_friction_of_its_speed() {
    for speed in [2.0, 10.0] {
        let locked = run_of(0.5, |_| [speed, 0.018, 0.0, -1.0, 0.0]);
        let (with, without) = (
            world(vec![hidden(Law::SpeedFriction, 1.0, 1)]).run(&locked, 0, 1e-3),
            world(vec![]).run(&locked, 0, 1e-3),
        );
        // the force of a patch that slides as a whole is the friction times the load
        let coefficient = |ideal: &Ideal| mean(&ideal.outputs[0][50..]) / mean(&ideal.outputs[2][50..]);
        let factor = coefficient(&with) / coefficient(&without);
        let expected = 1.0 - 0.3 * (1.0 - libm::exp(-speed / 1.55));
        assert!((factor - expected).abs() < 0.02, "{factor} {expected}");
    }
}

#[test]
fn a_delay_of_one_interval_brings_the_sample_before() {
    let run = run_of(0.6, |t| [15.0, 0.018, 0.03 * libm::sin(8.0 * t), 0.0, 0.0]);
    let (with, without) =
        (world(vec![hidden(Law::Delay, 1.0, 1)]).run(&run, 0, STEP), world(vec![]).run(&run, 0, STEP));
    let n = run.time.len();
    assert!(rms(&with.outputs[1][1..], &without.outputs[1][..n - 1]) < 1e-3);
    assert_eq!(with.outputs[0], without.outputs[0]);
}

#[test]
fn the_programme_stays_where_the_tire_is_good() {
    for index in 0..10 {
        let run = drawn(index, 2.0);
        let ideal = world(vec![]).run(&run, 0, 1e-3);
        assert!(ideal.outputs.iter().flatten().all(|v| v.is_finite()), "{index}");
        // it never loses the ground
        assert!(ideal.outputs[2].iter().all(|load| *load > 100.0), "{index}");
    }
}

#[test]
fn a_study_has_every_kind_that_was_asked_for() {
    for seed in 0..20 {
        let cases = draw_cases(&mut Random::new(seed, 0));
        let count = |is: fn(&Concealed) -> bool| cases.iter().filter(|c| is(c)).count();
        assert_eq!(count(|c| matches!(c, Concealed::Clear(_))), 21);
        assert_eq!(count(|c| matches!(c, Concealed::Faint(_))), 7);
        assert_eq!(count(|c| matches!(c, Concealed::Parameters)), 7);
        assert_eq!(count(|c| matches!(c, Concealed::Outside(_))), 7);
    }
}
