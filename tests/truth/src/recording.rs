//! The recordings and the answer of a case.

use crate::answer::{Answer, Effect, Fault, Parameter, Reference, ReferenceRun};
use crate::catalogue::{alike_on, family};
use crate::draw::Case;
use crate::fault::Tables;
use crate::files;
use crate::random::Random;
use crate::sensor::{Noise, Quantum, quantum};
use crate::simulate::STEP;
use crate::sizing::strongest;
use crate::study::Kind;
use std::path::Path;

/// A case as it is written.
#[derive(Debug, Clone)]
pub struct Recorded {
    /// Name and content of the files of its folder.
    pub files: Vec<(String, String)>,
    /// What is true.
    pub answer: Answer,
    /// What no model can explain.
    pub reference: Reference,
}

impl Recorded {
    /// Writes what a diagnosis may see: the name of the model, the recordings and what is believed.
    ///
    /// # Errors
    /// A folder that cannot be written.
    pub fn write_case(&self, folder: &Path) -> Result<(), String> {
        self.files.iter().try_for_each(|(name, content)| files::write(&folder.join(name), content))
    }

    /// Writes the answer and the floor of the noise.
    ///
    /// # Errors
    /// A folder that cannot be written.
    pub fn write_answer(&self, folder: &Path) -> Result<(), String> {
        let name = &self.answer.case;
        files::write_json(&folder.join(format!("{name}.json")), &self.answer)?;
        files::write_json(&folder.join(format!("{name}.reference.json")), &self.reference)
    }
}

/// Time stamps have this resolution \[s\].
const STAMP: Quantum = Quantum { mantissa: 1, exponent: -5 };

/// Simulates a case and records it.
#[must_use]
pub fn record(case: &Case) -> Recorded {
    let world = &case.world;
    let (inputs, outputs) = (world.base.inputs(), world.base.outputs());
    let mut random = case.random.clone();
    let stamp_error = random.within(0.001, 0.01);
    let share: Vec<f64> = outputs.iter().map(|_| random.within(0.1, 0.5)).collect();
    let quanta: Vec<Quantum> = case.noise.iter().zip(&share).map(|(n, s)| quantum(n.deviation * s)).collect();
    let input_quanta = input_quanta(case);
    let mut tables = Tables { stamps: Vec::new(), columns: Vec::new(), inputs: inputs.len() };
    let mut floor = Vec::new();
    for (number, run) in (0_u64..).zip(&case.runs) {
        let ideal = world.run(run, number, STEP);
        let interval = run.time.last().copied().unwrap_or(1.0) / (run.time.len().max(2) - 1) as f64;
        let stamps = stamped(&mut random, &run.time, stamp_error * interval, STAMP);
        let mut columns: Vec<Vec<f64>> = Vec::new();
        for (values, resolution) in ideal.inputs.iter().zip(&input_quanta) {
            columns.push(values.iter().map(|v| resolution.round(*v)).collect());
        }
        let mut squares = Vec::new();
        for ((values, noise), (resolution, row)) in
            ideal.outputs.iter().zip(&case.noise).zip(quanta.iter().zip(outputs))
        {
            let (recorded, square) = sensed(&mut random, noise, *resolution, (&run.time, &stamps), values);
            squares.push((row.0.to_owned(), square));
            columns.push(recorded);
        }
        tables.stamps.push(stamps);
        tables.columns.push(columns);
        floor.push(ReferenceRun { name: file_name(floor.len()), samples: run.time.len(), channels: squares });
    }
    let mut fault = None;
    if let Kind::Fault(name) = case.kind {
        let offered: Vec<usize> = (0..outputs.len())
            .filter(|c| outputs[*c].0 != "wheel_angle" && (inputs.len() != 5 || *c < 3))
            .collect();
        let struck = tables.spoil(name, &offered, &mut random);
        fault = Some(Fault::of(name, struck, |c| outputs[c].0.to_owned()));
    }
    let quanta: Vec<Quantum> = input_quanta.into_iter().chain(quanta).collect();
    let mut files = vec![("model".to_owned(), format!("{}\n", world.base.name()))];
    for run in 0..case.runs.len() {
        files.push((format!("recordings/{}", file_name(run)), csv(case, &tables, run, &quanta)));
    }
    if let Some(check) = &case.check {
        files.push(("recordings/runs.toml".to_owned(), runs_toml(check)));
    }
    Recorded { files, answer: answer(case, fault), reference: Reference { runs: floor } }
}

/// The stamps of samples, each off by a normal deviation of `error` seconds but for the first, with this resolution.
pub(crate) fn stamped(random: &mut Random, time: &[f64], error: f64, resolution: Quantum) -> Vec<f64> {
    let stamp = |t: &f64| {
        let off = if *t > 0.0 { error * random.normal().clamp(-3.0, 3.0) } else { 0.0 };
        resolution.round(t + off)
    };
    time.iter().map(stamp).collect()
}

