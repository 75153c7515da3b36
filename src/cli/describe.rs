//! `latsch describe`: the variables of a model.

use super::{Format, print, print_json};
use latsch::Result;
use latsch::fmi::Entry;
use latsch::fmi::archive::ModelLibrary;
use latsch::model::{Causality, Interface, Kind, Value, VariableInfo};
use latsch::shipped::MODELS;
use serde_json::json;
use std::path::PathBuf;

/// Show a model's variables with units, defaults and ranges
#[derive(clap::Args)]
pub struct Args {
    /// Name of the model (see `latsch models`)
    model: String,
    /// A library of own models made from fmu-template, instead of the shipped one
    #[arg(long, value_name = "LIBRARY")]
    library: Option<PathBuf>,
    /// How to print
    #[arg(long, value_enum, default_value = "text")]
    format: Format,
}

pub fn run(args: &Args) -> Result<()> {
    let interface = match &args.library {
        Some(path) => ModelLibrary::open(path)?.model(&args.model)?.clone(),
        None => (Entry::find(MODELS, &args.model)?.table)(),
    };
    match args.format {
        Format::Json => print_json(&as_json(&interface)),
        Format::Text => print(&as_text(&interface)),
    }
}

fn as_text(interface: &Interface) -> String {
    let mut text = format!(
        "{}: {}\n\nA range holds the values that are accepted; others are refused with an error.\n",
        interface.name, interface.description
    );
    for (title, causality) in [
        ("Inputs", Causality::Input),
        ("Outputs", Causality::Output),
        ("Internal quantities", Causality::Local),
        ("Parameters", Causality::Parameter),
    ] {
        let variables: Vec<&VariableInfo> =
            interface.with(causality).map(|i| &interface.variables[i]).collect();
        if variables.is_empty() {
            continue;
        }
        let width = variables.iter().map(|v| v.name.len()).max().unwrap_or(0);
        text += &format!("\n{title}\n");
        for v in variables {
            let unit = v.unit.as_deref().map(|u| format!("[{u}]")).unwrap_or_default();
            text += &format!("  {:width$}  {unit:12}{}\n", v.name, v.description);
            let facts: Vec<String> = [default(v), range(v), items(v)].into_iter().flatten().collect();
            if !facts.is_empty() {
                text += &format!("  {:width$}  {:12}{}\n", "", "", facts.join(", "));
            }
        }
    }
    text.pop();
    text
}

fn default(v: &VariableInfo) -> Option<String> {
    v.start.as_ref().map(|start| match start {
        Value::Text(text) => format!("default {text:?}"),
        other => format!("default {other}"),
    })
}

fn range(v: &VariableInfo) -> Option<String> {
    match (v.min, v.max) {
        (Some(min), Some(max)) => Some(format!("range {min} to {max}")),
        (Some(min), None) => Some(format!("at least {min}")),
        (None, Some(max)) => Some(format!("at most {max}")),
        (None, None) => None,
    }
}

fn items(v: &VariableInfo) -> Option<String> {
    let Kind::Enumeration(items) = &v.kind else { return None };
    let list: Vec<String> = (1..).zip(items).map(|(n, (name, _)): (i32, _)| format!("{n} {name}")).collect();
    Some(list.join(", "))
}

fn as_json(interface: &Interface) -> serde_json::Value {
    let variables: Vec<_> = interface
        .variables
        .iter()
        .map(|v| {
            let (kind, items) = match &v.kind {
                Kind::Real => ("real", None),
                Kind::Integer => ("integer", None),
                Kind::Boolean => ("boolean", None),
                Kind::Text => ("text", None),
                Kind::Enumeration(items) => ("enumeration", Some(items)),
            };
            json!({
                "name": v.name,
                "description": v.description,
                "causality": format!("{:?}", v.causality).to_lowercase(),
                "kind": kind,
                "items": items.map(|items| items.iter().map(|(n, d)| json!({"name": n, "description": d})).collect::<Vec<_>>()),
                "unit": v.unit,
                "default": v.start.as_ref().map(|start| match start {
                    Value::Real(x) => json!(x),
                    Value::Integer(x) => json!(x),
                    Value::Boolean(x) => json!(x),
                    Value::Text(x) => json!(x),
                }),
                "min": v.min,
                "max": v.max,
            })
        })
        .collect();
    json!({
        "name": interface.name,
        "description": interface.description,
        "communication_step": interface.communication_step,
        "variables": variables,
    })
}
