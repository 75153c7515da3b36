//! Manoeuvres at the edge of the model: standing, locked, in reverse, sideways, spinning, in the air.

use crate::common::rolling::{FREE, Point};
use crate::common::{FlatTrack, NO_ACTUATORS, assert_close, example_tire, flat_track, get, set};
use crate::{FORCES, TICK, check_sanity, forces, means, run};
use latsch::model::Slave;
use latsch::tire::Vertical;
use latsch::tire::ring_brush::stationary_refined;
use std::f64::consts::{FRAC_PI_2, PI};

#[test]
fn vertical_balance_and_standstill() {
    let mut rig = flat_track(&[("path_speed", 0.0), ("deflection", 0.0), NO_ACTUATORS]);
    let deflection = rig.find("deflection").unwrap();
    let steer = rig.find("steer").unwrap();
    rig.set_rate(deflection, 0.05).unwrap();
    run(&mut rig, 0.4, |_| {});
    set(&mut rig, &[("deflection", 0.02)]);
    rig.set_rate(steer, 0.1).unwrap();
    run(&mut rig, 0.6, |_| {});
    set(&mut rig, &[("steer", 0.02)]);
    run(&mut rig, 3.0, |_| {});
    let before = forces(&mut rig);
    assert!(before[5].abs() > 10.0, "the steered tire is twisted: {before:?}");
    let balance = get(&mut rig, "patch_force_z") - before[2];
    assert!((balance - 8.8 * 9.81).abs() < 1e-6, "{balance}");
    run(&mut rig, 6.0, |_| {});
    let after = forces(&mut rig);
    for (k, name) in FORCES.iter().enumerate() {
        let drift = (after[k] - before[k]).abs();
        println!("{name}: {} drift {drift:.1e}", before[k]);
        assert!(drift < 1e-6, "{name}: {} and 3 s later {}", before[k], after[k]);
    }
    assert_eq!(get(&mut rig, "friction_power"), 0.0);
}

/// A locked wheel slides with the kinetic coefficients, and only against its motion.
#[test]
fn locked_wheel() {
    let mut rig = flat_track(&[("slip", 0.0), ("deflection", 0.025)]);
    set(&mut rig, &[("slip", -1.0)]);
    let power = |rig: &mut FlatTrack| get(rig, "friction_power");
    run(&mut rig, 0.5, check_sanity);
    let [x, y, ..] = means(&mut rig, 0.7);
    let normal = get(&mut rig, "patch_force_z");
    println!("locked: force_x {x:.1} N of {normal:.1} N");
    assert!(x < -0.94 * normal && x > -1.1 * normal && y.abs() < 1e-6 * normal);
    assert_eq!(get(&mut rig, "sliding_share"), 1.0);
    // all the work goes into heat
    assert_close("power", power(&mut rig), -get(&mut rig, "patch_force_x") * 10.0, 1e-3);
}

/// Backward is forward seen in a mirror that swaps front and rear: what pushes the patch forward pushes it
/// backward, and left stays left.
#[test]
fn reverse_rolling() {
    let common = [("deflection", 0.025), ("camber", 0.01)];
    let mut forward = flat_track(&[&common[..], &[("slip", 0.02), ("slip_angle", 0.02)]].concat());
    let mut backward =
        flat_track(&[&common[..], &[("slip", -0.02), ("slip_angle", 0.02), ("path_speed", -10.0)]].concat());
    let signs = [-1.0, 1.0, 1.0, 1.0, -1.0, -1.0];
    let (mut worst, mut scale) = ([0.0_f64; 6], [1.0_f64; 6]);
    for k in 0..250 {
        let t = f64::from(k) * TICK;
        if k == 50 {
            set(&mut forward, &[("slip_angle", -0.05), ("slip", -0.03)]);
            set(&mut backward, &[("slip_angle", -0.05), ("slip", 0.03)]);
        }
        forward.step(t, TICK).unwrap();
        backward.step(t, TICK).unwrap();
        let (f, b) = (forces(&mut forward), forces(&mut backward));
        for i in 0..6 {
            worst[i] = worst[i].max((signs[i] * b[i] - f[i]).abs());
            scale[i] = scale[i].max(f[i].abs());
        }
    }
    println!("reverse: {worst:?} of {scale:?}");
    for i in 0..6 {
        assert!(worst[i] < 1e-6 * scale[i], "{}: {:.2e} of {}", FORCES[i], worst[i], scale[i]);
    }
}

/// Sideways at 90 degrees: Z7, and section 16.
#[test]
fn sideways() {
    for (deflection, z7) in [(0.017064, 3225.54), (0.026178, 5250.24)] {
        let mut rig =
            flat_track(&[("deflection", deflection), ("slip_angle", -FRAC_PI_2), ("path_speed", 1.0)]);
        run(&mut rig, 0.5, check_sanity);
        let [x, y, ..] = means(&mut rig, 0.6);
        println!("sideways: {y:.2} N for {z7} N");
        // 12 bristles along a stripe sample the pressure; its square counts, a little
        assert_close("Z7", y, z7, 3e-3);
        assert!(x.abs() < 1e-3 * y);
    }
}