/// What a sensor makes of a channel, and the mean square by which that differs from the truth at the stamps.
pub(crate) fn sensed(
    random: &mut Random,
    noise: &Noise,
    resolution: Quantum,
    (time, stamps): (&[f64], &[f64]),
    values: &[f64],
) -> (Vec<f64>, f64) {
    let errors = noise.values(random, values.len());
    let recorded: Vec<f64> = values.iter().zip(&errors).map(|(v, e)| resolution.round(v + e)).collect();
    // nobody can know that a stamp is wrong
    let truth = at_stamps(time, values, stamps);
    let square =
        recorded.iter().zip(&truth).map(|(r, v)| (r - v) * (r - v)).sum::<f64>() / values.len() as f64;
    (recorded, square)
}

/// Values at other times that are near their own.
fn at_stamps(time: &[f64], values: &[f64], stamps: &[f64]) -> Vec<f64> {
    let at = |k: usize| {
        let (from, to) = if stamps[k] < time[k] { (k.saturating_sub(1), k) } else { (k, k + 1) };
        let (from, to) = if to < time.len() { (from, to) } else { (time.len() - 2, time.len() - 1) };
        let slope = (values[to] - values[from]) / (time[to] - time[from]);
        values[k] + slope * (stamps[k] - time[k])
    };
    (0..stamps.len()).map(at).collect()
}

pub(crate) fn file_name(run: usize) -> String {
    format!("run-{:02}.csv", run + 1)
}

fn input_quanta(case: &Case) -> Vec<Quantum> {
    (0..case.world.base.inputs().len())
        .map(|i| {
            let values = || case.runs.iter().flat_map(|run| run.inputs[i].iter().copied());
            let (low, high) =
                values().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
            let range = (high - low).max(1e-3 * high.abs()).max(1e-6);
            quantum(range / 2e4)
        })
        .collect()
}

fn csv(case: &Case, tables: &Tables, run: usize, quanta: &[Quantum]) -> String {
    let rows = case.world.base.inputs().iter().chain(case.world.base.outputs());
    let mut text = String::from("time [s]");
    for row in rows {
        text += &format!(",{} [{}]", row.0, row.1);
    }
    for (k, stamp) in tables.stamps[run].iter().enumerate() {
        text += &format!("\n{stamp:.5}");
        for (column, resolution) in tables.columns[run].iter().zip(quanta) {
            text.push(',');
            // what a fault has scaled no longer lies on its grid
            let fine = matches!(case.kind, Kind::Fault("unit" | "swapped"));
            if fine { text += &format!("{:.7e}", column[k]) } else { text += &resolution.text(column[k]) }
        }
    }
    text + "\n"
}

fn runs_toml(check: &[bool]) -> String {
    let line = |(k, check): (usize, &bool)| {
        format!("\"{}\" = \"{}\"\n", file_name(k), if *check { "check" } else { "fit" })
    };
    format!("[runs]\n{}", check.iter().enumerate().map(line).collect::<String>())
}

fn answer(case: &Case, fault: Option<Fault>) -> Answer {
    let base = case.world.base;
    let outputs = base.outputs();
    let effects = case.world.hidden.iter().zip(&case.marks).map(|(hidden, (depends_on, left))| {
        let (over_noise, order) = strongest(left);
        Effect {
            id: hidden.id.to_owned(),
            family: family(hidden.id).unwrap_or_default().to_owned(),
            channels: order.into_iter().map(|c| outputs[c].0.to_owned()).collect(),
            depends_on: depends_on.clone(),
            accept: if family(hidden.id).is_some() { alike_on(base.name(), hidden.id) } else { Vec::new() },
            size: hidden.size,
            over_noise,
            amounts: Vec::new(),
        }
    });
    let detail = match case.kind.plain() {
        Kind::Clear(id) | Kind::Faint(id) | Kind::Outside(id) | Kind::Fault(id) => id.to_owned(),
        Kind::Mack(k) => format!("K{k}"),
        _ => case.world.hidden.iter().map(|h| h.id).collect::<Vec<_>>().join(" + "),
    };
    Answer {
        case: case.name.clone(),
        kind: case.kind.name().to_owned(),
        detail,
        model: base.name().to_owned(),
        effects: effects.collect(),
        fault,
        decoys: case.decoys.clone(),
        parameters: base
            .parameters()
            .iter()
            .zip(&case.world.parameters)
            .map(|(row, value)| Parameter { name: row.0.to_owned(), start: row.2, value: *value })
            .collect(),
        to_find: case.to_find.clone(),
    }
}
