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
pub(crate) struct Place {
    text: Rc<str>,
    offset: usize,
}

impl Place {
    /// The error `what`, with line and column.
    pub(super) fn error(&self, what: &str) -> Error {
        self.broken(what).into()
    }

    fn broken(&self, what: &str) -> Broken {
        Broken { place: Some(self.clone()), what: what.to_owned() }
    }

    /// Line and column, both from 1, columns in characters; and the text of the line.
    pub(crate) fn position(&self) -> (usize, usize, &str) {
        let mut end = self.offset.min(self.text.len());
        while !self.text.is_char_boundary(end) {
            end -= 1;
        }
        let before = &self.text[..end];
        let start = before.rfind('\n').map_or(0, |i| i + 1);
        let line = self.text[start..].split('\n').next().unwrap_or_default();
        (before.matches('\n').count() + 1, before[start..].chars().count() + 1, line.trim_end_matches('\r'))
    }
}

/// XML that cannot be read.
pub(crate) struct Broken {
    /// Unknown for a file that is not even text.
    pub(crate) place: Option<Place>,
    /// A sentence.
    pub(crate) what: String,
}

impl From<Broken> for Error {
    fn from(broken: Broken) -> Self {
        let what = broken.what;
        match broken.place {
            None => Error::fmu(format!("modelDescription.xml: {what}")),
            Some(place) => {
                let (line, column, _) = place.position();
                Error::fmu(format!("modelDescription.xml, line {line}, column {column}: {what}"))
            }
        }
    }
}

/// An attribute of a start tag.
#[derive(Clone)]
pub(crate) struct Attribute {
    pub(crate) name: String,
    pub(crate) value: String,
    pub(crate) place: Place,
}

/// A start tag.
#[derive(Clone)]
pub(crate) struct Element {
    name: String,
    attributes: Vec<Attribute>,
    place: Place,
}

impl Element {
    fn new(tag: &BytesStart<'_>, place: Place) -> std::result::Result<Self, Broken> {
        let name = tag.name().0.to_owned();
        let mut attributes = Vec::new();
        for attribute in tag.attributes() {
            let attribute = attribute.map_err(|e| place.broken(&format!("<{name}>: {e}")))?;
            let key = attribute.key.0;
            let value = attribute
                .normalized_value(XmlVersion::Explicit1_0)
                .map_err(|e| place.broken(&format!("<{name}>: attribute {key}: {e}")))?;
            // The key is a part of the text; were it a copy, the place of the tag has to do.
            let offset = (key.as_ptr() as usize).wrapping_sub(place.text.as_ptr() as usize);
            let offset = if offset < place.text.len() { offset } else { place.offset };
            attributes.push(Attribute {
                name: key.to_owned(),
                value: value.into_owned(),
                place: Place { offset, ..place.clone() },
            });
        }
        Ok(Self { name, attributes, place })
    }

    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    pub(crate) fn place(&self) -> Place {
        self.place.clone()
    }

    /// In the order of the file.
    pub(crate) fn attributes(&self) -> &[Attribute] {
        &self.attributes
    }

    /// The error `what` about this element.
    pub(super) fn wrong(&self, what: &str) -> Error {
        self.place.error(&format!("<{}>: {what}", self.name))
    }

    fn bad(&self, attribute: &str, value: &str, needed: &str) -> Error {
        self.wrong(&format!("the attribute {attribute} is {value:?}; {needed} is needed"))
    }

    /// An attribute.
    pub(crate) fn text(&self, attribute: &str) -> Option<&str> {
        self.attributes.iter().find(|a| a.name == attribute).map(|a| a.value.as_str())
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
pub(crate) fn read<E: From<Broken>>(
    bytes: &[u8],
    mut open: impl FnMut(&[String], &Element) -> std::result::Result<(), E>,
) -> std::result::Result<(), E> {
    let text = std::str::from_utf8(bytes).map_err(|e| Broken {
        place: None,
        what: format!("byte {} is not UTF-8, as the standard demands", e.valid_up_to() + 1),
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
            place(at).broken(&format!("the XML is broken: {e}"))
        })?;
        match event {
            Event::Start(_) | Event::Empty(_) if ended => {
                return Err(place(start).broken("there is an element after the end of the document").into());
            }
            Event::Start(tag) => {
                let element = Element::new(&tag, place(start))?;
                open(&path, &element)?;
                if path.len() == MAX_DEPTH {
                    let what = format!("<{}>: it is more than {MAX_DEPTH} elements deep", element.name);
                    return Err(element.place.broken(&what).into());
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
                return Err(place(start)
                    .broken("there is a DOCTYPE; for safety such files are not read")
                    .into());
            }
            Event::Text(text) if path.is_empty() && !text.trim().is_empty() => {
                let side = if ended { "after the end of" } else { "outside" };
                return Err(place(start).broken(&format!("there is text {side} the document")).into());
            }
            Event::Eof => break,
            _ => {}
        }
    }
    match path.last() {
        Some(name) => {
            let what = format!("the file ends, but <{name}> is not closed");
            Err(place(text.len() as u64).broken(&what).into())
        }
        None => Ok(()),
    }
}
