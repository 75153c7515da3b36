//! What is written is read, fields of bits and conversions against their definitions, damage is an error. Files of another program
//! are in tests/python/test_recordings.py.

use super::blocks::{Block, Blocks};
use super::conversion::Conversion;
use super::records::{Layout, Length, sorted};
use super::write::write;
use super::*;
use crate::recording::typed::faultless;
use crate::recording::{Channel as Recorded, Recording};
use proptest::prelude::*;

fn recording(rows: usize) -> Recording {
    let time: Vec<f64> = (0..rows).map(|k| 0.1 + k as f64 * 1e-3).collect();
    let channel = |name: &str, unit: &str, f: fn(f64) -> f64| Recorded {
        name: name.into(),
        unit: unit.into(),
        values: time.iter().map(|t| f(*t)).collect(),
    };
    let channels = vec![
        channel("left.force_z", "N", |t| 4000.0 + (20.0 * t).sin()),
        channel("x[1]", "1", |t| 1.0 / 3.0 - t),
        channel("Weg \u{fc}ber Grund", "mm", |_| -0.0),
    ];
    Recording { time, channels, source: "rig.mf4".into() }
}

fn written(recording: &Recording) -> Vec<u8> {
    let mut bytes = Vec::new();
    write(&mut bytes, recording).unwrap();
    bytes
}

fn read(bytes: &[u8]) -> Result<Recording> {
    faultless(parse_mdf(bytes, &Columns::default(), "rig.mf4")?)
}

#[test]
fn what_is_written_is_read_to_the_last_bit() {
    for rows in [2, 3000] {
        let original = recording(rows);
        let back = read(&written(&original)).unwrap();
        assert_eq!(back, original);
        assert!(back.channels[2].values.iter().all(|v| v.is_sign_negative()));
    }
    let mut bad = recording(3);
    bad.channels[1].values[2] = f64::NAN;
    let message = read(&written(&bad)).unwrap_err().to_string();
    assert!(message.contains("rig.mf4: x[1] (column 3), row 3: NaN"), "{message}");
}

/// A block of a channel or a conversion, as bytes.
fn block(links: &[u64], data: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::from(*b"##CC\0\0\0\0");
    bytes.extend(((24 + 8 * links.len() + data.len()) as u64).to_le_bytes());
    bytes.extend((links.len() as u64).to_le_bytes());
    links.iter().for_each(|link| bytes.extend(link.to_le_bytes()));
    bytes.extend(data);
    bytes
}

fn conversion(kind: u8, links: &[u64], values: &[f64]) -> Vec<u8> {
    let mut data = vec![kind, 0, 0, 0];
    data.extend((links.len() as u16).to_le_bytes());
    data.extend((values.len() as u16).to_le_bytes());
    data.extend([0; 16]);
    values.iter().for_each(|value| data.extend(value.to_le_bytes()));
    let all: Vec<u64> = [0; 4].iter().chain(links).copied().collect();
    block(&all, &data)
}

fn conversion_in(bytes: &[u8], at: u64) -> Conversion {
    Conversion::of(Blocks(bytes), Some(at), &mut 100).unwrap().unwrap()
}

#[test]
fn conversions_are_those_of_the_standard() {
    // a block is never at byte 0
    let of = |kind: u8, values: &[f64]| {
        let bytes = [vec![0; 8], conversion(kind, &[], values)].concat();
        conversion_in(&bytes, 8)
    };
    let linear = of(1, &[-40.0, 0.5]);
    assert_eq!([linear.value(0.0, true), linear.value(200.0, true)], [-40.0, 60.0]);
    // (x^2 + 2 x + 3) / (4 x + 5)
    assert_eq!(of(2, &[1.0, 2.0, 3.0, 0.0, 4.0, 5.0]).value(2.0, true), 11.0 / 13.0);
    let [between, nearest] = [4, 5].map(|kind| of(kind, &[0.0, 10.0, 1.0, 20.0, 3.0, 0.0]));
    assert_eq!([-1.0, 0.5, 1.0, 2.0, 9.0].map(|x| between.value(x, false)), [10.0, 15.0, 20.0, 10.0, 0.0]);
    assert_eq!([-1.0, 0.4, 0.5, 0.6, 9.0].map(|x| nearest.value(x, false)), [10.0, 10.0, 10.0, 20.0, 0.0]);
    // 0 to 4 is 7, 4 to 9 is 8, else -1: an end belongs to the range only of whole numbers
    let ranges = of(6, &[0.0, 4.0, 7.0, 4.0, 9.0, 8.0, -1.0]);
    assert_eq!([0.0, 4.0, 9.0, 10.0].map(|x| ranges.value(x, true)), [7.0, 7.0, 8.0, -1.0]);
    assert_eq!([0.0, 4.0, 9.0].map(|x| ranges.value(x, false)), [7.0, 8.0, -1.0]);
}

