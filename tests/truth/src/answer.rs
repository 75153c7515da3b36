//! The sealed answers.

use serde::{Deserialize, Serialize};

/// What is true of a case.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Answer {
    /// Name of the case.
    pub case: String,
    /// `clear`, `faint`, `mix`, `null`, `parameters`, `fault`, `outside`, `decoy` or `mack`.
    pub kind: String,
    /// What sort of its kind it is: the id of an effect, a fault, `K1`.
    pub detail: String,
    /// Name of the base model.
    pub model: String,
    /// What is concealed.
    pub effects: Vec<Effect>,
    /// The fault of the recording, if any.
    pub fault: Option<String>,
    /// A wrong name that fits the fitting runs.
    pub decoys: Vec<String>,
    /// The true parameters.
    pub parameters: Vec<Parameter>,
    /// Parameters that have to be found, with the share by which they may be off.
    pub to_find: Vec<(String, f64)>,
}

/// One concealed effect.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Effect {
    /// Its id.
    pub id: String,
    /// Its family; empty outside of the catalogue.
    pub family: String,
    /// Channels that it changes most.
    pub channels: Vec<String>,
    /// Variables on which it depends; empty where no recorded one is to name.
    pub depends_on: Vec<String>,
    /// Ids that are right.
    pub accept: Vec<String>,
    /// Its size over the nominal one.
    pub size: f64,
    /// Largest rms over channels of what remains of it after a refit of the parameters, over the noise.
    pub over_noise: f64,
}

/// A parameter.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Parameter {
    /// Name.
    pub name: String,
    /// What the base model starts from.
    pub start: f64,
    /// What is true.
    pub value: f64,
}

/// What no model can explain: mean square of recorded minus noise-free truth.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Reference {
    /// Per run.
    pub runs: Vec<ReferenceRun>,
}

/// The floor of one run.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ReferenceRun {
    /// Name of its file.
    pub name: String,
    /// Number of samples.
    pub samples: usize,
    /// Per channel its name and mean square in the channel's unit.
    pub channels: Vec<(String, f64)>,
}
