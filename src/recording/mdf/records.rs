//! Records of an MDF file: what is stored at each time, and the numbers in it.

use super::blocks::{Block, Blocks, Fields, Read};
use crate::recording::form::MAX_LENGTH;
use crate::recording::typed::inflated;
use std::borrow::Cow;
use std::collections::HashMap;

/// Where a number stands in a record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layout {
    kind: Kind,
    is_big_endian: bool,
    byte: usize,
    bit: u32,
    bits: u32,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Unsigned,
    Signed,
    Float,
}

impl Layout {
    /// What a channel's block says, where records have so many bytes of data; why it is no number.
    ///
    /// # Errors
    /// A block that is too short, a place beyond the record.
    pub fn of(channel: &Block, record: usize) -> Read<Result<Self, &'static str>> {
        let data = channel.data;
        let (code, bit) = (data.u8(2)?, u32::from(data.u8(3)?));
        let (byte, bits) = (data.u32(4)? as usize, data.u32(8)?);
        let kind = match code {
            0 | 1 => Kind::Unsigned,
            2 | 3 => Kind::Signed,
            4 | 5 => Kind::Float,
            6..=9 => return Ok(Err("it is text")),
            15 | 16 => return Ok(Err("it is of complex numbers")),
            _ => return Ok(Err("it is no number")),
        };
        if kind == Kind::Float && !(matches!(bits, 32 | 64) && bit == 0) {
            return Ok(Err("it is of floating-point numbers that have neither 32 nor 64 bits"));
        }
        if !(1..=64).contains(&bits) || bit > 7 {
            return Ok(Err("it is of integers with more than 64 bits"));
        }
        let layout = Self { kind, is_big_endian: code % 2 == 1, byte, bit, bits };
        match byte.checked_add(layout.bytes()) {
            Some(end) if end <= record => Ok(Ok(layout)),
            _ => Err(format!("a channel stands beyond its records of {record} bytes")),
        }
    }

    fn bytes(&self) -> usize {
        (self.bit + self.bits).div_ceil(8) as usize
    }

    /// Whether numbers are whole.
    pub fn is_whole(&self) -> bool {
        self.kind != Kind::Float
    }

    /// The number in a record. Whole numbers beyond 2^53 are rounded.
    pub fn number(&self, record: &[u8]) -> f64 {
        let bytes = &record[self.byte..self.byte + self.bytes()];
        let mut word: u128 = 0;
        let mut take = |byte: &u8| word = word << 8 | u128::from(*byte);
        if self.is_big_endian {
            bytes.iter().for_each(&mut take);
        } else {
            bytes.iter().rev().for_each(&mut take);
        }
        // 64 bits at most are left by the shift and the mask
        let number = (word >> self.bit & (u128::MAX >> (128 - self.bits))) as u64;
        match (self.kind, self.bits) {
            (Kind::Float, 32) => f64::from(f32::from_bits(number as u32)),
            (Kind::Float, _) => f64::from_bits(number),
            (Kind::Unsigned, _) => number as f64,
            // the sign's bit to the top and back
            (Kind::Signed, bits) => ((number << (64 - bits)) as i64 >> (64 - bits)) as f64,
        }
    }
}

/// The bytes that a link leads to: as they are, compressed, or in pieces.
///
/// # Errors
/// Damaged blocks; a kind of storage that is not read.
pub fn data<'a>(blocks: Blocks<'a>, link: Option<u64>) -> Read<Cow<'a, [u8]>> {
    let Some(at) = link else { return Ok(Cow::Borrowed(&[])) };
    let block = blocks.any(at)?;
    match &block.name {
        b"DL" => {
            let mut all = Vec::new();
            for list in blocks.chain(Some(at), "DL")? {
                for piece in (1..list.links()).filter_map(|k| list.link(k)) {
                    let piece = piece_at(blocks, piece)?;
                    if (all.len() + piece.len()) as u64 > MAX_LENGTH {
                        return Err(format!("it has more than {} MB of data", MAX_LENGTH >> 20));
                    }
                    all.extend_from_slice(&piece);
                }
            }
            Ok(Cow::Owned(all))
        }
        b"HL" if block.link(0) != Some(at) => {
            let list = block.link(0).ok_or("a list of data is empty")?;
            if &blocks.any(list)?.name != b"DL" {
                return Err("a list of data leads to none".into());
            }
            data(blocks, Some(list))
        }
        _ => piece_at(blocks, at),
    }
}

