//! Cheap screening of many effects: how much of the residual each can explain at its off value, beyond
//! what the model's own parameters can.

mod columns;

use super::linear::{Linear, explain};
use super::placement::Placement;
use super::recalled::Recalled;
use super::span::{CLOSELY, ROUGHLY};
use super::study::Model;
use crate::effect::{Parameter, empirical};
use crate::fit::{Bench, Drive, OutputError, Run, Setup, Traces, side_by_side};
use crate::model::Interface;
use columns::thin;
use nalgebra::DVector;
use std::sync::Arc;

/// Rows of the linear problem at most.
const MAX_ROWS: usize = 12_000;
/// Combinations of shapes that are tried for one placement.
const MAX_SHAPES: usize = 6;
/// And where nothing has to be simulated.
const MAX_REPLAYED: usize = 240;

/// Named and nameless placements, each, that are screened with all runs, and the shapes of each.
const KEPT: usize = 30;
const KEPT_SHAPES: usize = 2;
/// Runs that all placements are screened with.
pub(super) const FIRST: usize = 2;

/// What screening knows: the model as fitted, its residual and sensitivities, and all its signals.
pub struct Screen<'a> {
    bench: &'a Bench,
    /// Runs that are looked at.
    runs: Vec<&'a Run>,
    /// The model as fitted.
    model: &'a Model,
    /// Its setup.
    setup: Setup,
    /// Weights of the channels.
    weights: &'a [f64],
    /// Indices of the traced variables.
    watch: Arc<[usize]>,
    /// Their traces in each run.
    pub traces: Vec<Traces>,
    /// Of each run: derivatives by the fitted parameters, and measured minus simulated; weighted.
    parameters: Vec<Column>,
    residual: Column,
    /// Every how many samples count.
    stride: usize,
}

/// A change of the weighted outputs, run by run.
type Column = Vec<DVector<f64>>;

/// A placement with its best shape, by linear prediction.
#[derive(Debug, Clone)]
pub struct Screened {
    /// Where.
    pub placement: Placement,
    /// Parameters, as multiples of their scales.
    pub values: Vec<f64>,
    /// Parameters of the sizes and shapes with which it explains something as a whole, the best first.
    pub wholes: Vec<Vec<f64>>,
    /// Share of the squared residual that it explains.
    pub gain: f64,
    /// Number of places at which the effect was looked for, and at which all effects were.
    pub places: usize,
    pub all_places: usize,
}

/// A form of an effect at a placement, by number.
#[derive(Debug, Clone)]
struct Probe {
    placement: usize,
    /// Parameters where the effect is off; or all of them, of one that is tried as a whole: what sticks or touches
    /// answers to a small amplitude as if it did not.
    shape: Vec<f64>,
    /// Which of them are amplitudes, each with a column of its own; none of a whole, which has one.
    amplitudes: Vec<usize>,
}

impl Probe {
    fn is_whole(&self) -> bool {
        self.amplitudes.is_empty()
    }

    /// What is simulated for it: an amplitude by number, or all of it.
    fn jobs(&self) -> impl Iterator<Item = (&Self, Option<usize>)> {
        let whole = self.is_whole().then_some((self, None));
        self.amplitudes.iter().map(move |i| (self, Some(*i))).chain(whole)
    }
}

/// What a probe explains.
struct Explained {
    /// Share of the squared residual, with amounts of any size,
    gain: f64,
    /// with amounts that are looked for,
    inside: f64,
    /// and these, of its amplitudes.
    amounts: Vec<f64>,
}

