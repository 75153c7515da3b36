//! Stiffness and damping of a solid tire from recordings: what was put in comes back, and what recordings cannot tell is refused.
//!
//! Recordings are made here by the printed equations of the source, written once more (a static sum, an oscillator that is hit), and by the
//! shipped rig with its own tire. Nothing of `latsch::characteristic` makes them.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::{get, set, started};
use latsch::characteristic::{Answer, Law, Plan, characterize_with, parameters};
use latsch::model::{Settings, Slave, Value};
use latsch::recording::{Channel, Recording, parse_csv, to_csv, write_csv};
use latsch::rig::{HydroPulse, Wheel};
use latsch::stats::SplitMix64;
use latsch::tire::super_elastic::SuperElastic;
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

const R0: f64 = 0.2265;
const N: usize = 45;

// ---- recordings by the printed equations

/// Sum of z cos and number of the elements in contact at a deflection, one element below the centre.
fn sums(e: f64) -> (f64, f64) {
    (-10..=10).fold((0.0, 0.0), |(sum, m), n| {
        let gamma = f64::from(n) * TAU / N as f64;
        let z = R0 - (R0 - e) / gamma.cos();
        if z > 0.0 { (sum + z * gamma.cos(), m + 1.0) } else { (sum, m) }
    })
}

/// What a tire of one-point elements has: k = k0 (F / F0)^a, c = c0 (F / F0)^p (v / v0)^q.
#[derive(Clone, Copy)]
struct Truth {
    k0: f64,
    a: f64,
    c0: f64,
    p: f64,
    q: f64,
}

const F0: f64 = 9000.0;
const V0: f64 = 2.0;
const TRUTH: Truth = Truth { k0: 120e3, a: -0.15, c0: 600.0, p: 0.2, q: -0.4 };

impl Truth {
    /// F = k0 (F / F0)^a S(e)
    fn force(&self, e: f64) -> f64 {
        (self.k0 * F0.powf(-self.a) * sums(e).0).powf(1.0 / (1.0 - self.a))
    }

    fn deflection(&self, load: f64) -> f64 {
        let (mut low, mut high) = (0.0, 0.1);
        for _ in 0..60 {
            let e = 0.5 * (low + high);
            if self.force(e) < load { low = e } else { high = e }
        }
        low
    }
}

fn recording(name: &str, step: f64, channels: &[(&str, &str, Vec<f64>)]) -> Recording {
    let n = channels[0].2.len();
    let channel = |(name, unit, values): &(&str, &str, Vec<f64>)| Channel {
        name: (*name).into(),
        unit: (*unit).into(),
        values: values.clone(),
    };
    Recording {
        time: (0..n).map(|k| step * k as f64).collect(),
        channels: channels.iter().map(channel).collect(),
        source: name.into(),
    }
}

/// A harmonic deflection \[mm\] between two places and the force \[kN\] of spring and damper, at 1 kHz with noise.
fn made_loop(truth: Truth, [low, high]: [f64; 2], cycles: f64, seed: u64) -> Recording {
    let mut random = SplitMix64::new(seed);
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let (mut e, mut f) = (Vec::new(), Vec::new());
    for k in 0..(1000.0 * cycles) as usize {
        let (sin, cos) = (TAU * 1e-3 * k as f64 + 0.7).sin_cos();
        let (x, v) = (middle - half * cos, half * TAU * sin);
        e.push(1e3 * x + 0.02 * random.normal());
        f.push(1e-3 * (truth.force(x) + truth.c0 * sums(x).1 * v) + 0.04 * random.normal());
    }
    recording("loop.csv", 1e-3, &[("cylinder", "mm", e), ("cell", "kN", f)])
}

