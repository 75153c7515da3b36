//! The car against mechanics, and cases as they are drawn.

use super::axle::{front, lifts, on_steering_axis};
use super::brake::Brake;
use super::case::{Drawn, record, study};
use super::concealed::{OFFERS, Offer};
use super::controller::{Controller, Phase};
use super::parameters::{GRAVITY, Parameters, WHEELBASE};
use super::programme::KINDS;
use super::road::{Road, Scatter, Slabs};
use super::vehicle::{CarTold, Vehicle};
use super::world::{STEP, World};
use crate::random::Random;
use crate::simulate::Ideal;
use std::f64::consts::TAU;

const SEED: u64 = 1;
const SPEED: f64 = 80.0 / 3.6;

fn level() -> Road {
    Road { slabs: None, friction: [Scatter::none(1.0), Scatter::none(1.0)] }
}

/// Goes on for so long, with brake torques over time.
fn drive(car: &mut Vehicle, road: &Road, duration: f64, brakes: impl Fn(f64) -> [f64; 4]) -> Vec<CarTold> {
    let count = (duration / STEP).round() as u32;
    let told = |n| {
        let torques = brakes(f64::from(n) * STEP);
        car.step(road, torques, STEP);
        car.told(road, torques)
    };
    (0..count).map(told).collect()
}

#[test]
fn a_car_that_rolls_is_in_balance() {
    let p = Parameters::default();
    let mut car = Vehicle::rolls(&p, SPEED, [1.0; 2]).unwrap();
    let start = car.told(&level(), [0.0; 4]);
    let rolls = drive(&mut car, &level(), 0.2, |_| [0.0; 4]);
    let (first, last) = (start.wheels[0], rolls.last().unwrap().wheels[0]);
    for (a, b) in first.links.iter().zip(last.links) {
        // a wheel that starts free of torque falls behind by what slows it down
        assert!((a - b).abs() < 3.0, "{first:?} {last:?}");
    }
    assert!((first.strut - last.strut).abs() < 0.5);
    // standing, the axles would carry these; lift, drag and what slows the car down make a part of a percent
    let behind = p.vehicle_mass * GRAVITY * p.centre_of_mass_x / WHEELBASE;
    assert!((2.0 * start.wheels[2].tire_force.z() / behind - 1.0).abs() < 0.005);
}

#[test]
fn no_energy_comes_from_nowhere() {
    let p = Parameters { coupling_damping: 40.0, ..Parameters::default() };
    let road = Road {
        slabs: Some(Slabs { start: 1.0, length: 8.0, drop: 0.0 }),
        friction: [Scatter::none(1.0), Scatter::none(0.4)],
    };
    let mut car = Vehicle::rolls(&p, SPEED, [1.0, 0.4]).unwrap();
    let before = car.energy();
    drive(&mut car, &road, 1.0, |t| [900.0, 500.0, 300.0, 400.0].map(|m| m * (t / 0.1).min(1.0)));
    let motion = 0.5 * p.vehicle_mass * SPEED * SPEED;
    assert!((car.energy() - before).abs() < 1e-8 * motion, "{}", car.energy() - before);
    assert!(car.told(&road, [0.0; 4]).speed < 0.85 * SPEED);
}

#[test]
fn left_and_right_are_alike() {
    let p = Parameters::default();
    let run = |left: f64, right: f64| {
        let mut car = Vehicle::rolls(&p, SPEED, [1.0; 2]).unwrap();
        drive(&mut car, &level(), 0.3, |_| [left, right, 300.0, 300.0])
    };
    for (a, b) in run(900.0, 500.0).iter().zip(run(500.0, 900.0)) {
        assert!((a.yaw_rate + b.yaw_rate).abs() < 1e-9 && (a.column + b.column).abs() < 1e-4);
        for k in 0..4 {
            let off = a.wheels[k].carrier_force - b.wheels[k ^ 1].carrier_force.mirrored();
            assert!(off.length() < 1e-4, "{off:?}");
            assert!((a.wheels[k].strut - b.wheels[k ^ 1].strut).abs() < 1e-4);
        }
    }
}

