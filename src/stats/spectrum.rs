//! Amplitude spectra over frequency, and over orders of a rotation.

use super::{interpolate, mean, median_interval};
use realfft::RealFftPlanner;
use std::f64::consts::PI;

/// A segment is at least so long: what the published loads were compared with (Mack 2009, L2243).
const SHORTEST: usize = 512;
/// A longer one resolves more than a plot shows.
const LONGEST: usize = 8192;
/// More samples than this are not made of a recording with wildly uneven times.
const MOST_SAMPLES: usize = 4_000_000;

/// Amplitudes at equally spaced frequencies or orders, the first at 0.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Spectrum {
    /// Distance of two lines: \[Hz\], or in orders.
    pub spacing: f64,
    /// Amplitudes of the lines, in the unit of the values: a sine of amplitude 1 on a line has 1 there.
    pub amplitudes: Vec<f64>,
}

impl Spectrum {
    /// The frequencies or orders of the lines.
    pub fn places(&self) -> Vec<f64> {
        (0..self.amplitudes.len()).map(|i| i as f64 * self.spacing).collect()
    }
}

/// The single-sided amplitude spectrum of values at equal distances `step` \[s, or revolutions\].
///
/// The mean is taken off; Hamming windows of a power of two of samples that overlap by half, at least 512
/// (shorter series are filled up with zeros), otherwise about a quarter of the series, at most 8192;
/// 2|X| / sum of the window; root mean square over the windows. `None` for fewer than 16 values or
/// if one of them is not finite.
pub fn spectrum(values: &[f64], step: f64) -> Option<Spectrum> {
    if values.len() < 16 || !(step > 0.0 && step.is_finite()) || values.iter().any(|v| !v.is_finite()) {
        return None;
    }
    let n = (values.len() / 4).next_power_of_two().clamp(SHORTEST, LONGEST);
    let filled = n.min(values.len());
    let mean = mean(values);
    let window: Vec<f64> =
        (0..filled).map(|i| 0.54 - 0.46 * (2.0 * PI * i as f64 / (filled - 1) as f64).cos()).collect();
    let weight: f64 = window.iter().sum();

    let transform = RealFftPlanner::<f64>::new().plan_fft_forward(n);
    let (mut input, mut output) = (transform.make_input_vec(), transform.make_output_vec());
    let mut squares = vec![0.0; output.len()];
    let starts: Vec<usize> = (0..=values.len() - filled).step_by((filled / 2).max(1)).collect();
    for start in &starts {
        input.fill(0.0);
        for (i, w) in window.iter().enumerate() {
            input[i] = w * (values[start + i] - mean);
        }
        transform.process(&mut input, &mut output).ok()?;
        for (square, line) in squares.iter_mut().zip(&output) {
            *square += line.norm_sqr();
        }
    }
    let lines = squares.len();
    let amplitudes = squares.iter().enumerate().map(|(i, square)| {
        // the mean and the highest line have no counterpart at negative frequencies
        let sides = if i == 0 || i == lines - 1 { 1.0 } else { 2.0 };
        sides * (square / starts.len() as f64).sqrt() / weight
    });
    Some(Spectrum { spacing: 1.0 / (n as f64 * step), amplitudes: amplitudes.collect() })
}

/// The spectrum over frequency \[Hz\] of values at times \[s\] that increase; uneven ones are made even, at
/// the distance of most samples, linear between them. `None` as for [`spectrum`].
pub fn over_time(time: &[f64], values: &[f64]) -> Option<Spectrum> {
    let (time, values) = finite(time, values);
    let step = median_interval(&time);
    let even = resample(&time, &values, step)?;
    spectrum(&even, step)
}

/// The spectrum over the orders of a rotation, from its angle \[rad\] at each value; the angle must grow or
/// fall throughout. As many values a revolution as there are samples on average. `None` as for
/// [`spectrum`], or if the angle turns back or covers less than four revolutions.
pub fn over_angle(angle: &[f64], values: &[f64]) -> Option<Spectrum> {
    let (angle, values) = finite(angle, values);
    let (first, last) = (*angle.first()?, *angle.last()?);
    let sign = (last - first).signum();
    // a rotation that rests now and then has several values at one angle: the first counts
    let mut turns: Vec<f64> = Vec::with_capacity(angle.len());
    let mut kept: Vec<f64> = Vec::with_capacity(angle.len());
    for (angle, value) in angle.iter().zip(&values) {
        let turn = sign * (angle - first) / (2.0 * PI);
        match turns.last() {
            Some(before) if turn < before - 0.02 => return None,
            Some(before) if turn <= *before => {}
            _ => {
                turns.push(turn);
                kept.push(*value);
            }
        }
    }
    let total = *turns.last()?;
    if total < 4.0 {
        return None;
    }
    let step = total / (turns.len() - 1) as f64;
    spectrum(&resample(&turns, &kept, step)?, step)
}

/// The pairs of which both are finite.
fn finite(places: &[f64], values: &[f64]) -> (Vec<f64>, Vec<f64>) {
    places.iter().zip(values).filter(|(p, v)| p.is_finite() && v.is_finite()).unzip()
}

