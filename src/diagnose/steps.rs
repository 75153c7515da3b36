//! Steps of simulations, held against the noise of the recordings: the model's own ones as long as they cannot tell, so that
//! every simulation takes as much less time, and communication steps as short as they ask for.

use super::negligible::resolution;
use super::result::Use;
use super::subject::Subject;
use crate::Result;
use crate::fit::{Bench, Drive, Knob, OutputError, Run, Traces};
use crate::model::{Role, Value};
use crate::stats::{deviation, median, noise, root_mean_square};
use std::sync::{Arc, Mutex};

/// What a longer step may change of a channel in any run, as a share of the channel's noise: a four-hundredth of its square,
/// half of what the least effect that is fitted has to explain.
const SHARE: f64 = 0.05;

/// Communication steps at most where there is usually one: with 32 per sample nothing that was sampled is left between them.
const MOST_FINER: u32 = 16;

/// What sensors err by at least, over how much their channel moves: those of class 0.2. Shorter steps for recordings with less
/// noise, which are simulated ones, would cost more than they tell.
const CLASS: f64 = 2e-3;

/// What the channel of a run may change by a longer step of which only differences are used, as a share of what it moves where it
/// moves most: about so much of a difference is then wrong. Derivatives that are lead to the same place, whose residuals are
/// simulated with the other step, and places are ranked alike.
const SHARE_OF_MOTION: f64 = 0.05;

/// Steps of the model's own that are longer than those that it has by itself.
#[derive(Default)]
pub(super) struct LongerSteps {
    /// One that recordings cannot tell from it.
    pub longer: Option<LongerStep>,
    /// The parameter, and one that is longer still \[s\], with which differences between simulations are nearly the same.
    pub of_changes: Option<(usize, f64)>,
}

/// A step that recordings cannot tell from the model's.
pub(super) struct LongerStep {
    /// The parameter.
    pub variable: usize,
    /// Its value in the model, and the longer one \[s\].
    pub own: f64,
    pub step: f64,
    /// The most that this changes of a channel in a run, as a share of the noise.
    pub change: f64,
}

impl LongerSteps {
    /// The longest of twice, four times, ... the model's step, up to the most that the model accepts. None if the user has set it, or if
    /// the model does not say which parameter it is, as a system of several parts does not. Of check runs only the inputs are looked
    /// at: the noise is that of the fit runs.
    pub fn of(bench: &Bench, subject: &Subject, fit_runs: &[&Run], check_runs: &[&Run]) -> Self {
        let variables = &subject.interface.variables;
        let is_step = |v: &usize| variables[*v].meaning.is_some_and(|m| m.role == Some(Role::Step));
        let mut steps = (0..variables.len()).filter(is_step);
        let mut found = Self::default();
        let (Some(variable), None) = (steps.next(), steps.next()) else { return found };
        if subject.fixed.iter().any(|(v, _)| *v == variable) {
            return found;
        }
        let (Some(Value::Real(own)), Some(most)) = (&variables[variable].start, variables[variable].max)
        else {
            return found;
        };
        if !(*own > 0.0 && most.is_finite()) {
            return found;
        }
        // the longest first; one of the same decimals as the limit is not beyond it
        let doubled = std::iter::successors(Some(2.0 * own), |step| Some(2.0 * step));
        let mut longer: Vec<f64> = doubled.take_while(|step| *step <= most * (1.0 + 1e-9)).collect();
        longer.reverse();
        if longer.is_empty() {
            return found;
        }
        let runs = [fit_runs, check_runs].concat();
        let simulate = |step: f64| simulated(bench, &runs, Some((variable, step)));
        let noises = noises(fit_runs);
        let Some(reference) = simulate(*own) else { return found };
        for step in longer {
            let Some(answer) = simulate(step) else { continue };
            let change = most_changed(&answer, &reference, &noises);
            if change <= SHARE {
                found.longer = Some(LongerStep { variable, own: *own, step, change });
                break;
            }
            if found.of_changes.is_none() && are_alike(&answer, &reference) {
                found.of_changes = Some((variable, step));
            }
        }
        found
    }
}

impl LongerStep {
    /// What is said of it.
    pub fn words(&self, subject: &Subject) -> String {
        let Self { variable, own, step, change } = self;
        format!(
            "Simulated with {} = {step} s, not {own} s: that changes no channel of any run by more than {:.1} % of its noise.",
            subject.interface.variables[*variable].name,
            100.0 * change
        )
    }
}

