//! A case: a tire, what is believed of it, what is concealed in the session, and what is recorded.

use super::concealed::Concealed;
use super::fault::{FAULTS, spoil};
use super::offers::{NAMED, OUTSIDE, Offer};
use super::parameters::{FREE, Parameters};
use super::programme::{self, CHECKS, RUNS, Run};
use super::session::{CHANNELS, COARSE, FINE, FORCES, World};
use crate::answer::{Answer, Effect, Fault, Parameter, Reference, ReferenceRun};
use crate::catalogue::{alike_on, family};
use crate::fault::Tables;
use crate::flat_track::NAME;
use crate::machines::{Kind, size, spread};
use crate::random::Random;
use crate::recording::{Recorded, file_name, sensed};
use crate::sensor::{Noise, Quantum, quantum};
use crate::simulate::Ideal;
use crate::sizing::{Refit, strongest};
use std::f64::consts::TAU;

/// How many cases of each kind a study has.
const SHARES: [(Kind, usize); 8] = [
    (Kind::Clear, 14),
    (Kind::Plain, 14),
    (Kind::Faint, 6),
    (Kind::Mix, 6),
    (Kind::Null, 6),
    (Kind::Parameters, 6),
    (Kind::Outside, 8),
    (Kind::Fault, FAULTS.len()),
];

/// How many cases there are.
#[must_use]
pub fn count() -> usize {
    SHARES.iter().map(|(_, n)| n).sum()
}

/// Kind of every case, with what is concealed in it, in random order. Of each kind the offers are dealt like cards, so
/// that none comes twice before all have come.
pub(crate) fn study(seed: u64) -> Vec<(Kind, Vec<Offer>, &'static str)> {
    let mut random = Random::new(seed, 0);
    let mut all = Vec::new();
    for (kind, count) in SHARES {
        let (mut deck, each): (Vec<Offer>, usize) = match kind {
            Kind::Outside => (OUTSIDE.to_vec(), 1),
            Kind::Mix => (NAMED.to_vec(), 2),
            Kind::Clear | Kind::Plain | Kind::Faint => (NAMED.to_vec(), 1),
            _ => (Vec::new(), 0),
        };
        let size = deck.len();
        let rounds = (count * each).div_ceil(size.max(1));
        let mut cards = Vec::new();
        for _ in 0..rounds {
            random.shuffle(&mut deck);
            cards.extend_from_slice(&deck);
        }
        let faults = if kind == Kind::Fault { FAULTS.to_vec() } else { vec![""; count] };
        for (k, fault) in faults.into_iter().enumerate() {
            let cards = cards.iter().copied().skip(k * each).take(each).collect();
            all.push((kind, cards, fault));
        }
    }
    random.shuffle(&mut all);
    all
}

/// How often a session is drawn anew in which an effect cannot be as large as it is wanted.
const ATTEMPTS: u64 = 8;

/// Draws case number `number` of the study with this seed, and records it.
///
/// # Errors
/// No such case, or one that cannot be drawn.
pub fn case(seed: u64, number: usize) -> Result<Recorded, String> {
    let study = study(seed);
    let (kind, offers, fault) = study
        .get(number)
        .ok_or_else(|| format!("the study has {} cases; there is no number {}", study.len(), number + 1))?;
    (0..ATTEMPTS)
        .find_map(|attempt| {
            let mut random = Random::new(seed, 1 + attempt * 100_000 + number as u64);
            let drawn = Drawn::draw(*kind, offers, &mut random)?;
            record(&drawn, number, fault, &mut random)
        })
        .ok_or_else(|| format!("case {}: no {kind:?} of {offers:?} in {ATTEMPTS} attempts", number + 1))
}

