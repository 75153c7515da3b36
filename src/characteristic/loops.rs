//! Force over deflection as a loop: its cycles, branches, mean curve, area, and what they say of stiffness and damping.
//!
//! At one deflection a damper adds as much while loading as it takes while unloading, if both pass it equally fast: the mean of the
//! branches at equal deflection is the spring. The area of the loop is the work that a cycle loses, dW, and of a harmonic deflection of
//! amplitude e and angular frequency w a viscous damper loses pi w c e^2: c_eq = dW / (pi w e^2). The loss angle is that of a linear
//! material, sin = dW / (pi F e).

use super::laws::{Form, FormFit, Known, fit_form, mean_of};
use super::series::Even;
use crate::stats::{median, quantile};
use crate::{Error, Result};
use serde::Serialize;
use std::f64::consts::{PI, TAU};

/// A turn is one if the deflection then goes back by this share of its whole range: noise and play do not, and cycles of
/// another size are left out anyway.
const BACK: f64 = 0.5;
/// The first and the last sample count as turns where they are this near to the end of the range, as a share of it: a press
/// begins and ends at rest.
const AT_END: f64 = 0.1;
/// Cycles whose turns are elsewhere by this share of the range are no repetition of the others.
const SAME: f64 = 0.1;
/// Samples over which both channels are smoothed alike, each side, as a share of a cycle: a parabola over a tenth of a radian each side
/// is off by 1e-5 of the amplitude.
const WINDOW: f64 = 1.0 / 60.0;
/// That window in samples, at most: a thousand take 97 % of the noise already, and a recording of a million does not take minutes.
const WIDEST: usize = 500;
/// Places along the deflection at which branches are told, at most.
const PLACES: usize = 60;
/// Below this share of the largest force a line through the mean curve tells where the force begins.
const LOW: f64 = 0.08;

/// What a loop is made of.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Loop {
    /// Whole cycles that were used.
    pub cycles: usize,
    /// Time of a cycle \[s\].
    pub period: f64,
    /// Least and largest deflection \[m\].
    pub deflections: [f64; 2],
    /// Least and largest force of the mean curve \[N\].
    pub loads: [f64; 2],
    /// Work that a cycle loses \[J\].
    pub area: Known,
    /// Half the range of the deflection \[m\].
    pub amplitude: f64,
    /// dW / (pi w e^2) \[N.s/m\].
    pub equivalent_damping: Known,
    /// Loss angle \[rad\].
    pub loss_angle: f64,
    /// The branches and their mean.
    pub curve: Curve,
    /// Laws of the mean curve, the closest first.
    pub forms: Vec<FormFit>,
    /// Samples of the cycles that were used: deflection \[m\] and force \[N\], smoothed.
    #[serde(skip)]
    pub samples: Vec<[f64; 2]>,
    /// Speed of the deflection at each of them \[m/s\], and the time between two \[s\].
    #[serde(skip)]
    pub rates: (Vec<f64>, f64),
    /// Mean curves of single cycles.
    #[serde(skip)]
    pub single: Vec<Curve>,
    /// What a reader has to know.
    pub notes: Vec<String>,
}

/// The force over the deflection.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Curve {
    /// Deflections \[m\], rising.
    pub deflection: Vec<f64>,
    /// Force while it rises \[N\].
    pub loading: Vec<f64>,
    /// Force while it falls \[N\].
    pub unloading: Vec<f64>,
    /// Their mean \[N\].
    pub mean: Vec<f64>,
    /// That, made to rise everywhere with the least change (the table that a spline goes through) \[N\].
    pub table: Vec<f64>,
}

impl Curve {
    /// The deflection at a load on the table \[m\]; `None` outside of it.
    pub fn deflection_at(&self, load: f64) -> Option<f64> {
        let next = self.table.partition_point(|f| *f < load);
        match (next.checked_sub(1), self.table.get(next)) {
            (Some(i), Some(high)) => {
                let share = (load - self.table[i]) / (high - self.table[i]);
                Some(self.deflection[i] + share * (self.deflection[i + 1] - self.deflection[i]))
            }
            (None, Some(first)) if *first == load => Some(self.deflection[0]),
            _ => None,
        }
    }

