//! A case: a machine, what is concealed in it, what it is driven with, and what is recorded.

use super::conceal::{Concealed, Law, Natural, Place};
use super::draw::{self, Drive};
use super::mechanism::Machine;
use super::offers::{Offer, offers};
use super::unit;
use super::view::View;
use super::world::{Course, Motion, Run, World};
use crate::answer::{Answer, Effect, Parameter, Reference, ReferenceRun};
use crate::catalogue::family;
use crate::files;
use crate::programme::Wave;
use crate::random::Random;
use crate::recording::{Recorded, file_name, sensed, stamped};
use crate::sensor::{Noise, Quantum, quantum};
use crate::simulate::Ideal;
use crate::sizing::{Refit, strongest};
use std::path::Path;

/// What a case is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// An effect of the catalogue that leaves 3 to 6 times the noise.
    Clear,
    /// One that leaves 1.4 to 2.5 times, as in recordings that engineers argue about.
    Plain,
    /// One that leaves 0.3 to 0.9 times.
    Faint,
    /// Two clear ones.
    Mix,
    /// Nothing.
    Null,
    /// Wrong parameters alone.
    Parameters,
    /// What has no name, clear.
    Outside,
    /// A fault of the recording; machines have none.
    Fault,
}

impl Kind {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Clear => "clear",
            Self::Plain => "plain",
            Self::Faint => "faint",
            Self::Mix => "mix",
            Self::Null => "null",
            Self::Parameters => "parameters",
            Self::Outside => "outside",
            Self::Fault => "fault",
        }
    }

    /// What an effect leaves after a refit, over the noise.
    pub(crate) fn target(self) -> (f64, f64) {
        match self {
            Self::Plain => (1.4, 2.5),
            Self::Faint => (0.3, 0.9),
            _ => (3.0, 6.0),
        }
    }
}

/// How many cases of each kind a study of 200 has.
const SHARES: [(Kind, usize); 7] = [
    (Kind::Clear, 60),
    (Kind::Plain, 40),
    (Kind::Faint, 20),
    (Kind::Mix, 10),
    (Kind::Null, 15),
    (Kind::Parameters, 25),
    (Kind::Outside, 30),
];

/// How many cases there are.
#[must_use]
pub fn count() -> usize {
    SHARES.iter().map(|(_, n)| n).sum()
}

fn kinds(seed: u64) -> Vec<Kind> {
    let mut all: Vec<Kind> = SHARES.iter().flat_map(|(kind, n)| vec![*kind; *n]).collect();
    Random::new(seed, 0).shuffle(&mut all);
    all
}

/// How often a machine is drawn anew in which nothing can be as large as it is wanted.
const ATTEMPTS: u64 = 60;

/// Draws case number `number` of the study with this seed, and records it with twice the samples or not.
///
/// # Errors
/// No such case, or one that cannot be drawn.
pub(crate) fn case(seed: u64, number: usize, doubled: bool) -> Result<(Machine, Recorded), String> {
    let kinds = kinds(seed);
    let kind = *kinds
        .get(number)
        .ok_or_else(|| format!("the study has {} cases; there is no number {}", kinds.len(), number + 1))?;
    (0..ATTEMPTS)
        .find_map(|attempt| {
            try_case(kind, number, doubled, Random::new(seed, 1 + attempt * 100_000 + number as u64))
        })
        .ok_or_else(|| format!("case {}: no {kind:?} in {ATTEMPTS} attempts", number + 1))
}

/// Writes the unit and the recordings of a case, as they are told in a view.
///
/// # Errors
/// No such case or one that cannot be drawn, no C compiler, or a folder that cannot be written.
pub fn write_case(seed: u64, number: usize, view: View, folder: &Path) -> Result<(), String> {
    let (machine, recorded) = case(seed, number, view == View::Doubled)?;
    for (name, content) in view.told(&machine, recorded.files) {
        files::write(&folder.join(name), &content)?;
    }
    let start: Vec<f64> = machine.parameters.iter().map(|p| p.start).collect();
    unit::write(&machine, "machine", &start, view, &folder.join("machine.fmu"))
}

/// The recordings of a case and its answer, without its machine.
///
/// # Errors
/// No such case, or one that cannot be drawn.
pub fn recorded(seed: u64, number: usize) -> Result<Recorded, String> {
    case(seed, number, false).map(|(_, recorded)| recorded)
}

