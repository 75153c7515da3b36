//! Straight lines through values, by least squares.

use super::moments::{mean, mean_or_zero};

/// A straight line through points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Its slope.
    pub slope: f64,
    /// The standard error of the slope, for errors of the points that are independent and alike.
    pub error: f64,
}

impl Line {
    /// By least squares; `None` for fewer than three points or if `x` does not vary.
    pub fn through(x: &[f64], y: &[f64]) -> Option<Self> {
        let (mean_x, mean_y) = (mean(x), mean(y));
        let xx: f64 = x.iter().map(|x| (x - mean_x).powi(2)).sum();
        if x.len() < 3 || xx.is_nan() || xx <= 0.0 {
            return None;
        }
        let slope = x.iter().zip(y).map(|(x, y)| (x - mean_x) * (y - mean_y)).sum::<f64>() / xx;
        let left: f64 = x.iter().zip(y).map(|(x, y)| (y - mean_y - slope * (x - mean_x)).powi(2)).sum();
        Some(Self { slope, error: (left / (x.len() - 2) as f64 / xx).sqrt() })
    }
}

/// The line through values at equal distances: level at the first and slope per value.
pub fn even_line(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let middle = (n - 1.0) / 2.0;
    let mean = mean(values);
    let slope = values.iter().enumerate().map(|(i, v)| (i as f64 - middle) * v).sum::<f64>()
        / (n * (n * n - 1.0) / 12.0);
    (mean - slope * middle, slope)
}

/// The sum of squared distances of values at equal distances from the line through them.
pub fn about_line(values: &[f64]) -> f64 {
    let n = values.len().max(1) as f64;
    let (mean, middle) = (mean_or_zero(values), 0.5 * (n - 1.0));
    let (mut along, mut length, mut square) = (0.0, 0.0, 0.0);
    for (k, v) in values.iter().enumerate() {
        let x = k as f64 - middle;
        along += x * (v - mean);
        length += x * x;
        square += (v - mean).powi(2);
    }
    if length > 0.0 { (square - along * along / length).max(0.0) } else { square }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_on_a_line_is_found() {
        let x: Vec<f64> = (0..30).map(|i| 0.3 * f64::from(i * i)).collect();
        let y: Vec<f64> = x.iter().map(|x| 4.0 - 2.5 * x).collect();
        let line = Line::through(&x, &y).unwrap();
        assert!((line.slope + 2.5).abs() < 1e-12 && line.error < 1e-12, "{line:?}");
        let even: Vec<f64> = (0..30).map(|i| 4.0 - 2.5 * f64::from(i)).collect();
        let (level, slope) = even_line(&even);
        assert!((level - 4.0).abs() < 1e-12 && (slope + 2.5).abs() < 1e-12, "{level} {slope}");
        assert!(about_line(&even) < 1e-20);
        assert_eq!((about_line(&[]), about_line(&[7.0])), (0.0, 0.0));
        assert_eq!(Line::through(&[1.0; 5], &even[..5]), None);
        assert_eq!(Line::through(&even[..2], &even[..2]), None);
    }

    #[test]
    fn errors_that_alternate_leave_what_the_formulas_say() {
        // +1 -1 -1 +1 has neither mean nor slope: what is left is all of it, and the slope's standard error is
        // sqrt(4 / (n - 2) / sum of squares of x about their mean)
        let off = [1.0, -1.0, -1.0, 1.0];
        let x = [0.0, 1.0, 2.0, 3.0];
        let y: Vec<f64> = x.iter().zip(off).map(|(x, e)| 10.0 + 3.0 * x + e).collect();
        let line = Line::through(&x, &y).unwrap();
        assert!((line.slope - 3.0).abs() < 1e-12 && (line.error - f64::sqrt(4.0 / 2.0 / 5.0)).abs() < 1e-12);
        let (level, slope) = even_line(&y);
        assert!((level - 10.0).abs() < 1e-12 && (slope - 3.0).abs() < 1e-12, "{level} {slope}");
        assert!((about_line(&y) - 4.0).abs() < 1e-12);
    }
}
