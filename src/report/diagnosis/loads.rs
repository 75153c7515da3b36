//! What of the check runs matters for damage: extremes, level crossings, range pairs, rainflow.

use super::compare::{Compared, Trace};
use crate::diagnose::Diagnosis;
use crate::loads::{
    Rainflow, Residue, extremes, large_turning_points, level_crossings, rainflow, rainflow_matrix,
    range_pairs, summed_up,
};
use crate::page::{Html, Section, Table, number};
use crate::report::plot::{Axis, Plot, Size, Tone};

const MAX_CHANNELS: usize = 6;
/// Movements below this share of the measured span are left out: noise, which is not simulated, has a huge number.
const GATE: f64 = 0.05;
/// The same in multiples of the noise's root mean square, and as a share of the span at most.
const GATE_NOISE: f64 = 6.0;
const GATE_MOST: f64 = 0.5;
/// Classes of levels and ranges, and of a side of the rainflow matrix.
const CLASSES: usize = 60;
const MATRIX: usize = 16;
/// Slope of the S-N line for the equivalent range.
const SLOPE: f64 = 5.0;

/// x and y of a line.
type Points = (Vec<f64>, Vec<f64>);

/// One course of a channel in all runs.
struct Counted {
    extremes: Option<(f64, f64)>,
    crossings: Vec<usize>,
    pairs: Vec<f64>,
    cycles: Vec<(f64, f64)>,
    matrix: Vec<f64>,
}

impl Counted {
    fn new(courses: &[&[f64]], span: (f64, f64), gate: f64) -> Self {
        let (low, high) = span;
        let width = (high - low) / CLASSES as f64;
        let levels: Vec<f64> = (0..CLASSES).map(|i| low + (i as f64 + 0.5) * width).collect();
        let mut all = Self {
            extremes: None,
            crossings: vec![0; CLASSES],
            // a simulation may reach farther than the measurement
            pairs: vec![0.0; CLASSES * 3 / 2],
            cycles: Vec::new(),
            matrix: vec![0.0; MATRIX * MATRIX],
        };
        for course in courses {
            let points = large_turning_points(course, gate);
            let counted = rainflow(&points);
            all.extremes = match (all.extremes, extremes(course)) {
                (Some((a, b)), Some((c, d))) => Some((a.min(c), b.max(d))),
                (a, b) => a.or(b),
            };
            add(&mut all.crossings, level_crossings(&points, &levels));
            add(&mut all.pairs, range_pairs(&counted, Residue::Half, width, CLASSES * 3 / 2));
            add(&mut all.matrix, rainflow_matrix(&counted, Residue::Half, span, MATRIX).concat());
            all.cycles.extend(ranges(&counted));
        }
        all
    }

    fn count(&self) -> f64 {
        self.cycles.iter().map(|c| c.1).sum()
    }

    fn largest(&self) -> f64 {
        self.cycles.iter().map(|c| c.0).fold(f64::NAN, f64::max)
    }

    /// The sum of n range^slope, relative to that of another course: what it damages.
    fn damage(&self, other: &Self) -> f64 {
        let scale = other.largest();
        let sum = |c: &Self| c.cycles.iter().map(|(r, n)| n * (r / scale).powf(SLOPE)).sum::<f64>();
        sum(self) / sum(other)
    }

    /// Share of another course's cycles that have a partner in the same class of the rainflow matrix.
    fn alike(&self, other: &Self) -> f64 {
        let common: f64 = self.matrix.iter().zip(&other.matrix).map(|(a, b)| a.min(*b)).sum();
        common / other.matrix.iter().sum::<f64>()
    }
}

fn ranges(counted: &Rainflow) -> Vec<(f64, f64)> {
    counted.counted(Residue::Half).into_iter().map(|(cycle, n)| (cycle.range(), n)).collect()
}

fn add<T: std::ops::AddAssign>(sums: &mut [T], more: Vec<T>) {
    for (sum, more) in sums.iter_mut().zip(more) {
        *sum += more;
    }
}

