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

/// What a communication point of a part of a system costs, in updates: two FMUs that are wired to each other take 17 us for
/// a step of the master, in which each is set, stepped, read and recorded.
const EXCHANGE: f64 = 190.0;

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
            sum.per_second += own.per_second + EXCHANGE / interface.communication_step;
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
    use std::sync::Arc;

    fn subject(model: &str, parameters: &str) -> Subject {
        Subject::load(model, &Settings::parse(parameters, "own.toml").unwrap()).unwrap()
    }

    /// Ten seconds at a communication step.
    fn run(step: f64) -> Run {
        let drive =
            Drive { start: 0.0, step, inputs: Vec::new(), points: (10.0 / step).round() as usize + 1 };
        Run { name: String::new(), drive: Arc::new(drive), time: Vec::new(), channels: Vec::new() }
    }

    fn word(subject: &Subject, step: f64) -> Effort {
        let fixed = subject.coarse().pop().unwrap_or_else(|| subject.fixed.clone());
        Work::of(subject, &fixed).effort(&run(step), None).0
    }

    #[test]
    fn tires_take_long_and_small_models_do_not() {
        for model in MODELS {
            let is_tire = model.name.starts_with("ring-brush");
            let expected = if is_tire { Effort::Low } else { Effort::Full };
            for step in [1e-3, 1e-2] {
                assert_eq!(word(&subject(model.name, ""), step), expected, "{} {step}", model.name);
            }
        }
        // what it depends on: parts, steps, samples
        let few = subject("ring-brush-flat-track", "[parameters]\nstripes = 1\nbristles_per_stripe = 10\n");
        assert_eq!(word(&few, 1e-2), Effort::Full);
        let short = subject("brake-hydraulics", "[parameters]\nstep_size = 1e-5\n");
        assert_eq!(word(&short, 1e-2), Effort::Low);
        assert_eq!(word(&subject("brake-hydraulics", ""), 1e-4), Effort::Low);
    }

    #[test]
    fn an_fmu_costs_what_its_model_costs() {
        let parameters = "[parameters]\nstripes = 4\nstep_size = 2e-4\n";
        let native = subject("ring-brush-flat-track", parameters);
        let expected = Work::of(&native, &native.fixed);
        assert_eq!(expected, Work { per_second: (SMALL_STEP + 4.0 * 30.0) / 2e-4, is_known: true });
        // as an FMU has it: its parameters are start values of its description, and effects add variables
        let mut fmu = subject("ring-brush-flat-track", "");
        fmu.base = Base::Fmu("tire.fmu".into());
        for (variable, value) in &native.fixed {
            fmu.interface.variables[*variable].start = Some(value.clone());
        }
        let mut delay = fmu.interface.variables[0].clone();
        delay.name = "sensor_delay.delay".into();
        fmu.interface.variables.push(delay);
        assert_eq!(Work::of(&fmu, &[]), expected);
        // one that lacks a variable is another model, of which nothing is known
        fmu.interface.variables.retain(|v| v.name != "belt_mass");
        let unknown = Work::of(&fmu, &[]);
        assert_eq!(unknown, Work { per_second: 8.0 / 1e-3, is_known: false });
        let (effort, why) = unknown.effort(&run(1e-2), None);
        assert_eq!(effort, Effort::Full);
        assert!(why.contains("is not known") && why.contains("--effort low"), "{why}");
        assert_eq!(unknown.effort(&run(1e-2), Some(Effort::Low)).0, Effort::Low);
        // in a system its parts cost, and meeting them at every step of the system
        let mut system = native;
        system.base = Base::System("system.toml".into());
        system.interface.variables.iter_mut().for_each(|v| v.name = format!("tire.{}", v.name));
        system.interface.communication_step = 1e-3;
        let part = Work::of(&system, &system.fixed);
        assert!((part.per_second - expected.per_second - EXCHANGE / 1e-3).abs() < 1e-6 && part.is_known);
    }
}