    /// Slope of the mean at a deflection: of the line through what is within a tenth of the range each side \[N/m\].
    pub fn tangent_at(&self, deflection: f64) -> f64 {
        let (Some(first), Some(last)) = (self.deflection.first(), self.deflection.last()) else {
            return f64::NAN;
        };
        let side = 0.1 * (last - first);
        let near = |e: &f64| (e - deflection).abs() <= side;
        let points: Vec<(f64, f64)> =
            self.deflection.iter().copied().zip(self.mean.iter().copied()).filter(|(e, _)| near(e)).collect();
        slope_of(&points).map_or(f64::NAN, |(_, slope)| slope)
    }
}

/// Level at 0 and slope of the line through points.
fn slope_of(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    let n = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |s, p| (s.0 + p.0 / n, s.1 + p.1 / n));
    let xx: f64 = points.iter().map(|p| (p.0 - x).powi(2)).sum();
    let xy: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    (points.len() >= 2 && xx > 0.0).then(|| (y - xy / xx * x, xy / xx))
}

/// What is below the load cell and moves with the tire.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Below {
    /// Its mass \[kg\].
    pub mass: f64,
    /// Whether the cell was set to zero with the wheel hanging from it: then it shows what the road carries, and else its weight less.
    pub tared: bool,
    /// Gravity \[m/s²\].
    pub gravity: f64,
}

