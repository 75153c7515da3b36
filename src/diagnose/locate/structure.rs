//! Whether what is left of a channel can be foretold: by functions of the signals that are found in the fit
//! runs and tried on the check runs. What can be foretold is no noise.

use super::depends::{TIME, candidates};
use super::signals::{bins, blocks, channels, memory, residual};
use crate::diagnose::blocks::sign_flip;
use crate::diagnose::roles::Roles;
use crate::fit::{Run, Traces};
use crate::model::Interface;
use nalgebra::{DMatrix, DVector};

/// Samples that functions are found from at most.
const MAX_ROWS: usize = 4000;
/// Knots of a function of a signal, and of the time since the start.
const KNOTS: usize = 7;
const TIME_KNOTS: usize = 24;
/// Groups of functions that are put together at most.
const MAX_GROUPS: usize = 4;
/// Blocks are so many times longer than the residual's memory.
const BLOCK: f64 = 4.0;
/// A signal that makes so much less of the foretold part than the most important is not named.
const MINOR: f64 = 0.3;

/// What can be foretold of a channel's residual.
#[derive(Debug, Clone, PartialEq)]
pub struct Structure {
    /// Number of the measured channel.
    pub channel: usize,
    /// Share of the squared error of the check runs.
    pub share: f64,
    /// Probability that chance foretells as much, for all channels together.
    pub p: f64,
    /// Signals that it is foretold from, the most important first.
    pub depends_on: Vec<String>,
}

/// Runs with what is simulated of them.
#[derive(Clone, Copy)]
pub struct Seen<'a> {
    /// The runs.
    pub runs: &'a [&'a Run],
    /// Simulated channels of each run at its samples.
    pub simulated: &'a [Traces],
}

/// What can be foretold of the residual of each measured channel, the largest share first; channels of which
/// nothing can are left out.
///
/// Functions: piecewise linear ones of each signal (inputs, simulated channels, their rates, time, slid
/// energy), the same times the channel itself, and products of two signals. Groups of them are taken in one
/// after the other while an information criterion for as many groups as there are allows it. A gain or a
/// lag of the channel itself counts as a sensor's, not as structure.
pub fn structure(fit: Seen<'_>, check: Seen<'_>, interface: &Interface, roles: &Roles) -> Vec<Structure> {
    let count = channels(fit.runs).min(channels(check.runs));
    let of = |seen: Seen<'_>| candidates(seen.runs, seen.simulated, interface, roles);
    let (from, to) = (of(fit), of(check));
    let counting: Vec<&str> = fit
        .runs
        .iter()
        .flat_map(|r| r.channels.iter().filter(|c| c.counts))
        .filter_map(|c| interface.variables.get(c.variable).map(|v| v.name.as_str()))
        .collect();
    // an angle that counts on tells no more than the time
    let signals: Vec<Signal> = from
        .into_iter()
        .zip(to)
        .filter(|((name, _), _)| !counting.contains(&name.as_str()))
        .filter_map(|((name, fit), (_, check))| Signal::of(name, fit, check))
        .collect();
    let mut found: Vec<Structure> = (0..count)
        .filter_map(|channel| one(channel, fit, check, &signals))
        .map(|s| Structure { p: (s.p * count as f64).min(1.0), ..s })
        .collect();
    found.sort_by(|a, b| b.share.total_cmp(&a.share));
    found
}

/// A signal in the fit runs and the check runs on end, in multiples of its spread.
struct Signal {
    name: String,
    is_rate: bool,
    fit: Vec<f64>,
    check: Vec<f64>,
}

