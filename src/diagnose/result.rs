//! What a diagnosis says, in the form of `diagnosis.json`; docs/diagnosis-json.md describes it for those
//! who read the file.

use super::numbers::{MOSTLY, OPEN};
use crate::stats::mean;
use crate::{Error, Result};
use serde::{Deserialize, Serialize};

/// The result of a diagnosis. Units are those of the model's variables.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Diagnosis {
    /// What kind of answer it is.
    pub verdict: Verdict,
    /// If the verdict is `recording` and what is at fault could be left aside: what the rest says.
    #[serde(default)]
    pub without_faults: Option<WithoutFaults>,
    /// The answer for people: what was found, and how much better the check runs fit; two sentences.
    pub summary: String,
    /// What is missing in the model, the most important first. Empty for the verdicts `nothing` and `parameters`; for
    /// `recording` what is missing without what is at fault.
    pub findings: Vec<Finding>,
    /// How well the check runs fit, by channel.
    pub check: Vec<ChannelCheck>,
    /// The model's own parameters that were fitted.
    pub parameters: Vec<Fitted>,
    /// What sensors show at zero: small offsets of channels in all runs, fitted with the parameters. They are no findings.
    #[serde(default)]
    pub zeros: Vec<Estimate>,
    /// Where simulation and recordings differ after the refit of the model's own parameters.
    pub map: Vec<Cell>,
    /// Of a wired system: its parts, each with its loop open.
    #[serde(default)]
    pub parts: Vec<Part>,
    /// All effects that were tried inside the simulation, the best first.
    pub candidates: Vec<Candidate>,
    /// The experiment that would separate the alternatives, or that would make an answer possible; empty
    /// if nothing is open.
    pub next_experiment: String,
    /// The same for machines, if it was found by simulation.
    #[serde(default)]
    pub experiment: Option<Experiment>,
    /// The recordings and what they were used for.
    pub runs: Vec<RunUse>,
    /// What is wrong with the recordings.
    #[serde(default)]
    pub faults: Vec<Fault>,
    /// How many seconds were simulated for it, all runs together: what a diagnosis costs, whatever the machine.
    #[serde(default)]
    pub simulated: f64,
    /// What a reader has to know of how it was done: which parameters were changed for it, how much was
    /// simulated.
    #[serde(default)]
    pub notes: Vec<String>,
}

/// The kind of answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// The model as it is explains the recordings to within their noise.
    #[default]
    Nothing,
    /// The model's own parameters were off; no physics is missing.
    Parameters,
    /// A recording is at fault.
    Recording,
    /// One or several named effects are missing.
    Effect,
    /// One effect of several is missing that these recordings cannot tell apart.
    Family,
    /// Something is missing that has no name here.
    Unknown,
}

/// What recordings say without what is at fault.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct WithoutFaults {
    /// The verdict on the rest.
    pub verdict: Verdict,
    /// Runs that are left aside.
    pub runs: Vec<String>,
    /// Measured channels that are left aside in all runs.
    pub channels: Vec<String>,
    /// Channels whose samples at a rail are left aside, with what else was measured then.
    pub at_rail: Vec<String>,
    /// The times of all that was measured were put right.
    #[serde(default)]
    pub is_on_time: bool,
}

impl WithoutFaults {
    /// What is left aside, in words: `run a.csv and channels force, moment and samples of angle at its rail`.
    pub fn words(&self) -> String {
        let all = |what: &str, names: &[String]| {
            let plural = if names.len() > 1 { "s" } else { "" };
            (!names.is_empty()).then(|| format!("{what}{plural} {}", names.join(", ")))
        };
        let at_rail = self.at_rail.iter().map(|channel| format!("samples of {channel} at its rail"));
        let clock = self.is_on_time.then(|| "the error of the clock".to_owned());
        let parts = [all("run", &self.runs), all("channel", &self.channels)].into_iter().flatten();
        parts.chain(at_rail).chain(clock).collect::<Vec<_>>().join(" and ")
    }
}

/// Something that is missing in the model.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Finding {
    /// The catalogue's id, `unknown` if it has no name.
    pub effect: String,
    /// Its name in words.
    pub name: String,
    /// The family in kebab case: `tire`, `brake`, `suspension`, `rig`, `sensor`, `mechanism`; `unknown`
    /// if it has no name.
    pub family: String,
    /// Where in the model: `output force_y`, `input slip_angle`, `parameter friction`.
    pub place: String,
    /// The output channels that show it.
    pub channels: Vec<String>,
    /// The variables that it depends on.
    pub depends_on: Vec<String>,
    /// Probability that this is right, 0 to 1: the effect for the verdict `effect`, the family for
    /// `family`, that something is missing for `unknown`.
    pub confidence: f64,
    /// The effect's parameters.
    pub parameters: Vec<Estimate>,
    /// What else it could be, the most likely first.
    pub alternatives: Vec<Alternative>,
    /// Why it was named, in a few sentences.
    pub evidence: String,
}

