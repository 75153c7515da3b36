//! Faults that the values of one channel show by themselves: rails, frozen values, spikes, coarse steps.

use super::{Fault, FaultKind, Severity, short};
use crate::diagnose::numbers::RESOLUTION;
use crate::recording::{Channel, Recording};
use crate::stats::{amplitude, mean_or_zero, noise, quantile};

/// A channel whose noise is below this share of its amplitude is a command or a computed value: commands
/// hold values and jump, and that is no fault.
const ROUGH: f64 = 3e-5;
/// A sample that is more standard deviations of noise inside of a rail is there whatever its noise.
const CERTAIN: f64 = 3.0;
/// Samples on each side that tell where a signal is without its noise.
const AROUND: usize = 2;
/// Equal samples in a row that make a flat stretch.
const FLAT: usize = 6;
/// Samples at a rail, in all, that make saturation.
const AT_RAIL: usize = 8;
/// What a rail is, which recordings alone do not tell, and what to do.
const RAIL: &str = "the sensor or amplifier is at its rail, or what it measures cannot go farther (an end stop, a tank that runs over)";
pub(crate) const RAIL_ADVICE: &str =
    "If it is the sensor's, repeat with a larger range; if the machine's, put it into the model";
/// How often a value has to be there over the values just inside of it, and how many of those are looked at.
const PILED: usize = 4;
const INSIDE: usize = 6;
/// By how many quantisation steps (and standard deviations of noise) a signal has to fall on both sides of
/// a flat stretch, within half the stretch's length. A smooth peak falls by 4 steps at most, whatever its
/// curvature, if the quantisation made it flat.
const FALL: f64 = 10.0;
/// Samples in a row that may be stuck.
const STUCK: usize = 25;
/// By how many times the longest flat stretch that the channel has otherwise.
const LONGER: f64 = 4.0;
/// Noise of so many quantisation steps moves a value that rests.
const NOISY: f64 = 2.0;
/// A jump is so many times the largest of so many steps after it: a motion that begins takes longer steps later.
const JUMP: f64 = 2.0;
const AFTER: usize = 8;
/// The share of the way in the second half of so many steps that is nearer to half of it than to a quarter.
const AT_FULL_MOTION: f64 = 0.375;
/// Most samples of a spike.
const SPIKE: usize = 3;
/// How far a spike is, in the largest steps between samples around it.
const FAR: f64 = 8.0;

/// What one channel is like.
struct Look<'a> {
    time: &'a [f64],
    values: &'a [f64],
    /// Half its range.
    amplitude: f64,
    /// Standard deviation of its noise.
    noise: f64,
    /// Quantisation step, 0 if there is none.
    step: f64,
    /// Stretches of equal samples: first index and one past the last.
    flats: Vec<(usize, usize)>,
}

impl<'a> Look<'a> {
    fn new(time: &'a [f64], values: &'a [f64]) -> Self {
        let mut flats = Vec::new();
        let mut begin = 0;
        for i in 1..=values.len() {
            if i == values.len() || values[i] != values[begin] {
                if i - begin >= FLAT {
                    flats.push((begin, i));
                }
                begin = i;
            }
        }
        let step = step(values);
        Self { time, values, amplitude: amplitude(values), noise: noise(time, values), step, flats }
    }

    /// True if the channel has the noise that a measured one has.
    fn measured(&self) -> bool {
        // what moves by less than its numbers tell is a constant that was computed
        let size = self.values.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        self.amplitude > RESOLUTION * size && self.noise > ROUGH * self.amplitude
    }

    fn near_zero(&self, value: f64) -> bool {
        value.abs() <= 2.0 * self.step + 1e-3 * self.amplitude
    }

    /// How far the signal is from a flat stretch's value half its length before and after it.
    fn falls(&self, (begin, end): (usize, usize)) -> (Option<f64>, Option<f64>) {
        let half = (end - begin).div_ceil(2);
        let at =
            |i: Option<usize>| i.and_then(|i| self.values.get(i)).map(|v| (v - self.values[begin]).abs());
        (at(begin.checked_sub(half)), at(Some(end - 1 + half)))
    }

    /// Whether a flat stretch ends in a jump. A sensor that sends again jumps to where the machine is by then; a machine that
    /// was held by friction goes on from where it is.
    fn jumps_after(&self, (_, end): (usize, usize)) -> bool {
        let Some(next) = self.values.get(end) else { return false };
        let later = end..(end + AFTER).min(self.values.len() - 1);
        let steps = later.map(|i| (self.values[i + 1] - self.values[i]).abs()).fold(0.0, f64::max);
        (next - self.values[end - 1]).abs() > JUMP * steps.max(self.noise).max(self.step)
    }

