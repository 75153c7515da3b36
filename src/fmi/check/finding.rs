//! [`Finding`]: what is wrong with an FMU, printed like a compiler's diagnostics.

use super::rules::{Rule, rule};
use crate::fmi::import::xml;
use crate::shown::{one_line, visible};
use serde::Serialize;
use std::fmt::Write;

/// How bad a finding is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Level {
    /// The standard allows it or is silent, but masters may stumble over it; or it only shows when a master
    /// does what the standard forbids to masters.
    Warning,
    /// The standard forbids it.
    Error,
}

/// Where a finding is.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum Place {
    /// In modelDescription.xml.
    Xml {
        /// From 1.
        line: usize,
        /// In characters, from 1.
        column: usize,
        /// The line, or the part of a long line that the column is in.
        excerpt: String,
        /// What to underline of the excerpt: first character, from 0, and how many.
        mark: (usize, usize),
    },
    /// An entry of the archive.
    Entry {
        /// Its name.
        entry: String,
    },
}

/// Something that is wrong with an FMU.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// Name of the rule, such as "X10"; [`RULES`](super::RULES) holds all.
    pub rule: &'static str,
    /// How bad it is.
    pub level: Level,
    /// Where the rule is written, such as "FMI 2.0.5, 2.2.8".
    pub citation: &'static str,
    /// Where it is; `None` if it shows when the FMU is run.
    pub place: Option<Place>,
    /// What is wrong: a sentence.
    pub what: String,
    /// What to do: a sentence.
    pub help: &'static str,
    /// Where else it is: one finding has one cause, which often shows at many variables, calls or entries.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub also: Vec<Also>,
}

/// Another place of a finding.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Also {
    /// As in [`Finding::place`].
    pub place: Option<Place>,
    /// As in [`Finding::what`].
    pub what: String,
}

/// So many further places of a finding are printed.
const SHOWN: usize = 3;
/// Excerpts are no longer than this.
const EXCERPT: usize = 96;

impl Place {
    /// The place in the XML with `length` characters marked.
    pub(super) fn xml(place: &xml::Place, length: usize) -> Self {
        let (line, column) = place.position();
        // no more than an excerpt can need, as a line may be as long as the file
        let (before, after) = place.around(EXCERPT + 1);
        let at = before.chars().count();
        let characters: Vec<char> = before.chars().chain(after.chars()).map(visible).collect();
        // Long lines are cut to a window around the place.
        let from = if characters.len() <= EXCERPT { 0 } else { at.saturating_sub(EXCERPT / 3) };
        let to = (from + EXCERPT).min(characters.len());
        let mut excerpt = String::new();
        let mut shift = 0;
        if from > 0 {
            excerpt += "...";
            shift = 3;
        }
        excerpt.extend(&characters[from..to]);
        if to < characters.len() {
            excerpt += "...";
        }
        let first = at - from + shift;
        Self::Xml { line, column, excerpt, mark: (first, length.clamp(1, (to - at.min(to)).max(1))) }
    }

    /// The tag of an element.
    pub(super) fn tag(element: &xml::Element) -> Self {
        Self::xml(&element.place(), element.name().chars().count() + 1)
    }

    /// An attribute of an element, or its tag if it has no such attribute.
    pub(super) fn attribute(element: &xml::Element, name: &str) -> Self {
        match element.attributes().iter().find(|a| a.name == name) {
            Some(a) => Self::xml(&a.place, name.chars().count() + a.value.chars().count() + 3),
            None => Self::tag(element),
        }
    }

    /// An entry of the archive.
    pub(super) fn entry(name: impl Into<String>) -> Self {
        Self::Entry { entry: name.into() }
    }
}

impl Finding {
    /// A finding about the rule called `name`, which has to be in the table of rules.
    pub(super) fn new(level: Level, name: &str, place: Option<Place>, what: impl Into<String>) -> Self {
        let Rule { name, citation, help, .. } = *rule(name);
        Self { rule: name, level, citation, place, what: one_line(&what.into()), help, also: Vec::new() }
    }

    pub(super) fn error(name: &str, place: Option<Place>, what: impl Into<String>) -> Self {
        Self::new(Level::Error, name, place, what)
    }

    pub(super) fn warning(name: &str, place: Option<Place>, what: impl Into<String>) -> Self {
        Self::new(Level::Warning, name, place, what)
    }

    /// The finding as several lines of text.
    pub fn as_text(&self) -> String {
        let level = match self.level {
            Level::Error => "error",
            Level::Warning => "warning",
        };
        let mut text = format!("{level}[{}]: {}\n", self.rule, self.what);
        let mut margin = String::new();
        match &self.place {
            Some(Place::Xml { line, column, excerpt, mark }) => {
                let number = line.to_string();
                margin = " ".repeat(number.len());
                let _ = writeln!(text, "{margin}--> modelDescription.xml:{line}:{column}");
                let _ = writeln!(text, "{margin} |\n{number} | {excerpt}");
                let _ = writeln!(text, "{margin} | {}{}", " ".repeat(mark.0), "^".repeat(mark.1));
            }
            Some(Place::Entry { entry }) => {
                let _ = writeln!(text, " --> {}", one_line(entry));
            }
            None => {}
        }
        for Also { place, what } in self.also.iter().take(SHOWN) {
            let place = match place {
                Some(Place::Xml { line, column, .. }) => format!("modelDescription.xml:{line}:{column}: "),
                Some(Place::Entry { entry }) => format!("{entry}: "),
                None => String::new(),
            };
            let _ = writeln!(text, "{margin} = also: {place}{what}");
        }
        if self.also.len() > SHOWN {
            let more = self.also.len() - SHOWN;
            let _ = writeln!(text, "{margin} = also: {more} more (all with --format json)");
        }
        let _ = writeln!(text, "{margin} = note: {}", self.citation);
        let _ = writeln!(text, "{margin} = help: {}", self.help);
        text
    }
}

