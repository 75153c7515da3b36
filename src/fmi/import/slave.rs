//! [`ImportedFmu`]: an FMU as a [`Slave`].

#[cfg(feature = "host")]
use super::archive::{Archive, check_path};
use super::description::Description;
use super::instance::{Health, Instance, Slot};
use super::library::{Library, Names};
use super::log::{Log, Message, names as names_of};
#[cfg(feature = "host")]
use super::reader::MAX_LENGTH;
use crate::model::{
    Causality, Initial, Interface, Kind, Slave, Snapshot, Value, Variability, VariableInfo, check_experiment,
    check_step,
};
use crate::{Error, Result};
use serde::{Deserialize, Serialize};
use std::fmt::Display;
#[cfg(feature = "host")]
use std::fs;
use std::path::Path;
#[cfg(feature = "host")]
use std::path::PathBuf;
use std::sync::Arc;
use uuid::Uuid;

/// A co-simulation FMU of any maker, unpacked, loaded and instantiated.
///
/// Values are passed on as they are, also those outside an FMU's ranges and those that are not
/// finite: what it makes of them is the FMU's business. Calls that FMI 2.0 forbids are not passed on.
///
/// After an error of the FMU only reading, [`restore`](Slave::restore) and [`reset`](Slave::reset) are
/// possible; after fmi2Fatal nothing is.
pub struct ImportedFmu {
    instance: Instance,
    description: Description,
    course: Course,
    /// The last communication point \[s\] that the FMU was told to be final: no earlier state comes back in
    /// this run.
    settled: f64,
    /// Values in place of the description's start values.
    presets: Vec<(usize, Value)>,
    /// Value references on their way: reading several variables does not allocate each time.
    references: Vec<u32>,
    #[cfg(feature = "host")]
    folder: PathBuf,
    /// Removed after the instance is gone.
    #[cfg(feature = "host")]
    _temporary: Option<crate::temporary::Folder>,
}

/// Where the run stands; saved with the FMU's state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Course {
    phase: Phase,
    /// The last communication point \[s\].
    time: f64,
    /// Inputs set before the start: FMI takes them only afterwards.
    waiting: Vec<(usize, Value)>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
enum Phase {
    /// Instantiated.
    New,
    /// In initialization mode.
    Starting,
    /// Ready to step.
    Running,
}

/// What a [`Snapshot`] of an imported FMU holds.
struct Saved {
    slot: Slot,
    course: Course,
}

/// A snapshot as bytes.
#[derive(Serialize, Deserialize)]
struct Packed {
    guid: String,
    course: Course,
    state: Vec<u8>,
}

impl Course {
    const NEW: Self = Self { phase: Phase::New, time: 0.0, waiting: Vec::new() };
}

impl ImportedFmu {
    /// Unpacks, loads and instantiates the FMU at `path`. This runs its code.
    ///
    /// # Errors
    /// [`Error::fmu`]: a damaged or dangerous archive, a wrong description, no binary for this
    /// machine, a binary that is incomplete or refuses to be instantiated.
    #[cfg(feature = "host")]
    pub fn load(path: &Path) -> Result<Self> {
        // The archive names itself in its errors.
        let mut archive = Archive::open(path)?;
        let xml = archive.read("modelDescription.xml", MAX_LENGTH)?;
        let at = |e: Error| e.at(path.display());
        let xml = xml.ok_or_else(|| at(Error::fmu("there is no modelDescription.xml: this is no FMU")))?;
        let description = Description::parse(&xml).map_err(at)?;
        let temporary = archive.unpack()?;
        // FMUs without resources get an empty folder rather than a location that is not there.
        let made = fs::create_dir_all(temporary.path().join("resources"));
        made.map_err(|e| at(Error::fmu(format!("the folder that it was unpacked to cannot be used: {e}"))))?;
        let mut fmu = Self::instantiate(description, temporary.path(), Names::Usual).map_err(at)?;
        fmu._temporary = Some(temporary);
        Ok(fmu)
    }

    /// Loads and instantiates the FMU with this description that is unpacked in `folder` and stays there,
    /// inside the process of another FMU. This runs its code.
    ///
    /// # Errors
    /// [`Error::fmu`]: no binary for this machine, a binary that is incomplete or refuses to be
    /// instantiated.
    pub(in crate::fmi) fn carried(description: Description, folder: &Path) -> Result<Self> {
        Self::instantiate(description, folder, Names::OwnFirst)
    }