/// Steering on the spot: the moment saturates when the whole patch slides.
#[test]
fn steering_on_the_spot() {
    let mut rig = flat_track(&[("path_speed", 0.0), ("deflection", 0.02), NO_ACTUATORS]);
    let steer = rig.find("steer").unwrap();
    rig.set_rate(steer, 0.5).unwrap();
    let mut moments = Vec::new();
    run(&mut rig, 2.0, |rig| {
        check_sanity(rig);
        moments.push(get(rig, "moment_z"));
    });
    let (middle, end) = (moments[999], moments[1999]);
    println!(
        "moment after 0.5 and 1 rad: {middle:.3} {end:.3}, largest {:.3}",
        moments.iter().fold(0.0_f64, |a, b| a.max(b.abs()))
    );
    assert!(end < -50.0 && (end - middle).abs() < 1e-2 * end.abs());
    // no more than the outermost bristles' distance times friction: a patch of 0.17 m by 0.24 m
    assert!(end.abs() < 1.1 * get(&mut rig, "patch_force_z") * 0.15);
    assert!(get(&mut rig, "friction_power") > 0.0);
    // and back: it sticks at first, so the moment changes sign at once
    rig.set_rate(steer, -0.5).unwrap();
    run(&mut rig, 2.1, check_sanity);
    assert!(get(&mut rig, "moment_z") > end + 50.0);
}

/// Bouncing through zero load.
#[test]
fn lift_off_and_landing() {
    let mut rig = flat_track(&[("deflection", 0.01), ("slip_angle", -0.02), ("slip", 0.01), NO_ACTUATORS]);
    let deflection = rig.find("deflection").unwrap();
    let (mut air, mut ground) = (0, 0);
    for k in 0..1500 {
        let t = f64::from(k) * TICK;
        let angle = 2.0 * PI * 4.0 * t;
        set(&mut rig, &[("deflection", 0.01 * angle.cos())]);
        rig.set_rate(deflection, -0.01 * 2.0 * PI * 4.0 * angle.sin()).unwrap();
        rig.step(t, TICK).unwrap();
        check_sanity(&mut rig);
        if get(&mut rig, "pressure_state") == 1.0 {
            air += 1;
            let patch =
                ["patch_force_x", "patch_force_y", "patch_force_z", "sliding_share", "friction_power"];
            assert!(patch.iter().all(|name| get(&mut rig, name) == 0.0));
        } else {
            ground += 1;
        }
    }
    assert!(air > 500 && ground > 500, "{air} {ground}");
    // after the last landing it rolls as if it had never left
    set(&mut rig, &[("deflection", 0.02)]);
    rig.set_rate(deflection, 0.0).unwrap();
    run(&mut rig, 2.3, |_| {});
    let late = means(&mut rig, 2.44);
    let mut calm = flat_track(&[("deflection", 0.02), ("slip_angle", -0.02), ("slip", 0.01)]);
    run(&mut calm, 0.3, |_| {});
    let expected = means(&mut calm, 0.44);
    for k in 0..3 {
        assert_close(FORCES[k], late[k], expected[k], 3e-3);
    }
}

/// A wheel that spins on the spot, nearly.
#[test]
fn spinning_wheel() {
    let mut rig = flat_track(&[("path_speed", 0.1), ("deflection", 0.02)]);
    set(&mut rig, &[("slip", 90.0)]);
    run(&mut rig, 1.0, check_sanity);
    let [x, y, ..] = means(&mut rig, 1.2);
    let normal = get(&mut rig, "patch_force_z");
    println!("spinning: force_x {x:.1} of {normal:.1}");
    assert!(x > 0.9 * normal && x < 1.1 * normal && y.abs() < 1e-6 * normal);
    assert_close("power", get(&mut rig, "friction_power"), get(&mut rig, "patch_force_x") * 9.0, 1e-2);
}

/// At the stationary forces of a point the time domain and the stationary solver mean the same
/// vertical position.
#[test]
fn load_and_deflection() {
    let tire = example_tire();
    for deflection in [0.005, 0.02, 0.03] {
        let rim = Point { alpha: 0.01, slip: 0.005, ..FREE }.rim(&tire);
        let s = stationary_refined(&tire, &rim, Vertical::Height(0.338 - deflection), 1.0, 400).unwrap();
        let mut rig = flat_track(&[("deflection", deflection), ("slip_angle", -0.01), ("slip", 0.005)]);
        run(&mut rig, 0.2, |_| {});
        let late = means(&mut rig, 0.34);
        assert_close("force_z", late[2], s.on_rim.force.z, 1e-4);
    }
}
