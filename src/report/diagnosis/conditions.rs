//! Residuals of all check runs against operating conditions.

use super::compare::Compared;
use super::courses::conditions;
use crate::diagnose::Diagnosis;
use crate::page::{Html, Section};
use crate::report::plot::{Axis, Plot, Size, Tone};
use crate::stats::{deviation, mean};

const MAX_CONDITIONS: usize = 4;
const MAX_CHANNELS: usize = 6;
/// As many bins as this, of as many samples each, or fewer if they would have less than the second number.
const BINS: usize = 20;
const SAMPLES: usize = 20;

/// A sample: the condition, and the residuals there.
type Sample = (f64, f64, Option<f64>);

pub(super) fn section(diagnosis: &Diagnosis, runs: &[Compared]) -> Section {
    let section = Section::new("Against operating conditions");
    let mut names = conditions(diagnosis);
    if names.is_empty() {
        names = commands(runs);
    }
    let mut channels: Vec<(&str, &str)> = Vec::new();
    for trace in runs.iter().flat_map(|r| &r.traces) {
        if !channels.contains(&(trace.name, trace.unit)) && channels.len() < MAX_CHANNELS {
            channels.push((trace.name, trace.unit));
        }
    }
    let mut plots: Vec<Html> = Vec::new();
    let mut shown = 0;
    for name in names {
        let drawn: Vec<Html> =
            channels.iter().filter_map(|(channel, unit)| plot(runs, name, channel, unit)).collect();
        if !drawn.is_empty() {
            shown += 1;
            plots.extend(drawn);
        }
        if shown == MAX_CONDITIONS {
            break;
        }
    }
    if plots.is_empty() {
        return section;
    }
    section
        .with(Html::note(
            "Mean of the residual (measurement minus simulation) in bins of equally many samples of all check \
             runs; the area is plus and minus the standard deviation in the bin.",
        ))
        .side_by_side(plots)
}

/// What is recorded and not compared: what drives the model.
fn commands<'a>(runs: &'a [Compared]) -> Vec<&'a str> {
    let mut names: Vec<&'a str> = Vec::new();
    for run in runs {
        for channel in &run.run.recording.channels {
            let compared = run.traces.iter().any(|t| t.name == channel.name);
            if !compared && !names.contains(&channel.name.as_str()) {
                names.push(&channel.name);
            }
        }
    }
    names
}

fn plot(runs: &[Compared], condition: &str, channel: &str, unit: &str) -> Option<Html> {
    let mut samples: Vec<Sample> = Vec::new();
    let mut condition_unit = "";
    for run in runs {
        let (Some((values, unit)), Some(trace)) =
            (run.variable(condition), run.traces.iter().find(|t| t.name == channel))
        else {
            continue;
        };
        condition_unit = unit;
        let (before, after) = (trace.residual_before(), trace.residual_after());
        for (i, (x, b)) in values.iter().zip(before).enumerate() {
            let a = after.as_ref().map(|a| a[i]);
            if x.is_finite() && b.is_finite() && a.is_none_or(f64::is_finite) {
                samples.push((*x, b, a));
            }
        }
    }
    let bins = bins(samples);
    if bins.len() < 2 {
        return None;
    }
    let x: Vec<f64> = bins.iter().map(|b| mean(&b.iter().map(|s| s.0).collect::<Vec<_>>())).collect();
    let after: Option<Vec<Vec<f64>>> = bins.iter().map(|b| b.iter().map(|s| s.2).collect()).collect();
    let before: Vec<Vec<f64>> = bins.iter().map(|b| b.iter().map(|s| s.1).collect()).collect();
    let mut plot = Plot::new(channel, Axis::new(condition, condition_unit), Axis::new("residual", unit))
        .size(Size::Half)
        .columns(BINS * 4);
    for (name, tone, values) in [("before", Tone::Before, Some(before)), ("after", Tone::After, after)] {
        let Some(values) = values else { continue };
        let (means, deviations): (Vec<f64>, Vec<f64>) =
            values.iter().map(|v| (mean(v), deviation(v))).unzip();
        let low: Vec<f64> = means.iter().zip(&deviations).map(|(m, d)| m - d).collect();
        let high: Vec<f64> = means.iter().zip(&deviations).map(|(m, d)| m + d).collect();
        plot = plot.band(tone, &x, &low, &high).toned(name, tone, &x, &means);
    }
    Some(plot.html())
}

/// Samples in the order of the condition, in bins of about equally many; equal conditions share one bin.
fn bins(mut samples: Vec<Sample>) -> Vec<Vec<Sample>> {
    samples.sort_by(|a, b| a.0.total_cmp(&b.0));
    let size = (samples.len() / BINS).max(SAMPLES);
    let mut bins: Vec<Vec<Sample>> = Vec::new();
    let mut bin: Vec<Sample> = Vec::new();
    for sample in samples {
        let full = bin.len() >= size && bin.last().is_some_and(|last| last.0 < sample.0);
        if full {
            bins.push(std::mem::take(&mut bin));
        }
        bin.push(sample);
    }
    // a rest is not worth a bin
    match bins.last_mut() {
        Some(last) if bin.len() < size / 2 => last.extend(bin),
        _ if bin.is_empty() => {}
        _ => bins.push(bin),
    }
    bins
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_have_equally_many_samples_and_share_no_condition() {
        let even: Vec<Sample> = (0..1000).rev().map(|i| (f64::from(i), 0.0, None)).collect();
        let sizes: Vec<usize> = bins(even).iter().map(Vec::len).collect();
        assert_eq!(sizes, [50; 20]);
        // three speeds are three bins, whatever their shares
        let speeds: Vec<Sample> = (0..1000).map(|i| ([10.0, 20.0, 20.0, 30.0][i % 4], 0.0, None)).collect();
        let sizes: Vec<usize> = bins(speeds).iter().map(Vec::len).collect();
        assert_eq!(sizes, [250, 500, 250]);
        // a constant condition is one bin, no course
        assert_eq!(bins(vec![(1.0, 0.0, None); 500]).len(), 1);
        assert!(bins(Vec::new()).is_empty());
        // a short rest goes to the last bin
        let rest: Vec<Sample> = (0..45).map(|i| (f64::from(i), 0.0, None)).collect();
        assert_eq!(bins(rest).iter().map(Vec::len).collect::<Vec<_>>(), [20, 25]);
    }
}