/// The loop of a force \[N\], positive where the tire carries, over a deflection \[m\], positive inward. `skip` cycles at the beginning are left
/// out.
///
/// # Errors
/// No whole cycle: what there is instead.
pub fn analyse(even: &Even, skip: usize, below: Option<Below>) -> Result<Loop> {
    let [deflection, force] = &even.values[..] else {
        return Err(Error::call("a loop is made of a deflection and a force"));
    };
    let mut notes = Vec::new();
    let turns = turns(deflection);
    let rough = match rough_period(&turns) {
        Some(samples) => samples,
        None => return Err(half_a_loop(even, deflection, &turns)),
    };
    let side = ((WINDOW * rough).round() as usize).clamp(2, WIDEST);
    let (e, _) = smoothed(deflection, side);
    // of a slope, half the window is off by as little as the whole one is of a level
    let (_, rate) = smoothed(deflection, (side / 2).max(2));
    let (mut f, _) = smoothed(force, side);
    // a turn among samples with noise is the highest of them, which may be far from the middle
    let turns: Vec<usize> = turns.iter().map(|k| vertex(&e, *k, 3 * side)).collect();
    let cycles = cycles(&e, &turns, skip, &mut notes);
    let Some(first) = cycles.first() else {
        return Err(half_a_loop(even, deflection, &turns));
    };
    let used: Vec<f64> = cycles.iter().map(|c| (c[2] - c[0]) as f64 * even.step).collect();
    let period = mean_of(&used).value;
    if let Some(below) = below {
        let constant = if below.tared { 0.0 } else { below.mass * below.gravity };
        f.iter_mut().for_each(|f| *f += constant);
        // over cycles that follow each other: of what is left out between them nothing is known
        for group in cycles.chunk_by(|a, b| a[2] == b[0]) {
            let (from, to) = (group[0][0], group[group.len() - 1][2]);
            let period = (to - from) as f64 / group.len() as f64;
            for (f, a) in f[from..=to].iter_mut().zip(harmonic_acceleration(&e[from..=to], period, even.step))
            {
                *f -= below.mass * a;
            }
        }
    }
    let areas: Vec<f64> = cycles.iter().map(|c| area(&e[c[0]..=c[2]], &f[c[0]..=c[2]])).collect();
    let area = mean_of(&areas);
    let mid = |values: Vec<f64>| values.iter().sum::<f64>() / values.len() as f64;
    let is_low_first = e[first[0]] < e[first[1]];
    let ends = |c: &[usize; 3]| {
        let (outer, inner) = (0.5 * (e[c[0]] + e[c[2]]), e[c[1]]);
        if is_low_first { [outer, inner] } else { [inner, outer] }
    };
    let deflections =
        [mid(cycles.iter().map(|c| ends(c)[0]).collect()), mid(cycles.iter().map(|c| ends(c)[1]).collect())];
    let amplitude = 0.5 * (deflections[1] - deflections[0]);
    let per = cycles.iter().map(|c| c[2] - c[0]).min().unwrap_or(0);
    let places = (per / 10).clamp(8, PLACES);
    let curve = branches(&e, &f, &cycles, deflections, places);
    if curve.deflection.len() < 5 {
        return Err(Error::numeric(format!(
            "the loop has {} samples a cycle: at least 50 are needed to tell its branches",
            per
        )));
    }
    let forces: Vec<f64> = cycles.iter().flat_map(|c| f[c[0]..=c[2]].iter().copied()).collect();
    let force_amplitude = 0.5 * (quantile(&forces, 0.999) - quantile(&forces, 0.001));
    let sine = area.value / (PI * force_amplitude * amplitude);
    let mut forms: Vec<FormFit> =
        Form::ALL.iter().filter_map(|form| fit_form(*form, &curve.deflection, &curve.mean).ok()).collect();
    forms.sort_by(|a, b| a.rmse.total_cmp(&b.rmse));
    let loads = [curve.table[0], curve.table[curve.table.len() - 1]];
    if loads[1] <= 0.0 {
        return Err(Error::numeric(format!(
            "the largest force of the loop is {:.0} N: the force has to be positive where the tire carries; give the channel's factor as -1 if it counts the other way",
            loads[1]
        )));
    }
    notes.extend(begins_elsewhere(&curve));
    if area.value < 0.0 {
        return Err(Error::numeric(format!(
            "the loop is run through the wrong way round: {:.1} J a cycle would come out of the tire. Force and deflection are not of the same moment, or one of them has the wrong sign",
            -area.value
        )));
    }
    if cycles.len() == 1 {
        notes.push("one cycle: how much cycles scatter is not known, and intervals do not count it".into());
    }
    // what was left out is no part of it
    let used = || cycles.iter().flat_map(|c| c[0]..c[2]);
    let c = 1.0 / (PI * TAU / period * amplitude * amplitude);
    Ok(Loop {
        cycles: cycles.len(),
        period,
        deflections,
        loads,
        area,
        amplitude,
        equivalent_damping: area.times(c),
        loss_angle: sine.clamp(0.0, 1.0).asin(),
        forms,
        samples: used().map(|k| [e[k], f[k]]).collect(),
        rates: (used().map(|k| rate[k] / even.step).collect(), even.step),
        single: cycles.iter().map(|c| branches(&e, &f, &[*c], deflections, places)).collect(),
        curve,
        notes,
    })
}

impl Loop {
    /// The deflection at a load with what cycles scatter \[m\]; `None` where the mean curve does not reach.
    pub fn deflection_at(&self, load: f64) -> Option<Known> {
        let value = self.curve.deflection_at(load)?;
        let single: Vec<f64> = self.single.iter().filter_map(|c| c.deflection_at(load)).collect();
        Some(Known { value, ..mean_of(&single) })
    }

    /// The work that a force loses over a cycle of the deflection that was measured \[J\]; the force \[N\] is that beyond a spring, at a
    /// deflection \[m\] and its speed \[m/s\].
    pub fn lost_by(&self, force: impl Fn(f64, f64) -> f64) -> f64 {
        let (rates, step) = &self.rates;
        let all: f64 = self.samples.iter().zip(rates).map(|([e, _], r)| force(*e, *r) * r * step).sum();
        all / self.cycles as f64
    }
}

