//! A flat-track rig that holds the vertical force: its start, derivatives at constant load, and how the load is followed.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic)]

use latsch::Result;
use latsch::fmi::Entry;
use latsch::model::{Settings, Slave};
use latsch::shipped::MODELS;

const RIGS: [&str; 2] = ["ring-brush-flat-track", "magic-formula-flat-track"];
const OUTPUTS: [&str; 6] = ["force_x", "force_y", "force_z", "moment_x", "moment_y", "moment_z"];

fn rig(model: &str) -> Box<dyn Slave> {
    Entry::find(MODELS, model).unwrap().slave(&Settings::default()).unwrap()
}

fn started(model: &str, values: &[(&str, f64)]) -> Result<Box<dyn Slave>> {
    let mut slave = rig(model);
    for (name, value) in values {
        let variable = slave.interface().find(name)?;
        slave.set(variable, *value)?;
    }
    slave.start(0.0, None)?;
    slave.finish_start()?;
    Ok(slave)
}

fn read(slave: &mut dyn Slave, name: &str) -> f64 {
    slave.get(slave.interface().find(name).unwrap()).unwrap()
}

const STATES: [&[(&str, f64)]; 4] = [
    &[("slip", 0.02)],
    &[("slip_angle", 0.05), ("camber", 0.04)],
    &[("slip", -0.05), ("slip_angle", -0.03), ("friction_factor", 0.7), ("path_speed", 3.0)],
    &[("camber", -0.06), ("path_speed", -10.0), ("steer", 0.3)],
];

#[test]
fn a_start_at_a_load_is_that_at_its_deflection() {
    for model in RIGS {
        for state in STATES {
            for load in [1500.0, 4000.0, 6000.0] {
                let mut at_load =
                    started(model, &[&[("load_control", 1.0), ("load", load)], state].concat()).unwrap();
                assert!(
                    (read(&mut *at_load, "force_z") / load - 1.0).abs() < 1e-7,
                    "{model} {state:?} {load}"
                );
                let deflection = read(&mut *at_load, "actual_deflection");
                let mut deflected = started(model, &[&[("deflection", deflection)], state].concat()).unwrap();
                for output in OUTPUTS {
                    let [a, b] = [&mut at_load, &mut deflected].map(|s| read(&mut **s, output));
                    assert!((a - b).abs() < 1e-6 * load, "{model} {state:?} {load} {output}: {a} {b}");
                }
            }
        }
    }
}

/// The derivatives of a start are those of the states at constant load, against differences of starts.
#[test]
fn derivatives_of_a_start_are_those_at_constant_load() {
    let model = "ring-brush-flat-track";
    for state in STATES {
        let held = [&[("load_control", 1.0), ("load", 3500.0)], state].concat();
        let mut slave = started(model, &[]).unwrap();
        slave.reset().unwrap();
        for (name, value) in &held {
            slave.set(slave.interface().find(name).unwrap(), *value).unwrap();
        }
        slave.start(0.0, None).unwrap();
        let find = |name: &str| rig(model).interface().find(name).unwrap();
        let outputs = OUTPUTS.map(find);
        for (input, step) in
            [("slip", 1e-5), ("slip_angle", 1e-5), ("camber", 1e-5), ("friction_factor", 1e-4), ("load", 1.0)]
        {
            let exact = slave.directional_derivatives(&outputs, &[find(input)], &[1.0]).unwrap();
            let at = held.iter().rev().find(|(name, _)| *name == input).map(|(_, value)| *value);
            let at = at.unwrap_or(if input == "friction_factor" { 1.0 } else { 0.0 });
            let [below, above] = [-step, step].map(|d| {
                let mut moved = held.clone();
                moved.push((input, at + d));
                let mut slave = started(model, &moved).unwrap();
                OUTPUTS.map(|name| read(&mut *slave, name))
            });
            let sizes: [f64; 6] = OUTPUTS.map(|name| if name.starts_with("force") { 3500.0 } else { 350.0 });
            for k in 0..OUTPUTS.len() {
                let difference = (above[k] - below[k]) / (2.0 * step);
                let range = sizes[k] / if input == "load" { 3500.0 } else { 1.0 };
                let error = (exact[k] - difference).abs();
                assert!(
                    error < 2e-3 * range.max(exact[k].abs()),
                    "{state:?} {input} {}: {} {difference}",
                    OUTPUTS[k],
                    exact[k]
                );
            }
        }
        let load = slave.directional_derivatives(&[find("force_z")], &[find("load")], &[1.0]).unwrap()[0];
        assert!((load - 1.0).abs() < 1e-9, "{load}");
    }
}

/// After a step of the load the missing force falls with the corner of gain times the tire's stiffness.
#[test]
fn the_load_is_followed_with_the_corner_of_the_control() {
    for model in RIGS {
        let gain = 5e-5;
        let values = [("load_control", 1.0), ("load", 3000.0), ("load_control_gain", gain)];
        let stiffness = {
            let [low, high] = [3900.0, 4100.0].map(|load| {
                let mut slave = started(model, &[("load_control", 1.0), ("load", load)]).unwrap();
                read(&mut *slave, "actual_deflection")
            });
            200.0 / (high - low)
        };
        let mut slave = started(model, &values).unwrap();
        let load = slave.interface().find("load").unwrap();
        let mut missing = Vec::new();
        for k in 0..1000 {
            if k == 100 {
                slave.set(load, 4000.0).unwrap();
            }
            slave.step(f64::from(k) * 1e-3, 1e-3).unwrap();
            let goal = if k < 100 { 3000.0 } else { 4000.0 };
            missing.push(goal - read(&mut *slave, "force_z"));
        }
        assert!(missing[..100].iter().all(|m| m.abs() < 2.0), "{model}: it starts at rest");
        // behind the actuator's delay
        let corner = (missing[200] / missing[300]).ln() / 0.1;
        assert!((corner / (gain * stiffness) - 1.0).abs() < 0.15, "{model}: {corner} {}", gain * stiffness);
        assert!(missing[999].abs() < 1.0, "{model}: {}", missing[999]);
    }
}

#[test]
fn a_load_that_the_rig_does_not_reach_is_refused() {
    for model in RIGS {
        let refused = started(model, &[("load_control", 1.0), ("load", 9e4)]).err().unwrap().to_string();
        // a tire with a contact patch does not get that far
        let words = if model == "ring-brush-flat-track" {
            "contact patch"
        } else {
            "90000 N would need a deflection"
        };
        assert!(refused.contains(words), "{model}: {refused}");
    }
}
