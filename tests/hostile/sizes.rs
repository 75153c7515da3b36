//! Files that are long in one way. The sizes are such that work that grows with the square of the length takes minutes,
//! and work that grows with the length a second at most.

use super::{in_time, rig, xml};
use latsch::cosimulate::{parse_ssd, parse_toml};
use latsch::fmi::check::static_findings;
use latsch::fmi::import::Description;
use latsch::model::{Settings, Slave};
use latsch::recording::parse_csv;
use latsch::{Error, ErrorKind};
use std::fmt::Write;
use std::path::Path;

/// More than any message may have.
const LONG: usize = 2000;

/// What an error says, which somebody has to be able to read.
fn message(error: &Error) -> String {
    let message = error.to_string();
    assert!(message.len() <= LONG, "{} bytes", message.len());
    assert!(!message.chars().any(char::is_control), "{message:?}");
    message
}

/// `count` pieces of text one after the other.
fn many(count: usize, piece: impl Fn(usize) -> String) -> String {
    (0..count).fold(String::new(), |mut text, i| {
        text += &piece(i);
        text
    })
}

fn described(types: &str, units: &str, variables: &str, outputs: &str) -> String {
    format!(
        "<fmiModelDescription fmiVersion=\"2.0\" modelName=\"m\" guid=\"g\"><CoSimulation modelIdentifier=\"m\"/>\
         <UnitDefinitions>{units}</UnitDefinitions><TypeDefinitions>{types}</TypeDefinitions>\
         <ModelVariables>{variables}</ModelVariables>\
         <ModelStructure><Outputs>{outputs}</Outputs></ModelStructure></fmiModelDescription>"
    )
}

fn variables(count: usize, kind: &str) -> String {
    many(count, |i| {
        format!(
            "<ScalarVariable name=\"v{i}\" valueReference=\"{i}\" causality=\"output\">{kind}</ScalarVariable>"
        )
    })
}

#[test]
fn elements_with_many_attributes_are_refused() {
    let attributes = many(1_000_000, |i| format!(" a{i}=\"\""));
    let text = format!("<fmiModelDescription{attributes}/>");
    let error = in_time(|| Description::parse(text.as_bytes())).unwrap_err();
    assert!(message(&error).contains("more than 1000 attributes"), "{error}");
    let text = xml().replace("guid=", "twice=\"1\" twice=\"2\" guid=");
    let error = Description::parse(text.as_bytes()).unwrap_err();
    assert!(message(&error).contains("the attribute twice twice"), "{error}");
}

#[test]
fn enumerations_with_many_items_are_read() {
    let items = many(200_000, |i| format!("<Item name=\"i{i}\" value=\"{}\"/>", i + 1));
    let types = format!("<SimpleType name=\"T\"><Enumeration>{items}</Enumeration></SimpleType>");
    let text = described(&types, "", &variables(1, "<Enumeration declaredType=\"T\"/>"), "");
    in_time(|| Description::parse(text.as_bytes())).unwrap();
    // each variable has a copy: 200 GB
    let text = described(&types, "", &variables(10_000, "<Enumeration declaredType=\"T\"/>"), "");
    let error = in_time(|| Description::parse(text.as_bytes())).unwrap_err();
    assert!(message(&error).contains("from their types"), "{error}");
    // so has each of a unit
    let unit = "x".repeat(1_000_000);
    let types = format!("<SimpleType name=\"T\"><Real unit=\"{unit}\"/></SimpleType>");
    let text = described(&types, "", &variables(10_000, "<Real declaredType=\"T\"/>"), "");
    let error = in_time(|| Description::parse(text.as_bytes())).unwrap_err();
    assert!(message(&error).contains("from their types"), "{error}");
}

#[test]
fn types_with_long_names_are_read() {
    let items = many(100_000, |i| format!("<Item name=\"i{i}\" value=\"{}\"/>", i + 1));
    let name = "n".repeat(10_000_000);
    let types = format!("<SimpleType name=\"{name}\"><Enumeration>{items}</Enumeration></SimpleType>");
    let text = described(&types, "", &variables(1, "<Real/>"), "");
    in_time(|| Description::parse(text.as_bytes())).unwrap();
}

#[test]
fn what_is_wrong_everywhere_in_a_long_line_is_found_in_time() {
    let wrong = variables(100_000, "<Real/><Wrong/>");
    let findings = in_time(|| static_findings(described("", "", &wrong, "").as_bytes()));
    assert!(findings.len() >= 100_000);
    let lines = in_time(|| static_findings(described("", "", &wrong.replace("><", ">\n<"), "").as_bytes()));
    assert_eq!(lines.len(), findings.len());
}