/// Samples per natural time: about ten to twenty per period of the fastest excitation.
const RATE: (f64, f64) = (4.0, 9.0);
/// Frequencies of the excitation, per natural time.
const BAND: (f64, f64) = (0.02, 0.45);

fn draw_runs(random: &mut Random, machine: &Machine, drives: &[Drive]) -> Vec<Run> {
    let count = 3 + random.below(18);
    let interval = machine.time / random.within(RATE.0, RATE.1);
    let samples = (9000.0 / count as f64).clamp(400.0, 1200.0) * random.within(0.6, 1.0);
    let jitter = random.within(0.005, 0.05);
    (0_u64..)
        .take(count)
        .map(|number| {
            let duration = samples * interval;
            let mut time = vec![0.0];
            while time[time.len() - 1] < duration {
                let k = time.len() as f64;
                time.push(interval * (k + jitter * random.normal().clamp(-3.0, 3.0)));
            }
            let inputs = drives.iter().map(|drive| {
                let amplitude = drive.amplitude * random.log_within(0.2, 1.0);
                let idle = !drive.always && random.chance(0.4);
                let wave = if idle {
                    Wave::Rest
                } else {
                    stretched(Wave::draw(random, amplitude, BAND, duration / machine.time), random)
                };
                let room = drive.amplitude - amplitude;
                let middle =
                    drive.middle + if drive.middle > 0.0 { random.within(-0.5, 0.5) * room } else { 0.0 };
                Course { wave, middle }
            });
            let inputs = inputs.collect();
            Run { number, time, inputs }
        })
        .collect()
}

/// Triangles and steps are made for machines of some hertz; here they are as slow as the machine.
fn stretched(wave: Wave, random: &mut Random) -> Wave {
    match wave {
        Wave::Triangle(amplitude, _, phase) => Wave::Triangle(amplitude, random.log_within(6.0, 40.0), phase),
        Wave::Steps(levels, _) => {
            let slower = random.log_within(4.0, 15.0);
            Wave::Steps(levels.into_iter().map(|(t, level)| (t * slower, level)).collect(), 1.0)
        }
        other => other,
    }
}

/// Standard deviation.
pub(crate) fn spread(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = values.clone().count().max(1) as f64;
    let mean = values.clone().sum::<f64>() / count;
    (values.map(|v| (v - mean) * (v - mean)).sum::<f64>() / count).sqrt()
}

/// What is natural at a place, from runs of the machine as it is.
fn natural(world: &World, place: Place, ideals: &[Ideal], motions: &[Motion]) -> Natural {
    let mean = |of: &dyn Fn(&Motion) -> f64| {
        (motions.iter().map(|m| of(m) * of(m)).sum::<f64>() / motions.len().max(1) as f64).sqrt()
    };
    let m = &world.machine;
    match place {
        Place::Body(b) => {
            let v = m.velocity(b);
            Natural {
                way: mean(&|i| i[b].0),
                speed: mean(&|i| i[v].0),
                // what accelerates it, or what its speed costs where it only rolls
                force: mean(&|i| i[v].1) * world.parameters[m.bodies[b]],
            }
        }
        Place::Store(s) => {
            let s_state = m.store(s);
            Natural {
                way: mean(&|i| i[s_state].0),
                speed: mean(&|i| i[s_state].1),
                force: mean(&|i| i[s_state].1) * world.parameters[m.stores[s]],
            }
        }
        Place::Input(k) => Natural {
            way: spread(ideals.iter().flat_map(|i| i.inputs[k].iter().copied())),
            ..Natural::default()
        },
        Place::Output(k) => Natural {
            way: spread(ideals.iter().flat_map(|i| i.outputs[k].iter().copied())),
            ..Natural::default()
        },
        Place::Parameter(_) => Natural::default(),
    }
}

/// Differences of the outputs from sample to sample.
fn rates(ideal: &Ideal) -> Ideal {
    let differences =
        |values: &Vec<f64>| (0..values.len()).map(|k| values[k] - values[k.saturating_sub(1)]).collect();
    Ideal { outputs: ideal.outputs.iter().map(differences).collect(), ..Ideal::default() }
}

