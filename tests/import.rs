//! The importer against an FMU that is compiled here, from tests/data/integrator.c.
#![cfg(all(feature = "host", target_os = "linux", target_arch = "x86_64"))]
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use latsch::ErrorKind;
use latsch::fmi::import::ImportedFmu;
use latsch::model::{Kind, Slave, Snapshot};
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use zip::write::{SimpleFileOptions, ZipWriter};

const DESCRIPTION: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="Integrator" guid="{integrator}">
  <CoSimulation modelIdentifier="integrator" canHandleVariableCommunicationStepSize="true"
      canInterpolateInputs="true" canGetAndSetFMUstate="true" canSerializeFMUstate="true"/>
  <TypeDefinitions><SimpleType name="Mode"><Enumeration>
    <Item name="slow" value="1"/><Item name="fast" value="2"/></Enumeration></SimpleType></TypeDefinitions>
  <ModelVariables>
    <ScalarVariable name="u" valueReference="0" causality="input"><Real start="0" unit="m/s"/></ScalarVariable>
    <ScalarVariable name="y" valueReference="1" causality="output"><Real unit="m"/></ScalarVariable>
    <ScalarVariable name="k" valueReference="2" causality="parameter" variability="fixed"><Real start="2"/></ScalarVariable>
    <ScalarVariable name="count" valueReference="0" causality="parameter" variability="tunable"><Integer start="3"/></ScalarVariable>
    <ScalarVariable name="steps" valueReference="1" causality="output" variability="discrete"><Integer/></ScalarVariable>
    <ScalarVariable name="mode" valueReference="2" causality="parameter" variability="fixed"><Enumeration declaredType="Mode" start="1"/></ScalarVariable>
    <ScalarVariable name="flag" valueReference="0" causality="parameter" variability="fixed"><Boolean start="true"/></ScalarVariable>
    <ScalarVariable name="mood" valueReference="0" causality="parameter" variability="tunable"><String start="good"/></ScalarVariable>
    <ScalarVariable name="finals" valueReference="3" causality="output" variability="discrete"><Integer/></ScalarVariable>
    <ScalarVariable name="location" valueReference="1" causality="output" variability="discrete"><String/></ScalarVariable>
  </ModelVariables>
  <ModelStructure/>
</fmiModelDescription>
"#;

/// Compiles the integrator and packs it with a description.
fn pack(folder: &Path, description: &str, platform: &str, options: &[&str]) -> PathBuf {
    let binary = folder.join("integrator.so");
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/integrator.c");
    let status = Command::new("cc")
        .args(["-shared", "-fPIC", "-O1", "-Wall", "-Wextra", "-Werror", "-o"])
        .arg(&binary)
        .arg(source)
        .args(options)
        .arg("-lm")
        .status()
        .expect("a C compiler called cc, which Rust needs for linking too");
    assert!(status.success());
    let path = folder.join("integrator.fmu");
    let mut zip = ZipWriter::new(File::create(&path).unwrap());
    let options = SimpleFileOptions::default();
    for (name, bytes) in [
        ("modelDescription.xml", description.as_bytes()),
        ("resources/model.toml", b"gain = 2"),
        (&format!("binaries/{platform}/integrator.so"), &fs::read(&binary).unwrap()),
    ] {
        zip.start_file(name, options).unwrap();
        zip.write_all(bytes).unwrap();
    }
    zip.finish().unwrap();
    path
}

fn load_with(description: &str, options: &[&str]) -> latsch::Result<ImportedFmu> {
    let folder = tempfile::tempdir().unwrap();
    // The FMU file is not needed once it is loaded.
    ImportedFmu::load(&pack(folder.path(), description, "linux64", options))
}

fn load_as(description: &str) -> latsch::Result<ImportedFmu> {
    load_with(description, &[])
}

fn load() -> ImportedFmu {
    load_as(DESCRIPTION).unwrap()
}

fn value(fmu: &mut ImportedFmu, name: &str) -> f64 {
    let index = fmu.find(name).unwrap();
    fmu.get(index).unwrap()
}

fn set(fmu: &mut ImportedFmu, name: &str, value: f64) -> latsch::Result<()> {
    let index = fmu.find(name).unwrap();
    fmu.set(index, value)
}