#[test]
fn units_types_and_outputs_are_found_in_time() {
    const COUNT: usize = 60_000;
    let units = many(COUNT, |i| format!("<Unit name=\"u{i}\"/>"));
    let displays = many(COUNT, |i| format!("<DisplayUnit name=\"d{i}\"/>"));
    let units = format!("{units}<Unit name=\"u\">{displays}</Unit>");
    let items = many(COUNT, |i| format!("<Item name=\"i{i}\" value=\"{}\"/>", i + 1));
    let types = format!("<SimpleType name=\"T\"><Enumeration>{items}</Enumeration></SimpleType>");
    let last = COUNT - 1;
    let mut all = variables(COUNT, &format!("<Real unit=\"u\" displayUnit=\"d{last}\"/>"));
    all += &variables(COUNT, &format!("<Enumeration declaredType=\"T\" start=\"{COUNT}\"/>"))
        .replace("\"v", "\"e");
    let outputs = many(2 * COUNT, |i| format!("<Unknown index=\"{}\"/>", i + 1));
    let text = described(&types, &units, &all, &outputs);
    let findings = in_time(|| static_findings(text.as_bytes()));
    for rule in ["X12", "X13", "X9"] {
        assert!(!findings.iter().any(|f| f.rule == rule), "{rule}");
    }
    let text = text.replace(&format!("\"d{last}\"/></Scalar"), "\"dd\"/></Scalar");
    let wrong = in_time(|| static_findings(text.as_bytes()));
    assert_eq!(wrong.iter().filter(|f| f.rule == "X12").count(), COUNT);
}

#[test]
fn long_texts_do_not_make_long_messages() {
    let name = format!("\u{1b}[2J\n{}\u{202e}", "x".repeat(10_000_000)).replace('\u{1b}', "&#x9b;");
    let twice = variables(1, "<Real/>").replace("v0", &name).repeat(2);
    let text = described("", "", &twice, "");
    let error = in_time(|| Description::parse(text.as_bytes())).unwrap_err();
    assert!(message(&error).contains("there are two variables with the name"), "{error}");
    for finding in in_time(|| static_findings(text.as_bytes())) {
        assert!(finding.what.len() <= LONG && finding.as_text().len() <= 2 * LONG, "{}", finding.rule);
        assert!(!finding.as_text().chars().any(|c| c != '\n' && c.is_control()), "{:?}", finding.as_text());
    }
    let long = "y".repeat(10_000_000);
    let error = in_time(|| rig().interface().find(&long)).unwrap_err();
    assert!(message(&error).contains("has no variable"), "{error}");
    let error = parse_csv(&format!("time [s],{long}\n"), "r.csv").unwrap_err();
    assert!(message(&error).starts_with("r.csv:1:"), "{error}");
}

#[test]
fn settings_with_many_names_are_read() {
    let text = format!("[parameters]\n{}", many(300_000, |i| format!("k{i} = 1\n")));
    let settings = in_time(|| Settings::parse(&text, "s.toml")).unwrap();
    assert_eq!(settings.values.len(), 300_000);
    let last = settings.values.iter().find(|s| s.name == "k299999").unwrap();
    assert_eq!(last.place, "s.toml:300001");
    let mut table = rig().interface().clone();
    let pattern = table.variables.iter().find(|v| v.name == "belt_mass").unwrap().clone();
    table.variables.extend((0..300_000).map(|i| latsch::model::VariableInfo {
        name: format!("k{i}"),
        min: None,
        max: None,
        ..pattern.clone()
    }));
    assert_eq!(in_time(|| settings.check(&table)).unwrap().len(), 300_000);
}

#[test]
fn systems_with_many_parts_are_read() {
    let mut text = many(100_000, |i| format!("[component.c{i}]\nmodel = \"m\"\nset = {{ a = 1 }}\n"));
    text += "[connect]\n";
    text += &many(100_000, |i| format!("\"c{i}.y\" = \"c{i}.u\"\n"));
    let plan = in_time(|| parse_toml(&text, "s.toml", Path::new(""))).unwrap();
    assert_eq!((plan.components.len(), plan.connections.len()), (100_000, 100_000));
    assert_eq!(plan.connections[99_999].place, "s.toml:400001");
}

fn ssd(components: &str, connections: &str) -> String {
    format!(
        "<SystemStructureDescription version=\"1.0\"><System><Elements>{components}</Elements>\
         <Connections>{connections}</Connections></System></SystemStructureDescription>"
    )
}