/// Values at equal distances, from the first place on.
fn resample(places: &[f64], values: &[f64], step: f64) -> Option<Vec<f64>> {
    let (first, last) = (*places.first()?, *places.last()?);
    let count = (last - first) / step * (1.0 + 1e-12);
    if count.is_nan() || count >= MOST_SAMPLES as f64 {
        return None;
    }
    let even: Vec<f64> = (0..=count as usize)
        .map(|i| interpolate(places, values, (first + i as f64 * step).min(last)))
        .collect();
    even.iter().all(|v| v.is_finite()).then_some(even)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn highest(s: &Spectrum) -> (f64, f64) {
        let (i, a) = s.amplitudes.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).unwrap();
        (i as f64 * s.spacing, *a)
    }

    #[test]
    fn a_sine_on_a_line_has_its_amplitude_there() {
        // 1 kHz, 512 samples: lines every 1.953 Hz, as in the source
        let spacing = 1000.0 / 512.0;
        let f = 20.0 * spacing;
        let values: Vec<f64> =
            (0..2000).map(|i| 7.0 + 3.0 * (2.0 * PI * f * f64::from(i) * 1e-3).sin()).collect();
        let s = spectrum(&values, 1e-3).unwrap();
        assert_eq!(s.spacing, spacing);
        let (place, amplitude) = highest(&s);
        assert!((place - f).abs() < 1e-9 && (amplitude - 3.0).abs() < 2e-3, "{place} {amplitude}");
        // the mean is gone, and so is everything away from the line
        assert!(s.amplitudes[0] < 0.05 && s.amplitudes[100] < 0.02, "{:?}", &s.amplitudes[..3]);
    }

    #[test]
    fn it_is_the_sum_that_the_definition_says() {
        let values: Vec<f64> = (0..40).map(|i| f64::from(i * i % 17)).collect();
        let s = spectrum(&values, 0.1).unwrap();
        let mean = values.iter().sum::<f64>() / 40.0;
        let w = |i: usize| 0.54 - 0.46 * (2.0 * PI * i as f64 / 39.0).cos();
        let k = 37.0;
        let [re, im] = [f64::cos, f64::sin].map(|f| {
            (0..40).map(|i| w(i) * (values[i] - mean) * f(2.0 * PI * k * i as f64 / 512.0)).sum::<f64>()
        });
        let expected = 2.0 * re.hypot(im) / (0..40).map(w).sum::<f64>();
        assert!((s.amplitudes[37] - expected).abs() < 1e-12, "{} {expected}", s.amplitudes[37]);
    }

    #[test]
    fn uneven_times_and_missing_values_are_bridged() {
        let time: Vec<f64> = (0..4000)
            .map(|i| f64::from(i) * 1e-3 + 2e-4 * f64::from(i % 3))
            .filter(|t| !(1.0..1.02).contains(t))
            .collect();
        let mut values: Vec<f64> = time.iter().map(|t| 2.0 * (2.0 * PI * 12.0 * t).cos()).collect();
        values[700] = f64::NAN;
        let (place, amplitude) = highest(&over_time(&time, &values).unwrap());
        assert!((place - 12.0).abs() < 1.0 && (amplitude - 2.0).abs() < 0.3, "{place} {amplitude}");
    }

    #[test]
    fn a_second_order_stays_one_while_the_speed_changes() {
        for sign in [1.0, -1.0] {
            let time: Vec<f64> = (0..5000).map(|i| f64::from(i) * 2e-3).collect();
            let angle: Vec<f64> = time.iter().map(|t| sign * (20.0 * t + 4.0 * t * t)).collect();
            let values: Vec<f64> = angle.iter().map(|a| 5.0 * (2.0 * a).sin()).collect();
            let (order, amplitude) = highest(&over_angle(&angle, &values).unwrap());
            assert!((order - 2.0).abs() < 0.06 && (amplitude - 5.0).abs() < 0.4, "{order} {amplitude}");
            // over frequency it smears
            let (_, amplitude) = highest(&over_time(&time, &values).unwrap());
            assert!(amplitude < 2.5, "{amplitude}");
        }
    }

    #[test]
    fn what_is_too_little_has_no_spectrum() {
        assert_eq!(spectrum(&[1.0; 15], 1.0), None);
        assert_eq!(spectrum(&[1.0; 64], 0.0), None);
        assert_eq!(over_time(&[], &[]), None);
        assert_eq!(over_time(&[0.0, 1.0], &[f64::NAN; 2]), None);
        let back: Vec<f64> = (0..300).map(|i| 40.0 * (f64::from(i) * 0.05).sin()).collect();
        assert_eq!(over_angle(&back, &back), None);
        let still = vec![1.0; 300];
        assert_eq!(over_angle(&still, &still), None);
        assert!(spectrum(&[2.0; 64], 1.0).unwrap().amplitudes.iter().all(|a| *a == 0.0));
    }
}
