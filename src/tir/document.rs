//! The text of a tire property file without loss, and where its values are.

use crate::{Error, Result};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::ops::Range;

/// The most bytes that a tire property file may have: a hundred times the longest that is met.
pub const MAX_BYTES: usize = 16 << 20;

/// The most assignments that a tire property file may have: thirty times as many as a file of MF-Tire 6.2 has.
pub const MAX_ENTRIES: usize = 10_000;

/// The most notes that are kept; of a file that deserves more, the rest is counted.
const MAX_NOTES: usize = 50;

/// A tire property file: its bytes, and where the assignments in them are.
///
/// Grammar: a line is a section `[NAME]`, a subsection `(NAME)`, the header of a table `{name name}`, an assignment
/// `KEY = value`, a row of a table, a comment or blank. `$` and `!` begin a comment, also behind a value. Lines end with
/// CR LF, LF or CR. Names of sections and keys do not depend on capitals. What is none of this is kept as it is, with a
/// note.
#[derive(Debug, Clone, PartialEq)]
pub struct Document {
    name: String,
    bytes: Vec<u8>,
    sections: Vec<String>,
    items: Vec<Item>,
    /// The items with this section and key, in the order of the file.
    index: BTreeMap<(String, String), Vec<usize>>,
    /// The sections that have rows of numbers.
    tables: Vec<usize>,
    notes: Vec<Note>,
    left_out: usize,
}

/// Something about a file that its reader should know, but that does not make it unusable.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Note {
    /// Line in the file, from 1; 0 if it concerns no single line.
    pub line: usize,
    /// One sentence.
    pub message: String,
}

/// An assignment.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry<'a> {
    /// Section in capitals, without brackets; empty before the first one.
    pub section: &'a str,
    /// Key in capitals.
    pub key: &'a str,
    /// Line in the file, from 1.
    pub line: usize,
    /// What is assigned.
    pub value: Value,
}

/// What is assigned to a key.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// Nothing, not even quotes.
    Empty,
    /// A number as it stands in the file, in the file's units. It may be infinite if the file has one like 1e999.
    Number(f64),
    /// Text between quotes, without blanks at its ends.
    Text(String),
    /// Anything else.
    Word(String),
}

/// A line of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Row<'a> {
    /// Line in the file, from 1.
    pub line: usize,
    /// The subsection that it stands in, in capitals without brackets; empty in none.
    pub table: String,
    /// The line without comment and blanks at its ends.
    pub text: &'a [u8],
    /// Where the line begins, and where the next one does.
    range: Range<usize>,
}

#[derive(Debug, Clone, PartialEq)]
struct Item {
    line: usize,
    section: usize,
    key: String,
    /// The bytes of the value, quotes included; empty where a value would have to be inserted.
    value: Range<usize>,
    /// Where the next line begins.
    next: usize,
}

/// Sections that a note names at most.
const MANY: usize = 20;

impl Document {
    /// The document that `bytes` hold. `name` is what messages call the file.
    ///
    /// # Errors
    /// More than [`MAX_BYTES`] or [`MAX_ENTRIES`]; no section with an assignment, which no tire property file is.
    pub fn parse(bytes: impl Into<Vec<u8>>, name: &str) -> Result<Self> {
        let bytes = bytes.into();
        if bytes.len() > MAX_BYTES {
            return Err(Error::file(format!(
                "{name}: it has more than {} MB, the most that is read of a tire property file",
                MAX_BYTES >> 20
            )));
        }
        let mut document = Self {
            name: name.to_string(),
            bytes,
            sections: vec![String::new()],
            items: Vec::new(),
            index: BTreeMap::new(),
            tables: Vec::new(),
            notes: Vec::new(),
            left_out: 0,
        };
        document.scan()?;
        if document.items.iter().all(|item| item.section == 0) {
            return Err(Error::file(format!(
                "{name}: it has no section such as [MODEL] with assignments such as FITTYP = 6, so it is no tire \
                 property file"
            )));
        }
        Ok(document)
    }

    /// The bytes of the file.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// What messages call the file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What the reader of the file should know; at most some dozens, the last one counts the rest.
    pub fn notes(&self) -> Vec<Note> {
        let mut notes = self.notes.clone();
        if self.left_out > 0 {
            notes.push(Note {
                line: 0,
                message: format!("{} more notes on this file are left out", self.left_out),
            });
        }
        notes
    }

