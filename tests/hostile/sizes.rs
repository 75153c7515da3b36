//! Files that are long in one way. What is judged is how the processor's time grows with the length, so that neither the
//! machine nor what else it does matters.

use super::{in_time, rig, xml};
use latsch::cosimulate::{parse_ssd, parse_toml};
use latsch::fmi::check::static_findings;
use latsch::fmi::import::Description;
use latsch::model::{Settings, Slave, Value, VariableInfo};
use latsch::recording::parse_csv;
use latsch::{Error, ErrorKind};
use std::fmt::Write;
use std::path::Path;

/// More than any message may have.
const LONG: usize = 2000;

/// The processor's time of this thread \[ns\]. The kernel counts it where the thread gives way: without that, work between
/// two ticks of its clock may count as none.
fn worked() -> u64 {
    std::thread::yield_now();
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    text.split(' ').next().unwrap().parse().unwrap()
}

/// Eight times the length may take eight times as long and a bit, for memory that is further away: less than 24 times.
/// With the square it is 64 times. `prepare` makes a file of a length and what is to be done with it, which alone counts.
fn grows_with_length<T: FnOnce()>(length: usize, prepare: impl Fn(usize) -> T) {
    let time = |length: usize| {
        let body = prepare(length);
        let begin = worked();
        body();
        (worked() - begin).max(1) as f64
    };
    // caches and page faults disturb a single comparison
    let ratios: Vec<f64> = (0..3).map(|_| time(8 * length) / time(length)).collect();
    assert!(ratios.iter().any(|r| *r < 24.0), "eight times the length takes {ratios:.1?} times as long");
}

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

fn enumeration(name: &str, count: usize) -> String {
    let items = many(count, |i| format!("<Item name=\"i{i}\" value=\"{}\"/>", i + 1));
    format!("<SimpleType name=\"{name}\"><Enumeration>{items}</Enumeration></SimpleType>")
}

#[test]
fn enumerations_with_many_items_are_read() {
    grows_with_length(5_000, |count| {
        let kind = "<Enumeration declaredType=\"T\"/>";
        let text = described(&enumeration("T", count), "", &variables(1, kind), "");
        move || drop(Description::parse(text.as_bytes()).unwrap())
    });
}

#[test]
fn what_each_variable_copies_is_limited() {
    let unit = "x".repeat(1_000_000);
    for (types, kind) in [
        // 20 GB
        (enumeration("T", 20_000), "<Enumeration declaredType=\"T\"/>"),
        // 10 GB
        (
            format!("<SimpleType name=\"T\"><Real unit=\"{unit}\"/></SimpleType>"),
            "<Real declaredType=\"T\"/>",
        ),
    ] {
        let text = described(&types, "", &variables(10_000, kind), "");
        let error = Description::parse(text.as_bytes()).unwrap_err();
        assert!(message(&error).contains("from their types"), "{error}");
    }
}

#[test]
fn types_with_long_names_are_read() {
    grows_with_length(500, |count| {
        let types = enumeration(&"n".repeat(100 * count), count);
        let text = described(&types, "", &variables(1, "<Real/>"), "");
        move || drop(Description::parse(text.as_bytes()).unwrap())
    });
}

#[test]
fn what_is_wrong_everywhere_in_a_long_line_is_found_in_time() {
    for line_end in ["", "\n"] {
        grows_with_length(500, |count| {
            let wrong = variables(count, &format!("<Real/>{line_end}<Wrong/>"));
            let text = described("", "", &wrong, "");
            move || assert!(static_findings(text.as_bytes()).len() >= count)
        });
    }
}

/// A description with as many of everything, whose variables have the last of each.
fn with_many_of_all(count: usize) -> String {
    let units = many(count, |i| format!("<Unit name=\"u{i}\"/>"));
    let displays = many(count, |i| format!("<DisplayUnit name=\"d{i}\"/>"));
    let units = format!("{units}<Unit name=\"u\">{displays}</Unit>");
    let mut all = variables(count, &format!("<Real unit=\"u\" displayUnit=\"d{}\"/>", count - 1));
    let kind = format!("<Enumeration declaredType=\"T\" start=\"{count}\"/>");
    all += &variables(count, &kind).replace("\"v", "\"e");
    let outputs = many(2 * count, |i| format!("<Unknown index=\"{}\"/>", i + 1));
    described(&enumeration("T", count), &units, &all, &outputs)
}

#[test]
fn units_types_and_outputs_are_found_in_time() {
    const COUNT: usize = 1000;
    grows_with_length(COUNT, |count| {
        let text = with_many_of_all(count);
        move || drop(static_findings(text.as_bytes()))
    });
    let text = with_many_of_all(COUNT);
    let count = |text: &str, rule: &str, word: &str| {
        static_findings(text.as_bytes()).iter().filter(|f| f.rule == rule && f.what.contains(word)).count()
    };
    for (from, to, rule, word) in [
        (format!("\"d{}\"/></Scalar", COUNT - 1), "\"dd\"/></Scalar", "X12", "DisplayUnit"),
        ("unit=\"u\"".into(), "unit=\"uu\"", "X12", "no unit"),
        (format!("start=\"{COUNT}\""), "start=\"0\"", "X13", "value of no item"),
    ] {
        assert_eq!(count(&text, rule, word), 0, "{word}");
        assert_eq!(count(&text.replace(&from, to), rule, word), COUNT, "{word}");
    }
    let outputs = text.replace("<Unknown index=\"7\"/>", "");
    assert_eq!(count(&outputs, "X9", "does not list the output 7"), 1);
}

