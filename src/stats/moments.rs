//! Means and what is about them.

/// The mean; NaN of nothing.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The mean; 0 of nothing.
pub fn mean_or_zero(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// The sum of squared distances from the mean; 0 of nothing.
pub fn about_mean(values: &[f64]) -> f64 {
    let mean = mean_or_zero(values);
    values.iter().map(|v| (v - mean).powi(2)).sum()
}

/// The standard deviation about the mean, that of the values themselves (over n, not n - 1); NaN of nothing.
pub fn deviation(values: &[f64]) -> f64 {
    (about_mean(values) / values.len() as f64).sqrt()
}

/// The root of the mean square; 0 of nothing.
pub fn root_mean_square(values: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, n) = values.into_iter().fold((0.0, 0.0), |(sum, n), v| (sum + v * v, n + 1.0));
    (sum / f64::max(n, 1.0)).sqrt()
}

/// The correlation coefficient, 0 where one of the two does not vary.
pub fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let (mean_a, mean_b) = (mean(a), mean(b));
    let (mut aa, mut bb, mut ab) = (0.0, 0.0, 0.0);
    for (a, b) in a.iter().zip(b) {
        let (a, b) = (a - mean_a, b - mean_b);
        aa += a * a;
        bb += b * b;
        ab += a * b;
    }
    let scale = (aa * bb).sqrt();
    if scale > 0.0 { ab / scale } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(value: f64, expected: f64) {
        assert!((value - expected).abs() <= 1e-12 * expected.abs(), "{value} {expected}");
    }

    #[test]
    fn moments_of_whole_numbers_are_those_of_the_formulas() {
        // 1..n: mean (n + 1) / 2, variance (n^2 - 1) / 12, mean square (n + 1) (2 n + 1) / 6
        let n = 101.0;
        let values: Vec<f64> = (1..=101).map(f64::from).collect();
        near(mean(&values), 51.0);
        near(mean_or_zero(&values), 51.0);
        near(about_mean(&values), n * (n * n - 1.0) / 12.0);
        near(deviation(&values), f64::sqrt((n * n - 1.0) / 12.0));
        near(root_mean_square(values.iter().copied()), f64::sqrt((n + 1.0) * (2.0 * n + 1.0) / 6.0));
    }

    #[test]
    fn nothing_has_no_mean_and_no_size() {
        assert!(mean(&[]).is_nan() && deviation(&[]).is_nan());
        assert_eq!((mean_or_zero(&[]), about_mean(&[]), root_mean_square([])), (0.0, 0.0, 0.0));
    }

    #[test]
    fn correlation_is_the_cosine_between_deviations() {
        let values: Vec<f64> = (0..360).map(|i| f64::from(i).to_radians()).collect();
        let course = |phase: f64| values.iter().map(|x| 7.0 + 3.0 * (x + phase).sin()).collect::<Vec<_>>();
        for phase in [0.0, 0.3, 1.0, 2.0, 3.0] {
            assert!((correlation(&course(0.0), &course(phase)) - phase.cos()).abs() < 1e-12, "{phase}");
        }
        assert_eq!(correlation(&values, &[5.0; 360]), 0.0);
    }
}
