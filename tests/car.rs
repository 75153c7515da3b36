//! The car against closed forms: balance at the start, energy, mirror images, load transfer, levers of the steering axis, the rack's
//! own frequency, slabs.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::{Shipped, advance, assert_close, get, set, started};
use latsch::model::Native;
use latsch::rig::Vehicle;
use latsch::tire::magic_formula::MagicFormula;

const CAR: &str = "magic-formula-vehicle";
const WHEELS: [&str; 4] = ["front_left", "front_right", "rear_left", "rear_right"];
const GRAVITY: f64 = 9.81;

fn brake(car: &mut Shipped, front: f64, rear: f64) {
    for (i, wheel) in WHEELS.iter().enumerate() {
        car.set(&format!("{wheel}.brake_torque"), if i < 2 { front } else { rear });
    }
}

fn run(car: &mut Shipped, seconds: f64) {
    (0..(1e3 * seconds).round() as usize).for_each(|_| car.step(1e-3));
}

/// What the air and rolling take slows all of it down together, and nothing else moves. The ring-and-brush tire does not know of that
/// at its start: its belt of 8.8 kg takes 2 N of the rolling resistance with it.
#[test]
fn it_starts_in_balance() {
    for name in [CAR, "ring-brush-vehicle"] {
        let mut car = Shipped::new(name, &[]);
        let (pull, slow) = (car.get("longitudinal_acceleration"), car.get("vehicle_speed"));
        assert!(pull < 0.0 && pull > -0.5, "{name}: {pull}");
        let still = ["vertical_acceleration", "lateral_acceleration", "roll", "yaw_rate"];
        for k in 0..200 {
            for output in still {
                assert!(car.get(output).abs() < 1e-3, "{name}, step {k}: {output} = {}", car.get(output));
            }
            for wheel in WHEELS {
                let travel = car.get(&format!("{wheel}.wheel_travel"));
                assert!(travel.abs() < 5e-5, "{name}, step {k}: {wheel} travels {travel} m");
            }
            car.step(1e-3);
        }
        assert_close("speed", car.get("vehicle_speed"), slow + 0.2 * pull, 1e-3);
        // front: 1650 kg times the share 0.91 / 2.35
        let front = car.get("front_left.force_z") + car.get("front_right.force_z");
        assert_close("front axle", front, 1650.0 * GRAVITY * 0.91 / 2.35, 5e-3);
    }
}

/// A stop on slabs, half on ice, with a turn of the steering wheel: all that moves and deforms gives and takes energy, and what is
/// lost is what brakes, dampers, contacts and the air took.
#[test]
fn a_stop_keeps_account_of_its_energy() {
    let mut car: Native<Vehicle<MagicFormula>> = started(&[
        ("road_kind", 7.0),
        ("road_start", 6.0),
        ("road_height", 0.03),
        ("rack_friction", 100.0),
        ("step_size", 1e-4),
    ]);
    let energy = |car: &Native<Vehicle<MagicFormula>>| car.model().energy();
    let at_start = energy(&car);
    let moving = 0.5 * 1650.0 * (80.0_f64 / 3.6).powi(2);
    for (i, wheel) in WHEELS.iter().enumerate() {
        let torque = if i < 2 { 900.0 } else { 600.0 };
        set(&mut car, &[(&format!("{wheel}.brake_torque"), torque)]);
    }
    set(&mut car, &[("front_left.friction_factor", 0.4), ("rear_left.friction_factor", 0.4)]);
    let mut worst = 0.0_f64;
    for k in 0..2500 {
        let angle = 0.5 * (f64::from(k) * 4e-3).sin();
        set(&mut car, &[("steering_wheel_angle", angle)]);
        advance(&mut car, 1e-3, k, k + 1);
        worst = worst.max((energy(&car) + car.model().lost() - at_start).abs() / moving);
    }
    assert!(car.model().lost() > 0.5 * moving && get(&mut car, "yaw_rate").abs() > 1e-3);
    assert!(worst < 1e-4, "{worst}");
}

