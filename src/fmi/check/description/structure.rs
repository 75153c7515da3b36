//! The rules on ModelStructure: outputs, derivatives, initial unknowns, and what they depend on.

use super::super::finding::{Finding, Place};
use super::super::tree::Node;
use super::{Variable, at, flag, number};
use std::collections::{BTreeSet, HashSet};

/// The indices in a section of ModelStructure that point to variables, with their places.
fn unknowns<'a>(
    section: Option<&'a Node>,
    count: usize,
    findings: &mut Vec<Finding>,
    rule: &str,
) -> Vec<(usize, &'a Node)> {
    let mut list: Vec<(usize, &Node)> = Vec::new();
    let mut seen = HashSet::new();
    let Some(section) = section else { return list };
    for node in section.all("Unknown") {
        let Some(index) = number::<usize>(node, "index") else { continue };
        let what = if index == 0 || index > count {
            format!("{} lists variable {index}; the variables are numbered 1 to {count}", section.name())
        } else if !seen.insert(index) {
            format!("{} lists variable {index} twice", section.name())
        } else {
            list.push((index, node));
            continue;
        };
        findings.push(Finding::error(rule, at(node, "index"), what));
    }
    list
}

/// Checks what the section lists against the variables.
pub(super) fn check(root: &Node, variables: &[Variable], findings: &mut Vec<Finding>) {
    let Some(structure) = root.child("ModelStructure") else { return };
    let count = variables.len();
    let named = |index: usize| format!("{index} ({:?})", variables[index - 1].name);

    let outputs = unknowns(structure.child("Outputs"), count, findings, "X9");
    for (index, node) in &outputs {
        let v = &variables[index - 1];
        if v.causality != "output" {
            let what =
                format!("Outputs lists variable {}, whose causality is {}", named(*index), v.causality);
            findings.push(Finding::error("X9", at(node, "index"), what));
        }
    }
    let listed: HashSet<usize> = outputs.iter().map(|(index, _)| *index).collect();
    for (i, v) in variables.iter().enumerate() {
        if v.causality == "output" && !listed.contains(&(i + 1)) {
            let what = format!("Outputs does not list the output {}", named(i + 1));
            findings.push(Finding::error("X9", v.at("causality"), what));
        }
    }

    let derivatives = unknowns(structure.child("Derivatives"), count, findings, "X9");
    let mut states = BTreeSet::new();
    for (index, node) in &derivatives {
        let state: Option<usize> = variables[index - 1].kind.and_then(|k| number(k, "derivative"));
        match state {
            Some(state) if (1..=count).contains(&state) => states.extend([state, *index]),
            _ => {
                let what = format!("Derivatives lists variable {}, which is no derivative", named(*index));
                findings.push(Finding::error("X9", at(node, "index"), what));
            }
        }
    }

    let uncertain = |index: usize| matches!(variables[index - 1].initial(), Some("approx" | "calculated"));
    states.retain(|index| uncertain(*index));
    // Where nothing uses the derivatives, co-simulation ignores them: their absence is no fault then.
    let used = root.child("ModelExchange").is_some()
        || root.child("CoSimulation").is_some_and(|c| flag(c, "providesDirectionalDerivative"));
    let mut needed: BTreeSet<usize> = (1..=count)
        .filter(|i| match variables[i - 1].causality {
            "output" => uncertain(*i),
            causality => causality == "calculatedParameter",
        })
        .collect();
    let mut allowed = needed.clone();
    allowed.extend(&states);
    if used {
        needed.extend(&states);
    }
    let section = structure.child("InitialUnknowns");
    let listed = unknowns(section, count, findings, "X10");
    for (index, node) in &listed {
        if !allowed.contains(index) {
            let v = &variables[index - 1];
            let what = format!(
                "InitialUnknowns lists variable {}, a {} {} that is {}: it is not unknown",
                named(*index),
                v.variability,
                v.causality,
                v.initial().unwrap_or("given")
            );
            findings.push(Finding::error("X10", at(node, "index"), what));
        }
    }
    let there: BTreeSet<usize> = listed.iter().map(|(index, _)| *index).collect();
    let missing: Vec<String> = needed.difference(&there).map(|i| named(*i)).collect();
    if !missing.is_empty() {
        let place = Place::tag(&section.unwrap_or(structure).element);
        let what = format!("InitialUnknowns does not list {}", missing.join(", "));
        findings.push(Finding::error("X10", Some(place), what));
    }
    if let Some(pair) = listed.windows(2).find(|pair| pair[0].0 > pair[1].0) {
        let what = format!(
            "InitialUnknowns is not sorted: variable {} comes after {}",
            named(pair[1].0),
            named(pair[0].0)
        );
        findings.push(Finding::error("X10", at(pair[1].1, "index"), what));
    }

    for (section, list) in
        [("Outputs", &outputs), ("Derivatives", &derivatives), ("InitialUnknowns", &listed)]
    {
        for (index, node) in list {
            check_dependencies(section, *index, node, count, findings);
        }
    }
}

fn check_dependencies(section: &str, index: usize, node: &Node, count: usize, findings: &mut Vec<Finding>) {
    let mut report = |attribute: &str, what: String| {
        let what = format!("{section}, variable {index}: {what}");
        findings.push(Finding::error("X11", at(node, attribute), what));
    };
    let dependencies: Option<Vec<usize>> = match node.text("dependencies") {
        None => None,
        Some(text) => match text.split_ascii_whitespace().map(str::parse).collect() {
            Ok(list) => Some(list),
            // The schema says so already.
            Err(_) => return,
        },
    };
    if let Some(list) = &dependencies {
        if let Some(wrong) = list.iter().find(|i| **i == 0 || **i > count) {
            report("dependencies", format!("it depends on variable {wrong}; there are 1 to {count}"));
        }
        if let Some(pair) = list.windows(2).find(|pair| pair[0] >= pair[1]) {
            let what = format!("the dependencies are not sorted: {} comes after {}", pair[1], pair[0]);
            report("dependencies", what);
        }
    }
    let Some(kinds) = node.text("dependenciesKind") else { return };
    let kinds: Vec<&str> = kinds.split_ascii_whitespace().collect();
    match &dependencies {
        None => report("dependenciesKind", "there are kinds of dependencies, but no dependencies".into()),
        Some(list) if list.len() != kinds.len() => report(
            "dependenciesKind",
            format!("there are {} dependencies, but {} kinds of them", list.len(), kinds.len()),
        ),
        Some(_) => {}
    }
    if section == "InitialUnknowns"
        && let Some(kind) = kinds.iter().find(|k| matches!(**k, "fixed" | "tunable" | "discrete"))
    {
        report("dependenciesKind", format!("the kind {kind:?} has no meaning in the initialization"));
    }
}
