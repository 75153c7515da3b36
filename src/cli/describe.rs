//! `latsch describe`: the variables of a model or FMU.

use super::{Format, check_outputs, print, print_json};
use latsch::fmi::Entry;
use latsch::fmi::archive::{ModelLibrary, page_of};
use latsch::fmi::import::{Archive, Description, MAX_LENGTH};
use latsch::model::{Causality, Interface, Kind, Value, VariableInfo};
use latsch::report::write_html;
use latsch::shipped::MODELS;
use latsch::{Error, Result};
use serde_json::json;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

const DESCRIPTION: &str = "modelDescription.xml";

/// Show the variables of a model or of any FMU, with units, defaults and ranges
///
/// Nothing of an FMU is run; `latsch check` tries it out.
#[derive(clap::Args)]
pub struct Args {
    /// Name of the model (see `latsch models`), or an FMU: the file, the folder that it was unpacked to, or its
    /// modelDescription.xml
    #[arg(value_name = "MODEL|F.fmu")]
    model: String,
    /// A library of own models made from fmu-template, instead of the shipped one
    #[arg(long, value_name = "LIBRARY")]
    library: Option<PathBuf>,
    /// Page to write, as FMUs of the model carry it: equations, axes, limits, and all variables
    #[arg(long, value_name = "F.html")]
    page: Option<PathBuf>,
    /// How to print
    #[arg(long, value_enum, default_value = "text")]
    format: Format,
}

pub fn run(args: &Args) -> Result<()> {
    let (interface, page) = match &args.library {
        Some(path) => {
            let library = ModelLibrary::open(path)?;
            (library.model(&args.model)?.clone(), library.page(&args.model))
        }
        None => match Entry::find(MODELS, &args.model) {
            Ok(entry) => ((entry.table)(), page_of(&entry)),
            Err(error) => return described_fmu(args, error),
        },
    };
    if let Some(file) = &args.page {
        check_outputs(&[file], &args.library.iter().map(PathBuf::as_path).collect::<Vec<_>>())?;
        return write_html(file, &page?);
    }
    match args.format {
        Format::Json => print_json(&as_json(&interface)),
        Format::Text => {
            let ranges = "A range holds the values that are accepted; others are refused with an error.";
            print(&as_text(&interface, ranges))
        }
    }
}

/// Describes what is an FMU, or fails with the error for what is no model.
fn described_fmu(args: &Args, no_model: Error) -> Result<()> {
    let path = Path::new(&args.model);
    let looks_like_one = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("fmu"));
    if !path.exists() && !looks_like_one {
        return Err(no_model.at("neither a model nor a file"));
    }
    if args.page.is_some() {
        return Err(Error::call(format!(
            "--page writes the page of a model, and {} is an FMU: it carries its own, as documentation/index.html",
            args.model
        )));
    }
    let (description, platforms) = read_fmu(path)?;
    match args.format {
        Format::Json => {
            let mut value = as_json(&description.interface);
            value["fmu"] = fmu_as_json(&description, &platforms);
            print_json(&value)
        }
        Format::Text => print(&as_text(&description.interface, &about(&description, &platforms))),
    }
}

/// The description of an FMU (file, folder, or modelDescription.xml) and the platforms that it has binaries for, as far
/// as they can be seen.
fn read_fmu(path: &Path) -> Result<(Description, BTreeSet<String>)> {
    let at = |e: Error| e.at(path.display());
    let platform = |entry: &str| {
        let mut parts = entry.split('/');
        let found = (parts.next(), parts.next(), parts.next());
        let (Some("binaries"), Some(platform), Some(file)) = found else { return None };
        (!file.is_empty()).then(|| platform.to_owned())
    };
    if !path.is_dir() && path.extension().is_none_or(|e| !e.eq_ignore_ascii_case("xml")) {
        let mut archive = Archive::open(path)?;
        let xml = archive.read(DESCRIPTION, MAX_LENGTH)?;
        let xml = xml.ok_or_else(|| at(Error::fmu(format!("there is no {DESCRIPTION}: this is no FMU"))))?;
        let platforms = archive.names().filter_map(|entry| platform(&entry)).collect();
        return Ok((Description::parse(&xml).map_err(at)?, platforms));
    }
    let file = if path.is_dir() { path.join(DESCRIPTION) } else { path.into() };
    let at = |e: Error| e.at(file.display());
    let length = std::fs::metadata(&file).map_err(|e| at(Error::fmu(e.to_string())))?.len();
    if length > MAX_LENGTH {
        return Err(at(Error::fmu(format!("it has more than {MAX_LENGTH} bytes"))));
    }
    let xml = std::fs::read(&file).map_err(|e| at(Error::fmu(e.to_string())))?;
    let binaries = file.parent().map(|folder| folder.join("binaries"));
    let folders = binaries.and_then(|folder| std::fs::read_dir(folder).ok()).into_iter().flatten().flatten();
    let platforms = folders.map(|folder| folder.file_name().to_string_lossy().into_owned()).collect();
    Ok((Description::parse(&xml).map_err(at)?, platforms))
}

