//! A library of rig programmes, made from what the recordings covered of each driven input: its level, its
//! range and its band. Nothing is assumed of the machine but that it can do about that again.

use super::roles::Roles;
use crate::effect::Role;
use crate::fit::{Drive, Run};
use crate::model::{Interface, VariableInfo};
use crate::page::number;
use crate::stats::{SplitMix64, about_mean, median};
use std::f64::consts::PI;
use std::sync::Arc;

/// Frequencies below and above the recorded one, as multiples of it.
const BELOW: f64 = 0.25;
const ABOVE: f64 = 4.0;
/// The highest frequency, as a share of the sampling rate.
const HIGHEST: f64 = 0.2;
/// Periods of a sine, if a run is long enough.
const PERIODS: f64 = 5.0;
/// Amplitude of the largest sine as a multiple of the recorded one.
const LARGER: f64 = 1.5;
/// Length of the long hold as a multiple of that of a run: drifts and warming up need time.
const LONG: f64 = 5.0;
/// Communication points of a programme at most.
const MAX_POINTS: f64 = 200_000.0;
/// Sines that make a random band.
const LINES: usize = 16;
/// Inputs whose level is told in words.
const TOLD: usize = 3;
/// An input is the rate of another if it differs from it by less than this share of its square.
const SAME: f64 = 0.01;

/// What is driven through a rig.
pub(super) struct Programme {
    /// In words, with units.
    pub words: String,
    /// What it is for a model.
    pub drive: Arc<Drive>,
    /// It leaves the range that was recorded.
    pub beyond: bool,
}

/// The course of the input that a programme moves.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Shape {
    /// Up and down once.
    Triangle { low: f64, high: f64 },
    /// Frequency in Hz.
    Sine { middle: f64, amplitude: f64, frequency: f64 },
    /// From low to high and back, each held for as many seconds.
    Steps { low: f64, high: f64, hold: f64 },
    /// Sines of random phases between two frequencies in Hz.
    Band { low: f64, high: f64, from: f64, to: f64 },
    /// At rest.
    Hold { level: f64 },
}

impl Shape {
    /// Values at times since the start \[s\] of a programme that lasts for `length` seconds.
    fn course(self, times: &[f64], length: f64) -> Vec<f64> {
        let at = |of: &dyn Fn(f64) -> f64| times.iter().map(|t| of(*t)).collect::<Vec<f64>>();
        match self {
            Self::Triangle { low, high } => {
                at(&|t| low + (high - low) * (1.0 - (2.0 * t / length - 1.0).abs()))
            }
            Self::Sine { middle, amplitude, frequency } => {
                at(&|t| middle + amplitude * (2.0 * PI * frequency * t).sin())
            }
            // a step belongs to the point at which it is due, whatever rounding says
            Self::Steps { low, high, hold } => {
                at(&|t| if ((t / hold + 1e-6) as u64).is_multiple_of(2) { low } else { high })
            }
            Self::Band { low, high, from, to } => {
                let mut random = SplitMix64::new(7);
                let phases: Vec<f64> =
                    (0..LINES).map(|_| 2.0 * PI * random.bits() as f64 / u64::MAX as f64).collect();
                let wave = |t: f64| -> f64 {
                    let line = |(i, phase): (usize, &f64)| {
                        let frequency = from + (to - from) * i as f64 / (LINES - 1) as f64;
                        (2.0 * PI * frequency * t + phase).sin()
                    };
                    phases.iter().enumerate().map(line).sum()
                };
                let raw = at(&wave);
                let most = raw.iter().fold(f64::MIN_POSITIVE, |most, v| v.abs().max(most));
                raw.iter().map(|v| 0.5 * (low + high) + 0.5 * (high - low) * v / most).collect()
            }
            Self::Hold { level } => vec![level; times.len()],
        }
    }

