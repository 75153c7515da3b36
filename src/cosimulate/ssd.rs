//! System Structure Descriptions: `.ssd` files beside their FMUs, and `.ssp` archives (SSP 1.0).
//!
//! What is not supported is refused by its name: nested systems, signal dictionaries, mappings. Graphics
//! are passed over, annotations of other tools with a warning. Of the annotations of the Open Simulation
//! Platform the communication step is used.

use super::file::IN_ARCHIVE;
use super::plan::{
    Assignment, Plan, PlannedComponent, PlannedConnection, PlannedConnector, PortName, Source,
};
use super::system::Transfer;
use crate::bounded::{self, MAX_TEXT};
use crate::fmi::import::xml::{self, Broken, Element};
use crate::model::{Causality, Value};
use crate::{Error, Result};
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

/// The only version that is read.
const VERSION: &str = "1.0";
/// What annotations of the Open Simulation Platform are marked with.
const OSP: &str = "com.opensimulationplatform";
/// Elements that say nothing about the simulation, with all that is in them.
const WITHOUT_MEANING: [&str; 8] = [
    "ElementGeometry",
    "SystemGeometry",
    "GraphicalElements",
    "ConnectorGeometry",
    "ConnectionGeometry",
    "MetaData",
    // units are known by their names, items of enumerations by the FMU
    "Units",
    "Enumerations",
];
/// Elements that only hold others.
const CONTAINERS: [&str; 8] = [
    "Connectors",
    "Elements",
    "Connections",
    "ParameterBindings",
    "ParameterValues",
    "ParameterSet",
    "Parameters",
    "Annotations",
];

/// Names longer than this are refused \[bytes\]: everything that belongs to a component keeps a copy of its name, so a
/// short file with a long name could fill the memory.
const MAX_NAME: usize = 1000;

/// Reads a System Structure Description; sources are looked for in `folder`, and `place` names the file in
/// messages.
///
/// # Errors
/// XML that is broken, another version, constructs that are not supported, connections without connectors,
/// each with line and column; parameter files that cannot be read.
pub fn parse_ssd(bytes: &[u8], place: &str, folder: &Path) -> Result<Plan> {
    parse(bytes, place, folder, false)
}

/// As [`parse_ssd`], for the description in an archive that is unpacked in `folder`: sources outside it are refused, as
/// whoever sends an archive has no business with other files here.
///
/// # Errors
/// As [`parse_ssd`]; sources that are not in the archive.
pub(super) fn parse_ssd_in_archive(bytes: &[u8], place: &str, folder: &Path) -> Result<Plan> {
    parse(bytes, place, folder, true)
}

fn parse(bytes: &[u8], place: &str, folder: &Path, archive: bool) -> Result<Plan> {
    let mut reader =
        Reader { file: place.into(), folder: folder.into(), archive, left: MAX_TEXT, ..Reader::default() };
    xml::read(bytes, |path, element| reader.open(path, element).map_err(Fault::Wrong))
        .map_err(|fault| fault.error(place))?;
    reader.finish()
}

/// XML that is broken, or that says what cannot be done.
enum Fault {
    Broken(Broken),
    Wrong(Error),
}

impl From<Broken> for Fault {
    fn from(broken: Broken) -> Self {
        Self::Broken(broken)
    }
}

impl Fault {
    fn error(self, file: &str) -> Error {
        match self {
            Self::Wrong(error) => error,
            Self::Broken(Broken { place: Some(place), what }) => {
                let (line, column) = place.position();
                Error::file(format!("{file}:{line}:{column}: {what}"))
            }
            Self::Broken(Broken { place: None, what }) => Error::file(format!("{file}: {what}")),
        }
    }
}

#[derive(Default)]
struct Reader {
    file: String,
    folder: PathBuf,
    /// The folder is an unpacked archive.
    archive: bool,
    /// How much more of files of parameters is read \[bytes\]: many bindings may name the same one.
    left: u64,
    plan: Plan,
    /// Kinds of the connectors, by component and name.
    kinds: HashMap<(String, String), String>,
    connections: Vec<Link>,
    /// Values of the system's own parameter bindings, which win over those of the components.
    bindings: Vec<(PortName, Assignment)>,
    /// Prefix of the current binding.
    prefix: String,
    /// The parameter that is being read.
    parameter: String,
    /// The connector that is being read.
    connector: Option<PortName>,
    /// The type of the annotation that is being read.
    annotation: String,
    hints: Vec<(String, f64)>,
}

