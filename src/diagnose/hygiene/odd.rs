//! What single runs have and the others do not: an offset, a gain, a delay.
//!
//! Physics that the model lacks differs from run to run, too. It is told apart by five marks, all of
//! which a fault has: less than half of the runs have it; it stands out from the scatter of the others; one
//! number undoes it, so that what is left is as small as in the other runs; both halves of the run say the
//! same number; no operating condition (level, amplitude, frequency of any channel) explains it.

use super::against::Table;
use super::align::{Fit, Pair, bandwidth};
use super::explain::{explained, parted};
use super::unit_sign::mean_agrees;
use super::{Fault, FaultKind, Severity, run_name, short};
use crate::stats::{deviation, mean, median, spread};

/// Fewer runs than this say nothing about what is usual.
const RUNS: usize = 4;
/// Standing out: so many standard deviations of the other runs, and more with few runs.
const SIGMAS: f64 = 6.0;
/// Numbers of several runs that scatter by less than this share of what those of the others do are one: of what physics makes, which has
/// many, a number alone in its place is as rare then as before (14 and 16 false alarms in 1500 cases of the tests).
const SAME: f64 = 0.5;
/// Numbers of two runs are the same if they differ by less than so many standard deviations of those of the others.
const CERTAIN: f64 = 3.0;
/// The smallest gain deviation: parameters that are wrong by a tenth make runs differ by 5 to 10 %.
const GAIN: f64 = 0.1;
/// The smallest offset, as a share of the channel's amplitude in the median run.
const OFFSET: f64 = 0.03;
/// The smallest delay in intervals: stamps of one sample early or late are usual.
const DELAY: f64 = 1.5;
/// What may be left once the number is taken out, against what the run had before.
const UNDONE: f64 = 0.6;
/// And against what the other runs have.
const AS_OTHERS: f64 = 1.6;
/// The halves' numbers over that of the run.
const HALVES: std::ops::Range<f64> = 0.5..1.7;
/// A part of a run in which the simulation moves by less than this share of what it does in the whole run
/// tells no gain and no delay.
const MOVES: f64 = 0.2;

/// A run whose channel moves by less than this share of the median run's tells no gain: a small force that the
/// model lacks looks like a large one.
const WEAK: f64 = 0.3;

/// What may be left of a channel in a run whose simulation tells its gain.
const TOLD: f64 = 0.7;

/// Runs with a spectrum narrower than this are taken as single sines: there a delay is no more than a phase,
/// which a wrong parameter shifts as well.
const NARROW: f64 = 0.35;

/// A delay of about a period or more may be a smaller one that came round: it has to undo nearly all.
const ROUND: f64 = 0.25;

/// Gains over the usual one that are a reversed sign.
const REVERSED: std::ops::Range<f64> = -1.5..-0.6;

#[derive(Debug, Clone, Copy, PartialEq)]
enum What {
    Offset,
    Gain,
    Delay,
}

/// One run beside its simulation, seen with what is usual for all runs.
struct Seen {
    run: usize,
    /// What is left with the usual numbers.
    usual_error: f64,
    /// Measured deviation.
    size: f64,
    /// The offset, gain (over the usual one) and delay that the run would have by itself, and what is left.
    own: [(What, f64, f64); 3],
}

/// Finds what less than half of the runs have, and takes it out of `table`.
pub fn odd_runs(table: &mut Table) -> Vec<Fault> {
    let mut faults = Vec::new();
    for channel in 0..table.channels.len() {
        for fault in odd_in(table, channel) {
            faults.push(fault);
        }
    }
    faults
}

