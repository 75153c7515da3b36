//! The significance map of the residual: channel by time, frequency, operating condition and order.

use super::signals::{
    Signal, bin, bins, blocks, channels, even, inputs, interval, label, memory, name, outputs, residual,
};
use crate::diagnose::result::{Cell, CellKind};
use crate::diagnose::roles::Roles;
use crate::effect::Role;
use crate::fit::{Run, Traces};
use crate::model::Interface;
use crate::stats::chance::{coherent, fisher, holm, student};
use crate::stats::welch::{Lines, count, independent};
use crate::stats::{over_angle, root_mean_square};
use realfft::num_complex::Complex;
use std::f64::consts::PI;

/// Time windows of a run.
const WINDOWS: usize = 8;
/// Frequency bands.
const BANDS: usize = 6;
/// Ranges of a condition.
const RANGES: usize = 6;
/// Orders of a wheel.
const ORDERS: usize = 8;
/// Segments of the spectra, the longest first, and how many independent ones are needed.
const LENGTHS: [(usize, f64); 3] = [(256, 40.0), (128, 20.0), (64, 8.0)];
/// Blocks are so many times longer than the residual's memory.
const BLOCK: f64 = 4.0;
/// A test by blocks needs so many.
const MIN_BLOCKS: f64 = 6.0;
/// Equivalent noise bandwidth of the window of [`over_angle`], in lines (Hamming; Harris 1978, table I).
const BANDWIDTH: f64 = 1.363;
/// Outputs that are operating conditions.
const CONDITIONS: [Role; 9] = [
    Role::Load,
    Role::Slip,
    Role::SlipAngle,
    Role::TravelSpeed,
    Role::Velocity,
    Role::Position,
    Role::Pressure,
    Role::Temperature,
    Role::Camber,
];

/// The map of what `simulated` leaves of the measured channels of `runs`.
///
/// `noise` has that of each channel where it is known. Probabilities of chance are those of the time
/// window's mean square against the rest of its run, of the coherence with an input or output in a band,
/// of the mean residual in the range of a condition by blocks (Student), of an order's amplitude that keeps
/// its phase over blocks; corrected for all cells (Holm). Cells of which the runs have too little for a
/// test have none.
pub fn map(
    runs: &[&Run],
    simulated: &[Traces],
    interface: &Interface,
    roles: &Roles,
    noise: &[Option<f64>],
) -> Vec<Cell> {
    let driven = inputs(runs);
    let outputs = outputs(runs, simulated);
    let is_condition = |s: &&Signal| CONDITIONS.iter().any(|role| roles.is(s.variable, *role));
    let conditions: Vec<&Signal> = driven.iter().chain(outputs.iter().filter(is_condition)).collect();
    let angles = angles(runs, driven.iter().chain(&outputs), roles);
    let drivers: Vec<&Signal> = driven.iter().chain(&outputs).collect();
    let mut cells = Vec::new();
    for c in 0..channels(runs) {
        let values = residual(runs, simulated, c);
        let memory = memory(&values);
        let measured = runs.iter().flat_map(|r| &r.channels[c].values);
        let scale = noise.get(c).copied().flatten().unwrap_or_else(|| rms(measured));
        let left = rms(values.iter().flatten());
        let scale = if scale > 0.0 { scale } else { left };
        if left <= 0.0 || scale <= 0.0 || !scale.is_finite() {
            continue;
        }
        let channel = Channel { runs, values: &values, memory };
        let mut own = channel.windows();
        own.extend(channel.bands(&drivers));
        for condition in &conditions {
            own.extend(channel.ranges(&condition.values, &label(interface, condition.variable)));
        }
        for angle in &angles {
            own.extend(channel.orders(&angle.values, &label(interface, angle.variable)));
        }
        let variable = runs.first().map_or(0, |r| r.channels[c].variable);
        for mut cell in own {
            cell.channel = name(interface, variable);
            cell.level /= scale;
            cells.push(cell);
        }
    }
    let mut p: Vec<Option<f64>> = cells.iter().map(|c| c.p).collect();
    holm(&mut p);
    for (cell, p) in cells.iter_mut().zip(p) {
        cell.p = p;
    }
    cells
}

