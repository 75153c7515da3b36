//! What the process of a case says to the process that started it: lines of JSON, and files in a folder of both.

use super::finding::Level;
use serde::{Deserialize, Serialize};
use std::collections::HashSet;
use std::fs::File;
use std::io::Write;
use std::sync::{Mutex, PoisonError};

/// The file for the name of the current call.
pub(super) const CALL: &str = "call";
/// A file with this name says that unknown value references crash the FMU.
pub(super) const FRAGILE: &str = "fragile";
/// Where the code's standard output goes.
pub(super) const STDOUT: &str = "stdout";
/// Where the code's standard error goes.
pub(super) const STDERR: &str = "stderr";

/// A finding on its way to the parent process, which adds citation and place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Found {
    pub(super) rule: String,
    pub(super) level: Level,
    pub(super) what: String,
    /// The variable that it is about.
    pub(super) variable: Option<String>,
    /// The attribute of CoSimulation that it is about.
    pub(super) attribute: Option<String>,
}

/// A line from this process.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Line {
    /// Something is wrong.
    Found(Found),
    /// Something could not be checked, or nothing else makes sense.
    Stop(String),
    /// The case is through.
    Done,
}

/// Writes findings to the parent.
pub(super) struct Reporter {
    out: Mutex<File>,
    told: Mutex<HashSet<String>>,
}

impl Reporter {
    /// Writes to this file.
    pub(super) fn new(out: File) -> Self {
        Self { out: Mutex::new(out), told: Mutex::default() }
    }

    pub(super) fn send(&self, line: &Line) {
        let Ok(mut text) = serde_json::to_vec(line) else { return };
        text.push(b'\n');
        // If nobody listens any more, there is nobody to tell.
        let _ = self.out.lock().unwrap_or_else(PoisonError::into_inner).write_all(&text);
    }

    /// Sends a finding, once.
    pub(super) fn found(&self, found: Found) {
        let new = self
            .told
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .insert(format!("{} {}", found.rule, found.what));
        if new {
            self.send(&Line::Found(found));
        }
    }

    pub(super) fn report(&self, level: Level, rule: &str, what: impl Into<String>) {
        self.found(Found { rule: rule.into(), level, what: what.into(), variable: None, attribute: None });
    }

    pub(super) fn error(&self, rule: &str, what: impl Into<String>) {
        self.report(Level::Error, rule, what);
    }

    pub(super) fn warning(&self, rule: &str, what: impl Into<String>) {
        self.report(Level::Warning, rule, what);
    }

    /// Nothing can be checked after this.
    pub(super) fn stop(&self, why: impl Into<String>) {
        self.send(&Line::Stop(why.into()));
    }
}
