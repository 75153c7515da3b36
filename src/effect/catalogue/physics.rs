//! Each effect against its closed form.

use super::tests::run;
use crate::effect::{Effect, find, forms};
use std::f64::consts::{E, PI, TAU};

fn effect(id: &str) -> &'static Effect {
    find(id).unwrap()
}

/// The changed number along courses of time, `n` equal steps after the start.
fn along(id: &str, p: &[f64], dt: f64, n: usize, course: impl Fn(f64) -> (f64, [f64; 3])) -> Vec<f64> {
    let points: Vec<_> = (0..=n)
        .map(|i| {
            let (target, drivers) = course(i as f64 * dt);
            (dt, target, drivers)
        })
        .collect();
    run(effect(id), p, &points)
}

/// What an effect makes of one point that does not move.
fn at(id: &str, p: &[f64], target: f64, drivers: [f64; 3]) -> f64 {
    run(effect(id), p, &[(0.0, target, drivers)])[0]
}

fn close(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance, "{a} is not {b}");
}

/// The area of a loop: y over x.
fn area(x: &[f64], y: &[f64]) -> f64 {
    x.windows(2).zip(y.windows(2)).map(|(x, y)| 0.5 * (y[0] + y[1]) * (x[1] - x[0])).sum()
}

const N: usize = 20_000;

/// The loss of the last of three cycles of x = X sin(w t) under a force effect that is driven by
/// displacement or velocity.
fn loss(id: &str, p: &[f64], amplitude: f64, omega: f64) -> f64 {
    let dt = 3.0 * TAU / omega / (3 * N) as f64;
    let by_velocity = effect(id).drivers[0] == crate::effect::Role::Velocity;
    let place = |t: f64| amplitude * (omega * t).sin();
    let force = along(id, p, dt, 3 * N, |t| {
        (0.0, [if by_velocity { amplitude * omega * (omega * t).cos() } else { place(t) }, 5.0, 0.0])
    });
    let x: Vec<f64> = (0..=3 * N).map(|i| place(i as f64 * dt)).collect();
    -area(&x[2 * N..], &force[2 * N..])
}

/// Cosine and sine part of a course over whole turns.
fn line(y: &[f64], angle: impl Fn(usize) -> f64) -> (f64, f64) {
    let n = (y.len() - 1) as f64;
    let sum = |f: fn(f64) -> f64| (1..y.len()).map(|i| y[i] * f(angle(i))).sum::<f64>() * 2.0 / n;
    (sum(f64::cos), sum(f64::sin))
}

// ------------------------------------------------------------------ loops

#[test]
fn loops_lose_what_their_laws_say() {
    let (x, w) = (0.02, 6.0);
    close(loss("coulomb-friction", &[30.0, 1e-4], x, w), 4.0 * 30.0 * x, 2e-3);
    close(loss("coulomb-friction", &[30.0, 1e-4], x, 10.0 * w), 4.0 * 30.0 * x, 2e-3);
    close(loss("viscous-drag", &[8.0], x, w), PI * 8.0 * w * x * x, 1e-6);
    close(loss("quadratic-damper", &[50.0], x, w), 8.0 / 3.0 * 50.0 * w * w * x.powi(3), 1e-6);
    close(loss("load-dependent-friction", &[0.1, 1e-4], x, w), 4.0 * 0.1 * 5.0 * x, 1e-4);
    // no loss in springs, masses and what is even in the velocity
    for (id, p) in [
        ("progressive-spring", [1e5, 0.0, 0.0]),
        ("asymmetric-spring", [1e4, 0.0, 0.0]),
        ("bump-stop", [1e4, 3e3, 0.01]),
        ("clearance", [1e4, 0.01, 0.0]),
        ("damper-asymmetry", [50.0, 0.0, 0.0]),
    ] {
        close(loss(id, &p, x, w), 0.0, 1e-9);
    }
}

#[test]
fn a_maxwell_element_loses_most_at_its_own_frequency() {
    let (k, time, x) = (500.0, 0.05, 0.03);
    let theory = |w: f64| PI * k * x * x * (w * time) / (1.0 + (w * time).powi(2));
    for w in [2.0, 10.0, 20.0, 40.0, 200.0] {
        close(loss("maxwell-element", &[k, time], x, w), theory(w), 2e-3 * theory(20.0));
    }
    assert!(theory(20.0) > theory(19.0) && theory(20.0) > theory(21.0));
    // stiffness k at once, nothing in the end
    let step =
        along("maxwell-element", &[k, time], 1e-6, 1, |t| (0.0, [if t > 0.0 { x } else { 0.0 }, 0.0, 0.0]));
    close(step[1], -k * x, 1e-3);
}