/// Left and right exchanged, everything is exchanged, tires with conicity and ply steer too.
#[test]
fn a_mirrored_run_is_the_mirror_image() {
    let drive = |side: f64, lopsided: f64| {
        let mut values = vec![("road_kind", 7.0), ("road_start", 6.0), ("road_height", 0.03)];
        for (name, value) in [
            ("front_tire.PHY1", 0.004),
            ("front_tire.PVY1", 0.05),
            ("front_tire.QSX1", 0.01),
            ("front_tire.QHZ1", 0.01),
            ("rear_tire.PVY1", 0.03),
        ] {
            values.push((name, lopsided * value));
        }
        let mut car = Shipped::new(CAR, &values);
        let mut last = Vec::new();
        for k in 0..800 {
            car.set("steering_wheel_angle", side * 0.8 * (f64::from(k) * 5e-3).sin());
            let order = if side > 0.0 { [0, 1, 2, 3] } else { [1, 0, 3, 2] };
            for (i, torque) in [(0, 900.0), (1, 300.0), (2, 500.0), (3, 0.0)] {
                car.set(&format!("{}.brake_torque", WHEELS[order[i]]), torque);
            }
            car.step(1e-3);
            last = vec![
                car.get("vehicle_speed"),
                side * car.get("yaw_rate"),
                side * car.get("lateral_acceleration"),
                side * car.get("rack_displacement"),
                car.get(&format!("{}.longitudinal_link_force", WHEELS[order[0]])),
                car.get(&format!("{}.transverse_link_force", WHEELS[order[1]])),
                car.get(&format!("{}.tie_rod_force", WHEELS[order[1]])),
                side * car.get(&format!("{}.carrier_moment_z", WHEELS[order[2]])),
                car.get(&format!("{}.link_force_5", WHEELS[order[3]])),
            ];
        }
        last
    };
    let plain = drive(1.0, 0.0);
    for lopsided in [0.0, 1.0] {
        let (left, right) = (drive(1.0, lopsided), drive(-1.0, lopsided));
        assert!(left[1].abs() > 0.1, "it turns: {left:?}");
        for (a, b) in left.iter().zip(&right) {
            assert!((a - b).abs() < 1e-9 * (1.0 + a.abs()), "{left:?}\n{right:?}");
        }
        let change = (left[6] - plain[6]).abs();
        assert_eq!(change > 10.0, lopsided > 0.0, "a tie rod's force changes by {change} N");
    }
}

/// Links that give way by next to nothing, and no air.
const STIFF: &[(&str, f64)] = &[
    ("step_size", 1e-4),
    ("front_longitudinal_link_stiffness", 3e7),
    ("front_transverse_link_stiffness", 3e7),
    ("front_strut_top_stiffness", 3e7),
    ("front_tie_rod_stiffness", 1e7),
    ("rear_link_stiffness", 2e7),
    ("drag_area", 0.0),
    ("front_lift_area", 0.0),
    ("rear_lift_area", 0.0),
];
const INCLINATION: f64 = 0.174533;
const CASTER: f64 = 0.139626;
/// A wheel with its carrier \[kg\].
const UNSPRUNG: f64 = 40.0;

fn stiff(more: &[(&str, f64)]) -> Shipped {
    let values: Vec<_> = STIFF.iter().chain(more).copied().collect();
    Shipped::new(CAR, &values)
}

