//! Decays after impacts: a cleat on a drum hits the tire once a turn, and the rig swings until the next one.
//!
//! Impacts are found by their period, records of the periods are aligned to parts of a sample and averaged, and the average's free part
//! is fitted as a whole, x = zero + A exp(-delta t) cos(w t + phi). Beside it stands the classic envelope: the line through the logarithms of
//! the turns. c_ges = 2 m delta (6-1), k = m (w^2 + delta^2).

use super::laws::{Known, linear, mean_of};
use super::series::Even;
use super::swing::{LEAST_SAMPLES, LEAST_SWINGS, Swing, guess};
use crate::stats::{Line, deviation, mean, quantile, root_mean_square};
use crate::{Error, Result};
use serde::Serialize;
use std::f64::consts::TAU;

/// Share of the first amplitude that may be left when the next impact comes, unless the plan says otherwise: the next
/// one then begins up to a tenth of a radian elsewhere than without, and less than a percent of the energy is the former one's.
pub const MOST_LEFT: f64 = 0.1;
/// Periods that are needed: two give one difference, three the first that can disagree.
const LEAST_PERIODS: usize = 3;
/// Longer series are thinned out by means to about this many samples: an arm that swings with a few hertz is sampled more than
/// finely enough, and alignment takes seconds.
const MOST_SAMPLES: usize = 200_000;
/// Turns that have to stand out, for a line through their logarithms to have an error.
const LEAST_TURNS: usize = 3;
/// A lag is the period if the series repeats after it this well, over the best lag: shorter ones are of the oscillation.
const REPEATS: f64 = 0.9;
/// How well a series has to repeat (correlation) to be periodic at all: half of its power is then noise or something else.
const PERIODIC: f64 = 0.5;
/// Rounds of aligning and averaging: each makes the average sharper, and by the fourth it no longer moves by a tenth of a sample.
const ALIGNMENTS: usize = 4;
/// The impact begins where the average has left its rest by this share of its largest distance.
const ONSET: f64 = 0.05;

/// What is known of the impacts beforehand.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Impacts {
    /// Time between two \[s\].
    pub period: Option<f64>,
    /// How long the cleat is below the tire \[s\].
    pub passage: f64,
    /// Share of the amplitude that may be left at the next impact.
    pub most_left: f64,
}

/// What a decay is made of.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Decay {
    /// Periods that were averaged.
    pub periods: usize,
    /// Time between impacts \[s\].
    pub period: f64,
    /// How much periods differ from their mean: standard deviation \[s\].
    pub jitter: f64,
    /// delta \[1/s\].
    pub decay_rate: Known,
    /// The same by the envelope through the turns.
    pub envelope_rate: Known,
    /// Damped angular frequency \[rad/s\].
    pub frequency: Known,
    /// Amplitude where the free part begins, in the channel's unit.
    pub amplitude: f64,
    /// Amplitude of the envelope there.
    pub envelope_amplitude: f64,
    /// Level about which it swings, in the channel's unit.
    pub zero: f64,
    /// Share of that amplitude that is left when the next impact comes.
    pub left: f64,
    /// Root mean square of what the fit leaves, over the amplitude.
    pub residual: f64,
    /// Time since the onset of the impact \[s\], of the average.
    pub time: Vec<f64>,
    /// The average of the aligned periods.
    pub average: Vec<f64>,
    /// Standard deviation of the periods about it.
    pub scatter: Vec<f64>,
    /// Aligned periods, for a picture.
    #[serde(skip)]
    pub aligned: Vec<Vec<f64>>,
    /// Where the free part begins \[s\].
    pub free_from: f64,
    /// Turns of the free part: time \[s\] and distance from the zero.
    pub turns: Vec<[f64; 2]>,
    /// What a reader has to know.
    pub notes: Vec<String>,
}

impl Decay {
    /// The envelope of the fitted oscillation at a time of [`time`](Self::time), in the channel's unit.
    pub fn envelope_at(&self, time: f64) -> f64 {
        self.amplitude * (-self.decay_rate.value * (time - self.free_from)).exp()
    }
}

