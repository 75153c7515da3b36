//! The short form of a system: TOML.

use super::energy::BondKind;
use super::plan::{
    Assignment, Plan, PlannedBond, PlannedComponent, PlannedConnection, PlannedInputs, PortName, Source,
};
use super::system::Transfer;
use crate::model::{Lines, Value, line_of};
use crate::recording::{Columns, profile_file, profile_value};
use crate::{Error, Result};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use toml::Spanned;

type Table = BTreeMap<Spanned<String>, toml::Value>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    start: Option<f64>,
    stop: Option<f64>,
    step: Option<f64>,
    order: Option<Vec<String>>,
    #[serde(default)]
    iterate: usize,
    #[serde(default)]
    halvings: u32,
    #[serde(default)]
    record_every: usize,
    #[serde(default)]
    component: BTreeMap<Spanned<String>, Component>,
    #[serde(default)]
    connect: Table,
    #[serde(default)]
    inputs: Vec<Spanned<Inputs>>,
    #[serde(default)]
    bond: Vec<Spanned<Bond>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Component {
    model: Option<String>,
    fmu: Option<PathBuf>,
    parameters: Option<PathBuf>,
    #[serde(default)]
    set: Table,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Inputs {
    file: PathBuf,
    connect: Table,
    #[serde(default)]
    derivative: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Bond {
    effort: String,
    flow: Option<String>,
    displacement: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Target {
    to: String,
    factor: Option<f64>,
    offset: Option<f64>,
    #[serde(default)]
    keep_units: bool,
    #[serde(default)]
    derivative: bool,
}

/// Reads the short form; `place` names the file in messages, and files that it names are looked for in
/// `folder`.
///
/// # Errors
/// Not TOML, unknown keys, or values of another form, each with its line. Whether components and
/// variables are there is found out by [`Plan::load`].
pub fn parse_toml(text: &str, place: &str, folder: &Path) -> Result<Plan> {
    let file: File = toml::from_str(text).map_err(|e| {
        let line = e.span().map_or(1, |span| line_of(text, span.start));
        Error::file(format!("{place}:{line}: {}", e.message()))
    })?;
    let lines = Lines::new(text);
    let at = |offset: usize| format!("{place}:{}", lines.of(offset));
    let mut plan = Plan {
        source: place.into(),
        start: file.start,
        stop: file.stop,
        step: file.step,
        order: file.order,
        iterate: file.iterate,
        halvings: file.halvings,
        record_every: file.record_every,
        ..Plan::default()
    };
    for (name, component) in in_order(file.component) {
        let place = at(name.span().start);
        let name = name.into_inner();
        let wrong = |what: &str| Err(Error::file(format!("{place}: component {name}: {what}")));
        let source = match (component.model, component.fmu) {
            (Some(model), None) => Source::Model(model, component.parameters.map(|p| folder.join(p))),
            (None, Some(_)) if component.parameters.is_some() => {
                return wrong("an FMU has its parameters inside; change them with set = { ... }");
            }
            (None, Some(fmu)) => Source::Fmu(folder.join(fmu)),
            _ => return wrong("either model = \"NAME\" or fmu = \"F.fmu\" is needed"),
        };
        let mut set = Vec::new();
        for (variable, value) in in_order(component.set) {
            let place = at(variable.span().start);
            let variable = variable.into_inner();
            let value = Value::from_toml(&value)
                .map_err(|e| Error::file(format!("{place}: {name}.{variable} {e}")))?;
            plan.profiles.extend(profile_file(&variable, &value, folder));
            let value = profile_value(&variable, value, folder).map_err(|e| e.at(&place))?;
            set.push(Assignment { variable, value, place });
        }
        plan.components.push(PlannedComponent { name, source, set, place });
    }
    for (from, targets) in in_order(file.connect) {
        let place = at(from.span().start);
        let fail = |what: String| Error::file(format!("{place}: {what}"));
        let from: PortName = from.into_inner().parse().map_err(fail)?;
        let targets = match targets {
            toml::Value::Array(targets) => targets,
            one => vec![one],
        };
        for target in targets {
            let (to, transfer) = target_of(target).map_err(fail)?;
            let to = to.parse().map_err(fail)?;
            plan.connections.push(PlannedConnection {
                from: from.clone(),
                to,
                transfer,
                place: place.clone(),
            });
        }
    }
    for inputs in file.inputs {
        let place = at(inputs.span().start);
        let Inputs { file, connect, derivative } = inputs.into_inner();
        let mut channels = Vec::new();
        for (channel, targets) in in_order(connect) {
            let place = at(channel.span().start);
            let targets = match targets {
                toml::Value::Array(targets) => targets,
                one => vec![one],
            };
            for target in targets {
                let to = target
                    .as_str()
                    .ok_or("a text \"component.input\", or several in [ ], is needed".to_string());
                let to = to.and_then(str::parse).map_err(|what| Error::file(format!("{place}: {what}")))?;
                channels.push((channel.get_ref().clone(), to));
            }
        }
        plan.inputs.push(PlannedInputs {
            file: folder.join(file),
            columns: Columns::default(),
            connect: channels,
            derivative,
            place,
        });
    }
    for bond in file.bond {
        let place = at(bond.span().start);
        let fail = |what: String| Error::file(format!("{place}: {what}"));
        let Bond { effort, flow, displacement } = bond.into_inner();
        let (motion, kind) = match (flow, displacement) {
            (Some(flow), None) => (flow, BondKind::Flow),
            (None, Some(displacement)) => (displacement, BondKind::Displacement),
            _ => return Err(fail("a bond has either flow = \"...\" or displacement = \"...\"".into())),
        };
        let (effort, motion) = (effort.parse().map_err(fail)?, motion.parse().map_err(fail)?);
        plan.bonds.push(PlannedBond { effort, motion, kind, place });
    }
    Ok(plan)
}

/// What stands behind an output: `"component.input"`, or a table with `to`.
fn target_of(value: toml::Value) -> std::result::Result<(String, Transfer), String> {
    if let toml::Value::String(to) = value {
        return Ok((to, Transfer::default()));
    }
    if !value.is_table() {
        return Err(format!(
            "\"component.input\", {{ to = \"component.input\", factor = ..., offset = ... }}, or several of these in [ ] are needed, not a {}",
            value.type_str()
        ));
    }
    let target: Target = value.try_into().map_err(|e: toml::de::Error| e.message().to_string())?;
    let linear = (target.factor.is_some() || target.offset.is_some())
        .then(|| (target.factor.unwrap_or(1.0), target.offset.unwrap_or(0.0)));
    Ok((target.to, Transfer { linear, keep_units: target.keep_units, derivative: target.derivative }))
}

/// The entries of a table in the order of the file.
fn in_order<T>(table: BTreeMap<Spanned<String>, T>) -> Vec<(Spanned<String>, T)> {
    let mut entries: Vec<_> = table.into_iter().collect();
    entries.sort_by_key(|(name, _)| name.span().start);
    entries
}