    fn words(self, input: &Input<'_>) -> String {
        let (name, with) = (&input.info.name, |value: f64| input.with_unit(value));
        match self {
            Self::Triangle { low, high } => {
                format!("slow triangle of {name} from {} to {} and back", with(low), with(high))
            }
            Self::Sine { middle, amplitude, frequency } => {
                let about = if middle.abs() > 1e-9 * amplitude.abs() {
                    format!(" about {}", with(middle))
                } else {
                    String::new()
                };
                format!("sine of {name}, amplitude {}{about}, {} Hz", with(amplitude), number(frequency))
            }
            Self::Steps { low, high, hold } => format!(
                "steps of {name} between {} and {}, each held for {} s",
                with(low),
                with(high),
                number(hold)
            ),
            Self::Band { low, high, from, to } => format!(
                "random course of {name} between {} and {}, {} to {} Hz",
                with(low),
                with(high),
                number(from),
                number(to)
            ),
            Self::Hold { level } => format!("{name} held at {} for long", with(level)),
        }
    }
}

/// What part an input has in the programmes.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Part {
    /// It is moved or held.
    Free,
    /// It can only be held: no real number.
    Held,
    /// It counts on, as a travelled distance does, at this rate per second.
    Counts(f64),
    /// It is the rate of another one, which has this place among the inputs.
    RateOf(usize),
}

/// What the recordings covered of an input.
struct Input<'a> {
    info: &'a VariableInfo,
    variable: usize,
    low: f64,
    high: f64,
    /// The median of all runs.
    typical: f64,
    /// Root mean square frequency of its movement \[Hz\]; for a sine its frequency.
    frequency: f64,
    /// It moved during a run, not only from run to run.
    moves: bool,
    part: Part,
}

impl Input<'_> {
    fn with_unit(&self, value: f64) -> String {
        let unit = self.info.unit.as_deref().filter(|u| *u != "1").unwrap_or_default();
        format!("{} {unit}", number(value)).trim_end().to_owned()
    }

    /// The range that is `LARGER` than the recorded one, if the variable takes it. What never changed its sign
    /// (a load, a pressure) keeps it.
    fn larger(&self) -> Option<(f64, f64)> {
        let more = 0.5 * (LARGER - 1.0) * (self.high - self.low);
        let (mut low, mut high) = (self.low - more, self.high + more);
        if self.low >= 0.0 && low < 0.0 {
            (low, high) = (self.low, self.high + 2.0 * more);
        } else if self.high <= 0.0 && high > 0.0 {
            (low, high) = (self.low - 2.0 * more, self.high);
        }
        let fits = self.info.min.is_none_or(|min| low >= min) && self.info.max.is_none_or(|max| high <= max);
        fits.then_some((low, high))
    }
}

/// What the runs covered of each input that they drive.
fn cover<'a>(interface: &'a Interface, roles: &Roles, runs: &[&Run]) -> Vec<Input<'a>> {
    let all = runs.iter().flat_map(|run| run.drive.inputs.iter().map(|(v, _)| *v));
    let variables: std::collections::BTreeSet<usize> = all.collect();
    let courses = |variable: usize| {
        runs.iter().filter_map(move |run| {
            let values = &run.drive.inputs.iter().find(|(v, _)| *v == variable)?.1;
            (!values.is_empty()).then_some((&values[..], run.drive.step))
        })
    };
    let mut inputs = Vec::new();
    for variable in variables {
        let Some(info) = interface.variables.get(variable) else { continue };
        let mut pooled: Vec<f64> = courses(variable).flat_map(|(v, _)| v).copied().collect();
        pooled.retain(|v| v.is_finite());
        pooled.sort_by(f64::total_cmp);
        let (Some(low), Some(high)) = (pooled.first().copied(), pooled.last().copied()) else { continue };
        // levels that somebody can read and set, within what was recorded
        let unit = 0.01 * 10.0_f64.powf((high - low).log10().floor());
        let level =
            |value: f64, round: fn(f64) -> f64| if unit > 0.0 { unit * round(value / unit) } else { value };
        let (low, high) = (level(low, |v| (v - 1e-6).ceil()), level(high, |v| (v + 1e-6).floor()));
        let typical = level(median(&pooled), f64::round).clamp(low, high.max(low));
        let (mut fast, mut square, mut rates) = (0.0, 0.0, Vec::new());
        for (values, step) in courses(variable) {
            square += about_mean(values);
            fast += values.windows(2).map(|w| ((w[1] - w[0]) / step).powi(2)).sum::<f64>();
            rates.push((values[values.len() - 1] - values[0]) / (step * (values.len() - 1).max(1) as f64));
        }
        let counts = [Role::TravelDistance, Role::WheelAngle].iter().any(|role| roles.is(variable, *role));
        let moves = square > (1e-6 * (high - low)).powi(2) * pooled.len() as f64 && square > 0.0;
        inputs.push(Input {
            info,
            variable,
            low,
            high,
            typical,
            frequency: if moves { (fast / square).sqrt() / (2.0 * PI) } else { 0.0 },
            moves,
            part: match () {
                () if counts => Part::Counts(median(&rates)),
                () if info.is_real() => Part::Free,
                () => Part::Held,
            },
        });
    }
    // a velocity that is driven beside its position goes with it
    for b in 0..inputs.len() {
        let leads = |a: &usize| {
            let mut pairs = runs.iter().filter_map(|run| {
                let course = |i: usize| run.drive.inputs.iter().find(|(v, _)| *v == inputs[i].variable);
                Some((slope(&course(*a)?.1, run.drive.step), &course(b)?.1))
            });
            let is_rate = |(rate, own): (Vec<f64>, &Vec<f64>)| {
                let off: f64 = rate.iter().zip(own).map(|(r, v)| (r - v).powi(2)).sum();
                off <= SAME * own.iter().map(|v| v * v).sum::<f64>()
            };
            *a != b && inputs[*a].moves && pairs.all(is_rate)
        };
        if inputs[b].moves && inputs[b].part == Part::Free {
            let leader =
                (0..inputs.len()).filter(|a| !matches!(inputs[*a].part, Part::RateOf(_))).find(leads);
            inputs[b].part = leader.map_or(Part::Free, Part::RateOf);
        }
    }
    inputs
}

