//! Whether what is left of a channel can be foretold: by functions of the signals that are found in the fit
//! runs and tried on the check runs. What can be foretold is no noise.

use super::depends::{TIME, candidates, rate_by_sample};
use super::signals::{bins, blocks, channels, memory, residual};
use crate::diagnose::numbers::MUCH;
use crate::diagnose::roles::Roles;
use crate::fit::{Run, Traces};
use crate::model::Interface;
use crate::stats::{about_mean, mean_or_zero, redundancy, sign_flip};
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
/// A column of which less than this share is new says nothing new.
const NEW: f64 = 1e-3;

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
    /// The parameter of the model that would have to change with them, if it is foretold in that way.
    pub through: Option<String>,
}

/// What a parameter of the model does to the outputs.
pub struct Sensitivity {
    /// Its name.
    pub parameter: String,
    /// Change of each channel per change of the parameter, at the samples of each fit run.
    pub fit: Vec<Traces>,
    /// The same for the check runs.
    pub check: Vec<Traces>,
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
/// energy), the same times the channel itself, products of two signals, and functions times what a parameter
/// of the model does, as if it changed with the signal. Groups of them are taken in one after the other while
/// an information criterion for as many groups as there are allows it. A gain or a lag of the channel itself
/// counts as a sensor's, and the parameter as a whole as a refit's, not as structure.
pub fn structure(
    fit: Seen<'_>,
    check: Seen<'_>,
    wandering: &[Sensitivity],
    interface: &Interface,
    roles: &Roles,
) -> Vec<Structure> {
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
        .filter_map(|channel| one(channel, fit, check, wandering, &signals))
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
        let mean = mean_or_zero(&finite);
        let spread = (about_mean(&finite) / finite.len().max(1) as f64).sqrt();
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
    /// Times one of the factors: the channel itself, or what a parameter does to it.
    times: Option<usize>,
}

impl Group {
    fn columns(&self, signals: &[Signal], factors: &[[Vec<f64>; 2]], check: bool) -> Vec<Vec<f64>> {
        let mut columns = match self.signals[..] {
            [one] => signals[one].hats(check),
            [one, other] => {
                let pair = signals[one].side(check).iter().zip(signals[other].side(check));
                vec![pair.map(|(a, b)| a * b).collect()]
            }
            _ => Vec::new(),
        };
        if let Some(factor) = self.times {
            let factor = &factors[factor][usize::from(check)];
            for column in &mut columns {
                column.iter_mut().zip(factor).for_each(|(c, y)| *c *= y);
            }
        }
        columns
    }
}

fn groups(signals: &[Signal], factors: usize) -> Vec<Group> {
    let mut all = Vec::new();
    for (i, signal) in signals.iter().enumerate() {
        all.push(Group { signals: vec![i], times: None });
        // the channel itself is the first
        let some = if signal.is_rate { factors.min(1) } else { factors };
        all.extend((0..some).map(|factor| Group { signals: vec![i], times: Some(factor) }));
        if !signal.is_rate && signal.name != TIME {
            let others = (i + 1..signals.len()).filter(|j| !signals[*j].is_rate && signals[*j].name != TIME);
            all.extend(others.map(|j| Group { signals: vec![i, j], times: None }));
        }
    }
    all
}

/// A group taken in: the columns so far, and what is left.
#[derive(Clone)]
struct Taken {
    group: usize,
    basis: Vec<DVector<f64>>,
    left: DVector<f64>,
}

/// A channel's functions in the fit runs and in the check runs.
struct Design<'a> {
    signals: &'a [Signal],
    groups: Vec<Group>,
    /// The channel as simulated, and what parameters do to it, in multiples of their sizes: in the fit runs, in
    /// the check runs.
    factors: Vec<[Vec<f64>; 2]>,
    /// What a sensor of its own may do: offset, gain, lag; and what a refit may.
    plain: [Vec<Vec<f64>>; 2],
    /// Every how many samples are used to find functions.
    stride: usize,
}