impl Finding {
    /// Whether something else is about as likely.
    pub(crate) fn is_open(&self) -> bool {
        self.alternatives.iter().any(|a| a.confidence > OPEN)
    }
}

/// What else a finding could be.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Alternative {
    /// The catalogue's id.
    pub effect: String,
    /// The family in kebab case.
    pub family: String,
    /// Where in the model.
    pub place: String,
    /// Probability that this is right, 0 to 1.
    pub confidence: f64,
}

/// A number that was estimated, with its 95 % interval.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Estimate {
    /// Name of the parameter.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Lower end of the interval; `None` if the recordings do not fix it.
    pub low: Option<f64>,
    /// Upper end of the interval; `None` if the recordings do not fix it.
    pub high: Option<f64>,
    /// Unit of all three.
    pub unit: String,
}

/// A parameter of the model that was fitted, with its 95 % interval.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Fitted {
    /// Name of the parameter.
    pub name: String,
    /// Value before the fit.
    pub start: f64,
    /// Value after the fit, together with the findings.
    pub value: f64,
    /// Lower end of the interval; `None` if the recordings do not fix it.
    pub low: Option<f64>,
    /// Upper end of the interval; `None` if the recordings do not fix it.
    pub high: Option<f64>,
    /// Unit of all four.
    pub unit: String,
    /// The bound of its range that keeps it from going on, if one does: then it says nothing of the machine.
    #[serde(default)]
    pub held_at: Option<f64>,
}

/// How well a channel of the check runs fits: root mean squares of measurement minus simulation.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ChannelCheck {
    /// The channel.
    pub channel: String,
    /// Unit of the errors.
    pub unit: String,
    /// Error of the given model with its own parameters refitted.
    pub before: f64,
    /// Error of the corrected model.
    pub after: f64,
    /// What the noise of the recordings leaves to any model, and at least what is too little to say anything: a thousandth of the motion, and
    /// what numbers in single precision tell. `None` if it could not be estimated.
    pub noise: Option<f64>,
}

/// A part of a wired system whose loop was opened: its connected inputs follow the recorded check runs instead of the
/// other parts.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Part {
    /// Its name.
    pub part: String,
    /// Why its loop could not be opened; `None` if it was.
    pub closed: Option<String>,
    /// Its measured outputs; empty if the loop stayed closed.
    pub channels: Vec<PartChannel>,
}

/// A measured output of a part: root mean squares of measurement minus simulation.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct PartChannel {
    /// The channel.
    pub channel: String,
    /// Unit of the errors.
    pub unit: String,
    /// Error in the wired system, refitted.
    pub wired: f64,
    /// Error with recorded inputs, the part's parameters fitted to its own outputs.
    pub replayed: f64,
    /// Whether the part differs by itself: with recorded inputs more than noise is left. `None` if there is nothing to
    /// tell, because little more than noise is left in the wired system or the noise is not known.
    pub made_here: Option<bool>,
}

/// One cell of the significance map.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Cell {
    /// The output channel.
    pub channel: String,
    /// What the cell is a part of.
    pub kind: CellKind,
    /// The run of a time window (empty: all runs), the channel of a condition or of the angle of an order
    /// with its unit in brackets (`speed [m/s]`), empty for a band.
    pub what: String,
    /// Lower end: \[s\] for time, \[Hz\] for bands, order, or the condition's unit.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Root mean square of the residual in the cell, in multiples of the channel's noise; of the root mean
    /// square of the channel itself where its noise is not known.
    pub level: f64,
    /// Probability that chance makes this, corrected for the number of cells; `None` if it was not tested.
    pub p: Option<f64>,
}

/// What a [`Cell`] is a part of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CellKind {
    /// The time since the start of a run.
    #[default]
    Time,
    /// The spectrum over frequency.
    Band,
    /// The range of an operating condition.
    Condition,
    /// The spectrum over the orders of a rotation.
    Order,
}