/// A connection as written, where start and end do not tell the direction.
struct Link {
    start: (Option<String>, String),
    end: (Option<String>, String),
    transfer: Transfer,
    place: String,
}

impl Reader {
    fn place(&self, element: &Element) -> String {
        let place = element.place();
        let (line, column) = place.position();
        format!("{}:{line}:{column}", self.file)
    }

    fn wrong(&self, element: &Element, what: &str) -> Error {
        Error::file(format!("{}: <{}>: {what}", self.place(element), element.name()))
    }

    fn required(&self, element: &Element, attribute: &str) -> Result<String> {
        let missing = || self.wrong(element, &format!("the attribute {attribute} is missing"));
        element.text(attribute).map(str::to_owned).ok_or_else(missing)
    }

    /// A name that many things will keep.
    fn name(&self, element: &Element, attribute: &str) -> Result<String> {
        let name = self.required(element, attribute)?;
        match name.len() <= MAX_NAME {
            true => Ok(name),
            false => Err(self.wrong(
                element,
                &format!(
                    "the attribute {attribute} has {} bytes; no more than {MAX_NAME} are read",
                    name.len()
                ),
            )),
        }
    }

    fn number(&self, element: &Element, attribute: &str) -> Result<Option<f64>> {
        let Some(text) = element.text(attribute) else { return Ok(None) };
        match text.trim().parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(Some(value)),
            _ => Err(self.wrong(
                element,
                &format!("the attribute {attribute} is {text:?}; a finite number is needed"),
            )),
        }
    }

    /// Takes one element; `path` are the names of the elements around it.
    fn open(&mut self, path: &[String], element: &Element) -> Result<()> {
        let path: Vec<&str> = path.iter().map(|name| local(name)).collect();
        let name = local(element.name());
        if path.iter().chain([&name]).any(|name| WITHOUT_MEANING.contains(name)) {
            return Ok(());
        }
        if let Some(inside) = path.iter().position(|name| *name == "Annotation") {
            return self.annotated(&path[..inside], element, name);
        }
        match (path.as_slice(), name) {
            ([], "SystemStructureDescription") => {
                let version = self.required(element, "version")?;
                match version == VERSION {
                    true => Ok(()),
                    false => Err(self.wrong(
                        element,
                        &format!("the version is {version:?}; System Structure Descriptions of {VERSION:?} can be read"),
                    )),
                }
            }
            ([], _) => {
                Err(self.wrong(element, "the outermost element has to be <SystemStructureDescription>"))
            }
            ([_], "System") => Ok(()),
            ([_], "DefaultExperiment") => {
                self.plan.start = self.number(element, "startTime")?;
                self.plan.stop = self.number(element, "stopTime")?;
                Ok(())
            }
            ([_, "System", "Elements"], "Component") => self.component(element),
            ([_, "System", "Elements"], "System") => Err(self.wrong(
                element,
                "nested systems are not supported; put their components and connections into the outer one",
            )),
            ([.., "Connectors"], "Connector") => self.connector(&path, element),
            ([.., "Connectors", "Connector"], _) => self.connector_type(element, name),
            ([.., "ParameterBindings"], "ParameterBinding") => self.binding(&path, element),
            ([.., "Parameters"], "Parameter") => {
                self.parameter = format!("{}{}", self.prefix, self.required(element, "name")?);
                Ok(())
            }
            ([before @ .., "ParameterSet", "Parameters", "Parameter"], _) => {
                let owner = self.owner(before);
                let value = self.value(element, name)?;
                self.assign(owner, value, self.place(element)).map_err(|what| self.wrong(element, &what))
            }
            ([_, "System", "Connections"], "Connection") => self.connection(element),
            ([_, "System", "Connections", "Connection"], "LinearTransformation") => {
                let factor = self.number(element, "factor")?.unwrap_or(1.0);
                let offset = self.number(element, "offset")?.unwrap_or(0.0);
                if let Some(link) = self.connections.last_mut() {
                    link.transfer.linear = Some((factor, offset));
                }
                Ok(())
            }
            (_, "Annotation") => {
                self.annotation = self.required(element, "type")?;
                if self.annotation != OSP {
                    self.plan.warnings.push(format!(
                        "{}: the annotation of type {:?} is not used",
                        self.place(element),
                        self.annotation
                    ));
                }
                Ok(())
            }
            (_, name) if CONTAINERS.contains(&name) => Ok(()),
            _ => Err(self.wrong(element, "this is not supported")),
        }
    }

    fn annotated(&mut self, path: &[&str], element: &Element, name: &str) -> Result<()> {
        match (self.annotation.as_str(), name) {
            (OSP, "FixedStepAlgorithm") => {
                self.plan.step = self.number(element, "baseStepSize")?;
                Ok(())
            }
            (OSP, "StepSizeHint") if path.contains(&"Component") => {
                if let (Some(hint), Some(component)) =
                    (self.number(element, "value")?, self.plan.components.last())
                {
                    self.hints.push((component.name.clone(), hint));
                }
                Ok(())
            }
            (OSP, "Algorithm") => Ok(()),
            (OSP, other) => {
                self.plan
                    .warnings
                    .push(format!("{}: the annotation <{other}> is not used", self.place(element)));
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn component(&mut self, element: &Element) -> Result<()> {
        let name = self.name(element, "name")?;
        let source = self.required(element, "source")?;
        if let Some(other) = element.text("type").filter(|t| *t != "application/x-fmu-sharedlibrary") {
            return Err(self.wrong(element, &format!("{name} is of type {other:?}; only FMUs are supported")));
        }
        if element.text("implementation") == Some("ModelExchange") {
            return Err(self.wrong(
                element,
                &format!("{name} is to be run by model exchange; only co-simulation is supported"),
            ));
        }
        let path = self.resolve(&source).map_err(|what| self.wrong(element, &what))?;
        let place = self.place(element);
        self.plan.components.push(PlannedComponent {
            name,
            source: Source::Fmu(path),
            set: Vec::new(),
            place,
        });
        Ok(())
    }

    /// The file that a URI of the description names.
    fn resolve(&self, uri: &str) -> std::result::Result<PathBuf, String> {
        let outside = || {
            format!(
                "the source {uri:?} is not in the archive; a system in an SSP archive is made of the archive's own files, named relative to {IN_ARCHIVE}"
            )
        };
        let path = match uri.split_once("://") {
            Some(("file", _)) if self.archive => return Err(outside()),
            Some(("file", path)) => path,
            Some((scheme, _)) => {
                return Err(format!("the source {uri:?} is on {scheme}; only files are supported"));
            }
            None => uri,
        };
        let mut bytes = Vec::new();
        let mut rest = path.as_bytes();
        while let [first, tail @ ..] = rest {
            let decoded = (*first == b'%').then(|| path_byte(tail)).flatten();
            bytes.push(decoded.unwrap_or(*first));
            rest = if decoded.is_some() { &tail[2..] } else { tail };
        }
        let path = String::from_utf8(bytes).map_err(|_| format!("the source {uri:?} is no text"))?;
        if self.archive {
            return Ok(self.folder.join(inside(&path).ok_or_else(outside)?));
        }
        Ok(self.folder.join(path))
    }

    fn connector(&mut self, path: &[&str], element: &Element) -> Result<()> {
        let name = self.name(element, "name")?;
        let kind = self.required(element, "kind")?;
        let owner = match path.contains(&"Component") {
            true => self.plan.components.last().map(|c| c.name.clone()).unwrap_or_default(),
            // of the system itself
            false => String::new(),
        };
        if self.kinds.insert((owner.clone(), name.clone()), kind.clone()).is_some() {
            return Err(self.wrong(element, &format!("there are two connectors {name:?}")));
        }
        self.connector = None;
        if !owner.is_empty() {
            let causality = match kind.as_str() {
                "input" => Causality::Input,
                "output" => Causality::Output,
                "parameter" => Causality::Parameter,
                "calculatedParameter" => Causality::CalculatedParameter,
                "local" => Causality::Local,
                _ => {
                    return Err(
                        self.wrong(element, &format!("connectors of kind {kind:?} are not supported"))
                    );
                }
            };
            let port = PortName { component: owner, variable: name };
            self.connector = Some(port.clone());
            let place = self.place(element);
            self.plan.connectors.push(PlannedConnector { port, causality, kind: None, unit: None, place });
        }
        Ok(())
    }

    fn connector_type(&mut self, element: &Element, name: &str) -> Result<()> {
        if !["Real", "Integer", "Boolean", "String", "Enumeration"].contains(&name) {
            return Err(self.wrong(element, "connectors of this type are not supported"));
        }
        if let Some(connector) = self.plan.connectors.last_mut().filter(|_| self.connector.is_some()) {
            connector.kind = Some(name.into());
            connector.unit = element.text("unit").map(Into::into);
        }
        Ok(())
    }

    fn binding(&mut self, path: &[&str], element: &Element) -> Result<()> {
        self.prefix = match element.text("prefix") {
            Some(_) => self.name(element, "prefix")?,
            None => String::new(),
        };
        if let Some(other) = element.text("type").filter(|t| *t != "application/x-ssp-parameter-set") {
            return Err(self.wrong(element, &format!("parameters of type {other:?} are not supported")));
        }
        if element.text("sourceBase").is_some_and(|base| base != "SSD") {
            return Err(self.wrong(element, "parameters inside a component (sourceBase) are not supported"));
        }
        let Some(source) = element.text("source") else { return Ok(()) };
        let file = self.resolve(source).map_err(|what| self.wrong(element, &what))?;
        let fail = |e: String| self.wrong(element, &format!("the parameters {source:?} cannot be read: {e}"));
        let bytes = bounded::read(&file, MAX_TEXT).map_err(fail)?;
        let left = self.left.checked_sub(bytes.len() as u64);
        let much = || format!("with them, the files of parameters have more than {MAX_TEXT} bytes together");
        self.left = left.ok_or_else(much).map_err(fail)?;
        let owner = self.owner(path);
        // messages from there name that file
        let outer = std::mem::replace(&mut self.file, file.display().to_string());
        xml::read(&bytes, |path, element| self.parameter_file(path, element, owner).map_err(Fault::Wrong))
            .map_err(|fault| fault.error(&self.file))?;
        self.file = outer;
        Ok(())
    }

    /// Takes one element of a file of parameters (.ssv).
    fn parameter_file(&mut self, path: &[String], element: &Element, owner: Option<usize>) -> Result<()> {
        let path: Vec<&str> = path.iter().map(|name| local(name)).collect();
        let name = local(element.name());
        if path.iter().chain([&name]).any(|name| WITHOUT_MEANING.contains(name) || *name == "Annotations") {
            return Ok(());
        }
        match (path.as_slice(), name) {
            ([], "ParameterSet") | (["ParameterSet"], "Parameters") => Ok(()),
            (["ParameterSet", "Parameters"], "Parameter") => {
                self.parameter = format!("{}{}", self.prefix, self.required(element, "name")?);
                Ok(())
            }
            (["ParameterSet", "Parameters", "Parameter"], _) => {
                let value = self.value(element, name)?;
                self.assign(owner, value, self.place(element)).map_err(|what| self.wrong(element, &what))
            }
            _ => Err(self.wrong(element, "this is not supported in a file of parameters")),
        }
    }

    /// The value of a parameter.
    fn value(&self, element: &Element, kind: &str) -> Result<Value> {
        let text = self.required(element, "value")?;
        let not = |what: &str| self.wrong(element, &format!("the value {text:?} is not {what}"));
        match kind {
            "Real" => {
                let number = self.number(element, "value")?.unwrap_or_default();
                // the variable's unit is known later
                Ok(match element.text("unit") {
                    Some(unit) => Value::Text(format!("{number:?} {unit}")),
                    None => Value::Real(number),
                })
            }
            "Integer" => text.trim().parse().map(Value::Integer).map_err(|_| not("a whole number")),
            "Boolean" => match text.trim() {
                "true" | "1" => Ok(Value::Boolean(true)),
                "false" | "0" => Ok(Value::Boolean(false)),
                _ => Err(not("true or false")),
            },
            "String" | "Enumeration" => Ok(Value::Text(text)),
            _ => Err(self.wrong(element, "parameters of this type are not supported")),
        }
    }

    /// The component that an element with this path belongs to, if not to the system.
    fn owner(&self, path: &[&str]) -> Option<usize> {
        path.contains(&"Component").then(|| self.plan.components.len().checked_sub(1)).flatten()
    }

    /// Notes a parameter of a component, or, without one, of the one that its name begins with. The last one of a name
    /// counts; see `finish`.
    fn assign(
        &mut self,
        owner: Option<usize>,
        value: Value,
        place: String,
    ) -> std::result::Result<(), String> {
        let name = self.parameter.clone();
        match owner {
            Some(owner) => {
                if let Some(component) = self.plan.components.get_mut(owner) {
                    component.set.push(Assignment { variable: name, value, place });
                }
            }
            None => {
                let port: PortName = name
                    .parse()
                    .map_err(|e| format!("{e}; a parameter of the system itself is not supported"))?;
                let variable = port.variable.clone();
                self.bindings.push((port, Assignment { variable, value, place }));
            }
        }
        Ok(())
    }

    fn connection(&mut self, element: &Element) -> Result<()> {
        let owner = |attribute: &str| element.text(attribute).map(str::to_owned);
        let keep_units = match element.text("suppressUnitConversion") {
            None | Some("false" | "0") => false,
            Some("true" | "1") => true,
            Some(other) => {
                return Err(self.wrong(
                    element,
                    &format!("suppressUnitConversion is {other:?}; true or false is needed"),
                ));
            }
        };
        self.connections.push(Link {
            start: (owner("startElement"), self.required(element, "startConnector")?),
            end: (owner("endElement"), self.required(element, "endConnector")?),
            transfer: Transfer { keep_units, ..Transfer::default() },
            place: self.place(element),
        });
        Ok(())
    }

    fn finish(mut self) -> Result<Plan> {
        for link in std::mem::take(&mut self.connections) {
            self.link(link)?;
        }
        let mut components: HashMap<String, usize> = HashMap::new();
        for (i, component) in self.plan.components.iter().enumerate() {
            components.entry(component.name.clone()).or_insert(i);
        }
        for (port, assignment) in std::mem::take(&mut self.bindings) {
            let component = components.get(&port.component).and_then(|i| self.plan.components.get_mut(*i));
            let component = component.ok_or_else(|| {
                Error::file(format!("{}: there is no component {:?}", assignment.place, port.component))
            })?;
            component.set.push(assignment);
        }
        for component in &mut self.plan.components {
            let mut seen = HashSet::new();
            let mut kept: Vec<Assignment> = Vec::new();
            for assignment in std::mem::take(&mut component.set).into_iter().rev() {
                if seen.insert(assignment.variable.clone()) {
                    kept.push(assignment);
                }
            }
            kept.reverse();
            component.set = kept;
        }
        for (component, hint) in &self.hints {
            if self.plan.step.is_some_and(|step| step != *hint) {
                self.plan.warnings.push(format!(
                    "{}: the step size hint {hint} s of {component} is not used: all components communicate at the same points",
                    self.file
                ));
            }
        }
        self.plan.source = self.file;
        Ok(self.plan)
    }

    /// Adds a connection in the direction in which the value goes.
    fn link(&mut self, link: Link) -> Result<()> {
        let Link { start, end, transfer, place } = link;
        let kind = |(owner, name): &(Option<String>, String)| {
            let key = (owner.clone().unwrap_or_default(), name.clone());
            self.kinds.get(&key).cloned().ok_or_else(|| {
                Error::file(format!(
                    "{place}: {} has no connector {name:?}",
                    owner.as_deref().unwrap_or("the system")
                ))
            })
        };
        let (start_kind, end_kind) = (kind(&start)?, kind(&end)?);
        let (start, end) = match (start_kind.as_str(), end_kind.as_str()) {
            ("input", "output") if start.0.is_some() && end.0.is_some() => (end, start),
            _ => (start, end),
        };
        match (start, end) {
            ((Some(from), out), (Some(to), input)) => {
                let from = PortName { component: from, variable: out };
                let to = PortName { component: to, variable: input };
                self.plan.connections.push(PlannedConnection { from, to, transfer, place });
            }
            ((None, outer), (Some(owner), inner)) | ((Some(owner), inner), (None, outer)) => {
                self.plan.warnings.push(format!(
                    "{place}: the system's own connector {outer:?} is not used: nothing is outside, and {owner}.{inner} is recorded under its own name"
                ));
            }
            ((None, _), (None, _)) => {
                return Err(Error::file(format!(
                    "{place}: a connection of the system with itself is not supported"
                )));
            }
        }
        Ok(())
    }
}

/// The path as one below the folder that it is relative to; `None` if it leads out of it, or would on another system.
fn inside(path: &str) -> Option<PathBuf> {
    if path.contains(['\0', '\\', ':']) || path.starts_with('/') {
        return None;
    }
    let mut parts: Vec<&str> = Vec::new();
    for part in path.split('/') {
        match part {
            "" | "." => {}
            ".." => drop(parts.pop()?),
            part => parts.push(part),
        }
    }
    Some(parts.iter().collect())
}

/// A name without its prefix.
fn local(name: &str) -> &str {
    name.rsplit(':').next().unwrap_or(name)
}

/// The byte that two hexadecimal digits stand for.
fn path_byte(digits: &[u8]) -> Option<u8> {
    let text = std::str::from_utf8(digits.get(..2)?).ok()?;
    u8::from_str_radix(text, 16).ok()
}