/// A mass on the whole tire at a load and a speed, hit every `period` seconds: the place of the arm \[mm\].
fn made_decays(truth: Truth, load: f64, speed: f64, mass: f64, period: f64, seed: u64) -> Recording {
    let mut random = SplitMix64::new(seed);
    let e = truth.deflection(load);
    // a rolling tire has theta / gamma_0 elements in contact, on average
    let touching = 2.0 * (1.0 - e / R0).acos() / (TAU / N as f64);
    let c = truth.c0 * (load / F0).powf(truth.p) * (speed / V0).powf(truth.q) * touching;
    // the stiffness is that of the load, and does not follow the swing
    let k = truth.k0 * (load / F0).powf(truth.a) * touching;
    let (mut x, mut v, h) = (0.0, 0.0, 5e-5);
    let passage = 0.15 / speed;
    let values = (0..(24.0 * period / h) as usize)
        .filter_map(|i| {
            let since = (i as f64 * h - 0.4).rem_euclid(period);
            let lifted = if since < passage { 0.005 * (PI * since / passage).sin() } else { 0.0 };
            v += h * (k * (lifted - x) - c * v) / mass;
            x += h * v;
            (i % 40 == 0).then(|| 1e3 * (e - x) + 0.05 * random.normal())
        })
        .collect();
    recording("decay.csv", 40.0 * h, &[("arm", "mm", values)])
}

const TIRE: &str = "title = \"test\"\n[tire]\nname = \"SE 18x7-8\"\nradius = \"226.5 mm\"\nelements = 45\ncontact_points = 1\ncontact_stiffness = 0\nrubber_mass = \"1 g\"\n";
const LOOP: &str = "[[loop]]\nfile = \"loop.csv\"\nforce = \"cell\"\ndeflection = \"cylinder\"\n";

fn decay_of(load: f64, speed: f64, rest: &str) -> String {
    format!(
        "[[decay]]\nfile = \"{load} {speed}\"\nchannel = \"arm\"\nload = {load}\nspeed = \"{speed} m/s\"\ncleat_length = \"150 mm\"\n{rest}\n"
    )
}

fn solve(plan: &str, files: &BTreeMap<String, Recording>) -> latsch::Result<Answer> {
    // through the text of a file, as a rig's computer would have it
    characterize_with(&Plan::read(plan)?, &|file: &str| parse_csv(&to_csv(&files[file])?, file))
}

fn files(all: impl IntoIterator<Item = (String, Recording)>) -> BTreeMap<String, Recording> {
    all.into_iter().collect()
}

fn off(found: f64, truth: f64) -> f64 {
    found / truth - 1.0
}

// ---- round trips

