//! What an FMU tells its master.

use super::printf::{self, Arguments};
use crate::fmi::c::{ComponentEnvironment, Logger, Text};
use crate::model::{Kind, VariableInfo};
use crate::shown::shortened;
use std::cell::Cell;
use std::collections::{BTreeMap, VecDeque};
use std::ffi::{CStr, c_int};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// So many messages are kept; older ones give way.
const CAPACITY: usize = 1000;

/// A message of an FMU.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    /// fmi2Status as the FMU gave it: 0 OK, 1 warning, 2 discard, 3 error, 4 fatal, 5 pending.
    pub status: i32,
    /// Category, one of those in the FMU's description; may be empty.
    pub category: String,
    /// The text, with its arguments and with the names of variables that it refers to. Directives of C's
    /// printf stand as they are where their arguments cannot be read: not there, or not on x86-64 with Linux or Windows.
    pub text: String,
}

/// The messages of one instance. FMUs may log from any thread.
#[derive(Debug, Default)]
pub(in crate::fmi) struct Log {
    messages: Mutex<Messages>,
    names: Names,
    /// There was a message since the last call began.
    noted: AtomicBool,
}

#[derive(Debug, Default)]
struct Messages {
    kept: VecDeque<Message>,
    /// Of the call that is going on: the message with the worst status, the last of those.
    worst: Option<Message>,
}

/// Names of variables, by the letter and the value reference with which messages refer to them.
///
/// No hash map: its random numbers would make FMUs for Windows need a library more.
pub(in crate::fmi) type Names = BTreeMap<(char, u32), String>;

/// How messages may refer to these variables; of several with the same reference the first is named.
pub(in crate::fmi) fn names(variables: &[VariableInfo]) -> Names {
    let mut names = Names::new();
    for info in variables {
        let letter = match info.kind {
            Kind::Real => 'r',
            Kind::Integer | Kind::Enumeration(_) => 'i',
            Kind::Boolean => 'b',
            Kind::Text => 's',
        };
        names.entry((letter, info.reference)).or_insert_with(|| info.name.clone());
    }
    names
}

impl Log {
    /// A log for an FMU whose variables have these names.
    pub(in crate::fmi) fn new(names: Names) -> Self {
        Self { names, ..Self::default() }
    }

