//! The contact with the road against laws that hold for any tire: no more friction than Coulomb allows,
//! power in is power lost, and falling friction has stationary states, too.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::{FlatTrack, advance, assert_close, flat_track, get, set, started};
use latsch::model::{Native, Slave};
use latsch::rig::{RingBrushCorner, RingBrushWheel};

/// The largest coefficient of friction of the default tire: static, at no pressure.
const LARGEST_FRICTION: f64 = 1.5;

fn assert_law(slave: &mut dyn Slave) -> f64 {
    let normal = get(slave, "patch_force_z");
    let horizontal = get(slave, "patch_force_x").hypot(get(slave, "patch_force_y"));
    assert!(horizontal <= LARGEST_FRICTION * normal * (1.0 + 1e-12), "{horizontal} N on {normal} N");
    if normal > 0.0 { horizontal / normal } else { 0.0 }
}

#[test]
fn a_lightly_loaded_wheel_on_the_flat_track_has_no_more_friction_than_the_law_allows() {
    let mut light = 0;
    for deflection in [0.0008, 0.001, 0.002, 0.004, 0.008, 0.012] {
        for (slip, slip_angle) in
            [(-0.5, 0.0), (-0.05, 0.0), (0.3, 0.0), (0.0, 0.2), (-0.1, -0.1), (-1.0, 0.3)]
        {
            let mut rig = flat_track(&[
                ("path_speed", 20.0),
                ("deflection", deflection),
                ("slip", slip),
                ("slip_angle", slip_angle),
            ]);
            for k in 0..150 {
                advance(&mut rig, 1e-3, k, k + 1);
                assert_law(&mut rig);
                light += i32::from(get(&mut rig, "pressure_state") == 4.0);
            }
        }
    }
    assert!(light > 500, "the pressure was limited {light} times");
}

#[test]
fn a_braked_corner_and_wheel_on_a_bad_road_have_no_more_friction_than_the_law_allows() {
    let road =
        [("road_kind", 6.0), ("road_roughness", 4096e-6), ("road_start", 1.0), ("initial_speed", 25.0)];
    let mut corner: Native<RingBrushCorner> = started(&road);
    let mut wheel: Native<RingBrushWheel> = started(&road);
    let kinds = corner.interface().variables[corner.find("road_kind").unwrap()].kind.clone();
    let latsch::model::Kind::Enumeration(kinds) = kinds else { panic!("{kinds:?}") };
    assert_eq!(kinds[5].0, "iso_8608", "{kinds:?}");
    let mut light = 0;
    for (k, torque) in (0..1500).map(|k| (k, if k % 300 < 200 { 1800.0 } else { 0.0 })) {
        for slave in [&mut corner as &mut dyn Slave, &mut wheel] {
            set(slave, &[("brake_torque", torque)]);
            advance(slave, 1e-3, k, k + 1);
            assert_law(slave);
            light += i32::from((1.0..1000.0).contains(&get(slave, "patch_force_z")));
        }
    }
    assert!(light > 30, "{light} times the wheel was nearly lifted");
}

/// What the literal reading does, so that the page's warning stays true.
#[test]
fn the_printed_pressure_has_more_friction_than_the_law_allows() {
    let mut rig = flat_track(&[
        ("path_speed", 20.0),
        ("deflection", 0.001),
        ("slip", -0.5),
        ("limit_pressure_tilt", 0.0),
    ]);
    advance(&mut rig, 1e-3, 0, 300);
    let ratio = -get(&mut rig, "patch_force_x") / get(&mut rig, "patch_force_z");
    assert!(ratio > 1.5 && get(&mut rig, "negative_pressure_share") > 0.1, "{ratio}");
}

/// Means of outputs over whole passages of bristles.
fn means<const N: usize>(rig: &mut FlatTrack, names: [&str; N]) -> [f64; N] {
    advance(rig, 1e-3, 0, 500);
    let mut sums = [0.0; N];
    for k in 500..1500 {
        advance(rig, 1e-3, k, k + 1);
        for (sum, name) in sums.iter_mut().zip(names) {
            *sum += 1e-3 * get(rig, name);
        }
    }
    sums
}

