//! The rules on modelDescription.xml that no schema expresses.

mod structure;
mod structured_names;

use super::finding::{Finding, Level, Place};
use super::schema::{CAUSALITIES, INITIALS, VARIABILITIES};
use super::tree::Node;
use std::collections::{BTreeMap, HashMap, HashSet};

/// A ScalarVariable with FMI's defaults filled in. Values that the schema does not know are left out:
/// they have been found there.
struct Variable<'a> {
    node: &'a Node,
    name: &'a str,
    reference: Option<u32>,
    causality: &'a str,
    variability: &'a str,
    /// As written.
    initial: Option<&'a str>,
    /// The element for the type.
    kind: Option<&'a Node>,
}

impl<'a> Variable<'a> {
    fn new(node: &'a Node) -> Self {
        let word = |name: &str, words: &[&str], default: &'a str| match node.text(name) {
            Some(value) if words.contains(&value) => value,
            _ => default,
        };
        Self {
            node,
            name: node.text("name").unwrap_or("?"),
            reference: number(node, "valueReference"),
            causality: word("causality", CAUSALITIES, "local"),
            variability: word("variability", VARIABILITIES, "continuous"),
            initial: node.text("initial").filter(|i| INITIALS.contains(i)),
            kind: node
                .children
                .iter()
                .find(|c| matches!(c.name(), "Real" | "Integer" | "Boolean" | "String" | "Enumeration")),
        }
    }

    fn base(&self) -> &str {
        self.kind.map_or("", Node::name)
    }

    fn start(&self) -> Option<&'a str> {
        self.kind.and_then(|k| k.text("start"))
    }

    /// The words for `initial` that the standard allows, the default first; none where it forbids the
    /// attribute.
    fn allowed_initials(&self) -> &'static [&'static str] {
        match (self.causality, self.variability) {
            ("input" | "independent", _) => &[],
            ("parameter", _) | (_, "constant") => &["exact"],
            ("calculatedParameter", _) | ("local", "fixed" | "tunable") => &["calculated", "approx"],
            _ => &["calculated", "exact", "approx"],
        }
    }

    /// How the variable starts, with the default.
    fn initial(&self) -> Option<&'a str> {
        let allowed = self.allowed_initials();
        self.initial.filter(|i| allowed.contains(i)).or(allowed.first().copied())
    }

    fn place(&self) -> Option<Place> {
        Some(Place::tag(&self.node.element))
    }

    fn at(&self, attribute: &str) -> Option<Place> {
        at(self.node, attribute)
    }

    fn at_kind(&self, attribute: &str) -> Option<Place> {
        self.kind.map_or_else(|| self.place(), |k| at(k, attribute))
    }
}

fn at(node: &Node, attribute: &str) -> Option<Place> {
    Some(Place::attribute(&node.element, attribute))
}

fn number<T: std::str::FromStr>(node: &Node, attribute: &str) -> Option<T> {
    node.text(attribute).and_then(|t| t.trim().parse().ok())
}

fn flag(node: &Node, attribute: &str) -> bool {
    matches!(node.text(attribute).map(str::trim), Some("true" | "1"))
}

/// Units and display units by name: there may be as many of them as of variables.
struct Units<'a> {
    names: HashSet<&'a str>,
    display: HashSet<(&'a str, &'a str)>,
}

