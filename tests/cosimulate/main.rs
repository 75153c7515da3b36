//! Co-simulation of small models against closed forms: the properties of section 5.6 of Mack (2009), order
//! of convergence, energy, files.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod files;
mod models;

use latsch::cosimulate::{BondKind, Experiment, SystemSlave, Turn, Until, cosimulate_until};
use latsch::effect::{Attached, Attachment, Chosen, Signal};
use latsch::model::Slave;
use models::{channel, run, run_with, wire};
use nalgebra::{Matrix4, Vector4};

const PAIR: &str = r#"
stop = 1
STEP
[component.left]
model = "side"
set = { mass = 2, stiffness = 300, damping = 1, coupling_stiffness = 80, coupling_damping = 0.5, x0 = 0.1, step_size = 1.25e-4 }
[component.right]
model = "side"
set = { mass = 1, stiffness = 100, damping = 0.5, step_size = 1.25e-4 }
[connect]
"left.reaction" = LEFT
"right.position" = POSITION
"right.velocity" = VELOCITY
"#;

fn pair(head: &str, derivative: bool) -> String {
    let to = |port: &str| format!("{{ to = \"{port}\", derivative = {derivative} }}");
    PAIR.replace("STEP", head)
        .replace("LEFT", &to("right.force"))
        .replace("POSITION", &to("left.other_position"))
        .replace("VELOCITY", &to("left.other_velocity"))
}

/// The positions of the pair at 1 s as one system, by the matrix exponential.
fn exact() -> (f64, f64) {
    #[rustfmt::skip]
    let a = Matrix4::new(
        0.0, 1.0, 0.0, 0.0,
        -(300.0 + 80.0) / 2.0, -(1.0 + 0.5) / 2.0, 80.0 / 2.0, 0.5 / 2.0,
        0.0, 0.0, 0.0, 1.0,
        80.0, 0.5, -(100.0 + 80.0), -(0.5 + 0.5),
    );
    let y = a.exp() * Vector4::new(0.1, 0.0, 0.0, 0.0);
    (y[0], y[2])
}

fn error_at(head: &str, derivative: bool, step: f64) -> f64 {
    let (_, outcome) = run(&pair(&format!("step = {step}\n{head}"), derivative));
    let last = |name| *channel(&outcome, name).last().unwrap();
    let (left, right) = exact();
    (last("left.position") - left).hypot(last("right.position") - right)
}

#[test]
fn ends_where_a_condition_is_met() {
    let text = pair("step = 1e-3", false);
    let (_, whole) = run(&text);
    let position = channel(&whole, "left.position");
    let first = position.iter().position(|x| *x < 0.02).unwrap();
    assert!(first > 10 && first % 7 != 0 && !whole.met);
    let until = |value: f64, above: bool, every: usize| {
        let (plan, mut system) = wire(&text).unwrap();
        let experiment =
            Experiment { record_every: every, ..plan.experiment(&system, None, None, None).unwrap() };
        let port = system.port("left", "position").unwrap();
        let until = Until { port, above, value };
        cosimulate_until(&mut system, &experiment, Some(until), |_| ()).unwrap()
    };
    let ended = until(0.02, false, 1);
    assert!(ended.met && ended.stopped.is_none());
    assert_eq!(ended.recording.time, whole.recording.time[..=first]);
    assert_eq!(channel(&ended, "left.position"), position[..=first]);
    // between two samples, the end is a sample all the same
    let coarse = until(0.02, false, 7);
    assert_eq!(coarse.recording.time.last(), Some(&whole.recording.time[first]));
    assert_eq!(coarse.recording.time.len(), first / 7 + 2);
    // what holds at the start does not count there, but one step later
    assert_eq!(until(0.02, true, 1).recording.time.len(), 2);
    let never = until(1.0, true, 1);
    assert!(!never.met);
    assert_eq!(never.recording.time, whole.recording.time);
}

#[test]
fn converges_with_the_order_of_the_exchange() {
    for (head, derivative, order) in [
        ("", false, 1.0),
        ("order = ['left', 'right']", false, 1.0),
        ("", true, 2.0),
        ("order = ['left', 'right']", true, 2.0),
        ("iterate = 20", false, 2.0),
        ("iterate = 20\norder = ['right', 'left']", false, 2.0),
    ] {
        let errors = [2e-3, 1e-3, 5e-4].map(|step| error_at(head, derivative, step));
        let orders = [(errors[0] / errors[1]).log2(), (errors[1] / errors[2]).log2()];
        for found in orders {
            assert!((found - order).abs() < 0.15, "{head:?}, derivative {derivative}: {errors:?} {orders:?}");
        }
    }
}

