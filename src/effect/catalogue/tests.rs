//! What every effect of the catalogue has to keep.

use super::EFFECTS;
use crate::effect::{Call, Effect, Family, MAX_DRIVERS, Memory, Parameter, Port, Role, find, forms};
use proptest::prelude::*;

/// A communication point: time since the last one, changed number, drivers.
type Point<const N: usize = MAX_DRIVERS> = (f64, f64, [f64; N]);

/// What comes out of an effect that gets these points, the first of them as the start.
pub(super) fn run<const N: usize>(effect: &Effect, p: &[f64], points: &[Point<N>]) -> Vec<f64> {
    let (mut memory, mut time) = (Memory::default(), 0.0);
    let mut out = Vec::with_capacity(points.len());
    for (i, (dt, target, drivers)) in points.iter().enumerate() {
        let dt = if i == 0 { 0.0 } else { *dt };
        time += dt;
        let call =
            Call { time, dt, target: *target, drivers: &drivers[..effect.drivers.len()], course: None };
        out.push((effect.apply)(p, &mut memory, &call));
    }
    out
}

/// Smooth courses with irregular steps, different for each driver, with changes of sign.
fn smooth(effect: &Effect, n: usize) -> Vec<Point> {
    let mut time = 0.0;
    (0..n)
        .map(|i| {
            let dt = 0.004 + 0.003 * ((i * i) as f64).sin();
            time += dt;
            let t: f64 = time;
            let mut drivers = [(3.1, 0.0), (4.3, 2.0), (2.2, 1.0), (5.3, 0.5), (1.7, 2.5)]
                .map(|(w, phase): (f64, f64)| 0.8 * (w * t + phase).sin());
            for (driver, role) in drivers.iter_mut().zip(effect.drivers) {
                match role {
                    Role::WheelAngle | Role::TravelDistance => *driver = 9.0 * t,
                    Role::TravelSpeed | Role::WheelSpeed => *driver += 3.0,
                    _ => {}
                }
            }
            (dt, (2.7 * t + 0.3).sin() + 0.4 * (11.0 * t).sin(), drivers)
        })
        .collect()
}

fn off(effect: &Effect) -> Vec<f64> {
    effect.parameters.iter().map(|p| p.off.unwrap_or(p.probes[0])).collect()
}