/// Turns of a series, by place, each lower or higher than what is around it by [`BACK`] of the range, in turn.
fn turns(values: &[f64]) -> Vec<usize> {
    let (low, high) = (quantile(values, 0.002), quantile(values, 0.998));
    let range = high - low;
    let (mut lowest, mut highest) = (0, 0);
    // 1: looking for a highest, -1: for a lowest, 0: not known yet
    let mut looking = 0;
    let mut turns = Vec::new();
    for k in 1..values.len() {
        if values[k] > values[highest] {
            highest = k;
        }
        if values[k] < values[lowest] {
            lowest = k;
        }
        if looking <= 0 && values[k] > values[lowest] + BACK * range {
            if looking < 0 || values[lowest] < low + AT_END * range {
                turns.push(lowest);
            }
            (looking, highest) = (1, k);
        } else if looking >= 0 && values[k] < values[highest] - BACK * range {
            if looking > 0 || values[highest] > high - AT_END * range {
                turns.push(highest);
            }
            (looking, lowest) = (-1, k);
        }
    }
    match looking {
        1 if values[highest] > high - AT_END * range => turns.push(highest),
        -1 if values[lowest] < low + AT_END * range => turns.push(lowest),
        _ => {}
    }
    turns
}

/// Samples of a cycle.
fn rough_period(turns: &[usize]) -> Option<f64> {
    let lengths: Vec<f64> = turns.windows(3).map(|w| (w[2] - w[0]) as f64).collect();
    (!lengths.is_empty()).then(|| median(&lengths))
}

fn half_a_loop(even: &Even, deflection: &[f64], turns: &[usize]) -> Error {
    let (low, high) = (quantile(deflection, 0.002), quantile(deflection, 0.998));
    let at: Vec<String> = turns.iter().map(|k| format!("{:.3} s", even.time(*k as f64))).collect();
    let seen = match at.len() {
        0 => "it does not turn within the recording".to_owned(),
        _ => format!("its turns are at {}", at.join(" and ")),
    };
    Error::numeric(format!(
        "no whole loop: the deflection goes from {:.3} to {:.3} mm, and {seen}. A loop needs loading and unloading from turn to turn, after the cycles that are skipped; record at least one whole cycle, better five",
        1e3 * low,
        1e3 * high
    ))
}

/// Values and slopes (by place) of parabolas through `side` samples on each side; at the ends through what there is.
fn smoothed(values: &[f64], side: usize) -> (Vec<f64>, Vec<f64>) {
    let n = values.len();
    let (mut level, mut slope) = (Vec::with_capacity(n), Vec::with_capacity(n));
    let w = side as f64;
    let count = 2.0 * w + 1.0;
    // sums of x^2 and x^4 over -side..=side
    let s2 = w * (w + 1.0) * count / 3.0;
    let s4 = s2 * (3.0 * w * w + 3.0 * w - 1.0) / 5.0;
    let below = count * s4 - s2 * s2;
    for k in 0..n {
        // a window that is whole stays within the series; its parabola is read where the sample is
        let centre = k.clamp(side.min(n / 2), (n - 1).saturating_sub(side).max(n / 2));
        let (low, high) = (centre.saturating_sub(side), (centre + side).min(n - 1));
        let (mut y0, mut y1, mut y2) = (0.0, 0.0, 0.0);
        for (i, y) in values[low..=high].iter().enumerate() {
            let x = (low + i) as f64 - centre as f64;
            (y0, y1, y2) = (y0 + y, y1 + x * y, y2 + x * x * y);
        }
        let x = k as f64 - centre as f64;
        let a = (s4 * y0 - s2 * y2) / below;
        let b = y1 / s2;
        let c = (count * y2 - s2 * y0) / below;
        if high - low + 1 == 2 * side + 1 {
            level.push(a + (b + c * x) * x);
            slope.push(b + 2.0 * c * x);
        } else {
            level.push(values[k]);
            slope.push(0.0);
        }
    }
    (level, slope)
}

/// The place of a turn by the parabola around it; where it is at an end, or the parabola turns elsewhere, the place as it is.
fn vertex(values: &[f64], place: usize, side: usize) -> usize {
    let Some(around) = place.checked_sub(side).and_then(|low| values.get(low..=place + side)) else {
        return place;
    };
    let [level, before, after] = [side, side - 1, side + 1].map(|k| smoothed(around, side).0[k]);
    let bend = before - 2.0 * level + after;
    let off = 0.5 * (before - after) / bend;
    if off.abs() <= side as f64 { (place as f64 + off).round() as usize } else { place }
}