/// An effect that was tried inside the simulation, and what came of it.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Candidate {
    /// The catalogue's id.
    pub effect: String,
    /// Its name in words.
    pub name: String,
    /// The family in kebab case.
    pub family: String,
    /// Where in the model.
    pub place: String,
    /// Share of the squared error of the fit runs that it takes away, beyond the refit of the parameters;
    /// `None` if it was not fitted.
    pub fit_gain: Option<f64>,
    /// The same of the check runs.
    pub check_gain: Option<f64>,
    /// Probability that chance gains as much; `None` if it was not tested.
    pub p: Option<f64>,
    /// Why it was chosen, or why it lost.
    pub reason: String,
}

/// A programme for the rig, simulated with the fitted models of effects that the recordings do not separate.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Experiment {
    /// The catalogue's id of the finding that has alternatives.
    pub effect: String,
    /// Where in the model.
    pub place: String,
    /// What to drive, in words with units.
    pub programme: String,
    /// The output channel that shows it best.
    pub channel: String,
    /// Root mean square of what the finding and an alternative make of that channel, one minus the other, in
    /// multiples of its noise, after refits: the smallest of the alternatives that are separated, which takes
    /// 2, or of all if none is.
    pub separation: f64,
    /// The alternatives, each with its separation from the finding.
    pub rivals: Vec<Separation>,
    /// Number of programmes that were simulated.
    pub tried: usize,
}

/// How far an alternative is from a finding.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Separation {
    /// The catalogue's id.
    pub effect: String,
    /// Where in the model.
    pub place: String,
    /// As [`Experiment::separation`], in the channel that shows it best.
    pub separation: f64,
}

/// A recording and its use.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct RunUse {
    /// Name of the run: that of its file.
    pub name: String,
    /// What it was used for.
    #[serde(rename = "use")]
    pub use_: Use,
    /// The time \[s\] from which on it is for checking, if what comes before is to fit.
    pub check_from: Option<f64>,
}

/// What a recording is used for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Use {
    /// To fit parameters.
    #[default]
    Fit,
    /// To check what was fitted.
    Check,
    /// Not at all.
    Leave,
}

/// What is wrong with recordings.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Fault {
    /// What it is, in kebab case.
    pub kind: String,
    /// The runs that have it.
    pub runs: Vec<String>,
    /// The channel that has it; `None` for the time and for whole runs.
    pub channel: Option<String>,
    /// What was seen and what to do.
    pub text: String,
}

impl Diagnosis {
    /// Whether names stand beside something that has none and take away most of the error: all that was corrected is theirs.
    pub(crate) fn is_mostly_named(&self) -> bool {
        let [unknown, _, ..] = &self.findings[..] else { return false };
        let left = |c: &ChannelCheck| (c.after / c.before.max(f64::MIN_POSITIVE)).powi(2);
        let left: Vec<f64> = self.check.iter().map(left).collect();
        let verdict = self.without_faults.as_ref().map_or(self.verdict, |without| without.verdict);
        verdict == Verdict::Unknown && unknown.parameters.is_empty() && mean(&left) < 1.0 - MOSTLY
    }

    /// The parameters that ended at a bound of their range.
    pub(crate) fn held(&self) -> impl Iterator<Item = &Fitted> {
        self.parameters.iter().filter(|p| p.held_at.is_some())
    }

    /// The text of `diagnosis.json`.
    ///
    /// # Errors
    /// A number that every reader relies on is not finite; the message has its place.
    pub fn to_json(&self) -> Result<String> {
        if let Some((place, value)) = self.required().into_iter().find(|(_, value)| !value.is_finite()) {
            return Err(Error::numeric(format!("diagnosis.json: {place} is {value}; it has to be finite")));
        }
        let text = serde_json::to_string_pretty(&self.without_holes());
        text.map(|t| t + "\n").map_err(|e| Error::file(format!("diagnosis.json: {e}")))
    }

    /// Reads the text of a `diagnosis.json`.
    ///
    /// # Errors
    /// It is not JSON or a field is missing or of another type; the message has line and column.
    pub fn from_json(text: &str) -> Result<Self> {
        serde_json::from_str(text).map_err(|e| Error::file(format!("diagnosis.json: {e}")))
    }

