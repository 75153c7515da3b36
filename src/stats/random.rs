//! Random numbers that are the same everywhere and every time.

/// What the counter goes on by.
const STRIDE: u64 = 0x9e37_79b9_7f4a_7c15;

/// Steele, Lea and Flood's generator (2014): a counter that is scrambled. Every seed gives another series.
#[derive(Debug, Clone)]
pub struct SplitMix64(u64);

impl SplitMix64 {
    /// A generator from a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The series of a seed from its number `index` on, which a series of counters has at once; the first is 1.
    pub fn at(seed: u64, index: i64) -> Self {
        Self(seed.wrapping_add(index.wrapping_sub(1).cast_unsigned().wrapping_mul(STRIDE)))
    }

    /// The next 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(STRIDE);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A whole number below `n`, 0 for none. For an `n` far below 2^64 all are equally likely.
    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n.max(1) as u64) as usize
    }

    /// A number that is at least 0 and below 1.
    pub fn uniform(&mut self) -> f64 {
        // 53 bits are what a number holds
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A number of nearly the normal distribution, of mean 0 and variance 1: the sum of twelve uniform ones. None is
    /// beyond 6, and fewer than of the normal distribution are beyond 3.
    pub fn normal(&mut self) -> f64 {
        let mut sum = 0.0;
        for _ in 0..12 {
            sum += self.uniform();
        }
        sum - 6.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_generator_is_the_published_one() {
        let published = [6_457_827_717_110_365_317_u64, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423];
        // the first numbers of the authors' generator
        let (mut bits, mut uniform) = (SplitMix64::new(1_234_567), SplitMix64::new(1_234_567));
        for (i, published) in (1..).zip(published) {
            assert_eq!(bits.bits(), published);
            assert_eq!(SplitMix64::at(1_234_567, i).bits(), published);
            assert_eq!(uniform.uniform(), (published >> 11) as f64 / (1_u64 << 53) as f64);
        }
        assert_eq!(bits.below(0), 0);
    }

    #[test]
    fn numbers_have_the_moments_of_their_distributions() {
        let mut random = SplitMix64::new(3);
        let n = 200_000;
        let moments = |values: &[f64]| {
            [1, 2, 4].map(|power| values.iter().map(|v| v.powi(power)).sum::<f64>() / values.len() as f64)
        };
        let uniform: Vec<f64> = (0..n).map(|_| random.uniform()).collect();
        assert!(uniform.iter().all(|v| (0.0..1.0).contains(v)));
        for (found, expected) in moments(&uniform).into_iter().zip([1.0 / 2.0, 1.0 / 3.0, 1.0 / 5.0]) {
            assert!((found - expected).abs() < 3e-3, "{found} {expected}");
        }
        // the fourth moment of a sum of n uniform numbers is 3 - 6 / (5 n) for variance 1
        let normal: Vec<f64> = (0..n).map(|_| random.normal()).collect();
        for (found, (expected, error)) in
            moments(&normal).into_iter().zip([(0.0, 0.01), (1.0, 0.015), (2.9, 0.1)])
        {
            assert!((found - expected).abs() < error, "{found} {expected}");
        }
        let mut counts = [0; 5];
        (0..n).for_each(|_| counts[random.below(5)] += 1);
        assert!(counts.iter().all(|c| (39_000..41_000).contains(c)), "{counts:?}");
    }
}
