//! What commands that follow a plan of an identification share: the plan, what it is followed on, and what is known before.

use latsch::fmi::Entry;
use latsch::fmi::import::ImportedFmu;
use latsch::identify::{Numbers, Plan, number, shipped};
use latsch::model::{Interface, Settings, Slave};
use latsch::recording::read_settings;
use latsch::shipped::MODELS;
use latsch::{Result, read_text};
use std::path::Path;

/// A plan that is shipped, or in a file.
pub fn plan(name: &str) -> Result<Plan> {
    let text = match shipped(name) {
        Some(text) => text.to_owned(),
        None => read_text(Path::new(name))?,
    };
    Plan::read(&text).map_err(|e| e.at(name))
}

/// The plan's model, or an FMU in its place.
pub fn slave(plan: &Plan, fmu: Option<&Path>) -> Result<Box<dyn Slave>> {
    match fmu {
        Some(file) => Ok(Box::new(ImportedFmu::load(file)?)),
        None => Ok(Entry::find(MODELS, &plan.model)?.slave(&Settings::default())?),
    }
}

/// The numbers among the values of a parameter file, in the units of the model.
pub fn numbers(file: Option<&Path>, interface: &Interface) -> Result<Numbers> {
    let values = read_settings(file)?.check(interface)?;
    let named = values.iter().filter_map(|(variable, value)| {
        Some((interface.variables[*variable].name.clone(), number(Some(value))?))
    });
    Ok(named.collect())
}
