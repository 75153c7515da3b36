//! Random numbers of a road's seeds: the same on every processor.

use crate::stats::SplitMix64;

/// The generator of a seed.
pub(super) fn generator(seed: i32) -> SplitMix64 {
    SplitMix64::new(i64::from(seed).cast_unsigned())
}

/// Where a sequence with numbers of any index begins. Those of neighbouring seeds lie far apart.
pub(super) fn beginning(seed: i32) -> u64 {
    generator(seed).bits()
}

/// Number `index` of the sequence from [`beginning`], at least 0 and below 1.
pub(super) fn uniform_at(beginning: u64, index: i64) -> f64 {
    SplitMix64::at(beginning, index).uniform()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_sequences_of_a_seed_differ() {
        for seed in [-7, 0, 1, 2] {
            let mut random = generator(seed);
            let sequence: Vec<_> = (0..320).map(|_| random.uniform()).collect();
            assert!((-1000..1000).all(|i| !sequence.contains(&uniform_at(beginning(seed), i))));
        }
    }
}
