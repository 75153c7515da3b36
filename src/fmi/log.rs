//! Messages to the master's logger.

use super::c::{CallbackFunctions, Fmi, LogMessage, Status, Text};
use super::float::HostSettings;
use std::ffi::{CStr, CString, c_void};

/// The categories that the model description declares.
pub const CATEGORIES: [(&str, &str); 4] = [
    ("logEvents", "what the master asked for: initialization, steps back, reset"),
    ("logStatusWarning", "what the user should know although the call succeeded; always passed on"),
    ("logStatusError", "why a call was refused or discarded; always passed on"),
    ("logAll", "all messages"),
];

/// Who gets the messages.
#[derive(Clone, Copy)]
pub enum Master {
    /// Of FMI 2.0: copied, because the callback functions live only during fmi2Instantiate.
    Two(CallbackFunctions),
    /// Of FMI 3.0: its logger, and what that gets back.
    Three(LogMessage, *mut c_void),
}

impl Master {
    /// What it speaks.
    pub fn fmi(&self) -> Fmi {
        match self {
            Self::Two(_) => Fmi::Two,
            Self::Three(..) => Fmi::Three,
        }
    }
}

/// A master's logger.
pub struct Log {
    master: Master,
    instance: CString,
    events: bool,
    /// The host's floating-point settings during a call of an FMI function.
    host: HostSettings,
}

impl Log {
    /// The logger of a master for an instance of this name.
    pub fn new(master: Master, instance: &CStr, debug: bool) -> Self {
        Self { master, instance: instance.to_owned(), events: debug, host: HostSettings::default() }
    }

    /// What the master speaks.
    pub fn fmi(&self) -> Fmi {
        self.master.fmi()
    }

    /// Begins a call of an FMI function: the usual floating-point settings, but for the logger.
    pub fn enter(&mut self) {
        self.host = HostSettings::replace();
    }

    /// Ends it: the host's settings.
    pub fn leave(&mut self) {
        self.host = HostSettings::default();
    }

    /// Turns debug messages on or off, for all categories or for those named. Warnings and errors
    /// are always passed on: a status without a message helps nobody.
    pub fn set_categories(&mut self, on: bool, categories: &[&str]) -> Result<(), String> {
        for category in categories {
            if !CATEGORIES.iter().any(|(name, _)| name == category) {
                let names: Vec<&str> = CATEGORIES.iter().map(|(name, _)| *name).collect();
                return Err(format!("there is no log category {category:?}; there are {}", names.join(", ")));
            }
        }
        let named = categories.is_empty() || categories.iter().any(|c| matches!(*c, "logEvents" | "logAll"));
        if named {
            self.events = on;
        }
        Ok(())
    }

    /// Passes on what happened, if the master wants to know.
    pub fn event(&self, message: &str) {
        if self.events {
            self.send(Status::Ok, c"logEvents", message);
        }
    }

    /// Passes on the message of an error.
    pub fn error(&self, status: Status, message: &str) {
        self.send(status, c"logStatusError", message);
    }

    /// Passes on a warning.
    pub fn warning(&self, message: &str) {
        self.send(Status::Warning, c"logStatusWarning", message);
    }

    fn send(&self, status: Status, category: &CStr, message: &str) {
        let plain = message.replace('\0', " ");
        let text = match self.master {
            // the message is a format for printf, in which # is special as well
            Master::Two(_) => CString::new(plain.replace('%', "%%").replace('#', "##")),
            Master::Three(..) => CString::new(plain),
        };
        let (Ok(text), status) = (text, status as std::ffi::c_int) else { return };
        let text: Text = text.as_ptr();
        // SAFETY: the pointers are zero-terminated texts that outlive the call; a format has no directives, so that no further
        // arguments are read.
        self.host.during(|| unsafe {
            match self.master {
                Master::Two(to) => {
                    if let Some(logger) = to.logger {
                        logger(
                            to.component_environment,
                            self.instance.as_ptr(),
                            status,
                            category.as_ptr(),
                            text,
                        );
                    }
                }
                Master::Three(logger, environment) => {
                    if let Some(logger) = logger {
                        logger(environment, status, category.as_ptr(), text);
                    }
                }
            }
        });
    }
}