/// A mass of 1 kg on a spring that is another component, released at 0.1 m.
fn on_a_spring(head: &str, stiffness: f64) -> String {
    format!(
        r#"{head}
[component.spring]
model = "spring"
set = {{ stiffness = {stiffness}, step_size = 1e-4 }}
[component.mass]
model = "side"
set = {{ x0 = 0.1, step_size = 1e-4 }}
[connect]
"spring.force" = "mass.force"
"mass.position" = "spring.position"
"#
    )
}

#[test]
fn a_held_spring_force_is_a_negative_damper() {
    // P5: T w = 0.02; with the spring first, its force is late by T/2 in the mean: d = -k T/2. Side by side
    // it is late by one interval more: d = -3 k T/2. The energy grows with -d/m.
    let (k, t, stop): (f64, f64, f64) = (400.0, 1e-3, 4.0);
    for (head, intervals) in [("order = ['spring', 'mass']", 0.5), ("", 1.5)] {
        let (system, outcome) = run(&on_a_spring(&format!("stop = {stop}\nstep = {t}\n{head}"), k));
        let expected = -k * t * intervals;
        let energy = |i: usize| {
            let (x, v) = (channel(&outcome, "mass.position")[i], channel(&outcome, "mass.velocity")[i]);
            0.5 * k * x * x + 0.5 * v * v
        };
        // over whole periods, so that the phase does not matter
        let period = std::f64::consts::TAU / k.sqrt();
        let (first, last) = (0, ((12.0 * period) / t).round() as usize);
        let found = -(energy(last) / energy(first)).ln() / (last as f64 * t);
        assert!((found / expected - 1.0).abs() < 0.01, "{head}: {found} instead of {expected} N.s/m");
        // the bond found by its units says the same without knowing the spring
        let [bond] = system.bonds() else { panic!("{:?}", system.bonds()) };
        assert_eq!(bond.name, ("spring.force".to_string(), "mass.position".to_string()));
        let found = bond.equivalent_damping();
        assert!((found / expected - 1.0).abs() < 0.01, "{head}: {found} instead of {expected} N.s/m");
        let made = energy(outcome.recording.time.len() - 1) - energy(0);
        assert!((bond.generated / made - 1.0).abs() < 0.02, "{} J of {made} J", bond.generated);
    }
}

#[test]
fn the_controller_leads_by_one_interval() {
    // P1: Mack (2009), section 5.6: the first in the order runs ahead of the plant by exactly one interval
    let t = 1e-3;
    let (_, outcome) = run(&on_a_spring("stop = 0.003\nstep = 1e-3\norder = ['spring', 'mass']", 400.0));
    let expected: Vec<Turn> = (0..3)
        .flat_map(|k| {
            let (from, to) = (f64::from(k) * t, f64::from(k) * t + t);
            [0, 1].map(|component| Turn { component, from, to })
        })
        .collect();
    assert_eq!(outcome.log.len(), 6);
    for (turn, expected) in outcome.log.iter().zip(expected) {
        assert_eq!(turn.component, expected.component);
        assert!((turn.from - expected.from).abs() < 1e-15 && (turn.to - expected.to).abs() < 1e-15);
    }
    // the plant got u(t_k+1) = -k x(t_k) in the interval that began at t_k
    let (force, x) = (channel(&outcome, "mass.force"), channel(&outcome, "mass.position"));
    assert_eq!(force[1..], [0, 1, 2].map(|k| -400.0 * x[k]));
    // side by side it got y(t_k), which is one interval older
    let (_, outcome) = run(&on_a_spring("stop = 0.003\nstep = 1e-3", 400.0));
    let (force, x) = (channel(&outcome, "mass.force"), channel(&outcome, "mass.position"));
    assert_eq!(force[1..], [-400.0 * x[0], -400.0 * x[0], -400.0 * x[1]]);
}

#[test]
fn inputs_are_held_unless_asked_otherwise() {
    // P2
    for (derivative, held) in [(false, true), (true, false)] {
        let (_, outcome) = run(&pair("step = 1e-3", derivative));
        let change = *channel(&outcome, "right.largest_force_change").last().unwrap();
        assert_eq!(change == 0.0, held, "{change}");
    }
}