#[test]
fn hysteresis_knows_no_rate_and_closes() {
    for (id, p) in [("bouc-wen", [40.0, 0.01]), ("bushing-hysteresis", [40.0, 0.01])] {
        let slow = loss(id, &p, 0.03, 0.5);
        close(slow, loss(id, &p, 0.03, 50.0), 1e-9);
        assert!(slow > 0.0 && slow < 4.0 * 40.0 * 0.03, "{id}: {slow}");
        // the same way at a warped pace
        let way = |s: f64| 0.03 * (5.0 * s).sin() + 0.01 * (13.0 * s).sin();
        let even = along(id, &p, 1e-3, 3000, |t| (1.0, [way(t), 0.0, 0.0]));
        let warped: Vec<_> = (0..=3000)
            .map(|i| (0.5 + 0.4 * f64::from(i).sin(), 1.0, [way(f64::from(i) * 1e-3), 0.0, 0.0]))
            .collect();
        assert_eq!(even, run(effect(id), &p, &warped), "{id} sees the time");
        // after some cycles the loop is closed
        let cycles = along(id, &p, TAU / 1000.0, 6000, |t| (0.0, [0.03 * t.sin(), 0.0, 0.0]));
        close(cycles[6000], cycles[5000], 0.01);
        assert!((cycles[500] - cycles[1000]).abs() < 80.0 && (cycles[5250] - cycles[5750]).abs() > 40.0);
    }
}

#[test]
fn curves_of_hysteresis() {
    let to = |id: &str, way: &[f64]| {
        let points: Vec<_> = std::iter::once(&0.0).chain(way).map(|x| (1.0, 0.0, [*x, 0.0, 0.0])).collect();
        -run(effect(id), &[1.0, 0.1], &points).last().unwrap()
    };
    close(to("bouc-wen", &[0.1]), 1.0 - 1.0 / E, 1e-12);
    close(to("bouc-wen", &[-0.1]), 1.0 / E - 1.0, 1e-12);
    close(to("bouc-wen", &[10.0]), 1.0, 1e-12);
    // straight back by the way of the force, then up on the other side
    close(to("bouc-wen", &[10.0, 9.95]), 0.5, 1e-12);
    close(to("bouc-wen", &[10.0, 9.9]), 0.0, 1e-12);
    close(to("bouc-wen", &[10.0, 9.8]), 1.0 / E - 1.0, 1e-12);
    close(to("bushing-hysteresis", &[0.1]), 0.5, 1e-12);
    close(to("bushing-hysteresis", &[1e9]), 1.0, 1e-7);
    // from the upper branch: twice as much way for as much force
    close(to("bushing-hysteresis", &[1e9, 1e9 - 0.2]), 0.0, 1e-6);
    close(to("bushing-hysteresis", &[1e-6]) / 1e-6, 10.0, 1e-3);
}

#[test]
fn payne_is_soft_at_large_amplitudes_and_as_lossy_at_any_frequency() {
    let cycle = |amplitude: f64, dt: f64| {
        let elastic: Vec<f64> =
            (0..=3 * 2000).map(|i| amplitude * (TAU * f64::from(i) / 2000.0).sin()).collect();
        let points: Vec<_> = elastic.iter().map(|f| (dt, *f, [0.0; 3])).collect();
        let force = run(effect("payne"), &[10.0, 20.0], &points);
        let stiffness = (force[4500] - force[5500]) / (elastic[4500] - elastic[5500]);
        (stiffness, area(&elastic[4000..], &force[4000..]))
    };
    let ((small, _), (medium, lost), (large, _)) = (cycle(0.1, 0.1), cycle(20.0, 0.1), cycle(1000.0, 0.1));
    close(small, 1.5, 5e-3);
    close(large, 1.01, 5e-3);
    assert!(large < medium && medium < small && lost > 0.0, "{medium}, {lost}");
    assert_eq!(cycle(20.0, 0.1), cycle(20.0, 1e-4));
}

#[test]
fn play_follows_behind_its_gap() {
    let (x, gap) = (1.0, 0.2);
    let (place, dt) = (|t: f64| x * t.sin(), TAU / N as f64);
    let y = along("play", &[gap], dt, 2 * N, |t| (place(t), [0.0; 3]));
    let inner: Vec<f64> = (0..=2 * N).map(|i| place(i as f64 * dt)).collect();
    close(area(&inner[N..], &y[N..]).abs(), 4.0 * gap * (x - gap), 1e-5);
    close(y.iter().copied().fold(f64::MIN, f64::max), x - gap, 1e-9);
    // a motion within the gap does not get through
    assert!(along("play", &[gap], dt, 2 * N, |t| (0.15 * t.sin(), [0.0; 3])).iter().all(|y| *y == 0.0));
}

