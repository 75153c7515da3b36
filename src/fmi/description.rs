//! Writes `modelDescription.xml` from an interface.

use super::import::{ANNOTATIONS, Capabilities};
use super::log::CATEGORIES;
use crate::model::unit::{BASE, Unit};
use crate::model::{Causality, Initial, Interface, Kind, Purpose, Value, Variability, VariableInfo};
use crate::{Error, Result};
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesEnd, BytesStart, Event};
use std::collections::{BTreeSet, HashMap, HashSet};

/// The model identifier of a model: its name as a C identifier.
pub fn model_identifier(name: &str) -> String {
    let mut identifier: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if identifier.starts_with(|c: char| c.is_ascii_digit()) {
        identifier.insert(0, '_');
    }
    identifier
}

/// The description of a model for FMI 2.0 co-simulation. It depends on nothing but its arguments and
/// the version of the library.
///
/// # Errors
/// A variable with a unit that is not known.
pub fn model_description(interface: &Interface, guid: &str) -> Result<String> {
    describe(interface, guid, &capabilities_of(interface), Origin::Own)
}

/// What a native model with this interface can do. Outputs that are held between instants have no derivatives; a
/// model without others offers none.
pub(super) fn capabilities_of(interface: &Interface) -> Capabilities {
    let moves = |i: usize| interface.variables[i].variability == Variability::Continuous;
    Capabilities {
        provides_directional_derivatives: interface.directional_derivatives,
        max_output_derivative_order: u32::from(interface.with(Causality::Output).any(moves)),
        ..CAPABILITIES
    }
}

/// What native models can do.
pub const CAPABILITIES: Capabilities = Capabilities {
    needs_execution_tool: false,
    can_handle_variable_step: true,
    can_interpolate_inputs: true,
    max_output_derivative_order: 1,
    can_run_asynchronously: false,
    can_be_instantiated_once: false,
    can_not_use_memory_functions: true,
    can_get_and_set_state: true,
    can_serialize_state: true,
    provides_directional_derivatives: false,
};

/// Whose variables are described.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Origin {
    /// Ours: a unit that is not known is a mistake.
    Own,
    /// Those of any FMU: its units are passed on by name.
    Foreign,
}

/// As [`model_description`], of an FMU that can do what `capabilities` say.
pub(super) fn describe(
    interface: &Interface,
    guid: &str,
    capabilities: &Capabilities,
    origin: Origin,
) -> Result<String> {
    let mut xml = Xml::new();
    open_description(&mut xml, interface, "2.0", ("guid", guid), naming_convention(interface));
    let flag = |value: bool| if value { "true" } else { "false" };
    let identifier = model_identifier(&interface.name);
    let order = capabilities.max_output_derivative_order.to_string();
    let mut attributes = vec![("modelIdentifier", identifier.as_str())];
    if capabilities.needs_execution_tool {
        attributes.push(("needsExecutionTool", "true"));
    }
    attributes.extend([
        ("canHandleVariableCommunicationStepSize", flag(capabilities.can_handle_variable_step)),
        ("canInterpolateInputs", flag(capabilities.can_interpolate_inputs)),
        ("maxOutputDerivativeOrder", &order),
        ("canRunAsynchronuously", flag(capabilities.can_run_asynchronously)),
        ("canBeInstantiatedOnlyOncePerProcess", flag(capabilities.can_be_instantiated_once)),
        ("canNotUseMemoryManagementFunctions", flag(capabilities.can_not_use_memory_functions)),
        ("canGetAndSetFMUstate", flag(capabilities.can_get_and_set_state)),
        ("canSerializeFMUstate", flag(capabilities.can_serialize_state)),
        ("providesDirectionalDerivative", flag(capabilities.provides_directional_derivatives)),
    ]);
    xml.empty("CoSimulation", &attributes);
    write_units(&mut xml, interface, origin)?;
    let types = type_names(interface);
    write_types(&mut xml, interface, &types);
    write_categories_and_experiment(&mut xml, interface);
    write_meanings(&mut xml, interface);
    xml.open("ModelVariables", &[]);
    for variable in &interface.variables {
        write_variable(&mut xml, variable, &types);
    }
    xml.close("ModelVariables");
    write_structure(&mut xml, interface);
    xml.finish()
}