    fn instantiate(description: Description, folder: &Path, names: Names) -> Result<Self> {
        let io = |e| Error::fmu(format!("the folder that it was unpacked to cannot be used: {e}"));
        let folder = std::path::absolute(folder).map_err(io)?;
        let resources = folder.join("resources");
        let library =
            Library::load(&folder, &description.model_identifier, &description.capabilities, names)?;
        let name = match description.model_name.trim() {
            "" => &description.model_identifier,
            _ => &description.model_name,
        };
        let variables = names_of(&description.interface.variables);
        let instance = Instance::new(library, name, &description.guid, &file_uri(&resources), variables)?;
        Ok(Self {
            instance,
            description,
            course: Course::NEW,
            settled: f64::NEG_INFINITY,
            presets: Vec::new(),
            references: Vec::new(),
            #[cfg(feature = "host")]
            folder,
            #[cfg(feature = "host")]
            _temporary: None,
        })
    }

    /// Makes values the start values: now, in the interface and after every reset.
    ///
    /// # Errors
    /// Already started; variables that cannot be set, values that they do not accept.
    pub(in crate::fmi) fn preset(&mut self, values: Vec<(usize, Value)>) -> Result<()> {
        for (index, value) in &values {
            self.write(*index, value.clone())?;
            self.description.interface.variables[*index].start = Some(value.clone());
        }
        self.presets = values;
        Ok(())
    }

    /// Where the FMU's messages go.
    pub(in crate::fmi) fn log(&self) -> Arc<Log> {
        self.instance.log()
    }

    /// Calls fmi2DoStep `count` times from `time` on with nothing around it, to measure what a call itself takes. The
    /// slave is of no use afterwards but to be reset.
    ///
    /// # Errors
    /// The first step that does not succeed.
    #[cfg(feature = "host")]
    #[doc(hidden)]
    pub fn bare_steps(&mut self, time: f64, length: f64, count: usize) -> Result<()> {
        self.well("a step")?;
        self.order(self.course.phase == Phase::Running, "a step", "before the end of initialization")?;
        self.instance.bare_steps(time, length, count)
    }

    /// Makes one more instance of the same binary and frees it, to measure what that takes.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    #[cfg(feature = "host")]
    #[doc(hidden)]
    pub fn instantiate_again(&self) -> Result<()> {
        Self::instantiate(self.description.clone(), &self.folder, Names::Usual).map(drop)
    }

    /// What the FMU says of itself.
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// The FMU's messages since the last time, the oldest first; of many, the last 1000.
    pub fn messages(&mut self) -> Vec<Message> {
        self.instance.messages()
    }

    /// The content of the file `name` in the FMU's folder `resources`, such as "model.toml"; `None` if
    /// there is no such file.
    #[cfg(feature = "host")]
    pub fn resource(&self, name: &str) -> Option<Vec<u8>> {
        check_path(name).ok()?;
        fs::read(self.folder.join("resources").join(name)).ok()
    }

    fn variable(&self, index: usize) -> Result<&VariableInfo> {
        let Interface { name, variables, .. } = &self.description.interface;
        variables.get(index).ok_or_else(|| {
            Error::variable(format!("{name} has {} variables; there is no number {index}", variables.len()))
        })
    }

    /// Fails where `what` is not possible `when`.
    fn order(&self, allowed: bool, what: impl Display, when: &str) -> Result<()> {
        let name = &self.description.interface.name;
        match allowed {
            true => Ok(()),
            false => Err(Error::call(format!("{name}: {what} is not possible {when}"))),
        }
    }

    /// Fails after a failure.
    fn well(&self, what: impl Display) -> Result<()> {
        let well = self.instance.health() == Health::Well;
        self.order(well, what, "after a failed call; restore a saved state, reset, or load the FMU again")
    }

