//! What is left when the program is told to end: nothing, and it ends by the signal that it got.

use super::files::unit;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// Longer than anything here takes on a machine that does much else.
const PATIENCE: Duration = Duration::from_secs(120);

fn wait_for<T>(what: &str, mut look: impl FnMut() -> Option<T>) -> T {
    let begin = Instant::now();
    loop {
        if let Some(found) = look() {
            return found;
        }
        assert!(begin.elapsed() < PATIENCE, "waited in vain for {what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect()
}

fn start(arguments: &[&str], temporary: &Path, ignored: &str) -> Child {
    // a test runner may ignore signals, which a shell could not undo, and its trap says what the program ignores
    let mut command = Command::new("env");
    command.args(["--default-signal=INT,TERM,HUP", "sh", "-c", &format!("trap '' {ignored}; exec \"$@\"")]);
    command.args(["sh", env!("CARGO_BIN_EXE_latsch")]);
    command.args(arguments).env("TMPDIR", temporary).current_dir(temporary);
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
}

fn send(signal: &str, child: &Child) {
    let status = Command::new("kill").args(["-s", signal, &child.id().to_string()]).status().unwrap();
    assert!(status.success());
}

fn end_of(child: &mut Child) -> ExitStatus {
    wait_for("the end", || child.try_wait().unwrap())
}

/// Processes whose arguments name the folder.
fn processes_with(folder: &Path) -> Vec<String> {
    let name = folder.to_string_lossy().into_owned();
    let all = std::fs::read_dir("/proc").unwrap().flatten();
    let arguments = all.filter_map(|entry| std::fs::read(entry.path().join("cmdline")).ok());
    arguments.map(|a| String::from_utf8_lossy(&a).into_owned()).filter(|a| a.contains(&name)).collect()
}

#[test]
fn temporary_folders_go_with_the_program() {
    let folder = tempfile::tempdir().unwrap();
    let fmu = unit(folder.path(), &["-DHANG"], |binary| binary);
    let system = folder.path().join("system.toml");
    std::fs::write(&system, "stop = 1\nstep = 0.01\n[component.a]\nfmu = \"integrator.fmu\"\n").unwrap();
    let (fmu, system) = (fmu.to_str().unwrap(), system.to_str().unwrap());
    let output = folder.path().join("results.csv");
    let output = output.to_str().unwrap();
    for (arguments, folders, signal, number) in [
        (vec!["simulate", fmu, "--output", output], 1, "INT", libc::SIGINT),
        (vec!["simulate", fmu, "--output", output], 1, "TERM", libc::SIGTERM),
        (vec!["cosimulate", system, "--output", output], 1, "INT", libc::SIGINT),
        (vec!["check", fmu, "--timeout", "1000"], 2, "INT", libc::SIGINT),
        (vec!["check", fmu, "--timeout", "1000"], 2, "TERM", libc::SIGTERM),
        (vec!["check", fmu, "--timeout", "1000"], 2, "HUP", libc::SIGHUP),
    ] {
        let temporary = tempfile::tempdir().unwrap();
        let mut child = start(&arguments, temporary.path(), "USR1");
        wait_for("temporary folders", || (names(temporary.path()).len() == folders).then_some(()));
        if folders == 2 {
            let marked = |p: &String| p.contains("--child");
            wait_for("a child", || processes_with(temporary.path()).iter().any(marked).then_some(()));
        }
        send(signal, &child);
        assert_eq!(end_of(&mut child).signal(), Some(number), "{arguments:?}");
        assert_eq!(names(temporary.path()), [] as [String; 0], "{arguments:?}");
        assert_eq!(processes_with(temporary.path()), [] as [String; 0], "{arguments:?}");
        assert!(!Path::new(output).exists());
        let mut told = String::new();
        std::io::Read::read_to_string(&mut child.stderr.take().unwrap(), &mut told).unwrap();
        assert_eq!(told, "", "{arguments:?}");
    }
}

#[test]
fn signals_that_are_ignored_stay_ignored() {
    let folder = tempfile::tempdir().unwrap();
    let fmu = unit(folder.path(), &["-DHANG"], |binary| binary);
    let temporary = tempfile::tempdir().unwrap();
    let arguments = ["simulate", fmu.to_str().unwrap(), "--output", "results.csv"];
    let mut child = start(&arguments, temporary.path(), "INT HUP");
    wait_for("a temporary folder", || (names(temporary.path()).len() == 1).then_some(()));
    send("INT", &child);
    send("HUP", &child);
    // what ends it comes after them
    send("TERM", &child);
    assert_eq!(end_of(&mut child).signal(), Some(libc::SIGTERM));
    assert_eq!(names(temporary.path()), [] as [String; 0]);
}