    /// Whether a flat stretch that lasts to the end, where nobody sees it jump, begins at full motion. What friction holds slows down
    /// before: with an even deceleration half of the time takes a quarter of the way, and no more than that.
    fn stops_dead(&self, (begin, end): (usize, usize)) -> bool {
        let (Some(first), true) = (begin.checked_sub(AFTER), end == self.values.len()) else { return false };
        let way = |from: usize| self.values[begin] - self.values[from];
        way(first).abs() > self.clear() && way(begin - AFTER / 2) / way(first) > AT_FULL_MOTION
    }

    fn clear(&self) -> f64 {
        FALL * self.step.max(self.noise)
    }
}

/// The quantisation step: what all differences between neighbouring levels are multiples of; 0 if there is
/// no such step.
fn step(values: &[f64]) -> f64 {
    let mut levels: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    levels.sort_unstable_by(f64::total_cmp);
    levels.dedup();
    if levels.len() < 4 {
        return 0.0;
    }
    let gaps: Vec<f64> = levels.windows(2).map(|w| w[1] - w[0]).collect();
    let whole = levels[levels.len() - 1].abs().max(levels[0].abs());
    // levels that differ by rounding only are one
    let real: Vec<f64> = gaps.into_iter().filter(|g| *g > 1e-12 * whole).collect();
    let smallest = quantile(&real, 0.0);
    let multiples = real.iter().filter(|g| ((*g / smallest) - (*g / smallest).round()).abs() < 0.02).count();
    // a continuous signal's smallest gap is one of many sizes, and tiny beside the others
    if multiples as f64 > 0.95 * real.len() as f64 && smallest * 20.0 > quantile(&real, 0.5) {
        smallest
    } else {
        0.0
    }
}

/// What [`faults_of_values`] finds.
pub struct Found {
    /// The faults; the runs are left to the caller.
    pub faults: Vec<Fault>,
    /// Rows with spikes.
    pub spikes: Vec<usize>,
}

/// Looks at every channel of a recording whose times increase.
pub fn faults_of_values(recording: &Recording) -> Found {
    let mut found = Found { faults: Vec::new(), spikes: Vec::new() };
    if recording.time.len() < 3 * STUCK {
        return found;
    }
    let looks: Vec<Look> = recording.channels.iter().map(|c| Look::new(&recording.time, &c.values)).collect();
    for (i, (channel, look)) in recording.channels.iter().zip(&looks).enumerate() {
        let stuck = stuck(channel, look, &looks, i);
        if stuck.is_none() {
            found.faults.extend(saturated(channel, look));
        }
        found.faults.extend(stuck);
        found.faults.extend(coarse(channel, look));
        if let Some((fault, rows)) = spikes(channel, look, &looks, i) {
            found.faults.push(fault);
            found.spikes.extend(rows);
        }
    }
    found.spikes.sort_unstable();
    found.spikes.dedup();
    found
}

fn fault(kind: FaultKind, severity: Severity, channel: &Channel, value: f64, unit: &str) -> Fault {
    Fault {
        kind,
        severity,
        runs: Vec::new(),
        channel: Some(channel.name.clone()),
        span: None,
        value,
        unit: unit.into(),
        evidence: String::new(),
        advice: String::new(),
    }
}

