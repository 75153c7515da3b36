//! How far a simulation is from what was measured: errors, free oscillations, and what repeated recordings say of both.

use super::simulation::Beside;
use crate::characteristic::laws::Known;
use crate::comparison::{Difference, Gate, compare};
use crate::page::{Html, Section, Table, number};
use crate::recording::Recording;

/// How far the simulation is from what was measured.
pub(super) fn comparison(simulated: &Recording, beside: Option<Beside<'_>>) -> Section {
    let Some(Beside { measured, conditions }) = beside else {
        return Section::default();
    };
    let (differences, notes) = compare(simulated, measured, conditions);
    let section = Section::new("Simulation and measurement");
    let section =
        if differences.is_empty() { section } else { section.with(errors_table(&differences).html()) };
    let filtered = conditions.low_pass.map(|f| {
        format!(
            " Curves and errors are behind the same low-pass on both: half of the power at {f} Hz, no delay."
        )
    });
    let about = format!(
        "Errors are simulation minus measurement, at the times of {}; peak is the largest measured magnitude, highest and lowest are the errors of these values.{}",
        measured.source,
        filtered.unwrap_or_default()
    );
    let section = section.with(Html::note(&about));
    let section = match conditions.swing {
        Some(window) => swings(section, window, &differences),
        None => section,
    };
    let section = repeats(section, &differences);
    notes.iter().fold(section, |section, note| section.with(Html::note(note)))
}

fn errors_table(differences: &[Difference]) -> Table {
    let head = [
        "channel",
        "unit",
        "RMS error",
        "bias",
        "largest error",
        "RMS / peak [%]",
        "highest",
        "lowest",
        "R²",
        "samples",
    ];
    differences.iter().fold(Table::new(&head), |table, d| {
        table.row([
            d.name.clone(),
            d.unit.clone(),
            number(d.rms),
            number(d.bias),
            number(d.largest),
            number(d.share_of_peak.map_or(f64::NAN, |share| 100.0 * share)),
            number(d.extremes[0]),
            number(d.extremes[1]),
            number(d.r2.unwrap_or(f64::NAN)),
            d.samples.to_string(),
        ])
    })
}

/// Periods and decrements of free oscillations.
fn swings(section: Section, [from, to]: [f64; 2], differences: &[Difference]) -> Section {
    let mut table = Table::new(&[
        "channel",
        "period [s]",
        "measured",
        "error [%]",
        "decrement",
        "measured",
        "error [%]",
        "rest [%]",
    ]);
    let mut notes = vec![format!(
        "Free oscillations from {from} to {to} s, fitted as level + amplitude exp(-δt) cos(ωt + φ); the decrement is the logarithm of amplitudes a period apart. ± is half a 95 % interval of the measured value; the rest is what the fit leaves of the measured amplitude."
    )];
    // why, and the channels of which that is so
    let mut without: Vec<(String, Vec<&str>)> = Vec::new();
    for difference in differences {
        match &difference.swing {
            Some(Ok([own, there])) => {
                let error = |a: Known, b: Known| number(100.0 * (a.value / b.value - 1.0));
                let known = |k: Known| format!("{} ± {}", number(k.value), number(k.half_width));
                table = table.row([
                    difference.name.clone(),
                    number(own.period.value),
                    known(there.period),
                    error(own.period, there.period),
                    number(own.decrement.value),
                    known(there.decrement),
                    error(own.decrement, there.decrement),
                    number(100.0 * there.residual),
                ]);
            }
            Some(Err(e)) => match without.iter_mut().find(|(why, _)| *why == e.to_string()) {
                Some((_, names)) => names.push(&difference.name),
                None => without.push((e.to_string(), vec![&difference.name])),
            },
            None => {}
        }
    }
    notes.extend(without.iter().map(|(why, names)| format!("Not told of {}: {why}.", names.join(", "))));
    let section = if table.is_empty() { section } else { section.with(table.html()) };
    notes.iter().fold(section, |section, note| section.with(Html::note(note)))
}

/// What repeated recordings say about the errors.
fn repeats(section: Section, differences: &[Difference]) -> Section {
    let mut table =
        Table::new(&["channel", "unit", "RMS error to the mean run", "a run to it", "ratio", "says"]);
    let (mut runs, mut notes) = (0, Vec::new());
    for difference in differences {
        let repeated = match &difference.repeated {
            // nothing varies: there is nothing to say
            Some(Ok(repeated)) if repeated.scatter > 0.0 || repeated.common > 0.0 => repeated,
            Some(Err(e)) => {
                notes.push(e.to_string());
                continue;
            }
            _ => continue,
        };
        runs = repeated.runs;
        let says = match repeated.gate() {
            Gate::Beyond => "farther off than a run",
            Gate::NotRepeatable => "little: runs differ by more than their mean varies",
            Gate::Within => "no farther off than a run",
        };
        table = table.row([
            difference.name.clone(),
            difference.unit.clone(),
            number(repeated.rms),
            number(repeated.scatter),
            number(repeated.rms / repeated.scatter),
            says.into(),
        ]);
    }
    if table.is_empty() {
        return notes.iter().fold(section, |section, note| section.with(Html::note(note)));
    }
    let about = format!(
        "{runs} recordings of the same run, at the times that they have. A run to the mean: the standard deviation of a run about the mean of all."
    );
    let section = section.with(table.html()).with(Html::note(&about));
    notes.iter().fold(section, |section, note| section.with(Html::note(note)))
}
