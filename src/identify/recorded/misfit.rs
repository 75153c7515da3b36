//! Recordings that contradict the model with the parameters that were found.
//!
//! Targets are as many as parameters, so that these always meet them. What shows whether the model is right are the outputs that no
//! target reads, and how readings differ from the plane or the mean that stands for them.

use super::reduced::{Known, Reduced};
use super::search::{Search, beside};
use crate::Result;
use crate::identify::plan::Plan;
use crate::identify::registry::Numbers;
use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// What is left of a recording is larger than this many standard deviations of what can be expected of it once in 15,000.
const SIDE: f64 = 4.0;
/// Stationary states of a continuum, by which the model is read, and bristles in time are so far apart, as a share of an output's
/// range: a rig that is the model itself is no contradiction (tests/time_domain has the distance of each force).
const MODEL: f64 = 0.01;

/// An output that is not what the model says in a recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Misfit {
    /// The recording.
    pub recording: String,
    /// The output.
    pub output: String,
    /// Measured less modelled, root mean square over its readings.
    pub left: f64,
    /// What it could be, by what scatters, zeros that drift, and what is not known of the parameters.
    pub expected: f64,
    /// The groups that read that recording.
    pub groups: Vec<String>,
}

impl Misfit {
    /// It in a sentence.
    pub fn words(&self) -> String {
        format!(
            "{}: {} is {:.3e} from what the model with these parameters says (root mean square), up to {:.1e} could be: {} contradicts \
             the other groups. Is it a recording of this tire? Else the model leaves something out there: run `latsch diagnose`",
            self.recording,
            self.output,
            self.left,
            self.expected,
            self.groups.iter().map(|g| format!("group \"{g}\"")).collect::<Vec<_>>().join(" or ")
        )
    }
}

impl Search<'_> {
    /// The outputs of recordings that contradict the model.
    ///
    /// # Errors
    /// The model has no such state.
    pub fn misfits(
        &self,
        plan: &Plan,
        reduced: &Reduced,
        known: &Known,
        within: &Numbers,
    ) -> Result<Vec<Misfit>> {
        let whole = self.model(plan)?;
        let sought = whole.sought_values(&self.numbers)?;
        let covariance = self.covariance_of_sought(&whole, &sought, reduced, known, within)?;
        let reads = self.reads(&reduced.plan)?;
        // each reading once, in the first of its conditions; and who reads it
        let mut condition_of = BTreeMap::new();
        let mut groups = BTreeMap::<usize, BTreeSet<&String>>::new();
        let names = reduced.plan.groups.iter().flat_map(|g| g.targets.iter().map(|_| &g.name));
        for (read, group) in reads.iter().zip(names) {
            for member in &read.members {
                condition_of.entry(*member).or_insert(read.condition);
                groups.entry(self.evidence.readings[*member].recording).or_default().insert(group);
            }
        }
        let signals = &self.evidence.signals;
        let outputs = signals.outputs.len();
        let model = |numbers: &Numbers| {
            let mut all = Vec::new();
            for (member, condition) in &condition_of {
                let reading = &self.evidence.readings[*member];
                all.extend(whole.respond(
                    &plan.conditions[*condition],
                    reading,
                    signals,
                    &self.offsets,
                    numbers,
                )?);
            }
            Ok(DVector::from_vec(all))
        };
        let modelled = model(&whole.model_values(&sought)?)?;
        let mut slopes = DMatrix::zeros(modelled.len(), sought.len());
        for k in 0..sought.len() {
            let [(below, less), (above, more)] = beside(&whole, &sought, k, model)?;
            slopes.set_column(k, &((more - less) / (above - below)));
        }
        let mut left = BTreeMap::<(usize, usize), (f64, f64, f64)>::new();
        for (row, (member, output)) in
            condition_of.keys().flat_map(|m| (0..outputs).map(move |o| (*m, o))).enumerate()
        {
            let reading = &self.evidence.readings[member];
            let slope = slopes.row(row).transpose();
            let zero = self.evidence.zeros.drift[output];
            let variance = (&covariance * &slope).dot(&slope)
                + reading.noise[output].powi(2)
                + zero.powi(2) * (1.0 + 1.0 / self.evidence.zeros.recordings as f64);
            let sums = left.entry((reading.recording, output)).or_default();
            sums.0 += (reading.point.outputs[output] - modelled[row]).powi(2);
            sums.1 += variance;
            sums.2 += 1.0;
        }
        let mut found = Vec::new();
        for ((recording, output), (square, variance, count)) in left {
            let expected =
                (SIDE * SIDE * variance / count + (MODEL * self.evidence.ranges[output]).powi(2)).sqrt();
            let rest = (square / count).sqrt();
            if rest > expected {
                found.push(Misfit {
                    recording: self.evidence.names[recording].clone(),
                    output: signals.outputs[output].0.clone(),
                    left: rest,
                    expected,
                    groups: groups.get(&recording).into_iter().flatten().map(|g| (*g).clone()).collect(),
                });
            }
        }
        Ok(found)
    }
}
