//! A valid description, changed in one place at a time: exactly the rule of that place is found.

use super::super::finding::Level;
use super::super::static_findings;
use super::structured_names::structured;

const GOOD: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="Hub" guid="{1}" generationDateAndTime="2026-01-31T12:00:00Z"
    variableNamingConvention="structured">
  <CoSimulation modelIdentifier="hub" canGetAndSetFMUstate="true" canSerializeFMUstate="true"
      canHandleVariableCommunicationStepSize="true" maxOutputDerivativeOrder="1">
    <SourceFiles><File name="a.c"/><File name="b.c"/></SourceFiles>
  </CoSimulation>
  <UnitDefinitions>
    <Unit name="N"><BaseUnit kg="1" m="1" s="-2"/><DisplayUnit name="kN" factor="0.001"/><DisplayUnit name="MN" factor="1e-6"/></Unit>
    <Unit name="m"><BaseUnit m="1"/></Unit>
  </UnitDefinitions>
  <TypeDefinitions>
    <SimpleType name="Force"><Real unit="N" displayUnit="kN" min="-100" max="100"/></SimpleType>
    <SimpleType name="Mode"><Enumeration><Item name="on" value="1"/><Item name="off" value="2"/></Enumeration></SimpleType>
  </TypeDefinitions>
  <LogCategories><Category name="logAll"/><Category name="logEvents"/></LogCategories>
  <DefaultExperiment startTime="1" stopTime="2" stepSize="0.1" tolerance="1e-4"/>
  <VendorAnnotations><Tool name="x"><Own thing="1"/></Tool><Tool name="y"/></VendorAnnotations>
  <ModelVariables>
    <ScalarVariable name="F" valueReference="0" causality="input"><Real declaredType="Force" start="0"/></ScalarVariable>
    <ScalarVariable name="y" valueReference="1" causality="output"><Real unit="m"/></ScalarVariable>
    <ScalarVariable name="z" valueReference="2" causality="output" initial="exact"><Real start="3" min="2"/></ScalarVariable>
    <ScalarVariable name="p" valueReference="3" causality="parameter" variability="fixed"><Real start="1"/></ScalarVariable>
    <ScalarVariable name="q" valueReference="4" causality="calculatedParameter" variability="fixed"><Real/></ScalarVariable>
    <ScalarVariable name="m" valueReference="5" causality="parameter" variability="tunable"><Enumeration declaredType="Mode" start="2"/></ScalarVariable>
    <ScalarVariable name="der(y)" valueReference="6"><Real derivative="2"/></ScalarVariable>
    <ScalarVariable name="a.b[1]" valueReference="7"><Real/></ScalarVariable>
    <ScalarVariable name="a.b[2]" valueReference="8"><Real/></ScalarVariable>
    <ScalarVariable name="k" valueReference="9" variability="constant"><Integer start="7"/></ScalarVariable>
    <ScalarVariable name="time" valueReference="10" causality="independent"><Real/></ScalarVariable>
    <ScalarVariable name="on" valueReference="11" variability="discrete"><Boolean/><Annotations><Tool name="x"/></Annotations></ScalarVariable>
    <ScalarVariable name="u" valueReference="12" causality="output" variability="discrete"><String/></ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs><Unknown index="2"/><Unknown index="3" dependencies="1 4" dependenciesKind="dependent fixed"/><Unknown index="13"/></Outputs>
    <Derivatives><Unknown index="7"/></Derivatives>
    <InitialUnknowns><Unknown index="2" dependencies=""/><Unknown index="5"/><Unknown index="7"/><Unknown index="13"/></InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
"#;

fn rules(text: &str) -> Vec<(&'static str, String)> {
    static_findings(text.as_bytes()).into_iter().map(|f| (f.rule, f.as_text())).collect()
}

#[test]
fn a_valid_description_is_clean() {
    assert_eq!(rules(GOOD), []);
}

