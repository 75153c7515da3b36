//! Numbers as the shortest text that reads back as the same: the digits of a fast library, in the standard library's form.

use std::fmt::Write as _;

/// Where the standard library begins and ends to write numbers without an exponent.
const SMALL: f64 = 1e-4;
const LARGE: f64 = 1e16;

/// The shortest text that reads back as the same number.
pub(super) fn shortest(number: f64) -> String {
    let mut text = String::new();
    push_shortest(&mut text, number);
    text
}

/// Appends the shortest text that reads back as the same number: to the byte what `{:?}` makes of it, less a `.0` at
/// its end.
pub(super) fn push_shortest(text: &mut String, number: f64) {
    if number == 0.0 || !number.is_finite() || number.abs() >= LARGE {
        push_standard(text, number);
        return;
    }
    let mut buffer = zmij::Buffer::new();
    let digits = buffer.format_finite(number);
    let (mantissa, exponent) = digits.split_once('e').unwrap_or((digits, "0"));
    let (whole, decimals) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if is_halfway(number, decimals.len() as i32 - exponent) {
        push_standard(text, number);
    } else if number.abs() < SMALL && exponent == 0 {
        // zmij has 1.5e-5 as 0.000015
        let digits = decimals.trim_start_matches('0');
        let (first, rest) = digits.split_at(digits.len().min(1));
        text.push_str(whole.trim_end_matches('0'));
        text.push_str(first);
        if !rest.is_empty() {
            text.push('.');
            text.push_str(rest);
        }
        text.push_str("e-5");
    } else {
        text.push_str(digits.strip_suffix(".0").unwrap_or(digits));
    }
}

fn push_standard(text: &mut String, number: f64) {
    // writing to a text does not fail
    let _ = write!(text, "{number:?}");
    if text.ends_with(".0") {
        text.truncate(text.len() - 2);
    }
}

/// Whether a number lies in the middle between two texts of so many decimals: the standard library then takes the
/// upper one, zmij the even one. In binary an odd number times 2^-n has n decimals, the last of them a 5.
fn is_halfway(number: f64, decimals: i32) -> bool {
    let bits = number.to_bits();
    let exponent = (bits >> 52 & 0x7ff) as i32;
    let mantissa = (bits & ((1 << 52) - 1)) | (u64::from(exponent > 0) << 52);
    let lowest = exponent.max(1) - 1075 + mantissa.trailing_zeros() as i32;
    -lowest == decimals + 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// What numbers were written as before there was a faster way.
    fn plain(number: f64) -> String {
        let text = format!("{number:?}");
        text.strip_suffix(".0").unwrap_or(&text).into()
    }

    #[test]
    fn numbers_are_written_as_the_standard_library_has_them() {
        // the ends of notations, signs, the smallest and largest, what is not finite
        for number in [
            0.0,
            -0.0,
            1.0,
            -1.0,
            0.1,
            100.0,
            1e15,
            1e16,
            1.5e16,
            -1e17,
            9007199254740993.0,
            1e22,
            1e300,
            f64::MAX,
            1e-4,
            9.999999999999999e-5,
            1e-5,
            -1e-5,
            1.5e-5,
            9.999999999999999e-6,
            1e-6,
            -1.25e-7,
            1e-10,
            5e-324,
            f64::MIN_POSITIVE,
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
        ] {
            assert_eq!(shortest(number), plain(number));
        }
        // in the middle between two of the shortest texts, as numbers of single precision can be
        for (number, text) in [
            (4220181.0 / 32768.0, "128.78970336914063"),
            (2_f64.powi(49) + 0.25, "562949953421312.3"),
            (f64::from(0.157_550_81_f32), "0.15755081176757813"),
            (2_f64.powi(-25), "2.9802322387695313e-8"),
        ] {
            assert_eq!(shortest(number), text);
            assert_eq!(plain(number), text);
        }
        for exponent in 0..2047_u64 {
            for mantissa in [0, 1, 2, 3, 1 << 51, (1 << 52) - 2, (1 << 52) - 1] {
                let number = f64::from_bits(exponent << 52 | mantissa);
                assert_eq!(shortest(number), plain(number));
            }
        }
    }

    proptest! {
        #[test]
        fn any_number_is_written_as_the_standard_library_has_it(bits: u64, single: f32, whole: i64, power in 0..90) {
            let short = (whole >> 30) as f64 * 0.5_f64.powi(power);
            for number in [f64::from_bits(bits), f64::from(single), whole as f64, whole as f64 * 1e-9, short] {
                prop_assert_eq!(shortest(number), plain(number));
            }
        }
    }
}