impl<'a> Screen<'a> {
    /// Prepares: traces of all signals and the linear problem of the fitted parameters.
    ///
    /// `problem` is that of the model on the runs, `point` where it stands, `steps` those of differences by the unknowns that
    /// can still explain something, by number, `simulated` what it gives there. Every `stride`th sample counts, or as many as
    /// are needed.
    #[allow(clippy::too_many_arguments)] // one caller
    pub fn new(
        problem: &OutputError<'a>,
        simulated: &[Traces],
        model: &'a Model,
        point: &[f64],
        steps: &[(usize, f64)],
        watch: Arc<[usize]>,
        weights: &'a [f64],
        stride: Option<usize>,
    ) -> Option<Self> {
        let runs = problem.runs.clone();
        let drives: Vec<Arc<Drive>> = runs.iter().map(|r| Arc::clone(&r.drive)).collect();
        let setup = problem.setup(point);
        let traces: Option<Vec<Traces>> = problem
            .bench
            .run(&[Arc::new(setup.clone())], &drives, &watch)
            .into_iter()
            .map(std::result::Result::ok)
            .collect();
        let mut points = vec![point.to_vec()];
        for (i, step) in steps {
            let mut moved = point.to_vec();
            moved[*i] += step;
            points.push(moved);
        }
        let rows: usize = runs.iter().map(|r| r.time.len() * r.channels.len()).sum();
        let stride = stride.unwrap_or_else(|| rows.div_ceil(MAX_ROWS).max(1));
        let by_run = |simulated: &[Traces]| -> Column {
            let mut rest = &problem.difference(simulated)[..];
            let of = |run: &&Run| {
                let (own, others) = rest.split_at(run.time.len() * run.channels.len());
                rest = others;
                thin(own, stride)
            };
            runs.iter().map(of).collect()
        };
        let mut answers = problem.simulate(&points).into_iter();
        let base = by_run(&answers.next()??);
        let residual = by_run(simulated).into_iter().map(|r| -r).collect();
        let derivative = |(answer, (_, step)): (Option<Vec<Traces>>, &(usize, f64))| -> Option<Column> {
            let moved = by_run(&answer?);
            Some(moved.iter().zip(&base).map(|(a, b)| (a - b) / *step).collect())
        };
        let parameters = answers.zip(steps).filter_map(derivative).collect();
        Some(Self {
            bench: problem.bench,
            runs,
            model,
            setup,
            weights,
            watch,
            traces: traces?,
            parameters,
            residual,
            stride,
        })
    }

    /// Every how many samples count.
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// The share that each placement explains, the best first: all roughly with two runs, of which answers are recalled where
    /// they are known and kept for later, and the best of them closely with all runs, in the forms that explain most.
    pub fn screen(
        &self,
        interface: &Interface,
        placements: &[Placement],
        recalled: &mut Recalled,
    ) -> Vec<Screened> {
        let probes = self.probes(placements);
        let count = FIRST.min(self.runs.len());
        let samples: Vec<usize> = self.runs.iter().take(count).map(|run| run.time.len()).collect();
        let jobs: Vec<(&Probe, Option<usize>)> = probes.iter().flat_map(Probe::jobs).collect();
        let known: Vec<Option<Column>> = jobs
            .iter()
            .map(|(probe, amplitude)| {
                let placement = &placements[probe.placement];
                recalled.answer(placement, &probe.shape, *amplitude, &samples, self.weights)
            })
            .collect();
        let columns = self.columns(interface, placements, &probes, 0..count, (ROUGHLY, known));
        for ((probe, amplitude), column) in jobs.iter().zip(&columns) {
            let placement = &placements[probe.placement];
            if let (false, Some(column)) = (self.is_replayed(placement), column) {
                recalled.keep(placement, &probe.shape, *amplitude, column);
            }
        }
        let explained = self.explained(placements, &probes, &columns);
        let first = best_of_each(placements, &probes, &explained);
        let mut forms: Vec<Vec<(f64, usize)>> = vec![Vec::new(); placements.len()];
        for (k, (probe, explained)) in probes.iter().zip(&explained).enumerate() {
            forms[probe.placement].extend(explained.iter().map(|e| (e.gain, k)));
        }
        let best = |named: bool| {
            let same = first.iter().filter(move |s| empirical::is(s.placement.effect) != named);
            same.take(KEPT).filter_map(|s| placements.iter().position(|p| p.is_same(&s.placement)))
        };
        let mut chosen: Vec<usize> = Vec::new();
        for placement in best(true).chain(best(false)) {
            let own = &mut forms[placement];
            own.sort_by(|a, b| b.0.total_cmp(&a.0));
            for whole in [false, true] {
                let alike = own.iter().filter(|(_, k)| probes[*k].is_whole() == whole);
                chosen.extend(alike.take(KEPT_SHAPES).map(|(_, k)| k));
            }
        }
        chosen.sort_unstable();
        chosen.dedup();
        let kept: Vec<Probe> = chosen.iter().map(|k| probes[*k].clone()).collect();
        let columns = self.columns(interface, placements, &kept, 0..self.runs.len(), (CLOSELY, Vec::new()));
        best_of_each(placements, &kept, &self.explained(placements, &kept, &columns))
    }