/// Whole cycles from turn to turn that repeat each other, from the end that most of them have.
fn cycles(e: &[f64], turns: &[usize], skip: usize, notes: &mut Vec<String>) -> Vec<[usize; 3]> {
    let all = |from: usize| -> Vec<[usize; 3]> {
        turns[from.min(turns.len())..].windows(3).step_by(2).map(|w| [w[0], w[1], w[2]]).collect()
    };
    let (even, odd) = (all(0), all(1));
    // from low to low, where there are as many
    let low_first = |c: &Vec<[usize; 3]>| c.first().is_some_and(|c| e[c[0]] < e[c[1]]);
    let found = if odd.len() > even.len() || odd.len() == even.len() && low_first(&odd) { odd } else { even };
    let found: Vec<[usize; 3]> = found.into_iter().skip(skip).collect();
    let typical = |i: usize| median(&found.iter().map(|c| e[c[i]]).collect::<Vec<_>>());
    let typical = [typical(0), typical(1), typical(2)];
    let range = (typical[1] - typical[0]).abs();
    let length = median(&found.iter().map(|c| (c[2] - c[0]) as f64).collect::<Vec<_>>());
    let same = |c: &&[usize; 3]| {
        let places = (0..3).all(|i| (e[c[i]] - typical[i]).abs() < SAME * range);
        places && ((c[2] - c[0]) as f64 / length - 1.0).abs() < SAME
    };
    let kept: Vec<[usize; 3]> = found.iter().filter(same).copied().collect();
    if kept.len() < found.len() {
        notes.push(format!(
            "{} of {} cycles are left out: their ends or their time differ by more than a tenth from the others'",
            found.len() - kept.len(),
            found.len()
        ));
    }
    kept
}

/// The second derivative of the first harmonics of a series over whole periods of so many samples \[1/s² of its unit\].
fn harmonic_acceleration(values: &[f64], period: f64, step: f64) -> Vec<f64> {
    // a tire's deflection has little of the sixth; and what noise there is in it counts 36-fold
    const HARMONICS: usize = 5;
    let n = (values.len() - 1) as f64;
    let mut all = vec![0.0; values.len()];
    for h in 1..=HARMONICS {
        let w = TAU * h as f64 / period;
        let (mut a, mut b) = (0.0, 0.0);
        for (k, v) in values[..values.len() - 1].iter().enumerate() {
            let (sin, cos) = (w * k as f64).sin_cos();
            (a, b) = (a + 2.0 / n * v * cos, b + 2.0 / n * v * sin);
        }
        for (k, sum) in all.iter_mut().enumerate() {
            let (sin, cos) = (w * k as f64).sin_cos();
            *sum -= (w / step).powi(2) * (a * cos + b * sin);
        }
    }
    all
}

/// The area that a closed path encloses, positive where the force is larger while the deflection rises.
fn area(e: &[f64], f: &[f64]) -> f64 {
    let n = e.len();
    (0..n).map(|k| (k, (k + 1) % n)).map(|(k, next)| 0.5 * (f[k] + f[next]) * (e[next] - e[k])).sum()
}

