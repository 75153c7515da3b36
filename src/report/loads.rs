//! The page of loads: what of a simulation matters for damage, beside recordings of the same run.

use super::plot::{Axis, Plot, Size};
use crate::loads::{Compared, Conditions, Load, SURE, summed_up};
use crate::page::{Html, Page, Section, Table, number};
use crate::stats::extent;

/// The page of a comparison with recordings, whose names are given in their order.
pub fn loads_report(title: &str, recordings: &[String], all: &[Compared], conditions: &Conditions) -> String {
    let lead = match recordings.len() {
        1 => format!("Simulated loads beside the recording {}.", recordings[0]),
        n => format!("Simulated loads beside {n} recordings of the same run: {}.", recordings.join(", ")),
    };
    let mut page = Page::new(title, &lead).section(summary(recordings.len(), all, conditions));
    for one in all {
        page = page.section(Section::new(&format!("{} [{}]", one.name, one.unit)).side_by_side([
            crossings(one),
            pairs(one),
            amplitudes(one),
        ]));
    }
    page.html()
}

fn summary(runs: usize, all: &[Compared], conditions: &Conditions) -> Section {
    let mut head: Vec<&str> = vec!["channel", "", "simulated", "recorded"];
    if runs > 1 {
        head.extend(["to", "a further one", "to", "simulation is"]);
    }
    let mut table = Table::new(&head);
    for one in all {
        let channel = format!("{} [{}]", one.name, one.unit);
        for (name, band) in one.bands() {
            let mut row =
                vec![channel.clone(), name.into(), number(band.simulated), number(band.recorded[0])];
            if runs > 1 {
                let [low, high] = band.further.unwrap_or([f64::NAN; 2]).map(number);
                row.extend([number(band.recorded[1]), low, high, verdict(band.off())]);
            }
            table = table.row(row);
        }
        let (least, most) = extent(one.errors.iter().copied());
        let mut row = vec![channel, "rms error".into(), String::new(), number(least)];
        if runs > 1 {
            let repeats = one.repeats.iter().copied().fold(0.0, f64::max);
            let differ = format!("recordings differ by up to {}", number(repeats));
            row.extend([number(most), String::new(), String::new(), differ]);
        }
        table = table.row(row);
    }
    let over = conditions.over.as_ref().map_or("time".to_owned(), |name| format!("{name}, not over time"));
    Section::new("Loads").with(table.html()).with(Html::note(&format!(
        "Cycles by rainflow (four-point method), each range of the residue as half a cycle; movements below {:.0} % of the recorded span are left out. \
         Damage is the sum of range to the power {}, over that of the first recording. Crossings are upward, of the middle of the recorded span. \
         A further recording of the same run would be in its band with {:.0} % (Student's t; of three recordings every second further one is outside of what they span). \
         All histories were brought to the longest interval of their samples. Errors are over {over}: they mix size and timing, which does not matter for damage.",
        100.0 * conditions.gate,
        conditions.slope,
        100.0 * SURE
    )))
}

/// Where a quantity is in the band of a further recording.
fn verdict(off: Option<f64>) -> String {
    match off {
        None => "recordings say nothing of it".into(),
        Some(off) if off.abs() <= 1.0 => "within".into(),
        Some(off) => {
            format!("{}, {} times as far off", if off < 0.0 { "below" } else { "above" }, number(off.abs()))
        }
    }
}

/// A plot of all recordings and the simulation.
fn plotted(one: &Compared, x: Axis, y: Axis, of: impl Fn(&Load) -> (Vec<f64>, Vec<f64>)) -> Html {
    let mut plot = Plot::new("", x, y).size(Size::Half);
    for (k, load) in one.recorded.iter().enumerate() {
        let (x, y) = of(load);
        let name = if one.recorded.len() == 1 { "recorded".into() } else { format!("recorded {}", k + 1) };
        plot = plot.measured(&name, &x, &y);
    }
    let (x, y) = of(&one.simulated);
    plot.line("simulated", &x, &y).html()
}

fn crossings(one: &Compared) -> Html {
    plotted(one, Axis::new("up-crossings", "1"), Axis::new("level", &one.unit), |load| {
        (load.crossings.iter().map(|n| *n as f64).collect(), one.levels.clone())
    })
}

/// Cycles summed up from the largest range.
fn pairs(one: &Compared) -> Html {
    plotted(one, Axis::new("cycles of this range and larger", "1"), Axis::new("range", &one.unit), |load| {
        summed_up(&load.pairs, one.values.width)
    })
}

fn amplitudes(one: &Compared) -> Html {
    plotted(one, Axis::new("frequency", "Hz"), Axis::new("amplitude", &one.unit), |load| {
        load.spectrum.as_ref().map_or_else(Default::default, |s| (s.places(), s.amplitudes.clone()))
    })
}
