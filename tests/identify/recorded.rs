//! Parameters from recordings: of the measurement programme, driven by the rig in time steps, with a tire that the search does not
//! know.

use latsch::fmi::Entry;
use latsch::identify::recorded::{Answer, Beforehand, Found, Light, identify};
use latsch::identify::{Numbers, Plan, RigLimit, Stand, ring_brush};
use latsch::model::{Settings, Slave, Value};
use latsch::recording::Recording;
use latsch::shipped::MODELS;
use latsch::simulate::{Experiment, simulate};
use std::collections::BTreeMap;

/// The tire at the rig.
const TRUTH: [(&str, f64); 9] = [
    ("vertical_stiffness", 165e3),
    ("vertical_stiffness_quadratic", 2.2e6),
    ("bristle_stiffness", 3.6e4),
    ("stripe_length_factor", 0.8),
    ("patch_compliance_twist", 9e-5),
    ("patch_compliance_y", 9e-7),
    ("patch_compliance_x", 2.6e-6),
    ("friction_static_zero", 1.45),
    ("sidewall_lateral_stiffness", 95e3),
];
/// The channels of a rig.
const MEASURED: [&str; 9] =
    ["deflection", "path_speed", "slip", "slip_angle", "camber", "force_x", "force_y", "force_z", "moment_z"];

fn slave() -> Box<dyn Slave> {
    Entry::find(MODELS, "ring-brush-flat-track").unwrap().slave(&Settings::default()).unwrap()
}

fn plan() -> Plan {
    Plan::read(ring_brush::PLAN).unwrap()
}

/// The programme's recordings of the tire, at 500 Hz.
fn recordings() -> Vec<Recording> {
    let mut rig = slave();
    let interface = rig.interface().clone();
    let runs = plan().runs(&interface, &BTreeMap::new()).unwrap();
    runs.iter()
        .map(|run| {
            rig.reset().unwrap();
            let own = run.switches.iter().map(|(name, value)| (name.as_str(), *value)).chain(TRUTH);
            let values = own
                .map(|(name, value)| {
                    let variable = interface.find(name).unwrap();
                    let is_switch = matches!(interface.variables[variable].start, Some(Value::Boolean(_)));
                    (variable, if is_switch { Value::Boolean(value != 0.0) } else { Value::Real(value) })
                })
                .collect();
            let inputs = Some(&run.inputs);
            let experiment = Experiment { inputs, values, start: None, stop: None, step: Some(2e-3) };
            let outcome = simulate(&mut *rig, &experiment, |_, _| {}).unwrap();
            assert!(outcome.stopped.is_none(), "{}: {:?}", run.name, outcome.stopped);
            let mut recording = outcome.recording;
            recording.channels.retain(|c| MEASURED.contains(&c.name.as_str()));
            recording.source.clone_from(&run.name);
            recording
        })
        .collect()
}

fn answer(recordings: &[Recording]) -> latsch::Result<Answer> {
    answer_within(recordings, &[])
}

/// With what is known of some parameters, as a share of their values.
fn answer_within(recordings: &[Recording], within: &[(&str, f64)]) -> latsch::Result<Answer> {
    let within = within.iter().map(|(name, share)| ((*name).to_owned(), *share)).collect();
    let beforehand = Beforehand { values: Numbers::new(), within };
    identify(&plan(), &Stand::new(slave(), &[]), ring_brush::REGISTRY, &beforehand, recordings)
}

fn found<'a>(answer: &'a Answer, name: &str) -> &'a Found {
    answer.parameters.iter().find(|p| p.name == name).unwrap()
}

/// Time steps of half a millisecond against stationary states of a continuum: what is found is the tire within what the two differ by.
#[test]
fn the_tire_is_found_from_its_recordings() {
    let answer = answer(&recordings()).unwrap();
    for (name, value) in TRUTH {
        let found = answer.values.get(name).unwrap_or_else(|| panic!("{name} is not found: {answer:?}"));
        // a compliance that is a small part of a slope shows what the two differ by most
        let most = if name == "patch_compliance_y" { 0.02 } else { 0.004 };
        assert!((found / value - 1.0).abs() < most, "{name}: {found} instead of {value}");
    }
    // what the targets do not tell is not guessed
    for name in ["sidewall_radial_stiffness", "sidewall_tilt_stiffness"] {
        let row = found(&answer, name);
        assert!(row.light == Light::Red && row.half_width.is_none() && row.why.is_some(), "{row:?}");
        assert!(!answer.values.contains_key(name));
    }
    for target in &answer.targets {
        assert!((target.measured / target.modelled - 1.0).abs() < 1e-5, "{target:?}");
    }
}