fn mood(fmu: &mut ImportedFmu, mood: &str) {
    let index = fmu.find("mood").unwrap();
    fmu.set_text(index, mood).unwrap();
}

fn started() -> ImportedFmu {
    let mut fmu = load();
    fmu.start(0.0, None).unwrap();
    fmu.finish_start().unwrap();
    fmu
}

fn run(fmu: &mut ImportedFmu, steps: std::ops::Range<u32>) {
    for i in steps {
        fmu.step(f64::from(i) * 0.1, 0.1).unwrap();
    }
}

#[track_caller]
fn contains(error: &latsch::Error, words: &[&str]) {
    let message = error.to_string();
    for word in words {
        assert!(message.contains(word), "{word:?} is not in: {message}");
    }
}

#[test]
fn integrates() {
    let mut fmu = load();
    assert_eq!(fmu.interface().name, "Integrator");
    assert!(fmu.can_interpolate());
    assert_eq!(fmu.resource("model.toml").as_deref(), Some(&b"gain = 2"[..]));
    assert_eq!(fmu.resource("../modelDescription.xml"), None);
    set(&mut fmu, "k", 3.0).unwrap();
    // The FMU itself refuses inputs as early as this; they have to wait.
    set(&mut fmu, "u", 4.0).unwrap();
    set(&mut fmu, "u", 0.5).unwrap();
    contains(&fmu.get(0).unwrap_err(), &["reading u", "before the start"]);
    fmu.start(0.0, Some(2.0)).unwrap();
    assert_eq!(value(&mut fmu, "u"), 0.5);
    fmu.finish_start().unwrap();
    run(&mut fmu, 0..10);
    assert!((value(&mut fmu, "y") - 1.5).abs() < 1e-12);
    assert_eq!(value(&mut fmu, "steps"), 10.0);
    // From 0.5, with the rate 2 for one second: 0.5 + 1 on average 1.5.
    let u = fmu.find("u").unwrap();
    fmu.set(u, 0.5).unwrap();
    fmu.set_rate(u, 2.0).unwrap();
    run(&mut fmu, 10..20);
    assert!((value(&mut fmu, "y") - 6.0).abs() < 1e-12);
    contains(&fmu.step(2.0, 0.1).unwrap_err(), &["the step from 2 s by 0.1 s", "beyond the stop time"]);
    assert_eq!(fmu.messages().len(), 1);
    assert!(fmu.messages().is_empty());
}

#[test]
fn passes_every_type() {
    let mut fmu = load();
    assert!(matches!(&fmu.interface().variables[5].kind, Kind::Enumeration(items) if items.len() == 2));
    set(&mut fmu, "count", -7.0).unwrap();
    set(&mut fmu, "mode", 2.0).unwrap();
    set(&mut fmu, "flag", 0.0).unwrap();
    mood(&mut fmu, "größer");
    contains(&set(&mut fmu, "count", 1.5).unwrap_err(), &["count", "whole number"]);
    contains(&set(&mut fmu, "flag", 2.0).unwrap_err(), &["flag", "0 (false) or 1 (true)"]);
    contains(&set(&mut fmu, "mood", 2.0).unwrap_err(), &["mood", "text"]);
    contains(&fmu.set_text(7, "a\0b").unwrap_err(), &["mood", "NUL"]);
    contains(&fmu.set(99, 0.0).unwrap_err(), &["there is no number 99"]);
    fmu.start(1.0, None).unwrap();
    assert_eq!(["count", "mode", "flag"].map(|name| value(&mut fmu, name)), [-7.0, 2.0, 0.0]);
    assert_eq!(fmu.text(7).unwrap(), "größer");
    let location = fmu.text(9).unwrap();
    assert!(location.starts_with("file:///") && location.ends_with("/resources"), "{location}");
    contains(&fmu.text(0).unwrap_err(), &["u is not a text"]);
    contains(&fmu.get(7).unwrap_err(), &["mood is a text"]);
    let folder = PathBuf::from(location.trim_start_matches("file://"));
    assert!(folder.join("model.toml").exists());
    drop(fmu);
    assert!(!folder.parent().unwrap().exists());
}