fn piece_at<'a>(blocks: Blocks<'a>, at: u64) -> Read<Cow<'a, [u8]>> {
    let block = blocks.any(at)?;
    match &block.name {
        b"DT" => Ok(Cow::Borrowed(block.data.0)),
        b"DZ" => unzipped(&block.data).map(Cow::Owned),
        b"DV" | b"LD" => Err(
            "its data are stored channel by channel (MDF 4.2), which is not read; save them record by record"
                .into(),
        ),
        name => {
            Err(format!("at byte {at}: a block {} is where data should be", String::from_utf8_lossy(name)))
        }
    }
}

fn unzipped(block: &Fields) -> Read<Vec<u8>> {
    let (kind, width) = (block.u8(2)?, block.u32(4)? as usize);
    let (length, packed) = (block.u64(8)?, block.u64(16)?);
    let all = block.from(24)?;
    let packed = usize::try_from(packed).ok().and_then(|length| all.get(..length));
    let packed = packed.ok_or("a compressed block is shorter than it says")?;
    let length = Some(length).filter(|length| *length <= MAX_LENGTH);
    let length = length.ok_or_else(|| format!("it has more than {} MB of data", MAX_LENGTH >> 20))? as usize;
    let bytes = match kind {
        0 | 1 => inflated(packed, length)?,
        _ => return Err("its data are compressed in a way that is not read; deflate is".into()),
    };
    if bytes.len() < length {
        return Err("what is compressed in it is shorter than it says".into());
    }
    if kind == 0 || width == 0 {
        return Ok(bytes);
    }
    // bytes of one column of the records stand together; what is not a whole record stays at the end
    let rows = length / width;
    let mut records = vec![0; length];
    let (whole, rest) = bytes.split_at(rows * width);
    for (k, byte) in whole.iter().enumerate() {
        records[k % rows * width + k / rows] = *byte;
    }
    records[rows * width..].copy_from_slice(rest);
    Ok(records)
}

/// How long the records of a group are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Length {
    /// So many bytes.
    Fixed(usize),
    /// As each says in its first four bytes.
    Said,
}

/// Records of several groups that stand among each other, each behind the number of its group.
///
/// # Errors
/// A number that no group has, a record that is cut off.
pub fn sorted(data: &[u8], id_bytes: usize, groups: &HashMap<u64, Length>) -> Read<HashMap<u64, Vec<u8>>> {
    let mut sorted: HashMap<u64, Vec<u8>> = groups.keys().map(|id| (*id, Vec::new())).collect();
    let mut rest = data;
    let cut_off = || "its records are cut off".to_owned();
    while !rest.is_empty() {
        let (id, behind) = rest.split_at_checked(id_bytes).ok_or_else(cut_off)?;
        let id = id.iter().rev().fold(0, |id, byte| id << 8 | u64::from(*byte));
        let length = match groups.get(&id) {
            Some(Length::Fixed(length)) => *length,
            Some(Length::Said) => 4 + Fields(behind).u32(0).map_err(|_| cut_off())? as usize,
            None => return Err(format!("a record is of group {id}, which is not described")),
        };
        let (record, behind) = behind.split_at_checked(length).ok_or_else(cut_off)?;
        sorted.entry(id).or_default().extend_from_slice(record);
        rest = behind;
    }
    Ok(sorted)
}