/// Communication steps that are shorter than usual, because the model's answer to the recorded inputs depends on them.
pub(super) struct ShorterSteps {
    /// How many there are where there is usually one.
    finer: u32,
    /// What half of the usual ones changes of a channel, as a share of its noise,
    usual: f64,
    /// and half of these ones; or, where shorter ones are not tried, these in place of twice as long ones.
    change: f64,
    /// Whether that is little enough.
    is_enough: bool,
}

/// Runs, ready to be simulated, and what they are for.
type Used = Vec<(Run, Use)>;

impl ShorterSteps {
    /// The longest of half, a quarter, ... of the usual communication steps of which half changes nothing that recordings can
    /// tell, with the runs that take them: inputs are handed over more often. `prepared` makes the `runs` with steps so much
    /// shorter. `None` if the usual ones are short enough, or where the model takes no shorter ones.
    ///
    /// # Errors
    /// Those of `prepared`.
    pub fn of(
        bench: &Bench,
        runs: &Used,
        prepared: impl Fn(u32) -> Result<Used>,
    ) -> Result<Option<(Self, Used)>> {
        let answer = |runs: &[(Run, Use)]| {
            simulated(bench, &runs.iter().map(|(run, _)| run).collect::<Vec<_>>(), None)
        };
        let to_fit: Vec<&Run> =
            runs.iter().filter(|(_, use_)| *use_ == Use::Fit).map(|(run, _)| run).collect();
        let spreads = spreads(to_fit.iter().map(|r| r.channels.iter().map(|c| &c.values[..]).collect()));
        let least = |(c, spread): (usize, f64)| (CLASS * spread).max(resolution(&to_fit, c));
        let least = spreads.into_iter().enumerate().map(least);
        let noises: Vec<f64> =
            noises(&to_fit).into_iter().zip(least).map(|(n, least)| n.max(least)).collect();
        let Some(with_usual) = answer(runs) else { return Ok(None) };
        let mut now = with_usual.clone();
        let (mut finer, mut found) = (1, None);
        while finer < MOST_FINER {
            let halved = prepared(2 * finer)?;
            let Some(next) = answer(&halved) else { break };
            let change = changed(&now, &next, &noises);
            let usual = found.as_ref().map_or(change, |(shorter, _): &(Self, Used)| shorter.usual);
            if change <= SHARE {
                found = found.map(|(shorter, runs)| (Self { change, is_enough: true, ..shorter }, runs));
                break;
            }
            (finer, now) = (2 * finer, next);
            found = Some((Self { finer, usual, change, is_enough: false }, halved));
        }
        // what was found is as near as it gets
        if let Some((_, shorter)) = found.as_mut().filter(|_| are_alike(&with_usual, &now)) {
            for ((run, _), (usual, _)) in shorter.iter_mut().zip(runs) {
                let coarser = Some(Arc::clone(&usual.drive));
                run.drive = Arc::new(Drive { coarser, ..Drive::clone(&run.drive) });
            }
        }
        Ok(found)
    }

    /// How many there are where there is usually one.
    pub fn finer(&self) -> u32 {
        self.finer
    }

    /// What is said of them.
    pub fn words(&self) -> String {
        let Self { finer, usual, change, is_enough } = self;
        let change = 100.0 * change;
        let left = match is_enough {
            true => format!("halving these changes none by more than {change:.1} %"),
            false => {
                format!("the last halving still changes one by {change:.0} %, and no shorter ones are taken")
            }
        };
        format!(
            "Simulated with communication steps {finer} times as short as usual: halving the usual ones changes a channel by {:.0} % of its noise, {left}.",
            100.0 * usual
        )
    }
}

/// What a model answers in runs, if it does, with a parameter set to this value.
pub(super) fn simulated(bench: &Bench, runs: &[&Run], with: Option<(usize, f64)>) -> Option<Vec<Traces>> {
    let problem = OutputError {
        bench,
        runs: runs.to_vec(),
        knobs: with.iter().map(|(variable, _)| Knob::Parameter(*variable, 1.0)).collect(),
        values: Vec::new(),
        attachments: Vec::new(),
        weights: Vec::new(),
        of_changes: None,
        is_coarse: false,
        beside: None,
        kept: Mutex::default(),
    };
    problem.simulate(&[with.iter().map(|(_, value)| *value).collect()]).pop().flatten()
}

