//! Exports corrected models: a shipped model with effects, or any FMU inside one of ours, with effects.

use super::archive::{Binary, ModelLibrary, documents, pack, with_settings};
use super::c::Fmi;
use super::description::{CAPABILITIES, Origin, describe, model_identifier};
use super::documentation;
use super::entry::guid;
use super::import::{Archive, Capabilities, Description, MAX_LENGTH};
use super::make::{ORIGINAL, ORIGINAL_DESCRIPTION, corrected_interface};
use crate::effect::file::{Corrections, effects_text, meaning};
use crate::effect::{Attachment, attached_interface};
use crate::model::{Causality, Interface, Kind, Setting, Settings, Value, key};
use crate::page::escape;
use crate::{Error, Result};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// What is corrected.
#[derive(Debug, Clone, PartialEq)]
pub enum CorrectedBase {
    /// A model of the library by name, with these settings.
    Model(String, Settings),
    /// Any co-simulation FMU of FMI 2.0, by its file.
    Fmu(PathBuf),
}

impl CorrectedBase {
    /// The interface that attachments refer to, with the base's own start values.
    ///
    /// # Errors
    /// No such model, settings that it does not accept, a file that is no FMU.
    pub fn interface(&self, library: &ModelLibrary) -> Result<Interface> {
        match self {
            Self::Model(name, settings) => with_settings(library.model(name)?, settings),
            Self::Fmu(path) => Ok(read_description(path)?.interface),
        }
    }
}

/// An FMU of a model with other parameters and with effects, as the bytes of its archive. The same
/// arguments give the same bytes.
///
/// Parameters and start values of inputs are in the units of their variables; variables that are not named
/// keep the base's values. An FMU with effects proposes `step` \[s\] to masters, or what the base proposes. The model's name is the base's with `-corrected`; a model of the library without
/// effects is an ordinary FMU of that model. Of `library` an FMU needs only the binary. With `binaries`, it
/// has those instead of the library.
///
/// # Errors
/// No such model or file, parameters that it does not accept, effects that do not fit, a binary that cannot
/// be read or that the base has no counterpart for.
pub fn export_corrected(
    base: &CorrectedBase,
    parameters: &[(String, f64)],
    attachments: &[Attachment],
    step: Option<f64>,
    library: &ModelLibrary,
    binaries: &[Binary],
) -> Result<Vec<u8>> {
    let interface = base.interface(library)?;
    let added = parameters.iter().map(|(name, value)| {
        let variable = &interface.variables[interface.find(name)?];
        let value = match variable.kind {
            Kind::Real => Value::Real(*value),
            Kind::Boolean => Value::Boolean(*value != 0.0),
            _ if value.fract() == 0.0 && value.abs() < 2e9 => Value::Integer(*value as i32),
            _ => return Err(Error::variable(format!("{name} = {value:?}: a whole number is needed"))),
        };
        let (name, causality) = (name.clone(), variable.causality);
        Ok(Setting { name, value, causality, place: "the parameters".into() })
    });
    let added = Settings { values: added.collect::<Result<_>>()?, ..Settings::default() };
    let effects = effects_text(&interface, attachments, &[], step);
    match base {
        CorrectedBase::Model(name, settings) => {
            model(library, name, &merged(settings, &added), &effects, binaries)
        }
        CorrectedBase::Fmu(path) => {
            carrier(library, path, &added, &effects, binaries).map_err(|e| e.at(path.display()))
        }
    }
}

/// As [`export_corrected`], from what a file says. Parameters in the file take the place of the base's.
///
/// # Errors
/// As [`export_corrected`]; a file for another model.
pub fn export_corrections(
    base: &CorrectedBase,
    corrections: &Corrections,
    library: &ModelLibrary,
    binaries: &[Binary],
) -> Result<Vec<u8>> {
    let interface = base.interface(library)?;
    corrections.settings.check(&interface)?;
    let effects = effects_text(&interface, &corrections.attachments(&interface)?, &[], corrections.step);
    match base {
        CorrectedBase::Model(name, settings) => {
            model(library, name, &merged(settings, &corrections.settings), &effects, binaries)
        }
        CorrectedBase::Fmu(path) => carrier(library, path, &corrections.settings, &effects, binaries)
            .map_err(|e| e.at(path.display())),
    }
}

/// Settings of which those of `over` count where both have a value.
pub fn merged(under: &Settings, over: &Settings) -> Settings {
    let mut values: Vec<Setting> =
        under.values.iter().filter(|u| over.values.iter().all(|o| o.name != u.name)).cloned().collect();
    values.extend(over.values.iter().cloned());
    Settings { model: over.model.clone().or(under.model.clone()), version: None, values, fit: Vec::new() }
}