    /// The forms of each effect that are tried.
    fn probes(&self, placements: &[Placement]) -> Vec<Probe> {
        let mut probes = Vec::new();
        for (number, placement) in placements.iter().enumerate() {
            let parameters = placement.effect.parameters;
            let amplitudes: Vec<usize> =
                (0..parameters.len()).filter(|i| parameters[*i].off.is_some()).collect();
            let mut shapes: Vec<Vec<f64>> = vec![parameters.iter().map(|p| p.off.unwrap_or(0.0)).collect()];
            for (i, parameter) in parameters.iter().enumerate().filter(|(_, p)| p.off.is_none()) {
                shapes = shapes
                    .iter()
                    .flat_map(|shape| {
                        parameter.probes.iter().map(move |probe| {
                            let mut shape = shape.clone();
                            shape[i] = *probe;
                            shape
                        })
                    })
                    .collect();
            }
            // an even choice if there are too many
            let most = if self.is_replayed(placement) { MAX_REPLAYED } else { MAX_SHAPES };
            let skip = shapes.len().div_ceil(most).max(1);
            let probe = |shape: Vec<f64>| Probe { placement: number, shape, amplitudes: amplitudes.clone() };
            for shape in shapes.into_iter().step_by(skip) {
                let whole = |values| Probe { placement: number, shape: values, amplitudes: Vec::new() };
                let wholes = wholes(placement, &shape);
                let skip = wholes.len().div_ceil(most).max(1);
                probes.extend(wholes.into_iter().step_by(skip).map(whole));
                probes.push(probe(shape));
            }
        }
        probes
    }

    /// What each probe explains of the runs that its columns have.
    fn explained(
        &self,
        placements: &[Placement],
        probes: &[Probe],
        columns: &[Option<Column>],
    ) -> Vec<Option<Explained>> {
        let count = columns.iter().flatten().map(Vec::len).next().unwrap_or(0);
        let parameters: Vec<DVector<f64>> = self.parameters.iter().map(|c| joined(c, count)).collect();
        let linear = Linear::new(joined(&self.residual, count), &parameters);
        let residual = &linear.residual;
        let total = residual.norm_squared().max(f64::MIN_POSITIVE);
        let mut first = 0;
        let own: Vec<(&Probe, &[Option<Column>])> = (probes.iter())
            .map(|probe| {
                let own = &columns[first..first + probe.jobs().count()];
                first += own.len();
                (probe, own)
            })
            .collect();
        let of = |(probe, own): &(&Probe, &[Option<Column>])| -> Option<Explained> {
            let own: Vec<DVector<f64>> =
                own.iter().map(|c| Some(joined(c.as_ref()?, count))).collect::<Option<_>>()?;
            let clean: Vec<DVector<f64>> = own.iter().map(|c| linear.clean(c)).collect();
            if let ([change], true) = (&clean[..], probe.is_whole()) {
                let gain = 1.0 - (residual - change).norm_squared() / total;
                return (gain > 0.0).then_some(Explained { gain, inside: gain, amounts: Vec::new() });
            }
            let placement = &placements[probe.placement];
            let explain = |room: fn(&Placement, usize) -> (f64, f64)| {
                let rooms: Vec<(f64, f64)> = probe.amplitudes.iter().map(|i| room(placement, *i)).collect();
                explain(&clean, &own, residual, &rooms)
            };
            let (gain, _) = explain(room)?;
            let (inside, amounts) = explain(searched)?;
            Some(Explained { gain: gain / total, inside: inside / total, amounts })
        };
        side_by_side(self.bench.threads(), &own, of).into_iter().map(Option::flatten).collect()
    }
}

/// The first runs of a column, one below the other.
fn joined(column: &Column, count: usize) -> DVector<f64> {
    let runs = &column[..count.min(column.len())];
    DVector::from_iterator(runs.iter().map(DVector::len).sum(), runs.iter().flat_map(|r| r.iter().copied()))
}

/// Parameters of an effect as a whole: its amplitudes at each of the sizes that they say may be tried, with one shape.
fn wholes(placement: &Placement, shape: &[f64]) -> Vec<Vec<f64>> {
    let parameters = placement.effect.parameters;
    let sizes = |p: &Parameter| p.off.map_or(0, |_| p.probes.len().saturating_sub(1));
    let count = parameters.iter().map(sizes).max().unwrap_or(0);
    let at = |size: usize| {
        let value = |(p, value): (&Parameter, &f64)| match p.off {
            Some(off) => p.probes.get(size + 1).map_or(off, |amount| off + amount),
            None => *value,
        };
        parameters.iter().zip(shape).map(value).collect()
    };
    (0..count).map(at).collect()
}

