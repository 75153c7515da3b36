//! Corrected models as FMUs: shipped models with effects, and FMUs of others that are carried inside one of
//! ours. What comes out has to be what `Attached` computes in this process, to the last bit.
#![cfg(all(feature = "host", target_os = "linux", target_arch = "x86_64"))]
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use latsch::effect::file::{Corrections, Fitted, corrected_text};
use latsch::effect::{Attached, Attachment};
use latsch::fmi::archive::ModelLibrary;
use latsch::fmi::check::{Options, check};
use latsch::fmi::corrected::{CorrectedBase, export_corrected, export_corrections};
use latsch::fmi::import::{Archive, ImportedFmu};
use latsch::model::{Causality, Interface, Kind, Native, Settings, Slave};
use latsch::rig::RingBrushWheel;
use latsch::shipped::MODELS;
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;
use zip::CompressionMethod;
use zip::write::{SimpleFileOptions, ZipWriter};

const WHEEL: &str = r#"
[parameters]
hub_mass = { value = 31.5, low = 30.0, high = 33.0 }

[[effect]]
id = "relaxation-length"
target = "force_y"
drivers = ["velocity_x"]
parameters.length = "20 cm"

[[effect]]
id = "sensor-delay"
target = "force_z"
[effect.parameters]
delay = { value = 7.5, unit = "ms", low = 7, high = 8, max = 20 }

[[effect]]
id = "coulomb-friction"
target = "axle_force_z"
drivers = ["rate(position_z)"]
parameters = { force = { value = 40.0, unit = "N" }, velocity = 0.1 }
"#;

const INTEGRATOR: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="Integrator &amp; more" guid="{integrator}" generationTool="hand">
  <CoSimulation modelIdentifier="integrator" canHandleVariableCommunicationStepSize="true"
      canInterpolateInputs="true" canGetAndSetFMUstate="true" canSerializeFMUstate="true"/>
  <UnitDefinitions><Unit name="furlong"/><Unit name="m/s"><BaseUnit m="1" s="-1"/></Unit></UnitDefinitions>
  <TypeDefinitions><SimpleType name="M"><Enumeration>
    <Item name="slow" value="1"/><Item name="fast" value="2"/></Enumeration></SimpleType></TypeDefinitions>
  <LogCategories><Category name="logStatus"/></LogCategories>
  <DefaultExperiment stopTime="1" stepSize="0.01"/>
  <ModelVariables>
    <ScalarVariable name="u" valueReference="0" causality="input"><Real start="0" unit="m/s"/></ScalarVariable>
    <ScalarVariable name="y" valueReference="1" causality="output"><Real unit="furlong"/></ScalarVariable>
    <ScalarVariable name="k" valueReference="2" causality="parameter" variability="fixed"><Real start="2"/></ScalarVariable>
    <ScalarVariable name="count" valueReference="0" causality="parameter" variability="tunable"><Integer start="3"/></ScalarVariable>
    <ScalarVariable name="steps" valueReference="1" causality="output" variability="discrete"><Integer/></ScalarVariable>
    <ScalarVariable name="mode" valueReference="2" causality="parameter" variability="fixed"><Enumeration declaredType="M" start="1"/></ScalarVariable>
    <ScalarVariable name="flag" valueReference="0" causality="parameter" variability="fixed"><Boolean start="true"/></ScalarVariable>
    <ScalarVariable name="mood" valueReference="0" causality="parameter" variability="tunable"><String start="good"/></ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs><Unknown index="2"/><Unknown index="5"/></Outputs>
    <InitialUnknowns><Unknown index="2"/><Unknown index="5"/></InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
"#;

const BENT: &str = r#"
[parameters]
k = 3.0

[[effect]]
id = "sensor-delay"
target = "y"
parameters.delay = 0.025

[[effect]]
id = "coulomb-friction"
target = "u"
drivers = ["y"]
parameters = { force = 0.3, velocity = 0.1 }
"#;

