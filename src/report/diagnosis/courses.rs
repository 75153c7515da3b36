//! Check runs over time, frequency and order.

use super::compare::{Compared, Trace, rms};
use crate::diagnose::{CellKind, Diagnosis};
use crate::page::{Html, Section, Table, escape, number};
use crate::report::plot::{Axis, Plot, Size, Tone};
use crate::stats::{Spectrum, over_angle, over_time};
use std::fmt::Write;

/// So many runs and channels are drawn; of more the page would be too large to open.
const MAX_RUNS: usize = 12;
const MAX_CHANNELS: usize = 6;
/// What all lines together may take, and what a column of a line takes at most.
const BYTES: usize = 1_800_000;
const BYTES_PER_COLUMN: usize = 22;
/// The smallest and the largest number of columns of a plot.
const COLUMNS: [usize; 2] = [80, 600];
/// Lines for each channel of a run: three courses, two residuals, two spectra over frequency, two over order.
const LINES: usize = 9;
/// A spectrum ends where this share of the residual's energy lies below.
const ENERGY: f64 = 0.995;
/// The clearest stretch is this share of its run.
const STRETCH: f64 = 1.0 / 6.0;

/// The run and channel that gained most, where it gained most.
pub(super) fn clearest(diagnosis: &Diagnosis, runs: &[Compared]) -> Section {
    let section = Section::new("The clearest stretch");
    let first: Vec<&str> = diagnosis.findings.iter().flat_map(|f| &f.channels).map(String::as_str).collect();
    let gain = |trace: &Trace| {
        let (before, after) = (rms(&trace.residual_before()), rms(&trace.residual_after()?));
        let gain = 1.0 - after * after / (before * before);
        let size = rms(&trace.measured);
        // of channels that are equally better, the one that was worse
        (gain > 0.0).then_some(gain * (before / size.max(f64::MIN_POSITIVE)).min(1.0))
    };
    let of = |all: bool| {
        let pairs = runs.iter().flat_map(|r| r.traces.iter().map(move |t| (r, t)));
        pairs
            .filter(|(_, t)| all || first.contains(&t.name))
            .filter_map(|(r, t)| Some((gain(t)?, r, t)))
            .max_by(|a, b| a.0.total_cmp(&b.0))
    };
    let Some((_, run, trace)) = of(false).or_else(|| of(true)) else { return section };
    let (Some(after), Some(left)) = (&trace.after, trace.residual_after()) else { return section };
    let gone: Vec<f64> = trace
        .residual_before()
        .iter()
        .zip(&left)
        .map(|(b, a)| if (b * b - a * a).is_finite() { b * b - a * a } else { 0.0 })
        .collect();
    let length = ((gone.len() as f64 * STRETCH) as usize).clamp(2.min(gone.len()), gone.len());
    let mut sum: f64 = gone[..length].iter().sum();
    let mut best = (sum, 0);
    for end in length..gone.len() {
        sum += gone[end] - gone[end - length];
        if sum > best.0 {
            best = (sum, end - length + 1);
        }
    }
    let span = best.1..best.1 + length;
    let time = &run.time()[span.clone()];
    let cut = |values: &[f64]| values[span.clone()].to_vec();
    let course = Plot::new("", Axis::time(), Axis::new(trace.name, trace.unit))
        .size(Size::Half)
        .columns(COLUMNS[1])
        .toned("before", Tone::Before, time, &cut(&trace.before))
        .toned("after", Tone::After, time, &cut(after));
    let course = grey(course, time, &cut(&trace.measured));
    let residual = Plot::new("", Axis::time(), Axis::new("residual", trace.unit))
        .size(Size::Half)
        .columns(COLUMNS[1])
        .toned("residual before", Tone::Before, time, &cut(&trace.residual_before()))
        .toned("after", Tone::After, time, &cut(&left));
    section
        .with(Html::text(&format!(
            "{} in the check run {}: a part in which the correction takes away most.",
            trace.name, run.run.name
        )))
        .side_by_side([course.html(), residual.html()])
}

/// A measured line: dashed, in grey.
fn grey(plot: Plot, time: &[f64], measured: &[f64]) -> Plot {
    plot.measured("measured", time, measured)
}

/// All check runs: errors in numbers, then courses, residuals and spectra.
pub(super) fn section(runs: &[Compared]) -> Section {
    let mut section = Section::new("Check runs");
    if runs.iter().all(|r| r.traces.is_empty()) {
        return section;
    }
    section = section.with(errors(runs));
    let drawn: usize = runs.iter().take(MAX_RUNS).map(|r| r.traces.len().min(MAX_CHANNELS)).sum();
    let columns = (BYTES / BYTES_PER_COLUMN / (LINES * drawn.max(1))).clamp(COLUMNS[0], COLUMNS[1]);
    section = section.with(Html::note(
        "Residuals are measurement minus simulation. Spectra: single-sided amplitude of the residual, its mean taken \
         off, Hamming windows that overlap by half, root mean square over the windows; a window is a quarter of the \
         run, from 512 to 8192 samples. They end where 99.5 % of the energy lies below. Orders are multiples \
         of the rotation, resampled over its angle. Long series keep the smallest and largest value of every \
         column of the plot.",
    ));
    for (i, run) in runs.iter().take(MAX_RUNS).enumerate() {
        section = section.with(one(run, columns, i == 0));
    }
    let mut missing = Vec::new();
    if runs.len() > MAX_RUNS {
        missing.push(format!("{} of {} runs are drawn", MAX_RUNS, runs.len()));
    }
    if runs.iter().any(|r| r.traces.len() > MAX_CHANNELS) {
        missing.push(format!("the first {MAX_CHANNELS} channels of each run are drawn"));
    }
    if missing.is_empty() {
        return section;
    }
    section.with(Html::note(&format!(
        "To keep the page small, {}; the table has all of them.",
        missing.join(", and ")
    )))
}

