//! Cross spectra by Welch's method: Hann windows that overlap by half, over several runs.

use super::lines::even_line;
use realfft::RealFftPlanner;
use realfft::num_complex::Complex;
use std::f64::consts::PI;

/// Transforms of the segments of one signal in all runs.
pub struct Lines {
    /// By segment, then by line.
    segments: Vec<Vec<Complex<f64>>>,
    /// Samples of a segment.
    length: usize,
}

/// How many segments runs of these numbers of samples have.
pub fn count(samples: &[usize], length: usize) -> usize {
    samples.iter().filter(|n| **n >= length).map(|n| 1 + (n - length) / (length / 2)).sum()
}

/// As many independent segments tell as much as `segments` Hann windows that overlap by half: the
/// transforms of neighbours correlate by 1/6.
pub fn independent(segments: usize) -> f64 {
    let n = segments as f64;
    n / (1.0 + 2.0 * (n - 1.0).max(0.0) / n.max(1.0) / 36.0)
}

impl Lines {
    /// Transforms a signal: its samples in each run, at equal distances. Every segment loses its straight
    /// line, so that what is slower than it does not leak. All signals of the same runs have the same
    /// segments. `None` if the transform fails.
    pub fn of<'a>(runs: impl IntoIterator<Item = &'a [f64]>, length: usize) -> Option<Self> {
        let transform = RealFftPlanner::<f64>::new().plan_fft_forward(length);
        let window: Vec<f64> =
            (0..length).map(|i| 0.5 - 0.5 * (2.0 * PI * i as f64 / length as f64).cos()).collect();
        let norm = window.iter().map(|w| w * w).sum::<f64>().sqrt();
        let mut input = transform.make_input_vec();
        let mut segments = Vec::new();
        for run in runs {
            let mut start = 0;
            while let Some(samples) = run.get(start..start + length) {
                let (level, slope) = even_line(samples);
                for (i, (value, w)) in samples.iter().zip(&window).enumerate() {
                    input[i] = w * (value - level - slope * i as f64) / norm;
                }
                let mut output = transform.make_output_vec();
                transform.process(&mut input, &mut output).ok()?;
                segments.push(output);
                start += length / 2;
            }
        }
        Some(Self { segments, length })
    }

    /// Number of lines, with that of the mean.
    pub fn count(&self) -> usize {
        self.length / 2 + 1
    }

    /// Number of independent segments.
    pub fn independent(&self) -> f64 {
        independent(self.segments.len())
    }

    /// Mean of the product of a line with that of another signal, conjugated.
    pub fn cross(&self, other: &Self, line: usize) -> Complex<f64> {
        let sum: Complex<f64> =
            self.segments.iter().zip(&other.segments).map(|(a, b)| a[line] * b[line].conj()).sum();
        sum / self.segments.len().max(1) as f64
    }

    /// The share of a line in the mean square of the signal.
    pub fn power(&self, line: usize) -> f64 {
        let sum = self.square(line);
        // inner lines have a counterpart at negative frequencies
        let sides = if line == 0 || line == self.length / 2 { 1.0 } else { 2.0 };
        sides * sum / (self.segments.len().max(1) * self.length) as f64
    }

    /// Squared coherence with another signal on a line, 0 to 1.
    pub fn coherence(&self, other: &Self, line: usize) -> f64 {
        let product = self.square(line) * other.square(line);
        if product > 0.0 {
            (self.cross(other, line).norm_sqr() * (self.segments.len() as f64).powi(2) / product).min(1.0)
        } else {
            0.0
        }
    }

    /// Takes off what follows another signal linearly, line by line; on lines where the other one has less
    /// than `least` (in the unit of its square) nothing is taken.
    pub fn without(&mut self, other: &Self, least: &[f64]) {
        for line in 0..self.count() {
            let square = other.square(line);
            if square <= least.get(line).copied().unwrap_or(0.0) {
                continue;
            }
            let factor = self.cross(other, line) * (self.segments.len() as f64) / square;
            for (own, theirs) in self.segments.iter_mut().zip(&other.segments) {
                own[line] -= factor * theirs[line];
            }
        }
    }

    /// Sum of the squares of a line over the segments.
    pub fn square(&self, line: usize) -> f64 {
        self.segments.iter().map(|s| s[line].norm_sqr()).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::super::SplitMix64;
    use super::*;

    #[test]
    fn lines_add_up_to_the_mean_square() {
        let mut random = SplitMix64::new(3);
        let series: Vec<f64> = (0..20_000).map(|_| 3.0 * random.normal()).collect();
        let lines = Lines::of([&series[..]], 128).unwrap();
        let total: f64 = (0..lines.count()).map(|k| lines.power(k)).sum();
        // the line of every segment is gone: two of 128 degrees of freedom
        assert!((total / 9.0 - 0.98).abs() < 0.04, "{total}");
    }

    #[test]
    fn coherence_is_the_share_of_the_common_part() {
        let mut random = SplitMix64::new(4);
        let common: Vec<f64> = (0..40_000).map(|_| random.normal()).collect();
        let mut with =
            |gain: f64| -> Vec<f64> { common.iter().map(|c| gain * c + random.normal()).collect() };
        let (a, b) = (with(2.0), with(1.0));
        let [a, b] = [a, b].map(|s| Lines::of([&s[..]], 128).unwrap());
        let mean = (2..60).map(|k| a.coherence(&b, k)).sum::<f64>() / 58.0;
        assert!((mean - 0.8 * 0.5).abs() < 0.03, "{mean}");
        // what follows b is gone
        let mut rest = Lines::of([&common[..]], 128).unwrap();
        rest.without(&a, &[]);
        assert!(rest.coherence(&a, 20) < 1e-9);
    }

    #[test]
    fn unrelated_signals_are_as_coherent_as_the_formula_says() {
        let mut random = SplitMix64::new(5);
        let (mut seen, mut trials) = (0.0, 0.0);
        for _ in 0..40 {
            let [a, b] = [0, 1].map(|_| (0..1600).map(|_| random.normal()).collect::<Vec<f64>>());
            let [a, b] = [a, b].map(|s| Lines::of([&s[..]], 128).unwrap());
            for line in (2..62).step_by(3) {
                let p = super::super::chance::coherent(a.coherence(&b, line), a.independent());
                seen += f64::from(u8::from(p < 0.05));
                trials += 1.0;
            }
        }
        assert!((0.03..0.075).contains(&(seen / trials)), "{}", seen / trials);
    }
}
