//! [`Plan`]: what a file says of a system.

use super::energy::BondKind;
use super::master::Coupling;
use super::run::Experiment;
use super::system::{Port, System, Transfer};
use crate::fmi::Entry;
use crate::fmi::import::ImportedFmu;
use crate::model::unit::Unit;
use crate::model::{Causality, Kind, Slave, Value, VariableInfo};
use crate::recording::{Columns, read_recording_as, read_settings};
use crate::shipped::MODELS;
use crate::{Error, Result};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// A system as a file describes it: by names, with the places of everything for messages.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Plan {
    /// The file.
    pub source: String,
    /// The components, in the order of the file.
    pub components: Vec<PlannedComponent>,
    /// What the file says of variables, to be compared with what the components say.
    pub connectors: Vec<PlannedConnector>,
    /// Output to input.
    pub connections: Vec<PlannedConnection>,
    /// Pairs whose energy is watched; empty: those that the units show.
    pub bonds: Vec<PlannedBond>,
    /// Inputs that follow recordings.
    pub inputs: Vec<PlannedInputs>,
    /// Start \[s\].
    pub start: Option<f64>,
    /// Stop \[s\].
    pub stop: Option<f64>,
    /// Communication step \[s\].
    pub step: Option<f64>,
    /// Names of the components in the order in which they are stepped; `None`: side by side.
    pub order: Option<Vec<String>>,
    /// See [`Coupling::iterate`].
    pub iterate: usize,
    /// See [`Coupling::halvings`].
    pub halvings: u32,
    /// Every how many communication points are recorded, beside the last one; 0 is taken for 1.
    pub record_every: usize,
    /// CSV files of roads, whose points are among the values.
    pub profiles: Vec<PathBuf>,
    /// What was read and is not used.
    pub warnings: Vec<String>,
}

/// A component by its source.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedComponent {
    /// Its name in the system.
    pub name: String,
    /// What it is made from.
    pub source: Source,
    /// Values of parameters, and constant ones of inputs.
    pub set: Vec<Assignment>,
    /// Where it stands in the file.
    pub place: String,
}

/// What a component is made from.
#[derive(Debug, Clone, PartialEq)]
pub enum Source {
    /// A shipped model by name, with a file of parameters.
    Model(String, Option<PathBuf>),
    /// An FMU file.
    Fmu(PathBuf),
}

/// The value of one variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Assignment {
    /// Name of the variable.
    pub variable: String,
    /// Its value; for a real variable also a text with a unit.
    pub value: Value,
    /// Where it stands in the file.
    pub place: String,
}

/// A variable of a component, by names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PortName {
    /// Name of the component.
    pub component: String,
    /// Name of the variable.
    pub variable: String,
}

/// A variable as a file describes it.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedConnector {
    /// The variable.
    pub port: PortName,
    /// Its causality.
    pub causality: Causality,
    /// Its type, in the words of SSP: Real, Integer, Boolean, String, Enumeration.
    pub kind: Option<String>,
    /// Its unit.
    pub unit: Option<String>,
    /// Where it stands in the file.
    pub place: String,
}

/// A connection by names.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedConnection {
    /// The output.
    pub from: PortName,
    /// The input.
    pub to: PortName,
    /// What happens on the way.
    pub transfer: Transfer,
    /// Where it stands in the file.
    pub place: String,
}

/// A pair of outputs whose energy is watched.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedBond {
    /// Force or moment.
    pub effort: PortName,
    /// What goes the other way.
    pub motion: PortName,
    /// What that is.
    pub kind: BondKind,
    /// Where it stands in the file.
    pub place: String,
}

/// A recording and the inputs that follow it.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedInputs {
    /// The CSV file.
    pub file: PathBuf,
    /// What its columns are, where their headers do not say it.
    pub columns: Columns,
    /// Channel and input.
    pub connect: Vec<(String, PortName)>,
    /// The inputs get derivatives, too.
    pub derivative: bool,
    /// Where it stands in the file.
    pub place: String,
}

impl std::str::FromStr for PortName {
    type Err = String;

    /// From `component.variable`; the variable may have dots.
    fn from_str(text: &str) -> std::result::Result<Self, String> {
        match text.split_once('.') {
            Some((component, variable)) if !component.is_empty() && !variable.is_empty() => {
                Ok(Self { component: component.into(), variable: variable.into() })
            }
            _ => Err(format!("{text:?} is no name of the form component.variable")),
        }
    }
}