/// The decay of a channel.
///
/// # Errors
/// No period, too few of them, an oscillation that is too short or sampled too coarsely, or one that does not die out before the
/// next impact, with how much is left.
pub fn analyse(even: &Even, impacts: Impacts) -> Result<Decay> {
    let all = even.values.first().map(Vec::as_slice).unwrap_or_default();
    let stride = all.len().div_ceil(MOST_SAMPLES).max(1);
    let thin: Vec<f64> = all.chunks_exact(stride).map(mean).collect();
    let values = &thin[..];
    let even = &Even { start: even.start, step: even.step * stride as f64, values: Vec::new() };
    let mut notes = Vec::new();
    let rough = period(values, even.step, impacts.period)?;
    let length = rough.floor() as usize;
    let count = (values.len() as f64 / rough).floor() as usize;
    if count < LEAST_PERIODS + 1 {
        return Err(Error::numeric(format!(
            "{count} periods of {:.3} s are in the recording: {} are needed, one of which is lost at its ends",
            rough * even.step,
            LEAST_PERIODS + 1
        )));
    }
    // windows begin before the largest swing, and so before the impact
    let before = length / 6;
    let first = farthest(&values[..length + 1]);
    let begin = if first >= before { first - before } else { first + length - before };
    let mut starts: Vec<f64> = (0..count)
        .map(|k| begin as f64 + k as f64 * rough)
        .take_while(|s| s + rough + 2.0 < values.len() as f64)
        .collect();
    let mut average = mean_window(values, &starts, length);
    for _ in 0..ALIGNMENTS {
        let count = starts.len();
        for start in &mut starts {
            // without the period itself: its own noise would fit best where it is
            let own = window(values, *start, length);
            let n = count as f64;
            let others: Vec<f64> =
                average.iter().zip(&own).map(|(a, own)| (a * n - own) / (n - 1.0)).collect();
            *start += lag(values, *start, &others, length);
        }
        starts.retain(|s| *s >= 0.0 && s + length as f64 + 1.0 < values.len() as f64);
        if starts.len() < LEAST_PERIODS {
            break;
        }
        average = mean_window(values, &starts, length);
    }
    if starts.len() < LEAST_PERIODS {
        return Err(Error::numeric(format!(
            "{} whole periods of {:.3} s could be aligned: at least {LEAST_PERIODS} are needed",
            starts.len(),
            rough * even.step
        )));
    }
    let number: Vec<f64> = starts.iter().map(|s| ((s - starts[0]) / rough).round()).collect();
    let period = Line::through(&number, &starts).map_or(rough, |line| line.slope);
    let off: Vec<f64> = starts.iter().zip(&number).map(|(s, n)| s - starts[0] - n * period).collect();
    let jitter = deviation(&off) * even.step;
    if jitter > 0.01 * period * even.step {
        notes.push(format!(
            "impacts come unevenly, by {:.1} ms (standard deviation) about a period of {:.1} ms: the drum's speed was not steady",
            1e3 * jitter,
            1e3 * period * even.step
        ));
    }
    let aligned: Vec<Vec<f64>> = starts.iter().map(|s| window(values, *s, length)).collect();
    // rest before the impact, how far it goes, and where it begins
    let (low, high) = (quantile(&average, 0.0), quantile(&average, 1.0));
    let rest = mean(&average[..(before / 2).max(1)]);
    let most = (high - rest).max(rest - low);
    let onset = average.iter().position(|v| (v - rest).abs() > ONSET * most).unwrap_or(before);
    let onset = onset.max(before / 2);
    let passage = (impacts.passage / even.step).ceil() as usize;
    // the largest distance behind that is a turn of what is free
    let last = 2 * length / 3;
    let tail = mean(&average[length - length / 4..]);
    let far = |k: &usize| (average[*k] - tail).abs();
    let from = ((onset + passage).min(last)..=last).max_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(onset);
    let free = &average[from..];
    let start = guess(free, even.step);
    let Some(start) = start else {
        return Err(Error::numeric(format!(
            "after the impact at {:.3} s of the period nothing swings to and fro: there are no two turns about a level",
            (from - onset.min(from)) as f64 * even.step
        )));
    };
    let swing = Swing { values: free, step: even.step };
    let (found, covariance_half, residuals) = swing.fit(start)?;
    let [delta, omega] = found;
    let swings = free.len() as f64 * even.step * omega / TAU;
    if TAU / omega / even.step < LEAST_SAMPLES {
        return Err(Error::numeric(format!(
            "an oscillation of {:.1} Hz has {:.1} samples: at least {LEAST_SAMPLES} are needed",
            omega / TAU,
            TAU / omega / even.step
        )));
    }
    // up to the onset of the next one
    let lasts = (length - (from - onset.min(from))) as f64 * even.step;
    let left = (-delta * lasts).exp();
    if delta <= 0.0 || left > impacts.most_left {
        return Err(Error::numeric(format!(
            "the decay does not die out before the next impact: {:.0} % of its amplitude is left after {:.2} s ({:.2} Hz, decay rate about {:.2} 1/s), and at most {:.0} % may be (most_left). Where more is left, the next impact meets an oscillation whose phase is by chance. Take a slower drum, one cleat in place of several, or a larger drum",
            100.0 * left.min(9.99),
            lasts,
            omega / TAU,
            delta,
            100.0 * impacts.most_left
        )));
    }
    if swings < LEAST_SWINGS {
        return Err(Error::numeric(format!(
            "{swings:.1} oscillations of {:.2} Hz are between the impact and the next one: at least {LEAST_SWINGS} are needed to tell a decay rate",
            omega / TAU
        )));
    }
    let ([zero, cos, sin], _) = swing
        .linear([delta, omega])
        .ok_or_else(|| Error::numeric("the oscillation cannot be told from a level"))?;
    let amplitude = cos.hypot(sin);
    let spread = root_mean_square(residuals);
    // each period by itself, from the same start: what periods scatter
    let each: Vec<[f64; 2]> = aligned
        .iter()
        .filter_map(|period| Swing { values: &period[from..], step: even.step }.fit([delta, omega]).ok())
        .map(|(found, ..)| found)
        .collect();
    let known = |i: usize| {
        let scatter = mean_of(&each.iter().map(|e| e[i]).collect::<Vec<_>>()).half_width;
        let scatter = if scatter.is_finite() { scatter } else { 0.0 };
        Known { value: found[i], half_width: scatter.max(covariance_half[i]) }
    };
    let turns = turns(free, zero, even.step, omega, 3.0 * spread.max(1e-3 * amplitude));
    if turns.len() < LEAST_TURNS {
        return Err(Error::numeric(format!(
            "{} turns stand out of what the fit leaves ({:.2} Hz, decay rate about {delta:.2} 1/s): at least {LEAST_TURNS} are needed to tell a decay. The impacts are too weak for the noise, or the tire is damped so much that it does not swing",
            turns.len(),
            omega / TAU
        )));
    }
    let (envelope_rate, envelope_amplitude) = envelope(&turns, 2.0 * spread);
    let decay_rate = known(0);
    let apart = (envelope_rate.value - delta).abs();
    if apart > 0.05 * delta + decay_rate.half_width + envelope_rate.half_width {
        notes.push(format!(
            "the envelope through the turns decays with {:.3} 1/s and the fitted oscillation with {delta:.3} 1/s: the damping depends on the amplitude, or the zero drifts",
            envelope_rate.value
        ));
    }
    if spread > 0.1 * amplitude {
        notes.push(format!(
            "the fitted oscillation leaves {:.0} % of its amplitude: it is no decay of one frequency (play, two oscillations, a cleat that is still below the tire: cleat_length)",
            100.0 * spread / amplitude
        ));
    }
    let scatter = (0..length).map(|k| deviation(&aligned.iter().map(|p| p[k]).collect::<Vec<_>>()));
    let at = |k: usize| (k as f64 - onset as f64) * even.step;
    let free_from = at(from);
    Ok(Decay {
        periods: starts.len(),
        period: period * even.step,
        jitter,
        decay_rate,
        envelope_rate,
        frequency: known(1),
        amplitude,
        envelope_amplitude,
        zero,
        left,
        residual: spread / amplitude,
        time: (0..length).map(at).collect(),
        scatter: scatter.collect(),
        aligned,
        average,
        free_from,
        turns: turns.into_iter().map(|[t, x]| [t + free_from, x]).collect(),
        notes,
    })
}