#[test]
fn braking_loads_the_front_by_inertia_times_height() {
    let p = Parameters::default();
    let mut car = Vehicle::rolls(&p, SPEED, [1.0; 2]).unwrap();
    let before = car.told(&level(), [0.0; 4]);
    let brakes = |t: f64| [1100.0, 1100.0, 700.0, 700.0].map(|m| m * (t / 0.3).min(1.0));
    let told = *drive(&mut car, &level(), 1.5, brakes).last().unwrap();
    assert!(
        told.acceleration < -6.0 && told.wheels[0].tire_force.z() > 1.3 * before.wheels[0].tire_force.z()
    );
    // about the centre of mass as it is: what the wheels' spins lose turns the nose down as well
    let (centre, [front, rear]) = car.stance();
    let force = |axle: usize| told.wheels[axle].tire_force * 2.0;
    let (f, r) = (force(0), force(2));
    let spins = 4.0 * 0.9 * told.acceleration / 0.33;
    let moment = -centre.z() * (f.x() + r.x()) - front.x() * f.z() - rear.x() * r.z();
    let inertia = p.vehicle_mass * -told.acceleration * centre.z();
    assert!((moment - spins).abs() < 0.02 * inertia, "{moment} {spins} {inertia}");
    assert!((f.z() + r.z() - p.vehicle_mass * GRAVITY).abs() < 0.02 * p.vehicle_mass * GRAVITY);
}

/// Upward passes of a value through 0, on straight lines between samples.
fn passes(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let values: Vec<f64> = values.collect();
    let pass = |k: usize| {
        let (a, b) = (values[k], values[k + 1]);
        (a < 0.0 && b >= 0.0).then(|| k as f64 - a / (b - a))
    };
    (0..values.len() - 1).filter_map(pass).collect()
}

#[test]
fn wheels_and_rack_swing_against_the_column() {
    // without weight on the tires nothing else turns the wheels; a wheel turns about its axis with what stands beside it
    let p = Parameters { column_damping: 100.0, front_wheel_mass: 20.0, ..Parameters::default() };
    let corner = front(&p, 0.32).unwrap();
    let (low, high) = (
        on_steering_axis(p.front_scrub_radius, 0.32, 0.0),
        on_steering_axis(p.front_scrub_radius, 0.32, 0.5),
    );
    let axis = (high - low).unit();
    let beside = (corner.centre - low) - axis * (corner.centre - low).dot(axis);
    let inertia = 0.4 + 0.5 + 40.0 * beside.dot(beside);
    let outer = corner.links[2].ends[1];
    let rod = (corner.links[2].ends[0] - outer).unit();
    let arm = axis.dot((outer - low).cross(rod)).abs();
    let expected = (p.column_stiffness / (4.0 + 2.0 * inertia / (arm * arm))).sqrt() / TAU;
    let road = Road { slabs: None, friction: [Scatter::none(1e-3), Scatter::none(1e-3)] };
    let mut car = Vehicle::rolls(&p, 1e-3 + SPEED, [1.0; 2]).unwrap();
    car.nudge_rack(0.05);
    let swings = drive(&mut car, &road, 0.6, |_| [0.0; 4]);
    // rack and tie rods swing much faster at first
    let times = passes(swings.iter().skip(1500).map(|told| told.column));
    let frequency = (times.len() - 1) as f64 / (STEP * (times[times.len() - 1] - times[0]));
    assert!((frequency / expected - 1.0).abs() < 0.04, "{frequency} {expected}");
}

#[test]
fn the_longitudinal_link_makes_the_anti_dive() {
    for share in [0.0, 0.1, 0.3] {
        let p = Parameters { front_anti_dive: share, ..Parameters::default() };
        assert!((lifts(&front(&p, 0.32).unwrap()).unwrap() - share).abs() < 1e-9);
    }
}

