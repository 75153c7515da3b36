//! From the numbers that a recorder stored to those that it measured.

use super::blocks::{Block, Blocks, Read};

/// How stored numbers become values.
#[derive(Debug, Clone, PartialEq)]
pub enum Conversion {
    /// They are the values.
    None,
    /// `offset + factor x`.
    Linear { offset: f64, factor: f64 },
    /// `(a x^2 + b x + c) / (d x^2 + e x + f)`.
    Rational([f64; 6]),
    /// Values at increasing keys; between them on a straight line, or that of the nearest key.
    Table { keys: Vec<(f64, f64)>, is_interpolated: bool },
    /// Values, or conversions, of ranges; of what is in none of them.
    Ranges { ranges: Vec<Range>, otherwise: Box<Conversion> },
    /// One value.
    Constant(f64),
    /// A text in place of a number: nothing that could be computed with.
    Text,
}

/// A conversion that holds from one stored number to another.
#[derive(Debug, Clone, PartialEq)]
pub struct Range {
    low: f64,
    high: f64,
    conversion: Conversion,
}

/// The numbers of all conversions of a file: tables may be linked to again and again, so that a small file has no end of them.
pub const MAX_NUMBERS: usize = 1 << 24;

impl Conversion {
    /// The conversion that a link of a channel leads to; why there is none that gives numbers. Its numbers are taken from `room`.
    ///
    /// # Errors
    /// A damaged block.
    pub fn of(blocks: Blocks, link: Option<u64>, room: &mut usize) -> Read<Result<Self, &'static str>> {
        Self::read(blocks, link, room, false)
    }

    fn read(
        blocks: Blocks,
        link: Option<u64>,
        room: &mut usize,
        is_in_table: bool,
    ) -> Read<Result<Self, &'static str>> {
        let Some(at) = link else { return Ok(Ok(Self::None)) };
        let block = blocks.block(at, "CC")?;
        let count = usize::from(block.data.u16(6)?);
        *room = room.checked_sub(1 + count).ok_or("its conversions have too many numbers")?;
        let values = (0..count).map(|k| block.data.f64(24 + 8 * k)).collect::<Read<Vec<f64>>>()?;
        let pairs = || values.chunks_exact(2).map(|pair| (pair[0], pair[1])).collect::<Vec<_>>();
        Ok(match (block.data.u8(0)?, &values[..]) {
            (0, _) => Ok(Self::None),
            (1, [offset, factor, ..]) => Ok(Self::Linear { offset: *offset, factor: *factor }),
            (2, [a, b, c, d, e, f, ..]) => Ok(Self::Rational([*a, *b, *c, *d, *e, *f])),
            (3, _) => Err("its conversion is a formula in text"),
            (kind @ (4 | 5), [_, _, ..]) if pairs().is_sorted_by(|a, b| a.0 < b.0) => {
                Ok(Self::Table { keys: pairs(), is_interpolated: kind == 4 })
            }
            (6, [.., otherwise]) => {
                let triples = values.chunks_exact(3);
                let ranges =
                    triples.map(|t| Range { low: t[0], high: t[1], conversion: Self::Constant(t[2]) });
                Ok(Self::Ranges { ranges: ranges.collect(), otherwise: Box::new(Self::Constant(*otherwise)) })
            }
            (7 | 8, _) if is_in_table => Err("its conversion is a table of texts within another"),
            (7, _) => Self::texts(blocks, block, values.iter().map(|v| (*v, *v)).collect(), room)?,
            (8, _) => Self::texts(blocks, block, pairs(), room)?,
            (9, _) | (10, _) => Err("it is text"),
            (11, _) => Ok(Self::None),
            _ => Err("its conversion is none that MDF 4.1 has"),
        })
    }

    /// A table of texts. What stands for texts alone are numbers without unit, as stored. Where one of the texts is a scale, the others stand for what is
    /// no measurement: an error, a sensor that is not there.
    fn texts(
        blocks: Blocks,
        block: Block,
        keys: Vec<(f64, f64)>,
        room: &mut usize,
    ) -> Read<Result<Self, &'static str>> {
        // name, unit, comment and inverse come first
        let mut entry = |k: usize| -> Read<Result<Self, &'static str>> {
            match block.link(4 + k) {
                None => Ok(Ok(Self::Text)),
                Some(at) if &blocks.any(at)?.name == b"CC" => Self::read(blocks, Some(at), room, true),
                Some(_) => Ok(Ok(Self::Text)),
            }
        };
        let entries = (0..=keys.len()).map(&mut entry).collect::<Read<Result<Vec<_>, _>>>()?;
        let mut entries = match entries {
            Ok(entries) => entries,
            Err(why) => return Ok(Err(why)),
        };
        if entries.iter().all(|entry| *entry == Self::Text) {
            return Ok(Ok(Self::None));
        }
        let otherwise = Box::new(entries.pop().unwrap_or(Self::Text));
        let ranges =
            keys.into_iter().zip(entries).map(|((low, high), conversion)| Range { low, high, conversion });
        Ok(Ok(Self::Ranges { ranges: ranges.collect(), otherwise }))
    }

    /// Whether the stored numbers stand for texts, and so are numbers without a unit.
    pub fn is_code(blocks: Blocks, link: Option<u64>, conversion: &Self) -> Read<bool> {
        let Some(at) = link else { return Ok(false) };
        let kind = blocks.block(at, "CC")?.data.u8(0)?;
        Ok(matches!(kind, 7 | 8 | 11) && *conversion == Self::None)
    }

    /// The value of a stored number; not a number where there is none. A range of whole numbers has both its ends in it, one of
    /// others not its upper one.
    pub fn value(&self, stored: f64, is_whole: bool) -> f64 {
        match self {
            Self::None => stored,
            Self::Linear { offset, factor } => offset + factor * stored,
            Self::Rational([a, b, c, d, e, f]) => {
                ((a * stored + b) * stored + c) / ((d * stored + e) * stored + f)
            }
            Self::Table { keys, is_interpolated } => looked_up(keys, stored, *is_interpolated),
            Self::Ranges { ranges, otherwise } => {
                let has = |range: &&Range| {
                    range.low <= stored
                        && (stored < range.high
                            || stored == range.high && (is_whole || range.low == range.high))
                };
                ranges
                    .iter()
                    .find(has)
                    .map_or(otherwise.as_ref(), |range| &range.conversion)
                    .value(stored, is_whole)
            }
            Self::Constant(value) => *value,
            Self::Text => f64::NAN,
        }
    }
}

fn looked_up(keys: &[(f64, f64)], at: f64, is_interpolated: bool) -> f64 {
    let above = keys.partition_point(|(key, _)| *key <= at);
    match (above.checked_sub(1).map(|below| keys[below]), keys.get(above).copied()) {
        _ if at.is_nan() => f64::NAN,
        (Some((_, value)), None) | (None, Some((_, value))) => value,
        (Some((low, from)), Some((high, to))) if is_interpolated => {
            from + (to - from) * ((at - low) / (high - low))
        }
        (Some((low, from)), Some((high, to))) => {
            if at - low > high - at {
                to
            } else {
                from
            }
        }
        (None, None) => f64::NAN,
    }
}