    /// Fails unless FMI 2.0 allows to set the variable now.
    fn settable(&self, info: &VariableInfo) -> Result<()> {
        let name = &info.name;
        self.well(format_args!("setting {name}"))?;
        if info.variability == Variability::Constant {
            return Err(Error::variable(format!("{name} is constant; it cannot be set")));
        }
        let allowed = match (self.course.phase, info.causality) {
            (_, Causality::Input) => true,
            (Phase::New, _) => matches!(info.initial, Some(Initial::Exact | Initial::Approx)),
            (Phase::Starting, _) => info.initial == Some(Initial::Exact),
            (Phase::Running, Causality::Parameter) => info.variability == Variability::Tunable,
            (Phase::Running, _) => false,
        };
        match info.causality {
            _ if allowed => Ok(()),
            Causality::Parameter => {
                self.order(false, format_args!("setting the fixed parameter {name}"), "after initialization")
            }
            _ => Err(Error::variable(format!("{name} is computed by the FMU; it cannot be set now"))),
        }
    }

    fn write(&mut self, index: usize, value: Value) -> Result<()> {
        let info = self.variable(index)?;
        self.settable(info)?;
        if info.causality == Causality::Input && self.course.phase == Phase::New {
            self.course.waiting.retain(|(i, _)| *i != index);
            self.course.waiting.push((index, value));
            return Ok(());
        }
        let info = &self.description.interface.variables[index];
        let (name, reference) = (&info.name, info.reference);
        match value {
            Value::Real(v) => self.instance.set_real(name, reference, v),
            Value::Integer(v) => self.instance.set_integer(name, reference, v),
            Value::Boolean(v) => self.instance.set_boolean(name, reference, v),
            Value::Text(v) => self.instance.set_text(name, reference, &v),
        }
    }

    fn readable(&self, index: usize) -> Result<&VariableInfo> {
        let info = self.variable(index)?;
        self.order(
            self.course.phase != Phase::New,
            format_args!("reading {}", info.name),
            "before the start",
        )?;
        Ok(info)
    }
}

impl Slave for ImportedFmu {
    fn interface(&self) -> &Interface {
        &self.description.interface
    }

    fn get(&mut self, variable: usize) -> Result<f64> {
        self.readable(variable)?;
        let info = &self.description.interface.variables[variable];
        let (name, reference) = (&info.name, info.reference);
        match info.kind {
            Kind::Real => self.instance.get_real(name, reference),
            Kind::Integer | Kind::Enumeration(_) => self.instance.get_integer(name, reference).map(f64::from),
            Kind::Boolean => self.instance.get_boolean(name, reference).map(|v| f64::from(u8::from(v))),
            Kind::Text => Err(Error::variable(format!("{name} is a text, not a number"))),
        }
    }

    fn set(&mut self, variable: usize, value: f64) -> Result<()> {
        let info = self.variable(variable)?;
        let whole = value.fract() == 0.0 && (f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&value);
        let needed = match info.kind {
            Kind::Real => return self.write(variable, Value::Real(value)),
            Kind::Integer | Kind::Enumeration(_) if whole => {
                return self.write(variable, Value::Integer(value as i32));
            }
            Kind::Boolean if value == 0.0 || value == 1.0 => {
                return self.write(variable, Value::Boolean(value == 1.0));
            }
            Kind::Integer | Kind::Enumeration(_) => "a whole number of 32 bits",
            Kind::Boolean => "0 (false) or 1 (true)",
            Kind::Text => "a text",
        };
        Err(Error::variable(format!("{} = {value:?}: {needed} is needed", info.name)))
    }

    fn text(&mut self, variable: usize) -> Result<String> {
        self.readable(variable)?;
        let info = &self.description.interface.variables[variable];
        match info.kind {
            Kind::Text => self.instance.get_text(&info.name, info.reference),
            _ => Err(Error::variable(format!("{} is not a text", info.name))),
        }
    }

    fn set_text(&mut self, variable: usize, text: &str) -> Result<()> {
        let info = self.variable(variable)?;
        match info.kind {
            Kind::Text => self.write(variable, Value::Text(text.into())),
            _ => Err(Error::variable(format!("{} is not a text", info.name))),
        }
    }