/// Of the power that a rig puts into the rim of a rolling tire, the rolling resistance takes its lever
/// times load and spin, the side wall's dampers take what an offset that turns with the wheel makes of
/// them, and the contact the rest.
#[test]
fn the_power_at_the_rim_is_lost_in_the_contact_the_rolling_resistance_and_the_side_wall() {
    for (speed, slip, slip_angle, camber) in [
        (10.0, 0.0, 0.01, 0.0),
        (10.0, 0.0, 0.03, 0.0),
        (10.0, 0.0, -0.1, 0.0),
        (20.0, 0.0, 0.03, 0.0),
        (10.0, 0.03, 0.0, 0.0),
        (10.0, -0.1, 0.0, 0.0),
        (10.0, -1.0, 0.0, 0.0),
        (-10.0, 0.05, 0.05, 0.0),
        (10.0, 0.05, 0.05, 0.0),
        (10.0, -0.03, 0.03, 0.02),
        (3.0, 0.02, 0.04, -0.05),
    ] {
        let mut rig = flat_track(&[
            ("path_speed", speed),
            ("slip", slip),
            ("slip_angle", slip_angle),
            ("camber", camber),
        ]);
        // the smoothed power starts with its stationary value
        let at_start = get(&mut rig, "contact_power_loss");
        let names = [
            "force_x",
            "force_y",
            "moment_y",
            "moment_z",
            "patch_force_z",
            "wheel_speed",
            "patch_force_x",
            "patch_force_y",
            "patch_moment_y",
            "patch_moment_z",
        ];
        let [fx, fy, my, mz, normal, spin, patch @ ..] = means(&mut rig, names);
        let energy = get(&mut rig, "contact_energy_loss");
        let [offset_x, offset_z, tilt, yaw] =
            ["belt_offset_x", "belt_offset_z", "belt_camber", "belt_yaw"].map(|name| get(&mut rig, name));
        let (vx, vy) = (speed * slip_angle.cos(), speed.abs() * slip_angle.sin());
        let rim = -(fx * vx + fy * vy + (my * camber.cos() + mz * camber.sin()) * spin);
        let rolling = 0.01 * normal * spin.abs();
        let side_wall = spin
            * spin
            * (449.0 * (offset_x.powi(2) + offset_z.powi(2))
                + 9.61 * ((tilt - camber).powi(2) + yaw.powi(2)));
        let expected = rim - rolling - side_wall;
        let [mean] = means_of_power(&mut rig);
        println!(
            "{speed} {slip} {slip_angle} {camber}: rim {rim:.1} W, contact {expected:.1} W, {mean:.1} W, at the start {at_start:.1} W, sliding {:.1} W",
            get(&mut rig, "friction_power")
        );
        for (what, value) in [("mean", mean), ("energy", energy / 1.5), ("at the start", at_start)] {
            assert!(
                (value - expected).abs() < 0.01 * rim,
                "{what}: {value} W instead of {expected} W of {rim} W"
            );
        }
        // what the patch takes from the belt: the side wall as printed does not conserve power between
        // a rim and a belt that spin about different axes
        let (sin, cos) = yaw.sin_cos();
        let height = 0.338 - get(&mut rig, "actual_deflection") + offset_z;
        let heading = [vx * cos + vy * sin, vy * cos - vx * sin];
        let [fx, fy, my, mz] = patch;
        let belt = -(fx * (heading[0] - spin * height / tilt.cos())
            + fy * heading[1]
            + spin * (my * tilt.cos() + mz * tilt.sin()));
        for (what, value) in [("mean", mean), ("energy", energy / 1.5)] {
            assert_close(what, value, belt - rolling, 0.005);
        }
    }
}

/// The mean of the power over the second half of three seconds, from 1.5 s on.
fn means_of_power(rig: &mut FlatTrack) -> [f64; 1] {
    let mut sum = 0.0;
    for k in 1500..3000 {
        advance(rig, 1e-3, k, k + 1);
        sum += get(rig, "contact_power_loss") / 1500.0;
    }
    [sum]
}