impl<'a> Units<'a> {
    fn new(units: &[&'a Node]) -> Self {
        let mut known = Self { names: HashSet::new(), display: HashSet::new() };
        for unit in units {
            // of two with one name, which is a fault by itself, the first
            let Some(name) = unit.text("name").filter(|name| known.names.insert(name)) else { continue };
            known.display.extend(unit.all("DisplayUnit").filter_map(|d| Some((name, d.text("name")?))));
        }
        known
    }
}

/// Checks all rules.
pub(super) fn check(root: &Node, findings: &mut Vec<Finding>) {
    let list = |section: &str, element| -> Vec<&Node> {
        root.child(section).map(|s| s.all(element).collect()).unwrap_or_default()
    };
    let variables: Vec<Variable> =
        list("ModelVariables", "ScalarVariable").into_iter().map(Variable::new).collect();
    let types = list("TypeDefinitions", "SimpleType");
    let units = list("UnitDefinitions", "Unit");
    check_head(root, findings);
    check_experiment(root, findings);
    check_names(root, &variables, &types, &units, findings);
    let units = Units::new(&units);
    check_types(&types, &units, findings);
    let items: HashSet<(*const Node, i32)> = (types.iter().flat_map(|t| &t.children))
        .flat_map(|kind| {
            kind.all("Item").filter_map(move |i| Some((std::ptr::from_ref(kind), number(i, "value")?)))
        })
        .collect();
    let types: HashMap<&str, &Node> = types.iter().filter_map(|t| Some((t.text("name")?, *t))).collect();
    let co_simulation_only = root.child("ModelExchange").is_none();
    for variable in &variables {
        check_variable(variable, co_simulation_only, findings);
        check_kind(variable, &types, &items, &units, findings);
        check_derivative(variable, &variables, findings);
    }
    check_independent(&variables, findings);
    check_aliases(&variables, findings);
    if root.text("variableNamingConvention") == Some("structured") {
        structured_names::check(&variables, findings);
    }
    structure::check(root, &variables, findings);
}

fn check_head(root: &Node, findings: &mut Vec<Finding>) {
    match root.text("fmiVersion") {
        Some("2.0") | None => {}
        Some(other) => findings.push(Finding::error(
            "X1",
            at(root, "fmiVersion"),
            format!("fmiVersion is {other:?}; \"2.0\" is written for all versions 2.0.x"),
        )),
    }
    if root.text("guid").is_some_and(|guid| guid.trim().is_empty()) {
        findings.push(Finding::error(
            "X3",
            at(root, "guid"),
            "the guid is empty, so it tells no versions apart",
        ));
    }
    let mut parts = 0;
    for part in root.children.iter().filter(|c| matches!(c.name(), "ModelExchange" | "CoSimulation")) {
        parts += 1;
        if let Some(identifier) = part.text("modelIdentifier")
            && !is_c_identifier(identifier)
        {
            findings.push(Finding::error(
                "X2",
                at(part, "modelIdentifier"),
                format!("the modelIdentifier {identifier:?} is no C identifier"),
            ));
        }
        if flag(part, "canSerializeFMUstate") && !flag(part, "canGetAndSetFMUstate") {
            findings.push(Finding::error(
                "M7",
                at(part, "canSerializeFMUstate"),
                "canSerializeFMUstate is true, but canGetAndSetFMUstate is not",
            ));
        }
    }
    if parts > 0 && root.child("CoSimulation").is_none() {
        findings.push(Finding::warning(
            "CS",
            root.child("ModelExchange").map(|m| Place::tag(&m.element)),
            "there is no <CoSimulation>, so only what can be seen without running the FMU is checked",
        ));
    }
}

fn is_c_identifier(text: &str) -> bool {
    !text.is_empty()
        && !text.starts_with(|c: char| c.is_ascii_digit())
        && text.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_')
}

fn check_experiment(root: &Node, findings: &mut Vec<Finding>) {
    let Some(experiment) = root.child("DefaultExperiment") else { return };
    let value = |name: &str| number::<f64>(experiment, name);
    let start = value("startTime").unwrap_or(0.0);
    if let Some(stop) = value("stopTime")
        && stop <= start
    {
        let what = format!("stopTime = {stop} is not after startTime = {start}");
        // A run of no length is possible, if of little use.
        let level = if stop < start { Level::Error } else { Level::Warning };
        findings.push(Finding::new(level, "X18", at(experiment, "stopTime"), what));
    }
    for name in ["stepSize", "tolerance"] {
        if let Some(value) = value(name)
            && value <= 0.0
        {
            let what = format!("{name} = {value} is not positive");
            findings.push(Finding::error("X18", at(experiment, name), what));
        }
    }
}

/// Reports names that occur twice among `nodes`.
fn check_unique<'a>(
    rule: &str,
    what: &str,
    nodes: impl IntoIterator<Item = &'a Node>,
    findings: &mut Vec<Finding>,
) {
    let mut seen = HashSet::new();
    for node in nodes {
        if let Some(name) = node.text("name")
            && !seen.insert(name)
        {
            findings.push(Finding::error(
                rule,
                at(node, "name"),
                format!("there is a second {what} {name:?}"),
            ));
        }
    }
}

