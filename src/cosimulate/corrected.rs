//! Writes a system whose parts are corrected: other parameters, and parts with effects as FMUs.

use super::file::read_system;
use super::plan::{Assignment, Plan, PlannedComponent, Source};
use super::slave::SystemSlave;
use crate::effect::Attachment;
use crate::fmi::archive::ModelLibrary;
use crate::fmi::corrected::{CorrectedBase, export_corrected};
use crate::model::{Settings, Slave, Value};
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
    for (component, effects) in plan.components.iter_mut().zip(&effects) {
        component.source = gather(component, effects, folder, library)?;
    }
    for (i, inputs) in plan.inputs.iter_mut().enumerate() {
        inputs.file = copy(&inputs.file, folder, &format!("inputs-{}.csv", i + 1))?;
    }
    write_file(&folder.join(DESCRIPTION), text(&plan).as_bytes())
}

fn text(plan: &Plan) -> String {
    plan.to_toml(&|path| path.display().to_string())
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

/// Puts what a part is made from into the folder; the source by its name there.
fn gather(
    component: &PlannedComponent,
    effects: &[Attachment],
    folder: &Path,
    library: &ModelLibrary,
) -> Result<Source> {
    let fmu = format!("{}.fmu", component.name);
    if !effects.is_empty() {
        let base = match &component.source {
            Source::Model(name, None) => CorrectedBase::Model(name.clone(), Settings::default()),
            Source::Model(name, Some(path)) => {
                let place = path.display().to_string();
                let text = std::fs::read_to_string(path).map_err(|e| Error::file(format!("{place}: {e}")))?;
                CorrectedBase::Model(name.clone(), Settings::parse(&text, &place)?)
            }
            Source::Fmu(path) => CorrectedBase::Fmu(path.clone()),
        };
        write_file(&folder.join(&fmu), &export_corrected(&base, &[], effects, library, &[])?)?;
        return Ok(Source::Fmu(fmu.into()));
    }
    Ok(match &component.source {
        Source::Model(name, Some(path)) => {
            Source::Model(name.clone(), Some(copy(path, folder, &format!("{}.toml", component.name))?))
        }
        Source::Model(name, None) => Source::Model(name.clone(), None),
        Source::Fmu(path) => Source::Fmu(copy(path, folder, &fmu)?),
    })
}

fn copy(from: &Path, folder: &Path, name: &str) -> Result<PathBuf> {
    let at = |e: std::io::Error| Error::file(format!("{}: {e}", from.display()));
    let content = std::fs::read(from).map_err(at)?;
    write_file(&folder.join(name), &content)?;
    Ok(name.into())
}
