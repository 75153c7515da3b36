//! The schema of modelDescription.xml as a table: elements with their order, attributes with their types.

use super::finding::{Finding, Place};
use super::tree::Node;

/// What an attribute holds.
enum Kind {
    Text,
    Real,
    Int,
    Unsigned,
    Boolean,
    /// A point in time, such as 2026-01-31T12:00:00Z.
    Time,
    Word(&'static [&'static str]),
    Numbers,
    Words(&'static [&'static str]),
}

struct Attribute {
    name: &'static str,
    kind: Kind,
    required: bool,
}

/// A place in the order of children that holds elements of any of some names.
struct Slot {
    elements: &'static [(&'static str, &'static Type)],
    least: usize,
    most: usize,
}

struct Type {
    attributes: &'static [Attribute],
    slots: &'static [Slot],
    /// Anything may be inside: the data of other tools.
    open: bool,
}

const MANY: usize = usize::MAX;

const fn must(name: &'static str, kind: Kind) -> Attribute {
    Attribute { name, kind, required: true }
}
const fn may(name: &'static str, kind: Kind) -> Attribute {
    Attribute { name, kind, required: false }
}
const fn slot(elements: &'static [(&'static str, &'static Type)], least: usize, most: usize) -> Slot {
    Slot { elements, least, most }
}
const fn list(slots: &'static [Slot]) -> Type {
    Type { attributes: &[], slots, open: false }
}
const fn leaf(attributes: &'static [Attribute]) -> Type {
    Type { attributes, slots: &[], open: false }
}

const KINDS: &[&str] = &["dependent", "constant", "fixed", "tunable", "discrete"];
pub(super) const CAUSALITIES: &[&str] =
    &["parameter", "calculatedParameter", "input", "output", "local", "independent"];
pub(super) const VARIABILITIES: &[&str] = &["constant", "fixed", "tunable", "discrete", "continuous"];
pub(super) const INITIALS: &[&str] = &["exact", "approx", "calculated"];

static FILE: Type = leaf(&[must("name", Kind::Text)]);
static FILES: Type = list(&[slot(&[("File", &FILE)], 1, MANY)]);
static MODEL_EXCHANGE: Type = Type {
    attributes: &[
        must("modelIdentifier", Kind::Text),
        may("needsExecutionTool", Kind::Boolean),
        may("completedIntegratorStepNotNeeded", Kind::Boolean),
        may("canBeInstantiatedOnlyOncePerProcess", Kind::Boolean),
        may("canNotUseMemoryManagementFunctions", Kind::Boolean),
        may("canGetAndSetFMUstate", Kind::Boolean),
        may("canSerializeFMUstate", Kind::Boolean),
        may("providesDirectionalDerivative", Kind::Boolean),
    ],
    slots: &[slot(&[("SourceFiles", &FILES)], 0, 1)],
    open: false,
};
static CO_SIMULATION: Type = Type {
    attributes: &[
        must("modelIdentifier", Kind::Text),
        may("needsExecutionTool", Kind::Boolean),
        may("canHandleVariableCommunicationStepSize", Kind::Boolean),
        may("canInterpolateInputs", Kind::Boolean),
        may("maxOutputDerivativeOrder", Kind::Unsigned),
        may("canRunAsynchronuously", Kind::Boolean),
        may("canBeInstantiatedOnlyOncePerProcess", Kind::Boolean),
        may("canNotUseMemoryManagementFunctions", Kind::Boolean),
        may("canGetAndSetFMUstate", Kind::Boolean),
        may("canSerializeFMUstate", Kind::Boolean),
        may("providesDirectionalDerivative", Kind::Boolean),
    ],
    slots: &[slot(&[("SourceFiles", &FILES)], 0, 1)],
    open: false,
};
static BASE_UNIT: Type = leaf(&[
    may("kg", Kind::Int),
    may("m", Kind::Int),
    may("s", Kind::Int),
    may("A", Kind::Int),
    may("K", Kind::Int),
    may("mol", Kind::Int),
    may("cd", Kind::Int),
    may("rad", Kind::Int),
    may("factor", Kind::Real),
    may("offset", Kind::Real),
]);
static DISPLAY_UNIT: Type =
    leaf(&[must("name", Kind::Text), may("factor", Kind::Real), may("offset", Kind::Real)]);
