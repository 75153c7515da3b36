//! What a simulation is compared with a measurement under, as arguments.

use super::mapped::Mapped;
use latsch::comparison::{Conditions, behind_low_pass};
use latsch::recording::Recording;
use latsch::{Error, Result};
use std::path::{Path, PathBuf};

/// How the page compares outputs with what was measured.
#[derive(clap::Args)]
pub struct Compared {
    /// Compare behind a low-pass of this frequency [Hz], the same for simulation and measurement and without delay; files that are written have all
    #[arg(long, value_name = "HZ", requires = "report")]
    low_pass: Option<f64>,
    /// Compare period and decrement of the free oscillation between two times [s]
    #[arg(long, value_name = "FROM:TO", requires = "report")]
    swing: Option<String>,
    /// A further recording of the same run, on the same time: the page says whether the simulation is off by more than recordings differ. Can be given several times
    #[arg(long, value_name = "F.csv", requires = "report")]
    repeat: Vec<PathBuf>,
}

impl Compared {
    /// Files that are read.
    pub fn read(&self) -> impl Iterator<Item = &Path> {
        self.repeat.iter().map(PathBuf::as_path)
    }

    /// # Errors
    /// A window that is none, a recording that cannot be read, a low-pass that does not fit it.
    pub fn conditions(&self, map: &Mapped) -> Result<Conditions> {
        let repeat = |recording: Recording| match self.low_pass {
            Some(frequency) => latsch::comparison::low_pass(&recording, frequency),
            None => Ok(recording),
        };
        Ok(Conditions {
            low_pass: self.low_pass,
            swing: self.swing.as_deref().map(|text| super::span("--swing", text)).transpose()?,
            repeats: map.recordings(&self.repeat)?.into_iter().map(repeat).collect::<Result<_>>()?,
        })
    }
}

/// Simulation and measurement as they are compared and shown.
///
/// # Errors
/// There is nothing to compare, or the low-pass does not fit.
pub fn sides(
    simulated: &Recording,
    measured: Option<Recording>,
    conditions: &Conditions,
) -> Result<(Recording, Option<Recording>)> {
    match (measured, conditions.low_pass) {
        (Some(measured), Some(frequency)) => {
            let [simulated, measured] = behind_low_pass(simulated, &measured, frequency)?;
            Ok((simulated, Some(measured)))
        }
        (None, _) if conditions.is_any() => Err(Error::call(
            "--low-pass, --swing and --repeat compare with a measurement: there is no recording with a column named like an output",
        )),
        (measured, _) => Ok((simulated.clone(), measured)),
    }
}