#[test]
fn a_scale_among_texts_is_the_value_and_texts_are_none() {
    // 254 and 255 stand for texts, all else is a scale: as of J1939
    let scale = conversion(1, &[], &[-125.0, 1.0]);
    let text_at = 8 + scale.len() as u64;
    let mut text = block(&[], b"not available\0");
    text[2..4].copy_from_slice(b"TX");
    text.resize(text.len().next_multiple_of(8), 0);
    let table_at = text_at + text.len() as u64;
    let with_scale = conversion(7, &[text_at, text_at, 8], &[254.0, 255.0]);
    let bytes = [vec![0; 8], scale.clone(), text.clone(), with_scale].concat();
    let table = conversion_in(&bytes, table_at);
    assert_eq!(table.value(130.0, true), 5.0);
    assert!(table.value(254.0, true).is_nan() && table.value(255.0, true).is_nan());
    // texts alone: the numbers as they are stored
    let texts = conversion(7, &[text_at, text_at, 0], &[0.0, 1.0]);
    let bytes = [vec![0; 8], scale, text, texts].concat();
    assert_eq!(conversion_in(&bytes, table_at).value(1.0, true), 1.0);
}

fn layout(kind: u8, byte: u32, bit: u8, bits: u32) -> Layout {
    let mut data = vec![0, 0, kind, bit];
    data.extend(byte.to_le_bytes());
    data.extend(bits.to_le_bytes());
    let bytes = [vec![0; 8], block(&[], &data)].concat();
    let block: Block = Blocks(&bytes).any(8).unwrap();
    Layout::of(&block, 16).unwrap().unwrap()
}

proptest! {
    /// A number at any bit of a record, among others' bits, in either order of bytes.
    #[test]
    fn numbers_stand_at_any_bit(value: i64, bits in 1u32..=64, bit in 0u8..8, byte in 0u32..7, other: u128) {
        let field = value & (u64::MAX >> (64 - bits)) as i64;
        let mask = (u128::from(u64::MAX >> (64 - bits))) << bit;
        let signed = (value << (64 - bits)) >> (64 - bits);
        let width = (u32::from(bit) + bits).div_ceil(8) as usize;
        let word = (other & !mask) | (u128::from(field.cast_unsigned()) << bit);
        let mut record = [0xa5; 16];
        record[byte as usize..byte as usize + width].copy_from_slice(&word.to_le_bytes()[..width]);
        prop_assert_eq!(layout(0, byte, bit, bits).number(&record), field.cast_unsigned() as f64);
        prop_assert_eq!(layout(2, byte, bit, bits).number(&record), signed as f64);
        record[byte as usize..byte as usize + width].reverse();
        prop_assert_eq!(layout(1, byte, bit, bits).number(&record), field.cast_unsigned() as f64);
        prop_assert_eq!(layout(3, byte, bit, bits).number(&record), signed as f64);
    }

    /// Whatever is wrong with a file, it is a recording or an error.
    #[test]
    fn damage_is_an_error(at in 0usize..2000, byte: u8, cut in 0usize..2500) {
        let mut bytes = written(&recording(5));
        let at = at % bytes.len();
        bytes[at] = byte;
        let _ = read(&bytes);
        bytes.truncate(cut);
        let _ = read(&bytes);
    }
}

#[test]
fn records_of_several_groups_come_apart() {
    let groups = HashMap::from([(1, Length::Fixed(2)), (7, Length::Said)]);
    let data = [1, 10, 11, 7, 3, 0, 0, 0, 97, 98, 99, 1, 12, 13];
    let apart = sorted(&data, 1, &groups).unwrap();
    assert_eq!(apart[&1], [10, 11, 12, 13]);
    assert!(sorted(&data[..13], 1, &groups).unwrap_err().contains("cut off"));
    assert!(sorted(&[2, 0, 0], 1, &groups).unwrap_err().contains("group 2"));
}

#[test]
fn what_is_no_such_file_is_told() {
    let good = written(&recording(5));
    let message = |bytes: &[u8]| read(bytes).unwrap_err().to_string();
    assert!(message(b"time [s],force [N]\n").contains("less than 64 bytes"));
    assert!(message(&[b'x'; 100]).contains("no MDF file"));
    let with = |at: usize, text: &[u8]| {
        let mut bytes = good.clone();
        bytes[at..at + text.len()].copy_from_slice(text);
        message(&bytes)
    };
    assert!(with(0, b"UnFinMF ").contains("has not finished"));
    assert!(with(28, &330u16.to_le_bytes()).contains("version 3.30"));
    assert!(message(&good[..good.len() - 1]).contains("ends within a block"));
    // the first channel's name leads to itself: a ring of channels
    let channel = good.windows(4).position(|w| w == b"##CN").unwrap();
    assert!(with(channel + 24, &(channel as u64).to_le_bytes()).contains("in a ring"));
}