#[test]
fn the_interval_is_a_whole_multiple_of_the_components_steps() {
    // P3
    for (own, accepted) in [
        (1e-4, true),
        (5e-5, true),
        (2.5e-5, true),
        (3e-5, false),
        (2e-4, false),
        (1e-4 * (1.0 + 1e-8), false),
    ] {
        let text = on_a_spring("stop = 0.01\nstep = 1e-4", 400.0).replacen(
            "step_size = 1e-4",
            &format!("step_size = {own:e}"),
            1,
        );
        let (plan, mut system) = wire(&text).unwrap();
        let experiment = plan.experiment(&system, None, None, None).unwrap();
        match latsch::cosimulate::cosimulate(&mut system, &experiment, |_| ()) {
            Ok(_) => assert!(accepted, "{own}"),
            Err(e) => {
                assert!(!accepted, "{own}: {e}");
                let e = e.to_string();
                assert!(
                    e.contains("spring.step_size") && e.contains("multiple") && e.contains("take"),
                    "{e}"
                );
            }
        }
    }
}

#[test]
fn samples_do_not_drift() {
    // P4
    let (_, outcome) = run(&on_a_spring("stop = 2\nstep = 1e-4\nrecord_every = 10", 400.0));
    let time = &outcome.recording.time;
    assert_eq!(time.len(), 2001);
    assert!(time.iter().enumerate().all(|(n, t)| *t == n as f64 * 1e-3));
    // the samples are those of the run that records everything
    let (_, every) = run(&on_a_spring("stop = 2\nstep = 1e-4", 400.0));
    let (few, all) = (channel(&outcome, "mass.position"), channel(&every, "mass.position"));
    assert!(few.iter().enumerate().all(|(n, x)| *x == all[10 * n]));
}

#[test]
fn the_same_run_twice_and_intervals_cut_differently_have_the_same_bits() {
    // P8, and P7: with constant inputs it does not matter how the time is cut
    let text = pair("step = 1e-3", false);
    assert_eq!(run(&text).1.recording, run(&text).1.recording);
    let alone = r#"
stop = 1
[component.mass]
model = "side"
set = { stiffness = 50, x0 = 0.1, force = 3 }
"#;
    let [fine, coarse] = [1e-3, 2e-3].map(|step| {
        let (plan, mut system) = wire(alone).unwrap();
        let experiment = plan.experiment(&system, None, None, Some(step)).unwrap();
        channel(&latsch::cosimulate::cosimulate(&mut system, &experiment, |_| ()).unwrap(), "mass.position")
    });
    assert!(coarse.iter().enumerate().all(|(n, x)| *x == fine[2 * n]));
}

#[test]
fn a_loop_that_is_opened_and_replayed_has_the_same_bits() {
    for head in ["", "order = ['left', 'right']", "order = ['right', 'left']"] {
        let text = pair(&format!("step = 1e-3\n{head}"), false);
        let (_, closed) = run(&text);
        for component in ["left", "right"] {
            let (system, open) = run_with(&text, |system, experiment: Experiment| {
                let index = system.component(component).unwrap();
                let names = system.open(index, &closed.recording).unwrap();
                assert_eq!(names.len(), if component == "left" { 2 } else { 1 });
                experiment
            });
            assert!(system.bonds().is_empty(), "a cut loop exchanges no energy");
            for channel in &open.recording.channels {
                assert_eq!(
                    channel.values,
                    closed.recording.channel(&channel.name).unwrap().values,
                    "{}",
                    channel.name
                );
            }
        }
    }
}

#[test]
fn a_replayed_recording_that_is_coarser_than_the_interval_is_warned_of() {
    let closed = |every: usize| {
        run(&pair(&format!("step = 1e-3\norder = ['left', 'right']\nrecord_every = {every}"), false)).1
    };
    for (every, coarse) in [(1, false), (5, true)] {
        let recording = closed(every).recording;
        let (system, _) = run_with(&pair("step = 1e-3\norder = ['left', 'right']", false), |system, run| {
            system.open(0, &recording).unwrap();
            run
        });
        assert_eq!(system.warnings().len(), usize::from(coarse), "{:?}", system.warnings());
        for warning in system.warnings() {
            for word in ["5.000e-3 s apart", "0.001 s", "left.other_position, left.other_velocity"] {
                assert!(warning.contains(word), "{word}: {warning}");
            }
        }
    }
}