#[test]
fn dry_friction_of_rigs() {
    for v in [-0.3, 0.3] {
        close(at("guide-friction", &[20.0, 1e-3], 100.0, [v, 0.0, 0.0]), 100.0 + 20.0 * v.signum(), 1e-9);
        let width = |p: f64| at("seal-friction", &[12.0, 2e-5, 1e-3], 100.0, [v, p, 0.0]) - 100.0;
        close(width(0.0), 12.0 * v.signum(), 1e-9);
        close(width(7e5) - width(1e5), v.signum() * 12.0, 1e-9);
        close(at("guide-drag", &[6.0], 1.0, [v, 0.0, 0.0]), 1.0 + 6.0 * v, 1e-12);
    }
    assert_eq!(at("guide-friction", &[20.0, 1e-3], 100.0, [0.0; 3]), 100.0);
    // a size for each direction, and a part of it without a load
    let form = |id: &str, parameter: &str| {
        forms(id).find(|e| e.parameters.iter().any(|p| p.name == parameter)).unwrap()
    };
    let now = |effect: &Effect, p: &[f64], drivers: [f64; 3]| run(effect, p, &[(0.0, 1.0, drivers)])[0] - 1.0;
    let by_direction = |v: f64| now(form("coulomb-friction", "forwards"), &[3.0, 5.0, 1e-3], [v, 0.0, 0.0]);
    assert_eq!((by_direction(0.4), by_direction(-0.4), by_direction(0.0)), (-3.0, 5.0, 0.0));
    let loaded = |v: f64, load: f64| {
        now(form("load-dependent-friction", "per_load"), &[0.1, 2.0, 1e-4], [v, load, 0.0])
    };
    close(loaded(0.4, -30.0), -5.0, 1e-6);
    close(loaded(-0.4, 30.0), 5.0, 1e-6);
    close(loaded(0.4, 0.0), -2.0, 1e-6);
    assert_eq!(at("fixture-inertia", &[3.0], 10.0, [2.0, 0.0, 0.0]), 16.0);
    assert_eq!(at("added-inertia", &[3.0], 10.0, [2.0, 0.0, 0.0]), 4.0);
}

#[test]
fn stribeck_has_a_peak_at_low_velocity() {
    let friction = |v: f64| -at("stribeck-friction", &[10.0, 5.0, 0.1], 0.0, [v, 0.0, 0.0]);
    close(friction(10.0), 10.0, 1e-9);
    close(friction(0.1), 10.0 + 5.0 / E, 1e-6);
    close(friction(-0.1), -friction(0.1), 1e-12);
    assert!(friction(0.02) > 14.0 && friction(0.0) == 0.0);
}

#[test]
fn stops_and_gaps() {
    let stop = |x: f64| at("bump-stop", &[100.0, 40.0, 0.5], 7.0, [x, 0.0, 0.0]);
    assert_eq!((stop(0.5), stop(-0.5), stop(0.1)), (7.0, 7.0, 7.0));
    close(stop(0.75), 7.0 - 25.0, 1e-12);
    close(stop(-0.75), 7.0 + 10.0, 1e-12);
    // with the spring of the model there is no force inside the gap, and the spring's beyond it
    let spring = |x: f64| at("clearance", &[100.0, 0.1], -100.0 * x, [x, 0.0, 0.0]);
    assert_eq!(spring(0.07), 0.0);
    close(spring(0.3), -20.0, 1e-12);
    close(at("progressive-spring", &[2.0], 1.0, [3.0, 0.0, 0.0]), 1.0 - 54.0, 1e-12);
    close(at("asymmetric-spring", &[2.0], 1.0, [-3.0, 0.0, 0.0]), 1.0 - 18.0, 1e-12);
    // slopes c + a and c - a
    let damper = |v: f64| at("damper-asymmetry", &[2.0], -10.0 * v, [v, 0.0, 0.0]);
    assert_eq!((damper(1.0), damper(-1.0)), (-12.0, 8.0));
}

// ------------------------------------------------------------------ lags and delays

/// A unit step right after the start, then what comes out `t` later.
fn step(id: &str, p: &[f64], t: f64, drivers: [f64; 3]) -> f64 {
    let points = [(0.0, 0.0, drivers), (1e-9, 1.0, drivers), (t, 1.0, drivers)];
    run(effect(id), p, &points)[2]
}

