//! What the limited precision of recorded inputs can make of what is left: a wheel's angle sums up what a speed is off by.

use super::linear::explain;
use super::numbers::PRECISION;
use super::rest::Rest;
use super::study::{Model, Study};
use crate::Result;
use crate::fit::{Run, Traces};
use nalgebra::DVector;
use std::collections::BTreeSet;

/// The step of derivatives by inputs, as a share of these: ten times their precision, so that rounding inside a model is far below it.
const STEP: f64 = 1e-3;

/// What a model leaves of runs if every input of every run is off by as much, within its precision, as meets the recording best.
///
/// # Errors
/// The model cannot be run on one of them.
pub(super) fn within_precision(study: &Study<'_>, model: &Model, runs: &[&Run], rest: &Rest) -> Result<Rest> {
    let inputs: BTreeSet<usize> =
        runs.iter().flat_map(|run| run.drive.inputs.iter().map(|(v, _)| *v)).collect();
    // the same input of all runs at once
    let change = |input: usize| -> Result<Vec<Traces>> {
        let larger = |variable, _, v| if variable == input { v * (1.0 + STEP) } else { v };
        let moved: Vec<Run> = runs.iter().map(|run| run.with_inputs(larger)).collect();
        let simulated = study.rest(model, &moved.iter().collect::<Vec<_>>())?.simulated;
        let change = |a: &f64, b: &f64| (a - b) * (PRECISION / STEP);
        Ok(simulated.iter().zip(&rest.simulated).map(|(a, b)| combined(a, b, change)).collect())
    };
    let changes = inputs.into_iter().map(change).collect::<Result<Vec<Vec<Traces>>>>()?;
    let weighted = |traces: &Traces| {
        let rows =
            traces.iter().zip(&study.weights).flat_map(|(values, w)| values.iter().map(move |v| v * w));
        DVector::from_vec(rows.collect::<Vec<f64>>())
    };
    let meet = |(number, (run, simulated)): (usize, (&&Run, &Traces))| -> Traces {
        let measured: Traces = run.channels.iter().map(|c| c.values.clone()).collect();
        let residual = weighted(&combined(&measured, simulated, |m, s| m - s));
        let own: Vec<&Traces> = changes.iter().map(|of_runs| &of_runs[number]).collect();
        let columns: Vec<DVector<f64>> = own.iter().map(|change| weighted(change)).collect();
        let rooms = vec![(-1.0, 1.0); columns.len()];
        let amounts =
            explain(&columns, &columns, &residual, &rooms).map_or(Vec::new(), |(_, amounts)| amounts);
        own.iter().zip(amounts).fold(simulated.clone(), |met, (change, amount)| {
            combined(&met, change, |met, change| met + amount * change)
        })
    };
    let simulated = runs.iter().zip(&rest.simulated).enumerate().map(meet).collect();
    Ok(study.rest_with(runs, simulated))
}

/// Channels made of those of two, sample by sample.
fn combined(a: &Traces, b: &Traces, of: impl Fn(&f64, &f64) -> f64) -> Traces {
    let channel = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| of(a, b)).collect();
    a.iter().zip(b).map(channel).collect()
}
