//! What a sensor adds to a channel: coloured noise and quantisation.

use crate::random::Random;
use std::f64::consts::TAU;

/// Coloured noise: an autoregressive process of first or second order, at the sampling rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// n_k = a\[0\] n_{k-1} + a\[1\] n_{k-2} + e_k
    pub coefficients: [f64; 2],
    /// Standard deviation of n.
    pub deviation: f64,
}

impl Noise {
    /// A colour of its own for this deviation.
    #[must_use]
    pub fn draw(random: &mut Random, deviation: f64) -> Self {
        let coefficients = if random.chance(0.6) {
            [random.within(0.2, 0.85), 0.0]
        } else {
            let (radius, angle) = (random.within(0.5, 0.8), TAU * random.within(0.05, 0.3));
            [2.0 * radius * libm::cos(angle), -radius * radius]
        };
        Self { coefficients, deviation }
    }

    /// Variance of the process over that of its innovations (Yule and Walker).
    #[must_use]
    pub fn gain(&self) -> f64 {
        let [a, b] = self.coefficients;
        (1.0 - b) / ((1.0 + b) * ((1.0 - b) * (1.0 - b) - a * a))
    }

    /// As many values as asked for, from the stationary process.
    #[must_use]
    pub fn values(&self, random: &mut Random, count: usize) -> Vec<f64> {
        const SETTLE: usize = 100;
        let innovation = self.deviation / self.gain().sqrt();
        let mut past = [0.0; 2];
        let mut values = Vec::with_capacity(count + SETTLE);
        for _ in 0..count + SETTLE {
            let next = self.coefficients[0] * past[0]
                + self.coefficients[1] * past[1]
                + innovation * random.normal();
            past = [next, past[0]];
            values.push(next);
        }
        values.split_off(SETTLE)
    }
}

/// A step of 1, 2 or 5 times a power of ten, no larger than `wanted`: (mantissa, exponent).
#[must_use]
pub fn quantum(wanted: f64) -> Quantum {
    let mut exponent = 0_i32;
    let mut power = 1.0;
    while power > wanted {
        power /= 10.0;
        exponent -= 1;
    }
    while power * 10.0 <= wanted {
        power *= 10.0;
        exponent += 1;
    }
    let mantissa = if wanted >= 5.0 * power {
        5
    } else if wanted >= 2.0 * power {
        2
    } else {
        1
    };
    Quantum { mantissa, exponent }
}

/// A resolution in decimal digits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Quantum {
    /// 1, 2 or 5.
    pub mantissa: i32,
    /// Of ten.
    pub exponent: i32,
}

impl Quantum {
    /// The step.
    #[must_use]
    pub fn step(self) -> f64 {
        f64::from(self.mantissa) * libm::pow(10.0, f64::from(self.exponent))
    }

    /// The nearest multiple.
    #[must_use]
    pub fn round(self, value: f64) -> f64 {
        (value / self.step()).round() * self.step()
    }

    /// The nearest multiple as text, with no more digits than it has.
    #[must_use]
    pub fn text(self, value: f64) -> String {
        let digits = usize::try_from(-self.exponent).unwrap_or(0);
        let text = format!("{:.digits$}", self.round(value));
        if text.trim_start_matches('-').chars().all(|c| c == '0' || c == '.') { "0".into() } else { text }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_has_the_deviation_and_correlation_that_it_says() {
        for (seed, coefficients) in [(1, [0.8, 0.0]), (2, [0.9, -0.5]), (3, [0.0, 0.0])] {
            let noise = Noise { coefficients, deviation: 2.0 };
            let values = noise.values(&mut Random::new(seed, 0), 200_000);
            let n = values.len() as f64;
            let variance = values.iter().map(|v| v * v).sum::<f64>() / n;
            assert!((variance.sqrt() - 2.0).abs() < 0.03, "{variance}");
            // lag 1 of Yule and Walker: a / (1 - b)
            let correlation = values.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / n / variance;
            assert!((correlation - coefficients[0] / (1.0 - coefficients[1])).abs() < 0.01, "{correlation}");
        }
    }

    #[test]
    fn every_colour_that_is_drawn_is_stable() {
        let mut random = Random::new(7, 7);
        for _ in 0..1000 {
            let noise = Noise::draw(&mut random, 1.0);
            assert!(noise.gain() > 0.9 && noise.gain() < 20.0, "{noise:?}");
        }
    }

    #[test]
    fn quanta_are_decimal_and_short() {
        for (wanted, step) in [(0.0137, 0.01), (0.0237, 0.02), (7.3, 5.0), (999.0, 500.0), (1.3e-6, 1e-6)] {
            assert!((quantum(wanted).step() / step - 1.0).abs() < 1e-9, "{wanted}");
        }
        assert_eq!(quantum(0.02).text(1.2345), "1.24");
        assert_eq!(quantum(500.0).text(-1_234_567.0), "-1234500");
        assert_eq!(quantum(0.02).text(-0.001), "0");
    }
}