fn check_names(
    root: &Node,
    variables: &[Variable],
    types: &[&Node],
    units: &[&Node],
    findings: &mut Vec<Finding>,
) {
    check_unique("X12", "variable", variables.iter().map(|v| v.node), findings);
    check_unique("X12", "type", types.iter().copied(), findings);
    check_unique("X12", "unit", units.iter().copied(), findings);
    for unit in units {
        let name = unit.text("name").unwrap_or("?");
        check_unique("X12", &format!("display unit of {name:?}"), unit.all("DisplayUnit"), findings);
    }
    for (section, element, what, rule) in [
        ("LogCategories", "Category", "log category", "L1"),
        ("VendorAnnotations", "Tool", "vendor annotation of", "X12"),
    ] {
        if let Some(section) = root.child(section) {
            check_unique(rule, what, section.all(element), findings);
        }
    }
    for part in root.all("ModelExchange").chain(root.all("CoSimulation")) {
        if let Some(files) = part.child("SourceFiles") {
            check_unique("X12", "source file", files.all("File"), findings);
        }
    }
    for variable in variables {
        if let Some(annotations) = variable.node.child("Annotations") {
            let what = format!("annotation of {:?} by", variable.name);
            check_unique("X12", &what, annotations.all("Tool"), findings);
        }
    }
    let names: HashSet<&str> = variables.iter().map(|v| v.name).collect();
    for node in types {
        if let Some(name) = node.text("name")
            && names.contains(name)
        {
            findings.push(Finding::error(
                "X12",
                at(node, "name"),
                format!("the type {name:?} has the name of a variable"),
            ));
        }
    }
}

fn check_types(types: &[&Node], units: &Units, findings: &mut Vec<Finding>) {
    for node in types {
        let name = node.text("name").unwrap_or("?");
        for kind in &node.children {
            check_limits(&format!("the type {name:?}"), kind, None, findings);
            check_units(&format!("the type {name:?}"), kind, None, units, findings);
            if kind.name() != "Enumeration" {
                continue;
            }
            check_unique("X13", &format!("item of {name:?} called"), kind.all("Item"), findings);
            let mut values = HashSet::new();
            for item in kind.all("Item") {
                if let Some(value) = number::<i32>(item, "value")
                    && !values.insert(value)
                {
                    let what = format!("two items of {name:?} have the value {value}");
                    findings.push(Finding::error("X13", at(item, "value"), what));
                }
            }
        }
    }
}

/// A number of the element, or else of its declared type.
fn inherited(kind: &Node, declared: Option<&Node>, name: &str) -> Option<f64> {
    match kind.text(name) {
        Some(text) => text.trim().parse().ok(),
        None => declared.and_then(|d| number(d, name)),
    }
}

fn check_limits(who: &str, kind: &Node, declared: Option<&Node>, findings: &mut Vec<Finding>) {
    let min = inherited(kind, declared, "min");
    let max = inherited(kind, declared, "max");
    if let (Some(min), Some(max)) = (min, max)
        && min > max
    {
        let attribute = if kind.text("max").is_some() { "max" } else { "min" };
        let what = format!("{who}: min = {min} is greater than max = {max}");
        findings.push(Finding::error("X17", at(kind, attribute), what));
        return;
    }
    let Some(start) = number::<f64>(kind, "start") else { return };
    if min.is_some_and(|min| start < min) || max.is_some_and(|max| start > max) {
        let limit = |v: Option<f64>| v.map_or("none".to_owned(), |v| v.to_string());
        let what =
            format!("{who}: start = {start} is outside its limits: min {}, max {}", limit(min), limit(max));
        findings.push(Finding::error("X17", at(kind, "start"), what));
    }
}

fn check_units(who: &str, kind: &Node, declared: Option<&Node>, units: &Units, findings: &mut Vec<Finding>) {
    let unit = kind.text("unit");
    if let Some(unit) = unit
        && !units.names.contains(unit)
    {
        let what = format!("{who}: UnitDefinitions has no unit {unit:?}");
        findings.push(Finding::error("X12", at(kind, "unit"), what));
        return;
    }
    let Some(display) = kind.text("displayUnit") else { return };
    let what = match unit.or_else(|| declared.and_then(|d| d.text("unit"))) {
        None => format!("{who}: there is a displayUnit, but no unit"),
        Some(unit) if units.names.contains(unit) && !units.display.contains(&(unit, display)) => {
            format!("{who}: the unit {unit:?} has no DisplayUnit {display:?}")
        }
        Some(_) => return,
    };
    findings.push(Finding::error("X12", at(kind, "displayUnit"), what));
}

