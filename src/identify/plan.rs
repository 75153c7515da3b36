//! A plan: which parameters are found together, from which readings under which conditions. Data, as TOML.

use super::like::parse;
use super::programme::Programme;
use crate::model::did_you_mean;
use crate::{Error, Result};
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};

/// A plan of a sequential identification.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    /// Name of the model that it is for.
    pub model: String,
    /// What it is, in a line.
    pub title: String,
    /// Values of the model's variables wherever no condition says otherwise.
    #[serde(default)]
    pub set: BTreeMap<String, f64>,
    /// What the rig has to do.
    #[serde(rename = "condition")]
    pub conditions: Vec<Condition>,
    /// Parameters that are found together, in the order in which they are found.
    #[serde(rename = "group")]
    pub groups: Vec<GroupPlan>,
    /// What recordings of a rig need besides; without, there is a plan for known target values only.
    pub recordings: Option<Recordings>,
    /// The measurement programme.
    pub programme: Option<Programme>,
}

/// How recordings are to be understood.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recordings {
    /// Channels that measure an input that is no motion: the load is what the load cell says.
    #[serde(default)]
    pub measured_by: BTreeMap<String, String>,
    /// The condition in which responses are known, from which the offsets of their channels are found: a tire off the road.
    pub zero: String,
    /// Inputs whose channels may have an offset that is not known, and the standard deviation of what it may be.
    pub offsets: BTreeMap<String, f64>,
    /// By how much each input may change while it is held.
    pub held_within: BTreeMap<String, f64>,
}

/// What a rig has to do for a reading (a functional condition, (3.3)).
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Condition {
    /// Its name, to which readings refer.
    pub name: String,
    /// Inputs and their values.
    #[serde(default)]
    pub hold: BTreeMap<String, f64>,
    /// Responses that other inputs have to bring about, all at once.
    #[serde(default)]
    pub reach: Vec<Reach>,
    /// An input that is held where the tire touches the road, more what [`hold`](Self::hold) says.
    pub from_touch: Option<Touch>,
    /// What has to hold of the state that is read.
    #[serde(default)]
    pub require: Vec<Require>,
    /// What moves after all that, up to the reading.
    pub ramp: Option<Ramp>,
    /// Inputs of which the limit at 0 is meant: the reading is extrapolated from what is held and half of it.
    #[serde(default)]
    pub limit: Vec<Limit>,
    /// Where the inputs of a recorded stretch have to be for it to be one of this condition, which it may meet elsewhere than
    /// what is held: readings are corrected by what the model says of the difference.
    #[serde(default)]
    pub recorded: BTreeMap<String, [f64; 2]>,
    /// Why no recording can be one of this condition.
    pub not_recorded: Option<String>,
}

/// A response that an input brings about (text at (3.5)).
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reach {
    /// The output, or the name of a registered [`Functional`](super::registry::Functional).
    pub read: String,
    /// The value that it has to have.
    pub value: f64,
    /// The input that brings it about,
    pub by: String,
    /// and where it is looked for.
    pub between: [f64; 2],
    /// The first place from the lower end on, of so many intervals, is meant; otherwise there is only one.
    #[serde(default)]
    pub first_of: usize,
}

/// Where an input makes an output leave the value that it has at one end of a range.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Touch {
    /// The input.
    pub input: String,
    /// The output.
    pub output: String,
    /// From where on, and up to where, it is looked for.
    pub between: [f64; 2],
    /// By how much the output has left.
    pub by: f64,
}

/// Bounds of an output outside of which a reading does not mean what the plan takes it for.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Require {
    /// The output.
    pub output: String,
    /// Where it has to be.
    pub between: [f64; 2],
    /// Why.
    pub why: String,
}

/// An input that moves with a constant rate.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ramp {
    /// The input.
    pub input: String,
    /// Its rate, in its unit per second.
    pub rate: f64,
    /// For how long \[s\].
    pub time: f64,
    /// Communication step \[s\].
    pub step: f64,
    /// Of recordings, what is read is the mean while the input is between these, from where the tire touches.
    pub window: Option<[f64; 2]>,
}

/// An input of which a limit is meant.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limit {
    /// The input.
    pub input: String,
    /// The power with which the reading differs from its limit.
    pub order: i32,
}

