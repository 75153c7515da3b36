//! Numbers as people read them on a terminal.

/// A number with so many digits, or as many as stand before the point; a dash if it is none.
pub(super) fn digits(value: f64, count: u8) -> String {
    if !value.is_finite() {
        return "-".into();
    }
    let before = if value == 0.0 { f64::from(count) } else { value.abs().log10().floor() + 1.0 };
    let decimals = (f64::from(count) - before).clamp(0.0, 12.0) as usize;
    format!("{value:.decimals$}")
}

/// The same, with a power of ten where there would be many zeros: below a thousandth, and from ten million on.
pub(super) fn short(value: f64, count: u8) -> String {
    if value == 0.0 || !value.is_finite() || (1e-3..1e7).contains(&value.abs()) {
        return digits(value, count);
    }
    format!("{value:.*e}", usize::from(count).saturating_sub(1))
}

#[cfg(test)]
mod tests {
    use super::{digits, short};

    #[test]
    fn numbers_have_the_digits_that_are_asked_for_and_no_power_of_ten() {
        let three = |value: f64| digits(value, 3);
        assert_eq!([5.4596, 0.0090473, 15781.2, -0.15316].map(three), ["5.46", "0.00905", "15781", "-0.153"]);
        assert_eq!([0.0, f64::NAN].map(three), ["0", "-"]);
        assert_eq!(digits(2.0_f64.sqrt(), 5), "1.4142");
        let of = [8.49389e-7, -2.5e8, 0.001, 166_021.4, 0.0];
        assert_eq!(of.map(|v| short(v, 3)), ["8.49e-7", "-2.50e8", "0.00100", "166021", "0"]);
    }
}
