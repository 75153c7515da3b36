//! The sections of a TYDEX file and their lines.

use crate::{Error, Result};

/// All keywords. Sections of models are passed over.
const KEYWORDS: [&str; 12] = [
    "HEADER",
    "COMMENTS",
    "CONSTANTS",
    "MEASURCHANNELS",
    "MEASURDATA",
    "MODELDEFINITION",
    "MODELPARAMETERS",
    "MODELCOEFFICIENTS",
    "MODELCHANNELS",
    "MODELOUTPUTS",
    "MODELEND",
    "END",
];

/// A line that says something, without blanks at its end.
#[derive(Debug, Clone, Copy)]
pub struct Line<'a> {
    pub number: usize,
    pub text: &'a str,
}

/// A section: where it begins, and its lines.
#[derive(Debug)]
pub struct Section<'a> {
    keyword: &'static str,
    line: usize,
    /// How many lines the keyword's own line promises.
    count: Option<usize>,
    pub lines: Vec<Line<'a>>,
}

/// The sections of a file, in its order.
pub struct Sections<'a> {
    source: &'a str,
    sections: Vec<Section<'a>>,
}

impl<'a> Sections<'a> {
    /// Splits a text. Blank lines and lines with `!` in front say nothing.
    ///
    /// # Errors
    /// A text that does not begin with `**HEADER` or does not end with `**END`, an unknown keyword, a section twice.
    pub fn of(text: &'a str, source: &'a str) -> Result<Self> {
        let mut sections: Vec<Section<'a>> = Vec::new();
        for (i, text) in lines(text).enumerate() {
            let number = i + 1;
            let fail = |what: String| Err(Error::file(format!("{source}:{number}: {what}")));
            let text = text.trim_end_matches(is_blank);
            let said = text.trim_start();
            if said.is_empty() || said.starts_with('!') {
                continue;
            }
            if let Some(line) = said.strip_prefix("**") {
                let (word, count) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
                let Some(keyword) = KEYWORDS.iter().find(|known| known.eq_ignore_ascii_case(word)) else {
                    return fail(format!(
                        "**{word} is no keyword of TYDEX; these are {}",
                        KEYWORDS.join(", ")
                    ));
                };
                if let Some(first) = sections.iter().find(|section| section.keyword == *keyword) {
                    return fail(format!(
                        "**{keyword} stands in line {}, too; a file holds one measurement",
                        first.line
                    ));
                }
                let count = count.trim().parse().ok();
                sections.push(Section { keyword, line: number, count, lines: Vec::new() });
                continue;
            }
            match sections.last_mut() {
                None => return fail("this is no TYDEX file: the first line has to be **HEADER".into()),
                Some(Section { keyword: "END", .. }) => {
                    return fail("there is something behind **END; a file holds one measurement".into());
                }
                Some(section) => section.lines.push(Line { number, text }),
            }
        }
        if sections.first().is_none_or(|first| first.keyword != "HEADER") {
            return Err(Error::file(format!(
                "{source}: this is no TYDEX file: it does not begin with **HEADER"
            )));
        }
        if sections.last().is_none_or(|last| last.keyword != "END") {
            return Err(Error::file(format!(
                "{source}: the file does not end with **END: it has been cut off, or the line is missing"
            )));
        }
        Ok(Self { source, sections })
    }

    /// The lines of a section, none if it is not there.
    pub fn lines(&self, keyword: &str) -> &[Line<'a>] {
        self.sections.iter().find(|s| s.keyword == keyword).map_or(&[], |section| &section.lines)
    }

    /// The lines of a section that a recording cannot do without.
    ///
    /// # Errors
    /// There is none; or not as many lines as its keyword's line promises.
    pub fn needed(&self, keyword: &str, what: &str) -> Result<&[Line<'a>]> {
        let Some(section) = self.sections.iter().find(|s| s.keyword == keyword) else {
            return Err(Error::file(format!(
                "{}: there is no **{keyword}, the section with {what}",
                self.source
            )));
        };
        let found = section.lines.len();
        match section.count.filter(|count| *count != found) {
            None => Ok(&section.lines),
            Some(count) => Err(Error::file(format!(
                "{}:{}: **{keyword} says that {count} lines follow, but {found} do: is something missing?",
                self.source, section.line
            ))),
        }
    }
}

/// The lines of a text as an editor counts them.
fn lines(text: &str) -> impl Iterator<Item = &str> {
    text.split('\n').flat_map(|line| line.strip_suffix('\r').unwrap_or(line).split('\r'))
}

/// What is as good as nothing at a line's end: a file of DOS may end in the sign for its end.
fn is_blank(c: char) -> bool {
    c.is_whitespace() || c == '\u{1a}'
}