/// Off but for one amplitude, with each combination of the shapes' probes.
fn settings(effect: &Effect, amplitude: usize, value: f64) -> Vec<Vec<f64>> {
    let mut all = vec![Vec::new()];
    for (i, parameter) in effect.parameters.iter().enumerate() {
        let values = match parameter.off {
            Some(_) if i == amplitude => vec![value],
            Some(off) => vec![off],
            None => parameter.probes.to_vec(),
        };
        all = all
            .iter()
            .flat_map(|head| values.iter().map(move |v| [head.as_slice(), &[*v]].concat()))
            .collect();
    }
    all
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

fn amplitudes(effect: &Effect) -> impl Iterator<Item = (usize, &Parameter)> {
    effect.parameters.iter().enumerate().filter(|(_, p)| p.off.is_some())
}

#[test]
fn the_tables_are_whole() {
    assert!(EFFECTS.len() >= 40);
    assert!(EFFECTS.is_sorted_by_key(|e| e.family), "by family");
    for effect in EFFECTS {
        let id = effect.id;
        // what a file says of a form
        let told = |e: &Effect| {
            let mut names: Vec<&str> = e.parameters.iter().map(|p| p.name).collect();
            names.sort_unstable();
            (e.drivers.len(), names)
        };
        let same = forms(id).filter(|e| told(e) == told(effect));
        assert_eq!(same.count(), 1, "{id} is there once with so many drivers and these parameters");
        assert!(EFFECTS.iter().all(|e| (e.name == effect.name) == (e.id == id)), "{id}: its name is its own");
        assert!(id.chars().all(|c| c.is_ascii_lowercase() || c == '-'), "{id}");
        for text in [effect.name, effect.equation, effect.source, effect.signature] {
            assert!(text.len() > 3, "{id} says too little");
        }
        assert!(!effect.confused_with.is_empty(), "{id} is taken for nothing");
        for (other, how) in effect.confused_with {
            assert!(find(other).is_some() && *other != id, "{id} is confused with {other}");
            assert!(how.len() > 3, "{id}, {other}");
        }
        assert!(effect.drivers.len() <= MAX_DRIVERS, "{id}");
        assert!(amplitudes(effect).next().is_some(), "{id} cannot be switched off");
        assert!(effect.parameters.iter().filter(|p| p.off.is_none()).count() <= 3, "{id}: many shapes");
        if effect.port == Port::Force {
            assert_eq!(effect.targets, [Role::Force], "{id}");
        }
        for p in effect.parameters {
            let at = format!("{id}.{}", p.name);
            assert!(p.name.chars().all(|c| c.is_ascii_lowercase() || c == '_'), "{at}");
            assert_eq!(effect.parameters.iter().filter(|q| q.name == p.name).count(), 1, "{at}");
            assert!(p.plausible.0 < p.plausible.1 && p.search.0 < p.search.1, "{at}");
            assert!(p.plausible.0 < p.search.1 && p.search.0 < p.plausible.1, "{at}");
            // many only where nothing has to be simulated for them, else as many as screening tries
            let most = if effect.port == Port::Output { 240 } else { 6 };
            assert!((1..=most).contains(&p.probes.len()), "{at}");
            for probe in p.probes {
                assert!((p.search.0..=p.search.1).contains(probe), "{at}: {probe} is not searched");
                // a session may begin each of its runs cold
                let may_be_at_an_end = p.off.is_some() || p.of_session;
                assert!(
                    p.plausible.0 < *probe && *probe < p.plausible.1 || may_be_at_an_end,
                    "{at}: {probe}"
                );
            }
            if let Some(off) = p.off {
                assert!((p.search.0..=p.search.1).contains(&off) && !p.probes.contains(&off), "{at}");
            } else {
                assert!(p.search.0 >= 0.0 || p.name == "static_load", "{at}: a shape has no sign");
            }
            for (i, power) in p.scale.drivers.iter().enumerate() {
                assert!(*power == 0 || i < effect.drivers.len(), "{at}: the scale has a driver too many");
            }
        }
    }
    for family in
        [Family::Tire, Family::Brake, Family::Suspension, Family::Rig, Family::Sensor, Family::Mechanism]
    {
        assert!(EFFECTS.iter().filter(|e| e.family == family).count() >= 6, "{family:?}");
    }
}

/// Any amplitude makes a difference somewhere, in proportion to itself while it is small: a fit that
/// starts at the off value sees a slope.
#[test]
fn small_amplitudes_act_in_proportion() {
    for effect in EFFECTS {
        let points = smooth(effect, 900);
        let none = run(effect, &off(effect), &points);
        for (i, parameter) in amplitudes(effect) {
            let h = 1e-7;
            let mut acts = false;
            for (small, double) in settings(effect, i, h).iter().zip(settings(effect, i, 2.0 * h)) {
                let (once, twice) = (run(effect, small, &points), run(effect, &double, &points));
                let (first, second) = (distance(&once, &none), distance(&twice, &none));
                let expected: Vec<f64> = none.iter().zip(&once).map(|(n, o)| 2.0 * o - n).collect();
                let at = format!("{}.{} {small:?}", effect.id, parameter.name);
                assert!(
                    distance(&twice, &expected) <= 0.02 * second + 1e-11,
                    "{at}: {first} and {second} are not in proportion"
                );
                assert!(first < 1e3 * h * 30.0, "{at}: {first} is a jump");
                acts |= first > 1e-3 * h;
                if parameter.search.0 < 0.0 {
                    let mut negative = small.clone();
                    negative[i] = -h;
                    let other = run(effect, &negative, &points);
                    let expected: Vec<f64> = none.iter().zip(&once).map(|(n, o)| 2.0 * n - o).collect();
                    assert!(distance(&other, &expected) <= 0.02 * first + 1e-11, "{at}: a kink at off");
                }
            }
            assert!(acts, "{}.{} does nothing", effect.id, parameter.name);
        }
    }
}

/// A parameter stands still by itself: an effect that sits at one has to make something of its drivers or of time.
#[test]
fn what_sits_at_a_parameter_moves_it() {
    let sits =
        |e: &&Effect| e.port == Port::Parameter || e.also.iter().any(|(port, _)| *port == Port::Parameter);
    for effect in EFFECTS.iter().filter(sits) {
        let mut points = smooth(effect, 300);
        points.iter_mut().for_each(|point| point.1 = 0.8);
        let (amplitude, parameter) = amplitudes(effect).next().unwrap();
        let acts = settings(effect, amplitude, 3.0 * parameter.probes[0])
            .iter()
            .any(|p| run(effect, p, &points).iter().any(|y| (y - 0.8).abs() > 1e-9));
        assert!(acts, "{} does nothing to a number that stands still", effect.id);
    }
}

/// The declared scales are the dimensions of the equations: in other units of the changed number and of
/// the drivers the same comes out.
#[test]
fn other_units_change_nothing() {
    for effect in EFFECTS {
        // units that a parameter's scale knows of; speed in m/s beside a plain length is none of them
        let own_unit = |i: usize| {
            let used = effect.parameters.iter().any(|p| p.scale.drivers[i] != 0);
            if used { [7.0, 0.03, 11.0_f64][i] } else { 1.0 }
        };
        let is_force = |i: usize| {
            let forces = [Role::LateralForce, Role::LongitudinalForce];
            effect.drivers.get(i).is_some_and(|role| forces.contains(role))
        };
        let unit = |i: usize| match (0..3).find(|j| is_force(*j)) {
            // forces have one unit
            Some(first) if is_force(i) => own_unit(first),
            _ if i < 3 => own_unit(i),
            _ => 1.0,
        };
        let target_unit = 250.0_f64;
        let points = smooth(effect, 600);
        let scaled: Vec<Point> = points
            .iter()
            .map(|(dt, y, d)| (*dt, target_unit * y, std::array::from_fn(|i| unit(i) * d[i])))
            .collect();
        for (amplitude, parameter) in amplitudes(effect) {
            for p in settings(effect, amplitude, 3.0 * parameter.probes[0]) {
                let q: Vec<f64> = effect
                    .parameters
                    .iter()
                    .zip(&p)
                    .map(|(parameter, value)| {
                        let drivers: f64 =
                            (0..3).map(|i| unit(i).powi(parameter.scale.drivers[i].into())).product();
                        value * drivers * target_unit.powi(parameter.scale.target.into())
                    })
                    .collect();
                let (a, b) = (run(effect, &p, &points), run(effect, &q, &scaled));
                for (a, b) in a.iter().zip(&b) {
                    let error = (b / target_unit - a).abs();
                    assert!(error < 1e-9, "{}.{}: {a} and {b}", effect.id, parameter.name);
                }
            }
        }
    }
}

/// Effects whose times are those of their matter, of the mains or of a distance that is rolled, whatever the machine.
const ABSOLUTE: &[&str] = &[
    "relaxation-length",
    "carcass-compliance",
    "belt-mode",
    "thermal-softening",
    "inflation-warm-up",
    "pad-fade",
    "pad-onset",
    "frictional-heating",
    "steering-compliance",
    "mains-hum",
];

/// Times, frequencies and rates are told in the machine's own time: on one that does the same at another speed the same
/// comes out.
#[test]
fn a_machine_that_is_faster_or_slower_changes_nothing() {
    for effect in EFFECTS.iter().filter(|e| !ABSOLUTE.contains(&e.id)) {
        for slower in [1e-3, 60.0] {
            let points = smooth(effect, 600);
            let slow: Vec<Point> = points.iter().map(|(dt, y, d)| (slower * dt, *y, *d)).collect();
            for (amplitude, parameter) in amplitudes(effect) {
                for p in settings(effect, amplitude, 3.0 * parameter.probes[0]) {
                    let own = |(parameter, value): (&Parameter, &f64)| {
                        value * slower.powi(parameter.scale.time.into())
                    };
                    let q: Vec<f64> = effect.parameters.iter().zip(&p).map(own).collect();
                    for (a, b) in run(effect, &p, &points).iter().zip(&run(effect, &q, &slow)) {
                        assert!((a - b).abs() < 1e-9, "{}.{}: {a} and {b}", effect.id, parameter.name);
                    }
                }
            }
        }
    }
}

/// Effects that go on changing while nothing moves.
const RESTLESS: &[&str] = &[
    "thermal-softening",
    "inflation-warm-up",
    "pad-fade",
    "frictional-heating",
    "sensor-drift",
    "mains-hum",
];

#[test]
fn what_rests_at_the_start_stays() {
    for effect in EFFECTS.iter().filter(|e| !RESTLESS.contains(&e.id)) {
        let points = vec![(0.01, 0.8, [0.6, 1.7, 0.9]); 300];
        for (amplitude, parameter) in amplitudes(effect) {
            for p in settings(effect, amplitude, 5.0 * parameter.probes[0]) {
                let out = run(effect, &p, &points);
                for y in &out {
                    assert!((y - out[0]).abs() < 1e-12, "{} {p:?}: {} becomes {y}", effect.id, out[0]);
                }
            }
        }
    }
}

/// Effects whose memory integrates what is not straight between two points, or switches there; `lift-off`
/// holds a load that answers to it.
const STEPWISE: &[&str] = &[
    "thermal-softening",
    "pad-fade",
    "carcass-compliance",
    "valve-rate-limit",
    "actuator-rate-limit",
    "backlash",
    "pad-onset",
    "lift-off",
    "inflation-warm-up",
    "amplitude-softening",
];

#[test]
fn a_step_and_its_parts_give_the_same() {
    for effect in EFFECTS.iter().filter(|e| !STEPWISE.contains(&e.id)) {
        let mut points = smooth(effect, 300);
        for point in &mut points {
            for (driver, role) in point.2.iter_mut().zip(effect.drivers) {
                match role {
                    // a lag in metres is straight in time at constant speed only, a modulus on one side of 0
                    Role::TravelSpeed => *driver = 4.0,
                    Role::Force | Role::FrictionPower => *driver += 2.0,
                    _ => {}
                }
            }
        }
        let mut fine = vec![points[0]];
        for pair in points.windows(2) {
            let ((_, y0, d0), (dt, y1, d1)) = (pair[0], pair[1]);
            let straight = |s: f64| std::array::from_fn(|i| d0[i] + s * (d1[i] - d0[i]));
            let between = |s: f64| (straight(s), y0 + s * (y1 - y0));
            for (s, part) in [(0.2, 0.2), (0.7, 0.5), (1.0, 0.3)] {
                let (d, y) = between(s);
                fine.push((part * dt, y, d));
            }
        }
        for (amplitude, parameter) in amplitudes(effect) {
            for p in settings(effect, amplitude, 3.0 * parameter.probes[0]) {
                let (coarse, fine) = (run(effect, &p, &points), run(effect, &p, &fine));
                for (i, y) in coarse.iter().enumerate() {
                    let error = (y - fine[3 * i]).abs();
                    assert!(error < 1e-9, "{} {p:?}: {y} and {} at {i}", effect.id, fine[3 * i]);
                }
            }
        }
    }
}

/// Any number that is finite, the awkward ones often.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -2.0..2.0,
        1 => Just(0.0),
        1 => Just(-0.0),
        1 => prop_oneof![Just(1e-300), Just(-1e-300), Just(5e-324), Just(1e100), Just(-1e100), Just(1e9)],
    ]
}