fn rms<'a>(values: impl Iterator<Item = &'a f64>) -> f64 {
    root_mean_square(values.copied().filter(|v| v.is_finite()))
}

/// Angles of wheels: those that there are, else integrals of their speeds.
fn angles<'a>(runs: &[&Run], signals: impl Iterator<Item = &'a Signal>, roles: &Roles) -> Vec<Signal> {
    let signals: Vec<&Signal> = signals.collect();
    let with = |role: Role| signals.iter().filter(move |s| roles.is(s.variable, role));
    let given: Vec<Signal> =
        with(Role::WheelAngle).map(|s| Signal { variable: s.variable, values: s.values.clone() }).collect();
    if !given.is_empty() {
        return given;
    }
    let integral = |(run, values): (&&Run, &Vec<f64>)| {
        let mut sum = 0.0;
        let steps = run.time.windows(2).zip(values.windows(2));
        let rest = steps.map(|(t, v)| {
            sum += (t[1] - t[0]) * 0.5 * (v[0] + v[1]);
            sum
        });
        if values.is_empty() { Vec::new() } else { std::iter::once(0.0).chain(rest).collect() }
    };
    with(Role::WheelSpeed)
        .map(|s| Signal { variable: s.variable, values: runs.iter().zip(&s.values).map(integral).collect() })
        .collect()
}

/// The residual of a channel.
struct Channel<'a> {
    runs: &'a [&'a Run],
    /// By run; empty where a run lacks it.
    values: &'a [Vec<f64>],
    /// Neighbouring samples that tell as much as one.
    memory: f64,
}