/// The period in samples: near the given one, or the shortest lag after which the series repeats as well as after any.
fn period(values: &[f64], step: f64, given: Option<f64>) -> Result<f64> {
    let n = values.len();
    // some thousand samples tell a period to their distance; alignment does the rest
    let stride = (n / 6000).max(1);
    let level = mean(values);
    let thin: Vec<f64> = values.chunks(stride).map(|c| mean(c) - level).collect();
    let m = thin.len();
    let at = |lag: usize| {
        let (a, b) = (&thin[..m - lag], &thin[lag..]);
        let product: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
        let (aa, bb): (f64, f64) = (a.iter().map(|v| v * v).sum(), b.iter().map(|v| v * v).sum());
        product / (aa * bb).sqrt().max(f64::MIN_POSITIVE)
    };
    if let Some(seconds) = given.filter(|s| s / step < LEAST_SAMPLES) {
        return Err(Error::numeric(format!(
            "impacts are said to be {seconds} s apart, which is {:.1} samples: at least {LEAST_SAMPLES} are needed; is impact_period, or drum_circumference over speed, in the right unit?",
            seconds / step
        )));
    }
    // at least two periods have to be there to repeat
    let longest = m / 2;
    let correlation: Vec<f64> = (0..=longest).map(at).collect();
    let (from, to) = match given {
        Some(seconds) => {
            let lag = seconds / step / stride as f64;
            // a drum's speed is known to a few percent
            ((0.95 * lag).floor() as usize, (1.05 * lag).ceil() as usize)
        }
        // behind the first trough
        None => (correlation.iter().position(|c| *c < 0.2).unwrap_or(longest), longest),
    };
    if to > longest {
        return Err(Error::numeric(format!(
            "the recording lasts {:.2} s, and the impacts are said to be {:.2} s apart: at least {} of them are needed",
            n as f64 * step,
            given.unwrap_or_default(),
            LEAST_PERIODS + 1
        )));
    }
    let is_peak = |k: &usize| {
        let c = correlation[*k];
        *k > 0 && c >= correlation[k - 1] && correlation.get(k + 1).is_none_or(|next| c >= *next)
    };
    let best = (from..=to).map(|k| correlation[k]).fold(f64::NEG_INFINITY, f64::max);
    if from >= to || best < PERIODIC {
        return Err(Error::numeric(format!(
            "no impacts that repeat: after no time does the channel come back to itself ({:.0} % at best{}). A recording of several drum turns at a steady speed is needed, or the period is another one",
            100.0 * best.max(0.0),
            given.map_or(String::new(), |p| format!(", near the {p:.3} s that were given"))
        )));
    }
    let found = (from..=to)
        .filter(|k| correlation[*k] >= REPEATS * best)
        .find(is_peak)
        .or_else(|| (from..=to).max_by(|a, b| correlation[*a].total_cmp(&correlation[*b])));
    Ok(found.unwrap_or(to) as f64 * stride as f64)
}