impl<'a> Design<'a> {
    fn of(
        channel: usize,
        seen: [Seen<'_>; 2],
        wandering: &[Sensitivity],
        signals: &'a [Signal],
    ) -> Option<Self> {
        let joined = |runs: &[Traces]| runs.iter().flat_map(|t| t[channel].clone()).collect::<Vec<f64>>();
        let own = seen.map(|s| joined(s.simulated));
        let slopes = seen
            .map(|s| -> Vec<f64> { s.simulated.iter().flat_map(|t| rate_by_sample(&t[channel])).collect() });
        let scaled = |sides: [Vec<f64>; 2], size: f64| {
            sides.map(|values| values.into_iter().map(|v| v / size).collect::<Vec<f64>>())
        };
        let size_of = |sides: &[Vec<f64>; 2]| sides[0].iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let size = size_of(&own);
        if size <= 0.0 {
            return None;
        }
        let slopes = scaled(slopes, size);
        let mut factors = vec![scaled(own, size)];
        for s in wandering {
            let sides = [joined(&s.fit), joined(&s.check)];
            let size = size_of(&sides);
            // what it does not move has no factor, but keeps its number
            factors.push(scaled(sides, if size > 0.0 { size } else { 1.0 }));
        }
        let plain = [0, 1].map(|i| {
            let ones = vec![1.0; factors[0][i].len()];
            let all = factors.iter().map(|f| f[i].clone());
            [ones, slopes[i].clone()].into_iter().chain(all).collect::<Vec<_>>()
        });
        let stride = factors[0][0].len().div_ceil(MAX_ROWS).max(1);
        Some(Self { signals, groups: groups(signals, factors.len()), factors, plain, stride })
    }

    fn thin(&self, values: &[f64]) -> DVector<f64> {
        DVector::from_iterator(
            values.len().div_ceil(self.stride),
            values.iter().step_by(self.stride).copied(),
        )
    }

    fn columns(&self, group: usize, check: bool) -> Vec<Vec<f64>> {
        self.groups[group].columns(self.signals, &self.factors, check)
    }

    /// Takes groups in as long as their gain is worth their functions and the choice among so many. At first as
    /// many samples are independent as the memory of the residual allows, `independent`; what is missing makes that
    /// memory long, so that a group which leaves a shorter one is judged by that, too.
    fn choose(&self, target: &[f64], mut independent: f64) -> Vec<usize> {
        let mut basis: Vec<DVector<f64>> = Vec::new();
        let mut left = self.thin(target);
        for direction in self.plain[0].iter().map(|c| self.thin(c)) {
            take_in(&mut basis, direction, &mut left);
        }
        let rows = left.len() as f64;
        let enough = 2.0 * (self.groups.len() as f64).ln();
        let mut chosen: Vec<usize> = Vec::new();
        while chosen.len() < MAX_GROUPS {
            let before = left.norm_squared();
            let worth = |taken: &Taken, independent: f64| {
                let likelihood = -independent * (taken.left.norm_squared() / before).max(1e-12).ln();
                likelihood - (taken.basis.len() - basis.len()) as f64 * independent.ln()
            };
            let mut best: [Option<(f64, Taken)>; 2] = [None, None];
            for group in (0..self.groups.len()).filter(|g| !chosen.contains(g)) {
                let mut taken = Taken { group, basis: basis.clone(), left: left.clone() };
                for column in self.columns(group, false) {
                    take_in(&mut taken.basis, self.thin(&column), &mut taken.left);
                }
                for (best, independent) in best.iter_mut().zip([independent, rows]) {
                    let worth = worth(&taken, independent);
                    if best.as_ref().is_none_or(|b| b.0 < worth) {
                        *best = Some((worth, taken.clone()));
                    }
                }
            }
            let [careful, bold] = best;
            let careful = careful.filter(|c| c.0 >= enough).map(|(_, taken)| (independent, taken));
            let bold =
                bold.map(|(_, taken)| ((rows / redundancy(taken.left.as_slice())).max(independent), taken));
            let bold = bold.filter(|(own, taken)| worth(taken, *own) >= enough);
            let Some((own, taken)) = careful.or(bold) else { break };
            chosen.push(taken.group);
            (basis, left, independent) = (taken.basis, taken.left, own);
        }
        chosen
    }

    /// What functions that are fitted to `target` make of the check runs: the part of the sensor, and that of
    /// each group.
    fn foretell(&self, chosen: &[usize], target: &[f64]) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
        let mut columns: Vec<DVector<f64>> = self.plain[0].iter().map(|c| self.thin(c)).collect();
        let mut then: Vec<(usize, Vec<f64>)> = self.plain[1].iter().map(|c| (0, c.clone())).collect();
        for (k, g) in chosen.iter().enumerate() {
            columns.extend(self.columns(*g, false).iter().map(|c| self.thin(c)));
            then.extend(self.columns(*g, true).into_iter().map(|c| (k + 1, c)));
        }
        let amounts = solve(&columns, &self.thin(target))?;
        let mut parts = vec![vec![0.0; self.factors[0][1].len()]; chosen.len() + 1];
        for ((k, column), amount) in then.iter().zip(amounts.iter()) {
            parts[*k].iter_mut().zip(column).for_each(|(s, c)| *s += amount * c);
        }
        let groups = parts.split_off(1);
        Some((parts.pop()?, groups))
    }
}

