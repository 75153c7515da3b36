//! Honest comparison of two models on the same samples, whose errors are not independent: by blocks
//! longer than the errors' memory.

/// Resamplings of a test.
const DRAWS: usize = 4000;

/// A small generator of random numbers (splitmix64): tests must give the same answer every time.
pub struct Dice(u64);

impl Dice {
    /// A generator from a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A whole number below `n`.
    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n.max(1) as u64) as usize
    }
}

/// How many neighbouring samples tell as much as one that is independent: 1 + 2 * sum of the
/// autocorrelation up to its first zero.
pub fn redundancy(series: &[f64]) -> f64 {
    let n = series.len();
    let mean = series.iter().sum::<f64>() / n.max(1) as f64;
    let power: f64 = series.iter().map(|v| (v - mean).powi(2)).sum();
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
    let mut dice = Dice::new(1);
    let mut as_good = 1;
    for _ in 0..DRAWS {
        let mut total = 0.0;
        let mut bits = 0;
        for (i, gain) in gains.iter().enumerate() {
            if i % 64 == 0 {
                bits = dice.bits();
            }
            total += if bits & 1 == 1 { *gain } else { -gain };
            bits >>= 1;
        }
        as_good += usize::from(total >= sum);
    }
    as_good as f64 / (DRAWS + 1) as f64
}

/// What a model leaves in each block less what another leaves.
pub(super) fn differences(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// How often each of several models has the least `score` when blocks are drawn anew: `errors[model][block]`.
/// `score` is given the number of a model and the blocks that were drawn of it.
pub fn bootstrap_shares<B>(errors: &[Vec<B>], score: impl Fn(usize, &[&B]) -> f64) -> Vec<f64> {
    let blocks = errors.first().map_or(0, Vec::len);
    let mut wins = vec![0.0; errors.len()];
    if blocks == 0 {
        return wins;
    }
    let mut dice = Dice::new(2);
    let draws = 1000;
    for _ in 0..draws {
        let chosen: Vec<usize> = (0..blocks).map(|_| dice.below(blocks)).collect();
        let of = |m: usize| score(m, &chosen.iter().map(|b| &errors[m][*b]).collect::<Vec<_>>());
        let scores: Vec<f64> = (0..errors.len()).map(of).collect();
        let best = (0..errors.len()).min_by(|a, b| scores[*a].total_cmp(&scores[*b]));
        if let Some(best) = best {
            wins[best] += 1.0 / f64::from(draws);
        }
    }
    wins
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(dice: &mut Dice) -> f64 {
        (0..12).map(|_| dice.bits() as f64 / u64::MAX as f64).sum::<f64>() - 6.0
    }

    #[test]
    fn redundancy_of_filtered_noise_is_that_of_its_spectrum() {
        let mut dice = Dice::new(5);
        let (mut y, a) = (0.0, 0.8);
        let series: Vec<f64> = (0..200_000)
            .map(|_| {
                y = a * y + noise(&mut dice);
                y
            })
            .collect();
        // 1 + 2 sum a^k = (1 + a) / (1 - a) = 9, less what is cut off at 0.05
        let measured = redundancy(&series);
        assert!((8.0..9.3).contains(&measured), "{measured}");
    }

    #[test]
    fn sign_flip_holds_its_size_and_finds_winners() {
        let mut dice = Dice::new(9);
        let trials = 400;
        let alarms = (0..trials)
            .filter(|_| sign_flip(&(0..20).map(|_| noise(&mut dice)).collect::<Vec<_>>()) < 0.05)
            .count();
        assert!((8..=34).contains(&alarms), "{alarms} of {trials} at 5 %");
        let gains: Vec<f64> = (0..20).map(|_| 1.0 + noise(&mut dice) * 0.5).collect();
        assert!(sign_flip(&gains) < 1e-3);
    }
}