/// Flat at the channel's own highest or lowest value, again and again or for long, and nowhere else; or
/// there so often that noise would have carried it beyond.
fn saturated(channel: &Channel, look: &Look) -> Vec<Fault> {
    if !look.measured() {
        return Vec::new();
    }
    let ends = [quantile(look.values, 1.0), quantile(look.values, 0.0)];
    let of = |rail: f64| {
        // zero is where physics ends: no contact, standstill, no pressure
        if look.near_zero(rail) {
            return None;
        }
        let flats: Vec<_> = look
            .flats
            .iter()
            .filter(|f| look.values[f.0] == rail)
            .filter(|f| match look.falls(**f) {
                (Some(a), Some(b)) => a.min(b) > look.clear(),
                (Some(a), None) | (None, Some(a)) => a > look.clear(),
                (None, None) => false,
            })
            .collect();
        // a channel that is flat between its ends, too, is a command or a coarse one, or rests there; an amplifier has a rail
        // at either end
        let elsewhere = look.flats.iter().filter(|f| !ends.contains(&look.values[f.0]));
        let elsewhere: usize = elsewhere.map(|(a, b)| b - a).sum();
        let rests = |samples: usize| elsewhere * 4 > samples;
        if let Some((samples, fault)) = piled(channel, look, rail) {
            return (!rests(samples)).then_some(fault);
        }
        let (first, last) = (flats.first()?, flats.last()?);
        let samples: usize = flats.iter().map(|(a, b)| b - a).sum();
        if samples < AT_RAIL || rests(samples) {
            return None;
        }
        Some(Fault {
            span: Some((look.time[first.0], look.time[last.1 - 1])),
            evidence: format!(
                "{} is exactly {} {} in {} stretch(es) of together {samples} samples and never beyond, though \
                 it comes and goes by {} {} and has noise of {} {} elsewhere: {RAIL}.",
                channel.name,
                short(rail),
                channel.unit,
                flats.len(),
                short(look.clear()),
                channel.unit,
                short(look.noise),
                channel.unit
            ),
            advice: format!("{RAIL_ADVICE}. Until then leave these stretches out."),
            ..fault(FaultKind::Saturated, Severity::Fatal, channel, rail, &channel.unit)
        })
    };
    ends.into_iter().filter_map(of).collect()
}

/// The rows in which a channel is at a rail or would be there with a little more noise: of what comes near a rail those samples
/// alone are below it whose noise happens to be.
pub fn at_rail(time: &[f64], values: &[f64], rail: f64) -> Vec<bool> {
    let look = Look::new(time, values);
    let near = CERTAIN * look.noise.max(look.step);
    let is_near = |row: usize| {
        let around = &values[row.saturating_sub(AROUND)..(row + AROUND + 1).min(values.len())];
        values[row] == rail || (mean_or_zero(around) - rail).abs() < near
    };
    (0..values.len()).map(is_near).collect()
}

/// Much more often at one extreme value than at the ones just inside of it, though the noise is as large as
/// the distance between them; and in how many samples.
fn piled(channel: &Channel, look: &Look, rail: f64) -> Option<(usize, Fault)> {
    if look.noise < 0.5 * look.step || look.amplitude < look.clear() {
        return None;
    }
    let at = |i: usize| look.values[i] == rail;
    let rows: Vec<usize> = (0..look.values.len()).filter(|i| at(*i)).collect();
    let width = look.step.max(0.3 * look.noise);
    let mut inside = [0; INSIDE];
    for value in look.values.iter().filter(|v| **v != rail) {
        let place = ((value - rail).abs() / width - 0.5).max(0.0) as usize;
        if let Some(count) = inside.get_mut(place) {
            *count += 1;
        }
    }
    let most = inside.into_iter().max().unwrap_or(0).max(1);
    if rows.len() < AT_RAIL || rows.len() < PILED * most {
        return None;
    }
    let fault = Fault {
        span: Some((look.time[*rows.first()?], look.time[*rows.last()?])),
        evidence: format!(
            "{} is exactly {} {} in {} samples and never beyond, though values just inside of that are there in at \
             most {most} each and its noise is {} {}: {RAIL}.",
            channel.name,
            short(rail),
            channel.unit,
            rows.len(),
            short(look.noise),
            channel.unit
        ),
        advice: format!("{RAIL_ADVICE}. Until then leave these stretches out."),
        ..fault(FaultKind::Saturated, Severity::Fatal, channel, rail, &channel.unit)
    };
    Some((rows.len(), fault))
}

