//! Statistics that a few odd samples or runs do not move.

/// From the median absolute deviation to the standard deviation of a normal distribution.
const MAD_TO_SIGMA: f64 = 1.4826;

/// The quantile `q` (0 to 1) of `values` (NaN left out), the sample nearest to it; NaN if there is none.
pub fn quantile(values: &[f64], q: f64) -> f64 {
    let mut kept: Vec<f64> = values.iter().copied().filter(|v| !v.is_nan()).collect();
    if kept.is_empty() {
        return f64::NAN;
    }
    let i = ((kept.len() - 1) as f64 * q).round() as usize;
    *kept.select_nth_unstable_by(i, f64::total_cmp).1
}

/// What is not above a share `part / parts` of `sorted` (smallest first): the sample at that place or, between two
/// samples, the lower one; NaN if there is none. [`quantile`] is the nearer one.
pub fn quantile_below(sorted: &[f64], part: usize, parts: usize) -> f64 {
    let place = sorted.len().checked_sub(1).map(|last| part * last / parts.max(1));
    place.and_then(|i| sorted.get(i)).copied().unwrap_or(f64::NAN)
}

/// The median (NaN left out): of an even number of values the upper one of the two in the middle, so that it is always
/// one of them; NaN if there is none.
pub fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

/// The standard deviation that the median absolute deviation stands for.
pub fn spread(values: &[f64]) -> f64 {
    let middle = median(values);
    MAD_TO_SIGMA * median(&values.iter().map(|v| (v - middle).abs()).collect::<Vec<_>>())
}

/// The lowest and the highest value; of nothing infinite, the wrong way round.
pub fn extent(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    values.into_iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}

/// Half the range from the lowest to the highest hundredth: the size of a signal, single samples apart.
pub fn amplitude(values: &[f64]) -> f64 {
    (quantile(values, 0.99) - quantile(values, 0.01)) / 2.0
}

/// How much of the noise a sample has that its six neighbours do not foretell (Lagrange through their
/// real times): the standard deviation of white noise. Smooth commands, also ones with scattering time
/// stamps, have next to none; samples in flat stretches are not counted.
pub fn noise(time: &[f64], values: &[f64]) -> f64 {
    // white noise of 1 leaves sqrt(1 + (1 + 6^2 + 15^2) 2 / 20^2) on a regular clock
    const GAIN: f64 = 1.52;
    let stride = (values.len() / 4000).max(1);
    let errors: Vec<f64> = (3..values.len().saturating_sub(3))
        .step_by(stride)
        .filter(|i| values[i - 1] != values[*i] || values[i + 1] != values[*i])
        .filter_map(|i| {
            let around = [i - 3, i - 2, i - 1, i + 1, i + 2, i + 3];
            let guess: f64 = around
                .iter()
                .map(|&k| {
                    let weight: f64 = around
                        .iter()
                        .filter(|j| **j != k)
                        .map(|&j| (time[i] - time[j]) / (time[k] - time[j]))
                        .product();
                    weight * values[k]
                })
                .sum();
            let error = values[i] - guess;
            error.is_finite().then_some(error.abs())
        })
        .collect();
    if errors.is_empty() { 0.0 } else { MAD_TO_SIGMA * median(&errors) / GAIN }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_signals_have_no_noise_even_with_scattering_stamps() {
        let time: Vec<f64> = (0..500).map(|i| 0.01 * (i as f64 + 0.1 * (i as f64 * 7.7).sin())).collect();
        let smooth: Vec<f64> = time.iter().map(|t| (12.0 * t).sin()).collect();
        assert!(noise(&time, &smooth) < 1e-4);
        let rough: Vec<f64> =
            smooth.iter().enumerate().map(|(i, v)| v + 0.01 * (i as f64).powi(2).sin()).collect();
        let found = noise(&time, &rough);
        assert!((0.003..0.02).contains(&found), "{found}");
    }

    #[test]
    fn a_few_odd_values_do_not_matter() {
        let values = [1.0, 2.0, 3.0, 4.0, 1e9, f64::NAN];
        assert_eq!(median(&values), 3.0);
        assert!((spread(&values[..4]) - 1.4826).abs() < 1e-9 || spread(&values[..4]) > 0.0);
        assert!(quantile(&[], 0.5).is_nan());
    }
    #[test]
    fn quantiles_are_samples_and_their_names_say_which() {
        let values = [40.0, 10.0, 30.0, 20.0];
        // places 0 to 3: a quarter is 0.75, half is 1.5
        assert_eq!([0.0, 0.25, 0.5, 1.0].map(|q| quantile(&values, q)), [10.0, 20.0, 30.0, 40.0]);
        let sorted = [10.0, 20.0, 30.0, 40.0];
        assert_eq!([0, 1, 2, 4].map(|part| quantile_below(&sorted, part, 4)), [10.0, 10.0, 20.0, 40.0]);
        assert!(quantile_below(&[], 1, 4).is_nan());
        // the median is the sample behind the lower half, whatever their number
        for n in 1..50 {
            let all: Vec<f64> = (0..n).map(f64::from).collect();
            assert_eq!(median(&all), all[all.len() / 2]);
        }
    }
}
