//! Cases: calls in the wrong order and with wrong arguments, texts and messages.

use super::*;

pub(super) fn enter_before_setup(lab: &Lab<'_>) {
    let Some(mut unit) = lab.unit() else { return };
    let status = unit.enter();
    lab.refused("M1", lab.level, status, "fmi2EnterInitializationMode without fmi2SetupExperiment");
}

pub(super) fn exit_before_enter(lab: &Lab<'_>) {
    let Some(mut unit) = lab.unit() else { return };
    unit.setup(lab.t(0), None);
    let status = unit.exit();
    lab.refused("M1", lab.level, status, "fmi2ExitInitializationMode without fmi2EnterInitializationMode");
}

pub(super) fn enter_twice(lab: &Lab<'_>) {
    let Some(mut unit) = lab.ready() else { return };
    let status = unit.enter();
    lab.refused("M1", lab.level, status, "a second fmi2EnterInitializationMode");
}

pub(super) fn late_setup(lab: &Lab<'_>) {
    let Some(mut unit) = lab.ready() else { return };
    let status = unit.setup(lab.t(0), None);
    lab.refused("M1", lab.level, status, "fmi2SetupExperiment after the initialization");
}

pub(super) fn early_step(lab: &Lab<'_>) {
    let Some(mut unit) = lab.unit() else { return };
    unit.setup(lab.t(0), None);
    let status = unit.step(lab.t(0), lab.h());
    lab.refused("M1", lab.level, status, "fmi2DoStep before the initialization");
}

pub(super) fn early_end(lab: &Lab<'_>) {
    let Some(mut unit) = lab.unit() else { return };
    let status = unit.terminate();
    lab.refused("M5", lab.level, status, "fmi2Terminate before the initialization");
}

pub(super) fn step_after_end(lab: &Lab<'_>) {
    let Some(mut unit) = lab.ready() else { return };
    if unit.terminate() > 1 {
        return;
    }
    let status = unit.step(lab.t(0), lab.h());
    lab.refused("M5", lab.level, status, "fmi2DoStep after fmi2Terminate");
}

pub(super) fn early_get(lab: &Lab<'_>) {
    let Some(mut unit) = lab.unit() else { return };
    let Some(v) = lab.variables().iter().find(|v| v.is_real() && v.causality == Causality::Output) else {
        return;
    };
    let (status, _) = unit.get_real(v.reference);
    lab.refused("M2", lab.level, status, &format!("reading {:?} before the initialization", v.name));
}

/// Sets a variable that is `fitting` to a value that it would otherwise accept.
pub(super) fn set_forbidden(lab: &Lab<'_>, rule: &str, what: &str, fitting: impl Fn(&VariableInfo) -> bool) {
    let Some(v) = lab.variables().iter().find(|v| fitting(v)) else { return };
    let Some(mut unit) = lab.ready() else { return };
    let status = match &v.kind {
        Kind::Real => {
            let value = unit.get_real(v.reference).1;
            unit.set_real(v.reference, value)
        }
        Kind::Boolean => {
            let value = unit.get_boolean(v.reference).1;
            unit.set_boolean(v.reference, value)
        }
        Kind::Text => {
            let value = unit.get_text(v.reference).1;
            unit.set_text(v.reference, &value)
        }
        _ => {
            let value = unit.get_integer(v.reference).1;
            unit.set_integer(v.reference, value)
        }
    };
    if status <= 1 {
        lab.reporter.found(Found {
            rule: rule.into(),
            level: lab.level,
            what: format!(
                "setting the {what} {:?} between steps returned {}; fmi2Error was expected",
                v.name,
                word(status)
            ),
            variable: Some(v.name.clone()),
            attribute: None,
        });
    }
}

pub(super) fn set_fixed(lab: &Lab<'_>) {
    set_forbidden(lab, "M3", "fixed parameter", |v| {
        v.causality == Causality::Parameter && v.variability == Variability::Fixed
    });
}

pub(super) fn set_output(lab: &Lab<'_>) {
    set_forbidden(lab, "M3", "output", |v| {
        v.causality == Causality::Output && v.variability != Variability::Constant
    });
}

pub(super) fn set_constant(lab: &Lab<'_>) {
    set_forbidden(lab, "S9", "constant", |v| v.variability == Variability::Constant);
}