/// White noise of 1 % of the range of each channel, angles that are off by 0.05 degrees, and a load cell that is off.
#[test]
fn noise_widens_intervals_and_offsets_are_found() {
    let mut recordings = recordings();
    let mut state = 1_u64;
    let mut normal = || {
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    };
    let ranges = [("force_x", 8500.0), ("force_y", 5500.0), ("force_z", 9000.0), ("moment_z", 90.0)];
    let offsets = [("slip_angle", 8.7e-4), ("camber", -8.7e-4), ("force_y", 60.0), ("force_z", -90.0)];
    for channel in recordings.iter_mut().flat_map(|r| &mut r.channels) {
        let of =
            |all: &[(&str, f64)]| all.iter().find(|(name, _)| *name == channel.name).map_or(0.0, |(_, v)| *v);
        let (noise, offset) = (0.01 * of(&ranges), of(&offsets));
        channel.values.iter_mut().for_each(|v| *v += noise * normal() + offset);
    }
    let answer = answer(&recordings).unwrap();
    let angle = answer.offsets.iter().find(|(name, _)| name == "slip_angle").unwrap().1;
    assert!((angle - 8.7e-4).abs() < 1e-4, "{angle}");
    let zero = answer.zeros.iter().find(|(name, _)| name == "force_z").unwrap().1;
    assert!((zero + 90.0).abs() < 10.0, "{zero}");
    let truth = [
        ("vertical_stiffness", 165e3),
        ("vertical_stiffness_quadratic", 2.2e6),
        ("cross_section_radius", 0.675),
        ("bristle_stiffness", 3.6e4),
        ("stripe_length_factor", 0.8),
        ("patch_compliance_twist", 9e-5),
        ("patch_compliance_y", 9e-7),
        ("friction_sliding_zero", 1.1),
        ("patch_compliance_x", 2.6e-6),
        ("friction_static_zero", 1.45),
        ("sidewall_lateral_stiffness", 95e3),
    ];
    for (name, value) in truth {
        let row = found(&answer, name);
        let half = row.half_width.unwrap_or_else(|| panic!("{row:?}"));
        assert!((row.value - value).abs() < 2.0 * half, "{row:?} instead of {value}");
        assert!(half > 1e-4 * value, "{row:?}");
    }
    // two springs in series: who knows the one better knows the other better
    let within = [("sidewall_radial_stiffness", 0.02)];
    let [wide, narrow] = [&answer, &answer_within(&recordings, &within).unwrap()]
        .map(|answer| found(answer, "vertical_stiffness").half_width.unwrap());
    assert!(narrow < 0.5 * wide, "{narrow} {wide}");
    let refused = answer_within(&recordings, &[("sidewall", 0.1)]).unwrap_err().to_string();
    assert!(refused.contains("does not look for sidewall"), "{refused}");
}

#[test]
fn what_is_missing_is_said_with_what_comes_nearest() {
    let mut few = recordings();
    few.retain(|r| ["off-the-road", "springs", "small-slips-at-2600-N"].contains(&r.source.as_str()));
    let answer = answer(&few).unwrap();
    assert_eq!(found(&answer, "vertical_stiffness").light, Light::Green);
    let why = found(&answer, "stripe_length_factor").why.clone().unwrap();
    for word in ["aligning moment per camber", "nearest is springs from", "path_speed = 0.0000", "1 to 15"] {
        assert!(why.contains(word), "{why}");
    }
    // nothing but a zero
    let zero: Vec<Recording> = few.iter().filter(|r| r.source == "off-the-road").cloned().collect();
    let refused = self::answer(&zero).unwrap_err().to_string();
    assert!(refused.contains("identify nothing") && refused.contains("nearest is off-the-road"), "{refused}");
    // a load cell of which no zero is known
    few.retain(|r| r.source == "small-slips-at-2600-N");
    let refused = self::answer(&few).unwrap_err().to_string();
    assert!(refused.contains("zero of the load cell") && refused.contains("off the road"), "{refused}");
}

#[test]
fn recordings_that_the_model_cannot_explain_are_refused_with_the_likely_reason() {
    let good = recordings();
    let wrong = |is: fn(&str) -> bool, factor: f64| {
        let mut wrong = good.clone();
        for channel in wrong.iter_mut().flat_map(|r| &mut r.channels).filter(|c| is(&c.name)) {
            channel.values.iter_mut().for_each(|v| *v *= factor);
        }
        answer(&wrong).unwrap_err().to_string()
    };
    let kilonewtons = wrong(|name| name.starts_with("force"), 1e-3);
    assert!(kilonewtons.contains("force_z") && kilonewtons.contains("kN for N"), "{kilonewtons}");
    let sign = wrong(|name| name == "force_y", -1.0);
    assert!(sign.contains("force_y") && sign.contains("sign") && sign.contains("small-motions"), "{sign}");
    // forces that no compliance within the plan's bounds gives
    let stiff = wrong(|name| name == "force_y", 2.2);
    assert!(stiff.contains("lateral force per slip angle") && stiff.contains("latsch diagnose"), "{stiff}");
}

#[test]
fn a_programme_stays_within_what_the_rig_can_do() {
    let interface = slave().interface().clone();
    let slow = BTreeMap::from([("slip_angle".to_owned(), RigLimit { rate: 0.05, between: None })]);
    let [usual, slow] = [BTreeMap::new(), slow].map(|limits| plan().runs(&interface, &limits).unwrap());
    for (a, b) in usual.iter().zip(&slow) {
        let rate = |run: &latsch::identify::RigRun| {
            let time = &run.inputs.time;
            let values = &run.inputs.channel("slip_angle").unwrap().values;
            let rates =
                (1..time.len()).map(|k| ((values[k] - values[k - 1]) / (time[k] - time[k - 1])).abs());
            rates.fold(0.0, f64::max)
        };
        assert!(rate(a) < 0.1 + 1e-9 && rate(b) < 0.05 + 1e-9, "{}", a.name);
    }
    for limit in [RigLimit { rate: 0.1, between: Some([-0.2, 0.2]) }, RigLimit { rate: 0.0, between: None }] {
        let limits = BTreeMap::from([("slip_angle".to_owned(), limit)]);
        let refused = plan().runs(&interface, &limits).unwrap_err().to_string();
        assert!(refused.contains("slip_angle") && refused.contains("run \""), "{refused}");
    }
    let limits = BTreeMap::from([("deflection".to_owned(), RigLimit { rate: 0.05, between: None })]);
    let refused = plan().runs(&interface, &limits).unwrap_err().to_string();
    assert!(refused.contains("pressed-down-at-a-slip-angle") && refused.contains("0.08"), "{refused}");
}
