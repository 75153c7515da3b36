//! What an FMU tells its master.

use crate::fmi::c::{ComponentEnvironment, Logger, Text};
use crate::shown::shortened;
use std::collections::VecDeque;
use std::ffi::{CStr, c_int};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// So many messages are kept; older ones give way.
const CAPACITY: usize = 1000;

/// A message of an FMU.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    /// fmi2Status as the FMU gave it: 0 OK, 1 warning, 2 discard, 3 error, 4 fatal, 5 pending.
    pub status: i32,
    /// Category, one of those in the FMU's description; may be empty.
    pub category: String,
    /// The text. Directives of C's printf stand as they are: their arguments cannot be read from Rust.
    pub text: String,
}

/// The messages of one instance. FMUs may log from any thread.
#[derive(Debug, Default)]
pub(in crate::fmi) struct Log {
    messages: Mutex<Messages>,
    /// There was a message since the last call began.
    noted: AtomicBool,
}

#[derive(Debug, Default)]
struct Messages {
    kept: VecDeque<Message>,
    /// Of the call that is going on: the message with the worst status, the last of those.
    worst: Option<Message>,
}

impl Log {
    /// Forgets which message was the worst, before a call.
    pub(super) fn begin_call(&self) {
        // a lock for every call would take as long as a small model's step
        if self.noted.swap(false, Ordering::Relaxed) {
            self.lock().worst = None;
        }
    }

    /// The text that explains best why the call that just ended failed.
    pub(super) fn reason(&self) -> Option<String> {
        self.lock().worst.as_ref().map(|m| m.text.clone())
    }

    /// All messages; they are then forgotten.
    pub(in crate::fmi) fn drain(&self) -> Vec<Message> {
        self.lock().kept.drain(..).collect()
    }

    fn push(&self, message: Message) {
        let mut messages = self.lock();
        self.noted.store(true, Ordering::Relaxed);
        if messages.worst.as_ref().is_none_or(|w| message.status >= w.status) {
            messages.worst = Some(message.clone());
        }
        if messages.kept.len() == CAPACITY {
            messages.kept.pop_front();
        }
        messages.kept.push_back(message);
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Messages> {
        // Messages are whole at any time: a panic elsewhere does not spoil them.
        self.messages.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The logger for fmi2CallbackFunctions; its environment has to point to a [`Log`].
pub(super) fn logger() -> Logger {
    type Fixed = unsafe extern "C" fn(ComponentEnvironment, Text, c_int, Text, Text);
    type Variadic = unsafe extern "C" fn(ComponentEnvironment, Text, c_int, Text, Text, ...);
    // SAFETY: both are C function pointers of the same size. Stable Rust cannot define a variadic
    // function; in the C calling conventions of the supported platforms the fixed arguments of a
    // variadic call lie where a function with only these expects them, and the caller cleans up.
    Some(unsafe { std::mem::transmute::<Fixed, Variadic>(log) })
}

/// fmi2CallbackLogger without the variable arguments.
///
/// # Safety
/// `environment` is null or points to a living [`Log`]; the texts are null or end with a zero.
unsafe extern "C" fn log(
    environment: ComponentEnvironment,
    _instance: Text,
    status: c_int,
    category: Text,
    message: Text,
) {
    // SAFETY: as demanded of the caller; the slave keeps its log until the instance is gone.
    let Some(log) = (unsafe { environment.cast::<Log>().as_ref() }) else { return };
    // SAFETY: as demanded of the caller.
    let (category, text) = unsafe { (text(category), text(message)) };
    // many are kept, and each may be of any length
    let text = plain(&shortened(&text));
    log.push(Message { status, category: shortened(&category).into_owned(), text });
}

/// A copy of a C text; empty for null. What is not UTF-8 is replaced.
///
/// # Safety
/// `text` is null or ends with a zero.
pub(in crate::fmi) unsafe fn text(text: Text) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: not null, and ends with a zero.
    unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()
}

/// The text without the escapes of FMI's loggers: `%%` is a percent sign, `##` a hash.
fn plain(text: &str) -> String {
    text.replace("%%", "%").replace("##", "#").trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(status: i32, text: &str) -> Message {
        Message { status, category: String::new(), text: text.into() }
    }

    #[test]
    fn keeps_the_newest_and_finds_the_worst() {
        let log = Log::default();
        log.begin_call();
        assert_eq!(log.reason(), None);
        log.push(message(3, "first failure"));
        log.push(message(3, "failure"));
        log.push(message(0, "chatter"));
        assert_eq!(log.reason().as_deref(), Some("failure"));
        for i in 0..CAPACITY {
            log.push(message(0, &i.to_string()));
        }
        let messages = log.drain();
        assert_eq!(messages.len(), CAPACITY);
        assert_eq!(messages[0].text, "0");
        assert_eq!(log.drain(), []);
    }

    #[test]
    fn removes_escapes() {
        assert_eq!(plain("100 %% of ##1: %s\n"), "100 % of #1: %s");
    }
}
