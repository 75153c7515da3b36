//! A binary and its instances, called without protection: whatever FMI allows or forbids. Every call is
//! noted before it is made and looked at after it.

use crate::fmi::c::{
    Boolean, Byte, CO_SIMULATION, CallbackFunctions, Component, ComponentEnvironment, FALSE, FmuState, TRUE,
    Text, ValueReference,
};
use crate::fmi::check::system::CallNote;
use crate::fmi::check::{float_mode, memory};
use crate::fmi::import::library::Handle;
use crate::fmi::import::log::{self, Environment, Heard, text};
use std::ffi::{CString, c_int, c_void};
use std::ptr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// fmi2Error.
pub(super) const ERROR: c_int = 3;
/// fmi2Fatal.
const FATAL: c_int = 4;

type Get<T> = unsafe extern "C" fn(Component, *const ValueReference, usize, *mut T) -> c_int;
type Set<T> = unsafe extern "C" fn(Component, *const ValueReference, usize, *const T) -> c_int;
type Simple = unsafe extern "C" fn(Component) -> c_int;
type Status<T> = unsafe extern "C" fn(Component, c_int, *mut T) -> c_int;
type Partial = unsafe extern "C" fn(
    Component,
    *const ValueReference,
    usize,
    *const ValueReference,
    usize,
    *const f64,
    *mut f64,
) -> c_int;

macro_rules! functions {
    ($($field:ident $name:literal $type:ty;)*) => {
        /// The functions of a binary; `None` for those that it does not export.
        #[derive(Clone, Copy)]
        pub(super) struct Functions {
            $(pub(super) $field: Option<$type>,)*
        }

        impl Functions {
            /// Looks them up.
            ///
            /// # Safety
            /// The library follows FMI 2.0: its functions have the types that belong to their names. The
            /// handle outlives all calls.
            pub(super) unsafe fn find(handle: &Handle) -> Self {
                // SAFETY: demanded of the caller.
                unsafe { Self { $($field: handle.function($name),)* } }
            }

            /// The names of those that are not there.
            pub(super) fn missing(&self) -> Vec<String> {
                let mut names = Vec::new();
                $(if self.$field.is_none() {
                    names.push($name.to_string_lossy().into_owned());
                })*
                names
            }
        }
    };
}

functions! {
    types_platform c"fmi2GetTypesPlatform" unsafe extern "C" fn() -> Text;
    version c"fmi2GetVersion" unsafe extern "C" fn() -> Text;
    set_debug_logging c"fmi2SetDebugLogging" unsafe extern "C" fn(Component, Boolean, usize, *const Text) -> c_int;
    instantiate c"fmi2Instantiate" unsafe extern "C" fn(Text, c_int, Text, Text, *const CallbackFunctions, Boolean, Boolean) -> Component;
    free_instance c"fmi2FreeInstance" unsafe extern "C" fn(Component);
    setup c"fmi2SetupExperiment" unsafe extern "C" fn(Component, Boolean, f64, f64, Boolean, f64) -> c_int;
    enter c"fmi2EnterInitializationMode" Simple;
    exit c"fmi2ExitInitializationMode" Simple;
    terminate c"fmi2Terminate" Simple;
    reset c"fmi2Reset" Simple;
    get_real c"fmi2GetReal" Get<f64>;
    get_integer c"fmi2GetInteger" Get<c_int>;
    get_boolean c"fmi2GetBoolean" Get<Boolean>;
    get_string c"fmi2GetString" Get<Text>;
    set_real c"fmi2SetReal" Set<f64>;
    set_integer c"fmi2SetInteger" Set<c_int>;
    set_boolean c"fmi2SetBoolean" Set<Boolean>;
    set_string c"fmi2SetString" Set<Text>;
    get_state c"fmi2GetFMUstate" unsafe extern "C" fn(Component, *mut FmuState) -> c_int;
    set_state c"fmi2SetFMUstate" unsafe extern "C" fn(Component, FmuState) -> c_int;
    free_state c"fmi2FreeFMUstate" unsafe extern "C" fn(Component, *mut FmuState) -> c_int;
    state_size c"fmi2SerializedFMUstateSize" unsafe extern "C" fn(Component, FmuState, *mut usize) -> c_int;
    serialize c"fmi2SerializeFMUstate" unsafe extern "C" fn(Component, FmuState, *mut Byte, usize) -> c_int;
    deserialize c"fmi2DeSerializeFMUstate" unsafe extern "C" fn(Component, *const Byte, usize, *mut FmuState) -> c_int;
    directional c"fmi2GetDirectionalDerivative" Partial;
    set_rates c"fmi2SetRealInputDerivatives" unsafe extern "C" fn(Component, *const ValueReference, usize, *const c_int, *const f64) -> c_int;
    get_rates c"fmi2GetRealOutputDerivatives" unsafe extern "C" fn(Component, *const ValueReference, usize, *const c_int, *mut f64) -> c_int;
    step c"fmi2DoStep" unsafe extern "C" fn(Component, f64, f64, Boolean) -> c_int;
    cancel c"fmi2CancelStep" Simple;
    status c"fmi2GetStatus" Status<c_int>;
    real_status c"fmi2GetRealStatus" Status<f64>;
    integer_status c"fmi2GetIntegerStatus" Status<c_int>;
    boolean_status c"fmi2GetBooleanStatus" Status<Boolean>;
    string_status c"fmi2GetStringStatus" Status<Text>;
}

