//! Which parameters of the model would have to wander to explain what is left: to have a value of their own
//! in every part of a run.

use super::locate::Sensitivity;
use super::rest::Rest;
use super::study::{Fitted, Study};
use crate::fit::{Run, Traces};

/// Windows of a run that a parameter may have values of its own in.
const WINDOWS: usize = 12;
/// Parameters that are looked at closely.
const FEW: usize = 2;

/// What those parameters do to the outputs that would explain most of the rest of the fit runs if they wandered,
/// by the derivatives that the fit has ended with; the most important first.
pub(super) fn wandering(
    study: &Study<'_>,
    current: &Fitted,
    (fit, check): (&Rest, &Rest),
) -> Vec<Sensitivity> {
    let rows: usize = study.fit_runs.iter().map(|r| r.time.len() * r.channels.len()).sum();
    if rows != current.fit.jacobian.nrows() {
        return Vec::new();
    }
    let mut order: Vec<(f64, usize)> =
        (0..study.free.len()).map(|i| (explained(&study.fit_runs, current, i), i)).collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0));
    let sensitivity = |i: usize| {
        let mut model = current.model.clone();
        let step = current.unknowns[i].step_at(model.parameters[i]);
        model.parameters[i] += step;
        let change = |runs: &[&Run], from: &Rest| -> Option<Vec<Traces>> {
            let moved = study.rest(&model, runs).ok()?.simulated;
            let slope =
                |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| (a - b) / step).collect();
            let of = |(a, b): (&Traces, &Traces)| a.iter().zip(b).map(slope).collect();
            Some(moved.iter().zip(&from.simulated).map(of).collect())
        };
        Some(Sensitivity {
            parameter: study.bench.interface().variables[study.free[i].variable].name.clone(),
            fit: change(&study.fit_runs, fit)?,
            check: change(&study.check_runs, check)?,
        })
    };
    order.into_iter().take(FEW).filter_map(|(_, i)| sensitivity(i)).collect()
}

/// Weighted squared error of the runs that a parameter takes away, to first order, if every window of each run has
/// a value of its own.
fn explained(runs: &[&Run], current: &Fitted, parameter: usize) -> f64 {
    let (mut first, mut sum) = (0, 0.0);
    for run in runs {
        let n = run.time.len();
        let mut windows = [(0.0, 0.0); WINDOWS];
        // rows are run by run, channel by channel
        for k in 0..n * run.channels.len() {
            let (slope, rest) =
                (current.fit.jacobian[(first + k, parameter)], current.fit.residuals[first + k]);
            let window = &mut windows[k % n * WINDOWS / n];
            window.0 += slope * rest;
            window.1 += slope * slope;
        }
        sum += windows.iter().filter(|w| w.1 > 0.0).map(|w| w.0 * w.0 / w.1).sum::<f64>();
        first += n * run.channels.len();
    }
    sum
}
