//! What is tried with a binary. Each case runs in a process of its own.

use super::child::{Found, Reporter};
use super::finding::Level;
use super::unit::{self, CallNote, ERROR, Maker, Unit};
use crate::fmi::import::Description;
use crate::model::{Causality, Initial, Kind, Value, Variability, VariableInfo};
use std::ffi::c_int;
use std::ptr;
use std::time::{Duration, Instant};

/// The name of all instances.
pub(super) const NAME: &str = "unit under test";
/// Steps of a trajectory that is compared with another one.
const STEPS: u32 = 20;
/// A value reference that no FMU has.
const NOWHERE: u32 = 0xfffe_fffe;
/// How much results may depend on the length of the steps, relative to the largest value.
const PARTITION_TOLERANCE: f64 = 0.02;
/// How much directional derivatives may differ from differences, relative to the larger one.
const DERIVATIVE_TOLERANCE: f64 = 1e-6;
/// Growth of the memory by more than this, in each half of many cycles, is a leak \[bytes\].
const LEAK: u64 = 64 << 10;

/// Something to try.
pub(super) struct Case {
    /// As in the report.
    pub(super) name: &'static str,
    /// The rule that a crash or a hang breaks.
    pub(super) rule: &'static str,
    /// How bad a crash or a hang is.
    pub(super) level: Level,
    /// As part of a sentence: "while ...".
    pub(super) title: &'static str,
    /// Whether it makes sense for this FMU.
    pub(super) applies: fn(&Description) -> bool,
    pub(super) run: fn(&Lab<'_>),
}

const fn case(
    name: &'static str,
    rule: &'static str,
    title: &'static str,
    applies: fn(&Description) -> bool,
    run: fn(&Lab<'_>),
) -> Case {
    Case { name, rule, level: Level::Error, title, applies, run }
}

fn always(_: &Description) -> bool {
    true
}
fn saves(d: &Description) -> bool {
    d.capabilities.can_get_and_set_state
}
fn serializes(d: &Description) -> bool {
    saves(d) && d.capabilities.can_serialize_state
}
fn many(d: &Description) -> bool {
    !d.capabilities.can_be_instantiated_once
}
fn real_inputs(d: &Description) -> bool {
    d.interface.variables.iter().any(is_real_input)
}
fn text_parameters(d: &Description) -> bool {
    d.interface.variables.iter().any(is_text_parameter)
}

fn is_real_input(v: &VariableInfo) -> bool {
    v.causality == Causality::Input && v.is_real()
}
fn is_text_parameter(v: &VariableInfo) -> bool {
    v.causality == Causality::Parameter && v.kind == Kind::Text
}

/// All cases. The first two tell whether the others make sense.
pub(super) static CASES: &[Case] = &[
    case("functions", "M8", "loading the binary", always, functions),
    case("run", "M0", "running the default experiment", always, run),
    case("wrong-guid", "S3", "instantiating with a wrong GUID", always, wrong_guid),
    case("blank-name", "S3", "instantiating with a blank name", always, blank_name),
    case("free-nothing", "S6", "freeing NULL", always, free_nothing),
    Case {
        level: Level::Warning,
        ..case("null-instance", "S6", "calling with a NULL instance", always, null_instance)
    },
    case("enter-before-setup", "M1", "initializing without fmi2SetupExperiment", always, enter_before_setup),
    case("exit-before-enter", "M1", "ending an initialization that was not begun", always, exit_before_enter),
    case("enter-twice", "M1", "initializing twice", always, enter_twice),
    case("setup-after-initialization", "M1", "calling fmi2SetupExperiment late", always, late_setup),
    case("step-before-initialization", "M1", "stepping before the initialization", always, early_step),
    case("terminate-before-initialization", "M5", "terminating before the initialization", always, early_end),
    case("step-after-terminate", "M5", "stepping after fmi2Terminate", always, step_after_end),
    case("get-before-initialization", "M2", "reading before the initialization", always, early_get),
    case("set-fixed-parameter", "M3", "setting a fixed parameter between steps", always, set_fixed),
    case("set-output", "M3", "setting an output between steps", always, set_output),
    case("set-constant", "S9", "setting a constant", always, set_constant),
    case("unknown-reference", "S9", "using an unknown value reference", always, unknown_reference),
    case("step-nan", "D1", "stepping by NaN", always, |lab| bad_step(lab, None, f64::NAN)),
    case("step-zero", "D1", "stepping by zero", always, |lab| bad_step(lab, None, 0.0)),
    case("step-negative", "D1", "stepping backwards", always, |lab| bad_step(lab, None, -lab.h())),
    case("step-infinite", "D1", "stepping for ever", always, |lab| bad_step(lab, None, f64::INFINITY)),
    case("time-nan", "D1", "stepping from NaN", always, |lab| bad_step(lab, Some(f64::NAN), lab.h())),
    case("time-wrong", "D1", "stepping from another time", always, |lab| {
        bad_step(lab, Some(lab.t(0) + 1000.0 * lab.h()), lab.h());
    }),
    case("beyond-stop-time", "D2", "stepping beyond the stop time", always, beyond_stop),
    Case {
        level: Level::Warning,
        ..case("nan-input", "D8", "setting an input to NaN", real_inputs, |lab| bad_input(lab, f64::NAN))
    },
    Case {
        level: Level::Warning,
        ..case("infinite-input", "D8", "setting an input to infinity", real_inputs, |lab| {
            bad_input(lab, f64::INFINITY);
        })
    },
    case("texts", "S1", "setting a text", text_parameters, texts),
    case("logging", "L2", "switching messages off", always, logging),
    case("reset", "M5", "resetting", always, reset),
    case("reset-everywhere", "M5", "resetting in every state", always, reset_everywhere),
    case("rollback", "M6", "saving and restoring the state", saves, rollback),
    case("rollback-after-error", "M6", "restoring the state after an error", saves, rollback_after_error),
    case("state-reuse", "M6", "saving over an old state", saves, state_reuse),
    case("serialize", "M6", "turning the state into bytes and back", serializes, serialize),
    case("partition", "D10", "halving the steps", |d| d.capabilities.can_handle_variable_step, partition),
    case("clock", "D1", "comparing the FMU's time with the master's", always, clock),
    case(
        "input-derivatives",
        "D7",
        "setting derivatives of inputs",
        |d| d.capabilities.can_interpolate_inputs && real_inputs(d),
        input_derivatives,
    ),
    case(
        "output-derivatives",
        "D7",
        "reading derivatives of outputs",
        |d| d.capabilities.max_output_derivative_order > 0,
        output_derivatives,
    ),
    case(
        "directional-derivatives",
        "D9",
        "comparing directional derivatives with differences",
        |d| d.capabilities.provides_directional_derivatives && real_inputs(d),
        directional,
    ),
    case("two-instances", "S8", "stepping two instances in turn", many, two_instances),
    case("two-threads", "S8", "stepping two instances in two threads", many, two_threads),
    case("only-one-instance", "S8", "instantiating twice", |d| !many(d), only_one),
    case("leak", "S10", "making and freeing many instances", always, leak),
    case("unload", "S11", "unloading the binary", always, unload),
];

/// What a case works with.
pub(super) struct Lab<'a> {
    pub(super) maker: Maker<'a>,
    pub(super) note: &'a CallNote,
    pub(super) description: &'a Description,
    pub(super) reporter: &'a Reporter,
    pub(super) resources: String,
    pub(super) begin: Instant,
    pub(super) timeout: Duration,
}

/// Values as bits, to be compared exactly.
type Bits = Vec<u64>;

impl<'a> Lab<'a> {
    /// Communication step \[s\].
    fn h(&self) -> f64 {
        let e = &self.description.experiment;
        match (e.step_size, e.stop) {
            (None, Some(stop)) if stop > self.t(0) => (stop - self.t(0)) / 500.0,
            _ => self.description.interface.communication_step,
        }
    }

