//! Parameters from recordings: of the measurement programme, driven by the rig in time steps, with a tire that the search does not
//! know.

use latsch::fmi::Entry;
use latsch::identify::recorded::{Answer, Beforehand, Found, Light, Unmet, identify};
use latsch::identify::{Numbers, Plan, RigLimit, Stand, ring_brush};
use latsch::model::{Settings, Slave, Value};
use latsch::recording::Recording;
use latsch::shipped::MODELS;
use latsch::simulate::{Experiment, simulate};
use std::collections::BTreeMap;
use std::sync::OnceLock;

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
    static ONCE: OnceLock<Vec<Recording>> = OnceLock::new();
    ONCE.get_or_init(record).clone()
}

fn record() -> Vec<Recording> {
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
    asked(recordings, &Beforehand { values: Numbers::new(), within }, Unmet::Refused)
}

fn asked(recordings: &[Recording], beforehand: &Beforehand, unmet: Unmet) -> latsch::Result<Answer> {
    identify(&plan(), &Stand::new(slave(), &[]), ring_brush::REGISTRY, beforehand, unmet, recordings)
}

fn found<'a>(answer: &'a Answer, name: &str) -> &'a Found {
    answer.parameters.iter().find(|p| p.name == name).unwrap()
}

/// Time steps of half a millisecond against stationary states of a continuum: what is found is the tire within what the two differ by. A guess is where the search
/// begins, also beyond the bounds of what is looked for; the tests below begin without any.
#[test]
fn the_tire_is_found_from_its_recordings_wherever_the_search_begins() {
    let values = [("patch_compliance_x", 6e-6), ("sidewall_lateral_stiffness", 4e5)];
    let values = values.map(|(name, value)| (name.to_owned(), value)).into();
    let answer =
        asked(&recordings(), &Beforehand { values, ..Beforehand::default() }, Unmet::Refused).unwrap();
    for (name, value) in TRUTH {
        let found = answer.values.get(name).unwrap_or_else(|| panic!("{name} is not found: {answer:?}"));
        // a compliance that is a small part of a slope shows what the two differ by most
        let most = if name == "patch_compliance_y" { 0.02 } else { 0.004 };
        assert!((found / value - 1.0).abs() < most, "{name}: {found} instead of {value}");
        assert!(self::found(&answer, name).half_width.unwrap() > 0.0);
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
    // what two evaluators, time steps and stationary states, say of the same tire at the same inputs
    assert!(answer.misfits.is_empty() && answer.characteristics.len() >= 6, "{:?}", answer.misfits);
    for characteristic in &answer.characteristics {
        let size = characteristic.measured.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        for (measured, modelled) in characteristic.measured.iter().zip(&characteristic.modelled) {
            assert!((measured - modelled).abs() < 5e-3 * size, "{characteristic:?}");
        }
    }
}

/// A tire whose sliding friction falls faster with the load than the model can: refused, or the nearest friction, and nothing else.
#[test]
fn what_no_parameters_meet_is_refused_or_told_and_met_as_nearly_as_can_be() {
    let mut recordings = recordings();
    let own = recordings.iter_mut().find(|r| r.source == "dragged-sideways").unwrap();
    let load = own.channels.iter().find(|c| c.name == "force_z").unwrap().values.clone();
    let force = own.channels.iter_mut().find(|c| c.name == "force_y").unwrap();
    force.values.iter_mut().zip(load).for_each(|(v, load)| *v *= if load > 4000.0 { 0.9 } else { 1.0 });
    let refused = answer(&recordings).unwrap_err().to_string();
    for word in
        ["group \"sliding friction\"", "dragged-sideways", "fall of sliding friction, share = 1", "--nearest"]
    {
        assert!(refused.contains(word), "{word}: {refused}");
    }
    let answer = asked(&recordings, &Beforehand::default(), Unmet::Nearest).unwrap();
    // earlier groups do not give way: a little of their contacts slides, too
    for (name, value) in TRUTH.iter().take(6) {
        let most = if *name == "patch_compliance_y" { 0.03 } else { 0.01 };
        assert!((answer.values[*name] / value - 1.0).abs() < most, "{name}: {}", answer.values[*name]);
    }
    let row = found(&answer, "friction_sliding_zero");
    assert!(row.light == Light::Yellow && row.why.as_ref().unwrap().contains("as far as it goes"), "{row:?}");
    // the one parameter that is left lies between the two, and each interval is as wide as what is missed
    let target = |name: &str| answer.targets.iter().find(|t| t.name.starts_with(name)).unwrap();
    let [light, heavy] = ["sliding force at 3000", "sliding force at 5000"].map(target);
    assert!(light.modelled < light.measured && heavy.modelled > heavy.measured, "{light:?} {heavy:?}");
    for target in [light, heavy] {
        assert!(target.half_width >= (target.measured - target.modelled).abs(), "{target:?}");
        assert!(answer.notes.iter().any(|note| note.contains(&target.name)), "{:?}", answer.notes);
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
    recordings.retain(|r| ["off-the-road-at-the-beginning", "springs"].contains(&r.source.as_str()));
    let within = [("sidewall_radial_stiffness", 0.02)];
    let [wide, narrow] = [&[][..], &within]
        .map(|within| answer_within(&recordings, within).unwrap())
        .map(|answer| found(&answer, "vertical_stiffness").half_width.unwrap());
    assert!(narrow < 0.5 * wide, "{narrow} {wide}");
    let refused = answer_within(&recordings, &[("sidewall", 0.1)]).unwrap_err().to_string();
    assert!(refused.contains("does not look for sidewall"), "{refused}");
}

#[test]
fn what_is_missing_is_said_with_what_comes_nearest() {
    let mut few = recordings();
    let first = "off-the-road-at-the-beginning";
    few.retain(|r| [first, "springs", "small-slips-at-2600-N"].contains(&r.source.as_str()));
    let answer = answer(&few).unwrap();
    assert_eq!(found(&answer, "vertical_stiffness").light, Light::Green);
    let why = found(&answer, "stripe_length_factor").why.clone().unwrap();
    for word in ["aligning moment per camber", "nearest is springs from", "path_speed = 0.0000", "1 to 15"] {
        assert!(why.contains(word), "{why}");
    }
    // nothing but a zero
    let zero: Vec<Recording> = few.iter().filter(|r| r.source == first).cloned().collect();
    let refused = self::answer(&zero).unwrap_err().to_string();
    assert!(refused.contains("identify nothing") && refused.contains("nearest is off-the-road"), "{refused}");
    // a load cell of which no zero is known
    few.retain(|r| r.source == "small-slips-at-2600-N");
    let refused = self::answer(&few).unwrap_err().to_string();
    assert!(refused.contains("zero of the load cell") && refused.contains("off the road"), "{refused}");
}

/// Recordings with the channels whose names `is` knows times a factor, in the runs that `run` is part of the name of.
fn scaled(good: &[Recording], run: &str, is: impl Fn(&str) -> bool, factor: f64) -> Vec<Recording> {
    let mut wrong = good.to_vec();
    let own = wrong.iter_mut().filter(|r| r.source.contains(run)).flat_map(|r| &mut r.channels);
    for channel in own.filter(|c| is(&c.name)) {
        channel.values.iter_mut().for_each(|v| *v *= factor);
    }
    wrong
}

#[test]
fn recordings_that_the_model_cannot_explain_are_refused_with_the_likely_reason() {
    let good = recordings();
    let refused = |run, channel: &str, factor| {
        answer(&scaled(&good, run, |name| name.starts_with(channel), factor)).unwrap_err().to_string()
    };
    let degree = 180.0 / std::f64::consts::PI;
    let faults: [(&str, f64, &[&str]); 9] = [
        ("force", 1e-3, &["\"force_z\"", "kN for N"]),
        ("force_y", -1.0, &["\"force_y\"", "the other sign", "small-motions", "or that of slip_angle"]),
        ("slip_angle", degree, &["\"slip_angle\"", "degrees for radians"]),
        ("slip_angle", 1.0 / degree, &["\"slip_angle\"", "radians for degrees"]),
        ("path_speed", 3.6, &["\"path_speed\"", "km/h for m/s"]),
        ("deflection", 1e3, &["\"deflection\"", "mm for m"]),
        ("deflection", -1.0, &["\"deflection\"", "the other sign"]),
        ("slip", 100.0, &["\"slip", "per cent"]),
        ("camber", -1.0, &["\"camber\"", "other sign of one of the two"]),
    ];
    for (channel, factor, words) in faults {
        // the slip, and not the slip angle with it
        let is = |name: &str| if channel == "slip" { name == channel } else { name.starts_with(channel) };
        let refused = answer(&scaled(&good, "", is, factor)).unwrap_err().to_string();
        for word in words.iter().copied() {
            assert!(refused.contains(word), "{channel} times {factor}: {refused}");
        }
    }
    // forces that no compliance within the plan's bounds gives
    let stiff = refused("", "force_y", 2.2);
    assert!(stiff.contains("lateral force per slip angle") && stiff.contains("latsch diagnose"), "{stiff}");
    let other = refused("driven", "force_x", 1.3);
    assert!(other.contains("force driven at 6000 N") && other.contains("driven-and-braked"), "{other}");
}

/// What no target reads tells whether the model is right: as many targets as parameters are always met.
#[test]
fn outputs_that_contradict_the_model_are_told() {
    let mut recordings = recordings();
    // a side force that the model does not have, where longitudinal forces are read
    let own = recordings.iter_mut().find(|r| r.source == "driven-and-braked").unwrap();
    let side = own.channels.iter_mut().find(|c| c.name == "force_y").unwrap();
    side.values.iter_mut().for_each(|v| *v += 300.0);
    let odd = answer(&recordings).unwrap();
    let [misfit] = &odd.misfits[..] else { panic!("{:?}", odd.misfits) };
    assert!(misfit.recording == "driven-and-braked" && misfit.output == "force_y", "{misfit:?}");
    assert!((misfit.left - 300.0).abs() < 30.0 && misfit.expected < 200.0, "{misfit:?}");
    assert!(misfit.words().contains("latsch diagnose"), "{}", misfit.words());
    let row = found(&odd, "patch_compliance_x");
    assert!(row.light == Light::Yellow && row.why.as_ref().unwrap().contains("force_y"), "{row:?}");
}

#[test]
fn nothing_is_read_across_gaps_nor_where_nothing_comes_to_rest() {
    let mut recordings = recordings();
    recordings.retain(|r| r.source != "driven-and-braked" && r.source != "pressed-down-at-a-slip-angle");
    let own = recordings.iter_mut().find(|r| r.source == "small-motions-at-5000-N").unwrap();
    // 12 s are lost, among them two of the three visits of each camber
    let kept: Vec<usize> = (0..own.time.len()).filter(|k| !(20.0..32.0).contains(&own.time[*k])).collect();
    own.time = kept.iter().map(|k| own.time[*k]).collect();
    for channel in &mut own.channels {
        channel.values = kept.iter().map(|k| channel.values[*k]).collect();
    }
    // a force that creeps all the time
    let own = recordings.iter_mut().find(|r| r.source == "dragged-sideways").unwrap();
    let time = own.time.clone();
    let force = own.channels.iter_mut().find(|c| c.name == "force_y").unwrap();
    force.values.iter_mut().zip(time).for_each(|(v, t)| *v += 100.0 * t);
    let answer = answer(&recordings).unwrap();
    let note = answer.notes.iter().find(|n| n.contains("nothing is recorded from")).unwrap();
    assert!(note.contains("small-motions") && note.contains("from 20.00 to 32.0"), "{note}");
    for (name, value) in TRUTH.iter().take(6) {
        let most = if *name == "patch_compliance_y" { 0.03 } else { 0.006 };
        assert!((answer.values[*name] / value - 1.0).abs() < most, "{name}: {}", answer.values[*name]);
    }
    let row = found(&answer, "friction_sliding_zero");
    let why = row.why.as_ref().unwrap();
    let is_told = why.contains("dragged-sideways") && why.contains("force_y does not come to rest");
    assert!(row.light == Light::Red && is_told, "{why}");
}

/// What is not identified keeps its value, also where an earlier group has to assume one; a ramp that begins in contact is none.
#[test]
fn what_cannot_be_read_keeps_its_value() {
    let mut recordings = recordings();
    recordings.retain(|r| r.source != "driven-and-braked");
    let own = recordings.iter_mut().find(|r| r.source == "pressed-down-at-a-slip-angle").unwrap();
    let up = own.channels.iter_mut().find(|c| c.name == "deflection").unwrap();
    up.values.iter_mut().for_each(|v| *v = v.max(1e-3));
    let answer = answer(&recordings).unwrap();
    for (name, value) in
        [("friction_static_zero", 1.5), ("friction_static_reference", 1.4), ("patch_compliance_x", 3e-6)]
    {
        let row = found(&answer, name);
        assert!(row.light == Light::Red && (row.value / value - 1.0).abs() < 1e-12, "{row:?}");
        assert!(
            answer.values.get(name).is_none_or(|v| (v / value - 1.0).abs() < 1e-12),
            "{:?}",
            answer.values
        );
    }
    let row = found(&answer, "sidewall_lateral_stiffness");
    assert!(row.light == Light::Red && row.why.as_ref().unwrap().contains("begins"), "{row:?}");
    assert!(found(&answer, "friction_sliding_zero").light != Light::Red);
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
