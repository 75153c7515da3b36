//! Reading XML element by element, with the place of every mistake.

use crate::{Error, Result};
use quick_xml::XmlVersion;
use quick_xml::events::{BytesStart, Event};
use std::rc::Rc;
use std::str::FromStr;

/// Elements nested deeper than this are refused.
const MAX_DEPTH: usize = 64;

/// Where something is: byte offset in the file.
#[derive(Clone)]
pub(super) struct Place {
    text: Rc<str>,
    offset: usize,
}

impl Place {
    /// The error `what`, with line and column. Columns count characters from 1.
    pub(super) fn error(&self, what: &str) -> Error {
        let mut end = self.offset.min(self.text.len());
        while !self.text.is_char_boundary(end) {
            end -= 1;
        }
        let before = &self.text[..end];
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().map_or(0, |l| l.chars().count()) + 1;
        Error::fmu(format!("modelDescription.xml, line {line}, column {column}: {what}"))
    }
}

/// A start tag.
pub(super) struct Element {
    name: String,
    attributes: Vec<(String, String)>,
    place: Place,
}

impl Element {
    fn new(tag: &BytesStart<'_>, place: Place) -> Result<Self> {
        let name = tag.name().0.to_owned();
        let mut attributes = Vec::new();
        for attribute in tag.attributes() {
            let attribute = attribute.map_err(|e| place.error(&format!("<{name}>: {e}")))?;
            let value = attribute
                .normalized_value(XmlVersion::Explicit1_0)
                .map_err(|e| place.error(&format!("<{name}>: attribute {}: {e}", attribute.key.0)))?;
            attributes.push((attribute.key.0.to_owned(), value.into_owned()));
        }
        Ok(Self { name, attributes, place })
    }

    pub(super) fn name(&self) -> &str {
        &self.name
    }

    pub(super) fn place(&self) -> Place {
        self.place.clone()
    }

    /// The error `what` about this element.
    pub(super) fn wrong(&self, what: &str) -> Error {
        self.place.error(&format!("<{}>: {what}", self.name))
    }

    fn bad(&self, attribute: &str, value: &str, needed: &str) -> Error {
        self.wrong(&format!("the attribute {attribute} is {value:?}; {needed} is needed"))
    }

    /// An attribute.
    pub(super) fn text(&self, attribute: &str) -> Option<&str> {
        self.attributes.iter().find(|(name, _)| name == attribute).map(|(_, value)| value.as_str())
    }

    /// An attribute that has to be there.
    pub(super) fn required(&self, attribute: &str) -> Result<&str> {
        self.text(attribute)
            .ok_or_else(|| self.wrong(&format!("the attribute {attribute} is missing; FMI 2.0 demands it")))
    }

    /// A finite number.
    pub(super) fn real(&self, attribute: &str) -> Result<Option<f64>> {
        let Some(text) = self.text(attribute) else { return Ok(None) };
        match text.trim().parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(Some(value)),
            _ => Err(self.bad(attribute, text, "a finite number")),
        }
    }

    /// A whole number.
    pub(super) fn number<T: FromStr>(&self, attribute: &str) -> Result<Option<T>> {
        let Some(text) = self.text(attribute) else { return Ok(None) };
        match text.trim().parse() {
            Ok(value) => Ok(Some(value)),
            Err(_) => Err(self.bad(attribute, text, "a whole number in the range of its type")),
        }
    }

    /// A whole number that has to be there.
    pub(super) fn required_number<T: FromStr>(&self, attribute: &str) -> Result<T> {
        self.required(attribute)?;
        self.number(attribute)?.ok_or_else(|| self.wrong(&format!("the attribute {attribute} is missing")))
    }

    /// True or false.
    pub(super) fn boolean(&self, attribute: &str) -> Result<Option<bool>> {
        match self.text(attribute).map(str::trim) {
            None => Ok(None),
            Some("true" | "1") => Ok(Some(true)),
            Some("false" | "0") => Ok(Some(false)),
            Some(text) => Err(self.bad(attribute, text, "true or false")),
        }
    }

    /// True or false, false where absent.
    pub(super) fn flag(&self, attribute: &str) -> Result<bool> {
        Ok(self.boolean(attribute)?.unwrap_or(false))
    }

    /// One of some words.
    pub(super) fn word<T: Copy>(&self, attribute: &str, words: &[(&str, T)]) -> Result<Option<T>> {
        let Some(text) = self.text(attribute) else { return Ok(None) };
        match words.iter().find(|(word, _)| *word == text) {
            Some((_, value)) => Ok(Some(*value)),
            None => {
                let words: Vec<_> = words.iter().map(|(word, _)| *word).collect();
                Err(self.bad(attribute, text, &format!("one of {}", words.join(", "))))
            }
        }
    }
}

/// Calls `open` for every start tag with the names of the elements around it.
///
/// Fails for XML that is not well-formed, for a DOCTYPE (entities that grow without bound come from
/// there, and no FMU needs one), and with whatever `open` fails with.
pub(super) fn read(bytes: &[u8], mut open: impl FnMut(&[String], &Element) -> Result<()>) -> Result<()> {
    let text = std::str::from_utf8(bytes).map_err(|e| {
        Error::fmu(format!(
            "modelDescription.xml: byte {} is not UTF-8, which FMI demands",
            e.valid_up_to() + 1
        ))
    })?;
    let text: Rc<str> = text.trim_start_matches('\u{feff}').into();
    let place =
        |offset: u64| Place { text: text.clone(), offset: usize::try_from(offset).unwrap_or(usize::MAX) };
    let mut reader = quick_xml::Reader::from_str(&text);
    reader.config_mut().enable_all_checks(true);
    let mut path: Vec<String> = Vec::new();
    let mut ended = false;
    loop {
        let start = reader.buffer_position();
        let event = reader.read_event().map_err(|e| {
            let at = if reader.error_position() > 0 { reader.error_position() } else { start };
            place(at).error(&format!("the XML is broken: {e}"))
        })?;
        match event {
            Event::Start(_) | Event::Empty(_) if ended => {
                return Err(place(start).error("there is an element after the end of the document"));
            }
            Event::Start(tag) => {
                let element = Element::new(&tag, place(start))?;
                open(&path, &element)?;
                if path.len() == MAX_DEPTH {
                    return Err(element.wrong(&format!("it is more than {MAX_DEPTH} elements deep")));
                }
                path.push(element.name);
            }
            Event::Empty(tag) => {
                open(&path, &Element::new(&tag, place(start))?)?;
                ended = path.is_empty();
            }
            Event::End(_) => {
                path.pop();
                ended = path.is_empty();
            }
            Event::DocType(_) => {
                return Err(place(start).error("there is a DOCTYPE; for safety such files are not read"));
            }
            Event::Text(text) if path.is_empty() && !text.trim().is_empty() => {
                let side = if ended { "after the end of" } else { "outside" };
                return Err(place(start).error(&format!("there is text {side} the document")));
            }
            Event::Eof => break,
            _ => {}
        }
    }
    match path.last() {
        Some(name) => {
            Err(place(text.len() as u64).error(&format!("the file ends, but <{name}> is not closed")))
        }
        None => Ok(()),
    }
}