#[test]
fn lags_reach_63_percent() {
    let part = 1.0 - 1.0 / E;
    for id in ["sensor-lag", "hydraulic-lag", "actuator-lag"] {
        close(step(id, &[0.3], 0.3, [0.0; 3]), part, 1e-7);
        close(step(id, &[0.3], 0.6, [0.0; 3]), 1.0 - (-2.0_f64).exp(), 1e-7);
    }
    // in metres, not in seconds
    for speed in [-40.0, 0.5, 3.0, 30.0_f64] {
        close(step("relaxation-length", &[0.6], 0.6 / speed.abs(), [speed, 0.0, 0.0]), part, 1e-6);
    }
    close(step("relaxation-length", &[0.6], 100.0, [0.0; 3]), 0.0, 1e-6);
}

#[test]
fn carcass_compliance_is_a_length_that_falls_with_saturation() {
    // the force of a linear tire of stiffness c follows the lagged angle, seen one call later
    let distance = |stiffness: f64, limit: f64, speed: f64| {
        let (e, p) = (effect("carcass-compliance"), [2e-5]);
        let (mut memory, mut force, dt) = (crate::effect::Memory::default(), 0.0, 1e-3 / speed);
        let goal = |i: usize| if i == 0 { 1e-6 } else { 0.1 };
        for i in 0..20_000 {
            let drivers = [force, speed];
            let call = crate::effect::Call {
                time: 0.0,
                dt: if i == 0 { 0.0 } else { dt },
                target: goal(i),
                drivers: &drivers,
                course: None,
            };
            let slip = (e.apply)(&p, &mut memory, &call);
            if slip > (1.0 - 1.0 / E) * 0.1 {
                return i as f64 * 1e-3;
            }
            force = limit * (stiffness * slip / limit).tanh();
        }
        f64::INFINITY
    };
    close(distance(5e4, 1e9, 20.0), 1.0, 0.02);
    close(distance(5e4, 1e9, 1.0), 1.0, 0.02);
    close(distance(2e4, 1e9, 20.0), 0.4, 0.02);
    assert!(distance(5e4, 1500.0, 20.0) < 0.75);
}

#[test]
fn rubber_is_stiff_at_once_and_soft_in_the_end() {
    close(step("viscoelastic-stiffening", &[0.5, 0.2], 1e-9, [0.0; 3]), 1.5, 1e-7);
    close(step("viscoelastic-stiffening", &[0.5, 0.2], 0.2, [0.0; 3]), 1.0 + 0.5 / E, 1e-7);
    close(step("viscoelastic-stiffening", &[0.5, 0.2], 9.0, [0.0; 3]), 1.0, 1e-7);
}

#[test]
fn delays() {
    let course = |t: f64| (5.0 * t).sin();
    let late = along("sensor-delay", &[0.07], 1e-3, 2000, |t| (course(t), [0.0; 3]));
    for (i, y) in late.iter().enumerate().skip(71) {
        close(*y, course(i as f64 * 1e-3 - 0.07), 1e-5);
    }
    assert_eq!(late[30], course(0.0), "before the start nothing moved");
}

#[test]
fn a_clock_shows_another_time() {
    let course = |t: f64| (5.0 * t).sin();
    let values: Vec<f64> = (0..20_000).map(|i| course(2.0 + i as f64 * 1e-3)).collect();
    let whole = crate::effect::Course { start: 2.0, step: 1e-3, values: &values };
    let effect = find("clock-drift").unwrap();
    for (error, known, tolerance) in
        [(0.004, None, 1e-5), (-0.004, None, 0.08), (0.004, Some(whole), 1e-5), (-0.004, Some(whole), 1e-5)]
    {
        let mut memory = crate::effect::Memory::default();
        for (i, target) in values.iter().enumerate() {
            let (time, dt) = (2.0 + i as f64 * 1e-3, if i == 0 { 0.0 } else { 1e-3 });
            let call = crate::effect::Call { time, dt, target: *target, drivers: &[], course: known };
            let y = (effect.apply)(&[error], &mut memory, &call);
            let shown = time - error * (time - 2.0);
            // a clock that is ahead goes straight on where nobody knows, and ends with the run
            if i > 10 && shown < 2.0 + 19.999 {
                close(y, course(shown), tolerance);
            }
        }
    }
}

/// Gain and phase of an effect for a sine of the changed number after everything has settled.
fn response(id: &str, p: &[f64], hertz: f64) -> (f64, f64) {
    let (turns, per) = (400, 400);
    let dt = 1.0 / hertz / per as f64;
    let y = along(id, p, dt, turns * per, |t| ((TAU * hertz * t).sin(), [0.0; 3]));
    let start = (turns - 10) * per;
    let (cos, sin) = line(&y[start..], |i| TAU * i as f64 / per as f64);
    (cos.hypot(sin), cos.atan2(sin))
}