/// Each row: the rule, what to replace in the valid description, by what.
const MUTATIONS: &[(&str, &str, &str)] = &[
    ("XML", "</ModelStructure>", ""),
    ("XML", "modelName=\"Hub\"", "modelName=\"Hub & rim\""),
    ("XML", "modelName=\"Hub\"", "modelName=\"Hub\" modelName=\"Hub\""),
    ("XSD", "modelName=\"Hub\"", ""),
    ("XSD", "modelName=\"Hub\"", "modelName=\"Hub\" modelname=\"Hub\""),
    ("XSD", "maxOutputDerivativeOrder=\"1\"", "maxOutputDerivativeOrder=\"-1\""),
    ("XSD", "canGetAndSetFMUstate=\"true\"", "canGetAndSetFMUstate=\"true\" needsExecutionTool=\"no\""),
    ("XSD", "canGetAndSetFMUstate=\"true\"", "canGetAndSetFMUstate=\"true\" canRunAsynchronously=\"true\""),
    ("XSD", "stepSize=\"0.1\"", "stepSize=\"fast\""),
    ("XSD", "stepSize=\"0.1\"", "stepSize=\"infinity\""),
    ("XSD", "generationDateAndTime=\"2026-01-31T12:00:00Z\"", "generationDateAndTime=\"today\""),
    ("XSD", "variableNamingConvention=\"structured\"", "variableNamingConvention=\"free\""),
    ("XSD", "<Integer start=\"7\"/>", "<Integer start=\"7.5\"/>"),
    ("XSD", "<Real derivative=\"2\"/>", "<Real derivative=\"2\"/><Real/>"),
    ("XSD", "<Own thing=\"1\"/></Tool>", "</Tool><Own/>"),
    ("XSD", "<File name=\"a.c\"/><File name=\"b.c\"/>", ""),
    ("XSD", "name=\"k\" valueReference=\"9\"", "name=\"k\" valueReference=\"-9\""),
    ("XSD", "name=\"k\" valueReference=\"9\"", "name=\"k\""),
    ("XSD", "dependencies=\"1 4\"", "dependencies=\"1,4\""),
    ("XSD", "dependenciesKind=\"dependent fixed\"", "dependenciesKind=\"dependent firm\""),
    (
        "XSD",
        "<Boolean/><Annotations><Tool name=\"x\"/></Annotations>",
        "<Annotations><Tool name=\"x\"/></Annotations><Boolean/>",
    ),
    ("XSD", "<Enumeration declaredType=\"Mode\" start=\"2\"/>", "<Enumeration start=\"2\"/>"),
    ("D8", "stepSize=\"0.1\"", "stepSize=\"NaN\""),
    ("D8", "<Real start=\"1\"/>", "<Real start=\"-INF\"/>"),
    ("X1", "fmiVersion=\"2.0\"", "fmiVersion=\"2.0.5\""),
    ("X1", "encoding=\"UTF-8\"", "encoding=\"ISO-8859-1\""),
    ("X2", "modelIdentifier=\"hub\"", "modelIdentifier=\"my-hub\""),
    ("X2", "modelIdentifier=\"hub\"", "modelIdentifier=\"2hub\""),
    ("X3", "guid=\"{1}\"", "guid=\"\""),
    ("X4", "name=\"on\" valueReference=\"11\" variability=\"discrete\"", "name=\"on\" valueReference=\"11\""),
    (
        "X4",
        "causality=\"output\" variability=\"discrete\"",
        "causality=\"output\" variability=\"continuous\"",
    ),
    ("X5", "causality=\"parameter\" variability=\"fixed\"", "causality=\"parameter\""),
    (
        "X5",
        "causality=\"calculatedParameter\" variability=\"fixed\"",
        "causality=\"calculatedParameter\" variability=\"discrete\"",
    ),
    ("X5", "causality=\"input\"", "causality=\"input\" variability=\"fixed\""),
    ("X5", "causality=\"input\"", "causality=\"input\" variability=\"constant\""),
    ("X5", "causality=\"output\" variability=\"discrete\"", "causality=\"output\" variability=\"tunable\""),
    ("X5", "causality=\"independent\"", "causality=\"independent\" variability=\"discrete\""),
    ("X6", "causality=\"input\"", "causality=\"input\" initial=\"exact\""),
    (
        "X6",
        "causality=\"parameter\" variability=\"fixed\"",
        "causality=\"parameter\" variability=\"fixed\" initial=\"calculated\"",
    ),
    ("X6", "causality=\"calculatedParameter\"", "causality=\"calculatedParameter\" initial=\"exact\""),
    ("X6", "variability=\"constant\"", "variability=\"constant\" initial=\"approx\""),
    ("X6", "causality=\"independent\"", "causality=\"independent\" initial=\"exact\""),
    ("X7", "<Real start=\"1\"/>", "<Real/>"),
    ("X7", "declaredType=\"Force\" start=\"0\"", "declaredType=\"Force\""),
    ("X7", "<Real start=\"3\" min=\"2\"/>", "<Real min=\"2\"/>"),
    ("X7", "<Integer start=\"7\"/>", "<Integer/>"),
    ("X7", "<Real unit=\"m\"/>", "<Real unit=\"m\" start=\"0\"/>"),
    ("X8", "causality=\"independent\"><Real/>", "causality=\"independent\"><Real start=\"0\"/>"),
    ("X8", "causality=\"independent\"><Real/>", "causality=\"independent\"><Integer/>"),
    (
        "X8",
        "name=\"a.b[2]\" valueReference=\"8\"",
        "name=\"a.b[2]\" valueReference=\"8\" causality=\"independent\"",
    ),
    ("X9", "<Outputs><Unknown index=\"2\"/>", "<Outputs>"),
    ("X9", "<Outputs><Unknown index=\"2\"/>", "<Outputs><Unknown index=\"2\"/><Unknown index=\"2\"/>"),
    ("X9", "<Outputs><Unknown index=\"2\"/>", "<Outputs><Unknown index=\"2\"/><Unknown index=\"0\"/>"),
    ("X9", "<Outputs><Unknown index=\"2\"/>", "<Outputs><Unknown index=\"1\"/><Unknown index=\"2\"/>"),
    (
        "X9",
        "<Derivatives><Unknown index=\"7\"/>",
        "<Derivatives><Unknown index=\"7\"/><Unknown index=\"8\"/>",
    ),
    ("X10", "<Unknown index=\"5\"/>", ""),
    ("X10", "<Unknown index=\"5\"/>", "<Unknown index=\"3\"/><Unknown index=\"5\"/>"),
    ("X10", "<Unknown index=\"5\"/>", "<Unknown index=\"5\"/><Unknown index=\"5\"/>"),
    ("X10", "<Unknown index=\"5\"/><Unknown index=\"7\"/>", "<Unknown index=\"7\"/><Unknown index=\"5\"/>"),
    (
        "X10",
        "<InitialUnknowns><Unknown index=\"2\" dependencies=\"\"/><Unknown index=\"5\"/><Unknown index=\"7\"/><Unknown index=\"13\"/></InitialUnknowns>",
        "",
    ),
    ("X11", "dependencies=\"1 4\"", "dependencies=\"4 1\""),
    ("X11", "dependencies=\"1 4\"", "dependencies=\"1 44\""),
    ("X11", "dependencies=\"1 4\"", ""),
    ("X11", "dependenciesKind=\"dependent fixed\"", "dependenciesKind=\"dependent\""),
    ("X11", "index=\"2\" dependencies=\"\"", "index=\"2\" dependencies=\"1\" dependenciesKind=\"fixed\""),
    ("X12", "name=\"k\"", "name=\"p\""),
    (
        "X12",
        "<SimpleType name=\"Mode\">",
        "<SimpleType name=\"Force\"><Real/></SimpleType><SimpleType name=\"Mode\">",
    ),
    (
        "X12",
        "<SimpleType name=\"Mode\">",
        "<SimpleType name=\"F\"><Real/></SimpleType><SimpleType name=\"Mode\">",
    ),
    ("X12", "<Unit name=\"m\">", "<Unit name=\"N\">"),
    ("X12", "name=\"MN\"", "name=\"kN\""),
    ("X12", "<Tool name=\"y\"/>", "<Tool name=\"x\"/>"),
    ("X12", "name=\"b.c\"", "name=\"a.c\""),
    ("X12", "<Real unit=\"m\"/>", "<Real unit=\"mile\"/>"),
    ("X12", "<Real unit=\"m\"/>", "<Real unit=\"m\" displayUnit=\"kN\"/>"),
    ("X12", "<Real start=\"1\"/>", "<Real start=\"1\" displayUnit=\"kN\"/>"),
    ("X13", "name=\"off\" value=\"2\"", "name=\"on\" value=\"2\""),
    (
        "X13",
        "<Enumeration declaredType=\"Mode\" start=\"2\"/>",
        "<Enumeration declaredType=\"Mode\" start=\"3\"/>",
    ),
    ("X14", "name=\"p\" valueReference=\"3\"", "name=\"p\" valueReference=\"0\""),
    ("X14", "name=\"z\" valueReference=\"2\"", "name=\"z\" valueReference=\"3\""),
    ("X14", "name=\"k\" valueReference=\"9\"", "name=\"k\" valueReference=\"5\""),
    ("X15", "<Real unit=\"m\"/>", "<Real unit=\"m\" reinit=\"false\"/>"),
    ("X15", "causality=\"input\"", "causality=\"input\" canHandleMultipleSetPerTimeInstant=\"true\""),
    ("X16", "name=\"k\"", "name=\"k one\""),
    ("X16", "name=\"k\"", "name=\"k[1\""),
    ("X16", "name=\"p\"", "name=\"a.b[0]\""),
    ("X16", "name=\"a.b[2]\"", "name=\"a.b[0]\""),
    ("X17", "declaredType=\"Force\"", "declaredType=\"Farce\""),
    ("X17", "declaredType=\"Force\"", "declaredType=\"Mode\""),
    ("X17", "min=\"-100\"", "min=\"200\""),
    ("X17", "declaredType=\"Force\" start=\"0\"", "declaredType=\"Force\" start=\"200\""),
    ("X17", "<Real start=\"3\" min=\"2\"/>", "<Real start=\"1\" min=\"2\"/>"),
    ("X17", "declaredType=\"Force\" start=\"0\"", "declaredType=\"Force\" min=\"101\" start=\"0\""),
    ("X18", "stopTime=\"2\"", "stopTime=\"0.5\""),
    ("X18", "startTime=\"1\" stopTime=\"2\"", "stopTime=\"-1\""),
    ("X18", "stepSize=\"0.1\"", "stepSize=\"0\""),
    ("X18", "tolerance=\"1e-4\"", "tolerance=\"-1e-4\""),
    ("M7", "canGetAndSetFMUstate=\"true\"", ""),
    ("L1", "<Category name=\"logEvents\"/>", "<Category name=\"logAll\"/>"),
];

