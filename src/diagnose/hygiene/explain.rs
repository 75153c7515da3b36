//! Whether an operating condition explains what a run has and the others do not.
//!
//! With many conditions and few runs a line through one odd run always exists: where only the odd run has a
//! condition, it alone holds the line (its leverage is near 1), and the line says nothing. Then the run itself
//! has to say it. An effect of a condition goes up and down with it within the run, too, with the slope that
//! the runs claim; a fault stays what it is, whatever the condition does. A condition that does not move
//! within the odd run, or too little against the noise, is left as an explanation. Of several runs that have the same number a
//! line has to say that as well: conditions that differ do not make the same.

use super::against::Table;
use super::align::{Pair, period};
use crate::stats::{Line, about_mean, correlation, deviation, mean, median};

/// A condition explains a deviation if a line through all runs has this correlation.
const EXPLAINED: f64 = 0.95;
/// The other runs support that line if their own has this correlation,
const SUPPORTED: f64 = 0.8;
/// and its slope this share of the whole one's.
const SAME_SLOPE: std::ops::Range<f64> = 0.5..2.0;
/// Windows that the odd run is cut into.
const WINDOWS: usize = 12;
/// Samples that a window has to have.
const SAMPLES: usize = 30;
/// The share of the claimed slope that may be found within the run, two standard errors added, if the
/// condition is no explanation.
const ABSENT: f64 = 0.4;

/// By how many times less exactly than two numbers, that of the odd runs and that of the others, a line may say those of all runs: of five
/// runs chance does as much in about a hundredth of the cases (F distribution of 3 and 3), of four, the fewest that there are, in one of 26.
const AS_EXACT: f64 = 5.0;

/// A number of the times and values of a channel.
type Kind = fn(&[f64], &[f64]) -> f64;

/// What of a channel may be a condition: level, amplitude, frequency.
const KINDS: [Kind; 3] =
    [|_, values| mean(values), |_, values| deviation(values), |time, values| 1.0 / period(time, values)];

/// Whether a line over one operating condition explains the deviation of run number `odd`. `values` are the
/// numbers of all runs; `within` gives that of a part of the odd run, as far as it has one.
pub fn explained(
    table: &Table,
    pairs: &[&Pair],
    values: &[f64],
    odd: usize,
    within: &dyn Fn(usize, usize) -> Option<f64>,
) -> bool {
    let parts = parts(pairs[odd].time.len(), within);
    courses(table, pairs, odd).iter().any(|courses| {
        KINDS.iter().any(|kind| {
            let condition: Vec<f64> = courses.iter().map(|(time, values)| kind(time, values)).collect();
            if condition.iter().any(|v| !v.is_finite()) || correlation(&condition, values).abs() <= EXPLAINED
            {
                return false;
            }
            if says_less(&condition, values, odd) {
                return false;
            }
            let Some(line) = Line::through(&condition, values) else { return false };
            if supported(&line, &condition, values, odd) {
                return true;
            }
            let (time, course) = courses[odd];
            let (conditions, numbers): (Vec<f64>, Vec<f64>) = parts
                .iter()
                .filter(|part| part.to <= course.len())
                .map(|part| (kind(&time[part.from..part.to], &course[part.from..part.to]), part.number))
                .filter(|(condition, _)| condition.is_finite())
                .unzip();
            !absent(&line, &conditions, &numbers)
        })
    })
}

/// Times and values of a channel in one run.
type Course<'a> = (&'a [f64], &'a [f64]);

/// The channels that may be conditions, each in every run: the simulated channel and the inputs.
fn courses<'a>(table: &'a Table, pairs: &[&'a Pair], odd: usize) -> Vec<Vec<Course<'a>>> {
    let own = pairs.iter().map(|pair| (pair.time, pair.simulated)).collect();
    let inputs = table.measured[pairs[odd].run]
        .channels
        .iter()
        .map(|channel| channel.name.as_str())
        .filter(|name| !table.channels.iter().any(|output| output == name));
    let in_all_runs = |name: &str| {
        pairs
            .iter()
            .map(|pair| {
                let recording = &table.measured[pair.run];
                let channel = recording.channels.iter().find(|c| c.name == name)?;
                Some((recording.time.as_slice(), channel.values.as_slice()))
            })
            .collect::<Option<Vec<Course>>>()
    };
    std::iter::once(own).chain(inputs.filter_map(in_all_runs)).collect()
}

/// A part of the odd run and its number.
struct Part {
    from: usize,
    to: usize,
    number: f64,
}

fn parts(samples: usize, within: &dyn Fn(usize, usize) -> Option<f64>) -> Vec<Part> {
    let count = WINDOWS.min(samples / SAMPLES);
    (0..count)
        .map(|k| (k * samples / count, (k + 1) * samples / count))
        .filter_map(|(from, to)| Some(Part { from, to, number: within(from, to)? }))
        .collect()
}

/// Numbers that are nearer to the odd run's than to the usual one, its own among them, and the others.
pub fn parted(values: &[f64], odd: usize) -> (Vec<f64>, Vec<f64>) {
    let usual = median(values);
    values.iter().partition(|v| (*v - values[odd]).abs() < (*v - usual).abs())
}

/// Whether several runs have the odd one's number, and say so more exactly than any line over the condition does.
fn says_less(condition: &[f64], values: &[f64], odd: usize) -> bool {
    let (alike, others) = parted(values, odd);
    let of_line = about_mean(values) * (1.0 - correlation(condition, values).powi(2));
    alike.len() > 1 && of_line > AS_EXACT.powi(2) * (about_mean(&alike) + about_mean(&others))
}

/// Whether the runs without the odd one lie on the line, too, and go along it.
fn supported(line: &Line, condition: &[f64], values: &[f64], odd: usize) -> bool {
    let others = |of: &[f64]| -> Vec<f64> {
        of.iter().enumerate().filter(|(i, _)| *i != odd).map(|(_, v)| *v).collect()
    };
    let (condition, values) = (others(condition), others(values));
    correlation(&condition, &values).abs() > SUPPORTED
        && Line::through(&condition, &values).is_some_and(|o| SAME_SLOPE.contains(&(o.slope / line.slope)))
}

/// Whether the condition moves within the run and the number does not go with it as the line says.
fn absent(line: &Line, condition: &[f64], numbers: &[f64]) -> bool {
    condition.len() > 4
        && Line::through(condition, numbers).is_some_and(|within| {
            within.slope / line.slope + 2.0 * (within.error / line.slope).abs() < ABSENT
        })
}