fn odd_in(table: &mut Table, channel: usize) -> Vec<Fault> {
    let pairs: Vec<&Pair> = table.pairs[channel].iter().flatten().collect();
    let fits: Vec<(&Pair, Fit)> =
        pairs.iter().map(|p| (*p, p.best().unwrap_or_else(|| at_rest(p)))).collect();
    if fits.len() < RUNS {
        return Vec::new();
    }
    let told: Vec<bool> = fits.iter().map(|(pair, fit)| fit.error < TOLD * pair.size()).collect();
    let usual = usual(&fits, &told);
    let offsets: Vec<f64> = fits.iter().map(|(p, _)| offset(p, &usual, 0, p.time.len())).collect();
    let usual = Fit { offset: median(&offsets), ..usual };
    let seen: Vec<Seen> = fits.iter().map(|(pair, fit)| look(pair, &usual, fit.delay)).collect();
    let amplitude = median(&fits.iter().map(|(p, _)| p.amplitude()).collect::<Vec<_>>());
    let interval = median(&fits.iter().map(|(p, _)| p.interval()).collect::<Vec<_>>());

    let mut hits: Vec<(What, usize, f64)> = Vec::new();
    // and the scatter of the others
    let mut likely: Vec<((What, usize, f64), f64)> = Vec::new();
    for (i, this) in seen.iter().enumerate() {
        // of a run that hardly moves a gain is as good as an offset, and says nothing
        let of_run = this.own.iter().copied().filter(|o| o.0 == What::Offset || told[i]);
        let Some((what, value, left)) = of_run.min_by(|a, b| a.2.total_cmp(&b.2)) else { continue };
        let others: Vec<&Seen> = seen.iter().enumerate().filter(|(k, _)| *k != i).map(|(_, s)| s).collect();
        let left_others = median(&others.iter().map(|s| s.usual_error).collect::<Vec<_>>());
        let share_others = median(&others.iter().map(|s| s.usual_error / s.size).collect::<Vec<_>>());
        let undone = left < UNDONE * this.usual_error
            && (left < AS_OTHERS * left_others || left < AS_OTHERS * share_others * this.size);
        if !undone {
            continue;
        }
        let of = |s: &Seen| s.own.iter().find(|o| o.0 == what).map_or(0.0, |o| o.1);
        let tells: Vec<usize> = (0..seen.len()).filter(|k| what == What::Offset || told[*k]).collect();
        let Some(odd) = tells.iter().position(|k| *k == i).filter(|_| tells.len() >= RUNS) else { continue };
        let values: Vec<f64> = tells.iter().map(|k| of(&seen[*k])).collect();
        let (least, floor) = match what {
            What::Offset => (OFFSET * amplitude, 0.005 * amplitude),
            What::Gain => (GAIN, 0.005),
            What::Delay => (DELAY * interval, 0.15 * interval),
        };
        let (alike, usual_values) = stands_against(&values, odd, floor);
        let scatter = spread(&usual_values).max(floor);
        let away = value - median(&usual_values);
        // several runs that have the same number have less of it by chance
        let sigmas = SIGMAS * (1.0 + 3.0 / seen.len() as f64) / (alike as f64).sqrt();
        let out = away.abs() > least && away.abs() > sigmas * scatter;
        let pair = fits[i].0;
        let weak = what == What::Gain && pair.amplitude() < WEAK * amplitude;
        // a gain is that of the level, too
        let weak = weak
            || (what == What::Gain
                && value > 0.0
                && !mean_agrees(&pair.measured, pair.simulated, value * usual.gain));
        let phase = what == What::Delay
            && (bandwidth(pair.time, pair.simulated) < NARROW
                || (away.abs() > 0.4 * pair.period() && left > ROUND * this.usual_error));
        let pairs: Vec<&Pair> = tells.iter().map(|k| fits[*k].0).collect();
        if !out {
            continue;
        }
        let is_alone = !phase
            && !weak
            && halves_agree(pair, what, &usual, away)
            && !explained(table, &pairs, &values, odd, &|from, to| part(pair, what, &usual, from, to));
        let hit = (what, this.run, away);
        if is_alone {
            hits.push(hit);
        } else {
            likely.push((hit, scatter));
        }
    }
    // what a run says less clearly by itself it says with another that has the same number
    let is_of = |((what, _, value), scatter): &((What, usize, f64), f64)| {
        hits.iter().any(|h| h.0 == *what && (h.2 - value).abs() < CERTAIN * scatter)
    };
    let more: Vec<(What, usize, f64)> = likely.into_iter().filter(is_of).map(|(hit, _)| hit).collect();
    hits.extend(more);
    hits.sort_by_key(|hit| hit.1);
    // half of the runs are no exception, but a way to measure
    if 2 * hits.len() >= seen.len() {
        return Vec::new();
    }
    let looked_at = seen.len();
    let mut faults = Vec::new();
    for what in [What::Offset, What::Gain, What::Delay] {
        let of: Vec<(usize, f64)> = hits.iter().filter(|h| h.0 == what).map(|h| (h.1, h.2)).collect();
        if !of.is_empty() {
            faults.push(fault(table, channel, what, &of, looked_at));
        }
    }
    for (what, run, value) in hits {
        let Some(pair) = &mut table.pairs[channel][run] else { continue };
        match what {
            What::Offset => pair.measured.iter_mut().for_each(|v| *v -= value),
            What::Gain => pair.measured.iter_mut().for_each(|v| *v /= 1.0 + value),
            // later looks take any delay of a run as it is
            What::Delay => {}
        }
    }
    faults
}

