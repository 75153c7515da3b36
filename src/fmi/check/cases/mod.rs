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
use crate::fmi::check::finding::Level;
use crate::fmi::check::lab::*;
use crate::fmi::check::memory;
use crate::fmi::check::reporter::Found;
use crate::fmi::check::unit::{self, ERROR, Unit};
use crate::fmi::import::Description;
use crate::model::{Causality, Initial, Kind, Value, Variability, VariableInfo};
use std::ffi::c_int;
use std::ptr;

/// Steps of a trajectory that is compared with another one.
const STEPS: u32 = 20;
/// How much results may depend on the length of the steps, relative to the largest value.
const PARTITION_TOLERANCE: f64 = 0.02;
/// How much directional derivatives may differ from differences, relative to the larger one.
const DERIVATIVE_TOLERANCE: f64 = 1e-6;
/// The relative tolerance of a solver where the description does not name one. Tools' defaults are 1e-4
/// to 1e-6.
const SOLVER_TOLERANCE: f64 = 1e-4;
/// Growth of the memory by more than this, in each of so many parts of many cycles, is a leak \[bytes\].
const LEAK: u64 = 64 << 10;
const PARTS: usize = 6;

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
fn real_inputs(d: &Description) -> bool {
    d.interface.variables.iter().any(is_real_input)
}
fn own_memory(d: &Description) -> bool {
    d.capabilities.can_not_use_memory_functions
}
fn text_parameters(d: &Description) -> bool {
    d.interface.variables.iter().any(is_text_parameter)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fmi::check::rules::RULES;

    #[test]
    fn every_case_names_a_rule() {
        for (i, case) in CASES.iter().enumerate() {
            assert!(RULES.iter().any(|r| r.name == case.rule), "{}", case.name);
            assert!(CASES[..i].iter().all(|c| c.name != case.name), "{}", case.name);
            assert!(matches!(case.level, Level::Error | Level::Warning));
        }
    }
}
