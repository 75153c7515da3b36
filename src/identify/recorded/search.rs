//! The search for a plan's parameters that explain what was read from recordings, and what is known of them then.

use super::answer::Answer;
use super::estimate::Point;
use super::evidence::{Evidence, Read};
use super::matching::Moved;
use super::reduced::{Known, Reduced};
use super::scatter::side;
use super::suspicion;
use super::tangent::Tangent;
use super::unmet::Unmet;
use crate::identify::plan::Plan;
use crate::identify::readings::Readings;
use crate::identify::registry::{Numbers, Registry};
use crate::identify::solve::{Goal, Targets};
use crate::identify::stand::Stand;
use crate::recording::Recording;
use crate::{Error, Result};
use nalgebra::{DMatrix, DVector};
use std::collections::{BTreeMap, BTreeSet};

/// Rounds of corrections; one takes off a power of ten or two.
const ROUNDS: usize = 30;
/// They have come to rest where parameters move by less than this share of their range.
const AT_REST: f64 = 1e-7;
/// From here on Newton's method takes over: corrections that hardly depend on the parameters any more make it safe.
const NEAR: f64 = 0.02;
/// Derivatives are taken anew where a step with them leaves more than this share of the one before.
const SERVES: f64 = 0.3;
/// What rounding and a search that has come to rest leave of a target, as a share: it counts as met, and as no surer than that.
pub(super) const MISSED: f64 = 1e-4;
/// A target is met to rounding at this share of how sure it is.
const MET: f64 = 1e-9;
/// Steps of differences, as a share of a parameter's range: far above what rounding leaves of a stationary state, far below what
/// curves.
const STEP: f64 = 1e-4;

/// What it may be when nothing fits.
const LIKELY: &str = "Recordings of another tire, a wrong unit or sign, or physics that the model does not have: run `latsch diagnose` on them";

/// What is known before anything is measured.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Beforehand {
    /// Values of the model's parameters, known or guessed, in place of its own.
    pub values: Numbers,
    /// Of what is looked for, by name: the share of its value within which it is known, should recordings not tell it. Without,
    /// it may be anywhere in its range.
    pub within: Numbers,
}

/// Identifies what recordings tell of a plan's parameters.
///
/// # Errors
/// Recordings that cannot be understood or, unless the nearest parameters will do, that the model cannot explain: which, and
/// likely why.
pub fn identify(
    plan: &Plan,
    stand: &Stand,
    registry: Registry,
    beforehand: &Beforehand,
    unmet: Unmet,
    recordings: &[Recording],
) -> Result<Answer> {
    let start = &beforehand.values;
    let sought: BTreeSet<&String> = plan.groups.iter().flat_map(|g| &g.parameters).map(|p| &p.name).collect();
    if let Some(other) = beforehand.within.keys().find(|name| !sought.contains(name)) {
        return Err(Error::variable(format!("the plan does not look for {other}")));
    }
    let whole = Readings::new(plan, stand, registry, start)?;
    let evidence = Evidence::of(plan, &whole, &registry, stand.interface(), recordings, start)?;
    let mut reduced = Reduced::new(plan);
    for (target, why) in &evidence.missing {
        reduced.without_group_of(*target, why);
    }
    let mut search = Search {
        stand,
        registry,
        evidence: &evidence,
        numbers: start.clone(),
        offsets: Vec::new(),
        notes: Vec::new(),
        contradicted: Vec::new(),
    };
    search.offsets = vec![0.0; evidence.signals.inputs.len()];
    reduced.has_something()?;
    search.check_channels(&reduced.plan)?;
    let mut can_be_read = reduced.clone();
    reduced.drop_open(&search.known(&reduced.plan)?);
    let mut is_reopened = false;
    let known = loop {
        reduced.has_something()?;
        let refused = search.solve(&reduced.plan)?;
        if let Some((target, why)) = search.begins_in_contact(plan, &reduced.plan)? {
            can_be_read.without_group_of(target, &why);
            reduced.without_group_of(target, &why);
            continue;
        }
        let mut known = search.known(&reduced.plan)?;
        if reduced.drop_open(&known) {
            continue;
        }
        if !std::mem::replace(&mut is_reopened, true) {
            // what is not fixed where the search began may be where it ended
            let mut now = can_be_read.clone();
            now.drop_open(&search.known(&now.plan)?);
            if now.dropped.len() < reduced.dropped.len() {
                reduced = now;
                continue;
            }
        }
        for miss in search.missed(&reduced.plan, &known, refused)? {
            if miss.contradicts {
                if unmet == Unmet::Refused {
                    return Err(Error::numeric(format!(
                        "{}. {LIKELY}. The nearest parameters are found when they are asked for (--nearest)",
                        miss.told
                    )));
                }
                // as if it had been measured as badly as the model has it
                known.covariance[(miss.target, miss.target)] += (miss.by / known.side).powi(2);
                search.contradicted.push((miss.group, miss.brief));
            }
            search.notes.push(miss.told);
        }
        break known;
    };
    search.numbers = whole.with_what_is_held(&search.numbers, |name| reduced.drops(name))?;
    search.answer(plan, &reduced, &known, &beforehand.within)
}