fn flat(ideals: &[Ideal], deviations: &[f64]) -> Vec<f64> {
    let mut all = Vec::new();
    for ideal in ideals {
        for k in 0..ideal.outputs[0].len() {
            all.extend(ideal.outputs.iter().zip(deviations).map(|(values, d)| values[k] / d));
        }
    }
    all
}

/// Sizes larger than this are no longer believable: six times what is natural, a gain or a copy of a third.
fn most(law: Law) -> f64 {
    if matches!(law, Law::Gain | Law::CrossTalk) { 1.5 } else { 6.0 }
}

/// The runs with a sample between every two.
fn doubled(runs: &[Run]) -> Vec<Run> {
    let between = |run: &Run| {
        let middles = run.time.windows(2).map(|w| 0.5 * (w[0] + w[1]));
        let mut time: Vec<f64> = run.time.iter().copied().chain(middles).collect();
        time.sort_by(f64::total_cmp);
        Run { time, ..run.clone() }
    };
    runs.iter().map(between).collect()
}

fn try_case(kind: Kind, number: usize, twice: bool, mut random: Random) -> Option<(Machine, Recorded)> {
    let random = &mut random;
    let (mut machine, drives) = draw::draw(random);
    for p in &mut machine.parameters {
        let off = if kind == Kind::Null { 0.0 } else { 0.15 };
        p.value = p.start * (1.0 + random.within(-off, off));
    }
    let runs = draw_runs(random, &machine, &drives);
    let interval = runs[0].time[runs[0].time.len() - 1] / (runs[0].time.len() - 1) as f64;
    let mut world = World {
        parameters: machine.values(),
        concealed: Vec::new(),
        filter: interval * random.within(0.03, 0.2),
        machine,
    };
    // some runs are enough to size effects
    let some: Vec<&Run> = runs.iter().step_by((runs.len() / 4).max(1)).collect();
    let simulate =
        |world: &World| -> (Vec<Ideal>, Vec<Motion>) { some.iter().map(|run| world.run(run, true)).unzip() };
    let (ideals, motions) = simulate(&world);
    let outputs = world.machine.outputs.len();
    let noise: Vec<Noise> = (0..outputs)
        .map(|c| {
            let own = spread(ideals.iter().flat_map(|i| i.outputs[c].iter().copied()));
            let level = random.log_within(0.005, 0.03) * own;
            Noise::draw(random, level)
        })
        .collect();
    let deviations: Vec<f64> = noise.iter().map(|n| n.deviation).collect();
    if deviations.iter().any(|d| !(d.is_finite() && *d > 0.0)) {
        return None;
    }
    let refit = {
        let nominal = flat(&ideals, &deviations);
        let columns = (0..world.parameters.len()).map(|i| {
            let mut moved = world.clone();
            moved.parameters[i] *= 1.005;
            let mut column = flat(&simulate(&moved).0, &deviations);
            column.iter_mut().zip(&nominal).for_each(|(a, b)| *a -= b);
            column
        });
        let mut columns: Vec<Vec<f64>> = columns.collect();
        // filters of the recorder may have this lag in common
        columns.push(flat(&ideals.iter().map(rates).collect::<Vec<Ideal>>(), &deviations));
        Refit::of(nominal, columns)
    };
    let (named, outside) = offers(&world.machine, &drives);
    let count = match kind {
        Kind::Null | Kind::Parameters | Kind::Fault => 0,
        Kind::Mix => 2,
        _ => 1,
    };
    let from = if kind == Kind::Outside { outside } else { named };
    let mut concealed: Vec<(Offer, Concealed, Vec<f64>)> = Vec::new();
    for _ in 0..count {
        let offer = pick(random, &from, &concealed)?;
        let effect = Concealed {
            id: offer.id,
            law: offer.law,
            place: offer.place,
            natural: natural(&world, offer.place, &ideals, &motions),
            other: (offer.other, {
                let other = offer.other;
                spread(ideals.iter().flat_map(|i| i.outputs[other].iter().copied()))
            }),
            time: world.machine.time,
            duration: runs[0].time[runs[0].time.len() - 1],
            size: 1.0,
            form: [random.share(), random.share()],
            seed: random.bits(),
        };
        let (low, high) = kind.target();
        let target = random.log_within(low, high);
        let left_with = |size: f64| {
            let with = World { concealed: vec![Concealed { size, ..effect.clone() }], ..world.clone() };
            refit.left(&flat(&simulate(&with).0, &deviations), outputs)
        };
        let (size, left) = size(target, (low, most(offer.law)), &left_with)?;
        // what any sensor shows at zero, up to a fiftieth of what its channel spans, is no effect
        if let (Law::Bias, Place::Output(k)) = (effect.law, effect.place) {
            let all = || ideals.iter().flat_map(|i| i.outputs[k].iter().copied());
            let span = all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min);
            if effect.offset(size) < 0.025 * span {
                return None;
            }
        }
        concealed.push((offer, Concealed { size, ..effect }, left));
    }
    world.concealed = concealed.iter().map(|(_, one, _)| one.clone()).collect();
    let runs = if twice { doubled(&runs) } else { runs };
    record(kind, number, &world, &runs, &noise, &concealed, random)
}