static UNIT: Type = Type {
    attributes: &[must("name", Kind::Text)],
    slots: &[slot(&[("BaseUnit", &BASE_UNIT)], 0, 1), slot(&[("DisplayUnit", &DISPLAY_UNIT)], 0, MANY)],
    open: false,
};
static UNITS: Type = list(&[slot(&[("Unit", &UNIT)], 1, MANY)]);
static ANY: Type = Type { attributes: &[], slots: &[], open: true };
static REAL_TYPE: Type = leaf(&[
    may("quantity", Kind::Text),
    may("unit", Kind::Text),
    may("displayUnit", Kind::Text),
    may("relativeQuantity", Kind::Boolean),
    may("min", Kind::Real),
    may("max", Kind::Real),
    may("nominal", Kind::Real),
    may("unbounded", Kind::Boolean),
]);
static INTEGER_TYPE: Type =
    leaf(&[may("quantity", Kind::Text), may("min", Kind::Int), may("max", Kind::Int)]);
static ITEM: Type =
    leaf(&[must("name", Kind::Text), must("value", Kind::Int), may("description", Kind::Text)]);
static ENUMERATION_TYPE: Type = Type {
    attributes: &[may("quantity", Kind::Text)],
    slots: &[slot(&[("Item", &ITEM)], 1, MANY)],
    open: false,
};
static SIMPLE_TYPE: Type = Type {
    attributes: &[must("name", Kind::Text), may("description", Kind::Text)],
    slots: &[slot(
        &[
            ("Real", &REAL_TYPE),
            ("Integer", &INTEGER_TYPE),
            ("Boolean", &ANY),
            ("String", &ANY),
            ("Enumeration", &ENUMERATION_TYPE),
        ],
        1,
        1,
    )],
    open: false,
};
static TYPES: Type = list(&[slot(&[("SimpleType", &SIMPLE_TYPE)], 1, MANY)]);
static CATEGORY: Type = leaf(&[must("name", Kind::Text), may("description", Kind::Text)]);
static CATEGORIES: Type = list(&[slot(&[("Category", &CATEGORY)], 1, MANY)]);
static EXPERIMENT: Type = leaf(&[
    may("startTime", Kind::Real),
    may("stopTime", Kind::Real),
    may("tolerance", Kind::Real),
    may("stepSize", Kind::Real),
]);
static TOOL: Type = Type { attributes: &[must("name", Kind::Text)], slots: &[], open: true };
static ANNOTATIONS: Type = list(&[slot(&[("Tool", &TOOL)], 1, MANY)]);
static REAL: Type = leaf(&[
    may("declaredType", Kind::Text),
    may("quantity", Kind::Text),
    may("unit", Kind::Text),
    may("displayUnit", Kind::Text),
    may("relativeQuantity", Kind::Boolean),
    may("min", Kind::Real),
    may("max", Kind::Real),
    may("nominal", Kind::Real),
    may("unbounded", Kind::Boolean),
    may("start", Kind::Real),
    may("derivative", Kind::Unsigned),
    may("reinit", Kind::Boolean),
]);
static INTEGER: Type = leaf(&[
    may("declaredType", Kind::Text),
    may("quantity", Kind::Text),
    may("min", Kind::Int),
    may("max", Kind::Int),
    may("start", Kind::Int),
]);
static BOOLEAN: Type = leaf(&[may("declaredType", Kind::Text), may("start", Kind::Boolean)]);
static STRING: Type = leaf(&[may("declaredType", Kind::Text), may("start", Kind::Text)]);
static ENUMERATION: Type = leaf(&[
    must("declaredType", Kind::Text),
    may("quantity", Kind::Text),
    may("min", Kind::Int),
    may("max", Kind::Int),
    may("start", Kind::Int),
]);
static VARIABLE: Type = Type {
    attributes: &[
        must("name", Kind::Text),
        must("valueReference", Kind::Unsigned),
        may("description", Kind::Text),
        may("causality", Kind::Word(CAUSALITIES)),
        may("variability", Kind::Word(VARIABILITIES)),
        may("initial", Kind::Word(INITIALS)),
        may("canHandleMultipleSetPerTimeInstant", Kind::Boolean),
    ],
    slots: &[
        slot(
            &[
                ("Real", &REAL),
                ("Integer", &INTEGER),
                ("Boolean", &BOOLEAN),
                ("String", &STRING),
                ("Enumeration", &ENUMERATION),
            ],
            1,
            1,
        ),
        slot(&[("Annotations", &ANNOTATIONS)], 0, 1),
    ],
    open: false,
};
static VARIABLES: Type = list(&[slot(&[("ScalarVariable", &VARIABLE)], 1, MANY)]);
static UNKNOWN: Type = leaf(&[
    must("index", Kind::Unsigned),
    may("dependencies", Kind::Numbers),
    may("dependenciesKind", Kind::Words(KINDS)),
]);
static UNKNOWNS: Type = list(&[slot(&[("Unknown", &UNKNOWN)], 1, MANY)]);
static STRUCTURE: Type = list(&[
    slot(&[("Outputs", &UNKNOWNS)], 0, 1),
    slot(&[("Derivatives", &UNKNOWNS)], 0, 1),
    slot(&[("InitialUnknowns", &UNKNOWNS)], 0, 1),
]);
static ROOT: Type = Type {
    attributes: &[
        must("fmiVersion", Kind::Text),
        must("modelName", Kind::Text),
        must("guid", Kind::Text),
        may("description", Kind::Text),
        may("author", Kind::Text),
        may("version", Kind::Text),
        may("copyright", Kind::Text),
        may("license", Kind::Text),
        may("generationTool", Kind::Text),
        may("generationDateAndTime", Kind::Time),
        may("variableNamingConvention", Kind::Word(&["flat", "structured"])),
        may("numberOfEventIndicators", Kind::Unsigned),
    ],
    slots: &[
        slot(&[("ModelExchange", &MODEL_EXCHANGE), ("CoSimulation", &CO_SIMULATION)], 1, 2),
        slot(&[("UnitDefinitions", &UNITS)], 0, 1),
        slot(&[("TypeDefinitions", &TYPES)], 0, 1),
        slot(&[("LogCategories", &CATEGORIES)], 0, 1),
        slot(&[("DefaultExperiment", &EXPERIMENT)], 0, 1),
        slot(&[("VendorAnnotations", &ANNOTATIONS)], 0, 1),
        slot(&[("ModelVariables", &VARIABLES)], 1, 1),
        slot(&[("ModelStructure", &STRUCTURE)], 1, 1),
    ],
    open: false,
};