#[test]
fn a_wheel_that_falls_behind_gets_less_and_takes_the_other_rear_wheel_along() {
    let spin = SPEED / 0.33;
    let mut controller = Controller::new([0.33; 4], [spin; 4]);
    let mut slow = spin;
    for _ in 0..12 {
        slow -= 2.0;
        controller.sample([spin, spin, slow, spin], 1e7);
    }
    assert_eq!(controller.phases(), [Phase::Off, Phase::Off, Phase::Dump, Phase::Off]);
    assert_eq!(controller.valves(), [(1.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.0, 1.0)]);
    while slow < spin {
        slow += 2.0;
        controller.sample([spin, spin, slow, spin], 1e7);
    }
    assert_eq!(controller.phases()[2], Phase::Build);
    // a driver who lets go gets the brakes back
    controller.sample([spin; 4], 0.0);
    assert_eq!(controller.phases(), [Phase::Off; 4]);
}

#[test]
fn pads_that_touch_build_up_their_friction() {
    let pads = Parameters::default().brakes[0];
    let mut brake = Brake::default();
    let mut last = 0.0;
    for n in 1..=4000 {
        brake.follow(&pads, 50e5, (1.0, 0.0), STEP);
        let torque = brake.torque(&pads);
        assert!(torque >= last);
        last = torque;
        // a quarter of the friction at first, and half of the rest 110 ms behind contact, which takes 2.2 ms
        if n == 1122 {
            let full = 0.4 * (50e5 - 5e4) * 43e-4 * 0.14;
            assert!((torque / full - 0.625).abs() < 0.01, "{}", torque / full);
        }
    }
    let held = brake.line;
    brake.follow(&pads, 50e5, (0.0, 1.0), 0.01);
    assert!((held - brake.line - 9e5).abs() < 1.0);
}

#[test]
fn friction_has_the_deviation_and_length_that_it_says() {
    let (deviation, length) = (0.05, 0.5);
    let (mut squares, mut integral, mut count) = (0.0, 0.0, 0.0);
    for seed in 0..60 {
        let track = Scatter::draw(&mut Random::new(SEED, seed), 1.0, (deviation, length));
        let at = |k: i32| track.at(0.1 * f64::from(k)) - 1.0;
        for k in 0..1000 {
            squares += at(k) * at(k);
            integral += 0.1 * (0.5 * at(k) * at(k) + (1..20).map(|lag| at(k) * at(k + lag)).sum::<f64>());
            count += 1.0;
        }
    }
    let variance = squares / count;
    assert!((variance.sqrt() / deviation - 1.0).abs() < 0.05, "{variance}");
    assert!((integral / count / variance / length - 1.0).abs() < 0.1, "{}", integral / count / variance);
}

#[test]
fn another_road_is_one_of_all_runs_of_its_kind_and_the_answer_says_which() {
    let mut random = Random::new(SEED, 5);
    let mut drawn = Drawn::draw(Offer::OneRoad, &mut random);
    let (kind, level) = drawn.world.other_road.unwrap();
    for run in &drawn.runs {
        let plain = World { other_road: None, ..drawn.world.clone() }.road(run);
        let factor = drawn.world.road(run).friction[0].at(30.0) / plain.friction[0].at(30.0);
        let expected = if run.kind == kind { level } else { 1.0 };
        assert!((factor - expected).abs() < 1e-12, "{}: {factor}", run.file());
    }
    drawn.runs.retain(|run| run.number == 1 && run.kind == kind);
    let answer = record(&drawn, 0, &mut random).unwrap().answer;
    let [effect] = &answer.effects[..] else { panic!("{answer:?}") };
    assert!(
        effect.accept == [kind] && (effect.size - (level - 1.0)).abs() < 1e-12 && effect.over_noise > 1.0
    );
}

/// Channels of the first samples, relative to the spread over the run.
fn differ(a: &Ideal, b: &Ideal, samples: usize) -> f64 {
    let off = a.outputs.iter().zip(&b.outputs).map(|(a, b)| {
        let own = crate::machines::spread(a.iter().copied()).max(1e-3);
        let square = a.iter().zip(b).take(samples).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
        (square / samples as f64).sqrt() / own
    });
    off.fold(0.0, f64::max)
}

