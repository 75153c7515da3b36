//! Writes `modelDescription.xml` of FMI 3.0 from an interface.

use super::description::{
    Origin, Xml, borrowed, identity, model_identifier, naming_convention, number, open_description,
    type_names, unit_and_limits, unknowns, write_categories_and_experiment, write_units,
};
use super::import::Capabilities;
use super::instance::time_variable;
use crate::Result;
use crate::model::{Causality, Interface, Kind, Value, Variability, VariableInfo};
use std::collections::HashMap;

/// As [`model_description`](super::description::model_description), for FMI 3.0, of a model that can do what `capabilities` say. The
/// instantiation token is what FMI 2.0 calls GUID. The time is a variable more.
///
/// # Errors
/// A variable with a unit that is not known.
pub(super) fn model_description(
    interface: &Interface,
    token: &str,
    capabilities: &Capabilities,
) -> Result<String> {
    let mut interface = interface.clone();
    interface.variables.push(time(&interface));
    let mut xml = Xml::new();
    let convention = naming_convention(&interface);
    open_description(&mut xml, &interface, "3.0", ("instantiationToken", token), convention);
    let flag = |value: bool| if value { "true" } else { "false" };
    xml.empty(
        "CoSimulation",
        &[
            ("modelIdentifier", &model_identifier(&interface.name)),
            ("canHandleVariableCommunicationStepSize", flag(capabilities.can_handle_variable_step)),
            ("canGetAndSetFMUState", flag(capabilities.can_get_and_set_state)),
            ("canSerializeFMUState", flag(capabilities.can_serialize_state)),
            ("providesDirectionalDerivatives", flag(capabilities.provides_directional_derivatives)),
            ("maxOutputDerivativeOrder", &capabilities.max_output_derivative_order.to_string()),
            ("hasEventMode", "false"),
        ],
    );
    write_units(&mut xml, &interface, Origin::Own)?;
    let types = type_names(&interface);
    write_types(&mut xml, &interface, &types);
    write_categories_and_experiment(&mut xml, &interface);
    xml.open("ModelVariables", &[]);
    for variable in &interface.variables {
        write_variable(&mut xml, variable, &types);
    }
    xml.close("ModelVariables");
    xml.open("ModelStructure", &[]);
    let reference = |i: usize| interface.variables[i].reference.to_string();
    for output in interface.with(Causality::Output) {
        xml.empty("Output", &[("valueReference", &reference(output))]);
    }
    for unknown in unknowns(&interface) {
        xml.empty("InitialUnknown", &[("valueReference", &reference(unknown))]);
    }
    xml.close("ModelStructure");
    xml.finish()
}

/// The independent variable.
fn time(interface: &Interface) -> VariableInfo {
    let (name, reference) = time_variable(interface);
    VariableInfo {
        name,
        reference,
        description: "Time".into(),
        unit: Some("s".into()),
        kind: Kind::Real,
        causality: Causality::Independent,
        variability: Variability::Continuous,
        initial: None,
        start: None,
        min: None,
        max: None,
        nominal: None,
        meaning: None,
    }
}

fn write_types(xml: &mut Xml, interface: &Interface, types: &HashMap<&str, String>) {
    if types.is_empty() {
        return;
    }
    xml.open("TypeDefinitions", &[]);
    for variable in &interface.variables {
        let (Kind::Enumeration(items), Some(name)) = (&variable.kind, types.get(variable.name.as_str()))
        else {
            continue;
        };
        xml.open("EnumerationType", &[("name", name), ("description", &variable.description)]);
        for (value, (name, description)) in (1..).zip(items) {
            let value: i32 = value;
            xml.empty("Item", &[("name", name), ("value", &value.to_string()), ("description", description)]);
        }
        xml.close("EnumerationType");
    }
    xml.close("TypeDefinitions");
}

fn write_variable(xml: &mut Xml, variable: &VariableInfo, types: &HashMap<&str, String>) {
    let element = match &variable.kind {
        Kind::Real => "Float64",
        Kind::Integer => "Int32",
        Kind::Boolean => "Boolean",
        Kind::Text => "String",
        Kind::Enumeration(_) => "Enumeration",
    };
    let mut attributes = identity(variable);
    attributes.extend(types.get(variable.name.as_str()).map(|name| ("declaredType", name.clone())));
    attributes.extend(unit_and_limits(variable));
    // a text has its start value in an element of its own
    let mut text = None;
    match &variable.start {
        Some(Value::Real(start)) => attributes.push(("start", number(*start))),
        Some(Value::Text(start)) => text = Some(start),
        Some(other) => attributes.push(("start", other.to_string())),
        None => {}
    }
    let attributes = borrowed(&attributes);
    match text {
        Some(start) => {
            xml.open(element, &attributes);
            xml.empty("Start", &[("value", start)]);
            xml.close(element);
        }
        None => xml.empty(element, &attributes),
    }
}