impl Signal {
    fn of(name: String, fit: Vec<f64>, check: Vec<f64>) -> Option<Self> {
        let finite: Vec<f64> = fit.iter().copied().filter(|v| v.is_finite()).collect();
        let n = finite.len().max(1) as f64;
        let mean = finite.iter().sum::<f64>() / n;
        let spread = (finite.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt();
        let scale = |v: f64| if v.is_finite() { ((v - mean) / spread).clamp(-6.0, 6.0) } else { 0.0 };
        (spread > 1e-9 * mean.abs() && spread > 0.0).then(|| Self {
            is_rate: name.starts_with("rate of "),
            name,
            fit: fit.into_iter().map(scale).collect(),
            check: check.into_iter().map(scale).collect(),
        })
    }

    fn side(&self, check: bool) -> &[f64] {
        if check { &self.check } else { &self.fit }
    }

    /// Piecewise linear functions that are 1 at one knot each.
    fn hats(&self, check: bool) -> Vec<Vec<f64>> {
        let count = if self.name == TIME { TIME_KNOTS } else { KNOTS };
        let knots = if self.name == TIME {
            let (low, high) = self.fit.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
            (0..count).map(|k| low + (high - low) * k as f64 / (count - 1) as f64).collect()
        } else {
            bins(&self.fit, count - 1)
        };
        let hat = |k: usize, v: f64| {
            let v = v.clamp(knots[0], knots[knots.len() - 1]);
            if k > 0 && v < knots[k] {
                ((v - knots[k - 1]) / (knots[k] - knots[k - 1])).max(0.0)
            } else if k + 1 < knots.len() && v > knots[k] {
                ((knots[k + 1] - v) / (knots[k + 1] - knots[k])).max(0.0)
            } else {
                1.0
            }
        };
        (0..knots.len()).map(|k| self.side(check).iter().map(|v| hat(k, *v)).collect()).collect()
    }
}

/// Functions that are taken in together.
struct Group {
    /// Numbers of the signals.
    signals: Vec<usize>,
    /// Times the channel itself.
    times_own: bool,
}

impl Group {
    fn columns(&self, signals: &[Signal], own: &[f64], check: bool) -> Vec<Vec<f64>> {
        let mut columns = match self.signals[..] {
            [one] => signals[one].hats(check),
            [one, other] => {
                let pair = signals[one].side(check).iter().zip(signals[other].side(check));
                vec![pair.map(|(a, b)| a * b).collect()]
            }
            _ => Vec::new(),
        };
        if self.times_own {
            for column in &mut columns {
                column.iter_mut().zip(own).for_each(|(c, y)| *c *= y);
            }
        }
        columns
    }
}

fn groups(signals: &[Signal]) -> Vec<Group> {
    let mut all = Vec::new();
    for (i, signal) in signals.iter().enumerate() {
        all.push(Group { signals: vec![i], times_own: false });
        all.push(Group { signals: vec![i], times_own: true });
        if !signal.is_rate && signal.name != TIME {
            let others = (i + 1..signals.len()).filter(|j| !signals[*j].is_rate && signals[*j].name != TIME);
            all.extend(others.map(|j| Group { signals: vec![i, j], times_own: false }));
        }
    }
    all
}

fn one(channel: usize, fit: Seen<'_>, check: Seen<'_>, signals: &[Signal]) -> Option<Structure> {
    let rest = |seen: Seen<'_>| residual(seen.runs, seen.simulated, channel);
    let (fit_rest, check_rest) = (rest(fit), rest(check));
    let own =
        |seen: Seen<'_>| -> Vec<f64> { seen.simulated.iter().flat_map(|t| t[channel].clone()).collect() };
    let scaled = |values: Vec<f64>, by: f64| -> Vec<f64> { values.into_iter().map(|v| v / by).collect() };
    let size = own(fit).iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    if size <= 0.0 || fit_rest.iter().chain(&check_rest).any(Vec::is_empty) {
        return None;
    }
    let (own_fit, own_check) = (scaled(own(fit), size), scaled(own(check), size));
    let slopes = |seen: Seen<'_>| -> Vec<f64> {
        let slope = |t: &Traces| super::depends::rate_by_sample(&t[channel]);
        scaled(seen.simulated.iter().flat_map(slope).collect(), size)
    };
    // what a sensor of its own may do: offset, gain, lag
    let plain = |own: &[f64], slope: Vec<f64>| vec![vec![1.0; own.len()], own.to_vec(), slope];
    let (plain_fit, plain_check) = (plain(&own_fit, slopes(fit)), plain(&own_check, slopes(check)));

