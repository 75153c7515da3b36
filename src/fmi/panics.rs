//! What panics of the model's code say, for the functions that no panic gets past.

use std::cell::Cell;
use std::sync::Once;

/// As much as is kept of what a panic says.
const PANIC_LENGTH: usize = 500;

thread_local! {
    /// What the last panic of this thread said, and how long that is. Plain bytes: a value with a destructor
    /// would keep the library loaded in a host that unloads it.
    static LAST_PANIC: Cell<([u8; PANIC_LENGTH], usize)> = const { Cell::new(([0; PANIC_LENGTH], 0)) };
}

/// Makes the panic hook silent: the host's standard error is not ours. Panics become messages; only the hook
/// knows where one happened.
pub(super) fn silence() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        std::panic::set_hook(Box::new(|info| {
            let payload = info.payload();
            let text = payload
                .downcast_ref::<&str>()
                .copied()
                .or_else(|| payload.downcast_ref::<String>().map(String::as_str))
                .unwrap_or("no text");
            let place = info.location().map(|l| format!("{}:{}: ", l.file(), l.line())).unwrap_or_default();
            let said = format!("{place}{text}");
            let mut bytes = [0; PANIC_LENGTH];
            let length = said.len().min(PANIC_LENGTH);
            bytes[..length].copy_from_slice(&said.as_bytes()[..length]);
            LAST_PANIC.set((bytes, length));
        }));
    });
}

/// What to tell the master of the panic that was just caught in this thread.
pub(super) fn about() -> String {
    let (bytes, length) = LAST_PANIC.replace(([0; PANIC_LENGTH], 0));
    let said = match length {
        0 => "a place unknown".into(),
        _ => String::from_utf8_lossy(&bytes[..length]),
    };
    format!("the model's code panicked at {said}. This is a fault in it: please report it to its author")
}