/// Rates of change per second, by central differences.
fn slope(values: &[f64], step: f64) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    let at = |k: usize| {
        let (before, after) = (k.saturating_sub(1), (k + 1).min(last));
        (values[after] - values[before]) / (step * (after - before).max(1) as f64)
    };
    (0..values.len()).map(at).collect()
}

/// To two digits: nobody sets a rig to more.
pub(super) fn rounded(value: f64) -> f64 {
    let unit = 10.0_f64.powf(value.log10().floor() - 1.0);
    let rounded = (value / unit).round() * unit;
    if rounded.is_finite() && rounded > 0.0 { rounded } else { value }
}

/// A programme that is to be made.
struct Wish {
    /// Those with small numbers come first.
    rank: u8,
    /// Place of the moved input.
    moved: usize,
    shape: Shape,
    /// How long it takes \[s\].
    length: f64,
    /// Another input that is not held where it usually is: place and level.
    second: Option<(usize, f64)>,
}

/// The programmes, those first that separate most as a rule.
pub(super) fn library(interface: &Interface, roles: &Roles, runs: &[&Run]) -> Vec<Programme> {
    let Some(first) = runs.first() else { return Vec::new() };
    let (start, step) = (first.drive.start, first.drive.step);
    let lengths: Vec<f64> = runs.iter().map(|r| r.drive.length()).collect();
    let run = median(&lengths);
    let intervals = first.time.windows(2).map(|w| w[1] - w[0]).filter(|d| *d > 0.0);
    let highest = HIGHEST / intervals.fold(f64::INFINITY, f64::min).max(step);
    if !(run > 0.0 && step > 0.0 && highest * run > 1.0) {
        return Vec::new();
    }
    let inputs = cover(interface, roles, runs);
    let any_moves = inputs.iter().any(|i| i.moves);
    let movable = |i: &Input<'_>| i.part == Part::Free && i.high > i.low && (i.moves || !any_moves);

    let mut wanted: Vec<Wish> = Vec::new();
    for (i, input) in inputs.iter().enumerate().filter(|(_, input)| movable(input)) {
        let (low, high) = (input.low, input.high);
        let within = |f: f64| rounded(f.clamp(1.0 / run, highest));
        let usual = within(input.frequency.max(2.0 / run));
        let (slow, fast) = (within(BELOW * usual), within(ABOVE * usual));
        let lasts = |f: f64| (PERIODS / f).min(run);
        let sine = |(low, high): (f64, f64), share: f64, frequency: f64| Shape::Sine {
            middle: 0.5 * (low + high),
            amplitude: 0.5 * share * (high - low),
            frequency,
        };
        let steps = |hold: f64| Shape::Steps { low, high, hold };
        let mut put = |rank, shape, length| wanted.push(Wish { rank, moved: i, shape, length, second: None });
        put(0, sine((low, high), 1.0, usual), lasts(usual));
        put(1, steps(rounded(0.25 * run)), run);
        put(4, sine((low, high), 0.5, usual), lasts(usual));
        put(5, Shape::Triangle { low, high }, run);
        put(6, Shape::Hold { level: high }, LONG * run);
        put(9, Shape::Band { low, high, from: slow, to: fast }, run);
        if usual > 3.0 / run {
            put(10, steps(rounded(0.5 / usual)), lasts(usual));
        }
        for (frequency, rank) in [(fast, 2), (slow, 7)] {
            // only if it is another one
            if (frequency / usual).ln().abs() > 0.3 {
                put(rank, sine((low, high), 1.0, frequency), lasts(frequency));
                put(11, sine((low, high), 0.5, frequency), lasts(frequency));
            }
        }
        if let Some(larger) = input.larger() {
            put(8, sine(larger, 1.0, usual), lasts(usual));
            put(11, sine(larger, 1.0, slow), lasts(slow));
            put(11, sine(larger, 1.0, fast), lasts(fast));
        }
        for (j, other) in inputs.iter().enumerate() {
            let can = matches!(other.part, Part::Free | Part::Held) && j != i;
            for level in [other.low, other.high].into_iter().filter(|level| can && *level != other.typical) {
                let second = Some((j, level));
                for (rank, shape, length) in [
                    (3, sine((low, high), 1.0, usual), lasts(usual)),
                    (12, sine((low, high), 1.0, fast), lasts(fast)),
                    (12, steps(rounded(0.25 * run)), run),
                ] {
                    wanted.push(Wish { rank, moved: i, shape, length, second });
                }
            }
        }
    }
    wanted.sort_by_key(|w| w.rank);
    let make = |wish: &Wish| {
        let points = (wish.length / step).round() + 1.0;
        (points <= MAX_POINTS).then(|| programme(&inputs, (start, step, points as usize), wish))
    };
    wanted.iter().filter_map(make).collect()
}