#[test]
fn keeps_the_order_of_calls() {
    let mut fmu = load();
    contains(&fmu.step(0.0, 0.1).unwrap_err(), &["a step", "before the end of initialization"]);
    contains(&fmu.finish_start().unwrap_err(), &["outside initialization"]);
    contains(&fmu.start(1.0, Some(1.0)).unwrap_err(), &["not after"]);
    contains(&fmu.start(f64::NAN, None).unwrap_err(), &["finite"]);
    contains(&set(&mut fmu, "y", 1.0).unwrap_err(), &["y is computed"]);
    contains(&fmu.set_rate(0, 1.0).unwrap_err(), &["before the start"]);
    contains(&fmu.set_rate(1, 1.0).unwrap_err(), &["y is not a real input"]);
    fmu.start(0.0, None).unwrap();
    contains(&fmu.start(0.0, None).unwrap_err(), &["twice"]);
    fmu.finish_start().unwrap();
    contains(&set(&mut fmu, "k", 1.0).unwrap_err(), &["fixed parameter k"]);
    set(&mut fmu, "count", 1.0).unwrap();
    for (time, length) in [(0.0, 0.0), (0.0, -1.0), (0.0, f64::NAN), (f64::INFINITY, 1.0), (0.5, 0.1)] {
        assert_eq!(fmu.step(time, length).unwrap_err().kind(), ErrorKind::Call);
    }
    // None of these reached the FMU.
    fmu.step(0.0, 0.1).unwrap();
    assert!(fmu.messages().is_empty());
}

#[test]
fn starts_again_after_a_reset() {
    let mut fmu = started();
    set(&mut fmu, "u", 1.0).unwrap();
    run(&mut fmu, 0..5);
    fmu.reset().unwrap();
    fmu.start(0.0, None).unwrap();
    fmu.finish_start().unwrap();
    assert_eq!((value(&mut fmu, "u"), value(&mut fmu, "y")), (0.0, 0.0));
}

#[test]
fn saves_and_restores() {
    let mut fmu = started();
    set(&mut fmu, "u", 1.0).unwrap();
    run(&mut fmu, 0..5);
    let snapshot = fmu.save().unwrap();
    run(&mut fmu, 5..10);
    let y = value(&mut fmu, "y");
    fmu.restore(&snapshot).unwrap();
    assert!((value(&mut fmu, "y") - 1.0).abs() < 1e-12);
    run(&mut fmu, 5..10);
    assert_eq!(value(&mut fmu, "y"), y);

    // As bytes, to another instance that has not even been started.
    let bytes = fmu.serialize(&snapshot).unwrap();
    let mut other = load();
    contains(&other.restore(&snapshot).unwrap_err(), &["another slave"]);
    let copy = other.deserialize(&bytes).unwrap();
    other.restore(&copy).unwrap();
    run(&mut other, 5..10);
    assert_eq!(value(&mut other, "y"), y);
    for position in [0, 20, bytes.len() - 1] {
        let mut damaged = bytes.clone();
        damaged[position] ^= 1;
        contains(&other.deserialize(&damaged).err().unwrap(), &["damaged"]);
    }
    contains(&other.deserialize(&bytes[..10]).err().unwrap(), &["damaged"]);

    let mut snapshot = snapshot;
    fmu.save_into(&mut snapshot).unwrap();
    run(&mut fmu, 10..11);
    fmu.restore(&snapshot).unwrap();
    assert_eq!(value(&mut fmu, "y"), y);
    let foreign: Snapshot = Box::new(1);
    contains(&fmu.restore(&foreign).unwrap_err(), &["another slave"]);
    // A snapshot may die in another thread, and after its slave.
    let late = fmu.save().unwrap();
    std::thread::spawn(move || drop(snapshot)).join().unwrap();
    for _ in 0..100 {
        fmu.save().unwrap();
    }
    drop(fmu);
    drop(late);
}