/// Where a series is farthest from its mean.
fn farthest(values: &[f64]) -> usize {
    let level = mean(values);
    let far = |k: &usize| (values[*k] - level).abs();
    (0..values.len()).max_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(0)
}

/// `length` samples from a place between samples on: cubic through four neighbours, straight at the ends.
fn window(values: &[f64], start: f64, length: usize) -> Vec<f64> {
    let (whole, x) = (start.floor() as usize, start - start.floor());
    let at = |k: usize| values[k.min(values.len() - 1)];
    (whole..whole + length)
        .map(|k| match k.checked_sub(1) {
            Some(before) if k + 2 < values.len() => {
                let [a, b, c, d] = [at(before), at(k), at(k + 1), at(k + 2)];
                b + 0.5 * x * (c - a + x * (2.0 * a - 5.0 * b + 4.0 * c - d + x * (3.0 * (b - c) + d - a)))
            }
            _ => at(k) + x * (at(k + 1) - at(k)),
        })
        .collect()
}

fn mean_window(values: &[f64], starts: &[f64], length: usize) -> Vec<f64> {
    let mut sum = vec![0.0; length];
    for start in starts {
        sum.iter_mut().zip(window(values, *start, length)).for_each(|(s, v)| *s += v / starts.len() as f64);
    }
    sum
}