/// The integrator of tests/data, packed with a description.
fn integrator(folder: &Path, description: &str) -> PathBuf {
    let binary = folder.join("integrator.so");
    let status = Command::new("cc")
        .args(["-shared", "-fPIC", "-O1", "-Wall", "-Wextra", "-Werror", "-DPOLITE", "-o"])
        .arg(&binary)
        .arg(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/integrator.c"))
        .arg("-lm")
        .status()
        .expect("a C compiler called cc, which Rust needs for linking too");
    assert!(status.success());
    let path = folder.join("integrator.fmu");
    let mut zip = ZipWriter::new(File::create(&path).unwrap());
    for (name, bytes) in [
        ("modelDescription.xml", description.as_bytes()),
        ("binaries/linux64/integrator.so", &fs::read(&binary).unwrap()),
        ("documentation/licenses/license.txt", b"do what you like"),
    ] {
        zip.start_file(name, SimpleFileOptions::default()).unwrap();
        zip.write_all(bytes).unwrap();
    }
    zip.finish().unwrap();
    path
}

fn attachments(interface: &Interface, text: &str) -> Vec<Attachment> {
    Corrections::parse(text, "corrected.toml").unwrap().attachments(interface).unwrap()
}

fn shipped(model: &str) -> CorrectedBase {
    CorrectedBase::Model(model.into(), Settings::default())
}

/// Exports what the text says and writes it to a file.
fn export(folder: &Path, base: &CorrectedBase, text: &str) -> PathBuf {
    let library = ModelLibrary::shipped(MODELS).unwrap();
    let corrections = Corrections::parse(text, "corrected.toml").unwrap();
    let path = folder.join("corrected.fmu");
    fs::write(&path, export_corrections(base, &corrections, &library, &[]).unwrap()).unwrap();
    path
}

/// The wheel with effects in this process.
fn wheel() -> Attached<Native<RingBrushWheel>> {
    let mut settings = Corrections::parse(WHEEL, "").unwrap().settings;
    settings.model = None;
    let inner = Native::<RingBrushWheel>::new(&settings).unwrap();
    let effects = attachments(inner.interface(), WHEEL);
    Attached::new(Box::new(inner), effects).unwrap()
}

fn begin(slave: &mut dyn Slave) {
    slave.start(0.0, None).unwrap();
    slave.finish_start().unwrap();
}

/// Steps with inputs that move; gives all real outputs and inner quantities at each point, as bits.
fn run(slave: &mut dyn Slave, steps: std::ops::Range<u32>, inputs: &[(&str, f64, f64)]) -> Vec<Vec<u64>> {
    let h = 1e-3;
    let names: Vec<usize> = (0..slave.interface().variables.len())
        .filter(|&i| {
            let v = &slave.interface().variables[i];
            v.kind == Kind::Real && matches!(v.causality, Causality::Output | Causality::Input)
        })
        .collect();
    steps
        .map(|k| {
            let time = f64::from(k) * h;
            for (name, level, swing) in inputs {
                let index = slave.find(name).unwrap();
                let at = |t: f64| level + swing * (37.0 * t).sin();
                slave.set(index, at(time)).unwrap();
                if k % 3 == 0 {
                    slave.set_rate(index, (at(time + h) - at(time)) / h).unwrap();
                }
            }
            slave.step(time, f64::from(k + 1) * h - time).unwrap();
            names.iter().map(|&i| slave.get(i).unwrap().to_bits()).collect()
        })
        .collect()
}

const WHEEL_INPUTS: &[(&str, f64, f64)] =
    &[("steer", 0.02, 0.02), ("brake_torque", 300.0, 200.0), ("axle_force_z", -3500.0, 500.0)];

/// All that a master does with a slave gives the bits of the twin in this process.
fn same_bits(path: &Path, twin: &mut dyn Slave, inputs: &[(&str, f64, f64)], changed: &str) {
    let load = || ImportedFmu::load(path).unwrap();
    let mut fmu = load();
    begin(twin);
    begin(&mut fmu);
    // the first derivative of an output that an effect changes is the difference over a step
    let output = twin.find(changed).unwrap();
    if fmu.description().capabilities.max_output_derivative_order > 0 {
        let ahead = fmu.output_derivative(output).unwrap();
        assert_eq!(ahead, twin.output_derivative(output).unwrap());
    }
    let whole = run(twin, 0..120, inputs);
    assert!(whole[60] != whole[119]);
    assert!(run(&mut fmu, 0..60, inputs) == whole[..60]);
    let saved = fmu.save().unwrap();
    assert!(run(&mut fmu, 60..120, inputs) == whole[60..]);

    // back, along another way first, and on
    fmu.restore(&saved).unwrap();
    let (name, level, swing) = inputs[0];
    assert!(run(&mut fmu, 60..80, &[(name, level + 0.5 * swing + 0.01, 0.0)]) != whole[60..80]);
    fmu.restore(&saved).unwrap();
    assert!(run(&mut fmu, 60..120, inputs) == whole[60..]);
    if fmu.description().capabilities.max_output_derivative_order > 0 {
        let rate = fmu.output_derivative(output).unwrap();
        assert_eq!(rate, twin.output_derivative(output).unwrap());
        let [from, to] = [118, 119].map(|k: usize| {
            let column = twin.interface().variables[..output]
                .iter()
                .filter(|v| {
                    v.kind == Kind::Real && matches!(v.causality, Causality::Output | Causality::Input)
                })
                .count();
            f64::from_bits(whole[k][column])
        });
        assert!((rate - (to - from) / 1e-3).abs() <= 1e-6 * rate.abs(), "{rate}");
    }

    // in another instance, from bytes; both run on side by side
    let bytes = fmu.serialize(&saved).unwrap();
    let mut other = load();
    begin(&mut other);
    let there = other.deserialize(&bytes).unwrap();
    other.restore(&there).unwrap();
    fmu.restore(&saved).unwrap();
    for k in 60..120 {
        assert!(run(&mut other, k..k + 1, inputs)[0] == whole[k as usize]);
        assert!(run(&mut fmu, k..k + 1, inputs)[0] == whole[k as usize]);
    }
    let mut damaged = bytes.clone();
    damaged[bytes.len() / 2] ^= 1;
    assert!(other.deserialize(&damaged).is_err());

    // from the beginning
    fmu.reset().unwrap();
    begin(&mut fmu);
    assert!(run(&mut fmu, 0..60, inputs) == whole[..60]);
}

#[track_caller]
fn clean(path: &Path) {
    let program = Some(env!("CARGO_BIN_EXE_latsch").into());
    let report = check(path, &Options { program, timeout: Duration::from_secs(60) }).unwrap();
    let texts: Vec<String> = report.findings.iter().map(|f| f.as_text()).collect();
    assert!(texts.is_empty(), "{}", texts.join("\n"));
    assert!(report.notes.is_empty() && report.checks.len() > 30, "{:?}", report.notes);
}

#[test]
fn a_shipped_model_with_effects_is_the_attached_model() {
    let folder = tempfile::tempdir().unwrap();
    let path = export(folder.path(), &shipped("ring-brush-wheel"), WHEEL);
    let fmu = ImportedFmu::load(&path).unwrap();
    assert_eq!(fmu.interface().name, "ring-brush-wheel-corrected");
    let names = |i: &Interface| i.variables.iter().map(|v| v.name.clone()).collect::<Vec<_>>();
    assert_eq!(names(fmu.interface()), names(wheel().interface()));
    let delay = &fmu.interface().variables[fmu.find("effect.sensor_delay.force_z.delay").unwrap()];
    assert_eq!((delay.unit.as_deref(), delay.max), (Some("s"), Some(0.02)));
    assert!(fmu.interface().description.ends_with("Coulomb friction on axle_force_z"));
    assert!(fmu.description().capabilities.can_serialize_state);
    same_bits(&path, &mut wheel(), WHEEL_INPUTS, "force_z");
}

#[test]
fn effects_do_something_and_their_parameters_can_be_set() {
    let folder = tempfile::tempdir().unwrap();
    let path = export(folder.path(), &shipped("ring-brush-wheel"), WHEEL);
    let mut fmu = ImportedFmu::load(&path).unwrap();
    let mut settings = Corrections::parse(WHEEL, "").unwrap().settings;
    settings.model = None;
    let mut plain = Native::<RingBrushWheel>::new(&settings).unwrap();
    begin(&mut plain);
    let bare = run(&mut plain, 0..40, WHEEL_INPUTS);
    begin(&mut fmu);
    assert!(run(&mut fmu, 0..40, WHEEL_INPUTS) != bare);
    fmu.reset().unwrap();
    for (name, off) in [
        ("effect.sensor_delay.force_z.delay", 0.0),
        ("effect.relaxation_length.force_y.length", 0.0),
        ("effect.coulomb_friction.axle_force_z.force", 0.0),
    ] {
        let index = fmu.find(name).unwrap();
        fmu.set(index, off).unwrap();
    }
    begin(&mut fmu);
    assert!(run(&mut fmu, 0..40, WHEEL_INPUTS) == bare);
    let index = fmu.find("effect.sensor_delay.force_z.delay").unwrap();
    assert!(fmu.set(index, 0.001).unwrap_err().to_string().contains("after initialization"));
}

#[test]
fn a_foreign_fmu_inside_ours_is_the_attached_fmu() {
    let folder = tempfile::tempdir().unwrap();
    let original = integrator(folder.path(), INTEGRATOR);
    let path = export(folder.path(), &CorrectedBase::Fmu(original.clone()), BENT);
    let mut inner = ImportedFmu::load(&original).unwrap();
    let k = inner.find("k").unwrap();
    inner.set(k, 3.0).unwrap();
    let effects = attachments(inner.interface(), BENT);
    let mut twin = Attached::new(Box::new(inner), effects).unwrap();
    same_bits(&path, &mut twin, &[("u", 0.4, 0.5)], "y");

    let mut fmu = ImportedFmu::load(&path).unwrap();
    assert_eq!(fmu.interface().name, "Integrator & more-corrected");
    let c = fmu.description().capabilities;
    assert!(c.can_interpolate_inputs && c.can_serialize_state && !c.can_be_instantiated_once);
    assert_eq!(c.max_output_derivative_order, 0);
    let index = |name: &str| fmu.interface().index(name).unwrap();
    let (k, mode, mood, count) = (index("k"), index("mode"), index("mood"), index("count"));
    assert_eq!(fmu.interface().variables[k].start, Some(latsch::model::Value::Real(3.0)));
    fmu.set(mode, 2.0).unwrap();
    begin(&mut fmu);
    assert_eq!((fmu.get(k).unwrap(), fmu.get(mode).unwrap()), (3.0, 2.0));
    // the words of the original reach the master
    fmu.set_text(mood, "error").unwrap();
    let error = fmu.step(0.0, 0.01).unwrap_err().to_string();
    assert!(error.contains("bad mood"), "{error}");
    fmu.reset().unwrap();
    begin(&mut fmu);
    assert_eq!((fmu.get(k).unwrap(), fmu.get(mode).unwrap(), fmu.get(count).unwrap()), (3.0, 1.0, 3.0));

    // what belongs to the original is there
    let mut archive = Archive::open(&path).unwrap();
    let mut read = |name: &str| archive.read(name, 1 << 20).unwrap();
    assert_eq!(read("resources/original/modelDescription.xml").unwrap(), INTEGRATOR.as_bytes());
    assert_eq!(read("documentation/original/licenses/license.txt").unwrap(), b"do what you like");
    assert!(read("documentation/licenses/LICENSE-MIT").is_some());
}

#[test]
fn an_fmu_that_can_less_makes_one_that_can_less() {
    let folder = tempfile::tempdir().unwrap();
    let less = INTEGRATOR.replace(
        "canInterpolateInputs=\"true\" canGetAndSetFMUstate=\"true\" canSerializeFMUstate=\"true\"",
        "canBeInstantiatedOnlyOncePerProcess=\"true\"",
    );
    let original = integrator(folder.path(), &less);
    let path = export(folder.path(), &CorrectedBase::Fmu(original), BENT);
    let mut fmu = ImportedFmu::load(&path).unwrap();
    let c = fmu.description().capabilities;
    // derivatives of inputs are the wrapper's own
    assert!(c.can_interpolate_inputs && !c.can_get_and_set_state && !c.can_serialize_state);
    assert!(c.can_be_instantiated_once);
    begin(&mut fmu);
    let u = fmu.find("u").unwrap();
    fmu.set(u, 1.0).unwrap();
    fmu.step(0.0, 0.01).unwrap();
    assert!(fmu.save().is_err());
}

/// y' = k u with u = t: what runs straight is integrated exactly, though the FMU holds its inputs; with a play of b in the
/// input, y' = k (t - b).
#[test]
fn a_slave_that_holds_its_inputs_gets_what_they_are_in_the_middle() {
    let folder = tempfile::tempdir().unwrap();
    let less = INTEGRATOR.replace("canInterpolateInputs=\"true\"", "");
    let original = integrator(folder.path(), &less);
    let play = "[[effect]]\nid = \"play\"\ntarget = \"u\"\nparameters.gap = 0.1\n";
    let inside = |effects: &str| -> Box<dyn Slave> {
        let inner = ImportedFmu::load(&original).unwrap();
        assert!(!inner.can_interpolate());
        let effects = attachments(inner.interface(), effects);
        Box::new(Attached::new(Box::new(inner), effects).unwrap())
    };
    // and so as an FMU
    let exported: Box<dyn Slave> = Box::new(
        ImportedFmu::load(&export(folder.path(), &CorrectedBase::Fmu(original.clone()), play)).unwrap(),
    );
    for (mut slave, gap) in [(inside(""), 0.0), (inside(play), 0.1), (exported, 0.1)] {
        begin(slave.as_mut());
        let [u, y] = ["u", "y"].map(|name| slave.interface().index(name).unwrap());
        for step in 0..10 {
            let time = f64::from(step) * 0.1;
            slave.set_all(&[u], &[time], &[1.0]).unwrap();
            slave.step(time, 0.1).unwrap();
            let end = time + 0.1;
            assert!((slave.get(u).unwrap() - end).abs() < 1e-12);
            let moved = (end - gap).max(0.0);
            assert!((slave.get(y).unwrap() - moved * moved).abs() < 1e-12, "{gap}: {end}");
        }
    }
}

#[test]
fn our_own_fmus_can_be_carried_too_even_twice() {
    let folder = tempfile::tempdir().unwrap();
    let library = ModelLibrary::shipped(MODELS).unwrap();
    let base = folder.path().join("wheel.fmu");
    fs::write(&base, library.fmu("ring-brush-wheel", &Settings::default(), &[]).unwrap()).unwrap();
    let once = export(folder.path(), &CorrectedBase::Fmu(base), WHEEL);
    same_bits(&once, &mut wheel(), WHEEL_INPUTS, "force_y");

    let again = "[[effect]]\nid = \"sensor-delay\"\ntarget = \"velocity_x\"\nparameters.delay = 0.0025";
    let inside = folder.path().join("once.fmu");
    fs::rename(&once, &inside).unwrap();
    let twice = export(folder.path(), &CorrectedBase::Fmu(inside), again);
    let effects = attachments(wheel().interface(), again);
    let mut twin = Attached::new(Box::new(wheel()), effects).unwrap();
    same_bits(&twice, &mut twin, WHEEL_INPUTS, "velocity_x");
}

#[test]
fn the_check_finds_nothing() {
    let folder = tempfile::tempdir().unwrap();
    clean(&export(folder.path(), &shipped("ring-brush-wheel"), WHEEL));
    let original = integrator(folder.path(), INTEGRATOR);
    clean(&export(folder.path(), &CorrectedBase::Fmu(original), BENT));
}

#[test]
fn the_file_of_a_fit_gives_the_same_fmu() {
    let folder = tempfile::tempdir().unwrap();
    let library = ModelLibrary::shipped(MODELS).unwrap();
    let base = shipped("ring-brush-wheel");
    let interface = base.interface(&library).unwrap();
    let effects = attachments(&interface, WHEEL);
    let parameters = [("hub_mass".to_string(), 31.5)];
    let direct = export_corrected(&base, &parameters, &effects, Some(2e-4), &library, &[]).unwrap();
    let fitted = [Fitted { name: "hub_mass".into(), value: 31.5, interval: Some((30.0, 33.0)) }];
    let intervals = [vec![Some((0.19, 0.21))], vec![], vec![None, Some((0.09, 0.11))]];
    let text = corrected_text(&interface, &fitted, &effects, &intervals, Some(2e-4)).unwrap();
    assert!(text.contains("hub_mass = { value = 31.5, low = 30.0, high = 33.0 } # "), "{text}");
    assert!(text.contains(
        "length = { value = 0.2, unit = \"m\", low = 0.19, high = 0.21, min = 0.0, max = 5.0 } # "
    ));
    let corrections = Corrections::parse(&text, "corrected.toml").unwrap();
    assert!(export_corrections(&base, &corrections, &library, &[]).unwrap() == direct);
    // masters are proposed the step that it was fitted with
    assert!(text.contains("[simulation]\ncommunication_step = 0.0002 # [s]"), "{text}");
    let path = folder.path().join("direct.fmu");
    fs::write(&path, direct).unwrap();
    assert_eq!(ImportedFmu::load(&path).unwrap().interface().communication_step, 2e-4);

    // nothing but parameters: the model's ordinary FMU
    let plain = export_corrected(&base, &parameters, &[], Some(2e-4), &library, &[]).unwrap();
    let settings = Settings::parse("[parameters]\nhub_mass = 31.5", "").unwrap();
    assert!(plain == library.fmu("ring-brush-wheel", &settings, &[]).unwrap());
}

#[test]
fn refuses_with_a_reason() {
    let folder = tempfile::tempdir().unwrap();
    let library = ModelLibrary::shipped(MODELS).unwrap();
    let refused = |base: &CorrectedBase, text: &str, words: &[&str]| {
        let corrections = Corrections::parse(text, "c.toml");
        let error = corrections.and_then(|c| export_corrections(base, &c, &library, &[])).unwrap_err();
        for word in words {
            assert!(error.to_string().contains(word), "{word:?} is not in: {error}");
        }
    };
    let base = shipped("ring-brush-wheel");
    let effect = |rest: &str| format!("model = \"ring-brush-wheel\"\n\n[[effect]]\n{rest}");
    refused(
        &base,
        "[simulation]\ncommunication_step = 1e-4\n",
        &["c.toml: [simulation]", "there are none ([[effect]])"],
    );
    for (rest, words) in [
        (
            "id = \"sensor-delay\"\ntarget = \"force_y\"\nparameters.delay = 0.1\n\n[simulation]\ncommunication_step = 0.0",
            &["c.toml:9: communication_step has to be a positive time"][..],
        ),
        ("id = 1", &["c.toml:4", "string"][..]),
        ("id = \"magic\"\ntarget = \"force_y\"", &["c.toml:3: effect magic", "sensor-delay"]),
        ("id = \"sensor-delay\"\ntarget = \"force_q\"", &["c.toml:3", "\"force_q\"", "did you mean"]),
        ("id = \"sensor-delay\"\ntarget = \"steer\"\nparameters.delay = 0.1", &["a real output", "steer"]),
        ("id = \"sensor-delay\"\ntarget = \"force_y\"", &["delay is missing"]),
        (
            "id = \"sensor-delay\"\ntarget = \"force_y\"\nparameters.dealy = 1",
            &["c.toml:6", "no parameter dealy"],
        ),
        (
            "id = \"sensor-delay\"\ntarget = \"force_y\"\nparameters.delay = \"1 kg\"",
            &["c.toml:6: delay", "\"s\""],
        ),
        (
            "id = \"sensor-delay\"\ntarget = \"force_y\"\nparameters.delay = -0.1",
            &["c.toml:6: delay", "range"],
        ),
        ("id = \"sensor-delay\"\ntarget = \"force_y\"\nparameters.delay = nan", &["c.toml:6", "finite"]),
        (
            "id = \"sensor-delay\"\ntarget = \"force_y\"\nparameters.delay = {value = 0.1, hi = 1}",
            &["key hi"],
        ),
        ("id = \"sensor-delay\"\ntarget = \"force_y\"\ncolour = 1\n", &["c.toml:6", "colour"]),
        ("id = \"relaxation-length\"\ntarget = \"force_y\"", &["drivers", "TravelSpeed"]),
        ("id = \"relaxation-length\"\ntarget = \"force_y\"\ndrivers = [\"rate(nothing)\"]", &["\"nothing\""]),
    ] {
        refused(&base, &effect(rest), words);
    }
    refused(&base, "model = \"other\"", &["for the model \"other\""]);
    refused(&base, "[parameters]\nhub_mass = -1", &["c.toml:2", "hub_mass"]);
    refused(&base, "[parameters]\nhub_mass = { low = 1 }", &["c.toml:2", "no value"]);
    let twice = "[[effect]]\nid = \"sensor-delay\"\ntarget = \"force_y\"\nparameters.delay = 0.1\n".repeat(2);
    refused(&base, &twice, &["attached twice"]);
    let error = Settings::parse(&twice, "tire.toml").unwrap_err().to_string();
    assert!(error.contains("--effects"), "{error}");

    refused(&CorrectedBase::Fmu(folder.path().join("none.fmu")), "", &["none.fmu"]);
    let original = integrator(folder.path(), INTEGRATOR);
    let base = CorrectedBase::Fmu(original);
    refused(&base, "[parameters]\nz = 1", &["\"z\""]);
    let corrections = Corrections::parse(BENT, "c.toml").unwrap();
    let binary = format!("win64={}", folder.path().join("x.dll").display());
    fs::write(folder.path().join("x.dll"), b"MZ").unwrap();
    let error = export_corrections(&base, &corrections, &library, &[binary.parse().unwrap()]).unwrap_err();
    assert!(error.to_string().contains("win64"), "{error}");
}

#[test]
fn resources_that_do_not_belong_together_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let original = integrator(folder.path(), INTEGRATOR);
    let path = export(folder.path(), &CorrectedBase::Fmu(original), BENT);
    let mut archive = Archive::open(&path).unwrap();
    let names = [
        "modelDescription.xml",
        "resources/model.toml",
        "resources/original.toml",
        "resources/original/modelDescription.xml",
        "resources/original/binaries/linux64/integrator.so",
        "binaries/linux64/Integrator___more_corrected.so",
    ];
    let files: Vec<Vec<u8>> =
        names.iter().map(|name| archive.read(name, 1 << 30).unwrap().expect(name)).collect();
    for (spoiled, from, to, words) in [
        (1, "value = 0.3", "value = 0.4", "GUID"),
        (2, "canGetAndSet", "canGetAndSet", ""),
        (2, "step_size = 0.01", "step_size = 0.02", "GUID"),
        (2, "[", "[[", "original.toml"),
        (1, "original = true", "original = 3", "model.toml"),
        (1, "coulomb-friction", "coulomb-fiction", "coulomb-fiction"),
        (4, "\u{7f}ELF", "\u{7f}elf", "carries"),
    ] {
        let mut zip = ZipWriter::new(File::create(folder.path().join("spoiled.fmu")).unwrap());
        for (i, (name, content)) in names.iter().zip(&files).enumerate() {
            let stored = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
            zip.start_file(*name, stored).unwrap();
            let mut content = content.clone();
            if i == spoiled && i < 4 {
                content = String::from_utf8(content).unwrap().replacen(from, to, 1).into_bytes();
            } else if i == spoiled {
                content[..4].copy_from_slice(to.as_bytes());
            }
            zip.write_all(&content).unwrap();
        }
        zip.finish().unwrap();
        let loaded = ImportedFmu::load(&folder.path().join("spoiled.fmu"));
        match words {
            "" => assert!(loaded.is_ok()),
            words => {
                let error = loaded.err().expect(from).to_string();
                assert!(error.contains(words), "{words:?} is not in: {error}");
            }
        }
    }
}

