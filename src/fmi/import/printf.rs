//! The messages of loggers: C's printf with arguments that are not trusted.
//!
//! What an FMU passes as a format may be a plain text with percent signs in it, and then its arguments are
//! not there. So every directive is read here and not by the C library: `%n` writes nothing, widths are
//! limited, and a text or a place on the stack is only read if it is there.

use std::ffi::{CString, c_int};

/// Widths and precisions beyond this are taken for this.
const WIDEST: i64 = 200;
/// So many arguments are read; more directives than these stand as they are.
const MOST: usize = 64;
/// So much of a text is shown \[bytes\].
const LONGEST: usize = 4096;

/// The arguments of a variadic call, one after the other; `None` where there is no telling.
pub(super) trait Arguments {
    /// An integer or a pointer, as the register or the place on the stack holds it.
    fn word(&mut self) -> Option<u64>;
    /// A double.
    fn real(&mut self) -> Option<f64>;
    /// A long double.
    fn long_real(&mut self) -> Option<f64>;
    /// The bytes of the text that is at an address, without the zero, or as many as are asked for; `None` if
    /// nothing can be read there.
    fn text(&mut self, address: u64, most: usize) -> Option<Vec<u8>>;
}

/// No arguments: directives stand as they are.
#[cfg_attr(not(feature = "host"), allow(dead_code))]
pub(super) struct Nothing;

impl Arguments for Nothing {
    fn word(&mut self) -> Option<u64> {
        None
    }
    fn real(&mut self) -> Option<f64> {
        None
    }
    fn long_real(&mut self) -> Option<f64> {
        None
    }
    fn text(&mut self, _: u64, _: usize) -> Option<Vec<u8>> {
        None
    }
}

/// A directive such as `%-8.3lf`.
#[derive(Default)]
struct Directive {
    flags: String,
    width: Option<i64>,
    precision: Option<i64>,
    /// "hh", "h", "l", "ll", "L", "z", "j", "t" or nothing.
    length: String,
    conversion: char,
}

/// The message: `format` with its directives replaced.
pub(super) fn format(format: &str, arguments: &mut dyn Arguments) -> String {
    let mut out = String::with_capacity(format.len());
    let mut rest = format;
    for _ in 0..MOST {
        let Some(at) = rest.find('%') else { break };
        out.push_str(&rest[..at]);
        rest = &rest[at..];
        if let Some(tail) = rest.strip_prefix("%%") {
            out.push('%');
            rest = tail;
            continue;
        }
        let (shown, tail) = match read(&rest[1..], arguments) {
            Some((directive, tail)) => (show(&directive, arguments), tail),
            None => (None, &rest[1..]),
        };
        match shown {
            Some(text) => out.push_str(&text),
            None => out.push_str(&rest[..rest.len() - tail.len()]),
        }
        rest = tail;
    }
    out.push_str(&rest.replace("%%", "%"));
    out
}

/// The directive at the beginning of `text`, which follows a percent sign, and what comes after it.
fn read<'a>(text: &'a str, arguments: &mut dyn Arguments) -> Option<(Directive, &'a str)> {
    let mut directive = Directive::default();
    let rest = text.trim_start_matches(['-', '+', ' ', '#', '0', '\'']);
    directive.flags = text[..text.len() - rest.len()].replace('\'', "");
    let mut number = |rest: &'a str| -> Option<(Option<i64>, &'a str)> {
        if let Some(tail) = rest.strip_prefix('*') {
            return Some((Some(i64::from(arguments.word()? as c_int)), tail));
        }
        let tail = rest.trim_start_matches(|c: char| c.is_ascii_digit());
        let digits = &rest[..rest.len() - tail.len()];
        Some((if digits.is_empty() { None } else { Some(digits.parse().unwrap_or(WIDEST)) }, tail))
    };
    let (width, mut rest) = number(rest)?;
    directive.width = width;
    if let Some(tail) = rest.strip_prefix('.') {
        let (precision, tail) = number(tail)?;
        (directive.precision, rest) = (Some(precision.unwrap_or(0)), tail);
    }
    let tail = rest.trim_start_matches(['h', 'l', 'L', 'q', 'z', 'j', 't']);
    directive.length = rest[..rest.len() - tail.len()].into();
    directive.conversion = tail.chars().next().filter(|c| "diouxXeEfFgGaAcspn".contains(*c))?;
    Some((directive, &tail[1..]))
}

