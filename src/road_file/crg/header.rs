//! What stands before the data of an OpenCRG file.

use crate::tir::shown;
use crate::{Error, Result};
use std::collections::BTreeMap;

/// The most channels: a road of a hundred metres' width in millimetres.
const MAX_CHANNELS: usize = 100_000;

/// What a channel of the data is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Channel {
    X,
    Y,
    U,
    Phi,
    Slope,
    Banking,
    /// A long section, by its number or its position.
    Number(f64),
    At(f64),
}

/// How numbers are written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Format {
    /// Records fill lines, or blocks, of 80 bytes.
    pub long: bool,
    pub double: bool,
    pub text: bool,
}

impl Format {
    fn of(word: &str) -> Option<Self> {
        let mut letters = word.chars().map(|c| c.to_ascii_uppercase());
        let long = match letters.next()? {
            'L' => true,
            'K' => false,
            _ => return None,
        };
        let double = match letters.next()? {
            'D' => true,
            'R' => false,
            _ => return None,
        };
        let text = match (letters.next()?, letters.next()?, letters.next()) {
            ('F', 'I', None) => true,
            ('B', 'I', None) => false,
            _ => return None,
        };
        Some(Self { long, double, text })
    }

    /// Bytes of a number.
    pub fn width(self) -> usize {
        match (self.text, self.double) {
            (true, true) => 20,
            (true, false) => 10,
            (false, true) => 8,
            (false, false) => 4,
        }
    }
}

pub(super) type Numbers = BTreeMap<String, (f64, usize)>;

/// What stands before the data.
#[derive(Debug, Default)]
pub(super) struct Header {
    pub road: Numbers,
    pub mods: Option<Numbers>,
    pub opts: Option<Numbers>,
    pub file: Option<(String, usize)>,
    pub format: Option<Format>,
    pub channels: Vec<Channel>,
    /// Where the reference line begins by `U:` of `$KD_DEFINITION` \[m\], which is for viewers.
    pub begin: Option<f64>,
    pub comments: bool,
    pub notes: Vec<String>,
    /// Where the data begin; the line before them.
    pub data: Option<(usize, usize)>,
}

impl Header {
    /// # Errors
    /// A line that says something else than it has to, with its number.
    pub fn read(bytes: &[u8], name: &str) -> Result<Self> {
        let mut header = Self::default();
        let mut section = String::new();
        let (mut start, mut line) = (0, 0);
        let mut file_name = String::new();
        while start < bytes.len() {
            line += 1;
            let rest = bytes.get(start..).unwrap_or_default();
            let length = rest.iter().position(|b| *b == b'\n' || *b == b'\r').unwrap_or(rest.len());
            let text = rest.get(..length).unwrap_or_default();
            let end = match (rest.get(length), rest.get(length + 1)) {
                (Some(b'\r'), Some(b'\n')) => start + length + 2,
                (Some(_), _) => start + length + 1,
                (None, _) => start + length,
            };
            start = end;
            if text.starts_with(b"$$$$") {
                header.data = Some((start, line));
                break;
            }
            // Latin-1 as the standard says
            let text: String = text.iter().take(1000).map(|b| char::from(*b)).collect();
            let place = format!("{name}:{line}");
            if text.starts_with('$')
                && !(section == "$ROAD_CRG_FILE" && file_name.is_empty() && is_path(&text))
            {
                if section == "$ROAD_CRG_FILE" && !file_name.is_empty() {
                    header.file = Some((std::mem::take(&mut file_name), line - 1));
                }
                section = text.split(['!', ' ', '\t']).next().unwrap_or_default().to_ascii_uppercase();
                match section.as_str() {
                    "$CT" => header.comments = true,
                    "$ROAD_CRG_MODS" => header.mods = Some(Numbers::new()),
                    "$ROAD_CRG_OPTS" => header.opts = Some(Numbers::new()),
                    _ => {}
                }
                continue;
            }
            let text = text.split('!').next().unwrap_or_default().trim();
            if text.is_empty() || text.starts_with('*') {
                continue;
            }
            match section.as_str() {
                "$ROAD_CRG" => assign(&mut header.road, text, &place, line, &mut header.notes)?,
                "$ROAD_CRG_MODS" => {
                    assign(header.mods.get_or_insert_default(), text, &place, line, &mut header.notes)?;
                }
                "$ROAD_CRG_OPTS" => {
                    assign(header.opts.get_or_insert_default(), text, &place, line, &mut header.notes)?;
                }
                "$ROAD_CRG_FILE" => file_name.push_str(text),
                "$KD_DEFINITION" => header.define(text, &place)?,
                _ => {}
            }
        }
        if !file_name.is_empty() {
            header.file = Some((file_name, line));
        }
        let nothing = header.road.is_empty() && header.file.is_none() && header.channels.is_empty();
        if nothing {
            return Err(Error::file(format!(
                "{name}: there is no block $ROAD_CRG and no $KD_DEFINITION: this is no OpenCRG file"
            )));
        }
        Ok(header)
    }

