//! The sealed answers.

use crate::fault::Struck;
use crate::recording::file_name;
use serde::{Deserialize, Serialize};
use std::fmt::{self, Display, Formatter};

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
    pub fault: Option<Fault>,
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
    /// Its parameters as its name has them, in SI units, where its law is the same as that of the name.
    pub amounts: Vec<(String, f64)>,
}

/// A fault of the recording.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Fault {
    /// Its name.
    pub name: String,
    /// The channels that it struck; none where it struck all that was recorded.
    pub channels: Vec<String>,
    /// The files in which it is; none where it is in all.
    pub runs: Vec<String>,
}

impl Fault {
    /// What was struck, with the names of the channels.
    #[must_use]
    pub fn of(name: &str, struck: Struck, channel: impl Fn(usize) -> String) -> Self {
        Self {
            name: name.to_owned(),
            channels: struck.channels.into_iter().map(channel).collect(),
            runs: struck.runs.into_iter().map(file_name).collect(),
        }
    }
}

impl Display for Fault {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.name)?;
        let list = self.channels.iter().chain(&self.runs).map(String::as_str).collect::<Vec<_>>().join(" ");
        if list.is_empty() { Ok(()) } else { write!(f, " in {list}") }
    }
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