/// What the best form of each placement explains, with the form that explains most within where amplitudes are looked for; the best
/// placement first. A form that is near none of what an effect does, such as a Maxwell element that yields at once, explains as much as a
/// better one if it is many times as large, and no fit begins well there.
fn best_of_each(
    placements: &[Placement],
    probes: &[Probe],
    explained: &[Option<Explained>],
) -> Vec<Screened> {
    let mut forms: Vec<Vec<(&Probe, &Explained)>> = vec![Vec::new(); placements.len()];
    for (probe, explained) in probes.iter().zip(explained) {
        forms[probe.placement].extend(explained.iter().map(|e| (probe, e)));
    }
    let of = |(placement, forms): (&Placement, &Vec<(&Probe, &Explained)>)| {
        let first = |a: f64, b: f64| b.total_cmp(&a);
        let (probe, inside) = forms.iter().min_by(|a, b| first(a.1.inside, b.1.inside))?;
        let mut values = probe.shape.clone();
        for (i, amount) in probe.amplitudes.iter().zip(&inside.amounts) {
            values[*i] = placement.effect.parameters[*i].off.unwrap_or(0.0) + amount;
        }
        let mut wholes: Vec<(f64, &[f64])> =
            (forms.iter().filter(|(p, _)| p.is_whole())).map(|(p, e)| (e.gain, &p.shape[..])).collect();
        wholes.sort_by(|a, b| first(a.0, b.0));
        Some(Screened {
            placement: placement.clone(),
            values,
            wholes: wholes.iter().map(|(_, shape)| shape.to_vec()).collect(),
            gain: forms.iter().map(|(_, e)| e.gain).fold(0.0, f64::max),
            places: 1,
            all_places: 1,
        })
    };
    let mut found: Vec<Screened> = placements.iter().zip(&forms).filter_map(of).collect();
    found.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    found
}

/// How far an amplitude may go from where the effect is off to be what its name says: what only the reverse would explain, or
/// more of it than there can be, is not promised. A natural size is a guess, and limits nothing but the sign.
fn room(placement: &Placement, amplitude: usize) -> (f64, f64) {
    let parameter = &placement.effect.parameters[amplitude];
    let off = parameter.off.unwrap_or(0.0);
    if empirical::is(placement.effect) {
        return (parameter.search.0 - off, parameter.search.1 - off);
    }
    let (low, high) = ((parameter.plausible.0 - off).min(0.0), (parameter.plausible.1 - off).max(0.0));
    if parameter.scale.is_plain() {
        return (low, high);
    }
    (if low < 0.0 { f64::NEG_INFINITY } else { 0.0 }, if high > 0.0 { f64::INFINITY } else { 0.0 })
}

/// The same, within where the amplitude is looked for.
fn searched(placement: &Placement, amplitude: usize) -> (f64, f64) {
    let parameter = &placement.effect.parameters[amplitude];
    let off = parameter.off.unwrap_or(0.0);
    let (low, high) = room(placement, amplitude);
    (low.max(parameter.search.0 - off), high.min(parameter.search.1 - off))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Port;

    #[test]
    fn a_fit_begins_with_the_form_that_explains_most_within_what_is_looked_for() {
        let effect = crate::effect::find("maxwell-element").unwrap();
        let (most, shapes) = (effect.parameters[0].search.1, effect.parameters[1].probes.len());
        let placement = Placement {
            effect,
            port: Port::Force,
            targets: vec![0],
            drivers: Vec::new(),
            scales: vec![1.0; 2],
            units: vec![None; 2],
            bounded: false,
        };
        let probe = |time: f64| Probe { placement: 0, shape: vec![0.0, time], amplitudes: vec![0] };
        // what yields at once is a damper: it explains as much as any, if it is stiffer than anything that is looked for
        let probes: Vec<Probe> = effect.parameters[1].probes.iter().map(|t| probe(*t)).collect();
        let of = |(k, _): (usize, &Probe)| {
            let inside = if k == 0 { 0.2 } else { 0.7 - 0.1 * k as f64 };
            let amounts = vec![if k == 0 { most } else { 0.5 }];
            Some(Explained { gain: 0.7 - 0.01 * k as f64, inside, amounts })
        };
        let explained: Vec<Option<Explained>> = probes.iter().enumerate().map(of).collect();
        let [best] = &best_of_each(&[placement], &probes, &explained)[..] else { panic!("one placement") };
        assert!(shapes > 2 && best.gain == 0.7, "{}", best.gain);
        assert_eq!(best.values, [0.5, effect.parameters[1].probes[1]]);
    }
}
