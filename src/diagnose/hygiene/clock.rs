//! A delay that grows over the run: two clocks that run at different rates.

use super::against::Table;
use super::align::{Pair, period};
use super::{Fault, FaultKind, Severity, run_name, short};
use crate::recording::Recording;
use crate::stats::{correlation, deviation, mean, median};

/// Windows that a run is cut into.
const WINDOWS: usize = 8;
/// Samples that a window has to have.
const SAMPLES: usize = 40;
/// How far the delay has to grow, in intervals.
const GROWS: f64 = 1.5;
/// How straight it has to grow: correlation of delay and time.
const STRAIGHT: f64 = 0.95;
/// What may be left with the growing delay, against the best constant one.
const UNDONE: f64 = 0.7;
/// A lag that changes with speed, frequency or amplitude looks alike if these change steadily over the run:
/// not told apart beyond this correlation of delay and condition.
const CONFOUNDED: f64 = 0.85;

/// Finds delays that grow in proportion to time.
pub fn drifts(table: &Table) -> Vec<Fault> {
    let mut faults = Vec::new();
    for (channel, name) in table.channels.iter().enumerate() {
        let pairs: Vec<&Pair> = table.pairs[channel].iter().flatten().collect();
        let hits: Vec<(usize, f64)> = pairs
            .iter()
            .filter_map(|p| Some((p.run, rate(p, &table.measured[p.run], table.channels)?)))
            .collect();
        if hits.is_empty() {
            continue;
        }
        let rate = median(&hits.iter().map(|h| h.1).collect::<Vec<_>>());
        let same_sign = hits.iter().filter(|h| h.1 * rate > 0.0).count();
        // a clock has one rate; lags of other causes would go up here and down there
        if same_sign < hits.len() {
            continue;
        }
        faults.push(Fault {
            kind: FaultKind::ClockDrift,
            severity: Severity::Fatal,
            runs: hits.iter().map(|h| run_name(&table.measured[h.0].source)).collect(),
            channel: Some(name.clone()),
            span: None,
            value: 1e6 * rate,
            unit: "1e-6".into(),
            evidence: format!(
                "In {} of {} run(s) {name} comes later and later against the simulation, by {} ms per second, \
                 straight over the run and independent of level, amplitude and frequency.",
                hits.len(),
                pairs.len(),
                short(1e3 * rate)
            ),
            advice: "Record all channels with one clock, or divide this channel's time by 1 + rate.".into(),
        });
    }
    faults
}

/// By how much the delay grows per second, if it does so as a clock's does.
fn rate(pair: &Pair, measured: &Recording, outputs: &[String]) -> Option<f64> {
    let n = pair.time.len();
    let windows = WINDOWS.min(n / SAMPLES);
    if windows < 5 {
        return None;
    }
    let whole = deviation(pair.simulated);
    let reach = pair.reach();
    let mut seen: Vec<(f64, f64, usize, usize)> = Vec::new();
    for k in 0..windows {
        let (from, to) = (k * n / windows, (k + 1) * n / windows);
        if deviation(&pair.simulated[from..to]) < 0.2 * whole {
            continue;
        }
        let Some(fit) = pair.best_in(from, to, reach, 1.0) else { continue };
        if fit.error < 0.7 * deviation(&pair.measured[from..to]) {
            seen.push((mean(&pair.time[from..to]), fit.delay, from, to));
        }
    }
    if seen.len() < 5 {
        return None;
    }
    let times: Vec<f64> = seen.iter().map(|s| s.0).collect();
    let delays: Vec<f64> = seen.iter().map(|s| s.1).collect();
    let straight = correlation(&times, &delays);
    if straight.abs() < STRAIGHT {
        return None;
    }
    // the median of all slopes
    let slopes: Vec<f64> = (0..seen.len())
        .flat_map(|i| (i + 1..seen.len()).map(move |j| (i, j)))
        .map(|(i, j)| (delays[j] - delays[i]) / (times[j] - times[i]))
        .collect();
    let slope = median(&slopes);
    let length = pair.time[n - 1] - pair.time[0];
    if slope.abs() * length < GROWS * pair.interval() {
        return None;
    }
    let conditions = |values: &[f64]| -> [Vec<f64>; 3] {
        let part = |f: &dyn Fn(&[f64], &[f64]) -> f64| {
            seen.iter().map(|s| f(&pair.time[s.2..s.3], &values[s.2..s.3])).collect::<Vec<f64>>()
        };
        [part(&|_, v| mean(v)), part(&|_, v| deviation(v)), part(&|t, v| 1.0 / period(t, v))]
    };
    let inputs = measured.channels.iter().filter(|c| !outputs.contains(&c.name)).map(|c| c.values.as_slice());
    for values in inputs.chain(std::iter::once(pair.simulated)).filter(|v| v.len() == n) {
        let whole = deviation(values);
        for (kind, condition) in conditions(values).iter().enumerate() {
            let size = if kind == 0 { whole.max(mean(values).abs()) } else { mean(condition).abs() };
            let varies = deviation(condition) > 0.1 * size;
            if varies && correlation(condition, &delays).abs() > CONFOUNDED {
                return None;
            }
        }
    }
    // does the growing delay leave less than the best constant one?
    let constant = pair.best()?;
    let start = median(&times.iter().zip(&delays).map(|(t, d)| d - slope * t).collect::<Vec<_>>());
    let (mut sum, mut count) = (0.0, 0.0);
    for s in &seen {
        pair.visit(s.2, s.3, start + slope * s.0, reach, |y, v, _| {
            sum += (y - constant.offset - constant.gain * v).powi(2);
            count += 1.0;
        });
    }
    let left = (sum / f64::max(count, 1.0)).sqrt();
    (left < UNDONE * constant.error).then_some(slope)
}