impl Channel<'_> {
    fn windows(&self) -> Vec<Cell> {
        let mut cells = Vec::new();
        let whole =
            |run: &Run| run.time.last().zip(run.time.first()).map_or(0.0, |(last, first)| last - first);
        let longest = self.runs.iter().map(|run| whole(run)).fold(0.0, f64::max);
        for (run, values) in self.runs.iter().zip(self.values) {
            let Some(first) = run.time.first() else { continue };
            // runs that last as long but for a few samples have the same windows
            let is_as_long = whole(run) > longest * (1.0 - 1.0 / WINDOWS as f64);
            let length = if is_as_long { longest } else { whole(run) } / WINDOWS as f64;
            if values.is_empty() || length.is_nan() || length <= 0.0 {
                continue;
            }
            let mut sums = [(0.0, 0.0); WINDOWS];
            for (t, e) in run.time.iter().zip(values).filter(|(_, e)| e.is_finite()) {
                let (sum, n) = &mut sums[(((t - first) / length) as usize).min(WINDOWS - 1)];
                *sum += e * e;
                *n += 1.0;
            }
            let (all, samples) = sums.iter().fold((0.0, 0.0), |(a, b), (s, n)| (a + s, b + n));
            for (k, (sum, n)) in sums.into_iter().enumerate().filter(|(_, (_, n))| *n > 0.0) {
                let (dof, others) = (n / self.memory, (samples - n) / self.memory);
                let ratio = sum / n / ((all - sum) / (samples - n));
                let tested = dof >= 3.0 && others >= 8.0 && ratio.is_finite();
                cells.push(Cell {
                    kind: CellKind::Time,
                    what: run.name.clone(),
                    low: k as f64 * length,
                    high: (k + 1) as f64 * length,
                    level: (sum / n).sqrt(),
                    p: tested.then(|| fisher(ratio, dof, others)),
                    ..Cell::default()
                });
            }
        }
        cells
    }

    fn bands(&self, drivers: &[&Signal]) -> Vec<Cell> {
        let Some(step) = interval(self.runs) else { return Vec::new() };
        let evened = |values: &[Vec<f64>]| -> Vec<Vec<f64>> {
            self.runs.iter().zip(values).map(|(run, v)| even(&run.time, v, step)).collect()
        };
        let own = evened(self.values);
        let samples: Vec<usize> = own.iter().map(Vec::len).collect();
        let enough = |(length, needed): &&(usize, f64)| independent(count(&samples, *length)) >= *needed;
        let Some((length, _)) = LENGTHS.iter().find(enough) else { return Vec::new() };
        let lines = |values: &[Vec<f64>]| Lines::of(values.iter().map(|v| &v[..]), *length);
        let Some(own_lines) = lines(&own) else { return Vec::new() };
        let others: Vec<Lines> = drivers
            .iter()
            .map(|s| evened(&s.values))
            .filter(|v| v.iter().zip(&own).all(|(a, b)| a.len() == b.len()))
            .filter_map(|v| lines(&v))
            .collect();
        let nyquist = *length as f64 / 2.0;
        let edge = |b: usize| if b == 0 { 0.0 } else { nyquist.powf(b as f64 / BANDS as f64) };
        let hertz = 1.0 / (*length as f64 * step);
        (0..BANDS)
            .map(|b| {
                let within = |k: &usize| {
                    let k = *k as f64;
                    k >= edge(b) - 1e-9 && (k < edge(b + 1) - 1e-9 || b + 1 == BANDS)
                };
                let inner: Vec<usize> = (0..own_lines.count()).filter(within).collect();
                let tested: Vec<usize> =
                    inner.iter().copied().filter(|k| *k > 0 && *k < length / 2).collect();
                let looks = (tested.len() * others.len()) as f64;
                let n = own_lines.independent();
                let least = tested
                    .iter()
                    .flat_map(|k| others.iter().map(|o| coherent(own_lines.coherence(o, *k), n)))
                    .fold(1.0, f64::min);
                Cell {
                    kind: CellKind::Band,
                    low: edge(b) * hertz,
                    high: edge(b + 1) * hertz,
                    level: inner.iter().map(|k| own_lines.power(*k)).sum::<f64>().sqrt(),
                    p: (looks > 0.0).then(|| (least * looks).min(1.0)),
                    ..Cell::default()
                }
            })
            .collect()
    }

    fn ranges(&self, condition: &[Vec<f64>], what: &str) -> Vec<Cell> {
        let all: Vec<f64> = condition.iter().flatten().copied().collect();
        let edges = bins(&all, RANGES);
        let count = edges.len().saturating_sub(1);
        // sum, samples and sum of squares of each block in each range
        let mut sums: Vec<Vec<(f64, f64)>> = vec![Vec::new(); count];
        let mut squares = vec![0.0; count];
        let mut first = 0;
        for (values, condition) in self.values.iter().zip(condition) {
            let (block, end) = blocks(values.len(), BLOCK * self.memory, first);
            for ((e, v), b) in values.iter().zip(condition).zip(block) {
                let Some(k) = bin(&edges, *v).filter(|_| e.is_finite()) else { continue };
                let known = sums[k].len().max(b + 1);
                sums[k].resize(known, (0.0, 0.0));
                sums[k][b].0 += e;
                sums[k][b].1 += 1.0;
                squares[k] += e * e;
            }
            first = end;
        }
        let of = |k: usize| {
            let n: f64 = sums[k].iter().map(|s| s.1).sum();
            (n > 0.0).then(|| Cell {
                kind: CellKind::Condition,
                what: what.to_owned(),
                low: edges[k],
                high: edges[k + 1],
                level: (squares[k] / n).sqrt(),
                p: mean_is_zero(&sums[k]),
                ..Cell::default()
            })
        };
        (0..count).filter_map(of).collect()
    }

    fn orders(&self, angle: &[Vec<f64>], what: &str) -> Vec<Cell> {
        let spectra: Vec<_> = self
            .values
            .iter()
            .zip(angle)
            .filter(|(values, angle)| values.len() == angle.len() && !values.is_empty())
            .filter_map(|(values, angle)| Some((values, angle, over_angle(angle, values)?)))
            .collect();
        let samples: f64 = spectra.iter().map(|(v, ..)| v.len() as f64).sum();
        // samples of a revolution where it turns fastest on average
        let turns =
            |angle: &[f64]| angle.first().zip(angle.last()).map_or(0.0, |(a, b)| (b - a).abs() / (2.0 * PI));
        let least = spectra.iter().map(|(v, a, _)| v.len() as f64 / turns(a)).fold(f64::INFINITY, f64::min);
        if spectra.is_empty() {
            return Vec::new();
        }
        let cell = |order: usize| {
            let order = order as f64;
            let mut square = 0.0;
            for (values, _, spectrum) in &spectra {
                let lines = spectrum.amplitudes.iter().enumerate().filter(|(i, _)| {
                    let place = *i as f64 * spectrum.spacing;
                    place >= order - 0.5 && place < order + 0.5
                });
                let own: f64 = lines.map(|(_, a)| 0.5 * a * a / BANDWIDTH).sum();
                square += own * values.len() as f64 / samples;
            }
            // mean of the residual at the order's phase, in blocks of whole revolutions
            let (mut kept, mut lost, mut runs, mut count) = (0.0, 0.0, 0.0, 0.0);
            for (values, angle, _) in &spectra {
                let means = phases(values, angle, turns(angle), order, BLOCK * self.memory);
                let n = means.len() as f64;
                if n < 2.0 {
                    continue;
                }
                let mean: Complex<f64> = means.iter().sum::<Complex<f64>>() / n;
                kept += n * mean.norm_sqr();
                lost += means.iter().map(|m| (m - mean).norm_sqr()).sum::<f64>();
                runs += 1.0;
                count += n;
            }
            let tested = count - runs >= MIN_BLOCKS && lost > 0.0;
            Cell {
                kind: CellKind::Order,
                what: what.to_owned(),
                low: order - 0.5,
                high: order + 0.5,
                level: square.sqrt(),
                p: tested
                    .then(|| fisher(kept / runs / (lost / (count - runs)), 2.0 * runs, 2.0 * (count - runs))),
                ..Cell::default()
            }
        };
        (1..=ORDERS).filter(|k| (*k as f64) < 0.45 * least).map(cell).collect()
    }
}

