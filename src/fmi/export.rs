//! The C functions of an FMU of FMI 2.0, and what those of FMI 3.0 share with them: pointers in, `Instance` calls, status out.
//!
//! [`export_fmus!`](crate::export_fmus) makes the `fmi2...` symbols from these in a crate of type
//! `cdylib`. No panic gets past them: it becomes fmi2Fatal.

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

/// One C function per line, each forwarding to this module.
#[doc(hidden)]
#[macro_export]
macro_rules! __c_functions {
    ($($symbol:ident($($argument:ident: $type:ty),*) $(-> $result:ty)? = $body:expr;)*) => {$(
        #[unsafe(no_mangle)]
        #[allow(non_snake_case, missing_docs, clippy::missing_safety_doc, clippy::too_many_arguments)]
        pub unsafe extern "C" fn $symbol($($argument: $type),*) $(-> $result)? {
            // SAFETY: the master keeps to the standard.
            unsafe { $body }
        }
    )*};
}

/// Exports the named models as the functions of FMI 2.0 and FMI 3.0 of a crate of type `cdylib`: which of them an FMU is, its
/// description says.
///
/// ```text
/// latsch::export_fmus!(MyModel, AnotherModel);
/// latsch::export_fmus!(entries: &[Entry::of::<MyModel>()]); // a list that is made elsewhere
/// ```
#[macro_export]
macro_rules! export_fmus {
    ($($model:ty),+ $(,)?) => {
        $crate::export_fmus!(entries: &[$(Entry::of::<$model>()),+]);
    };
    (entries: $entries:expr) => {
        mod latsch_fmi {
            #[allow(unused_imports)]
            use super::*;
            use ::std::ffi::{c_int, c_void};
            use $crate::fmi::c::*;
            use $crate::fmi::export::{self, Sink};
            use $crate::fmi::export3;
            use $crate::fmi::{Entry, Function};

            const MODELS: &[Entry] = $entries;

            $crate::__c_functions! {
                latsch_models(sink: Sink, context: *mut c_void) = export::describe_models(MODELS, sink, context);
                fmi2GetTypesPlatform() -> Text = export::TYPES_PLATFORM.as_ptr();
                fmi2GetVersion() -> Text = export::FMI_VERSION.as_ptr();
                fmi2SetDebugLogging(c: Component, on: Boolean, n: usize, categories: *const Text) -> Status
                    = export::set_debug_logging(c, on, n, categories);
                fmi2Instantiate(name: Text, kind: c_int, guid: Text, location: Text, functions: *const CallbackFunctions, visible: Boolean, debug: Boolean) -> Component
                    = export::instantiate(MODELS, name, kind, guid, location, functions, visible, debug);
                fmi2FreeInstance(c: Component) = export::free_instance(c);
                fmi2SetupExperiment(c: Component, tolerance_defined: Boolean, tolerance: f64, start: f64, stop_defined: Boolean, stop: f64) -> Status
                    = export::setup_experiment(c, tolerance_defined, tolerance, start, stop_defined, stop);
                fmi2EnterInitializationMode(c: Component) -> Status = export::enter_initialization_mode(c);
                fmi2ExitInitializationMode(c: Component) -> Status = export::exit_initialization_mode(c);
                fmi2Terminate(c: Component) -> Status = export::terminate(c);
                fmi2Reset(c: Component) -> Status = export::reset(c);
                fmi2GetReal(c: Component, vr: *const ValueReference, n: usize, values: *mut f64) -> Status = export::get_real(c, vr, n, values, n);
                fmi2GetInteger(c: Component, vr: *const ValueReference, n: usize, values: *mut c_int) -> Status = export::get_integer(c, vr, n, values, n);
                fmi2GetBoolean(c: Component, vr: *const ValueReference, n: usize, values: *mut Boolean) -> Status = export::get_boolean(c, vr, n, values, n);
                fmi2GetString(c: Component, vr: *const ValueReference, n: usize, values: *mut Text) -> Status = export::get_string(c, vr, n, values, n);
                fmi2SetReal(c: Component, vr: *const ValueReference, n: usize, values: *const f64) -> Status = export::set_real(c, vr, n, values, n);
                fmi2SetInteger(c: Component, vr: *const ValueReference, n: usize, values: *const c_int) -> Status = export::set_integer(c, vr, n, values, n);
                fmi2SetBoolean(c: Component, vr: *const ValueReference, n: usize, values: *const Boolean) -> Status = export::set_boolean(c, vr, n, values, n);
                fmi2SetString(c: Component, vr: *const ValueReference, n: usize, values: *const Text) -> Status = export::set_string(c, vr, n, values, n);
                fmi2GetFMUstate(c: Component, state: *mut FmuState) -> Status = export::get_fmu_state(c, state);
                fmi2SetFMUstate(c: Component, state: FmuState) -> Status = export::set_fmu_state(c, state);
                fmi2FreeFMUstate(c: Component, state: *mut FmuState) -> Status = export::free_fmu_state(c, state);
                fmi2SerializedFMUstateSize(c: Component, state: FmuState, size: *mut usize) -> Status = export::serialized_fmu_state_size(c, state, size);
                fmi2SerializeFMUstate(c: Component, state: FmuState, bytes: *mut Byte, size: usize) -> Status = export::serialize_fmu_state(c, state, bytes, size);
                fmi2DeSerializeFMUstate(c: Component, bytes: *const Byte, size: usize, state: *mut FmuState) -> Status = export::deserialize_fmu_state(c, bytes, size, state);
                fmi2GetDirectionalDerivative(c: Component, unknowns: *const ValueReference, n_unknowns: usize, knowns: *const ValueReference, n_knowns: usize, seed: *const f64, values: *mut f64) -> Status
                    = export::get_directional_derivative(c, unknowns, n_unknowns, knowns, n_knowns, seed, n_knowns, values, n_unknowns);
                fmi2SetRealInputDerivatives(c: Component, vr: *const ValueReference, n: usize, orders: *const c_int, values: *const f64) -> Status
                    = export::set_real_input_derivatives(c, vr, n, orders, values);
                fmi2GetRealOutputDerivatives(c: Component, vr: *const ValueReference, n: usize, orders: *const c_int, values: *mut f64) -> Status
                    = export::get_real_output_derivatives(c, vr, n, orders, values, n);
                fmi2DoStep(c: Component, time: f64, length: f64, no_state_prior: Boolean) -> Status = export::do_step(c, time, length, no_state_prior);
                fmi2CancelStep(c: Component) -> Status = export::not_offered(c, Function::CancelStep);
                fmi2GetStatus(c: Component, _kind: c_int, value: *mut Status) -> Status
                    = export::no_status(c, Function::GetStatus, value);
                fmi2GetRealStatus(c: Component, kind: c_int, value: *mut f64) -> Status = export::get_real_status(c, kind, value);
                fmi2GetIntegerStatus(c: Component, _kind: c_int, value: *mut c_int) -> Status
                    = export::no_status(c, Function::GetIntegerStatus, value);
                fmi2GetBooleanStatus(c: Component, kind: c_int, value: *mut Boolean) -> Status = export::get_boolean_status(c, kind, value);
                fmi2GetStringStatus(c: Component, _kind: c_int, value: *mut Text) -> Status
                    = export::no_status(c, Function::GetStringStatus, value);
            }

            $crate::__c_functions! {
                fmi3GetVersion() -> Text = export3::FMI_VERSION.as_ptr();
                fmi3SetDebugLogging(c: Component, on: Boolean3, n: usize, categories: *const Text) -> Status
                    = export::set_debug_logging(c, on.into(), n, categories);
                fmi3InstantiateCoSimulation(name: Text, token: Text, resources: Text, _visible: Boolean3, debug: Boolean3, event_mode: Boolean3, _early_return: Boolean3, _intermediate: *const ValueReference, _n: usize, environment: *mut c_void, log: LogMessage, _update: IntermediateUpdate) -> Component
                    = export3::instantiate(MODELS, name, token, resources, debug, event_mode, environment, log);
                fmi3InstantiateModelExchange(name: Text, _token: Text, _resources: Text, _visible: Boolean3, _debug: Boolean3, environment: *mut c_void, log: LogMessage) -> Component
                    = export3::refuse_kind("fmi3InstantiateModelExchange", name, environment, log);
                fmi3InstantiateScheduledExecution(name: Text, _token: Text, _resources: Text, _visible: Boolean3, _debug: Boolean3, environment: *mut c_void, log: LogMessage, _clock: IntermediateUpdate, _lock: IntermediateUpdate, _unlock: IntermediateUpdate) -> Component
                    = export3::refuse_kind("fmi3InstantiateScheduledExecution", name, environment, log);
                fmi3FreeInstance(c: Component) = export::free_instance(c);
                fmi3EnterInitializationMode(c: Component, tolerance_defined: Boolean3, tolerance: f64, start: f64, stop_defined: Boolean3, stop: f64) -> Status
                    = export3::enter_initialization_mode(c, tolerance_defined, tolerance, start, stop_defined, stop);
                fmi3ExitInitializationMode(c: Component) -> Status = export::exit_initialization_mode(c);
                fmi3Terminate(c: Component) -> Status = export::terminate(c);
                fmi3Reset(c: Component) -> Status = export::reset(c);
                fmi3GetFloat64(c: Component, vr: *const ValueReference, n: usize, values: *mut f64, m: usize) -> Status = export::get_real(c, vr, n, values, m);
                fmi3GetInt32(c: Component, vr: *const ValueReference, n: usize, values: *mut i32, m: usize) -> Status = export::get_integer(c, vr, n, values, m);
                fmi3GetInt64(c: Component, vr: *const ValueReference, n: usize, values: *mut i64, m: usize) -> Status = export::get_enumeration(c, vr, n, values, m);
                fmi3GetBoolean(c: Component, vr: *const ValueReference, n: usize, values: *mut Boolean3, m: usize) -> Status = export::get_byte_boolean(c, vr, n, values, m);
                fmi3GetString(c: Component, vr: *const ValueReference, n: usize, values: *mut Text, m: usize) -> Status = export::get_string(c, vr, n, values, m);
                fmi3SetFloat64(c: Component, vr: *const ValueReference, n: usize, values: *const f64, m: usize) -> Status = export::set_real(c, vr, n, values, m);
                fmi3SetInt32(c: Component, vr: *const ValueReference, n: usize, values: *const i32, m: usize) -> Status = export::set_integer(c, vr, n, values, m);
                fmi3SetInt64(c: Component, vr: *const ValueReference, n: usize, values: *const i64, m: usize) -> Status = export::set_enumeration(c, vr, n, values, m);
                fmi3SetBoolean(c: Component, vr: *const ValueReference, n: usize, values: *const Boolean3, m: usize) -> Status = export::set_byte_boolean(c, vr, n, values, m);
                fmi3SetString(c: Component, vr: *const ValueReference, n: usize, values: *const Text, m: usize) -> Status = export::set_string(c, vr, n, values, m);
                fmi3GetFloat32(c: Component, _vr: *const ValueReference, n: usize, _values: *mut f32, _m: usize) -> Status = export3::no_variables(c, "fmi3GetFloat32", n);
                fmi3GetInt8(c: Component, _vr: *const ValueReference, n: usize, _values: *mut i8, _m: usize) -> Status = export3::no_variables(c, "fmi3GetInt8", n);
                fmi3GetUInt8(c: Component, _vr: *const ValueReference, n: usize, _values: *mut u8, _m: usize) -> Status = export3::no_variables(c, "fmi3GetUInt8", n);
                fmi3GetInt16(c: Component, _vr: *const ValueReference, n: usize, _values: *mut i16, _m: usize) -> Status = export3::no_variables(c, "fmi3GetInt16", n);
                fmi3GetUInt16(c: Component, _vr: *const ValueReference, n: usize, _values: *mut u16, _m: usize) -> Status = export3::no_variables(c, "fmi3GetUInt16", n);
                fmi3GetUInt32(c: Component, _vr: *const ValueReference, n: usize, _values: *mut u32, _m: usize) -> Status = export3::no_variables(c, "fmi3GetUInt32", n);
                fmi3GetUInt64(c: Component, _vr: *const ValueReference, n: usize, _values: *mut u64, _m: usize) -> Status = export3::no_variables(c, "fmi3GetUInt64", n);
                fmi3GetBinary(c: Component, _vr: *const ValueReference, n: usize, _sizes: *mut usize, _values: *mut *const u8, _m: usize) -> Status = export3::no_variables(c, "fmi3GetBinary", n);
                fmi3GetClock(c: Component, _vr: *const ValueReference, n: usize, _values: *mut Boolean3) -> Status = export3::no_variables(c, "fmi3GetClock", n);
                fmi3SetFloat32(c: Component, _vr: *const ValueReference, n: usize, _values: *const f32, _m: usize) -> Status = export3::no_variables(c, "fmi3SetFloat32", n);
                fmi3SetInt8(c: Component, _vr: *const ValueReference, n: usize, _values: *const i8, _m: usize) -> Status = export3::no_variables(c, "fmi3SetInt8", n);
                fmi3SetUInt8(c: Component, _vr: *const ValueReference, n: usize, _values: *const u8, _m: usize) -> Status = export3::no_variables(c, "fmi3SetUInt8", n);
                fmi3SetInt16(c: Component, _vr: *const ValueReference, n: usize, _values: *const i16, _m: usize) -> Status = export3::no_variables(c, "fmi3SetInt16", n);
                fmi3SetUInt16(c: Component, _vr: *const ValueReference, n: usize, _values: *const u16, _m: usize) -> Status = export3::no_variables(c, "fmi3SetUInt16", n);
                fmi3SetUInt32(c: Component, _vr: *const ValueReference, n: usize, _values: *const u32, _m: usize) -> Status = export3::no_variables(c, "fmi3SetUInt32", n);
                fmi3SetUInt64(c: Component, _vr: *const ValueReference, n: usize, _values: *const u64, _m: usize) -> Status = export3::no_variables(c, "fmi3SetUInt64", n);
                fmi3SetBinary(c: Component, _vr: *const ValueReference, n: usize, _sizes: *const usize, _values: *const *const u8, _m: usize) -> Status = export3::no_variables(c, "fmi3SetBinary", n);
                fmi3SetClock(c: Component, _vr: *const ValueReference, n: usize, _values: *const Boolean3) -> Status = export3::no_variables(c, "fmi3SetClock", n);
                fmi3GetFMUState(c: Component, state: *mut FmuState) -> Status = export::get_fmu_state(c, state);
                fmi3SetFMUState(c: Component, state: FmuState) -> Status = export::set_fmu_state(c, state);
                fmi3FreeFMUState(c: Component, state: *mut FmuState) -> Status = export::free_fmu_state(c, state);
                fmi3SerializedFMUStateSize(c: Component, state: FmuState, size: *mut usize) -> Status = export::serialized_fmu_state_size(c, state, size);
                fmi3SerializeFMUState(c: Component, state: FmuState, bytes: *mut u8, size: usize) -> Status = export::serialize_fmu_state(c, state, bytes.cast(), size);
                fmi3DeserializeFMUState(c: Component, bytes: *const u8, size: usize, state: *mut FmuState) -> Status = export::deserialize_fmu_state(c, bytes.cast(), size, state);
                fmi3GetDirectionalDerivative(c: Component, unknowns: *const ValueReference, n_unknowns: usize, knowns: *const ValueReference, n_knowns: usize, seed: *const f64, n_seed: usize, values: *mut f64, n_values: usize) -> Status
                    = export::get_directional_derivative(c, unknowns, n_unknowns, knowns, n_knowns, seed, n_seed, values, n_values);
                fmi3GetOutputDerivatives(c: Component, vr: *const ValueReference, n: usize, orders: *const i32, values: *mut f64, m: usize) -> Status
                    = export::get_real_output_derivatives(c, vr, n, orders, values, m);
                fmi3DoStep(c: Component, time: f64, length: f64, _no_state_prior: Boolean3, event: *mut Boolean3, end: *mut Boolean3, early: *mut Boolean3, reached: *mut f64) -> Status
                    = export3::do_step(c, time, length, [event, end, early], reached);
                fmi3GetNumberOfVariableDependencies(c: Component, _vr: ValueReference, _n: *mut usize) -> Status = export3::not_offered(c, "fmi3GetNumberOfVariableDependencies");
                fmi3GetVariableDependencies(c: Component, _dependent: ValueReference, _elements: *mut usize, _independents: *mut ValueReference, _of: *mut usize, _kinds: *mut c_int, _n: usize) -> Status = export3::not_offered(c, "fmi3GetVariableDependencies");
                fmi3GetAdjointDerivative(c: Component, _unknowns: *const ValueReference, _n: usize, _knowns: *const ValueReference, _m: usize, _seed: *const f64, _k: usize, _values: *mut f64, _l: usize) -> Status = export3::not_offered(c, "fmi3GetAdjointDerivative");
                fmi3EnterConfigurationMode(c: Component) -> Status = export3::not_offered(c, "fmi3EnterConfigurationMode");
                fmi3ExitConfigurationMode(c: Component) -> Status = export3::not_offered(c, "fmi3ExitConfigurationMode");
                fmi3EnterEventMode(c: Component) -> Status = export3::not_offered(c, "fmi3EnterEventMode");
                fmi3EnterStepMode(c: Component) -> Status = export3::not_offered(c, "fmi3EnterStepMode");
                fmi3EvaluateDiscreteStates(c: Component) -> Status = export3::not_offered(c, "fmi3EvaluateDiscreteStates");
                fmi3UpdateDiscreteStates(c: Component, _more: *mut Boolean3, _end: *mut Boolean3, _nominals: *mut Boolean3, _values: *mut Boolean3, _defined: *mut Boolean3, _time: *mut f64) -> Status = export3::not_offered(c, "fmi3UpdateDiscreteStates");
                fmi3GetIntervalDecimal(c: Component, _vr: *const ValueReference, _n: usize, _intervals: *mut f64, _qualifiers: *mut c_int) -> Status = export3::not_offered(c, "fmi3GetIntervalDecimal");
                fmi3GetIntervalFraction(c: Component, _vr: *const ValueReference, _n: usize, _counters: *mut u64, _resolutions: *mut u64, _qualifiers: *mut c_int) -> Status = export3::not_offered(c, "fmi3GetIntervalFraction");
                fmi3GetShiftDecimal(c: Component, _vr: *const ValueReference, _n: usize, _shifts: *mut f64) -> Status = export3::not_offered(c, "fmi3GetShiftDecimal");
                fmi3GetShiftFraction(c: Component, _vr: *const ValueReference, _n: usize, _counters: *mut u64, _resolutions: *mut u64) -> Status = export3::not_offered(c, "fmi3GetShiftFraction");
                fmi3SetIntervalDecimal(c: Component, _vr: *const ValueReference, _n: usize, _intervals: *const f64) -> Status = export3::not_offered(c, "fmi3SetIntervalDecimal");
                fmi3SetIntervalFraction(c: Component, _vr: *const ValueReference, _n: usize, _counters: *const u64, _resolutions: *const u64) -> Status = export3::not_offered(c, "fmi3SetIntervalFraction");
                fmi3SetShiftDecimal(c: Component, _vr: *const ValueReference, _n: usize, _shifts: *const f64) -> Status = export3::not_offered(c, "fmi3SetShiftDecimal");
                fmi3SetShiftFraction(c: Component, _vr: *const ValueReference, _n: usize, _counters: *const u64, _resolutions: *const u64) -> Status = export3::not_offered(c, "fmi3SetShiftFraction");
                fmi3EnterContinuousTimeMode(c: Component) -> Status = export3::not_offered(c, "fmi3EnterContinuousTimeMode");
                fmi3CompletedIntegratorStep(c: Component, _no_state_prior: Boolean3, _event: *mut Boolean3, _end: *mut Boolean3) -> Status = export3::not_offered(c, "fmi3CompletedIntegratorStep");
                fmi3SetTime(c: Component, _time: f64) -> Status = export3::not_offered(c, "fmi3SetTime");
                fmi3SetContinuousStates(c: Component, _states: *const f64, _n: usize) -> Status = export3::not_offered(c, "fmi3SetContinuousStates");
                fmi3GetContinuousStateDerivatives(c: Component, _derivatives: *mut f64, _n: usize) -> Status = export3::not_offered(c, "fmi3GetContinuousStateDerivatives");
                fmi3GetEventIndicators(c: Component, _indicators: *mut f64, _n: usize) -> Status = export3::not_offered(c, "fmi3GetEventIndicators");
                fmi3GetContinuousStates(c: Component, _states: *mut f64, _n: usize) -> Status = export3::not_offered(c, "fmi3GetContinuousStates");
                fmi3GetNominalsOfContinuousStates(c: Component, _nominals: *mut f64, _n: usize) -> Status = export3::not_offered(c, "fmi3GetNominalsOfContinuousStates");
                fmi3GetNumberOfEventIndicators(c: Component, _n: *mut usize) -> Status = export3::not_offered(c, "fmi3GetNumberOfEventIndicators");
                fmi3GetNumberOfContinuousStates(c: Component, _n: *mut usize) -> Status = export3::not_offered(c, "fmi3GetNumberOfContinuousStates");
                fmi3ActivateModelPartition(c: Component, _clock: ValueReference, _time: f64) -> Status = export3::not_offered(c, "fmi3ActivateModelPartition");
            }
        }
    };
}