/// noSetFMUStatePriorToCurrentPoint is true as long as nobody holds a state to go back to. The FMU ends the
/// process if it is set back to before a point that was final.
#[test]
fn the_past_is_final_unless_somebody_can_go_back() {
    let mut fmu = started();
    set(&mut fmu, "u", 1.0).unwrap();
    run(&mut fmu, 0..3);
    assert_eq!(value(&mut fmu, "finals"), 3.0);
    let snapshot = fmu.save().unwrap();
    run(&mut fmu, 3..5);
    fmu.restore(&snapshot).unwrap();
    run(&mut fmu, 3..5);
    assert_eq!(value(&mut fmu, "finals"), 3.0);
    let y = value(&mut fmu, "y");
    drop(snapshot);
    run(&mut fmu, 5..7);
    assert_eq!(value(&mut fmu, "finals"), 5.0);
    // Bytes may come back at any time.
    let snapshot = fmu.save().unwrap();
    let bytes = fmu.serialize(&snapshot).unwrap();
    drop(snapshot);
    run(&mut fmu, 7..9);
    assert_eq!(value(&mut fmu, "finals"), 5.0);

    // Another instance that is farther already: the state begins another run of it.
    let mut other = started();
    run(&mut other, 0..12);
    assert_eq!(value(&mut other, "finals"), 12.0);
    let copy = other.deserialize(&bytes).unwrap();
    other.restore(&copy).unwrap();
    assert!((value(&mut other, "y") - y - 0.4).abs() < 1e-12);
    run(&mut other, 7..9);
    assert_eq!(value(&mut other, "finals"), 12.0);
}

#[test]
fn a_simulation_never_goes_back() {
    let mut fmu = load();
    let experiment = latsch::simulate::Experiment { stop: Some(1.0), step: Some(0.1), ..Default::default() };
    let outcome = latsch::simulate::simulate(&mut fmu, &experiment, |_, _| {}).unwrap();
    assert!(outcome.stopped.is_none());
    assert_eq!(value(&mut fmu, "finals"), 10.0);
}

#[test]
fn a_simulation_says_why_values_cannot_be_read_any_more() {
    let mut fmu = load();
    mood(&mut fmu, "mute");
    let experiment = latsch::simulate::Experiment { stop: Some(1.0), step: Some(0.1), ..Default::default() };
    let outcome = latsch::simulate::simulate(&mut fmu, &experiment, |_, _| {});
    let error = outcome.map(|outcome| outcome.stopped.unwrap()).unwrap_or_else(|error| error);
    contains(&error, &["fmi2Fatal", "nothing more to tell"]);
}

#[test]
fn messages_have_their_arguments_and_names() {
    let mut fmu = started();
    set(&mut fmu, "u", 3.0).unwrap();
    mood(&mut fmu, "talk");
    run(&mut fmu, 0..1);
    let messages = fmu.messages();
    assert_eq!(messages.len(), 1);
    assert_eq!(messages[0].text, "step at 0.00 s: u is +3, 50 % of #7 (late)");
}

/// An FMU that passes a number of its own for the environment: it is not taken for a pointer.
#[test]
fn a_lost_environment_is_survived() {
    let mut fmu = load_with(DESCRIPTION, &["-DLOST_ENVIRONMENT"]).unwrap();
    let _bystander = load();
    fmu.start(0.0, None).unwrap();
    fmu.finish_start().unwrap();
    contains(&set(&mut fmu, "u", f64::NAN).unwrap_err(), &["the value is no number; 100"]);
    assert_eq!(fmu.messages().len(), 1);
}