    /// The communication point after `k` steps \[s\].
    fn t(&self, k: u32) -> f64 {
        let start = self.description.interface.start_time;
        if k == 0 { start } else { start + f64::from(k) * self.h() }
    }

    fn variables(&self) -> &'a [VariableInfo] {
        &self.description.interface.variables
    }

    /// True when a share of the time limit has passed.
    fn late(&self, share: f64) -> bool {
        self.begin.elapsed() > self.timeout.mul_f64(share)
    }

    /// A new instance. That it can be made is checked by `run`.
    fn unit(&self) -> Option<Unit<'a>> {
        self.maker.make(NAME, &self.description.guid, &self.resources).ok()
    }

    /// Initializes, with start values of inputs `change`d.
    fn initialize(&self, unit: &mut Unit<'_>) -> bool {
        unit.setup(self.t(0), None) <= 1 && unit.enter() <= 1 && unit.exit() <= 1
    }

    /// A new instance that is ready for the first step.
    fn ready(&self) -> Option<Unit<'a>> {
        let mut unit = self.unit()?;
        self.initialize(&mut unit).then_some(unit)
    }

    /// Outputs and local variables as bits; texts are left out.
    fn read(&self, unit: &mut Unit<'_>) -> Option<Bits> {
        let mut bits = Vec::new();
        for v in self.variables() {
            if !matches!(v.causality, Causality::Output | Causality::Local) {
                continue;
            }
            let (status, value) = match v.kind {
                Kind::Real => {
                    let (status, value) = unit.get_real(v.reference);
                    (status, value.to_bits())
                }
                Kind::Integer | Kind::Enumeration(_) => {
                    let (status, value) = unit.get_integer(v.reference);
                    (status, value as u64)
                }
                Kind::Boolean => {
                    let (status, value) = unit.get_boolean(v.reference);
                    (status, u64::from(value))
                }
                Kind::Text => continue,
            };
            if status > 1 {
                return None;
            }
            bits.push(value);
        }
        Some(bits)
    }

    /// Moves the real inputs a little, each within its limits; `k` is the number of the step.
    fn excite(&self, unit: &mut Unit<'_>, k: u32) -> bool {
        self.variables().iter().filter(|v| is_real_input(v)).all(|v| {
            let start = start_of(v);
            let reach = match (v.min, v.max) {
                (_, Some(max)) if max > start => (max - start).min(nominal(v)),
                (Some(min), Some(_)) => (min - start).max(-nominal(v)),
                _ => nominal(v),
            };
            let value = start + 0.02 * reach * (0.5 - 0.5 * (0.3 * f64::from(k)).cos());
            unit.set_real(v.reference, value) <= 1
        })
    }

    /// Makes the steps number `from` to `to`, with moving inputs if `excited`; the values after each.
    fn advance(&self, unit: &mut Unit<'_>, from: u32, to: u32, excited: bool) -> Option<Bits> {
        let mut bits = Vec::new();
        for k in from..to {
            if excited && !self.excite(unit, k) || unit.step(self.t(k), self.h()) > 1 {
                return None;
            }
            bits.extend(self.read(unit)?);
        }
        Some(bits)
    }

    /// Reports that a call that had to fail did not.
    fn refused(&self, rule: &str, level: Level, status: c_int, call: &str) {
        if status <= 1 {
            self.reporter.report(
                level,
                rule,
                format!("{call} returned {}; fmi2Error was expected", word(status)),
            );
        }
    }

    /// Tells the parent that a case could not be carried through although `run` was.
    fn unable(&self) {
        self.reporter.warning(
            "M0",
            "the FMU does not take small changes of its inputs, so that less could be checked",
        );
    }
}