/// One of the laws that there are, each as likely, at one of its places; not at a place that is taken.
fn pick(random: &mut Random, from: &[Offer], taken: &[(Offer, Concealed, Vec<f64>)]) -> Option<Offer> {
    let free: Vec<&Offer> = from.iter().filter(|o| taken.iter().all(|(t, ..)| t.place != o.place)).collect();
    let mut ids: Vec<&str> = free.iter().map(|o| o.id).collect();
    ids.sort_unstable();
    ids.dedup();
    if ids.is_empty() {
        return None;
    }
    let id = random.pick(&ids);
    let list: Vec<&Offer> = free.into_iter().filter(|o| o.id == id).collect();
    Some(list[random.below(list.len())].clone())
}

/// The size at which the largest rest over the channels is `target`.
pub(crate) fn size(
    target: f64,
    (least, most): (f64, f64),
    left: &impl Fn(f64) -> Vec<f64>,
) -> Option<(f64, Vec<f64>)> {
    let largest = |list: &[f64]| list.iter().copied().fold(0.0, f64::max);
    let (mut small, mut large, mut at) = (0.0_f64, f64::INFINITY, 0.3_f64);
    for _ in 0..14 {
        let all = left(at);
        let now = largest(&all);
        if now.is_finite() && (now / target - 1.0).abs() < 0.05 {
            return Some((at, all));
        }
        if now.is_finite() && now < target {
            if at >= most {
                return (now > least).then_some((at, all));
            }
            small = at;
        } else {
            large = at;
        }
        let wish = if now.is_finite() && now > 0.0 { at * (target / now).clamp(0.1, 10.0) } else { 0.3 * at };
        let inside = wish > small && wish < large;
        at = if inside {
            wish
        } else if large.is_infinite() {
            2.0 * at
        } else if small > 0.0 {
            (small * large).sqrt()
        } else {
            0.3 * large
        }
        .min(most);
    }
    None
}