/// What a directive makes of its arguments; `None` if they cannot be read.
fn show(directive: &Directive, arguments: &mut dyn Arguments) -> Option<String> {
    let length = directive.length.as_str();
    match directive.conversion {
        // counts what was written so far, into the memory of the caller
        'n' => arguments.word().map(|_| String::new()),
        's' => {
            let address = arguments.word()?;
            let most = directive.precision.filter(|p| *p >= 0).map_or(LONGEST, |p| (p as usize).min(LONGEST));
            let bytes = match address {
                0 => b"(null)".to_vec(),
                // wide characters are rare, and their size differs between systems
                _ if length.contains('l') => return None,
                _ => arguments.text(address, most)?,
            };
            let text = String::from_utf8_lossy(&bytes).into_owned();
            let width = directive.width.unwrap_or(0);
            let left = width < 0 || directive.flags.contains('-');
            let width = width.abs().min(WIDEST) as usize;
            Some(if left { format!("{text:<width$}") } else { format!("{text:>width$}") })
        }
        'c' => char::from_u32(u32::from(arguments.word()? as u8)).map(Into::into),
        'p' => Some(format!("{:#x}", arguments.word()?)),
        'd' | 'i' => {
            let word = arguments.word()?;
            let value = match length {
                "hh" => i64::from(word as i8),
                "h" => i64::from(word as i16),
                "" => i64::from(word as i32),
                _ => word as i64,
            };
            // SAFETY: `print` makes a directive for one long long, and one is passed.
            unsafe { print(directive, "ll", |buffer, size, f| libc::snprintf(buffer, size, f, value)) }
        }
        'o' | 'u' | 'x' | 'X' => {
            let word = arguments.word()?;
            let value = match length {
                "hh" => u64::from(word as u8),
                "h" => u64::from(word as u16),
                "" => u64::from(word as u32),
                _ => word,
            };
            // SAFETY: `print` makes a directive for one unsigned long long, and one is passed.
            unsafe { print(directive, "ll", |buffer, size, f| libc::snprintf(buffer, size, f, value)) }
        }
        _ => {
            let value = if length == "L" { arguments.long_real()? } else { arguments.real()? };
            // SAFETY: `print` makes a directive for one double, and one is passed.
            unsafe { print(directive, "", |buffer, size, f| libc::snprintf(buffer, size, f, value)) }
        }
    }
}

/// One number as the C library writes it.
///
/// # Safety
/// `call` passes its arguments to snprintf with one value of the type that conversion and length name.
unsafe fn print(
    directive: &Directive,
    length: &str,
    call: impl FnOnce(*mut libc::c_char, usize, *const libc::c_char) -> c_int,
) -> Option<String> {
    let mut format = format!("%{}", directive.flags);
    if let Some(width) = directive.width {
        format += if width < 0 { "-" } else { "" };
        format += &width.abs().min(WIDEST).to_string();
    }
    if let Some(precision) = directive.precision.filter(|p| *p >= 0) {
        format += &format!(".{}", precision.min(WIDEST));
    }
    format += length;
    format.push(directive.conversion);
    let format = CString::new(format).ok()?;
    // The largest double has 309 digits before the point.
    let mut buffer = [0u8; 1024];
    let written = call(buffer.as_mut_ptr().cast(), buffer.len(), format.as_ptr());
    let written = usize::try_from(written).ok()?.min(buffer.len() - 1);
    let text = String::from_utf8_lossy(&buffer[..written]).into_owned();
    Some(if cfg!(windows) { two_digits_of_exponent(text) } else { text })
}

/// A number as C99 writes it: the old C library of Windows has three digits of exponent and more, as in 1e-007.
fn two_digits_of_exponent(text: String) -> String {
    let is_sign = |c: char| matches!(c, '+' | '-');
    match text.split_once(['e', 'E']).and_then(|(_, tail)| tail.strip_prefix(is_sign)) {
        Some(digits) if digits.len() == 3 && digits.starts_with('0') => {
            let mut short = text.clone();
            short.remove(text.len() - 3);
            short
        }
        _ => text,
    }
}