fn one(
    channel: usize,
    fit: Seen<'_>,
    check: Seen<'_>,
    wandering: &[Sensitivity],
    signals: &[Signal],
) -> Option<Structure> {
    let [fit_rest, check_rest] = [fit, check].map(|s| residual(s.runs, s.simulated, channel));
    if fit_rest.iter().chain(&check_rest).any(Vec::is_empty) {
        return None;
    }
    let design = Design::of(channel, [fit, check], wandering, signals)?;
    let target: Vec<f64> = fit_rest.concat();
    let independent = (target.len() as f64 / memory(&fit_rest)).max(4.0);
    let chosen = design.choose(&target, independent);
    if chosen.is_empty() {
        return None;
    }
    let (sensor, parts) = design.foretell(&chosen, &target)?;
    let (sensor_alone, _) = design.foretell(&[], &target)?;
    let all = |k: usize| sensor[k] + parts.iter().map(|p| p[k]).sum::<f64>();
    // before and after, sample by sample
    let (mut before, mut after, mut k) = (Vec::new(), Vec::new(), 0);
    for run in &check_rest {
        before.push(run.iter().enumerate().map(|(i, r)| r - sensor_alone[k + i]).collect::<Vec<f64>>());
        after.push(run.iter().enumerate().map(|(i, r)| r - all(k + i)).collect::<Vec<f64>>());
        k += run.len();
    }
    let length = BLOCK * memory(&after);
    let (mut gains, mut first) = (Vec::new(), 0);
    for (before, after) in before.iter().zip(&after) {
        let (block, end) = blocks(before.len(), length, first);
        gains.resize(end, 0.0);
        for ((b, a), block) in before.iter().zip(after).zip(block) {
            gains[block] += b * b - a * a;
        }
        first = end;
    }
    let won: f64 = gains.iter().sum();
    let total: f64 = before.iter().flatten().map(|b| b * b).sum();
    (won > 0.0).then(|| Structure {
        channel,
        share: won / total,
        p: sign_flip(&gains),
        depends_on: important(&design, &chosen, &parts),
        through: through(&design, &chosen, &parts, wandering),
    })
}

/// The parameter that the largest part is foretold through.
fn through(
    design: &Design<'_>,
    chosen: &[usize],
    parts: &[Vec<f64>],
    wandering: &[Sensitivity],
) -> Option<String> {
    let square = |part: &Vec<f64>| part.iter().map(|v| v * v).sum::<f64>();
    let largest = chosen.iter().zip(parts).max_by(|a, b| square(a.1).total_cmp(&square(b.1)))?.0;
    let parameter = design.groups[*largest].times?.checked_sub(1)?;
    wandering.get(parameter).map(|s| s.parameter.clone())
}

/// The signals by how much the functions that they are in make.
fn important(design: &Design<'_>, chosen: &[usize], parts: &[Vec<f64>]) -> Vec<String> {
    let mut weights: Vec<(f64, &str)> = Vec::new();
    for (g, part) in chosen.iter().zip(parts) {
        let size = about_mean(part);
        for s in &design.groups[*g].signals {
            let name = design.signals[*s].name.as_str();
            match weights.iter_mut().find(|w| w.1 == name) {
                Some(w) => w.0 += size,
                None => weights.push((size, name)),
            }
        }
    }
    weights.sort_by(|a, b| b.0.total_cmp(&a.0));
    let most = weights.first().map_or(0.0, |w| w.0);
    weights.iter().filter(|w| w.0 >= MUCH * most).take(3).map(|w| w.1.to_owned()).collect()
}