#[test]
fn parameters_come_back_within_a_percent_from_loops_and_decays_with_noise() {
    let loads = [6572.0, 9260.0, 14960.0];
    let mut all = files([("loop.csv".to_owned(), made_loop(TRUTH, [0.5e-3, 27e-3], 9.0, 1))]);
    let mut plan = format!(
        "{TIRE}[characteristic]\nreference_load = {F0}\nreference_speed = {V0}\nelements = [75, 105]\n{LOOP}"
    );
    for (i, load) in loads.into_iter().enumerate() {
        for (j, speed) in [1.0, 2.0, 3.5].into_iter().enumerate() {
            // weights on an arm: the mass is not the load over gravity
            let mass = 1.15 * load / 9.81;
            let made = made_decays(TRUTH, load, speed, mass, 4.0, (10 * i + j) as u64);
            all.insert(format!("{load} {speed}"), made);
            plan += &decay_of(load, speed, &format!("pivot_inertia = {:?}\nwheel_arm = 1.2", mass * 1.44));
        }
    }
    let answer = solve(&plan, &all).unwrap();
    let (k, c) = (&answer.stiffness, &answer.damping);
    assert_eq!((k.law, c.law), (Law::Power, Law::Power), "{} / {}", k.why, c.why);
    let found = [
        ("k0", k.value, TRUTH.k0),
        ("c0", c.value, TRUTH.c0),
        ("a", k.load_exponent.unwrap(), TRUTH.a),
        ("p", c.load_exponent.unwrap(), TRUTH.p),
        ("q", c.speed_exponent.unwrap(), TRUTH.q),
    ];
    for (name, known, truth) in found {
        println!(
            "{name}: {} ± {} for {truth}: {:+.3} %",
            known.value,
            known.half_width,
            100.0 * off(known.value, truth)
        );
    }
    // constants within 1 %; exponents so that twice the load or speed is within 1 %
    assert!(off(k.value.value, TRUTH.k0).abs() < 0.01 && off(c.value.value, TRUTH.c0).abs() < 0.01);
    for (_, known, truth) in &found[2..] {
        assert!((2_f64.powf(known.value - truth) - 1.0).abs() < 0.01, "{known:?} {truth}");
    }
    // intervals are no decoration: they have the truth, give or take
    for (name, known, truth) in found {
        assert!(known.half_width < 0.05 * truth.abs().max(1.0), "{name}: {known:?}");
        assert!((known.value - truth).abs() < 2.0 * known.half_width, "{name}: {known:?} {truth}");
    }
    for decay in &answer.decays {
        let (mass, load) = (1.15 * decay.load / 9.81, decay.load);
        assert!((decay.mass / mass - 1.0).abs() < 1e-9);
        assert!(
            off(decay.stiffness.value, decay.tangent).abs() < 0.02,
            "{load}: {} {}",
            decay.stiffness.value,
            decay.tangent
        );
    }
    // the loop says the damping of the standing wheel once more
    assert!(
        off(answer.loops[0].element_damping.value, TRUTH.c0).abs() < 0.01,
        "{:?}",
        answer.loops[0].element_damping
    );
    assert_eq!(answer.over_speed.len(), 3);
    for laws in &answer.over_speed {
        assert!((laws.power[1].value - TRUTH.q).abs() < 0.03, "{laws:?}");
    }
    assert_eq!(
        answer.elements.iter().map(|e| e.elements).collect::<std::collections::BTreeSet<_>>().len(),
        3
    );
    // what is written is what the model takes
    let read = Plan::read(&plan).unwrap();
    let text = parameters(&read, &answer).unwrap();
    let model = started::<HydroPulse<SuperElastic>>(&[("contact_points", 1.0)]);
    let values = Settings::parse(&text, "parameters.toml").unwrap().check(model.interface()).unwrap();
    let index = model.interface().index("damping_speed_exponent").unwrap();
    assert!(values.iter().any(|(i, _)| *i == index), "{text}");
}

/// Force and way of the shipped rig as its channels have them, with noise.
fn hydropulse(start: &[(&str, f64)], seconds: f64) -> Recording {
    let step = 2e-3;
    let base = [("control", 2.0), ("excitation", 2.0), ("excitation_frequency", 2.0), ("step_size", 5e-4)];
    let mut rig = started::<HydroPulse<SuperElastic>>(&[&base, start].concat());
    let (mut way, mut force) = (Vec::new(), Vec::new());
    for k in 0..(seconds / step) as usize {
        way.push(1e3 * get(&mut rig, "piston_position"));
        force.push(get(&mut rig, "cell_force"));
        rig.step(k as f64 * step, step).unwrap();
    }
    let mut random = SplitMix64::new(5);
    way.iter_mut().for_each(|w| *w += 0.01 * random.normal());
    force.iter_mut().for_each(|f| *f += 20.0 * random.normal());
    recording("loop.csv", step, &[("cylinder", "mm", way), ("cell", "N", force)])
}