impl Plan {
    /// Takes a component out, with all that leads to and from it. What it drove has its own start values then.
    pub fn remove(&mut self, name: &str) {
        let other = |port: &PortName| port.component != name;
        self.components.retain(|c| c.name != name);
        self.connectors.retain(|c| other(&c.port));
        self.connections.retain(|c| other(&c.from) && other(&c.to));
        self.bonds.retain(|b| other(&b.effort) && other(&b.motion));
        self.inputs.iter_mut().for_each(|inputs| inputs.connect.retain(|(_, to)| other(to)));
        if let Some(order) = &mut self.order {
            order.retain(|n| n != name);
        }
    }

    /// The files that the system is made from.
    pub fn files(&self) -> Vec<&Path> {
        let recordings = self.inputs.iter().map(|inputs| &inputs.file);
        let mut files: Vec<&Path> = recordings.chain(&self.profiles).map(PathBuf::as_path).collect();
        for component in &self.components {
            match &component.source {
                Source::Model(_, parameters) => files.extend(parameters.as_deref()),
                Source::Fmu(path) => files.push(path),
            }
        }
        files
    }

    /// What to run: the times given, else those of the file, else start at 0 s and stop where the first
    /// recorded input ends.
    ///
    /// # Errors
    /// No stop time or no communication step anywhere.
    pub fn experiment(
        &self,
        system: &System,
        start: Option<f64>,
        stop: Option<f64>,
        step: Option<f64>,
    ) -> Result<Experiment> {
        let ends = system.feeds.iter().filter_map(|f| f.time.last().copied()).reduce(f64::min);
        let stop = stop.or(self.stop).or(ends).ok_or_else(|| {
            Error::call(format!("{}: there is no stop time; give it in the file or with --stop", self.source))
        })?;
        let step = step.or(self.step).ok_or_else(|| {
            let steps: Vec<String> = system
                .components
                .iter()
                .map(|c| format!("{} {} s", c.name, c.interface().communication_step))
                .collect();
            Error::call(format!(
                "{}: there is no communication step; give it in the file or with --step. What suits each component by itself: {}",
                self.source,
                steps.join(", ")
            ))
        })?;
        Ok(Experiment {
            start: start.or(self.start).unwrap_or(0.0),
            stop,
            step,
            record_every: self.record_every.max(1),
            all: false,
            log: false,
        })
    }

    /// Loads the components and wires them. This runs the FMUs' code.
    ///
    /// # Errors
    /// No components, some that cannot be loaded, names that are not there, connections that do not fit; each with
    /// its place in the file.
    pub fn load(&self) -> Result<System> {
        self.wire(add)
    }

