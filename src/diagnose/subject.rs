//! What is diagnosed: a shipped model, an FMU or a wired system, how to make slaves of it, and which of
//! its parameters a fit may change.

use crate::cosimulate::{System, SystemSlave, read_system};
use crate::fit::Factory;
use crate::fmi::Entry;
use crate::fmi::import::ImportedFmu;
use crate::model::{Causality, Interface, Kind, Settings, Slave, Value, Variability, VariableInfo};
use crate::shipped::MODELS;
use crate::{Error, Result};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// How far a parameter without bounds of its own may move from its nominal value, as a share of it.
const REACH: f64 = 0.5;
/// How many times as long as its own the steps of a model may be while effects are looked for.
const COARSER: [f64; 2] = [2.0, 4.0];
/// Parameters of the numerics, which no recording is fitted with: parts of their names.
const NUMERICAL: &[&str] = &[
    "step_size",
    "sample_time",
    "tolerance",
    "initial",
    "start",
    "actuator",
    "reference",
    "seed",
    "number_of",
    "gravity",
    "road_",
];

/// What the user has in hand.
#[derive(Debug, Clone, PartialEq)]
pub enum Base {
    /// A shipped model with its settings.
    Shipped(String, Settings),
    /// A file of a third party or our own.
    Fmu(PathBuf),
    /// A wired system.
    System(PathBuf),
}

/// A parameter that may be fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeParameter {
    /// Index of the variable.
    pub variable: usize,
    /// Value before the fit.
    pub nominal: f64,
    /// Its typical size: that of the value, or of its range if the value is zero.
    pub scale: f64,
    /// Bounds.
    pub low: f64,
    /// Bounds.
    pub high: f64,
    /// The user asked for it.
    pub asked: bool,
}

/// A model under diagnosis.
pub struct Subject {
    /// What it is.
    pub base: Base,
    /// Makes slaves of it.
    pub factory: Factory,
    /// Its interface.
    pub interface: Interface,
    /// Values that the user set, applied before every run.
    pub fixed: Vec<(usize, Value)>,
    /// What may be fitted.
    pub free: Vec<FreeParameter>,
}

impl Subject {
    /// What is fixed in copies with longer and longer steps of the model's own, if it has such a parameter and the
    /// user has left it alone.
    pub fn coarse(&self) -> Vec<Vec<(usize, Value)>> {
        COARSER.iter().filter_map(|factor| self.with_steps(*factor)).collect()
    }

    fn with_steps(&self, factor: f64) -> Option<Vec<(usize, Value)>> {
        let variable = self.interface.index("step_size")?;
        let info = &self.interface.variables[variable];
        let given = match &self.base {
            Base::Shipped(_, settings) => settings.values.iter().any(|s| s.name == "step_size"),
            _ => self.fixed.iter().any(|(v, _)| *v == variable),
        };
        let start = match info.start {
            Some(Value::Real(start)) => start,
            _ => return None,
        };
        let step = (factor * start).min(info.max.unwrap_or(f64::INFINITY));
        if given || info.causality != Causality::Parameter || info.kind != Kind::Real || step <= start {
            return None;
        }
        Some(self.fixed.iter().cloned().chain([(variable, Value::Real(step))]).collect())
    }

    /// The communication step \[s\] that the model has and no other: that of a wired system.
    pub fn own_step(&self) -> Option<f64> {
        matches!(self.base, Base::System(_)).then_some(self.interface.communication_step)
    }

    /// Loads a model by name or file.
    ///
    /// # Errors
    /// No such model or file, settings that do not fit.
    pub fn load(model: &str, settings: &Settings) -> Result<Self> {
        let path = Path::new(model);
        let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        let (base, factory): (Base, Factory) = match ending.as_str() {
            "fmu" => {
                let file = path.to_path_buf();
                let load = move || -> Result<Box<dyn Slave>> { Ok(Box::new(ImportedFmu::load(&file)?)) };
                (Base::Fmu(path.into()), Arc::new(load))
            }
            "ssd" | "ssp" | "toml" => {
                let file = path.to_path_buf();
                let load = move || -> Result<Box<dyn Slave>> {
                    let (system, step) = wired(&file)?;
                    Ok(Box::new(SystemSlave::new("system", system, step)?))
                };
                (Base::System(path.into()), Arc::new(load))
            }
            _ => {
                let entry = Entry::find(MODELS, model).map_err(|e| {
                    Error::variable(format!(
                        "{e}; an FMU is named by its file F.fmu, a system by F.ssd or F.toml"
                    ))
                })?;
                // with bounds and places, which the model does not need
                let own = Settings { fit: Vec::new(), ..settings.clone() };
                let (given, values) = (own.clone(), own);
                let load = move || -> Result<Box<dyn Slave>> {
                    let slave: Box<dyn Slave> = entry.slave(&values)?;
                    Ok(slave)
                };
                (Base::Shipped(model.into(), given), Arc::new(load))
            }
        };
        let interface = factory()?.interface().clone();
        let fixed = Settings { model: None, ..settings.clone() }.check(&interface)?;
        let free = free_parameters(&interface, &fixed, settings)?;
        Ok(Self { base, factory, interface, fixed, free })
    }
}

