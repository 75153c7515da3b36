//! Puts the library that goes into FMUs into the program, where nothing else would put it beside the program.
//!
//! In a checkout that library is a package of its own (`fmu-template`), which cargo builds beside the program. A package by itself,
//! as `cargo install` takes it from a registry, has only this program, so its library is built here: the same crate without the
//! feature `host`. `LATSCH_LIBRARY_INSIDE` asks for it (`1`) or declines it (`0`) anywhere.

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::{env, fs};

const ASKED: &str = "LATSCH_LIBRARY_INSIDE";
const SOURCE: &str = "latsch::export_fmus!(entries: latsch::shipped::MODELS);\n";
/// As in the Cargo.toml of the program.
const PROFILES: &str = "[profile.release]\nlto = \"fat\"\ncodegen-units = 1\nstrip = true\n\n\
    [profile.dev]\nopt-level = 1\ndebug = false\nstrip = \"debuginfo\"\n";

fn main() -> ExitCode {
    println!("cargo::rustc-check-cfg=cfg(library_inside)");
    println!("cargo::rerun-if-env-changed={ASKED}");
    println!("cargo::rerun-if-changed=build.rs");
    // without the program there is nobody to carry it, and the library itself is built that way
    if env::var_os("CARGO_FEATURE_HOST").is_none() {
        return ExitCode::SUCCESS;
    }
    match wanted().and_then(|wanted| if wanted { build().map(Some) } else { Ok(None) }) {
        Ok(None) => {}
        Ok(Some(library)) => {
            println!("cargo::rustc-cfg=library_inside");
            println!("cargo::rustc-env=LATSCH_LIBRARY_FILE={}", library.display());
        }
        Err(what) => {
            println!(
                "cargo::error=the library that goes into FMUs could not be built: {what}. With {ASKED}=0 the program is built \
                without it, and exports with a library that it is told"
            );
            return ExitCode::FAILURE;
        }
    }
    ExitCode::SUCCESS
}

fn variable(name: &str) -> Result<String, String> {
    env::var(name).map_err(|e| format!("{name}: {e}"))
}

/// Whether the program is to carry the library.
fn wanted() -> Result<bool, String> {
    match env::var(ASKED).as_deref() {
        Ok("1") => Ok(true),
        Ok("0") => Ok(false),
        Ok(other) => Err(format!("{ASKED}={other} is neither 1 nor 0")),
        Err(_) => {
            let checkout =
                Path::new(&variable("CARGO_MANIFEST_DIR")?).join("fmu-template/Cargo.toml").is_file();
            Ok(!checkout && variable("PROFILE")? == "release")
        }
    }
}

/// The library, built of these sources for the program's target, with the versions of the package's lock file.
fn build() -> Result<PathBuf, String> {
    let sources = PathBuf::from(variable("CARGO_MANIFEST_DIR")?);
    let (profile, target) = (variable("PROFILE")?, variable("TARGET")?);
    let here = PathBuf::from(variable("OUT_DIR")?).join("library");
    for watched in ["src", "Cargo.toml", "Cargo.lock"] {
        println!("cargo::rerun-if-changed={watched}");
    }
    let write = |name: &str, text: &str| {
        let path = here.join(name);
        fs::create_dir_all(path.parent().unwrap_or(&here))
            .and_then(|()| fs::write(&path, text))
            .map_err(|e| format!("{}: {e}", path.display()))
    };
    // in a basic string of TOML, which unlike a literal one takes an apostrophe too
    let path = sources.display().to_string().replace('\\', "\\\\").replace('"', "\\\"");
    write(
        "Cargo.toml",
        &format!(
            "[package]\nname = \"latsch-fmu\"\nversion = \"{}\"\nedition = \"2024\"\n\n[lib]\ncrate-type = [\"cdylib\"]\n\n\
            [dependencies]\nlatsch = {{ path = \"{path}\", default-features = false }}\n\n{PROFILES}\n[workspace]\n",
            variable("CARGO_PKG_VERSION")?
        ),
    )?;
    write("src/lib.rs", SOURCE)?;
    let lock = sources.join("Cargo.lock");
    write("Cargo.lock", &fs::read_to_string(&lock).map_err(|e| format!("{}: {e}", lock.display()))?)?;

    let mut cargo = Command::new(variable("CARGO")?);
    // with the versions of the lock file: where the program is installed with others, these are fetched
    let as_built = if profile == "release" { "release" } else { "dev" };
    cargo.args(["build", "--profile", as_built, "--target", &target]);
    // that it is built with the feature `host` is said of this package, and not of those below it, the same one among them
    for (name, _) in env::vars_os().filter(|(name, _)| name.to_string_lossy().starts_with("CARGO_FEATURE_")) {
        cargo.env_remove(name);
    }
    cargo.current_dir(&here).env("CARGO_TARGET_DIR", here.join("target")).env(ASKED, "0");
    let done = cargo.output().map_err(|e| format!("cargo: {e}"))?;
    if !done.status.success() {
        return Err(String::from_utf8_lossy(&done.stderr).trim().replace('\n', " "));
    }
    let named = match variable("CARGO_CFG_TARGET_OS")?.as_str() {
        "windows" => "latsch_fmu.dll",
        "macos" => "liblatsch_fmu.dylib",
        _ => "liblatsch_fmu.so",
    };
    let library = here.join("target").join(&target).join(&profile).join(named);
    if library.is_file() { Ok(library) } else { Err(format!("{}: not there", library.display())) }
}