    /// As [`load`](Self::load), with components from elsewhere: `add` adds one to the system and gives its
    /// index.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn wire(
        &self,
        mut add: impl FnMut(&mut System, &PlannedComponent) -> Result<usize>,
    ) -> Result<System> {
        if self.components.is_empty() {
            return Err(Error::file(format!("{}: there are no components", self.source)));
        }
        let mut system =
            System::new(Coupling { order: None, iterate: self.iterate, halvings: self.halvings });
        for warning in &self.warnings {
            system.warn(warning.clone());
        }
        // a search through all variables for each name would take minutes where there are many of both
        let mut variables: HashMap<&str, (usize, HashMap<String, usize>)> = HashMap::new();
        for component in &self.components {
            let index = add(&mut system, component).map_err(|e| placed(e, &component.place))?;
            let all = system.components()[index].interface().variables.iter().enumerate().rev();
            let all: HashMap<String, usize> = all.map(|(i, v)| (v.name.clone(), i)).collect();
            for assignment in &component.set {
                let at = |e: Error| placed(e, &assignment.place);
                let port = match all.get(&assignment.variable) {
                    Some(variable) => Port { component: index, variable: *variable },
                    None => system.port(&component.name, &assignment.variable).map_err(at)?,
                };
                let value = system.info(port).accept_quantity(&assignment.value).map_err(at)?;
                system.set(port, &value).map_err(at)?;
            }
            variables.insert(&component.name, (index, all));
        }
        let port = |system: &System, name: &PortName| match variables.get(name.component.as_str()).and_then(
            |(component, all)| Some(Port { component: *component, variable: *all.get(&name.variable)? }),
        ) {
            Some(port) => Ok(port),
            None => system.port(&name.component, &name.variable),
        };
        for connector in &self.connectors {
            let at = |e: Error| placed(e, &connector.place);
            let port = port(&system, &connector.port).map_err(at)?;
            connector.check(system.info(port)).map_err(|what| at(Error::file(what)))?;
        }
        for PlannedConnection { from, to, transfer, place } in &self.connections {
            let at = |e: Error| placed(e, place);
            let (from, to) = (port(&system, from).map_err(at)?, port(&system, to).map_err(at)?);
            system.connect(from, to, *transfer).map_err(at)?;
        }
        for inputs in &self.inputs {
            let at = |e: Error| placed(e, &inputs.place);
            let recording = read_recording_as(&inputs.file, &inputs.columns).map_err(at)?;
            for (channel, to) in &inputs.connect {
                let to: Port = port(&system, to).map_err(at)?;
                system.feed(to, &recording, channel, inputs.derivative).map_err(at)?;
            }
        }
        for PlannedBond { effort, motion, kind, place } in &self.bonds {
            let at = |e: Error| placed(e, place);
            let (effort, motion) = (port(&system, effort).map_err(at)?, port(&system, motion).map_err(at)?);
            system.bond(effort, motion, *kind).map_err(at)?;
        }
        if self.bonds.is_empty() {
            system.find_bonds();
        }
        if let Some(order) = &self.order {
            let order: Result<Vec<usize>> = order.iter().map(|name| system.component(name)).collect();
            system.coupling.order = Some(order.map_err(|e| placed(e, &format!("{}: order", self.source)))?);
            system.check_order().map_err(|e| placed(e, &self.source))?;
        }
        Ok(system)
    }
}

impl PlannedConnector {
    /// Compares with what the component says of the variable.
    fn check(&self, info: &VariableInfo) -> std::result::Result<(), String> {
        let PortName { component, variable } = &self.port;
        let kind = match info.kind {
            Kind::Real => "Real",
            Kind::Integer => "Integer",
            Kind::Boolean => "Boolean",
            Kind::Text => "String",
            Kind::Enumeration(_) => "Enumeration",
        };
        let differ = |what: &str, here: &str, there: &str| {
            Err(format!("the {what} of {component}.{variable} is {here} here and {there} in the component"))
        };
        if self.causality != info.causality {
            return differ("kind", &format!("{:?}", self.causality), &format!("{:?}", info.causality));
        }
        if let Some(here) = self.kind.as_deref().filter(|here| *here != kind) {
            return differ("type", here, kind);
        }
        if let (Some(here), Some(there)) = (&self.unit, &info.unit)
            && here != there
            && !matches!((Unit::parse(here), Unit::parse(there)), (Ok(a), Ok(b)) if a == b)
        {
            return differ("unit", here, there);
        }
        Ok(())
    }
}

/// Adds a shipped model or an FMU.
fn add(system: &mut System, component: &PlannedComponent) -> Result<usize> {
    match &component.source {
        Source::Model(name, parameters) => {
            let entry = Entry::find(MODELS, name)
                .map_err(|e| Error::variable(format!("{e}; an FMU is given as fmu = \"F.fmu\"")))?;
            let slave: Box<dyn Slave> = entry.slave(&read_settings(parameters.as_deref())?)?;
            system.add(&component.name, slave)
        }
        Source::Fmu(path) => {
            let fmu = ImportedFmu::load(path)?;
            let about = fmu.description();
            let description = format!("{} ({})", path.display(), about.model_name);
            let even_steps_only = !about.capabilities.can_handle_variable_step;
            let preferred_step = about.experiment.step_size;
            let index = system.add(&component.name, Box::new(fmu))?;
            let component = system.component_mut(index);
            component.about = description;
            component.even_steps_only = even_steps_only;
            component.preferred_step = preferred_step;
            Ok(index)
        }
    }
}

/// The error with its place in a file in front, which makes it one of that file.
fn placed(error: Error, place: &str) -> Error {
    Error::new(error.kind(), error.to_string()).at(place)
}