#[test]
fn every_mutation_breaks_its_rule_and_no_other() {
    for (rule, from, to) in MUTATIONS {
        assert_eq!(GOOD.matches(from).count(), 1, "{from}");
        let found = rules(&GOOD.replacen(from, to, 1));
        let told: Vec<&str> = found.iter().map(|(_, text)| text.as_str()).collect();
        assert!(!found.is_empty(), "{rule}: {from} -> {to}: nothing is found");
        assert!(found.iter().all(|(name, _)| name == rule), "{rule}: {from} -> {to}:\n{}", told.join("\n"));
        assert!(told[0].contains(" --> modelDescription.xml:") || *rule == "XML", "{}", told[0]);
    }
}

#[test]
fn without_a_part_for_co_simulation() {
    let start = GOOD.find("  <CoSimulation").unwrap();
    let end = GOOD.find("  <UnitDefinitions").unwrap();
    let found = rules(&format!("{}{}", &GOOD[..start], &GOOD[end..]));
    assert_eq!(found.len(), 1);
    assert!(
        found[0].1.contains("error[XSD]: <fmiModelDescription> has no <ModelExchange> or <CoSimulation>")
    );
    let exchange = format!("{}<ModelExchange modelIdentifier=\"hub\"/>{}", &GOOD[..start], &GOOD[end..]);
    let found = static_findings(exchange.as_bytes());
    assert_eq!((found.len(), found[0].rule, found[0].level), (1, "CS", Level::Warning));
}