fn check_variable(v: &Variable, co_simulation_only: bool, findings: &mut Vec<Finding>) {
    let name = v.name;
    let not_real = v.kind.is_some() && v.base() != "Real";
    let allowed: &[&str] = match v.causality {
        "parameter" | "calculatedParameter" => &["fixed", "tunable"],
        "input" => &["discrete", "continuous"],
        "output" => &["constant", "discrete", "continuous"],
        "independent" => &["continuous"],
        _ => VARIABILITIES,
    };
    let fits = allowed.contains(&v.variability);
    if !fits {
        let default = if v.node.text("variability").is_none() { " (the default)" } else { "" };
        findings.push(Finding::error(
            "X5",
            v.at("variability"),
            format!(
                "{name:?} has the causality {} and the variability {}{default}; {} is allowed",
                v.causality,
                v.variability,
                allowed.join(" or ")
            ),
        ));
    } else if not_real && v.variability == "continuous" && v.causality != "independent" {
        let default = if v.node.text("variability").is_none() { ", by default" } else { "" };
        findings.push(Finding::error(
            "X4",
            v.at("variability"),
            format!("{name:?} is {} and continuous{default}; only Real variables are continuous", v.base()),
        ));
    }
    // What follows depends on both; one finding about a wrong combination is enough.
    let initials = v.allowed_initials();
    if fits
        && let Some(initial) = v.initial
        && !initials.contains(&initial)
    {
        let kind = format!("{} {}", v.variability, v.causality);
        let what = match initials {
            [] => format!("{name:?} is an {}, which has no attribute initial", v.causality),
            words => {
                format!("{name:?} is a {kind}; initial is {initial:?}, allowed is {}", words.join(" or "))
            }
        };
        findings.push(Finding::error("X6", v.at("initial"), what));
    } else if fits && v.kind.is_some() {
        let needed = v.causality == "input" || matches!(v.initial(), Some("exact" | "approx"));
        let who = match (v.causality, v.initial()) {
            ("input" | "parameter", _) => format!("the {} {name:?}", v.causality),
            (causality, Some(initial)) => format!("the {causality} {name:?}, whose initial is {initial},"),
            (causality, None) => format!("the {causality} variable {name:?}"),
        };
        match v.start() {
            None if needed => {
                let place = v.kind.map(|k| Place::tag(&k.element));
                findings.push(Finding::error("X7", place, format!("{who} has no start value")));
            }
            // An independent variable with a start breaks the rule on these.
            Some(_) if !needed && v.causality != "independent" => {
                findings.push(Finding::error(
                    "X7",
                    v.at_kind("start"),
                    format!("{who} has a start value, which is forbidden"),
                ));
            }
            _ => {}
        }
    }
    if co_simulation_only {
        let multiple = "canHandleMultipleSetPerTimeInstant";
        if v.node.text(multiple).is_some() {
            let what = format!("{name:?} has the attribute {multiple}, which is for model exchange");
            findings.push(Finding::error("X15", v.at(multiple), what));
        }
        if v.kind.is_some_and(|k| k.text("reinit").is_some()) {
            let what = format!("{name:?} has the attribute reinit, which is for model exchange");
            findings.push(Finding::error("X15", v.at_kind("reinit"), what));
        }
    }
}

