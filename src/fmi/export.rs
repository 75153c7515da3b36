//! The C functions of an FMU of FMI 2.0, and what those of FMI 3.0 share with them: pointers in, `Instance` calls, status out.
//!
//! [`export_fmus!`](crate::export_fmus) makes the symbols from these in a crate of type
//! `cdylib`. No panic gets past them: it becomes a fatal error.

use super::c::{
    Boolean, Boolean3, Byte, CO_SIMULATION, CallbackFunctions, Component, FALSE, Fmi, FmuState, Status, Text,
    ValueReference,
};
use super::entry::Entry;
use super::float::HostSettings;
use super::instance::{Instance, Saved};
use super::log::{Log, Master};
use super::panics;
use super::pointers::{array, array_mut, text};
use super::state::Function;
use crate::{Error, Result};
use std::ffi::{CStr, c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr::null_mut;

/// fmi2GetTypesPlatform.
pub const TYPES_PLATFORM: &CStr = c"default";
/// fmi2GetVersion.
pub const FMI_VERSION: &CStr = c"2.0";

/// What `function` does with an instance: state machine, messages, panics.
///
/// # Safety
/// `component` is null or came from [`instantiate`] and was not freed, and no other thread uses it.
pub(super) unsafe fn call(
    component: Component,
    function: Function,
    body: impl FnOnce(&mut Instance) -> Result<()>,
) -> Status {
    // SAFETY: the caller's promise.
    let Some(instance) = (unsafe { component.cast::<Instance>().as_mut() }) else { return Status::Error };
    instance.enter();
    let status = match catch_unwind(AssertUnwindSafe(|| instance.call(function, body))) {
        Ok(status) => status,
        Err(_) => catch_unwind(AssertUnwindSafe(|| {
            instance.fatal(&format!("{}: {}", instance.name(function), panics::about()))
        }))
        .unwrap_or(Status::Fatal),
    };
    instance.leave();
    status
}

/// fmi2Instantiate.
///
/// # Safety
/// The pointers are null or as FMI 2.0 has them; they are not kept.
#[allow(clippy::too_many_arguments)] // the standard's
pub unsafe fn instantiate(
    models: &[Entry],
    name: Text,
    kind: c_int,
    guid: Text,
    location: Text,
    functions: *const CallbackFunctions,
    _visible: Boolean,
    debug: Boolean,
) -> Component {
    // Without callbacks there is nobody to tell.
    // SAFETY: null or valid by the caller's promise; copied.
    let Some(&callbacks) = (unsafe { functions.as_ref() }) else { return null_mut() };
    let refused = (kind != CO_SIMULATION).then_some("only co-simulation is offered, not model exchange");
    // SAFETY: the caller's promise.
    unsafe {
        made(models, name, (guid, "the GUID"), location, Master::Two(callbacks), debug != FALSE, refused)
    }
}

/// A new instance, or null and a message: also where what is asked for is `refused`.
///
/// # Safety
/// The texts are null or zero-terminated; they are not kept. What `master` has can be called while the instance lives.
pub(super) unsafe fn made(
    models: &[Entry],
    name: Text,
    (guid, what): (Text, &str),
    location: Text,
    master: Master,
    debug: bool,
    refused: Option<&str>,
) -> Component {
    panics::silence();
    let settings = HostSettings::replace();
    let made = catch_unwind(AssertUnwindSafe(|| {
        // SAFETY: the caller's promise.
        let (name_text, guid, location) = unsafe {
            (text(name, "the instance name")?, text(guid, what)?, text(location, "the resource location")?)
        };
        if name_text.is_none_or(|n| n.trim().is_empty()) {
            return Err(Error::call("the instance name is missing or blank"));
        }
        if let Some(refused) = refused {
            return Err(Error::call(refused));
        }
        let guid = guid.ok_or_else(|| Error::call(format!("{what} is missing")))?;
        // SAFETY: not null, or `name_text` had been `None`.
        let name = unsafe { CStr::from_ptr(name) };
        Instance::new(models, name, guid, location, master, debug)
    }));
    drop(settings);
    let error = match made {
        Ok(Ok(instance)) => return Box::into_raw(Box::new(instance)).cast(),
        Ok(Err(error)) => error,
        Err(_) => Error::fmu(panics::about()),
    };
    // SAFETY: null or valid by the caller's promise.
    let name = if name.is_null() { c"" } else { unsafe { CStr::from_ptr(name) } };
    let function = match master.fmi() {
        Fmi::Two => "fmi2Instantiate",
        Fmi::Three => "fmi3InstantiateCoSimulation",
    };
    Log::new(master, name, false).error(Status::Error, &format!("{function}: {error}"));
    null_mut()
}

/// fmi2FreeInstance.
///
/// # Safety
/// `component` is null or came from [`instantiate`] and was not freed.
pub unsafe fn free_instance(component: Component) {
    if !component.is_null() {
        // SAFETY: the caller's promise: a pointer from Box::into_raw.
        let instance = unsafe { Box::from_raw(component.cast::<Instance>()) };
        let (slave, log) = instance.take_apart();
        if catch_unwind(AssertUnwindSafe(|| drop(slave))).is_err() {
            log.error(Status::Fatal, &format!("{}FreeInstance: {}", log.fmi().prefix(), panics::about()));
        }
    }
}

/// fmi2SetDebugLogging.
///
/// # Safety
/// As `call`; `categories` points to `count` texts.
pub unsafe fn set_debug_logging(c: Component, on: Boolean, count: usize, categories: *const Text) -> Status {
    // SAFETY: the caller's promise, here and inside.
    unsafe {
        call(c, Function::SetDebugLogging, |instance| {
            let categories = array(categories, count, "categories")?
                .iter()
                .map(|c| text(*c, "a category")?.ok_or_else(|| Error::call("a category is a null pointer")))
                .collect::<Result<Vec<_>>>()?;
            instance.set_debug_logging(on != FALSE, &categories)
        })
    }
}

/// fmi2SetupExperiment.
///
/// # Safety
/// As `call`.
pub unsafe fn setup_experiment(
    c: Component,
    tolerance_defined: Boolean,
    tolerance: f64,
    start: f64,
    stop_defined: Boolean,
    stop: f64,
) -> Status {
    let tolerance = (tolerance_defined != FALSE).then_some(tolerance);
    let stop = (stop_defined != FALSE).then_some(stop);
    // SAFETY: the caller's promise.
    unsafe { call(c, Function::SetupExperiment, |i| i.setup_experiment(tolerance, start, stop)) }
}

/// Functions that have no arguments but the instance.
macro_rules! plain {
    ($($(#[$doc:meta])* $name:ident: $function:ident, $method:ident;)*) => {$(
        $(#[$doc])*
        ///
        /// # Safety
        /// As `call`.
        pub unsafe fn $name(c: Component) -> Status {
            // SAFETY: the caller's promise.
            unsafe { call(c, Function::$function, Instance::$method) }
        }
    )*};
}

plain! {
    /// fmi2EnterInitializationMode.
    enter_initialization_mode: EnterInitializationMode, enter_initialization;
    /// fmi2ExitInitializationMode.
    exit_initialization_mode: ExitInitializationMode, exit_initialization;
    /// fmi2Terminate.
    terminate: Terminate, terminate;
    /// fmi2Reset.
    reset: Reset, reset;
}

/// Every variable has one value.
fn one_each(references: usize, values: usize, what: &str) -> Result<()> {
    if references == values {
        return Ok(());
    }
    Err(Error::call(format!(
        "{references} value references and {values} {what}: every variable has one value"
    )))
}

/// Values of variables of a type. FMI 2.0 has one count for both arrays.
macro_rules! getter {
    ($($name:ident: $function:ident, $type:ty, $method:ident;)*) => {$(
        #[doc = concat!("fmi2", stringify!($function), " and its like in FMI 3.0, for values of this type.")]
        ///
        /// # Safety
        /// As `call`; the arrays have as many items as their counts say.
        pub unsafe fn $name(c: Component, references: *const ValueReference, count: usize, values: *mut $type, value_count: usize) -> Status {
            // SAFETY: the caller's promise, here and inside.
            unsafe {
                call(c, Function::$function, |instance| {
                    one_each(count, value_count, "values")?;
                    let references = array(references, count, "value references")?;
                    let values = array_mut(values, count, "values")?;
                    for (reference, value) in references.iter().zip(values) {
                        *value = instance.$method(*reference)?.into();
                    }
                    Ok(())
                })
            }
        }
    )*};
}

getter! {
    get_real: GetReal, f64, get_real;
    get_integer: GetInteger, c_int, get_integer;
    get_enumeration: GetInteger, i64, get_enumeration;
    get_boolean: GetBoolean, Boolean, get_boolean;
    get_byte_boolean: GetBoolean, Boolean3, get_boolean;
}

/// fmi2GetString.
///
/// # Safety
/// As `call`; the arrays have `count` items.
pub unsafe fn get_string(
    c: Component,
    references: *const ValueReference,
    count: usize,
    values: *mut Text,
    value_count: usize,
) -> Status {
    // SAFETY: the caller's promise, here and inside.
    unsafe {
        call(c, Function::GetString, |instance| {
            one_each(count, value_count, "values")?;
            let references = array(references, count, "value references")?;
            let values = array_mut(values, count, "values")?;
            for (text, value) in instance.get_texts(references)?.iter().zip(values) {
                *value = text.as_ptr();
            }
            Ok(())
        })
    }
}

/// The same the other way.
macro_rules! setter {
    ($($name:ident: $function:ident, $type:ty, $method:ident;)*) => {$(
        #[doc = concat!("fmi2", stringify!($function), " and its like in FMI 3.0, for values of this type.")]
        ///
        /// # Safety
        /// As `call`; the arrays have as many items as their counts say.
        pub unsafe fn $name(c: Component, references: *const ValueReference, count: usize, values: *const $type, value_count: usize) -> Status {
            // SAFETY: the caller's promise, here and inside.
            unsafe {
                call(c, Function::$function, |instance| {
                    one_each(count, value_count, "values")?;
                    let references = array(references, count, "value references")?;
                    let values = array(values, count, "values")?;
                    references.iter().zip(values).try_for_each(|(r, v)| instance.$method(*r, (*v).into()))
                })
            }
        }
    )*};
}

setter! {
    set_real: SetReal, f64, set_real;
    set_integer: SetInteger, c_int, set_integer;
    set_enumeration: SetInteger, i64, set_enumeration;
    set_boolean: SetBoolean, Boolean, set_boolean;
    set_byte_boolean: SetBoolean, Boolean3, set_boolean;
}

/// fmi2SetString.
///
/// # Safety
/// As `call`; the arrays have `count` items.
pub unsafe fn set_string(
    c: Component,
    references: *const ValueReference,
    count: usize,
    values: *const Text,
    value_count: usize,
) -> Status {
    // SAFETY: the caller's promise, here and inside.
    unsafe {
        call(c, Function::SetString, |instance| {
            one_each(count, value_count, "values")?;
            let references = array(references, count, "value references")?;
            let values = array(values, count, "values")?;
            for (reference, value) in references.iter().zip(values) {
                let value = text(*value, "a text")?.ok_or_else(|| Error::call("a text is a null pointer"))?;
                instance.set_text(*reference, value)?;
            }
            Ok(())
        })
    }
}

/// fmi2SetRealInputDerivatives.
///
/// # Safety
/// As `call`; the arrays have `count` items.
pub unsafe fn set_real_input_derivatives(
    c: Component,
    references: *const ValueReference,
    count: usize,
    orders: *const c_int,
    values: *const f64,
) -> Status {
    // SAFETY: the caller's promise, here and inside.
    unsafe {
        call(c, Function::SetRealInputDerivatives, |instance| {
            let references = array(references, count, "value references")?;
            let orders = array(orders, count, "orders")?;
            let values = array(values, count, "values")?;
            for ((reference, order), value) in references.iter().zip(orders).zip(values) {
                instance.set_rate(*reference, *order, *value)?;
            }
            Ok(())
        })
    }
}

/// fmi2GetRealOutputDerivatives.
///
/// # Safety
/// As `call`; the arrays have `count` items.
pub unsafe fn get_real_output_derivatives(
    c: Component,
    references: *const ValueReference,
    count: usize,
    orders: *const c_int,
    values: *mut f64,
    value_count: usize,
) -> Status {
    // SAFETY: the caller's promise, here and inside.
    unsafe {
        call(c, Function::GetRealOutputDerivatives, |instance| {
            one_each(count, value_count, "values")?;
            let references = array(references, count, "value references")?;
            let orders = array(orders, count, "orders")?;
            let values = array_mut(values, count, "values")?;
            for ((reference, order), value) in references.iter().zip(orders).zip(values) {
                *value = instance.output_derivative(*reference, *order)?;
            }
            Ok(())
        })
    }
}

/// fmi2GetDirectionalDerivative.
///
/// # Safety
/// As `call`; the arrays have as many items as their counts say.
#[allow(clippy::too_many_arguments)] // the standard's
pub unsafe fn get_directional_derivative(
    c: Component,
    unknowns: *const ValueReference,
    unknown_count: usize,
    knowns: *const ValueReference,
    known_count: usize,
    seed: *const f64,
    seed_count: usize,
    values: *mut f64,
    value_count: usize,
) -> Status {
    // SAFETY: the caller's promise, here and inside.
    unsafe {
        call(c, Function::GetDirectionalDerivative, |instance| {
            one_each(known_count, seed_count, "numbers of the direction")?;
            one_each(unknown_count, value_count, "values")?;
            let unknowns = array(unknowns, unknown_count, "unknowns")?;
            let knowns = array(knowns, known_count, "knowns")?;
            let seed = array(seed, known_count, "numbers of the direction")?;
            let values = array_mut(values, unknown_count, "values")?;
            values.copy_from_slice(&instance.directional_derivatives(unknowns, knowns, seed)?);
            Ok(())
        })
    }
}

/// The saved state behind a handle.
///
/// # Safety
/// `handle` is null or came from [`get_fmu_state`] or [`deserialize_fmu_state`] and was not freed.
unsafe fn saved<'a>(handle: FmuState) -> Result<&'a mut Saved> {
    // SAFETY: the caller's promise.
    unsafe { handle.cast::<Saved>().as_mut() }.ok_or_else(|| Error::call("the FMU state is a null pointer"))
}

pub(super) fn nowhere() -> Error {
    Error::call("the place for the result is a null pointer")
}

/// fmi2GetFMUstate.
///
/// # Safety
/// As `call`; `handle` points to null or to a handle of this instance.
pub unsafe fn get_fmu_state(c: Component, handle: *mut FmuState) -> Status {
    // SAFETY: the caller's promise, here and inside.
    unsafe {
        call(c, Function::GetFMUstate, |instance| {
            let handle = handle.as_mut().ok_or_else(nowhere)?;
            if handle.is_null() {
                *handle = Box::into_raw(Box::new(instance.save()?)).cast();
                return Ok(());
            }
            instance.save_into(saved(*handle)?)
        })
    }
}

/// fmi2SetFMUstate.
///
/// # Safety
/// As `call` and `saved`.
pub unsafe fn set_fmu_state(c: Component, handle: FmuState) -> Status {
    // SAFETY: the caller's promise, here and inside.
    unsafe { call(c, Function::SetFMUstate, |instance| instance.restore(saved(handle)?)) }
}

/// fmi2FreeFMUstate.
///
/// # Safety
/// As `call`; `handle` is null, or points to null or to a handle of this instance.
pub unsafe fn free_fmu_state(c: Component, handle: *mut FmuState) -> Status {
    // SAFETY: the caller's promise, here and inside.
    unsafe {
        call(c, Function::FreeFMUstate, |_| {
            if let Some(handle) = handle.as_mut()
                && !handle.is_null()
            {
                drop(Box::from_raw(handle.cast::<Saved>()));
                *handle = null_mut();
            }
            Ok(())
        })
    }
}

/// fmi2SerializedFMUstateSize.
///
/// # Safety
/// As `call` and `saved`; `size` is null or can be written.
pub unsafe fn serialized_fmu_state_size(c: Component, handle: FmuState, size: *mut usize) -> Status {
    // SAFETY: the caller's promise, here and inside.
    unsafe {
        call(c, Function::SerializedFMUstateSize, |instance| {
            let size = size.as_mut().ok_or_else(nowhere)?;
            *size = instance.serialize(saved(handle)?)?.len();
            Ok(())
        })
    }
}

/// fmi2SerializeFMUstate.
///
/// # Safety
/// As `call` and `saved`; `bytes` has room for `size`.
pub unsafe fn serialize_fmu_state(c: Component, handle: FmuState, bytes: *mut Byte, size: usize) -> Status {
    // SAFETY: the caller's promise, here and inside.
    unsafe {
        call(c, Function::SerializeFMUstate, |instance| {
            let state = instance.serialize(saved(handle)?)?;
            let bytes = array_mut(bytes.cast::<u8>(), size, "bytes")?;
            let Some(room) = bytes.get_mut(..state.len()) else {
                return Err(Error::call(format!(
                    "the state needs {} bytes, there is room for {size}",
                    state.len()
                )));
            };
            room.copy_from_slice(&state);
            Ok(())
        })
    }
}

/// fmi2DeSerializeFMUstate.
///
/// # Safety
/// As [`get_fmu_state`]; `bytes` has `size` items.
pub unsafe fn deserialize_fmu_state(
    c: Component,
    bytes: *const Byte,
    size: usize,
    handle: *mut FmuState,
) -> Status {
    // SAFETY: the caller's promise, here and inside.
    unsafe {
        call(c, Function::DeSerializeFMUstate, |instance| {
            let state = instance.deserialize(array(bytes.cast::<u8>(), size, "bytes")?)?;
            let handle = handle.as_mut().ok_or_else(nowhere)?;
            if handle.is_null() {
                *handle = Box::into_raw(Box::new(state)).cast();
            } else {
                *saved(*handle)? = state;
            }
            Ok(())
        })
    }
}

/// fmi2DoStep.
///
/// # Safety
/// As `call`.
pub unsafe fn do_step(c: Component, time: f64, length: f64, _no_state_prior: Boolean) -> Status {
    // SAFETY: the caller's promise.
    unsafe { call(c, Function::DoStep, |instance| instance.do_step(time, length)) }
}

/// A function that this version does not offer; the capability flags say so.
///
/// # Safety
/// As `call`.
pub unsafe fn not_offered(c: Component, function: Function) -> Status {
    // SAFETY: the caller's promise.
    unsafe {
        call(c, function, |_| Err(Error::call("not offered; see the capability flags of the description")))
    }
}

/// The fmi2Get...Status functions: the last successful time and whether the slave wants to end have
/// answers; the others are about asynchronous steps, which there are none of.
///
/// # Safety
/// As `call`; `value` is null or can be written.
unsafe fn get_status<T>(
    c: Component,
    function: Function,
    value: *mut T,
    answer: impl FnOnce(&Instance) -> Option<T>,
) -> Status {
    let mut discard = false;
    // SAFETY: the caller's promise, here and inside.
    let status = unsafe {
        call(c, function, |instance| {
            let value = value.as_mut().ok_or_else(nowhere)?;
            match answer(instance) {
                Some(answer) => *value = answer,
                None => {
                    instance.discard(function);
                    discard = true;
                }
            }
            Ok(())
        })
    };
    if status == Status::Ok && discard { Status::Discard } else { status }
}

/// fmi2GetRealStatus: the last successful time.
///
/// # Safety
/// As `call`; `value` is null or can be written.
pub unsafe fn get_real_status(c: Component, kind: c_int, value: *mut f64) -> Status {
    const LAST_SUCCESSFUL_TIME: c_int = 2;
    let answer = |i: &Instance| (kind == LAST_SUCCESSFUL_TIME).then(|| i.last_successful_time());
    // SAFETY: the caller's promise.
    unsafe { get_status(c, Function::GetRealStatus, value, answer) }
}

/// fmi2GetBooleanStatus: whether the slave wants to end, which it never does.
///
/// # Safety
/// As `call`; `value` is null or can be written.
pub unsafe fn get_boolean_status(c: Component, kind: c_int, value: *mut Boolean) -> Status {
    const TERMINATED: c_int = 3;
    // SAFETY: the caller's promise.
    unsafe { get_status(c, Function::GetBooleanStatus, value, |_| (kind == TERMINATED).then_some(FALSE)) }
}

/// fmi2GetStatus, fmi2GetIntegerStatus, fmi2GetStringStatus: no kind of status has these types, or only
/// an asynchronous step has.
///
/// # Safety
/// As `call`; `value` is null or can be written.
pub unsafe fn no_status<T>(c: Component, function: Function, value: *mut T) -> Status {
    // SAFETY: the caller's promise.
    unsafe { get_status(c, function, value, |_| None) }
}

/// Passes the interfaces and documentations of a library's models to `sink`, for whoever makes an FMU:
/// version and (interface, documentation) of each model, serialised.
///
/// # Safety
/// `sink` can be called with `context` and bytes that live during the call.
pub unsafe fn describe_models(models: &[Entry], sink: Sink, context: *mut c_void) {
    panics::silence();
    let bytes = catch_unwind(|| {
        let tables: Vec<_> = models.iter().map(|m| ((m.table)(), m.documentation.concat())).collect();
        postcard::to_stdvec(&(crate::VERSION, tables)).unwrap_or_default()
    })
    .unwrap_or_default();
    // SAFETY: the caller's promise.
    unsafe { sink(context, bytes.as_ptr(), bytes.len()) }
}

/// Receives bytes: context, start, length.
pub type Sink = unsafe extern "C" fn(*mut c_void, *const u8, usize);