/// What an FMU can do, in the words of the standard and in plain ones.
fn capabilities(description: &Description) -> [(&'static str, &'static str, bool); 8] {
    let can = &description.capabilities;
    [
        ("canHandleVariableCommunicationStepSize", "steps of changing length", can.can_handle_variable_step),
        ("canInterpolateInputs", "derivatives of inputs", can.can_interpolate_inputs),
        ("maxOutputDerivativeOrder", "derivatives of outputs", can.max_output_derivative_order > 0),
        ("canGetAndSetFMUstate", "saving and restoring the state", can.can_get_and_set_state),
        ("canSerializeFMUstate", "the state as bytes", can.can_serialize_state),
        ("providesDirectionalDerivative", "directional derivatives", can.provides_directional_derivatives),
        (
            "canBeInstantiatedOnlyOncePerProcess",
            "only one instance in a process",
            can.can_be_instantiated_once,
        ),
        ("needsExecutionTool", "needs the tool that made it", can.needs_execution_tool),
    ]
}

fn about(description: &Description, platforms: &BTreeSet<String>) -> String {
    let list = |which: bool| {
        let words: Vec<&str> = capabilities(description)
            .iter()
            .filter(|(.., yes)| *yes == which)
            .map(|(_, word, _)| *word)
            .collect();
        if words.is_empty() { "-".into() } else { words.join(", ") }
    };
    let platforms: Vec<&str> = platforms.iter().map(String::as_str).collect();
    let experiment = description.experiment;
    let mut times = Vec::new();
    for (word, time) in
        [("from", experiment.start), ("to", experiment.stop), ("in steps of", experiment.step_size)]
    {
        times.extend(time.map(|t| format!("{word} {t} s")));
    }
    let rows = [
        ("FMI", format!("{} for co-simulation", description.fmi_version)),
        ("made by", description.generation_tool.clone().unwrap_or_else(|| "-".into())),
        ("binaries for", if platforms.is_empty() { "-".into() } else { platforms.join(", ") }),
        ("can or has", list(true)),
        ("not", list(false)),
        ("experiment", if times.is_empty() { "-".into() } else { times.join(" ") }),
        ("GUID", description.guid.clone()),
    ];
    rows.map(|(name, value)| format!("{name:<13} {value}")).join("\n")
}

fn fmu_as_json(description: &Description, platforms: &BTreeSet<String>) -> serde_json::Value {
    let can: serde_json::Map<String, serde_json::Value> = capabilities(description)
        .iter()
        .map(|(name, _, yes)| match *name {
            "maxOutputDerivativeOrder" => {
                ((*name).into(), json!(description.capabilities.max_output_derivative_order))
            }
            _ => ((*name).into(), json!(yes)),
        })
        .collect();
    json!({
        "fmi_version": description.fmi_version,
        "generation_tool": description.generation_tool,
        "guid": description.guid,
        "platforms": platforms,
        "capabilities": can,
        "experiment": {
            "start": description.experiment.start,
            "stop": description.experiment.stop,
            "step_size": description.experiment.step_size,
        },
    })
}

/// The variables by causality, under the name and what `head` says of the whole.
fn as_text(interface: &Interface, head: &str) -> String {
    let description = match interface.description.trim() {
        "" => String::new(),
        text => format!(": {text}"),
    };
    let mut text = format!("{}{description}\n\n{head}\n", interface.name);
    for (title, causality) in [
        ("Inputs", Causality::Input),
        ("Outputs", Causality::Output),
        ("Internal quantities", Causality::Local),
        ("Parameters", Causality::Parameter),
        ("Parameters that follow from others", Causality::CalculatedParameter),
        ("Time", Causality::Independent),
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
            text += format!("  {:width$}  {unit:12}{}", v.name, v.description).trim_end();
            text.push('\n');
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