/// The bytes of the text at an address of this process, as [`Arguments::text`] has it.
#[cfg(all(any(target_os = "linux", windows), target_arch = "x86_64"))]
fn text_at(address: u64, most: usize) -> Option<Vec<u8>> {
    let mut text = Vec::new();
    while text.len() < most {
        // Not beyond the end of a page: the next one may not be there.
        let at = address.checked_add(text.len() as u64)?;
        let mut chunk = vec![0; (4096 - (at % 4096) as usize).min(most - text.len())];
        let read = peek(at, &mut chunk);
        if read == 0 {
            // A text without an end is none.
            return None;
        }
        chunk.truncate(read);
        if let Some(end) = chunk.iter().position(|b| *b == 0) {
            text.extend(&chunk[..end]);
            return Some(text);
        }
        text.extend(chunk);
    }
    Some(text)
}

/// The eight bytes at an address.
#[cfg(all(any(target_os = "linux", windows), target_arch = "x86_64"))]
fn word_at(address: u64) -> Option<u64> {
    let mut bytes = [0; 8];
    (peek(address, &mut bytes) == 8).then(|| u64::from_le_bytes(bytes))
}

/// Copies what is at an address of this process, if anything is; how many bytes.
#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
fn peek(address: u64, buffer: &mut [u8]) -> usize {
    let local = libc::iovec { iov_base: buffer.as_mut_ptr().cast(), iov_len: buffer.len() };
    let remote = libc::iovec { iov_base: address as *mut _, iov_len: buffer.len() };
    // SAFETY: the kernel writes into the buffer only, and looks whether the other address is there.
    let read = unsafe { libc::process_vm_readv(libc::getpid(), &local, 1, &remote, 1, 0) };
    usize::try_from(read).unwrap_or(0)
}

/// Copies what is at an address of this process, if anything is; how many bytes.
#[cfg(all(windows, target_arch = "x86_64"))]
fn peek(address: u64, buffer: &mut [u8]) -> usize {
    use windows_sys::Win32::System::Diagnostics::Debug::ReadProcessMemory;
    use windows_sys::Win32::System::Threading::GetCurrentProcess;
    let mut read = 0;
    let into = buffer.as_mut_ptr().cast();
    // SAFETY: the system writes into the buffer only, and looks whether the other address is there.
    let done =
        unsafe { ReadProcessMemory(GetCurrentProcess(), address as *const _, into, buffer.len(), &mut read) };
    if done == 0 { 0 } else { read }
}

/// What a variadic function finds when it is called, by the System V convention of x86-64.
#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
pub(super) mod call {
    use super::{Arguments, text_at, word_at};

    /// The registers at the beginning of the call, as the logger's entry lays them out.
    #[repr(C)]
    pub(in crate::fmi::import) struct Registers {
        general: [u64; 6],
        vector: [[u64; 2]; 8],
        /// Where arguments are that have no register.
        stack: u64,
    }

    /// Where a logger finds its arguments.
    pub(in crate::fmi::import) type Place = *const Registers;

    /// The arguments after the five that every logger has.
    pub(in crate::fmi::import) struct Variadic<'a> {
        registers: &'a Registers,
        general: usize,
        vector: usize,
        stack: u64,
    }

    impl<'a> Variadic<'a> {
        /// # Safety
        /// The registers are there as long as this value.
        pub(in crate::fmi::import) unsafe fn at(place: Place) -> Self {
            // SAFETY: demanded of the caller.
            let registers = unsafe { &*place };
            Self { registers, general: 5, vector: 0, stack: registers.stack }
        }

        fn stacked(&mut self) -> Option<u64> {
            let word = word_at(self.stack);
            self.stack += 8;
            word
        }
    }

    impl Arguments for Variadic<'_> {
        fn word(&mut self) -> Option<u64> {
            let word = self.registers.general.get(self.general).copied();
            self.general += 1;
            word.or_else(|| self.stacked())
        }

        fn real(&mut self) -> Option<f64> {
            let register = self.registers.vector.get(self.vector).map(|r| r[0]);
            self.vector += 1;
            register.or_else(|| self.stacked()).map(f64::from_bits)
        }

        fn long_real(&mut self) -> Option<f64> {
            // Always on the stack, at a multiple of 16: 64 bits of mantissa, then exponent and sign.
            self.stack = self.stack.next_multiple_of(16);
            let (mantissa, head) = (self.stacked()?, self.stacked()? as u16);
            let exponent = i32::from(head & 0x7fff) - 16383 - 63;
            let size = libm::ldexp(mantissa as f64, exponent);
            let size = match head & 0x7fff {
                0x7fff if mantissa << 1 != 0 => f64::NAN,
                0x7fff => f64::INFINITY,
                _ => size,
            };
            Some(if head & 0x8000 != 0 { -size } else { size })
        }

        fn text(&mut self, address: u64, most: usize) -> Option<Vec<u8>> {
            text_at(address, most)
        }
    }
}

