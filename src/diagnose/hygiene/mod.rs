//! Faults of recordings, told apart from faults of the model.
//!
//! Two looks, each cheap beside one simulation:
//! - [`RawRecording`] and [`faults_of_runs`] see the recordings alone: time stamps, unreadable cells, rails,
//!   frozen values, spikes, copies.
//! - [`faults_against`] sees recordings beside simulations of the same runs: unit, sign, swapped cables,
//!   and whatever differs in a few runs only.
//!
//! The rule for all of them: physics that a model lacks must not be called a fault. So a fault has to
//! have a mark that physics does not leave: bit-wise constancy in a channel that has noise, a gain that
//! is a ratio of units, or a deviation that single runs have, that one number undoes entirely, and that
//! no operating condition explains. What all runs share (a bias, a delay, a gain that is no ratio of
//! units) is left to the catalogue of effects.

mod against;
mod align;
mod clock;
mod copies;
mod explain;
mod odd;
mod raw;
mod swap;
#[cfg(test)]
mod tests;
mod time;
mod unit_sign;
mod values;

pub use against::faults_against;
pub use raw::{RawRecording, faults_of_runs};
pub(crate) use raw::{leave_out_rows, read_raw};
pub(crate) use values::{RAIL_ADVICE, at_rail};

use serde::Serialize;

/// What is wrong with a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FaultKind {
    /// The time steps back.
    TimeJumpsBack,
    /// Rows have the same time.
    DuplicateStamps,
    /// Samples are missing.
    Gap,
    /// Time stamps scatter about a regular clock.
    Jitter,
    /// Cells are empty or hold no finite number.
    EmptyCells,
    /// Values end at a rail.
    Saturated,
    /// A value is frozen.
    Stuck,
    /// Single samples are far away.
    Spikes,
    /// Two runs are copies.
    DuplicatedRun,
    /// The quantisation step is coarse against the signal.
    CoarseQuantisation,
    /// Values are in another unit than the header says.
    WrongUnit,
    /// The sign is reversed.
    WrongSign,
    /// Channels carry each other's name.
    SwappedChannels,
    /// Some runs have an offset that the others do not have.
    OffsetInSomeRuns,
    /// Some runs have a delay that the others do not have.
    DelayInSomeRuns,
    /// Some runs have a gain that the others do not have.
    GainInSomeRuns,
    /// A delay grows over the run.
    ClockDrift,
}

impl FaultKind {
    /// True for what no parameters can make of a channel: it shows beside a model that was not refitted, too.
    pub fn is_gross(self) -> bool {
        matches!(self, Self::WrongUnit | Self::WrongSign | Self::SwappedChannels)
    }

    /// True for what single runs have and the others do not; of clocks the search finds what all runs share.
    pub fn is_of_some_runs(self) -> bool {
        matches!(
            self,
            Self::OffsetInSomeRuns | Self::DelayInSomeRuns | Self::GainInSomeRuns | Self::ClockDrift
        )
    }
}

/// What a fault means for the diagnosis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub enum Severity {
    /// What would be found in these channels and runs would be the fault, not the model's physics.
    #[serde(rename = "fatal for diagnosis")]
    Fatal,
    /// The diagnosis goes on with what is left: samples were left out or times mended.
    #[serde(rename = "repaired")]
    Repaired,
    /// Worth knowing, does not disturb.
    #[serde(rename = "note")]
    Note,
}

/// A fault of one or more recordings.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fault {
    /// What it is.
    pub kind: FaultKind,
    /// What it means for the diagnosis.
    pub severity: Severity,
    /// The runs that have it, by their file name.
    pub runs: Vec<String>,
    /// The channel that has it, `None` for the time and for whole runs.
    pub channel: Option<String>,
    /// The time span \[s\] from the first to the last place, `None` for all of the runs.
    pub span: Option<(f64, f64)>,
    /// How large it is, in `unit`.
    pub value: f64,
    /// The unit of `value`.
    pub unit: String,
    /// What was seen, as a sentence.
    pub evidence: String,
    /// What to do, as a sentence.
    pub advice: String,
}

impl Fault {
    /// True if the fault makes the verdict `recording`: it is more than a note.
    pub fn counts(&self) -> bool {
        self.severity != Severity::Note
    }

    /// True if what would be found where it is would be the fault.
    pub fn is_fatal(&self) -> bool {
        self.severity == Severity::Fatal
    }

    /// True if it is the other one, seen again: of the same kind in the same channel, in one of the same runs.
    pub fn is_of(&self, other: &Self) -> bool {
        self.kind == other.kind
            && self.channel == other.channel
            && self.runs.iter().any(|run| other.runs.contains(run))
    }
}

/// The name of a run: the file name of where it comes from.
fn run_name(source: &str) -> String {
    source.rsplit(['/', '\\']).next().unwrap_or(source).to_owned()
}

/// A number for people: three digits.
fn short(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    if !(1e-3..1e5).contains(&size) {
        return format!("{value:.2e}");
    }
    let digits = (2.0 - size.log10().floor()).max(0.0) as usize;
    format!("{value:.digits$}")
}