#[test]
fn an_interval_that_is_refused_is_halved() {
    let text = |halvings: u32| {
        pair(&format!("step = 8e-3\nhalvings = {halvings}"), false)
            .replace("damping = 0.5, step", "moves_at_most = 1e-3, damping = 0.5, step")
    };
    let (plan, mut system) = wire(&text(0)).unwrap();
    let experiment = plan.experiment(&system, None, None, None).unwrap();
    let outcome = latsch::cosimulate::cosimulate(&mut system, &experiment, |_| ()).unwrap();
    let message = outcome.stopped.unwrap().to_string();
    assert!(message.contains("right") && message.contains("on a held force"), "{message}");
    let (system, outcome) = run(&text(4));
    assert!(
        outcome.halved > 10 && system.warnings().is_empty(),
        "{} {:?}",
        outcome.halved,
        system.warnings()
    );
    // the samples stay where they were, and the result is that of a shorter interval
    assert_eq!(outcome.recording.time.len(), 126);
    let (left, right) = exact();
    let error = (channel(&outcome, "left.position").last().unwrap() - left)
        .hypot(channel(&outcome, "right.position").last().unwrap() - right);
    assert!(error < 0.5 * error_at("", false, 8e-3), "{error}");
}

#[test]
fn what_is_extrapolated_stays_within_the_range_of_the_input() {
    // the spring takes -1e6 m to 1e6 m; the mass swings just so far, and before it turns its slope points beyond
    let text = r#"
stop = 1
step = 1e-2
[component.mass]
model = "side"
set = { stiffness = 400, x0 = 0.1 }
[component.spring]
model = "spring"
[connect]
"mass.position" = { to = "spring.position", factor = 1e7, derivative = true }
"#;
    let (_, outcome) = run(text);
    let position = channel(&outcome, "spring.position");
    let ends = position.iter().fold((0.0_f64, 0.0_f64), |(a, b), x| (a.min(*x), b.max(*x)));
    assert_eq!(ends, (-1e6, 1e6));
    // away from the ends it is the line that it was
    let x = channel(&outcome, "mass.position");
    assert!((position[6] - 1e7 * (2.0 * x[5] - x[4])).abs() < 1e-6);
}

#[test]
fn a_shorter_last_interval_is_recorded_at_its_own_time() {
    for every in [1, 2, 3, 5, 7, 100] {
        let head = format!("stop = 9.5e-3\nstep = 1e-3\nrecord_every = {every}");
        let (_, outcome) = run(&on_a_spring(&head, 400.0));
        assert_eq!(outcome.recording.time.last(), Some(&9.5e-3), "every {every}");
        assert_eq!(outcome.recording.time.len(), 10_usize.div_ceil(every) + 1);
        assert_eq!(channel(&outcome, "mass.position").len(), outcome.recording.time.len());
    }
}

#[test]
fn halving_ends_where_a_component_refuses_every_interval() {
    let text = pair(&format!("step = 8e-3\nhalvings = {}", u32::MAX), false)
        .replace("damping = 0.5, step", "moves_at_most = -1.0, damping = 0.5, step");
    let (plan, mut system) = wire(&text).unwrap();
    let experiment = plan.experiment(&system, None, None, None).unwrap();
    let outcome = latsch::cosimulate::cosimulate(&mut system, &experiment, |_| ()).unwrap();
    assert!(outcome.stopped.unwrap().to_string().contains("right"));
    assert!(outcome.halved <= 31, "{}", outcome.halved);
}

#[test]
fn an_interval_is_cut_into_so_many_parts_and_no_more() {
    // the faster it gets, the shorter the intervals that it takes: down to 3e-7 s
    let text = pair("step = 8e-3\nhalvings = 30", false).replace(
        "damping = 0.5, step_size = 1.25e-4",
        "moves_at_most = 1e-7, damping = 0.5, step_size = 1e-7",
    );
    let (plan, mut system) = wire(&text).unwrap();
    let experiment = plan.experiment(&system, None, None, None).unwrap();
    let outcome = latsch::cosimulate::cosimulate(&mut system, &experiment, |_| ()).unwrap();
    let message = outcome.stopped.unwrap().to_string();
    assert!(message.contains("right") && message.contains("4096 parts"), "{message}");
    assert!(outcome.halved >= 4095, "{}", outcome.halved);
}