/// m a h / L, with heights and places as they are then: the whole car about the point of the road below the front wheels.
#[test]
fn braking_moves_load_forward() {
    let mut car = stiff(&[("initial_speed", 40.0)]);
    let trail = car.get("front_trail");
    let height = (trail + 0.012) / CASTER.tan();
    let body = 1650.0 - 4.0 * UNSPRUNG;
    let front = 2.0 * car.get("front_left.force_z");
    brake(&mut car, 1000.0, 900.0);
    run(&mut car, 2.0);
    // the body's centre of mass at the start, from the point of the road below the front axle
    let centre =
        [(-1650.0 * 1.44 + 2.0 * UNSPRUNG * 2.35) / body, (1650.0 * 0.48 - 4.0 * UNSPRUNG * height) / body];
    let (sin, cos) = car.get("pitch").sin_cos();
    let mut place = |wheel: &str, x: f64| {
        let along = x - centre[0] + car.get(&format!("{wheel}.wheel_fore_aft"));
        let up = height - centre[1] + car.get(&format!("{wheel}.wheel_travel"));
        along * cos + up * sin
    };
    let (before, behind) = (place("front_left", 0.0), -place("rear_left", -2.35));
    let over = centre[1] + car.get("body_height");
    let slows = -car.get("longitudinal_acceleration");
    let moment = body * (GRAVITY * before + slows * over)
        + 2.0 * UNSPRUNG * (GRAVITY * (before + behind) + 2.0 * slows * height);
    // the load of the rear wheels holds the weight, and what slows it down lets them go
    let weights = body * GRAVITY * before + 2.0 * UNSPRUNG * GRAVITY * (before + behind);
    let rear = (weights - (moment - weights)) / (before + behind);
    assert_close("rear", 2.0 * car.get("rear_left.force_z"), rear, 5e-3);
    assert_close("front", 2.0 * car.get("front_left.force_z"), 1650.0 * GRAVITY - rear, 5e-3);
    // and about as much as the textbook says
    let transferred = 2.0 * car.get("front_left.force_z") - front;
    assert_close("transferred", transferred, 1650.0 * slows * 0.48 / 2.35, 0.05);
}

/// Where nothing gives way, moments about the steering axis are the forces times the levers of (6.17) to (6.26).
#[test]
fn levers_of_the_steering_axis_are_those_of_the_formulas() {
    let mut car = stiff(&[("front_toe", 0.0), ("front_camber", 0.0)]);
    let about = |car: &mut Shipped, cause: &str| car.get(&format!("front_left.steering_moment_{cause}"));
    let radius = (car.get("front_trail") + 0.012) / CASTER.tan();
    let [brake_lever, load_lever] =
        ["brake", "load"].map(|lever| car.get(&format!("front_lever_arm_{lever}")));
    // the wheel's centre stands beside the axis
    let hub_lever = brake_lever + radius * INCLINATION.sin();
    assert_close("load", -about(&mut car, "vertical"), car.get("front_left.force_z") * load_lever, 1e-3);
    let slows = -car.get("longitudinal_acceleration");
    let inertia = UNSPRUNG * (GRAVITY * load_lever - slows * hub_lever * CASTER.cos());
    assert_close("inertia", about(&mut car, "inertia"), inertia, 0.02);
    let opposite = -car.get("front_right.steering_moment_vertical");
    assert_eq!(about(&mut car, "vertical"), opposite);

    brake(&mut car, 500.0, 300.0);
    run(&mut car, 1.0);
    // of what turns the wheel only what the brake takes is on the carrier
    let force = -car.get("front_left.force_x");
    let along = CASTER.cos() * (force * hub_lever - 500.0 * INCLINATION.sin());
    assert_close("along", about(&mut car, "longitudinal"), along, 0.02);
    let tie_rod = car.get("front_left.tie_rod_force") * 0.13 * CASTER.cos() * INCLINATION.cos();
    assert_close("tie rod", about(&mut car, "tie_rod"), -tie_rod, 0.02);
    assert_close("brake", car.get("front_left.carrier_moment_y"), 500.0, 1e-3);
}

