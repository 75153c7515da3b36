//! A case: a tire on a rig, what is believed of it, what is concealed, and what is recorded.

use super::concealed::{Concealed, Law, OFFERS, Offer};
use super::parameters::{Parameters, Rig};
use super::programme::{self, Run};
use super::world::{COARSE, FINE, World, input, noisy, outputs};
use crate::answer::{Answer, Effect, Parameter, Reference, ReferenceRun};
use crate::catalogue::{alike_on, family};
use crate::machines::{Kind, size, spread};
use crate::random::Random;
use crate::recording::{Recorded, file_name, sensed};
use crate::sensor::{Noise, Quantum, quantum};
use crate::simulate::Ideal;
use crate::sizing::{Refit, strongest};
use std::f64::consts::TAU;

/// How many cases there are: nothing concealed with parameters that are right and wrong, and each effect once.
#[must_use]
pub fn count() -> usize {
    OFFERS.len() + 2
}

/// Kind of every case, with what is concealed in it, in random order. Half of the names are clear, half plain.
pub(crate) fn study(seed: u64) -> Vec<(Kind, Option<Offer>)> {
    let mut random = Random::new(seed, 0);
    let others = |o: &Offer| !matches!(o, Offer::SpeedDamping | Offer::Play);
    let mut named: Vec<Offer> = OFFERS.into_iter().filter(others).collect();
    random.shuffle(&mut named);
    // the weight of a wheel is all that play shows: never more than plain
    named.push(Offer::Play);
    named.swap(5, 6);
    let kind = |k: usize| if k.is_multiple_of(2) { Kind::Clear } else { Kind::Plain };
    let mut all: Vec<_> = named.into_iter().enumerate().map(|(k, offer)| (kind(k), Some(offer))).collect();
    all.extend([(Kind::Outside, Some(Offer::SpeedDamping)), (Kind::Null, None), (Kind::Parameters, None)]);
    random.shuffle(&mut all);
    all
}

/// How often a case is drawn anew in which an effect cannot be as large as it is wanted.
const ATTEMPTS: u64 = 6;

/// Draws case number `number` of the study with this seed, and records it.
///
/// # Errors
/// No such case, or one that cannot be drawn.
pub fn case(seed: u64, number: usize) -> Result<Recorded, String> {
    let study = study(seed);
    let (kind, offer) = study
        .get(number)
        .ok_or_else(|| format!("the study has {} cases; there is no number {}", study.len(), number + 1))?;
    (0..ATTEMPTS)
        .find_map(|attempt| {
            let mut random = Random::new(seed, 1 + attempt * 1000 + number as u64);
            let drawn = Drawn::draw(*kind, *offer, &mut random)?;
            record(&drawn, number, &mut random)
        })
        .ok_or_else(|| format!("case {}: no {kind:?} {offer:?} in {ATTEMPTS} attempts", number + 1))
}

/// What is drawn of a case.
#[derive(Debug, Clone)]
pub(crate) struct Drawn {
    pub(crate) kind: Kind,
    pub(crate) world: World,
    pub(crate) belief: Parameters,
    pub(crate) runs: Vec<Run>,
    pub(crate) noise: Vec<Noise>,
    /// Of the channels, constant.
    pub(crate) offsets: Vec<f64>,
    /// What is concealed, and what it leaves of each channel.
    pub(crate) mark: Option<(Offer, Vec<f64>)>,
}

/// Share of a channel's spread over all runs that its noise has.
const NOISE: (f64, f64) = (0.01, 0.017);
/// Offsets of channels are at most so many times the noise.
const OFFSET: f64 = 1.5;
/// Sample times are off the even grid by as much \[s\], or not at all.
const JITTER: f64 = 1e-4;
/// Every how manieth sample counts where effects are sized.
const EVERY: usize = 2;
/// Effects larger or smaller than so many times their natural size are no longer believable.
const MOST: f64 = 10.0;
/// How often another shape of an effect is drawn that cannot be as large as it is wanted.
const SHAPES: usize = 3;

impl Drawn {
    fn draw(kind: Kind, offer: Option<Offer>, random: &mut Random) -> Option<Self> {
        let rig = match offer {
            Some(offer) => offer.rig(random),
            // between them, both nulls see a cylinder and the drum
            None if kind == Kind::Null => random.pick(&[Rig::Force, Rig::Position]),
            None => Rig::Drum,
        };
        let hung = offer == Some(Offer::Play);
        let mut drawn = Self::with(kind, (rig, hung), random, |_| true);
        if let Some(offer) = offer {
            drawn.conceal(offer, random)?;
        }
        Some(drawn)
    }

