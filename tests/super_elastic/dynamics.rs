//! A wheel under a mass that swings.

use super::{common, rim, single, tire};
use latsch::rig::{HydroPulse, Wheel};
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
        // the table has three decimals; steps of 1 ms are 3e-4 mm off those of 0.1 ms
        let found = extrema(&swing(&[], 670.0, 16e-3, step, 0.4));
        let expected = [(0.0923, 10.310), (0.1845, 15.468), (0.2766, 10.793), (0.3688, 15.031)];
        for (found, (time, value)) in found.iter().zip(expected) {
            assert!(
                (found.0 - time).abs() < 2e-4 && (found.1 - value).abs() < 2e-3,
                "{step}: {found:?} {time} {value}"
            );
        }
    }
}

/// Deflections \[mm\] of a wheel of 27 kg that the hydropulse rig presses on the road around 10 kN, in the last two of five periods.
fn pressed(parameters: &[(&str, f64)], amplitude: f64, frequency: f64, step: f64) -> (f64, f64) {
    let mut values = vec![
        ("rim_force", 2.0),
        ("wheel_mass", 27.0 - 19.8),
        ("force", 10e3),
        ("excitation", 2.0),
        ("excitation_amplitude", amplitude),
        ("excitation_frequency", frequency),
        ("command_actuators", 0.0),
        ("step_size", step),
    ];
    values.extend(parameters);
    let mut slave = common::started::<HydroPulse<SuperElastic>>(&values);
    let steps = (5.0 / frequency / 1e-3).round() as usize;
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for k in 0..steps {
        let time = 1e-3 * k as f64;
        latsch::model::Slave::step(&mut slave, time, 1e-3).unwrap();
        if k > steps * 3 / 5 {
            let deflection = 1e3 * common::get(&mut slave, "tire_deflection");
            (least, most) = (least.min(deflection), most.max(deflection));
        }
    }
    (least, most)
}

/// Check 30: a loop that touches no load, and check 31: the frequency hardly matters.
#[test]
fn the_hydropulse_presses_as_far_as_the_table_says() {
    let one = |elements: f64, stiffness: f64, damping: f64| {
        [
            ("contact_points", 1.0),
            ("elements", elements),
            ("element_radial_stiffness", stiffness),
            ("element_radial_damping", damping),
        ]
    };
    let rows = [
        (one(45.0, 151_105.0, 280.0), (1.57, 27.15)),
        (one(75.0, 93_398.0, 157.0), (1.18, 26.83)),
        (one(105.0, 65_945.0, 127.0), (1.42, 26.93)),
    ];
    for (parameters, expected) in rows {
        let found = pressed(&parameters, 10e3, 1.0, 1e-3);
        assert_near(found, expected, 6e-3);
    }
    assert_near(pressed(&[], 10e3, 1.0, 1e-3), (0.79, 27.89), 6e-3);
    let rows = [(0.5, 13.906, 20.983), (1.0, 13.903, 20.985), (2.0, 13.889, 20.990), (4.0, 13.848, 21.029)];
    for (frequency, low, high) in rows {
        let found = pressed(&one(45.0, 151_105.0, 280.0), 3e3, frequency, 1e-3);
        assert_near(found, (low, high), 1e-3);
    }
}

#[track_caller]
fn assert_near(found: (f64, f64), expected: (f64, f64), tolerance: f64) {
    let away = (found.0 - expected.0).abs().max((found.1 - expected.1).abs());
    assert!(away < tolerance, "{found:?} instead of {expected:?}");
}

/// Led along the way that force control has made, the rig answers with the force: the two kinds of control are one machine.
#[test]
fn position_control_gives_back_the_force_that_made_the_way() {
    let common_values =
        [("rim_force", 2.0), ("wheel_mass", 20.0), ("command_actuators", 0.0), ("step_size", 1e-3)];
    let sine =
        [("force", 8e3), ("excitation", 2.0), ("excitation_amplitude", 3e3), ("excitation_frequency", 2.0)];
    let mut pressing = common::started::<HydroPulse<SuperElastic>>(&[&common_values[..], &sine].concat());
    let mut moving = {
        let at = common::get(&mut pressing, "piston_position");
        common::started::<HydroPulse<SuperElastic>>(
            &[&common_values[..], &[("control", 2.0), ("position", at)]].concat(),
        )
    };
    // at the start, too: the load cell has a force, whatever is controlled
    common::assert_close("cell at the start", common::get(&mut moving, "cell_force"), 8e3, 1e-6);
    let (mut difference, mut size) = (0.0, 0.0);
    for k in 0..1000 {
        common::advance(&mut pressing, 1e-3, k, k + 1);
        let mut get = |name: &str| common::get(&mut pressing, name);
        let [position, velocity, force] = ["piston_position", "piston_velocity", "cell_force"].map(&mut get);
        let variable = latsch::model::Slave::find(&moving, "position").unwrap();
        latsch::model::Slave::set(&mut moving, variable, position).unwrap();
        latsch::model::Slave::set_rate(&mut moving, variable, velocity).unwrap();
        common::advance(&mut moving, 1e-3, k, k + 1);
        if k > 100 {
            let other = common::get(&mut moving, "cell_force");
            difference += (other - force).powi(2);
            size += (force - 8e3).powi(2);
        }
    }
    assert!((difference / size).sqrt() < 0.02);
}

/// Friction in the rubber makes a loop that does not depend on the frequency; a damper makes one that grows with it.
#[test]
fn the_loop_tells_friction_from_damping() {
    let area = |parameters: &[(&str, f64)], frequency: f64| {
        let mut values = vec![
            ("contact_points", 1.0),
            ("wheel_mass", 20.0),
            ("force", 8e3),
            ("excitation", 2.0),
            ("excitation_amplitude", 3e3),
            ("excitation_frequency", frequency),
            ("command_actuators", 0.0),
            ("step_size", 1e-3),
        ];
        values.extend(parameters);
        let mut slave = common::started::<HydroPulse<SuperElastic>>(&values);
        let period = (1e3 / frequency).round() as u32;
        let mut work = 0.0;
        let mut last = (0.0, 0.0);
        for k in 0..2 * period {
            common::advance(&mut slave, 1e-3, k, k + 1);
            let now = (common::get(&mut slave, "cell_force"), common::get(&mut slave, "piston_position"));
            if k >= period {
                work += 0.5 * (now.0 + last.0) * (now.1 - last.1);
            }
            last = now;
        }
        work
    };
    let damped = [("element_radial_damping", 280.0), ("contact_damping", 0.0)];
    let rubbed = [&damped[..], &[("friction_force", 100.0), ("friction_stiffness", 1e6)]].concat();
    let by_damper = [0.5, 2.0].map(|f| area(&damped, f));
    assert!((by_damper[1] / by_damper[0] / 4.0 - 1.0).abs() < 0.05, "{by_damper:?}");
    let with_friction = [0.5, 2.0].map(|f| area(&rubbed, f));
    let [slow, fast] = [0, 1].map(|i| with_friction[i] - by_damper[i]);
    assert!(slow > by_damper[1] && (fast / slow - 1.0).abs() < 0.02, "{slow} {fast}");
}
