//! One instance of an FMU's binary: every call into foreign code, with its status checked.

use super::library::{Bytes, Library, States};
use super::log::{Environment, Log, Message, Names, logger, text};
use crate::fmi::c::{Boolean, CO_SIMULATION, CallbackFunctions, Component, FALSE, FmuState, Status, TRUE};
use crate::{Error, Result};
use std::ffi::{CString, c_int};
use std::fmt::Display;
use std::mem::ManuallyDrop;
use std::ptr;
use std::rc::Rc;
use std::sync::{Arc, Mutex, PoisonError};

/// fmi2StatusKind: until when a discarded step got.
const LAST_SUCCESSFUL_TIME: c_int = 2;
/// fmi2StatusKind: whether the FMU wants the simulation to end.
const TERMINATED: c_int = 3;

/// A call that did not end well.
pub(super) struct Failure {
    pub(super) status: Status,
    pub(super) error: Error,
}

impl From<Failure> for Error {
    fn from(failure: Failure) -> Self {
        failure.error
    }
}

type Outcome = std::result::Result<(), Failure>;

/// What can still be called.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Health {
    /// All.
    Well,
    /// After fmi2Error or a discarded step: reading, restoring, resetting, the end.
    Failed,
    /// After fmi2Fatal: nothing, not even the end.
    Dead,
}

/// An instance with all that has to live as long.
pub(super) struct Instance {
    component: Component,
    name: String,
    health: Health,
    /// Saved states by slot; null where a slot has none yet.
    states: Vec<FmuState>,
    unused: Arc<Mutex<Vec<usize>>>,
    /// A state was turned into bytes, which may come back at any time.
    serialized: bool,
    /// Leaked when the instance is dead: its code may still run in some thread.
    foundation: ManuallyDrop<Foundation>,
}

/// What an instance stands on; dropped in this order.
struct Foundation {
    library: Library,
    /// Kept although valid only during fmi2Instantiate: many FMUs hold on to the pointer.
    _callbacks: Rc<CallbackFunctions>,
    log: Arc<Log>,
    environment: Environment,
}

/// A place for one saved state. The state itself belongs to the instance, so that whoever holds the
/// slot may outlive it or sit in another thread; dropping the slot lets the instance use it again.
pub(super) struct Slot {
    index: usize,
    unused: Arc<Mutex<Vec<usize>>>,
}

impl Drop for Slot {
    fn drop(&mut self) {
        self.unused.lock().unwrap_or_else(PoisonError::into_inner).push(self.index);
    }
}

impl Instance {
    /// Instantiates for co-simulation; `resources` is a URI, `names` are those of the variables.
    pub(super) fn new(
        library: Library,
        name: &str,
        guid: &str,
        resources: &str,
        names: Names,
    ) -> Result<Self> {
        let c_text = |what: &str, text: &str| {
            CString::new(text).map_err(|_| Error::fmu(format!("the {what} holds a NUL character")))
        };
        let (c_name, c_guid) = (c_text("model's name", name)?, c_text("guid", guid)?);
        let c_resources = c_text("resource location", resources)?;
        let log = Arc::new(Log::new(names));
        let environment = Environment::new(log.clone());
        let callbacks = Rc::new(CallbackFunctions {
            logger: logger(),
            allocate_memory: Some(libc::calloc),
            free_memory: Some(libc::free),
            step_finished: None,
            component_environment: environment.pointer(),
        });
        let calling = environment.calling();
        // SAFETY: the texts end with a zero; the callbacks and the log live in the foundation until
        // the instance is freed and the library closed, or for ever.
        let component = unsafe {
            (library.instantiate)(
                c_name.as_ptr(),
                CO_SIMULATION,
                c_guid.as_ptr(),
                c_resources.as_ptr(),
                Rc::as_ptr(&callbacks),
                FALSE,
                TRUE,
            )
        };
        drop(calling);
        if component.is_null() {
            return Err(Error::fmu(format!(
                "{name}: fmi2Instantiate returned no instance: {}",
                reason(&log)
            )));
        }
        Ok(Self {
            component,
            name: name.into(),
            health: Health::Well,
            states: Vec::new(),
            unused: Arc::default(),
            serialized: false,
            foundation: ManuallyDrop::new(Foundation { library, _callbacks: callbacks, log, environment }),
        })
    }