fn model(
    library: &ModelLibrary,
    name: &str,
    settings: &Settings,
    effects: &str,
    binaries: &[Binary],
) -> Result<Vec<u8>> {
    if effects.is_empty() {
        return library.fmu(name, settings, binaries);
    }
    let (table, text) = library.find(name)?;
    let resources = settings.to_file(table)? + effects;
    // from the text, as the FMU will do it
    let corrections = Corrections::parse(&resources, "model.toml")?;
    let inner = with_settings(table, &corrections.settings)?;
    let outer = corrected_interface(&inner, &corrections)?;
    let guid = guid(&outer, &resources);
    let text = added_html(&inner, &corrections)? + text;
    let page =
        documentation::page(&corrected_interface(table, &corrections)?, &outer, &guid, &text, Fmi::Two);
    let description = describe(&outer, &guid, &CAPABILITIES, Origin::Own)?;
    let mut files = vec![
        ("modelDescription.xml".into(), description.into_bytes()),
        ("resources/model.toml".into(), resources.into_bytes()),
    ];
    files.extend(library.binaries(&model_identifier(&outer.name), binaries, Fmi::Two)?);
    files.extend(documents(page));
    pack(files)
}

fn read_description(path: &Path) -> Result<Description> {
    let xml = Archive::open(path)?.read("modelDescription.xml", MAX_LENGTH)?;
    let at = |e: Error| e.at(path.display());
    let xml = xml.ok_or_else(|| at(Error::fmu("there is no modelDescription.xml: this is no FMU")))?;
    Description::parse(&xml).map_err(at)
}

/// An FMU that carries another one.
fn carrier(
    library: &ModelLibrary,
    path: &Path,
    settings: &Settings,
    effects: &str,
    binaries: &[Binary],
) -> Result<Vec<u8>> {
    let description = read_description(path)?;
    let about = toml::to_string(&description)
        .map_err(|e| Error::fmu(format!("its description cannot be written as TOML: {e}")))?;
    let resources = carrier_file(&description.interface, settings)? + effects;
    // from the texts, as the FMU will do it
    let corrections = Corrections::parse(&resources, "model.toml")?;
    let description: Description = toml::from_str(&about)
        .map_err(|e| Error::fmu(format!("its description cannot be read from TOML: {e}")))?;
    let inner = with_settings(&description.interface, &corrections.settings)?;
    let outer = corrected_interface(&inner, &corrections)?;
    let guid = guid(&outer, &(about.clone() + &resources));
    let can = &description.capabilities;
    let capabilities = Capabilities {
        // an original that holds its inputs gets their means over each step
        can_interpolate_inputs: true,
        max_output_derivative_order: can.max_output_derivative_order.min(1),
        can_run_asynchronously: false,
        can_not_use_memory_functions: true,
        can_serialize_state: can.can_get_and_set_state && can.can_serialize_state,
        provides_directional_derivatives: false,
        ..*can
    };
    let text = origin_html(&description) + &added_html(&inner, &corrections)?;
    let table = corrected_interface(&description.interface, &corrections)?;
    let page = documentation::page_of_carrier(&table, &outer, &guid, &text, &capabilities);
    let xml = describe(&outer, &guid, &capabilities, Origin::Foreign)?;

    let original = unpacked(path)?;
    let mut files = vec![
        ("modelDescription.xml".into(), xml.into_bytes()),
        ("resources/model.toml".into(), resources.into_bytes()),
        (format!("resources/{ORIGINAL_DESCRIPTION}"), about.into_bytes()),
    ];
    let own = library.binaries(&model_identifier(&outer.name), binaries, Fmi::Two)?;
    for (name, _) in &own {
        same_platform(name, &original)?;
    }
    files.extend(own);
    if !original.iter().any(|(name, _)| name.starts_with("resources/")) {
        // a folder that some FMUs want to see, and archives do not hold empty ones
        files.push((format!("resources/{ORIGINAL}/resources/.empty"), Vec::new()));
    }
    files.extend(documents(page));
    files.extend(original.into_iter().map(|(name, content)| match name.strip_prefix("documentation/") {
        Some(rest) => (format!("documentation/{ORIGINAL}/{rest}"), content),
        None => (format!("resources/{ORIGINAL}/{name}"), content),
    }));
    pack(files)
}