/// Whether what was simulated with longer steps differs so little from what was with these that it tells as well how outputs change with an
/// unknown.
pub(super) fn are_alike(longer: &[Traces], reference: &[Traces]) -> bool {
    let spreads = spreads(reference.iter().map(|run| run.iter().map(Vec::as_slice).collect()));
    most_changed(longer, reference, &spreads) <= SHARE_OF_MOTION
}

/// How much a channel differs from the reference over all runs, as a share of its noise: of the one that does so most.
fn changed(simulated: &[Traces], reference: &[Traces], noises: &[f64]) -> f64 {
    let course = |runs: &[Traces], c: usize| -> Vec<f64> {
        runs.iter().filter_map(|run| run.get(c)).flatten().copied().collect()
    };
    let of = |c: usize| vec![vec![course(simulated, c)]];
    let reference = |c: usize| vec![vec![course(reference, c)]];
    let each = noises.iter().enumerate().map(|(c, noise)| most_changed(&of(c), &reference(c), &[*noise]));
    each.fold(0.0, f64::max)
}

/// The most that a channel of a run differs from the reference, as a share of the channel's noise.
fn most_changed(simulated: &[Traces], reference: &[Traces], noises: &[f64]) -> f64 {
    let runs = simulated.iter().zip(reference);
    let channels = runs.flat_map(|(a, b)| a.iter().zip(b).zip(noises));
    let changes = channels.map(|((a, b), noise)| {
        let change = root_mean_square(a.iter().zip(b).map(|(a, b)| a - b));
        if change == 0.0 { 0.0 } else { change / noise }
    });
    // what is no number is no small change
    changes.fold(0.0, |most: f64, change| if change.is_nan() { f64::INFINITY } else { most.max(change) })
}

/// The noise of each channel: that of the run in the middle.
fn noises(runs: &[&Run]) -> Vec<f64> {
    let count = runs.iter().map(|r| r.channels.len()).max().unwrap_or(0);
    let of = |c: usize| {
        let measured =
            runs.iter().filter_map(|r| Some((r, r.channels.get(c).filter(|c| !c.values.is_empty())?)));
        let each: Vec<f64> = measured.map(|(r, channel)| noise(&r.time, &channel.values)).collect();
        if each.is_empty() { 0.0 } else { median(&each) }
    };
    (0..count).map(of).collect()
}