/// A group of parameters.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroupPlan {
    /// What it is about.
    pub name: String,
    /// What is looked for: parameters of the model, or what `transform` makes them of.
    pub parameters: Vec<Sought>,
    /// Registered [`Transform`](super::registry::Transform) from what is looked for to the model's parameters.
    pub transform: Option<String>,
    /// Of what the transform takes, places that are not looked for, and their values.
    #[serde(default)]
    pub fixed: BTreeMap<usize, f64>,
    /// Registered [`Inversion`](super::registry::Inversion) in closed form.
    pub inversion: Option<String>,
    /// Positions in which parameters and targets are nested where the search needs it, the outermost first; else as they
    /// stand.
    #[serde(default)]
    pub nesting: Option<NestingPlan>,
    /// How it is solved; without, in closed form where there is one, else by descent and, where that does not meet the targets,
    /// by nested bisection.
    #[serde(default)]
    pub solver: Option<Solver>,
    /// What is read, as many as there are parameters.
    #[serde(rename = "target")]
    pub targets: Vec<Target>,
}

/// How a group is solved that is to be solved in one way only.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Solver {
    /// [`nested`](super::solve::nested) at once: for targets that have no derivatives.
    NestedBisection,
    /// [`Method::Newton`](super::solve::Method::Newton) with step control and projection.
    Newton,
    /// [`Method::Gradient`](super::solve::Method::Gradient), likewise.
    Gradient,
}

/// What is looked for, with its bounds.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sought {
    /// Its name.
    pub name: String,
    /// Least and largest value.
    pub bounds: [f64; 2],
}

/// Signs with which targets respond (3.32), (3.41).
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NestingPlan {
    /// For each target in the order of nesting: 1 if it rises with its parameter while the later ones are met, or -1.
    pub rises: Vec<f64>,
    /// `falls[j][r]`: 1 if parameter r falls while parameter j rises and targets after j are met, or -1.
    pub falls: Vec<Vec<f64>>,
    /// The last two are solved together; 1 if the second-last target rises with the third-last parameter and the last falls,
    /// or -1.
    pub tail: Option<f64>,
}

/// What is read under a condition (an evaluation functional).
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Target {
    /// What it is, with its unit.
    pub name: String,
    /// The condition.
    pub condition: String,
    /// The output, or the name of a registered functional.
    pub read: String,
    /// The input along which its slope is meant; else its value.
    pub along: Option<String>,
    /// Factor on it: -1 where the source counts it the other way round.
    #[serde(default = "one")]
    pub factor: f64,
}

fn one() -> f64 {
    1.0
}

impl Plan {
    /// Reads a plan. With `like = "NAME"` it is the shipped one of that name, but for what it says: conditions, groups and runs take
    /// the place of those of the same name.
    ///
    /// # Errors
    /// No TOML, unknown entries, groups whose numbers of parameters and targets differ, conditions that are not there, ranges
    /// that are none, and whatever else cannot be followed on any model.
    pub fn read(text: &str) -> Result<Self> {
        let plan = parse(text)?;
        finite(&plan.set)?;
        for condition in &plan.conditions {
            condition.check().map_err(|e| e.at(format!("condition \"{}\"", condition.name)))?;
        }
        different("condition", plan.conditions.iter().map(|c| &c.name))?;
        for group in &plan.groups {
            group.check(&plan).map_err(|e| e.at(format!("group \"{}\"", group.name)))?;
        }
        plan.check_target_names()?;
        if let Some(recordings) = &plan.recordings {
            recordings.check(&plan).map_err(|e| e.at("recordings"))?;
        }
        different("parameter", plan.groups.iter().flat_map(|g| &g.parameters).map(|p| &p.name))?;
        Ok(plan)
    }

    /// The condition of a name.
    ///
    /// # Errors
    /// There is none.
    pub fn condition(&self, name: &str) -> Result<&Condition> {
        self.conditions.iter().find(|c| c.name == name).ok_or_else(|| {
            let hint = did_you_mean(name, self.conditions.iter().map(|c| c.name.as_str()));
            Error::file(format!("there is no condition \"{name}\"{hint}"))
        })
    }

    /// What was read is known by its target's name: two with one name would get one number.
    fn check_target_names(&self) -> Result<()> {
        let mut seen: BTreeMap<&str, &str> = BTreeMap::new();
        for group in &self.groups {
            for target in &group.targets {
                if let Some(other) = seen.insert(&target.name, &group.name) {
                    return Err(Error::file(format!(
                        "target \"{}\" is there twice, in group \"{other}\" and in group \"{}\": each needs a name of its own",
                        target.name, group.name
                    )));
                }
            }
        }
        Ok(())
    }
}

impl Recordings {
    /// Its condition is there, and its widths are numbers.
    fn check(&self, plan: &Plan) -> Result<()> {
        plan.condition(&self.zero).map_err(|e| e.at("zero"))?;
        for (entry, widths) in [("offsets", &self.offsets), ("held_within", &self.held_within)] {
            let wrong = widths.iter().find(|(_, width)| !(**width >= 0.0 && width.is_finite()));
            if let Some((name, width)) = wrong {
                return Err(Error::file(format!(
                    "{entry}: {name} = {width}: a width of at least 0 is needed"
                )));
            }
        }
        Ok(())
    }
}

