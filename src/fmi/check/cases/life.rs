//! Cases: making and freeing an instance, a plain run, start values.

use super::*;
use crate::fmi::check::system;
use crate::fmi::import::slave::file_uri;

pub(super) fn functions(lab: &Lab<'_>) {
    let missing = lab.maker.functions.missing();
    if !missing.is_empty() {
        lab.reporter.error("M8", format!("the binary does not export {}", missing.join(", ")));
    }
    let [version, platform] = unit::names(&lab.maker.functions, lab.note);
    if let Some(version) = version
        && version != "2.0"
    {
        lab.reporter.error("V1", format!("fmi2GetVersion returned {version:?}; \"2.0\" was expected"));
    }
    if let Some(platform) = platform
        && platform != "default"
    {
        lab.reporter
            .error("V1", format!("fmi2GetTypesPlatform returned {platform:?}; \"default\" was expected"));
    }
    let f = &lab.maker.functions;
    if f.instantiate.is_none()
        || f.setup.is_none()
        || f.enter.is_none()
        || f.exit.is_none()
        || f.step.is_none()
    {
        lab.reporter.stop("the binary lacks functions that every run needs");
    }
}

pub(super) fn run(lab: &Lab<'_>) {
    let mut unit = match lab.maker.make(NAME, &lab.description.guid, &lab.resources) {
        Ok(unit) => unit,
        Err(messages) => {
            let why = messages
                .last()
                .map_or("there is no message".into(), |m| format!("its message is {:?}", m.text));
            lab.reporter
                .error("M0", format!("fmi2Instantiate with the description's GUID returned NULL; {why}"));
            return lab.reporter.stop("the FMU cannot be instantiated");
        }
    };
    for (name, status) in [
        ("fmi2SetupExperiment", unit.setup(lab.t(0), None)),
        ("fmi2EnterInitializationMode", unit.enter()),
        ("fmi2ExitInitializationMode", unit.exit()),
    ] {
        if status > 1 {
            lab.reporter
                .error("M0", format!("{name} returned {} with the start values of the FMU", word(status)));
            return lab.reporter.stop("the FMU cannot be initialized");
        }
    }
    start_values(lab, &mut unit);
    let end = lab.description.interface.stop_time;
    let mut k = 0;
    // A little of the experiment is enough; a slow FMU does less of it.
    while k < 1000 && !lab.late(0.3) && lab.t(k + 1) <= end + 0.01 * lab.h() {
        let status = unit.step(lab.t(k), lab.h());
        if status > 1 && k == 0 && many(lab.description) && steps_with_rollback(lab) {
            lab.reporter.error(
                "D5",
                format!(
                    "fmi2DoStep with noSetFMUStatePriorToCurrentPoint = fmi2True returned {}, with fmi2False it does not",
                    word(status)
                ),
            );
            return lab.reporter.stop("the FMU cannot be stepped where no rollback comes");
        }
        if status > 1 {
            let what = format!(
                "fmi2DoStep from {} s by {} s returned {} with the start values",
                lab.t(k),
                lab.h(),
                word(status)
            );
            lab.reporter.error("M0", what);
            return lab.reporter.stop("the FMU cannot be stepped");
        }
        k += 1;
    }
    for v in lab.variables().iter().filter(|v| v.is_real()) {
        let (status, value) = unit.get_real(v.reference);
        if status <= 1 && !value.is_finite() {
            lab.reporter.found(Found {
                rule: "D8".into(),
                level: Level::Warning,
                what: format!(
                    "{:?} is {value} after {k} steps, and fmi2GetReal returned {}",
                    v.name,
                    word(status)
                ),
                variable: Some(v.name.clone()),
                attribute: None,
            });
        } else if status > 1 {
            lab.reporter.found(Found {
                rule: "M0".into(),
                level: Level::Error,
                what: format!("reading {:?} between steps returned {}", v.name, word(status)),
                variable: Some(v.name.clone()),
                attribute: None,
            });
            return;
        }
    }
    let status = unit.terminate();
    if status > 1 {
        lab.reporter.error("M5", format!("fmi2Terminate after {k} steps returned {}", word(status)));
    }
}

/// True if the first step succeeds where rollback may come.
fn steps_with_rollback(lab: &Lab<'_>) -> bool {
    lab.ready().is_some_and(|mut unit| unit.step_as(lab.t(0), lab.h(), false) <= 1)
}

/// True if the value of the binary is the one that is written. 15 significant digits are enough: many tools
/// write no more, and two numbers that agree in those are half a unit of the last of them apart at most.
fn as_written(value: &Value, written: &Value) -> bool {
    match (value, written) {
        (Value::Real(a), Value::Real(b)) => {
            let size = a.abs().max(b.abs());
            let unit = 10f64.powf(size.log10().floor() - 14.0);
            a == b || (a - b).abs() <= 0.5 * unit + f64::EPSILON * size
        }
        _ => value == written,
    }
}