/// Findings that say the same of other variables, messages, numbers or calls have one cause: the first of
/// them keeps the others' places.
pub(super) fn group(findings: Vec<Finding>) -> Vec<Finding> {
    let mut groups: Vec<(String, Finding)> = Vec::new();
    for finding in findings {
        let shape = shape(&finding);
        let same = |(s, f): &&mut (String, Finding)| {
            *s == shape && f.rule == finding.rule && f.level == finding.level
        };
        match groups.iter_mut().find(same) {
            Some((_, first)) => first.also.push(Also { place: finding.place, what: finding.what }),
            None => groups.push((shape, finding)),
        }
    }
    groups.into_iter().map(|(_, finding)| finding).collect()
}

/// What a finding says, without what it says it of: texts in quotes and numbers. The rules on messages are
/// about what all calls share, so that there the name of the call is left out as well; elsewhere another call
/// is another cause.
fn shape(finding: &Finding) -> String {
    let messages = matches!(finding.rule, "L1" | "L3" | "L4" | "L5");
    let mut shape = String::new();
    for (i, part) in finding.what.split('"').enumerate() {
        if i % 2 == 1 {
            shape.push('"');
            continue;
        }
        for word in part.split_inclusive(' ') {
            let bare = word.trim_matches(|c: char| !c.is_ascii_alphanumeric() && !matches!(c, '-' | '.'));
            let number = bare.parse::<f64>().is_ok();
            let call = messages && bare.starts_with("fmi2") && !bare.starts_with("fmi2Error");
            shape.push_str(if number || call { "#" } else { word });
        }
    }
    shape
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_cause_is_one_finding() {
        let found = |rule: &str, what: &str| Finding::error(rule, None, what);
        let grouped = group(vec![
            found("X7", "\"k\" starts with 2.0 in the binary and with 2.5 in the description"),
            found("L1", "fmi2DoStep logs in the category \"a\", but none is declared"),
            found("X7", "\"m\" starts with -1e-3 in the binary and with inf in the description"),
            found("L1", "fmi2Reset logs in the category \"b\", but none is declared"),
            found("M1", "fmi2DoStep before the initialization returned fmi2OK"),
            found("M1", "fmi2Reset before the initialization returned fmi2OK"),
            Finding::warning("M1", None, "fmi2Reset before the initialization returned fmi2OK"),
        ]);
        assert_eq!(grouped.iter().map(|f| f.rule).collect::<Vec<_>>(), ["X7", "L1", "M1", "M1", "M1"]);
        assert_eq!(grouped.iter().map(|f| f.also.len()).collect::<Vec<_>>(), [1, 1, 0, 0, 0]);
        assert!(grouped[0].as_text().contains(" = also: \"m\" starts with"));
        let many = (0..10).map(|i| found("X7", &format!("\"k{i}\" is wrong"))).collect();
        let text = group(many)[0].as_text();
        assert_eq!(text.matches("= also:").count(), SHOWN + 1);
        assert!(text.contains("= also: 6 more"), "{text}");
    }

    #[test]
    fn looks_like_a_compilers() {
        let finding = Finding::error(
            "X7",
            Some(Place::Xml { line: 12, column: 3, excerpt: "  <Real/>".into(), mark: (2, 5) }),
            "the parameter \"k\" has no start value",
        );
        assert!(finding.also.is_empty());
        assert_eq!(
            finding.as_text(),
            format!(
                "error[X7]: the parameter \"k\" has no start value\n  --> modelDescription.xml:12:3\n   |\n\
                 12 |   <Real/>\n   |   ^^^^^\n   = note: FMI 2.0.5, 2.2.7\n   = help: {}\n",
                finding.help
            )
        );
        let finding = Finding::warning("Z2", Some(Place::entry("binaries/amiga/x.so")), "it is odd");
        assert!(finding.as_text().starts_with("warning[Z2]: it is odd\n --> binaries/amiga/x.so\n = note: "));
    }

    #[test]
    fn long_lines_are_cut() {
        let text = format!("<a>{}<b x=\"1\"/>{}</a>", " ".repeat(300), " ".repeat(300));
        let mut place = None;
        xml::read::<xml::Broken>(text.as_bytes(), |_, e| {
            if e.name() == "b" {
                place = Some(Place::attribute(e, "x"));
            }
            Ok(())
        })
        .unwrap_or_else(|b| panic!("{}", b.what));
        let Some(Place::Xml { line: 1, column, excerpt, mark }) = place else { panic!() };
        assert_eq!(column, 307);
        let marked: String = excerpt.chars().skip(mark.0).take(mark.1).collect();
        assert_eq!(marked, "x=\"1\"");
        assert!(excerpt.len() < 120);
    }
}
