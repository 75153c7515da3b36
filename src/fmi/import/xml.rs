//! Reading XML element by element, with the place of every mistake.

use crate::{Error, Result};
use quick_xml::XmlVersion;
use quick_xml::events::{BytesStart, Event};
use std::cell::OnceCell;
use std::collections::HashSet;
use std::rc::Rc;
use std::str::FromStr;

/// Elements nested deeper than this are refused.
const MAX_DEPTH: usize = 64;
/// Elements with more attributes than this are refused; those of FMI and SSP have two dozen at most.
const MAX_ATTRIBUTES: usize = 1000;
/// Files with more elements than this are refused: as a tree they take 200 bytes each, and a million variables need half
/// of them.
const MAX_ELEMENTS: usize = 5_000_000;
/// Characters are counted once for each piece of so many bytes.
const PIECE: usize = 1024;

/// Where something is: byte offset in the file.
#[derive(Clone)]
pub(crate) struct Place {
    text: Rc<Text>,
    offset: usize,
}

/// A file's text, with what it takes to find lines and columns again and again.
struct Text {
    text: String,
    counts: OnceCell<Counts>,
}

struct Counts {
    /// Bytes after which a line begins.
    line_ends: Vec<usize>,
    /// Characters before each piece.
    before: Vec<usize>,
}

impl Text {
    fn counts(&self) -> &Counts {
        self.counts.get_or_init(|| {
            let bytes = self.text.as_bytes();
            let line_ends = (0..bytes.len()).filter(|i| bytes[*i] == b'\n').collect();
            let mut before = vec![0];
            for piece in bytes.chunks(PIECE) {
                before.push(before.last().copied().unwrap_or(0) + characters(piece));
            }
            Counts { line_ends, before }
        })
    }

    /// Characters before a byte.
    fn characters_before(&self, offset: usize) -> usize {
        let piece = offset / PIECE;
        self.counts().before[piece] + characters(&self.text.as_bytes()[piece * PIECE..offset])
    }
}

/// The characters that begin in a piece of UTF-8.
fn characters(bytes: &[u8]) -> usize {
    bytes.iter().filter(|byte| **byte & 0xc0 != 0x80).count()
}

impl Place {
    /// The error `what`, with line and column.
    pub(super) fn error(&self, what: &str) -> Error {
        self.broken(what).into()
    }

    fn broken(&self, what: &str) -> Broken {
        Broken { place: Some(self.clone()), what: what.to_owned() }
    }

    /// The offset, at the beginning of a character, and the line's number, from 0, and beginning.
    fn line(&self) -> (usize, usize, usize) {
        let mut end = self.offset.min(self.text.text.len());
        while !self.text.text.is_char_boundary(end) {
            end -= 1;
        }
        let ends = &self.text.counts().line_ends;
        let number = ends.partition_point(|line_end| *line_end < end);
        (end, number, number.checked_sub(1).map_or(0, |before| ends[before] + 1))
    }

    /// Line and column, both from 1, columns in characters.
    pub(crate) fn position(&self) -> (usize, usize) {
        let (end, number, start) = self.line();
        (number + 1, self.text.characters_before(end) - self.text.characters_before(start) + 1)
    }

    /// What stands in the line before and after the place, at most so many characters each.
    pub(crate) fn around(&self, most: usize) -> (String, String) {
        let (end, _, start) = self.line();
        let before: Vec<char> = self.text.text[start..end].chars().rev().take(most).collect();
        let after: String = self.text.text[end..].chars().take_while(|c| *c != '\n').take(most).collect();
        (before.into_iter().rev().collect(), after.trim_end_matches('\r').to_owned())
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
                let (line, column) = place.position();
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
        let mut seen = HashSet::new();
        // the reader's own check for duplicates compares each with each
        for attribute in tag.attributes().with_checks(false) {
            let attribute = attribute.map_err(|e| place.broken(&format!("<{name}>: {e}")))?;
            let key = attribute.key.0;
            if !seen.insert(key) {
                return Err(place.broken(&format!("<{name}>: it has the attribute {key} twice")));
            }
            if attributes.len() == MAX_ATTRIBUTES {
                return Err(place.broken(&format!("<{name}>: it has more than {MAX_ATTRIBUTES} attributes")));
            }
            let value = attribute
                .normalized_value(XmlVersion::Explicit1_0)
                .map_err(|e| place.broken(&format!("<{name}>: attribute {key}: {e}")))?;
            // The key is a part of the text; were it a copy, the place of the tag has to do.
            let offset = (key.as_ptr() as usize).wrapping_sub(place.text.text.as_ptr() as usize);
            let offset = if offset < place.text.text.len() { offset } else { place.offset };
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
    let text = Rc::new(Text { text: text.trim_start_matches('\u{feff}').into(), counts: OnceCell::new() });
    let place =
        |offset: u64| Place { text: text.clone(), offset: usize::try_from(offset).unwrap_or(usize::MAX) };
    let mut reader = quick_xml::Reader::from_str(&text.text);
    reader.config_mut().enable_all_checks(true);
    let mut path: Vec<String> = Vec::new();
    let mut ended = false;
    let mut elements = 0_usize;
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
            Event::Start(_) | Event::Empty(_) if elements == MAX_ELEMENTS => {
                return Err(place(start)
                    .broken(&format!("there are more than {MAX_ELEMENTS} elements; such files are not read"))
                    .into());
            }
            Event::Start(tag) => {
                elements += 1;
                let element = Element::new(&tag, place(start))?;
                open(&path, &element)?;
                if path.len() == MAX_DEPTH {
                    let what = format!("<{}>: it is more than {MAX_DEPTH} elements deep", element.name);
                    return Err(element.place.broken(&what).into());
                }
                path.push(element.name);
            }
            Event::Empty(tag) => {
                elements += 1;
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
            Err(place(text.text.len() as u64).broken(&what).into())
        }
        None => Ok(()),
    }
}