fn errors(runs: &[Compared]) -> Html {
    let mut table =
        Table::new(&["check run", "channel", "unit", "error before", "error after", "change [%]"]);
    for run in runs {
        for trace in &run.traces {
            let before = rms(&trace.residual_before());
            let after = trace.residual_after().map_or(f64::NAN, |r| rms(&r));
            let change = 100.0 * (after / before - 1.0);
            table = table.row([
                run.run.name.clone(),
                trace.name.into(),
                trace.unit.into(),
                number(before),
                number(after),
                if change.is_finite() {
                    format!("{change:.0}").replace('-', "−")
                } else {
                    number(f64::NAN)
                },
            ]);
        }
    }
    table.html()
}

/// The plots of a run, folded but for the first.
fn one(run: &Compared, columns: usize, open: bool) -> Html {
    let mut plots = String::new();
    for trace in run.traces.iter().take(MAX_CHANNELS) {
        // a grid of its own: each channel begins a row
        plots.push_str("<div class=\"grid\">\n");
        for plot in of_trace(run, trace, columns) {
            plots.push_str(plot.as_str());
        }
        plots.push_str("</div>\n");
    }
    let mut html = String::new();
    let _ = write!(
        html,
        "<details{}><summary>{}<span>{}</span></summary>\n{plots}</details>\n",
        if open { " open" } else { "" },
        escape(&run.run.name),
        escape(&run.traces.iter().map(|t| t.name).collect::<Vec<_>>().join(", ")),
    );
    Html::raw(html)
}

fn of_trace(run: &Compared, trace: &Trace, columns: usize) -> Vec<Html> {
    let time = run.time();
    let plot = |title: &str, x: Axis, y: Axis| Plot::new(title, x, y).size(Size::Half).columns(columns);
    let (before, after) = (trace.residual_before(), trace.residual_after());

    let mut course = plot(trace.name, Axis::time(), Axis::new(trace.name, trace.unit)).toned(
        "before",
        Tone::Before,
        time,
        &trace.before,
    );
    let mut residual = plot(trace.name, Axis::time(), Axis::new("residual", trace.unit)).toned(
        "residual before",
        Tone::Before,
        time,
        &before,
    );
    if let (Some(simulated), Some(after)) = (&trace.after, &after) {
        course = course.toned("after", Tone::After, time, simulated);
        residual = residual.toned("after", Tone::After, time, after);
    }
    let mut plots = vec![grey(course, time, &trace.measured).html(), residual.html()];

    let spectra = |of: &dyn Fn(&[f64]) -> Option<Spectrum>| {
        let before = of(&before)?;
        let after = after.as_deref().and_then(of);
        Some((before, after))
    };
    let amplitude = || Axis::new("residual's amplitude", trace.unit);
    if let Some((before, after)) = spectra(&|r| over_time(time, r)) {
        let plot = plot(trace.name, Axis::new("frequency", "Hz"), amplitude());
        plots.push(drawn(plot, &before, after.as_ref()));
    }
    if let Some((name, angle)) = &run.rotation
        && let Some((before, after)) = spectra(&|r| over_angle(angle, r))
    {
        let plot = plot(trace.name, Axis::new(&format!("order of {name}"), "1"), amplitude());
        plots.push(drawn(plot, &before, after.as_ref()));
    }
    plots
}

/// Both spectra up to where almost all of the energy lies below.
fn drawn(plot: Plot, before: &Spectrum, after: Option<&Spectrum>) -> Html {
    let end = [Some(before), after].into_iter().flatten().map(last_line).max().unwrap_or(0);
    let (places, end) = (before.places(), end + 1);
    let mut plot = plot.toned("before", Tone::Before, &places[..end.min(places.len())], &before.amplitudes);
    if let Some(after) = after {
        plot = plot.toned("after", Tone::After, &places[..end.min(places.len())], &after.amplitudes);
    }
    plot.html()
}

fn last_line(spectrum: &Spectrum) -> usize {
    let total: f64 = spectrum.amplitudes.iter().map(|a| a * a).sum();
    let mut sum = 0.0;
    let line = spectrum.amplitudes.iter().position(|a| {
        sum += a * a;
        sum >= ENERGY * total
    });
    // a little room beyond
    let line = line.unwrap_or(spectrum.amplitudes.len());
    (line + line / 10 + 4).min(spectrum.amplitudes.len().saturating_sub(1))
}

/// The strongest line of what is left of a channel, in all runs: frequency \[Hz\] and amplitude.
pub(super) fn strongest_left(runs: &[Compared], channel: &str) -> Option<(f64, f64)> {
    let lines = runs.iter().filter_map(|run| {
        let trace = run.traces.iter().find(|t| t.name == channel)?;
        let spectrum = over_time(run.time(), &trace.residual_left())?;
        let strongest = spectrum.amplitudes.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
        Some((strongest.0 as f64 * spectrum.spacing, *strongest.1))
    });
    lines.max_by(|a, b| a.1.total_cmp(&b.1))
}

/// The highest operating conditions that the map names, the most telling first.
pub(super) fn conditions(diagnosis: &Diagnosis) -> Vec<&str> {
    let mut cells: Vec<_> = diagnosis.map.iter().filter(|c| c.kind == CellKind::Condition).collect();
    cells.sort_by(|a, b| b.level.total_cmp(&a.level));
    let named = diagnosis.findings.iter().flat_map(|f| &f.depends_on).map(String::as_str);
    let mut names: Vec<&str> = Vec::new();
    for name in named.chain(cells.iter().map(|c| super::compare::bare(&c.what).0)) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}
