//! A case: a car, what is believed of it, what is concealed, and what is recorded.

use super::concealed::{self, OFFERS, Offer};
use super::parameters::{Parameters, rounded};
use super::programme::{self, INTERVAL, Run};
use super::system;
use super::world::{STEP, World, outputs};
use crate::answer::{Answer, Effect, Parameter, Reference, ReferenceRun};
use crate::machines::spread;
use crate::random::Random;
use crate::recording::{Recorded, sensed};
use crate::sensor::{Noise, Quantum, quantum};
use crate::simulate::Ideal;
use crate::sizing::strongest;

/// How many cases there are.
#[must_use]
pub fn count() -> usize {
    OFFERS.iter().map(|(_, times)| times).sum()
}

/// What is concealed in every case, in random order.
pub(crate) fn study(seed: u64) -> Vec<Offer> {
    let mut all: Vec<Offer> =
        OFFERS.iter().flat_map(|(offer, times)| std::iter::repeat_n(*offer, *times)).collect();
    Random::new(seed, 0).shuffle(&mut all);
    all
}

/// Draws case number `number` of the study with this seed, and records it.
///
/// # Errors
/// No such case, or a car that cannot be driven.
pub fn case(seed: u64, number: usize) -> Result<Recorded, String> {
    let study = study(seed);
    let offer = study
        .get(number)
        .ok_or_else(|| format!("the study has {} cases; there is no number {}", study.len(), number + 1))?;
    let mut random = Random::new(seed, 1 + number as u64);
    let drawn = Drawn::draw(*offer, &mut random);
    record(&drawn, number, &mut random).ok_or_else(|| format!("case {}: the car left the road", number + 1))
}

/// What is drawn of a case.
#[derive(Debug, Clone)]
pub(crate) struct Drawn {
    pub(crate) offer: Offer,
    pub(crate) world: World,
    pub(crate) belief: Parameters,
    pub(crate) runs: Vec<Run>,
}

impl Drawn {
    pub(crate) fn draw(offer: Offer, random: &mut Random) -> Self {
        let mut belief = Parameters::draw(random);
        let mut truth = belief.clone();
        offer.conceal(&mut truth, &mut belief, random);
        let (truth, belief) = (truth.rounded(), belief.rounded());
        let scatter = (rounded(random.within(0.03, 0.05)), rounded(random.log_within(0.7, 1.5)));
        let runs = programme::draw(random, &belief);
        let other_road = (offer == Offer::OneRoad).then(|| concealed::other_road(random));
        let world = World { p: truth, scatter, alike: offer == Offer::ColumnAlike, other_road };
        Self { offer, world, belief, runs }
    }
}

/// Share of a channel's spread over all runs that its noise has, and its constant offset over the noise.
const NOISE: (f64, f64) = (0.005, 0.01);
/// The same of the driver's pressure, which drives a simulation: more of it would be a torque that is not there in gentle stops.
const NOISE_OF_PRESSURE: (f64, f64) = (0.001, 0.0025);
const OFFSET: f64 = 1.0;
/// Of the driver's pressure \[bar\].
const LEAST_PRESSURE: f64 = 0.1;

/// A cause that leaves less than that of the noise is seen in no channel.
const HARDLY: f64 = 0.01;

/// Noise, constant offset and resolution of a channel.
struct Sensor {
    noise: Noise,
    offset: f64,
    quantum: Quantum,
}

fn sensors(session: &[Ideal], random: &mut Random) -> Vec<Sensor> {
    let mut least = vec![LEAST_PRESSURE];
    least.extend(outputs().iter().map(|(_, _, least)| least));
    let mut all = Vec::new();
    for (c, least) in least.into_iter().enumerate() {
        let own = spread(session.iter().flat_map(|ideal| channel(ideal, c).iter().copied()));
        let (low, high) = if c == 0 { NOISE_OF_PRESSURE } else { NOISE };
        let deviation = (random.within(low, high) * own).max(least);
        let noise = Noise::draw(random, deviation);
        let offset = deviation * random.within(-OFFSET, OFFSET);
        all.push(Sensor { noise, offset, quantum: quantum(deviation * random.log_within(0.05, 0.3)) });
    }
    all
}

/// A channel of a run: the driver's pressure, then what the car does.
fn channel(ideal: &Ideal, c: usize) -> &[f64] {
    let list = if c == 0 { ideal.inputs.first() } else { ideal.outputs.get(c - 1) };
    list.map_or(&[], Vec::as_slice)
}