/// Braking lifts the body over a front wheel by anti_dive times its braking force: by virtual work of the wheel's travel, gently, so
/// that links keep their slopes.
#[test]
fn anti_dive_is_what_it_says() {
    const TOP: f64 = 0.75;
    let torque = 50.0;
    let braked = |anti_dive: f64| {
        let mut car = stiff(&[("front_anti_dive", anti_dive)]);
        let height = (car.get("front_trail") + 0.012) / CASTER.tan();
        let told = |car: &mut Shipped| {
            let [push, force] = ["strut_force", "force_x"].map(|what| car.get(&format!("front_left.{what}")));
            [push, -force, -car.get("longitudinal_acceleration")]
        };
        let before = told(&mut car);
        brake(&mut car, torque, 30.0);
        run(&mut car, 3.0);
        let after = told(&mut car);
        let ratio = car.get("front_left.strut_travel") / car.get("front_left.wheel_travel");
        let [push, force, slows] = [0, 1, 2].map(|i| after[i] - before[i]);
        (push * ratio, force, slows, height)
    };
    let (without, force, slows, height) = braked(0.0);
    for anti_dive in [0.1, 0.3] {
        let lifted = without - braked(anti_dive).0;
        // the road's force at the wheel's centre less what the masses there take, and the brake's torque on the carrier, which
        // turns about the strut's top
        let expected = anti_dive * ((force - UNSPRUNG * slows) * (1.0 - height / TOP) + torque / TOP);
        // the strut leans inward and cambers the wheel, whose centre, 12 mm outside of the ball joint, then rises a little more
        let camber_rate = INCLINATION.tan() / (TOP - 0.17);
        let rises = 1.0 + INCLINATION.tan().powi(2);
        let expected = expected * rises / (rises + camber_rate * 0.0122);
        assert_close("lifted", lifted, expected, 0.01);
    }
}

/// The mode of wheels that steer together: k / (m + 2 J / r²), with the tie rods in series to the column.
#[test]
fn the_rack_swings_with_its_own_frequency() {
    for column in [0.3e6, 0.6e6, 1.2e6] {
        let mut car = stiff(&[
            ("column_stiffness", column),
            ("column_damping", 20.0),
            ("initial_speed", 0.2),
            ("command_actuators", 0.0),
            ("front_tie_rod_stiffness", 6e6),
            ("front_camber", 0.0),
        ]);
        WHEELS.iter().for_each(|wheel| car.set(&format!("{wheel}.friction_factor"), 0.0));
        car.set("steering_wheel_angle", 0.05);
        // ends of half swings, behind what the stiff parts do first
        let (mut turns, mut last) = (Vec::new(), [0.0; 2]);
        for k in 0..6000 {
            car.step(1e-4);
            let now = car.get("rack_displacement");
            if k > 200 && (now - last[1]) * (last[1] - last[0]) < 0.0 {
                turns.push(f64::from(k) * 1e-4);
            }
            last = [last[1], now];
        }
        let found = (turns.len() - 1) as f64 / 2.0 / (turns[turns.len() - 1] - turns[0]);
        // about the axis: carrier with wheel, and its mass beside it
        let arm = 0.13 * CASTER.cos() * INCLINATION.cos();
        let beside = (0.0417_f64.powi(2) + 0.012_f64.powi(2)) * UNSPRUNG;
        let mass = 4.0 + 2.0 * (0.9 + beside) / (arm * arm);
        let stiffness = 1.0 / (1.0 / column + 1.0 / 12e6);
        assert_close("frequency", found, (stiffness / mass).sqrt() / std::f64::consts::TAU, 0.02);
    }
}