#[test]
fn modes_amplify_at_their_frequency() {
    for id in ["frame-resonance", "belt-mode", "actuator-resonance", "driveline-compliance"] {
        let p = [1.0, 20.0, 0.05];
        let (gain, phase) = response(id, &p, 20.0);
        close(gain, 10.0, 0.01);
        close(phase, -PI / 2.0, 1e-3);
        close(response(id, &p, 1.0).0, 1.0 / (1.0 - 0.0025), 1e-3);
        let r = 3.0_f64;
        let theory = 1.0 / ((1.0 - r * r).powi(2) + (0.1 * r).powi(2)).sqrt();
        close(response(id, &p, 60.0).0, theory, 1e-3);
        close(response(id, &[0.5, 20.0, 0.05], 20.0).0, (0.25 + 25.0_f64).sqrt(), 0.01);
    }
    // soft steering: the angle gives way by c F in the end, at first it rings
    let angle = along("steering-compliance", &[1e-5, 10.0, 0.1], 1e-3, 5000, |t| {
        (0.05, [if t > 0.0 { 1000.0 } else { 0.0 }, 0.0, 0.0])
    });
    close(angle[5000], 0.04, 1e-9);
    close(angle[0], 0.05, 0.0);
    assert!(angle.iter().copied().fold(f64::MAX, f64::min) < 0.04 - 0.6 * 0.01);
}

#[test]
fn rate_limits_dead_bands_and_gaps() {
    let ramp =
        along("valve-rate-limit", &[1.0, 50.0], 1e-3, 100, |t| (if t > 0.0 { 2.0 } else { 0.0 }, [0.0; 3]));
    close(ramp[20], 1.0, 1e-12);
    close(ramp[100], 2.0, 1e-12);
    let slow = along("valve-rate-limit", &[1.0, 50.0], 1e-3, 100, |t| (49.0 * t, [0.0; 3]));
    close(slow[77], 49.0 * 0.077, 1e-12);
    for (p, through) in [(0.5, 0.0), (3.0, 2.0), (-3.0, -2.0)] {
        close(at("hydraulic-hold-off", &[1.0], p, [0.0; 3]), through, 1e-12);
    }
    // a torque M takes sqrt(2 * 2 b / M) to cross the gap 2 b
    let torque =
        along("backlash", &[1.0, 0.01], 1e-4, 20_000, |t| (if t < 0.5 { 4.0 } else { -4.0 }, [0.0; 3]));
    let lost = torque.iter().filter(|m| **m == 0.0).count() as f64 * 1e-4;
    close(lost, (2.0 * 0.02 / 4.0_f64).sqrt(), 1e-3);
    assert!(torque[..5000].iter().all(|m| *m == 4.0) && torque[7000..].iter().all(|m| *m == -4.0));
}

// ------------------------------------------------------------------ orders

#[test]
fn orders_of_the_wheel() {
    let n = 3600;
    let turn = |i: usize| TAU * 4.0 * i as f64 / n as f64;
    let course = |id: &str, target: f64, driver: f64| {
        let p = &[0.03, -0.04, 0.015, -0.02, 0.006, -0.008][..effect(id).parameters.len()];
        let y = along(id, p, 1.0, n, |t| (target, [turn(t as usize), driver, 0.0]));
        [1.0, 2.0, 3.0].map(|order| line(&y, |i| order * turn(i)))
    };
    let is = |(cos, sin): (f64, f64), size: f64| {
        close(cos, 0.03 * size, 1e-9);
        close(sin, -0.04 * size, 1e-9);
    };
    for (order, size) in [50.0, 25.0, 10.0].into_iter().enumerate() {
        is(course("tone-ring", 50.0, 0.0)[order], size);
    }
    is(course("disc-thickness-variation", 30.0, 0.0)[0], 30.0);
    is(course("disc-thickness-variation", 30.0, 0.0)[1], 15.0);
    is(course("disc-thickness-variation", 0.0, 0.0)[0], 0.0);
    is(course("non-uniformity", 100.0, 4000.0)[0], 4000.0);
    is(course("non-uniformity", 100.0, 4000.0)[1], 0.0);
    // with the second order at half of the first
    let both = forms("non-uniformity").find(|e| e.drivers.len() == 2 && e.parameters.len() == 4).unwrap();
    let points: Vec<_> = (0..=n).map(|i| (1.0, 100.0, [turn(i), 4000.0, 0.0])).collect();
    let y = run(both, &[0.03, -0.04, 0.015, -0.02], &points);
    is(line(&y, turn), 4000.0);
    is(line(&y, |i| 2.0 * turn(i)), 2000.0);
    // a stiffness by shares of itself
    let stiffness = forms("non-uniformity").find(|e| e.drivers.len() == 1).unwrap();
    let y = run(stiffness, &[0.03, -0.04, 0.015, -0.02], &points);
    is(line(&y, turn), 100.0);
    is(line(&y, |i| 2.0 * turn(i)), 50.0);
    is(course("brake-torque-variation", 100.0, 20.0)[0], 20.0);
    // four times as much at twice the speed
    is(course("imbalance", 100.0, 10.0)[0], 100.0);
    is(course("imbalance", 100.0, -20.0)[0], 400.0);
}

