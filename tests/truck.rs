//! The counterbalance truck: loads, symmetry, natural frequencies against a matrix of its own, what drives and what is lost, and the
//! carriage that jumps.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::Shipped;
use nalgebra::{DMatrix, DVector};

const TRUCK: &str = "super-elastic-counterbalance-truck";
const SIMPLE: &str = "linear-counterbalance-truck";

const BARE: (&str, f64) = ("road_kind", 1.0);

#[test]
fn wheels_carry_the_loads_of_the_levers_and_it_tips_over_with_too_much() {
    let mut empty = Shipped::new(TRUCK, &[BARE]);
    // by hand: moments about the rear axle
    let front = (2300.0 * (1.25 - 0.624) + 350.0 * 0.5 + 250.0 * 2.0) / 1.25 * 9.81 / 2.0;
    assert!((empty.get("front_left.force_z") / front - 1.0).abs() < 0.02, "{front}");
    assert!((front - 8000.0).abs() < 500.0, "{front}: about the source's 8000 N");
    let all: f64 = ["front_left", "front_right", "rear_left", "rear_right"]
        .iter()
        .map(|wheel| empty.get(&format!("{wheel}.force_z")))
        .sum();
    assert!((all / (2900.0 * 9.81) - 1.0).abs() < 0.02);
    // 8 km/h is 12.9 rad/s on the rear radius without load; the dynamic one is a little smaller
    let spin = empty.get("rear_left.wheel_speed");
    assert!(spin > 12.88 && spin < 13.3, "{spin}");
    let mut slave = common::shipped(TRUCK);
    common::set(&mut *slave, &[("payload", 3000.0)]);
    slave.start(0.0, None).unwrap();
    let message = slave.finish_start().unwrap_err().to_string();
    assert!(message.contains("tips over forward"), "{message}");
}

/// The source has a slip of about 5 % of the front wheels at 8 km/h: what the rolling resistance alone takes. Radial dampers that roll
/// take as much again, and more.
#[test]
fn the_front_wheels_slip_by_what_all_wheels_take() {
    let slip = |damping: f64| {
        let damped = ["front_tire.", "rear_tire."].map(|tire| format!("{tire}element_radial_damping"));
        let mut truck = Shipped::new(
            TRUCK,
            &[BARE, (&*damped[0], damping), (&*damped[1], damping), ("speed_gain_integral", 3e3)],
        );
        truck.step(8.0);
        let all = (0..100).map(|_| {
            truck.step(0.013);
            truck.get("front_left.slip")
        });
        all.sum::<f64>() / 100.0
    };
    let (without, with) = (slip(0.0), slip(280.0));
    assert!((without - 0.05).abs() < 0.01, "{without}");
    assert!(with > 2.0 * without && with < 0.2, "{with}");
}

/// It starts as it goes on, but for the ripple of elements, and what they take at the start is a mean over eight angles.
#[test]
fn it_keeps_its_speed_and_its_place() {
    let mut truck = Shipped::new(TRUCK, &[BARE]);
    for _ in 0..200 {
        truck.step(0.01);
        assert!((truck.get("truck_speed") - 8.0 / 3.6).abs() < 0.01, "{}", truck.get("truck_speed"));
        assert!(truck.get("chassis_height").abs() < 3e-4 && truck.get("chassis_pitch").abs() < 5e-4);
        assert!(truck.get("chassis_roll").abs() < 1e-9, "no side has more than the other");
    }
    // in the mean the drive gives what rolling takes
    assert!(truck.get("drive_torque_actual") > 0.0);
}

