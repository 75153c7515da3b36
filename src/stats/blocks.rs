//! Honest comparison of two models on the same samples, whose errors are not independent: by blocks
//! longer than the errors' memory.

use super::SplitMix64;
use super::moments::{about_mean, mean_or_zero};

/// Resamplings of a test.
const DRAWS: usize = 4000;

/// How many neighbouring samples tell as much as one that is independent: 1 + 2 * sum of the
/// autocorrelation up to its first zero.
pub fn redundancy(series: &[f64]) -> f64 {
    let n = series.len();
    let (mean, power) = (mean_or_zero(series), about_mean(series));
    if n < 8 || power <= 0.0 {
        return 1.0;
    }
    let mut sum = 1.0;
    for lag in 1..n / 4 {
        let product: f64 = series.windows(lag + 1).map(|w| (w[0] - mean) * (w[lag] - mean)).sum();
        let correlation = product / power;
        if correlation <= 0.05 {
            break;
        }
        sum += 2.0 * correlation;
    }
    sum
}

/// Probability that blocks with gains like these come from a comparison without a winner: the share of
/// random signs that give at least this sum. One-sided, never below 1 / (draws + 1).
pub fn sign_flip(gains: &[f64]) -> f64 {
    let sum: f64 = gains.iter().sum();
    if sum <= 0.0 || gains.is_empty() {
        return 1.0;
    }
    let mut random = SplitMix64::new(1);
    let mut as_good = 1;
    for _ in 0..DRAWS {
        let mut total = 0.0;
        let mut bits = 0;
        for (i, gain) in gains.iter().enumerate() {
            if i % 64 == 0 {
                bits = random.bits();
            }
            total += if bits & 1 == 1 { *gain } else { -gain };
            bits >>= 1;
        }
        as_good += usize::from(total >= sum);
    }
    as_good as f64 / (DRAWS + 1) as f64
}

/// The probability that chance makes the product of two independent probabilities of chance as small as it is (Fisher): of
/// the product P it is P (1 - ln P).
pub fn product(a: f64, b: f64) -> f64 {
    let p = a * b;
    if p > 0.0 { p * (1.0 - p.ln()) } else { p }
}

/// How often each of several models has the least `score` when blocks are drawn anew: `errors[model][block]`.
/// `score` is given the number of a model and the blocks that were drawn of it.
pub fn bootstrap_shares<B>(errors: &[Vec<B>], score: impl Fn(usize, &[&B]) -> f64) -> Vec<f64> {
    let blocks = errors.first().map_or(0, Vec::len);
    let mut wins = vec![0.0; errors.len()];
    if blocks == 0 {
        return wins;
    }
    let mut random = SplitMix64::new(2);
    let draws = 1000;
    for _ in 0..draws {
        let chosen: Vec<usize> = (0..blocks).map(|_| random.below(blocks)).collect();
        let of = |m: usize| score(m, &chosen.iter().map(|b| &errors[m][*b]).collect::<Vec<_>>());
        let scores: Vec<f64> = (0..errors.len()).map(of).collect();
        let best = (0..errors.len()).min_by(|a, b| scores[*a].total_cmp(&scores[*b]));
        if let Some(best) = best {
            wins[best] += 1.0;
        }
    }
    wins.iter().map(|won| won / f64::from(draws)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_product_of_two_chances_is_a_chance() {
        let mut random = SplitMix64::new(3);
        let products: Vec<f64> = (0..100_000).map(|_| product(random.uniform(), random.uniform())).collect();
        for level in [0.001, 0.01, 0.1, 0.5] {
            let share = products.iter().filter(|p| **p < level).count() as f64 / products.len() as f64;
            let scatter = (level * (1.0 - level) / products.len() as f64).sqrt();
            assert!((share - level).abs() < 4.0 * scatter, "{level}: {share}");
        }
    }

    #[test]
    fn redundancy_of_filtered_noise_is_that_of_its_spectrum() {
        let mut random = SplitMix64::new(5);
        let (mut y, a) = (0.0, 0.8);
        let series: Vec<f64> = (0..200_000)
            .map(|_| {
                y = a * y + random.normal();
                y
            })
            .collect();
        // 1 + 2 sum a^k = (1 + a) / (1 - a) = 9, less what is cut off at 0.05
        let measured = redundancy(&series);
        assert!((8.0..9.3).contains(&measured), "{measured}");
    }

    #[test]
    fn sign_flip_holds_its_size_and_finds_winners() {
        let mut random = SplitMix64::new(9);
        let trials = 400;
        let alarms = (0..trials)
            .filter(|_| sign_flip(&(0..20).map(|_| random.normal()).collect::<Vec<_>>()) < 0.05)
            .count();
        assert!((8..=34).contains(&alarms), "{alarms} of {trials} at 5 %");
        let gains: Vec<f64> = (0..20).map(|_| 1.0 + random.normal() * 0.5).collect();
        assert!(sign_flip(&gains) < 1e-3);
    }
}