    pub(super) fn health(&self) -> Health {
        self.health
    }

    /// The messages since the last time.
    pub(super) fn messages(&self) -> Vec<Message> {
        self.foundation.log.drain()
    }

    /// Where the messages go.
    pub(super) fn log(&self) -> Arc<Log> {
        self.foundation.log.clone()
    }

    /// Calls `function`, unless the instance is dead, and judges its status.
    fn call(&mut self, what: impl Display, function: impl FnOnce(&Library, Component) -> c_int) -> Outcome {
        if self.health == Health::Dead {
            return Err(Failure {
                status: Status::Fatal,
                error: Error::fmu(format!(
                    "{}: {what} is not possible after fmi2Fatal; load the FMU again",
                    self.name
                )),
            });
        }
        self.foundation.log.begin_call();
        let calling = self.foundation.environment.calling();
        let status = function(&self.foundation.library, self.component);
        drop(calling);
        let (status, word) = match status {
            0 | 1 => return Ok(()),
            2 => (Status::Discard, "fmi2Discard".to_owned()),
            3 => (Status::Error, "fmi2Error".to_owned()),
            4 => (Status::Fatal, "fmi2Fatal".to_owned()),
            5 => {
                (Status::Pending, "fmi2Pending, though nobody asked for steps in the background,".to_owned())
            }
            other => (Status::Error, format!("the unknown status {other}")),
        };
        match status {
            // An instance that is still busy must not be freed either.
            Status::Fatal | Status::Pending => self.health = Health::Dead,
            Status::Error => self.health = Health::Failed,
            _ => {}
        }
        let reason = reason(&self.foundation.log);
        // many FMUs begin their message with the function, which stands here already
        let reason = match reason.split_once(": ") {
            Some((function, rest)) if what.to_string().contains(function) => rest,
            _ => &reason,
        };
        let error = Error::fmu(format!("{}: {what} returned {word}: {reason}", self.name));
        Err(Failure { status, error })
    }

    pub(super) fn get_real(&mut self, variable: &str, reference: u32) -> Result<f64> {
        let mut value = 0.0;
        self.call(format_args!("reading {variable}"), |f, c| {
            // SAFETY: a living instance; one reference and room for one value.
            unsafe { (f.get_real)(c, &reference, 1, &mut value) }
        })?;
        Ok(value)
    }

    /// Values of several real variables.
    pub(super) fn get_reals(&mut self, references: &[u32], values: &mut [f64]) -> Result<()> {
        let n = references.len().min(values.len());
        Ok(self.call("reading several variables", |f, c| {
            // SAFETY: a living instance; n references and room for n values.
            unsafe { (f.get_real)(c, references.as_ptr(), n, values.as_mut_ptr()) }
        })?)
    }

    /// Sets several real variables and, where the library has that function, their derivatives.
    pub(super) fn set_reals(
        &mut self,
        references: &[u32],
        values: &[f64],
        rates: Option<&[f64]>,
    ) -> Result<()> {
        let n = references.len().min(values.len());
        self.call("setting several variables", |f, c| {
            // SAFETY: a living instance; n references and n values.
            unsafe { (f.set_real)(c, references.as_ptr(), n, values.as_ptr()) }
        })?;
        let (Some(rates), Some(set)) = (rates, self.foundation.library.set_derivatives) else {
            return Ok(());
        };
        let n = n.min(rates.len());
        let orders = vec![1; n];
        Ok(self.call("setting several derivatives", |_, c| {
            // SAFETY: a living instance; n references, n orders, n values.
            unsafe { set(c, references.as_ptr(), n, orders.as_ptr(), rates.as_ptr()) }
        })?)
    }

    pub(super) fn get_integer(&mut self, variable: &str, reference: u32) -> Result<i32> {
        let mut value = 0;
        self.call(format_args!("reading {variable}"), |f, c| {
            // SAFETY: a living instance; one reference and room for one value.
            unsafe { (f.get_integer)(c, &reference, 1, &mut value) }
        })?;
        Ok(value)
    }

