//! What a master gains from derivatives of outputs: one that extrapolates with them must not be further from
//! what the model does next than one that holds the value, for any real output of any shipped model.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic)]

use latsch::fmi::Entry;
use latsch::model::{Causality, Settings, Slave, Variability, VariableInfo};
use latsch::shipped::MODELS;

/// The communication step that the shipped models suggest \[s\], and looks at what happens within one.
const COMMUNICATION_STEP: f64 = 1e-3;
const LOOKS: usize = 10;
const STEPS: usize = 1500;

/// A run in which the model moves: start values, and what the inputs are at a time.
struct Case {
    /// What the model's name ends with: every tire on a rig, or names.
    models: &'static [&'static str],
    start: &'static [(&'static str, f64)],
    inputs: fn(f64) -> Vec<(&'static str, f64)>,
}

/// 0 before `from`, then rising evenly to 1 within `rise` seconds.
fn ramp(time: f64, from: f64, rise: f64) -> f64 {
    ((time - from) / rise).clamp(0.0, 1.0)
}

/// A wheel that brakes for a second against what pushes it on, steered and leaning.
fn wheel(t: f64, torque: f64, push: f64) -> Vec<(&'static str, f64)> {
    let pressed = ramp(t, 0.1, 0.2) * (1.0 - ramp(t, 1.0, 0.1));
    vec![
        ("brake_torque", torque * pressed),
        ("axle_force_x", push * pressed),
        ("steer", 0.03 * (6.0 * t).sin()),
        ("camber", 0.02 * (5.0 * t).sin()),
    ]
}

// On roads without edges and kinks: at these, forces of tires that feel one point jump, and no derivative knows it.
const CASES: &[Case] = &[
    Case {
        models: &["-flat-track"],
        start: &[],
        inputs: |t| {
            vec![
                ("slip", 0.06 * (9.0 * t).sin()),
                ("slip_angle", 0.08 * (7.0 * t).sin()),
                ("camber", 0.03 * (5.0 * t).sin()),
                ("deflection", 0.02 + 0.004 * (11.0 * t).sin()),
            ]
        },
    },
    Case {
        models: &["-tire"],
        start: &[("rim_z", 0.317)],
        inputs: |t| {
            vec![
                ("rim_x", 10.0 * t),
                ("rim_y", 0.05 * (8.0 * t).sin()),
                ("rim_velocity_y", 0.4 * (8.0 * t).cos()),
                ("rim_z", 0.317 + 0.003 * (12.0 * t).sin()),
                ("rim_velocity_z", 0.036 * (12.0 * t).cos()),
                ("rim_spin_rate", 10.0 / 0.328 * (1.0 + 0.05 * (6.0 * t).sin())),
            ]
        },
    },
    // small wheels, which the torque of the others would stop
    Case {
        models: &["linear-wheel", "fiala-wheel", "ua-wheel", "tmeasy-wheel"],
        start: &[("initial_speed", 20.0), ("road_kind", 6.0)],
        inputs: |t| wheel(t, 400.0, 1800.0),
    },
    Case {
        models: &["-wheel"],
        start: &[("initial_speed", 20.0), ("road_kind", 6.0)],
        inputs: |t| wheel(t, 900.0, 2500.0),
    },
    Case {
        models: &["-corner"],
        start: &[("road_kind", 6.0)],
        inputs: |t| vec![("brake_torque", 1000.0 * ramp(t, 0.1, 0.2) * (1.0 - ramp(t, 1.0, 0.1)))],
    },
    Case {
        models: &["-hydropulse"],
        start: &[],
        inputs: |t| vec![("force", 4000.0 + 1500.0 * (9.0 * t).sin())],
    },
    // a wheel that brakes at a speed at which many bristles come and go within a step; of one that rolls free single ones let go
    Case {
        models: &["-drum"],
        start: &[("road_kind", 1.0)],
        inputs: |t| {
            let pressed = 800.0 * ramp(t, 0.05, 0.2) * (1.0 + 0.3 * (9.0 * t).sin());
            vec![
                ("drum_speed", 15.0 + 2.5 * (4.0 * t).sin()),
                ("brake_torque", pressed),
                ("pivot_torque", 500.0 * (8.0 * t).sin()),
            ]
        },
    },
    Case {
        models: &["-counterbalance-truck"],
        start: &[("road_kind", 6.0), ("road_start", 1.0)],
        inputs: |t| vec![("speed", 2.0 + 0.2 * (2.0 * t).sin())],
    },
    // all wheels brake, for the same reason
    Case {
        models: &["-vehicle"],
        start: &[],
        inputs: |t| {
            let torque = 600.0 * ramp(t, 0.1, 0.2);
            vec![
                ("front_left.brake_torque", torque),
                ("front_right.brake_torque", 0.8 * torque),
                ("rear_left.brake_torque", torque),
                ("rear_right.brake_torque", 0.9 * torque),
                ("steering_wheel_angle", 0.3 * (5.0 * t).sin()),
            ]
        },
    },
    Case {
        models: &["axle"],
        start: &[],
        inputs: |t| {
            let braking = ramp(t, 0.1, 0.2) * (1.0 + 0.2 * (12.0 * t).sin());
            vec![
                ("left.carrier_force_x", -3000.0 * braking),
                ("left.carrier_moment_y", 950.0 * braking),
                ("right.carrier_force_x", -2500.0 * braking),
                ("right.carrier_moment_y", 800.0 * braking),
                ("left.carrier_force_z", 2935.0 + 1000.0 * (9.0 * t).sin()),
            ]
        },
    },
    Case {
        models: &["brake-hydraulics"],
        start: &[],
        // a driver's foot, and valves that switch every 40 ms
        inputs: |t| {
            let dump = t > 0.3 && (t / 0.04).floor() % 3.0 == 0.0;
            vec![
                ("driver_pressure", 8e6 * ramp(t, 0.05, 0.2)),
                ("inlet_valve", if dump { 0.0 } else { 1.0 }),
                ("outlet_valve", if dump { 1.0 } else { 0.0 }),
            ]
        },
    },
    Case {
        models: &["abs-controller"],
        start: &[
            ("wheel_speed_1", 60.0),
            ("wheel_speed_2", 60.0),
            ("wheel_speed_3", 60.0),
            ("wheel_speed_4", 60.0),
        ],
        // wheels that slip and recover, each in a rhythm of its own
        inputs: |t| {
            let wheel = |rate: f64| (60.0 - 25.0 * t) * (1.0 - 0.3 * (rate * t).sin().max(0.0));
            vec![
                ("wheel_speed_1", wheel(20.0)),
                ("wheel_speed_2", wheel(23.0)),
                ("wheel_speed_3", wheel(17.0)),
                ("wheel_speed_4", wheel(29.0)),
                ("driver_pressure", 1e7),
            ]
        },
    },
];

