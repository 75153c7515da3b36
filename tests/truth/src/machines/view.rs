//! The same machine, told differently: what a diagnosis says of it must not change.

use super::mechanism::{Machine, Variable};
use crate::random::Random;
use std::fmt::Write as _;
use std::str::FromStr;

/// What is different. Nothing that the machine does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum View {
    /// Nothing.
    Same,
    /// All values but angles and shares are a thousand times larger: other units, under the same names.
    Larger,
    /// A thousand times smaller.
    Smaller,
    /// All takes ten times as long.
    Slower,
    /// A tenth.
    Faster,
    /// The first output counts the other way, in the unit and in the recordings.
    Turned,
    /// Columns have other names, and a map.
    Renamed,
    /// Runs come in the reverse order.
    Reordered,
    /// An input was recorded that does nothing.
    Beside,
    /// Twice the samples.
    Doubled,
    /// In one run the last output counts the other way: a fault of that recording.
    Spoilt,
}

/// All of them, by name.
pub const VIEWS: [(&str, View); 11] = [
    ("same", View::Same),
    ("larger", View::Larger),
    ("smaller", View::Smaller),
    ("slower", View::Slower),
    ("faster", View::Faster),
    ("turned", View::Turned),
    ("renamed", View::Renamed),
    ("reordered", View::Reordered),
    ("beside", View::Beside),
    ("doubled", View::Doubled),
    ("spoilt", View::Spoilt),
];

impl FromStr for View {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let all: Vec<&str> = VIEWS.iter().map(|(name, _)| *name).collect();
        let found = VIEWS.iter().find(|(n, _)| *n == name).map(|(_, view)| *view);
        found.ok_or_else(|| format!("there is no view {name:?}; there are {}", all.join(", ")))
    }
}

/// The name and unit of the input that does nothing.
pub(super) const IDLE: (&str, &str) = ("spare_voltage", "V");

impl View {
    /// How many times as long everything takes.
    #[must_use]
    pub fn time(self) -> f64 {
        match self {
            Self::Slower => 10.0,
            Self::Faster => 0.1,
            _ => 1.0,
        }
    }

    /// What the numbers of a variable are multiplied with.
    fn factor(self, unit: &str) -> f64 {
        let is_plain = matches!(unit, "rad" | "rad/s" | "rad/s2" | "1");
        match self {
            Self::Larger if !is_plain => 1e3,
            Self::Smaller if !is_plain => 1e-3,
            // positions stay, so that speeds change
            Self::Slower | Self::Faster => match unit {
                "m/s" | "rad/s" => 1.0 / self.time(),
                "m/s2" | "rad/s2" => 1.0 / (self.time() * self.time()),
                _ => 1.0,
            },
            _ => 1.0,
        }
    }

    /// Whether an input does nothing.
    pub(super) fn has_idle(self) -> bool {
        self == Self::Beside
    }

    /// The factors of all inputs and of all outputs.
    #[must_use]
    pub fn factors(self, machine: &Machine) -> (Vec<f64>, Vec<f64>) {
        let inputs = machine.inputs.iter().map(|v| self.factor(v.unit)).collect();
        let turned = |k: usize| if self == Self::Turned && k == 0 { -1.0 } else { 1.0 };
        let outputs = machine.outputs.iter().enumerate().map(|(k, (v, _))| turned(k) * self.factor(v.unit));
        (inputs, outputs.collect())
    }

    /// The files of a case as they are told.
    #[must_use]
    pub fn told(self, machine: &Machine, files: Vec<(String, String)>) -> Vec<(String, String)> {
        let count = files.len();
        let is_run = |name: &str| name.starts_with("recordings/");
        let (inputs, outputs) = self.factors(machine);
        let factors = [vec![self.time()], inputs, outputs].concat();
        let mut told: Vec<(String, String)> = Vec::new();
        for (k, (name, text)) in files.iter().enumerate() {
            if !is_run(name) {
                told.push((name.clone(), text.clone()));
                continue;
            }
            // the runs are the last files
            let first = files.iter().position(|(name, _)| is_run(name)).unwrap_or(0);
            let name = if self == Self::Reordered { &files[first + count - 1 - k].0 } else { name };
            let mut factors = factors.clone();
            if self == Self::Spoilt
                && k == first
                && let Some(last) = factors.last_mut()
            {
                *last = -*last;
            }
            told.push((name.clone(), self.table(text, &factors, k as u64)));
        }
        if self == Self::Renamed {
            let mut map = String::from("[channels]\n");
            for (k, variable) in variables(machine).enumerate() {
                let (name, unit) = (&variable.name, variable.unit);
                let _ = writeln!(map, "\"{}\" = {{ variable = \"{name}\", unit = \"{unit}\" }}", column(k));
            }
            let _ = writeln!(map, "\"t/s\" = {{ variable = \"time\", unit = \"s\" }}");
            told.push(("map.toml".to_owned(), map));
        }
        told
    }