/// What is drawn of a case.
#[derive(Debug, Clone)]
pub(crate) struct Drawn {
    pub(crate) kind: Kind,
    pub(crate) world: World,
    pub(crate) belief: Parameters,
    pub(crate) runs: Vec<Run>,
    pub(crate) noise: Vec<Noise>,
    /// Of the channels, without what is concealed.
    pub(crate) spreads: [f64; CHANNELS],
    /// Of the channels, constant.
    pub(crate) offsets: [f64; FORCES],
    /// Per effect what it is and what it leaves of each channel.
    pub(crate) marks: Vec<(Offer, Vec<f64>)>,
}

/// How often another place and shape of an effect is drawn that cannot be as large as it is wanted.
const SHAPES: usize = 3;
/// Share of a channel's spread over the session that its noise has. A load cell has to bear the overturning moment, so that
/// of its small moment about the vertical it sees less well: 0.7 to 1 % of the whole span, which is reached at the edge of
/// sliding alone.
const NOISE: [(f64, f64); FORCES] =
    [(0.007, 0.011), (0.007, 0.011), (0.008, 0.013), (0.005, 0.008), (0.005, 0.008), (0.035, 0.055)];
/// Offsets of channels are at most so many times the noise, as zeros of a load cell between two calibrations.
const OFFSET: f64 = 1.8;
/// Sample times are off the even grid by as much \[s\], or not at all.
const JITTER: f64 = 1.5e-4;
/// Every how manieth sample counts where effects are sized.
const EVERY: usize = 3;
/// Effects larger than so many times their natural size are no longer believable.
const MOST: f64 = 8.0;
/// The same of a wrong gain or a copy of a channel, in fifths of it.
const MOST_OF_CHANNEL: f64 = 1.5;

impl Drawn {
    fn draw(kind: Kind, offers: &[Offer], random: &mut Random) -> Option<Self> {
        let (mut drawn, few, nominal) = Self::bare(kind, random, |_| true);
        drawn.conceal(offers, (&few, &nominal), random)?;
        Some(drawn)
    }

    /// A case without what is concealed, of those runs that are `wanted`; with them, their samples thinned, and what is
    /// ideally recorded there.
    pub(crate) fn bare(
        kind: Kind,
        random: &mut Random,
        wanted: impl Fn(usize) -> bool,
    ) -> (Self, Vec<Run>, Vec<Ideal>) {
        let tire = Parameters::draw(random);
        let belief = tire.believed(random, kind == Kind::Null);
        let jitter = if random.chance(0.7) { JITTER } else { 0.0 };
        let mut runs = programme::draw(random, jitter);
        let mut number = 0..;
        runs.retain(|_| number.next().is_some_and(&wanted));
        let few: Vec<Run> = runs.iter().map(|run| run.thinned(EVERY)).collect();
        let world = World { tire, concealed: Vec::new() };
        let nominal = world.session(&few, COARSE);
        let spreads: [f64; CHANNELS] =
            std::array::from_fn(|c| spread(nominal.iter().flat_map(|i| i.outputs[c].iter().copied())));
        let noise: Vec<Noise> = spreads[..FORCES]
            .iter()
            .zip(NOISE)
            .map(|(own, (least, most))| {
                let deviation = random.within(least, most) * own;
                Noise::draw(random, deviation)
            })
            .collect();
        let given = kind == Kind::Null || random.chance(0.7);
        let offsets = std::array::from_fn(|c| {
            if given { noise[c].deviation * random.within(-OFFSET, OFFSET) } else { 0.0 }
        });
        let drawn = Self { kind, world, belief, runs, noise, offsets, spreads, marks: Vec::new() };
        (drawn, few, nominal)
    }