    /// Forgets which message was the worst, before a call.
    pub(super) fn begin_call(&self) {
        // a lock for every call would take as long as a small model's step, and a swap a good part of that
        if self.noted.load(Ordering::Relaxed) && self.noted.swap(false, Ordering::Relaxed) {
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

    fn lock(&self) -> MutexGuard<'_, Messages> {
        // Messages are whole at any time: a panic elsewhere does not spoil them.
        self.messages.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A message on its way.
#[derive(Debug, Clone)]
// The check looks at all of it; an FMU that carries another one does not.
#[cfg_attr(not(feature = "host"), allow(dead_code))]
pub(in crate::fmi) struct Heard {
    /// The instance's name.
    pub(in crate::fmi) name: String,
    pub(in crate::fmi) status: c_int,
    /// `None` for NULL.
    pub(in crate::fmi) category: Option<String>,
    /// As the FMU gave it.
    pub(in crate::fmi) format: String,
    /// The same with its arguments.
    pub(in crate::fmi) text: String,
    /// False if it came with an environment that no living instance was given.
    pub(in crate::fmi) known: bool,
}

/// Whoever gets the messages of an instance.
pub(in crate::fmi) trait Listener: Send + Sync {
    /// May be called from any thread.
    fn hear(&self, message: Heard);
}

impl Listener for Log {
    fn hear(&self, message: Heard) {
        let Heard { status, category, text, .. } = message;
        // many are kept, and each may be of any length
        let text = resolve(&shortened(&text), &self.names).trim_end().to_owned();
        let category = shortened(&category.unwrap_or_default()).into_owned();
        self.push(Message { status, category, text });
    }
}

/// The listeners of all living instances, by the environment that they were given. What an FMU hands back
/// is compared with these and never looked into: FMUs pass numbers of their own, and pointers that are
/// out of date.
static LISTENERS: Mutex<Vec<(usize, Arc<dyn Listener>)>> = Mutex::new(Vec::new());

thread_local! {
    /// The environment of the instance that this thread is calling; 0 for none.
    static CALLED: Cell<usize> = const { Cell::new(0) };
}

fn listeners() -> MutexGuard<'static, Vec<(usize, Arc<dyn Listener>)>> {
    // The list is whole at any time.
    LISTENERS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What an instance gets as fmi2ComponentEnvironment. Messages reach its listener until it is dropped.
pub(in crate::fmi) struct Environment(usize);

impl Environment {
    pub(in crate::fmi) fn new(listener: Arc<dyn Listener>) -> Self {
        let number = Arc::as_ptr(&listener).cast::<u8>() as usize;
        listeners().push((number, listener));
        Self(number)
    }

    pub(in crate::fmi) fn pointer(&self) -> ComponentEnvironment {
        self.0 as ComponentEnvironment
    }

    /// Notes that this thread is calling the instance, until the note is dropped: messages with an unknown
    /// environment are then taken for the instance's.
    pub(in crate::fmi) fn calling(&self) -> Calling {
        Calling(CALLED.replace(self.0))
    }
}

impl Drop for Environment {
    fn drop(&mut self) {
        let mut all = listeners();
        all.retain(|(number, _)| *number != self.0);
        if all.is_empty() {
            // Nothing stays allocated when an FMU that carries another one is unloaded.
            *all = Vec::new();
        }
    }
}

/// See [`Environment::calling`].
pub(in crate::fmi) struct Calling(usize);

impl Drop for Calling {
    fn drop(&mut self) {
        CALLED.set(self.0);
    }
}

/// Who gets a message with this environment, and whether that is the one who should. A thread of an FMU
/// with an unknown environment could be anybody's: all get its messages.
fn addressees(environment: usize) -> (Vec<Arc<dyn Listener>>, bool) {
    let called = CALLED.get();
    let all = listeners();
    let find = |number| all.iter().find(|(n, _)| *n == number).map(|(_, listener)| listener.clone());
    if let Some(listener) = find(environment) {
        return (vec![listener], true);
    }
    match find(called) {
        Some(listener) => (vec![listener], false),
        None => (all.iter().map(|(_, listener)| listener.clone()).collect(), false),
    }
}

/// Passes a message on to those whom it concerns.
///
/// # Safety
/// The texts are null or end with a zero. Nothing is demanded of the environment.
unsafe fn pass_on(
    environment: ComponentEnvironment,
    name: Text,
    status: c_int,
    category: Text,
    format: Text,
    arguments: &mut dyn Arguments,
) {
    let (listeners, known) = addressees(environment as usize);
    // SAFETY: demanded of the caller.
    let (name, format) = unsafe { (text(name), text(format)) };
    // SAFETY: demanded of the caller.
    let category = (!category.is_null()).then(|| unsafe { text(category) });
    let text = printf::format(&format, arguments);
    let message = Heard { name, status, category, format, text, known };
    for listener in listeners {
        listener.hear(message.clone());
    }
}

/// fmi2CallbackLogger without the variable arguments: directives stand as they are.
///
/// # Safety
/// The texts are null or end with a zero.
#[cfg(any(feature = "host", not(all(any(target_os = "linux", windows), target_arch = "x86_64"))))]
pub(in crate::fmi) unsafe extern "C" fn without_arguments(
    environment: ComponentEnvironment,
    name: Text,
    status: c_int,
    category: Text,
    format: Text,
) {
    // SAFETY: demanded of the caller.
    unsafe { pass_on(environment, name, status, category, format, &mut printf::Nothing) }
}

type Fixed = unsafe extern "C" fn(ComponentEnvironment, Text, c_int, Text, Text);

/// A function without the variable arguments as a logger.
pub(in crate::fmi) fn variadic(function: Fixed) -> Logger {
    type Variadic = unsafe extern "C" fn(ComponentEnvironment, Text, c_int, Text, Text, ...);
    // SAFETY: both are C function pointers of the same size. Stable Rust cannot define a variadic
    // function; in the C calling conventions of the supported platforms the fixed arguments of a
    // variadic call lie where a function with only these expects them, and the caller cleans up.
    Some(unsafe { std::mem::transmute::<Fixed, Variadic>(function) })
}

/// The logger for fmi2CallbackFunctions.
pub(in crate::fmi) fn logger() -> Logger {
    #[cfg(all(any(target_os = "linux", windows), target_arch = "x86_64"))]
    return variadic(entry::log);
    // Elsewhere the arguments cannot be read.
    #[cfg(not(all(any(target_os = "linux", windows), target_arch = "x86_64")))]
    return variadic(without_arguments);
}

/// Where a message arrives with its arguments still where the call left them.
#[cfg(all(any(target_os = "linux", windows), target_arch = "x86_64"))]
mod entry {
    use super::printf::call::{Place, Variadic};
    use super::{ComponentEnvironment, Text, c_int, pass_on};

    /// fmi2CallbackLogger: puts all registers that may hold arguments, and the place of the others, into a
    /// [`Registers`](super::printf::call::Registers) and passes that to [`arrived`] as a sixth argument.
    ///
    /// # Safety
    /// The texts are null or end with a zero.
    #[cfg(not(windows))]
    #[unsafe(naked)]
    pub(super) unsafe extern "C" fn log(_: ComponentEnvironment, _: Text, _: c_int, _: Text, _: Text) {
        std::arch::naked_asm!(
            "push rbp",
            "mov rbp, rsp",
            "sub rsp, 192",
            "mov [rsp], rdi",
            "mov [rsp + 8], rsi",
            "mov [rsp + 16], rdx",
            "mov [rsp + 24], rcx",
            "mov [rsp + 32], r8",
            "mov [rsp + 40], r9",
            "movups [rsp + 48], xmm0",
            "movups [rsp + 64], xmm1",
            "movups [rsp + 80], xmm2",
            "movups [rsp + 96], xmm3",
            "movups [rsp + 112], xmm4",
            "movups [rsp + 128], xmm5",
            "movups [rsp + 144], xmm6",
            "movups [rsp + 160], xmm7",
            "lea rax, [rbp + 16]",
            "mov [rsp + 176], rax",
            "mov r9, rsp",
            "call {arrived}",
            "leave",
            "ret",
            arrived = sym arrived,
        )
    }

    /// fmi2CallbackLogger: calls [`arrived`] with the same arguments and, as a sixth, the place of those that follow.
    ///
    /// # Safety
    /// The texts are null or end with a zero.
    #[cfg(windows)]
    #[unsafe(naked)]
    pub(super) unsafe extern "C" fn log(_: ComponentEnvironment, _: Text, _: c_int, _: Text, _: Text) {
        std::arch::naked_asm!(
            // four words for the called function's own use, the fifth argument and the sixth; the stack at a multiple of 16
            "sub rsp, 56",
            "mov rax, [rsp + 96]",
            "mov [rsp + 32], rax",
            "lea rax, [rsp + 104]",
            "mov [rsp + 40], rax",
            "call {arrived}",
            "add rsp, 56",
            "ret",
            arrived = sym arrived,
        )
    }

    /// # Safety
    /// The texts are null or end with a zero; the place is that of the call's arguments.
    unsafe extern "C" fn arrived(
        environment: ComponentEnvironment,
        name: Text,
        status: c_int,
        category: Text,
        format: Text,
        place: Place,
    ) {
        // SAFETY: demanded of the caller, who waits.
        let mut arguments = unsafe { Variadic::at(place) };
        // SAFETY: demanded of the caller.
        unsafe { pass_on(environment, name, status, category, format, &mut arguments) }
    }
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

/// The text with the names of the variables that it refers to, as in `#r12#`, and `#` for `##`. What refers
/// to nothing stands as it is.
fn resolve(text: &str, names: &Names) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('#') {
        out.push_str(before);
        if let Some(tail) = after.strip_prefix('#') {
            out.push('#');
            rest = tail;
            continue;
        }
        let name = after.split_once('#').and_then(|(inside, tail)| {
            let mut letters = inside.chars();
            let letter = letters.next()?;
            let digits = letters.as_str();
            let plain = digits.bytes().all(|b| b.is_ascii_digit());
            let reference = digits.parse().ok().filter(|_| plain)?;
            Some((names.get(&(letter, reference))?, tail))
        });
        match name {
            Some((name, tail)) => {
                out.push_str(name);
                rest = tail;
            }
            None => {
                out.push('#');
                rest = after;
            }
        }
    }
    out + rest
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
    fn names_stand_for_references() {
        let names = Names::from([
            (('r', 1365), "body.m".to_owned()),
            (('i', 1), "gear".into()),
            (('s', 0), "x".into()),
        ]);
        let resolved = |text: &str| resolve(text, &names);
        assert_eq!(
            resolved("#r1365# must be larger than zero (used in IO channel ##4)"),
            "body.m must be larger than zero (used in IO channel #4)"
        );
        assert_eq!(resolved("#i1##s0#"), "gearx");
        assert_eq!(resolved("###i1###"), "#gear#");
        for text in ["#b1#", "#r#", "#r1366#", "item #1", "#", "#r+1365#", "#ü1#"] {
            assert_eq!(resolved(text), text);
        }
    }

    #[test]
    fn only_the_living_are_reached() {
        let (one, other) = (Arc::<Log>::default(), Arc::<Log>::default());
        let texts = |log: &Log| log.drain().into_iter().map(|m| m.text).collect::<Vec<_>>();
        let say = |environment: ComponentEnvironment, text: &CStr| {
            let Some(log) = logger() else { return };
            // SAFETY: texts that end with a zero, and a text for the directive.
            unsafe { log(environment, c"".as_ptr(), 0, c"".as_ptr(), text.as_ptr(), c"now".as_ptr()) };
        };
        let (first, second) = (Environment::new(one.clone()), Environment::new(other.clone()));
        say(first.pointer(), c"first");
        say(second.pointer(), c"second");
        assert_eq!(texts(&one), ["first"]);
        assert_eq!(texts(&other), ["second"]);
        {
            let _calling = second.calling();
            say(1 as ComponentEnvironment, c"somebody");
            say(std::ptr::null_mut(), c"nobody");
        }
        assert_eq!(texts(&one), [""; 0]);
        assert_eq!(texts(&other), ["somebody", "nobody"]);
        let old = first.pointer();
        drop(first);
        let _calling = second.calling();
        say(old, c"late");
        assert_eq!(texts(&one), [""; 0]);
        assert_eq!(texts(&other), ["late"]);
    }

    #[test]
    #[cfg(all(target_os = "linux", target_arch = "x86_64"))]
    fn arguments_come_from_registers_and_from_the_stack() {
        let log = Arc::<Log>::default();
        let environment = Environment::new(log.clone());
        let format = c"%s %d %.1f %s %d %.1f %.1f %.1f %.1f %.1f %.1f %.1f %.1f %.1f %d";
        let (e, a, b) = (environment.pointer(), c"a".as_ptr(), c"b".as_ptr());
        let Some(logger) = logger() else { panic!("no logger") };
        // SAFETY: the arguments are those that the format names.
        unsafe {
            #[rustfmt::skip]
            logger(e, a, 0, a, format.as_ptr(), a, -1, 0.5, b, 2, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 7);
            // no text is at these addresses
            logger(e, a, 0, a, c"%s %s".as_ptr(), 1u64, u64::MAX);
        }
        let texts: Vec<String> = log.drain().into_iter().map(|m| m.text).collect();
        assert_eq!(texts, ["a -1 0.5 b 2 1.0 2.0 3.0 4.0 5.0 6.0 7.0 8.0 9.0 7", "%s %s"]);
    }
}
