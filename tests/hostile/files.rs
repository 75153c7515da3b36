//! Archives and libraries that are not what they say, files that are no files, and text that a terminal obeys.

use super::in_time;
use latsch::cosimulate::read_system;
use latsch::fmi::check::{Options, check};
use latsch::fmi::import::{Archive, ImportedFmu};
use latsch::recording::{read_csv, read_settings};
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::Duration;
use zip::CompressionMethod;
use zip::write::{SimpleFileOptions, ZipWriter};

const DESCRIPTION: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="Integrator" guid="{integrator}">
  <CoSimulation modelIdentifier="integrator" canHandleVariableCommunicationStepSize="true"/>
  <LogCategories><Category name="logStatus"/></LogCategories>
  <ModelVariables>
    <ScalarVariable name="u" valueReference="0" causality="input"><Real start="0"/></ScalarVariable>
    <ScalarVariable name="y" valueReference="1" causality="output"><Real/></ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="2"/></Outputs><InitialUnknowns><Unknown index="2"/></InitialUnknowns></ModelStructure>
</fmiModelDescription>
"#;

fn pack(path: &Path, files: &[(&str, &[u8])]) {
    let mut zip = ZipWriter::new(File::create(path).unwrap());
    for (name, bytes) in files {
        zip.start_file(*name, SimpleFileOptions::default()).unwrap();
        zip.write_all(bytes).unwrap();
    }
    zip.finish().unwrap();
}

/// The integrator as an FMU in the folder, with its binary changed.
pub fn unit(folder: &Path, options: &[&str], change: impl FnOnce(Vec<u8>) -> Vec<u8>) -> PathBuf {
    let binary = folder.join("integrator.so");
    let status = Command::new("cc")
        .args(["-shared", "-fPIC", "-O1", "-DPOLITE", "-o"])
        .arg(&binary)
        .arg(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/integrator.c"))
        .args(options)
        .arg("-lm")
        .status()
        .expect("a C compiler called cc, which Rust needs for linking too");
    assert!(status.success());
    let bytes = change(fs::read(&binary).unwrap());
    let path = folder.join("integrator.fmu");
    pack(
        &path,
        &[("modelDescription.xml", DESCRIPTION.as_bytes()), ("binaries/linux64/integrator.so", &bytes)],
    );
    path
}

/// Runs the program; a process of its own, which a crash ends.
fn latsch(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_latsch")).args(arguments).output().unwrap()
}

/// What the program says of arguments that it refuses.
fn refusal(arguments: &[&str]) -> String {
    let output = in_time(|| latsch(arguments));
    let told = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {:?} {told}", output.status);
    told
}

#[test]
fn damaged_libraries_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("results.csv");
    let refused = |change: &dyn Fn(Vec<u8>) -> Vec<u8>| {
        let fmu = unit(folder.path(), &[], change);
        let fmu = fmu.to_str().unwrap();
        let told = refusal(&["simulate", fmu, "--stop", "0.1", "--output", output.to_str().unwrap()]);
        assert!(told.contains("the binary cannot be loaded"), "{told}");
        let report = check(
            Path::new(fmu),
            &Options { program: Some(env!("CARGO_BIN_EXE_latsch").into()), timeout: Duration::from_secs(60) },
        )
        .unwrap();
        let finding = report.findings.iter().find(|f| f.rule == "Z3").unwrap_or_else(|| panic!("{report:?}"));
        assert!(finding.what.contains("the binary cannot be loaded"), "{}", finding.what);
        told
    };
    let whole = |bytes: Vec<u8>| bytes;
    let fmu = unit(folder.path(), &[], whole);
    ImportedFmu::load(&fmu).unwrap();
    let length = fs::metadata(folder.path().join("integrator.so")).unwrap().len() as usize;
    for share in [1, 2, 4, 8, 10, 12, 14, 15] {
        let told = refused(&|mut bytes| {
            bytes.truncate(length * share / 16);
            bytes
        });
        assert!(told.contains("cut off"), "{share}: {told}");
    }
    refused(&|mut bytes| {
        bytes.truncate(30);
        bytes
    });
    // the right length, but the end was never written
    let told = refused(&|mut bytes| {
        bytes[2000..].fill(0);
        bytes
    });
    assert!(told.contains("dynamic section"), "{told}");
    for (at, value, word) in [
        (4, 1, "another machine"),
        (5, 2, "another machine"),
        (18, 183, "another machine"),
        (16, 2, "no library"),
    ] {
        let told = refused(&|mut bytes| {
            bytes[at] = value;
            bytes
        });
        assert!(told.contains(word), "{told}");
    }
}

const SSV: &str = "<ParameterSet version=\"1.0\" name=\"p\"><Parameters><Parameter name=\"k\"><Real value=\"3\"/>\
    </Parameter></Parameters></ParameterSet>";