/// What a variadic function finds when it is called, by the convention of 64-bit Windows: one word after the other.
#[cfg(all(windows, target_arch = "x86_64"))]
pub(super) mod call {
    use super::{Arguments, text_at, word_at};

    /// Where a logger finds the arguments after the five that it always has: their address.
    pub(in crate::fmi::import) type Place = u64;

    /// Those arguments.
    pub(in crate::fmi::import) struct Variadic(Place);

    impl Variadic {
        /// # Safety
        /// None: what is not there is not read.
        pub(in crate::fmi::import) unsafe fn at(place: Place) -> Self {
            Self(place)
        }
    }

    impl Arguments for Variadic {
        fn word(&mut self) -> Option<u64> {
            let word = word_at(self.0);
            self.0 += 8;
            word
        }

        fn real(&mut self) -> Option<f64> {
            self.word().map(f64::from_bits)
        }

        // Microsoft's is a double. MinGW passes a pointer to its own, which is taken for a number here.
        fn long_real(&mut self) -> Option<f64> {
            self.real()
        }

        fn text(&mut self, address: u64, most: usize) -> Option<Vec<u8>> {
            text_at(address, most)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::VecDeque;

    enum Given {
        Word(u64),
        Real(f64),
    }

    struct List(VecDeque<Given>);

    impl Arguments for List {
        fn word(&mut self) -> Option<u64> {
            match self.0.pop_front() {
                Some(Given::Word(w)) => Some(w),
                _ => None,
            }
        }
        fn real(&mut self) -> Option<f64> {
            match self.0.pop_front() {
                Some(Given::Real(x)) => Some(x),
                _ => None,
            }
        }
        fn long_real(&mut self) -> Option<f64> {
            self.real()
        }
        fn text(&mut self, address: u64, most: usize) -> Option<Vec<u8>> {
            (address == 7).then(|| b"belt"[..most.min(4)].to_vec())
        }
    }

    fn with(text: &str, given: Vec<Given>) -> String {
        format(text, &mut List(given.into()))
    }

    #[test]
    fn directives_take_their_arguments() {
        use Given::{Real, Word};
        assert_eq!(with("%s: %5.2f%%", vec![Word(7), Real(2.71)]), "belt:  2.71%");
        assert_eq!(with("%d %i %u", vec![Word(u64::MAX), Word(3), Word(u64::MAX)]), "-1 3 4294967295");
        assert_eq!(with("%ld %hhd %#x", vec![Word(u64::MAX), Word(0x1ff), Word(255)]), "-1 -1 0xff");
        assert_eq!(with("[%-6s|%6s|%.2s]", vec![Word(7), Word(7), Word(7)]), "[belt  |  belt|be]");
        assert_eq!(with("%*d|%-*d|", vec![Word(4), Word(1), Word(4), Word(2)]), "   1|2   |");
        assert_eq!(with("%e %g %c", vec![Real(0.5), Real(1e-7), Word(65)]), "5.000000e-01 1e-07 A");
        assert_eq!(with("%s", vec![Word(0)]), "(null)");
    }

    #[test]
    fn exponents_have_two_digits_where_two_are_enough() {
        for (old, new) in
            [("1e-007", "1e-07"), ("-5.25E+010", "-5.25E+10"), ("1e+100", "1e+100"), ("1e-07", "1e-07")]
        {
            assert_eq!(two_digits_of_exponent(old.into()), new);
        }
        assert_eq!(two_digits_of_exponent("0.5".into()), "0.5");
    }

    #[test]
    fn what_cannot_be_read_stands_as_it_is() {
        for text in ["%s", "%d of %f", "50 % sure", "%", "%k", "%*d", "%1$s"] {
            assert_eq!(format(text, &mut Nothing), text);
        }
        assert_eq!(with("%s", vec![Given::Word(8)]), "%s");
        // nothing is written, nothing is as wide as that
        assert_eq!(with("a%nb", vec![Given::Word(8)]), "ab");
        assert_eq!(with("%999999999d", vec![Given::Word(1)]).len(), WIDEST as usize);
        assert_eq!(with("%.999999999f", vec![Given::Real(f64::MAX)]).len(), 309 + 1 + WIDEST as usize);
        let many = "%d".repeat(100_000);
        assert_eq!(format(&many, &mut Nothing), many);
    }
}