    /// A case without what is concealed, of those runs that are `wanted`.
    #[cfg(test)]
    pub(crate) fn bare(kind: Kind, rig: Rig, random: &mut Random, wanted: impl Fn(usize) -> bool) -> Self {
        Self::with(kind, (rig, false), random, wanted)
    }

    fn with(
        kind: Kind,
        (rig, hung): (Rig, bool),
        random: &mut Random,
        wanted: impl Fn(usize) -> bool,
    ) -> Self {
        let p = Parameters::draw(random, rig);
        let belief = p.believed(random, kind == Kind::Null);
        let cleat = programme::cleat(random, p.road_start);
        let jitter = if random.chance(0.7) { JITTER } else { 0.0 };
        let mut runs = programme::draw(random, rig, jitter, hung);
        let mut number = 0..;
        runs.retain(|_| number.next().is_some_and(&wanted));
        let world = World { rig, p, cleat, concealed: None };
        let few: Vec<Run> = runs.iter().map(|run| run.thinned(EVERY)).collect();
        let nominal = world.session(&few, COARSE);
        let noise: Vec<Noise> = (0..noisy(rig))
            .map(|c| {
                let own = spread(nominal.iter().flat_map(|i| i.outputs[c].iter().copied()));
                let deviation = random.within(NOISE.0, NOISE.1) * own;
                Noise::draw(random, deviation)
            })
            .collect();
        let offsets = noise.iter().map(|n| n.deviation * random.within(-OFFSET, OFFSET)).collect();
        Self { kind, world, belief, runs, noise, offsets, mark: None }
    }

    /// Conceals an effect, as large as the kind wants it; none if it cannot be.
    pub(crate) fn conceal(&mut self, offer: Offer, random: &mut Random) -> Option<()> {
        let few: Vec<Run> = self.runs.iter().map(|run| run.thinned(EVERY)).collect();
        let refit = self.refit(&few, offer);
        let (low, high) = self.kind.target();
        let target = random.log_within(low, high);
        let (mut concealed, left) = (0..SHAPES).find_map(|_| {
            let law = offer.draw(random);
            let left = |size: f64| {
                let concealed = Some(Concealed { law, size });
                let world = World { concealed, ..self.world.clone() };
                refit.left(&self.flat(&world.session(&few, COARSE)), self.noise.len())
            };
            let (size, left) = size(target, (low, MOST), &left)?;
            Some((Concealed { law, size }, left))
        })?;
        if let Law::CellLag(beyond) = &mut concealed.law {
            *beyond = self.world.p.element_radial_damping / self.world.p.element_radial_stiffness;
        }
        self.world.concealed = Some(concealed);
        self.mark = Some((offer, left));
        Some(())
    }

    /// All channels of all runs over the noise, channels taking turns.
    pub(crate) fn flat(&self, session: &[Ideal]) -> Vec<f64> {
        let mut all = Vec::new();
        for ideal in session {
            for k in 0..ideal.outputs[0].len() {
                all.extend(self.noise.iter().zip(&ideal.outputs).map(|(n, values)| values[k] / n.deviation));
            }
        }
        all
    }

    /// What free parameters and offsets can explain. A lag of the force is less damping, until there is none: what it takes
    /// for that comes on top of its size.
    fn refit(&self, runs: &[Run], offer: Offer) -> Refit {
        let nominal = self.flat(&self.world.session(runs, COARSE));
        let channels = self.noise.len();
        let free = |(name, _): &(&str, f64)| offer != Offer::CellLag || *name != "element_radial_damping";
        let columns = self.world.p.free().filter(free).map(|(name, _)| {
            let moved = World { p: self.world.p.moved(name, 5e-3), ..self.world.clone() };
            let mut column = self.flat(&moved.session(runs, COARSE));
            column.iter_mut().zip(&nominal).for_each(|(a, b)| *a -= b);
            column
        });
        let offsets = (0..channels)
            .map(|c| (0..nominal.len()).map(|k| if k % channels == c { 1.0 } else { 0.0 }).collect());
        let columns = columns.chain(offsets).collect();
        Refit::of(nominal, columns)
    }
}

/// Steps of the encoder per revolution.
const ENCODER: f64 = 1024.0;