/// Lines through the samples of each branch in `places` pieces of the deflection, read in their middles.
fn branches(e: &[f64], f: &[f64], cycles: &[[usize; 3]], [low, high]: [f64; 2], places: usize) -> Curve {
    let width = (high - low) / places as f64;
    // count, sums of x, y, xx, xy about the middle of the piece
    let mut sums = vec![[[0.0; 5]; 2]; places];
    for c in cycles {
        for (from, to) in [(c[0], c[1]), (c[1], c[2])] {
            let rising = usize::from(e[from] >= e[to]);
            for k in from..to {
                let place = (e[k] - low) / width;
                if place < 0.0 || place >= places as f64 {
                    continue;
                }
                let i = place as usize;
                let x = e[k] - (low + (i as f64 + 0.5) * width);
                let s = &mut sums[i][rising];
                s.iter_mut().zip([1.0, x, f[k], x * x, x * f[k]]).for_each(|(s, v)| *s += v);
            }
        }
    }
    let read = |[n, x, y, xx, xy]: [f64; 5]| {
        let (mean_x, mean_y) = (x / n, y / n);
        let spread = xx - n * mean_x * mean_x;
        // few samples at one place tell no slope
        let slope = if n >= 3.0 && spread > 0.01 * n * width * width {
            (xy - n * mean_x * mean_y) / spread
        } else {
            0.0
        };
        (n >= 1.0).then_some(mean_y - slope * mean_x)
    };
    let mut curve = Curve::default();
    for (i, [up, down]) in sums.into_iter().enumerate() {
        if let (Some(loading), Some(unloading)) = (read(up), read(down)) {
            curve.deflection.push(low + (i as f64 + 0.5) * width);
            curve.loading.push(loading);
            curve.unloading.push(unloading);
            curve.mean.push(0.5 * (loading + unloading));
        }
    }
    curve.table = rising(&curve.mean);
    curve
}

/// The rising sequence that is nearest to a sequence (pool adjacent violators), with equal neighbours set apart by a hair so that it can
/// be read both ways.
fn rising(values: &[f64]) -> Vec<f64> {
    let mut pools: Vec<(f64, usize)> = Vec::new();
    for v in values {
        pools.push((*v, 1));
        while let [.., (a, n), (b, m)] = pools[..] {
            if a < b {
                break;
            }
            let mean = (a * n as f64 + b * m as f64) / (n + m) as f64;
            pools.truncate(pools.len() - 2);
            pools.push((mean, n + m));
        }
    }
    let hair = 1e-9 * values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let mut all = Vec::with_capacity(values.len());
    for (mean, n) in pools {
        all.extend((0..n).map(|i| mean + hair * (i as f64 - 0.5 * (n as f64 - 1.0)) / n as f64));
    }
    all
}