/// Constant to the last digit for long, though it has noise elsewhere and other channels go on moving.
fn stuck(channel: &Channel, look: &Look, all: &[Look], own: usize) -> Option<Fault> {
    if !look.measured() {
        return None;
    }
    let longest = *look.flats.iter().max_by_key(|(a, b)| b - a)?;
    let (begin, end) = longest;
    let length = end - begin;
    let value = look.values[begin];
    let others: Vec<usize> = look.flats.iter().filter(|f| **f != longest).map(|(a, b)| b - a).collect();
    let usual = others.iter().copied().max().unwrap_or(1);
    // zero is where physics rests; a short stretch at a rail is saturation's business
    let rail = value == quantile(look.values, 1.0) || value == quantile(look.values, 0.0);
    let at_rail = rail && length < look.values.len() / 10;
    if length < STUCK || at_rail || look.near_zero(value) || (length as f64) < LONGER * usual as f64 {
        return None;
    }
    // with noise of several steps the chance of so many equal ones is nil; else what stays may as well be a machine at rest
    let is_noisy = look.step > 0.0 && look.noise > NOISY * look.step;
    if !is_noisy && !look.jumps_after(longest) && (rail || !look.stops_dead(longest)) {
        return None;
    }
    let moving = all.iter().enumerate().any(|(i, other)| {
        i != own && other.amplitude > 0.0 && {
            let part = &other.values[begin..end];
            amplitude(part) > 0.2 * other.amplitude
        }
    });
    moving.then(|| Fault {
        span: Some((look.time[begin], look.time[end - 1])),
        evidence: format!(
            "{} is exactly {} {} for {length} samples while other channels move; elsewhere it has noise of {} {}.",
            channel.name,
            short(value),
            channel.unit,
            short(look.noise),
            channel.unit
        ),
        advice: "Look for a sensor or bus that stopped sending; leave this stretch of the run out.".into(),
        ..fault(FaultKind::Stuck, Severity::Fatal, channel, look.time[end - 1] - look.time[begin], "s")
    })
}

/// One to three samples far away, with the channel unmoved before and after, and nothing to see in others.
fn spikes(channel: &Channel, look: &Look, all: &[Look], own: usize) -> Option<(Fault, Vec<usize>)> {
    if !look.measured() {
        return None;
    }
    let mut rows = Vec::new();
    let mut count = 0;
    let mut size: f64 = 0.0;
    let mut i = 1;
    while i + SPIKE + 1 < look.values.len() {
        let Some((length, far)) = spike(look, i) else {
            i += 1;
            continue;
        };
        let echo = all.iter().enumerate().any(|(k, other)| {
            k != own && other.measured() && {
                // what the others do at that moment, against their own habit around it
                let step = |j: usize| (other.values[j + 1] - other.values[j]).abs();
                let range = i.saturating_sub(20)..(i + length + 20).min(other.values.len() - 1);
                let now = (i - 1..i + length).map(step).fold(0.0, f64::max);
                let around =
                    range.filter(|j| !(i - 1..i + length + 2).contains(j)).map(step).fold(0.0, f64::max);
                now > 3.0 * around && spike(other, i).is_none()
            }
        });
        if !echo {
            count += 1;
            size = size.max(far);
            rows.extend(i..i + length);
        }
        i += length;
    }
    let (&first, &last) = (rows.first()?, rows.last()?);
    let fault = Fault {
        span: Some((look.time[first], look.time[last])),
        evidence: format!(
            "{} leaves its course {count} time(s) for 1 to {SPIKE} samples by up to {} {} and is back as if \
             nothing had been (noise {} {}; no echo in other channels).",
            channel.name,
            short(size),
            channel.unit,
            short(look.noise),
            channel.unit
        ),
        advice: "The rows were left out; look for loose contacts and lost messages.".into(),
        ..fault(FaultKind::Spikes, Severity::Repaired, channel, count as f64, "1")
    };
    Some((fault, rows))
}

/// Length and size of the spike that begins at sample `i`.
fn spike(look: &Look, i: usize) -> Option<(usize, f64)> {
    let values = look.values;
    let jump = (values[i] - values[i - 1]).abs();
    if jump < FAR * look.noise.max(look.step) || jump < 0.1 * look.amplitude {
        return None;
    }
    let length = (1..=SPIKE)
        .find(|n| values.get(i + n).is_some_and(|back| (back - values[i - 1]).abs() < 0.3 * jump))?;
    let after = values[i + length];
    let far = (i..i + length)
        .map(|j| {
            let share = (j - i + 1) as f64 / (length + 1) as f64;
            (values[j] - values[i - 1] * (1.0 - share) - after * share).abs()
        })
        .fold(f64::INFINITY, f64::min);
    let step = |j: usize| (values[j + 1] - values[j]).abs();
    let around = |range: std::ops::Range<usize>| {
        let mut steps: Vec<f64> = range.map(step).collect();
        // another spike among them is not counted
        steps.sort_unstable_by(f64::total_cmp);
        steps.len().checked_sub(3).map_or(f64::INFINITY, |k| steps[k])
    };
    let before = around(i.saturating_sub(16)..i - 1);
    let behind = around(i + length..(i + length + 16).min(values.len() - 1));
    // what swings out and back, however fast, is on its way before the jump and after it
    let beside = [i.checked_sub(2), (i + length + 1 < values.len()).then_some(i + length)];
    let beside = beside.into_iter().flatten().map(step).fold(0.0, f64::max);
    let quiet = match (before.is_finite(), behind.is_finite()) {
        (true, true) => before.max(behind),
        _ => before.min(behind),
    };
    let zero = (i..i + length).all(|j| look.near_zero(values[j]));
    let enough = if zero { 0.1 } else { 0.5 } * look.amplitude;
    let quiet = quiet.max(beside);
    (far > FAR * quiet && far > enough && quiet.is_finite()).then_some((length, far))
}

