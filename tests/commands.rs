//! Commands and motions that a master passes: held between communication points or with derivatives,
//! it is the same motion, and the forces meet as the communication step goes to 0. And in reverse.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::{get, set, started};
use latsch::model::{Model, Native, Slave};
use latsch::rig::{RingBrushFlatTrack, RingBrushTire, RingBrushWheel};
use std::f64::consts::TAU;

/// How a master passes a function of time.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Pass {
    Held,
    WithDerivative,
}

/// A course of an input: its name, and value and derivative over time.
type Course<'a> = (&'a str, &'a dyn Fn(f64) -> [f64; 2]);

/// The output at every 10 ms of a run of `end` seconds.
fn run<M: Model>(
    start: &[(&str, f64)],
    courses: &[Course<'_>],
    pass: Pass,
    step: f64,
    end: f64,
    output: &str,
) -> Vec<f64> {
    // the model's own step stays what it is
    let mut slave: Native<M> = started(&[start, &[("step_size", 1e-4)]].concat());
    let every = (0.01 / step).round() as u32;
    let mut values = Vec::new();
    for k in 0..(end / step).round() as u32 {
        let t = f64::from(k) * step;
        for (name, course) in courses {
            let [value, derivative] = course(t);
            set(&mut slave, &[(name, value)]);
            if pass == Pass::WithDerivative {
                let index = slave.find(name).unwrap();
                slave.set_rate(index, derivative).unwrap();
            }
        }
        slave.step(t, f64::from(k + 1) * step - t).unwrap();
        if (k + 1) % every == 0 {
            values.push(get(&mut slave, output));
        }
    }
    values
}

fn rms(a: &[f64], b: &[f64]) -> f64 {
    (a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len() as f64).sqrt()
}

fn sine(amplitude: f64, frequency: f64) -> impl Fn(f64) -> [f64; 2] {
    let omega = TAU * frequency;
    move |t| [amplitude * (omega * t).sin(), amplitude * omega * (omega * t).cos()]
}

/// Differences from the finest run with derivatives over communication steps, for both ways.
fn meet<M: Model>(start: &[(&str, f64)], courses: &[Course<'_>], steps: &[f64], end: f64, output: &str) {
    let finest = steps[steps.len() - 1];
    let reference = run::<M>(start, courses, Pass::WithDerivative, finest, end, output);
    let size = rms(&reference, &vec![0.0; reference.len()]);
    let mut last = [f64::INFINITY; 2];
    for &step in steps {
        let errors = [Pass::Held, Pass::WithDerivative]
            .map(|pass| rms(&run::<M>(start, courses, pass, step, end, output), &reference));
        println!(
            "{} {output}: {size:.0} N, at {step} s held {:.2}, with derivatives {:.2}",
            M::NAME,
            errors[0],
            errors[1]
        );
        assert!(
            errors[0] < 0.7 * last[0] || errors[0] < 1e-3 * size,
            "held: {} after {}",
            errors[0],
            last[0]
        );
        assert!(errors[1] <= errors[0].max(1e-3 * size), "with derivatives it is no worse: {errors:?}");
        last = errors;
    }
    assert!(last[0] < 0.005 * size, "they meet: {} N of {size} N", last[0]);
}

const STEPS: [f64; 6] = [10e-3, 5e-3, 2e-3, 1e-3, 0.5e-3, 0.1e-3];

#[test]
fn a_command_moves_the_flat_track_alike_however_it_is_passed() {
    for (frequency, end) in [(1.0, 1.0), (5.0, 0.4)] {
        for actuators in [1.0, 0.0] {
            let start = [("path_speed", 20.0), ("command_actuators", actuators)];
            meet::<RingBrushFlatTrack>(
                &start,
                &[("slip_angle", &sine(0.03, frequency))],
                &STEPS,
                end,
                "force_y",
            );
        }
    }
    // a motion with a velocity of its own
    let start = [("path_speed", 20.0), ("slip", -0.03)];
    let deflection = |t: f64| {
        let [s, c] = sine(0.004, 5.0)(t);
        [0.02 + s, c]
    };
    meet::<RingBrushFlatTrack>(&start, &[("deflection", &deflection)], &STEPS[2..], 0.3, "force_z");
}

#[test]
fn a_command_moves_the_wheel_alike_however_it_is_passed() {
    for actuators in [1.0, 0.0] {
        let start = [("initial_speed", 20.0), ("command_actuators", actuators)];
        let (steer, camber) = (sine(0.01, 2.0), sine(0.05, 2.0));
        meet::<RingBrushWheel>(&start, &[("steer", &steer)], &STEPS[2..], 0.4, "force_y");
        meet::<RingBrushWheel>(&start, &[("camber", &camber)], &STEPS[2..], 0.4, "force_y");
    }
}

/// A plane that pitches, rolls and heaves under a rolling tire.
#[test]
fn a_plane_moves_the_bare_tire_alike_however_it_is_passed() {
    let speed = 10.0;
    let start = [("rim_velocity_x", speed)];
    let pitch = sine(0.05, 3.0);
    let roll = sine(0.04, 3.0);
    // the plane turns about a point that travels with the wheel
    let place = |t: f64| [speed * t, speed];
    for (slope, course) in [("road_slope_x", &pitch as &dyn Fn(f64) -> [f64; 2]), ("road_slope_y", &roll)] {
        for output in ["global_force_x", "global_force_y"] {
            if (slope == "road_slope_x") != (output == "global_force_x") {
                continue;
            }
            meet::<RingBrushTire>(&start, &[("road_x", &place), (slope, course)], &STEPS[1..], 0.4, output);
        }
    }
}

/// A rim that speeds up and is told so: positions are x + v t + a t²/2 between communication points.
#[test]
fn a_pose_runs_on_with_the_derivative_of_its_velocity() {
    let mut tire: Native<RingBrushTire> = started(&[("rim_velocity_x", 10.0)]);
    let [velocity, place, spin] =
        ["rim_velocity_x", "rim_x", "rim_spin"].map(|name| tire.find(name).unwrap());
    tire.set(velocity, 10.0).unwrap();
    tire.set_rate(velocity, 6.0).unwrap();
    // any cut of the time gives the same bits
    let mut cut: Native<RingBrushTire> = started(&[("rim_velocity_x", 10.0)]);
    cut.set(velocity, 10.0).unwrap();
    cut.set_rate(velocity, 6.0).unwrap();
    tire.step(0.0, 0.05).unwrap();
    for k in 0..50 {
        let t = f64::from(k) * 1e-3;
        cut.step(t, f64::from(k + 1) * 1e-3 - t).unwrap();
    }
    for slave in [&mut tire, &mut cut] {
        let x = slave.get(place).unwrap();
        assert!((x - (10.0 * 0.05 + 0.5 * 6.0 * 0.05 * 0.05)).abs() < 1e-12, "{x}");
        let angle = slave.get(spin).unwrap();
        assert!((angle - 10.0 / 0.328 * 0.05).abs() < 1e-9, "{angle}");
    }
    for name in ["global_force_x", "global_force_z"] {
        assert_eq!(get(&mut tire, name), get(&mut cut, name), "{name}");
    }
    // held from here on, the place runs straight
    tire.set(velocity, 10.3).unwrap();
    tire.step(0.05, 0.01).unwrap();
    let x = tire.get(place).unwrap();
    assert!((x - (0.5075 + 0.103)).abs() < 1e-12, "{x}");
}

/// One meaning of slip and slip angle on all rigs and in both directions of travel: a positive slip pushes
/// forward, a positive slip angle to the right, and the wheel reports what the flat track is told.
#[test]
fn slip_and_slip_angle_mean_the_same_forward_and_in_reverse_on_all_rigs() {
    for speed in [10.0, -10.0] {
        for (slip, slip_angle) in [(0.02, 0.0), (-0.02, 0.0), (0.0, 0.02), (0.0, -0.02), (0.02, 0.02)] {
            let start = [("path_speed", speed), ("slip", slip), ("slip_angle", slip_angle)];
            let mut rig: Native<RingBrushFlatTrack> = started(&start);
            let (fx, fy) = (get(&mut rig, "force_x"), get(&mut rig, "force_y"));
            assert!(slip == 0.0 || fx * slip > 0.0, "{speed} {slip}: {fx}");
            assert!(slip_angle == 0.0 || fy * slip_angle < 0.0, "{speed} {slip_angle}: {fy}");
        }
        // a wheel that a brake holds
        let locked = -speed.signum();
        let mut rig: Native<RingBrushFlatTrack> = started(&[("path_speed", speed), ("slip", locked)]);
        assert_eq!(get(&mut rig, "wheel_speed"), 0.0);
        let mut wheel: Native<RingBrushWheel> = started(&[("initial_speed", speed), ("brake_torque", 1e4)]);
        common::advance(&mut wheel, 1e-3, 0, 30);
        assert_eq!((get(&mut wheel, "wheel_speed"), get(&mut wheel, "slip")), (0.0, locked));
        assert!(get(&mut rig, "force_x") * speed < 0.0 && get(&mut wheel, "force_x") * speed < 0.0);
        // a wheel that is pushed to its left
        let mut wheel: Native<RingBrushWheel> =
            started(&[("initial_speed", speed), ("axle_force_y", 1000.0)]);
        common::advance(&mut wheel, 1e-3, 0, 1500);
        let angle = get(&mut wheel, "slip_angle");
        assert!(angle > 0.0 && get(&mut wheel, "force_y") < -500.0, "{speed}: {angle}");
        let slip = get(&mut wheel, "slip");
        let mut rig: Native<RingBrushFlatTrack> = started(&[
            ("path_speed", speed),
            ("slip_angle", angle),
            ("slip", slip),
            ("deflection", 0.338 - get(&mut wheel, "position_z")),
        ]);
        let [there, here] = [get(&mut wheel, "force_y"), get(&mut rig, "force_y")];
        assert!(
            (there / here - 1.0).abs() < 0.1,
            "{speed}: {there} N on the wheel, {here} N on the flat track"
        );
    }
}