#[test]
fn the_shipped_rig_gives_back_the_parameters_of_its_tire() {
    let off_road = |rim_force: f64| {
        let up = [("position", -0.01), ("excitation", 1.0), ("rim_force", rim_force)];
        let mut rig = started::<HydroPulse<SuperElastic>>(
            &[("control", 2.0)].into_iter().chain(up).collect::<Vec<_>>(),
        );
        get(&mut rig, "cell_force")
    };
    for (rim_force, name) in [(1.0, "radial"), (2.0, "exact")] {
        let start = [("position", 0.013), ("excitation_amplitude", 0.0125), ("rim_force", rim_force)];
        let all = files([("loop.csv".to_owned(), hydropulse(&start, 20.0))]);
        let plan = format!(
            "title = \"t\"\n[tire]\nname = \"SE\"\nradius = 0.2265\nelements = 45\nrim_force = \"{name}\"\n{LOOP}mass_below_cell = 30\ntared_with_wheel = true\nforce_off_road = {:?}\n",
            off_road(rim_force)
        );
        let answer = solve(&plan, &all).unwrap();
        let (k, c) = (&answer.stiffness, &answer.damping);
        println!(
            "{name}: k {:?} {:+.3} %, {:?}, c {:?} {:+.3} %",
            k.value,
            100.0 * off(k.value.value, 122e3),
            k.load_exponent,
            c.value,
            100.0 * off(c.value.value, 280.0)
        );
        assert_eq!(k.law, Law::Constant, "{}", k.why);
        assert!(off(k.value.value, 122e3).abs() < 0.01, "{:?}", k.value);
        assert!(off(c.value.value, 280.0).abs() < 0.01, "{:?}", c.value);
    }
}

/// Deflection \[mm\] of a wheel under a mass that rolls over a cleat every `spacing` metres, with noise.
fn rolling(damping: f64, speed: f64, spacing: f64, seconds: f64) -> Recording {
    let step = 2e-3;
    let cleats = [
        ("road_kind", 4.0),
        ("road_start", 0.5 * speed),
        ("road_height", 0.005),
        ("road_length", 0.15),
        ("road_spacing", spacing),
    ];
    let wheel = [
        ("rim_force", 2.0),
        ("rolling_resistance", 0.0),
        ("element_radial_damping", damping),
        ("hub_mass", MASS - 19.8),
        ("axle_force_z", 0.0),
        ("initial_load", (MASS - 19.8) * 9.81),
        ("initial_speed", speed),
        ("step_size", 2e-4),
    ];
    let mut wheel = started::<Wheel<SuperElastic>>(&[&cleats[..], &wheel].concat());
    let mut random = SplitMix64::new(8);
    let mut deflection = Vec::new();
    for k in 0..(seconds / step) as usize {
        deflection.push(1e3 * (R0 - get(&mut wheel, "position_z")) + 0.02 * random.normal());
        // a drum's drive: dampers and cleats take speed
        let lost = speed - get(&mut wheel, "velocity_x");
        set(&mut wheel, &[("drive_torque", 3000.0 * lost)]);
        wheel.step(k as f64 * step, step).unwrap();
    }
    recording("decay.csv", step, &[("arm", "mm", deflection)])
}

const MASS: f64 = 944.0;

#[test]
fn the_shipped_tire_rolling_over_cleats_gives_back_its_damping_or_the_note_why_not() {
    for (damping, speed, within) in [(280.0, 2.0, 0.025), (280.0, 3.0, 0.03), (600.0, 4.0, 0.09)] {
        // until a twentieth is left
        let period = if damping < 500.0 { 3.2 } else { 1.8 };
        let all = files([("d".to_owned(), rolling(damping, speed, period * speed, 9.5 * period))]);
        let plan = format!(
            "title = \"t\"\n[tire]\nname = \"SE\"\nradius = 0.2265\nelements = 45\nrim_force = \"exact\"\nelement_stiffness = \"122 N/mm\"\n[[decay]]\nfile = \"d\"\nchannel = \"arm\"\nload = {}\nspeed = {speed}\nmass = {MASS}\ncleat_length = \"150 mm\"\n",
            MASS * 9.81
        );
        let answer = solve(&plan, &all).unwrap();
        let decay = &answer.decays[0];
        println!(
            "{damping} at {speed} m/s: {:+.2} % ± {:.2} %, k {:+.2} %, {:?}",
            100.0 * off(decay.element.value, damping),
            100.0 * decay.element.share(),
            100.0 * off(decay.stiffness.value, decay.tangent),
            decay.analysis.notes
        );
        assert!(off(decay.element.value, damping).abs() < within, "{:?}", decay.element);
        assert!(off(decay.stiffness.value, decay.tangent).abs() < 0.01);
        assert!(
            decay.analysis.notes.iter().any(|n| n.contains("leave the road")),
            "{:?}",
            decay.analysis.notes
        );
    }
}