#[test]
fn says_what_the_fmu_says() {
    let mut fmu = started();
    let error = set(&mut fmu, "u", f64::NAN).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Fmu);
    contains(&error, &["Integrator", "setting u = NaN", "fmi2Error", "the value is no number; 100% sure"]);
    contains(&fmu.step(0.0, 0.1).unwrap_err(), &["after a failed call"]);
    fmu.reset().unwrap();
    // An input that waited until the start.
    set(&mut fmu, "u", f64::NAN).unwrap();
    contains(&fmu.start(0.0, None).unwrap_err(), &["no number"]);

    let mut fmu = started();
    let snapshot = fmu.save().unwrap();
    mood(&mut fmu, "error");
    contains(&fmu.step(0.0, 0.1).unwrap_err(), &["fmi2Error: bad mood"]);
    assert_eq!(value(&mut fmu, "y"), 0.0);
    contains(&fmu.save().err().unwrap(), &["after a failed call"]);
    fmu.restore(&snapshot).unwrap();
    fmu.step(0.0, 0.1).unwrap();
    mood(&mut fmu, "discard");
    contains(&fmu.step(0.1, 0.1).unwrap_err(), &["half a step only", "t = 0.15", "to end here"]);
    fmu.restore(&snapshot).unwrap();
    // The FMU aborts the process if it is called once more after this.
    mood(&mut fmu, "fatal");
    contains(&fmu.step(0.0, 0.1).unwrap_err(), &["fmi2Fatal: very bad mood"]);
    contains(&fmu.get(0).unwrap_err(), &["after fmi2Fatal"]);
    contains(&fmu.reset().unwrap_err(), &["after fmi2Fatal"]);
    contains(&fmu.restore(&snapshot).unwrap_err(), &["after fmi2Fatal"]);
    assert_eq!(fmu.messages().last().unwrap().status, 4);
    drop(fmu);
}

#[test]
fn says_what_the_fmu_cannot() {
    let plain = DESCRIPTION
        .replace("canInterpolateInputs=\"true\"", "")
        .replace("canGetAndSetFMUstate=\"true\" canSerializeFMUstate=\"true\"", "");
    let mut fmu = load_as(&plain).unwrap();
    assert!(!fmu.can_interpolate());
    fmu.start(0.0, None).unwrap();
    contains(&fmu.set_rate(0, 1.0).unwrap_err(), &["canInterpolateInputs"]);
    contains(&fmu.save().err().unwrap(), &["canGetAndSetFMUstate"]);
    let plain = DESCRIPTION.replace("canSerializeFMUstate=\"true\"", "");
    let mut fmu = load_as(&plain).unwrap();
    let snapshot = fmu.save().unwrap();
    contains(&fmu.serialize(&snapshot).unwrap_err(), &["canSerializeFMUstate"]);
}

#[test]
fn says_why_an_fmu_cannot_be_loaded() {
    let folder = tempfile::tempdir().unwrap();
    let fail = |path: &Path| {
        let error = ImportedFmu::load(path).err().unwrap();
        assert_eq!(error.kind(), ErrorKind::Fmu);
        contains(&error, &["integrator.fmu"]);
        error
    };
    let path = pack(folder.path(), DESCRIPTION, "win64", &[]);
    contains(&fail(&path), &["no binary", "binaries/linux64/integrator.so", "there are binaries for win64"]);
    let path = pack(folder.path(), DESCRIPTION, "linux64", &["-DWITHOUT_STEP"]);
    contains(&fail(&path), &["fmi2DoStep is missing"]);
    let path = pack(folder.path(), &DESCRIPTION.replace("{integrator}", "{other}"), "linux64", &[]);
    contains(&fail(&path), &["fmi2Instantiate", "wrong guid: 100% of #1#"]);
    let path = pack(folder.path(), &DESCRIPTION.replace("\"2.0\"", "\"3.0\""), "linux64", &[]);
    contains(&fail(&path), &["modelDescription.xml, line 2", "fmiVersion"]);

    let path = pack(folder.path(), DESCRIPTION, "x86_64-linux", &[]);
    ImportedFmu::load(&path).unwrap();

    let mut zip = ZipWriter::new(File::create(&path).unwrap());
    zip.start_file("binaries/linux64/integrator.so", SimpleFileOptions::default()).unwrap();
    zip.write_all(b"not a library").unwrap();
    zip.finish().unwrap();
    contains(&fail(&path), &["there is no modelDescription.xml"]);

    let mut zip = ZipWriter::new(File::create(&path).unwrap());
    for (name, text) in [("modelDescription.xml", DESCRIPTION), ("binaries/linux64/integrator.so", "junk")] {
        zip.start_file(name, SimpleFileOptions::default()).unwrap();
        zip.write_all(text.as_bytes()).unwrap();
    }
    zip.finish().unwrap();
    contains(&fail(&path), &["cannot be loaded"]);
}