    let target: Vec<f64> = fit_rest.concat();
    let stride = target.len().div_ceil(MAX_ROWS).max(1);
    let thin =
        |v: &[f64]| DVector::from_iterator(v.len().div_ceil(stride), v.iter().step_by(stride).copied());
    let memory = memory(&fit_rest);
    let independent = (target.len() as f64 / memory).max(4.0);
    let mut basis: Vec<DVector<f64>> = Vec::new();
    let mut left = thin(&target);
    for column in &plain_fit {
        take_in(&mut basis, &mut left, thin(column));
    }
    let groups = groups(signals);
    let clean = |basis: &[DVector<f64>], group: &Group| -> Vec<DVector<f64>> {
        let mut own_basis: Vec<DVector<f64>> = Vec::new();
        for column in group.columns(signals, &own_fit, false) {
            let mut column = thin(&column);
            let size = column.norm();
            for _ in 0..2 {
                for b in basis.iter().chain(&own_basis) {
                    let along = column.dot(b);
                    column.axpy(-along, b, 1.0);
                }
            }
            let norm = column.norm();
            if norm > 1e-3 * size {
                own_basis.push(column / norm);
            }
        }
        own_basis
    };
    let mut chosen: Vec<usize> = Vec::new();
    for _ in 0..MAX_GROUPS {
        let before = left.norm_squared();
        let rated = (0..groups.len()).filter(|g| !chosen.contains(g)).map(|g| {
            let directions = clean(&basis, &groups[g]);
            let gain: f64 = directions.iter().map(|d| d.dot(&left).powi(2)).sum();
            let likelihood = -independent * (1.0 - (gain / before).min(1.0 - 1e-12)).ln();
            (likelihood - directions.len() as f64 * independent.ln(), g, directions)
        });
        let best = rated.max_by(|a, b| a.0.total_cmp(&b.0));
        let Some((worth, g, directions)) = best else { break };
        if worth < 2.0 * (groups.len() as f64).ln() {
            break;
        }
        for d in directions {
            left.axpy(-left.dot(&d), &d, 1.0);
            basis.push(d);
        }
        chosen.push(g);
    }
    if chosen.is_empty() {
        return None;
    }
    // the same functions on the check runs
    let columns = |check: bool, own: &[f64], plain: &[Vec<f64>]| -> Vec<(Option<usize>, Vec<f64>)> {
        let mut all: Vec<(Option<usize>, Vec<f64>)> = plain.iter().map(|c| (None, c.clone())).collect();
        for g in &chosen {
            all.extend(groups[*g].columns(signals, own, check).into_iter().map(|c| (Some(*g), c)));
        }
        all
    };
    let fit_columns = columns(false, &own_fit, &plain_fit);
    let amounts = solve(&fit_columns.iter().map(|(_, c)| thin(c)).collect::<Vec<_>>(), &thin(&target))?;
    let without = solve(&plain_fit.iter().map(|c| thin(c)).collect::<Vec<_>>(), &thin(&target))?;
    let check_columns = columns(true, &own_check, &plain_check);
    let measured: Vec<f64> = check_rest.concat();
    let foretold = |group: Option<usize>| -> Vec<f64> {
        let mut sum = vec![0.0; measured.len()];
        for ((g, column), amount) in check_columns.iter().zip(amounts.iter()) {
            if group.is_none() || *g == group {
                sum.iter_mut().zip(column).for_each(|(s, c)| *s += amount * c);
            }
        }
        sum
    };
    let all = foretold(None);
    let mut by_sensor = vec![0.0; measured.len()];
    for (column, amount) in plain_check.iter().zip(without.iter()) {
        by_sensor.iter_mut().zip(column).for_each(|(s, c)| *s += amount * c);
    }
    let mut at = 0;
    let after: Vec<Vec<f64>> = check_rest
        .iter()
        .map(|run| {
            at += run.len();
            run.iter().zip(&all[at - run.len()..]).map(|(r, f)| r - f).collect()
        })
        .collect();
    let length = BLOCK * super::signals::memory(&after);
    let (mut gains, mut end, mut at) = (Vec::new(), 0, 0);
    let (mut won, mut total) = (0.0, 0.0);
    for run in &check_rest {
        let (block, next) = blocks(run.len(), length, 0);
        let start = end;
        end += next;
        gains.resize(end, 0.0);
        for (k, r) in run.iter().enumerate() {
            let before = (r - by_sensor[at]).powi(2);
            let after = (r - all[at]).powi(2);
            gains[start + block[k]] += before - after;
            won += before - after;
            total += r * r;
            at += 1;
        }
    }
    if !(won > 0.0) {
        return None;
    }
    // a signal is as important as the functions that it is in
    let mut weight: Vec<(f64, &str)> = Vec::new();
    for g in &chosen {
        let part = foretold(Some(*g));
        let n = part.len().max(1) as f64;
        let mean = part.iter().sum::<f64>() / n;
        let size = part.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
        for s in &groups[*g].signals {
            let name = signals[*s].name.as_str();
            match weight.iter_mut().find(|w| w.1 == name) {
                Some(w) => w.0 += size,
                None => weight.push((size, name)),
            }
        }
    }
    weight.sort_by(|a, b| b.0.total_cmp(&a.0));
    let most = weight.first().map_or(0.0, |w| w.0);
    let depends_on = weight.iter().filter(|w| w.0 >= MINOR * most).take(3).map(|w| w.1.to_owned()).collect();
    Some(Structure { channel, share: won / total, p: sign_flip(&gains), depends_on })
}

/// Makes a column orthogonal to the others, takes it in, and takes it out of what is left.
fn take_in(basis: &mut Vec<DVector<f64>>, left: &mut DVector<f64>, mut column: DVector<f64>) {
    let size = column.norm();
    for _ in 0..2 {
        for b in &*basis {
            let along = column.dot(b);
            column.axpy(-along, b, 1.0);
        }
    }
    let norm = column.norm();
    if norm > 1e-6 * size {
        let direction = column / norm;
        left.axpy(-left.dot(&direction), &direction, 1.0);
        basis.push(direction);
    }
}

/// Least squares with a trace of ridge, for columns that are nearly the same.
fn solve(columns: &[DVector<f64>], target: &DVector<f64>) -> Option<DVector<f64>> {
    let matrix = DMatrix::from_columns(columns);
    let mut normal = matrix.tr_mul(&matrix);
    for i in 0..normal.nrows() {
        normal[(i, i)] = normal[(i, i)] * (1.0 + 1e-6) + f64::MIN_POSITIVE;
    }
    Some(normal.cholesky()?.solve(&matrix.tr_mul(target)))
}