fn record(
    kind: Kind,
    number: usize,
    world: &World,
    runs: &[Run],
    noise: &[Noise],
    concealed: &[(Offer, Concealed, Vec<f64>)],
    random: &mut Random,
) -> Option<(Machine, Recorded)> {
    let machine = &world.machine;
    let ideals: Vec<Ideal> = runs.iter().map(|run| world.run(run, false).0).collect();
    let finite = |list: &Vec<Vec<f64>>| list.iter().flatten().all(|v| v.is_finite());
    if !ideals.iter().all(|i| finite(&i.inputs) && finite(&i.outputs)) {
        return None;
    }
    let stamp_error = random.within(0.001, 0.01);
    let share: Vec<f64> = noise.iter().map(|n| n.deviation * random.within(0.1, 0.5)).collect();
    let quanta: Vec<Quantum> = share.iter().map(|s| quantum(*s)).collect();
    let input_quanta: Vec<Quantum> = (0..machine.inputs.len())
        .map(|k| quantum(spread(ideals.iter().flat_map(|i| i.inputs[k].iter().copied())).max(1e-12) / 5e3))
        .collect();
    let interval = runs[0].time[1];
    let stamp = quantum(interval * 2e-4);
    let mut files = vec![("model".to_owned(), "machine.fmu\n".to_owned())];
    let mut floor = Vec::new();
    for (k, (run, ideal)) in runs.iter().zip(&ideals).enumerate() {
        let stamps = stamped(random, &run.time, stamp_error * interval, stamp);
        let mut columns: Vec<Vec<String>> = Vec::new();
        for (values, resolution) in ideal.inputs.iter().zip(&input_quanta) {
            columns.push(values.iter().map(|v| resolution.text(*v)).collect());
        }
        let mut squares = Vec::new();
        for (c, values) in ideal.outputs.iter().enumerate() {
            let (recorded, square) = sensed(random, &noise[c], quanta[c], (&run.time, &stamps), values);
            squares.push((machine.outputs[c].0.name.clone(), square));
            columns.push(recorded.iter().map(|v| quanta[c].text(*v)).collect());
        }
        let mut text = String::from("time [s]");
        for v in machine.inputs.iter().chain(machine.outputs.iter().map(|(v, _)| v)) {
            text += &format!(",{} [{}]", v.name, v.unit);
        }
        for (row, t) in stamps.iter().enumerate() {
            text += &format!("\n{}", stamp.text(*t));
            for column in &columns {
                text.push(',');
                text += &column[row];
            }
        }
        files.push((format!("recordings/{}", file_name(k)), text + "\n"));
        floor.push(ReferenceRun { name: file_name(k), samples: run.time.len(), channels: squares });
    }
    let effects = concealed.iter().map(|(offer, one, left)| {
        let (over_noise, order) = strongest(left);
        let inside = kind != Kind::Outside;
        Effect {
            id: offer.id.to_owned(),
            family: family(offer.id).unwrap_or_default().to_owned(),
            channels: order.into_iter().map(|c| machine.outputs[c].0.name.clone()).collect(),
            depends_on: offer.depends_on.clone(),
            accept: if inside { offer.accept.iter().map(|s| (*s).to_owned()).collect() } else { Vec::new() },
            size: one.size,
            over_noise,
            amounts: one.amounts().into_iter().map(|(name, value)| (name.to_owned(), value)).collect(),
        }
    });
    let effects: Vec<Effect> = effects.collect();
    let answer = Answer {
        case: crate::study::name(number),
        kind: kind.name().to_owned(),
        detail: effects.iter().map(|e| e.id.as_str()).collect::<Vec<_>>().join(" + "),
        model: world_name(machine).to_owned(),
        effects,
        parameters: machine
            .parameters
            .iter()
            .map(|p| Parameter { name: p.name.clone(), start: p.start, value: p.value })
            .collect(),
        ..Answer::default()
    };
    Some((machine.clone(), Recorded { files, answer, reference: Reference { runs: floor } }))
}

/// What sort of machine it is, in a word.
fn world_name(machine: &Machine) -> &'static str {
    use super::mechanism::Element::{Cylinder, Motor, Shaken};
    let has = |of: fn(&super::mechanism::Element) -> bool| machine.elements.iter().any(of);
    if machine.bodies.is_empty() {
        "stores"
    } else if has(|e| matches!(e, Motor { .. })) {
        "driveline"
    } else if has(|e| matches!(e, Cylinder { .. })) {
        "cylinder"
    } else if has(|e| matches!(e, Shaken { .. })) {
        "shaken chain"
    } else {
        "pushed chain"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_study_is_drawn_and_its_effects_are_as_large_as_said() {
        let kinds = kinds(3);
        assert_eq!((kinds.len(), count()), (200, 200));
        let mut seen = std::collections::BTreeSet::new();
        // the first two of each kind
        let numbers = SHARES.iter().flat_map(|(wanted, _)| {
            kinds
                .iter()
                .enumerate()
                .filter(move |(_, kind)| *kind == wanted)
                .map(|(number, _)| number)
                .take(2)
        });
        for number in numbers {
            let recorded = recorded(3, number).unwrap_or_else(|e| panic!("{e}"));
            seen.insert(recorded.answer.kind.clone());
            for effect in &recorded.answer.effects {
                let range = match recorded.answer.kind.as_str() {
                    "faint" => (0.28, 0.95),
                    "plain" => (1.3, 2.7),
                    _ => (2.8, 6.4),
                };
                let x = effect.over_noise;
                assert!(x > range.0 && x < range.1, "{}: {x}", recorded.answer.case);
            }
        }
        assert_eq!(seen.len(), SHARES.len(), "{seen:?}");
    }
}
