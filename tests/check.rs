//! The check against FMUs with known defects, compiled here from tests/data/integrator.c.
#![cfg(all(feature = "host", target_os = "linux", target_arch = "x86_64"))]
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use latsch::fmi::check::{Level, Options, Place, Report, check};
use std::fs::{self, File};
use std::io::Write;
use std::process::Command;
use std::time::Duration;
use zip::write::{SimpleFileOptions, ZipWriter};

const DESCRIPTION: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="Integrator" guid="{integrator}">
  <CoSimulation modelIdentifier="integrator" canHandleVariableCommunicationStepSize="true"
      canInterpolateInputs="true" canGetAndSetFMUstate="true" canSerializeFMUstate="true"/>
  <UnitDefinitions><Unit name="m"><BaseUnit m="1"/></Unit><Unit name="m/s"><BaseUnit m="1" s="-1"/></Unit></UnitDefinitions>
  <TypeDefinitions><SimpleType name="Mode"><Enumeration>
    <Item name="slow" value="1"/><Item name="fast" value="2"/></Enumeration></SimpleType></TypeDefinitions>
  <LogCategories><Category name="logStatus"/></LogCategories>
  <DefaultExperiment stopTime="1" stepSize="0.01"/>
  <ModelVariables>
    <ScalarVariable name="u" valueReference="0" causality="input"><Real start="0" unit="m/s"/></ScalarVariable>
    <ScalarVariable name="y" valueReference="1" causality="output"><Real unit="m"/></ScalarVariable>
    <ScalarVariable name="k" valueReference="2" causality="parameter" variability="fixed"><Real start="2"/></ScalarVariable>
    <ScalarVariable name="count" valueReference="0" causality="parameter" variability="tunable"><Integer start="3"/></ScalarVariable>
    <ScalarVariable name="steps" valueReference="1" causality="output" variability="discrete"><Integer/></ScalarVariable>
    <ScalarVariable name="mode" valueReference="2" causality="parameter" variability="fixed"><Enumeration declaredType="Mode" start="1"/></ScalarVariable>
    <ScalarVariable name="flag" valueReference="0" causality="parameter" variability="fixed"><Boolean start="true"/></ScalarVariable>
    <ScalarVariable name="mood" valueReference="0" causality="parameter" variability="tunable"><String start="good"/></ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs><Unknown index="2"/><Unknown index="5"/></Outputs>
    <InitialUnknowns><Unknown index="2"/><Unknown index="5"/></InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
"#;

/// Compiles the integrator with these options, packs it and checks it.
fn examine(description: &str, options: &[&str]) -> Report {
    examine_with(description, options, &[])
}