/// Compares the whole description with the schema.
pub(super) fn check(root: &Node, findings: &mut Vec<Finding>) {
    if root.name() != "fmiModelDescription" {
        findings.push(Finding::error(
            "XSD",
            Some(Place::tag(&root.element)),
            format!("the outermost element is <{}>; <fmiModelDescription> is needed", root.name()),
        ));
        return;
    }
    check_element(root, &ROOT, findings);
    for kind in ["ModelExchange", "CoSimulation"] {
        if let Some(second) = root.all(kind).nth(1) {
            wrong(findings, second, format!("there is a second <{kind}>; one is allowed"));
        }
    }
}

fn wrong(findings: &mut Vec<Finding>, node: &Node, what: String) {
    findings.push(Finding::error("XSD", Some(Place::tag(&node.element)), what));
}

fn check_element(node: &Node, shape: &'static Type, findings: &mut Vec<Finding>) {
    let name = node.name();
    for attribute in node.element.attributes() {
        // Namespaces and the location of the schema may stand anywhere.
        if attribute.name.starts_with("xmlns") || attribute.name.starts_with("xsi:") || shape.open {
            continue;
        }
        let mut fault = |rule, what| {
            let place = Place::attribute(&node.element, &attribute.name);
            findings.push(Finding::error(rule, Some(place), what));
        };
        let Some(known) = shape.attributes.iter().find(|a| a.name == attribute.name) else {
            fault(
                "XSD",
                format!("<{name}> has no attribute {}{}", attribute.name, near(&attribute.name, shape)),
            );
            continue;
        };
        match faulty(&known.kind, &attribute.value) {
            Some(Fault::Type(needed)) => fault(
                "XSD",
                format!("<{name}>: {} is {:?}; {needed} is needed", attribute.name, attribute.value),
            ),
            Some(Fault::NotFinite) => fault(
                "D8",
                format!(
                    "<{name}>: {} is {}; a description holds finite numbers only",
                    attribute.name, attribute.value
                ),
            ),
            None => {}
        }
    }
    for attribute in shape.attributes.iter().filter(|a| a.required && node.text(a.name).is_none()) {
        wrong(findings, node, format!("<{name}>: the attribute {} is missing", attribute.name));
    }
    if shape.open {
        return;
    }
    // Which slot the children have reached, and how many are in it.
    let (mut current, mut count) = (0, 0);
    for child in &node.children {
        let found = shape.slots.iter().enumerate().find_map(|(i, slot)| {
            slot.elements.iter().find(|(element, _)| *element == child.name()).map(|(_, shape)| (i, *shape))
        });
        let Some((index, inner)) = found else {
            wrong(findings, child, format!("<{name}> has no element <{}>", child.name()));
            continue;
        };
        if index < current {
            let before = shape.slots[current].elements[0].0;
            wrong(
                findings,
                child,
                format!("<{}> is at the wrong place in <{name}>: it belongs before <{before}>", child.name()),
            );
        } else {
            if index > current {
                (current, count) = (index, 0);
            }
            count += 1;
            if count == shape.slots[index].most.saturating_add(1) {
                wrong(findings, child, format!("<{name}> has too many elements <{}>", child.name()));
            }
        }
        check_element(child, inner, findings);
    }
    for slot in shape.slots {
        let there =
            node.children.iter().filter(|c| slot.elements.iter().any(|(e, _)| *e == c.name())).count();
        if there < slot.least {
            let names: Vec<String> = slot.elements.iter().map(|(e, _)| format!("<{e}>")).collect();
            wrong(findings, node, format!("<{name}> has no {}", names.join(" or ")));
        }
    }
}

