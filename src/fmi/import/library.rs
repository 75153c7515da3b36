//! The binary of an FMU: loading it and finding its functions.

use super::description::Capabilities;
use super::log::text;
use crate::fmi::c::{Boolean, Byte, CallbackFunctions, Component, FmuState, Text, ValueReference};
use crate::{Error, Result};
#[cfg(unix)]
use libloading::os::unix as system;
#[cfg(windows)]
use libloading::os::windows as system;
use std::ffi::{CStr, c_int};
use std::fs;
use std::path::{Path, PathBuf};

/// The folders in `binaries/` that hold a binary for this machine, and its ending.
const PLATFORMS: &[&str] = if cfg!(all(target_os = "linux", target_arch = "x86_64")) {
    &["linux64", "x86_64-linux"]
} else if cfg!(all(target_os = "linux", target_arch = "x86")) {
    &["linux32", "x86-linux"]
} else if cfg!(all(target_os = "linux", target_arch = "aarch64")) {
    &["aarch64-linux"]
} else if cfg!(all(target_os = "macos", target_arch = "aarch64")) {
    &["aarch64-darwin"]
} else if cfg!(target_os = "macos") {
    &["darwin64", "x86_64-darwin"]
} else if cfg!(all(windows, target_arch = "x86_64")) {
    &["win64", "x86_64-windows"]
} else {
    &[]
};
const ENDING: &str = std::env::consts::DLL_EXTENSION;

type Get<T> = unsafe extern "C" fn(Component, *const ValueReference, usize, *mut T) -> c_int;
type Set<T> = unsafe extern "C" fn(Component, *const ValueReference, usize, *const T) -> c_int;
type Simple = unsafe extern "C" fn(Component) -> c_int;
type Instantiate =
    unsafe extern "C" fn(Text, c_int, Text, Text, *const CallbackFunctions, Boolean, Boolean) -> Component;
type SetDerivatives =
    unsafe extern "C" fn(Component, *const ValueReference, usize, *const c_int, *const f64) -> c_int;
type GetDerivatives =
    unsafe extern "C" fn(Component, *const ValueReference, usize, *const c_int, *mut f64) -> c_int;

/// Where a binary finds the functions that it names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::fmi) enum Names {
    /// In the process first, as usual.
    #[cfg(feature = "host")]
    Usual,
    /// In itself first. A binary in whose process another FMU was loaded for all to see would otherwise
    /// get that one's `fmi2DoStep` where it calls its own: the names are the same in all FMUs.
    OwnFirst,
}

impl Names {
    /// Loads a library for nobody else to see, and all that it needs at once.
    ///
    /// # Safety
    /// Its initialisers are foreign code.
    #[cfg(unix)]
    unsafe fn open(self, path: &Path) -> std::result::Result<system::Library, libloading::Error> {
        let flag = match self {
            #[cfg(feature = "host")]
            Self::Usual => 0,
            // elsewhere libraries look into themselves first (macOS), or cannot be told to
            #[cfg(all(target_os = "linux", target_env = "gnu"))]
            Self::OwnFirst => libc::RTLD_DEEPBIND,
            #[cfg(not(all(target_os = "linux", target_env = "gnu")))]
            Self::OwnFirst => 0,
        };
        // SAFETY: demanded of the caller.
        unsafe { system::Library::open(Some(path), libc::RTLD_NOW | libc::RTLD_LOCAL | flag) }
    }

    /// Loads a library, which finds the libraries beside it. Names are never shared on this system.
    ///
    /// # Safety
    /// Its initialisers are foreign code.
    #[cfg(windows)]
    unsafe fn open(self, path: &Path) -> std::result::Result<system::Library, libloading::Error> {
        // SAFETY: demanded of the caller.
        unsafe { system::Library::load_with_flags(path, system::LOAD_WITH_ALTERED_SEARCH_PATH) }
    }
}