    /// Conceals what is offered, each as large as the kind wants it; none if something cannot be.
    pub(crate) fn conceal(
        &mut self,
        offers: &[Offer],
        (runs, nominal): (&[Run], &[Ideal]),
        random: &mut Random,
    ) -> Option<()> {
        if offers.is_empty() {
            return Some(());
        }
        let refit = self.refit(runs, nominal);
        for offer in offers {
            let (low, high) = self.kind.target();
            let target = random.log_within(low, high);
            let sign = if offer.may_be_negative() { random.sign() } else { 1.0 };
            let most = if matches!(offer, Offer::Gain | Offer::CrossTalk) { MOST_OF_CHANNEL } else { MOST };
            let (effect, left) = (0..SHAPES).find_map(|_| {
                let effect = offer.draw(random, &self.spreads, runs[0].duration);
                let with = |size: f64| effect.sized(sign * size);
                let left = |size: f64| {
                    let world = World { concealed: vec![with(size)], tire: self.world.tire.clone() };
                    refit.left(&self.flat(&world.session(runs, COARSE)), FORCES)
                };
                let (size, left) = size(target, (low, most), &left)?;
                Some((with(size), left))
            })?;
            self.world.concealed.push(effect);
            self.marks.push((*offer, left));
        }
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

    /// What free parameters and offsets can explain.
    pub(crate) fn refit(&self, runs: &[Run], nominal: &[Ideal]) -> Refit {
        let nominal = self.flat(nominal);
        let columns = (0..FREE).map(|free| {
            let moved = World { tire: self.world.tire.moved(free, 5e-3), concealed: Vec::new() };
            let mut column = self.flat(&moved.session(runs, COARSE));
            column.iter_mut().zip(&nominal).for_each(|(a, b)| *a -= b);
            column
        });
        let offsets = (0..FORCES)
            .map(|c| (0..nominal.len()).map(|k| if k % FORCES == c { 1.0 } else { 0.0 }).collect());
        let columns = columns.chain(offsets).collect();
        Refit::of(nominal, columns)
    }
}

/// Name, unit and decimals of the columns that are commands.
const INPUTS: [(&str, &str, i32); 6] = [
    ("steer", "rad", -6),
    ("deflection", "m", -7),
    ("path_speed", "m/s", -4),
    ("camber", "rad", -6),
    ("slip", "1", -6),
    ("slip_angle", "rad", -6),
];
const OUTPUTS: [(&str, &str); CHANNELS] = [
    ("force_x", "N"),
    ("force_y", "N"),
    ("force_z", "N"),
    ("moment_x", "N.m"),
    ("moment_y", "N.m"),
    ("moment_z", "N.m"),
    ("wheel_angle", "rad"),
];
/// Steps of the encoder per revolution.
const ENCODER: f64 = 1024.0;

fn record(drawn: &Drawn, number: usize, fault: &str, random: &mut Random) -> Option<Recorded> {
    let session = drawn.world.session(&drawn.runs, FINE);
    let finite = |ideal: &Ideal| ideal.outputs.iter().flatten().all(|v| v.is_finite());
    if !session.iter().all(finite) {
        return None;
    }
    let quanta: Vec<Quantum> =
        drawn.noise.iter().map(|n| quantum(n.deviation * random.log_within(0.05, 0.3))).collect();
    let mut tables = Tables { stamps: Vec::new(), columns: Vec::new(), inputs: INPUTS.len() };
    let mut floor = Vec::new();
    for (k, (run, ideal)) in drawn.runs.iter().zip(&session).enumerate() {
        let commands = ideal.inputs.iter().zip(INPUTS).map(|(values, (.., exponent))| {
            let grid = Quantum { mantissa: 1, exponent };
            values.iter().map(|v| grid.round(*v)).collect()
        });
        let mut columns: Vec<Vec<f64>> = commands.collect();
        let mut squares = Vec::new();
        for c in 0..FORCES {
            let truth: Vec<f64> = ideal.outputs[c].iter().map(|v| v + drawn.offsets[c]).collect();
            let (recorded, square) =
                sensed(random, &drawn.noise[c], quanta[c], (&run.stamps, &run.stamps), &truth);
            squares.push((OUTPUTS[c].0.to_owned(), square));
            columns.push(recorded);
        }
        let step = TAU / ENCODER;
        columns.push(ideal.outputs[FORCES].iter().map(|v| (v / step).floor() * step).collect());
        tables.columns.push(columns);
        tables.stamps.push(run.stamps.clone());
        floor.push(ReferenceRun { name: file_name(k), samples: run.stamps.len(), channels: squares });
    }
    let fault = (drawn.kind == Kind::Fault)
        .then(|| Fault::of(fault, spoil(&mut tables, fault, random), |c| OUTPUTS[c].0.to_owned()));
    let mut files = vec![("model".to_owned(), format!("{NAME}\n"))];
    files.extend((0..RUNS).map(|run| (format!("recordings/{}", file_name(run)), csv(&tables, run, &quanta))));
    let uses = (0..RUNS).map(|run| {
        let used = if run < RUNS - CHECKS { "fit" } else { "check" };
        format!("\"{}\" = \"{used}\"\n", file_name(run))
    });
    files.push(("recordings/runs.toml".to_owned(), format!("[runs]\n{}", uses.collect::<String>())));
    files.push(("parameters.toml".to_owned(), drawn.belief.toml()));
    Some(Recorded { files, answer: answer(drawn, number, fault), reference: Reference { runs: floor } })
}

fn csv(tables: &Tables, run: usize, quanta: &[Quantum]) -> String {
    let mut text = String::from("time [s]");
    for (name, unit) in
        INPUTS.iter().map(|(name, unit, _)| (name, unit)).chain(OUTPUTS.iter().map(|(n, u)| (n, u)))
    {
        text += &format!(",{name} [{unit}]");
    }
    let inputs = INPUTS.map(|(.., exponent)| Quantum { mantissa: 1, exponent });
    for (k, stamp) in tables.stamps[run].iter().enumerate() {
        text += &format!("\n{stamp:.5}");
        for (c, column) in tables.columns[run].iter().enumerate() {
            text.push(',');
            let grid = inputs.get(c).or_else(|| quanta.get(c - inputs.len()));
            // the encoder, and what a fault has put on another grid
            let off = grid.is_none_or(|grid| (grid.round(column[k]) - column[k]).abs() > 1e-9 * grid.step());
            match grid {
                Some(grid) if !off => text += &grid.text(column[k]),
                None => text += &format!("{:.5}", column[k]),
                _ => text += &format!("{:.6e}", column[k]),
            }
        }
    }
    text + "\n"
}

fn answer(drawn: &Drawn, number: usize, fault: Option<Fault>) -> Answer {
    let inside = drawn.kind != Kind::Outside;
    let names = OUTPUTS.map(|row| row.0);
    let effects =
        drawn.marks.iter().zip(&drawn.world.concealed).map(|((offer, left), one): (_, &Concealed)| {
            let (over_noise, order) = strongest(left);
            Effect {
                id: offer.id().to_owned(),
                family: family(offer.id()).unwrap_or_default().to_owned(),
                channels: order.into_iter().map(|c| OUTPUTS[c].0.to_owned()).collect(),
                depends_on: one.depends_on(&names).into_iter().map(str::to_owned).collect(),
                accept: if inside { alike_on(NAME, offer.id()) } else { Vec::new() },
                size: one.size,
                over_noise,
                amounts: Vec::new(),
            }
        });
    let effects: Vec<Effect> = effects.collect();
    let names = effects.iter().map(|e| e.id.as_str()).collect::<Vec<_>>().join(" + ");
    let detail = fault.as_ref().map_or(&names, |f| &f.name);
    Answer {
        case: crate::study::name(number),
        kind: drawn.kind.name().to_owned(),
        detail: detail.to_owned(),
        model: NAME.to_owned(),
        parameters: drawn
            .belief
            .free()
            .zip(drawn.world.tire.free())
            .map(|((name, start), (_, value))| Parameter { name: name.to_owned(), start, value })
            .collect(),
        effects,
        fault,
        ..Answer::default()
    }
}