#[test]
fn lines_fixed_in_metres_and_in_hertz() {
    for speed in [2.0, 7.0] {
        let y = along("belt-order", &[0.3, 0.1, 1.5], 1e-3, 3000, |t| (1.0, [speed * t, 0.0, 0.0]));
        for i in [0, 500, 1777] {
            let s = TAU * speed * i as f64 * 1e-3 / 1.5;
            close(y[i], 1.0 + 0.3 * s.cos() + 0.1 * s.sin(), 1e-12);
        }
    }
    let hum = along("mains-hum", &[0.3, 0.1, 50.0], 1e-3, 200, |_| (1.0, [0.0; 3]));
    close(hum[20], 1.3, 1e-9);
    close(hum[25], 1.1, 1e-9);
    close(hum[25], hum[45], 1e-9);
}

// ------------------------------------------------------------------ heat

#[test]
fn heat_comes_to_a_balance() {
    // P T is stored in the end, 63 % of it after T
    let (loss, time, power) = (2e-5, 8.0, 4000.0);
    let stored = |t: f64| power * time * (1.0 - (-t / time).exp());
    let steady = 1.0 - (loss * power * time).tanh();
    for (id, target, drivers) in [
        ("thermal-softening", 1000.0, [0.2, 20.0, 0.0]),
        ("pad-fade", -100.0, [40.0, 0.0, 0.0]),
        ("frictional-heating", 50.0, [-4000.0, 0.0, 0.0]),
    ] {
        let y = along(id, &[loss, time], 0.1, 2000, |_| (target, drivers));
        assert_eq!(y[0], target, "{id} starts cold");
        close(y[80] / target, 1.0 - (loss * stored(8.0)).tanh(), 1e-9);
        close(y[2000] / target, steady, 1e-9);
        assert!(y[2000] / target < 0.6, "{id}");
    }
    // 4 kW of side force, and 3 kW of it with 1 kW of drive
    let sideways = [-20.0, -2000.0, 0.1_f64.atan(), 0.0, 0.0];
    for drivers in [sideways, [-20.0, -1500.0, 1000.0, 0.1_f64.atan(), -0.05]] {
        let count = if drivers == sideways { 3 } else { 5 };
        let form = forms("thermal-softening").find(|e| e.drivers.len() == count).unwrap();
        let points: Vec<_> = (0..=80).map(|_| (0.1, 1.1, drivers)).collect();
        close(run(form, &[loss, time], &points)[80] / 1.1, 1.0 - (loss * stored(8.0)).tanh(), 1e-9);
    }
    // and goes away in a pause: after 3 T with nothing 5 % are left
    let y = along("frictional-heating", &[loss, time], 0.1, 2240, |t| {
        (50.0, [if t <= 200.0 { power } else { 0.0 }, 0.0, 0.0])
    });
    close(1.0 - y[2240] / 50.0, (loss * power * time * (-3.0_f64).exp()).tanh(), 1e-3);
    let warm = along("inflation-warm-up", &[0.005, 20.0], 0.05, 8000, |_| (200.0, [-30.0, 0.0, 0.0]));
    close(warm[0], 200.0, 0.0);
    close(warm[400], 200.0 * (1.0 + 0.005 * 30.0 * (1.0 - 1.0 / E)), 1e-9);
    close(warm[8000], 200.0 * 1.15, 1e-6);
}