/// The functions of a loaded binary; statuses are plain numbers, as foreign code may return any.
pub(super) struct Library {
    pub(super) instantiate: Instantiate,
    pub(super) free_instance: unsafe extern "C" fn(Component),
    pub(super) setup_experiment: unsafe extern "C" fn(Component, Boolean, f64, f64, Boolean, f64) -> c_int,
    pub(super) enter_initialization: Simple,
    pub(super) exit_initialization: Simple,
    pub(super) terminate: Simple,
    pub(super) reset: Simple,
    pub(super) get_real: Get<f64>,
    pub(super) get_integer: Get<c_int>,
    pub(super) get_boolean: Get<Boolean>,
    pub(super) get_string: Get<Text>,
    pub(super) set_real: Set<f64>,
    pub(super) set_integer: Set<c_int>,
    pub(super) set_boolean: Set<Boolean>,
    pub(super) set_string: Set<Text>,
    pub(super) do_step: unsafe extern "C" fn(Component, f64, f64, Boolean) -> c_int,
    pub(super) get_real_status: Option<unsafe extern "C" fn(Component, c_int, *mut f64) -> c_int>,
    pub(super) get_boolean_status: Option<unsafe extern "C" fn(Component, c_int, *mut Boolean) -> c_int>,
    /// There if the FMU can interpolate its inputs.
    pub(super) set_derivatives: Option<SetDerivatives>,
    /// There if the FMU has derivatives of its outputs.
    pub(super) get_derivatives: Option<GetDerivatives>,
    /// There if the FMU can save its state.
    pub(super) states: Option<States>,
    /// There if the FMU can also serialise it.
    pub(super) bytes: Option<Bytes>,
    /// Closes the library after everything else.
    _handle: Handle,
}

/// The functions for saved states.
#[derive(Clone, Copy)]
pub(super) struct States {
    pub(super) get: unsafe extern "C" fn(Component, *mut FmuState) -> c_int,
    pub(super) set: unsafe extern "C" fn(Component, FmuState) -> c_int,
    pub(super) free: unsafe extern "C" fn(Component, *mut FmuState) -> c_int,
}

/// The functions that turn saved states into bytes and back.
#[derive(Clone, Copy)]
pub(super) struct Bytes {
    pub(super) size: unsafe extern "C" fn(Component, FmuState, *mut usize) -> c_int,
    pub(super) write: unsafe extern "C" fn(Component, FmuState, *mut Byte, usize) -> c_int,
    pub(super) read: unsafe extern "C" fn(Component, *const Byte, usize, *mut FmuState) -> c_int,
}

impl Library {
    /// Loads the binary `identifier` of the FMU unpacked in `folder`, with the functions that it needs
    /// for co-simulation and for `capabilities`. Runs the initialisers of the library: foreign code.
    pub(super) fn load(
        folder: &Path,
        identifier: &str,
        capabilities: &Capabilities,
        names: Names,
    ) -> Result<Self> {
        let (file, path) = find(folder, identifier)?;
        let handle = Handle::open(&path, names).map_err(|e| e.at(&file))?;
        let functions = Functions { handle: &handle, file };
        // SAFETY: the types are those that FMI 2.0 gives the functions of these names.
        unsafe {
            if let Some(version) = functions.optional::<unsafe extern "C" fn() -> Text>(c"fmi2GetVersion") {
                let version = text(version());
                if !version.starts_with("2.") {
                    return Err(Error::fmu(format!(
                        "{}: fmi2GetVersion returns {version:?}; \"2.0\" was expected",
                        functions.file
                    )));
                }
            }
            Ok(Self {
                instantiate: functions.needed(c"fmi2Instantiate")?,
                free_instance: functions.needed(c"fmi2FreeInstance")?,
                setup_experiment: functions.needed(c"fmi2SetupExperiment")?,
                enter_initialization: functions.needed(c"fmi2EnterInitializationMode")?,
                exit_initialization: functions.needed(c"fmi2ExitInitializationMode")?,
                terminate: functions.needed(c"fmi2Terminate")?,
                reset: functions.needed(c"fmi2Reset")?,
                get_real: functions.needed(c"fmi2GetReal")?,
                get_integer: functions.needed(c"fmi2GetInteger")?,
                get_boolean: functions.needed(c"fmi2GetBoolean")?,
                get_string: functions.needed(c"fmi2GetString")?,
                set_real: functions.needed(c"fmi2SetReal")?,
                set_integer: functions.needed(c"fmi2SetInteger")?,
                set_boolean: functions.needed(c"fmi2SetBoolean")?,
                set_string: functions.needed(c"fmi2SetString")?,
                do_step: functions.needed(c"fmi2DoStep")?,
                get_real_status: functions.optional(c"fmi2GetRealStatus"),
                get_boolean_status: functions.optional(c"fmi2GetBooleanStatus"),
                set_derivatives: match capabilities.can_interpolate_inputs {
                    true => Some(functions.needed(c"fmi2SetRealInputDerivatives")?),
                    false => None,
                },
                get_derivatives: match capabilities.max_output_derivative_order {
                    0 => None,
                    _ => functions.optional(c"fmi2GetRealOutputDerivatives"),
                },
                states: match capabilities.can_get_and_set_state {
                    true => Some(States {
                        get: functions.needed(c"fmi2GetFMUstate")?,
                        set: functions.needed(c"fmi2SetFMUstate")?,
                        free: functions.needed(c"fmi2FreeFMUstate")?,
                    }),
                    false => None,
                },
                bytes: match capabilities.can_get_and_set_state && capabilities.can_serialize_state {
                    true => Some(Bytes {
                        size: functions.needed(c"fmi2SerializedFMUstateSize")?,
                        write: functions.needed(c"fmi2SerializeFMUstate")?,
                        read: functions.needed(c"fmi2DeSerializeFMUstate")?,
                    }),
                    false => None,
                },
                _handle: handle,
            })
        }
    }
}