/// A wheel that is turned to and fro on the spot without breaking away stores energy and gives it back.
#[test]
fn what_bristles_store_and_give_back_is_no_loss() {
    let mut rig = flat_track(&[("path_speed", 0.0)]);
    let (mut turning, mut lost) = (0.0, 0.0);
    let mut steer = 0.0;
    for k in 0..4000 {
        let t = f64::from(k) * 1e-3;
        let next = 0.004 * (3.0 * t).sin();
        set(&mut rig, &[("steer", next)]);
        advance(&mut rig, 1e-3, k, k + 1);
        turning += (get(&mut rig, "moment_z") * (next - steer)).abs();
        steer = next;
        let energy = get(&mut rig, "contact_energy_loss");
        assert!(energy >= lost - 1e-9, "energy comes back: {lost} {energy}");
        lost = energy;
    }
    assert_eq!(get(&mut rig, "sliding_distance"), 0.0);
    assert!(lost < 0.05 * turning, "{lost} J of {turning} J that went to and fro");
}

/// Points of usual measurements: straight, cornering, driving, braking, locked, combined, cambered.
const POINTS: [(f64, f64, f64, f64); 15] = [
    (0.0, 0.0, 0.0, 20.0),
    (0.0, 0.01, 0.0, 20.0),
    (0.0, 0.03, 0.0, 20.0),
    (0.0, 0.07, 0.0, 20.0),
    (0.0, 0.15, 0.0, 20.0),
    (0.02, 0.0, 0.0, 20.0),
    (-0.03, 0.0, 0.0, 20.0),
    (-0.1, 0.0, 0.0, 20.0),
    (-0.5, 0.0, 0.0, 20.0),
    (-1.0, 0.0, 0.0, 20.0),
    (-0.05, 0.05, 0.0, 20.0),
    (0.0, 0.0, 0.05, 20.0),
    (0.03, -0.05, 0.03, 10.0),
    (0.1, 0.0, 0.0, 30.0),
    (0.0, -0.1, -0.03, -5.0),
];

/// Falling friction damps less than nothing: at a slip angle of 0.15 what the sums over bristles are off by grows, the less
/// the finer they are.
#[test]
fn friction_that_falls_with_the_speed_has_stationary_starts_that_stay() {
    let finer = [
        ("step_size", 1e-4),
        ("bristles_per_stripe", 60.0),
        ("bristle_length", 0.007),
        ("bristle_stiffness", 2e4),
        ("bristle_damping", 0.325),
    ];
    let grids = [(&[][..], 0.035), (&finer, 0.02)];
    for (falloff, (grid, most)) in [0.01, 0.02, 0.05, 0.1].into_iter().flat_map(|f| grids.map(|g| (f, g))) {
        let mut missed = Vec::new();
        for (slip, slip_angle, camber, speed) in POINTS {
            let own = [
                ("slip", slip),
                ("slip_angle", slip_angle),
                ("camber", camber),
                ("path_speed", speed),
                ("friction_speed_falloff", falloff),
            ];
            let mut rig = flat_track(&[&own, grid].concat());
            if get(&mut rig, "stationary_start") != 1.0 {
                missed.push((slip, slip_angle, camber, speed));
                continue;
            }
            // at 0.1 s/m the falling friction makes the belt swing on its side wall
            if falloff > 0.05 {
                continue;
            }
            let start = ["force_x", "force_y"].map(|name| get(&mut rig, name));
            let late = means(&mut rig, ["force_x", "force_y"]);
            let scale = start[0].hypot(start[1]).max(100.0);
            for axis in 0..2 {
                let moved = (late[axis] - start[axis]).abs() / scale;
                assert!(moved < most, "{falloff} {slip} {slip_angle}: {start:?} becomes {late:?}");
            }
        }
        assert!(missed.is_empty(), "falloff {falloff}: {missed:?}");
    }
}
