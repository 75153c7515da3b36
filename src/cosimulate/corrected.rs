//! Writes a system whose parts are corrected: other parameters, and parts with effects as FMUs.

use super::file::read_system;
use super::plan::{Assignment, PlannedComponent, Source};
use super::slave::SystemSlave;
use crate::effect::Attachment;
use crate::fmi::archive::ModelLibrary;
use crate::fmi::corrected::{CorrectedBase, export_corrected};
use crate::model::{Slave, Value};
use crate::recording::read_settings;
use crate::{Error, Result, write_file};
use std::path::{Path, PathBuf};

/// The description of the written system, in its folder.
const DESCRIPTION: &str = "system.toml";

/// Writes the system of `file` to `folder`, which is made: `system.toml` and beside it all that it names. `parameters`
/// are by names `part.variable`, `attachments` refer to the interface of the system as one slave
/// ([`SystemSlave`]); a part with effects becomes an FMU that has them, so that they act inside the loop.
///
/// # Errors
/// Files that cannot be read or written; an effect that is driven by signals of several parts, which no FMU of one part
/// can have.
pub fn write_corrected(
    file: &Path,
    folder: &Path,
    parameters: &[(String, f64)],
    attachments: &[Attachment],
    library: &ModelLibrary,
) -> Result<()> {
    let read = read_system(file)?;
    let mut plan = read.plan.clone();
    let slave = SystemSlave::new("system", plan.load()?, plan.step.unwrap_or(1.0))?;
    let mut effects: Vec<Vec<Attachment>> = vec![Vec::new(); plan.components.len()];
    for attachment in attachments {
        let (part, attachment) = of_one_part(&slave, attachment)?;
        effects[part].push(attachment);
    }
    for (name, value) in parameters {
        let port = slave.port(slave.find(name)?)?;
        let variable = slave.system().info(port).name.clone();
        let set = &mut plan.components[port.component].set;
        set.retain(|a| a.variable != variable);
        set.push(Assignment { variable, value: Value::Real(*value), place: "the parameters".into() });
    }
    std::fs::create_dir_all(folder)
        .map_err(|e| Error::file(format!("{} cannot be made: {e}", folder.display())))?;
    let parts = std::mem::take(&mut plan.components).into_iter().zip(&effects);
    plan.components =
        parts.map(|(part, effects)| gather(part, effects, folder, library)).collect::<Result<_>>()?;
    for (i, inputs) in plan.inputs.iter_mut().enumerate() {
        inputs.file = copy(&inputs.file, folder, &format!("inputs-{}.csv", i + 1))?;
    }
    let text = plan.to_toml(&|path| path.display().to_string());
    write_file(&folder.join(DESCRIPTION), text.as_bytes())
}

/// The part that an effect belongs to, and the effect by the indices of that part.
fn of_one_part(slave: &SystemSlave, attachment: &Attachment) -> Result<(usize, Attachment)> {
    let target = slave.port(attachment.target)?;
    let mut own = Attachment { target: target.variable, ..attachment.clone() };
    for signal in &mut own.drivers {
        let port = slave.port(signal.variable)?;
        if port.component != target.component {
            let name = |variable: usize| &slave.interface().variables[variable].name;
            return Err(Error::variable(format!(
                "the effect {} on {} is driven by {}, which is a signal of another part",
                attachment.effect.id,
                name(attachment.target),
                name(signal.variable)
            )));
        }
        signal.variable = port.variable;
    }
    Ok((target.component, own))
}

/// Puts what a part is made from into the folder; the part as it is to be described there.
fn gather(
    mut component: PlannedComponent,
    effects: &[Attachment],
    folder: &Path,
    library: &ModelLibrary,
) -> Result<PlannedComponent> {
    let fmu = format!("{}.fmu", component.name);
    let base = match component.source {
        Source::Model(name, parameters) => CorrectedBase::Model(name, read_settings(parameters.as_deref())?),
        Source::Fmu(path) => CorrectedBase::Fmu(path),
    };
    if !effects.is_empty() {
        write_file(&folder.join(&fmu), &export_corrected(&base, &[], effects, None, library, &[])?)?;
        return Ok(PlannedComponent { source: Source::Fmu(fmu.into()), ..component });
    }
    component.source = match base {
        CorrectedBase::Model(name, settings) => {
            let over = |name: &str| component.set.iter().any(|a| a.variable == name);
            let more = settings.values.into_iter().filter(|s| !over(&s.name));
            let more: Vec<Assignment> =
                more.map(|s| Assignment { variable: s.name, value: s.value, place: s.place }).collect();
            component.set.extend(more);
            Source::Model(name, None)
        }
        CorrectedBase::Fmu(path) => Source::Fmu(copy(&path, folder, &fmu)?),
    };
    Ok(component)
}

fn copy(from: &Path, folder: &Path, name: &str) -> Result<PathBuf> {
    let at = |e: std::io::Error| Error::file(format!("{}: {e}", from.display()));
    let content = std::fs::read(from).map_err(at)?;
    write_file(&folder.join(name), &content)?;
    Ok(name.into())
}