/// The same with further files.
fn examine_with(description: &str, options: &[&str], files: &[&str]) -> Report {
    let folder = tempfile::tempdir().unwrap();
    let binary = folder.path().join("integrator.so");
    let status = Command::new("cc")
        .args(["-shared", "-fPIC", "-O1", "-Wall", "-Wextra", "-Werror", "-DPOLITE", "-o"])
        .arg(&binary)
        .arg(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/integrator.c"))
        .args(options)
        .arg("-lm")
        .status()
        .expect("a C compiler called cc, which Rust needs for linking too");
    assert!(status.success());
    let path = folder.path().join("integrator.fmu");
    let mut zip = ZipWriter::new(File::create(&path).unwrap());
    for (name, bytes) in [
        ("modelDescription.xml", description.as_bytes()),
        ("binaries/linux64/integrator.so", &fs::read(&binary).unwrap()),
    ] {
        zip.start_file(name, SimpleFileOptions::default()).unwrap();
        zip.write_all(bytes).unwrap();
    }
    for name in files {
        zip.start_file(*name, SimpleFileOptions::default()).unwrap();
    }
    zip.finish().unwrap();
    let program = Some(env!("CARGO_BIN_EXE_latsch").into());
    check(&path, &Options { program, timeout: Duration::from_secs(4) }).unwrap()
}

/// The findings of a defect: all about these rules, one at least with these words.
#[track_caller]
fn finds(option: &str, rules: &[&str], level: Level, words: &[&str]) {
    finds_in(DESCRIPTION, option, rules, level, words);
}

#[track_caller]
fn finds_in(description: &str, option: &str, rules: &[&str], level: Level, words: &[&str]) {
    let report = examine(description, &[option]);
    let texts: Vec<String> = report.findings.iter().map(|f| f.as_text()).collect();
    let all = texts.join("\n");
    assert!(report.findings.iter().all(|f| rules.contains(&f.rule)), "{all}");
    assert!(report.findings.iter().any(|f| f.level == level), "{all}");
    assert!(texts.iter().any(|t| words.iter().all(|w| t.contains(w))), "{words:?} are not in:\n{all}");
}

#[test]
fn a_good_fmu_is_clean() {
    let report = examine(DESCRIPTION, &[]);
    let texts: Vec<String> = report.findings.iter().map(|f| f.as_text()).collect();
    assert!(texts.is_empty(), "{}", texts.join("\n"));
    assert!(report.notes.is_empty(), "{:?}", report.notes);
    assert!(report.checks.len() > 35);
}

#[test]
fn a_hang_names_the_call() {
    finds(
        "-DHANG_ON_NAN",
        &["D1"],
        // no master may step by NaN
        Level::Warning,
        &["warning[D1]", "fmi2DoStep did not return within 4 s", "stepping by NaN"],
    );
}

#[test]
fn a_crash_names_the_call() {
    finds(
        "-DCRASH_IN_RESET",
        &["M5", "S9"],
        Level::Error,
        &["error[M5]", "fmi2Reset crashed with SIGSEGV", "resetting"],
    );
}

#[test]
fn a_state_that_lacks_something() {
    finds(
        "-DFORGETFUL",
        &["M6"],
        Level::Error,
        &["fmi2SetFMUstate after steps with other inputs", "\"y\" is"],
    );
}

#[test]
fn noise() {
    finds("-DNOISE", &["S8"], Level::Warning, &["prints to standard output: \"step to "]);
}

#[test]
fn numbers_that_are_none() {
    finds(
        "-DNAN_PASSES",
        &["D8"],
        Level::Warning,
        &["\"u\" = NaN", "\"y\" becomes NaN", "modelDescription.xml:11:"],
    );
}

#[test]
fn a_leak() {
    finds("-DLEAK", &["S10"], Level::Error, &["memory grows by about", "bytes with each instance"]);
}

#[test]
fn what_the_description_promises() {
    let wrong = DESCRIPTION
        .replace("<Real start=\"2\"/>", "<Real start=\"2.5\"/>")
        .replace("name=\"logStatus\"", "name=\"logAll\"");
    let report = examine(&wrong, &[]);
    let start = report.findings.iter().find(|f| f.rule == "X7").unwrap();
    assert!(start.what.contains("\"k\" starts with 2.0 in the binary and with 2.5"), "{}", start.what);
    let Some(Place::Xml { line: 13, excerpt, mark, .. }) = &start.place else { panic!("{:?}", start.place) };
    assert_eq!(excerpt.chars().skip(mark.0).take(mark.1).collect::<String>(), "start=\"2.5\"");
    // one cause, whichever calls log
    let categories: Vec<_> = report.findings.iter().filter(|f| f.rule == "L1").collect();
    assert_eq!(categories.len(), 1);
    assert!(categories[0].also.len() > 3);
    assert!(report.findings.iter().all(|f| matches!(f.rule, "X7" | "L1")));

    let report = examine(DESCRIPTION, &["-DWITHOUT_STEP"]);
    assert!(report.findings.iter().any(|f| f.rule == "M8" && f.what.contains("fmi2DoStep")));
    assert_eq!(report.notes.len(), 1);
    let report = examine(&DESCRIPTION.replace("{integrator}", "{other}"), &[]);
    assert!(report.findings.iter().any(|f| f.rule == "M0" && f.what.contains("NULL")));
}

/// What only shows when a master does what it must not is no error of the FMU.
#[test]
fn what_masters_must_not_do_is_a_warning() {
    let report = examine(DESCRIPTION, &["-DANY_ORDER"]);
    let texts: Vec<String> = report.findings.iter().map(|f| f.as_text()).collect();
    assert!(texts.iter().all(|t| t.starts_with("warning[")), "{}", texts.join("\n"));
    let all: Vec<&str> =
        report.findings.iter().flat_map(|f| f.also.iter().map(|a| &*a.what).chain([&*f.what])).collect();
    for words in ["before the initialization", "without fmi2SetupExperiment", "by NaN s", "from 10 s"] {
        assert!(all.iter().any(|t| t.contains(words)), "{words}: {}", all.join("\n"));
    }
}

#[test]
fn start_values_with_fifteen_digits_are_as_written() {
    let with =
        |start: &str| DESCRIPTION.replace("<Real start=\"2\"/>", &format!("<Real start=\"{start}\"/>"));
    let report = examine(&with("0.666666666666667"), &["-DTHIRD"]);
    assert_eq!(report.findings.len(), 0, "{:?}", report.findings);
    let report = examine(&with("0.66666666666667"), &["-DTHIRD"]);
    assert_eq!(report.findings.iter().map(|f| f.rule).collect::<Vec<_>>(), ["X7"]);
}

#[test]
fn a_lost_environment_is_one_finding() {
    finds("-DLOST_ENVIRONMENT", &["L4"], Level::Error, &["with an environment that the master did not give"]);
}

#[test]
fn the_flag_for_rollback_changes_nothing() {
    finds(
        "-DFLAG_MATTERS",
        &["D5"],
        Level::Error,
        &["fmi2False the FMU runs otherwise than with fmi2True", "\"y\" is"],
    );
    let report = examine(DESCRIPTION, &["-DNEEDS_ROLLBACK"]);
    let texts: Vec<String> = report.findings.iter().map(|f| f.as_text()).collect();
    let words = "error[D5]: fmi2DoStep with noSetFMUStatePriorToCurrentPoint = fmi2True returned fmi2Error";
    assert!(texts.iter().any(|t| t.contains(words)), "{}", texts.join("\n"));
}

/// A solver that begins anew errs otherwise, but not more; a state that lacks something is found all the same.
#[test]
fn restored_solvers_err_otherwise() {
    finds("-DSOLVER", &["M6"], Level::Warning, &["warning[M6]", "less than the error of the FMU's solver"]);
    let report = examine(DESCRIPTION, &["-DSOLVER", "-DFORGETFUL"]);
    assert!(
        report.findings.iter().any(|f| f.rule == "M6" && f.level == Level::Error),
        "{:?}",
        report.findings
    );
}

#[test]
fn what_is_not_repeatable_is_not_compared() {
    finds("-DRANDOM", &["S12", "D10"], Level::Warning, &["the same calls give other results"]);
}

#[test]
fn memory_functions_come_in_pairs() {
    finds("-DFOREIGN_MEMORY", &["S5"], Level::Error, &["freeMemory is called with memory that is not"]);
    finds("-DKEEPS_MEMORY", &["S5", "S10"], Level::Error, &["1 are never freed with freeMemory"]);
    let own = "canNotUseMemoryManagementFunctions=\"true\" canInterpolateInputs";
    let own = DESCRIPTION.replace("canInterpolateInputs", own);
    finds_in(&own, "-DPOLITE", &["S5"], Level::Error, &["is true, but allocateMemory is called"]);
    let report = examine(&own, &["-DOWN_MEMORY", "-DNEEDS_MEMORY"]);
    let rules: Vec<&str> = report.findings.iter().map(|f| f.rule).collect();
    assert!(
        rules.contains(&"S5") && rules.iter().all(|r| matches!(*r, "S5" | "L5")),
        "{:?}",
        report.findings
    );
    let words = "does not run without allocateMemory and freeMemory";
    assert!(report.findings.iter().any(|f| f.what.contains(words)), "{:?}", report.findings);
    let report = examine(&own, &["-DOWN_MEMORY"]);
    assert_eq!(report.findings.len(), 0, "{:?}", report.findings);
}

#[test]
fn locations_are_uris() {
    let report = examine(DESCRIPTION, &["-DPLAIN_LOCATION"]);
    let found = |words: &str| report.findings.iter().find(|f| f.what.contains(words)).unwrap();
    assert!(report.findings.iter().all(|f| f.rule == "S7"), "{:?}", report.findings);
    assert_eq!(found("file:/...").level, Level::Error);
    assert_eq!(found("percent-encoded").level, Level::Error);
    assert_eq!(found("file://localhost/").level, Level::Warning);
    assert_eq!(found("NULL").level, Level::Warning);
}

#[test]
fn platforms_that_are_there_are_named() {
    let report = examine_with(DESCRIPTION, &[], &["binaries/win64/integrator.dll"]);
    assert_eq!(report.platforms, ["linux64", "win64"]);
    assert_eq!(report.ran.as_deref(), Some("linux64"));
    assert_eq!(report.notes.len(), 1);
    assert!(
        report.notes[0].contains("win64") && report.notes[0].contains("cannot be run"),
        "{:?}",
        report.notes
    );
}
