//! What was compared, as CSV.

use super::compare::{Compared, QUANTITIES};
use super::count::from_to;
use crate::{Error, Result};

fn written(rows: Vec<Vec<String>>) -> Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.write_record(row).map_err(|e| Error::file(e.to_string()))?;
    }
    let bytes = writer.into_inner().map_err(|e| Error::file(e.to_string()))?;
    String::from_utf8(bytes).map_err(|e| Error::file(e.to_string()))
}

/// A row for each quantity of each channel: simulated, recorded, where a further recording would be, and how far the simulation is from
/// the middle of that, over half its width.
///
/// # Errors
/// The writer fails.
pub fn quantities(all: &[Compared], runs: usize) -> Result<String> {
    let mut head: Vec<String> = ["channel", "unit", "quantity", "simulated"].map(String::from).to_vec();
    head.extend((1..=runs).map(|k| format!("recorded_{k}")));
    head.extend(["further_from", "further_to", "off"].map(String::from));
    let mut rows = vec![head];
    for one in all {
        for ((name, of), (_, band)) in QUANTITIES.iter().zip(one.bands()) {
            let mut row =
                vec![one.name.clone(), one.unit.clone(), (*name).into(), of(&one.simulated).to_string()];
            row.extend(one.recorded.iter().map(|load| of(load).to_string()));
            row.extend(
                band.further.map_or([const { String::new() }; 2], |ends| ends.map(|end| end.to_string())),
            );
            row.push(band.off().map_or(String::new(), |share| share.to_string()));
            rows.push(row);
        }
        let mut row = vec![one.name.clone(), one.unit.clone(), "rms error".into(), "0".into()];
        row.extend(one.errors.iter().map(f64::to_string));
        row.extend([const { String::new() }; 3]);
        rows.push(row);
    }
    written(rows)
}

/// A row for each class of each channel: its level and the crossings of it upward, its range and the cycles in it.
///
/// # Errors
/// The writer fails.
pub fn counts(all: &[Compared], runs: usize) -> Result<String> {
    let columns = |what: &str| {
        let recorded = (1..=runs).map(move |k| format!("recorded_{k}_{what}"));
        std::iter::once(format!("simulated_{what}")).chain(recorded).collect::<Vec<_>>()
    };
    let mut head: Vec<String> = ["channel", "unit", "level"].map(String::from).to_vec();
    head.extend(columns("crossings"));
    head.extend(["range_from".into(), "range_to".into()]);
    head.extend(columns("cycles"));
    let mut rows = vec![head];
    for one in all {
        let loads: Vec<_> = std::iter::once(&one.simulated).chain(&one.recorded).collect();
        for k in 0..one.simulated.pairs.len() {
            let mut row = vec![one.name.clone(), one.unit.clone()];
            row.push(one.levels.get(k).map_or(String::new(), f64::to_string));
            row.extend(
                loads.iter().map(|load| load.crossings.get(k).map_or(String::new(), usize::to_string)),
            );
            row.extend([k, k + 1].map(|k| (k as f64 * one.values.width).to_string()));
            row.extend(loads.iter().map(|load| load.pairs[k].to_string()));
            rows.push(row);
        }
    }
    written(rows)
}

/// The from-to matrix of each channel and run: a row for each cell that has cycles, with the classes that they lead from and to and their number.
///
/// # Errors
/// The writer fails.
pub fn matrices(all: &[Compared]) -> Result<String> {
    let head = ["channel", "unit", "run", "from_low", "from_high", "to_low", "to_high", "cycles"];
    let mut rows = vec![head.map(String::from).to_vec()];
    for one in all {
        let recorded = one.recorded.iter().enumerate().map(|(k, load)| (format!("recorded_{}", k + 1), load));
        for (run, load) in std::iter::once(("simulated".to_owned(), &one.simulated)).chain(recorded) {
            for (cell, cycles) in from_to(&load.counted, &one.values) {
                let mut row = vec![one.name.clone(), one.unit.clone(), run.clone()];
                row.extend(cell.iter().flat_map(|class| one.values.ends(*class)).map(|end| end.to_string()));
                row.push(cycles.to_string());
                rows.push(row);
            }
        }
    }
    written(rows)
}