#[test]
fn a_reset_does_not_lose_the_warning_that_intervals_are_not_halved() {
    let (_, mut system) = wire(&pair("step = 1e-3\nhalvings = 3", false)).unwrap();
    system.component_mut(1).even_steps_only = true;
    let mut slave = SystemSlave::new("pair", system, 1e-3).unwrap();
    for _ in 0..2 {
        slave.start(0.0, None).unwrap();
        slave.finish_start().unwrap();
        let warning = slave.warning().unwrap_or_default();
        assert!(warning.contains("right cannot vary its step"), "{warning:?}");
        slave.reset().unwrap();
    }
}

#[test]
fn a_coupling_that_makes_energy_is_warned_of() {
    let warnings = |step: f64| {
        let (system, _) =
            run(&on_a_spring(&format!("stop = 2\nstep = {step}\norder = ['spring', 'mass']"), 400.0));
        latsch::cosimulate::energy_warnings(&system, step)
    };
    let [warning] = &warnings(5e-3)[..] else { panic!("{:?}", warnings(5e-3)) };
    for word in ["spring.force", "mass.position", "made", "damper of -", "N.s/m"] {
        assert!(warning.contains(word), "{word}: {warning}");
    }
    // the interval that it names is enough
    let named = warning.split("step of ").nth(1).unwrap().split(" s ").next().unwrap();
    assert_eq!(named, "5e-4", "{warning}");
    assert_eq!(warnings(named.parse().unwrap()), Vec::<String>::new(), "{warning}");
}

#[test]
fn a_bond_of_force_and_velocity_finds_the_energy_that_appears() {
    // in other units on one side: 400 N/m, 100 mm
    for head in ["", "order = ['strut', 'mass']", "order = ['mass', 'strut']"] {
        let (system, outcome) = run(&format!(
            r#"
stop = 2
step = 1e-3
{head}
[component.strut]
model = "strut"
set = {{ stiffness = 0.4, start = 100 }}
[component.mass]
model = "side"
[connect]
"strut.force" = "mass.force"
"mass.velocity" = "strut.velocity"
"#
        ));
        let energy = |i: usize| {
            let (s, v) =
                (1e-3 * channel(&outcome, "strut.stretch")[i], channel(&outcome, "mass.velocity")[i]);
            0.5 * 400.0 * s * s + 0.5 * v * v
        };
        let made = energy(2000) - energy(0);
        let [bond] = system.bonds() else { panic!("{:?}", system.bonds()) };
        assert_eq!(bond.kind, BondKind::Flow);
        assert!(made.abs() > 0.005 * energy(0), "{head}: {made}");
        assert!((bond.generated / made - 1.0).abs() < 0.01, "{head}: {} J of {made} J", bond.generated);
        let column = channel(&outcome, "generated energy strut.force mass.velocity");
        assert_eq!(column[2000], bond.generated);
    }
}

#[test]
fn components_that_depend_on_each_other_settle_or_it_is_said() {
    let loop_of = |stiffness: f64, sign: f64| {
        let text = format!(
            r#"
stop = 0.01
step = 1e-3
[component.a]
model = "spring"
set = {{ stiffness = {stiffness} }}
[component.b]
model = "spring"
set = {{ stiffness = 1 }}
[connect]
"a.force" = {{ to = "b.position", factor = 1, offset = 1 }}
"b.force" = {{ to = "a.position", factor = {sign} }}
"#
        );
        run(&text)
    };
    // f_a = -s p_a, p_a = f_b = -(f_a + 1): f_a = s (f_a + 1), so f_a = s / (1 - s)
    let (system, outcome) = loop_of(0.5, 1.0);
    assert!(system.warnings().is_empty(), "{:?}", system.warnings());
    assert!((channel(&outcome, "a.force")[0] - 1.0).abs() < 1e-11);
    // f_a = -(f_a + 1): from 0 to -1 and back for ever
    let (system, _) = loop_of(1.0, -1.0);
    let [warning] = system.warnings() else { panic!("{:?}", system.warnings()) };
    assert!(
        warning.contains("a.force") && warning.contains("b.force") && warning.contains("algebraic"),
        "{warning}"
    );
}