fn point() -> impl Strategy<Value = Point> {
    let dt = prop_oneof![4 => 1e-4..0.1, 1 => Just(1e-12), 1 => 1.0..1e4];
    (dt, number(), [number(), number(), number(), number(), number()])
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn off_is_off_to_the_last_bit(points in proptest::collection::vec(point(), 1..40)) {
        for effect in EFFECTS {
            for (amplitude, _) in amplitudes(effect) {
                for p in settings(effect, amplitude, 0.0) {
                    for (y, (_, target, _)) in run(effect, &p, &points).iter().zip(&points) {
                        prop_assert_eq!(y.to_bits(), target.to_bits(), "{}: {} becomes {}", effect.id, target, y);
                    }
                }
            }
        }
    }

    #[test]
    fn finite_in_finite_out(
        points in proptest::collection::vec(point(), 1..40),
        share in proptest::array::uniform5(prop_oneof![Just(0.0), Just(1.0), 0.0..1.0]),
    ) {
        for effect in EFFECTS {
            let p: Vec<f64> = effect
                .parameters
                .iter()
                .zip(share)
                .map(|(p, s)| p.search.0 + s * (p.search.1 - p.search.0))
                .collect();
            for y in run(effect, &p, &points) {
                prop_assert!(!y.is_nan(), "{} {:?} makes {}", effect.id, p, y);
                let small = points.iter().all(|(_, y, d)| y.abs() < 1e10 && d.iter().all(|d| d.abs() < 1e10));
                prop_assert!(!small || y.is_finite(), "{} {:?} makes {}", effect.id, p, y);
            }
        }
    }
}