/// A hint at an attribute with a similar name.
fn near(name: &str, shape: &Type) -> String {
    shape
        .attributes
        .iter()
        .map(|a| (strsim::jaro_winkler(&name.to_lowercase(), &a.name.to_lowercase()), a.name))
        .filter(|(score, _)| *score > 0.85)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| format!("; did you mean {name}?"))
        .unwrap_or_default()
}

enum Fault {
    /// What is needed instead.
    Type(String),
    NotFinite,
}

fn faulty(kind: &Kind, value: &str) -> Option<Fault> {
    let text = value.trim();
    let needed = |good: bool, what: &str| (!good).then(|| Fault::Type(what.to_owned()));
    let one_of = |words: &[&str]| format!("one of {}", words.join(", "));
    match kind {
        Kind::Text => None,
        Kind::Real => match text {
            "NaN" | "INF" | "-INF" => Some(Fault::NotFinite),
            // Rust reads also "inf" and "infinity", which no schema knows.
            _ if text.contains(|c: char| c.is_ascii_alphabetic() && !matches!(c, 'e' | 'E')) => {
                needed(false, "a number")
            }
            _ => match text.parse::<f64>() {
                Ok(number) if number.is_finite() => None,
                Ok(_) => Some(Fault::NotFinite),
                Err(_) => needed(false, "a number"),
            },
        },
        Kind::Int => needed(text.parse::<i32>().is_ok(), "a whole number of 32 bits"),
        Kind::Unsigned => needed(text.parse::<u32>().is_ok(), "a whole number from 0 to 4294967295"),
        Kind::Boolean => needed(matches!(text, "true" | "false" | "0" | "1"), "true or false"),
        Kind::Time => needed(is_time(text), "a time such as 2026-01-31T12:00:00Z"),
        Kind::Word(words) => needed(words.contains(&value), &one_of(words)),
        Kind::Numbers => needed(
            text.split_ascii_whitespace().all(|n| n.parse::<u32>().is_ok()),
            "a list of whole numbers with spaces between",
        ),
        Kind::Words(words) => needed(
            text.split_ascii_whitespace().all(|w| words.contains(&w)),
            &format!("a list with each {}", one_of(words)),
        ),
    }
}

/// True for xs:dateTime, as far as its form goes.
fn is_time(text: &str) -> bool {
    let Some((date, time)) = text.split_once('T') else { return false };
    let digits = |part: &str, count: usize| part.len() == count && part.bytes().all(|b| b.is_ascii_digit());
    let date: Vec<&str> = date.trim_start_matches('-').split('-').collect();
    let clock = time.strip_suffix('Z').unwrap_or_else(|| match time.rfind(['+', '-']) {
        Some(i) if digits(time[i + 1..].split(':').next().unwrap_or(""), 2) && time.len() == i + 6 => {
            &time[..i]
        }
        _ => time,
    });
    let clock: Vec<&str> = clock.split(':').collect();
    let [year, month, day] = date.as_slice() else { return false };
    let [hour, minute, second] = clock.as_slice() else { return false };
    let (whole, fraction) = second.split_once('.').unwrap_or((second, "0"));
    year.len() >= 4
        && digits(year, year.len())
        && [month, day, hour, minute].iter().all(|part| digits(part, 2))
        && digits(whole, 2)
        && !fraction.is_empty()
        && digits(fraction, fraction.len())
}

#[cfg(test)]
mod tests {
    use super::is_time;

    #[test]
    fn knows_times() {
        for good in ["2026-01-31T12:00:00Z", "2026-01-31T12:00:00", "2026-01-31T12:00:00.25+01:00"] {
            assert!(is_time(good), "{good}");
        }
        for bad in
            ["", "2026-01-31", "yesterday", "2026-1-31T12:00:00Z", "2026-01-31T12:00Z", "26-01-31T12:00:00"]
        {
            assert!(!is_time(bad), "{bad}");
        }
    }
}