    /// A recording with its columns multiplied.
    fn table(self, text: &str, factors: &[f64], run: u64) -> String {
        let mut idle = Random::new(run, 4711);
        let mut level = 0.0;
        let mut lines = text.lines();
        let header: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
        let mut told = match self {
            Self::Renamed => {
                let names: Vec<String> = (0..header.len() - 1).map(column).collect();
                format!("t/s,{}", names.join(","))
            }
            Self::Beside => format!("{},{} [{}]", header.join(","), IDLE.0, IDLE.1),
            _ => header.join(","),
        };
        told.push('\n');
        for line in lines {
            let cells = line.split(',').zip(factors).map(|(cell, factor)| match cell.parse::<f64>() {
                Ok(value) if *factor != 1.0 => format!("{:e}", value * factor),
                _ => cell.to_owned(),
            });
            told += &cells.collect::<Vec<_>>().join(",");
            if self.has_idle() {
                level += 0.1 * (idle.normal() - level);
                let _ = write!(told, ",{level:.4}");
            }
            told.push('\n');
        }
        told
    }
}

fn variables(machine: &Machine) -> impl Iterator<Item = &Variable> {
    machine.inputs.iter().chain(machine.outputs.iter().map(|(v, _)| v))
}

/// What a column is called whose name says nothing.
fn column(k: usize) -> String {
    format!("Channel {} (raw)", k + 1)
}

#[cfg(test)]
mod tests {
    use super::super::mechanism::Sensor;
    use super::*;

    #[test]
    fn a_recording_is_told_in_other_words() {
        let variable = |name: &str, unit| Variable { name: name.into(), unit };
        let machine = Machine {
            inputs: vec![variable("push", "N")],
            outputs: vec![
                (variable("x", "m"), Sensor::State(0)),
                (variable("v", "m/s"), Sensor::State(1)),
                (variable("w", "rad/s"), Sensor::State(1)),
            ],
            ..Machine::default()
        };
        let run = "time [s],push [N],x [m],v [m/s],w [rad/s]\n0.5,2,0.25,-4,8\n";
        let files = |names: &[&str]| -> Vec<(String, String)> {
            let one = |name: &&str| ((*name).to_owned(), run.replace("0.25", &format!("0.2{}", name.len())));
            std::iter::once(("model".to_owned(), "machine.fmu\n".to_owned()))
                .chain(names.iter().map(one))
                .collect()
        };
        let row = |view: View| {
            view.told(&machine, files(&["recordings/a.csv"]))[1].1.lines().nth(1).unwrap().to_owned()
        };
        assert_eq!(row(View::Same), "0.5,2,0.216,-4,8");
        assert_eq!(row(View::Larger), "0.5,2e3,2.16e2,-4e3,8");
        assert_eq!(row(View::Slower), "5e0,2,0.216,-4e-1,8e-1");
        assert_eq!(row(View::Turned), "0.5,2,-2.16e-1,-4,8");
        assert_eq!(row(View::Spoilt), "0.5,2,0.216,-4,-8e0");
        assert_eq!(row(View::Beside).split(',').count(), 6);
        let reordered = View::Reordered.told(&machine, files(&["recordings/a.csv", "recordings/bb.csv"]));
        assert!(reordered[1].0 == "recordings/bb.csv" && reordered[1].1.contains("0.216"));
        let renamed = View::Renamed.told(&machine, files(&["recordings/a.csv"]));
        assert!(renamed[1].1.starts_with("t/s,Channel 1 (raw),Channel 2"));
        assert!(renamed[2].1.contains("\"Channel 4 (raw)\" = { variable = \"w\", unit = \"rad/s\" }"));
    }
}