    fn set_rate(&mut self, variable: usize, rate: f64) -> Result<()> {
        let info = self.variable(variable)?;
        let what = format!("the derivative of {}", info.name);
        if info.causality != Causality::Input || !info.is_real() {
            return Err(Error::variable(format!("{} is not a real input; it has no derivative", info.name)));
        }
        self.well(&what)?;
        self.order(self.course.phase != Phase::New, &what, "before the start")?;
        let info = &self.description.interface.variables[variable];
        self.instance.set_rate(&info.name, info.reference, rate).unwrap_or_else(|| {
            Err(Error::call(format!(
                "{}: {what} cannot be set: the FMU does not interpolate (canInterpolateInputs is not true)",
                self.description.interface.name
            )))
        })
    }

    fn get_all(&mut self, variables: &[usize], values: &mut [f64]) -> Result<()> {
        let mut references = std::mem::take(&mut self.references);
        references.clear();
        let collected = variables.iter().try_for_each(|variable| {
            let info = self.readable(*variable)?;
            if !info.is_real() {
                return Err(Error::variable(format!("{} is not a real variable", info.name)));
            }
            references.push(info.reference);
            Ok(())
        });
        self.references = references;
        collected?;
        self.instance.get_reals(&self.references, values)
    }

    fn set_all(&mut self, variables: &[usize], values: &[f64], rates: &[f64]) -> Result<()> {
        let what = "setting inputs";
        self.well(what)?;
        self.order(self.course.phase != Phase::New, what, "before the start")?;
        let mut references = Vec::with_capacity(variables.len());
        for variable in variables {
            let info = self.variable(*variable)?;
            if info.causality != Causality::Input || !info.is_real() {
                return Err(Error::variable(format!("{} is not a real input", info.name)));
            }
            references.push(info.reference);
        }
        self.instance.set_reals(&references, values, self.can_interpolate().then_some(rates))
    }

    fn can_interpolate(&self) -> bool {
        self.description.capabilities.can_interpolate_inputs
    }

    fn start(&mut self, start: f64, stop: Option<f64>) -> Result<()> {
        self.well("a start")?;
        self.order(self.course.phase == Phase::New, "a start", "twice without a reset")?;
        check_experiment(start, stop)?;
        self.instance.setup(start, stop)?;
        self.instance.enter_initialization()?;
        self.course.phase = Phase::Starting;
        self.course.time = start;
        for (variable, value) in std::mem::take(&mut self.course.waiting) {
            self.write(variable, value)?;
        }
        Ok(())
    }

    fn finish_start(&mut self) -> Result<()> {
        self.well("the end of initialization")?;
        let starting = self.course.phase == Phase::Starting;
        self.order(starting, "the end of initialization", "outside initialization")?;
        self.instance.exit_initialization()?;
        self.course.phase = Phase::Running;
        Ok(())
    }

    fn output_derivative(&mut self, variable: usize) -> Result<f64> {
        let info = self.variable(variable)?;
        let what = format!("the derivative of {}", info.name);
        if info.causality != Causality::Output || !info.is_real() {
            return Err(Error::variable(format!("{what}: only real outputs have one")));
        }
        self.order(self.course.phase == Phase::Running, &what, "before the end of initialization")?;
        let info = &self.description.interface.variables[variable];
        self.instance.get_rate(&info.name, info.reference).unwrap_or_else(|| {
            Err(Error::call(format!(
                "{}: {what} is not known to the FMU (maxOutputDerivativeOrder is 0)",
                self.description.interface.name
            )))
        })
    }

    fn step(&mut self, time: f64, length: f64) -> Result<()> {
        self.well("a step")?;
        self.order(self.course.phase == Phase::Running, "a step", "before the end of initialization")?;
        let target = check_step(self.course.time, time, length, None)?;
        // Only whoever holds a saved state can go back.
        let final_past = !self.instance.may_go_back();
        if final_past {
            self.settled = time;
        }
        self.instance.step(time, length, final_past)?;
        self.course.time = target;
        Ok(())
    }

    fn save(&mut self) -> Result<Snapshot> {
        self.well("saving the state")?;
        let slot = self.instance.save()?;
        Ok(Box::new(Saved { slot, course: self.course.clone() }))
    }

