//! Values between samples, linear, and how far samples are apart.

use super::robust::median;

/// How far outside a recording, as a share of its first or last interval, a time still counts as
/// its first or last: clocks that add up steps miss the end by rounding.
const END_TOLERANCE: f64 = 1e-6;

/// True if `t` lies within the samples, or outside by no more than rounding.
pub fn within(time: &[f64], t: f64) -> bool {
    match time {
        [] => false,
        [only] => t == *only,
        [first, second, ..] => {
            let n = time.len();
            let (before, last) = (time[n - 2], time[n - 1]);
            t >= first - END_TOLERANCE * (second - first) && t <= last + END_TOLERANCE * (last - before)
        }
    }
}

/// Index of the interval that begins at or contains `t`; for the end of the recording the last one.
fn interval(time: &[f64], t: f64) -> Option<usize> {
    let last = time.len().checked_sub(2)?;
    within(time, t).then(|| time.partition_point(|x| *x <= t).saturating_sub(1).min(last))
}

/// The value at time `t` \[s\], linear between samples. `time` increases strictly.
///
/// Outside the samples the value is NaN, which every model refuses: [`Recording::covers`](crate::recording::Recording::covers) says
/// beforehand, in words, whether that can happen.
pub fn interpolate(time: &[f64], values: &[f64], t: f64) -> f64 {
    let Some(i) = interval(time, t) else {
        return if time == [t] { values[0] } else { f64::NAN };
    };
    let share = ((t - time[i]) / (time[i + 1] - time[i])).clamp(0.0, 1.0);
    // this form gives the samples exactly
    values[i] * (1.0 - share) + values[i + 1] * share
}

/// The slope \[1/s\] of the interval between samples that begins at or contains time `t` \[s\]; at the
/// end of the recording that of the last interval, outside NaN.
///
/// It is the derivative that an input needs as long as no sample lies within a communication step.
pub fn slope(time: &[f64], values: &[f64], t: f64) -> f64 {
    match interval(time, t) {
        Some(i) => (values[i + 1] - values[i]) / (time[i + 1] - time[i]),
        None => f64::NAN,
    }
}

/// The median distance of times that increase; NaN for fewer than two.
pub fn median_interval(time: &[f64]) -> f64 {
    median(&time.windows(2).map(|w| w[1] - w[0]).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interpolates_between_samples_and_nowhere_else() {
        let (time, values) = ([0.0, 0.1, 0.3], [5.0, 7.0, 3.0]);
        for (t, value, rate) in
            [(0.0, 5.0, 20.0), (0.05, 6.0, 20.0), (0.1, 7.0, -20.0), (0.2, 5.0, -20.0), (0.3, 3.0, -20.0)]
        {
            assert!((interpolate(&time, &values, t) - value).abs() < 1e-12, "{t}");
            assert!((slope(&time, &values, t) - rate).abs() < 1e-9, "{t}");
        }
        for t in [-0.01, 0.31, f64::NAN, f64::INFINITY] {
            assert!(interpolate(&time, &values, t).is_nan(), "{t}");
            assert!(slope(&time, &values, t).is_nan(), "{t}");
        }
        // three tenths added up are a little more than the last sample
        assert_eq!(interpolate(&time, &values, 0.1 + 0.1 + 0.1), 3.0);
        assert_eq!(interpolate(&[2.0], &[9.0], 2.0), 9.0);
        assert!(interpolate(&[], &[], 0.0).is_nan());
    }

    #[test]
    fn a_gap_does_not_move_the_median_interval() {
        assert!((median_interval(&[0.0, 0.1, 0.2, 5.0, 5.1]) - 0.1).abs() < 1e-12);
        // of an even number of intervals the upper one of the two in the middle
        assert_eq!(median_interval(&[0.0, 1.0, 3.0]), 2.0);
        assert!(median_interval(&[3.0]).is_nan());
    }
}
