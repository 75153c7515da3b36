//! Makes the [`Manifest`] of a system.

use super::manifest::{Connection, Driven, Manifest, Pair, Part, Structure};
use super::stamp::Stamp;
use crate::cosimulate::{BondKind, Plan, PlannedComponent, Port, PortName, Source, System, read_system};
use crate::fmi::import::{Archive, Description, MAX_LENGTH};
use crate::model::{Causality, Kind, Value, VariableInfo};
use crate::{Error, Result, VERSION};
use std::collections::BTreeMap;
use std::path::Path;

/// Lists what a system is made of. It is loaded and wired for that, which runs the FMUs' code, but not started.
///
/// # Errors
/// A system that cannot be loaded, a file that cannot be read.
pub fn freeze(path: &Path) -> Result<Manifest> {
    let file = read_system(path)?;
    let (plan, folder) = (&file.plan, file.folder.as_path());
    let system = plan.load()?;
    let own = path.parent().unwrap_or(Path::new(""));
    let component = plan.components.iter().enumerate().map(|(index, component)| {
        let mut part = part(component, folder)?;
        part.values = values(&system, index);
        Ok((component.name.clone(), part))
    });
    let bonds = plan.bonds.iter().map(|bond| Pair {
        effort: written(&bond.effort),
        motion: written(&bond.motion),
        displacement: bond.kind == BondKind::Displacement,
    });
    Ok(Manifest {
        latsch: VERSION.into(),
        system: Structure {
            file: Stamp::of(path, own)?,
            step: plan.step,
            start: plan.start,
            stop: plan.stop,
            order: plan.order.clone(),
            iterate: plan.iterate,
            halvings: plan.halvings,
            record_every: plan.record_every.max(1),
        },
        component: component.collect::<Result<_>>()?,
        connection: connections(plan),
        input: inputs(plan, folder)?,
        bond: bonds.collect(),
    })
}

fn written(name: &PortName) -> String {
    format!("{}.{}", name.component, name.variable)
}

/// What a component is made from.
fn part(component: &PlannedComponent, folder: &Path) -> Result<Part> {
    match &component.source {
        Source::Model(name, parameters) => Ok(Part {
            model: Some(name.clone()),
            parameters: parameters.as_deref().map(|path| Stamp::of(path, folder)).transpose()?,
            ..Part::default()
        }),
        Source::Fmu(path) => {
            let xml = Archive::open(path)?.read("modelDescription.xml", MAX_LENGTH)?;
            let xml = xml.ok_or_else(|| Error::fmu("there is no modelDescription.xml").at(path.display()))?;
            let about = Description::parse(&xml).map_err(|e| e.at(path.display()))?;
            Ok(Part {
                model_name: Some(about.model_name),
                guid: Some(about.guid),
                generation_tool: about.generation_tool,
                fmu: Some(Stamp::of(path, folder)?),
                ..Part::default()
            })
        }
    }
}

/// Parameters, and inputs that nothing drives.
fn values(system: &System, component: usize) -> BTreeMap<String, toml::Value> {
    let interface = system.components()[component].interface();
    let given = interface.variables.iter().enumerate().filter_map(|(variable, info)| {
        let port = Port { component, variable };
        let is_driven = || system.connections().any(|(_, to)| to == port) || system.follows(port);
        let is_given = match info.causality {
            Causality::Parameter => true,
            Causality::Input => !is_driven(),
            _ => false,
        };
        let value = system.given(port).filter(|_| is_given)?;
        Some((info.name.clone(), told(info, value)))
    });
    given.collect()
}

/// A value with its unit, or as the name of an item; a text with a unit is what parameter files take, too.
fn told(info: &VariableInfo, value: &Value) -> toml::Value {
    let unit = info.unit.as_deref().filter(|unit| !["1", "-", ""].contains(unit));
    match (value, &info.kind) {
        (Value::Real(number), _) => match unit {
            Some(unit) => toml::Value::String(format!("{number:?} {unit}")),
            None => toml::Value::Float(*number),
        },
        (Value::Integer(number), Kind::Enumeration(items)) => {
            let item = usize::try_from(*number - 1).ok().and_then(|k| items.get(k));
            item.map_or(toml::Value::Integer((*number).into()), |(name, _)| toml::Value::String(name.clone()))
        }
        (Value::Integer(number), _) => toml::Value::Integer((*number).into()),
        (Value::Boolean(switch), _) => toml::Value::Boolean(*switch),
        (Value::Text(text), _) => toml::Value::String(text.clone()),
    }
}

fn connections(plan: &Plan) -> BTreeMap<String, Connection> {
    let connections = plan.connections.iter().map(|planned| {
        let connection = Connection {
            from: written(&planned.from),
            factor: planned.transfer.linear.map(|(factor, _)| factor),
            offset: planned.transfer.linear.map(|(_, offset)| offset),
            keep_units: planned.transfer.keep_units,
            derivative: planned.transfer.derivative,
        };
        (written(&planned.to), connection)
    });
    connections.collect()
}

fn inputs(plan: &Plan, folder: &Path) -> Result<BTreeMap<String, Driven>> {
    let mut all = BTreeMap::new();
    for planned in &plan.inputs {
        let recording = Stamp::of(&planned.file, folder)?;
        for (channel, to) in &planned.connect {
            let (channel, recording) = (channel.clone(), recording.clone());
            all.insert(written(to), Driven { channel, derivative: planned.derivative, recording });
        }
    }
    Ok(all)
}