#[test]
fn roles_stand_in_for_others() {
    for role in [Role::Force, Role::SlipAngle, Role::Other] {
        assert!(role.serves(Role::Other) && role.serves(role));
    }
    assert!(Role::SlipAngle.serves(Role::Slip) && !Role::Slip.serves(Role::SlipAngle));
    assert!(Role::WheelSpeed.serves(Role::Velocity) && !Role::Velocity.serves(Role::WheelSpeed));
    assert!(!Role::Other.serves(Role::Force));
}

/// A row of docs/effects.md.
fn row(effect: &Effect) -> String {
    let cell = |text: &str| text.replace('|', "\\|");
    let port = format!("{:?}", effect.port).to_lowercase();
    let drivers: Vec<String> = effect.drivers.iter().map(|r| words(&format!("{r:?}"))).collect();
    let confusions: Vec<String> =
        effect.confused_with.iter().map(|(id, how)| format!("`{id}`: {how}")).collect();
    let parameters: Vec<&str> = effect.parameters.iter().map(|p| p.name).collect();
    format!(
        "| `{}` | {} | {port} | {} | `{}` | {} | {} | {} | {} |",
        effect.id,
        effect.name,
        if drivers.is_empty() { "-".to_owned() } else { drivers.join(", ") },
        cell(effect.equation),
        parameters.join(", "),
        cell(effect.signature),
        cell(&confusions.join("; ")),
        cell(effect.source),
    )
}