fn case_of(entry: &Entry) -> &'static Case {
    CASES
        .iter()
        .find(|c| c.models.iter().any(|ending| entry.name.ends_with(ending)))
        .unwrap_or_else(|| panic!("{}", entry.name))
}

fn set(slave: &mut dyn Slave, values: &[(&str, f64)]) {
    for (name, value) in values {
        let index = slave.find(name).unwrap();
        slave.set(index, *value).unwrap();
    }
}

/// How far one output is from what a master that knows it at communication points takes it for in between: root of
/// the sum of squares.
struct Misses {
    output: VariableInfo,
    /// From its last value.
    held: f64,
    /// From the line through it with the derivative that the model gives.
    extrapolated: f64,
    /// From the line with the difference over the last step of the model's own grid.
    by_difference: f64,
    /// The largest derivative that the model gives.
    rate: f64,
}

fn misses(entry: &Entry) -> Vec<Misses> {
    let case = case_of(entry);
    let mut slave = entry.slave(&Settings::default()).unwrap();
    set(slave.as_mut(), case.start);
    set(slave.as_mut(), &(case.inputs)(0.0));
    slave.start(0.0, None).unwrap();
    slave.finish_start().unwrap();
    let outputs: Vec<usize> = {
        let interface = slave.interface();
        interface.with(Causality::Output).filter(|i| interface.variables[*i].is_real()).collect()
    };
    let mut found: Vec<Misses> = outputs
        .iter()
        .map(|o| Misses {
            output: slave.interface().variables[*o].clone(),
            held: 0.0,
            extrapolated: 0.0,
            by_difference: 0.0,
            rate: 0.0,
        })
        .collect();
    let within = COMMUNICATION_STEP / LOOKS as f64;
    // all values so far: the models' own steps are whole numbers of looks
    let own_step = slave.own_step().unwrap();
    let looks_back = (own_step / within).round() as usize;
    let mut past: Vec<Vec<f64>> = Vec::new();
    let mut known = vec![(0.0, 0.0, 0.0); outputs.len()];
    for k in 0..STEPS * LOOKS {
        let (begin, end) = (k as f64 * within, (k + 1) as f64 * within);
        let now: Vec<f64> = outputs.iter().map(|o| slave.get(*o).unwrap()).collect();
        if k % LOOKS == 0 {
            for (i, known) in known.iter_mut().enumerate() {
                let before = past.get(k.wrapping_sub(looks_back)).map_or(now[i], |values| values[i]);
                let rate = slave.output_derivative(outputs[i]).unwrap();
                *known = (now[i], rate, (now[i] - before) / own_step);
                found[i].rate = found[i].rate.max(rate.abs());
            }
        }
        past.push(now);
        set(slave.as_mut(), &(case.inputs)(begin));
        slave.step(begin, end - begin).unwrap();
        let ahead = (k % LOOKS + 1) as f64 * within;
        for ((o, miss), (value, rate, difference)) in outputs.iter().zip(&mut found).zip(&known) {
            let moved = slave.get(*o).unwrap() - value;
            miss.held += moved * moved;
            miss.extrapolated += (moved - rate * ahead).powi(2);
            miss.by_difference += (moved - difference * ahead).powi(2);
        }
    }
    for miss in &mut found {
        for sum in [&mut miss.held, &mut miss.extrapolated, &mut miss.by_difference] {
            *sum = sum.sqrt();
        }
    }
    found
}