    fn save_into(&mut self, snapshot: &mut Snapshot) -> Result<()> {
        match snapshot.downcast_mut::<Saved>() {
            Some(saved) if self.instance.owns(&saved.slot) => {
                self.well("saving the state")?;
                self.instance.save_into(&saved.slot)?;
                saved.course.clone_from(&self.course);
            }
            _ => *snapshot = self.save()?,
        }
        Ok(())
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let saved = saved(snapshot)?;
        if self.instance.owns(&saved.slot) && saved.course.time < self.settled {
            // A state of another instance, from before a point that this one takes for final: another run
            // begins with it.
            self.reset()?;
        }
        self.instance.restore(&saved.slot)?;
        self.course.clone_from(&saved.course);
        Ok(())
    }

    fn serialize(&mut self, snapshot: &Snapshot) -> Result<Vec<u8>> {
        let saved = saved(snapshot)?;
        let state = self.instance.serialize(&saved.slot)?;
        let guid = self.description.guid.clone();
        let payload = postcard::to_stdvec(&Packed { guid, course: saved.course.clone(), state })
            .map_err(|e| Error::call(format!("the state cannot be written: {e}")))?;
        Ok([digest(&payload).as_bytes(), payload.as_slice()].concat())
    }

    fn deserialize(&mut self, bytes: &[u8]) -> Result<Snapshot> {
        // Foreign code gets no bytes but its own, undamaged.
        let damaged = || Error::call("the bytes of the saved state are damaged");
        let (head, payload) = bytes.split_at_checked(16).ok_or_else(damaged)?;
        if head != digest(payload).as_bytes() {
            return Err(damaged());
        }
        let packed: Packed = postcard::from_bytes(payload).map_err(|_| damaged())?;
        if packed.guid != self.description.guid {
            return Err(Error::call(format!(
                "the bytes are a state of the FMU with the guid {:?}; this one has {:?}",
                packed.guid, self.description.guid
            )));
        }
        let slot = self.instance.deserialize(&packed.state)?;
        Ok(Box::new(Saved { slot, course: packed.course }))
    }

    fn reset(&mut self) -> Result<()> {
        self.instance.reset()?;
        self.course = Course::NEW;
        self.settled = f64::NEG_INFINITY;
        for (index, value) in self.presets.clone() {
            self.write(index, value)?;
        }
        Ok(())
    }
}

impl Drop for ImportedFmu {
    fn drop(&mut self) {
        if self.course.phase == Phase::Running && self.instance.health() == Health::Well {
            // There is nobody left to tell of a failure.
            let _ = self.instance.terminate();
        }
    }
}

fn saved(snapshot: &Snapshot) -> Result<&Saved> {
    snapshot.downcast_ref().ok_or_else(|| Error::call("the saved state belongs to another slave"))
}

fn digest(payload: &[u8]) -> Uuid {
    Uuid::new_v5(&Uuid::NAMESPACE_OID, payload)
}

/// The URI of an absolute path, by RFC 3986.
pub(in crate::fmi) fn file_uri(path: &Path) -> String {
    uri(path.as_os_str().as_encoded_bytes(), cfg!(windows))
}

fn uri(path: &[u8], windows: bool) -> String {
    // C:\folder is /C:/folder, and \\server\share is //server/share; \\?\ in front says that a path is as it stands
    let path = if windows { path.strip_prefix(br"\\?\").unwrap_or(path) } else { path };
    let is_share = windows && path.starts_with(br"\\");
    let mut uri = String::from(if is_share { "file:" } else { "file://" });
    if windows && !is_share {
        uri.push('/');
    }
    for &byte in path {
        match byte {
            b'\\' if windows => uri.push('/'),
            b':' if windows => uri.push(':'),
            b'/' | b'-' | b'.' | b'_' | b'~' => uri.push(char::from(byte)),
            _ if byte.is_ascii_alphanumeric() => uri.push(char::from(byte)),
            _ => uri.push_str(&format!("%{byte:02X}")),
        }
    }
    uri
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uris_are_percent_encoded() {
        let of = |path: &str, windows| uri(path.as_bytes(), windows);
        assert_eq!(of("/srv/a b/ü%#?/x-1_2.~", false), "file:///srv/a%20b/%C3%BC%25%23%3F/x-1_2.~");
        assert_eq!(of(r"C:\Temp\a b", true), "file:///C:/Temp/a%20b");
        assert_eq!(of(r"\\?\C:\Temp", true), "file:///C:/Temp");
        assert_eq!(of(r"\\server\share\x", true), "file://server/share/x");
    }
}