/// Of a run whose simulation does not move: it tells an offset, and no gain or delay.
fn at_rest(pair: &Pair) -> Fit {
    let offset = mean(&pair.measured) - mean(pair.simulated);
    Fit { offset, gain: 1.0, delay: 0.0, error: pair.size() }
}

/// Gain and delay of most runs of which the simulation tells any: noise about a level that hardly changes has none.
fn usual(fits: &[(&Pair, Fit)], told: &[bool]) -> Fit {
    let of = |number: fn(&Fit) -> f64| -> Option<f64> {
        let numbers: Vec<f64> =
            fits.iter().zip(told).filter(|(_, told)| **told).map(|((_, fit), _)| number(fit)).collect();
        (!numbers.is_empty()).then(|| median(&numbers))
    };
    Fit {
        offset: 0.0,
        gain: of(|fit| fit.gain).unwrap_or(1.0),
        delay: of(|fit| fit.delay).unwrap_or(0.0),
        error: 0.0,
    }
}

/// How many runs have the odd one's number, and the numbers of the others, from which it has to stand out. As long as those that are
/// near it are not one number, to within half the scatter of the others, it is alone.
fn stands_against(values: &[f64], odd: usize, floor: f64) -> (usize, Vec<f64>) {
    let (alike, others) = parted(values, odd);
    if deviation(&alike) <= SAME * spread(&others).max(floor) {
        return (alike.len(), others);
    }
    let rest = values.iter().enumerate().filter(|(k, _)| *k != odd).map(|(_, v)| *v);
    (1, rest.collect())
}

/// The mean of what is left with the usual gain and delay.
fn offset(pair: &Pair, usual: &Fit, from: usize, to: usize) -> f64 {
    let (mut sum, mut n) = (0.0, 0.0);
    pair.visit(from, to, usual.delay, pair.reach(), |y, s, _| {
        sum += y - usual.gain * s;
        n += 1.0;
    });
    sum / f64::max(n, 1.0)
}

/// The gain of the whole channel, offset and all, over the usual one.
fn gain(pair: &Pair, usual: &Fit, from: usize, to: usize) -> f64 {
    let (mut yp, mut pp) = (0.0, 0.0);
    pair.visit(from, to, usual.delay, pair.reach(), |y, s, _| {
        let p = usual.offset + usual.gain * s;
        yp += y * p;
        pp += p * p;
    });
    if pp > 0.0 { yp / pp } else { 1.0 }
}

