//! Makes the slave that an FMU's resources describe: a model of the library, or an FMU that is carried
//! along, with or without effects.

use super::entry::{Entry, guid, guid_of};
use crate::bounded;
use crate::effect::file::Corrections;
use crate::effect::{Attached, attached_interface};
use crate::model::{Interface, Slave};
use crate::{Error, Result};
use std::path::Path;

/// The folder in the resources that holds the FMU that is carried along.
pub const ORIGINAL: &str = "original";
/// The file in the resources with that FMU's description.
pub const ORIGINAL_DESCRIPTION: &str = "original.toml";
/// That file is no longer \[bytes\].
pub const MAX_ABOUT: u64 = 64 << 20;

/// A slave, its interface as the FMU's description has it, and the GUID that goes with it.
pub struct Made {
    pub slave: Box<dyn Slave>,
    pub guid: String,
    /// Messages of the FMU that is carried along.
    pub messages: Option<std::sync::Arc<super::import::log::Log>>,
}

/// The slave that the folder `resources` with `model.toml` describes.
///
/// # Errors
/// Resources that cannot be read or are of another version, an unknown model, values or effects that it
/// does not take, an FMU inside that cannot be loaded.
pub fn make(models: &[Entry], resources: &Path, text: &str) -> Result<Made> {
    let corrections = Corrections::parse(text, "model.toml")?;
    let settings = &corrections.settings;
    if settings.version.as_deref() != Some(crate::VERSION) {
        return Err(Error::fmu(format!(
            "the resources are of version {}, the binary is of version {}: export the FMU anew",
            settings.version.as_deref().unwrap_or("?"),
            crate::VERSION
        )));
    }
    if corrections.original {
        return carried(&corrections, resources, text);
    }
    let model = settings.model.as_deref().ok_or_else(|| Error::fmu("model.toml names no model"))?;
    let entry = Entry::find(models, model)?;
    let (inner, fingerprint) = entry.slave_with_fingerprint(settings)?;
    let (slave, guid): (Box<dyn Slave>, String) = if corrections.has_effects() {
        let attachments = corrections.attachments(inner.interface())?;
        let outer = corrected_interface(inner.interface(), &corrections)?;
        (Box::new(Attached::new(inner, attachments)?), guid(&outer, text))
    } else {
        (inner, guid_of(&fingerprint, text))
    };
    Ok(Made { slave, guid, messages: None })
}

fn carried(corrections: &Corrections, resources: &Path, text: &str) -> Result<Made> {
    use super::import::{Description, ImportedFmu};
    let path = resources.join(ORIGINAL_DESCRIPTION);
    let at = |e: String| Error::fmu(format!("{}: {e}", path.display()));
    let about = bounded::read_own_text(&path, MAX_ABOUT).map_err(at)?;
    let description: Description = toml::from_str(&about).map_err(|e| at(e.message().into()))?;
    let values = corrections.settings.check(&description.interface)?;
    let mut inner = ImportedFmu::carried(description, &resources.join(ORIGINAL))
        .map_err(|e| e.at("the FMU that this one carries"))?;
    inner.preset(values)?;
    let messages = Some(inner.log());
    let attachments = corrections.attachments(inner.interface())?;
    let outer = corrected_interface(inner.interface(), corrections)?;
    let guid = guid(&outer, &(about + text));
    let slave = Box::new(Attached::new(Box::new(inner), attachments)?);
    Ok(Made { slave, guid, messages })
}

/// The interface of a corrected model as its own FMU has it. `inner` is that of the model with its start
/// values.
///
/// # Errors
/// Effects that do not fit the model.
pub fn corrected_interface(inner: &Interface, corrections: &Corrections) -> Result<Interface> {
    let attachments = corrections.attachments(inner)?;
    let mut interface = attached_interface(inner, &attachments)?;
    let added: Vec<String> = attachments
        .iter()
        .map(|a| format!("{} on {}", a.effect.name, interface.variables[a.target].name))
        .collect();
    if !added.is_empty() {
        interface.description = format!("{}; with {}", interface.description, added.join(", "));
    }
    interface.name.push_str("-corrected");
    if let Some(step) = corrections.step {
        interface.communication_step = step;
    }
    Ok(as_own(interface))
}

/// An interface in the form that our FMUs have: a variable's reference is made of its name, and there are
/// start values only where FMI has them.
fn as_own(mut interface: Interface) -> Interface {
    use crate::model::{Causality, Initial};
    for variable in &mut interface.variables {
        variable.reference = crate::model::reference(&variable.name);
        if variable.initial == Some(Initial::Calculated) || variable.causality == Causality::Independent {
            variable.start = None;
        }
    }
    interface
}
