//! The one error type of the library.

use crate::shown::one_line;
use std::fmt;

/// What went wrong, where and what to do: a sentence that the user reads as it stands.
///
/// The [`kind`](Error::kind) is for programs (exit codes, FMI status), the message for people.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Error {
    kind: ErrorKind,
    message: String,
}

/// The area that an [`Error`] belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorKind {
    /// A variable: unknown name, wrong type, value outside its range or not finite.
    Variable,
    /// A call in the wrong order, or a time that does not fit.
    Call,
    /// The numbers: no stationary state, a state that left the model's validity.
    Numeric,
    /// A file or its content.
    File,
    /// An FMU: its archive, description or binary.
    Fmu,
}

/// `std::result::Result` with this crate's [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// An error of `kind` with the sentence `message`.
    ///
    /// The sentence may quote whatever a file or an FMU says: it becomes one line without control characters, and
    /// without its middle if it is very long.
    pub fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        Self { kind, message: one_line(&message.into()) }
    }

    /// See [`ErrorKind::Variable`].
    pub fn variable(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Variable, message)
    }

    /// See [`ErrorKind::Call`].
    pub fn call(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Call, message)
    }

    /// See [`ErrorKind::Numeric`].
    pub fn numeric(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Numeric, message)
    }

    /// See [`ErrorKind::File`].
    pub fn file(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::File, message)
    }

    /// See [`ErrorKind::Fmu`].
    pub fn fmu(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Fmu, message)
    }

    /// The area that the error belongs to.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }

    /// The same error with `place: ` in front of its message.
    #[must_use]
    pub fn at(self, place: impl fmt::Display) -> Self {
        Self { message: one_line(&format!("{place}: {}", self.message)), ..self }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Error {}
