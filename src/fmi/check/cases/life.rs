//! Cases: making and freeing an instance, a plain run, start values.

use super::*;

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
                .map_or("there is no message".into(), |m| format!("its message is {:?}", m.format));
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
        if status <= 1 && value != *start {
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
            lab.reporter.error("S3", format!("fmi2Instantiate with {what} returned an instance"));
            unit.free();
        }
        Err(messages) if messages.is_empty() => {
            lab.reporter.error("S3", format!("fmi2Instantiate with {what} returned NULL without a message"));
        }
        Err(_) => {}
    }
}

pub(super) fn wrong_guid(lab: &Lab<'_>) {
    refused_instance(lab, NAME, "{00000000-0000-0000-0000-00000000c0de}", "a wrong GUID");
}

pub(super) fn blank_name(lab: &Lab<'_>) {
    for (name, what) in [("", "an empty name"), ("  ", "a name of spaces")] {
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
        lab.refused("S6", Level::Warning, status, &format!("{name} of a NULL instance"));
    }
}
