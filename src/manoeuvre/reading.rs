//! [`Reading`]: a number that a manoeuvre is for, and how numbers are read from a run.

use crate::Result;
use crate::recording::Recording;
use crate::stats::interpolate;
use serde::Serialize;
use std::fmt::Write as _;
use std::ops::Range;

/// A number of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reading {
    /// What it is.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Its unit.
    pub unit: &'static str,
    /// What it would be by a closed form, if there is one whose parameters the vehicle tells.
    pub expected: Option<f64>,
}

impl Reading {
    pub(super) fn new(name: impl Into<String>, value: f64, unit: &'static str) -> Self {
        Self { name: name.into(), value, unit, expected: None }
    }

    pub(super) fn beside(self, expected: Option<f64>) -> Self {
        Self { expected, ..self }
    }
}

/// Readings as CSV.
pub fn readings_csv(readings: &[Reading]) -> String {
    let mut text = String::from("reading,value,unit,expected\n");
    for Reading { name, value, unit, expected } in readings {
        // writing to a text does not fail; names have no comma
        let _ = writeln!(text, "{name},{value},{unit},{}", expected.map_or(String::new(), |e| e.to_string()));
    }
    text
}

/// A run by the names that manoeuvres use.
pub(super) struct View<'a> {
    pub run: &'a Recording,
    pub car: &'a super::Car,
}

impl View<'_> {
    /// An output of the vehicle.
    pub fn course(&self, name: &str, unit: &str) -> Result<Vec<f64>> {
        self.run.channel_in(&format!("car.{}", self.car.name(name)), unit)
    }

    /// The samples from one time to another \[s\].
    pub fn samples(&self, from: f64, to: f64) -> Range<usize> {
        let time = &self.run.time;
        let first = time.partition_point(|t| *t < from);
        first..time.partition_point(|t| *t <= to).max(first)
    }

    /// The value at a time \[s\].
    pub fn at(&self, time: f64, values: &[f64]) -> f64 {
        interpolate(&self.run.time, values, time)
    }
}