fn ssd(source: &str, parameters: &str) -> String {
    let bindings = match parameters {
        "" => String::new(),
        file => format!("<ParameterBindings><ParameterBinding source=\"{file}\"/></ParameterBindings>"),
    };
    format!(
        "<SystemStructureDescription version=\"1.0\"><System><Elements><Component name=\"a\" source=\"{source}\">\
         {bindings}</Component></Elements></System><DefaultExperiment startTime=\"0\" stopTime=\"1\"/>\
         </SystemStructureDescription>"
    )
}

#[test]
fn systems_in_archives_stay_in_them() {
    let folder = tempfile::tempdir().unwrap();
    let outside = folder.path().join("outside");
    fs::create_dir(&outside).unwrap();
    let fmu = unit(&outside, &[], |binary| binary);
    let values = outside.join("values.ssv");
    fs::write(&values, SSV).unwrap();
    let path = folder.path().join("system.ssp");
    let inner = fs::read(&fmu).unwrap();
    let read = |source: &str, parameters: &str| {
        let text = ssd(source, parameters);
        let files: &[(&str, &[u8])] = &[
            ("SystemStructure.ssd", text.as_bytes()),
            ("resources/in.fmu", &inner),
            ("resources/in.ssv", SSV.as_bytes()),
        ];
        pack(&path, files);
        read_system(&path)
    };
    for good in
        ["resources/in.fmu", "./resources/in.fmu", "resources/../resources/in.fmu", "resources/in%2Efmu"]
    {
        let file = read(good, "resources/in.ssv").unwrap_or_else(|e| panic!("{good}: {e}"));
        assert_eq!(file.plan.components[0].set.len(), 1);
        // found and loaded: what it lacks is the parameter
        let error = file.plan.load().err().unwrap().to_string();
        assert!(error.contains("has no variable \"k\""), "{good}: {error}");
    }
    let up = "../".repeat(20);
    for (file, name) in [(&fmu, "in.fmu"), (&values, "in.ssv")] {
        let absolute = file.to_str().unwrap();
        let good = format!("resources/{name}");
        for bad in [
            absolute.to_owned(),
            format!("file://{absolute}"),
            format!("file:{absolute}"),
            format!("{up}{}", &absolute[1..]),
            format!("resources/{up}{}", &absolute[1..]),
            format!("{}{}", up.replace("..", "%2e%2E"), &absolute[1..]),
            format!("%2F{}", &absolute[1..]),
            "..\\outside\\in.fmu".into(),
            "C:/outside/in.fmu".into(),
            "file://resources/in.fmu".into(),
        ] {
            let result = match name {
                "in.fmu" => read(&bad, ""),
                _ => read("resources/in.fmu", &bad),
            };
            let told =
                result.err().unwrap_or_else(|| panic!("{bad} was taken instead of {good}")).to_string();
            assert!(
                told.contains("is not in the archive") && told.contains("SystemStructure.ssd:1:"),
                "{told}"
            );
        }
    }
    // without an archive the files lie where their owner put them
    let path = folder.path().join("system.ssd");
    fs::write(&path, ssd("outside/integrator.fmu", values.to_str().unwrap())).unwrap();
    assert_eq!(read_system(&path).unwrap().plan.components[0].set.len(), 1);
}

#[test]
fn archives_whose_entries_overlap_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bomb.fmu");
    let mut zip = ZipWriter::new(File::create(&path).unwrap());
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    for name in ["a", "b"] {
        zip.start_file(name, options).unwrap();
        zip.write_all(b"the same").unwrap();
    }
    zip.finish().unwrap();
    Archive::open(&path).unwrap().unpack().unwrap();
    // both entries of the directory point to the first data
    let mut bytes = fs::read(&path).unwrap();
    let entry = bytes.windows(4).rposition(|w| w == b"PK\x01\x02").unwrap();
    bytes[entry + 42..entry + 46].fill(0);
    fs::write(&path, bytes).unwrap();
    let error = Archive::open(&path).and_then(|mut a| a.unpack()).unwrap_err().to_string();
    assert!(error.contains("overlap"), "{error}");
}

