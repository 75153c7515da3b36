//! [`Report`]: all that was found.

use super::finding::{Finding, Level};
use serde::Serialize;

/// What was found.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// In the order archive, description, binary.
    pub findings: Vec<Finding>,
    /// The checks of the binary that were run.
    pub checks: Vec<&'static str>,
    /// What was not checked, and why: sentences.
    pub notes: Vec<String>,
    /// The platforms that the archive has binaries for, such as "linux64", sorted.
    pub platforms: Vec<String>,
    /// The one whose binary was run.
    pub ran: Option<String>,
}

impl Report {
    /// How many findings are of this level.
    pub fn count(&self, level: Level) -> usize {
        self.findings.iter().filter(|f| f.level == level).count()
    }
}