/// How much each channel moves: as in the run in which it moves most. Of each run, its channels.
fn spreads<'a>(runs: impl Iterator<Item = Vec<&'a [f64]>>) -> Vec<f64> {
    let mut spreads: Vec<f64> = Vec::new();
    for channels in runs {
        spreads.resize(spreads.len().max(channels.len()), 0.0);
        spreads.iter_mut().zip(channels).for_each(|(most, values)| *most = most.max(deviation(values)));
    }
    spreads
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::{Channel, Options, Problem, Unknown, least_squares};
    use crate::model::Settings;
    use crate::stats::SplitMix64;
    use std::sync::Arc;

    /// A swing of the slip angle on the ring-and-brush tire, one of the deflection at 48 Hz by so much \[m\], and this noise
    /// on the lateral force \[N\].
    fn run(subject: &Subject, bench: &Bench, bounce: f64, noise: f64) -> Run {
        let find = |name: &str| subject.interface.index(name).unwrap();
        let points = 401;
        let swing = (0..points).map(|k| 0.05 * (0.05 * k as f64).sin()).collect();
        let mut inputs = vec![
            (find("deflection"), (0..points).map(|k| 0.02 + bounce * (0.6 * k as f64).sin()).collect()),
            (find("path_speed"), vec![20.0; points]),
            (find("slip_angle"), swing),
        ];
        inputs.sort_by_key(|i| i.0);
        let mut run = Run {
            name: String::new(),
            time: (0..points).map(|k| 2e-3 * k as f64).collect(),
            drive: Arc::new(Drive::new(0.0, 2e-3, points, inputs)),
            channels: Vec::new(),
        };
        let watch: Arc<[usize]> = Arc::from([find("force_y")]);
        let mut traces =
            bench.run(&[Arc::default()], &[Arc::clone(&run.drive)], &watch).pop().unwrap().unwrap();
        let mut random = SplitMix64::new(3);
        let values = traces.remove(0).into_iter().map(|f| f + noise * random.normal()).collect();
        run.channels =
            vec![Channel { variable: find("force_y"), values, counts: false, unresolved: Vec::new() }];
        run
    }

    #[test]
    fn a_step_is_longer_where_noise_hides_it_and_nobody_has_set_it() {
        let mut subject = Subject::load("ring-brush-flat-track", &Settings::default()).unwrap();
        let bench = Bench::new(&subject.factory, &subject.fixed, 2).unwrap();
        let [noisy, clean, bouncing] =
            [(0.0, 30.0), (0.0, 0.01), (0.02, 30.0)].map(|(by, noise)| run(&subject, &bench, by, noise));
        let longer_step = |subject: &Subject, fit: &[&Run], check: &[&Run]| {
            LongerSteps::of(&bench, subject, fit, check).longer
        };
        let longer = longer_step(&subject, &[&noisy], &[]).unwrap();
        assert_eq!((longer.own, longer.step), (5e-4, 1e-3));
        // it makes a difference
        assert!(longer.change > 1e-4 && longer.change < SHARE, "{}", longer.change);
        let words = longer.words(&subject);
        assert!(words.contains("step_size = 0.001 s, not 0.0005 s"), "{words}");
        assert!(longer_step(&subject, &[&clean], &[]).is_none());
        // of check runs the inputs count, and not their noise
        assert!(longer_step(&subject, &[&noisy], &[&clean]).is_some());
        assert!(longer_step(&subject, &[&noisy], &[&bouncing]).is_none());
        // one run in three that is clean is told by the noise of the others
        assert!(longer_step(&subject, &[&noisy, &clean, &noisy], &[]).is_some());
        assert!(longer_step(&subject, &[&clean, &noisy, &clean], &[]).is_none());
        subject.fixed.push((longer.variable, Value::Real(5e-4)));
        assert!(longer_step(&subject, &[&noisy], &[]).is_none());
    }

    #[test]
    fn derivatives_with_a_longer_step_lead_to_the_same_place() {
        let subject = Subject::load("ring-brush-flat-track", &Settings::default()).unwrap();
        let bench = Bench::new(&subject.factory, &subject.fixed, 2).unwrap();
        let [noisy, clean] = [30.0, 0.01].map(|noise| run(&subject, &bench, 0.0, noise));
        // where recordings cannot tell, all is simulated with it
        let steps = |run: &Run| LongerSteps::of(&bench, &subject, &[run], &[]);
        assert!(steps(&noisy).longer.is_some() && steps(&noisy).of_changes.is_none());
        let LongerSteps { longer: None, of_changes: Some((variable, step)) } = steps(&clean) else {
            panic!("differences do not take the longer step");
        };
        assert_eq!(step, 1e-3);
        let stiffness = subject.interface.index("bristle_stiffness").unwrap();
        let Some(Value::Real(nominal)) = subject.interface.variables[stiffness].start else { unreachable!() };
        let problem = |values: Vec<(usize, f64)>, of_changes| OutputError {
            bench: &bench,
            runs: vec![&clean],
            knobs: vec![Knob::Parameter(stiffness, nominal)],
            values,
            attachments: Vec::new(),
            weights: vec![100.0],
            of_changes,
            is_coarse: false,
            beside: None,
            kept: Mutex::default(),
        };
        // they are others than those with the model's own step, but nearly the same
        let slope = |of_changes| {
            let problem = problem(Vec::new(), of_changes);
            let here = problem.residuals(&[vec![1.1]]).remove(0).unwrap();
            problem.changes(&[1.1], &here, &[vec![1.101]]).remove(0).unwrap()
        };
        let (by_own, by_quick) = (slope(None), slope(Some((variable, step))));
        let off = root_mean_square(by_own.iter().zip(&by_quick).map(|(a, b)| a - b));
        let size = root_mean_square(by_own.iter().copied());
        assert!(off > 0.0 && off < SHARE_OF_MOTION * size, "{off} of {size}");
        let (prior, reach) = (f64::INFINITY, f64::INFINITY);
        let unknown = Unknown { start: 1.1, mean: 1.0, low: 0.5, high: 2.0, step: 1e-3, prior, reach };
        let options = Options { tolerance: 1e-6, ..Options::default() };
        let fit = |problem| least_squares(&problem, &[unknown], options).unwrap().x[0];
        let own = fit(problem(Vec::new(), None));
        let quick = fit(problem(Vec::new(), Some((variable, step))));
        // while residuals with that step have another place
        let other = fit(problem(vec![(variable, step)], None));
        assert!(
            (own - 1.0).abs() < 1e-5 && (quick - own).abs() < 0.02 * (other - own).abs(),
            "{own} {quick} {other}"
        );
    }

    /// A swing of the slip angle on the Magic Formula tire, with noise of the lateral force by so much \[N\], with
    /// communication points so far apart \[s\].
    fn swing(subject: &Subject, bench: &Bench, step: f64, noise: f64) -> Run {
        let find = |name: &str| subject.interface.index(name).unwrap();
        let points = (2.0 / step).round() as usize + 1;
        let at = |k: usize| 0.05 * (40.0 * step * k as f64).sin();
        let mut inputs = vec![
            (find("load"), vec![4000.0; points]),
            (find("path_speed"), vec![20.0; points]),
            (find("slip_angle"), (0..points).map(at).collect()),
        ];
        inputs.sort_by_key(|i| i.0);
        let drive = Arc::new(Drive::new(0.0, step, points, inputs));
        let watch: Arc<[usize]> = Arc::from([find("force_y")]);
        let mut traces = bench.run(&[Arc::default()], &[Arc::clone(&drive)], &watch).pop().unwrap().unwrap();
        let mut random = SplitMix64::new(5);
        let sampled = traces.remove(0).into_iter().step_by((0.04 / step).round() as usize);
        let values: Vec<f64> = sampled.map(|f| f + noise * random.normal()).collect();
        let time = (0..values.len()).map(|k| 0.04 * k as f64).collect();
        Run {
            name: String::new(),
            time,
            drive,
            channels: vec![Channel {
                variable: find("force_y"),
                values,
                counts: false,
                unresolved: Vec::new(),
            }],
        }
    }

    #[test]
    fn communication_steps_are_as_short_as_noise_tells() {
        // four samples in a period: a straight line between two is far from the sine
        let subject = Subject::load("magic-formula-flat-track", &Settings::default()).unwrap();
        let bench = Bench::new(&subject.factory, &subject.fixed, 2).unwrap();
        let finer = |usual: f64, noise: f64| {
            let with =
                |finer: u32| Ok(vec![(swing(&subject, &bench, usual / f64::from(finer), noise), Use::Fit)]);
            ShorterSteps::of(&bench, &with(1).unwrap(), with).unwrap().map_or((1, None), |(shorter, runs)| {
                let drive = &runs[0].0.drive;
                assert_eq!(drive.step, usual / f64::from(shorter.finer));
                assert!(
                    shorter.is_enough && shorter.change <= SHARE && shorter.usual > SHARE,
                    "{}",
                    shorter.words()
                );
                (shorter.finer, drive.coarser.as_ref().map(|coarser| coarser.step))
            })
        };
        let each = [1000.0, 100.0, 10.0].map(|noise| finer(0.02, noise).0);
        assert!(each[0] == 1 && each.is_sorted() && each[2] > 1, "{each:?}");
        // the usual ones still tell how outputs change with an unknown, unless they are far from telling the outputs
        assert_eq!(finer(0.02, 10.0).1, Some(0.02));
        let (finer, coarser) = finer(0.04, 10.0);
        assert!(finer > 1 && coarser.is_none());
    }

    #[test]
    fn what_is_no_number_is_no_small_change() {
        let traces = |x: f64| vec![vec![vec![1.0, x]]];
        assert!(most_changed(&traces(f64::NAN), &traces(1.0), &[1.0]) > 1.0);
        assert!(most_changed(&traces(2.0), &traces(1.0), &[0.0]) > 1.0);
        assert_eq!(most_changed(&traces(1.0), &traces(1.0), &[0.0]), 0.0);
        assert!((most_changed(&traces(3.0), &traces(1.0), &[2.0]) - 0.5f64.sqrt()).abs() < 1e-12);
    }
}