#[test]
fn shorter_steps_make_no_other_recording_and_a_symmetric_road_hides_the_column() {
    let mut drawn = Drawn::draw(Offer::ColumnAlike, &mut Random::new(SEED, 3));
    let run = drawn.runs.remove(0);
    let fine = drawn.world.run(&run, 0.5 * STEP).unwrap();
    let own = drawn.world.run(&run, STEP).unwrap();
    // until the first wheel has been close to locking: behind that decisions of the controller part
    assert!(differ(&own, &fine, 375) < 2e-3, "{}", differ(&own, &fine, 375));
    let stiff = World { p: drawn.belief.clone(), ..drawn.world.clone() };
    let hidden = stiff.run(&run, STEP).unwrap();
    assert!(differ(&own, &hidden, own.outputs[0].len()) < 1e-5);
    let apart = World { alike: false, ..drawn.world.clone() }.run(&run, STEP).unwrap();
    let shown = World { alike: false, ..stiff }.run(&run, STEP).unwrap();
    assert!(differ(&apart, &shown, 500) > 0.05);
}

#[test]
fn a_study_has_every_offer_and_a_case_says_nothing_of_it() {
    let study = study(SEED);
    assert_eq!(study.len(), 48);
    assert!(OFFERS.iter().all(|(offer, times)| study.iter().filter(|o| *o == offer).count() == *times));
    assert_ne!(study, super::case::study(SEED + 1));
    let number = study.iter().position(|offer| *offer == Offer::Nothing).unwrap();
    let mut random = Random::new(SEED, 1 + number as u64);
    let mut drawn = Drawn::draw(study[number], &mut random);
    assert_eq!(drawn.runs.len(), KINDS.iter().map(|(_, _, count, _)| count).sum::<usize>());
    drawn.runs.retain(|run| run.number == 1 && run.kind != "partial");
    let recorded = record(&drawn, number, &mut random).unwrap();
    assert_eq!(recorded.answer.kind, "null");
    assert!(recorded.answer.parameters.iter().all(|p| p.start == p.value));
    let file = |name: &str| &recorded.files.iter().find(|(n, _)| n == name).unwrap().1;
    assert!(
        file("recordings/runs.toml")
            .contains("[runs]\n\"flat-1.csv\" = \"fit\"\n\"fast-1.csv\" = \"check\"\n")
    );
    assert_eq!(recorded.files.len(), 3 + drawn.runs.len());
    assert!(file("system.toml").contains("road_friction_seed_right = 2"));
    let header = file("recordings/flat-1.csv").lines().next().unwrap();
    assert!(header.starts_with(
        "time [s],driver_pressure [bar],car.steering_wheel_angle [rad],car.vehicle_speed [m/s]"
    ));
    assert!(
        header.contains("car.front_left.tie_rod_force [N]")
            && !header.contains("car.rear_left.carrier_force_x")
    );
}

#[test]
fn causes_change_what_a_right_diagnosis_may_name() {
    for (offer, _) in OFFERS {
        let drawn = Drawn::draw(offer, &mut Random::new(SEED, 9));
        let (believed, truly) = (drawn.belief.named(), drawn.world.p.named());
        let moved: Vec<&String> =
            believed.iter().zip(&truly).filter(|(a, b)| a.1 != b.1).map(|(a, _)| &a.0).collect();
        let accepted: Vec<String> = offer.causes().into_iter().flat_map(|(_, accept)| accept).collect();
        assert!(moved.iter().all(|name| accepted.contains(name)), "{offer:?}: {moved:?}");
        let same_car = [Offer::Nothing, Offer::OneRoad].contains(&offer);
        assert_eq!(drawn.belief == drawn.world.p, same_car, "{offer:?}");
        assert_eq!(drawn.world.other_road.is_some(), offer == Offer::OneRoad);
    }
}