/// A cycle that is not like the others is left out, and of the damping too: one that is four times as slow loses a quarter.
#[test]
fn a_slow_cycle_that_is_left_out_changes_nothing() {
    let made = |slow: f64| {
        let mut random = SplitMix64::new(1);
        let (mut e, mut f, mut phase) = (Vec::new(), Vec::new(), 0.7);
        while phase < 0.7 + 8.0 * TAU {
            let rate = if (4.0 * TAU..5.0 * TAU).contains(&phase) { slow } else { 1.0 };
            let (sin, cos) = f64::sin_cos(phase);
            let (x, v) = (13.75e-3 - 13.25e-3 * cos, 13.25e-3 * TAU * rate * sin);
            e.push(1e3 * x + 0.02 * random.normal());
            f.push(1e-3 * (TRUTH.force(x) + TRUTH.c0 * sums(x).1 * v) + 0.04 * random.normal());
            phase += TAU * 1e-3 * rate;
        }
        let made = recording("loop.csv", 1e-3, &[("cylinder", "mm", e), ("cell", "kN", f)]);
        let answer = solve(&format!("{TIRE}{LOOP}"), &files([("loop.csv".into(), made)])).unwrap();
        (answer.loops[0].element_damping.value, answer.loops[0].analysis.notes.join("; "))
    };
    let (even, odd) = (made(1.0), made(0.25));
    assert!(odd.1.contains("left out"), "{}", odd.1);
    assert!(off(odd.0, even.0).abs() < 0.02, "{odd:?} {even:?}");
}

/// One cycle at one load: nothing tells how far off it is.
#[test]
fn what_nothing_says_the_error_of_has_no_interval_of_zero() {
    let plan = format!("{TIRE}[characteristic]\nloads = [9000.0]\n{LOOP}between = [0.0, 2.6]\n");
    let answer =
        solve(&plan, &files([("loop.csv".into(), made_loop(TRUTH, [0.5e-3, 27e-3], 3.0, 1))])).unwrap();
    assert_eq!(answer.loops[0].analysis.cycles, 1);
    for c in [&answer.stiffness, &answer.damping] {
        assert!(c.value.half_width.is_infinite(), "{:?}", c.value);
    }
    let text = parameters(&Plan::read(&plan).unwrap(), &answer).unwrap();
    assert!(!text.contains("inf") && !text.contains("low ="), "{text}");
}

// ---- what recordings cannot tell