/// The first line and element, with what both versions of the standard have there.
pub(super) fn open_description(
    xml: &mut Xml,
    interface: &Interface,
    version: &str,
    guid: (&str, &str),
    convention: &str,
) {
    let _ = xml.writer.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)));
    xml.open(
        ROOT,
        &[
            ("fmiVersion", version),
            ("modelName", &interface.name),
            guid,
            ("description", &interface.description),
            ("version", crate::VERSION),
            ("generationTool", concat!("latsch ", env!("CARGO_PKG_VERSION"))),
            ("variableNamingConvention", convention),
        ],
    );
}

pub(super) fn write_categories_and_experiment(xml: &mut Xml, interface: &Interface) {
    xml.open("LogCategories", &[]);
    for (name, description) in CATEGORIES {
        xml.empty("Category", &[("name", name), ("description", description)]);
    }
    xml.close("LogCategories");
    xml.empty(
        "DefaultExperiment",
        &[
            ("startTime", &number(interface.start_time)),
            ("stopTime", &number(interface.stop_time)),
            ("stepSize", &number(interface.communication_step)),
        ],
    );
}

/// Structured, where all names are what parts and their prefixes make: C identifiers with points between them. Of other
/// names nothing is promised.
pub(super) fn naming_convention(interface: &Interface) -> &'static str {
    let is_identifier = |word: &str| {
        !word.is_empty()
            && !word.starts_with(|c: char| c.is_ascii_digit())
            && word.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_')
    };
    let structured = interface.variables.iter().all(|v| v.name.split('.').all(is_identifier));
    if structured { "structured" } else { "flat" }
}

/// What the author of the model says of its variables. FMI has no place of its own for that; whoever does not know
/// the tool's name passes it by.
fn write_meanings(xml: &mut Xml, interface: &Interface) {
    if interface.variables.iter().all(|v| v.meaning.is_none()) {
        return;
    }
    xml.open("VendorAnnotations", &[]);
    xml.open("Tool", &[("name", ANNOTATIONS)]);
    xml.open("Meanings", &[]);
    for (name, meaning) in interface.variables.iter().filter_map(|v| Some((&v.name, v.meaning?))) {
        let role = meaning.role.map(word).unwrap_or_default();
        let purpose = word(meaning.purpose);
        let mut attributes = vec![("name", name.as_str())];
        if !role.is_empty() {
            attributes.push(("role", &role));
        }
        if meaning.purpose != Purpose::default() {
            attributes.push(("purpose", &purpose));
        }
        if attributes.len() > 1 {
            xml.empty("Variable", &attributes);
        }
    }
    xml.close("Meanings");
    xml.close("Tool");
    xml.close("VendorAnnotations");
}

/// The word that stands for a role or purpose in files.
fn word(value: impl serde::Serialize) -> String {
    serde_json::to_value(value).ok().and_then(|v| v.as_str().map(Into::into)).unwrap_or_default()
}

/// The element that all of a description is in.
const ROOT: &str = "fmiModelDescription";

/// Elements and attributes; writing to memory does not fail.
pub(super) struct Xml {
    writer: Writer<Vec<u8>>,
}

impl Xml {
    pub(super) fn new() -> Self {
        Self { writer: Writer::new_with_indent(Vec::new(), b' ', 2) }
    }

    /// The text, when all but the first element is closed.
    pub(super) fn finish(mut self) -> Result<String> {
        self.close(ROOT);
        let text = String::from_utf8(self.writer.into_inner());
        text.map(|text| text + "\n").map_err(|_| Error::fmu("the model description is not UTF-8"))
    }