#[test]
fn a_system_is_a_slave() {
    let text = pair("step = 1e-3\norder = ['left', 'right']", false);
    let (_, expected) = run(&text);
    let (_, system) = wire(&text).unwrap();
    let mut slave = SystemSlave::new("pair", system, 1e-3).unwrap();
    for name in ["right.force", "left.other_position"] {
        let variable = slave.find(name).unwrap();
        assert!(slave.set(variable, 1.0).unwrap_err().to_string().contains(name));
    }
    // twice, to see the reset; sampled more coarsely than it communicates
    let experiment = latsch::simulate::Experiment { step: Some(5e-3), ..Default::default() };
    for _ in 0..2 {
        let outcome = latsch::simulate::simulate(&mut slave, &experiment, |_, _| ()).unwrap();
        assert_eq!(outcome.stopped, None);
        let found = &outcome.recording.channel("left.position").unwrap().values;
        let all = channel(&expected, "left.position");
        assert!(found.len() == 201 && found.iter().enumerate().all(|(n, x)| *x == all[5 * n]));
        slave.reset().unwrap();
    }
    // P8: back to a saved state, and the same again
    slave.start(0.0, None).unwrap();
    slave.finish_start().unwrap();
    slave.step(0.0, 0.1).unwrap();
    let saved = slave.save().unwrap();
    let x = slave.find("right.position").unwrap();
    let mut once = || {
        slave.restore(&saved).unwrap();
        slave.step(0.1, 0.2).unwrap();
        slave.get(x).unwrap()
    };
    let (first, second) = (once(), once());
    assert_eq!(first, second);
    assert_eq!(first, channel(&expected, "right.position")[300]);
    assert!(slave.step(0.3, 0.0015).unwrap_err().to_string().contains("multiples"));
}

/// Friction along the way of a force.
fn friction(target: usize, driver: usize) -> Vec<Attachment> {
    let effect = latsch::effect::find("guide-friction").unwrap();
    let chosen = |value| Chosen { value, range: (-1e9, 1e9), unit: None };
    let drivers = vec![Signal::value(driver)];
    vec![Attachment { effect, target, drivers, parameters: vec![chosen(2.0), chosen(0.1)] }]
}

#[test]
fn an_effect_on_an_output_of_a_system_acts_on_what_is_connected_to_it() {
    let text = pair("step = 1e-3", false);
    let (plan, system) = wire(&text).unwrap();
    let slave = SystemSlave::new("pair", system, 1e-3).unwrap();
    let find = |slave: &SystemSlave, name: &str| slave.find(name).unwrap();
    let (reaction, velocity) = (find(&slave, "left.reaction"), find(&slave, "left.velocity"));
    let x = find(&slave, "right.position");
    assert!(slave.is_passed_on(reaction) && !slave.is_passed_on(find(&slave, "right.reaction")));
    let mut outside = Attached::new(Box::new(slave), friction(reaction, velocity)).unwrap();
    // the part itself has the effect
    let inside = plan
        .wire(|system, component| {
            let part = models::slave("side")?;
            if component.name != "left" {
                return system.add(&component.name, part);
            }
            let effects = friction(part.find("reaction")?, part.find("velocity")?);
            system.add(&component.name, Box::new(Attached::new(part, effects)?))
        })
        .unwrap();
    let mut inside = SystemSlave::new("pair", inside, 1e-3).unwrap();
    let mut without = SystemSlave::new("pair", wire(&text).unwrap().1, 1e-3).unwrap();
    let course = |slave: &mut dyn Slave, x: usize| -> Vec<f64> {
        slave.start(0.0, None).unwrap();
        slave.finish_start().unwrap();
        (0..1000u32)
            .map(|k| {
                slave.step(f64::from(k) * 1e-3, f64::from(k + 1) * 1e-3 - f64::from(k) * 1e-3).unwrap();
                slave.get(x).unwrap()
            })
            .collect()
    };
    let from_outside = course(&mut outside, x);
    let x_inside = inside.find("right.position").unwrap();
    let from_inside = course(&mut inside, x_inside);
    let far = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(far(&from_outside, &from_inside) < 1e-12, "{}", far(&from_outside, &from_inside));
    assert!(far(&from_outside, &course(&mut without, x)) > 1e-3);
    // twice the same after a reset: nothing stays on the wires
    outside.reset().unwrap();
    assert_eq!(course(&mut outside, x), from_outside);
}