    pub(super) fn get_boolean(&mut self, variable: &str, reference: u32) -> Result<bool> {
        let mut value = FALSE;
        self.call(format_args!("reading {variable}"), |f, c| {
            // SAFETY: a living instance; one reference and room for one value.
            unsafe { (f.get_boolean)(c, &reference, 1, &mut value) }
        })?;
        Ok(value != FALSE)
    }

    pub(super) fn get_text(&mut self, variable: &str, reference: u32) -> Result<String> {
        let mut value = ptr::null();
        self.call(format_args!("reading {variable}"), |f, c| {
            // SAFETY: a living instance; one reference and room for one value.
            unsafe { (f.get_string)(c, &reference, 1, &mut value) }
        })?;
        // SAFETY: null or a text that the FMU keeps at least until the next call.
        Ok(unsafe { text(value) })
    }

    pub(super) fn set_real(&mut self, variable: &str, reference: u32, value: f64) -> Result<()> {
        Ok(self.call(format_args!("setting {variable} = {value:?}"), |f, c| {
            // SAFETY: a living instance; one reference and one value.
            unsafe { (f.set_real)(c, &reference, 1, &value) }
        })?)
    }

    pub(super) fn set_integer(&mut self, variable: &str, reference: u32, value: i32) -> Result<()> {
        Ok(self.call(format_args!("setting {variable} = {value}"), |f, c| {
            // SAFETY: a living instance; one reference and one value.
            unsafe { (f.set_integer)(c, &reference, 1, &value) }
        })?)
    }

    pub(super) fn set_boolean(&mut self, variable: &str, reference: u32, value: bool) -> Result<()> {
        let value = c_int::from(value);
        Ok(self.call(format_args!("setting {variable} = {value}"), |f, c| {
            // SAFETY: a living instance; one reference and one value.
            unsafe { (f.set_boolean)(c, &reference, 1, &value) }
        })?)
    }

    pub(super) fn set_text(&mut self, variable: &str, reference: u32, value: &str) -> Result<()> {
        let c_value = CString::new(value)
            .map_err(|_| Error::variable(format!("{variable}: the text holds a NUL character")))?;
        Ok(self.call(format_args!("setting {variable} = {value:?}"), |f, c| {
            // SAFETY: a living instance; one reference and one text, which the FMU has to copy.
            unsafe { (f.set_string)(c, &reference, 1, &c_value.as_ptr()) }
        })?)
    }

    /// Fails with `None` where the library has no such function.
    pub(super) fn set_rate(&mut self, variable: &str, reference: u32, rate: f64) -> Option<Result<()>> {
        let set = self.foundation.library.set_derivatives?;
        let outcome = self.call(format_args!("setting the derivative of {variable} = {rate:?}"), |_, c| {
            // SAFETY: a living instance; one reference, one order, one value.
            unsafe { set(c, &reference, 1, &1, &rate) }
        });
        Some(outcome.map_err(Error::from))
    }

    /// The first derivative of an output; `None` where the library has no such function.
    pub(super) fn get_rate(&mut self, variable: &str, reference: u32) -> Option<Result<f64>> {
        let get = self.foundation.library.get_derivatives?;
        let mut rate = 0.0;
        let outcome = self.call(format_args!("reading the derivative of {variable}"), |_, c| {
            // SAFETY: a living instance; one reference, one order, room for one value.
            unsafe { get(c, &reference, 1, &1, &mut rate) }
        });
        Some(outcome.map(|()| rate).map_err(Error::from))
    }

    pub(super) fn setup(&mut self, start: f64, stop: Option<f64>) -> Result<()> {
        Ok(self.call("fmi2SetupExperiment", |f, c| {
            let (has_stop, stop) = (c_int::from(stop.is_some()), stop.unwrap_or(0.0));
            // SAFETY: a living instance.
            unsafe { (f.setup_experiment)(c, FALSE, 0.0, start, has_stop, stop) }
        })?)
    }

    pub(super) fn enter_initialization(&mut self) -> Result<()> {
        // SAFETY: a living instance.
        Ok(self.call("fmi2EnterInitializationMode", |f, c| unsafe { (f.enter_initialization)(c) })?)
    }

    pub(super) fn exit_initialization(&mut self) -> Result<()> {
        // SAFETY: a living instance.
        Ok(self.call("fmi2ExitInitializationMode", |f, c| unsafe { (f.exit_initialization)(c) })?)
    }

