//! How much effort a model gets. What its simulation costs is counted and never timed: the answer must not depend on
//! how fast a machine is, or on what else it does.

use super::result::Effort;
use super::subject::{Base, Subject};
use crate::fit::{Drive, Run};
use crate::fmi::Entry;
use crate::model::{Causality, Interface, Kind, SMALL_STEP, Setting, Settings, Slave, Value, VariableInfo};
use crate::shipped::MODELS;
use std::mem::discriminant;

/// A model that costs more for a second of a recording takes long \[s\].
const LONG: f64 = 5e-3;
/// What an update of a bristle costs \[s\]: a core of the machine of docs/tires-on-vehicles.md takes 75 us for ten steps
/// of a tire with 180 of them.
const UPDATE: f64 = 40e-9;
/// What a communication point costs, in updates: inputs are set, outputs read and compared.
const POINT: f64 = 25.0;

/// What a simulation costs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Work {
    /// Updates in a simulated second, beside those of communication points.
    per_second: f64,
    /// All parts told it; of others small steps are assumed.
    is_known: bool,
}

impl Work {
    /// Of a model with these values.
    pub fn of(subject: &Subject, fixed: &[(usize, Value)]) -> Self {
        let interface = &subject.interface;
        let Base::System(_) = subject.base else { return Self::of_part(interface, "", fixed) };
        let mut parts: Vec<&str> =
            interface.variables.iter().filter_map(|v| Some(v.name.split_once('.')?.0)).collect();
        parts.dedup();
        let mut sum = Self { per_second: 0.0, is_known: true };
        for part in parts {
            let own = Self::of_part(interface, &format!("{part}."), fixed);
            // the master meets each part at every communication point
            sum.per_second += own.per_second + POINT / interface.communication_step;
            sum.is_known &= own.is_known;
        }
        sum
    }

    /// Of the part whose variables begin so: a shipped model tells it, also as an FMU and with effects.
    fn of_part(interface: &Interface, part: &str, fixed: &[(usize, Value)]) -> Self {
        let told = MODELS.iter().find_map(|entry| twin(entry, interface, part, fixed)?.work());
        told.map_or_else(|| Self::assumed(interface), |per_second| Self { per_second, is_known: true })
    }

    /// Of a model that does not tell: a small step in each interval that its maker names.
    pub fn assumed(interface: &Interface) -> Self {
        Self { per_second: SMALL_STEP / interface.communication_step, is_known: false }
    }

    /// What it costs to simulate along a drive, on the machine of docs/tires-on-vehicles.md \[s\].
    pub fn cost(&self, drive: &Drive) -> f64 {
        let steps = drive.points.saturating_sub(1) as f64;
        UPDATE * (steps * drive.step * self.per_second + drive.points as f64 * POINT)
    }

    /// The effort for runs like this one, and why.
    pub fn effort(&self, run: &Run, asked: Option<Effort>) -> (Effort, String) {
        let simulated = run.drive.points.saturating_sub(1) as f64 * run.drive.step;
        let share = self.cost(&run.drive) / simulated.max(f64::MIN_POSITIVE);
        let effort = asked.unwrap_or(if share > LONG { Effort::Low } else { Effort::Full });
        let word = match effort {
            Effort::Full => "full",
            Effort::Low => "low",
        };
        let why = match (asked, self.is_known) {
            (Some(_), _) => "as was asked for".into(),
            (None, true) => format!(
                "by its steps the model takes about {} ms for a second of the recordings, and more than {} ms is long; this is counted, not timed",
                crate::page::number((1e3 * share * 10.0).round() / 10.0),
                1e3 * LONG
            ),
            (None, false) => {
                "what a step of this model costs is not known and was taken for little; --effort low tries less".into()
            }
        };
        (effort, format!("Effort: {word}, {why}."))
    }
}

/// The shipped model that the variables which begin so are those of, with their values: before a start it tells as much
/// as the FMU that was made of it could.
fn twin(
    entry: &Entry,
    interface: &Interface,
    part: &str,
    fixed: &[(usize, Value)],
) -> Option<Box<dyn Slave + Send>> {
    let table = (entry.table)();
    let of = |own: &VariableInfo| interface.index(&format!("{part}{}", own.name));
    let told = table.variables.iter().filter(|v| v.causality != Causality::Independent);
    let mut values = Vec::new();
    for own in told {
        let variable = of(own)?;
        let info = &interface.variables[variable];
        if discriminant(&own.kind) != discriminant(&info.kind) {
            return None;
        }
        let fixed = fixed.iter().rev().find(|(v, _)| *v == variable).map(|(_, value)| value);
        if let Some(value) = fixed.or(info.start.as_ref())
            && own.causality == Causality::Parameter
            && own.kind != Kind::Text
        {
            let (name, causality) = (own.name.clone(), Causality::Parameter);
            values.push(Setting { name, value: value.clone(), causality, place: String::new() });
        }
    }
    entry.slave(&Settings { values, ..Settings::default() }).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::{Bench, Setup};
    use std::sync::Arc;

    fn subject(model: &str, parameters: &str) -> Subject {
        Subject::load(model, &Settings::parse(parameters, "own.toml").unwrap()).unwrap()
    }

    /// Ten seconds at a communication step.
    fn run(step: f64) -> Run {
        let drive = Drive { start: 0.0, step, inputs: Vec::new(), points: (10.0 / step).round() as usize + 1 };
        Run { name: String::new(), drive: Arc::new(drive), time: Vec::new(), channels: Vec::new() }
    }

    #[test]
    fn measure() {
        for model in ["brake-hydraulics", "abs-controller", "ring-brush-flat-track", "ring-brush-corner"] {
            let s = subject(model, "");
            let fixed = s.coarse().pop().unwrap_or(s.fixed.clone());
            let bench = Bench::new(&s.factory, &fixed, 1).unwrap();
            for step in [1e-3, 1e-2] {
                let r = run(step);
                let watch: Arc<[usize]> = s.interface.with(Causality::Output).take(2).collect();
                let drive = Arc::new(Drive { inputs: s.interface.with(Causality::Input).take(2).map(|v| {
                    let Some(Value::Real(x)) = s.interface.variables[v].start else { panic!() };
                    (v, (0..r.drive.points).map(|k| x * (1.0 + 1e-3 * (k as f64 * 0.1).sin())).collect()) }).collect(), ..(*r.drive).clone() });
                for _ in 0..2 {
                let t = std::time::Instant::now();
                let a = bench.run(&[Arc::new(Setup::default())], &[Arc::clone(&drive)], &watch);
                let e = t.elapsed().as_secs_f64();
                println!("{model} {step} {} {:.3} ms/s, counted {:.3}", a[0].is_ok(), e * 100.0, 100.0 * Work::of(&s, &fixed).cost(&drive));
                }
            }
        }
    }
}