/// Start values of the binary are those of the description.
pub(super) fn start_values(lab: &Lab<'_>, unit: &mut Unit<'_>) {
    for v in lab.variables() {
        let certain = matches!(v.causality, Causality::Input | Causality::Parameter)
            || v.initial == Some(Initial::Exact) && v.causality != Causality::Independent;
        let Some(start) = v.start.as_ref().filter(|_| certain) else { continue };
        let (status, value) = match v.kind {
            Kind::Real => {
                let (status, value) = unit.get_real(v.reference);
                (status, Value::Real(value))
            }
            Kind::Integer | Kind::Enumeration(_) => {
                let (status, value) = unit.get_integer(v.reference);
                (status, Value::Integer(value))
            }
            Kind::Boolean => {
                let (status, value) = unit.get_boolean(v.reference);
                (status, Value::Boolean(value))
            }
            Kind::Text => {
                let (status, value) = unit.get_text(v.reference);
                (status, Value::Text(value))
            }
        };
        if status <= 1 && !as_written(&value, start) {
            lab.reporter.found(Found {
                rule: "X7".into(),
                level: Level::Error,
                what: format!(
                    "{:?} starts with {value} in the binary and with {start} in the description",
                    v.name
                ),
                variable: Some(v.name.clone()),
                attribute: Some("start".into()),
            });
        }
    }
}

pub(super) fn refused_instance(lab: &Lab<'_>, name: &str, guid: &str, what: &str) {
    match lab.maker.make(name, guid, &lab.resources) {
        Ok(unit) => {
            lab.reporter.report(lab.level, "S3", format!("fmi2Instantiate with {what} returned an instance"));
            unit.free();
        }
        Err(messages) if messages.is_empty() => {
            let what = format!("fmi2Instantiate with {what} returned NULL without a message");
            lab.reporter.report(lab.level, "S3", what);
        }
        Err(_) => {}
    }
}

pub(super) fn wrong_guid(lab: &Lab<'_>) {
    refused_instance(lab, NAME, "{00000000-0000-0000-0000-00000000c0de}", "a wrong GUID");
}

pub(super) fn blank_name(lab: &Lab<'_>) {
    let names = [("", "an empty name"), ("  ", "a name of spaces")];
    for (name, what) in names.into_iter().take(if many(lab.description) { 2 } else { 1 }) {
        refused_instance(lab, name, &lab.description.guid, what);
    }
}

pub(super) fn free_nothing(lab: &Lab<'_>) {
    lab.maker.nothing().free();
    if saves(lab.description)
        && let Some(mut unit) = lab.ready()
    {
        let status = unit.free_state(&mut ptr::null_mut());
        if status > 1 {
            lab.reporter.error(
                "S6",
                format!("fmi2FreeFMUstate of NULL returned {}; it has to do nothing", word(status)),
            );
        }
    }
}

pub(super) fn null_instance(lab: &Lab<'_>) {
    let mut unit = lab.maker.nothing();
    let statuses = [
        ("fmi2SetupExperiment", unit.setup(0.0, None)),
        ("fmi2EnterInitializationMode", unit.enter()),
        ("fmi2ExitInitializationMode", unit.exit()),
        ("fmi2SetReal", unit.set_real(0, 0.0)),
        ("fmi2GetReal", unit.get_real(0).0),
        ("fmi2DoStep", unit.step(0.0, lab.h())),
        ("fmi2Terminate", unit.terminate()),
        ("fmi2Reset", unit.reset()),
    ];
    for (name, status) in statuses {
        lab.refused("S6", lab.level, status, &format!("{name} of a NULL instance"));
    }
}

/// Makes a run and frees the instance; what it did with the functions for memory.
fn run_and_free(lab: &Lab<'_>, memory: bool) -> bool {
    let made = lab.maker.make_with(NAME, &lab.description.guid, Some(&lab.resources), memory);
    let Ok(mut unit) = made else { return false };
    let ran = lab.initialize(&mut unit) && (0..3).all(|k| unit.step(lab.t(k), lab.h()) <= 1);
    if ran && saves(lab.description) {
        let mut state = ptr::null_mut();
        if unit.save(&mut state) <= 1 {
            unit.free_state(&mut state);
        }
    }
    if ran {
        unit.terminate();
    }
    ran
}