    /// A line of `$KD_DEFINITION`.
    fn define(&mut self, text: &str, place: &str) -> Result<()> {
        let wrong = |what: String| Err(Error::file(format!("{place}: $KD_DEFINITION: {what}")));
        if let Some(word) = text.strip_prefix("#:") {
            let word = word.split_whitespace().next().unwrap_or_default();
            self.format = Format::of(word);
            return match self.format {
                Some(_) => Ok(()),
                None => wrong(format!(
                    "the format '{}' is not known; known are LRFI, LDFI, LRBI, LDBI, KRFI, KDFI, KRBI and KDBI",
                    shown(word.as_bytes())
                )),
            };
        }
        let Some(rest) = text.strip_prefix("D:").or(text.strip_prefix("d:")) else {
            // U: name, unit, begin, step
            if text.starts_with(['U', 'u']) {
                self.begin = text.split(',').nth(2).and_then(|begin| begin.trim().parse().ok());
            }
            return Ok(());
        };
        let (what, unit) = rest.split_once(',').unwrap_or((rest, ""));
        let (what, unit) = (
            what.trim().to_ascii_lowercase(),
            unit.split(',').next().unwrap_or("").trim().to_ascii_lowercase(),
        );
        let number = |text: &str| text.trim().parse::<f64>().ok().filter(|x| x.is_finite());
        let channel = match what.strip_prefix("long section") {
            Some(rest) => {
                let rest = rest.trim();
                match rest.strip_prefix("at v") {
                    Some(at) => at.trim().strip_prefix('=').and_then(number).map(Channel::At),
                    None => number(rest).map(Channel::Number),
                }
            }
            None => match what.strip_prefix("reference line").map(str::trim) {
                Some("x") => Some(Channel::X),
                Some("y") => Some(Channel::Y),
                Some("u") => Some(Channel::U),
                Some("phi") => Some(Channel::Phi),
                Some("slope") => Some(Channel::Slope),
                Some("banking") => Some(Channel::Banking),
                _ => None,
            },
        };
        let Some(channel) = channel else {
            return wrong(format!(
                "'{}' is no channel; there are 'reference line' x, y, u, phi, slope and banking, 'long section' and a number, and 'long section at v = ' and a position",
                shown(what.as_bytes())
            ));
        };
        let wanted = match channel {
            Channel::Phi => "rad",
            Channel::Slope | Channel::Banking => "m/m",
            _ => "m",
        };
        if unit != wanted {
            return wrong(format!(
                "the unit of '{}' is '{}'; it has to be {wanted}",
                shown(what.as_bytes()),
                shown(unit.as_bytes())
            ));
        }
        if self.channels.len() >= MAX_CHANNELS {
            return wrong(format!("there are more than {MAX_CHANNELS} channels"));
        }
        self.channels.push(channel);
        Ok(())
    }
}

/// Whether a line that begins with `$` is a path and no block: `$HOME/road.crg`.
fn is_path(text: &str) -> bool {
    text.contains('/') || text.to_ascii_lowercase().contains(".crg")
}

/// `KEY = number` of a block.
fn assign(
    numbers: &mut Numbers,
    text: &str,
    place: &str,
    line: usize,
    notes: &mut Vec<String>,
) -> Result<()> {
    let Some((key, value)) = text.split_once('=') else {
        return Err(Error::file(format!(
            "{place}: '{}' is no assignment KEY = number",
            shown(text.as_bytes())
        )));
    };
    let value = value.trim().replace(['d', 'D'], "e");
    let parsed = |text: &str| text.parse::<f64>().ok().filter(|x| x.is_finite());
    let number = parsed(&value).or_else(|| {
        // sign and letter of the exponent exchanged, as in a sample of the standard
        let mended = parsed(&value.replacen("+e", "e+", 1).replacen("-e", "e-", 1))?;
        notes.push(format!("{place}: {} is '{value}', which is taken as {mended}", key.trim()));
        Some(mended)
    });
    match number {
        Some(number) if numbers.len() < 1000 => {
            let key = key.trim().to_ascii_uppercase();
            if let Some((before, at)) = numbers.insert(key.clone(), (number, line))
                && before != number
            {
                return Err(Error::file(format!("{place}: {key} has another value than in line {at}")));
            }
            Ok(())
        }
        Some(_) => Err(Error::file(format!("{place}: the block has more than 1000 keys"))),
        None => Err(Error::file(format!(
            "{place}: {} is '{}', which is no number",
            shown(key.trim().as_bytes()),
            shown(value.as_bytes())
        ))),
    }
}