/// Slabs of 15 m: behind each drop the wheel falls longer than its tire reaches.
#[test]
fn wheels_lose_the_road_behind_a_slab() {
    // times of an independent program of a simpler car, behind the onset of the brake
    for (height, drops) in [(0.0, vec![]), (0.05, vec![0.049, 0.862])] {
        let slabs = [("road_kind", 7.0), ("road_start", 2.0), ("road_height", height), ("step_size", 2e-4)];
        let mut car = Shipped::new(CAR, &slabs);
        let (mut lost, mut off) = (Vec::new(), false);
        for k in 0..1800 {
            // the brake comes 1.1 m before the first drop
            if k == 716 {
                brake(&mut car, 1200.0, 900.0);
            }
            car.step(1e-3);
            let now = car.get("front_left.force_z") <= 0.0;
            if now && !off {
                lost.push(1e-3 * f64::from(k) - 0.716);
            }
            off = now;
        }
        assert_eq!(lost.len(), drops.len(), "{height} m: {lost:?}");
        for (at, expected) in lost.iter().zip(&drops) {
            assert!((at - expected).abs() < 0.02, "{height} m: {lost:?}");
        }
    }
}

/// Forces of the wheels on their carriers, as the car's measuring rims tell them on slabs under a brake that pulls to the left, give
/// the axle in a rig the link forces of the road. What is left is the turning of the body, which the rig does not have.
#[test]
fn an_axle_in_a_rig_finds_the_link_forces_of_the_road() {
    let slabs = [("road_kind", 7.0), ("road_start", 2.0), ("road_height", 0.02), ("step_size", 2e-4)];
    let mut car = Shipped::new(CAR, &slabs);
    let height = (car.get("front_trail") + 0.012) / CASTER.tan();
    let sides = [("front_left", "left"), ("front_right", "right")];
    let rim = ["force_x", "force_y", "force_z", "moment_x", "moment_y", "moment_z"];
    let body = [("longitudinal", "x"), ("lateral", "y"), ("vertical", "z")];
    let measured = |car: &mut Shipped| {
        let mut all = Vec::new();
        for (from, to) in sides {
            for name in rim {
                all.push((format!("{to}.carrier_{name}"), car.get(&format!("{from}.carrier_{name}"))));
            }
        }
        for (from, to) in body {
            all.push((format!("body_acceleration_{to}"), car.get(&format!("{from}_acceleration"))));
        }
        all
    };
    let mut start = measured(&mut car);
    start.push(("wheel_centre_height".into(), height));
    let start: Vec<_> = start.iter().map(|(name, value)| (name.as_str(), *value)).collect();
    let mut axle = Shipped::new("axle", &start);
    let links = ["longitudinal_link", "transverse_link", "tie_rod", "strut"];
    let mut courses = vec![(Vec::new(), Vec::new()); 2 * links.len()];
    for k in 0..1600 {
        if k == 500 {
            for (wheel, torque) in WHEELS.iter().zip([900.0, 500.0, 600.0, 300.0]) {
                car.set(&format!("{wheel}.brake_torque"), torque);
            }
        }
        car.step(1e-3);
        for (name, value) in measured(&mut car) {
            axle.set(&name, value);
        }
        axle.step(1e-3);
        for (i, (on_road, in_rig)) in courses.iter_mut().enumerate() {
            let (side, link) = (sides[i / links.len()], links[i % links.len()]);
            on_road.push(car.get(&format!("{}.{link}_force", side.0)));
            in_rig.push(axle.get(&format!("{}.{link}_force", side.1)));
        }
    }
    for (i, (on_road, in_rig)) in courses.iter().enumerate() {
        let mean = on_road.iter().sum::<f64>() / on_road.len() as f64;
        let rms = |of: &dyn Fn(usize) -> f64| {
            ((0..on_road.len()).map(|k| of(k).powi(2)).sum::<f64>() / on_road.len() as f64).sqrt()
        };
        let share = rms(&|k| on_road[k] - in_rig[k]) / rms(&|k| on_road[k] - mean);
        assert!(share < 0.15, "{} {}: {share}", sides[i / links.len()].0, links[i % links.len()]);
    }
}