    /// The names of the sections in the order of the file, in capitals.
    pub fn sections(&self) -> impl Iterator<Item = &str> {
        self.sections.iter().skip(1).map(String::as_str)
    }

    /// The names of the sections that have rows of numbers, each once, in capitals.
    pub(crate) fn tables(&self) -> BTreeSet<&str> {
        self.tables.iter().filter_map(|i| self.sections.get(*i)).map(String::as_str).collect()
    }

    /// A note on the sections whose rows no tire uses, but for those that are `told` elsewhere.
    pub(super) fn unused_tables(&self, told: &[&str]) -> Option<String> {
        let others: Vec<String> = self
            .tables()
            .into_iter()
            .filter(|section| !told.contains(section))
            .map(|section| format!("[{section}]"))
            .collect();
        let more = if others.len() > MANY { ", ..." } else { "" };
        let first = others.get(..MANY).unwrap_or(&others).join(", ");
        (!others.is_empty()).then(|| format!("{}: rows that are not used stand in {first}{more}", self.name))
    }

    /// Notes on keys that no tire uses, given as `[SECTION] KEY`.
    pub(super) fn unused_keys(&self, unused: &[String]) -> Vec<String> {
        let keys = unused.iter().filter_map(|entry| entry.strip_prefix('[')?.split_once("] "));
        let sections = by_section(keys);
        let note = |(section, keys): &(&str, String)| {
            format!("{}: [{section}] has {} that the model does not use: {keys}", self.name, counted(keys))
        };
        let mut notes: Vec<String> = sections.iter().take(MANY).map(note).collect();
        if sections.len() > MANY {
            notes.push(format!("{}: so have {} sections more", self.name, sections.len() - MANY));
        }
        notes
    }