#[test]
fn what_recordings_cannot_tell_is_refused_with_file_and_reason() {
    let whole = || made_loop(TRUTH, [0.5e-3, 27e-3], 5.0, 1);
    let decays = |load: f64, speed: f64, period: f64| {
        (format!("{load} {speed}"), made_decays(TRUTH, load, speed, load / 9.81, period, 3))
    };
    let says = |plan: &str, all: &BTreeMap<String, Recording>, words: &[&str]| {
        let message = solve(plan, all).unwrap_err().to_string();
        for word in words {
            assert!(message.contains(word), "{word:?} is not in: {message}");
        }
    };
    let with_loop = format!("{TIRE}{LOOP}");
    // half a loop
    let mut half = whole();
    let part = "between = [1.15, 1.65]\nskip_cycles = 0\n";
    says(
        &format!("{with_loop}{part}"),
        &files([("loop.csv".into(), half.clone())]),
        &["loop.csv", "no whole loop", "loading and unloading"],
    );
    // a clipped sensor
    half.channels[1].values.iter_mut().for_each(|f| *f = f.min(11.0));
    says(
        &with_loop,
        &files([("loop.csv".into(), half)]),
        &["loop.csv", "\"cell\"", "clipped", "wider range"],
    );
    // another unit, a channel that is not there
    says(
        &with_loop.replace("\"cell\"", "\"cylinder\""),
        &files([("loop.csv".into(), whole())]),
        &["\"cylinder\"", "\"mm\"", "\"N\""],
    );
    says(
        &with_loop.replace("\"cell\"", "\"load\""),
        &files([("loop.csv".into(), whole())]),
        &["no channel \"load\"", "cylinder, cell"],
    );
    // too small a range of loads for an exponent
    let narrow = files([("loop.csv".into(), made_loop(TRUTH, [10e-3, 12e-3], 9.0, 2))]);
    let power = format!("{TIRE}[characteristic]\nstiffness = \"power\"\n{LOOP}");
    says(&power, &narrow, &["no power law of the stiffness", "span a factor of", "wider range"]);
    let auto = solve(&with_loop, &narrow).unwrap();
    assert!(
        auto.stiffness.law == Law::Constant && auto.stiffness.why.contains("span a factor"),
        "{}",
        auto.stiffness.why
    );
    // loads that no loop has
    says(
        &format!("{TIRE}[characteristic]\nloads = [30000.0]\n{LOOP}"),
        &files([("loop.csv".into(), whole())]),
        &["30000 N", "nothing is extrapolated"],
    );
    // decays that overlap
    let plan = |more: &str, decays: &str| format!("{TIRE}{more}{LOOP}{decays}");
    let all = files([("loop.csv".into(), whole()), decays(9260.0, 2.0, 0.7)]);
    says(
        &plan("", &decay_of(9260.0, 2.0, "impact_period = 0.7")),
        &all,
        &["9260 2", "\"arm\"", "does not die out", "% of its amplitude is left"],
    );
    // one speed for a law over the speed
    let all = files([("loop.csv".into(), whole()), decays(9260.0, 2.0, 3.0), decays(14960.0, 2.0, 3.0)]);
    let both = decay_of(9260.0, 2.0, "") + &decay_of(14960.0, 2.0, "");
    says(
        &plan("[characteristic]\ndamping = \"power\"\n", &both),
        &all,
        &["no power law of the damping", "one speed", "Measure at two more"],
    );
    let auto = solve(&plan("", &both), &all).unwrap();
    assert!(
        auto.damping.speed_exponent.is_none() && auto.damping.why.contains("one speed"),
        "{}",
        auto.damping.why
    );
    assert!(auto.notes.iter().any(|n| n.contains("pivot_inertia")), "{:?}", auto.notes);
    // a wheel that stands beside others that roll, and loads that are not quite the same in a table
    let standing = |speed: f64| {
        (format!("9260 {speed}"), made_decays(TRUTH, 9260.0, speed.max(0.5), 9260.0 / 9.81, 3.0, 3))
    };
    let all = files([
        ("loop.csv".into(), whole()),
        standing(0.0),
        standing(1.0),
        standing(2.0),
        decays(9270.0, 1.5, 3.0),
    ]);
    let three = [0.0, 1.0, 2.0]
        .map(|v| decay_of(9260.0, v, "").replace("cleat_length = \"150 mm\"", "impact_period = 3"));
    let auto = solve(&plan("", &three.concat()), &all).unwrap();
    assert!(auto.damping.why.contains("stands") || auto.damping.law == Law::Table, "{}", auto.damping.why);
    // a period that is no more than a sample
    says(
        &plan("", &decay_of(9260.0, 2.0, "impact_period = \"3 ms\"")),
        &all,
        &["9260 2", "0.003 s apart", "right unit"],
    );
    // a table with holes
    let all = files([("loop.csv".into(), whole()), decays(9260.0, 2.0, 3.0), decays(14960.0, 1.0, 4.0)]);
    let both = decay_of(9260.0, 2.0, "") + &decay_of(14960.0, 1.0, "");
    says(
        &plan("[characteristic]\ndamping = \"table\"\n", &both),
        &all,
        &["no table of the damping", "each of the same speeds"],
    );
    // plans that say too little or too much, and one that says enough
    Plan::read(include_str!("../examples/plans/solid-tire.toml")).unwrap();
    for (plan, word) in [
        (TIRE.to_owned(), "[[loop]]"),
        (format!("{TIRE}{}", decay_of(9000.0, 2.0, "")), "element_stiffness"),
        (format!("{with_loop}mass_below_cell = 30"), "tared_with_wheel"),
        (
            format!("{with_loop}{}", decay_of(9000.0, 2.0, "mass = 900\nwheel_arm = 1.0")),
            "pivot_inertia and wheel_arm together",
        ),
        (format!("{with_loop}forse = 1"), "forse"),
        (with_loop.replace("rubber_mass = \"1 g\"", "mass = 30"), "rim_mass or rubber_mass"),
        (with_loop.replace("\"1 g\"", "20\nrim_mass = 6\nmass = 30"), "not mass = 30 kg together"),
        (with_loop.replace("\"1 g\"", "20\nrim_radius = -1"), "rim_radius"),
        (with_loop.replace("226.5 mm", "226.5 kg"), "radius"),
        (with_loop.replace("elements = 45", "elements = 3"), "4 to 2000"),
    ] {
        let message = Plan::read(&plan).unwrap_err().to_string();
        assert!(message.contains(word), "{word:?} is not in: {message}");
    }
}

