//! The C functions of FMI 3.0 that FMI 2.0 does not have, or with other arguments. It has no derivatives of inputs: a master that knows
//! how an input goes on has no way to say so.

use super::c::{Boolean3, Component, LogMessage, Status, Text};
use super::entry::Entry;
use super::export::{self, call, made};
use super::log::{Log, Master};
use super::state::Function;
use crate::Error;
use std::ffi::{CStr, c_void};
use std::ptr::null_mut;

/// fmi3GetVersion.
pub const FMI_VERSION: &CStr = c"3.0";

/// fmi3InstantiateCoSimulation.
///
/// # Safety
/// The texts are null or zero-terminated; they are not kept. `log` can be called with `environment` while the instance lives.
#[allow(clippy::too_many_arguments)] // the standard's
pub unsafe fn instantiate(
    models: &[Entry],
    name: Text,
    token: Text,
    resources: Text,
    debug: Boolean3,
    event_mode: Boolean3,
    environment: *mut c_void,
    log: LogMessage,
) -> Component {
    let refused = (event_mode != 0).then_some("there is no Event Mode; see hasEventMode of the description");
    let (master, token) = (Master::Three(log, environment), (token, "the instantiation token"));
    // SAFETY: the caller's promise.
    unsafe { made(models, name, token, resources, master, debug != 0, refused) }
}

/// fmi3InstantiateModelExchange and fmi3InstantiateScheduledExecution.
///
/// # Safety
/// As [`instantiate`].
pub unsafe fn refuse_kind(
    function: &str,
    name: Text,
    environment: *mut c_void,
    log: LogMessage,
) -> Component {
    // SAFETY: the caller's promise: zero-terminated.
    let name = if name.is_null() { c"" } else { unsafe { CStr::from_ptr(name) } };
    let message = format!("{function}: only co-simulation is offered");
    Log::new(Master::Three(log, environment), name, false).error(Status::Error, &message);
    null_mut()
}

/// A function that FMUs for co-simulation without events, clocks and structural parameters have no use for.
///
/// # Safety
/// As `call`.
pub unsafe fn not_offered(c: Component, function: &str) -> Status {
    let refused =
        || Error::call(format!("{function} is not offered; see the capability flags of the description"));
    // SAFETY: the caller's promise.
    unsafe { call(c, Function::NotOffered, |_| Err(refused())) }
}

/// Getters and setters of types that no variable has.
///
/// # Safety
/// As `call`.
pub unsafe fn no_variables(c: Component, function: &str, count: usize) -> Status {
    let refused = || Error::variable(format!("{function}: there are no variables of this type"));
    // SAFETY: the caller's promise.
    unsafe { call(c, Function::NotOffered, |_| if count == 0 { Ok(()) } else { Err(refused()) }) }
}

/// fmi3EnterInitializationMode.
///
/// # Safety
/// As `call`.
pub unsafe fn enter_initialization_mode(
    c: Component,
    tolerance_defined: Boolean3,
    tolerance: f64,
    start: f64,
    stop_defined: Boolean3,
    stop: f64,
) -> Status {
    let tolerance = (tolerance_defined != 0).then_some(tolerance);
    let stop = (stop_defined != 0).then_some(stop);
    // SAFETY: the caller's promise.
    unsafe {
        call(c, Function::EnterInitializationMode, |instance| {
            instance.setup_experiment(tolerance, start, stop)?;
            instance.enter_initialization()
        })
    }
}

/// fmi3DoStep. A step that is made is made to its end, and nothing happens that the master has to handle: the three `flags` are about
/// that.
///
/// # Safety
/// As `call`; the places are null or can be written.
pub unsafe fn do_step(
    c: Component,
    time: f64,
    length: f64,
    flags: [*mut Boolean3; 3],
    reached: *mut f64,
) -> Status {
    // SAFETY: the caller's promise, here and inside.
    unsafe {
        call(c, Function::DoStep, |instance| {
            for flag in flags {
                *flag.as_mut().ok_or_else(export::nowhere)? = 0;
            }
            let reached = reached.as_mut().ok_or_else(export::nowhere)?;
            *reached = instance.last_successful_time();
            instance.do_step(time, length)?;
            *reached = instance.last_successful_time();
            Ok(())
        })
    }
}