    /// All assignments in the order of the file.
    pub fn entries(&self) -> impl Iterator<Item = Entry<'_>> {
        self.items.iter().map(|item| self.entry(item))
    }

    /// All assignments to `key` in `section`, in the order of the file; capitals do not matter.
    pub fn all(&self, section: &str, key: &str) -> Vec<Entry<'_>> {
        self.found(section, key)
            .iter()
            .filter_map(|i| self.items.get(*i))
            .map(|item| self.entry(item))
            .collect()
    }

    /// The first assignment to `key` in `section`; capitals do not matter.
    pub fn get(&self, section: &str, key: &str) -> Option<Entry<'_>> {
        let item = self.items.get(*self.found(section, key).first()?)?;
        Some(self.entry(item))
    }

    /// The text of a key in its own capitals, with its line; `None` where it is none.
    pub(crate) fn word(&self, section: &str, key: &str) -> Option<(String, usize)> {
        match self.get(section, key)? {
            Entry { value: Value::Text(text) | Value::Word(text), line, .. } => Some((text, line)),
            _ => None,
        }
    }

    /// The assignment to a key that messages call `called`.
    ///
    /// # Errors
    /// It stands there several times with different values.
    pub(crate) fn only(&self, section: &str, key: &str, called: &str) -> Result<Option<Entry<'_>>> {
        let all = self.all(section, key);
        let Some(entry) = all.first() else { return Ok(None) };
        match all.iter().find(|other| other.value != entry.value) {
            None => Ok(Some(entry.clone())),
            Some(other) => Err(Error::file(format!(
                "{}: {called} has another value than in line {}; leave one of them out",
                self.place(other.line),
                entry.line
            ))),
        }
    }

    /// The number of an assignment that messages call `called`, in the units of the file; `None` where nothing is assigned.
    ///
    /// # Errors
    /// A text, or a number that is too large.
    pub(crate) fn number(&self, entry: &Entry<'_>, called: &str) -> Result<Option<f64>> {
        let place = self.place(entry.line);
        match &entry.value {
            Value::Number(number) if number.is_finite() => Ok(Some(*number)),
            Value::Empty => Ok(None),
            Value::Number(_) => Err(Error::file(format!("{place}: {called} is too large for a number"))),
            Value::Text(text) | Value::Word(text) => Err(Error::file(format!(
                "{place}: {called} is '{}', which is no number",
                shown(text.as_bytes())
            ))),
        }
    }

    /// The notes as sentences with their places.
    pub(crate) fn told(&self) -> impl Iterator<Item = String> {
        self.notes().into_iter().map(|note| match note.line {
            0 => format!("{}: {}", self.name, note.message),
            line => format!("{}: {}", self.place(line), note.message),
        })
    }

    /// The lines of a section that are neither assignments nor headers, comments or quoted texts: the rows of its tables, and
    /// whatever else stands there. Capitals of the name do not matter.
    pub fn rows<'a>(&'a self, section: &str) -> impl Iterator<Item = Row<'a>> {
        let wanted = section.to_ascii_uppercase();
        let (mut inside, mut table) = (false, String::new());
        lines(&self.bytes).filter_map(move |(line, range, next)| {
            let start = range.start;
            let text = self.bytes.get(trimmed(&self.bytes, range)).unwrap_or_default();
            match text.first() {
                Some(b'[') => {
                    let name = text.get(1..text.iter().position(|b| *b == b']')?).unwrap_or_default();
                    inside = upper(name.trim_ascii()) == wanted;
                    table.clear();
                    return None;
                }
                Some(b'(') => {
                    let end = text.iter().position(|b| *b == b')').unwrap_or(text.len());
                    table = upper(text.get(1..end).unwrap_or_default().trim_ascii());
                    return None;
                }
                None | Some(b'$' | b'!' | b'{' | b'\'') => return None,
                Some(_) => {}
            }
            let text = text.get(..comment_start(text)).unwrap_or_default().trim_ascii();
            let is_row = inside && !text.is_empty() && !text.contains(&b'=');
            is_row.then(|| Row { line, table: table.clone(), text, range: start..next })
        })
    }

    /// Puts other lines in the place of the rows of a table, from its first row to its last; what stands between and behind them
    /// goes, too. Returns whether that were more than rows: comments, say.
    ///
    /// # Errors
    /// The table has no rows; the document would become too long.
    pub fn set_rows(&mut self, section: &str, table: &str, rows: &str) -> Result<bool> {
        let of_table = || self.rows(section).filter(|row| row.table == table);
        let in_rows: usize = of_table().map(|row| visible(row.text)).sum();
        let found: Vec<Range<usize>> = of_table().map(|row| row.range).collect();
        let (Some(first), Some(last)) = (found.first(), found.last()) else {
            return Err(Error::file(format!("{}: [{section}] has no rows to replace", self.name)));
        };
        let replaced = self.bytes.get(first.start..last.end).unwrap_or_default();
        let more = visible(replaced) > in_rows;
        let end_of_line = self.end_of_line();
        let mut bytes = self.bytes.get(..first.start).unwrap_or_default().to_vec();
        for row in rows.lines() {
            bytes.extend_from_slice(row.as_bytes());
            bytes.extend_from_slice(end_of_line.as_bytes());
        }
        bytes.extend_from_slice(self.bytes.get(last.end..).unwrap_or_default());
        *self = Self::parse(bytes, &self.name)?;
        Ok(more)
    }

    /// Where a line is: `file.tir:12`.
    pub fn place(&self, line: usize) -> String {
        format!("{}:{line}", self.name)
    }

    /// Writes a number to `key` in `section`, in the units of the file, wherever the key stands there. Nothing but the
    /// value changes. A key that is missing gets a line at the end of its section, a section that is missing is added at
    /// the end of the file.
    ///
    /// # Errors
    /// The number is not finite; the names are no names of a section and a key; the file would become too long.
    pub fn set_number(&mut self, section: &str, key: &str, value: f64) -> Result<()> {
        let text = number_text(value).ok_or_else(|| {
            Error::file(format!(
                "{}: {key} cannot become {value}, a file holds finite numbers only",
                self.name
            ))
        })?;
        self.set_all(&[(section.to_string(), key.to_string(), text)])
    }

    /// As [`set_number`](Self::set_number), for a text, which is put between quotes.
    ///
    /// # Errors
    /// The text has a quote or a line break, for which the format has no way of writing; as there.
    pub fn set_text(&mut self, section: &str, key: &str, value: &str) -> Result<()> {
        if value.contains(['\'', '\n', '\r']) {
            return Err(Error::file(format!(
                "{}: {key} cannot become a text with a quote or a line break; leave them out",
                self.name
            )));
        }
        self.set_all(&[(section.to_string(), key.to_string(), format!("'{value}'"))])
    }

    /// Sets several (section, key, text of the value) at once.
    pub(super) fn set_all(&mut self, values: &[(String, String, String)]) -> Result<()> {
        let mut edits: Vec<(Range<usize>, String)> = Vec::new();
        let mut new_sections: Vec<(String, String)> = Vec::new();
        let end_of_line = self.end_of_line();
        for (section, key, text) in values {
            if !is_name(section.as_bytes()) || !is_name(key.as_bytes()) {
                return Err(Error::file(format!(
                    "{}: '{}' in [{}] is no name of a key; use letters, digits and underscores",
                    self.name,
                    shown(key.as_bytes()),
                    shown(section.as_bytes())
                )));
            }
            let found = self.found(section, key);
            for item in found.iter().filter_map(|i| self.items.get(*i)) {
                edits.push((item.value.clone(), text.clone()));
            }
            if !found.is_empty() {
                continue;
            }
            let line = format!("{:<24} = {text}{end_of_line}", key.to_ascii_uppercase());
            let wanted = section.to_ascii_uppercase();
            let last = self.items.iter().rev().find(|item| self.sections.get(item.section) == Some(&wanted));
            if let Some(item) = last {
                let line = if item.next == self.bytes.len() && !ends_line(&self.bytes) {
                    format!("{end_of_line}{line}")
                } else {
                    line
                };
                edits.push((item.next..item.next, line));
            } else if let Some((_, lines)) = new_sections.iter_mut().find(|(name, _)| *name == wanted) {
                lines.push_str(&line);
            } else {
                new_sections.push((wanted, line));
            }
        }
        // stable: what is inserted at one place stays in the order of `values`
        edits.sort_by_key(|(range, _)| range.start);
        let mut bytes = Vec::with_capacity(self.bytes.len() + 64 * edits.len());
        let mut done = 0;
        for (range, text) in &edits {
            bytes.extend_from_slice(self.bytes.get(done..range.start).unwrap_or_default());
            bytes.extend_from_slice(text.as_bytes());
            done = range.end;
        }
        bytes.extend_from_slice(self.bytes.get(done..).unwrap_or_default());
        for (section, lines) in new_sections {
            if !ends_line(&bytes) {
                bytes.extend_from_slice(end_of_line.as_bytes());
            }
            bytes.extend_from_slice(format!("[{section}]{end_of_line}{lines}").as_bytes());
        }
        *self = Self::parse(bytes, &self.name)?;
        Ok(())
    }

    fn found(&self, section: &str, key: &str) -> &[usize] {
        let name = (section.to_ascii_uppercase(), key.to_ascii_uppercase());
        self.index.get(&name).map(Vec::as_slice).unwrap_or_default()
    }

    fn entry<'a>(&'a self, item: &'a Item) -> Entry<'a> {
        let text = self.bytes.get(item.value.clone()).unwrap_or_default();
        Entry {
            section: self.sections.get(item.section).map(String::as_str).unwrap_or_default(),
            key: &item.key,
            line: item.line,
            value: value_of(text),
        }
    }

    /// How the first line ends; LF if there is but one line.
    fn end_of_line(&self) -> &'static str {
        match self.bytes.iter().position(|b| *b == b'\r' || *b == b'\n') {
            Some(i) if self.bytes.get(i) == Some(&b'\n') => "\n",
            Some(i) if self.bytes.get(i + 1) == Some(&b'\n') => "\r\n",
            Some(_) => "\r",
            None => "\n",
        }
    }

    /// The message is made only if it is kept: a file may deserve millions.
    fn note(&mut self, line: usize, message: impl FnOnce() -> String) {
        if self.notes.len() < MAX_NOTES {
            self.notes.push(Note { line, message: message() });
        } else {
            self.left_out += 1;
        }
    }

    /// Goes through the bytes once.
    fn scan(&mut self) -> Result<()> {
        let bytes = std::mem::take(&mut self.bytes);
        for (line, range, next) in lines(&bytes) {
            self.scan_line(&bytes, range, next, line)?;
        }
        self.bytes = bytes;
        let doubles: Vec<(usize, String)> = self
            .index
            .iter()
            .filter(|(_, items)| items.len() > 1)
            .map(|((section, key), items)| {
                let lines: Vec<String> =
                    items.iter().filter_map(|i| self.items.get(*i)).map(|i| i.line.to_string()).collect();
                let last = items.last().and_then(|i| self.items.get(*i)).map_or(0, |i| i.line);
                let mut lines = lines.join(", ");
                lines.truncate(100);
                (last, format!("{key} stands more than once in [{section}], in the lines {lines}"))
            })
            .collect();
        for (line, message) in doubles {
            self.note(line, || message);
        }
        Ok(())
    }

    fn scan_line(&mut self, bytes: &[u8], range: Range<usize>, next: usize, line: usize) -> Result<()> {
        let range = trimmed(bytes, range);
        let text = bytes.get(range.clone()).unwrap_or_default();
        match text.first() {
            // blank, comment, header of a table, line of a text table
            None | Some(b'$' | b'!' | b'{' | b'\'') => {}
            Some(b'[') => {
                let close = text.iter().position(|b| *b == b']');
                let name = text.get(1..close.unwrap_or(comment_start(text))).unwrap_or_default();
                let name = name.trim_ascii();
                if close.is_none() || !is_name(name) {
                    self.note(line, || {
                        format!("'{}' begins a section, but has no name in brackets: [NAME]", shown(text))
                    });
                }
                if self.sections.len() > MAX_ENTRIES {
                    return Err(self.too_many("sections"));
                }
                self.sections.push(upper(name));
            }
            // a subsection holds a table, its keys count to the section
            Some(b'(') => {
                if !text.contains(&b')') {
                    self.note(line, || "a subsection has no closing bracket: (NAME)".to_string());
                }
            }
            Some(_) => {
                let code = text.get(..comment_start(text)).unwrap_or_default();
                if let Some(equals) = code.iter().position(|b| *b == b'=') {
                    let key = code.get(..equals).unwrap_or_default().trim_ascii();
                    if !is_name(key) {
                        self.note(line, || {
                            format!("'{}' is no name of a key; the line is kept, not used", shown(key))
                        });
                        return Ok(());
                    }
                    let from = range.start + equals + 1;
                    let value = self.scan_value(bytes, from..range.end, line);
                    if self.items.len() >= MAX_ENTRIES {
                        return Err(self.too_many("assignments"));
                    }
                    let section = self.sections.len() - 1;
                    let key = upper(key);
                    let name = (self.sections.last().cloned().unwrap_or_default(), key.clone());
                    self.index.entry(name).or_default().push(self.items.len());
                    self.items.push(Item { line, section, key, value, next });
                } else if !code.split(u8::is_ascii_whitespace).all(|w| w.is_empty() || number(w).is_some()) {
                    self.note(line, || {
                        format!(
                            "'{}' is no assignment, table or comment; the line is kept, not used",
                            shown(code)
                        )
                    });
                } else if self.tables.last() != Some(&(self.sections.len() - 1)) {
                    self.tables.push(self.sections.len() - 1);
                }
            }
        }
        Ok(())
    }

    /// Where the value is that begins somewhere in `range`, a line from behind its equals sign.
    fn scan_value(&mut self, bytes: &[u8], range: Range<usize>, line: usize) -> Range<usize> {
        let range = trimmed(bytes, range);
        let text = bytes.get(range.clone()).unwrap_or_default();
        let length = match text.first() {
            Some(quote @ (b'\'' | b'"')) => match text.iter().skip(1).position(|b| b == quote) {
                Some(inside) => {
                    let end = inside + 2;
                    let tail = text.get(end..).unwrap_or_default().trim_ascii();
                    if !matches!(tail.first(), None | Some(b'$' | b'!')) {
                        self.note(line, || {
                            format!("'{}' follows a text in quotes; it is ignored", shown(tail))
                        });
                    }
                    end
                }
                None => {
                    self.note(line, || "a text has no closing quote".to_string());
                    comment_start(text)
                }
            },
            _ => comment_start(text),
        };
        trimmed(bytes, range.start..range.start + length)
    }

    fn too_many(&self, what: &str) -> Error {
        Error::file(format!(
            "{}: it has more than {MAX_ENTRIES} {what}; no tire property file is that long",
            self.name
        ))
    }
}