/// A wired system from its file, with its communication step \[s\].
///
/// # Errors
/// A file that cannot be read or has no step, parts that cannot be loaded.
pub(super) fn wired(file: &Path) -> Result<(System, f64)> {
    let system = read_system(file)?;
    let loaded = system.plan.load()?;
    let step = system.plan.step.ok_or_else(|| {
        Error::file(format!("{}: there is no communication step; give it in the file", file.display()))
    })?;
    Ok((loaded, step))
}

fn value_of(info: &VariableInfo, variable: usize, fixed: &[(usize, Value)]) -> Option<f64> {
    let set = fixed.iter().find(|(v, _)| *v == variable).map(|(_, value)| value);
    match set.or(info.start.as_ref()) {
        Some(Value::Real(v)) => Some(*v),
        Some(Value::Integer(v)) => Some(f64::from(*v)),
        _ => None,
    }
}

fn free_parameters(
    interface: &Interface,
    fixed: &[(usize, Value)],
    settings: &Settings,
) -> Result<Vec<FreeParameter>> {
    let parameter = |variable: usize, range: Option<(f64, f64)>| {
        let info = &interface.variables[variable];
        let nominal = value_of(info, variable, fixed)?;
        let reach = REACH * nominal.abs();
        let (low, high) = range.unwrap_or((nominal - reach, nominal + reach));
        let low = low.max(info.min.unwrap_or(f64::NEG_INFINITY));
        let high = high.min(info.max.unwrap_or(f64::INFINITY));
        let asked = !settings.fit.is_empty();
        let scale = if nominal == 0.0 { 0.5 * (high - low) } else { nominal.abs() };
        Some(FreeParameter { variable, nominal: nominal.clamp(low, high.max(low)), scale, low, high, asked })
    };
    if settings.fit.is_empty() {
        let names = |name: &str| NUMERICAL.iter().any(|part| name.to_ascii_lowercase().contains(part));
        let all = interface.variables.iter().enumerate().filter(|(_, info)| {
            info.causality == Causality::Parameter
                && matches!(info.variability, Variability::Fixed | Variability::Tunable)
                && info.kind == Kind::Real
                && !names(&info.name)
        });
        return Ok(all
            .filter_map(|(variable, _)| parameter(variable, None))
            .filter(|p| p.nominal != 0.0 && p.high > p.low)
            .collect());
    }
    let mut free = Vec::new();
    for entry in &settings.fit {
        let at = |e: Error| Error::file(e.to_string()).at(&entry.place);
        let variable = interface.find(&entry.name).map_err(at)?;
        let info = &interface.variables[variable];
        if info.causality != Causality::Parameter || info.kind != Kind::Real {
            return Err(at(Error::variable(format!("{} is no real parameter", entry.name))));
        }
        let found = parameter(variable, entry.range)
            .filter(|p| p.high > p.low && p.scale.is_finite() && p.scale > 0.0);
        free.push(found.ok_or_else(|| {
            at(Error::variable(format!("{}: its start value and range leave nothing to fit", entry.name)))
        })?);
    }
    Ok(free)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_copy_with_longer_steps_is_made_unless_the_user_has_chosen_one() {
        let subject = Subject::load("ring-brush-flat-track", &Settings::default()).unwrap();
        let step = subject.interface.index("step_size").unwrap();
        // 0.1 ms by itself, at most 0.5 ms
        assert_eq!(subject.coarse(), [2e-4, 4e-4].map(|long| vec![(step, Value::Real(long))]));
        let file = "[parameters]\nstep_size = 2e-4\n";
        let chosen = Settings::parse(file, "own.toml").unwrap();
        assert_eq!(Subject::load("ring-brush-flat-track", &chosen).unwrap().coarse().len(), 0);
    }
}