/// Means of a residual times the order's rotation backwards, over blocks of whole revolutions.
fn phases(values: &[f64], angle: &[f64], turns: f64, order: f64, samples: f64) -> Vec<Complex<f64>> {
    let per_turn = values.len() as f64 / turns;
    let length = (samples / per_turn).ceil().max(2.0);
    let count = (turns / length) as usize;
    let mut parts: Vec<Vec<(f64, f64)>> = vec![Vec::new(); count];
    let first = angle.first().copied().unwrap_or(0.0);
    for (e, a) in values.iter().zip(angle).filter(|(e, a)| e.is_finite() && a.is_finite()) {
        let block = ((a - first).abs() / (2.0 * PI * length)) as usize;
        if let Some(part) = parts.get_mut(block) {
            part.push((*e, *a));
        }
    }
    let of = |part: Vec<(f64, f64)>| {
        let n = part.len() as f64;
        let mean = part.iter().map(|(e, _)| e).sum::<f64>() / n;
        let sum: Complex<f64> = part.iter().map(|(e, a)| Complex::from_polar(e - mean, -order * a)).sum();
        sum / n
    };
    parts.into_iter().filter(|p| p.len() > 3).map(of).collect()
}

/// Probability of a mean as far from 0 by chance, from sums and numbers of samples of independent blocks.
fn mean_is_zero(blocks: &[(f64, f64)]) -> Option<f64> {
    let n: f64 = blocks.iter().map(|b| b.1).sum();
    let squares: f64 = blocks.iter().map(|b| b.1 * b.1).sum();
    // blocks that have few samples count little
    let effective = n * n / squares;
    if effective.is_nan() || effective < MIN_BLOCKS {
        return None;
    }
    let mean = blocks.iter().map(|b| b.0).sum::<f64>() / n;
    let spread: f64 = blocks.iter().map(|b| (b.0 - mean * b.1).powi(2)).sum();
    let error = (spread * effective / (effective - 1.0)).sqrt() / n;
    (error > 0.0).then(|| student(mean / error, effective - 1.0))
}