fn check_kind(
    v: &Variable,
    types: &HashMap<&str, &Node>,
    items: &HashSet<(*const Node, i32)>,
    units: &Units,
    findings: &mut Vec<Finding>,
) {
    let Some(kind) = v.kind else { return };
    let mut declared = None;
    if let Some(name) = kind.text("declaredType") {
        let fault = match types.get(name) {
            None => Some(format!(
                "{:?} has the declaredType {name:?}, which TypeDefinitions does not have",
                v.name
            )),
            Some(node) => {
                declared = node.children.iter().find(|c| c.name() == kind.name());
                let other = node.children.first().map_or("nothing", Node::name);
                declared
                    .is_none()
                    .then(|| format!("{:?} is {}, its declaredType {name:?} is {other}", v.name, kind.name()))
            }
        };
        if let Some(what) = fault {
            findings.push(Finding::error("X17", v.at_kind("declaredType"), what));
            return;
        }
    }
    check_limits(&format!("{:?}", v.name), kind, declared, findings);
    check_units(&format!("{:?}", v.name), kind, declared, units, findings);
    if kind.name() == "Enumeration"
        && let (Some(declared), Some(start)) = (declared, number::<i32>(kind, "start"))
        && !items.contains(&(std::ptr::from_ref(declared), start))
    {
        let what = format!("{:?} starts with {start}, which is the value of no item of its type", v.name);
        findings.push(Finding::error("X13", v.at_kind("start"), what));
    }
}

fn check_derivative(v: &Variable, variables: &[Variable], findings: &mut Vec<Finding>) {
    let Some(index) = v.kind.and_then(|k| number::<usize>(k, "derivative")) else { return };
    let state = index.checked_sub(1).and_then(|i| variables.get(i));
    let what = match state {
        None => format!("{:?} is the derivative of variable {index}; there are {}", v.name, variables.len()),
        Some(state) if state.base() != "Real" || state.variability != "continuous" => {
            format!("{:?} is the derivative of {:?}, which is no continuous Real", v.name, state.name)
        }
        Some(state) if std::ptr::eq(state, v) => format!("{:?} is its own derivative", v.name),
        Some(_) => return,
    };
    findings.push(Finding::error("X9", v.at_kind("derivative"), what));
}

fn check_independent(variables: &[Variable], findings: &mut Vec<Finding>) {
    let mut independent = variables.iter().filter(|v| v.causality == "independent");
    if let Some(v) = independent.next() {
        if v.kind.is_some() && v.base() != "Real" {
            let what = format!("the independent variable {:?} is {}, not Real", v.name, v.base());
            findings.push(Finding::error("X8", v.place(), what));
        }
        if v.start().is_some() {
            let what = format!("the independent variable {:?} has a start value", v.name);
            findings.push(Finding::error("X8", v.at_kind("start"), what));
        }
    }
    for v in independent {
        let what = format!("{:?} is a second independent variable; one is allowed", v.name);
        findings.push(Finding::error("X8", v.at("causality"), what));
    }
}

fn check_aliases(variables: &[Variable], findings: &mut Vec<Finding>) {
    let mut sets: BTreeMap<(&str, u32), Vec<&Variable>> = BTreeMap::new();
    for v in variables {
        // Enumerations are read and written with the functions for integers.
        let base = if v.base() == "Enumeration" { "Integer" } else { v.base() };
        if let Some(reference) = v.reference {
            sets.entry((base, reference)).or_default().push(v);
        }
    }
    for ((_, reference), set) in sets {
        let mut report = |v: &Variable, what: String| {
            findings.push(Finding::error("X14", v.at("valueReference"), what));
        };
        let settable: Vec<_> = set.iter().filter(|v| matches!(v.causality, "input" | "parameter")).collect();
        if let [first, others @ ..] = settable.as_slice() {
            for v in others {
                let what = format!(
                    "{:?} and {:?} can both be set and share the value reference {reference}",
                    first.name, v.name
                );
                report(v, what);
            }
            if !others.is_empty() {
                continue;
            }
        }
        let constants = set.iter().filter(|v| v.variability == "constant").count();
        if constants > 0 && constants < set.len() {
            let names: Vec<_> = set.iter().map(|v| v.name).collect();
            report(set[1], format!("{} share a value reference, but not all are constant", names.join(", ")));
            continue;
        }
        let started: Vec<_> = set.iter().filter(|v| v.start().is_some()).collect();
        if let [first, others @ ..] = started.as_slice() {
            for v in others {
                if constants == 0 {
                    report(v, format!("{:?} and its alias {:?} both have a start value", v.name, first.name));
                } else if v.start() != first.start() {
                    report(v, format!("the constant {:?} and its alias {:?} differ", v.name, first.name));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
