//! The C types of FMI 2.0 (fmi2TypesPlatform.h, fmi2FunctionTypes.h), and what FMI 3.0 has otherwise (fmi3PlatformTypes.h,
//! fmi3FunctionTypes.h).

use std::ffi::{c_char, c_int, c_void};

/// The version of the standard that a master speaks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Fmi {
    /// FMI 2.0.
    #[default]
    Two,
    /// FMI 3.0.
    Three,
}

impl Fmi {
    /// What its functions begin with.
    pub const fn prefix(self) -> &'static str {
        match self {
            Self::Two => "fmi2",
            Self::Three => "fmi3",
        }
    }
}

/// An instance, seen from the master.
pub type Component = *mut c_void;
/// What the master gets back in its callbacks.
pub type ComponentEnvironment = *mut c_void;
/// A saved state, seen from the master.
pub type FmuState = *mut c_void;
/// A text: UTF-8, ended by a zero.
pub type Text = *const c_char;
/// Handle of a variable.
pub type ValueReference = u32;
/// 0 or 1.
pub type Boolean = c_int;
/// A byte of a serialised state.
pub type Byte = c_char;

/// fmi2True.
pub const TRUE: Boolean = 1;
/// fmi2False.
pub const FALSE: Boolean = 0;

/// fmi2Status.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Status {
    /// Done.
    Ok,
    /// Done, but look at the message.
    Warning,
    /// Not done; the master may try something else.
    Discard,
    /// Not done; only reset, a saved state or the end help.
    Error,
    /// Nothing helps.
    Fatal,
    /// Still at it.
    Pending,
}

/// fmi2Type.
pub const CO_SIMULATION: c_int = 1;

/// fmi2CallbackLogger. C-variadic; instances of this library pass no further arguments.
pub type Logger = Option<unsafe extern "C" fn(ComponentEnvironment, Text, c_int, Text, Text, ...)>;

/// fmi2CallbackFunctions.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct CallbackFunctions {
    /// Receives messages.
    pub logger: Logger,
    /// Not used by instances of this library.
    pub allocate_memory: Option<unsafe extern "C" fn(usize, usize) -> *mut c_void>,
    /// Not used by instances of this library.
    pub free_memory: Option<unsafe extern "C" fn(*mut c_void)>,
    /// Not used: steps are never asynchronous.
    pub step_finished: Option<unsafe extern "C" fn(ComponentEnvironment, c_int)>,
    /// Handed back in every callback.
    pub component_environment: ComponentEnvironment,
}

/// fmi3Boolean: a byte of 0 or 1; what a master passes is not trusted to be one.
pub type Boolean3 = u8;

/// fmi3LogMessageCallback.
pub type LogMessage = Option<unsafe extern "C" fn(*mut c_void, c_int, Text, Text)>;

/// fmi3IntermediateUpdateCallback, which is never called.
pub type IntermediateUpdate = Option<unsafe extern "C" fn()>;
