//! A plan: which parameters are found together, from which readings under which conditions. Data, as TOML.

use crate::{Error, Result};
use serde::Deserialize;
use std::collections::BTreeMap;

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
    /// Registered [`Inversion`](super::registry::Inversion) in closed form.
    pub inversion: Option<String>,
    /// Positions in which parameters and targets are nested where the search needs it, the outermost first; else as they
    /// stand.
    #[serde(default)]
    pub nesting: Option<NestingPlan>,
    /// What is read, as many as there are parameters.
    #[serde(rename = "target")]
    pub targets: Vec<Target>,
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
    /// Reads a plan.
    ///
    /// # Errors
    /// No TOML, unknown entries, groups whose numbers of parameters and targets differ, conditions that are not there.
    pub fn read(text: &str) -> Result<Self> {
        let plan: Self = toml::from_str(text).map_err(|e| Error::file(e.to_string()))?;
        for group in &plan.groups {
            let (parameters, targets) = (group.parameters.len(), group.targets.len());
            if parameters != targets {
                return Err(Error::file(format!(
                    "group \"{}\": {targets} targets for {parameters} parameters; as many are needed",
                    group.name
                )));
            }
            for target in &group.targets {
                plan.condition(&target.condition)
                    .map_err(|e| e.at(format!("group \"{}\", target \"{}\"", group.name, target.name)))?;
            }
        }
        Ok(plan)
    }

    /// The condition of a name.
    ///
    /// # Errors
    /// There is none.
    pub fn condition(&self, name: &str) -> Result<&Condition> {
        self.conditions
            .iter()
            .find(|c| c.name == name)
            .ok_or_else(|| Error::file(format!("there is no condition \"{name}\"")))
    }
}