fn record(drawn: &Drawn, number: usize, random: &mut Random) -> Option<Recorded> {
    let rig = drawn.world.rig;
    let session = drawn.world.session(&drawn.runs, FINE);
    let finite = |ideal: &Ideal| ideal.outputs.iter().flatten().all(|v| v.is_finite());
    if !session.iter().all(finite) {
        return None;
    }
    let quanta: Vec<Quantum> =
        drawn.noise.iter().map(|n| quantum(n.deviation * random.log_within(0.05, 0.3))).collect();
    let mut files = vec![("model".to_owned(), format!("{}\n", rig.model()))];
    let mut floor = Vec::new();
    for (k, (run, ideal)) in drawn.runs.iter().zip(&session).enumerate() {
        let mut squares = Vec::new();
        let mut columns = Vec::new();
        for (c, noise) in drawn.noise.iter().enumerate() {
            let truth: Vec<f64> = ideal.outputs[c].iter().map(|v| v + drawn.offsets[c]).collect();
            let (recorded, square) = sensed(random, noise, quanta[c], (&run.stamps, &run.stamps), &truth);
            squares.push((outputs(rig)[c].0.to_owned(), square));
            columns.push(recorded);
        }
        if let Some(angle) = ideal.outputs.get(columns.len()) {
            let step = TAU / ENCODER;
            columns.push(angle.iter().map(|v| (v / step).floor() * step).collect());
        }
        files.push((
            format!("recordings/{}", file_name(k)),
            csv(rig, (run, &ideal.inputs[0]), &columns, &quanta),
        ));
        floor.push(ReferenceRun { name: file_name(k), samples: run.stamps.len(), channels: squares });
    }
    let (all, checks) = rig.runs();
    let uses = (0..drawn.runs.len()).map(|run| {
        let used = if run < all - checks { "fit" } else { "check" };
        format!("\"{}\" = \"{used}\"\n", file_name(run))
    });
    files.push(("recordings/runs.toml".to_owned(), format!("[runs]\n{}", uses.collect::<String>())));
    files.push(("parameters.toml".to_owned(), drawn.belief.toml(rig, &drawn.world.cleat.profile())));
    Some(Recorded { files, answer: answer(drawn, number), reference: Reference { runs: floor } })
}

fn csv(rig: Rig, (run, command): (&Run, &[f64]), columns: &[Vec<f64>], quanta: &[Quantum]) -> String {
    let (name, unit, exponent) = input(rig);
    let mut text = format!("time [s],{name} [{unit}]");
    for (name, unit) in outputs(rig) {
        text += &format!(",{name} [{unit}]");
    }
    let grid = Quantum { mantissa: 1, exponent };
    for (k, stamp) in run.stamps.iter().enumerate() {
        text += &format!("\n{stamp:.5},{}", grid.text(command[k]));
        for (c, column) in columns.iter().enumerate() {
            text.push(',');
            match quanta.get(c) {
                Some(quantum) => text += &quantum.text(column[k]),
                None => text += &format!("{:.5}", column[k]),
            }
        }
    }
    text + "\n"
}

fn answer(drawn: &Drawn, number: usize) -> Answer {
    let rig = drawn.world.rig;
    let effects: Vec<Effect> = drawn
        .mark
        .iter()
        .map(|(offer, left)| {
            let (over_noise, order) = strongest(left);
            let mut accept = Vec::new();
            if drawn.kind != Kind::Outside {
                accept = alike_on(rig.model(), offer.id());
                accept.extend(offer.also().iter().map(|id| (*id).to_owned()));
            }
            Effect {
                id: offer.id().to_owned(),
                family: family(offer.id()).unwrap_or_default().to_owned(),
                channels: order.into_iter().map(|c| outputs(rig)[c].0.to_owned()).collect(),
                depends_on: offer.depends_on().iter().map(|s| (*s).to_owned()).collect(),
                accept,
                size: drawn.world.concealed.map_or(0.0, |c| c.size),
                over_noise,
                amounts: Vec::new(),
            }
        })
        .collect();
    Answer {
        case: crate::study::name(number),
        kind: drawn.kind.name().to_owned(),
        detail: effects.first().map(|e| e.id.clone()).unwrap_or_default(),
        model: rig.model().to_owned(),
        parameters: drawn
            .belief
            .free()
            .zip(drawn.world.p.free())
            .map(|((name, start), (_, value))| Parameter { name: name.to_owned(), start, value })
            .collect(),
        effects,
        ..Answer::default()
    }
}