/// A cleat on the left and one on the right make mirror images; one on both no roll.
#[test]
fn left_and_right_are_mirror_images() {
    let start = ("road_start", 0.5);
    let mut runs = [2.0, 3.0].map(|tracks| Shipped::new(TRUCK, &[start, ("road_tracks", tracks)]));
    let mut both = Shipped::new(TRUCK, &[start]);
    let mut rolled = 0.0_f64;
    // what the left wheel's cleat does first: it lifts that side, so that the truck rolls to the right
    let mut first = None;
    for _ in 0..100 {
        let [left, right] = runs.each_mut().map(|run| {
            run.step(0.01);
            [
                "chassis_roll",
                "chassis_height",
                "axle_acceleration_left",
                "axle_acceleration_right",
                "cabin_roll",
            ]
            .map(|name| run.get(name))
        });
        rolled = rolled.max(left[0].abs());
        if left[0].abs() > 1e-3 && first.is_none() {
            first = Some(left[0]);
        }
        let mirrored = [-right[0], right[1], right[3], right[2], -right[4]];
        for (a, b) in left.iter().zip(mirrored) {
            assert!((a - b).abs() < 1e-7 * (1.0 + a.abs()), "{left:?} {right:?}");
        }
        both.step(0.01);
        assert!(both.get("chassis_roll").abs() < 1e-9);
    }
    assert!(rolled > 2e-3 && first.unwrap() > 0.0, "{rolled} {first:?}");
}

/// What a torque of the drive does at last: the rear wheels take what accelerates all masses at their heights and the wheels about
/// their axes, and the nose rises. No more torque than the drive has.
#[test]
fn a_torque_of_the_drive_lifts_the_nose() {
    let level = [
        BARE,
        ("drive", 2.0),
        ("front_tire.rolling_resistance", 0.0),
        ("rear_tire.rolling_resistance", 0.0),
        ("front_tire.vertical_damping", 8000.0),
        ("rear_tire.vertical_damping", 8000.0),
        ("drive_torque", 600.0),
    ];
    let mut truck = Shipped::new(SIMPLE, &level);
    assert_eq!(truck.get("chassis_pitch"), 0.0);
    let load = truck.get("rear_left.force_z");
    truck.step(5.0);
    let (before, spins) = (truck.get("truck_speed"), ["front_left", "rear_left"]);
    let turning = spins.map(|wheel| truck.get(&format!("{wheel}.wheel_speed")));
    truck.step(0.5);
    let acceleration = 2.0 * (truck.get("truck_speed") - before);
    assert!(acceleration > 0.5, "{acceleration}");
    let spun = [0, 1].map(|i| 2.0 * (truck.get(&format!("{}.wheel_speed", spins[i])) - turning[i]));
    let moment =
        acceleration * (2300.0 * 0.6 + 350.0 * 1.4 + 250.0 * 0.6) + 2.0 * (3.0 * spun[0] + 0.08 * spun[1]);
    let more = 2.0 * (truck.get("rear_left.force_z") - load);
    assert!((more / (moment / 1.25) - 1.0).abs() < 0.01, "{more} {}", moment / 1.25);
    // springs of 2 x 5e5 N/m under each axle
    let pitch = -2.0 * more / 1e6 / 1.25;
    assert!((truck.get("chassis_pitch") / pitch - 1.0).abs() < 0.01, "{pitch}");

    let mut strong = Shipped::new(SIMPLE, &[BARE, ("drive", 2.0), ("drive_torque", 1e5)]);
    assert_eq!(strong.get("drive_torque_actual"), 2000.0);
    strong.step(0.1);
    assert_eq!(strong.get("drive_torque_actual"), 2000.0);
}