/// The step that the refusal of a longer one advises is stable, on a rough road.
#[test]
fn a_step_that_is_too_long_is_refused_with_one_that_is_not() {
    let mut slave = common::shipped(CAR);
    set(&mut *slave, &[("step_size", 1e-3), ("rack_mass", 1.0)]);
    let error = slave.start(0.0, None).and_then(|()| slave.finish_start()).unwrap_err().to_string();
    assert!(error.contains("the rack;"), "{error}");
    let limit: f64 =
        error.split("take a step_size of ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    let rough = [("road_kind", 6.0), ("road_start", 3.0), ("rack_mass", 1.0), ("step_size", limit)];
    let mut car = Shipped::new(CAR, &rough);
    run(&mut car, 2.0);
    assert!(car.get("rack_displacement").abs() < 0.01);
}

/// A coupling drags front and rear wheels to one speed, and one that the step cannot take is refused.
#[test]
fn a_coupling_brings_axles_to_one_speed() {
    let faster = |coupling: f64| {
        let mut car = Shipped::new(CAR, &[("coupling_damping", coupling), ("step_size", 1e-4)]);
        brake(&mut car, 400.0, 0.0);
        run(&mut car, 0.5);
        let [front, rear] = ["front_left", "rear_left"].map(|wheel| car.get(&format!("{wheel}.wheel_speed")));
        // it brakes the rear wheels with what it gives the front ones
        let rear_force = car.get("rear_left.force_x");
        (rear - front, rear_force)
    };
    let (without, with) = (faster(0.0), faster(500.0));
    assert!(without.0 > 0.5 && with.0 < 0.5 * without.0 && with.0 > 0.0, "{without:?} {with:?}");
    assert!(with.1 < without.1 - 100.0, "{without:?} {with:?}");
    let mut slave = common::shipped(CAR);
    set(&mut *slave, &[("coupling_damping", 2e4)]);
    let error = slave.start(0.0, None).and_then(|()| slave.finish_start()).unwrap_err().to_string();
    assert!(error.contains("coupling_damping"), "{error}");
}

/// Joints that make no suspension are refused by name.
#[test]
fn joints_that_do_not_hold_a_wheel_are_refused() {
    let refused = |values: &[(&str, f64)], text: Option<(&str, &str)>| {
        let mut slave = common::shipped(CAR);
        set(&mut *slave, values);
        if let Some((name, text)) = text {
            let index = slave.find(name).unwrap();
            slave.set_text(index, text).unwrap();
        }
        slave.start(0.0, None).and_then(|()| slave.finish_start()).unwrap_err().to_string()
    };
    let meeting = "0.3 0.4 0.2 0 0.7 0.2; -0.3 0.4 0.2 0 0.7 0.2; 0.3 0.4 0.4 0 0.7 0.2; -0.3 0.4 0.4 0 0.7 0.2; 0 0.4 0.3 0 0.7 0.2";
    for (values, text, words) in [
        (&[("front_ball_joint_height", -0.1)][..], None, "front_ball_joint_height"),
        (&[("front_strut_top_height", 0.1)], None, "front_strut_top_height"),
        (
            &[
                ("front_anti_dive", 1.0),
                ("front_longitudinal_link_angle", 0.0),
                ("front_ball_joint_height", 0.0),
            ],
            None,
            "front_anti_dive",
        ),
        (&[("front_steering_arm", 0.001)], None, "front_steering_arm"),
        (&[("vehicle_mass", 100.0)], None, "vehicle_mass"),
        (&[("centre_of_mass_x", 2.4)], None, "centre_of_mass_x"),
        (&[], Some(("rear_links", meeting)), "do not hold its wheel"),
        (&[], Some(("rear_links", "0 0 0")), "rear_links"),
        (&[], Some(("rear_strut", "")), "rear_strut"),
        (&[], Some(("front_damper", "0 10; 1 20")), "front_damper"),
        (
            &[("road_kind", 4.0), ("road_start", -2.5), ("road_height", 0.01), ("road_length", 0.5)],
            None,
            "rear left wheel",
        ),
    ] {
        let error = refused(values, text);
        assert!(error.contains(words), "{words}: {error}");
    }
}