#[test]
fn inputs_with_effects_run_on_with_their_rates() {
    let text = "[[effect]]\nid = \"coulomb-friction\"\ntarget = \"axle_force_z\"\ndrivers = [\"velocity_z\"]\n\
                parameters = { force = 0.0, velocity = 0.1 }";
    let mut plain = Native::<RingBrushWheel>::new(&Settings::default()).unwrap();
    let inner = Native::<RingBrushWheel>::new(&Settings::default()).unwrap();
    let effects = attachments(inner.interface(), text);
    let mut with = Attached::new(Box::new(inner), effects).unwrap();
    let (force, height) = (plain.find("axle_force_z").unwrap(), plain.find("position_z").unwrap());
    let slaves: [&mut dyn Slave; 2] = [&mut plain, &mut with];
    let ends = slaves.map(|slave| {
        begin(slave);
        // the order of the two does not matter
        slave.set_rate(force, 20_000.0).unwrap();
        slave.set(force, -4000.0).unwrap();
        for k in 0..20 {
            slave.step(f64::from(k) * 1e-3, 1e-3).unwrap();
        }
        (slave.get(force).unwrap(), slave.get(height).unwrap())
    });
    assert!((ends[1].0 - -3600.0).abs() < 1e-6, "{ends:?}");
    assert!((ends[0].0 - ends[1].0).abs() < 1e-6 && (ends[0].1 - ends[1].1).abs() < 1e-12, "{ends:?}");
    assert!(with.set_rate(force, f64::NAN).is_err() && with.set_rate(height, 1.0).is_err());
}
