//! A wheel under a mass that swings.

use super::{common, rim, single, tire};
use latsch::rig::Wheel;
use latsch::tire::super_elastic::SuperElastic;
use latsch::tire::{Tire, Vertical};

/// Deflections \[mm\] of a wheel under a mass over time, let go at a deflection.
fn swing(parameters: &[(&str, f64)], mass: f64, from: f64, step: f64, end: f64) -> Vec<f64> {
    let mut values = vec![
        ("rim_force", 2.0),
        ("contact_points", 1.0),
        ("element_radial_stiffness", 151_105.0),
        ("hub_mass", mass - 19.8),
        ("axle_force_z", 0.0),
        ("initial_speed", 0.0),
        ("step_size", step),
    ];
    values.extend(parameters);
    let change = single(values.iter().rev().find(|v| v.0 == "element_radial_stiffness").unwrap().1);
    let still = tire(|p| {
        change(p);
        if let Some((_, n)) = parameters.iter().find(|v| v.0 == "elements") {
            p.elements = *n as i32;
        }
    });
    let at = still.stationary(&rim(0.2265 - from, 0.0, 0.0), Vertical::Height(0.2265 - from), 1.0).unwrap();
    values.push(("initial_load", at.on_rim.force.z));
    let mut slave = common::started::<Wheel<SuperElastic>>(&values);
    let mut all = vec![1e3 * common::get(&mut slave, "tire_deflection")];
    let steps = (end / 1e-3).round() as usize;
    for k in 0..steps {
        latsch::model::Slave::step(&mut slave, 1e-3 * k as f64, 1e-3).unwrap();
        all.push(1e3 * common::get(&mut slave, "tire_deflection"));
    }
    all
}

/// Turning points of a series with a millisecond between values: time \[s\] and value, of the parabola through three.
fn extrema(values: &[f64]) -> Vec<(f64, f64)> {
    let turns = |w: &[f64]| (w[1] - w[0]) * (w[2] - w[1]) < 0.0;
    let top = |k: usize| {
        let [a, b, c] = [values[k], values[k + 1], values[k + 2]];
        let x = 0.5 * (a - c) / (a - 2.0 * b + c);
        (1e-3 * (k as f64 + 1.0 + x), b - 0.25 * (a - c) * x)
    };
    values.windows(3).enumerate().filter(|(_, w)| turns(w)).map(|(k, _)| top(k)).collect()
}

/// Checks 28 and 29.
#[test]
fn the_mass_swings_as_the_table_says() {
    for step in [1e-4, 1e-3] {
        let found = extrema(&swing(&[], 670.0, 16e-3, step, 0.4));
        println!("X {step} {found:?}");
        let expected = [(0.0923, 10.310), (0.1845, 15.468), (0.2766, 10.793), (0.3688, 15.031)];
        for (found, (time, value)) in found.iter().zip(expected) {
            assert!(
                (found.0 - time).abs() < 2e-4 && (found.1 - value).abs() < 2e-3,
                "{step}: {found:?} {time} {value}"
            );
        }
    }
}
