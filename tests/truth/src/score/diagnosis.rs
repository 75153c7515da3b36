//! What a diagnosis said: the part of `diagnosis.json` that is judged.

use serde::Deserialize;

/// `diagnosis.json`. What is not judged is not read; what is absent is empty.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(default)]
pub struct Diagnosis {
    /// `nothing`, `parameters`, `recording`, `effect`, `family`, `unknown`.
    pub verdict: String,
    /// What was found, the best first.
    pub findings: Vec<Finding>,
    /// Errors on the checking runs.
    pub check: Vec<Check>,
    /// Parameters after the refit.
    pub parameters: Vec<Parameter>,
    /// What the runs were used for.
    pub runs: Vec<RunUse>,
    /// What is wrong with the recordings.
    pub faults: Vec<Fault>,
}

/// A fault of recordings.
#[derive(Debug, Clone, PartialEq, Eq, Default, Deserialize)]
#[serde(default)]
pub struct Fault {
    /// Files that have it.
    pub runs: Vec<String>,
    /// The channel, if it is in one.
    pub channel: Option<String>,
}

/// One finding.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(default)]
pub struct Finding {
    /// Id.
    pub effect: Option<String>,
    /// Family.
    pub family: Option<String>,
    /// Channels.
    pub channels: Vec<String>,
    /// Variables.
    pub depends_on: Vec<String>,
    /// From 0 to 1.
    pub confidence: Option<f64>,
    /// Its parameters.
    pub parameters: Vec<Parameter>,
    /// Other names that the data allow.
    pub alternatives: Vec<Finding>,
}

/// Errors of one channel.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(default)]
pub struct Check {
    /// Its name.
    pub channel: String,
    /// After correction.
    pub after: Option<f64>,
}

/// A parameter.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(default)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// After the refit.
    pub value: Option<f64>,
    /// Ends of its 95 % interval.
    pub low: Option<f64>,
    /// The other end.
    pub high: Option<f64>,
}

/// What a run was used for.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(default)]
pub struct RunUse {
    /// File or its stem.
    pub name: String,
    /// `fit` or `check`.
    #[serde(rename = "use")]
    pub used: String,
}

impl Finding {
    /// The id, empty if there is none.
    #[must_use]
    pub fn id(&self) -> &str {
        self.effect.as_deref().unwrap_or_default()
    }
}

impl Diagnosis {
    /// Whether anything is named.
    #[must_use]
    pub fn names(&self) -> bool {
        matches!(self.verdict.as_str(), "effect" | "family" | "recording")
    }

    /// All that is named, the most trusted first.
    #[must_use]
    pub fn ranking(&self) -> Vec<&Finding> {
        if !self.names() {
            return Vec::new();
        }
        let mut rest: Vec<&Finding> =
            self.findings.iter().skip(1).chain(self.findings.iter().flat_map(|f| &f.alternatives)).collect();
        let trust = |f: &Finding| f.confidence.unwrap_or(0.0);
        rest.sort_by(|a, b| trust(b).total_cmp(&trust(a)));
        self.findings.first().into_iter().chain(rest).collect()
    }
}