/// All of a case, simulated and recorded; none if the car cannot be driven.
pub(crate) fn record(drawn: &Drawn, number: usize, random: &mut Random) -> Option<Recorded> {
    let session: Vec<Ideal> =
        drawn.runs.iter().map(|run| drawn.world.run(run, STEP)).collect::<Option<_>>()?;
    if !session.iter().all(|ideal| ideal.outputs.iter().flatten().all(|v| v.is_finite())) {
        return None;
    }
    let sensors = sensors(&session, random);
    let mut names = vec![("driver_pressure".to_owned(), "bar")];
    names.extend(outputs().into_iter().map(|(name, unit, _)| (name, unit)));
    let mut files = vec![
        ("system.toml".to_owned(), system::system(&drawn.belief, drawn.world.scatter, drawn.world.alike)),
        ("driver.csv".to_owned(), system::driver()),
        ("recordings/runs.toml".to_owned(), system::runs(&drawn.runs)),
    ];
    let mut floor = Vec::new();
    for (run, ideal) in drawn.runs.iter().zip(&session) {
        let count = channel(ideal, 0).len();
        let stamps: Vec<f64> = (0..count).map(|k| k as f64 * INTERVAL).collect();
        let mut head = "time [s]".to_owned();
        let mut rows: Vec<String> = stamps.iter().map(|t| format!("{t:.3}")).collect();
        let mut squares = Vec::new();
        for (c, (sensor, (name, unit))) in sensors.iter().zip(&names).enumerate() {
            let truth: Vec<f64> = channel(ideal, c).iter().map(|v| v + sensor.offset).collect();
            let (recorded, square) =
                sensed(random, &sensor.noise, sensor.quantum, (&stamps, &stamps), &truth);
            squares.push((name.clone(), square));
            head += &format!(",{name} [{unit}]");
            for (row, value) in rows.iter_mut().zip(&recorded) {
                *row += ",";
                *row += &sensor.quantum.text(*value);
            }
            if c == 0 {
                // nobody turns the steering wheel
                head += ",car.steering_wheel_angle [rad]";
                rows.iter_mut().for_each(|row| *row += ",0");
            }
        }
        files.push((format!("recordings/{}", run.file()), head + "\n" + &rows.join("\n") + "\n"));
        floor.push(ReferenceRun { name: run.file(), samples: count, channels: squares });
    }
    let answer = answer(drawn, number, (&session, &sensors))?;
    Some(Recorded { files, answer, reference: Reference { runs: floor } })
}

/// A stop with controller is compared until as long after the brake's onset \[s\]: behind the first dip its decisions part, whatever is
/// concealed.
const FIRST_DIP: f64 = 0.35;

/// What is seen of a cause in a gentle stop, and in the first dip of one with controller, and on a road that is another one: rms over
/// the noise.
fn seen(drawn: &Drawn, session: &[Ideal], sensors: &[Sensor]) -> Option<Vec<f64>> {
    let bare = World { p: drawn.belief.clone(), other_road: None, ..drawn.world.clone() };
    let mut most = vec![0.0_f64; sensors.len()];
    let other = drawn.world.other_road.map(|(kind, _)| kind);
    for kind in ["flat", "partial"].into_iter().chain(other) {
        let Some((run, with)) = drawn.runs.iter().zip(session).find(|(run, _)| run.kind == kind) else {
            continue;
        };
        let without = bare.run(run, STEP)?;
        let dip = ((run.onset + FIRST_DIP) / INTERVAL).round() as usize;
        let samples = if kind == "partial" { usize::MAX } else { dip };
        for (c, most) in most.iter_mut().enumerate() {
            let both = channel(with, c).iter().zip(channel(&without, c)).take(samples);
            let count = both.len().max(1) as f64;
            let square = both.map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / count;
            *most = most.max(square.sqrt() / sensors[c].noise.deviation);
        }
    }
    Some(most)
}

fn answer(drawn: &Drawn, number: usize, (session, sensors): (&[Ideal], &[Sensor])) -> Option<Answer> {
    let causes = drawn.offer.causes();
    let mut names = vec!["driver_pressure".to_owned()];
    names.extend(outputs().into_iter().map(|(name, ..)| name));
    let (mut over_noise, mut channels) = (0.0, Vec::new());
    if !causes.is_empty() {
        let (most, order) = strongest(&seen(drawn, session, sensors)?);
        over_noise = most;
        let order = if most > HARDLY { order } else { Vec::new() };
        channels = order.into_iter().filter_map(|c| names.get(c).cloned()).collect();
    }
    let (believed, true_ones) = (drawn.belief.named(), drawn.world.p.named());
    let mut parameters: Vec<Parameter> = believed
        .into_iter()
        .zip(true_ones)
        .map(|((name, start), (_, value))| Parameter { name, start, value })
        .collect();
    for (name, start, value) in [
        ("car.front_damper", drawn.belief.front_damping, drawn.world.p.front_damping),
        ("car.road_friction", drawn.belief.road_friction, drawn.world.p.road_friction),
        ("driver_pressure", drawn.belief.master_gain, drawn.world.p.master_gain),
    ] {
        parameters.push(Parameter { name: name.to_owned(), start, value });
    }
    let off = |p: &Parameter| if p.start == 0.0 { p.value } else { p.value / p.start - 1.0 };
    let effects: Vec<Effect> = causes
        .into_iter()
        .map(|(id, accept)| {
            let offs = parameters.iter().filter(|p| accept.contains(&p.name)).map(off);
            let most = offs.fold(0.0, |most: f64, o| if o.abs() > most.abs() { o } else { most });
            let (accept, size) = match drawn.world.other_road {
                Some((kind, level)) => (vec![kind.to_owned()], level - 1.0),
                None => (accept, most),
            };
            Effect {
                id: id.to_owned(),
                family: String::new(),
                channels: channels.clone(),
                depends_on: Vec::new(),
                size,
                accept,
                over_noise,
                amounts: Vec::new(),
            }
        })
        .collect();
    Some(Answer {
        case: crate::study::name(number),
        kind: drawn.offer.kind().to_owned(),
        detail: effects.iter().map(|e| e.id.as_str()).collect::<Vec<_>>().join(" + "),
        model: "car".to_owned(),
        effects,
        parameters,
        ..Answer::default()
    })
}