/// A note where the low end of the curve does not lead to no force at no deflection.
fn begins_elsewhere(curve: &Curve) -> Option<String> {
    let most = *curve.table.last()?;
    let low: Vec<(f64, f64)> = curve
        .deflection
        .iter()
        .copied()
        .zip(curve.mean.iter().copied())
        .filter(|(_, f)| *f < LOW * most && *f > 0.02 * most)
        .collect();
    if low.len() < 3 || curve.table[0] > 0.5 * LOW * most {
        return None;
    }
    let (level, slope) = slope_of(&low)?;
    let begins = -level / slope;
    let last = curve.deflection.last()?;
    // of F = a e^1.5 such a line begins at 4 % of the range: a spring that gets stiffer has that without an offset
    (begins.abs() > 0.06 * last).then(|| {
        format!(
            "the force begins at a deflection of {:.2} mm by its lowest part, and not at 0: if the channel does not count from where the tire touches, say where it does (deflection_at_touch)",
            1e3 * begins
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::SplitMix64;

    /// A spring F = a e^b with a damper, and e harmonic.
    fn made(cycles: f64, noise: [f64; 2], seed: u64) -> Even {
        let (a, b, c) = (4.0e6, 1.45, 3000.0);
        let mut random = SplitMix64::new(seed);
        let step = 1e-3;
        let n = (cycles / step) as usize;
        let (mut e, mut f) = (Vec::new(), Vec::new());
        for k in 0..n {
            let (sin, cos) = (TAU * step * k as f64 + 1.0).sin_cos();
            let (x, v) = (0.013 - 0.012 * cos, 0.012 * TAU * sin);
            e.push(x + noise[0] * random.normal());
            f.push(a * x.powf(b) + c * v + noise[1] * random.normal());
        }
        Even { start: 0.0, step, values: vec![e, f] }
    }

    #[test]
    fn spring_and_damper_come_back_from_a_noisy_loop() {
        let found = analyse(&made(8.0, [2e-5, 60.0], 5), 1, None).unwrap();
        assert!(found.cycles >= 6, "{}", found.cycles);
        assert!((found.period - 1.0).abs() < 2e-3, "{}", found.period);
        assert!(
            (found.equivalent_damping.value / 3000.0 - 1.0).abs() < 0.01,
            "{:?}",
            found.equivalent_damping
        );
        assert_eq!(found.forms[0].form, Form::Power);
        let [a, b] = found.forms[0].coefficients;
        assert!((a.value / 4.0e6 - 1.0).abs() < 0.01 && (b.value / 1.45 - 1.0).abs() < 0.003, "{a:?} {b:?}");
        // secant and tangent
        for load in [3e3, 6.5e3, 14e3] {
            let e = found.deflection_at(load).unwrap();
            let exact = (load / 4.0e6_f64).powf(1.0 / 1.45);
            assert!((e.value / exact - 1.0).abs() < 0.003, "{load}: {e:?} {exact}");
            let tangent = found.curve.tangent_at(e.value);
            assert!((tangent / (1.45 * load / exact) - 1.0).abs() < 0.01, "{load}: {tangent}");
        }
        assert!(found.notes.is_empty(), "{:?}", found.notes);
        // a damper that is the same at every deflection
        let lost = found.lost_by(|_, rate| 3000.0 * rate);
        assert!((lost / found.area.value - 1.0).abs() < 0.01, "{lost}");
    }

    #[test]
    fn one_press_is_a_loop_and_half_a_press_is_none() {
        let mut press = made(1.0, [2e-5, 20.0], 6);
        // from turn to turn
        press.values.iter_mut().for_each(|v| v.rotate_right(159));
        let whole = analyse(&press, 0, None).unwrap();
        assert_eq!(whole.cycles, 1);
        assert!((whole.equivalent_damping.value / 3000.0 - 1.0).abs() < 0.02, "{whole:?}");
        assert!(whole.notes.iter().any(|n| n.contains("one cycle")));
        press.values.iter_mut().for_each(|v| v.truncate(500));
        let message = analyse(&press, 0, None).unwrap_err().to_string();
        assert!(message.contains("no whole loop") && message.contains("loading and unloading"), "{message}");
        // all that there is was skipped
        assert!(analyse(&made(2.6, [0.0; 2], 1), 3, None).is_err());
    }

    #[test]
    fn mass_and_weight_below_the_cell_are_taken_out() {
        let mut even = made(6.0, [1e-5, 10.0], 7);
        for k in 0..even.values[0].len() {
            // what the cell shows: less the weight, more the inertia
            let w = TAU;
            let acceleration = 0.012 * w * w * (w * 1e-3 * k as f64 + 1.0).cos();
            even.values[1][k] += 400.0 * (acceleration - 9.81);
        }
        let below = Below { mass: 400.0, tared: false, gravity: 9.81 };
        let found = analyse(&even, 0, Some(below)).unwrap();
        let e = found.deflection_at(6.5e3).unwrap().value;
        assert!((e / (6.5e3 / 4.0e6_f64).powf(1.0 / 1.45) - 1.0).abs() < 0.003);
    }

    #[test]
    fn wrong_signs_and_an_offset_are_told() {
        let mut pulled = made(4.0, [0.0; 2], 8);
        pulled.values[1].iter_mut().for_each(|f| *f = -*f);
        assert!(
            analyse(&pulled, 0, None).unwrap_err().to_string().contains("positive where the tire carries")
        );
        let mut shifted = made(4.0, [0.0; 2], 9);
        shifted.values[0].iter_mut().for_each(|e| *e += 3e-3);
        let found = analyse(&shifted, 0, None).unwrap();
        assert!(found.notes[0].contains("deflection_at_touch"), "{:?}", found.notes);
        assert_eq!(rising(&[1.0, 3.0, 2.0, 4.0]).windows(2).filter(|w| w[1] <= w[0]).count(), 0);
    }
}