#[test]
fn descriptions_of_systems_with_many_parts_are_read() {
    const COUNT: usize = 60_000;
    let wire = "<Connection startElement=\"a\" startConnector=\"y\" endElement=\"b\" endConnector=\"u\"/>";
    let part = |name: &str, inside: &str| {
        format!("<Component name=\"{name}\" source=\"x.fmu\">{inside}</Component>")
    };
    let port = |name: &str, kind: &str| format!("<Connector name=\"{name}\" kind=\"{kind}\"/>");
    let parameters =
        many(COUNT, |i| format!("<Parameter name=\"p{}\"><Real value=\"{i}\"/></Parameter>", i % 50_000));
    let bound = format!(
        "<ParameterBindings><ParameterBinding><ParameterValues><ParameterSet><Parameters>{parameters}</Parameters>\
         </ParameterSet></ParameterValues></ParameterBinding></ParameterBindings>"
    );
    let a = part("a", &format!("<Connectors>{}</Connectors>{bound}", port("y", "output")));
    let ports = port("u", "input") + &many(COUNT, |i| port(&format!("u{i}"), "input"));
    let b = part("b", &format!("<Connectors>{ports}</Connectors>"));
    let more = many(COUNT, |i| part(&format!("c{i}"), ""));
    let text = ssd(&(a + &b + &more), &wire.repeat(COUNT));
    let plan = in_time(|| parse_ssd(text.as_bytes(), "s.ssd", Path::new(""))).unwrap();
    assert_eq!((plan.components.len(), plan.connections.len()), (COUNT + 2, COUNT));
    let set = &plan.components[0].set;
    assert_eq!(set.len(), 50_000);
    // the last one of a name counts
    let last = set.iter().find(|a| a.variable == "p0").unwrap();
    assert_eq!(last.value, latsch::model::Value::Real(50_000.0));
}

#[test]
fn names_that_everything_repeats_are_short() {
    let name = "n".repeat(1_000_000);
    let ports = many(10_000, |i| format!("<Connector name=\"u{i}\" kind=\"input\"/>"));
    let part =
        format!("<Component name=\"{name}\" source=\"x.fmu\"><Connectors>{ports}</Connectors></Component>");
    let error = in_time(|| parse_ssd(ssd(&part, "").as_bytes(), "s.ssd", Path::new(""))).unwrap_err();
    assert!(message(&error).contains("no more than 1000"), "{error}");
}

#[test]
fn toml_that_is_deep_is_refused() {
    for text in [
        format!("a = {}", "[".repeat(1_000_000)),
        format!("a = {}{}", "[".repeat(100_000), "]".repeat(100_000)),
        format!("a = {}1{}", "{a=".repeat(100_000), "}".repeat(100_000)),
        format!("[{}a]", "a.".repeat(100_000)),
        format!("{}a = 1", "a.".repeat(100_000)),
        format!("[connect]\n\"a.b\" = {}{}", "[".repeat(100_000), "]".repeat(100_000)),
    ] {
        for error in [
            in_time(|| Settings::parse(&text, "s.toml")).unwrap_err(),
            in_time(|| parse_toml(&text, "s.toml", Path::new(""))).unwrap_err(),
        ] {
            assert!(message(&error).starts_with("s.toml:"), "{error}");
            assert_eq!(error.kind(), ErrorKind::File);
        }
    }
}

#[test]
fn rows_with_many_cells_are_refused() {
    for text in [
        format!("time [s]{}\n0\n", ",a [N]".repeat(1_000_000)),
        format!("time [s],a [N]\n0,1\n1{}\n", ",".repeat(20_000_000)),
    ] {
        let error = in_time(|| parse_csv(&text, "r.csv")).unwrap_err();
        assert!(message(&error).contains("no more than 100000"), "{error}");
    }
    // one long line without anything, and one of quotes
    for text in ["7".repeat(50_000_000), "\"\n".repeat(10_000_000), "\"".repeat(50_000_000)] {
        let error = in_time(|| parse_csv(&text, "r.csv")).unwrap_err();
        assert!(message(&error).starts_with("r.csv:"), "{error}");
    }
}

#[test]
fn recordings_with_many_channels_are_read() {
    let mut text = String::from("time [s]");
    for i in 0..50_000 {
        let _ = write!(text, ",c{i} [N]");
    }
    for row in 0..2 {
        let _ = write!(text, "\n{row}{}", ",1".repeat(50_000));
    }
    assert_eq!(in_time(|| parse_csv(&text, "r.csv")).unwrap().channels.len(), 50_000);
}