// ---- the command

#[test]
fn the_command_writes_parameters_property_file_page_and_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    let write = |name: &str, recording: &Recording| write_csv(&place(name), recording).unwrap();
    write("loop.csv", &made_loop(TRUTH, [0.5e-3, 27e-3], 6.0, 1));
    write("decay.csv", &made_decays(TRUTH, 9260.0, 2.0, 9260.0 / 9.81, 3.0, 2));
    let decay = decay_of(9260.0, 2.0, "").replace("9260 2", "decay.csv");
    let exact = TIRE.replace("elements = 45", "elements = 45\nrim_force = \"exact\"");
    std::fs::write(place("plan.toml"), format!("{exact}{LOOP}{decay}")).unwrap();
    let run = |plan: &str| {
        std::process::Command::new(env!("CARGO_BIN_EXE_latsch"))
            .current_dir(folder.path())
            .args(["solid-tire", plan, "--output", "tire.toml", "--tir", "tire.tir"])
            .args(["--report", "tire.html", "--json", "tire.json"])
            .output()
            .unwrap()
    };
    let done = run("plan.toml");
    let told = String::from_utf8(done.stdout).unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    assert!(
        told.contains("element_radial_stiffness = 1") && told.contains("note: the mass of decays"),
        "{told}"
    );
    let text = |name: &str| std::fs::read_to_string(place(name)).unwrap();
    assert!(text("tire.toml").contains("stiffness_law = 2"));
    // the property file is read back to the same parameters, and what it has no place for is told
    let read = latsch::tir::settings(&place("tire.tir")).unwrap().settings;
    let written = Settings::parse(&text("tire.toml"), "tire.toml").unwrap();
    let mut same = 0;
    for value in &read.values {
        if let Some(own) = written.values.iter().find(|own| own.name == value.name) {
            let number = |v: &Value| v.to_string().parse::<f64>().ok();
            if let (Some(a), Some(b)) = (number(&value.value), number(&own.value)) {
                assert!((a - b).abs() <= 1e-12 * b.abs(), "{}: {a} {b}", value.name);
                same += 1;
            }
        }
    }
    assert!(same >= 6, "{same}");
    let lost = String::from_utf8(done.stderr).unwrap();
    for what in ["stiffness_law", "rim_force", "mass of the rim"] {
        assert!(lost.contains(what), "{what} is not in: {lost}");
    }
    assert!(text("tire.html").contains("Loop loop.csv") && text("tire.html").contains("<h3>decay.csv"));
    assert!(text("tire.json").contains("\"by_cosines\""));
    // an error has the plan's place
    std::fs::write(place("wrong.toml"), format!("{TIRE}{LOOP}").replace("\"cell\"", "\"sell\"")).unwrap();
    let failed = run("wrong.toml");
    let message = String::from_utf8(failed.stderr).unwrap();
    assert_eq!(failed.status.code(), Some(2), "{message}");
    assert!(message.contains("wrong.toml") && message.contains("no channel \"sell\""), "{message}");
}