    pub(super) fn terminate(&mut self) -> Result<()> {
        // SAFETY: a living instance.
        Ok(self.call("fmi2Terminate", |f, c| unsafe { (f.terminate)(c) })?)
    }

    pub(super) fn reset(&mut self) -> Result<()> {
        // SAFETY: a living instance.
        self.call("fmi2Reset", |f, c| unsafe { (f.reset)(c) })?;
        self.health = Health::Well;
        Ok(())
    }

    /// True if somebody may still go back: he holds a saved state, or had one turned into bytes.
    pub(super) fn may_go_back(&self) -> bool {
        // Each slot that is held holds the list of unused slots.
        self.serialized || Arc::strong_count(&self.unused) > 1
    }

    /// Steps; a discarded step says how far it got. `final_past`: no earlier state will come back.
    pub(super) fn step(&mut self, time: f64, length: f64, final_past: bool) -> Result<()> {
        let outcome = self.call(format_args!("the step from {time} s by {length} s"), |f, c| {
            // SAFETY: a living instance.
            unsafe { (f.do_step)(c, time, length, Boolean::from(final_past)) }
        });
        let Err(failure) = outcome else { return Ok(()) };
        if failure.status != Status::Discard {
            return Err(failure.error);
        }
        self.health = Health::Failed;
        let mut error = failure.error.to_string();
        if let Some(time) = self.last_successful_time() {
            error += &format!("; it got to t = {time} s");
        }
        if self.wants_to_end() {
            error += "; the FMU wants the simulation to end here";
        }
        Err(Error::fmu(error))
    }

    /// See [`ImportedFmu::bare_steps`](super::ImportedFmu::bare_steps).
    #[cfg(feature = "host")]
    pub(super) fn bare_steps(&mut self, time: f64, length: f64, count: usize) -> Result<()> {
        Ok(self.call("a row of steps", |f, c| {
            let step = |k: usize| {
                // SAFETY: a living instance.
                unsafe { (f.do_step)(c, time + k as f64 * length, length, TRUE) }
            };
            let is_done = |status: &c_int| [Status::Ok as c_int, Status::Warning as c_int].contains(status);
            (0..count).map(step).find(|status| !is_done(status)).unwrap_or(Status::Ok as c_int)
        })?)
    }

    fn last_successful_time(&mut self) -> Option<f64> {
        let status = self.foundation.library.get_real_status?;
        let mut time = f64::NAN;
        self.call("fmi2GetRealStatus", |_, c| {
            // SAFETY: a living instance, and room for one value.
            unsafe { status(c, LAST_SUCCESSFUL_TIME, &mut time) }
        })
        .ok()?;
        time.is_finite().then_some(time)
    }

    fn wants_to_end(&mut self) -> bool {
        let Some(status) = self.foundation.library.get_boolean_status else { return false };
        let mut terminated = FALSE;
        let outcome = self.call("fmi2GetBooleanStatus", |_, c| {
            // SAFETY: a living instance, and room for one value.
            unsafe { status(c, TERMINATED, &mut terminated) }
        });
        outcome.is_ok() && terminated != FALSE
    }

    fn states(&self) -> Result<States> {
        self.foundation.library.states.ok_or_else(|| {
            Error::call(format!(
                "{}: the FMU cannot save its state (canGetAndSetFMUstate is not true)",
                self.name
            ))
        })
    }

    fn bytes(&self) -> Result<Bytes> {
        self.foundation.library.bytes.ok_or_else(|| {
            Error::call(format!(
                "{}: the FMU cannot turn its state into bytes (canSerializeFMUstate is not true)",
                self.name
            ))
        })
    }

    /// The saved state in a slot of this instance.
    fn state_in(&self, slot: &Slot) -> Result<FmuState> {
        match self.states.get(slot.index) {
            Some(&state) if self.owns(slot) && !state.is_null() => Ok(state),
            _ => Err(Error::call(format!("{}: the saved state belongs to another slave", self.name))),
        }
    }

    /// True for a slot of this instance.
    pub(super) fn owns(&self, slot: &Slot) -> bool {
        Arc::ptr_eq(&self.unused, &slot.unused)
    }