pub(super) fn memory_functions(lab: &Lab<'_>) {
    let attribute = Some("canNotUseMemoryManagementFunctions".to_owned());
    run_and_free(lab, true);
    let (allocated, foreign, living) = memory::account();
    if own_memory(lab.description) && allocated > 0 {
        lab.reporter.found(Found {
            rule: "S5".into(),
            level: Level::Error,
            what: "canNotUseMemoryManagementFunctions is true, but allocateMemory is called".into(),
            variable: None,
            attribute,
        });
    }
    if foreign > 0 {
        lab.reporter.error("S5", "freeMemory is called with memory that is not from allocateMemory");
    }
    if living > 0 {
        lab.reporter.error(
            "S5",
            format!(
                "of {allocated} pieces of memory from allocateMemory {living} are never freed with freeMemory"
            ),
        );
    }
}

pub(super) fn no_memory_functions(lab: &Lab<'_>) {
    if many(lab.description) {
        run_and_free(lab, true);
        if memory::account().0 > 0 {
            // That these functions are called is found by `memory`; without them it can only crash.
            return;
        }
    }
    if !run_and_free(lab, false) {
        lab.reporter.found(Found {
            rule: "S5".into(),
            level: Level::Error,
            what: "canNotUseMemoryManagementFunctions is true, but the FMU does not run without allocateMemory and freeMemory".into(),
            variable: None,
            attribute: Some("canNotUseMemoryManagementFunctions".into()),
        });
    }
}

/// How the resource location is passed.
#[derive(Clone, Copy)]
pub(super) enum Location {
    WithoutAuthority,
    Localhost,
    Encoded,
    Missing,
}

/// The FMU starts from its resources, and does the same, however their location is written.
pub(super) fn located(lab: &Lab<'_>, location: Location) {
    let path = lab.resources.trim_start_matches("file://");
    let (uri, shown) = match location {
        Location::WithoutAuthority => (Some(format!("file:{path}")), "as file:/..."),
        Location::Localhost => (Some(format!("file://localhost{path}")), "as file://localhost/..."),
        Location::Missing => (None, "as NULL"),
        Location::Encoded => {
            // The same under a name that a URI cannot hold as it is.
            let other = lab.work.join("resources of 100 % \u{fc}ber");
            if system::same_folder(&lab.folder, &other).is_err() {
                return;
            }
            (Some(file_uri(&other)), "with characters that are percent-encoded")
        }
    };
    let run = |uri: Option<&str>| -> Option<Bits> {
        let mut unit = lab.maker.make_with(NAME, &lab.description.guid, uri, true).ok()?;
        plain_run(lab, &mut unit)
    };
    let got = run(uri.as_deref());
    if !many(lab.description) {
        // That it starts in the usual way is checked by `run`, in another process.
        if got.is_none() {
            let what = format!("with the resource location {shown} the FMU does not start or step");
            lab.reporter.report(lab.level, "S7", what);
        }
        return;
    }
    let what = match (run(Some(&lab.resources)), got) {
        (None, _) => return,
        (Some(_), None) => format!("with the resource location {shown} the FMU does not start or step"),
        (Some(a), Some(b)) if !lab.same(&a, &b, None) && lab.repeatable(&a, || run(Some(&lab.resources))) => {
            format!("with the resource location {shown} the FMU runs otherwise: {}", differ(lab, &a, &b))
        }
        _ => return,
    };
    lab.reporter.report(lab.level, "S7", what);
}

pub(super) fn final_past(lab: &Lab<'_>) {
    // The error is the status of a step, or 0 if something else failed.
    let run = |flag: bool| -> Result<Bits, c_int> {
        let mut unit = lab.ready().ok_or(0)?;
        let mut bits = Vec::new();
        for k in 0..STEPS {
            if !lab.excite(&mut unit, k) {
                return Err(0);
            }
            let status = unit.step_as(lab.t(k), lab.h(), flag);
            if status > 1 {
                return Err(status);
            }
            bits.extend(lab.read(&mut unit).ok_or(0)?);
        }
        Ok(bits)
    };
    // The other value is passed everywhere else.
    let first = if many(lab.description) { run(true) } else { Ok(Bits::new()) };
    match (first, run(false)) {
        (Ok(_), Ok(_)) if !many(lab.description) => {}
        (Ok(a), Ok(b)) => {
            if !lab.same(&a, &b, None) && lab.repeatable(&a, || run(true).ok()) {
                lab.reporter.error(
                    "D5",
                    format!(
                        "with noSetFMUStatePriorToCurrentPoint = fmi2False the FMU runs otherwise than with fmi2True: {}",
                        differ(lab, &a, &b)
                    ),
                );
            }
        }
        (Ok(_), Err(status)) if status > 1 => lab.reporter.error(
            "D5",
            format!("fmi2DoStep with noSetFMUStatePriorToCurrentPoint = fmi2False returned {}", word(status)),
        ),
        // That fmi2True is refused is found by `run`.
        _ => lab.unable(),
    }
}