/// The binary `identifier` for this machine in the FMU unpacked in `folder`: its name in the archive
/// and its path.
pub(in crate::fmi) fn find(folder: &Path, identifier: &str) -> Result<(String, PathBuf)> {
    let binaries = folder.join("binaries");
    let file = format!("{identifier}.{ENDING}");
    PLATFORMS
        .iter()
        .map(|platform| (format!("binaries/{platform}/{file}"), binaries.join(platform).join(&file)))
        .find(|(_, path)| path.is_file())
        .ok_or_else(|| missing(&binaries, &file))
}

/// The error for an FMU without a binary for this machine.
fn missing(binaries: &Path, file: &str) -> Error {
    let mut there: Vec<String> = fs::read_dir(binaries)
        .into_iter()
        .flatten()
        .flatten()
        .filter(|entry| entry.path().is_dir())
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    there.sort();
    let there = match there.as_slice() {
        [] => "it has no binaries at all".to_owned(),
        some => format!("there are binaries for {}", some.join(", ")),
    };
    let here = PLATFORMS.first().unwrap_or(&"this platform");
    Error::fmu(format!("the FMU has no binary for this machine, binaries/{here}/{file}; {there}"))
}

/// A library as the system's loader knows it, closed when it is dropped.
pub(in crate::fmi) struct Handle(system::Library);

impl Handle {
    /// Loads the library at `path`, an absolute one: the systems look for others in different places.
    pub(in crate::fmi) fn open(path: &Path, names: Names) -> Result<Self> {
        #[cfg(target_os = "linux")]
        super::elf::check(path).map_err(|why| Error::fmu(format!("the binary cannot be loaded: {why}")))?;
        // SAFETY: the initialisers of the library run: that is what importing an FMU means.
        unsafe { names.open(path) }.map(Self).map_err(|e| {
            let why = std::error::Error::source(&e).map_or_else(|| e.to_string(), ToString::to_string);
            Error::fmu(format!("the binary cannot be loaded: {why}"))
        })
    }

    /// The function called `name`, if there is one.
    ///
    /// # Safety
    /// `F` is the type of the pointer to that function. It is not called once the handle is gone.
    pub(in crate::fmi) unsafe fn function<F: Copy>(&self, name: &CStr) -> Option<F> {
        // no other type than that of a pointer that is never null has a meaning here
        const { assert!(size_of::<Option<F>>() == size_of::<*const ()>()) };
        // SAFETY: `F` is a function pointer (demanded of the caller), and a symbol at null is none.
        unsafe { self.0.get::<Option<F>>(name) }.ok().and_then(|symbol| *symbol)
    }
}

/// True if the library at `path` is loaded.
#[cfg(feature = "host")]
pub(in crate::fmi) fn is_loaded(path: &Path) -> bool {
    // SAFETY: nothing is loaded that is not there, and no initialiser runs.
    #[cfg(unix)]
    return unsafe { system::Library::open(Some(path), libc::RTLD_NOW | libc::RTLD_NOLOAD) }.is_ok();
    #[cfg(windows)]
    return system::Library::open_already_loaded(path).is_ok();
}

struct Functions<'a> {
    handle: &'a Handle,
    file: String,
}

impl Functions<'_> {
    /// The function called `name`, if there is one.
    ///
    /// # Safety
    /// `F` is the type of the pointer to that function.
    unsafe fn optional<F: Copy>(&self, name: &CStr) -> Option<F> {
        // SAFETY: demanded of the caller.
        unsafe { self.handle.function(name) }
    }

    /// As [`optional`](Self::optional), but fails where there is no such function.
    ///
    /// # Safety
    /// As for [`optional`](Self::optional).
    unsafe fn needed<F: Copy>(&self, name: &CStr) -> Result<F> {
        // SAFETY: demanded of the caller.
        unsafe { self.optional(name) }.ok_or_else(|| {
            Error::fmu(format!(
                "{}: the function {} is missing; the FMU is incomplete",
                self.file,
                name.to_string_lossy()
            ))
        })
    }
}