    /// A slot that nobody uses, perhaps with an old state that may be overwritten.
    fn slot(&mut self) -> Slot {
        let unused = self.unused.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let index = unused.unwrap_or_else(|| {
            self.states.push(ptr::null_mut());
            self.states.len() - 1
        });
        Slot { index, unused: self.unused.clone() }
    }

    /// Saves the state in a new slot.
    pub(super) fn save(&mut self) -> Result<Slot> {
        self.states()?;
        let slot = self.slot();
        self.save_into(&slot)?;
        Ok(slot)
    }

    /// Saves the state in a slot of this instance, over what was there.
    pub(super) fn save_into(&mut self, slot: &Slot) -> Result<()> {
        let states = self.states()?;
        let mut state = self.states[slot.index];
        let outcome = self.call("fmi2GetFMUstate", |_, c| {
            // SAFETY: a living instance; null or a state that it gave and that was not freed.
            unsafe { (states.get)(c, &mut state) }
        });
        self.states[slot.index] = state;
        Ok(outcome?)
    }

    /// Goes back to the state in a slot.
    pub(super) fn restore(&mut self, slot: &Slot) -> Result<()> {
        let states = self.states()?;
        let state = self.state_in(slot)?;
        self.call("fmi2SetFMUstate", |_, c| {
            // SAFETY: a living instance and a state that it gave and that was not freed.
            unsafe { (states.set)(c, state) }
        })?;
        self.health = Health::Well;
        Ok(())
    }

    /// The state in a slot as bytes.
    pub(super) fn serialize(&mut self, slot: &Slot) -> Result<Vec<u8>> {
        let bytes = self.bytes()?;
        let state = self.state_in(slot)?;
        let mut size = 0;
        self.call("fmi2SerializedFMUstateSize", |_, c| {
            // SAFETY: a living instance, a state of it, and room for one number.
            unsafe { (bytes.size)(c, state, &mut size) }
        })?;
        let mut buffer = Vec::new();
        buffer.try_reserve_exact(size).map_err(|_| {
            Error::fmu(format!("{}: there is no memory for a saved state of {size} bytes", self.name))
        })?;
        buffer.resize(size, 0u8);
        self.call("fmi2SerializeFMUstate", |_, c| {
            // SAFETY: a living instance, a state of it, and room for `size` bytes.
            unsafe { (bytes.write)(c, state, buffer.as_mut_ptr().cast(), size) }
        })?;
        self.serialized = true;
        Ok(buffer)
    }

    /// The state in `buffer`, in a new slot.
    pub(super) fn deserialize(&mut self, buffer: &[u8]) -> Result<Slot> {
        let bytes = self.bytes()?;
        let slot = self.slot();
        // The FMU allocates here: an old state would be lost.
        self.free(slot.index);
        let mut state = ptr::null_mut();
        let outcome = self.call("fmi2DeSerializeFMUstate", |_, c| {
            // SAFETY: a living instance; the bytes are those that the same FMU wrote.
            unsafe { (bytes.read)(c, buffer.as_ptr().cast(), buffer.len(), &mut state) }
        });
        self.states[slot.index] = state;
        outcome?;
        Ok(slot)
    }

    /// Frees the state with this index, if there is one.
    fn free(&mut self, index: usize) {
        let mut state = std::mem::replace(&mut self.states[index], ptr::null_mut());
        if let (false, Ok(states)) = (state.is_null(), self.states()) {
            // What fails here leaks; there is nobody left to tell.
            let _ = self.call("fmi2FreeFMUstate", |_, c| {
                // SAFETY: a living instance and a state that it gave and that was not freed.
                unsafe { (states.free)(c, &mut state) }
            });
        }
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        for index in 0..self.states.len() {
            self.free(index);
        }
        if self.health == Health::Dead {
            return;
        }
        let calling = self.foundation.environment.calling();
        // SAFETY: a living instance, used here for the last time; then nothing of the library runs
        // any more and the foundation, which is dropped only here, can go.
        unsafe {
            (self.foundation.library.free_instance)(self.component);
            drop(calling);
            ManuallyDrop::drop(&mut self.foundation);
        }
    }
}

/// Why a call failed, in the FMU's words.
fn reason(log: &Log) -> String {
    log.reason().unwrap_or_else(|| "the FMU gave no reason".into())
}