#[cfg(test)]
mod tests {
    use super::super::bed::{interface, run};
    use super::*;
    use crate::stats::SplitMix64;
    use crate::stats::testing::coloured;

    const INPUTS: [(&str, &str); 2] = [("load", "N"), ("wheel_angle", "rad")];
    const OUTPUTS: [(&str, &str); 2] = [("force_y", "N"), ("sliding", "m/s")];

    /// Runs of noise and of what `add` makes from load, angle and sample; and the map.
    fn look(seed: u64, add: impl Fn(f64, f64, usize) -> f64) -> Vec<Cell> {
        let mut random = SplitMix64::new(seed);
        let n = 2400;
        let mut runs = Vec::new();
        let mut simulated = Vec::new();
        for r in 0..3 {
            let slow = coloured(&mut random, 0.99, n);
            let load: Vec<f64> = slow.iter().map(|v| 3000.0 + 500.0 * v).collect();
            let angle: Vec<f64> = (0..n).map(|i| 20.0 * 0.01 * i as f64 + 1e-6 * (i * i) as f64).collect();
            let memory = [0.3, 0.9][seed as usize % 2];
            let noise = [coloured(&mut random, memory, n), coloured(&mut random, 0.8, n)];
            let force: Vec<f64> = load.iter().map(|f| 0.5 * f).collect();
            let sliding = coloured(&mut random, 0.9, n);
            let measured = [
                (0..n).map(|i| force[i] + 10.0 * noise[0][i] + add(load[i], angle[i], i)).collect(),
                (0..n).map(|i| sliding[i] + 0.1 * noise[1][i]).collect::<Vec<f64>>(),
            ];
            runs.push(run(&format!("run {r}"), 0.01, &[load, angle], &measured));
            simulated.push(vec![force, sliding]);
        }
        let interface = interface(&INPUTS, &OUTPUTS);
        let roles = Roles::of(&interface, &[]).unwrap();
        map(&runs.iter().collect::<Vec<_>>(), &simulated, &interface, &roles, &[Some(10.0), None])
    }

    fn significant(cells: &[Cell]) -> Vec<&Cell> {
        cells.iter().filter(|c| c.p.is_some_and(|p| p < 0.01)).collect()
    }

    #[test]
    fn noise_alone_is_significant_nowhere() {
        let maps: Vec<Vec<Cell>> = (0..100).map(|seed| look(seed, |_, _, _| 0.0)).collect();
        let alarms = maps.iter().filter(|m| m.iter().any(|c| c.p.is_some_and(|p| p < 0.05))).count();
        assert!(alarms <= 9, "{alarms} of 100 at 5 %");
        // everything was looked at: windows, bands, ranges of two inputs and the sliding speed, orders
        let of = |kind| maps[0].iter().filter(|c| c.kind == kind && c.p.is_some()).count();
        assert_eq!(of(CellKind::Time), 2 * 3 * 8);
        assert_eq!(of(CellKind::Band), 2 * 6);
        assert_eq!(of(CellKind::Condition), 2 * 3 * 6);
        assert_eq!(of(CellKind::Order), 2 * 8);
        // the force has its noise as unit
        let level = rms(maps[0]
            .iter()
            .filter(|c| c.kind == CellKind::Time && c.channel == "force_y")
            .map(|c| &c.level));
        assert!((level - 1.0).abs() < 0.1, "{level}");
    }