/// `TravelSpeed` as `travel speed`.
fn words(name: &str) -> String {
    name.chars()
        .enumerate()
        .flat_map(|(i, c)| {
            let gap = (i > 0 && c.is_uppercase()).then_some(' ');
            gap.into_iter().chain(c.to_lowercase())
        })
        .collect()
}

/// The tables of docs/effects.md, by family.
fn tables() -> String {
    let mut text = String::new();
    let mut family = None;
    for effect in EFFECTS {
        if family != Some(effect.family) {
            family = Some(effect.family);
            text += &format!("\n## {:?}\n\n", effect.family);
            text += "| id | name | port | drivers | equation | parameters | signature | taken for: told apart by | source |\n";
            text += "|---|---|---|---|---|---|---|---|---|\n";
        }
        text += &row(effect);
        text.push('\n');
    }
    text
}

/// Set UPDATE_EFFECTS to write the tables anew.
#[test]
fn the_documentation_has_every_effect() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/effects.md");
    let text = std::fs::read_to_string(path).unwrap();
    let head = &text[..text.find("\n## ").unwrap_or(text.len())];
    if std::env::var_os("UPDATE_EFFECTS").is_some() {
        std::fs::write(path, head.to_owned() + &tables()).unwrap();
        return;
    }
    for effect in EFFECTS {
        assert!(
            text.contains(&row(effect)),
            "docs/effects.md lacks (UPDATE_EFFECTS=1 writes it) {}",
            row(effect)
        );
    }
    assert_eq!(text.lines().filter(|l| l.starts_with("| `")).count(), EFFECTS.len(), "rows without effect");
}