/// What the model said, by condition and reading.
pub(super) type Asked = BTreeMap<(usize, usize), Vec<f64>>;

#[derive(Clone)]
pub(super) struct Search<'a> {
    /// The model.
    pub stand: &'a Stand,
    registry: Registry,
    /// What was recorded.
    pub evidence: &'a Evidence,
    /// Values of the model's parameters.
    pub numbers: Numbers,
    /// Offsets of the inputs.
    pub offsets: Vec<f64>,
    /// What is to be said of the answer.
    pub notes: Vec<String>,
    /// Groups of which a target contradicts the others, and how.
    pub contradicted: Vec<(String, String)>,
}

/// How sure things are, as standard deviations. What is nearest depends on it, and would not come to rest while it follows a model
/// that is not there yet.
pub(super) struct Sure {
    /// Each output, as a mean over a stretch.
    pub outputs: Vec<f64>,
    /// Each target.
    targets: Vec<f64>,
}

impl Search<'_> {
    /// A plan on the model with what is known of its parameters.
    pub fn model<'b>(&'b self, plan: &'b Plan) -> Result<Readings<'b>> {
        Readings::new(plan, self.stand, self.registry, &self.numbers)
    }

    /// The readings of a plan's targets, in their order.
    pub fn reads(&self, plan: &Plan) -> Result<Vec<Read>> {
        let names = plan.groups.iter().flat_map(|g| &g.targets).map(|t| &t.name);
        names
            .map(|name| {
                let found = self.evidence.targets.iter().find(|read| read.name == *name);
                found.cloned().ok_or_else(|| Error::file(format!("\"{name}\" is not read")))
            })
            .collect()
    }

    /// The points of a target as the model has them.
    pub fn simulated(&self, model: &Readings<'_>, read: &Read, numbers: &Numbers) -> Result<Vec<Point>> {
        self.simulated_once(model, read, numbers, &mut BTreeMap::new())
    }

    /// The same, where the model has not been asked before.
    pub fn simulated_once(
        &self,
        model: &Readings<'_>,
        read: &Read,
        numbers: &Numbers,
        asked: &mut Asked,
    ) -> Result<Vec<Point>> {
        let condition = &model.plan().conditions[read.condition];
        let mut points = Vec::new();
        for k in &read.members {
            let reading = &self.evidence.readings[*k];
            let outputs = match asked.get(&(read.condition, *k)) {
                Some(outputs) => outputs.clone(),
                None => model
                    .respond(condition, reading, &self.evidence.signals, &self.offsets, numbers)
                    .map_err(|e| e.at(self.evidence.place(reading)))?,
            };
            asked.insert((read.condition, *k), outputs.clone());
            points.push(Point { inputs: reading.point.inputs.clone(), outputs });
        }
        Ok(points)
    }

    /// Channels are what they are called.
    fn check_channels(&self, plan: &Plan) -> Result<()> {
        let model = self.model(plan)?;
        let numbers = model.model_values(&model.sought_values(&self.numbers)?)?;
        let reads: Vec<Read> = self.reads(plan)?.into_iter().filter(|r| !r.is_ramp(self.evidence)).collect();
        let simulated =
            reads.iter().map(|r| self.simulated(&model, r, &numbers)).collect::<Result<Vec<_>>>()?;
        suspicion::check_outputs(self.evidence, &reads, &simulated)
    }

    /// What was measured.
    pub fn measured(&self, read: &Read) -> Result<f64> {
        let value = read.factor * read.estimate.of(&self.evidence.points(read));
        if value.is_finite() {
            return Ok(value);
        }
        Err(Error::numeric(format!(
            "\"{}\" cannot be read from its {} readings",
            read.name,
            read.members.len()
        )))
    }

    /// What the model has in its place.
    pub fn modelled(&self, model: &Readings<'_>, reads: &[Read], numbers: &Numbers) -> Result<Vec<f64>> {
        let mut asked = BTreeMap::new();
        let mut value = |read: &Read| {
            let points = self.visited(model, read, numbers, &mut asked)?;
            Ok(read.factor * read.estimate.of(&points))
        };
        reads.iter().map(&mut value).collect()
    }

    /// The points of a target as the model has them, asked once for all readings at one place, at the mean of their inputs: estimates
    /// are means and straight lines through readings, so that what each of them is off by counts to second order only.
    pub fn visited(
        &self,
        model: &Readings<'_>,
        read: &Read,
        numbers: &Numbers,
        asked: &mut BTreeMap<(usize, Vec<usize>), Vec<f64>>,
    ) -> Result<Vec<Point>> {
        let condition = &model.plan().conditions[read.condition];
        let mut points = Vec::new();
        for visit in &read.visits {
            let reading = self.evidence.mean_of(visit);
            let key = (read.condition, visit.clone());
            let outputs = match asked.get(&key) {
                Some(outputs) => outputs.clone(),
                None => model
                    .respond(condition, &reading, &self.evidence.signals, &self.offsets, numbers)
                    .map_err(|e| e.at(self.evidence.place(&reading)))?,
            };
            asked.insert(key, outputs.clone());
            points.extend(std::iter::repeat_n(Point { inputs: reading.point.inputs, outputs }, visit.len()));
        }
        Ok(points)
    }

    /// Rounds of sequential identification, corrected by where the rig measured; near the answer by Newton's method. Where a
    /// group's targets cannot be met within its bounds, its parameters are the nearest to them, by how sure they are. Returns why
    /// they cannot, if the rounds end before Newton's method takes over.
    fn solve(&mut self, plan: &Plan) -> Result<Option<String>> {
        let reads = self.reads(plan)?;
        let measured: Vec<f64> = reads.iter().map(|r| self.measured(r)).collect::<Result<_>>()?;
        let (mut left, mut refused) = (f64::INFINITY, None);
        let (mut jacobian, mut sure) = (None, None::<Sure>);
        // how far Newton's last step went, while it goes on
        let mut newton: Option<f64> = None;
        let mut most = 0;
        for _ in 0..ROUNDS {
            self.offsets = self.find_offsets(plan, &reads, sure.as_ref())?;
            let model = self.model(plan)?;
            let at = model.sought_values(&self.numbers)?;
            let numbers = model.model_values(&at)?;
            let modelled = self.modelled(&model, &reads, &numbers)?;
            let bounds = model.bounds();
            let is_newton = left <= NEAR || newton.is_some();
            let next: Vec<f64> = if is_newton {
                let known = match jacobian.take() {
                    Some(jacobian) => jacobian,
                    None => self.jacobian(&model, &reads, &at)?,
                };
                let sure = match &sure {
                    Some(sure) => sure,
                    None => sure.insert(self.sure(&model, &reads, &numbers)?),
                };
                let goal = Goal { values: measured.clone(), sizes: sure.targets.clone(), tolerance: MET };
                let tangent = Tangent { bounds, at: &at, values: &modelled, jacobian: &known };
                let next = tangent.nearest(&goal, plan.groups.iter().map(|group| group.parameters.len()))?;
                (jacobian, refused) = (Some(known), None);
                next
            } else {
                let nominal = model.at(&at)?;
                let goal: Vec<f64> =
                    (0..at.len()).map(|k| measured[k] - (modelled[k] - nominal[k])).collect();
                let found = model.identify(&Goal::new(&goal));
                let found = found
                    .map_err(|why| Error::numeric(format!("no answer: {}. {LIKELY}", model.words(&why))))?;
                // the first corrections may ask for what cannot be; the last ones must not
                refused = found.unsolved.first().map(|(_, why)| model.words(why));
                found.parameters
            };
            let moved = |k: usize| (next[k] - at[k]).abs() / (bounds[k][1] - bounds[k][0]);
            most = (0..at.len()).max_by(|a, b| moved(*a).total_cmp(&moved(*b))).unwrap_or(0);
            let before = std::mem::replace(&mut left, moved(most));
            // the first step may be long, from what is nearest in itself to what is nearest by how sure targets are
            newton = (is_newton && newton.is_none_or(|last| left < last)).then_some(left);
            // derivatives of one place serve as long as they take off most of what is left
            if left > SERVES * before {
                jacobian = None;
            }
            let next = model.model_values(&next)?;
            drop(model);
            self.numbers.extend(next);
            if left <= AT_REST {
                return Ok(refused);
            }
        }
        let mut sought = plan.groups.iter().flat_map(|group| &group.parameters);
        let moving = sought.nth(most).map_or("", |parameter| &parameter.name);
        let why = match refused {
            Some(why) => format!("; in the last one {why}"),
            None => String::new(),
        };
        Err(Error::numeric(format!(
            "the corrections for where the rig measured do not come to rest: {moving} still moves by {left:.1e} of its range{why}. \
             The recordings were made too far from the plan's conditions, or the model cannot do what they show"
        )))
    }

    /// How sure outputs and targets are, with the parameters as they are.
    fn sure(&self, model: &Readings<'_>, reads: &[Read], numbers: &Numbers) -> Result<Sure> {
        let mut asked = BTreeMap::new();
        let scatter = self.scatter(model, reads, numbers, &mut asked)?;
        let covariance = self.covariance(model, reads, numbers, &scatter, &mut asked)?;
        Ok(Sure {
            outputs: scatter.sizes(false).to_vec(),
            targets: covariance.diagonal().iter().map(|variance| variance.sqrt()).collect(),
        })
    }

    /// A target that is read from ramps of which one began where the tire touched the road already, if there is one: by number,
    /// and which ramp. The model begins off the road.
    fn begins_in_contact(&self, plan: &Plan, reduced: &Plan) -> Result<Option<(usize, String)>> {
        for read in self.reads(reduced)? {
            let Some(ramp) = &reduced.conditions[read.condition].ramp else { continue };
            let input = self.evidence.signals.input(&ramp.input);
            let offset = input.map_or(0.0, |k| self.offsets[k]);
            for reading in read.members.iter().map(|k| &self.evidence.readings[*k]) {
                let Some(Moved { rate, begins, touch, .. }) = &reading.moved else { continue };
                let behind = (begins - offset - touch) * rate.signum();
                let mut names = plan.groups.iter().flat_map(|g| &g.targets);
                if let (true, Some(number)) = (behind > 0.0, names.position(|t| t.name == read.name)) {
                    let place = self.evidence.place(reading);
                    return Ok(Some((
                        number,
                        format!(
                            "the ramp in {place} begins {behind:.1e} behind where the tire touches the road"
                        ),
                    )));
                }
            }
        }
        Ok(None)
    }

    /// Derivatives of the model's readings (rows) by what is looked for (columns).
    fn jacobian(&self, model: &Readings<'_>, reads: &[Read], at: &[f64]) -> Result<DMatrix<f64>> {
        let mut jacobian = DMatrix::zeros(reads.len(), at.len());
        for k in 0..at.len() {
            let [(below, less), (above, more)] =
                beside(model, at, k, |numbers| Ok(DVector::from_vec(self.modelled(model, reads, numbers)?)))?;
            let column = (more - less) / (above - below);
            if let Some(row) = column.iter().position(|d| !d.is_finite()) {
                let mut sought = model.plan().groups.iter().flat_map(|group| &group.parameters);
                let name = sought.nth(k).map_or("", |parameter| &parameter.name);
                return Err(Error::numeric(format!(
                    "\"{}\" has no derivative by {name} at {:.4e}: the model does not answer near there",
                    reads[row].name, at[k]
                )));
            }
            jacobian.set_column(k, &column);
        }
        Ok(jacobian)
    }

    /// What the readings fix, with the parameters as they are.
    fn known(&self, plan: &Plan) -> Result<Known> {
        let reads = self.reads(plan)?;
        let model = self.model(plan)?;
        let at = model.sought_values(&self.numbers)?;
        let numbers = model.model_values(&at)?;
        let ranges: Vec<f64> = model.bounds().iter().map(|[low, high]| high - low).collect();
        let jacobian = self.jacobian(&model, &reads, &at)?;
        let mut asked = BTreeMap::new();
        let scatter = self.scatter(&model, &reads, &numbers, &mut asked)?;
        let covariance = self.covariance(&model, &reads, &numbers, &scatter, &mut asked)?;
        Ok(Known { jacobian, covariance, at, ranges, side: side(scatter.freedom()) })
    }
}

/// What depends on the parameters, a step to both sides of one of those that are looked for, and where that is: within its bounds,
/// also where it begins beyond them.
pub(super) fn beside<T>(
    whole: &Readings<'_>,
    sought: &[f64],
    k: usize,
    mut of: impl FnMut(&Numbers) -> Result<T>,
) -> Result<[(f64, T); 2]> {
    let [low, high] = whole.bounds()[k];
    let middle = sought[k].clamp(low, high);
    let mut at = |step: f64| {
        let mut moved = sought.to_vec();
        moved[k] = (middle + step * (high - low)).clamp(low, high);
        Ok::<_, Error>((moved[k], of(&whole.model_values(&moved)?)?))
    };
    Ok([at(-STEP)?, at(STEP)?])
}