/// The lines of a file: number from 1, where they are, and where the next one begins.
fn lines(bytes: &[u8]) -> impl Iterator<Item = (usize, Range<usize>, usize)> {
    let mut start = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
    let mut line = 0;
    std::iter::from_fn(move || {
        let rest = bytes.get(start..).filter(|rest| !rest.is_empty())?;
        line += 1;
        let begin = start;
        let end = begin + rest.iter().position(|b| *b == b'\n' || *b == b'\r').unwrap_or(rest.len());
        start = match (bytes.get(end), bytes.get(end + 1)) {
            (Some(b'\r'), Some(b'\n')) => end + 2,
            (Some(_), _) => end + 1,
            (None, _) => end,
        };
        Some((line, begin..end, start))
    })
}

/// `range` without the blanks at its ends.
fn trimmed(bytes: &[u8], range: Range<usize>) -> Range<usize> {
    let text = bytes.get(range.clone()).unwrap_or_default();
    let start = range.start + (text.len() - text.trim_ascii_start().len());
    let length = text.trim_ascii().len();
    start..start + length
}

/// Where the comment of a line begins that is not inside quotes; the length of the line if there is none.
fn comment_start(text: &[u8]) -> usize {
    let mut quoted = false;
    for (i, b) in text.iter().enumerate() {
        match b {
            b'\'' => quoted = !quoted,
            b'$' | b'!' if !quoted => return i,
            _ => {}
        }
    }
    // a quote that is never closed hides no comment
    if quoted { text.iter().position(|b| matches!(b, b'$' | b'!')).unwrap_or(text.len()) } else { text.len() }
}