    fn start<'a>(name: &'a str, attributes: &[(&str, &str)]) -> BytesStart<'a> {
        BytesStart::new(name).with_attributes(attributes.iter().copied())
    }

    pub(super) fn open(&mut self, name: &str, attributes: &[(&str, &str)]) {
        let _ = self.writer.write_event(Event::Start(Self::start(name, attributes)));
    }

    pub(super) fn empty(&mut self, name: &str, attributes: &[(&str, &str)]) {
        let _ = self.writer.write_event(Event::Empty(Self::start(name, attributes)));
    }

    pub(super) fn close(&mut self, name: &str) {
        let _ = self.writer.write_event(Event::End(BytesEnd::new(name)));
    }
}

/// The shortest text that reads back as the same number.
pub(super) fn number(value: f64) -> String {
    format!("{value:?}")
}

pub(super) fn write_units(xml: &mut Xml, interface: &Interface, origin: Origin) -> Result<()> {
    let units: BTreeSet<&str> = interface.variables.iter().filter_map(|v| v.unit.as_deref()).collect();
    if units.is_empty() {
        return Ok(());
    }
    xml.open("UnitDefinitions", &[]);
    for name in units {
        let unit = match Unit::parse(name) {
            Ok(unit) => unit,
            Err(_) if origin == Origin::Foreign => {
                xml.empty("Unit", &[("name", name)]);
                continue;
            }
            Err(error) => return Err(error),
        };
        let mut attributes: Vec<(&str, String)> = BASE
            .iter()
            .zip(unit.exponents)
            .filter(|(_, exponent)| *exponent != 0)
            .map(|(base, exponent)| (*base, exponent.to_string()))
            .collect();
        if unit.factor != 1.0 {
            attributes.push(("factor", number(unit.factor)));
        }
        if unit.offset != 0.0 {
            attributes.push(("offset", number(unit.offset)));
        }
        let attributes: Vec<(&str, &str)> = attributes.iter().map(|(n, v)| (*n, v.as_str())).collect();
        xml.open("Unit", &[("name", name)]);
        xml.empty("BaseUnit", &attributes);
        xml.close("Unit");
    }
    xml.close("UnitDefinitions");
    Ok(())
}

/// Names of the types of the enumeration variables: `pressure_state` has the type `PressureState`. A name
/// that a variable or another type has already gets `Type` behind it.
pub(super) fn type_names(interface: &Interface) -> HashMap<&str, String> {
    let mut taken: HashSet<String> = interface.variables.iter().map(|v| v.name.clone()).collect();
    let mut names = HashMap::new();
    for variable in interface.variables.iter().filter(|v| matches!(v.kind, Kind::Enumeration(_))) {
        let mut name = String::new();
        for word in variable.name.split('_') {
            let mut letters = word.chars();
            name.extend(letters.next().map(|c| c.to_ascii_uppercase()));
            name.push_str(letters.as_str());
        }
        while !taken.insert(name.clone()) {
            name.push_str("Type");
        }
        names.insert(variable.name.as_str(), name);
    }
    names
}

fn write_types(xml: &mut Xml, interface: &Interface, types: &HashMap<&str, String>) {
    let enumerations: Vec<(&VariableInfo, &Vec<(String, String)>)> = interface
        .variables
        .iter()
        .filter_map(|v| match &v.kind {
            Kind::Enumeration(items) => Some((v, items)),
            _ => None,
        })
        .collect();
    if enumerations.is_empty() {
        return;
    }
    xml.open("TypeDefinitions", &[]);
    for (variable, items) in enumerations {
        let name = types.get(variable.name.as_str()).map_or("", String::as_str);
        xml.open("SimpleType", &[("name", name), ("description", &variable.description)]);
        xml.open("Enumeration", &[]);
        for (value, (name, description)) in (1..).zip(items) {
            let value: i32 = value;
            xml.empty("Item", &[("name", name), ("value", &value.to_string()), ("description", description)]);
        }
        xml.close("Enumeration");
        xml.close("SimpleType");
    }
    xml.close("TypeDefinitions");
}

