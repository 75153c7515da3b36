//! What is tried with a binary. Each case runs in a process of its own.

mod calls;
mod guest;
mod life;
mod states;
mod time;

use self::calls::*;
use self::guest::*;
use self::life::*;
use self::states::*;
use self::time::*;
use crate::fmi::check::child::{FRAGILE, Found, Reporter};
use crate::fmi::check::finding::Level;
use crate::fmi::check::unit::{self, CallNote, ERROR, Maker, Unit};
use crate::fmi::import::Description;
use crate::model::{Causality, Initial, Kind, Value, Variability, VariableInfo};
use std::ffi::c_int;
use std::path::PathBuf;
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
/// Results that differ by less than this share of a variable's size are the same but for rounding: a run that
/// is compared takes some 40 steps of some hundred operations each, with an error of 1e-16 each.
const ROUNDING: f64 = 1e-12;
/// The relative tolerance of a solver where the description does not name one. Tools' defaults are 1e-4
/// to 1e-6.
const SOLVER_TOLERANCE: f64 = 1e-4;
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

/// A case of what the standard forbids to masters: the standard leaves open what comes of it, so that nothing
/// that the FMU does then is an error by the letter.
const fn forbidden(
    name: &'static str,
    rule: &'static str,
    title: &'static str,
    applies: fn(&Description) -> bool,
    run: fn(&Lab<'_>),
) -> Case {
    Case { level: Level::Warning, ..case(name, rule, title, applies, run) }
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
fn own_memory(d: &Description) -> bool {
    d.capabilities.can_not_use_memory_functions
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
    forbidden("blank-name", "S3", "instantiating with a blank name", always, blank_name),
    case("memory", "S5", "running with functions for memory", always, memory_functions),
    case(
        "no-memory-functions",
        "S5",
        "running without functions for memory",
        own_memory,
        no_memory_functions,
    ),
    case("location-without-authority", "S7", "passing the resource location as file:/", always, |lab| {
        located(lab, Location::WithoutAuthority);
    }),
    case("location-encoded", "S7", "passing a resource location with percent signs", always, |lab| {
        located(lab, Location::Encoded);
    }),
    Case {
        level: Level::Warning,
        ..case(
            "location-localhost",
            "S7",
            "passing the resource location as file://localhost/",
            always,
            |lab| {
                located(lab, Location::Localhost);
            },
        )
    },
    forbidden("no-location", "S7", "passing no resource location", always, |lab| {
        located(lab, Location::Missing);
    }),
    case("free-nothing", "S6", "freeing NULL", always, free_nothing),
    forbidden("null-instance", "S6", "calling with a NULL instance", always, null_instance),
    forbidden(
        "enter-before-setup",
        "M1",
        "initializing without fmi2SetupExperiment",
        always,
        enter_before_setup,
    ),
    forbidden(
        "exit-before-enter",
        "M1",
        "ending an initialization that was not begun",
        always,
        exit_before_enter,
    ),
    forbidden("enter-twice", "M1", "initializing twice", always, enter_twice),
    forbidden("setup-after-initialization", "M1", "calling fmi2SetupExperiment late", always, late_setup),
    forbidden("step-before-initialization", "M1", "stepping before the initialization", always, early_step),
    forbidden(
        "terminate-before-initialization",
        "M5",
        "terminating before the initialization",
        always,
        early_end,
    ),
    forbidden("step-after-terminate", "M5", "stepping after fmi2Terminate", always, step_after_end),
    forbidden("get-before-initialization", "M2", "reading before the initialization", always, early_get),
    forbidden("set-fixed-parameter", "M3", "setting a fixed parameter between steps", always, set_fixed),
    forbidden("set-output", "M3", "setting an output between steps", always, set_output),
    case("set-constant", "S9", "setting a constant", always, set_constant),
    case("unknown-reference", "S9", "using an unknown value reference", always, unknown_reference),
    forbidden("step-nan", "D1", "stepping by NaN", always, |lab| bad_step(lab, None, f64::NAN)),
    forbidden("step-zero", "D1", "stepping by zero", always, |lab| bad_step(lab, None, 0.0)),
    forbidden("step-negative", "D1", "stepping backwards", always, |lab| bad_step(lab, None, -lab.h())),
    forbidden("step-infinite", "D1", "stepping for ever", always, |lab| bad_step(lab, None, f64::INFINITY)),
    forbidden("time-nan", "D1", "stepping from NaN", always, |lab| bad_step(lab, Some(f64::NAN), lab.h())),
    forbidden("time-wrong", "D1", "stepping from another time", always, |lab| {
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
    case(
        "final-past",
        "D5",
        "stepping with a past that is final, and with one that is not",
        always,
        final_past,
    ),
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
    forbidden("only-one-instance", "S8", "instantiating twice", |d| !many(d), only_one),
    case("leak", "S10", "making and freeing many instances", many, leak),
    case("unload", "S11", "unloading the binary", always, unload),
];

/// What a case works with.
pub(super) struct Lab<'a> {
    pub(super) maker: Maker<'a>,
    pub(super) note: &'a CallNote,
    pub(super) description: &'a Description,
    pub(super) reporter: &'a Reporter,
    /// How bad what this case finds is.
    pub(super) level: Level,
    /// The folder of the resources, as a URI.
    pub(super) resources: String,
    /// The same as a path.
    pub(super) folder: PathBuf,
    /// Where the case may write.
    pub(super) work: PathBuf,
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

    /// The variables that [`read`](Self::read) reads.
    fn watched(&self) -> Vec<&'a VariableInfo> {
        let shown = |v: &&VariableInfo| {
            matches!(v.causality, Causality::Output | Causality::Local) && v.kind != Kind::Text
        };
        self.variables().iter().filter(shown).collect()
    }

    /// How large each of them is in a run: its largest value, at least its nominal one.
    fn sizes(&self, bits: &Bits) -> Vec<f64> {
        let watched = self.watched();
        let n = watched.len().max(1);
        let size = |(i, v): (usize, &&VariableInfo)| {
            let values = bits.iter().skip(i).step_by(n).map(|b| f64::from_bits(*b).abs());
            let nominal = v.nominal.map_or(0.0, f64::abs);
            if v.is_real() { values.filter(|x| x.is_finite()).fold(nominal, f64::max) } else { 0.0 }
        };
        watched.iter().enumerate().map(size).collect()
    }

    /// How far the numbers of two runs are apart at most, infinitely for what has no distance: whole numbers,
    /// NaN. `None` for runs of other lengths.
    fn errors(&self, a: &Bits, b: &Bits) -> Option<Vec<f64>> {
        let watched = self.watched();
        let mut errors = vec![0.0; watched.len()];
        if a.len() != b.len() {
            return None;
        }
        for (i, (x, y)) in a.iter().zip(b).enumerate() {
            let at = i % watched.len();
            let difference = (f64::from_bits(*x) - f64::from_bits(*y)).abs();
            if x == y {
                continue;
            }
            let far = !watched[at].is_real() || !difference.is_finite();
            errors[at] = if far { f64::INFINITY } else { difference.max(errors[at]) };
        }
        Some(errors)
    }

    /// Whether two runs are the same, but for rounding and for these errors.
    fn same(&self, a: &Bits, b: &Bits, allowed: Option<&[f64]>) -> bool {
        let Some(errors) = self.errors(a, b) else { return false };
        errors.iter().zip(self.sizes(a)).enumerate().all(|(i, (error, size))| {
            let allowed = allowed.and_then(|all| all.get(i)).copied().unwrap_or(0.0);
            *error <= allowed.max(ROUNDING * size)
        })
    }

    /// True if the same calls give the same results in a fresh instance. If not, that is reported: then no
    /// difference says anything of what was done between.
    fn repeatable(&self, expected: &Bits, again: impl Fn() -> Option<Bits>) -> bool {
        if !many(self.description) {
            return true;
        }
        let Some(bits) = again() else { return true };
        let same = self.same(expected, &bits, None);
        if !same {
            self.reporter.warning(
                "S12",
                "the same calls give other results in the next instance, so that results of reset, rollback and instances side by side cannot be compared",
            );
        }
        same
    }

    /// Brings an instance between steps to an error; `None` where that is known to crash.
    fn make_error(&self, unit: &mut Unit<'_>) -> Option<c_int> {
        (!self.work.join(FRAGILE).exists()).then(|| unit.get_real(NOWHERE).0)
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
