//! Offsets of the rig's inputs, from what no target reads.

use super::estimate::Estimate;
use super::evidence::Read;
use super::search::{Search, Sure};
use crate::identify::plan::Plan;
use crate::{Error, Result};
use nalgebra::{DMatrix, DVector};
use std::collections::{BTreeMap, BTreeSet};

/// Steps of differences over an offset, in standard deviations of what it may be.
const OFFSET_STEP: f64 = 0.1;

impl Search<'_> {
    /// Offsets of inputs: those with which the model has the values that were measured where its inputs are 0, which no target
    /// reads, and touches the road where it was measured to.
    pub fn find_offsets(&self, plan: &Plan, reads: &[Read], sure: Option<&Sure>) -> Result<Vec<f64>> {
        let Some(how) = &plan.recordings else { return Ok(self.offsets.clone()) };
        let signals = &self.evidence.signals;
        let looked: Vec<(usize, f64)> =
            how.offsets.iter().filter_map(|(name, size)| Some((signals.input(name)?, *size))).collect();
        let model = self.model(plan)?;
        let numbers = model.model_values(&model.sought_values(&self.numbers)?)?;
        let mut asked = BTreeMap::new();
        let sizes = match sure {
            Some(sure) => sure.outputs.clone(),
            None => self.scatter(&model, reads, &numbers, &mut asked)?.sizes(false).to_vec(),
        };
        let (mut rows, mut rest): (Vec<Vec<f64>>, Vec<f64>) = (Vec::new(), Vec::new());
        let mut offsets = self.offsets.clone();
        let mut seen = BTreeSet::new();
        for read in reads {
            if !seen.insert(read.members.clone()) {
                continue;
            }
            let measured = self.evidence.points(read);
            let simulated = self.simulated_once(&model, read, &numbers, &mut asked)?;
            match &read.estimate {
                Estimate::FromTouch { over, .. } if looked.iter().any(|(input, _)| input == over) => {
                    offsets[*over] += read.estimate.touch(&measured) - read.estimate.touch(&simulated);
                }
                Estimate::Slope { .. } => {
                    let own = read.estimate.at_zero(&simulated);
                    let measured = read.estimate.at_zero(&measured);
                    let of_visits = |search: &Self| {
                        let points = search.visited(&model, read, &numbers, &mut BTreeMap::new())?;
                        Ok::<_, Error>(read.estimate.at_zero(&points))
                    };
                    let here = of_visits(self)?;
                    let mut slopes = Vec::new();
                    for (input, step) in &looked {
                        let mut other = self.clone();
                        other.offsets[*input] += OFFSET_STEP * step;
                        let moved = of_visits(&other)?;
                        slopes.push(
                            moved.iter().zip(&here).map(|(b, a)| (b - a) / OFFSET_STEP).collect::<Vec<f64>>(),
                        );
                    }
                    for (output, size) in sizes.iter().enumerate() {
                        let size = size / (read.members.len() as f64).sqrt();
                        rows.push(slopes.iter().map(|s| s[output] / size).collect());
                        rest.push((measured[output] - own[output]) / size);
                    }
                }
                _ => {}
            }
        }
        // what is known of offsets beforehand
        for (k, (input, size)) in looked.iter().enumerate() {
            rows.push((0..looked.len()).map(|other| f64::from(u8::from(other == k))).collect());
            rest.push(-self.offsets[*input] / size);
        }
        let design = DMatrix::from_fn(rows.len(), looked.len(), |i, k| rows[i][k]);
        let found = design.svd(true, true).solve(&DVector::from_vec(rest), 1e-9);
        let found = found.map_err(|e| Error::numeric(e.to_owned()))?;
        for (k, (input, size)) in looked.iter().enumerate() {
            // that of what touches the road is found by where it does
            if offsets[*input] == self.offsets[*input] {
                offsets[*input] += found[k] * size;
            }
        }
        Ok(offsets)
    }
}