fn write_variable(xml: &mut Xml, variable: &VariableInfo, types: &HashMap<&str, String>) {
    let mut details = Vec::new();
    let element = match &variable.kind {
        Kind::Real => "Real",
        Kind::Integer => "Integer",
        Kind::Boolean => "Boolean",
        Kind::Text => "String",
        Kind::Enumeration(_) => {
            details.push(("declaredType", types.get(variable.name.as_str()).cloned().unwrap_or_default()));
            "Enumeration"
        }
    };
    details.extend(unit_and_limits(variable));
    match &variable.start {
        Some(Value::Real(v)) => details.push(("start", number(*v))),
        Some(other) => details.push(("start", other.to_string())),
        None => {}
    }
    xml.open("ScalarVariable", &borrowed(&identity(variable)));
    xml.empty(element, &borrowed(&details));
    xml.close("ScalarVariable");
}

/// Attributes with their values.
pub(super) type Attributes = Vec<(&'static str, String)>;

pub(super) fn borrowed(list: &Attributes) -> Vec<(&str, &str)> {
    list.iter().map(|(n, v)| (*n, v.as_str())).collect()
}

/// What a variable is.
pub(super) fn identity(variable: &VariableInfo) -> Attributes {
    let mut attributes = vec![
        ("name", variable.name.clone()),
        ("valueReference", variable.reference.to_string()),
        ("description", variable.description.clone()),
        ("causality", causality(variable.causality).into()),
        ("variability", variability(variable.variability).into()),
    ];
    attributes.extend(variable.initial.map(|value| ("initial", initial(value).into())));
    attributes
}

/// What its values may be.
pub(super) fn unit_and_limits(variable: &VariableInfo) -> Attributes {
    let text = |limit: f64| if variable.is_real() { number(limit) } else { format!("{limit:.0}") };
    let limits = [("min", variable.min), ("max", variable.max), ("nominal", variable.nominal)];
    let limits = limits.into_iter().filter_map(|(name, limit)| Some((name, text(limit?))));
    variable.unit.clone().map(|unit| ("unit", unit)).into_iter().chain(limits).collect()
}

fn causality(value: Causality) -> &'static str {
    match value {
        Causality::Parameter => "parameter",
        Causality::CalculatedParameter => "calculatedParameter",
        Causality::Input => "input",
        Causality::Output => "output",
        Causality::Local => "local",
        Causality::Independent => "independent",
    }
}

fn variability(value: Variability) -> &'static str {
    match value {
        Variability::Constant => "constant",
        Variability::Fixed => "fixed",
        Variability::Tunable => "tunable",
        Variability::Discrete => "discrete",
        Variability::Continuous => "continuous",
    }
}

fn initial(value: Initial) -> &'static str {
    match value {
        Initial::Exact => "exact",
        Initial::Approx => "approx",
        Initial::Calculated => "calculated",
    }
}

/// Outputs and InitialUnknowns. Their dependencies are left out, which stands for "on everything":
/// every output starts from a stationary state that all inputs and parameters have a part in.
fn write_structure(xml: &mut Xml, interface: &Interface) {
    let outputs: Vec<usize> = interface.with(Causality::Output).collect();
    xml.open("ModelStructure", &[]);
    for (section, indices) in [("Outputs", outputs), ("InitialUnknowns", unknowns(interface))] {
        if indices.is_empty() {
            continue;
        }
        xml.open(section, &[]);
        for index in indices {
            xml.empty("Unknown", &[("index", &(index + 1).to_string())]);
        }
        xml.close(section);
    }
    xml.close("ModelStructure");
}

/// What an initialization has to find.
pub(super) fn unknowns(interface: &Interface) -> Vec<usize> {
    let is_unknown = |i: &usize| {
        let v = &interface.variables[*i];
        let calculated = matches!(v.initial, Some(Initial::Calculated | Initial::Approx));
        v.causality == Causality::CalculatedParameter || v.causality == Causality::Output && calculated
    };
    (0..interface.variables.len()).filter(is_unknown).collect()
}