    #[test]
    fn a_condition_is_where_it_is() {
        let cells = look(1, |load, _, _| if load > 3400.0 { 12.0 } else { 0.0 });
        let found = significant(&cells);
        // the mean over the wheel's angle is not zero either
        let ranges: Vec<&&Cell> = found.iter().filter(|c| c.what == "load [N]").collect();
        assert!(!ranges.is_empty() && ranges.iter().all(|c| c.high > 3400.0), "{ranges:?}");
        assert!(found.iter().all(|c| c.channel == "force_y"), "{found:?}");
        assert!(found.iter().all(|c| c.kind != CellKind::Order), "{found:?}");
    }

    #[test]
    fn an_order_is_one() {
        let cells = look(2, |_, angle, _| 5.0 * (3.0 * angle + 0.4).sin());
        let found = significant(&cells);
        let orders: Vec<f64> =
            found.iter().filter(|c| c.kind == CellKind::Order).map(|c| c.low + 0.5).collect();
        assert_eq!(orders, [3.0]);
        assert_eq!(found.iter().find(|c| c.kind == CellKind::Order).unwrap().what, "wheel_angle [rad]");
        // amplitude 5 and noise 10, some of which is at this order too
        let level = found.iter().find(|c| c.kind == CellKind::Order).unwrap().level;
        assert!((0.34..0.5).contains(&level), "{level}");
    }

    #[test]
    fn a_time_and_a_band_are_where_they_are() {
        let mut random = SplitMix64::new(8);
        let burst: Vec<f64> = (0..2400).map(|i| if i < 300 { 25.0 * random.normal() } else { 0.0 }).collect();
        let cells = look(4, |_, _, i| burst[i]);
        let found = significant(&cells);
        let first: Vec<&&Cell> = found.iter().filter(|c| c.kind == CellKind::Time).collect();
        assert_eq!(first.len(), 3, "{first:?}");
        assert!(first.iter().all(|c| c.low == 0.0 && (c.high - 3.0).abs() < 0.01));

        // what follows the load is slow
        let cells = look(6, |load, _, _| 0.02 * (load - 3000.0));
        let found = significant(&cells);
        let bands: Vec<&&Cell> = found.iter().filter(|c| c.kind == CellKind::Band).collect();
        assert!(!bands.is_empty() && bands[0].low == 0.0, "{bands:?}");
        assert!(bands.iter().all(|c| c.high < 26.0 && c.channel == "force_y"), "{bands:?}");
    }

    #[test]
    fn runs_of_nearly_one_length_share_their_windows() {
        let interface = interface(&INPUTS, &OUTPUTS);
        let roles = Roles::default();
        let mut random = SplitMix64::new(2);
        // the last is half as long, with windows of its own
        let lengths = [2400, 2391, 2396, 1200];
        let mut noise = |n: usize| (0..n).map(|_| random.normal()).collect::<Vec<f64>>();
        let runs: Vec<Run> =
            lengths.map(|n| run("a", 0.01, &[noise(n), noise(n)], &[noise(n)])).into_iter().collect();
        let simulated: Vec<Traces> = lengths.iter().map(|n| vec![vec![0.0; *n]]).collect();
        let cells = map(&runs.iter().collect::<Vec<_>>(), &simulated, &interface, &roles, &[]);
        let mut ends: Vec<u64> =
            cells.iter().filter(|c| c.kind == CellKind::Time).map(|c| c.high.to_bits()).collect();
        ends.sort_unstable();
        ends.dedup();
        assert_eq!(ends.len(), 2 * WINDOWS);
    }

    #[test]
    fn nothing_has_no_map() {
        let interface = interface(&INPUTS, &OUTPUTS);
        let roles = Roles::default();
        assert!(map(&[], &[], &interface, &roles, &[]).is_empty());
        let short = run("a", 0.01, &[vec![1.0; 5], vec![f64::NAN; 5]], &[vec![1.0, 2.0, f64::NAN, 1.0, 0.0]]);
        let cells = map(&[&short], &[vec![vec![0.0; 5]]], &interface, &roles, &[]);
        assert!(cells.iter().all(|c| c.p.is_none() && c.level.is_finite()), "{cells:?}");
    }
}