impl Condition {
    /// What it asks for can be asked of a rig.
    fn check(&self) -> Result<()> {
        finite(&self.hold)?;
        self.reach.iter().try_for_each(|r| range(&r.by, r.between))?;
        if let [first, second, ..] = &self.reach.iter().filter(|r| r.first_of > 0).collect::<Vec<_>>()[..] {
            return Err(Error::file(format!(
                "the first place is asked for by {} and by {}: one of them can be meant, the other needs a place that is the only one (no first_of)",
                first.by, second.by
            )));
        }
        different("reach by", self.reach.iter().map(|r| &r.by))?;
        self.from_touch.iter().try_for_each(|t| range(&t.input, t.between))?;
        self.require.iter().try_for_each(|r| range(&r.output, r.between))?;
        self.recorded.iter().try_for_each(|(input, between)| range(input, *between))?;
        if let Some(ramp) = &self.ramp {
            let times = ramp.step > 0.0 && ramp.step <= ramp.time && ramp.time.is_finite();
            if !times || !ramp.rate.is_finite() {
                return Err(Error::file(format!(
                    "{} moves with {} for {} s in steps of {} s: a finite rate, a time and a step of it are needed",
                    ramp.input, ramp.rate, ramp.time, ramp.step
                )));
            }
        }
        for limit in &self.limit {
            if limit.order < 1 || !self.hold.contains_key(&limit.input) {
                return Err(Error::file(format!(
                    "the limit of order {} in {}: a held input and an order of at least 1 are needed",
                    limit.order, limit.input
                )));
            }
        }
        Ok(())
    }
}

impl GroupPlan {
    /// All that the transform takes, from what is looked for.
    pub(super) fn whole(&self, sought: &[f64]) -> Vec<f64> {
        let mut rest = sought.iter().copied();
        let count = sought.len() + self.fixed.len();
        let value = |k: usize| self.fixed.get(&k).copied().or_else(|| rest.next());
        (0..count).map_while(value).collect()
    }

    /// What is looked for, of all that the transform takes.
    pub(super) fn sought(&self, whole: &[f64]) -> Vec<f64> {
        whole.iter().enumerate().filter(|(k, _)| !self.fixed.contains_key(k)).map(|(_, v)| *v).collect()
    }

    fn check(&self, plan: &Plan) -> Result<()> {
        let size = self.parameters.len();
        if size == 0 || size != self.targets.len() {
            let targets = self.targets.len();
            return Err(Error::file(format!(
                "{targets} targets for {size} parameters; as many are needed, and one at least"
            )));
        }
        if let (Some(_), Some(inversion)) = (self.solver, &self.inversion) {
            return Err(Error::file(format!(
                "solver: the inversion \"{inversion}\" solves this group; one of the two has to go"
            )));
        }
        self.parameters.iter().try_for_each(|p| range(&p.name, p.bounds))?;
        for target in &self.targets {
            plan.condition(&target.condition).map_err(|e| e.at(format!("target \"{}\"", target.name)))?;
        }
        self.nesting.iter().try_for_each(|nesting| nesting.check(size))
    }
}

impl NestingPlan {
    /// There is a sign for each of `size` targets and pairs.
    fn check(&self, size: usize) -> Result<()> {
        let whole = self.rises.len() == size
            && self.falls.len() == size
            && self.falls.iter().all(|row| row.len() == size)
            && (self.tail.is_none() || size > 2);
        let falls = self.falls.iter().enumerate().flat_map(|(j, row)| row.iter().skip(j + 1));
        let mut signs = self.rises.iter().chain(falls).chain(&self.tail);
        if whole && signs.all(|s| s.abs() == 1.0) {
            return Ok(());
        }
        Err(Error::file(format!(
            "nesting: {size} signs in rises, {size} rows of {size} in falls, and a tail for more than two parameters only; each 1 or \
             -1 (in falls above the diagonal)"
        )))
    }
}

pub(super) fn range(name: &str, [low, high]: [f64; 2]) -> Result<()> {
    if low < high && low.is_finite() && high.is_finite() {
        return Ok(());
    }
    Err(Error::file(format!("{name}: {low} to {high} is no range")))
}

pub(super) fn finite(values: &BTreeMap<String, f64>) -> Result<()> {
    let wrong = values.iter().find(|(_, value)| !value.is_finite());
    wrong.map_or(Ok(()), |(name, value)| {
        Err(Error::file(format!("{name} = {value} is no number that can be set")))
    })
}

fn different<'a>(what: &str, names: impl Iterator<Item = &'a String>) -> Result<()> {
    let mut seen = BTreeSet::new();
    for name in names {
        if !seen.insert(name) {
            return Err(Error::file(format!("{what} \"{name}\" is there twice")));
        }
    }
    Ok(())
}