/// Makes a column orthogonal to the others, takes it in, and takes it out of what is left.
fn take_in(basis: &mut Vec<DVector<f64>>, mut column: DVector<f64>, left: &mut DVector<f64>) {
    let size = column.norm();
    // twice is enough
    for _ in 0..2 {
        for b in &*basis {
            let along = column.dot(b);
            column.axpy(-along, b, 1.0);
        }
    }
    let norm = column.norm();
    if norm > NEW * size {
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

#[cfg(test)]
mod tests {
    use super::super::bed::{interface, run};
    use super::*;
    use crate::stats::SplitMix64;
    use crate::stats::testing::coloured;

    const INPUTS: [(&str, &str); 3] = [("load", "N"), ("slip_angle", "rad"), ("speed", "m/s")];
    const OUTPUTS: [(&str, &str); 2] = [("force_y", "N"), ("moment", "N.m")];

    /// What is found if the recorded force has `wrong(load, angle, speed, force, rate of force)` more than
    /// the simulated one.
    fn ask(seed: u64, wrong: impl Fn([f64; 5]) -> f64) -> Vec<Structure> {
        ask_with(seed, wrong, None)
    }

    /// The same with a parameter that moves the force by a function of the angle.
    fn ask_with(seed: u64, wrong: impl Fn([f64; 5]) -> f64, moves: Option<fn(f64) -> f64>) -> Vec<Structure> {
        let mut random = SplitMix64::new(seed);
        let n = 2000;
        let (mut runs, mut simulated, mut sensitivity) = (Vec::new(), Vec::new(), Vec::new());
        for _ in 0..6 {
            let [load, angle, speed] = [0, 1, 2].map(|_| coloured(&mut random, 0.98, n));
            let force: Vec<f64> = load.iter().zip(&angle).map(|(f, a)| 500.0 * a * (5.0 + f)).collect();
            let noise = coloured(&mut random, 0.7, n);
            let measured = (0..n).map(|i| {
                let rate = force[i] - force[i.saturating_sub(1)];
                force[i] + 50.0 * noise[i] + wrong([load[i], angle[i], speed[i], force[i], rate])
            });
            let measured: Vec<f64> = measured.collect();
            let other: Vec<f64> = (0..n).map(|_| random.normal()).collect();
            let moved = |f: fn(f64) -> f64| angle.iter().map(|a| f(*a)).collect::<Vec<f64>>();
            sensitivity.push(vec![moves.map_or(vec![0.0; n], moved), vec![0.0; n]]);
            runs.push(run("a", 0.01, &[load, angle, speed], &[measured, other]));
            simulated.push(vec![force, vec![0.0; n]]);
        }
        let interface = interface(&INPUTS, &OUTPUTS);
        let roles = Roles::of(&interface, &[]).unwrap();
        let runs: Vec<&Run> = runs.iter().collect();
        let side = |from: usize, to: usize| Seen { runs: &runs[from..to], simulated: &simulated[from..to] };
        let (fit, check) = (sensitivity[..4].to_vec(), sensitivity[4..].to_vec());
        let wandering: Vec<Sensitivity> =
            moves.map(|_| Sensitivity { parameter: "curvature".into(), fit, check }).into_iter().collect();
        structure(side(0, 4), side(4, 6), &wandering, &interface, &roles)
    }

    #[test]
    fn functions_of_signals_are_foretold_and_named() {
        for seed in 0..3 {
            let found = ask(seed, |[_, _, speed, ..]| 50.0 * (1.5 * speed).sin());
            assert_eq!((found[0].channel, &found[0].depends_on[..]), (0, &["speed".to_owned()][..]));
            // half of the error is structure: variance 1/2 (1 - exp(-2 1.5^2)) of 1 + that
            assert!((found[0].share - 0.33).abs() < 0.08 && found[0].p < 0.01, "{found:?}");
            let found = ask(seed, |[load, _, speed, ..]| 40.0 * load * speed);
            let mut names = found[0].depends_on.clone();
            names.sort();
            assert_eq!(names, ["load", "speed"]);
            let found = ask(seed, |[_, _, speed, force, _]| 0.1 * force * speed.max(0.0));
            assert!(found[0].depends_on.contains(&"speed".to_owned()) && found[0].p < 0.01, "{found:?}");
        }
    }

    #[test]
    fn a_parameter_that_changes_with_a_signal_is_named_with_it() {
        let square: fn(f64) -> f64 = |angle| 300.0 * angle.powi(2);
        for seed in 20..23 {
            let found = ask_with(
                seed,
                |[_, angle, speed, ..]| 0.3 * square(angle) * (1.5 * speed).sin(),
                Some(square),
            );
            assert_eq!(found.len(), 1, "{seed}: {found:?}");
            assert_eq!(found[0].through.as_deref(), Some("curvature"), "{found:?}");
            assert_eq!((found[0].channel, &found[0].depends_on[..]), (0, &["speed".to_owned()][..]));
            assert!(found[0].p < 0.01);
            // what a refit of it would do, and noise, are no structure
            for amount in [0.0, 0.2] {
                let found = ask_with(seed, |[_, angle, ..]| amount * square(angle), Some(square));
                assert!(found.iter().all(|s| s.p > 0.01), "{amount}: {found:?}");
            }
        }
    }

    #[test]
    fn noise_and_errors_of_the_sensor_itself_are_no_structure() {
        for seed in 10..16 {
            let sure = |found: Vec<Structure>| found.into_iter().filter(|s| s.p < 0.01).collect::<Vec<_>>();
            assert_eq!(sure(ask(seed, |_| 0.0)), []);
            assert_eq!(sure(ask(seed, |[.., force, _]| 0.1 * force + 30.0)), []);
            assert_eq!(sure(ask(seed, |[.., rate]| 0.4 * rate)), []);
        }
    }
}