/// By how much a window has to be moved for it to fit a template: the place of the largest cross correlation, to parts of a sample by
/// a parabola.
fn lag(values: &[f64], start: f64, template: &[f64], length: usize) -> f64 {
    let level = mean(template);
    // a fiftieth of a period, the rest of what a rough period is off by
    let most = (length / 50).max(2) as i64;
    let at = |shift: i64| -> f64 {
        let from = start + shift as f64;
        if from < 0.0 || from + length as f64 + 2.0 > values.len() as f64 {
            return f64::NEG_INFINITY;
        }
        let one = window(values, from, length);
        let own = mean(&one);
        let (mut product, mut power) = (0.0, 0.0);
        for (v, t) in one.iter().zip(template) {
            (product, power) = (product + (v - own) * (t - level), power + (v - own).powi(2));
        }
        product / power.sqrt().max(f64::MIN_POSITIVE)
    };
    let all: Vec<f64> = (-most..=most).map(at).collect();
    let Some(best) = (0..all.len()).max_by(|a, b| all[*a].total_cmp(&all[*b])) else { return 0.0 };
    let part = match (best.checked_sub(1).map(|k| all[k]), all.get(best + 1)) {
        (Some(a), Some(c)) if a.is_finite() && c.is_finite() => {
            let bend = a - 2.0 * all[best] + c;
            if bend < 0.0 { 0.5 * (a - c) / bend } else { 0.0 }
        }
        _ => 0.0,
    };
    best as f64 - most as f64 + part
}

/// Turns about the zero that stand out: time since the beginning and distance from the zero, of the parabola around each.
fn turns(free: &[f64], zero: f64, step: f64, omega: f64, least: f64) -> Vec<[f64; 2]> {
    let half = (std::f64::consts::PI / omega / step).round().max(2.0) as usize;
    let side = (half / 8).max(1);
    let mut turns: Vec<[f64; 2]> = Vec::new();
    let mut k = side;
    while k + side < free.len() {
        let around = k.saturating_sub(half / 2)..(k + half / 2 + 1).min(free.len());
        let x = (free[k] - zero).abs();
        let is_top = around
            .clone()
            .all(|i| (free[i] - zero).abs() <= x || (free[i] - zero).signum() != (free[k] - zero).signum());
        if is_top && x > least {
            // least squares parabola through the samples on both sides
            let w = side as f64;
            let (s0, s2) = (2.0 * w + 1.0, w * (w + 1.0) * (2.0 * w + 1.0) / 3.0);
            let s4 = s2 * (3.0 * w * w + 3.0 * w - 1.0) / 5.0;
            let (mut y0, mut y1, mut y2) = (0.0, 0.0, 0.0);
            for i in 0..=2 * side {
                let (u, y) = (i as f64 - w, free[k + i - side] - zero);
                (y0, y1, y2) = (y0 + y, y1 + u * y, y2 + u * u * y);
            }
            let c = (s0 * y2 - s2 * y0) / (s0 * s4 - s2 * s2);
            let (a, b) = ((y0 - c * s2) / s0, y1 / s2);
            let u = if c == 0.0 { 0.0 } else { (-0.5 * b / c).clamp(-w, w) };
            turns.push([(k as f64 + u) * step, a + (b + c * u) * u]);
            k += half / 2;
        }
        k += 1;
    }
    // behind the first that is not half an oscillation after the one before, on the other side, there is noise
    let follows = |w: &[[f64; 2]]| {
        let halves = (w[1][0] - w[0][0]) / (half as f64 * step);
        (0.75..1.25).contains(&halves) && w[0][1] * w[1][1] < 0.0
    };
    let kept = turns.windows(2).take_while(|w| follows(w)).count() + 1;
    turns.truncate(kept);
    turns
}