/// A status as the standard writes it.
pub(super) fn word(status: c_int) -> &'static str {
    match status {
        0 => "fmi2OK",
        1 => "fmi2Warning",
        2 => "fmi2Discard",
        3 => "fmi2Error",
        4 => "fmi2Fatal",
        5 => "fmi2Pending",
        _ => "an unknown status",
    }
}

fn start_of(v: &VariableInfo) -> f64 {
    match v.start {
        Some(Value::Real(start)) => start,
        Some(Value::Integer(start)) => f64::from(start),
        _ => 0.0,
    }
}

fn nominal(v: &VariableInfo) -> f64 {
    v.nominal.filter(|n| n.is_finite() && *n != 0.0).unwrap_or(1.0).abs().max(start_of(v).abs())
}

fn functions(lab: &Lab<'_>) {
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

fn run(lab: &Lab<'_>) {
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
fn start_values(lab: &Lab<'_>, unit: &mut Unit<'_>) {
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

fn refused_instance(lab: &Lab<'_>, name: &str, guid: &str, what: &str) {
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

fn wrong_guid(lab: &Lab<'_>) {
    refused_instance(lab, NAME, "{00000000-0000-0000-0000-00000000c0de}", "a wrong GUID");
}

fn blank_name(lab: &Lab<'_>) {
    for (name, what) in [("", "an empty name"), ("  ", "a name of spaces")] {
        refused_instance(lab, name, &lab.description.guid, what);
    }
}

fn free_nothing(lab: &Lab<'_>) {
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

fn null_instance(lab: &Lab<'_>) {
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

fn enter_before_setup(lab: &Lab<'_>) {
    let Some(mut unit) = lab.unit() else { return };
    let status = unit.enter();
    lab.refused("M1", Level::Error, status, "fmi2EnterInitializationMode without fmi2SetupExperiment");
}

fn exit_before_enter(lab: &Lab<'_>) {
    let Some(mut unit) = lab.unit() else { return };
    unit.setup(lab.t(0), None);
    let status = unit.exit();
    lab.refused("M1", Level::Error, status, "fmi2ExitInitializationMode without fmi2EnterInitializationMode");
}

fn enter_twice(lab: &Lab<'_>) {
    let Some(mut unit) = lab.ready() else { return };
    let status = unit.enter();
    lab.refused("M1", Level::Error, status, "a second fmi2EnterInitializationMode");
}

fn late_setup(lab: &Lab<'_>) {
    let Some(mut unit) = lab.ready() else { return };
    let status = unit.setup(lab.t(0), None);
    lab.refused("M1", Level::Error, status, "fmi2SetupExperiment after the initialization");
}

fn early_step(lab: &Lab<'_>) {
    let Some(mut unit) = lab.unit() else { return };
    unit.setup(lab.t(0), None);
    let status = unit.step(lab.t(0), lab.h());
    lab.refused("M1", Level::Error, status, "fmi2DoStep before the initialization");
}

fn early_end(lab: &Lab<'_>) {
    let Some(mut unit) = lab.unit() else { return };
    let status = unit.terminate();
    lab.refused("M5", Level::Error, status, "fmi2Terminate before the initialization");
}

fn step_after_end(lab: &Lab<'_>) {
    let Some(mut unit) = lab.ready() else { return };
    if unit.terminate() > 1 {
        return;
    }
    let status = unit.step(lab.t(0), lab.h());
    lab.refused("M5", Level::Error, status, "fmi2DoStep after fmi2Terminate");
}

fn early_get(lab: &Lab<'_>) {
    let Some(mut unit) = lab.unit() else { return };
    let Some(v) = lab.variables().iter().find(|v| v.is_real() && v.causality == Causality::Output) else {
        return;
    };
    let (status, _) = unit.get_real(v.reference);
    lab.refused("M2", Level::Warning, status, &format!("reading {:?} before the initialization", v.name));
}

/// Sets a variable that is `fitting` to a value that it would otherwise accept.
fn set_forbidden(lab: &Lab<'_>, rule: &str, what: &str, fitting: impl Fn(&VariableInfo) -> bool) {
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
            level: if rule == "M3" { Level::Warning } else { Level::Error },
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

fn set_fixed(lab: &Lab<'_>) {
    set_forbidden(lab, "M3", "fixed parameter", |v| {
        v.causality == Causality::Parameter && v.variability == Variability::Fixed
    });
}

fn set_output(lab: &Lab<'_>) {
    set_forbidden(lab, "M3", "output", |v| {
        v.causality == Causality::Output && v.variability != Variability::Constant
    });
}

fn set_constant(lab: &Lab<'_>) {
    set_forbidden(lab, "S9", "constant", |v| v.variability == Variability::Constant);
}

fn unknown_reference(lab: &Lab<'_>) {
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

fn bad_step(lab: &Lab<'_>, time: Option<f64>, length: f64) {
    let Some(mut unit) = lab.ready() else { return };
    let time = time.unwrap_or(lab.t(0));
    let status = unit.step(time, length);
    lab.refused("D1", Level::Error, status, &format!("fmi2DoStep from {time} s by {length} s"));
}

fn beyond_stop(lab: &Lab<'_>) {
    let Some(mut unit) = lab.unit() else { return };
    let initialized = unit.setup(lab.t(0), Some(lab.t(2))) <= 1 && unit.enter() <= 1 && unit.exit() <= 1;
    if !initialized || unit.step(lab.t(0), lab.h()) > 1 || unit.step(lab.t(1), lab.h()) > 1 {
        return;
    }
    let status = unit.step(lab.t(2), lab.h());
    lab.refused("D2", Level::Error, status, &format!("fmi2DoStep beyond the stop time {} s", lab.t(2)));
}

fn bad_input(lab: &Lab<'_>, value: f64) {
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

fn texts(lab: &Lab<'_>) {
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

fn logging(lab: &Lab<'_>) {
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

/// A run with the start values of all variables.
fn plain_run(lab: &Lab<'_>, unit: &mut Unit<'_>) -> Option<Bits> {
    if !lab.initialize(unit) {
        return None;
    }
    lab.advance(unit, 0, STEPS, false)
}

fn reset(lab: &Lab<'_>) {
    let Some(mut unit) = lab.unit() else { return };
    let Some(fresh) = plain_run(lab, &mut unit) else { return };
    let reset = |unit: &mut Unit<'_>| {
        let status = unit.reset();
        if status > 1 {
            lab.reporter.error("M5", format!("fmi2Reset between steps returned {}", word(status)));
        }
        status <= 1
    };
    if !reset(&mut unit) {
        return;
    }
    // Everything that can be changed is: parameters a little, then the inputs.
    for v in lab.variables().iter().filter(|v| v.is_real() && v.causality == Causality::Parameter) {
        let value = start_of(v) * (1.0 + 1e-6);
        let fits = v.min.is_none_or(|min| value >= min) && v.max.is_none_or(|max| value <= max);
        if fits && unit.set_real(v.reference, value) > 1 && !reset(&mut unit) {
            return;
        }
    }
    if !lab.initialize(&mut unit) || lab.advance(&mut unit, 0, STEPS, true).is_none() {
        lab.unable();
    }
    if !reset(&mut unit) {
        return;
    }
    match plain_run(lab, &mut unit) {
        None => lab.reporter.error("M5", "after fmi2Reset the FMU does not run any more"),
        Some(again) if again != fresh => {
            lab.reporter.error(
                "M5",
                format!(
                    "after fmi2Reset the FMU runs otherwise than when it was new: {}",
                    differ(lab, &fresh, &again)
                ),
            );
        }
        Some(_) => {}
    }
}

/// Which variable differs first, and when.
fn differ(lab: &Lab<'_>, a: &[u64], b: &[u64]) -> String {
    let read: Vec<&VariableInfo> = lab
        .variables()
        .iter()
        .filter(|v| matches!(v.causality, Causality::Output | Causality::Local) && v.kind != Kind::Text)
        .collect();
    let Some(at) = a.iter().zip(b).position(|(x, y)| x != y) else { return "there are more values".into() };
    let v = read[at % read.len().max(1)];
    let show = |bits: u64| if v.is_real() { format!("{:?}", f64::from_bits(bits)) } else { bits.to_string() };
    format!(
        "{:?} is {} instead of {} after {} steps",
        v.name,
        show(b[at]),
        show(a[at]),
        at / read.len().max(1) + 1
    )
}

fn reset_everywhere(lab: &Lab<'_>) {
    let Some(mut unit) = lab.unit() else { return };
    for (place, reach) in [
        ("before the initialization", 0),
        ("in the initialization", 1),
        ("after fmi2Terminate", 2),
        ("after an error", 3),
    ] {
        let reached = match reach {
            0 => true,
            1 => unit.setup(lab.t(0), None) <= 1 && unit.enter() <= 1,
            2 => lab.initialize(&mut unit) && unit.terminate() <= 1,
            // Whether this is refused is found elsewhere.
            _ => lab.initialize(&mut unit) && unit.get_real(NOWHERE).0 >= ERROR,
        };
        if !reached {
            return;
        }
        let status = unit.reset();
        if status > 1 {
            return lab.reporter.error("M5", format!("fmi2Reset {place} returned {}", word(status)));
        }
    }
    if !lab.initialize(&mut unit) {
        lab.reporter.error("M5", "after fmi2Reset the FMU cannot be initialized any more");
    }
}

/// A unit after some steps with moving inputs, and its state there.
fn saved<'a>(lab: &Lab<'a>) -> Option<(Unit<'a>, *mut std::ffi::c_void)> {
    let mut unit = lab.ready()?;
    if lab.advance(&mut unit, 0, STEPS, true).is_none() {
        lab.unable();
        return None;
    }
    let mut state = ptr::null_mut();
    let status = unit.save(&mut state);
    if status > 1 || state.is_null() {
        lab.reporter.error(
            "M6",
            format!(
                "fmi2GetFMUstate returned {}{}",
                word(status),
                if state.is_null() { " and NULL" } else { "" }
            ),
        );
        return None;
    }
    Some((unit, state))
}

/// Restores, continues with the inputs of the saved state, and compares.
fn continues(
    lab: &Lab<'_>,
    unit: &mut Unit<'_>,
    state: *mut std::ffi::c_void,
    expected: &Bits,
    after: &str,
) -> bool {
    let status = unit.restore(state);
    if status > 1 {
        lab.reporter.error("M6", format!("fmi2SetFMUstate {after} returned {}", word(status)));
        return false;
    }
    match lab.advance(unit, STEPS, 2 * STEPS, false) {
        None => lab.reporter.error("M6", format!("after fmi2SetFMUstate {after} the FMU cannot be stepped")),
        Some(bits) if bits != *expected => lab.reporter.error(
            "M6",
            format!(
                "after fmi2SetFMUstate {after} the FMU continues otherwise: {}",
                differ(lab, expected, &bits)
            ),
        ),
        Some(_) => return true,
    }
    false
}

fn free_saved(lab: &Lab<'_>, unit: &mut Unit<'_>, mut state: *mut std::ffi::c_void) {
    let status = unit.free_state(&mut state);
    if status > 1 {
        lab.reporter.error("M6", format!("fmi2FreeFMUstate returned {}", word(status)));
    } else if !state.is_null() {
        lab.reporter.error("S6", "fmi2FreeFMUstate does not set the freed state to NULL");
    }
}

fn rollback(lab: &Lab<'_>) {
    let Some((mut unit, state)) = saved(lab) else { return };
    // Without setting inputs: those of the saved state have to come back with it.
    let Some(expected) = lab.advance(&mut unit, STEPS, 2 * STEPS, false) else { return };
    if !continues(lab, &mut unit, state, &expected, "at once") {
        return;
    }
    if unit.restore(state) <= 1
        && lab.advance(&mut unit, STEPS, STEPS + 7, true).is_some()
        && !continues(lab, &mut unit, state, &expected, "after steps with other inputs")
    {
        return;
    }
    free_saved(lab, &mut unit, state);
}

fn rollback_after_error(lab: &Lab<'_>) {
    let Some((mut unit, state)) = saved(lab) else { return };
    let Some(expected) = lab.advance(&mut unit, STEPS, 2 * STEPS, false) else { return };
    if unit.get_real(NOWHERE).0 == ERROR {
        continues(lab, &mut unit, state, &expected, "after fmi2Error");
    }
    free_saved(lab, &mut unit, state);
}

fn state_reuse(lab: &Lab<'_>) {
    let Some((mut unit, state)) = saved(lab) else { return };
    if lab.advance(&mut unit, STEPS, STEPS + 5, true).is_none() {
        return;
    }
    let mut second = state;
    let status = unit.save(&mut second);
    if status > 1 {
        return lab
            .reporter
            .error("M6", format!("fmi2GetFMUstate over an old state returned {}", word(status)));
    }
    let run = |unit: &mut Unit<'_>| lab.advance(unit, STEPS + 5, STEPS + 15, false);
    let Some(expected) = run(&mut unit) else { return };
    if unit.restore(second) > 1 || run(&mut unit).is_none_or(|bits| bits != expected) {
        lab.reporter.error("M6", "a state that was saved over an old one is not the new one");
    }
    free_saved(lab, &mut unit, second);
}

fn serialize(lab: &Lab<'_>) {
    let Some((mut unit, state)) = saved(lab) else { return };
    let Some(expected) = lab.advance(&mut unit, STEPS, 2 * STEPS, false) else { return };
    let bytes = match unit.serialize(state) {
        Ok(bytes) => bytes,
        Err(status) => {
            return lab.reporter.error("M6", format!("turning a state into bytes returned {}", word(status)));
        }
    };
    let mut copy = ptr::null_mut();
    let status = unit.deserialize(&bytes, &mut copy);
    if status > 1 || copy.is_null() {
        return lab
            .reporter
            .error("M6", format!("fmi2DeSerializeFMUstate of its own bytes returned {}", word(status)));
    }
    let good = continues(lab, &mut unit, copy, &expected, "of a state from bytes");
    free_saved(lab, &mut unit, copy);
    free_saved(lab, &mut unit, state);
    unit.free();
    if !good {
        return;
    }
    let Some(mut other) = lab.unit() else { return };
    let mut copy = ptr::null_mut();
    let status = other.deserialize(&bytes, &mut copy);
    if status > 1 || copy.is_null() {
        return lab
            .reporter
            .error("M6", format!("fmi2DeSerializeFMUstate in a new instance returned {}", word(status)));
    }
    continues(lab, &mut other, copy, &expected, "of a state from another instance's bytes");
    free_saved(lab, &mut other, copy);
}

fn partition(lab: &Lab<'_>) {
    let reals: Vec<&VariableInfo> =
        lab.variables().iter().filter(|v| v.is_real() && v.causality == Causality::Output).collect();
    let steps = 100;
    let run = |parts: u32| -> Option<Vec<Vec<f64>>> {
        let mut unit = lab.unit()?;
        // Something has to happen for the steps to matter; inputs stay as they are then.
        if !lab.initialize(&mut unit) || !lab.excite(&mut unit, 10) {
            return None;
        }
        let mut values = Vec::new();
        for k in 0..steps {
            for part in 0..parts {
                let time = lab.t(k) + f64::from(part) * lab.h() / f64::from(parts);
                if unit.step(time, lab.h() / f64::from(parts)) > 1 {
                    return None;
                }
            }
            values.push(reals.iter().map(|v| unit.get_real(v.reference).1).collect());
            if lab.late(0.3 * f64::from(parts)) {
                break;
            }
        }
        Some(values)
    };
    let Some(whole) = run(1) else { return };
    let Some(halves) = run(2) else {
        return lab.reporter.found(Found {
            rule: "D10".into(),
            level: Level::Error,
            what: format!("a step by {} s is refused, half the usual one", lab.h() / 2.0),
            variable: None,
            attribute: Some("canHandleVariableCommunicationStepSize".into()),
        });
    };
    for (i, v) in reals.iter().enumerate() {
        let pairs = || whole.iter().zip(&halves).map(|(a, b)| (a[i], b[i]));
        let size = pairs().fold(v.nominal.map_or(0.0, f64::abs), |m, (a, b)| m.max(a.abs()).max(b.abs()));
        let worst = pairs().map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        if worst > PARTITION_TOLERANCE * size && worst > 1e-9 {
            lab.reporter.found(Found {
                rule: "D10".into(),
                level: Level::Warning,
                what: format!(
                    "with steps half as long {:?} differs by {worst:.3e}, more than {} % of its largest value {size:.3e}",
                    v.name,
                    100.0 * PARTITION_TOLERANCE
                ),
                variable: Some(v.name.clone()),
                attribute: None,
            });
        }
    }
}

fn clock(lab: &Lab<'_>) {
    let Some(mut unit) = lab.ready() else { return };
    for k in 0..STEPS {
        if unit.step(lab.t(k), lab.h()) > 1 {
            return;
        }
        let end = lab.t(k) + lab.h();
        let mut times = Vec::new();
        if let Some(v) = lab.variables().iter().find(|v| v.causality == Causality::Independent) {
            let (status, time) = unit.get_real(v.reference);
            if status <= 1 {
                times.push((format!("the independent variable {:?}", v.name), time));
            }
        }
        times.extend(unit.last_successful_time().map(|t| ("the last successful time".into(), t)));
        for (what, time) in times {
            if time.is_nan() || (time - end).abs() > 1e-6 * lab.h() + 1e-12 * end.abs() {
                return lab.reporter.error("D1", format!("after a step to {end} s {what} is {time} s"));
            }
        }
    }
}

fn input_derivatives(lab: &Lab<'_>) {
    let attribute = Some("canInterpolateInputs".to_owned());
    let inputs =
        || lab.variables().iter().filter(|v| is_real_input(v) && v.variability == Variability::Continuous);
    let Some(mut unit) = lab.ready() else { return };
    for v in inputs() {
        let status = unit.set_rate(v.reference, 1, 0.0);
        if status > 1 {
            lab.reporter.found(Found {
                rule: "D7".into(),
                level: Level::Error,
                what: format!(
                    "canInterpolateInputs is true, but setting the first derivative of {:?} returned {}",
                    v.name,
                    word(status)
                ),
                variable: None,
                attribute,
            });
            return;
        }
    }
    if unit.step(lab.t(0), lab.h()) > 1 {
        return lab
            .reporter
            .error("D7", "the FMU cannot be stepped after derivatives of its inputs were set to zero");
    }
    if let Some(v) = inputs().next() {
        let status = unit.set_rate(v.reference, 0, 0.0);
        lab.refused("D7", Level::Warning, status, "setting a derivative of order 0");
    }
}

fn output_derivatives(lab: &Lab<'_>) {
    let Some(mut unit) = lab.ready() else { return };
    if unit.step(lab.t(0), lab.h()) > 1 {
        return;
    }
    let outputs = lab.variables().iter().filter(|v| {
        v.is_real() && v.causality == Causality::Output && v.variability == Variability::Continuous
    });
    for v in outputs {
        let (status, value) = unit.get_rate(v.reference, 1);
        if status > 1 || !value.is_finite() {
            lab.reporter.found(Found {
                rule: "D7".into(),
                level: Level::Error,
                what: format!("the first derivative of {:?} is {value} with {}", v.name, word(status)),
                variable: None,
                attribute: Some("maxOutputDerivativeOrder".into()),
            });
            return;
        }
    }
}

fn directional(lab: &Lab<'_>) {
    // In the initialization outputs follow inputs at once, so that differences need no step.
    let Some(mut unit) = lab.unit() else { return };
    if unit.setup(lab.t(0), None) > 1 || unit.enter() > 1 {
        return;
    }
    let outputs: Vec<&VariableInfo> = lab
        .variables()
        .iter()
        .filter(|v| {
            v.is_real() && v.causality == Causality::Output && v.variability == Variability::Continuous
        })
        .take(12)
        .collect();
    for input in lab
        .variables()
        .iter()
        .filter(|v| is_real_input(v) && v.variability == Variability::Continuous)
        .take(12)
    {
        let (start, step) = (start_of(input), 1e-5 * nominal(input));
        let mut at = |value: f64| -> Option<Vec<f64>> {
            if unit.set_real(input.reference, value) > 1 {
                return None;
            }
            outputs
                .iter()
                .map(|v| Some(unit.get_real(v.reference)).filter(|(s, _)| *s <= 1).map(|(_, y)| y))
                .collect()
        };
        let mut slopes = |step: f64| -> Option<Vec<f64>> {
            let (above, below) = (at(start + step)?, at(start - step)?);
            Some(above.iter().zip(below).map(|(a, b)| (a - b) / (2.0 * step)).collect())
        };
        let (Some(wide), Some(narrow), Some(middle)) = (slopes(step), slopes(0.5 * step), at(start)) else {
            return;
        };
        // Outputs that are small by symmetry are rounded like those that are not.
        let largest = middle.iter().fold(1e-3, |most: f64, y| most.max(y.abs()));
        for (i, output) in outputs.iter().enumerate() {
            let (status, value) = unit.directional(output.reference, input.reference);
            let difference = (4.0 * narrow[i] - wide[i]) / 3.0;
            // What curvature and rounding do to the difference.
            let noise = (narrow[i] - wide[i]).abs() + 1e-12 * largest / step;
            let what = if status > 1 {
                format!("d {:?} / d {:?} returned {}", output.name, input.name, word(status))
            } else if value.is_nan()
                || (value - difference).abs()
                    > DERIVATIVE_TOLERANCE * value.abs().max(difference.abs()) + noise
            {
                format!(
                    "d {:?} / d {:?} is {value:?}; differences give {difference:?}",
                    output.name, input.name
                )
            } else {
                continue;
            };
            lab.reporter.found(Found {
                rule: "D9".into(),
                level: if status > 1 { Level::Error } else { Level::Warning },
                what,
                variable: Some(output.name.clone()),
                attribute: None,
            });
        }
    }
}

fn two_instances(lab: &Lab<'_>) {
    let Some(mut first) = lab.ready() else { return };
    let Some(alone) = lab.advance(&mut first, 0, STEPS, true) else { return lab.unable() };
    first.free();
    let (Some(mut a), Some(mut b)) = (lab.unit(), lab.unit()) else {
        return lab.reporter.found(Found {
            rule: "S8".into(),
            level: Level::Error,
            what: "a second instance cannot be made, but canBeInstantiatedOnlyOncePerProcess is not true"
                .into(),
            variable: None,
            attribute: Some("canBeInstantiatedOnlyOncePerProcess".into()),
        });
    };
    if !lab.initialize(&mut a) || !lab.initialize(&mut b) {
        return lab.reporter.error("S8", "two instances cannot be initialized at the same time");
    }
    let mut bits = Vec::new();
    for k in 0..STEPS {
        // The other one goes its own way.
        let other = lab.advance(&mut b, k, k + 1, false);
        let (Some(values), Some(_)) = (lab.advance(&mut a, k, k + 1, true), other) else {
            return lab.reporter.error("S8", "two instances cannot be stepped in turn");
        };
        bits.extend(values);
    }
    if bits != alone {
        lab.reporter.error(
            "S8",
            format!("an instance runs otherwise beside another one: {}", differ(lab, &alone, &bits)),
        );
    }
}

fn two_threads(lab: &Lab<'_>) {
    let run = || lab.ready().and_then(|mut unit| lab.advance(&mut unit, 0, 5 * STEPS, true));
    let Some(alone) = run() else { return lab.unable() };
    let results = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..2).map(|_| scope.spawn(run)).collect();
        threads.into_iter().map(|t| t.join().ok().flatten()).collect::<Vec<_>>()
    });
    for bits in results {
        match bits {
            None => lab.reporter.error("S8", "two instances cannot run in two threads at the same time"),
            Some(bits) if bits != alone => {
                let what = format!(
                    "two instances in two threads disturb each other: {}",
                    differ(lab, &alone, &bits)
                );
                return lab.reporter.error("S8", what);
            }
            Some(_) => {}
        }
    }
}

fn only_one(lab: &Lab<'_>) {
    let Some(_first) = lab.unit() else { return };
    if lab.unit().is_some() {
        lab.reporter.found(Found {
            rule: "S8".into(),
            level: Level::Warning,
            what: "canBeInstantiatedOnlyOncePerProcess is true, but a second instance was made".into(),
            variable: None,
            attribute: Some("canBeInstantiatedOnlyOncePerProcess".into()),
        });
    }
}

/// Memory that this process uses \[bytes\].
fn memory() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/statm").ok()?;
    let pages: u64 = text.split(' ').nth(1)?.parse().ok()?;
    // Pages of 4 KiB are the smallest; larger ones only make leaks look smaller.
    Some(4096 * pages)
}

fn leak(lab: &Lab<'_>) {
    let cycle = || -> Option<()> {
        let mut unit = lab.ready()?;
        for k in 0..3 {
            if unit.step(lab.t(k), lab.h()) > 1 {
                return None;
            }
        }
        if saves(lab.description) {
            let mut state = ptr::null_mut();
            if unit.save(&mut state) <= 1 {
                unit.free_state(&mut state);
            }
        }
        unit.terminate();
        Some(())
    };
    // After the first cycles the allocator has all that it keeps.
    for _ in 0..30 {
        if cycle().is_none() || lab.late(0.1) {
            break;
        }
    }
    let mut marks = vec![memory()];
    let mut cycles = 0;
    for half in 1..=2 {
        let share = 0.1 + 0.2 * f64::from(half);
        for _ in 0..300 {
            if cycle().is_none() || lab.late(share) {
                break;
            }
            cycles += 1;
        }
        marks.push(memory());
    }
    let [Some(a), Some(b), Some(c)] = marks[..] else { return };
    if b > a + LEAK && c > b + LEAK {
        let per_cycle = (c - a) / cycles.max(1);
        lab.reporter.error(
            "S10",
            format!("memory grows by about {per_cycle} bytes with each instance that is made and freed ({cycles} in all)"),
        );
    }
}

fn unload(lab: &Lab<'_>) {
    let Some(mut unit) = lab.ready() else { return };
    unit.step(lab.t(0), lab.h());
    unit.terminate();
}