/// Fewer than 32 steps over the channel's amplitude: the step is 1 % of it or more in standard deviation.
fn coarse(channel: &Channel, look: &Look) -> Option<Fault> {
    let steps = look.amplitude / look.step;
    (look.step > 0.0 && look.measured() && steps < 32.0).then(|| Fault {
        evidence: format!(
            "{} comes in steps of {} {}, {} of them to its amplitude.",
            channel.name,
            short(look.step),
            channel.unit,
            short(steps)
        ),
        advice: "Effects below the step cannot be seen; use a smaller range or a finer converter.".into(),
        ..fault(FaultKind::CoarseQuantisation, Severity::Note, channel, look.step, &channel.unit)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sine of 2 Hz with noise, quantised, cut off above `rail`: so fast that it stays there for a few samples.
    fn sine(rail: f64) -> Recording {
        let (mut seed, step) = (7_u64, 5e-3);
        let mut noise = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 40) as f64 / (1_u64 << 24) as f64 - 0.5
        };
        let time: Vec<f64> = (0..800).map(|k| 0.01 * f64::from(k)).collect();
        let value = |t: &f64| {
            let clean = (2.0 * std::f64::consts::TAU * t).sin() + 0.06 * noise();
            (clean.min(rail) / step).round() * step
        };
        let values = time.iter().map(value).collect();
        let channel = Channel { name: "velocity".into(), unit: "m/s".into(), values };
        Recording { time, channels: vec![channel], ..Recording::default() }
    }

    /// Friction holds what turns: it comes to rest where it turns, and goes on from there.
    #[test]
    fn what_friction_holds_is_no_stuck_sensor() {
        let time: Vec<f64> = (0..800).map(|k| 0.01 * f64::from(k)).collect();
        // at rest for 1.2 s at a turning point of a swing; the sensor meanwhile sees nothing, or has nothing to see
        let swing = |t: f64| {
            let phase = if t < 2.5 { t } else { (t - 1.2).max(2.5) };
            (1.0 + 0.1 * phase) * (std::f64::consts::PI * phase).sin()
        };
        let counts = |v: f64| (v * 800.0).round() / 800.0;
        let held: Vec<f64> = time.iter().map(|t| counts(swing(*t))).collect();
        let moving: Vec<f64> = time.iter().map(|t| counts((1.0 + 0.1 * t) * (3.0 * t).sin())).collect();
        let at_rest = |k: usize| (160..280).contains(&k);
        let frozen =
            moving.iter().enumerate().map(|(k, v)| if at_rest(k) { moving[160] } else { *v }).collect();
        let kinds = |values: Vec<f64>| -> Vec<FaultKind> {
            let channel = |name: &str, values| Channel { name: name.into(), unit: "rad".into(), values };
            let channels = vec![channel("angle", values), channel("command", moving.clone())];
            let recording = Recording { time: time.clone(), channels, ..Recording::default() };
            faults_of_values(&recording).faults.iter().map(|f| f.kind).collect()
        };
        assert_eq!(kinds(held), []);
        assert_eq!(kinds(frozen), [FaultKind::Stuck]);
    }

    #[test]
    fn a_rail_shows_in_short_visits() {
        let kinds = |rail: f64| -> Vec<FaultKind> {
            faults_of_values(&sine(rail)).faults.iter().map(|f| f.kind).collect()
        };
        assert_eq!(kinds(2.0), []);
        assert_eq!(kinds(0.95), [FaultKind::Saturated]);
        // the same in the last digits of a constant that was computed
        let mut computed = sine(0.95);
        computed.channels.iter_mut().flat_map(|c| &mut c.values).for_each(|v| *v = -34.0 + 1e-9 * *v);
        assert!(faults_of_values(&computed).faults.is_empty());
    }
}