/// Rate and amplitude at the beginning of the envelope through turns, whose logarithms are known to the noise over their size.
fn envelope(turns: &[[f64; 2]], noise: f64) -> (Known, f64) {
    let time = turns.iter().map(|t| t[0]).collect();
    let log = |t: &[f64; 2]| Known { value: t[1].abs().ln(), half_width: noise / t[1].abs() };
    let logs: Vec<Known> = turns.iter().map(log).collect();
    match linear(&[vec![1.0; turns.len()], time], &logs).as_deref() {
        Some([level, slope]) => (slope.times(-1.0), level.value.exp()),
        _ => (Known { value: f64::NAN, half_width: f64::INFINITY }, f64::NAN),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::SplitMix64;

    /// A damped oscillator that is pushed once a period by a pulse of a half sine, at 1 kHz, by small steps of its own.
    fn made(delta: f64, frequency: f64, period: f64, seconds: f64, noise: f64, jitter: f64) -> Even {
        let mut random = SplitMix64::new(11);
        let (w2, h) = (TAU * frequency, 1e-4);
        let w2 = w2 * w2 + delta * delta;
        let (mut x, mut v) = (0.0, 0.0);
        let mut values = Vec::new();
        let (mut next, passage) = (0.4, 0.05);
        for k in 0..(seconds / h) as usize {
            let t = k as f64 * h;
            if t > next + passage {
                next += period + jitter * random.normal();
            }
            let push =
                if t > next { 40.0 * (std::f64::consts::PI * (t - next) / passage).sin() } else { 0.0 };
            v += h * (push - w2 * x - 2.0 * delta * v);
            x += h * v;
            if k % 10 == 0 {
                values.push(0.013 + x * 1e-2 + noise * random.normal());
            }
        }
        Even { start: 0.0, step: 1e-3, values: vec![values] }
    }

    const WITH: Impacts = Impacts { period: None, passage: 0.05, most_left: MOST_LEFT };

    #[test]
    fn rate_and_frequency_come_back_from_noisy_impacts() {
        let even = made(1.6, 5.4, 2.0, 40.0, 3e-5, 0.004);
        let found = analyse(&even, WITH).unwrap();
        assert!((17..=20).contains(&found.periods), "{}", found.periods);
        assert!((found.period - 2.0).abs() < 5e-3);
        // a clock that is off by 4 ms each time
        assert!((0.001..0.012).contains(&found.jitter), "{}", found.jitter);
        assert!((found.decay_rate.value / 1.6 - 1.0).abs() < 0.01, "{:?}", found.decay_rate);
        assert!((found.decay_rate.value - 1.6).abs() < 1.5 * found.decay_rate.half_width);
        assert!((found.frequency.value / (TAU * 5.4) - 1.0).abs() < 2e-3, "{:?}", found.frequency);
        assert!((found.envelope_rate.value / 1.6 - 1.0).abs() < 0.05, "{:?}", found.envelope_rate);
        assert!((found.zero - 0.013).abs() < 2e-5);
        assert!(found.notes.is_empty(), "{:?}", found.notes);
        // the same with the period given
        let given = analyse(&even, Impacts { period: Some(2.02), ..WITH }).unwrap();
        assert!((given.decay_rate.value / 1.6 - 1.0).abs() < 0.01);
    }

    #[test]
    fn what_cannot_tell_a_decay_is_refused_with_the_reason() {
        let message = |even: &Even, impacts| analyse(even, impacts).unwrap_err().to_string();
        // 20 % is left after a period of 1 s
        let overlap = message(&made(1.7, 5.4, 1.0, 20.0, 1e-4, 0.0), WITH);
        assert!(
            overlap.contains("does not die out") && overlap.contains("% of its amplitude is left"),
            "{overlap}"
        );
        let percent: f64 = overlap.split(": ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
        assert!((15.0..25.0).contains(&percent), "{overlap}");
        // who allows it gets the rate
        let allowed =
            analyse(&made(1.7, 5.4, 1.0, 20.0, 1e-4, 0.0), Impacts { most_left: 0.3, ..WITH }).unwrap();
        let rate = allowed.decay_rate;
        assert!((rate.value - 1.7).abs() < 1.5 * rate.half_width && rate.share() < 0.06, "{rate:?}");
        let few = message(&made(1.6, 5.4, 2.0, 6.0, 1e-4, 0.0), WITH);
        assert!(few.contains("periods"), "{few}");
        let mut random = SplitMix64::new(4);
        let noise: Vec<f64> = (0..20_000).map(|_| random.normal()).collect();
        let noise = message(&Even { start: 0.0, step: 1e-3, values: vec![noise] }, WITH);
        assert!(noise.contains("no impacts that repeat"), "{noise}");
    }
}
