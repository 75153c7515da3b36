//! The scale of a plot's axis: what it spans, and its labels.

use super::plot::Axis;
use crate::shown::with_unit;
use crate::stats::extent;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use std::ops::Range;

/// Spans below this, relative to the size of the values or absolute, are rounding: a constant.
const ROUNDING: f64 = 1e-10;
const NOTHING: f64 = 1e-13;

/// One axis: span, places of the labels and how they are written.
#[derive(Clone)]
pub struct Scale {
    pub low: f64,
    pub high: f64,
    pub ticks: Vec<f64>,
    pub decimals: usize,
    /// Labels are in this power of ten of the unit.
    pub exponent: i32,
    /// What the numbers 1, 2, ... are called, if they are names.
    names: Vec<String>,
}

impl Scale {
    /// A scale over finite values with about `count` labels; `round` widens it to the next labels.
    pub fn new(values: impl Iterator<Item = f64>, count: usize, round: bool) -> Self {
        let (mut low, mut high) = extent(values);
        let size = low.abs().max(high.abs());
        if high - low <= (ROUNDING * size).max(NOTHING) {
            let margin = if size > NOTHING { 0.1 * size } else { 1.0 };
            (low, high) = (low - margin, high + margin);
        }
        let raw = (high - low) / count.max(2) as f64;
        let power = 10_f64.powf(raw.log10().floor());
        let step = [1.0, 2.0, 5.0].into_iter().find(|m| m * power >= 0.999 * raw).unwrap_or(10.0) * power;
        let (first, last) = if round {
            ((low / step + 1e-9).floor(), (high / step - 1e-9).ceil())
        } else {
            ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor())
        };
        if round {
            (low, high) = (first * step, last * step);
        }
        let ticks: Vec<f64> = (0..=(last - first) as usize).map(|i| (first + i as f64) * step).collect();
        let size = low.abs().max(high.abs());
        let exponent = exponent_of(size);
        let decimals = (-(step / 10_f64.powi(exponent)).log10() - 1e-9).ceil().max(0.0) as usize;
        Self { low, high, ticks, decimals, exponent, names: Vec::new() }
    }

    /// A scale of what 1, 2, ... are called.
    pub fn of_names(names: &[String]) -> Self {
        let ticks = (1..=names.len()).map(|k| k as f64).collect();
        Self {
            low: 0.5,
            high: names.len() as f64 + 0.5,
            ticks,
            decimals: 0,
            exponent: 0,
            names: names.to_vec(),
        }
    }

    /// A scale over finite values with about ten labels, or as many as have room beside each other: `room` is
    /// the length of the axis in heights of letters.
    pub fn beside(values: impl Iterator<Item = f64> + Clone, room: f64) -> Self {
        let fits = |scale: &Self| {
            let longest = scale.ticks.iter().map(|t| scale.label(*t).chars().count()).max().unwrap_or(0);
            // a digit is a little more than half as wide as it is high, and two of them are kept between labels
            scale.ticks.len() as f64 * 0.6 * (longest as f64 + 2.0) <= room
        };
        let scale = |count: usize| Self::new(values.clone(), count, false);
        (2..=10).rev().map(scale).find(fits).unwrap_or_else(|| scale(2))
    }

    pub fn label(&self, value: f64) -> String {
        if let Some(name) = called(&self.names, value) {
            return name.into();
        }
        let text = format!("{:.*}", self.decimals, value / 10_f64.powi(self.exponent));
        let is_zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
        if is_zero { text.replace('-', "") } else { text.replace('-', "−") }
    }

    pub fn title(&self, axis: &Axis) -> String {
        if !self.names.is_empty() {
            return axis.quantity.clone();
        }
        title(&axis.quantity, &axis.unit, self.exponent)
    }
}

/// What a value is called, if 1, 2, ... have names.
pub fn called(names: &[String], value: f64) -> Option<&str> {
    names.get((value as usize).checked_sub(1)?).map(String::as_str)
}

/// The power of ten in which numbers of this size are short; 0 where they are as they are.
pub fn exponent_of(size: f64) -> i32 {
    if size == 0.0 || !size.is_finite() || (0.01..1e5).contains(&size) {
        0
    } else {
        3 * (size.log10() / 3.0).floor() as i32
    }
}

/// A quantity with its unit, times a power of ten: `q [10⁻⁶ N]`.
pub fn title(quantity: &str, unit: &str, exponent: i32) -> String {
    if exponent == 0 {
        return format!("{quantity} [{unit}]");
    }
    let digit = |c| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        c => char::from_u32('⁰' as u32 + c as u32 - '0' as u32).unwrap_or(c),
    };
    let power: String = exponent.to_string().chars().map(digit).collect();
    format!("{quantity} [{}]", with_unit(format_args!("10{power}"), unit))
}

impl Ranged for Scale {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (start, end): (i32, i32)) -> i32 {
        let share = (value - self.low) / (self.high - self.low);
        start + (share * f64::from(end - start)).round() as i32
    }

    fn key_points<H: KeyPointHint>(&self, hint: H) -> Vec<f64> {
        if hint.weight().allow_light_points() { Vec::new() } else { self.ticks.clone() }
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

impl ValueFormatter<f64> for Scale {
    fn format(value: &f64) -> String {
        value.to_string()
    }

    fn format_ext(&self, value: &f64) -> String {
        self.label(*value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_are_round_and_short() {
        let labels = |values: &[f64], count| {
            let scale = Scale::new(values.iter().copied(), count, true);
            let labels: Vec<String> = scale.ticks.iter().map(|t| scale.label(*t)).collect();
            (labels.join(" "), scale.title(&Axis::new("q", "N")))
        };
        for (values, text, title) in [
            (&[-4200.0, 5100.0][..], "−6000 −4000 −2000 0 2000 4000 6000", "q [N]"),
            (&[0.0, 0.3], "0.0 0.1 0.2 0.3", "q [N]"),
            (&[-0.04, 0.03], "−0.04 −0.02 0.00 0.02 0.04", "q [N]"),
            (&[0.0, 2.1e5], "0 50 100 150 200 250", "q [10³ N]"),
            (&[0.0, 3e-6], "0 1 2 3", "q [10⁻⁶ N]"),
            (&[5.0], "4.4 4.6 4.8 5.0 5.2 5.4 5.6", "q [N]"),
            (&[5.0, 5.0 + 1e-14], "4.4 4.6 4.8 5.0 5.2 5.4 5.6", "q [N]"),
            (&[0.0], "−1.0 −0.5 0.0 0.5 1.0", "q [N]"),
        ] {
            assert_eq!(labels(values, 5), (text.into(), title.into()), "{values:?}");
        }
        // time ends where the data end
        let time = Scale::new([0.0, 2.57].into_iter(), 5, false);
        assert_eq!((time.low, time.high, time.ticks.last().copied()), (0.0, 2.57, Some(2.0)));
    }
}