/// One programme on a grid of communication points: start, step and number.
fn programme(
    inputs: &[Input<'_>],
    (start, step, points): (f64, f64, usize),
    &Wish { moved, shape, second, .. }: &Wish,
) -> Programme {
    let times: Vec<f64> = (0..points).map(|k| k as f64 * step).collect();
    let length = times.last().copied().unwrap_or_default();
    let level = |i: usize| second.filter(|s| s.0 == i).map_or(inputs[i].typical, |s| s.1);
    let mut courses: Vec<Vec<f64>> = Vec::new();
    let (mut told, mut untold) = (Vec::new(), false);
    for (i, input) in inputs.iter().enumerate() {
        if i == moved {
            courses.push(shape.course(&times, length));
            continue;
        }
        let is_second = second.is_some_and(|s| s.0 == i);
        match input.part {
            Part::Counts(rate) => {
                courses.push(times.iter().map(|t| input.low + rate * t).collect());
                told.push(format!("{} running at {} per s", input.info.name, input.with_unit(rate)));
            }
            // below, when what it follows is there
            Part::RateOf(_) => courses.push(Vec::new()),
            Part::Free | Part::Held => {
                courses.push(vec![level(i); points]);
                if is_second || told.len() < TOLD {
                    told.push(format!("{} held at {}", input.info.name, input.with_unit(level(i))));
                } else {
                    untold = true;
                }
            }
        }
    }
    for (i, input) in inputs.iter().enumerate() {
        if let Part::RateOf(leader) = input.part {
            courses[i] = slope(&courses[leader], step);
        }
    }
    if untold {
        told.push("all else held at its median".into());
    }
    let words = std::iter::once(shape.words(&inputs[moved])).chain(told);
    let words = words.chain(std::iter::once(format!("{} s", number(length)))).collect::<Vec<_>>().join(", ");
    let range = &courses[moved];
    let slack = 1e-9 * (inputs[moved].high - inputs[moved].low);
    let beyond = range.iter().any(|v| *v > inputs[moved].high + slack || *v < inputs[moved].low - slack);
    let driven = inputs.iter().map(|i| i.variable).zip(courses).collect();
    Programme { words, drive: Arc::new(Drive::new(start, step, points, driven)), beyond }
}