pub(super) fn unknown_reference(lab: &Lab<'_>) {
    type Try = fn(&mut Unit<'_>) -> c_int;
    let tries: [(&str, Try); 6] = [
        ("fmi2GetReal", |u| u.get_real(NOWHERE).0),
        ("fmi2SetReal", |u| u.set_real(NOWHERE, 0.0)),
        ("fmi2GetInteger", |u| u.get_integer(NOWHERE).0),
        ("fmi2SetInteger", |u| u.set_integer(NOWHERE, 0)),
        ("fmi2GetBoolean", |u| u.get_boolean(NOWHERE).0),
        ("fmi2SetBoolean", |u| u.set_boolean(NOWHERE, false)),
    ];
    let Some(mut unit) = lab.ready() else { return };
    for (name, call) in tries {
        let status = call(&mut unit);
        lab.refused(
            "S9",
            Level::Error,
            status,
            &format!("{name} of the value reference {NOWHERE}, which does not exist,"),
        );
        // An error ends the run; the next call needs a new one.
        if status >= ERROR && (unit.reset() > 1 || !lab.initialize(&mut unit)) {
            return;
        }
    }
}

pub(super) fn bad_step(lab: &Lab<'_>, time: Option<f64>, length: f64) {
    let Some(mut unit) = lab.ready() else { return };
    let time = time.unwrap_or(lab.t(0));
    let status = unit.step(time, length);
    lab.refused("D1", lab.level, status, &format!("fmi2DoStep from {time} s by {length} s"));
}

pub(super) fn beyond_stop(lab: &Lab<'_>) {
    let Some(mut unit) = lab.unit() else { return };
    let initialized = unit.setup(lab.t(0), Some(lab.t(2))) <= 1 && unit.enter() <= 1 && unit.exit() <= 1;
    if !initialized || unit.step(lab.t(0), lab.h()) > 1 || unit.step(lab.t(1), lab.h()) > 1 {
        return;
    }
    let status = unit.step(lab.t(2), lab.h());
    lab.refused("D2", Level::Error, status, &format!("fmi2DoStep beyond the stop time {} s", lab.t(2)));
}

pub(super) fn bad_input(lab: &Lab<'_>, value: f64) {
    for v in lab.variables().iter().filter(|v| is_real_input(v)).take(8) {
        let Some(mut unit) = lab.ready() else { return };
        if unit.set_real(v.reference, value) > 1 || unit.step(lab.t(0), lab.h()) > 1 {
            continue;
        }
        for output in lab.variables().iter().filter(|v| v.is_real() && v.causality == Causality::Output) {
            let (status, result) = unit.get_real(output.reference);
            if status <= 1 && !result.is_finite() {
                lab.reporter.found(Found {
                    rule: "D8".into(),
                    level: Level::Warning,
                    what: format!(
                        "with {:?} = {value} every call returns fmi2OK, and {:?} becomes {result}",
                        v.name, output.name
                    ),
                    variable: Some(v.name.clone()),
                    attribute: None,
                });
                break;
            }
        }
        if !many(lab.description) {
            return;
        }
    }
}

pub(super) fn texts(lab: &Lab<'_>) {
    for v in lab.variables().iter().filter(|v| is_text_parameter(v)).take(8) {
        let Some(mut unit) = lab.unit() else { return };
        let Some(Value::Text(start)) = &v.start else { continue };
        // The start value itself is accepted for certain.
        if unit.set_text(v.reference, start) > 1 || !lab.initialize(&mut unit) {
            continue;
        }
        let (status, text) = unit.get_text(v.reference);
        if status <= 1 && text != *start {
            lab.reporter.found(Found {
                rule: "S1".into(),
                level: Level::Error,
                what: format!("{:?} was set to {start:?} and is {text:?} after the text was freed", v.name),
                variable: Some(v.name.clone()),
                attribute: None,
            });
        }
        if !many(lab.description) {
            return;
        }
    }
}

pub(super) fn logging(lab: &Lab<'_>) {
    let mut heard = None;
    {
        let Some(mut unit) = lab.unit() else { return };
        let status = unit.set_debug_logging(false);
        unit.chatter();
        if status > 1 {
            return lab
                .reporter
                .error("L2", format!("fmi2SetDebugLogging(fmi2False) returned {}", word(status)));
        }
        if unit.setup(lab.t(0), None) <= 1 && unit.enter() <= 1 && unit.exit() <= 1 {
            for k in 0..5 {
                if unit.step(lab.t(k), lab.h()) > 1 {
                    break;
                }
                heard = heard.or_else(|| unit.chatter());
            }
        }
        heard = heard.or_else(|| unit.chatter());
    }
    if let Some(message) = heard {
        let message: String = message.chars().take(60).collect();
        lab.reporter.warning("L2", format!("messages are switched off, but {message:?} comes with fmi2OK"));
    }
}