#[test]
fn a_pad_bites_after_some_time() {
    let (p, dt) = ([0.75, 0.22, 0.05], 1e-3);
    let onset = |t: f64| if (0.1..1.0).contains(&t) || t > 1.8 { 2.0 } else { 0.0 };
    let y = along("pad-onset", &p, dt, 2500, |t| (onset(t), [0.0; 3]));
    close(y[100], 2.0 * 0.25, 0.01);
    close(y[100 + 109], 2.0 * (0.25 + 0.75 * 0.5), 0.01);
    close(y[100 + 220], 2.0, 1e-12);
    close(y[999], 2.0, 1e-12);
    // after a release it takes as long again
    close(y[1801], 2.0 * 0.25, 0.01);
    // who starts with the brake on has the pad in contact
    assert!(along("pad-onset", &p, dt, 9, |_| (2.0, [0.0; 3])).iter().all(|y| *y == 2.0));
}

// ------------------------------------------------------------------ factors and offsets

#[test]
fn friction_of_tires() {
    let speedy =
        |slip: f64, v: f64, n: f64| at("speed-dependent-friction", &[0.4, 5.0, n], 100.0, [slip, v, 0.0]);
    for n in [0.5, 1.0, 2.0] {
        close(speedy(0.25, 20.0, n), 100.0 * (1.0 - 0.4 * (1.0 - 1.0 / E)), 1e-9);
        close(speedy(0.25, 20.0, n), speedy(-0.5, 10.0, n), 1e-12);
    }
    close(speedy(1.0, 100.0, 2.0), 60.0, 1e-9);
    // along both axes: 3, 4, 5
    let both = forms("speed-dependent-friction").find(|e| e.drivers.len() == 3).unwrap();
    let points = [(0.0, 100.0, [10.0, 0.4_f64.atan(), 0.3])];
    close(run(both, &[0.4, 5.0, 2.0], &points)[0], speedy(0.5, 10.0, 2.0), 1e-9);
    // the same sliding from the speed of the wheel
    let wheel = forms("speed-dependent-friction").find(|e| e.parameters.len() == 4).unwrap();
    let points = [(0.0, 100.0, [10.0, 0.4_f64.atan(), (10.0 - 3.0) / 0.35])];
    close(run(wheel, &[0.4, 5.0, 2.0, 0.35], &points)[0], speedy(0.5, 10.0, 2.0), 1e-9);
    let branch = |slip: f64| at("falling-branch", &[0.3, 0.1], 100.0, [slip, 0.0, 0.0]);
    assert_eq!((branch(0.1), branch(-0.05)), (100.0, 100.0));
    close(branch(-0.2), 100.0 * (1.0 - 0.3 * 1.0_f64.tanh()), 1e-12);
    close(at("load-sensitivity", &[0.2, 4000.0], 100.0, [-6000.0, 0.0, 0.0]), 90.0, 1e-9);
    assert_eq!(at("load-sensitivity", &[0.2, 4000.0], 100.0, [4000.0, 0.0, 0.0]), 100.0);
    close(at("pressure-dependent-friction", &[-0.3, 2e5], 100.0, [3e5, 0.0, 0.0]), 85.0, 1e-9);
    close(at("drum-curvature", &[0.21], 110.0, [0.0; 3]), 100.0, 1e-9);
    close(at("camber-thrust", &[50.0], 1.0, [-0.1, 0.0, 0.0]), 6.0, 1e-12);
    let loaded = forms("camber-thrust").find(|e| e.drivers.len() == 2).unwrap();
    // a tire pushes to the side to which it leans, under either sign of the load
    let lean = |load: f64| run(loaded, &[1.2], &[(0.0, 1.0, [-0.1, load, 0.0])])[0];
    close(lean(50.0), 7.0, 1e-12);
    close(lean(-50.0), 7.0, 1e-12);
}

#[test]
fn offsets_by_direction() {
    let load = 4000.0;
    let of = |id: &str, v: f64| at(id, &[0.02], 0.0, [load, v, 0.0]);
    close(of("conicity", 10.0), 80.0, 0.01);
    close(of("conicity", -10.0), of("conicity", 10.0), 1e-12);
    close(of("plysteer", 10.0), 80.0, 1e-9);
    close(of("plysteer", -10.0), -80.0, 1e-9);
    close(of("rolling-resistance", 10.0), -80.0, 1e-9);
    close(of("rolling-resistance", -10.0), 80.0, 1e-9);
    for id in ["conicity", "plysteer", "rolling-resistance"] {
        assert_eq!(of(id, 0.0), 0.0, "{id} at standstill");
    }
    close(at("aero-drag", &[0.4], 0.0, [-20.0, 0.0, 0.0]), 160.0, 1e-9);
}