fn look(pair: &Pair, usual: &Fit, own_delay: f64) -> Seen {
    let end = pair.time.len();
    let own_offset = offset(pair, usual, 0, end);
    let own_gain = gain(pair, usual, 0, end);
    Seen {
        run: pair.run,
        usual_error: pair.error(usual.offset, usual.gain, usual.delay),
        size: pair.size(),
        own: [
            (What::Offset, own_offset, pair.error(own_offset, usual.gain, usual.delay)),
            (What::Gain, own_gain, pair.error(own_gain * usual.offset, own_gain * usual.gain, usual.delay)),
            (What::Delay, own_delay, pair.error(usual.offset, usual.gain, own_delay)),
        ],
    }
}

fn delay(pair: &Pair, usual: &Fit, from: usize, to: usize) -> f64 {
    pair.best_in(from, to, pair.reach(), 1.0).map_or(usual.delay, |fit| fit.delay)
}

/// The number of a part of the run. A part at its ends, of which most is not looked at, has none; nor has one
/// in which the simulation hardly moves a gain or a delay.
fn part(pair: &Pair, what: What, usual: &Fit, from: usize, to: usize) -> Option<f64> {
    let (reach, end) = (pair.reach(), pair.time.len() - 1);
    let looked_at = pair.time[0] + reach..=pair.time[end] - reach;
    if 2 * pair.time[from..to].iter().filter(|t| looked_at.contains(*t)).count() < to - from {
        return None;
    }
    let moves = deviation(&pair.simulated[from..to]) > MOVES * deviation(pair.simulated);
    match what {
        What::Offset => Some(offset(pair, usual, from, to)),
        What::Gain => moves.then(|| gain(pair, usual, from, to)),
        What::Delay => moves.then(|| pair.best_in(from, to, pair.reach(), 1.0))?.map(|fit| fit.delay),
    }
}

/// Whether both halves of the run show the deviation.
fn halves_agree(pair: &Pair, what: What, usual: &Fit, away: f64) -> bool {
    let n = pair.time.len();
    [(0, n / 2), (n / 2, n)].into_iter().all(|(from, to)| {
        let half = match what {
            What::Offset => offset(pair, usual, from, to) - usual.offset,
            What::Gain => gain(pair, usual, from, to) - 1.0,
            What::Delay => delay(pair, usual, from, to) - usual.delay,
        };
        HALVES.contains(&(half / away))
    })
}

fn fault(table: &Table, channel: usize, what: What, hits: &[(usize, f64)], looked_at: usize) -> Fault {
    let name = &table.channels[channel];
    let runs: Vec<String> = hits.iter().map(|h| run_name(&table.measured[h.0].source)).collect();
    let value = median(&hits.iter().map(|h| h.1).collect::<Vec<_>>());
    let channel_unit = table.unit(channel);
    let (kind, value, unit, noun, advice) = match what {
        What::Offset => (
            FaultKind::OffsetInSomeRuns,
            value,
            channel_unit,
            "an offset",
            "Zero the sensor and repeat these runs, or subtract the offset.",
        ),
        What::Gain if REVERSED.contains(&(1.0 + value)) => (
            FaultKind::WrongSign,
            1.0 + value,
            "1",
            "a gain",
            "Check the sensor's direction, and reverse the channel in these runs.",
        ),
        What::Gain => (
            FaultKind::GainInSomeRuns,
            100.0 * value,
            "%",
            "a gain error",
            "Check range, supply and calibration of the sensor in these runs, or leave them out.",
        ),
        What::Delay => (
            FaultKind::DelayInSomeRuns,
            value,
            "s",
            "a delay",
            "Check how the loggers were started in these runs, or shift the channel.",
        ),
    };
    Fault {
        kind,
        severity: Severity::Fatal,
        channel: Some(name.clone()),
        span: None,
        value,
        unit: unit.into(),
        evidence: format!(
            "{} of {looked_at} run(s) have {noun} of {} {unit} in {name} that the others do not have, in both \
             halves alike; without it they agree as the others do, and no operating condition goes with it.",
            runs.len(),
            short(value)
        ),
        advice: advice.into(),
        runs,
    }
}
