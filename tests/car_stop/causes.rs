//! Causes are found in recordings of another car than the one that is believed, and none where only the road's friction is another. The recordings are the shipped
//! car's own here, without noise; `tests/truth` has those of another program.

use crate::WHEELS;
use crate::procedures::Wired;
use latsch::causes::{PartFindings, Recorded, Use, find};
use latsch::model::Value;
use latsch::recording::{Channel, Recording, interpolate};

/// So many stops to fit on one road, and as many to check, faster ones on another, each with friction that scatters otherwise, sampled every 2 ms. Some values hold on
/// the second road only.
fn recorded(repeats: i32, seconds: f64, values: &[(&str, f64)], second: &[(&str, f64)]) -> Vec<Recorded> {
    (1..=2 * repeats)
        .map(|k| {
            let seed = f64::from(k);
            let is_second = k > repeats;
            let scatter = [
                ("car.road_friction_deviation", 0.03),
                ("car.road_friction_seed", 10.0 * seed),
                ("car.road_friction_seed_right", 10.0 * seed + 1.0),
                ("car.initial_speed", if is_second { 20.0 } else { 17.0 }),
            ];
            let second = if is_second { second } else { &[] };
            let run = Wired::new(&[values, &scatter, second].concat()).until(seconds).run();
            let initial = ("car.initial_speed".to_owned(), Value::Real(scatter[3].1));
            Recorded {
                name: format!("stop-{k}.csv"),
                recording: sampled(&run),
                used: if is_second { Use::Check } else { Use::Fit },
                group: if is_second { "fast" } else { "slow" }.into(),
                set: vec![initial],
            }
        })
        .collect()
}

fn sampled(run: &Recording) -> Recording {
    let mut names: Vec<String> =
        ["vehicle_speed", "longitudinal_acceleration", "yaw_rate"].map(|n| format!("car.{n}")).into();
    for wheel in WHEELS {
        names.extend(["wheel_speed", "carrier_moment_y"].map(|n| format!("car.{wheel}.{n}")));
    }
    for wheel in &WHEELS[..2] {
        let forces =
            ["carrier_force_x", "carrier_force_y", "carrier_force_z", "tie_rod_force", "strut_force"];
        names.extend(forces.map(|n| format!("car.{wheel}.{n}")));
    }
    names.extend(["fl", "fr", "rl", "rr"].map(|b| format!("brake_{b}.caliper_pressure")));
    let last = run.time.last().unwrap();
    let time: Vec<f64> = (0..).map(|k| f64::from(k) * 2e-3).take_while(|t| t < last).collect();
    let of = |name: &str, as_name: &str| {
        let channel = run.channel(name).unwrap();
        Channel {
            name: as_name.to_owned(),
            unit: channel.unit.clone(),
            values: time.iter().map(|t| interpolate(&run.time, &channel.values, *t)).collect(),
        }
    };
    let mut channels: Vec<Channel> = names.iter().map(|name| of(name, name)).collect();
    channels.push(of("abs.driver_pressure", "driver_pressure"));
    Recording { time, channels, source: "stop".into() }
}

fn causes(recorded: &[Recorded]) -> Vec<PartFindings> {
    find(&Wired::new(&[]).plan, recorded, 0, &mut |_| {}).unwrap()
}

/// Level of the friction on a slippery road.
const LESS: f64 = 0.88;

fn less_friction() -> Vec<(String, f64)> {
    let scales = ["front", "rear"].map(|axle| ["X", "Y"].map(|along| format!("car.{axle}_tire.LMU{along}")));
    scales.into_iter().flatten().map(|name| (name, LESS)).collect()
}

fn named(values: &[(String, f64)]) -> Vec<(&str, f64)> {
    values.iter().map(|(name, value)| (name.as_str(), *value)).collect()
}

#[test]
fn causes_are_named_in_the_part_that_has_them_and_with_their_size() {
    let brakes = ["fl", "fr", "rl", "rr"].map(|b| format!("brake_{b}.caliper_lag"));
    let mut values: Vec<(&str, f64)> = brakes.iter().map(|name| (name.as_str(), 0.02)).collect();
    values.push(("car.front_anti_dive", 0.3));
    let findings = causes(&recorded(2, 1.0, &values, &[]));
    let ids: Vec<Vec<&str>> =
        findings.iter().map(|part| part.found.iter().map(|found| found.id).collect()).collect();
    assert_eq!(ids, [vec!["anti_dive"], vec![], vec!["caliper_lag"], vec![]], "{findings:#?}");
    let value = |part: usize| match findings[part].found[0].changes[0].value {
        Value::Real(value) => value,
        _ => panic!("a number"),
    };
    assert!((value(0) - 0.3).abs() < 0.01, "{}", value(0));
    assert!((value(2) - 0.02).abs() < 1e-3, "{}", value(2));
}

/// The second road is slippery, and its runs say so.
#[test]
fn nothing_is_named_where_only_the_friction_scatters() {
    let less = less_friction();
    let mut runs = recorded(2, 1.0, &[], &named(&less));
    for run in runs.iter_mut().filter(|run| run.group == "fast") {
        let given = WHEELS.map(|wheel| (format!("car.{wheel}.friction_factor"), Value::Real(LESS)));
        run.set.extend(given);
    }
    for part in causes(&runs) {
        assert!(part.found.is_empty() && part.of_roads.is_empty(), "{part:#?}");
    }
}

#[test]
fn friction_of_one_road_is_named_for_that_road_beside_a_cause_of_all() {
    let less = less_friction();
    let hubs = [("car.front_carrier_inertia", 0.72), ("car.front_wheel_transverse_inertia", 0.9)];
    // the level of one road's friction does not show in less
    let findings = causes(&recorded(3, 1.5, &hubs, &named(&less)));
    let [vehicle, rest @ ..] = &findings[..] else { panic!("{findings:#?}") };
    let [found] = &vehicle.found[..] else { panic!("{vehicle:#?}") };
    assert_eq!(found.id, "hub_inertia", "{vehicle:#?}");
    let Value::Real(inertia) = found.changes[0].value else { panic!("a number") };
    assert!((inertia / 0.72 - 1.0).abs() < 0.03, "{inertia}");
    assert!(rest.iter().all(|part| part.found.is_empty()), "{rest:#?}");
    let [road] = &findings[0].of_roads[..] else { panic!("{:#?}", findings[0]) };
    assert_eq!((road.id, road.group.as_str()), ("friction_level", "fast"));
    let Value::Real(level) = road.changes[0].value else { panic!("a number") };
    assert!((level - LESS).abs() < 0.02, "{level}");
}