/// The environment of an instance's callbacks.
#[derive(Default)]
pub(super) struct Listener {
    messages: Mutex<Vec<Heard>>,
}

/// Messages beyond these are dropped: a leak check must not measure them.
const MESSAGES: usize = 1000;

impl Listener {
    fn take(&self) -> Vec<Heard> {
        std::mem::take(&mut *self.messages.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl log::Listener for Listener {
    fn hear(&self, message: Heard) {
        if !message.known {
            STRANGE.store(true, Ordering::Relaxed);
        }
        let mut messages = self.messages.lock().unwrap_or_else(PoisonError::into_inner);
        if messages.len() < MESSAGES {
            messages.push(message);
        }
    }
}

/// True once a callback was called through the struct after fmi2Instantiate.
pub(super) static STALE: AtomicBool = AtomicBool::new(false);
/// True once the logger was called with another environment.
pub(super) static STRANGE: AtomicBool = AtomicBool::new(false);

/// # Safety
/// The texts are null or end with a zero.
unsafe extern "C" fn stale_listen(e: ComponentEnvironment, n: Text, s: c_int, c: Text, f: Text) {
    STALE.store(true, Ordering::Relaxed);
    // SAFETY: demanded of the caller.
    unsafe { log::without_arguments(e, n, s, c, f) }
}

unsafe extern "C" fn stale_calloc(count: usize, size: usize) -> *mut c_void {
    STALE.store(true, Ordering::Relaxed);
    // SAFETY: as `libc::calloc`, which takes any numbers.
    unsafe { memory::calloc(count, size) }
}

/// # Safety
/// As `free`.
unsafe extern "C" fn stale_free(memory: *mut c_void) {
    STALE.store(true, Ordering::Relaxed);
    // SAFETY: demanded of the caller.
    unsafe { memory::free(memory) }
}

/// What came of a call, for those who judge calls.
pub(super) struct Outcome<'a> {
    pub(super) call: &'a str,
    pub(super) status: c_int,
    pub(super) messages: &'a [Heard],
    /// The name that the instance was given; `None` for none that it could use.
    pub(super) name: Option<&'a str>,
    /// False if the call left the floating-point mode changed.
    pub(super) same_float_mode: bool,
}

/// Judges every call of a unit.
pub(super) type Judge<'a> = &'a (dyn Fn(&Outcome<'_>) + Sync);

/// What an instance is made of.
#[derive(Clone, Copy)]
pub(super) struct Maker<'a> {
    pub(super) functions: Functions,
    pub(super) note: &'a CallNote,
    pub(super) judge: Judge<'a>,
}

/// An instance of the binary.
pub(super) struct Unit<'a> {
    maker: Maker<'a>,
    component: Component,
    listener: Arc<Listener>,
    /// `None` for no instance.
    environment: Option<Environment>,
    /// As passed; `None` for a blank one.
    name: Option<String>,
    /// A state was saved, so that steps are not final.
    saved: bool,
    /// Spoilt, but there: reading them late is no crash of ours.
    texts: [Vec<u8>; 3],
    /// The same; null for no instance.
    callbacks: *mut CallbackFunctions,
    /// The last message that came with fmi2OK.
    chatter: Option<String>,
    /// After fmi2Fatal nothing may be called, not even fmi2FreeInstance.
    dead: bool,
}

impl<'a> Maker<'a> {
    /// Instantiates for co-simulation. All that is passed is spoilt afterwards: it is only valid during
    /// the call. Returns the messages where there is no instance.
    pub(super) fn make(self, name: &str, guid: &str, resources: &str) -> Result<Unit<'a>, Vec<Heard>> {
        self.make_with(name, guid, Some(resources), true)
    }

    /// As [`make`](Self::make), also without a resource location and without functions for memory.
    pub(super) fn make_with(
        self,
        name: &str,
        guid: &str,
        resources: Option<&str>,
        memory: bool,
    ) -> Result<Unit<'a>, Vec<Heard>> {
        let listener: Arc<Listener> = Arc::default();
        let environment = Environment::new(listener.clone());
        let mut texts = [name, guid, resources.unwrap_or_default()]
            .map(|t| CString::new(t.replace('\0', "?")).unwrap_or_default().into_bytes_with_nul());
        let callbacks = Box::into_raw(Box::new(CallbackFunctions {
            logger: log::logger(),
            allocate_memory: memory.then_some(memory::calloc),
            free_memory: memory.then_some(memory::free),
            step_finished: None,
            component_environment: environment.pointer(),
        }));
        let Some(instantiate) = self.functions.instantiate else { return Err(Vec::new()) };
        self.note.write("fmi2Instantiate");
        let mode = float_mode::now();
        let calling = environment.calling();
        let [c_name, c_guid, c_resources] = texts.each_ref().map(|t| t.as_ptr().cast());
        let c_resources = if resources.is_some() { c_resources } else { ptr::null() };
        // SAFETY: the texts end with a zero, the callbacks are never freed.
        let component =
            unsafe { instantiate(c_name, CO_SIMULATION, c_guid, c_resources, callbacks, FALSE, TRUE) };
        drop(calling);
        let same_float_mode = float_mode::now() == mode;
        float_mode::restore(mode);
        for text in &mut texts {
            let end = text.len() - 1;
            text[..end].fill(b'~');
        }
        // SAFETY: the struct is ours until the unit is dropped.
        unsafe {
            (*callbacks).logger = log::variadic(stale_listen);
            (*callbacks).allocate_memory = memory.then_some(stale_calloc);
            (*callbacks).free_memory = memory.then_some(stale_free);
        }
        let messages = listener.take();
        let given = Some(name).filter(|n| !n.trim().is_empty());
        let call = "fmi2Instantiate";
        (self.judge)(&Outcome { call, status: 0, messages: &messages, name: given, same_float_mode });
        let mut unit = self.nothing();
        (unit.component, unit.callbacks, unit.texts) = (component, callbacks, texts);
        unit.name = given.map(Into::into);
        (unit.listener, unit.environment) = (listener, Some(environment));
        // What is not there is not freed, but what was passed is.
        if component.is_null() { Err(messages) } else { Ok(unit) }
    }