#[test]
fn pipes_folders_and_devices_are_no_files() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let text = |path: PathBuf| path.to_str().unwrap().to_owned();
    let output = text(at("results.csv"));
    let recordings = at("recordings");
    fs::create_dir(&recordings).unwrap();
    for pipe in [at("pipe.fmu"), at("pipe.ssp"), recordings.join("run.csv")] {
        // nobody writes to it: whoever opens it waits
        assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    }
    let fmu = text(at("pipe.fmu"));
    for arguments in [
        vec!["simulate", &fmu, "--output", &output],
        vec!["check", &fmu],
        vec!["cosimulate", &text(at("pipe.ssp")), "--output", &output],
        vec![
            "diagnose",
            "ring-brush-flat-track",
            "--recordings",
            &text(recordings),
            "--output",
            &text(at("d")),
        ],
    ] {
        let told = refusal(&arguments);
        assert!(told.contains("no ordinary file"), "{told}");
    }
    std::os::unix::fs::symlink("/dev/zero", at("endless.fmu")).unwrap();
    std::os::unix::fs::symlink("/dev/zero", at("endless.toml")).unwrap();
    std::os::unix::fs::symlink("/dev/zero", at("endless.ssd")).unwrap();
    for name in ["endless.fmu", "endless.toml", "endless.ssd"] {
        let told = match name {
            "endless.fmu" => refusal(&["check", &text(at(name))]),
            _ => refusal(&["cosimulate", &text(at(name)), "--output", &output]),
        };
        assert!(told.contains("no ordinary file") || told.contains("more than 16 MB"), "{told}");
    }
    let told = in_time(|| read_settings(Some(&at("endless.toml")))).unwrap_err().to_string();
    assert!(told.contains("more than 16 MB"), "{told}");
    for path in [folder.path().to_owned(), at("none")] {
        assert!(read_csv(&path).is_err() && read_settings(Some(&path)).is_err());
        assert!(ImportedFmu::load(&path).is_err());
    }
}

#[test]
fn files_that_say_that_they_are_long_are_not_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("system.toml");
    File::create(&path).unwrap().set_len(1 << 40).unwrap();
    for error in [read_settings(Some(&path)).unwrap_err(), read_system(&path).unwrap_err()] {
        assert!(error.to_string().contains("more than 16 MB"), "{error}");
    }
    let path = folder.path().join("run.csv");
    File::create(&path).unwrap().set_len(1 << 40).unwrap();
    let error = read_csv(&path).unwrap_err();
    assert!(error.to_string().contains("more than 4096 MB"), "{error}");
}

/// What reaches the terminal is lines of text.
fn assert_harmless(text: &str) {
    let wrong = |c: &char| {
        (c.is_control() && *c != '\n') || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    assert!(!text.chars().any(|c| wrong(&c)), "{:?}", &text[..text.len().min(3000)]);
}

#[test]
fn nothing_that_a_terminal_obeys_is_printed() {
    let folder = tempfile::tempdir().unwrap();
    let fmu = unit(folder.path(), &["-DLOUD"], |binary| binary);
    let output = folder.path().join("results.csv");
    let output = output.to_str().unwrap();
    let told = refusal(&["simulate", fmu.to_str().unwrap(), "--output", output]);
    assert_harmless(&told);
    assert!(
        told.len() < 3000 && told.contains("shortened") && told.contains("\\u{1b}[31m error: "),
        "{told}"
    );
    assert_eq!(told.lines().count(), 1, "{told}");

    let evil = "u&#x9b;2J&#x202e;&#10;error: none&#9;";
    for (from, to) in [
        ("name=\"u\"", format!("name=\"{evil}\"")),
        ("modelIdentifier=\"integrator\"", format!("modelIdentifier=\"{evil}\"")),
        ("causality=\"input\"", format!("causality=\"{evil}\"")),
        ("<LogCategories>", format!("<LogCategories {}=\"1\">", "u\u{9b}2J\u{202e}")),
        ("<ModelStructure>", "<Odd\u{9b}2J\u{202e}/><ModelStructure>".into()),
    ] {
        assert!(DESCRIPTION.contains(from), "{from}");
        let path = folder.path().join("evil.fmu");
        let binary = fs::read(folder.path().join("integrator.so")).unwrap();
        let text = DESCRIPTION.replace(from, &to);
        pack(
            &path,
            &[("modelDescription.xml", text.as_bytes()), ("binaries/linux64/integrator.so", &binary)],
        );
        let path = path.to_str().unwrap();
        for arguments in [
            vec!["check", path, "--no-run"],
            vec!["check", path, "--no-run", "--format", "json"],
            vec!["simulate", path, "--output", output],
        ] {
            let said = latsch(&arguments);
            for stream in [&said.stdout, &said.stderr] {
                assert_harmless(&String::from_utf8(stream.clone()).unwrap());
            }
            if arguments.len() == 5 && arguments[0] == "check" {
                let _: serde_json::Value = serde_json::from_slice(&said.stdout).unwrap();
            }
        }
    }
    let path = folder.path().join("evil\u{1b}[31m\n.toml");
    fs::write(&path, "[parameters]\n\"\u{9b}\\u001b[2J\\u202e\" = [1]\n").unwrap();
    let told = refusal(&[
        "simulate",
        "brake-hydraulics",
        "--parameters",
        path.to_str().unwrap(),
        "--output",
        output,
    ]);
    assert_harmless(&told);
    assert_eq!(told.lines().count(), 1, "{told}");
}