/// How many bytes are no blanks.
fn visible(text: &[u8]) -> usize {
    text.iter().filter(|b| !b.is_ascii_whitespace()).count()
}

fn ends_line(bytes: &[u8]) -> bool {
    matches!(bytes.last(), None | Some(b'\n' | b'\r'))
}

/// Whether this can be the name of a section or key.
fn is_name(name: &[u8]) -> bool {
    !name.is_empty()
        && name.len() <= 64
        && name.iter().all(|b| b.is_ascii_alphanumeric() || matches!(b, b'_' | b'-' | b'.' | b' '))
}

fn upper(name: &[u8]) -> String {
    let name = name.get(..name.len().min(64)).unwrap_or_default();
    String::from_utf8_lossy(name).to_ascii_uppercase()
}

/// The beginning of some text of a file, for a message.
pub(crate) fn shown(text: &[u8]) -> String {
    let text = String::from_utf8_lossy(text.get(..text.len().min(160)).unwrap_or_default()).into_owned();
    let mut shown: String = text.chars().filter(|c| !c.is_control()).take(40).collect();
    if shown.len() < text.len() {
        shown.push('…');
    }
    shown
}

fn value_of(text: &[u8]) -> Value {
    let inside = |quote: u8| text.strip_prefix(&[quote]).map(|t| t.strip_suffix(&[quote]).unwrap_or(t));
    if text.is_empty() {
        Value::Empty
    } else if let Some(inside) = inside(b'\'').or_else(|| inside(b'"')) {
        Value::Text(String::from_utf8_lossy(inside.trim_ascii()).into_owned())
    } else if let Some(number) = number(text) {
        Value::Number(number)
    } else {
        Value::Word(String::from_utf8_lossy(text).into_owned())
    }
}