/// Softer front tires, tuned while it stands: they sink by the load over what their stiffness has lost, and the rear ones do not.
#[test]
fn parameters_of_tires_are_tuned_on_their_wheels() {
    let mut truck = Shipped::new(SIMPLE, &[BARE, ("speed", 0.0)]);
    truck.step(0.5);
    truck.set("front_tire.vertical_stiffness", 2.5e5);
    truck.step(10.0);
    let load = (2300.0 * (1.25 - 0.624) + 350.0 * 0.5 + 250.0 * 2.0) / 1.25 * 9.81 / 2.0;
    let lower = load / 2.5e5 - load / 5e5;
    assert!((truck.get("chassis_pitch") / (lower / 1.25) - 1.0).abs() < 0.01, "{lower}");
    let rear = truck.get("chassis_height") + truck.get("chassis_pitch") * (1.25 - 0.624);
    assert!(rear.abs() < 0.01 * lower, "{rear} {lower}");

    // and those of the tire with elements, which has parameters of another kind
    let mut truck = Shipped::new(TRUCK, &[BARE, ("speed", 0.0)]);
    truck.step(0.5);
    truck.set("rear_tire.stiffness_factor", 0.5);
    truck.step(3.0);
    let (height, pitch) = (truck.get("chassis_height"), truck.get("chassis_pitch"));
    let [front, rear] = [0.624, 0.624 - 1.25].map(|x| height - x * pitch);
    assert!(front.abs() < 5e-4 && rear < -5e-3, "{front} {rear}");
}

/// The roof goes as the cabin's centre of mass, and turns about that.
#[test]
fn the_roof_turns_about_the_cabins_centre_of_mass() {
    let mut truck = Shipped::new(SIMPLE, &[("road_start", 0.5)]);
    let step = 1e-3;
    let course: Vec<[f64; 3]> = (0..1000)
        .map(|_| {
            truck.step(step);
            ["truck_speed", "cabin_pitch", "roof_acceleration"].map(|name| truck.get(name))
        })
        .collect();
    let (mut off, mut most) = (0.0_f64, 0.0_f64);
    for three in course.windows(3) {
        let [[v0, p0, _], [_, p1, roof], [v2, p2, _]] = *three else { unreachable!() };
        let expected = (v2 - v0) / (2.0 * step) + (2.1 - 1.4) * (p2 - 2.0 * p1 + p0) / (step * step);
        (off, most) = (off.max((roof - expected).abs()), most.max(roof.abs()));
    }
    assert!(most > 0.5 && off < 0.05 * most, "{off} {most}");
}

#[test]
fn an_obstacle_under_a_wheel_at_the_start_is_refused() {
    let mut slave = common::shipped(TRUCK);
    common::set(&mut *slave, &[("road_start", -0.1)]);
    slave.start(0.0, None).unwrap();
    let message = slave.finish_start().unwrap_err().to_string();
    assert!(message.contains("level road") && message.contains("road_start"), "{message}");
}

