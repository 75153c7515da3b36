//! [`Smooth`]: a recorded channel between its samples.

/// A smooth course through the samples of a channel: cubic pieces whose slopes are Akima's in their modified
/// form (a mean of the neighbouring slopes, with weights that keep what is straight or at rest so up to the sample
/// where it begins to move). A sampled sine is met several times closer than by straight lines, and nothing
/// overshoots beside a step.
///
/// H. Akima, "A new method of interpolation and smooth curve fitting based on local procedures",
/// Journal of the ACM 17 (1970) 589.
pub struct Smooth<'a> {
    time: &'a [f64],
    values: &'a [f64],
    slopes: Vec<f64>,
}

impl<'a> Smooth<'a> {
    /// Through these samples; `time` \[s\] rises.
    pub fn new(time: &'a [f64], values: &'a [f64]) -> Self {
        let n = time.len().min(values.len());
        let mut of: Vec<f64> =
            (1..n).map(|k| (values[k] - values[k - 1]) / (time[k] - time[k - 1])).collect();
        // beyond the ends the slope goes on as it changed last
        for _ in 0..2 {
            if let [first, rest @ ..] = &of[..] {
                let second = rest.first().unwrap_or(first);
                let last = of[of.len() - 1];
                let before = of[of.len().saturating_sub(2)];
                let (head, tail) = (2.0 * first - second, 2.0 * last - before);
                of.insert(0, head);
                of.push(tail);
            }
        }
        let slope = |k: usize| {
            let Some([a, b, c, d]) = of.get(k..k + 4) else { return 0.0 };
            let left = (d - c).abs() + 0.5 * (d + c).abs();
            let right = (b - a).abs() + 0.5 * (b + a).abs();
            if left + right > 0.0 { (left * b + right * c) / (left + right) } else { 0.0 }
        };
        Self { time, values, slopes: (0..n).map(slope).collect() }
    }

    /// The value at a time \[s\]; before the first sample and behind the last theirs.
    pub fn at(&self, t: f64) -> f64 {
        let n = self.slopes.len();
        let next = self.time.partition_point(|s| *s <= t);
        if next == 0 || next >= n {
            return self.values.get(next.min(n.saturating_sub(1))).copied().unwrap_or(f64::NAN);
        }
        let k = next - 1;
        let length = self.time[next] - self.time[k];
        let x = (t - self.time[k]) / length;
        let (a, b) = (self.values[k], self.values[next]);
        let (da, db) = (self.slopes[k] * length, self.slopes[next] * length);
        let rest = 1.0 - x;
        a * rest * rest * (1.0 + 2.0 * x) + b * x * x * (3.0 - 2.0 * x) + x * rest * (da * rest - db * x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(n: usize) -> f64 {
        let time: Vec<f64> = (0..=n).map(|k| k as f64 / n as f64).collect();
        let values: Vec<f64> = time.iter().map(|t| (5.0 * t).sin()).collect();
        let smooth = Smooth::new(&time, &values);
        (0..1000)
            .map(|k| f64::from(k) / 999.0)
            .map(|t| (smooth.at(t) - (5.0 * t).sin()).abs())
            .fold(0.0, f64::max)
    }

    #[test]
    fn a_sine_is_met_closer_than_by_straight_lines() {
        // straight lines: 25 h^2 / 8
        for n in [40, 80, 160] {
            assert!(error(n) < 0.3 * 25.0 / 8.0 / (n * n) as f64, "{n}: {}", error(n));
        }
    }

    #[test]
    fn meets_samples_and_does_not_overshoot_beside_a_step() {
        let time: Vec<f64> = (0..12).map(|k| f64::from(k) * 0.1).collect();
        let values: Vec<f64> = (0..12).map(|k| if k < 6 { 1.0 } else { 3.0 }).collect();
        let smooth = Smooth::new(&time, &values);
        for k in 0..=110 {
            let v = smooth.at(f64::from(k) * 0.01);
            assert!((1.0 - 1e-12..=3.0 + 1e-12).contains(&v), "{k}: {v}");
        }
        for (t, v) in time.iter().zip(&values) {
            assert_eq!(smooth.at(*t), *v);
        }
        assert_eq!((smooth.at(-1.0), smooth.at(9.0)), (1.0, 3.0));
        let line = Smooth::new(&[0.0, 1.0], &[2.0, 4.0]);
        assert!((line.at(0.25) - 2.5).abs() < 1e-12);
    }
}