#[test]
fn long_texts_do_not_make_long_messages() {
    let name = format!("\u{1b}[2J\n{}\u{202e}", "x".repeat(1_000_000)).replace('\u{1b}', "&#x9b;");
    let twice = variables(1, "<Real/>").replace("v0", &name).repeat(2);
    let text = described("", "", &twice, "");
    let error = in_time(|| Description::parse(text.as_bytes())).unwrap_err();
    assert!(message(&error).contains("there are two variables with the name"), "{error}");
    for finding in in_time(|| static_findings(text.as_bytes())) {
        assert!(finding.what.len() <= LONG && finding.as_text().len() <= 2 * LONG, "{}", finding.rule);
        assert!(!finding.as_text().chars().any(|c| c != '\n' && c.is_control()), "{:?}", finding.as_text());
    }
    let long = "y".repeat(1_000_000);
    let error = in_time(|| rig().interface().find(&long)).unwrap_err();
    assert!(message(&error).contains("has no variable"), "{error}");
    let error = parse_csv(&format!("time [s],{long}\n"), "r.csv").unwrap_err();
    assert!(message(&error).starts_with("r.csv:1:"), "{error}");
}

#[test]
fn settings_with_many_names_are_read() {
    let table = rig().interface().clone();
    let pattern = table.variables.iter().find(|v| v.name == "belt_mass").unwrap();
    let text = |count| format!("[parameters]\n{}", many(count, |i| format!("k{i} = 10\n")));
    grows_with_length(3_000, |count| {
        let text = text(count);
        let mut table = table.clone();
        table.variables.extend((0..count).map(|i| VariableInfo { name: format!("k{i}"), ..pattern.clone() }));
        move || {
            let settings = Settings::parse(&text, "s.toml").unwrap();
            assert_eq!(settings.check(&table).unwrap().len(), count);
        }
    });
    let settings = Settings::parse(&text(3000), "s.toml").unwrap();
    assert_eq!(settings.values.iter().find(|s| s.name == "k2999").unwrap().place, "s.toml:3001");
}

#[test]
fn systems_with_many_parts_are_read() {
    let text = |count| {
        let parts = many(count, |i| format!("[component.c{i}]\nmodel = \"m\"\nset = {{ a = 1 }}\n"));
        parts + "[connect]\n" + &many(count, |i| format!("\"c{i}.y\" = \"c{i}.u\"\n"))
    };
    grows_with_length(2_000, |count| {
        let text = text(count);
        move || {
            let plan = parse_toml(&text, "s.toml", Path::new("")).unwrap();
            assert_eq!((plan.components.len(), plan.connections.len()), (count, count));
        }
    });
    let plan = parse_toml(&text(2000), "s.toml", Path::new("")).unwrap();
    assert_eq!(plan.connections[1999].place, "s.toml:8001");
}

fn ssd(components: &str, connections: &str) -> String {
    format!(
        "<SystemStructureDescription version=\"1.0\"><System><Elements>{components}</Elements>\
         <Connections>{connections}</Connections></System></SystemStructureDescription>"
    )
}

/// A system with so many components, connectors, equal connections, and parameters of which the last ten are of names
/// that were there before.
fn large_system(count: usize) -> String {
    let wire = "<Connection startElement=\"a\" startConnector=\"y\" endElement=\"b\" endConnector=\"u\"/>";
    let part = |name: &str, inside: &str| {
        format!("<Component name=\"{name}\" source=\"x.fmu\">{inside}</Component>")
    };
    let port = |name: &str, kind: &str| format!("<Connector name=\"{name}\" kind=\"{kind}\"/>");
    let parameters = many(count, |i| {
        format!("<Parameter name=\"p{}\"><Real value=\"{i}\"/></Parameter>", i % (count - 10))
    });
    let bound = format!(
        "<ParameterBindings><ParameterBinding><ParameterValues><ParameterSet><Parameters>{parameters}</Parameters>\
         </ParameterSet></ParameterValues></ParameterBinding></ParameterBindings>"
    );
    let a = part("a", &format!("<Connectors>{}</Connectors>{bound}", port("y", "output")));
    let ports = port("u", "input") + &many(count, |i| port(&format!("u{i}"), "input"));
    let b = part("b", &format!("<Connectors>{ports}</Connectors>"));
    let more = many(count, |i| part(&format!("c{i}"), ""));
    ssd(&(a + &b + &more), &wire.repeat(count))
}

#[test]
fn descriptions_of_systems_with_many_parts_are_read() {
    const COUNT: usize = 1000;
    grows_with_length(COUNT, |count| {
        let text = large_system(count);
        move || drop(parse_ssd(text.as_bytes(), "s.ssd", Path::new("")).unwrap())
    });
    let plan = parse_ssd(large_system(COUNT).as_bytes(), "s.ssd", Path::new("")).unwrap();
    assert_eq!((plan.components.len(), plan.connections.len()), (COUNT + 2, COUNT));
    let set = &plan.components[0].set;
    assert_eq!(set.len(), COUNT - 10);
    // the last one of a name counts
    let last = set.iter().find(|a| a.variable == "p0").unwrap();
    assert_eq!(last.value, Value::Real((COUNT - 10) as f64));
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
        format!("time [s]{}\n0\n", ",a [N]".repeat(200_000)),
        format!("time [s],a [N]\n0,1\n1{}\n", ",".repeat(1_000_000)),
    ] {
        let error = in_time(|| parse_csv(&text, "r.csv")).unwrap_err();
        assert!(message(&error).contains("no more than 100000"), "{error}");
    }
    // one long line without anything, and one of quotes
    for text in ["7".repeat(2_000_000), "\"\n".repeat(1_000_000), "\"".repeat(2_000_000)] {
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