/// The `model.toml` of an FMU that carries another one, without the effects.
fn carrier_file(interface: &Interface, settings: &Settings) -> Result<String> {
    let mut text = format!(
        "model = {}\nversion = \"{}\"\noriginal = true # the model is the FMU in the folder {ORIGINAL}\n",
        Value::Text(interface.name.clone()).to_toml(),
        crate::VERSION
    );
    let values: BTreeMap<usize, Value> = settings.check(interface)?.into_iter().collect();
    for (section, causality) in [("parameters", Causality::Parameter), ("inputs", Causality::Input)] {
        let mut lines =
            values.iter().filter(|(i, _)| interface.variables[**i].causality == causality).peekable();
        if lines.peek().is_some() {
            let _ = write!(text, "\n[{section}]\n");
        }
        for (index, value) in lines {
            let variable = &interface.variables[*index];
            let _ = writeln!(text, "{} = {}{}", key(&variable.name), value.to_toml(), meaning(variable));
        }
    }
    Ok(text)
}

/// The files of an FMU, by name in its archive.
fn unpacked(path: &Path) -> Result<Vec<(String, Vec<u8>)>> {
    fn walk(folder: &Path, name: &str, files: &mut Vec<(String, Vec<u8>)>) -> std::io::Result<()> {
        let mut entries = std::fs::read_dir(folder)?.collect::<std::io::Result<Vec<_>>>()?;
        entries.sort_by_key(std::fs::DirEntry::file_name);
        for entry in entries {
            // names of archives are UTF-8 or were made so
            let name = format!("{name}{}", entry.file_name().to_string_lossy());
            match entry.file_type()?.is_dir() {
                true => walk(&entry.path(), &format!("{name}/"), files)?,
                false => files.push((name, std::fs::read(entry.path())?)),
            }
        }
        Ok(())
    }
    let folder = Archive::open(path)?.unpack()?;
    let mut files = Vec::new();
    walk(folder.path(), "", &mut files)
        .map_err(|e| Error::file(format!("its unpacked files cannot be read: {e}")))?;
    Ok(files)
}

/// Fails unless the original has a binary for the platform of ours, which is called
/// `binaries/<platform>/<file>`.
fn same_platform(own: &str, original: &[(String, Vec<u8>)]) -> Result<()> {
    // the first of each is ours; others are names that FMI 3.0 gave
    const SAME: [&[&str]; 3] =
        [&["linux64", "x86_64-linux"], &["win64", "x86_64-windows"], &["darwin64", "x86_64-darwin"]];
    let platform = own.split('/').nth(1).unwrap_or_default();
    let alone = [platform];
    let folders = SAME.into_iter().find(|s| s[0] == platform).unwrap_or(&alone);
    let has = |folder: &str| {
        let folder = format!("binaries/{folder}/");
        original.iter().any(|(name, _)| name.starts_with(&folder))
    };
    if folders.iter().any(|folder| has(folder)) {
        return Ok(());
    }
    Err(Error::fmu(format!(
        "the FMU has no binary for {platform}, so the corrected one cannot have one either"
    )))
}

/// What the FMU inside is.
fn origin_html(description: &Description) -> String {
    let tool = description.generation_tool.as_deref().unwrap_or("an unnamed tool");
    format!(
        "<h2>The FMU inside</h2>
<p>This FMU carries {}, made by {}, GUID <code>{}</code>, unchanged in <code>resources/{ORIGINAL}</code>, and runs it.
Its documentation and licenses, if it has any, are beside this page in <code>{ORIGINAL}/</code>; they hold for it as
before. It has the variables below but for those that begin with <code>effect.</code></p>\n",
        escape(&description.model_name),
        escape(tool),
        escape(&description.guid)
    )
}

/// What was added to a model.
fn added_html(inner: &Interface, corrections: &Corrections) -> Result<String> {
    let attachments = corrections.attachments(inner)?;
    if attachments.is_empty() {
        return Ok(String::new());
    }
    let outer = attached_interface(inner, &attachments)?;
    let mut html = String::from("<h2>What was added to the model</h2>\n<ul>\n");
    for attachment in &attachments {
        let effect = attachment.effect;
        let _ = writeln!(
            html,
            "<li>{} (<code>{}</code>) on <code>{}</code>: {}. Source: {}.</li>",
            escape(effect.name),
            escape(effect.id),
            escape(&outer.variables[attachment.target].name),
            escape(effect.equation),
            escape(effect.source)
        );
    }
    html.push_str(
        "</ul>
<p>Their parameters are those that begin with <code>effect.</code> Effects act at communication points, so results
depend on the communication step. Effects on inputs, forces and parameters see the outputs of the point before: a delay
of one communication step. The derivative of an output that an effect changes is the difference over the last
communication step. Directional derivatives are not offered.</p>\n",
    );
    Ok(html)
}