pub(super) fn section(diagnosis: &Diagnosis, runs: &[Compared]) -> Section {
    let section = Section::new("Loads");
    let mut names: Vec<(&str, &str)> = Vec::new();
    for trace in runs.iter().flat_map(|r| &r.traces) {
        if !names.contains(&(trace.name, trace.unit)) {
            names.push((trace.name, trace.unit));
        }
    }
    let mut table = Table::new(&[
        "channel",
        "",
        "smallest",
        "largest",
        "cycles",
        "largest range",
        "middle crossed",
        "damage",
        "alike [%]",
        "gate",
    ]);
    let mut plots = Vec::new();
    for (i, (name, unit)) in names.into_iter().enumerate() {
        let traces: Vec<&Trace> =
            runs.iter().flat_map(|r| r.traces.iter().find(|t| (t.name, t.unit) == (name, unit))).collect();
        let measured: Vec<&[f64]> = traces.iter().map(|t| t.measured.as_slice()).collect();
        let all: Vec<f64> = measured.concat();
        let Some(span) = extremes(&all).filter(|(low, high)| high > low) else { continue };
        let noise = diagnosis.check.iter().find(|c| c.channel == name).and_then(|c| c.noise).unwrap_or(0.0);
        let gate = (GATE_NOISE * noise).min(GATE_MOST * (span.1 - span.0)).max(GATE * (span.1 - span.0));
        let measured = Counted::new(&measured, span, gate);
        let before =
            Counted::new(&traces.iter().map(|t| t.before.as_slice()).collect::<Vec<_>>(), span, gate);
        let after: Option<Vec<&[f64]>> = traces.iter().map(|t| t.after.as_deref()).collect();
        let after = after.map(|a| Counted::new(&a, span, gate));
        for (what, c) in [("measured", Some(&measured)), ("before", Some(&before)), ("after", after.as_ref())]
        {
            let Some(c) = c else { continue };
            let (low, high) = c.extremes.unwrap_or((f64::NAN, f64::NAN));
            table = table.row([
                format!("{name} [{unit}]"),
                what.into(),
                number(low),
                number(high),
                number(c.count()),
                number(c.largest()),
                c.crossings[CLASSES / 2].to_string(),
                number(c.damage(&measured)),
                format!("{:.0}", 100.0 * c.alike(&measured)),
                number(gate),
            ]);
        }
        if i < MAX_CHANNELS {
            plots.extend(plotted(name, unit, span, &measured, &before, after.as_ref()));
        }
    }
    if table.is_empty() {
        return section;
    }
    section
        .with(table.html())
        .with(Html::note(&format!(
            "All check runs together. Movements smaller than the gate are left out: {:.0} % of the measured span, or \
             {GATE_NOISE} times the noise (at most half of the span), which no simulation has. Cycles by rainflow \
             (four-point method), each range of the residue as half a cycle. Damage is the sum of range to the power \
             {SLOPE}, relative to the measured one. Alike are the measured cycles that have a partner in the same of \
             {MATRIX} by {MATRIX} classes of the rainflow matrix. Crossings are upwards.",
            100.0 * GATE
        )))
        .side_by_side(plots)
}

/// Level crossings, and range pairs summed up from the largest.
fn plotted(
    name: &str,
    unit: &str,
    (low, high): (f64, f64),
    measured: &Counted,
    before: &Counted,
    after: Option<&Counted>,
) -> [Html; 2] {
    let width = (high - low) / CLASSES as f64;
    let plot = |x: &str, y: &str, course: &dyn Fn(&Counted) -> Points| {
        let mut plot =
            Plot::new(name, Axis::new(x, "1"), Axis::new(y, unit)).size(Size::Half).columns(CLASSES * 2);
        for (what, tone, counted) in [("before", Tone::Before, Some(before)), ("after", Tone::After, after)] {
            if let Some((x, y)) = counted.map(course) {
                plot = plot.toned(what, tone, &x, &y);
            }
        }
        let (x, y) = course(measured);
        plot.measured("measured", &x, &y).html()
    };
    let levels = |c: &Counted| {
        let y = (0..CLASSES).map(|i| low + (i as f64 + 0.5) * width).collect();
        (c.crossings.iter().map(|n| *n as f64).collect(), y)
    };
    let pairs = |c: &Counted| summed_up(&c.pairs, width);
    [plot("up-crossings", "level", &levels), plot("cycles of this range and larger", "range", &pairs)]
}
