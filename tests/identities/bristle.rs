//! Section 15, end: one bristle in time.

use super::*;

const NORMAL: f64 = 1000.0;
const PRESSURE: f64 = 1e5;

fn run(velocity: [f64; 2], dt: f64, steps: usize) -> Vec<([f64; 2], [f64; 2], bool)> {
    let p = example();
    let limits = Friction::new(&p).limits(PRESSURE, NORMAL);
    let (mut deflection, mut stick) = ([0.0; 2], false);
    (0..steps)
        .map(|_| {
            let step = advance(&p, deflection, velocity, stick, &limits, dt);
            (deflection, stick) = (step.deflection, step.stick);
            (step.deflection, step.force, step.stick)
        })
        .collect()
}

#[test]
fn sticks_breaks_away_and_slides() {
    let dt = 1e-6;
    let course = run([-0.3, 0.0], dt, 200_000);
    let broken = course.iter().position(|(_, _, stick)| !stick).unwrap();
    assert!(course[0].2, "from rest it sticks");
    for (k, (deflection, force, _)) in course[..broken].iter().enumerate() {
        let t = (k + 1) as f64 * dt;
        assert!((deflection[0] - 0.3 * t).abs() < 1e-12 && deflection[1] == 0.0);
        assert!((force[0] - (4e4 * 0.3 * t + 0.65 * 0.3)).abs() < 1e-8);
    }
    // the first step whose trial force is over 1450 N
    let time = broken as f64 * dt;
    assert!(time <= 0.12081708 + 1e-8 && time > 0.12081708 - dt, "{time}");
    for (_, force, stick) in &course[broken..] {
        assert!(!stick && (force[0] - 1050.0).abs() < 1e-9 && force[1] == 0.0);
    }
    // relaxes to 1050 / 4e4 with 16.25 us; backward Euler with 1 us is slower by a few per cent
    let rest = 1050.0 / 4e4;
    let after = |k: usize| course[broken + k - 1].0[0] - rest;
    let decay = (after(20) / after(40)).ln();
    assert_close("time constant", 20.0 * dt / decay, 16.25e-6, 0.05);
    assert_close("deflection at last", course[199_999].0[0], rest, 1e-12);
}

#[test]
fn force_is_against_the_motion_in_both_modes() {
    for (_, force, _) in run([0.3, 0.4], 1e-4, 5000) {
        let size = force[0].hypot(force[1]);
        assert!((force[0] / size + 0.6).abs() < 1e-12 && (force[1] / size + 0.8).abs() < 1e-12);
    }
}

/// Between the limits the mode is memory.
#[test]
fn hysteresis() {
    let p = example();
    let limits = Friction::new(&p).limits(PRESSURE, NORMAL);
    assert!((limits.sticking - 1450.0).abs() < 1e-9 && (limits.sliding - 1050.0).abs() < 1e-9);
    for trial in [1050.1, 1200.0, 1449.9] {
        let deflection = [trial / 4e4, 0.0];
        let held = advance(&p, deflection, [0.0; 2], true, &limits, 1e-4);
        assert!(held.stick && (held.force[0] - trial).abs() < 1e-9);
        let slid = advance(&p, deflection, [0.0; 2], false, &limits, 1e-4);
        assert!(!slid.stick && (slid.force[0] - 1050.0).abs() < 1e-9);
    }
    let above = advance(&p, [1450.1 / 4e4, 0.0], [0.0; 2], true, &limits, 1e-4);
    assert!(!above.stick);
    let below = advance(&p, [1049.9 / 4e4, 0.0], [0.0; 2], false, &limits, 1e-4);
    assert!(below.stick);
}

/// Check 24: a bristle that enters a patch slides first, since its limit begins at zero, and
/// sticks after the way that the source gives (line 4535), on the line of adhesion.
#[test]
fn entry() {
    let p = example();
    let (slip, speed, limit_slope) = (0.03, 10.0, 8000.0);
    let (c, d) = (p.bristle_stiffness, p.bristle_damping);
    let feed = (slip + 1.0) * speed;
    let steepness = slip / (slip + 1.0);
    let way = -feed * d / c * (1.0 - c * steepness / limit_slope).ln();
    let step = 1e-8 * way / 1e-4;
    let (mut x, mut deflection, mut stick) = (0.0, [0.0; 2], false);
    let mut sticks_from = None;
    while x < 1.5 * way {
        x += feed * step;
        let limits = Limits { sticking: 1.3 * limit_slope * x, sliding: limit_slope * x };
        let result = advance(&p, deflection, [-slip * speed, 0.0], stick, &limits, step);
        (deflection, stick) = (result.deflection, result.stick);
        if stick && sticks_from.is_none() {
            sticks_from = Some((x, deflection[0]));
        }
        if !stick {
            assert!(sticks_from.is_none());
        }
    }
    let (entry, first) = sticks_from.unwrap();
    // steps of a thousandth of the way
    assert_close("way of sliding", entry, way, 5e-3);
    assert_close("slope of adhesion", (deflection[0] - first) / (x - entry), steepness, 1e-9);
}

#[test]
fn free_bristle_relaxes() {
    let p = example();
    let limits = Friction::new(&p).limits(0.0, 0.0);
    let step = advance(&p, [1e-3, -2e-3], [0.0; 2], true, &limits, 16.25e-6);
    assert!(!step.stick && small(&step.force) < 1e-12);
    assert_close("half", step.deflection[0], 0.5e-3, 1e-12);
}