/// Frequencies of a truck on linear tires that rocks by little, from mass and stiffness matrices of their own.
#[test]
fn it_rocks_with_the_frequencies_of_its_matrices() {
    let (kf, kr, mount, chain) = (5e5, 5e5, 3e5, 1.5e6);
    // chassis z, pitch; cabin z, pitch; carriage z. Points: front axle, bolster, mounts, fork
    let mass = DMatrix::from_diagonal(&DVector::from_vec(vec![2300.0, 900.0, 350.0, 90.0, 250.0]));
    let mut stiffness = DMatrix::zeros(5, 5);
    let mut spring = |k: f64, row: [f64; 5]| {
        let row = DVector::from_row_slice(&row);
        stiffness += &row * row.transpose() * k;
    };
    let (cg, cabin) = (-0.624, -0.75);
    spring(2.0 * kf, [1.0, cg, 0.0, 0.0, 0.0]);
    spring(2.0 * kr, [1.0, 1.25 + cg, 0.0, 0.0, 0.0]);
    for at in [-0.4, 0.4] {
        spring(2.0 * mount, [-1.0, cabin + at - cg, 1.0, -at, 0.0]);
    }
    spring(chain, [-1.0, 0.75 - cg, 0.0, 0.0, 1.0]);
    let root = mass.map(|m: f64| if m > 0.0 { 1.0 / m.sqrt() } else { 0.0 });
    let modes = (&root * stiffness * &root).symmetric_eigen();
    let mut frequencies: Vec<f64> =
        modes.eigenvalues.iter().map(|w| w.sqrt() / std::f64::consts::TAU).collect();
    frequencies.sort_by(f64::total_cmp);

    // a tiny step lets it ring without dampers
    let undamped = [
        ("front_tire.vertical_damping", 0.0),
        ("rear_tire.vertical_damping", 0.0),
        ("mount_damping", 0.0),
        ("chain_damping", 0.0),
        ("road_kind", 2.0),
        ("road_height", 1e-5),
        ("road_start", 0.3),
        ("step_size", 1e-4),
        ("front_tire.rolling_resistance", 0.0),
        ("rear_tire.rolling_resistance", 0.0),
    ];
    let mut truck = Shipped::new(SIMPLE, &undamped);
    truck.step(0.8);
    let (step, count) = (2e-3, 8192);
    let course: Vec<f64> = (0..count)
        .map(|_| {
            truck.step(step);
            truck.get("chassis_height") - 0.7 * truck.get("chassis_pitch") + truck.get("cabin_pitch")
        })
        .collect();
    let mean = course.iter().sum::<f64>() / course.len() as f64;
    let power = |f: f64| {
        let (mut re, mut im) = (0.0, 0.0);
        for (n, x) in course.iter().enumerate() {
            let phase = std::f64::consts::TAU * f * step * n as f64;
            let window = 0.5 - 0.5 * (std::f64::consts::TAU * n as f64 / course.len() as f64).cos();
            re += window * (x - mean) * phase.cos();
            im += window * (x - mean) * phase.sin();
        }
        re * re + im * im
    };
    for expected in &frequencies[..4] {
        // the peak within 4 % of it
        let best = (-80..=80)
            .map(|k| expected * (1.0 + 5e-4 * f64::from(k)))
            .max_by(|a, b| power(*a).total_cmp(&power(*b)))
            .unwrap();
        assert!((best / expected - 1.0).abs() < 5e-3, "{best} {expected} of {frequencies:?}");
    }
}

/// Without a drive it slows down by what its wheels take, over all that travels.
#[test]
fn it_coasts_by_its_rolling_resistance() {
    let mut truck = Shipped::new(SIMPLE, &[BARE, ("drive", 2.0)]);
    truck.step(1.0);
    let before = truck.get("truck_speed");
    truck.step(1.0);
    let lost = before - truck.get("truck_speed");
    // 2900 kg and what turns: 2 x 3 on 0.21 m, 2 x 0.08 on 0.16 m; moments f R0 Fz act over the rolling radii
    let (front, rear) = (2.0 * 8298.0, 2900.0 * 9.81 - 2.0 * 8298.0);
    let radius = |r0: f64, load: f64| r0 - 0.5 * load / 5e5;
    let (rf, rr) = (radius(0.2265, front), radius(0.1725, rear));
    let resistance = 0.015 * (front * 0.2265 / rf + rear * 0.1725 / rr);
    let mass = 2900.0 + 6.0 / (rf * rf) + 0.16 / (rr * rr);
    assert!((lost / (resistance / mass) - 1.0).abs() < 0.02, "{lost} {}", resistance / mass);
}

/// Empty forks jump when the front wheels have crossed a high cleat; a payload, with stiffer chains to its weight, does not.
#[test]
fn empty_forks_jump_and_loaded_ones_do_not() {
    let least = |payload: f64| {
        let mut truck = Shipped::new(TRUCK, &[("payload", payload), ("road_start", 0.5)]);
        (0..1500)
            .map(|_| {
                truck.step(1e-3);
                truck.get("chain_force")
            })
            .fold(f64::INFINITY, f64::min)
    };
    let (empty, loaded) = (least(0.0), least(875.0));
    assert!(empty == 0.0, "{empty}");
    assert!(loaded > 0.0, "{loaded}");
}