    /// An instance that is NULL, to see what calls make of it.
    pub(super) fn nothing(self) -> Unit<'a> {
        Unit {
            maker: self,
            component: ptr::null_mut(),
            listener: Arc::default(),
            environment: None,
            name: None,
            saved: false,
            texts: [const { Vec::new() }; 3],
            callbacks: ptr::null_mut(),
            chatter: None,
            dead: false,
        }
    }
}

impl Unit<'_> {
    /// Calls `function`; fmi2Error if it is missing, which is found elsewhere.
    fn call<F>(&mut self, name: &str, function: Option<F>, run: impl FnOnce(F, Component) -> c_int) -> c_int {
        let Some(function) = function else { return ERROR };
        if self.dead {
            return FATAL;
        }
        self.maker.note.write(name);
        let mode = float_mode::now();
        let calling = self.environment.as_ref().map(Environment::calling);
        let status = run(function, self.component);
        drop(calling);
        let same_float_mode = float_mode::now() == mode;
        float_mode::restore(mode);
        let messages = self.listener.take();
        self.dead = status == FATAL;
        if let Some(message) = messages.iter().find(|m| m.status == 0) {
            self.chatter = Some(message.format.clone());
        }
        if !self.component.is_null() {
            let given = self.name.as_deref();
            (self.maker.judge)(&Outcome {
                call: name,
                status,
                messages: &messages,
                name: given,
                same_float_mode,
            });
        }
        status
    }

    /// A message that came with fmi2OK since the last time.
    pub(super) fn chatter(&mut self) -> Option<String> {
        self.chatter.take()
    }

    pub(super) fn set_debug_logging(&mut self, on: bool) -> c_int {
        let function = self.maker.functions.set_debug_logging;
        // SAFETY: an instance, and no categories, which stands for all.
        self.call("fmi2SetDebugLogging", function, |f, c| unsafe { f(c, c_int::from(on), 0, ptr::null()) })
    }

    pub(super) fn setup(&mut self, start: f64, stop: Option<f64>) -> c_int {
        let (has_stop, stop) = (c_int::from(stop.is_some()), stop.unwrap_or(0.0));
        let function = self.maker.functions.setup;
        // SAFETY: an instance and numbers.
        self.call("fmi2SetupExperiment", function, |f, c| unsafe { f(c, FALSE, 0.0, start, has_stop, stop) })
    }

    pub(super) fn enter(&mut self) -> c_int {
        // SAFETY: an instance.
        self.call("fmi2EnterInitializationMode", self.maker.functions.enter, |f, c| unsafe { f(c) })
    }

    pub(super) fn exit(&mut self) -> c_int {
        // SAFETY: an instance.
        self.call("fmi2ExitInitializationMode", self.maker.functions.exit, |f, c| unsafe { f(c) })
    }

    pub(super) fn terminate(&mut self) -> c_int {
        // SAFETY: an instance.
        self.call("fmi2Terminate", self.maker.functions.terminate, |f, c| unsafe { f(c) })
    }

    pub(super) fn reset(&mut self) -> c_int {
        // SAFETY: an instance.
        self.call("fmi2Reset", self.maker.functions.reset, |f, c| unsafe { f(c) })
    }

    /// Steps; the past is said to be final until a state is saved.
    pub(super) fn step(&mut self, time: f64, length: f64) -> c_int {
        self.step_as(time, length, !self.saved)
    }

    /// Steps with this value of noSetFMUStatePriorToCurrentPoint.
    pub(super) fn step_as(&mut self, time: f64, length: f64, final_past: bool) -> c_int {
        let flag = Boolean::from(final_past);
        // SAFETY: an instance and numbers.
        self.call("fmi2DoStep", self.maker.functions.step, |f, c| unsafe { f(c, time, length, flag) })
    }

    pub(super) fn get_real(&mut self, reference: u32) -> (c_int, f64) {
        let mut value = 0.0;
        let function = self.maker.functions.get_real;
        // SAFETY: an instance, one reference and room for one value.
        let status = self.call("fmi2GetReal", function, |f, c| unsafe { f(c, &reference, 1, &mut value) });
        (status, value)
    }

    pub(super) fn get_integer(&mut self, reference: u32) -> (c_int, i32) {
        let mut value = 0;
        let function = self.maker.functions.get_integer;
        // SAFETY: an instance, one reference and room for one value.
        let status = self.call("fmi2GetInteger", function, |f, c| unsafe { f(c, &reference, 1, &mut value) });
        (status, value)
    }

    pub(super) fn get_boolean(&mut self, reference: u32) -> (c_int, bool) {
        let mut value = FALSE;
        let function = self.maker.functions.get_boolean;
        // SAFETY: an instance, one reference and room for one value.
        let status = self.call("fmi2GetBoolean", function, |f, c| unsafe { f(c, &reference, 1, &mut value) });
        (status, value != FALSE)
    }

    pub(super) fn get_text(&mut self, reference: u32) -> (c_int, String) {
        let mut value = ptr::null();
        let function = self.maker.functions.get_string;
        // SAFETY: an instance, one reference and room for one value.
        let status = self.call("fmi2GetString", function, |f, c| unsafe { f(c, &reference, 1, &mut value) });
        // SAFETY: null or a text that lives until the next call.
        let value = if status <= 1 { unsafe { text(value) } } else { String::new() };
        (status, value)
    }

    pub(super) fn set_real(&mut self, reference: u32, value: f64) -> c_int {
        let function = self.maker.functions.set_real;
        // SAFETY: an instance, one reference and one value.
        self.call("fmi2SetReal", function, |f, c| unsafe { f(c, &reference, 1, &value) })
    }

    pub(super) fn set_integer(&mut self, reference: u32, value: i32) -> c_int {
        let function = self.maker.functions.set_integer;
        // SAFETY: an instance, one reference and one value.
        self.call("fmi2SetInteger", function, |f, c| unsafe { f(c, &reference, 1, &value) })
    }

    pub(super) fn set_boolean(&mut self, reference: u32, value: bool) -> c_int {
        let function = self.maker.functions.set_boolean;
        // SAFETY: an instance, one reference and one value.
        self.call("fmi2SetBoolean", function, |f, c| unsafe { f(c, &reference, 1, &c_int::from(value)) })
    }

    /// Sets a text and spoils it afterwards: the instance has to have copied it.
    pub(super) fn set_text(&mut self, reference: u32, value: &str) -> c_int {
        let function = self.maker.functions.set_string;
        let mut bytes = CString::new(value.replace('\0', "?")).unwrap_or_default().into_bytes_with_nul();
        let pointer: Text = bytes.as_ptr().cast();
        // SAFETY: an instance, one reference and one text, which ends with a zero.
        let status = self.call("fmi2SetString", function, |f, c| unsafe { f(c, &reference, 1, &pointer) });
        let end = bytes.len() - 1;
        bytes[..end].fill(b'~');
        // Leaked, so that reading it later is no crash of ours.
        std::mem::forget(bytes);
        status
    }

    pub(super) fn set_rate(&mut self, reference: u32, order: i32, value: f64) -> c_int {
        let function = self.maker.functions.set_rates;
        // SAFETY: an instance, one reference, one order and one value.
        self.call("fmi2SetRealInputDerivatives", function, |f, c| unsafe {
            f(c, &reference, 1, &order, &value)
        })
    }

    pub(super) fn get_rate(&mut self, reference: u32, order: i32) -> (c_int, f64) {
        let mut value = 0.0;
        let function = self.maker.functions.get_rates;
        let status = self.call("fmi2GetRealOutputDerivatives", function, |f, c| {
            // SAFETY: an instance, one reference, one order and room for one value.
            unsafe { f(c, &reference, 1, &order, &mut value) }
        });
        (status, value)
    }

    /// d unknown / d known.
    pub(super) fn directional(&mut self, unknown: u32, known: u32) -> (c_int, f64) {
        let mut value = 0.0;
        let function = self.maker.functions.directional;
        let status = self.call("fmi2GetDirectionalDerivative", function, |f, c| {
            // SAFETY: an instance, one reference each, one seed and room for one value.
            unsafe { f(c, &unknown, 1, &known, 1, &1.0, &mut value) }
        });
        (status, value)
    }

    /// Says that steps are not final from now on, as if a state were saved.
    pub(super) fn expect_rollback(&mut self) {
        self.saved = true;
    }

    /// Saves the state, over `state` if that is not null.
    pub(super) fn save(&mut self, state: &mut FmuState) -> c_int {
        self.saved = true;
        // SAFETY: an instance; null or a state that it gave.
        self.call("fmi2GetFMUstate", self.maker.functions.get_state, |f, c| unsafe { f(c, state) })
    }

    pub(super) fn restore(&mut self, state: FmuState) -> c_int {
        // SAFETY: an instance and a state that it gave.
        self.call("fmi2SetFMUstate", self.maker.functions.set_state, |f, c| unsafe { f(c, state) })
    }

    pub(super) fn free_state(&mut self, state: &mut FmuState) -> c_int {
        // SAFETY: an instance; null or a state that it gave and that was not freed.
        self.call("fmi2FreeFMUstate", self.maker.functions.free_state, |f, c| unsafe { f(c, state) })
    }

    /// A saved state as bytes.
    pub(super) fn serialize(&mut self, state: FmuState) -> Result<Vec<Byte>, c_int> {
        let mut size = 0;
        let function = self.maker.functions.state_size;
        let status = self.call("fmi2SerializedFMUstateSize", function, |f, c| {
            // SAFETY: an instance, a state that it gave and room for a number.
            unsafe { f(c, state, &mut size) }
        });
        if status > 1 || size > 1 << 30 {
            return Err(status);
        }
        let mut bytes = vec![0; size];
        let function = self.maker.functions.serialize;
        let status = self.call("fmi2SerializeFMUstate", function, |f, c| {
            // SAFETY: an instance, a state that it gave and as much room as it wants.
            unsafe { f(c, state, bytes.as_mut_ptr(), size) }
        });
        if status > 1 { Err(status) } else { Ok(bytes) }
    }

    pub(super) fn deserialize(&mut self, bytes: &[Byte], state: &mut FmuState) -> c_int {
        self.saved = true;
        let function = self.maker.functions.deserialize;
        self.call("fmi2DeSerializeFMUstate", function, |f, c| {
            // SAFETY: an instance, bytes with their number, and null to be replaced.
            unsafe { f(c, bytes.as_ptr(), bytes.len(), state) }
        })
    }

    /// fmi2LastSuccessfulTime, if the instance answers.
    pub(super) fn last_successful_time(&mut self) -> Option<f64> {
        let mut time = f64::NAN;
        let function = self.maker.functions.real_status;
        // SAFETY: an instance, and room for one value.
        let status = self.call("fmi2GetRealStatus", function, |f, c| unsafe { f(c, 2, &mut time) });
        (status <= 1).then_some(time)
    }

    /// Frees the instance, which dropping it does as well; of NULL this has to do nothing.
    pub(super) fn free(self) {
        drop(self);
    }
}

impl Drop for Unit<'_> {
    fn drop(&mut self) {
        if self.dead {
            // Its code may still run somewhere.
            std::mem::forget((std::mem::take(&mut self.texts), self.environment.take()));
            return;
        }
        // An instance that was refused is not freed; NULL from `nothing` is, to see what happens.
        if let Some(free) = self.maker.functions.free_instance
            && (!self.component.is_null() || self.callbacks.is_null())
        {
            self.maker.note.write("fmi2FreeInstance");
            let _calling = self.environment.as_ref().map(Environment::calling);
            // SAFETY: the instance is not used after this.
            unsafe { free(self.component) };
        }
        if !self.callbacks.is_null() {
            // SAFETY: made from a box, and freed once.
            drop(unsafe { Box::from_raw(self.callbacks) });
        }
    }
}

/// The version and the platform that the binary names, as far as it does.
pub(super) fn names(functions: &Functions, note: &CallNote) -> [Option<String>; 2] {
    [("fmi2GetVersion", functions.version), ("fmi2GetTypesPlatform", functions.types_platform)].map(
        |(name, function)| {
            note.write(name);
            // SAFETY: the functions return null or constant texts.
            function.map(|f| unsafe { text(f()) })
        },
    )
}