/// Before the first step the derivative is what the first step brings, also where inputs run on by themselves: a rim
/// with a velocity moves although nobody set its position anew.
#[test]
fn the_first_derivative_is_that_of_the_first_step() {
    for entry in MODELS {
        let case = case_of(entry);
        let mut slave = entry.slave(&Settings::default()).unwrap();
        set(slave.as_mut(), case.start);
        set(slave.as_mut(), &(case.inputs)(0.0));
        slave.start(0.0, None).unwrap();
        slave.finish_start().unwrap();
        let outputs: Vec<usize> = {
            let interface = slave.interface();
            let moves = |i: &usize| interface.variables[*i].variability == Variability::Continuous;
            interface.with(Causality::Output).filter(moves).collect()
        };
        let rates: Vec<f64> = outputs.iter().map(|o| slave.output_derivative(*o).unwrap()).collect();
        let own_step = slave.own_step().unwrap();
        slave.step(0.0, own_step).unwrap();
        for (output, rate) in outputs.iter().zip(rates) {
            assert_eq!(slave.output_derivative(*output).unwrap(), rate, "{} {output}", entry.name);
        }
    }
}

#[test]
fn extrapolating_with_derivatives_is_never_worse_than_holding() {
    let mut worse = Vec::new();
    let mut ragged = std::collections::BTreeMap::new();
    for entry in MODELS {
        for Misses { output, held, extrapolated, by_difference, rate } in misses(entry) {
            let (ratio, difference) = (extrapolated / held, by_difference / held);
            println!("{:<22} {:<22} {held:10.3e} {ratio:8.3} {difference:8.3}", entry.name, output.name);
            // rounding where both are the same
            if extrapolated > held * (1.0 + 1e-9) {
                worse.push(format!("{} {}: {ratio:.2} times as far off", entry.name, output.name));
            }
            // of some models it is said of all outputs: elements come and go, bristles let go under a wheel that stands
            let ripples = entry.name.starts_with("super-elastic") || entry.name.ends_with("hydropulse");
            if !ripples && rate == 0.0 && held > 0.0 && output.variability == Variability::Continuous {
                // of any wheel
                let name = output.name.rsplit('.').next().unwrap_or_default().to_owned();
                let most: &mut f64 = ragged.entry(name).or_insert(0.0);
                *most = most.max(difference);
            }
        }
    }
    assert!(worse.is_empty(), "{worse:#?}");
    // an output is without derivative only where the difference misleads
    assert_eq!(ragged.keys().map(String::as_str).collect::<Vec<_>>(), ["friction_power"]);
    assert!(ragged.values().all(|most| *most > 1.0), "{ragged:?}");
}