    /// The numbers that are not optional, with their places.
    fn required(&self) -> Vec<(String, f64)> {
        let mut all = Vec::new();
        for finding in &self.findings {
            let place = |what: &str| format!("{what} of the finding {:?}", finding.effect);
            all.push((place("the confidence"), finding.confidence));
            all.extend(
                finding
                    .alternatives
                    .iter()
                    .map(|a| (place("the confidence of an alternative"), a.confidence)),
            );
            all.extend(finding.parameters.iter().map(|p| (place(&format!("{:?}", p.name)), p.value)));
        }
        for check in &self.check {
            all.push((format!("the error before of {:?}", check.channel), check.before));
            all.push((format!("the error after of {:?}", check.channel), check.after));
        }
        for c in self.parts.iter().flat_map(|p| &p.channels) {
            all.push((format!("the error of {:?} in the system", c.channel), c.wired));
            all.push((format!("the error of {:?} with recorded inputs", c.channel), c.replayed));
        }
        for p in &self.parameters {
            all.push((format!("the start of {:?}", p.name), p.start));
            all.push((format!("the value of {:?}", p.name), p.value));
        }
        if let Some(experiment) = &self.experiment {
            all.push(("the separation of the experiment".into(), experiment.separation));
            let of = |r: &Separation| (format!("the separation of {:?}", r.effect), r.separation);
            all.extend(experiment.rivals.iter().map(of));
        }
        for cell in &self.map {
            let place = |what: &str| format!("the {what} of a cell of {:?}", cell.channel);
            all.extend([
                (place("low end"), cell.low),
                (place("high end"), cell.high),
                (place("level"), cell.level),
            ]);
        }
        all
    }

    /// The same with optional numbers that are not finite taken for missing.
    fn without_holes(&self) -> Self {
        let mut clean = self.clone();
        let findings =
            clean.findings.iter_mut().flat_map(|f| &mut f.parameters).flat_map(|p| [&mut p.low, &mut p.high]);
        let parameters = clean.parameters.iter_mut().flat_map(|p| [&mut p.low, &mut p.high]);
        let check = clean.check.iter_mut().map(|c| &mut c.noise);
        let map = clean.map.iter_mut().map(|c| &mut c.p);
        let candidates =
            clean.candidates.iter_mut().flat_map(|c| [&mut c.fit_gain, &mut c.check_gain, &mut c.p]);
        for number in findings.chain(parameters).chain(check).chain(map).chain(candidates) {
            *number = number.filter(|v| v.is_finite());
        }
        clean
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DOCUMENT: &str = include_str!("../../docs/diagnosis-json.md");

    fn example() -> Diagnosis {
        let json = DOCUMENT.split("```json\n").nth(1).unwrap().split("```").next().unwrap();
        Diagnosis::from_json(json).unwrap()
    }

    #[test]
    fn the_documented_example_is_read_and_written_back() {
        let diagnosis = example();
        assert_eq!(diagnosis.verdict, Verdict::Family);
        assert_eq!(diagnosis.findings[0].parameters[0].low, Some(0.41));
        assert_eq!(diagnosis.runs[1].use_, Use::Check);
        assert_eq!(diagnosis.map[0].kind, CellKind::Condition);
        assert_eq!(Diagnosis::from_json(&diagnosis.to_json().unwrap()).unwrap(), diagnosis);
    }

    #[test]
    fn every_field_is_documented() {
        fn keys(value: &serde_json::Value, found: &mut std::collections::BTreeSet<String>) {
            match value {
                serde_json::Value::Object(map) => map.iter().for_each(|(key, value)| {
                    found.insert(key.clone());
                    keys(value, found);
                }),
                serde_json::Value::Array(list) => list.iter().for_each(|value| keys(value, found)),
                _ => {}
            }
        }
        let diagnosis = example();
        // the example has one of everything
        assert!(!diagnosis.faults.is_empty() && !diagnosis.candidates.is_empty());
        let mut found = std::collections::BTreeSet::new();
        keys(&serde_json::to_value(&diagnosis).unwrap(), &mut found);
        assert!(found.len() > 30, "{found:?}");
        for key in found {
            assert!(DOCUMENT.contains(&format!("| `{key}` |")), "{key}");
        }
    }

    #[test]
    fn json_has_no_number_that_is_none() {
        let mut diagnosis = example();
        diagnosis.check[0].noise = Some(f64::NAN);
        diagnosis.parameters[0].high = Some(f64::INFINITY);
        diagnosis.candidates[0].p = Some(f64::NAN);
        let back = Diagnosis::from_json(&diagnosis.to_json().unwrap()).unwrap();
        assert_eq!((back.check[0].noise, back.parameters[0].high, back.candidates[0].p), (None, None, None));

        diagnosis.check[0].after = f64::NAN;
        let message = diagnosis.to_json().unwrap_err().to_string();
        assert!(message.contains("after") && message.contains("force_y"), "{message}");
    }

    #[test]
    fn what_is_missing_in_a_file_is_named() {
        let message = Diagnosis::from_json("{ \"verdict\": \"family\" }").unwrap_err().to_string();
        assert!(message.contains("summary") && message.contains("line 1"), "{message}");
        assert!(Diagnosis::from_json("{ \"verdict\": \"maybe\" }").is_err());
    }
}