/// A number with a decimal point or without, with an exponent after E or, as Fortran writes, D; `None` for anything
/// else, also for the words that other languages have for what is no number.
pub(crate) fn number(text: &[u8]) -> Option<f64> {
    let allowed = |b: &u8| b.is_ascii_digit() || matches!(b, b'+' | b'-' | b'.' | b'e' | b'E' | b'd' | b'D');
    if text.len() > 400 || !text.iter().all(allowed) || !text.iter().any(u8::is_ascii_digit) {
        return None;
    }
    let text: String =
        text.iter().map(|b| if matches!(b, b'd' | b'D') { 'e' } else { char::from(*b) }).collect();
    text.parse().ok()
}

/// The shortest text that is read as this number; `None` if it is not finite.
pub(crate) fn number_text(value: f64) -> Option<String> {
    if !value.is_finite() {
        return None;
    }
    let size = value.abs();
    Some(if size == 0.0 || (1e-5..1e15).contains(&size) { format!("{value}") } else { format!("{value:e}") })
}

/// Keys, a list for each section, so that nobody has to read a hundred in a line.
pub(super) fn by_section<'a>(keys: impl Iterator<Item = (&'a str, &'a str)>) -> Vec<(&'a str, String)> {
    let mut sections: Vec<(&str, String)> = Vec::new();
    let mut places = HashMap::new();
    for (section, key) in keys {
        match places.get(section).and_then(|place: &usize| sections.get_mut(*place)) {
            Some((_, list)) => {
                list.push_str(", ");
                list.push_str(key);
            }
            None => {
                places.insert(section, sections.len());
                sections.push((section, key.into()));
            }
        }
    }
    sections
}

/// How many keys a list has.
pub(super) fn counted(keys: &str) -> String {
    match keys.split(", ").count() {
        1 => "a key".into(),
        count => format!("{count} keys"),
    }
}