#[test]
fn clips_and_steps() {
    for (y, shown) in [(3.0, 2.0), (-3.0, -2.0), (1.5, 1.5)] {
        for id in ["saturation", "actuator-limit"] {
            assert_eq!(at(id, &[1.0, 2.0], y, [0.0; 3]), shown);
            close(at(id, &[0.5, 2.0], y, [0.0; 3]), 0.5 * (y + shown), 1e-12);
        }
    }
    assert_eq!(at("loss-of-contact", &[1.0, 0.0], -5.0, [0.0; 3]), 0.0);
    assert_eq!(at("loss-of-contact", &[1.0, 3.0], -5.0, [0.0; 3]), -3.0);
    assert_eq!(at("loss-of-contact", &[1.0, 3.0], -2.0, [0.0; 3]), -2.0);
    for (y, shown) in [(0.24, 0.25), (0.3, 0.25), (-0.38, -0.5), (0.1, 0.0)] {
        close(at("quantisation", &[1.0, 0.25], y, [0.0; 3]), shown, 1e-12);
    }
}

#[test]
fn a_wheel_that_leaves_the_road_has_no_load_below_zero() {
    // a tire on a road that falls away under a wheel at rest, and comes back
    let (stiffness, weight, step) = (2e5, 4e3, 1e-4);
    let road = |t: f64| -0.05 * (6.0 * t).sin().max(0.0);
    let load = |h: f64| weight + stiffness * h;
    let effect = find("lift-off").unwrap();
    let (mut memory, mut seen, mut before, mut least) =
        (crate::effect::Memory::default(), load(0.0), load(0.0), f64::INFINITY);
    for k in 0..12_000 {
        let t = f64::from(k) * step;
        let dt = if k == 0 { 0.0 } else { step };
        let ahead = if k == 0 { seen } else { 2.0 * seen - before };
        let call = crate::effect::Call { time: t, dt, target: road(t), drivers: &[ahead], course: None };
        before = seen;
        seen = load((effect.apply)(&[1.0, stiffness], &mut memory, &call));
        least = least.min(seen);
        // straight on from two points: half the curvature over a step, and the corner of the road itself
        let (expected, error) = (load(road(t)).max(0.0), 0.05 * 36.0 * stiffness * step * step);
        let corner = [0.0, PI / 6.0, PI / 3.0].iter().any(|c| (t - c).abs() < 3.0 * step);
        assert!(corner || (seen - expected).abs() < 3.0 * error, "{t}: {seen} {expected}");
    }
    assert!(load(road(0.26)) < -5000.0 && least > -7.0, "{least}");
}

#[test]
fn amplitude_softens_by_its_mean() {
    let (k, limit) = (300.0, 0.02);
    for x in [0.002, 0.02, 0.2] {
        let force = along("amplitude-softening", &[k, limit, 3.0], 1e-3, 60_000, |t| {
            (0.0, [x * (20.0 * t).sin(), 0.0, 0.0])
        });
        let most = force[50_000..].iter().fold(0.0_f64, |m, f| m.max(f.abs()));
        close(most, k * x / (1.0 + x / limit), 0.02 * k * x / (1.0 + x / limit));
    }
}

#[test]
fn sensors_that_show_something_else() {
    assert_eq!(at("sensor-bias", &[0.5], 2.0, [0.0; 3]), 2.5);
    assert_eq!(at("sensor-gain", &[0.5], 2.0, [0.0; 3]), 3.0);
    assert_eq!(at("rolling-radius", &[-0.25], 2.0, [0.0; 3]), 1.5);
    let form = |id: &str, drivers: usize| forms(id).find(|e| e.drivers.len() == drivers).unwrap();
    let radius = run(form("rolling-radius", 1), &[-0.25, 1e-4], &[(0.0, 2.0, [-5000.0, 0.0, 0.0])]);
    close(radius[0], 2.0 * (1.0 - 0.25 + 0.5), 1e-12);
    assert_eq!(run(form("plysteer", 1), &[0.01], &[(0.0, 0.02, [20.0, 0.0, 0.0])]), [0.03]);
    assert_eq!(at("cross-talk", &[0.5], 2.0, [8.0, 0.0, 0.0]), 6.0);
    assert_eq!(at("sensor-nonlinearity", &[0.5, 0.1], -2.0, [0.0; 3]), -2.0 - 2.0 + 0.4);
    let drift = along("sensor-drift", &[0.5], 0.1, 40, |_| (2.0, [0.0; 3]));
    close(drift[40], 4.0, 1e-9);
    assert_eq!(drift[0], 2.0);
    let sag = along("supply-sag", &[1e-3, 0.1], 0.01, 1000, |t| {
        (5.0, [if t > 0.0 { -200.0 } else { 0.0 }, 0.0, 0.0])
    });
    assert_eq!(sag[0], 5.0);
    close(sag[1000], 4.0, 1e-9);
}