#[test]
fn order_of_the_sections() {
    let start = GOOD.find("  <LogCategories").unwrap();
    let end = GOOD.find("  <DefaultExperiment").unwrap();
    let moved = GOOD
        .replace(&GOOD[start..end], "")
        .replace("  <UnitDefinitions", &format!("{}  <UnitDefinitions", &GOOD[start..end]));
    let found = rules(&moved);
    assert!(found.iter().all(|(rule, _)| *rule == "XSD") && !found.is_empty());
    assert!(found[0].1.contains("it belongs before <LogCategories>"), "{}", found[0].1);
}

#[test]
fn all_findings_are_collected() {
    let text = GOOD
        .replace("stopTime=\"2\"", "stopTime=\"0\"")
        .replace("<Unknown index=\"5\"/>", "")
        .replace("unit=\"m\"", "unit=\"mile\"");
    let found: Vec<_> = rules(&text).into_iter().map(|(rule, _)| rule).collect();
    assert_eq!(found, ["X18", "X12", "X10"]);
}

#[test]
fn any_cut_is_survived() {
    for end in (0..GOOD.trim_end().len()).step_by(7) {
        assert!(!static_findings(&GOOD.as_bytes()[..end]).is_empty());
    }
}

#[test]
fn grammar_of_structured_names() {
    for good in
        ["a", "_a1", "a.b", "a[1]", "a[1,2].b", "der(a.b)", "der(a[1,2])", "der(a,2)", "'x y'.z", "'it\\'s'"]
    {
        assert!(structured(good).is_some(), "{good}");
    }
    for bad in ["", "1a", "a.", ".a", "a[", "a[]", "a[x]", "a b", "der(a", "a-b", "''", "'a", "a[1]b"] {
        assert!(structured(bad).is_none(), "{bad}");
    }
}
