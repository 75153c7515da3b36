//! Random series for tests.

use super::SplitMix64;

/// Noise of variance 1 with a memory: each value `a` times the one before.
pub fn coloured(random: &mut SplitMix64, a: f64, n: usize) -> Vec<f64> {
    let mut y = random.normal();
    (0..n)
        .map(|_| {
            y = a * y + (1.0 - a * a).sqrt() * random.normal();
            y
        })
        .collect()
}
